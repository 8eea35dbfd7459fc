#pragma once

// A flat section through an occlusion tree: the regions of its leaves and the traces of its planes, in plan
// or as the eye sees them.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/comparison/tree_shape.h"
#include "tools/sightline/report/svg_canvas.h"

namespace sightline::tool {

// The plane of a section. Its point (x, y) is `origin + x * right + y * up`, relative to the eye, in metres.
struct SectionPlane {
  Vec3d origin{}, right{}, up{};
};
// Horizontal, through the eye: x is +x of the scene, y is +z, so that north, -z, is up on paper.
SectionPlane planSection();
// One metre before the eye, as the eye sees it: y grows downwards, as on paper.
SectionPlane imageSection(const View& view);

// The line in which the section cuts a plane: `a x + b y + c` is the plane's value there.
struct SectionLine {
  double a = 0.0, b = 0.0, c = 0.0;

  double at(const SvgPoint& p) const { return a * p.x + b * p.y + c; }
  SectionLine flipped() const { return {-a, -b, -c}; }
};
SectionLine lineOf(const SectionPlane& section, const Plane& plane);

using SectionPolygon = std::vector<SvgPoint>;  // convex
// The part of a polygon that is behind the line, where its value is at most 0; empty if there is none.
SectionPolygon partBehind(const SectionPolygon& polygon, const SectionLine& line);
// The ends of the piece of a line within a polygon. False: the line misses it.
bool pieceWithin(const SectionPolygon& polygon, const SectionLine& line, SvgPoint& from, SvgPoint& to);
// The mean of the corners. Precondition: there is one.
SvgPoint middleOf(const SectionPolygon& polygon);

// The part of the section that the path to a leaf leaves over.
struct LeafRegion {
  TreePlace place{};
  TreeBranch leaf{};
  SectionPolygon region{};
  // Of a leaf in shadow: the part behind its occluder. In a section as the eye sees it, that is all of it.
  SectionPolygon shadow{};
};
// The piece of a node's plane within the node's region.
struct NodeTrace {
  std::uint32_t node = 0;
  SvgPoint from{}, to{};
};

struct TreeSection {
  SectionPolygon view{};  // the part of `paper` in the view's frustum
  std::vector<LeafRegion> leaves{};
  std::vector<NodeTrace> traces{};
};
// paper: the part of the section's plane that is looked at. Regions outside the frustum are left out.
TreeSection sectionOf(const TreeShape& tree, const SectionPlane& section, const SectionPolygon& paper);

}  // namespace sightline::tool
