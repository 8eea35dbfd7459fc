// Makes a drawing of outlines and strokes from an order of objects.
//
// Based on: Snyder, Lengyel. MSR-TR-97-11, 1997, section 11: "Hidden-line drawings" from layers.
// Differs from the paper in: outlines are unions of triangles; there is a second form, the plot, in which the
// arcs of the sort tell which objects can hide a line.

#include <algorithm>
#include <optional>
#include <utility>

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

  // The arguments and the results so far of one call of paint() or plot().
  struct Frame {
    const SceneView& scene;
    std::span<const std::string> names;
    const View& view;
    const DrawingSettings& settings;
    Drawing drawing{};
    double tolerance = settings.page_height * kToleranceShare;
    std::vector<std::optional<std::vector<GridPath>>> outlines{};  // one for each object, of those asked for
    std::vector<bool> shows{};                     // one for each object: whether it may show something
    std::uint64_t objects = 0, objects_drawn = 0;  // objects of the order that may show something

    bool mayShow(ObjectId object) const { return object.value < shows.size() && shows[object.value]; }
    // The objects of these parts that may show something.
    std::vector<ObjectId> objectsOf(std::span<const PartId> parts) const;
    void tellProgress();  // called after each object
  };

  // Prepares a drawing. False if nothing can be drawn.
  bool begin(Frame& frame);
  // The object with its name and its strokes: the parts of its lines that neither it nor the occluders hide,
  // without the pieces in `before`.
  DrawingObject drawLines(Frame& frame, ObjectId object, DrawnPieces* before);
  void drawOutline(Frame& frame, DrawingObject& object);
  const LayerOrder& seenFirst(Frame& frame, const LayerOrder& order);
  const std::vector<GridPath>& gridOutlineOf(Frame& frame, ObjectId object);

  FeatureEdges edges;
  // Memory that is used again.
  HiddenLines hidden;
  Outliner outliner;
  SeenOrder seen_order;
  std::vector<FeatureLine> lines;
  std::vector<LinePiece> pieces;
  std::vector<ObjectId> occluders;  // of the object whose lines are drawn next
};

void HiddenLineRenderer::Impl::Frame::tellProgress() {
  ++objects_drawn;
  if (settings.progress) {
    settings.progress(static_cast<double>(objects_drawn) / static_cast<double>(objects));
  }
}

bool HiddenLineRenderer::Impl::begin(Frame& frame) {
  const double height = frame.settings.page_height;
  if (!isDrawable(frame.view, height)) {
    return false;
  }
  frame.drawing.height = height;
  frame.drawing.width = height * frame.view.aspect;
  hidden.setView(frame.scene, frame.view, height);
  outliner.setView(frame.view, height);
  frame.outlines.resize(frame.scene.objects.size());
  frame.shows.resize(frame.scene.objects.size());
  for (std::size_t i = 0; i < frame.shows.size(); ++i) {
    frame.shows[i] = outliner.mayShow(frame.scene, ObjectId(i));
  }
  return true;
}

DrawingObject HiddenLineRenderer::Impl::drawLines(Frame& frame, ObjectId object, DrawnPieces* before) {
  const std::span<const std::string> names = frame.names;
  DrawingObject drawn{.object = object,
                      .name = object.value < names.size() ? names[object.value] : std::string()};
  occluders.push_back(object);
  std::erase_if(occluders, [&](ObjectId id) { return !frame.mayShow(id); });
  std::sort(occluders.begin(), occluders.end());
  occluders.erase(std::unique(occluders.begin(), occluders.end()), occluders.end());
  edges.select(frame.scene, object, frame.view, frame.settings.features, lines);
  pieces.clear();
  hidden.visiblePieces(lines, occluders, pieces);
  if (before != nullptr) {
    before->leaveNew(pieces);
  }
  joinPieces(pieces, frame.tolerance, drawn.strokes);
  frame.drawing.pairs += lines.size() * occluders.size();
  frame.drawing.all_pairs += lines.size() * frame.objects;
  return drawn;
}

void HiddenLineRenderer::Impl::drawOutline(Frame& frame, DrawingObject& object) {
  const SceneView& scene = frame.scene;
  if (!scene.materialOf(scene.objects[object.object.value]).opaque()) {
    return;
  }
  outliner.toPage(gridOutlineOf(frame, object.object), object.outline);
  frame.outlines[object.object.value].reset();  // each object is drawn once
  for (PagePath& ring : object.outline) {
    // Closing the line lets the last edge be simplified too.
    ring.push_back(ring.front());
    simplify(ring, frame.tolerance);
    ring.pop_back();
  }
  std::erase_if(object.outline, [](const PagePath& ring) { return ring.size() < 3; });
}

// The outline of an opaque object that may show; empty for others.
const std::vector<GridPath>& HiddenLineRenderer::Impl::gridOutlineOf(Frame& frame, ObjectId object) {
  const SceneView& scene = frame.scene;
  std::optional<std::vector<GridPath>>& known = frame.outlines[object.value];
  if (!known) {
    known.emplace();
    if (frame.mayShow(object) && scene.materialOf(scene.objects[object.value]).opaque()) {
      outliner.outline(scene, object, *known);
    }
  }
  return *known;
}

const LayerOrder& HiddenLineRenderer::Impl::seenFirst(Frame& frame, const LayerOrder& order) {
  return seen_order.sort(frame.scene, outliner, order, [&](ObjectId object) -> const std::vector<GridPath>& {
    return gridOutlineOf(frame, object);
  });
}

std::vector<ObjectId> HiddenLineRenderer::Impl::Frame::objectsOf(std::span<const PartId> parts) const {
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
  Impl& own = *impl_;
  Impl::Frame frame{scene, names, view, settings};
  Drawing& drawing = frame.drawing;
  if (!own.begin(frame)) {
    return std::move(drawing);
  }
  const LayerOrder& order = settings.seen_first ? own.seenFirst(frame, given) : given;
  frame.objects = frame.objectsOf(order.parts).size();
  const OccludersOf occluders_of(order.arcs, scene.objects.size());
  std::vector<std::size_t> group_of(scene.objects.size(), order.groups());
  for (std::size_t i = order.groups(); i-- > 0;) {
    const std::vector<ObjectId> members = frame.objectsOf(order.group(i));
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
      DrawingObject object = own.drawLines(frame, member, nullptr);
      own.drawOutline(frame, object);
      frame.tellProgress();
      if (!object.outline.empty() || !object.strokes.empty()) {
        group.objects.push_back(std::move(object));
      }
    }
    if (!group.objects.empty()) {
      drawing.groups.push_back(std::move(group));
    }
  }
  drawing.stats = own.hidden.stats();
  return std::move(drawing);
}

Drawing HiddenLineRenderer::plot(const SceneView& scene, std::span<const std::string> names, const View& view,
                                 const LayerOrder& order, const DrawingSettings& settings) {
  Impl& own = *impl_;
  Impl::Frame frame{scene, names, view, settings};
  Drawing& drawing = frame.drawing;
  if (!own.begin(frame)) {
    return std::move(drawing);
  }
  const std::vector<ObjectId> members = frame.objectsOf(order.parts);
  frame.objects = members.size();
  const OccludersOf occluders_of(order.arcs, scene.objects.size());
  DrawnPieces drawn(frame.tolerance);
  for (auto member = members.rbegin(); member != members.rend(); ++member) {
    const auto& backdrops = settings.backdrops;
    if (std::find(backdrops.begin(), backdrops.end(), *member) != backdrops.end()) {
      own.occluders = members;
    } else {
      const std::span<const ObjectId> fronts = occluders_of.find(*member);
      own.occluders.assign(fronts.begin(), fronts.end());
      own.occluders.insert(own.occluders.end(), settings.overlays.begin(), settings.overlays.end());
    }
    DrawingObject object = own.drawLines(frame, *member, &drawn);
    frame.tellProgress();
    if (!object.strokes.empty()) {
      drawing.groups.emplace_back().objects.push_back(std::move(object));
    }
  }
  drawing.stats = own.hidden.stats();
  return std::move(drawing);
}

}  // namespace sightline
