#include "src/drawing/outline.h"

#include <algorithm>
#include <cmath>

#include "src/drawing/outline_union.h"
#include "src/geometry/clip_convex.h"

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
      return p.z - view_.view().near;
    case 1:
      return view_.view().far - p.z;
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
  const double depth = view_.view().orthographic ? 1.0 : std::max(p.z, view_.view().near);
  const double x = std::clamp(p.x / depth, left_, right_);
  const double y = std::clamp(p.y / depth, bottom_, top_);
  const double lines = view_.pageScale() * scale_;
  return {std::llround((x - view_.left()) * lines), std::llround((view_.top() - y) * lines)};
}

// Clips polygon_ by these borders. False if nothing is left.
bool Outliner::clip(std::uint32_t borders) {
  for (std::uint32_t border = 0; border < kBorders; ++border) {
    if ((borders >> border & 1u) != 0 && !clipConvex(polygon_, scratch_, Corner{}, [&](const Vec3d& p) {
          return borderDistance(border, p);
        })) {
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
  // Seen from the front, corners are counter-clockwise: with y down their area is negative.
  const int turn = orientationOf(ring_);
  if (turn == 0 || (turn > 0 && !double_sided)) {
    return;
  }
  if (turn < 0) {
    std::reverse(ring_.begin(), ring_.end());
  }
  chain_.add(ring_);
}

void Outliner::outline(const SceneView& scene, ObjectId id, std::vector<PagePath>& rings) {
  rings.clear();
  chain_.clear();
  const Object& object = scene.objects[id.value];
  const bool double_sided = scene.materialOf(object).double_sided;
  const std::span<const std::uint32_t> indices = scene.indicesOf(object);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    addTriangle(scene, indices.subspan(i, 3), double_sided);
  }
  chain_.takeLoops(loops_);
  uniteLoops(loops_, kMinWidth);
  for (const GridPath& loop : loops_) {
    PagePath& ring = rings.emplace_back();
    ring.reserve(loop.size());
    for (const GridPoint& p : loop) {
      ring.push_back({static_cast<double>(p.x) / scale_, static_cast<double>(p.y) / scale_});
    }
  }
}

}  // namespace sightline::drawing
