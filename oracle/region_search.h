#pragma once

// Tries to see an object from somewhere in a region, to contradict a claim that it is hidden from all of it.
//
// A search proves nothing when it finds nothing. What it finds is decided in exact arithmetic.
//
// Four numbers describe a line from the region to the object. Whatever fixes two of them leaves a search that
// is exact but for rounding: all lines in a plane (PlaneLines), and all lines through an eye
// (VisibilityProof). The search takes random lines first, then planes: through random points of region and
// object, across the edges and through the corners of what blocks a line, and around the best lines so far. A
// line is better the fewer surfaces block it. At last it decides whether the eyes of the best lines and the
// corners of the region see the object.

#include <cstdint>
#include <memory>

#include "oracle/exact_visibility.h"
#include "oracle/eye_region.h"

namespace sightline {

struct RegionSearchSettings {
  // What is closer to the eye than this may be clipped by a view's near plane: it hides nothing. Metres.
  double near_distance = 0.0;
  std::uint32_t lines = 256;        // random lines, at most
  std::uint32_t planes = 96;        // planes whose lines are searched, at most
  std::uint32_t plane_steps = 600;  // lines that are tried in a plane, at most
  std::uint32_t eyes = 12;          // eyes for which exact arithmetic decides, at most
  std::uint32_t eye_steps = 64;     // steps of a decision, as of ExactVisibility::decide
};

enum class FoundBy : std::uint8_t { kLine, kPlane, kEye };

struct RegionAnswer {
  bool found = false;
  FoundBy by = FoundBy::kLine;
  Vec3d eye{};          // if found: in the region
  View view{};          // if found: from this eye; its near plane clips nothing beyond near_distance
  SeenPoint witness{};  // if found: what the view shows
  std::uint64_t lines = 0, planes = 0, eyes = 0;  // that were searched
  // Pairs of an eye and a picture from it, for which the object was proved hidden, and not decided.
  std::uint64_t hidden_views = 0, undecided_views = 0;
};

// Const functions may be called from several threads at once.
class RegionSearch {
 public:
  // The scene's memory must outlive this object.
  explicit RegionSearch(const SceneView& scene);
  ~RegionSearch();
  RegionSearch(RegionSearch&&) noexcept;
  RegionSearch& operator=(RegionSearch&&) noexcept;

  // The same arguments give the same answer. Nothing is found if the region is empty or the object has no
  // triangles.
  RegionAnswer contradict(const EyeRegion& region, ObjectId object, const RegionSearchSettings& settings,
                          std::uint64_t seed) const;

 private:
  struct Impl;
  class Attempt;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
