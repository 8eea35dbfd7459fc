// Bittner, Havran and Slavik 1998, figures 1, 2, 7 and 8: occlusion trees of a few polygons. Planes, regions
// and answers are those of the trees that the library builds.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "sightline/occlusion/occlusion_tree.h"
#include "tools/sightline/reproduce/bittner.h"
#include "tools/sightline/reproduce/figure_colors.h"
#include "tools/sightline/reproduce/tree_diagram.h"
#include "tools/sightline/reproduce/tree_section.h"

namespace sightline::tool::bittner {
namespace {

using Polygons = std::vector<std::vector<Vec3f>>;

OccluderSet setOf(const Polygons& polygons) {
  std::vector<OccluderPolygon> given;
  for (const std::vector<Vec3f>& polygon : polygons) {
    given.push_back({polygon, true, ObjectId()});
  }
  return makeOccluders(given);
}

std::vector<OccluderId> allOf(const OccluderSet& set) {
  std::vector<OccluderId> ids;
  for (std::size_t i = 0; i < set.occluders.size(); ++i) {
    ids.push_back(OccluderId(i));
  }
  return ids;
}

// An eye at the origin that looks along -z.
View lookingNorth(double tan_half_fovy, double aspect) {
  View view;
  setOrientation(view, {0.0, 0.0, -1.0}, {0.0, 1.0, 0.0});
  view.tan_half_fovy = tan_half_fovy;
  view.aspect = aspect;
  view.z_near = 0.01;
  return view;
}

// Where a section lies on the canvas.
struct Sheet {
  SvgPoint eye{};       // where the section's origin is, pixels
  double scale = 40.0;  // pixels a metre

  SvgPoint operator()(const SvgPoint& p) const { return {eye.x + scale * p.x, eye.y + scale * p.y}; }
  SvgPoint operator()(const Vec3d& p) const { return (*this)(SvgPoint{p.x, p.z}); }  // in plan
  SectionPolygon operator()(const SectionPolygon& polygon) const {
    SectionPolygon placed;
    for (const SvgPoint& p : polygon) {
      placed.push_back((*this)(p));
    }
    return placed;
  }
};

void drawRegions(SvgCanvas& canvas, const TreeSection& section, const Sheet& sheet) {
  canvas.polygon(sheet(section.view), {.fill = kInView, .stroke = kDimInk, .width = 0.8, .dashes = "5 4"});
  for (const LeafRegion& leaf : section.leaves) {
    canvas.polygon(sheet(leaf.shadow), {.fill = kInShadow, .fill_opacity = 0.75});
  }
}

// Draws the traces of planes and their letters at one end: the far one, or at a share of the way.
void drawTraces(SvgCanvas& canvas, const TreeSection& section, const TreeShape& tree,
                const std::vector<std::string>& letters, const Sheet& sheet, double label_at) {
  for (const NodeTrace& trace : section.traces) {
    const bool repeated = tree.nodes[trace.node].repeated;
    const bool outwards = std::hypot(trace.from.x, trace.from.y) < std::hypot(trace.to.x, trace.to.y);
    const SvgPoint &near = outwards ? trace.from : trace.to, &far = outwards ? trace.to : trace.from;
    canvas.line(
        sheet(near), sheet(far),
        {.stroke = repeated ? kFlaggedInk : kPlaneInk, .width = 1.3, .dashes = repeated ? "4 3" : ""});
    const SvgPoint label{near.x + label_at * (far.x - near.x), near.y + label_at * (far.y - near.y)};
    canvas.circle(sheet(label), 8.5, {.fill = "#ffffff", .stroke = repeated ? kFlaggedInk : kPlaneInk});
    canvas.text(sheet(label), letters[trace.node], {.size = 11.0});
  }
}

void drawEye(SvgCanvas& canvas, const SvgPoint& at) {
  canvas.circle(at, 4.5, {.fill = kInk});
  canvas.text({at.x + 4.0, at.y + 18.0}, "viewpoint", {.anchor = SvgText::Anchor::kMiddle});
}

// Draws walls as they stand in plan, with their letters.
void drawWalls(SvgCanvas& canvas, const OccluderSet& set, const Sheet& sheet) {
  for (std::size_t i = 0; i < set.occluders.size(); ++i) {
    const auto corners = set.verticesOf(set.occluders[i]);
    const auto [west, east] = std::minmax_element(corners.begin(), corners.end(),
                                                  [](const Vec3f& a, const Vec3f& b) { return a.x < b.x; });
    canvas.line(sheet(Vec3d(*west)), sheet(Vec3d(*east)), {.stroke = kOccluderInk, .width = 4.0});
    const SvgPoint at = sheet((Vec3d(*west) + Vec3d(*east)) * 0.5);
    canvas.text({at.x, at.y + 14.0}, std::string(1, static_cast<char>('A' + i)),
                {.color = kOccluderInk, .bold = true});
  }
}

std::vector<Vec3f> wall(float x0, float z0, float x1, float z1) {
  constexpr float kTall = 40.0f;  // above and below all that is in view
  return {{x0, -kTall, z0}, {x1, -kTall, z1}, {x1, kTall, z1}, {x0, kTall, z0}};
}

SectionPolygon rectangle(double left, double top, double right, double bottom) {
  return {{left, top}, {right, top}, {right, bottom}, {left, bottom}};
}

// Looks at figure 1 from the east, from above and a little from behind.
struct SideView {
  SvgPoint eye{};
  double scale = 40.0;

  SvgPoint operator()(const Vec3d& p) const {
    const Vec3d along = normalized(Vec3d(-0.86, -0.34, -0.42));
    const Vec3d right = normalized(cross(along, Vec3d(0.0, 1.0, 0.0)));
    const Vec3d up = cross(right, along);
    return {eye.x + scale * dot(p, right), eye.y - scale * dot(p, up)};
  }
};

void drawVolume(SvgCanvas& canvas, const TreeShape& tree, const std::vector<std::string>& letters,
                const SideView& at) {
  const std::vector<Vec3d>& corners = tree.leaves.front().corners;
  constexpr double kFar = 2.1;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Vec3d &p = corners[i], &q = corners[(i + 1) % corners.size()];
    const std::vector<SvgPoint> side{at(p), at(q), at(q * kFar), at(p * kFar)};
    canvas.polygon(side, {.fill = kInShadow, .stroke = kPlaneInk, .width = 1.2, .fill_opacity = 0.45});
    canvas.line(at(Vec3d()), at(p), {.stroke = kPlaneInk, .width = 1.0, .dashes = "5 4"});
  }
  std::vector<SvgPoint> front;
  for (const Vec3d& p : corners) {
    front.push_back(at(p));
  }
  canvas.polygon(front, {.fill = kOccluderInk, .stroke = kOccluderInk, .width = 1.5, .fill_opacity = 0.75});
  const SvgPoint highest = *std::min_element(front.begin(), front.end(),
                                             [](const SvgPoint& a, const SvgPoint& b) { return a.y < b.y; });
  canvas.text({highest.x + 10.0, highest.y - 30.0}, "occluder, in its supporting plane",
              {.anchor = SvgText::Anchor::kEnd, .color = kOccluderInk});
  for (std::uint32_t n = tree.frustum_nodes; n < tree.nodes.size(); ++n) {
    // The side whose corners lie in the node's plane, and the way its normal points.
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3d &p = corners[i], &q = corners[(i + 1) % corners.size()];
      const Plane& plane = tree.nodes[n].plane;
      constexpr double kInPlane = 1e-6;
      if (std::abs(plane.evaluate(p)) < kInPlane && std::abs(plane.evaluate(q)) < kInPlane) {
        const Vec3d middle = (p + q) * (0.5 * 1.55);
        canvas.arrow(at(middle), at(middle + plane.normal * 0.7), kPlaneInk);
        const SvgPoint label = at(middle + plane.normal * 1.0);
        canvas.text(label, letters[n], {.size = 14.0, .color = kPlaneInk, .bold = true});
      }
    }
  }
  drawEye(canvas, at(Vec3d()));
}

ReportPicture pictureOf(const std::string& figure, std::uint32_t number, std::string caption) {
  ReportPicture picture;
  picture.file = figure + ".svg";
  picture.caption = std::move(caption);
  picture.frame = number;
  picture.heading = fmt::format("Figure {}", number);
  return picture;
}

void addFigure(Figures& figures, std::uint32_t number, const SvgCanvas& canvas, std::string caption) {
  const std::string name = fmt::format("figure-{}", number);
  figures.pictures.push_back(pictureOf(name, number, std::move(caption)));
  figures.files.push_back({.name = name + ".svg", .text = canvas.file()});
}

void addFigure1(Figures& figures) {
  const OccluderSet set = setOf({{{-1.3f, -0.8f, -4.0f}, {1.2f, -0.5f, -4.8f}, {0.1f, 1.2f, -4.2f}}});
  const TreeShape tree = shapeOfTree(lookingNorth(0.6, 1.5), set, allOf(set), true);
  const std::vector<std::string> letters = lettersOf(tree);
  SvgCanvas canvas(960, 420, "Figure 1: the occlusion volume of a polygon");
  drawVolume(canvas, tree, letters, {{60, 250}, 44});
  canvas.text({250, 24}, "the volume", {.bold = true});
  canvas.text({750, 24}, "its section at the eye's height", {.bold = true});
  const Sheet sheet{{750, 390}, 38};
  const TreeSection section = sectionOf(tree, planSection(), rectangle(-5.3, -9, 5.3, 0.2));
  drawRegions(canvas, section, sheet);
  drawTraces(canvas, section, tree, letters, sheet, 0.9);
  drawEye(canvas, sheet.eye);
  addFigure(
      figures, 1, canvas,
      fmt::format("The occlusion volume of a triangle: {} shadow planes through the eye and the edges, with "
                  "normals to the outside, and the plane of the triangle itself. On the right the region "
                  "that it hides, in plan; the third shadow plane does not cut that height in view.",
                  tree.nodes.size() - tree.frustum_nodes));
}

void addFigure2(Figures& figures) {
  const OccluderSet set = setOf(
      {wall(-3.2f, -5.0f, 0.6f, -4.2f), wall(0.2f, -6.5f, 3.6f, -5.5f), wall(-6.6f, -7.6f, -3.0f, -8.6f)});
  const TreeShape tree = shapeOfTree(lookingNorth(0.32, 3.0), set, allOf(set), true);
  const std::vector<std::string> letters = lettersOf(tree);
  SvgCanvas canvas(960, 456, "Figure 2: three walls and their occlusion tree");
  const Sheet sheet{{310, 420}, 38};
  const TreeSection section = sectionOf(tree, planSection(), rectangle(-7.8, -10.6, 7.8, 0.2));
  drawRegions(canvas, section, sheet);
  drawTraces(canvas, section, tree, letters, sheet, 0.93);
  drawWalls(canvas, set, sheet);
  drawEye(canvas, sheet.eye);
  drawDiagram(canvas, diagramOf(tree, letters),
              {.corner = {640, 30}, .size = {300, 370}, .radius = 15, .left = "behind", .right = "in front"});
  addFigure(
      figures, 2, canvas,
      fmt::format("Three walls in plan, what they hide together (grey), and their tree of {} shadow planes. "
                  "Squares are leaves: grey ones in the shadow of the wall that they name, white ones in "
                  "none. The walls are taller than the view, so their upper and lower edges add no node.",
                  tree.nodes.size() - tree.frustum_nodes));
}

// An occluder as the eye sees it, in imageSection().
SectionPolygon seenOf(const Occluder& occluder, const OccluderSet& set, const View& view) {
  const SectionPlane image = imageSection(view);
  SectionPolygon seen;
  for (const Vec3f& corner : set.verticesOf(occluder)) {
    const Vec3d p = Vec3d(corner) - view.eye;
    const double depth = dot(p, view.forward);
    seen.push_back({dot(p, image.right) / depth, dot(p, image.up) / depth});
  }
  return seen;
}

// The corner of an occluder that is farthest from the middle of all occluders.
SvgPoint farthestCorner(const SectionPolygon& seen, const OccluderSet& set, const View& view) {
  SectionPolygon middles;
  for (const Occluder& occluder : set.occluders) {
    middles.push_back(middleOf(seenOf(occluder, set, view)));
  }
  const SvgPoint middle = middleOf(middles);
  const auto away = [&](const SvgPoint& p) { return std::hypot(p.x - middle.x, p.y - middle.y); };
  return *std::max_element(seen.begin(), seen.end(),
                           [&](const SvgPoint& p, const SvgPoint& q) { return away(p) < away(q); });
}

// Draws the occluders as the eye sees them.
void drawSeen(SvgCanvas& canvas, const OccluderSet& set, const View& view, const Sheet& sheet) {
  for (std::size_t i = set.occluders.size(); i-- > 0;) {
    const SectionPolygon seen = seenOf(set.occluders[i], set, view);
    canvas.polygon(sheet(seen),
                   {.fill = kOccluderInk, .stroke = kOccluderInk, .width = 2.0, .fill_opacity = 0.14});
    // The letter stands aside, where occluders do not overlap.
    constexpr double kAside = 0.4;
    const SvgPoint middle = middleOf(seen), corner = farthestCorner(seen, set, view);
    const SvgPoint at =
        sheet(SvgPoint{middle.x + kAside * (corner.x - middle.x), middle.y + kAside * (corner.y - middle.y)});
    canvas.text(at, std::string(1, static_cast<char>('A' + i)),
                {.size = 16.0, .color = kOccluderInk, .bold = true});
  }
}

SectionPolygon pictureOf(const View& view) {
  const double x = view.tan_half_fovy * view.aspect, y = view.tan_half_fovy;
  return rectangle(-x, -y, x, y);
}

void addFigure7(Figures& figures) {
  const View view = lookingNorth(0.45, 1.25);
  const OccluderSet set =
      setOf({{{-1.5f, -1.0f, -4.0f}, {0.7f, -1.2f, -4.0f}, {0.95f, 0.6f, -4.0f}, {-0.8f, 1.1f, -4.0f}},
             {{0.3f, -0.9f, -6.0f}, {2.5f, -0.5f, -6.0f}, {1.3f, 1.8f, -6.0f}}});
  const TreeShape standard = shapeOfTree(view, set, allOf(set), false);
  const TreeShape modified = shapeOfTree(view, set, allOf(set), true);
  const std::vector<std::string> letters = lettersOf(standard);
  SvgCanvas canvas(1100, 430, "Figure 7: the occlusion tree and the modified one");
  const Sheet sheet{{235, 225}, 400};
  const TreeSection section = sectionOf(standard, imageSection(view), pictureOf(view));
  canvas.polygon(sheet(section.view), {.fill = kInView, .stroke = kDimInk, .width = 0.8, .dashes = "5 4"});
  drawSeen(canvas, set, view, sheet);
  drawTraces(canvas, section, standard, letters, sheet, 0.88);
  canvas.text({235, 24}, "as seen from the viewpoint", {.bold = true});
  canvas.text({640, 24}, "OBSP", {.bold = true});
  canvas.text({940, 24}, "MOBSP", {.bold = true});
  drawDiagram(canvas, diagramOf(standard, letters), {.corner = {490, 40}, .size = {300, 370}, .radius = 13});
  drawDiagram(canvas, diagramOf(modified, lettersOf(modified)),
              {.corner = {800, 40}, .size = {290, 370}, .radius = 13});
  addFigure(
      figures, 7, canvas,
      fmt::format(
          "Two occluders as the eye sees them and their trees. B's edges that lie in planes of A are "
          "flagged: the standard tree has a node for each (dashed), {} nodes in all; the modified one "
          "has none, {} nodes, and tells the same regions apart.",
          standard.nodes.size() - standard.frustum_nodes, modified.nodes.size() - modified.frustum_nodes));
}

const char* wordOf(Visibility state) {
  return state == Visibility::kHidden ? "hidden" : state == Visibility::kVisible ? "visible" : "partial";
}

}  // namespace

Figure8 figure8() {
  Figure8 made;
  made.view = lookingNorth(0.55, 1.3);
  made.occluders =
      setOf({{{-2.7f, -2.15f, -4.0f}, {0.0f, -2.15f, -4.0f}, {0.0f, 2.15f, -4.0f}, {-2.7f, 2.15f, -4.0f}},
             {{-0.6f, 0.36f, -6.0f}, {2.7f, -1.62f, -6.0f}, {2.7f, 2.7f, -6.0f}, {-0.6f, 2.7f, -6.0f}}});
  made.box = {{-4.2f, 0.75f, -12.5f}, {3.0f, 3.6f, -12.0f}};
  made.tree = shapeOfTree(made.view, made.occluders, allOf(made.occluders), true);
  made.by_the_paper = classifyUncut(made.tree, made.view.eye, made.box);
  OcclusionTree tree;
  tree.build(made.view, made.occluders, allOf(made.occluders));
  made.here = tree.classify(made.box);
  return made;
}

namespace {

// Draws the planes that the box crosses, on through the whole view.
void drawCrossedPlanes(SvgCanvas& canvas, const Figure8& made, const TreeSection& section,
                       const Sheet& sheet) {
  const Vec3d middle = center(made.box) - made.view.eye, half = Vec3d(made.box.extent()) * 0.5;
  for (std::uint32_t n = made.tree.frustum_nodes; n < made.tree.nodes.size(); ++n) {
    const Plane& plane = made.tree.nodes[n].plane;
    SvgPoint from, to;
    if (std::abs(plane.evaluate(middle)) < dot(abs(plane.normal), half) &&
        pieceWithin(section.view, lineOf(imageSection(made.view), plane), from, to)) {
      canvas.line(sheet(from), sheet(to), {.stroke = kPlaneInk, .width = 2.0, .dashes = "7 4"});
    }
  }
}

void addFigure8(Figures& figures) {
  const Figure8 made = figure8();
  const TreeSection section = sectionOf(made.tree, imageSection(made.view), pictureOf(made.view));
  const std::vector<std::string> letters = lettersOf(made.tree);
  SvgCanvas canvas(960, 450, "Figure 8: a configuration that the conservative test gets wrong");
  const Sheet sheet{{290, 235}, 370};
  canvas.polygon(sheet(section.view), {.fill = kInView, .stroke = kDimInk, .width = 0.8, .dashes = "5 4"});
  std::vector<TreePlace> reached;
  classifyUncut(made.tree, made.view.eye, made.box, &reached);
  for (const LeafRegion& leaf : section.leaves) {
    if (leaf.leaf.kind == TreeBranch::Kind::kLit &&
        std::find(reached.begin(), reached.end(), leaf.place) != reached.end()) {
      canvas.polygon(sheet(leaf.region), {.fill = kMarked, .fill_opacity = 0.8});
    }
  }
  drawSeen(canvas, made.occluders, made.view, sheet);
  drawCrossedPlanes(canvas, made, section, sheet);
  drawTraces(canvas, section, made.tree, letters, sheet, 0.88);
  const double depth = -made.box.max.z;
  const SectionPolygon seen = rectangle(made.box.min.x / depth, -made.box.max.y / depth,
                                        made.box.max.x / depth, -made.box.min.y / depth);
  canvas.polygon(sheet(seen),
                 {.fill = kFlaggedInk, .stroke = kFlaggedInk, .width = 2.0, .fill_opacity = 0.12});
  const SvgPoint corner = sheet(seen[0]);
  canvas.text({corner.x, corner.y - 11.0}, "the box, behind both",
              {.anchor = SvgText::Anchor::kStart, .color = kFlaggedInk});
  canvas.text({290, 20}, "as seen from the viewpoint", {.bold = true});
  drawDiagram(canvas, diagramOf(made.tree, letters), {.corner = {600, 40}, .size = {340, 300}, .radius = 14});
  canvas.text({610, 380},
              fmt::format("planes alone, each leaf counts (the paper): {}", wordOf(made.by_the_paper)),
              {.anchor = SvgText::Anchor::kStart});
  canvas.text({610, 404}, fmt::format("leaves that the box's image reaches (here): {}", wordOf(made.here)),
              {.anchor = SvgText::Anchor::kStart});
  addFigure(figures, 8, canvas,
            "A box that A and B hide together. It crosses the planes of the right edge of A and, where A "
            "hides it, of "
            "B's lower edge (dashed). So a search that only compares the box with planes reaches the marked "
            "region in "
            "front of both, where no point of the box is.");
}

}  // namespace

Figures treeFigures() {
  Figures figures;
  addFigure1(figures);
  addFigure2(figures);
  addFigure7(figures);
  addFigure8(figures);
  return figures;
}

}  // namespace sightline::tool::bittner
