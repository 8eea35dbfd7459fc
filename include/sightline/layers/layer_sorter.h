#pragma once

// The order in which moving things must be drawn, found anew for each eye from the order before.
//
// Based on: John Snyder, Jed Lengyel. Visibility Sorting and Compositing for Image-Based Rendering.
// Microsoft Research MSR-TR-97-11, 1997. docs/algorithms/layers.md says what differs.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/layers/extent_axis.h"
#include "sightline/layers/hull.h"
#include "sightline/layers/pair_rule.h"
#include "sightline/math/mat4.h"
#include "sightline/scene/camera.h"

namespace sightline {

using HullId = Id<struct HullTag>;  // hull of a LayerSorter
using PartId = Id<struct PartTag>;  // part of a LayerSorter, from 0 in the order in which they were added

// `front` occludes `back`: some ray from the eye meets the hulls of one and then those of the other.
struct LayerArc {
  PartId front{}, back{};

  friend auto operator<=>(const LayerArc&, const LayerArc&) = default;
};

// What a LayerSorter sorts with and what it finds candidates with. Opaque to callers: the two interfaces
// speak of the sorter's private tables.
class LayerSortAlgorithm;
class CandidateSearch;

// Factories, called once by each LayerSorter made with them. sightline/comparison/layer_sorting.h has some.
using MakeLayerSort = std::function<std::unique_ptr<LayerSortAlgorithm>()>;
using MakeCandidateSearch = std::function<std::unique_ptr<CandidateSearch>()>;

struct LayerSettings {
  MakeLayerSort sort{};  // empty: strongly connected components by depth-first search
  std::vector<ExtentAxis> extents = cameraExtents();  // at most kMaxExtentAxes
  MakeCandidateSearch search{};                       // empty: a scan that compares many parts at a time
  // After the sort, groups move to the front of others that do not occlude them and lie farther along this
  // axis of `extents` (a spatial one); none: -1. Keeps the order near what later frames need.
  int conditioning_axis = 2;
  bool exact = true;              // false: extents alone decide. Larger groups
  bool all_arcs = false;          // arcs between groups too: every pair of parts is asked about
  std::uint32_t pair_expiry = 1;  // frames that what is known of a pair outlives its last use
};

struct PartSettings {
  enum class Place : std::uint8_t {
    kSorted,
    kOverlay,   // before all others, as a head-up display; by number among themselves
    kBackdrop,  // behind all others, as the sky; by number among themselves
  };
  Place place = Place::kSorted;
  bool is_static = false;  // never moves after the first update: setTransform is then refused
};

struct LayerStats {
  std::uint64_t extent_updates = 0;    // intervals of parts computed
  std::uint64_t occluder_queries = 0;  // parts or groups whose occluders were asked for
  std::uint64_t candidates = 0;        // parts whose extents did not rule them out
  std::uint64_t pair_queries = 0;      // pairs of parts that were tested exactly
  std::uint64_t chung_steps = 0, gjk_steps = 0;
  std::uint64_t reinsertions = 0;  // parts and groups put back by incrementalSort(); 0 with the default sort
  std::uint64_t conditioned = 0;   // groups that moved
  std::uint64_t known_pairs = 0;   // pairs of which something is kept
};

// One frame's answer; valid until the next call of update().
struct LayerOrder {
  std::span<const PartId> parts{};            // all enabled parts, group after group, front to back
  std::span<const std::uint32_t> first_of{};  // groups + 1: where each begins in parts
  std::span<const LayerArc> arcs{};           // within groups, or all (all_arcs); ascending
  std::span<const LayerArc> collisions{};     // pairs of parts whose hulls meet or touch, front < back;
                                              // ascending. Pairs with a rule are not looked at
  LayerStats stats{};

  std::size_t groups() const { return first_of.empty() ? 0 : first_of.size() - 1; }
  std::span<const PartId> group(std::size_t i) const {
    return parts.subspan(first_of[i], first_of[i + 1] - first_of[i]);
  }
};

// The sorter keeps what it knows from frame to frame. The order is right all around the eye, also for what
// the view does not show. Undecided means "occludes": that may join groups, it never gives a wrong order. No
// allocation in update() after warm-up. For one thread at a time.
class LayerSorter {
 public:
  explicit LayerSorter(LayerSettings settings = {});
  ~LayerSorter();
  LayerSorter(LayerSorter&&) noexcept;
  LayerSorter& operator=(LayerSorter&&) noexcept;

  HullId addHull(ConvexHull hull);
  // The part is the union of the hulls: at least one, of this sorter.
  PartId addPart(std::span<const HullId> hulls, const PartSettings& settings = {});
  std::size_t parts() const;

  // Affine. Not finite: the part occludes all and is occluded by all until it is finite again. false, and
  // nothing changed: the part is static and has been sorted.
  bool setTransform(PartId part, const Mat4& world_from_part);
  // A part that is not enabled is not in the order.
  void setEnabled(PartId part, bool enabled);

  // What a program knows of two parts. A rule only takes arcs away: where it lets one occlude the other,
  // hulls decide; those of a joint meet. For both orders of the two, the last one holds. Without effect with
  // numbers of no part, and where extents alone decide (LayerSettings::exact).
  void setRule(PartId first, PartId second, const PairPlane& rule);
  void setRule(PartId first, PartId second, const SphereCylinderJoint& rule);
  void setRule(PartId first, PartId second, const PairCallback& rule);
  void clearRule(PartId first, PartId second);
  // Two parts with the same single solid hull and the same transform, of which `front` draws those faces of
  // one closed convex surface that the eye sees from outside and `back` the others: a part within the hull
  // lies between them.
  void setContainer(PartId front, PartId back);

  // Builds what the search keeps between frames anew, at once (the tree of extentTree()); call it after
  // update(). Does nothing with the default search.
  void rebuildSearch();
  // Forgets the last order: the next one begins from distances, as after a cut.
  void reset();

  const LayerOrder& update(const View& view);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
