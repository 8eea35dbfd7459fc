#pragma once

// How a box is best divided into several, as far as the cells of a grid say.

#include <array>
#include <cstdint>

#include "sightline/scene/object_boxes.h"
#include "src/scene/cell_grid.h"

namespace sightline::scene {

struct DivisionSettings {
  std::uint32_t max_boxes = kMaxObjectBoxes;  // at most kMaxObjectBoxes
  double min_saving = 0.0;         // what one more box has to save: a share of the whole box, by volume
  std::uint32_t max_divided = 15;  // so many boxes are divided; at most DivisionTree::kMaxDivided
};

// A box, its halves, their halves, and which of those divisions to keep.
struct DivisionTree {
  static constexpr std::uint32_t kMaxDivided = 31;

  struct Node {
    std::uint32_t first_half = 0;  // the other one follows; 0: it is not divided
    int axis = 0;
    float plane = 0.0f;  // where it is divided
    // By number of boxes: the least volume of so many boxes that hold what this one holds, and how many of
    // them are in the first half; 0: it is one box.
    std::array<float, kMaxObjectBoxes + 1> min_volume{};
    std::array<std::uint8_t, kMaxObjectBoxes + 1> in_first{};
  };

  std::array<Node, 2 * kMaxDivided + 1> nodes{};  // the first one is the root
  std::uint32_t node_count = 0;
  std::uint32_t boxes = 1;  // so many are best; 1 if nothing saves as much as a box costs, or is marked
  float cost = 0.0f;        // their volume, and what all but one of them cost
};

// Divides the marked cells of a grid, again and again, and then chooses which of the divisions to keep.
// Every instruction set gives the same tree.
void findDivisions(const CellGrid& grid, const DivisionSettings& settings, DivisionTree& tree);

}  // namespace sightline::scene
