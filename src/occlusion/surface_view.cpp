#include "src/occlusion/surface_view.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace sightline::occlusion {
namespace {

constexpr double kNearMargin = 1e-6;
constexpr double kBorder = 2.0 / kGridStep;  // pixels by which rectangles are widened
// A patch is flat if its thickness is at most this fraction of its depth, and that of a cluster.
constexpr double kFlat = 1.0 / 64.0;
constexpr std::int32_t kSmall = 64;  // pixels of the rectangle of a cluster whose triangles are not looked at

// A bound of the coordinates of what lies in a box and is projected in batches: metres in an orthographic
// view, divided by their depth in a perspective one.
double reachOf(const Box& box, const PixelView& view) {
  // Boxes seen at a larger slope are too near for single precision, and pixel_boxes gives them no rectangle.
  constexpr double kLargestSlope = 0x1p15;
  const Vec3d far = max(abs(Vec3d(box.min) - view.eye), abs(Vec3d(box.max) - view.eye));
  return view.orthographic ? far.x + far.y + far.z : kLargestSlope;
}

}  // namespace

void SurfaceView::begin(const SurfaceSet& set, const PixelView& view, double min_pixels,
                        const DepthTarget& target) {
  set_ = &set;
  view_ = view;
  min_pixels_ = min_pixels;
  target_ = target;
  clip_depth_ = view.near * (1.0 + kNearMargin);
  setViewers();
  listed_.resize(set.parts.size());
  projection_ = BoxProjection(view, target.width, target.height);
  batches_ = view.stretch * reachOf(set.bounds, view) * std::max(view.scale_x, view.scale_y) +
                 std::abs(view.middle_x) + std::abs(view.middle_y) <
             kLargestGrid / kGridStep;
  clusters_.clear();
  parts_.clear();
}

void SurfaceView::listParts(std::span<const ObjectId> objects) {
  candidates_.clear();
  if (view_.sane()) {
    findCandidates(objects);
  }
  imagesOfCandidates(unsorted_);
  sortParts();
}

void SurfaceView::listParts(std::span<const std::uint32_t> parts) {
  candidates_.clear();
  if (view_.sane()) {
    candidates_.assign(parts.begin(), parts.end());
  }
  imagesOfCandidates(parts_);
}

void SurfaceView::imagesOfCandidates(std::vector<PartImage>& images) {
  boxes_.clear();
  for (const std::uint32_t part : candidates_) {
    boxes_.push_back(set_->part_bounds[part]);
  }
  project(boxes_, images_);
  images.clear();
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    BoxExtent extent;
    if (extentOf(boxes_[i], images_[i], extent) && extent.rectangle.area() >= min_pixels_) {
      images.push_back({candidates_[i], extent.rectangle, nearestOf(extent)});
    }
  }
}

void SurfaceView::setNeeds(std::span<const Box> boxes, NeedMap& needs) {
  needs.clear(target_);
  if (!view_.sane()) {
    return;
  }
  project(boxes, images_);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    BoxExtent extent;
    if (extentOf(boxes[i], images_[i], extent) && !extent.cut) {
      needs.add(extent.rectangle, nearestOf(extent));
    }
  }
}

void SurfaceView::setViewers() {
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
double SurfaceView::tooNear() const {
  return (view_.viewers.radius + view_.viewers.near_distance) * (1.0 + kNearMargin);
}

// Whether all of a slab is farther from all viewers than that. thickness: before the plane.
bool SurfaceView::clearOfViewers(const Plane& support, double thickness) const {
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

// Sets candidates_ to the parts of the objects that may be large enough.
void SurfaceView::findCandidates(std::span<const ObjectId> objects) {
  boxes_.clear();
  for (const ObjectId object : objects) {
    if (!set_->partsOf(object).empty()) {
      objects_.push_back(object);
      boxes_.push_back(set_->object_bounds[object.value]);
    }
  }
  project(boxes_, images_);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    BoxExtent extent;
    if (!extentOf(boxes_[i], images_[i], extent) && !extent.inexact) {
      continue;
    }
    const std::span<const std::uint32_t> parts = set_->partsOf(objects_[i]);
    const std::span<const float> sizes = set_->sizesOf(objects_[i]);
    const double smallest = smallestOf(extent);
    for (std::size_t k = 0; k < parts.size() && !(sizes[k] < smallest); ++k) {
      if (!listed_[parts[k]]) {
        listed_[parts[k]] = true;
        candidates_.push_back(parts[k]);
      }
    }
  }
  for (const std::uint32_t part : candidates_) {
    listed_[part] = false;
  }
  objects_.clear();
  boxes_.clear();
}

// The least diameter, in metres, of a part of an object that may have min_pixels.
double SurfaceView::smallestOf(const BoxExtent& object) const {
  if (object.inexact) {
    return 0.0;
  }
  // The rectangle of a part is at most so much larger than its image, which has at most its diameter.
  constexpr double kRectangle = 0.5;
  const double depth = view_.orthographic ? 1.0 : std::max(object.nearest, clip_depth_);
  return kRectangle * std::sqrt(min_pixels_) * depth / std::max(view_.scale_x, view_.scale_y);
}

// Sorts the parts by the leading bits of their depth, the nearest first; equal ones stay as they are.
void SurfaceView::sortParts() {
  constexpr std::uint32_t kShift = 20, kKeys = 1u << (32 - kShift);
  const auto keyOf = [](const PartImage& part) {
    const auto bits = std::bit_cast<std::uint32_t>(part.nearest);
    const std::uint32_t ascending = (bits >> 31) != 0 ? ~bits : bits | 0x80000000u;
    return kKeys - 1 - (ascending >> kShift);
  };
  constexpr std::size_t kFew = 16;
  if (unsorted_.size() <= kFew) {
    parts_.clear();
    for (const PartImage& part : unsorted_) {
      const auto later = std::find_if(parts_.begin(), parts_.end(),
                                      [&](const PartImage& other) { return keyOf(other) > keyOf(part); });
      parts_.insert(later, part);
    }
    return;
  }
  first_of_key_.assign(kKeys + 1, 0);
  for (const PartImage& part : unsorted_) {
    ++first_of_key_[keyOf(part) + 1];
  }
  std::partial_sum(first_of_key_.begin(), first_of_key_.end(), first_of_key_.begin());
  parts_.resize(unsorted_.size());
  for (const PartImage& part : unsorted_) {
    parts_[first_of_key_[keyOf(part)]++] = part;
  }
}

float SurfaceView::nearestOf(const BoxExtent& extent) const {
  const double value = view_.reciprocalDepth(std::max(extent.nearest, clip_depth_));
  return static_cast<float>(value + 1e-6 * std::abs(value));
}

PatchSide SurfaceView::sideOf(std::uint32_t number) const {
  const SurfacePatch& patch = set_->patches[number];
  const double cone = patch.cone_cosine;
  if (!(cone > 0.0)) {
    return {.side = 0, .travel = std::numeric_limits<double>::infinity()};
  }
  // On which side of the patch's slab the eye is, and how far from it; and how far away the patch is along
  // it.
  const Box& bounds = set_->patch_bounds[number];
  const Vec3d middle = view_.orthographic ? view_.unit_z : center(bounds) - view_.eye;
  const double along = dot(patch.support.normal, middle);
  const double height = view_.orthographic ? -along : patch.support.evaluate(view_.eye);
  const double thickness = view_.orthographic ? 0.0 : patch.thickness;
  const double above = std::max(height - thickness, -height);
  const double radius = view_.orthographic ? 0.0 : 0.5 * length(Vec3d(bounds.extent()));
  const double beside = std::sqrt(std::max(0.0, dot(middle, middle) - along * along)) + radius;
  const double sine = std::sqrt(std::max(0.0, 1.0 - cone * cone));
  const double slack = above * cone - beside * sine;
  const std::int32_t nearer_side = height > 0.0 ? 1 : -1;
  // When the eye moves by a metre, `above` and `beside` change by at most one.
  return {.side = slack > 0.0 && above > 0.0 ? nearer_side : 0,
          .travel = view_.orthographic ? 0.0 : 0.999 * std::abs(slack) / (cone + sine)};
}

void SurfaceView::imagesOf(std::span<const ShownPatch> patches, double min_pixels,
                           std::vector<PatchImage>& images) {
  boxes_.clear();
  for (const ShownPatch& shown : patches) {
    boxes_.push_back(set_->patch_bounds[shown.patch]);
  }
  project(boxes_, images_);
  images.clear();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    BoxExtent extent;
    if (!extentOf(boxes_[i], images_[i], extent) || extent.rectangle.area() < min_pixels) {
      continue;
    }
    PatchImage image;
    image.patch = patches[i].patch;
    image.rectangle = extent.rectangle;
    image.nearest = nearestOf(extent);
    image.flat = set_->patches[image.patch].thickness <= kFlat * std::max(extent.nearest, clip_depth_);
    const SurfacePatch& patch = set_->patches[image.patch];
    const bool whole =
        !extent.cut && (!extent.among_viewers || clearOfViewers(patch.support, patch.thickness));
    image.sign = image.flat && whole ? patches[i].side : 0;
    image.farthest = extent.farthest;
    images.push_back(image);
  }
}

void SurfaceView::setDepth(PatchImage& image) const {
  const SurfacePatch& patch = set_->patches[image.patch];
  image.depth = boundOf(behind(patch.support, patch.thickness, image.sign), image.farthest);
}

void SurfaceView::addClusters(const SurfacePatch& patch, PatchImage& image) {
  image.first = static_cast<std::uint32_t>(clusters_.size());
  std::int32_t signs = 0;
  double farthest = 0.0;
  project(std::span(set_->cluster_bounds).subspan(patch.first_cluster, patch.cluster_count), images_);
  for (std::uint32_t i = 0; i < patch.cluster_count; ++i) {
    ClusterImage cluster;
    double depth = 0.0;
    if (chooseCluster(patch.first_cluster + i, images_[i], cluster, depth)) {
      clusters_.push_back(cluster);
      signs += cluster.sign;
      farthest = std::max(farthest, depth);
    }
  }
  image.count = static_cast<std::uint32_t>(clusters_.size()) - image.first;
  if (image.count == 1) {
    image.flat = clusters_.back().flat;
    image.rectangle = clusters_.back().rectangle;
    image.depth = clusters_.back().depth;
    return;
  }
  image.flat = image.flat && std::abs(signs) == static_cast<std::int32_t>(image.count);
  if (image.flat && image.count > 0) {
    image.depth = boundOf(behind(patch.support, patch.thickness, signs), farthest);
  }
}

void SurfaceView::addClusters(std::span<const std::uint32_t> numbers) {
  boxes_.clear();
  for (const std::uint32_t number : numbers) {
    boxes_.push_back(set_->cluster_bounds[number]);
  }
  project(boxes_, images_);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    ClusterImage cluster;
    double depth = 0.0;
    if (chooseCluster(numbers[i], images_[i], cluster, depth)) {
      clusters_.push_back(cluster);
    }
  }
}

// farthest: receives a bound of its depth, metres.
bool SurfaceView::chooseCluster(std::uint32_t number, const PixelBox& box, ClusterImage& image,
                                double& farthest) const {
  const SurfaceCluster& cluster = set_->clusters[number];
  const double height = view_.orthographic ? -dot(cluster.support.normal, view_.unit_z)
                                           : cluster.support.evaluate(view_.eye) - 0.5 * cluster.thickness;
  image.sign = height > 0.0 ? 1 : cluster.double_sided ? -1 : 0;
  BoxExtent extent;
  if (image.sign == 0 || !extentOf(set_->cluster_bounds[number], box, extent)) {
    return false;
  }
  if (extent.among_viewers && !clearOfViewers(cluster.support, cluster.thickness)) {
    return false;
  }
  farthest = extent.farthest;
  image.cluster = number;
  image.cut = extent.cut;
  image.rectangle = extent.rectangle;
  image.flat = cluster.thickness <= kFlat * std::max(extent.nearest, clip_depth_);
  image.depth = boundOf(behind(cluster.support, cluster.thickness, image.sign), extent.farthest);
  return true;
}

void SurfaceView::addDepths(const ClusterImage& image, std::vector<PartDepth>& depths) {
  if (image.flat || image.rectangle.area() < kSmall) {
    depths.push_back({image.rectangle, image.depth});
    return;
  }
  // Triangle by triangle. Where the surface hides something, it shows its front there.
  const std::span<const std::uint32_t> corners = set_->trianglesOf(set_->clusters[image.cluster]);
  boxes_.clear();
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    Box box;
    for (std::size_t k = i; k < i + 3; ++k) {
      box.extend(set_->vertices[corners[k]]);
    }
    boxes_.push_back(box);
  }
  project(boxes_, images_);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    BoxExtent extent;
    // What lies beyond the far plane has a depth too, although it is outside the view.
    const PixelBox& image_of_box = images_[i / 3];
    const bool known = image_of_box.place == BoxPlace::kOutside
                           ? extentOf(boxes_[i / 3], extent)
                           : extentOf(boxes_[i / 3], image_of_box, extent);
    if (!known) {
      if (extent.inexact) {
        depths.push_back({image.rectangle, image.depth});
      }
      continue;
    }
    const Vec3f &a = set_->vertices[corners[i]], &b = set_->vertices[corners[i + 1]],
                &c = set_->vertices[corners[i + 2]];
    const Vec3d p = Vec3d(a) - view_.eye, u = Vec3d(b) - Vec3d(a), v = Vec3d(c) - Vec3d(a);
    const Vec3d normal = cross(u, v) * image.sign;
    const double size = length(u) * length(v),
                 reach = maxComponent(abs(p)) + maxComponent(abs(u)) + maxComponent(abs(v));
    // The value of the plane through the triangle at the eye.
    const double height = view_.orthographic ? -dot(normal, view_.unit_z) : -dot(normal, p);
    if (height < -1e-9 * size * (view_.orthographic ? 1.0 : reach)) {
      continue;
    }
    depths.push_back(
        {extent.rectangle, boundOf(normal, -dot(normal, p) + 1e-14 * reach * size, size, extent.farthest)});
  }
}

void SurfaceView::project(std::span<const Box> boxes, std::vector<PixelBox>& images) const {
  images.resize(std::max(images.size(), boxes.size()));
  projectBoxes(projection_, boxes, images);
}

// False: outside the view, or its image cannot be computed exactly enough. What lies beyond the far plane is
// outside too: it may be left out of a surface, but not out of the depth of one.
bool SurfaceView::extentOf(const Box& box, const PixelBox& image, BoxExtent& extent) const {
  if (image.place == BoxPlace::kOutside) {
    return false;
  }
  if (image.place == BoxPlace::kOnBuffer && batches_) {
    extent.nearest = view_.orthographic ? -image.nearest : 1.0 / image.nearest;
    extent.farthest = view_.orthographic ? -image.farthest : 1.0 / image.farthest;
    extent.rectangle = {image.x0, image.y0, image.x1 + 1, image.y1 + 1};
    if (extent.nearest > clip_depth_ && extent.nearest > viewers_max_.z) {
      return true;
    }
  }
  return extentOf(box, extent);
}

bool SurfaceView::extentOf(const Box& box, BoxExtent& extent) const {
  const PixelView& view = view_;
  const Vec3d middle = view.toCamera(center(box) - view.eye), half = (Vec3d(box.max) - Vec3d(box.min)) * 0.5;
  const Vec3d size{dot(abs(view.right), half), dot(abs(view.up), half), dot(abs(view.forward), half)};
  const double reach = maxComponent(abs(middle)) + maxComponent(size);
  const double rounding = 1e-14 * reach * view.stretch;
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

Plane SurfaceView::behind(const Plane& support, double thickness, std::int32_t sign) const {
  Plane plane = support;
  if (sign < 0) {
    plane = plane.flipped();
    plane.offset += thickness;
  }
  return plane;
}

DepthBound SurfaceView::boundOf(const Plane& plane, double farthest) const {
  return boundOf(plane.normal, plane.evaluate(view_.eye), 1.0, farthest);
}

DepthBound SurfaceView::boundOf(const Vec3d& normal, double at_eye, double size, double farthest) const {
  const PixelView& view = view_;
  const double floor = view.reciprocalDepth(farthest);
  DepthBound bound;
  bound.floor = static_cast<float>(floor - 1e-6 * std::abs(floor));
  bound.at_origin = bound.floor;
  // Reciprocal depth of the plane: n . (x, y, 1) in camera space over minus its value at the eye; in an
  // orthographic view minus the depth.
  const Vec3d n = view.normalToCamera(normal);
  const double slope = view.orthographic ? n.z : -at_eye;
  if (!(slope < (view.orthographic ? -1e-3 * size : -1e-9 * size * farthest))) {
    return bound;
  }
  // Rays through pixel (x, y): camera x is (x - middle) / scale, times the depth in a perspective view.
  const double inverse = view.orthographic ? view.metres / slope : 1.0 / (slope * view.metres);
  const double a = n.x * inverse / view.scale_x, b = n.y * inverse / view.scale_y;
  const double constant = (view.orthographic ? at_eye : n.z) * inverse;
  const double c = constant - a * view.middle_x - b * view.middle_y;
  const double range = std::abs(a) * target_.width + std::abs(b) * target_.height + std::abs(c);
  if (!(range < 1e30)) {
    return bound;
  }
  // The least over the pixel's square, and less than rounding.
  bound.along_x = static_cast<float>(a);
  bound.along_y = static_cast<float>(b);
  bound.at_origin = static_cast<float>(c + std::min(a, 0.0) + std::min(b, 0.0) - 1e-6 * range);
  return bound;
}

}  // namespace sightline::occlusion
