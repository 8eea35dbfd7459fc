#pragma once

// Trees of boxes on the screen, each with the reciprocal depth of its nearest point: they find what may hide
// a line without visiting what lies beside or behind the line.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "src/drawing/line_view.h"

namespace sightline::drawing {

struct HidingBox {
  double min_x = 0.0, min_y = 0.0, max_x = 0.0, max_y = 0.0;  // screen
  double reciprocal_depth = 0.0;                              // of the nearest point, rounded up

  static HidingBox none();
  void extend(const ScreenPoint& point);
  void extend(const HidingBox& box);
  // Grows the box by more than the rounding of its corners, and of lines behind it up to 256 times as far
  // from the eye; lines farther away may be drawn beside its border. `reach` is how far the corners are from
  // the eye, in units of the screen: 1 in perspective.
  void widen(double reach);
};

// A line on the screen.
struct ScreenLine {
  ScreenPoint from, to;

  // Finds the part of the line over the box, as shares on the screen. False if there is none, or if all of it
  // is nearer than everything in the box.
  bool mayBeHiddenBy(const HidingBox& box, double& first, double& last) const;
};

class HidingTrees {
 public:
  struct Item {
    HidingBox box;
    std::uint32_t id = 0;
  };
  static constexpr std::uint32_t kNoTree = 0xffffffffu;

  void clear();
  // Adds a tree and returns its root. Reorders items.
  std::uint32_t add(std::span<Item> items);
  const HidingBox& box(std::uint32_t root) const { return nodes_[root].box; }

  // Calls visit(id) for each item that may hide the line, roughly from near to far. skip(first, last), called
  // for each box, returns whether this part of the line (shares on the screen) is of no further interest.
  template <typename Skip, typename Visit>
  void traverse(std::uint32_t root, const ScreenLine& line, const Skip& skip, const Visit& visit) const {
    std::array<std::uint32_t, 64> waiting;  // each level halves the items, so 32 would be enough
    std::size_t count = 0;
    waiting[count++] = root;
    while (count > 0) {
      const Node& node = nodes_[waiting[--count]];
      double first = 0.0;
      double last = 1.0;
      if (!line.mayBeHiddenBy(node.box, first, last) || skip(first, last)) {
        continue;
      }
      for (std::uint32_t i = node.first; i < node.first + node.count; ++i) {
        visit(ids_[i]);
      }
      if (node.count == 0) {
        const std::uint32_t left = static_cast<std::uint32_t>(&node - nodes_.data()) + 1;
        const bool left_first = nodes_[left].box.reciprocal_depth >= nodes_[node.first].box.reciprocal_depth;
        waiting[count++] = left_first ? node.first : left;
        waiting[count++] = left_first ? left : node.first;
      }
    }
  }

 private:
  struct Node {
    HidingBox box;
    // The first entry of a leaf in ids_, or the second child of an inner node (the first child follows it).
    std::uint32_t first = 0;
    std::uint32_t count = 0;  // a leaf's entries; 0 in inner nodes
  };
  static constexpr std::size_t kLeaf = 4;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace sightline::drawing
