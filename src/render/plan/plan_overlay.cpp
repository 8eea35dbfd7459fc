#include "src/render/plan/plan_overlay.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "src/geometry/monotone_chain.h"

namespace sightline::render {
namespace {

struct Point {
  double x = 0.0, y = 0.0;  // clip space
};

class OverlayBuilder {
 public:
  explicit OverlayBuilder(const PlanView& plan) : plan_(plan), pixel_(2.0 / plan.size_px) {}

  Point project(const Vec3d& p) const {
    return {(p.x - plan_.camera.eye.x) / plan_.radius, -(p.z - plan_.camera.eye.z) / plan_.radius};
  }

  // Fills a convex polygon.
  void fill(std::span<const Point> polygon, const PlanColor& color, double alpha) {
    for (std::size_t i = 2; i < polygon.size(); ++i) {
      add(polygon[0], color, alpha);
      add(polygon[i - 1], color, alpha);
      add(polygon[i], color, alpha);
    }
  }

  void outline(std::span<const Point> polygon, const PlanColor& color, double width_px) {
    for (std::size_t i = 0; i < polygon.size(); ++i) {
      line(polygon[i], polygon[(i + 1) % polygon.size()], color, width_px);
    }
  }

  void disc(const Point& center, const PlanColor& color, double radius_px) {
    std::array<Point, 24> rim;
    for (std::size_t i = 0; i < rim.size(); ++i) {
      const double angle = 2.0 * 3.14159265358979 * static_cast<double>(i) / static_cast<double>(rim.size());
      rim[i] = {center.x + radius_px * pixel_ * std::cos(angle),
                center.y + radius_px * pixel_ * std::sin(angle)};
    }
    fill(rim, color, 1.0);
  }

  std::vector<OverlayVertex> take() { return std::move(vertices_); }

 private:
  // Draws a line whose square ends reach half its width beyond its points, so that corners close and a line
  // without length shows.
  void line(const Point& a, const Point& b, const PlanColor& color, double width_px) {
    const double half = 0.5 * width_px * pixel_;
    const double length = std::hypot(b.x - a.x, b.y - a.y);
    const double dx = length > 0.0 ? (b.x - a.x) / length * half : half;
    const double dy = length > 0.0 ? (b.y - a.y) / length * half : 0.0;
    const std::array<Point, 4> corners{{{a.x - dx - dy, a.y - dy + dx},
                                        {a.x - dx + dy, a.y - dy - dx},
                                        {b.x + dx + dy, b.y + dy - dx},
                                        {b.x + dx - dy, b.y + dy + dx}}};
    fill(corners, color, 1.0);
  }

  void add(const Point& p, const PlanColor& color, double alpha) {
    vertices_.push_back(
        {static_cast<float>(p.x),
         static_cast<float>(p.y),
         {color[0], color[1], color[2], static_cast<std::uint8_t>(std::lround(alpha * 255.0))}});
  }

  const PlanView& plan_;
  double pixel_;
  std::vector<OverlayVertex> vertices_;
};

// The outline of the view's volume seen from above, cut off at twice the picture's radius.
std::vector<Point> frustumOutline(const OverlayBuilder& builder, const PlanView& plan) {
  const View& view = plan.camera;
  const double far = std::min(view.z_far, 4.0 * plan.radius);
  std::vector<Point> corners;
  for (const double depth : {view.z_near, far}) {
    const double half = view.orthographic ? 0.5 * view.ortho_height : depth * view.tan_half_fovy;
    for (const double x : {view.shift_x - 1.0, view.shift_x + 1.0}) {
      for (const double y : {view.shift_y - 1.0, view.shift_y + 1.0}) {
        corners.push_back(builder.project(view.eye + view.forward * depth +
                                          view.right * (x * half * view.aspect) + view.up * (y * half)));
      }
    }
  }
  std::sort(corners.begin(), corners.end(),
            [](const Point& a, const Point& b) { return a.x < b.x || (a.x == b.x && a.y < b.y); });
  return geometry::convexHull(std::move(corners), [](const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x) > 0.0;
  });
}

void addOccluders(OverlayBuilder& builder, const PlanView& plan) {
  std::vector<Point> corners;
  std::vector<std::vector<Point>> polygons;
  for (const OccluderId id : plan.occluders_used) {
    const Occluder& occluder = plan.occluders->occluders[id.value];
    double lowest = std::numeric_limits<double>::infinity();
    corners.clear();
    for (const Vec3f& vertex : plan.occluders->verticesOf(occluder)) {
      lowest = std::min(lowest, static_cast<double>(vertex.y));
      corners.push_back(builder.project(Vec3d(vertex)));
    }
    if (lowest <= plan.cut_height) {
      polygons.push_back(corners);
    }
  }
  for (const std::vector<Point>& polygon : polygons) {
    builder.fill(polygon, kPlanOccluder, 0.09);
  }
  for (const std::vector<Point>& polygon : polygons) {
    builder.outline(polygon, kPlanOccluder, 3.0);
  }
}

}  // namespace

std::vector<OverlayVertex> planOverlay(const PlanView& plan) {
  OverlayBuilder builder(plan);
  if (plan.occluders) {
    addOccluders(builder, plan);
  }
  const std::vector<Point> frustum = frustumOutline(builder, plan);
  builder.outline(frustum, kPlanBackground, 4.0);
  builder.outline(frustum, kPlanCamera, 2.0);
  const Point eye = builder.project(plan.camera.eye);
  builder.disc(eye, kPlanBackground, 8.0);
  builder.disc(eye, kPlanCamera, 6.0);
  return builder.take();
}

}  // namespace sightline::render
