// Based on: Poon, Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. IV 1999, section 4.
// Differs from the paper in: the pictures are made on the processor.
//
// An occluder's plane n . r = -h, with r relative to the eye and h the eye's height over the plane, is in
// camera space z (n_x u + n_y v + n_z) = -h, where u = x / z and v = y / z. So the reciprocal depth 1 / z is
// -(n_x u + n_y v + n_z) / h, linear in the picture.

#include "src/comparison/occluders/occluder_picture.h"

#include <cmath>
#include <numbers>

#include "src/geometry/clip_convex.h"

namespace sightline::comparison {
namespace {

constexpr double kFarthest = 1e12;  // metres; beyond it everything has the same reciprocal depth

// The area of a polygon in the picture, in pixels, by the shoelace formula.
double areaOf(std::span<const geometry::PixelPoint> corners) {
  double twice = 0.0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const geometry::PixelPoint& a = corners[i];
    const geometry::PixelPoint& b = corners[i + 1 < corners.size() ? i + 1 : 0];
    twice += a.x * b.y - b.x * a.y;
  }
  return 0.5 * std::abs(twice);
}

}  // namespace

scene::PixelView pictureView(const Vec3d& eye, const Vec3d& forward, const PictureShape& shape) {
  View view;
  view.eye = eye;
  setOrientation(view, forward, Vec3d(0.0, 1.0, 0.0));
  view.tan_half_fovy = std::tan(shape.view_angle_deg * std::numbers::pi / 360.0);
  view.aspect = 1.0;
  view.z_near = shape.near;
  view.z_far = kFarthest;
  return scene::PixelView(view, shape.resolution, shape.resolution);
}

void OccluderPicture::draw(const OccluderSet& set, std::span<const NearOccluder> candidates, const Vec3d& eye,
                           const Vec3d& forward, const PictureShape& shape, double min_area) {
  view_ = pictureView(eye, forward, shape);
  resolution_ = shape.resolution;
  tan_half_ = view_.middle_x / view_.scale_x;
  side_length_ = std::sqrt(1.0 + tan_half_ * tan_half_);
  highest_ = 1.0 / shape.near;
  lowest_ = 1.0 / kFarthest;
  shown_.clear();
  spans_.clear();
  for (const NearOccluder& candidate : candidates) {
    const Vec3d center = view_.toCamera(Vec3d(set[candidate.id].centroid) - eye);
    if (inPicture(center, candidate.radius)) {
      drawOne(set, candidate, min_area);
    }
  }
}

// Whether a part of a sphere may be in the picture.
bool OccluderPicture::inPicture(const Vec3d& center, double radius) const {
  const double reach = radius * side_length_;
  return center.z + radius > view_.near && center.z * tan_half_ - std::abs(center.x) > -reach &&
         center.z * tan_half_ - std::abs(center.y) > -reach;
}

// Cuts polygon_ to what is in the picture. False: nothing.
bool OccluderPicture::clip() {
  const Corner cut{};
  const double t = tan_half_, near = view_.near;
  return geometry::clipConvex(polygon_, scratch_, cut, [=](const Vec3d& p) { return p.z - near; }) &&
         geometry::clipConvex(polygon_, scratch_, cut, [=](const Vec3d& p) { return t * p.z - p.x; }) &&
         geometry::clipConvex(polygon_, scratch_, cut, [=](const Vec3d& p) { return t * p.z + p.x; }) &&
         geometry::clipConvex(polygon_, scratch_, cut, [=](const Vec3d& p) { return t * p.z - p.y; }) &&
         geometry::clipConvex(polygon_, scratch_, cut, [=](const Vec3d& p) { return t * p.z + p.y; });
}

void OccluderPicture::drawOne(const OccluderSet& set, const NearOccluder& candidate, double min_area) {
  const Occluder& occluder = set[candidate.id];
  polygon_.clear();
  for (const Vec3f& vertex : set.verticesOf(occluder)) {
    polygon_.push_back({view_.toCamera(Vec3d(vertex) - view_.eye)});
  }
  if (!clip()) {
    return;
  }
  corners_px_.clear();
  for (const Corner& corner : polygon_) {
    corners_px_.push_back({view_.pixelX(corner.position), view_.pixelY(corner.position)});
  }
  ShownOccluder shown;
  shown.id = candidate.id;
  shown.area = areaOf(corners_px_);
  if (!(shown.area >= min_area)) {
    return;
  }
  shown.first_span = static_cast<std::uint32_t>(spans_.size());
  geometry::forEachCentreSpan(
      corners_px_, resolution_, resolution_, [&](std::uint32_t y, std::uint32_t first, std::uint32_t last) {
        spans_.push_back({static_cast<std::uint16_t>(y), static_cast<std::uint16_t>(first),
                          static_cast<std::uint16_t>(last)});
        shown.pixels += last - first + 1;
      });
  shown.span_count = static_cast<std::uint32_t>(spans_.size()) - shown.first_span;
  if (shown.pixels == 0) {
    return;
  }
  const Vec3d normal = view_.toCamera(occluder.plane.normal) / -occluder.plane.evaluate(view_.eye);
  shown.along_x = normal.x / view_.scale_x;
  shown.along_y = normal.y / view_.scale_y;
  shown.at_origin = normal.z - shown.along_x * view_.middle_x - shown.along_y * view_.middle_y;
  shown_.push_back(shown);
}

}  // namespace sightline::comparison
