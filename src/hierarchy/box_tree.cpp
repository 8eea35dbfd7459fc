// Based on: Goldsmith, Salmon. Automatic Creation of Object Hierarchies for Ray Tracing. IEEE Computer
// Graphics and Applications 1987. Objects are inserted one after the other, each where it increases
// the cost of the tree by the smallest amount,
//
//   cost = sum over inner nodes of area(node) * children(node),
//
// the boxes that a ray through the scene is expected to be compared with. An object becomes one more child of
// an inner node, or makes a pair with a leaf. On the way down, the child with the smallest growth of area is
// followed.
//
// Differs from the paper in: a node has at most kMaxChildren children, or equal boxes would all be children
// of one; the order of insertion is a fixed random one, not the best of several; below kCostLevels levels the
// child with the fewest objects is followed, so that no input makes a deep tree.

#include "sightline/hierarchy/box_tree.h"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "src/math/infinite_box.h"

namespace sightline {
namespace {

constexpr std::uint32_t kMaxChildren = 8;
constexpr std::uint32_t kCostLevels = 48;
constexpr std::uint32_t kNone = 0xffffffffu;

// In double precision throughout: no finite box's area is infinite.
double areaOf(const Box& box) {
  const Vec3d e = Vec3d(box.max) - Vec3d(box.min);
  return e.x * e.y + e.y * e.z + e.z * e.x;
}

Box both(Box a, const Box& b) {
  a.extend(b);
  return a;
}

class Inserter {
 public:
  // A leaf has no children.
  struct Node {
    Box bounds;
    ObjectId object;  // leaf
    std::uint32_t objects = 1;
    std::uint32_t child_count = 0;
    std::array<std::uint32_t, kMaxChildren> children{};
  };

  explicit Inserter(std::size_t object_count) { nodes_.reserve(2 * object_count); }

  void insert(const Box& box, ObjectId object) {
    const auto leaf = static_cast<std::uint32_t>(nodes_.size());
    nodes_.push_back({.bounds = box, .object = object});
    if (leaf == 0) {
      root_ = leaf;
    } else if (nodes_[root_].child_count == 0) {
      root_ = pair(root_, leaf);
    } else {
      put(leaf, cheapestPlace(box));
    }
  }

  const std::vector<Node>& nodes() const { return nodes_; }
  std::uint32_t root() const { return root_; }

 private:
  // Below the inner node path_[level]: as one more child, or in a pair with its child number `slot`.
  struct Place {
    std::size_t level = 0;
    std::uint32_t slot = kNone;
    double cost = std::numeric_limits<double>::infinity();
  };

  // Fills path_, the nodes that were looked at.
  Place cheapestPlace(const Box& box) {
    path_.clear();
    Place best;
    double above = 0.0;  // what the inner nodes on the way cost more for having grown
    for (std::uint32_t at = root_; at != kNone;) {
      const Node& node = nodes_[at];
      path_.push_back(at);
      const double grown = areaOf(both(node.bounds, box));
      above += (grown - areaOf(node.bounds)) * node.child_count;
      if (above >= best.cost) {
        break;
      }
      if (node.child_count < kMaxChildren) {
        take({path_.size() - 1, kNone, above + grown}, best);
      }
      at = path_.size() < kCostLevels ? nextByCost(node, box, above, best)
                                      : nextByCount(node, box, above, best);
    }
    return best;
  }

  static void take(const Place& place, Place& best) {
    if (place.cost < best.cost) {
      best = place;
    }
  }

  // The inner child with the smallest growth, of several the one with the fewest objects; kNone without inner
  // children.
  std::uint32_t nextByCost(const Node& node, const Box& box, double above, Place& best) const {
    std::uint32_t next = kNone;
    double min_growth = 0.0;
    for (std::uint32_t i = 0; i < node.child_count; ++i) {
      const Node& child = nodes_[node.children[i]];
      const double grown = areaOf(both(child.bounds, box));
      if (child.child_count == 0) {
        take({path_.size() - 1, i, above + 2.0 * grown}, best);
        continue;
      }
      const double growth = grown - areaOf(child.bounds);
      if (next == kNone || growth < min_growth ||
          (growth == min_growth && child.objects < nodes_[next].objects)) {
        next = node.children[i];
        min_growth = growth;
      }
    }
    return next;
  }

  // Fills one node after the other: as deep as the logarithm of the number of objects.
  std::uint32_t nextByCount(const Node& node, const Box& box, double above, Place& best) const {
    if (node.child_count < kMaxChildren) {
      return kNone;
    }
    std::uint32_t fewest = 0;
    for (std::uint32_t i = 1; i < node.child_count; ++i) {
      if (nodes_[node.children[i]].objects < nodes_[node.children[fewest]].objects) {
        fewest = i;
      }
    }
    const Node& child = nodes_[node.children[fewest]];
    if (child.child_count != 0) {
      return node.children[fewest];
    }
    take({path_.size() - 1, fewest, above + 2.0 * areaOf(both(child.bounds, box))}, best);
    return kNone;
  }

  void put(std::uint32_t leaf, const Place& place) {
    for (std::size_t i = 0; i <= place.level; ++i) {
      nodes_[path_[i]].bounds.extend(nodes_[leaf].bounds);
      ++nodes_[path_[i]].objects;
    }
    const std::uint32_t at = path_[place.level];
    if (place.slot != kNone) {
      const std::uint32_t inner = pair(nodes_[at].children[place.slot], leaf);
      nodes_[at].children[place.slot] = inner;
    } else {
      nodes_[at].children[nodes_[at].child_count++] = leaf;
    }
  }

  std::uint32_t pair(std::uint32_t a, std::uint32_t b) {
    nodes_.push_back({.bounds = both(nodes_[a].bounds, nodes_[b].bounds),
                      .objects = 2,
                      .child_count = 2,
                      .children = {a, b}});
    return static_cast<std::uint32_t>(nodes_.size() - 1);
  }

  std::vector<Node> nodes_;
  std::uint32_t root_ = kNone;
  std::vector<std::uint32_t> path_;
};

// The objects with a box to go by, in the order in which they are inserted: the same on every machine.
std::vector<ObjectId> insertionOrder(std::span<const Box> bounds) {
  std::vector<ObjectId> order;
  for (std::uint32_t i = 0; i < bounds.size(); ++i) {
    if (bounds[i].wellFormed()) {
      order.push_back(ObjectId(i));
    }
  }
  std::uint64_t state = 1987;
  for (std::size_t i = order.size(); i > 1; --i) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    std::swap(order[i - 1], order[static_cast<std::size_t>((state >> 32) % i)]);
  }
  return order;
}

class Flattener {
 public:
  Flattener(std::span<const std::uint32_t> object_triangles, BoxTree& tree)
      : triangles_(object_triangles), tree_(tree) {}

  std::uint32_t begin(const Box& bounds) {
    tree_.nodes.push_back(
        {.bounds = bounds, .first_object = static_cast<std::uint32_t>(tree_.objects.size())});
    return static_cast<std::uint32_t>(tree_.nodes.size() - 1);
  }
  // Call this when all that lies below the node has been added.
  void finish(std::uint32_t node) {
    BoxNode& n = tree_.nodes[node];
    n.end = static_cast<std::uint32_t>(tree_.nodes.size());
    n.object_count = static_cast<std::uint32_t>(tree_.objects.size()) - n.first_object;
    std::uint64_t sum = n.triangles;
    for (std::uint32_t child = node + 1; child < n.end; child = tree_.nodes[child].end) {
      sum += tree_.nodes[child].triangles;
    }
    n.triangles = static_cast<std::uint32_t>(std::min<std::uint64_t>(sum, 0xffffffffu));
  }
  void leaf(const Box& bounds, ObjectId object) {
    const std::uint32_t node = begin(bounds);
    tree_.objects.push_back(object);
    tree_.nodes[node].triangles = triangles_.empty() ? 1 : triangles_[object.value];
    finish(node);
  }

  void all(const Inserter& inserted) {
    struct Entry {
      std::uint32_t node;
      std::uint32_t started;  // its number in the flat tree, when its children are done; else kNone
    };
    std::vector<Entry> stack{{inserted.root(), kNone}};
    while (!stack.empty()) {
      const Entry entry = stack.back();
      stack.pop_back();
      const Inserter::Node& node = inserted.nodes()[entry.node];
      if (entry.started != kNone) {
        finish(entry.started);
      } else if (node.child_count == 0) {
        leaf(node.bounds, node.object);
      } else {
        stack.push_back({entry.node, begin(node.bounds)});
        for (std::uint32_t i = node.child_count; i-- > 0;) {
          stack.push_back({node.children[i], kNone});
        }
      }
    }
  }

 private:
  std::span<const std::uint32_t> triangles_;
  BoxTree& tree_;
};

}  // namespace

BoxTree buildBoxTree(std::span<const Box> object_bounds, std::span<const std::uint32_t> object_triangles) {
  BoxTree tree;
  const std::vector<ObjectId> order = insertionOrder(object_bounds);
  Inserter inserter(order.size());
  for (const ObjectId object : order) {
    inserter.insert(object_bounds[object.value], object);
  }
  Flattener flat(object_triangles, tree);
  const bool any_broken = order.size() < object_bounds.size();
  // A lone object without a proper box is a root and a leaf in one.
  const bool own_root = any_broken && object_bounds.size() > 1;
  if (own_root) {
    flat.begin(math::infiniteBox());
  }
  if (!order.empty()) {
    flat.all(inserter);
  }
  for (std::uint32_t i = 0; any_broken && i < object_bounds.size(); ++i) {
    if (!object_bounds[i].wellFormed()) {
      flat.leaf(math::infiniteBox(), ObjectId(i));
    }
  }
  if (own_root) {
    flat.finish(0);
  }
  return tree;
}

}  // namespace sightline
