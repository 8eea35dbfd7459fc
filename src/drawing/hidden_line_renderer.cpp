// Makes a drawing of outlines and strokes from an order of objects.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, 1997, section 11: "Hidden-line drawings" from layers.
// Differs from the paper in: outlines are unions of triangles; there is a second form, the plot, in which the
// arcs of the sort tell which objects can hide a line.

#include <algorithm>
#include <optional>

#include "sightline/drawing/drawing.h"
#include "src/base/rows.h"
#include "src/drawing/line_view.h"
#include "src/drawing/outline.h"
#include "src/drawing/polylines.h"
#include "src/drawing/seen_order.h"

namespace sightline {

using namespace drawing;

namespace {

constexpr double kToleranceShare = 1.0 / 200000.0;  // of the page's height

// The objects that may occlude each object, from the arcs of an order.
class OccludersOf {
 public:
  OccludersOf(std::span<const LayerArc> arcs, std::size_t objects) {
    fronts_.group(objects, [&](auto&& body) {
      for (const LayerArc& arc : arcs) {
        if (arc.front.value < objects && arc.back.value < objects) {
          body(arc.back.value, ObjectId(arc.front.value));
        }
      }
    });
  }

  std::span<const ObjectId> find(ObjectId object) const { return fronts_[object.value]; }

 private:
  base::Rows<ObjectId> fronts_;  // one row per object
};

}  // namespace

std::uint64_t countStrokes(const Drawing& drawing) {
  std::uint64_t strokes = 0;
  for (const DrawingGroup& group : drawing.groups) {
    for (const DrawingObject& object : group.objects) {
      strokes += object.strokes.size();
    }
  }
  return strokes;
}

struct HiddenLineRenderer::Impl {
  explicit Impl(const SceneView& of) : edges(of) {}

  // Prepares a drawing. False if nothing can be drawn.
  bool begin(const SceneView& scene, std::span<const std::string> names, const View& view,
             const DrawingSettings& settings, Drawing& drawing);
  // The object with its name and its strokes: the parts of its lines that neither it nor the occluders hide,
  // without the pieces in `before`.
  DrawingObject drawLines(ObjectId object, DrawnPieces* before, Drawing& drawing);
  void drawOutline(DrawingObject& object);
  const LayerOrder& seenFirst(const LayerOrder& order);
  const std::vector<GridPath>& gridOutlineOf(ObjectId object);
  void tellProgress();  // called after each object
  // The objects of these parts that may show something.
  std::vector<ObjectId> objectsOf(std::span<const PartId> parts) const;
  bool mayShow(ObjectId object) const { return object.value < shows.size() && shows[object.value]; }

  FeatureEdges edges;
  HiddenLines hidden;
  Outliner outliner;
  SeenOrder seen_order;
  std::vector<FeatureLine> lines;
  std::vector<LinePiece> pieces;
  std::vector<ObjectId> occluders;

  // State of the drawing that is being made.
  SceneView scene;
  std::span<const std::string> names;
  View view;
  const DrawingSettings* settings = nullptr;
  double tolerance = 0.0;
  std::vector<std::optional<std::vector<GridPath>>> outlines;  // one for each object, of those asked for
  std::vector<bool> shows;                       // one for each object: whether it may show something
  std::uint64_t objects = 0, objects_drawn = 0;  // objects of the order that may show something
};

bool HiddenLineRenderer::Impl::begin(const SceneView& scene_in, std::span<const std::string> names_in,
                                     const View& view_in, const DrawingSettings& settings_in,
                                     Drawing& drawing) {
  if (!isDrawable(view_in, settings_in.page_height)) {
    return false;
  }
  scene = scene_in;
  names = names_in;
  view = view_in;
  settings = &settings_in;
  objects_drawn = 0;
  tolerance = settings_in.page_height * kToleranceShare;
  drawing.height = settings_in.page_height;
  drawing.width = settings_in.page_height * view.aspect;
  hidden.setView(scene, view, settings_in.page_height);
  outliner.setView(view, settings_in.page_height);
  outlines.assign(scene.objects.size(), {});
  shows.resize(scene.objects.size());
  for (std::size_t i = 0; i < shows.size(); ++i) {
    shows[i] = outliner.mayShow(scene, ObjectId(i));
  }
  return true;
}

DrawingObject HiddenLineRenderer::Impl::drawLines(ObjectId object, DrawnPieces* before, Drawing& drawing) {
  DrawingObject drawn{.object = object,
                      .name = object.value < names.size() ? names[object.value] : std::string()};
  occluders.push_back(object);
  std::erase_if(occluders, [&](ObjectId id) { return !mayShow(id); });
  std::sort(occluders.begin(), occluders.end());
  occluders.erase(std::unique(occluders.begin(), occluders.end()), occluders.end());
  edges.select(scene, object, view, settings->features, lines);
  pieces.clear();
  hidden.visiblePieces(lines, occluders, pieces);
  if (before != nullptr) {
    before->leaveNew(pieces);
  }
  joinPieces(pieces, tolerance, drawn.strokes);
  drawing.pairs += lines.size() * occluders.size();
  drawing.all_pairs += lines.size() * objects;
  return drawn;
}

void HiddenLineRenderer::Impl::tellProgress() {
  ++objects_drawn;
  if (settings->progress) {
    settings->progress(static_cast<double>(objects_drawn) / static_cast<double>(objects));
  }
}

void HiddenLineRenderer::Impl::drawOutline(DrawingObject& object) {
  if (!scene.materialOf(scene.objects[object.object.value]).opaque()) {
    return;
  }
  outliner.toPage(gridOutlineOf(object.object), object.outline);
  outlines[object.object.value].reset();  // each object is drawn once
  for (PagePath& ring : object.outline) {
    // Closing the line lets the last edge be simplified too.
    ring.push_back(ring.front());
    simplify(ring, tolerance);
    ring.pop_back();
  }
  std::erase_if(object.outline, [](const PagePath& ring) { return ring.size() < 3; });
}

// The outline of an opaque object that may show; empty for others.
const std::vector<GridPath>& HiddenLineRenderer::Impl::gridOutlineOf(ObjectId object) {
  std::optional<std::vector<GridPath>>& known = outlines[object.value];
  if (!known) {
    known.emplace();
    if (mayShow(object) && scene.materialOf(scene.objects[object.value]).opaque()) {
      outliner.outline(scene, object, *known);
    }
  }
  return *known;
}

const LayerOrder& HiddenLineRenderer::Impl::seenFirst(const LayerOrder& order) {
  return seen_order.sort(scene, outliner, order, [this](ObjectId object) -> const std::vector<GridPath>& {
    return gridOutlineOf(object);
  });
}

std::vector<ObjectId> HiddenLineRenderer::Impl::objectsOf(std::span<const PartId> parts) const {
  std::vector<ObjectId> ids;
  for (const PartId part : parts) {
    if (const ObjectId object(part.value); mayShow(object)) {
      ids.push_back(object);
    }
  }
  return ids;
}

HiddenLineRenderer::HiddenLineRenderer(const SceneView& scene) : impl_(std::make_unique<Impl>(scene)) {}
HiddenLineRenderer::~HiddenLineRenderer() = default;
HiddenLineRenderer::HiddenLineRenderer(HiddenLineRenderer&&) noexcept = default;
HiddenLineRenderer& HiddenLineRenderer::operator=(HiddenLineRenderer&&) noexcept = default;

Drawing HiddenLineRenderer::paint(const SceneView& scene, std::span<const std::string> names,
                                  const View& view, const LayerOrder& given,
                                  const DrawingSettings& settings) {
  Drawing drawing;
  Impl& own = *impl_;
  if (!own.begin(scene, names, view, settings, drawing)) {
    return drawing;
  }
  const LayerOrder& order = settings.seen_first ? own.seenFirst(given) : given;
  own.objects = own.objectsOf(order.parts).size();
  const OccludersOf occluders_of(order.arcs, scene.objects.size());
  std::vector<std::size_t> group_of(scene.objects.size(), order.groups());
  for (std::size_t i = order.groups(); i-- > 0;) {
    const std::vector<ObjectId> members = own.objectsOf(order.group(i));
    for (const ObjectId member : members) {
      group_of[member.value] = i;
    }
    drawing.largest_group = std::max(drawing.largest_group, members.size());
    DrawingGroup group;
    for (const ObjectId member : members) {
      own.occluders.clear();
      for (const ObjectId front : occluders_of.find(member)) {
        if (group_of[front.value] == i) {
          own.occluders.push_back(front);
        }
      }
      DrawingObject object = own.drawLines(member, nullptr, drawing);
      own.drawOutline(object);
      own.tellProgress();
      if (!object.outline.empty() || !object.strokes.empty()) {
        group.objects.push_back(std::move(object));
      }
    }
    if (!group.objects.empty()) {
      drawing.groups.push_back(std::move(group));
    }
  }
  drawing.stats = own.hidden.stats();
  return drawing;
}

Drawing HiddenLineRenderer::plot(const SceneView& scene, std::span<const std::string> names, const View& view,
                                 const LayerOrder& order, const DrawingSettings& settings) {
  Drawing drawing;
  Impl& own = *impl_;
  if (!own.begin(scene, names, view, settings, drawing)) {
    return drawing;
  }
  const std::vector<ObjectId> members = own.objectsOf(order.parts);
  own.objects = members.size();
  const OccludersOf occluders_of(order.arcs, scene.objects.size());
  DrawnPieces drawn(own.tolerance);
  for (auto member = members.rbegin(); member != members.rend(); ++member) {
    const auto& backdrops = settings.backdrops;
    if (std::find(backdrops.begin(), backdrops.end(), *member) != backdrops.end()) {
      own.occluders = members;
    } else {
      const std::span<const ObjectId> fronts = occluders_of.find(*member);
      own.occluders.assign(fronts.begin(), fronts.end());
      own.occluders.insert(own.occluders.end(), settings.overlays.begin(), settings.overlays.end());
    }
    DrawingObject object = own.drawLines(*member, &drawn, drawing);
    own.tellProgress();
    if (!object.strokes.empty()) {
      drawing.groups.emplace_back().objects.push_back(std::move(object));
    }
  }
  drawing.stats = own.hidden.stats();
  return drawing;
}

}  // namespace sightline
