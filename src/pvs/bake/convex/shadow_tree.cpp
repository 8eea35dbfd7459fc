#include "src/pvs/bake/convex/shadow_tree.h"

#include <algorithm>
#include <array>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/pvs/bake/convex/shadow_tree.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace sightline::pvs {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// No fused operations: they would round differently on different instruction sets. A box's minimum and
// maximum over a plane have an error of at most 2^-50 of the reach, which the shadow's offset allows for.
class Traversal {
 public:
  Traversal(const ShadowTree::Arrays& tree, const Shadow& shadow, std::vector<ObjectRun>& runs)
      : tree_(tree), shadow_(shadow), runs_(runs), first_run_(runs.size()) {}

  // Visits the nodes first ... first + count - 1, whose parent is behind all planes except these.
  void visit(std::uint32_t first, std::uint32_t count, const std::uint8_t* planes,
             std::uint32_t plane_count) {
    const auto lanes = static_cast<std::uint32_t>(hn::Lanes(kLanes));
    for (std::uint32_t i = 0; i < count; i += lanes) {
      visitLanes(first + i, std::min(count - i, lanes), planes, plane_count);
    }
  }

 private:
  void visitLanes(std::uint32_t first, std::uint32_t count, const std::uint8_t* planes,
                  std::uint32_t plane_count) {
    std::array<std::uint8_t, kMaxShadowPlanes> behind;  // by plane: bits of the lanes that are behind it
    const std::uint32_t lit = classify(first, count, planes, plane_count, behind.data());
    for (std::uint32_t lane = 0; lane < count; ++lane) {
      if (((lit >> lane) & 1u) != 0) {
        continue;
      }
      std::array<std::uint8_t, kMaxShadowPlanes> left;
      std::uint32_t left_count = 0;
      for (std::uint32_t p = 0; p < plane_count; ++p) {
        left[left_count] = planes[p];
        left_count += ((behind[p] >> lane) & 1u) ^ 1u;
      }
      const ShadowTree::Node& node = tree_.nodes[first + lane];
      if (left_count == 0) {
        append(node.objects);
      } else if (node.child_count > 0) {
        visit(node.first_child, node.child_count, left.data(), left_count);
      }
    }
  }

  // Bits of the lanes with nothing below that is behind all planes: for some plane, no leaf reaches far
  // enough.
  std::uint32_t classify(std::uint32_t first, std::uint32_t count, const std::uint8_t* planes,
                         std::uint32_t plane_count, std::uint8_t* behind) const {
    const auto x = hn::Sub(hn::LoadU(kLanes, tree_.cx.data() + first), hn::Set(kLanes, shadow_.eye.x));
    const auto y = hn::Sub(hn::LoadU(kLanes, tree_.cy.data() + first), hn::Set(kLanes, shadow_.eye.y));
    const auto z = hn::Sub(hn::LoadU(kLanes, tree_.cz.data() + first), hn::Set(kLanes, shadow_.eye.z));
    const auto hx = hn::LoadU(kLanes, tree_.hx.data() + first);
    const auto hy = hn::LoadU(kLanes, tree_.hy.data() + first);
    const auto hz = hn::LoadU(kLanes, tree_.hz.data() + first);
    const auto rx = hn::LoadU(kLanes, tree_.rx.data() + first);
    const auto ry = hn::LoadU(kLanes, tree_.ry.data() + first);
    const auto rz = hn::LoadU(kLanes, tree_.rz.data() + first);
    auto lit = hn::Not(hn::FirstN(kLanes, count));
    for (std::uint32_t i = 0; i < plane_count; ++i) {
      const std::uint8_t p = planes[i];
      const auto nx = hn::Set(kLanes, shadow_.nx[p]), ny = hn::Set(kLanes, shadow_.ny[p]);
      const auto nz = hn::Set(kLanes, shadow_.nz[p]), offset = hn::Set(kLanes, shadow_.offset[p]);
      const auto middle = hn::Add(hn::Add(hn::Mul(nx, x), hn::Mul(ny, y)), hn::Mul(nz, z));
      const auto ax = hn::Abs(nx), ay = hn::Abs(ny), az = hn::Abs(nz);
      const auto half = hn::Add(hn::Add(hn::Mul(ax, hx), hn::Mul(ay, hy)), hn::Mul(az, hz));
      const auto room = hn::Add(hn::Add(hn::Mul(ax, rx), hn::Mul(ay, ry)), hn::Mul(az, rz));
      lit = hn::Or(lit, hn::Lt(hn::Add(middle, room), offset));
      if (hn::AllTrue(kLanes, lit)) {
        break;
      }
      behind[i] = bitsOf(hn::Ge(hn::Sub(middle, half), offset));
    }
    return bitsOf(lit);
  }

  using Lanes = hn::CappedTag<double, 8>;
  static std::uint8_t bitsOf(hn::Mask<Lanes> mask) {
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(Lanes(), mask, bits);
    return bits[0];
  }

  void append(const ObjectRun& run) {
    if (runs_.size() > first_run_ && runs_.back().end == run.begin) {
      runs_.back().end = run.end;
    } else {
      runs_.push_back(run);
    }
  }

  static constexpr Lanes kLanes{};
  const ShadowTree::Arrays& tree_;
  const Shadow& shadow_;
  std::vector<ObjectRun>& runs_;
  std::size_t first_run_;
};

// The lanes, from this node on, that are behind all planes. The operations and their order are those of
// Traversal::classify().
template <class D>
hn::Mask<D> behindAll(D d, const ShadowTree::Arrays& tree, const Shadow& shadow, std::uint32_t node) {
  const auto x = hn::Sub(hn::LoadU(d, tree.cx.data() + node), hn::Set(d, shadow.eye.x));
  const auto y = hn::Sub(hn::LoadU(d, tree.cy.data() + node), hn::Set(d, shadow.eye.y));
  const auto z = hn::Sub(hn::LoadU(d, tree.cz.data() + node), hn::Set(d, shadow.eye.z));
  const auto hx = hn::LoadU(d, tree.hx.data() + node), hy = hn::LoadU(d, tree.hy.data() + node);
  const auto hz = hn::LoadU(d, tree.hz.data() + node);
  auto behind = hn::FirstN(d, shadow.count == 0 ? 0 : hn::Lanes(d));  // a shadow without planes hides nothing
  for (std::uint32_t p = 0; p < shadow.count && !hn::AllFalse(d, behind); ++p) {
    const auto nx = hn::Set(d, shadow.nx[p]), ny = hn::Set(d, shadow.ny[p]), nz = hn::Set(d, shadow.nz[p]);
    const auto middle = hn::Add(hn::Add(hn::Mul(nx, x), hn::Mul(ny, y)), hn::Mul(nz, z));
    const auto half =
        hn::Add(hn::Add(hn::Mul(hn::Abs(nx), hx), hn::Mul(hn::Abs(ny), hy)), hn::Mul(hn::Abs(nz), hz));
    behind = hn::And(behind, hn::Ge(hn::Sub(middle, half), hn::Set(d, shadow.offset[p])));
  }
  return behind;
}

void traverse(const ShadowTree::Arrays& tree, const Shadow& shadow, std::vector<ObjectRun>& runs) {
  std::array<std::uint8_t, kMaxShadowPlanes> planes;
  for (std::uint32_t p = 0; p < shadow.count; ++p) {
    planes[p] = static_cast<std::uint8_t>(p);
  }
  if (shadow.count > 0 && !tree.nodes.empty()) {
    Traversal(tree, shadow, runs).visit(0, 1, planes.data(), shadow.count);
  }
}

std::uint32_t hiddenNodes(const ShadowTree::Arrays& tree, std::span<const Shadow> shadows,
                          std::uint32_t first, std::uint32_t count) {
  const hn::CappedTag<double, ShadowTree::kGroup> d;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(d));
  std::uint32_t bits = 0;
  for (std::uint32_t i = 0; i < count; i += lanes) {
    const std::uint32_t at = first + i;
    auto behind = hn::FirstN(d, std::min(count - i, lanes));
    for (std::size_t s = 0; s < shadows.size() && !hn::AllFalse(d, behind); ++s) {
      behind = hn::And(behind, behindAll(d, tree, shadows[s], at));
    }
    std::uint8_t some[8] = {};
    hn::StoreMaskBits(d, behind, some);
    bits |= std::uint32_t{some[0]} << i;
  }
  return bits;
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::pvs
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace sightline::pvs {
namespace {

HWY_EXPORT(traverse);
HWY_EXPORT(hiddenNodes);

constexpr std::size_t kMinChildren = 8;  // inner nodes are dissolved until there are about this many
// At this depth, a node's children are all its leaves, which bounds the recursion.
constexpr std::uint32_t kMaxDepth = 64;
constexpr std::size_t kPadding = 8;  // lanes
// Inner nodes are wider by this fraction of the reach. The test of a node and that of a leaf below it round
// by less than half as much together, so neither a node that is taken as hidden nor one that is left out as
// seen ever contradicts the test of the leaf.
constexpr double kNodeMargin = 0x1p-46;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr CellBox kNoPoints{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};

void extend(CellBox& box, const CellBox& by) {
  box = {min(box.min, by.min), max(box.max, by.max)};
}

// True for nodes that are malformed or have a malformed node below them.
std::vector<bool> brokenNodes(const BoxTreeView& tree) {
  std::vector<bool> broken(tree.nodes.size());
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    bool all_well = tree.nodes[i].bounds.wellFormed();
    for (std::uint32_t child = static_cast<std::uint32_t>(i) + 1; child < tree.nodes[i].end;
         child = tree.nodes[child].end) {
      all_well = all_well && !broken[child];
    }
    broken[i] = !all_well;
  }
  return broken;
}

std::vector<std::uint32_t> childrenOf(const BoxTreeView& tree, std::uint32_t node) {
  std::vector<std::uint32_t> children;
  for (std::uint32_t child = node + 1; child < tree.nodes[node].end; child = tree.nodes[child].end) {
    children.push_back(child);
  }
  return children;
}

// Replaces the largest inner nodes by their children while there are few children. Keeps their order.
void widen(const BoxTreeView& tree, std::vector<std::uint32_t>& children) {
  while (children.size() < kMinChildren) {
    double largest = -1.0;
    std::size_t chosen = children.size();
    for (std::size_t i = 0; i < children.size(); ++i) {
      const double area = surfaceArea(tree.nodes[children[i]].bounds);
      if (!tree.leaf(children[i]) && !(area <= largest)) {
        largest = area;
        chosen = i;
      }
    }
    if (chosen == children.size()) {
      return;
    }
    const std::vector<std::uint32_t> below = childrenOf(tree, children[chosen]);
    if (children.size() - 1 + below.size() > kMinChildren) {
      return;
    }
    const auto at = children.erase(children.begin() + static_cast<std::ptrdiff_t>(chosen));
    children.insert(at, below.begin(), below.end());
  }
}

std::vector<std::uint32_t> leavesBelow(const BoxTreeView& tree, std::uint32_t node) {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t i = node + 1; i < tree.nodes[node].end; ++i) {
    if (tree.leaf(i)) {
      leaves.push_back(i);
    }
  }
  return leaves;
}

// The data of a node's box in the shadow tree.
struct NodeBox {
  Vec3d centre, half, room;
};

// Boxes by node. A malformed node, or one with a malformed node below it, counts as an unbounded box.
std::vector<NodeBox> nodeBoxes(const BoxTreeView& tree, double reach) {
  const Vec3d infinite(kInfinity, kInfinity, kInfinity);
  const std::vector<bool> broken = brokenNodes(tree);
  std::vector<NodeBox> boxes(tree.nodes.size(), NodeBox{{}, infinite, infinite});
  // Minimum half extents of the leaves below that may be hidden.
  std::vector<Vec3d> min_half(tree.nodes.size(), infinite);
  for (std::size_t i = tree.nodes.size(); i-- > 0;) {
    const auto node = static_cast<std::uint32_t>(i);
    NodeBox& box = boxes[i];
    if (!broken[i]) {
      const Vec3d low(tree.nodes[i].bounds.min), high(tree.nodes[i].bounds.max);
      box.centre = center(tree.nodes[i].bounds);
      box.half = max(high - box.centre, box.centre - low) * (1.0 + 0x1p-50);
      min_half[i] = tree.leaf(node) ? box.half : min_half[i];
    }
    for (std::uint32_t child = node + 1; child < tree.nodes[i].end; child = tree.nodes[child].end) {
      min_half[i] = min(min_half[i], min_half[child]);
    }
    if (!broken[i]) {
      const double margin = tree.leaf(node) ? 0.0 : kNodeMargin * reach;
      box.half += Vec3d{margin, margin, margin};
      box.room = box.half - min_half[i] * 2.0;
    }
  }
  return boxes;
}

}  // namespace

ShadowTree::ShadowTree(const BoxTreeView& tree, double reach) {
  if (tree.nodes.empty()) {
    return;
  }
  const std::vector<NodeBox> boxes = nodeBoxes(tree, reach);
  std::vector<std::uint32_t> from{0}, depth{0};  // by new index: the old index and the depth
  for (std::size_t i = 0; i < from.size(); ++i) {
    const BoxNode& old = tree.nodes[from[i]];
    std::vector<std::uint32_t> children;
    if (depth[i] + 1 < kMaxDepth) {
      children = childrenOf(tree, from[i]);
      widen(tree, children);
    } else {
      children = leavesBelow(tree, from[i]);
    }
    arrays_.nodes.push_back({static_cast<std::uint32_t>(from.size()),
                             static_cast<std::uint32_t>(children.size()),
                             {old.first_object, old.first_object + old.object_count}});
    depth.insert(depth.end(), children.size(), depth[i] + 1);
    from.insert(from.end(), children.begin(), children.end());
  }
  const auto fill = [&](std::vector<double>& values, Vec3d NodeBox::*part, int axis) {
    values.reserve(from.size() + kPadding);
    for (const std::uint32_t node : from) {
      values.push_back((boxes[node].*part)[axis]);
    }
    values.resize(from.size() + kPadding, 0.0);
  };
  fill(arrays_.cx, &NodeBox::centre, 0);
  fill(arrays_.cy, &NodeBox::centre, 1);
  fill(arrays_.cz, &NodeBox::centre, 2);
  fill(arrays_.hx, &NodeBox::half, 0);
  fill(arrays_.hy, &NodeBox::half, 1);
  fill(arrays_.hz, &NodeBox::half, 2);
  fill(arrays_.rx, &NodeBox::room, 0);
  fill(arrays_.ry, &NodeBox::room, 1);
  fill(arrays_.rz, &NodeBox::room, 2);
  findCorners(tree, from);
  leaf_of_.resize(tree.objects.size());
  for (std::uint32_t i = 0; i < from.size(); ++i) {
    if (tree.leaf(from[i])) {
      leaf_of_[arrays_.nodes[i].objects.begin] = i;
    }
  }
}

void ShadowTree::findCorners(const BoxTreeView& tree, std::span<const std::uint32_t> from) {
  lowest_.resize(from.size(), kNoPoints);
  highest_.resize(from.size(), kNoPoints);
  for (std::size_t i = from.size(); i-- > 0;) {
    const Node& node = arrays_.nodes[i];
    if (node.child_count == 0 && mayBeHidden(static_cast<std::uint32_t>(i))) {
      const Vec3d low(tree.nodes[from[i]].bounds.min), high(tree.nodes[from[i]].bounds.max);
      lowest_[i] = {low, low};
      highest_[i] = {high, high};
    }
    for (std::uint32_t child = node.first_child; child < node.first_child + node.child_count; ++child) {
      extend(lowest_[i], lowest_[child]);
      extend(highest_[i], highest_[child]);
    }
  }
}

std::uint32_t ShadowTree::hidden(std::span<const Shadow> shadows, std::uint32_t first,
                                 std::uint32_t count) const {
  return HWY_DYNAMIC_DISPATCH(hiddenNodes)(arrays_, shadows, first, count);
}

void ShadowTree::hiddenBy(const Shadow& shadow, std::vector<ObjectRun>& runs) const {
  HWY_DYNAMIC_DISPATCH(traverse)(arrays_, shadow, runs);
}

}  // namespace sightline::pvs
#endif
