// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, section 5.
// Differs from the paper in: an occluder's score for a cell is a bound over all viewpoints of the cell
// instead of the area-angle at one of them, so that none is lost that is worth more from some corner of it
// than the last one in the list could be from anywhere.
//
// Let c be the occluder's centroid, N its normal, A its area, E a viewpoint of the cell, r = |E - c|, and
// h = N . (E - c), the height of E over the occluder on the side that is seen. With r >= r0, the distance
// from c to the cell, and h <= h0, the largest height of a corner of the cell:
//
//   kOccluder:  area-angle = A h / r^3 = A (h / r) / r^2       <= A min(1, h0 / r0) / r0^2
//   kView:      area-angle = -A (N . V) / r^2                  <= A cos(max(0, a - w)) / r0^2
//
// where V is a viewing direction that is at most w, the directions' covering angle, from the stored direction
// d, and a is the angle between d and -N (N when the back is seen). No solid angle is larger than 2 pi:
// neither is a score.
//
// The polygon lies in a sphere of radius s around c, the cell in one of radius R around m. So what a
// viewpoint of the cell sees of the polygon lies within b = asin((s + R) / |c - m|) of the direction of c -
// m, and it counts for d if that makes at most view_angle / 2 + w + b with d.
//
// The search goes best first through a hierarchy over the centroids. A node's bound, with the largest area
// below it and the distance of its box, is never smaller than a score below it, also in rounded arithmetic:
// every operation is monotonic. So occluders arrive in descending order of what they can at most be worth
// for a direction, and a direction is finished when that is worse than the last entry of its full list.

#include "src/occluders/database/database_lists.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "src/occluders/occluder_radius.h"

namespace sightline::occluders {
namespace {

constexpr double kFullSolidAngle = 2.0 * std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kRelativeRounding = 1e-9;  // relative: far above that of a few operations

// Squared distance between two boxes, or of a point from a box.
double squaredGap(const Vec3d& a_min, const Vec3d& a_max, const Vec3d& b_min, const Vec3d& b_max) {
  const Vec3d gap = max(Vec3d(), max(a_min - b_max, b_min - a_max));
  return dot(gap, gap);
}

bool better(const std::pair<double, OccluderId>& a, const std::pair<double, OccluderId>& b) {
  return a.first > b.first || (a.first == b.first && a.second < b.second);
}

}  // namespace

CandidateTree::CandidateTree(const OccluderSet& set, bool turned_away) {
  std::vector<Candidate> usable;
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < set.occluders.size(); ++i) {
    const Occluder& o = set.occluders[i];
    const double radius = occluders::radiusOf(set, o);
    if (isFinite(o.centroid) && std::isfinite(radius) && std::isfinite(o.area) && o.area > 0.0f) {
      usable.push_back({Vec3d(o.centroid), turned_away ? o.plane.flipped() : o.plane, o.area, radius,
                        OccluderId(i), o.double_sided});
      boxes.push_back({o.centroid, o.centroid});
      bounds_.extend(o.centroid);
    }
  }
  const Hierarchy bvh = buildHierarchy(boxes, {}, {.kind = HierarchyKind::kBvh, .max_leaf_objects = 4});
  for (const ObjectId object : bvh.objects) {
    candidates_.push_back(usable[object.value]);
  }
  nodes_.resize(bvh.nodes.size());
  for (std::size_t i = nodes_.size(); i-- > 0;) {  // children before their parent
    Node& node = nodes_[i];
    const HierarchyNode& source = bvh.nodes[i];
    node.min = Vec3d(source.bounds.min);
    node.max = Vec3d(source.bounds.max);
    double polygon_radius = 0.0;
    if (source.leaf()) {
      node.first = source.link;
      node.after = source.link + static_cast<std::uint32_t>(bvh.objectsBelow(NodeIndex(i)).size());
      for (std::uint32_t c = node.first; c < node.after; ++c) {
        node.max_area = std::max(node.max_area, candidates_[c].area);
        polygon_radius = std::max(polygon_radius, candidates_[c].radius);
      }
      node.radius = 0.5 * length(node.max - node.min) + polygon_radius;
    } else {
      node.right = bvh.right(NodeIndex(i)).value;
      for (const Node* child : {&nodes_[i + 1], &nodes_[node.right]}) {
        node.max_area = std::max(node.max_area, child->max_area);
        const double off_center = 0.5 * length((child->min + child->max) - (node.min + node.max));
        node.radius = std::max(node.radius, off_center + child->radius);
      }
    }
  }
}

ListFinder::ListFinder(const CandidateTree& tree, const occluders::SphereDirections& directions,
                       const ListSettings& settings)
    : tree_(tree), directions_(directions), settings_(settings), best_(directions.count()) {
  const double view_angle = settings.view_angle_deg > 0.0 ? std::min(settings.view_angle_deg, 360.0) : 0.0;
  const double covering = directions.coveringAngleRad();
  const double cone = std::min(std::numbers::pi, view_angle * std::numbers::pi / 360.0 + covering);
  cos_cone_ = std::cos(cone);
  sin_cone_ = std::max(0.0, std::sin(cone));
  cos_covering_ = std::cos(covering);
  sin_covering_ = std::max(0.0, std::sin(covering));
}

// The bound holds for all directions and everything below the node.
double ListFinder::boundOf(const CandidateTree::Node& node) const {
  return std::min(kFullSolidAngle, node.max_area / squaredGap(node.min, node.max, cell_.min, cell_.max));
}

// Which sides of the candidate are seen and hide from somewhere in the cell, and its distance.
ListFinder::Sight ListFinder::sightOf(const Candidate& candidate) const {
  const Vec3d& n = candidate.plane.normal;
  const Vec3d at_min(n.x * cell_.min.x, n.y * cell_.min.y, n.z * cell_.min.z);
  const Vec3d at_max(n.x * cell_.max.x, n.y * cell_.max.y, n.z * cell_.max.z);
  const Vec3d high = max(at_min, at_max), low = min(at_min, at_max);
  Sight sight;
  sight.highest = high.x + high.y + high.z;
  sight.lowest = low.x + low.y + low.z;
  sight.front = sight.highest + candidate.plane.offset > 0.0;
  sight.back = candidate.double_sided && sight.lowest + candidate.plane.offset < 0.0;
  sight.squared_distance = squaredGap(candidate.centroid, candidate.centroid, cell_.min, cell_.max);
  return sight;
}

// For all directions; for kOccluder the score itself. 0: no viewpoint of the cell sees a side that hides.
double ListFinder::boundOf(const Candidate& candidate) const {
  const Sight sight = sightOf(candidate);
  if (!sight.front && !sight.back) {
    return 0.0;
  }
  double cosine = 1.0;
  if (settings_.direction == AreaAngleDirection::kOccluder) {
    const double level = dot(candidate.plane.normal, candidate.centroid);
    const double height =
        std::max(sight.front ? sight.highest - level : 0.0, sight.back ? level - sight.lowest : 0.0);
    const double nearest = std::sqrt(sight.squared_distance);
    cosine = height < nearest ? height / nearest : 1.0;
  }
  return std::min(kFullSolidAngle, cosine * candidate.area / sight.squared_distance);
}

// kView: never larger than boundOf.
double ListFinder::scoreAlong(const Vec3d& direction, const Candidate& candidate, const Sight& sight) const {
  // cos(max(0, a - w)) from x = cos(a).
  const auto bestCosine = [this](double x) {
    return x >= cos_covering_
               ? 1.0
               : std::min(1.0, x * cos_covering_ + std::sqrt(std::max(0.0, 1.0 - x * x)) * sin_covering_);
  };
  const double x = dot(candidate.plane.normal, direction);
  const double cosine = std::max(sight.front ? bestCosine(-x) : 0.0, sight.back ? bestCosine(x) : 0.0);
  if (!(cosine > 0.0)) {
    return 0.0;  // also at no distance
  }
  return std::min(kFullSolidAngle, cosine * candidate.area / sight.squared_distance);
}

// A sphere of this radius at this offset from the middle of the cell is in the cone of a unit direction d,
// as seen from somewhere in the cell, when dot(d, from_cell) is at least this.
double ListFinder::minDotInCone(const Vec3d& from_cell, double radius) const {
  const double distance = length(from_cell);
  const double reach = radius + cell_.radius;
  if (!(distance > reach)) {
    return -kInfinity;
  }
  // b as above, a: half the cone's angle; beyond a + b = 180 degrees everything is in it.
  const double sin_b = reach / distance, cos_b = std::sqrt(1.0 - sin_b * sin_b);
  if (sin_cone_ * cos_b + cos_cone_ * sin_b <= 0.0) {
    return -kInfinity;
  }
  return distance * (cos_cone_ * cos_b - sin_cone_ * sin_b);
}

void ListFinder::push(const Entry& entry) {
  queue_.push_back(entry);
  std::push_heap(queue_.begin(), queue_.end());
}

// Queues what lies directly below the node, unless it is in no unfinished direction's cone.
void ListFinder::open(std::uint32_t index) {
  const CandidateTree::Node& node = tree_.nodes()[index];
  const Vec3d from_cell = 0.5 * (node.min + node.max) - cell_.center;
  const double radius = node.radius + kRelativeRounding * (node.radius + length(from_cell));
  const double min_dot = minDotInCone(from_cell, radius);
  if (std::none_of(open_.begin(), open_.end(),
                   [&](std::uint32_t d) { return dot(directions_[d], from_cell) >= min_dot; })) {
    return;
  }
  if (!node.leaf()) {
    for (const std::uint32_t child : {index + 1, node.right}) {
      push({boundOf(tree_.nodes()[child]), 0, child});
    }
    return;
  }
  for (std::uint32_t c = node.first; c < node.after; ++c) {
    const double bound = boundOf(tree_[c]);
    if (bound > 0.0) {
      push({bound, tree_[c].id.value + 1, c});
    }
  }
}

// Enters the candidate into the lists of the unfinished directions, and finishes those that it, and hence
// whatever follows it in the queue, could not improve.
void ListFinder::take(const Candidate& candidate, double bound) {
  const Vec3d from_cell = candidate.centroid - cell_.center;
  const double min_dot = minDotInCone(from_cell, candidate.radius);
  const bool along_view = settings_.direction == AreaAngleDirection::kView;
  const Sight sight = along_view ? sightOf(candidate) : Sight{};
  const auto finished = [&](std::uint32_t d) {
    std::vector<Ranked>& list = best_[d];
    if (dot(directions_[d], from_cell) >= min_dot) {
      const double score = along_view ? scoreAlong(directions_[d], candidate, sight) : bound;
      if (score > 0.0) {
        insert({score, candidate.id}, list);
      }
    }
    return list.size() == settings_.count && !better({bound, candidate.id}, list.front());
  };
  open_.erase(std::remove_if(open_.begin(), open_.end(), finished), open_.end());
}

void ListFinder::insert(const Ranked& entry, std::vector<Ranked>& list) const {
  if (list.size() == settings_.count) {
    if (!better(entry, list.front())) {
      return;
    }
    std::pop_heap(list.begin(), list.end(), better);
    list.pop_back();
  }
  list.push_back(entry);
  std::push_heap(list.begin(), list.end(), better);
}

void ListFinder::find(const Box& cell, std::span<OccluderId> ids, std::span<std::uint32_t> counts) {
  cell_.min = Vec3d(cell.min);
  cell_.max = Vec3d(cell.max);
  cell_.center = 0.5 * (cell_.min + cell_.max);
  cell_.radius = 0.5 * length(cell_.max - cell_.min);
  queue_.clear();
  open_.clear();
  for (std::uint32_t d = 0; d < directions_.count(); ++d) {
    best_[d].clear();
    open_.push_back(d);
  }
  if (settings_.count > 0 && !tree_.nodes().empty()) {
    push({boundOf(tree_.nodes()[0]), 0, 0});
  }
  while (!queue_.empty() && !open_.empty()) {
    std::pop_heap(queue_.begin(), queue_.end());
    const Entry entry = queue_.back();
    queue_.pop_back();
    if (entry.rank == 0) {
      open(entry.index);
    } else {
      take(tree_[entry.index], entry.bound);
    }
  }
  for (std::uint32_t d = 0; d < directions_.count(); ++d) {
    std::sort_heap(best_[d].begin(), best_[d].end(), better);
    counts[d] = static_cast<std::uint32_t>(best_[d].size());
    for (std::size_t i = 0; i < best_[d].size(); ++i) {
      ids[std::size_t{d} * settings_.count + i] = best_[d][i].second;
    }
  }
}

}  // namespace sightline::occluders
