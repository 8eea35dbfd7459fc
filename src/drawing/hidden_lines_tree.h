#pragma once

// Trees over boxes on the screen, each with the reciprocal depth of the nearest thing in it: what may hide a
// line is found without looking at what lies beside it or behind it.

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
  void widen();  // by more than the rounding of its corners
};

// A line on the screen.
struct ScreenLine {
  ScreenPoint from, to;

  // The part of the line over the box, shares on the screen; false: none, or all of it is nearer than what is
  // in the box.
  bool meets(const HidingBox& box, double& first, double& last) const;
};

class HidingTrees {
 public:
  struct Item {
    HidingBox box;
    std::uint32_t id = 0;
  };
  static constexpr std::uint32_t kNoTree = 0xffffffffu;

  void clear();
  // Returns the new tree's root. items: reordered.
  std::uint32_t add(std::span<Item> items);
  const HidingBox& box(std::uint32_t root) const { return nodes_[root].box; }

  // Calls visit(id) for what may hide the line, roughly from near to far. skip(first, last): whether nothing
  // needs to be known of this part of the line, screen shares; asked again and again.
  template <typename Skip, typename Visit>
  void walk(std::uint32_t root, const ScreenLine& line, const Skip& skip, const Visit& visit) const {
    std::array<std::uint32_t, 64> waiting;  // halves at every step: 32 would do
    std::size_t count = 0;
    waiting[count++] = root;
    while (count > 0) {
      const Node& node = nodes_[waiting[--count]];
      double first = 0.0;
      double last = 1.0;
      if (!line.meets(node.box, first, last) || skip(first, last)) {
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
    std::uint32_t first = 0;  // leaves: into ids_; inner nodes: the second child; the first one follows
    std::uint32_t count = 0;  // 0: an inner node
  };
  static constexpr std::size_t kLeaf = 4;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> ids_;
};

}  // namespace sightline::drawing
