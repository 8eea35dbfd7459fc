#pragma once

// Draws binary trees as circles and squares below each other.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sightline/comparison/tree_shape.h"
#include "tools/sightline/report/svg_canvas.h"

namespace sightline::tool {

inline constexpr std::uint32_t kNoChild = 0xffffffffu;

struct DiagramNode {
  std::string label{};
  SvgPaint paint{};
  bool square = false;
  std::array<std::uint32_t, 2> children{kNoChild, kNoChild};  // left, right; both or none
};

struct DiagramPlace {
  SvgPoint corner{}, size{};  // the rectangle that the diagram fills
  double radius = 11.0;       // of a node, if there is room
  // Words at the branches of the root; empty: none.
  std::string left{}, right{};
};

// nodes[0] is the root.
void drawDiagram(SvgCanvas& canvas, const std::vector<DiagramNode>& nodes, const DiagramPlace& place);

// Labels of the nodes of an occlusion tree: a, b, c ... from the root down, what is behind a node before what
// is in front of it; none for the frustum's. A node that repeats a plane has the letter of the node above
// that has it, with a stroke. So trees with and without such nodes agree.
std::vector<std::string> lettersOf(const TreeShape& tree);

// The diagram of an occlusion tree below the frustum's planes: what is behind a plane is on the left. Leaves
// are squares: grey ones with the occluder's letter (A is OccluderId 0) in shadow, white ones not.
std::vector<DiagramNode> diagramOf(const TreeShape& tree, const std::vector<std::string>& letters);

}  // namespace sightline::tool
