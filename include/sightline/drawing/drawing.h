#pragma once

// Hidden-line drawings as editable vector graphics, made of groups, outlines and strokes, written as SVG or
// PDF.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/drawing/feature_edges.h"
#include "sightline/drawing/hidden_lines.h"
#include "sightline/layers/layer_sorter.h"
#include "sightline/scene/scene.h"

namespace sightline {

using PagePath = std::vector<PagePoint>;

// One object of a drawing. Its strokes lie over its outline.
struct DrawingObject {
  ObjectId object{};
  std::string name{};
  std::vector<PagePath> outline{};  // rings, to be filled even-odd; the first point is not repeated
  std::vector<PagePath> strokes{};  // open or (first == last) closed polylines
};

// Objects that are drawn together: first all outlines, then all strokes.
struct DrawingGroup {
  std::vector<DrawingObject> objects{};
};

struct Drawing {
  double width = 0.0, height = 0.0;    // page units
  std::vector<DrawingGroup> groups{};  // in the order of drawing, back to front
  HiddenLineStats stats{};
  // Pairs of a line and an object that the line was tested against, and how many pairs there would be if each
  // line were tested against all objects. Both count objects that may show on the page.
  std::uint64_t pairs = 0, all_pairs = 0;
  std::size_t largest_group = 0;  // objects of the order's largest group that may show on the page
};

std::uint64_t countStrokes(const Drawing& drawing);

struct DrawingSettings {
  FeatureSettings features{};
  double page_height = 720.0;
  // For plots: the parts that the sorter draws in front of or behind all others (PartSettings::place). The
  // sorter has no arcs of them, so all lines are tested against all overlays, and lines of a backdrop against
  // everything. Depth still decides what is hidden. Parts that are left to a depth buffer have no arcs
  // either: name them in both lists.
  std::vector<ObjectId> overlays{}, backdrops{};
  // For the painter's form: within groups of the order only the arcs count from what may be seen on the page
  // to what may lie behind it there, so that groups are smaller. order.arcs must hold all pairs
  // (LayerArcs::kAll). The drawing shows the same; objects that are wholly hidden are groups of their own,
  // whose lines stay whole and are painted over.
  bool seen_first = false;
  // Called after each object with the share of objects that is drawn, ascending to 1.
  std::function<void(double done)> progress = {};
};

// Draws a scene, one view after another. Part i of an order is object i. Objects that show nothing on the
// page are left out. Lines of an object are joined to strokes at its corners; strokes and outlines are
// simplified within about 1 / 200,000 of the page's height. A view whose z_near is 0 shows all that is before
// the eye, in perspective from a depth of 2^-40 m on. The drawing is empty if the view or the page has no
// valid size (pages: 1e-15 to 1e15 units on each side). For one thread at a time.
class HiddenLineRenderer {
 public:
  explicit HiddenLineRenderer(const SceneView& scene);  // reads the triangles; positions may change later
  ~HiddenLineRenderer();
  HiddenLineRenderer(HiddenLineRenderer&&) noexcept;
  HiddenLineRenderer& operator=(HiddenLineRenderer&&) noexcept;

  // The painter's form (Snyder, Lengyel, section 11): groups from back to front, with each object's outline
  // filled so that it hides what is behind. A line is tested against its own object and those of its group
  // that may occlude it (order.arcs), so the strokes of an object that hides nothing of itself stay whole.
  // Blended and alpha-tested objects hide nothing: they have strokes and no outline. All parts must be
  // sorted, overlays or backdrops, for those left to a depth buffer have no order. scene must be the
  // constructor's, except for positions. names has one entry for each object; missing ones are empty.
  Drawing paint(const SceneView& scene, std::span<const std::string> names, const View& view,
                const LayerOrder& order, const DrawingSettings& settings);

  // The visible pieces of all lines and nothing else, for plotters and CAD. A line is tested against its
  // object and those that may occlude it by order.arcs, which must hold all pairs (LayerArcs::kAll).
  // Each object is a group of its own. A piece that several objects draw at the same place, as walls that
  // share an edge do, is drawn by the first one only, so that a pen goes there once.
  Drawing plot(const SceneView& scene, std::span<const std::string> names, const View& view,
               const LayerOrder& order, const DrawingSettings& settings);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

struct DrawingStyle {
  double stroke_width = 1.0;                          // page units
  std::string stroke = "#000000", paper = "#ffffff";  // #rrggbb
  std::string title{};
};

// An SVG 1.1 document. Each object is a <g> with one path for its outline and one for all its strokes; its id
// is made of the object's name, which is added as inkscape:label if the two differ. A group of several
// objects is a <g> around theirs, with all outlines in a <g> below the strokes. Coordinates have two
// decimals, more on pages below 100 units. Drawings with outlines have a rectangle of paper below everything.
// Paths with coordinates that are not finite are left out; a colour that is not #rrggbb or a width that is
// not a number is replaced by the default.
std::string toSvg(const Drawing& drawing, const DrawingStyle& style = {});
// A PDF 1.5 document of one page. One unit is one point. Each object is an optional content group (a layer)
// with its name. Many readers show no page larger than 14,400 points.
std::string toPdf(const Drawing& drawing, const DrawingStyle& style = {});

}  // namespace sightline
