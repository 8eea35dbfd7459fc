#include "tools/sightline/reproduce/tree_diagram.h"

#include <algorithm>
#include <utility>

#include "tools/sightline/reproduce/figure_colors.h"

namespace sightline::tool {
namespace {

// Places nodes: leaves next to each other, a node above the middle of its children.
class Layout {
 public:
  explicit Layout(const std::vector<DiagramNode>& nodes)
      : nodes_(nodes), columns_(nodes.size()), rows_(nodes.size()) {
    visit(0, 0);
  }

  double column(std::uint32_t node) const { return columns_[node]; }
  std::uint32_t row(std::uint32_t node) const { return rows_[node]; }
  double columns() const { return leaves_; }
  std::uint32_t lastRow() const { return *std::max_element(rows_.begin(), rows_.end()); }

 private:
  void visit(std::uint32_t node, std::uint32_t row) {
    rows_[node] = row;
    const auto [left, right] = nodes_[node].children;
    if (left == kNoChild) {
      columns_[node] = leaves_ + 0.5;
      leaves_ += 1.0;
      return;
    }
    visit(left, row + 1);
    visit(right, row + 1);
    columns_[node] = 0.5 * (columns_[left] + columns_[right]);
  }

  const std::vector<DiagramNode>& nodes_;
  std::vector<double> columns_;
  std::vector<std::uint32_t> rows_;
  double leaves_ = 0.0;
};

std::string occluderLetter(OccluderId occluder) {
  return std::string(1, static_cast<char>('A' + occluder.value % 26));
}

bool samePlane(const Plane& a, const Plane& b) {
  return (a.normal == b.normal && a.offset == b.offset) || (a.normal == -b.normal && a.offset == -b.offset);
}

// Gives letters in the order of lettersOf().
class Lettering {
 public:
  explicit Lettering(const TreeShape& tree) : tree_(tree), letters_(tree.nodes.size()) {
    visit(tree.belowFrustum());
  }

  std::vector<std::string> take() && { return std::move(letters_); }

 private:
  void visit(TreeBranch branch) {
    if (branch.kind != TreeBranch::Kind::kNode) {
      return;
    }
    const TreeShapeNode& node = tree_.nodes[branch.index];
    letters_[branch.index] = node.repeated ? repeatedLetter(node) : std::string(1, next_);
    next_ = static_cast<char>(node.repeated ? next_ : next_ == 'z' ? 'a' : next_ + 1);
    path_.push_back(branch.index);
    visit(node.back);
    visit(node.front);
    path_.pop_back();
  }

  std::string repeatedLetter(const TreeShapeNode& node) const {
    for (const std::uint32_t above : path_) {
      if (samePlane(tree_.nodes[above].plane, node.plane)) {
        return letters_[above] + "'";
      }
    }
    return "'";  // a plane of the frustum
  }

  const TreeShape& tree_;
  std::vector<std::string> letters_;
  std::vector<std::uint32_t> path_;  // the nodes above
  char next_ = 'a';
};

std::uint32_t addBranch(const TreeShape& tree, const std::vector<std::string>& letters, TreeBranch branch,
                        std::vector<DiagramNode>& nodes) {
  const auto index = static_cast<std::uint32_t>(nodes.size());
  nodes.emplace_back();
  if (branch.kind != TreeBranch::Kind::kNode) {
    const bool in_shadow = branch.kind == TreeBranch::Kind::kShadow;
    nodes[index] = {.label = in_shadow ? occluderLetter(tree.leaves[branch.index].occluder) : "",
                    .paint = {.fill = in_shadow ? kInShadow : "#ffffff", .stroke = kInk},
                    .square = true};
    return index;
  }
  const TreeShapeNode& node = tree.nodes[branch.index];
  nodes[index] = {.label = letters[branch.index],
                  .paint = {.fill = "#ffffff",
                            .stroke = node.repeated ? kFlaggedInk : kInk,
                            .width = node.repeated ? 2.0 : 1.2,
                            .dashes = node.repeated ? "4 2" : ""}};
  const std::uint32_t left = addBranch(tree, letters, node.back, nodes);
  const std::uint32_t right = addBranch(tree, letters, node.front, nodes);
  nodes[index].children = {left, right};
  return index;
}

}  // namespace

void drawDiagram(SvgCanvas& canvas, const std::vector<DiagramNode>& nodes, const DiagramPlace& place) {
  if (nodes.empty()) {
    return;
  }
  const Layout layout(nodes);
  const double column = place.size.x / layout.columns();
  const double row = place.size.y / (layout.lastRow() + 1.0);
  const double radius = std::min({place.radius, 0.42 * column, 0.38 * row});
  const auto at = [&](std::uint32_t node) {
    return SvgPoint{place.corner.x + column * layout.column(node),
                    place.corner.y + row * (layout.row(node) + 0.5)};
  };
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    for (std::size_t side = 0; side < 2 && nodes[n].children[side] != kNoChild; ++side) {
      const SvgPoint from = at(n), to = at(nodes[n].children[side]);
      canvas.line(from, to, {.stroke = kInk, .width = 1.0});
      const std::string& words = side == 0 ? place.left : place.right;
      if (n == 0 && !words.empty()) {
        const SvgPoint middle{0.5 * (from.x + to.x) + (side == 0 ? -6.0 : 6.0), 0.5 * (from.y + to.y) - 4.0};
        canvas.text(middle, words,
                    {.size = 11.0,
                     .anchor = side == 0 ? SvgText::Anchor::kEnd : SvgText::Anchor::kStart,
                     .color = "#666666",
                     .italic = true});
      }
    }
  }
  for (std::uint32_t n = 0; n < nodes.size(); ++n) {
    const SvgPoint p = at(n);
    if (nodes[n].square) {
      canvas.rectangle({p.x - radius, p.y - radius}, {2.0 * radius, 2.0 * radius}, nodes[n].paint);
    } else {
      canvas.circle(p, radius, nodes[n].paint);
    }
    canvas.text(p, nodes[n].label, {.size = std::min(12.0, 1.25 * radius)});
  }
}

std::vector<std::string> lettersOf(const TreeShape& tree) {
  return Lettering(tree).take();
}

std::vector<DiagramNode> diagramOf(const TreeShape& tree, const std::vector<std::string>& letters) {
  std::vector<DiagramNode> nodes;
  addBranch(tree, letters, tree.belowFrustum(), nodes);
  return nodes;
}

}  // namespace sightline::tool
