#include "sightline/drawing/hidden_lines.h"

#include <algorithm>
#include <cmath>

#include "src/drawing/hidden_lines_occluders.h"
#include "src/drawing/line_intervals.h"
#include "src/drawing/line_view.h"

namespace sightline {

using namespace drawing;

namespace {

using Interval = LineIntervals::Interval;

constexpr double kNoLength = 0x1p-40;  // shorter pieces have no length; a share of the page's height
constexpr double kSpeck = 0x1p-18;     // the shortest piece that a pen draws; a share of the page's height

// The part of a line within the view, in camera space and on the screen.
struct PageLine {
  HidableLine line;
  ScreenLine screen;
  const LineView* view = nullptr;

  PagePoint at(double share) const {
    const ScreenPoint p = view->onScreen(line.a * (1.0 - share) + line.b * share);
    return {view->pageX(p.x), view->pageY(p.y)};
  }
  double pageLength(double from, double to) const {
    const PagePoint p = at(from);
    const PagePoint q = at(to);
    return std::hypot(q.x - p.x, q.y - p.y);
  }
  // Converts a share of the line on the screen to a share in space.
  double inSpace(double on_screen) const {
    double share = on_screen;
    if (!view->view().orthographic) {
      const double start = (1.0 - on_screen) * screen.from.reciprocal_depth;
      const double end = on_screen * screen.to.reciprocal_depth;
      share = end / (start + end);
    }
    return line.from + (line.to - line.from) * share;
  }
};

}  // namespace

struct HiddenLines::Impl {
  LineView view;
  double page_height = 0.0;
  std::vector<Vec3d> camera;  // all positions in camera space
  std::vector<float> size;    // the largest coordinate of each position
  HidingTriangles triangles;
  HidingTrees occluders;
  std::vector<HidingTrees::Item> items;
  LineIntervals hidden;
  std::vector<Interval> stretches;
  HiddenLineStats stats;

  std::uint32_t gather(std::span<const ObjectId> objects);
  bool place(const FeatureLine& line, PageLine& placed) const;
  void hide(const PageLine& line, std::uint32_t root);
  void joinStretches(const PageLine& line);
  void addPieces(const FeatureLine& line, const PageLine& placed, std::vector<LinePiece>& pieces);
};

// Builds a tree of the objects' trees and returns its root.
std::uint32_t HiddenLines::Impl::gather(std::span<const ObjectId> objects) {
  items.clear();
  occluders.clear();
  for (const ObjectId object : objects) {
    const std::uint32_t root =
        object.value < triangles.objects() ? triangles.rootOf(object.value) : HidingTrees::kNoTree;
    if (root != HidingTrees::kNoTree) {
      items.push_back({triangles.trees().box(root), root});
    }
  }
  return occluders.add(items);
}

// Clips the line to the view. False if nothing is left, or if what is left has no length.
bool HiddenLines::Impl::place(const FeatureLine& line, PageLine& placed) const {
  if (line.a >= camera.size() || line.b >= camera.size() || !isFinite(camera[line.a]) ||
      !isFinite(camera[line.b])) {
    return false;
  }
  HidableLine& l = placed.line;
  l = {camera[line.a], camera[line.b], size[line.a], size[line.b], 0.0, 1.0};
  if (!view.clip(l.a, l.b, l.from, l.to)) {
    return false;
  }
  const Vec3d from = l.a * (1.0 - l.from) + l.b * l.from;
  const Vec3d to = l.a * (1.0 - l.to) + l.b * l.to;
  placed.view = &view;
  placed.screen = {view.onScreen(from), view.onScreen(to)};
  const bool has_image = view.view().orthographic || (from.z > 0.0 && to.z > 0.0);
  return has_image && placed.pageLength(l.from, l.to) > kNoLength * page_height;
}

// Sets `hidden` to the parts of the line that the occluders hide.
void HiddenLines::Impl::hide(const PageLine& placed, std::uint32_t root) {
  hidden.clear();
  if (root == HidingTrees::kNoTree) {
    return;
  }
  const auto known = [&](double first, double last) {
    return hidden.covers(placed.inSpace(first), placed.inSpace(last));
  };
  const auto test = [&](std::uint32_t triangle) {
    double from = 0.0;
    double to = 1.0;
    ++stats.tests;
    if (hiddenPart(triangles[triangle], placed.line, view.view(), from, to)) {
      hidden.add(from, to);
    }
  };
  occluders.traverse(root, placed.screen, known, [&](std::uint32_t object_root) {
    triangles.trees().traverse(object_root, placed.screen, known, test);
  });
}

// Sets `stretches` to what is hidden on the page. Visible specks between two hidden stretches, or between one
// and an end, are hidden too; hidden stretches that are then too short for a gap are not.
void HiddenLines::Impl::joinStretches(const PageLine& placed) {
  const double speck = kSpeck * page_height;
  const HidableLine& line = placed.line;
  stretches.clear();
  if (placed.pageLength(line.from, line.to) <= speck) {
    double covered = 0.0;
    for (const Interval& i : hidden.intervals()) {
      covered += i.to - i.from;
    }
    if (covered > 0.5 * (line.to - line.from)) {
      stretches.push_back({line.from, line.to});
    }
    return;
  }
  for (const Interval& i : hidden.intervals()) {
    const double before = stretches.empty() ? line.from : stretches.back().to;
    const bool joined = placed.pageLength(before, i.from) <= speck;
    if (joined && !stretches.empty()) {
      stretches.back().to = i.to;
    } else {
      stretches.push_back({joined ? line.from : i.from, i.to});
    }
  }
  if (!stretches.empty() && placed.pageLength(stretches.back().to, line.to) <= speck) {
    stretches.back().to = line.to;
  }
  std::erase_if(stretches, [&](const Interval& i) { return placed.pageLength(i.from, i.to) <= speck; });
}

void HiddenLines::Impl::addPieces(const FeatureLine& line, const PageLine& placed,
                                  std::vector<LinePiece>& pieces) {
  double from = placed.line.from;
  const auto add = [&](double to) {
    if (from < to) {
      pieces.push_back({placed.at(from), placed.at(to), from, to, line});
      ++stats.pieces;
    }
  };
  for (const Interval& stretch : stretches) {
    add(stretch.from);
    from = stretch.to;
  }
  add(placed.line.to);
}

HiddenLines::HiddenLines() : impl_(std::make_unique<Impl>()) {}
HiddenLines::~HiddenLines() = default;
HiddenLines::HiddenLines(HiddenLines&&) noexcept = default;
HiddenLines& HiddenLines::operator=(HiddenLines&&) noexcept = default;

void HiddenLines::setView(const SceneView& scene, const View& view, double page_height) {
  Impl& impl = *impl_;
  impl.view = LineView(view, page_height);
  impl.page_height = page_height;
  impl.stats = {};
  impl.camera.clear();
  impl.size.clear();
  for (const Vec3f& position : scene.positions) {
    impl.camera.push_back(impl.view.cameraPoint(position));
    impl.size.push_back(maxComponent(abs(position)));
  }
  impl.triangles.set(scene, impl.view);
}

void HiddenLines::visiblePieces(std::span<const FeatureLine> lines, std::span<const ObjectId> occluders,
                                std::vector<LinePiece>& pieces) {
  Impl& impl = *impl_;
  const std::uint32_t root = impl.gather(occluders);
  for (const FeatureLine& line : lines) {
    ++impl.stats.lines;
    PageLine placed;
    if (impl.place(line, placed)) {
      impl.hide(placed, root);
      impl.joinStretches(placed);
      impl.addPieces(line, placed, pieces);
    }
  }
}

const HiddenLineStats& HiddenLines::stats() const {
  return impl_->stats;
}

}  // namespace sightline
