#pragma once

// The occluders that are active for one view: those that can be used from there, with their outlines drawn in
// and their planes through the eye. SupportingPlanes and KeptPlanes start from them.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/occlusion/supporting_planes.h"
#include "src/occlusion/eye_occluder.h"
#include "src/occlusion/planes/eye_planes.h"

namespace sightline::occlusion {

// An edge of an outline, drawn in; relative to the occluder's first vertex.
struct InsetEdge {
  Vec3d point, direction;  // direction: unit length
};

struct ActiveOccluder {
  EyeOccluder seen;
  std::uint32_t set = 0;  // its set, by position in what build() was given
  Vec3d origin;           // its first vertex, scene space
  double inset = 0.0;     // metres by which its outline is drawn in: 2^inset_exponent, at least seen.inset
  std::int16_t inset_exponent = 0;
  std::uint16_t edge_count = 0;
  bool near_clipped = false;
  // Where the near plane clips it: the plane through the eye and the cut, relative to the eye. What the near
  // plane leaves of the occluder lies behind.
  Plane near_cut;
  std::uint32_t first_edge = 0;  // in the inset edges of all active occluders
};

// Active occluders have numbers from 0 to size() - 1, in the order in which they were added.
class ActiveOccluders {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // Starts a view with the chosen occluders of some sets.
  void build(const View& view, std::span<const ChosenOccluders> sets);
  // Makes further occluders of a set active and returns the list of them, ascending by OccluderId, each once.
  // What cannot be used from here is left out.
  OccluderList add(std::uint32_t set, std::span<const OccluderId> ids);

  const Eye& eye() const { return eye_; }
  std::uint32_t size() const { return static_cast<std::uint32_t>(occluders_.size()); }
  const ActiveOccluder& operator[](std::uint32_t number) const { return occluders_[number]; }
  const OccluderSet& setOf(const ActiveOccluder& occluder) const { return *sources_[occluder.set].set; }
  std::span<const InsetEdge> edgesOf(const ActiveOccluder& occluder) const;
  // The number of an occluder; kNone unless it is active.
  std::uint32_t find(std::uint32_t set, OccluderId id) const;
  bool hasSets() const { return !sources_.empty(); }

  // The list of the occluders of build(): the first builtCount() ones.
  OccluderList all() const { return all_; }
  std::uint32_t builtCount() const { return built_count_; }
  // Those of them that are of the first set.
  std::span<const OccluderId> used() const { return used_; }
  SupportingPlanesStats stats() const { return stats_; }

  // Lists are ranges of one growing array of numbers: a new one is begun by its first position, filled by
  // append(), and taken away by truncate().
  std::uint32_t endOfLists() const { return static_cast<std::uint32_t>(lists_.size()); }
  std::uint32_t inList(OccluderList list, std::uint32_t i) const { return lists_[list.first + i]; }
  void append(std::uint32_t number) { lists_.push_back(number); }
  void truncate(std::uint32_t end) { lists_.resize(end); }

  // Compares a box with the planes through the eye of one active occluder.
  EyePlaneTest test(std::uint32_t number, const Box& box) const;
  // Compares a box with the occluders of a list, up to the first that hides it. tests: at least list.count.
  // Returns how many were compared.
  std::uint32_t testEach(OccluderList list, const Box& box, std::span<EyePlaneTest> tests) const;

 private:
  // A set of build(). Its occluders have the slots from first_slot on, after those of the sets before.
  struct Source {
    const OccluderSet* set = nullptr;
    std::uint32_t first_slot = 0;
  };
  static constexpr std::uint32_t kUnusable = kNone - 1;

  void takeSources(std::span<const ChosenOccluders> sets);
  std::uint32_t activate(std::uint32_t set, OccluderId id);

  std::vector<Source> sources_;
  Eye eye_;
  bool usable_view_ = false;  // validate() accepts the view of the last build(). Otherwise no occluder hides
  std::vector<ActiveOccluder> occluders_;
  std::uint32_t built_count_ = 0;
  std::vector<std::uint32_t> number_of_;    // by slot of an occluder: its number, kUnusable or kNone
  std::vector<std::uint32_t> taken_slots_;  // slots that are not kNone
  std::vector<OccluderId> used_;
  std::vector<InsetEdge> inset_edges_;
  std::vector<EyeShape> shapes_;  // by number
  std::vector<EyeQuad> quads_;
  std::vector<std::uint32_t> lists_;
  OccluderList all_;
  SupportingPlanesStats stats_;
};

}  // namespace sightline::occlusion
