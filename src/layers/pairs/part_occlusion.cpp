#include "src/layers/pairs/part_occlusion.h"

#include <algorithm>
#include <cmath>

#include "sightline/geometry/tolerance.h"
#include "src/layers/hull/support.h"
#include "src/layers/pairs/envelope_pair.h"
#include "src/layers/pairs/pair_eye.h"
#include "src/layers/pairs/swept_set.h"

namespace sightline::layers {
namespace {

// Relative to the coordinates; some hundred times the rounding error of what it is compared with.
constexpr double kMargin = 1e-12;

}  // namespace

void PartOcclusion::beginFrame(const View& view, const PartStore& parts, const ExtentTable& extents,
                               const PairRules& rules, std::uint32_t expiry,
                               std::span<const Vec3d> more_eyes) {
  view_ = view;
  more_eyes_ = view.orthographic ? std::span<const Vec3d>() : more_eyes;
  view_is_finite_ = view.orthographic
                        ? isFinite(view.forward) && l1Norm(view.forward) > 0.0
                        : isFinite(view.eye) && std::all_of(more_eyes.begin(), more_eyes.end(),
                                                            [](const Vec3d& eye) { return isFinite(eye); });
  parts_ = &parts;
  extents_ = &extents;
  rules_ = &rules;
  table_.beginFrame(expiry);
  ++frame_;
  expiry_ = expiry;
  known_colliders_.resize(parts.parts(), 0);
  rule_orders_.resize(rules.numbers());
  collisions_.clear();
  collisions_are_sorted_ = true;
  pair_queries_ = 0;
  counts_ = {};
}

bool PartOcclusion::occludes(std::uint32_t front, std::uint32_t back) {
  if (!view_is_finite_ || parts_->finite[front] == 0 || parts_->finite[back] == 0) {
    return true;
  }
  const std::uint32_t number = rules_->find(front, back);
  const PairRule* rule = number == PairRules::kNone ? nullptr : &rules_->rule(number);
  if (rule != nullptr && std::holds_alternative<ContainerRule>(rule->what)) {
    if (isContainer(rule->first, rule->second)) {
      return rule->first == front;
    }
    rule = nullptr;
  }
  if (rule != nullptr) {
    const PairOrder order = ruleOrder(number);
    if (!(rule->first == front ? order.first_may_occlude : order.second_may_occlude)) {
      return false;
    }
    if (std::holds_alternative<SphereCylinderJoint>(rule->what)) {
      return true;  // they touch
    }
  }

  const std::uint64_t before = counts_.questions;
  const bool occludes = hullsOcclude(front, back, rule == nullptr);
  pair_queries_ += counts_.questions != before ? 1 : 0;
  return occludes;
}

PairOrder PartOcclusion::orderByRule(std::uint32_t first, std::uint32_t second) {
  const std::uint32_t number =
      view_is_finite_ && rules_ != nullptr ? rules_->find(first, second) : PairRules::kNone;
  if (number >= rule_orders_.size() || std::holds_alternative<ContainerRule>(rules_->rule(number).what)) {
    return {};
  }
  const PairOrder order = ruleOrder(number);
  return rules_->rule(number).first == first ? order
                                             : PairOrder{order.second_may_occlude, order.first_may_occlude};
}

// Whether the hulls of part `front` occlude those of part `back`. Without a rule, contacts and containers
// count.
bool PartOcclusion::hullsOcclude(std::uint32_t front, std::uint32_t back, bool without_rule) {
  if (without_rule && stillCollide(front, back)) {
    return containment(front, back) != Verdict::kDoesNot;
  }
  const bool may_touch = without_rule && contact_tolerance_ > 0.0 && spatialExtentsOverlap(front, back);
  if (may_touch) {
    // What is inside a container is so whether or not the smaller hulls still intersect.
    if (const Verdict verdict = containment(front, back); verdict != Verdict::kOpen) {
      collide(front, back);
      return verdict == Verdict::kOccludes;
    }
  }
  const double erosion = may_touch ? contact_tolerance_ : 0.0;
  const bool occludes = anyHullPair(front, back, Reach::kToTheEye, [&](std::uint32_t i, std::uint32_t j) {
    return hullOccludes(front, i, back, j, erosion);
  });
  return occludes && (!without_rule || !collide(front, back) || may_touch ||
                      containment(front, back) != Verdict::kDoesNot);
}

std::span<const Arc> PartOcclusion::collisions() {
  if (!collisions_are_sorted_) {
    std::sort(collisions_.begin(), collisions_.end());
    collisions_.erase(std::unique(collisions_.begin(), collisions_.end()), collisions_.end());
    collisions_are_sorted_ = true;
  }
  return collisions_;
}

PairOrder PartOcclusion::ruleOrder(std::uint32_t number) {
  RuleOrder& known = rule_orders_[number];
  if (known.frame == frame_) {
    return known.order;
  }
  PairOrder order = ruleOrder(rules_->rule(number), view_);
  View other = view_;
  for (const Vec3d& eye : more_eyes_) {
    other.eye = eye;
    const PairOrder for_other = ruleOrder(rules_->rule(number), other);
    order.first_may_occlude = order.first_may_occlude || for_other.first_may_occlude;
    order.second_may_occlude = order.second_may_occlude || for_other.second_may_occlude;
  }
  known = {frame_, order};
  return order;
}

PairOrder PartOcclusion::ruleOrder(const PairRule& rule, const View& view) const {
  PairOrder order;
  if (const auto* callback = std::get_if<PairCallback>(&rule.what)) {
    if (callback->order != nullptr) {
      order = callback->order(callback->user, view);
    }
  } else {
    const PairEye eye = pairEye(view, parts_->placements[rule.first]);
    if (const auto* plane = std::get_if<PairPlane>(&rule.what)) {
      order = orderOf(*plane, eye);
    } else if (const auto* joint = std::get_if<SphereCylinderJoint>(&rule.what)) {
      order = orderOf(*joint, eye);
    }
  }
  return order;
}

bool PartOcclusion::spatialExtentsOverlap(std::uint32_t a, std::uint32_t b) const {
  for (std::size_t axis = 0; axis < extents_->axes(); ++axis) {
    if (!extents_->angular(axis) && !overlapsSpatial(extents_->at(axis, a), extents_->at(axis, b))) {
      return false;
    }
  }
  return true;
}

// Whether test(i, j) is true for some pair of instances of the two parts.
template <typename Test>
bool PartOcclusion::anyHullPair(std::uint32_t front, std::uint32_t back, Reach reach, Test&& test) {
  if (hull_extents_ != nullptr && (parts_->hullsOf(front).size() > 1 || parts_->hullsOf(back).size() > 1)) {
    return anyOverlappingHullPair(front, back, reach, test);
  }
  for (std::uint32_t i = parts_->first_hull[front]; i < parts_->first_hull[front + 1]; ++i) {
    for (std::uint32_t j = parts_->first_hull[back]; j < parts_->first_hull[back + 1]; ++j) {
      if (test(i, j)) {
        return true;
      }
    }
  }
  return false;
}

// Compares each hull with the whole other part first, so that little is left of parts that hardly overlap.
template <typename Test>
bool PartOcclusion::anyOverlappingHullPair(std::uint32_t front, std::uint32_t back, Reach reach,
                                           Test&& test) {
  const PartExtents& extents = *hull_extents_;
  const bool to_the_eye = reach == Reach::kToTheEye;
  const Extent whole = to_the_eye ? extents.query(back) : extentOf(extents.table(), back);
  front_hulls_.clear();
  for (std::uint32_t i = parts_->first_hull[front]; i < parts_->first_hull[front + 1]; ++i) {
    if (overlaps(extents.hulls(), whole, i)) {
      front_hulls_.push_back(i);
    }
  }
  for (std::uint32_t j = parts_->first_hull[back]; j < parts_->first_hull[back + 1]; ++j) {
    const Extent query = to_the_eye ? extents.queryOfHull(j) : extentOf(extents.hulls(), j);
    if (!overlaps(extents.table(), query, front)) {
      continue;
    }
    for (const std::uint32_t i : front_hulls_) {
      if (overlaps(extents.hulls(), query, i) && test(i, j)) {
        return true;
      }
    }
  }
  return false;
}

// Precondition: a < b.
bool PartOcclusion::hullsIntersect(std::uint32_t a, std::uint32_t i, std::uint32_t b, std::uint32_t j) {
  const auto [witness, again] = table_.use(i, j, PairTable::Question::kIntersection);
  if (!again) {
    testIntersection(placed(a, i, contact_tolerance_), placed(b, j, contact_tolerance_), witness, counts_);
  }
  return !witness.disjoint;
}

void PartOcclusion::addCollision(std::uint32_t a, std::uint32_t b) {
  collisions_.push_back({a, b});
  for (const std::uint32_t part : {a, b}) {
    known_colliders_[part] = frame_ + expiry_;
  }
  collisions_are_sorted_ = false;
}

// Whether the parts intersected at their last test and do so now. Then each occludes the other, and one test
// serves both directions.
bool PartOcclusion::stillCollide(std::uint32_t front, std::uint32_t back) {
  if (!mayBeKnownToCollide(front) || !mayBeKnownToCollide(back)) {
    return false;
  }
  const std::uint32_t low = std::min(front, back), high = std::max(front, back);
  const bool intersect = anyHullPair(low, high, Reach::kOwn, [&](std::uint32_t i, std::uint32_t j) {
    const PairTable::Kept kept = table_.find(i, j, PairTable::Question::kIntersection);
    return kept.witness != nullptr && !kept.witness->disjoint &&
           (kept.used_now || hullsIntersect(low, i, high, j));
  });
  if (intersect) {
    addCollision(low, high);
  }
  return intersect;
}

// Whether the parts intersect; if so, records a collision. Parts that intersect occlude each other, so no
// collision of a tested pair is missed.
bool PartOcclusion::collide(std::uint32_t front, std::uint32_t back) {
  const std::uint32_t low = std::min(front, back), high = std::max(front, back);
  const bool intersect = spatialExtentsOverlap(low, high) &&
                         anyHullPair(low, high, Reach::kOwn, [&](std::uint32_t i, std::uint32_t j) {
                           return hullsIntersect(low, i, high, j);
                         });
  if (intersect) {
    addCollision(low, high);
  }
  return intersect;
}

// Whether the direction that separated the hull in front from the set that the hull behind sweeps to the eye
// still does, by their envelopes and with some room.
bool PartOcclusion::stillApart(std::uint32_t front, std::uint32_t i, std::uint32_t back, std::uint32_t j,
                               const PairWitness& witness, double room) const {
  if (!witness.disjoint || !isUnit(witness.direction) || parts_->envelopes.empty()) {
    return false;
  }
  const Vec3d& direction = witness.direction;
  const Placement &of_front = parts_->placements[front], &of_back = parts_->placements[back];
  const Vec3d& origin = of_front.origin;
  const double highest_of_front =
      outerHeight(parts_->envelopes[parts_->part_hulls[i]], of_front, Vec3d(), direction);
  const double highest_of_back =
      outerHeight(parts_->envelopes[parts_->part_hulls[j]], of_back, of_back.origin - origin, -direction);
  // An eye at infinity is on one side of the plane.
  bool eyes_are_apart = view_.orthographic
                            ? outerHeight(view_.forward, direction) <= 0.0
                            : highest_of_front + outerHeight(view_.eye - origin, -direction) < -room;
  for (const Vec3d& eye : more_eyes_) {
    eyes_are_apart = eyes_are_apart && highest_of_front + outerHeight(eye - origin, -direction) < -room;
  }
  return eyes_are_apart && highest_of_front + highest_of_back < -room;
}

// Whether the hull in front intersects the set that the hull behind sweeps to the eye, both made smaller by
// half the erosion.
bool PartOcclusion::hullOccludes(std::uint32_t front, std::uint32_t i, std::uint32_t back, std::uint32_t j,
                                 double erosion) {
  const auto [witness, again] = table_.use(i, j, PairTable::Question::kOcclusion);
  if (again) {
    return !witness.disjoint;
  }
  if (stillApart(front, i, back, j, witness, erosion)) {
    ++counts_.questions;
    ++counts_.chung_steps;
    return false;
  }
  const ConvexSet in_front = placed(front, i, erosion);
  ConvexSet swept = placed(back, j, erosion);
  if (view_.orthographic) {
    if (!sweepPast(view_.forward, in_front, swept)) {
      ++counts_.questions;
      witness.disjoint = true;
      return false;
    }
  } else {
    swept.kind = ConvexSet::Kind::kWithEye;
    swept.eye_or_sweep = view_.eye;
    swept.more_eyes = more_eyes_;
  }
  return testIntersection(in_front, swept, witness, counts_) != Intersection::kDisjoint;
}

bool PartOcclusion::isContainer(std::uint32_t front, std::uint32_t back) const {
  const auto of_front = parts_->hullsOf(front), of_back = parts_->hullsOf(back);
  return of_front.size() == 1 && of_back.size() == 1 && of_front[0] == of_back[0] &&
         parts_->hulls[of_front[0]].dimension == 3 && parts_->placements[front] == parts_->placements[back];
}

// Whether a part inside a container decides the question: it is behind the container's front and in front of
// its back.
PartOcclusion::Verdict PartOcclusion::containment(std::uint32_t front, std::uint32_t back) const {
  const PairRules::Container around_front = rules_->containerOf(back);
  if (around_front.other != PairRules::kNone && isContainer(back, around_front.other) &&
      contains(back, front)) {
    return around_front.is_front ? Verdict::kDoesNot : Verdict::kOccludes;
  }
  const PairRules::Container around_back = rules_->containerOf(front);
  if (around_back.other != PairRules::kNone && isContainer(front, around_back.other) &&
      contains(front, back)) {
    return around_back.is_front ? Verdict::kOccludes : Verdict::kDoesNot;
  }
  return Verdict::kOpen;
}

// Whether all of a part lies inside the shell's hull by more than the rounding error. A face with the normal
// n and the offset d in the hull's space, placed by M, has the normal N = cof(M) n sign(det M), and a point w
// of the world is behind it if N . (w - origin) <= -d |det M|.
bool PartOcclusion::contains(std::uint32_t shell, std::uint32_t part) const {
  const ConvexSet around = placed(shell, parts_->first_hull[shell]);
  const Placement& m = around.placement;
  const Vec3d cof_x = cross(m.y, m.z), cof_y = cross(m.z, m.x), cof_z = cross(m.x, m.y);
  const double determinant = dot(m.x, cof_x);
  const double side = determinant < 0.0 ? -1.0 : 1.0;
  const double x = l1Norm(m.x), y = l1Norm(m.y), z = l1Norm(m.z);
  for (std::uint32_t i = parts_->first_hull[part]; i < parts_->first_hull[part + 1]; ++i) {
    const ConvexSet inside = placed(part, i);
    const double reach = reachOf(inside) + reachOf(around);
    std::uint32_t start = 0;
    for (const Plane& face : around.hull->faces) {
      const Vec3d& n = face.normal;
      const Vec3d normal = (cof_x * n.x + cof_y * n.y + cof_z * n.z) * side;
      const Vec3d direction = inside.placement.toHull(normal);
      const Support top = farthest(*inside.hull, direction, start);
      start = top.vertex;
      const double height = top.height + supportError(*inside.hull, l1Norm(direction)) +
                            dot(normal, inside.placement.origin - m.origin);
      const double steep = x * y + y * z + z * x;
      const double margin = kMargin * (steep * reach + x * y * z * std::abs(face.offset)) +
                            around.hull->slack * std::abs(determinant);
      if (!(height + margin < -face.offset * std::abs(determinant))) {
        return false;
      }
    }
  }
  return true;
}

// erosion: the hull is made smaller by half of this.
ConvexSet PartOcclusion::placed(std::uint32_t part, std::uint32_t instance, double erosion) const {
  ConvexSet set;
  const std::uint32_t hull = parts_->part_hulls[instance];
  set.hull = &parts_->hulls[hull];
  set.around = hull < parts_->envelopes.size() ? &parts_->envelopes[hull] : nullptr;
  set.placement = erosion > 0.0 ? eroded(parts_->placements[part], parts_->boxes[hull], 0.5 * erosion)
                                : parts_->placements[part];
  return set;
}

}  // namespace sightline::layers
