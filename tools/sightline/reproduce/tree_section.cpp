#include "tools/sightline/reproduce/tree_section.h"

#include <algorithm>
#include <cmath>

namespace sightline::tool {
namespace {

// Follows the tree down, with the part of the paper that is left.
class Sectioning {
 public:
  Sectioning(const TreeShape& tree, const SectionPlane& plane, TreeSection& out)
      : tree_(tree), plane_(plane), out_(out) {}

  void visit(const TreePlace& place, const SectionPolygon& region) {
    const TreeBranch branch = tree_.at(place);
    if (region.empty() || branch.kind == TreeBranch::Kind::kOutside) {
      return;
    }
    if (branch.kind != TreeBranch::Kind::kNode) {
      LeafRegion leaf{place, branch, region};
      if (branch.kind == TreeBranch::Kind::kShadow) {
        leaf.shadow = partBehind(region, lineOf(plane_, tree_.leaves[branch.index].support));
      }
      out_.leaves.push_back(std::move(leaf));
      return;
    }
    const TreeShapeNode& node = tree_.nodes[branch.index];
    const SectionLine line = lineOf(plane_, node.plane);
    NodeTrace trace{branch.index};
    if (branch.index >= tree_.frustum_nodes && pieceWithin(region, line, trace.from, trace.to)) {
      out_.traces.push_back(trace);
    }
    visit({branch.index, false}, partBehind(region, line));
    visit({branch.index, true}, partBehind(region, line.flipped()));
  }

 private:
  const TreeShape& tree_;
  const SectionPlane& plane_;
  TreeSection& out_;
};

}  // namespace

SectionPlane planSection() {
  return {{}, {1.0, 0.0, 0.0}, {0.0, 0.0, 1.0}};
}

SectionPlane imageSection(const View& view) {
  return {view.forward, view.right, -view.up};
}

SectionLine lineOf(const SectionPlane& section, const Plane& plane) {
  return {dot(plane.normal, section.right), dot(plane.normal, section.up), plane.evaluate(section.origin)};
}

SectionPolygon partBehind(const SectionPolygon& polygon, const SectionLine& line) {
  SectionPolygon part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const SvgPoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double at_p = line.at(p), at_q = line.at(q);
    if (at_p <= 0.0) {
      part.push_back(p);
    }
    if ((at_p < 0.0 && at_q > 0.0) || (at_p > 0.0 && at_q < 0.0)) {
      const double t = at_p / (at_p - at_q);
      part.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
    }
  }
  return part.size() < 3 ? SectionPolygon{} : part;
}

bool pieceWithin(const SectionPolygon& polygon, const SectionLine& line, SvgPoint& from, SvgPoint& to) {
  std::vector<SvgPoint> ends;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const SvgPoint &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double at_p = line.at(p), at_q = line.at(q);
    if ((at_p <= 0.0) != (at_q <= 0.0)) {
      const double t = at_p / (at_p - at_q);
      ends.push_back({p.x + t * (q.x - p.x), p.y + t * (q.y - p.y)});
    }
  }
  if (ends.size() < 2) {
    return false;
  }
  from = ends[0];
  to = ends[1];
  return true;
}

SvgPoint middleOf(const SectionPolygon& polygon) {
  SvgPoint sum;
  for (const SvgPoint& p : polygon) {
    sum.x += p.x;
    sum.y += p.y;
  }
  const auto corners = static_cast<double>(polygon.size());
  return {sum.x / corners, sum.y / corners};
}

TreeSection sectionOf(const TreeShape& tree, const SectionPlane& section, const SectionPolygon& paper) {
  TreeSection out;
  out.view = paper;
  for (std::uint32_t i = 0; i < tree.frustum_nodes; ++i) {
    out.view = partBehind(out.view, lineOf(section, tree.nodes[i].plane));
  }
  Sectioning(tree, section, out).visit({}, paper);
  return out;
}

}  // namespace sightline::tool
