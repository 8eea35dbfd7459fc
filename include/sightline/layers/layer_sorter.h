#pragma once

// The order in which moving parts must be drawn, found for each view from the order of the last one.
//
// Based on: John Snyder, Jed Lengyel. Visibility Sorting and Compositing for Image-Based Rendering.
// Microsoft Research MSR-TR-97-11, 1997. docs/algorithms/layers.md says what differs.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/layers/extent_axis.h"
#include "sightline/layers/hull.h"
#include "sightline/layers/pair_rule.h"
#include "sightline/math/mat4.h"
#include "sightline/scene/camera.h"

namespace sightline {

using HullId = Id<struct HullTag>;  // a hull of a LayerSorter
using PartId = Id<struct PartTag>;  // a part of a LayerSorter, numbered from 0 (see addPart)

// `front` occludes `back`: some ray from the eye hits a hull of `front` and then, or at the same point, one
// of `back`.
struct LayerArc {
  PartId front{}, back{};

  friend auto operator<=>(const LayerArc&, const LayerArc&) = default;
};

// What a LayerSorter sorts with and what it finds candidates with. Opaque to callers: the two interfaces
// speak of the sorter's private tables.
class LayerSortAlgorithm;
class CandidateSearch;
namespace layers {
struct PartStore;
}

// Factories, called once by each LayerSorter made with them. sightline/comparison/layer_sorting.h (not
// installed) has some.
using MakeLayerSort = std::function<std::unique_ptr<LayerSortAlgorithm>()>;
using MakeCandidateSearch = std::function<std::unique_ptr<CandidateSearch>()>;

// Which arcs LayerOrder::arcs has. The sort itself asks about few pairs: of n parts in one place about 2 n of
// their n^2.
enum class LayerArcs : std::uint8_t {
  kNone,
  kWithinGroups,  // asks about all pairs of parts of each group; needed to merge and composite groups
  kAll,           // asks about all pairs of parts
};

struct LayerSettings {
  MakeLayerSort sort{};  // empty: strongly connected components by depth-first search
  std::vector<ExtentAxis> extents = cameraExtents();  // at most kMaxExtentAxes
  MakeCandidateSearch search{};                       // empty: a scan that compares many parts at a time
  // Moves groups forward after the sort, past groups that lie farther and do not occlude them. This keeps the
  // order near the one that later frames need.
  bool conditioning = true;
  // The index in `extents` of the spatial axis along which "farther" is measured. None given: the first one
  // with Frame::kCamera. Where there is no such axis, groups stay where they are.
  std::optional<std::uint32_t> conditioning_axis{};
  bool exact = true;  // false: parts whose extents overlap count as occluding, which makes groups larger
  LayerArcs arcs = LayerArcs::kWithinGroups;
  // true: sorted parts that are surely outside the view are left out of the order. It then holds for the view
  // alone: what is drawn for shadows and reflections needs the whole.
  bool frustum_culling = false;
  // More than 0, metres: parts whose spatial extents overlap are taken as hulls made smaller by up to half of
  // this on all sides. So parts that touch, as boxes that share a face do, or overlap by a quarter of this or
  // less, have an order: that of the smaller hulls. It may be wrong where the image of one covers that of the
  // other by no more than this, and all over a part that is thinner than this and lies inside another one, no
  // deeper behind its face than half of this. What is inside a container stays there. 0: parts that touch
  // occlude each other.
  double contact_tolerance = 0.0;
  std::uint32_t pair_expiry = 1;  // frames for which a pair's cached result is kept after its last use
};

struct PartSettings {
  enum class Place : std::uint8_t {
    kSorted,
    kOverlay,   // in front of all others (a head-up display); several are ordered by number
    kBackdrop,  // behind all others (the sky); several are ordered by number
    // Opaque and drawn with a depth buffer, which then hides what of the sorted parts is behind. Such parts
    // need no order, and are neither sorted nor tested. They are one group, LayerOrder::depth_buffered.
    kDepthBuffered,
  };
  Place place = Place::kSorted;
  bool is_static = false;  // true: setTransform() is refused after the first update()
};

// Counts of the last update().
struct LayerStats {
  std::uint64_t extent_updates = 0;    // intervals computed, one per part and axis
  std::uint64_t occluder_queries = 0;  // searches for all occluders of a part or group
  std::uint64_t candidates = 0;        // occluders that the extents did not rule out
  std::uint64_t pair_queries = 0;      // pairs of parts tested exactly
  std::uint64_t chung_steps = 0, gjk_steps = 0;
  std::uint64_t reinsertions = 0;  // parts and groups put back by incrementalSort(); 0 with the default sort
  std::uint64_t conditioned = 0;   // groups moved forward by conditioning
  std::uint64_t known_pairs = 0;   // pairs of hulls with a cached result
  std::uint64_t outside = 0;       // parts left out because they are outside the view
};

// The order of one frame. The spans are valid until the next update().
struct LayerOrder {
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::span<const PartId> parts{};            // all enabled parts, group after group, front to back
  std::span<const std::uint32_t> first_of{};  // groups + 1 elements: where each group begins in parts
  std::span<const LayerArc> arcs{};           // as LayerSettings::arcs says; ascending
  // Pairs of parts whose hulls intersect or touch, or overlap by more than the contact tolerance, ascending,
  // front < back. Pairs with a rule are left out. With LayerArcs::kNone only some.
  std::span<const LayerArc> collisions{};
  // The groups of sorted parts begin here, after those of overlays.
  std::uint32_t first_sorted = 0;
  // The first group after those of sorted parts: of depth-buffered parts, of a backdrop, or the number of
  // groups.
  std::uint32_t sorted_end = 0;
  // The group of all depth-buffered parts, by number, which comes after the sorted ones and before backdrops.
  // Its parts need not be adjacent in the true order: where they are nearer, they hide parts of the groups
  // from first_sorted on. kNone: there are none.
  std::uint32_t depth_buffered = kNone;
  LayerStats stats{};

  std::size_t groups() const { return first_of.empty() ? 0 : first_of.size() - 1; }
  std::span<const PartId> group(std::size_t i) const {
    return parts.subspan(first_of[i], first_of[i + 1] - first_of[i]);
  }
};

// Sorts parts into groups, front to back; a group of several parts is a strongly connected component of "may
// occlude". The order holds all around the eye, also outside the view. It is conservative: a pair that the
// tests cannot decide counts as occluding, which may enlarge groups but never gives a wrong order. Results
// are kept from frame to frame. update() does not allocate after warm-up. For one thread at a time.
class LayerSorter {
 public:
  explicit LayerSorter(LayerSettings settings = {});
  ~LayerSorter();
  LayerSorter(LayerSorter&&) noexcept;
  LayerSorter& operator=(LayerSorter&&) noexcept;

  HullId addHull(ConvexHull hull);
  // Replaces a hull, for parts that change their shape, such as skinned ones. Takes time proportional to the
  // number of parts. Returns false and changes nothing if a static part that has been sorted has this hull.
  bool setHull(HullId hull, ConvexHull shape);
  // Adds a part, the union of at least one hull of this sorter. It gets the number of a removed part with as
  // many hulls, or else the next one.
  PartId addPart(std::span<const HullId> hulls, const PartSettings& settings = {});
  // Removes a part and its rules. Its number means nothing until addPart() returns it again, and calls with
  // it have no effect. Takes time proportional to the number of rules.
  void removePart(PartId part);
  // All numbers of parts are below this, those of removed parts too.
  std::size_t parts() const;

  // Places a part by an affine transform. A part with a transform that is not finite occludes all others and
  // is occluded by all. Returns false and changes nothing if the part is static and has been sorted.
  bool setTransform(PartId part, const Mat4& world_from_part);
  // Disabled parts are left out of the order.
  void setEnabled(PartId part, bool enabled);

  // Sets what the program knows about two parts; it replaces the pair's earlier rule, whichever part came
  // first. A rule only removes arcs: where it allows an occlusion, the hulls decide (those of a joint
  // intersect). It has no effect for numbers that are no part, and without LayerSettings::exact.
  void setRule(PartId first, PartId second, const PairPlane& rule);
  void setRule(PartId first, PartId second, const SphereCylinderJoint& rule);
  void setRule(PartId first, PartId second, const PairCallback& rule);
  void clearRule(PartId first, PartId second);
  // Declares that two parts are the near and the far side of one closed convex surface, so that a part inside
  // it is drawn between them. Both parts must have the same single solid hull and the same transform; `front`
  // draws the faces that the eye sees from outside, `back` the others.
  void setContainer(PartId front, PartId back);

  // What the sorter was told about a part; empty, or the default, for a number that is no part.
  std::vector<HullId> hullsOf(PartId part) const;
  PartSettings settingsOf(PartId part) const;
  Mat4 transformOf(PartId part) const;
  bool isEnabled(PartId part) const;  // false for a number that is no part
  bool isInContainer(PartId part) const;
  const ConvexHull& hull(HullId hull) const;  // valid until the next addHull() or setHull()
  const LayerSettings& settings() const;
  // Gives part `to` every rule that `from` has with another part, except containers. For a part that takes
  // the place of another, or of a piece of it.
  void copyRules(PartId from, PartId to);

  // Builds what the search keeps between frames anew, at once (the tree of extentTree(), not installed); call
  // it after update(). Does nothing with the default search.
  void rebuildSearch();
  // Forgets the last order, so that the next one starts from distances. For a cut to another view.
  void reset();

  const LayerOrder& update(const View& view) { return update(view, {}); }
  // The same for a set of eyes: the convex hull of the view's eye and these, such as two eyes, the points of
  // a lens, or the way of a camera. One part occludes another if it does for some eye of the set, so the
  // order is right for each of them. In an orthographic view more_eyes are ignored. Rules are asked for each
  // of these eyes, and allow what one of them allows; that is right for all eyes between them if the eyes for
  // which a PairCallback excludes an occlusion form a convex set, and if none is in a joint's sphere or
  // cylinder. Parts are not left out for being outside the view. At most 65,535 eyes; the rest is ignored.
  const LayerOrder& update(const View& view, std::span<const Vec3d> more_eyes);

 private:
  friend class CycleSplitter;

  const layers::PartStore& store() const;
  // Which of two parts may occlude the other by their rule, for the eyes of an update() whose spans are still
  // valid; both may without a rule. Rules that were set since have no effect.
  PairOrder orderByRule(PartId first, PartId second);
  // A different number for each part that ever had this number; 0 for a number that is no part.
  std::uint64_t generationOf(PartId part) const;

  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
