#pragma once

// Hidden-line drawings as editable vector graphics: groups, outlines, strokes; SVG and PDF.

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

// One object of a drawing. Strokes lie over the outline.
struct DrawingObject {
  ObjectId object{};
  std::string name{};
  std::vector<PagePath> outline{};  // rings, to be filled even-odd; the first point is not repeated
  std::vector<PagePath> strokes{};  // open or (first == last) closed polylines
};

// Objects that are drawn together: all outlines, then all strokes.
struct DrawingGroup {
  std::vector<DrawingObject> objects{};
};

struct Drawing {
  double width = 0.0, height = 0.0;    // page units
  std::vector<DrawingGroup> groups{};  // in the order of drawing, back to front
  HiddenLineStats stats{};
  // Of objects that may show something on the page: pairs of a line and an object that it was tested against,
  // and how many they would be if each line were tested against all objects.
  std::uint64_t pairs = 0, all_pairs = 0;
};

std::uint64_t countStrokes(const Drawing& drawing);

struct DrawingSettings {
  FeatureSettings features{};
  double page_height = 720.0;
  // For plots: the parts that the sorter was told to draw in front of or behind all others
  // (PartSettings::place). It has no arcs of them, so lines are tested against all overlays, and those of a
  // backdrop against everything. What hides there is still decided by depth.
  std::vector<ObjectId> overlays{}, backdrops{};
  // Called after each object with the share of them that is drawn, ascending to 1.
  std::function<void(double done)> progress = {};
};

// Draws scenes, one view after another. Part i of an order is object i. Objects that show nothing on the page
// are left out. Lines of an object are joined to strokes at its corners; strokes and outlines leave out
// points within about a 200,000th of the page's height. A view or a page without a size that is a finite
// number above zero (pages: 1e-15 to 1e15 units) gives an empty drawing. For one thread at a time.
class HiddenLineRenderer {
 public:
  explicit HiddenLineRenderer(const SceneView& scene);  // the scene's triangles; positions may change later
  ~HiddenLineRenderer();
  HiddenLineRenderer(HiddenLineRenderer&&) noexcept;
  HiddenLineRenderer& operator=(HiddenLineRenderer&&) noexcept;

  // The painter's form (Snyder, Lengyel, section 11): groups back to front; each object's outline is filled
  // and hides what is behind; lines are tested against their own object and those of its group that may
  // occlude it (order.arcs), so strokes of an object that hides nothing of itself are whole. What does not
  // hide, blended and alpha-tested objects, has strokes and no outline: what is behind it shows through.
  // scene: of the constructor, but for positions. names: of the objects; missing ones are empty.
  Drawing paint(const SceneView& scene, std::span<const std::string> names, const View& view,
                const LayerOrder& order, const DrawingSettings& settings);

  // The visible pieces of all lines, nothing else: for plotters and CAD. Each line is tested against its
  // object and those that may occlude it: order.arcs, which must be of all pairs (LayerSettings::all_arcs).
  // Each object is a group of its own. What several objects draw at the same place, from end to end, as walls
  // that share an edge do, only the first one has: a pen goes there once.
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

// An SVG 1.1 document. Each object is a <g>, whose id is made of its name, with the name itself as
// inkscape:label where the two differ; it holds one path of its outline and one of all its strokes. A group
// of several objects is a <g> around theirs, in which the outlines are a <g> below. Two decimals, more on
// pages below 100 units. Drawings with outlines have a rectangle of paper below everything. Paths with
// coordinates that are not finite are left out; a colour that is not #rrggbb or a width that is no number is
// replaced by the default.
std::string toSvg(const Drawing& drawing, const DrawingStyle& style = {});
// A PDF 1.5 document of one page, one unit a point; each object is an optional content group (a layer) with
// its name. Many readers show no page beyond 14,400 points.
std::string toPdf(const Drawing& drawing, const DrawingStyle& style = {});

}  // namespace sightline
