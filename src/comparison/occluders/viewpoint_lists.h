#pragma once

// The best occluders of one picture, by each criterion.

#include <span>
#include <vector>

#include "sightline/comparison/viewpoint_database.h"
#include "src/comparison/occluders/id_buffer.h"
#include "src/comparison/occluders/minimum_sets.h"
#include "src/comparison/occluders/occluder_filter.h"
#include "src/comparison/occluders/occluder_picture.h"
#include "src/comparison/occluders/occluder_stack.h"
#include "src/comparison/occluders/set_selection.h"

namespace sightline::comparison {

// What all pictures of a database have in common. Its settings are in range.
struct PictureSource {
  const Hierarchy& hierarchy;
  const OccluderSet& set;
  OccluderFilter filter;
  std::vector<NodeIndex> occludees;
  ViewpointDatabaseSettings settings;
  PictureShape shape;

  PictureSource(const Hierarchy& hierarchy_, const OccluderSet& set_,
                const ViewpointDatabaseSettings& settings_);
  // In steradians: an occluder with a smaller solid angle has fewer than min_occluder_pixels pixels anywhere
  // in the picture.
  double minSolidAngle() const;
};

// Makes the lists of one picture after the other, and keeps its storage. Each thread has one of its own.
class ListMaker {
 public:
  explicit ListMaker(const PictureSource& source) : source_(source) {}

  // Sets the eye of the pictures that follow.
  void moveTo(const Vec3d& eye);
  // The list for a viewing direction, best first, ties by id.
  void make(const Vec3d& direction, std::vector<OccluderId>& list);

 private:
  template <typename Key>
  void rankBy(Key&& key, std::vector<OccluderId>& list);
  void byProjectedSize(std::vector<OccluderId>& list);
  void byFirstHit(std::vector<OccluderId>& list);
  void byMinimumSets(std::vector<OccluderId>& list);
  void goOnByFirstHit(std::vector<OccluderId>& list);
  void drawNearest();

  const PictureSource& source_;
  Vec3d eye_;
  std::vector<NearOccluder> candidates_;
  OccluderPicture picture_;
  IdBuffer nearest_;
  std::vector<std::uint32_t> order_;

  std::vector<Occludee> occludees_;
  OccluderStack stack_;
  CombinationTable table_;
  MinimumSetSearch search_;
  std::vector<double> cost_of_;
  SetPool pool_;
  SetSelection selection_;
};

}  // namespace sightline::comparison
