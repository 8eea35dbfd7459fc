#include "src/drawing/outline.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "src/drawing/outline_union.h"
#include "src/geometry/clip_convex.h"
#include "src/geometry/monotone_chain.h"
#include "src/scene/usable_view.h"

namespace sightline::drawing {
namespace {

constexpr std::uint32_t kBorders = 6;    // near, far, left, right, lower, upper
constexpr double kMinLines = 1024.0;     // lines of the grid for each unit, at least
constexpr double kLinesAcross = 0x1p20;  // lines of the grid across the page, at least

// Grid lines for each unit. A power of two, so that the corners of pages of round sizes lie on the grid. The
// largest pages need 2^60 lines, which is below Clipper's limit.
double gridScaleOf(double extent) {
  return std::max(kMinLines, std::exp2(std::ceil(std::log2(kLinesAcross / extent))));
}

}  // namespace

void Outliner::setView(const View& view, double page_height) {
  view_ = LineView(view, page_height);
  mirrored_ = scene::isLeftHanded(view_.view());
  const double margin = (view_.top() - view_.bottom()) * kMargin;
  left_ = view_.left() - margin;
  right_ = view_.right() + margin;
  bottom_ = view_.bottom() - margin;
  top_ = view_.top() + margin;
  scale_ = gridScaleOf(view_.pageScale() * std::max(right_ - left_, top_ - bottom_));
}

bool Outliner::mayShow(const SceneView& scene, ObjectId object) const {
  std::uint32_t beyond = ~0u;
  for (const std::uint32_t corner : scene.indicesOf(scene.objects[object.value])) {
    if (isFinite(scene.positions[corner])) {
      beyond &= bordersBeyond(view_.cameraPoint(scene.positions[corner]));
    }
    if (beyond == 0) {
      return true;
    }
  }
  return false;
}

// The distance from a border of the view's volume, >= 0 inside.
double Outliner::borderDistance(std::uint32_t border, const Vec3d& p) const {
  const double depth = view_.view().orthographic ? 1.0 : p.z;
  switch (border) {
    case 0:
      return p.z - view_.view().z_near;
    case 1:
      return view_.view().z_far - p.z;
    case 2:
      return p.x - left_ * depth;
    case 3:
      return right_ * depth - p.x;
    case 4:
      return p.y - bottom_ * depth;
    default:
      return top_ * depth - p.y;
  }
}

std::uint32_t Outliner::bordersBeyond(const Vec3d& p) const {
  std::uint32_t borders = 0;
  for (std::uint32_t border = 0; border < kBorders; ++border) {
    borders |= borderDistance(border, p) < 0.0 ? 1u << border : 0u;
  }
  return borders;
}

// The nearest grid point, x to the right and y down as on the page. It is clamped, because rounding may leave
// points beyond the margin, and points before the near plane that have no depth at all.
GridPoint Outliner::onGrid(const Vec3d& p) const {
  const double depth = view_.view().orthographic ? 1.0 : std::max(p.z, view_.view().z_near);
  const double x = std::clamp(p.x / depth, left_, right_);
  const double y = std::clamp(p.y / depth, bottom_, top_);
  const double lines = view_.pageScale() * scale_;
  return {std::llround((x - view_.left()) * lines), std::llround((view_.top() - y) * lines)};
}

// Clips polygon_ by these borders. False if nothing is left.
bool Outliner::clip(std::uint32_t borders) {
  for (std::uint32_t border = 0; border < kBorders; ++border) {
    if ((borders >> border & 1u) != 0 &&
        !geometry::clipConvex(polygon_, scratch_, Corner{},
                              [&](const Vec3d& p) { return borderDistance(border, p); })) {
      return false;
    }
  }
  return true;
}

void Outliner::addTriangle(const SceneView& scene, std::span<const std::uint32_t> corners,
                           bool double_sided) {
  polygon_.clear();
  std::uint32_t some_beyond = 0, all_beyond = ~0u;
  for (const std::uint32_t corner : corners) {
    if (!isFinite(scene.positions[corner])) {
      return;
    }
    const Vec3d p = view_.cameraPoint(scene.positions[corner]);
    const std::uint32_t beyond = bordersBeyond(p);
    some_beyond |= beyond;
    all_beyond &= beyond;
    polygon_.push_back({p});
  }
  if (all_beyond != 0 || (some_beyond != 0 && !clip(some_beyond))) {
    return;
  }
  ring_.clear();
  for (const Corner& corner : polygon_) {
    ring_.push_back(onGrid(corner.position));
  }
  // Seen from the front, corners are counter-clockwise: with y down their area is negative, unless the page
  // is mirrored.
  const int turn = orientationOf(ring_);
  const bool from_behind = mirrored_ ? turn < 0 : turn > 0;
  if (turn == 0 || (from_behind && !double_sided)) {
    return;
  }
  if (turn < 0) {
    std::reverse(ring_.begin(), ring_.end());
  }
  chain_.add(ring_);
}

void Outliner::outline(const SceneView& scene, ObjectId id, std::vector<GridPath>& rings) {
  chain_.clear();
  const Object& object = scene.objects[id.value];
  const bool double_sided = scene.materialOf(object).double_sided;
  const std::span<const std::uint32_t> indices = scene.indicesOf(object);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    addTriangle(scene, indices.subspan(i, 3), double_sided);
  }
  chain_.takeLoops(rings);
  uniteLoops(rings, kMinWidth);
}

void Outliner::toPage(const std::vector<GridPath>& loops, std::vector<PagePath>& rings) const {
  rings.clear();
  for (const GridPath& loop : loops) {
    PagePath& ring = rings.emplace_back();
    ring.reserve(loop.size());
    for (const GridPoint& p : loop) {
      ring.push_back({static_cast<double>(p.x) / scale_, static_cast<double>(p.y) / scale_});
    }
  }
}

GridPath Outliner::page() const {
  const double lines = view_.pageScale() * scale_;
  const std::int64_t width = std::llround((view_.right() - view_.left()) * lines),
                     height = std::llround((view_.top() - view_.bottom()) * lines);
  return {{0, 0}, {width, 0}, {width, height}, {0, height}};
}

// The hull of the corners' images, rounded to the grid.
void Outliner::imageHull(const SceneView& scene, ObjectId id, GridPath& hull) const {
  constexpr double kFarthest = 0x1p45;  // grid lines, of which products fit into Clipper's numbers
  hull.clear();
  std::vector<GridPoint> points;
  bool is_whole_page = false;
  for (const std::uint32_t corner : scene.indicesOf(scene.objects[id.value])) {
    if (!isFinite(scene.positions[corner])) {
      continue;
    }
    const Vec3d p = view_.cameraPoint(scene.positions[corner]);
    const double depth = view_.view().orthographic ? 1.0 : p.z;
    const double lines = view_.pageScale() * scale_;
    const double x = (p.x / depth - view_.left()) * lines, y = (view_.top() - p.y / depth) * lines;
    if (p.z < view_.view().z_near || !(std::abs(x) < kFarthest && std::abs(y) < kFarthest)) {
      is_whole_page = true;
      break;
    }
    points.push_back({std::llround(x), std::llround(y)});
  }
  if (is_whole_page) {
    const double lines = view_.pageScale() * scale_;
    const std::int64_t left = std::llround((left_ - view_.left()) * lines) - 1,
                       right = std::llround((right_ - view_.left()) * lines) + 1,
                       upper = std::llround((view_.top() - top_) * lines) - 1,
                       lower = std::llround((view_.top() - bottom_) * lines) + 1;
    hull = {{left, upper}, {right, upper}, {right, lower}, {left, lower}};
    return;
  }
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) {
    hull = points;
    return;
  }
  hull = geometry::convexHull(std::move(points), [](const GridPoint& a, const GridPoint& b,
                                                    const GridPoint& c) { return turnOf(a, b, c) > 0; });
}

}  // namespace sightline::drawing
