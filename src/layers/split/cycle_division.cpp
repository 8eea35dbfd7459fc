#include "src/layers/split/cycle_division.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sightline/geometry/tolerance.h"
#include "src/layers/split/cut_planes.h"

namespace sightline::layers {
namespace {

constexpr std::size_t kTriedNodes = 3;       // of a cycle, for each cut
constexpr std::size_t kTriedNeighbours = 4;  // whose planes are tried
constexpr std::size_t kPatience = 6;         // cuts in a row without progress
constexpr double kProgress = 0.002;          // the share of the weight in cycles that is worth a cut
constexpr double kGain = 1e-9;               // smaller differences of scores are rounding

bool isLess(double a, double b) {
  return a < b - kGain * std::abs(b);
}

bool isBetter(const CycleGraph::Score& a, const CycleGraph::Score& b) {
  return isLess(a.weight, b.weight) || (!isLess(b.weight, a.weight) && isLess(a.surface, b.surface));
}

}  // namespace

CycleDivision::CycleDivision(const SetOcclusion& occlusion, std::span<const Vec3d> eyes,
                             std::vector<CycleMember> members, ShapeOfMember shape_of,
                             const DivisionLimits& limits)
    : occlusion_(occlusion),
      eyes_(eyes),
      members_(std::move(members)),
      shape_of_(std::move(shape_of)),
      limits_(limits) {
  for (const CycleMember& member : members_) {
    member_of_.push_back(graph_.add(member.weight, member.surface));
    parent_of_.push_back(kNoNode);
    cuts_left_.push_back(member.cuts_left);
    sets_.push_back(member.sets);
    shapes_.emplace_back();
  }
}

bool CycleDivision::run() {
  const CycleGraph::Score before = graph_.score();
  double fewest = before.nodes, lightest = before.weight;
  std::size_t kept = 0, last_gain = 0;  // numbers of cuts
  while (trials_ < limits_.max_trials && cuts_.size() < last_gain + kPatience) {
    const std::vector<std::uint32_t> cycle = worstCycle();
    std::optional<Choice> best = cycle.empty() ? std::nullopt : bestCut(cycle);
    if (!best) {
      break;
    }
    apply(std::move(*best));
    const CycleGraph::Score score = graph_.score();
    if (score.weight < lightest * (1.0 - kProgress)) {
      lightest = score.weight;
      last_gain = cuts_.size();
    }
    if (score.nodes < fewest) {
      fewest = score.nodes;
      kept = last_gain = cuts_.size();
    }
  }
  while (cuts_.size() > kept) {
    setDivided(cuts_.back(), false);
    cuts_.pop_back();
  }
  if (!(fewest < before.nodes)) {
    return false;
  }
  takeBackInVain(fewest);
  return true;
}

// The cycle with the greatest weight; empty if there is none.
std::vector<std::uint32_t> CycleDivision::worstCycle() {
  graph_.score();
  std::vector<std::uint32_t> worst;
  double most = 0.0;
  for (const std::vector<std::uint32_t>& cycle : graph_.cycles()) {
    double weight = 0.0;
    for (const std::uint32_t node : cycle) {
      weight += graph_[node].weight;
    }
    if (weight > most) {
      most = weight;
      worst = cycle;
    }
  }
  return worst;
}

// The nodes through which most of the cycle's arcs lead, and that a random line hits most often.
std::vector<std::uint32_t> CycleDivision::nodesToDivide(std::span<const std::uint32_t> cycle) const {
  std::vector<std::uint8_t> is_in(graph_.size(), 0);
  for (const std::uint32_t node : cycle) {
    is_in[node] = 1;
  }
  const auto count = [&](const std::vector<std::uint32_t>& list) {
    return static_cast<double>(std::count_if(list.begin(), list.end(), [&](std::uint32_t node) {
      return is_in[node] != 0 && graph_[node].alive;
    }));
  };
  std::vector<std::pair<double, std::uint32_t>> ranked;
  for (const std::uint32_t node : cycle) {
    const bool fits = pieces_ + piecesOf(node) <= limits_.max_pieces;
    if (cuts_left_[node] > 0 && fits) {
      const CycleGraph::Node& own = graph_[node];
      ranked.emplace_back(-count(own.behind) * count(own.in_front) * own.surface, node);
    }
  }
  std::sort(ranked.begin(), ranked.end());
  ranked.resize(std::min(ranked.size(), kTriedNodes));
  std::vector<std::uint32_t> nodes;
  for (const auto& [rank, node] : ranked) {
    nodes.push_back(node);
  }
  return nodes;
}

std::optional<CycleDivision::Choice> CycleDivision::bestCut(std::span<const std::uint32_t> cycle) {
  std::optional<Choice> best;
  for (const std::uint32_t node : nodesToDivide(cycle)) {
    tryPlanes(node, cycle, best);
  }
  return best;
}

// The first hulls of the largest neighbours within the cycle, those first that are both in front and behind.
std::vector<ConvexSet> CycleDivision::neighboursOf(std::uint32_t node,
                                                   std::span<const std::uint32_t> cycle) const {
  std::vector<std::uint32_t> members(cycle.begin(), cycle.end());
  std::sort(members.begin(), members.end());
  std::vector<std::pair<double, std::uint32_t>> ranked;
  const CycleGraph::Node& own = graph_[node];
  const auto has = [](const std::vector<std::uint32_t>& list, std::uint32_t other) {
    return std::find(list.begin(), list.end(), other) != list.end();
  };
  for (const std::uint32_t other : members) {
    const bool behind = has(own.behind, other), in_front = has(own.in_front, other);
    if (behind || in_front) {
      ranked.emplace_back(-graph_[other].surface * (behind && in_front ? 1e6 : 1.0), other);
    }
  }
  std::sort(ranked.begin(), ranked.end());
  ranked.resize(std::min(ranked.size(), kTriedNeighbours));
  std::vector<ConvexSet> sets;
  for (const auto& [rank, other] : ranked) {
    if (!sets_[other].empty()) {
      sets.push_back(sets_[other].front());
    }
  }
  return sets;
}

bool CycleDivision::haveShape(std::uint32_t node) {
  if (!shapes_[node] && node < members_.size()) {
    shapes_[node] = shape_of_(node);
    cuts_left_[node] = shapes_[node] ? cuts_left_[node] : 0;
  }
  return shapes_[node].has_value();
}

void CycleDivision::tryPlanes(std::uint32_t node, std::span<const std::uint32_t> cycle,
                              std::optional<Choice>& best) {
  if (!haveShape(node)) {
    return;
  }
  // The halves come after all nodes.
  std::vector<std::uint32_t> among(cycle.begin(), cycle.end());
  among.push_back(graph_.size());
  among.push_back(graph_.size() + 1);
  const PartShape& shape = *shapes_[node];
  for (const Plane& plane : cutPlanes(shape, placementOf(node), neighboursOf(node, cycle))) {
    if (trials_ == limits_.max_trials) {
      return;
    }
    ++trials_;
    std::optional<ShapeHalves> halves = halvesOf(shape, plane);
    if (!halves) {
      continue;
    }
    addHalves(node, plane, *halves);
    graph_[node].alive = false;
    const CycleGraph::Score score = graph_.score(among);
    graph_[node].alive = true;
    graph_.removeLast();
    graph_.removeLast();
    if (!best || isBetter(score, best->score)) {
      best = Choice{node, plane, std::move(*halves), score};
    }
  }
}

// Adds a node for each half, in front first, with their arcs.
void CycleDivision::addHalves(std::uint32_t node, const Plane& plane, const ShapeHalves& halves) {
  const double surface = halves.front.surface + halves.behind.surface;
  const double share = surface > 0.0 ? halves.front.surface / surface : 0.5;
  const double weight = graph_[node].weight;
  const std::uint32_t front = graph_.add(weight * share, halves.front.surface);
  const std::uint32_t behind = graph_.add(weight * (1.0 - share), halves.behind.surface);
  const Placement& placement = placementOf(node);
  const std::pair<std::uint32_t, std::vector<ConvexSet>> both[] = {
      {front, halves.front.placed(placement, limits_.erosion)},
      {behind, halves.behind.placed(placement, limits_.erosion)}};
  // What a half occludes, the whole does. Pieces of one part, which touch, keep the arcs of their whole.
  for (const std::uint32_t other : graph_[node].behind) {
    for (const auto& [half, sets] : both) {
      if (graph_[other].alive && (areOfOnePart(other, node) || occlusion_.occludes(sets, sets_[other]))) {
        graph_.addArc(half, other);
      }
    }
  }
  for (const std::uint32_t other : graph_[node].in_front) {
    for (const auto& [half, sets] : both) {
      if (graph_[other].alive && (areOfOnePart(other, node) || occlusion_.occludes(sets_[other], sets))) {
        graph_.addArc(other, half);
      }
    }
  }
  addArcsOfHalves(front, behind, plane, placement);
}

// The halves touch, so the one on an eye's side of the plane occludes the other.
void CycleDivision::addArcsOfHalves(std::uint32_t front, std::uint32_t behind, const Plane& plane,
                                    const Placement& p) {
  bool eye_in_front = false, eye_behind = false;
  const Vec3d of_x = cross(p.y, p.z), of_y = cross(p.z, p.x), of_z = cross(p.x, p.y);
  const double determinant = dot(p.x, of_x);
  for (const Vec3d& eye : eyes_) {
    const Vec3d from = eye - p.origin;
    const Vec3d in_part = Vec3d(dot(from, of_x), dot(from, of_y), dot(from, of_z)) / determinant;
    const double height = plane.evaluate(in_part);
    const double room = 1e-9 * (l1Norm(in_part) + std::abs(plane.offset));
    eye_in_front = eye_in_front || !(height < -room);
    eye_behind = eye_behind || !(height > room);
  }
  if (eye_in_front) {
    graph_.addArc(front, behind);
  }
  if (eye_behind) {
    graph_.addArc(behind, front);
  }
}

// The pieces that are added if a node is divided: a whole part is none itself.
std::uint32_t CycleDivision::piecesOf(std::uint32_t node) const {
  return node < members_.size() && !members_[node].is_piece ? 2 : 1;
}

void CycleDivision::apply(Choice choice) {
  const DivisionCut cut{choice.node, graph_.size(), graph_.size() + 1, choice.plane};
  addHalves(choice.node, choice.plane, choice.halves);
  for (PartShape* const half : {&choice.halves.front, &choice.halves.behind}) {
    member_of_.push_back(member_of_[choice.node]);
    parent_of_.push_back(choice.node);
    cuts_left_.push_back(cuts_left_[choice.node] - 1);
    shapes_.emplace_back(std::move(*half));
    sets_.push_back(shapes_.back()->placed(placementOf(choice.node), limits_.erosion));
  }
  graph_[choice.node].alive = false;
  pieces_ += piecesOf(cut.node);
  cuts_.push_back(cut);
}

void CycleDivision::setDivided(const DivisionCut& cut, bool divided) {
  graph_[cut.node].alive = !divided;
  graph_[cut.front].alive = graph_[cut.behind].alive = divided;
  pieces_ = divided ? pieces_ + piecesOf(cut.node) : pieces_ - piecesOf(cut.node);
}

// A node that lives again lacks the arcs of those that were made after it was divided.
void CycleDivision::completeArcs(std::uint32_t node, std::uint32_t first_later) {
  const std::vector<ConvexSet>& own = sets_[node];
  for (std::uint32_t other = first_later; other < graph_.size(); ++other) {
    if (!graph_[other].alive) {
      continue;
    }
    if (areOfOnePart(node, other)) {
      copyArc(node, other);
      continue;
    }
    if (occlusion_.occludes(own, sets_[other])) {
      graph_.addArc(node, other);
    }
    if (occlusion_.occludes(sets_[other], own)) {
      graph_.addArc(other, node);
    }
  }
}

bool CycleDivision::areOfOnePart(std::uint32_t a, std::uint32_t b) const {
  return members_[member_of_[a]].part == members_[member_of_[b]].part;
}

// Between pieces of one part: the arc that the node has to a whole of the other.
void CycleDivision::copyArc(std::uint32_t node, std::uint32_t other) {
  const auto has = [](const std::vector<std::uint32_t>& list, std::uint32_t whole) {
    return std::find(list.begin(), list.end(), whole) != list.end();
  };
  for (std::uint32_t whole = parent_of_[other]; whole != kNoNode; whole = parent_of_[whole]) {
    const bool behind = has(graph_[node].behind, whole), in_front = has(graph_[node].in_front, whole);
    if (behind) {
      graph_.addArc(node, other);
    }
    if (in_front) {
      graph_.addArc(other, node);
    }
    if (behind || in_front) {
      return;
    }
  }
}

// Takes back the cuts, the last one first, without which the group falls apart as far.
void CycleDivision::takeBackInVain(double enough) {
  for (std::size_t i = cuts_.size(); i-- > 0;) {
    const DivisionCut cut = cuts_[i];
    if (!graph_[cut.front].alive || !graph_[cut.behind].alive) {
      continue;  // a half is divided
    }
    setDivided(cut, false);
    completeArcs(cut.node, cut.behind + 1);
    if (graph_.score().nodes <= enough) {
      cuts_.erase(cuts_.begin() + static_cast<std::ptrdiff_t>(i));
    } else {
      setDivided(cut, true);
    }
  }
}

}  // namespace sightline::layers
