#include "src/occlusion/surfaces/box_extents.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/occlusion/eye_box.h"
#include "src/occlusion/surfaces/boundary_edge.h"

namespace sightline::occlusion {
namespace {

constexpr double kNearMargin = 1e-6;
constexpr double kBorder = 2.0 / kGridStep;  // pixels by which rectangles are widened

// A bound of the coordinates of what lies in a box and is projected in batches: metres in an orthographic
// view, divided by their depth in a perspective one.
double reachOf(const Box& box, const scene::PixelView& view) {
  // Boxes seen at a larger slope are too near for single precision, and pixel_boxes gives them no rectangle.
  constexpr double kLargestSlope = 0x1p15;
  const Vec3d far = EyeBox::of(box, view.eye).reach();
  return view.orthographic ? far.x + far.y + far.z : kLargestSlope;
}

}  // namespace

void BoxExtents::begin(const scene::PixelView& view, const Box& bounds, const DepthTarget& target) {
  view_ = view;
  target_ = target;
  clip_depth_ = view.near * (1.0 + kNearMargin);
  setViewers();
  projection_ = BoxProjection(view, target.width, target.height);
  batches_ = view.stretch * reachOf(bounds, view) * std::max(view.scale_x, view.scale_y) +
                 std::abs(view.middle_x) + std::abs(view.middle_y) <
             kLargestGrid / kGridStep;
}

void BoxExtents::setViewers() {
  constexpr double kNobody = std::numeric_limits<double>::infinity();
  viewers_min_ = Vec3d(kNobody, kNobody, kNobody);
  viewers_max_ = -viewers_min_;
  const ViewerRegion& viewers = view_.viewers;
  if (viewers.several()) {
    const double around = tooNear();
    viewers_min_ = min(Vec3d(), min(viewers.offsets[0], viewers.offsets[1])) - Vec3d(around, around, around);
    viewers_max_ = max(Vec3d(), max(viewers.offsets[0], viewers.offsets[1])) + Vec3d(around, around, around);
  }
}

// What is so near to the triangle of a ViewerRegion may be too near to one of the viewers; camera space.
double BoxExtents::tooNear() const {
  return (view_.viewers.radius + view_.viewers.near_distance) * (1.0 + kNearMargin);
}

bool BoxExtents::clearOfViewers(const Plane& support, double thickness) const {
  const Vec3d normal = view_.normalToCamera(support.normal);
  const double at_eye = support.evaluate(view_.eye);
  double lowest = at_eye, highest = at_eye, size = 0.0;
  for (const Vec3d& offset : view_.viewers.offsets) {
    const double height = at_eye + dot(normal, offset);
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
    size += maxComponent(abs(offset));
  }
  const double around = (tooNear() + kNearMargin * size) * view_.stretch;
  return lowest > thickness + around || highest < -around;
}

float BoxExtents::nearestOf(const BoxExtent& extent) const {
  const double value = view_.reciprocalDepth(std::max(extent.nearest, clip_depth_));
  return static_cast<float>(value + 1e-6 * std::abs(value));
}

void BoxExtents::project(std::span<const Box> boxes, std::vector<PixelBox>& images) const {
  images.resize(std::max(images.size(), boxes.size()));
  projectBoxes(projection_, boxes, images);
}

bool BoxExtents::of(const Box& box, const PixelBox& image, BoxExtent& extent) const {
  if (image.place == BoxPlace::kOutside) {
    return false;
  }
  if (image.place == BoxPlace::kOnBuffer && batches_) {
    extent.nearest = view_.orthographic ? -image.nearest : 1.0 / image.nearest;
    extent.farthest = view_.orthographic ? -image.farthest : 1.0 / image.farthest;
    extent.rectangle = {image.x0, image.y0, image.x1 + 1, image.y1 + 1};
    if (extent.nearest - view_.depth_rounding > clip_depth_ && extent.nearest > viewers_max_.z) {
      return true;
    }
  }
  return of(box, extent);
}

bool BoxExtents::of(const Box& box, BoxExtent& extent) const {
  const scene::PixelView& view = view_;
  const Vec3d middle = view.toCamera(center(box) - view.eye), half = (Vec3d(box.max) - Vec3d(box.min)) * 0.5;
  const Vec3d size{dot(abs(view.right), half), dot(abs(view.up), half), dot(abs(view.forward), half)};
  const double reach = maxComponent(abs(middle)) + maxComponent(size);
  const double rounding = 1e-14 * reach * view.stretch + view.depth_rounding;
  extent.nearest = middle.z - size.z - rounding;
  extent.farthest = middle.z + size.z + rounding;
  if (!(extent.farthest > clip_depth_)) {
    return false;
  }
  extent.cut = !(extent.nearest > clip_depth_);
  const Vec3d spare(rounding, rounding, rounding), low = middle - size - spare, high = middle + size + spare;
  extent.among_viewers = low.x < viewers_max_.x && high.x > viewers_min_.x && low.y < viewers_max_.y &&
                         high.y > viewers_min_.y && low.z < viewers_max_.z && high.z > viewers_min_.z;
  extent.inexact = extent.cut && rounding > 0.5 * kNearMargin * view.near;
  const double front = std::max(extent.nearest, clip_depth_);
  const double scale = std::max(view.scale_x, view.scale_y) / (view.orthographic ? 1.0 : front);
  const double pixels = view.stretch * reach * scale + std::abs(view.middle_x) + std::abs(view.middle_y);
  extent.inexact = extent.inexact || !(pixels < kLargestGrid / kGridStep);
  if (extent.inexact) {
    return false;
  }
  const double near_inverse = view.orthographic ? 1.0 : 1.0 / front,
               far_inverse = view.orthographic ? 1.0 : 1.0 / extent.farthest;
  const auto least = [&](double v) { return std::min(v * near_inverse, v * far_inverse); };
  const auto pixel = [](double v, std::uint32_t last) {
    return static_cast<std::int32_t>(std::clamp(v, 0.0, static_cast<double>(last)));
  };
  const double x0 = view.middle_x + view.scale_x * least(middle.x - size.x),
               x1 = view.middle_x - view.scale_x * least(-middle.x - size.x),
               y0 = view.middle_y + view.scale_y * least(middle.y - size.y),
               y1 = view.middle_y - view.scale_y * least(-middle.y - size.y);
  extent.rectangle = {pixel(x0 - kBorder, target_.width), pixel(y0 - kBorder, target_.height),
                      pixel(x1 + kBorder + 1.0, target_.width), pixel(y1 + kBorder + 1.0, target_.height)};
  return !extent.rectangle.empty();
}

}  // namespace sightline::occlusion
