#pragma once

// The exact test of whether one part occludes another, for pairs that the extents do not rule out.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, section 6.
// Differs from the paper in: hulls are first tested for occlusion, which most pairs fail, and for collision
// only if they occlude or collided in the last frame; parts are unions of hulls, of which only the pairs with
// extents that overlap are tested; views may be orthographic; rules are applied before hulls are tested;
// containers.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/layers/pair_rule.h"
#include "sightline/scene/camera.h"
#include "src/layers/extents/extent_table.h"
#include "src/layers/extents/part_extents.h"
#include "src/layers/pairs/convex_pair.h"
#include "src/layers/pairs/pair_rules.h"
#include "src/layers/pairs/pair_table.h"
#include "src/layers/pairs/part_store.h"
#include "src/layers/sort/occluder_source.h"

namespace sightline::layers {

class PartOcclusion {
 public:
  // contact_tolerance: see LayerSettings. hull_extents: of parts with several hulls, only those pairs of
  // hulls are tested whose extents allow it; null: all pairs. They must be up to date in each frame.
  explicit PartOcclusion(double contact_tolerance = 0.0, const PartExtents* hull_extents = nullptr)
      : contact_tolerance_(contact_tolerance), hull_extents_(hull_extents) {}

  // Begins a frame. Parts, extents and rules must not change until its last question.
  // extents: only those of spatial axes are used. expiry: frames for which a pair's result is kept after its
  // last use. more_eyes: in a perspective view, questions are about all eyes in the convex hull of the view's
  // and these, which must not change either; at most kMaxMoreEyes.
  void beginFrame(const View& view, const PartStore& parts, const ExtentTable& extents,
                  const PairRules& rules, std::uint32_t expiry, std::span<const Vec3d> more_eyes = {});
  // Whether some ray from the eye, or from one of the eyes, hits part `front` and then part `back`.
  // Conservative: true if it is not certain. A part that is not finite occludes all others and is occluded by
  // all.
  bool occludes(std::uint32_t front, std::uint32_t back);
  // Which of two parts may occlude the other by their rule alone; both may without one, or in a container.
  PairOrder orderByRule(std::uint32_t first, std::uint32_t second);
  // Returns the pairs of parts that were asked about in this frame, have no rule, and intersect, touch, or
  // nearly touch, or overlap by more than the contact tolerance: front < back, each once, ascending. Valid
  // until the next question.
  std::span<const Arc> collisions();

  std::uint64_t pairQueries() const { return pair_queries_; }  // pairs whose hulls were tested in this frame
  const PairCounts& counts() const { return counts_; }         // counts of this frame
  std::size_t knownPairs() const { return table_.size(); }

 private:
  enum class Verdict : std::uint8_t { kOpen, kOccludes, kDoesNot };

  PairOrder ruleOrder(std::uint32_t number);
  PairOrder ruleOrder(const PairRule& rule, const View& view) const;
  bool spatialExtentsOverlap(std::uint32_t a, std::uint32_t b) const;
  // Which pairs of hulls matter: those that may occlude in this order, or those that may intersect.
  enum class Reach : std::uint8_t { kToTheEye, kOwn };
  template <typename Test>
  bool anyHullPair(std::uint32_t front, std::uint32_t back, Reach reach, Test&& test);
  template <typename Test>
  bool anyOverlappingHullPair(std::uint32_t front, std::uint32_t back, Reach reach, Test&& test);
  bool hullsOcclude(std::uint32_t front, std::uint32_t back, bool without_rule);
  bool hullOccludes(std::uint32_t front, std::uint32_t i, std::uint32_t back, std::uint32_t j,
                    double erosion);
  bool stillApart(std::uint32_t front, std::uint32_t i, std::uint32_t back, std::uint32_t j,
                  const PairWitness& witness, double room) const;
  bool hullsIntersect(std::uint32_t a, std::uint32_t i, std::uint32_t b, std::uint32_t j);
  bool stillCollide(std::uint32_t front, std::uint32_t back);
  bool collide(std::uint32_t front, std::uint32_t back);
  bool mayBeKnownToCollide(std::uint32_t part) const { return known_colliders_[part] >= frame_; }
  void addCollision(std::uint32_t a, std::uint32_t b);

  bool isContainer(std::uint32_t front, std::uint32_t back) const;
  Verdict containment(std::uint32_t front, std::uint32_t back) const;
  bool contains(std::uint32_t shell, std::uint32_t part) const;

  ConvexSet placed(std::uint32_t part, std::uint32_t instance, double erosion = 0.0) const;

  double contact_tolerance_;
  const PartExtents* hull_extents_;
  View view_;
  std::span<const Vec3d> more_eyes_;  // empty in orthographic views
  bool view_is_finite_ = false;
  const PartStore* parts_ = nullptr;
  const ExtentTable* extents_ = nullptr;
  const PairRules* rules_ = nullptr;

  PairTable table_;
  std::vector<std::uint32_t> front_hulls_;  // scratch for anyOverlappingHullPair()
  struct RuleOrder {
    std::uint64_t frame = 0;
    PairOrder order;
  };
  std::vector<RuleOrder> rule_orders_;  // one per rule: its last order and the frame of it
  std::uint64_t frame_ = 0;
  std::vector<Arc> collisions_;
  // One per part: the last frame in which the table may know of a collision.
  std::vector<std::uint64_t> known_colliders_;
  std::uint32_t expiry_ = 0;
  bool collisions_are_sorted_ = true;

  std::uint64_t pair_queries_ = 0;
  PairCounts counts_;
};

}  // namespace sightline::layers
