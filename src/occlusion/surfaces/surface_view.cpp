#include "src/occlusion/surfaces/surface_view.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

namespace sightline::occlusion {
namespace {

// A patch is flat if its thickness is at most this fraction of its depth, and that of a cluster.
constexpr double kFlat = 1.0 / 64.0;
constexpr std::int32_t kSmall = 64;  // pixels of the rectangle of a cluster whose triangles are not looked at

}  // namespace

void SurfaceView::begin(const SurfaceSet& set, const scene::PixelView& view, double min_pixels,
                        const DepthTarget& target) {
  set_ = &set;
  extents_.begin(view, set.bounds, target);
  target_ = target;
  min_pixels_ = min_pixels;
  listed_.resize(set.parts.size());
  clusters_.clear();
  parts_.clear();
}

void SurfaceView::listParts(std::span<const ObjectId> objects) {
  candidates_.clear();
  if (view().sane()) {
    findCandidates(objects);
  }
  imagesOfCandidates(unsorted_);
  sortParts();
}

void SurfaceView::listParts(std::span<const std::uint32_t> parts) {
  candidates_.clear();
  if (view().sane()) {
    candidates_.assign(parts.begin(), parts.end());
  }
  imagesOfCandidates(parts_);
}

void SurfaceView::imagesOfCandidates(std::vector<PartImage>& images) {
  boxes_.clear();
  for (const std::uint32_t part : candidates_) {
    boxes_.push_back(set_->part_bounds[part]);
  }
  extents_.project(boxes_, images_);
  images.clear();
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    BoxExtent extent;
    if (extents_.of(boxes_[i], images_[i], extent) && extent.rectangle.area() >= min_pixels_) {
      images.push_back({candidates_[i], extent.rectangle, extents_.nearestOf(extent)});
    }
  }
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
  extents_.project(boxes_, images_);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    BoxExtent extent;
    if (!extents_.of(boxes_[i], images_[i], extent) && !extent.inexact) {
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
  const double depth = view().orthographic ? 1.0 : std::max(object.nearest, clipDepth());
  return kRectangle * std::sqrt(min_pixels_) * depth / std::max(view().scale_x, view().scale_y);
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

PatchSide SurfaceView::sideOf(std::uint32_t number) const {
  const SurfacePatch& patch = set_->patches[number];
  const double cone = patch.cone_cosine;
  if (!(cone > 0.0)) {
    return {.side = 0, .travel = std::numeric_limits<double>::infinity()};
  }
  // On which side of the patch's slab the eye is, and how far from it; and how far away the patch is along
  // it.
  const Box& bounds = set_->patch_bounds[number];
  const Vec3d middle = view().orthographic ? view().unit_z : center(bounds) - view().eye;
  const double along = dot(patch.support.normal, middle);
  const double height = view().orthographic ? -along : patch.support.evaluate(view().eye);
  const double thickness = view().orthographic ? 0.0 : patch.thickness;
  const double above = std::max(height - thickness, -height);
  const double radius = view().orthographic ? 0.0 : 0.5 * length(Vec3d(bounds.extent()));
  const double beside = std::sqrt(std::max(0.0, dot(middle, middle) - along * along)) + radius;
  const double sine = std::sqrt(std::max(0.0, 1.0 - cone * cone));
  const double slack = above * cone - beside * sine;
  const std::int32_t nearer_side = height > 0.0 ? 1 : -1;
  // When the eye moves by a metre, `above` and `beside` change by at most one.
  return {.side = slack > 0.0 && above > 0.0 ? nearer_side : 0,
          .travel = view().orthographic ? 0.0 : 0.999 * std::abs(slack) / (cone + sine)};
}

void SurfaceView::imagesOf(std::span<const ShownPatch> patches, double min_pixels,
                           std::vector<PatchImage>& images) {
  boxes_.clear();
  for (const ShownPatch& shown : patches) {
    boxes_.push_back(set_->patch_bounds[shown.patch]);
  }
  extents_.project(boxes_, images_);
  images.clear();
  for (std::size_t i = 0; i < patches.size(); ++i) {
    BoxExtent extent;
    if (!extents_.of(boxes_[i], images_[i], extent) || extent.rectangle.area() < min_pixels) {
      continue;
    }
    PatchImage image;
    image.patch = patches[i].patch;
    image.rectangle = extent.rectangle;
    image.nearest = extents_.nearestOf(extent);
    image.flat = set_->patches[image.patch].thickness <= kFlat * std::max(extent.nearest, clipDepth());
    const SurfacePatch& patch = set_->patches[image.patch];
    const bool whole =
        !extent.cut && (!extent.among_viewers || extents_.clearOfViewers(patch.support, patch.thickness));
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
  extents_.project(std::span(set_->cluster_bounds).subspan(patch.first_cluster, patch.cluster_count),
                   images_);
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
  extents_.project(boxes_, images_);
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
  const double height = view().orthographic ? -dot(cluster.support.normal, view().unit_z)
                                            : cluster.support.evaluate(view().eye) - 0.5 * cluster.thickness;
  image.sign = height > 0.0 ? 1 : cluster.double_sided ? -1 : 0;
  BoxExtent extent;
  if (image.sign == 0 || !extents_.of(set_->cluster_bounds[number], box, extent)) {
    return false;
  }
  if (extent.among_viewers && !extents_.clearOfViewers(cluster.support, cluster.thickness)) {
    return false;
  }
  farthest = extent.farthest;
  image.cluster = number;
  image.cut = extent.cut;
  image.rectangle = extent.rectangle;
  image.flat = cluster.thickness <= kFlat * std::max(extent.nearest, clipDepth());
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
  extents_.project(boxes_, images_);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    BoxExtent extent;
    // What lies beyond the far plane has a depth too, although it is outside the view.
    const PixelBox& image_of_box = images_[i / 3];
    const bool known = image_of_box.place == BoxPlace::kOutside
                           ? extents_.of(boxes_[i / 3], extent)
                           : extents_.of(boxes_[i / 3], image_of_box, extent);
    if (!known) {
      if (extent.inexact) {
        depths.push_back({image.rectangle, image.depth});
      }
      continue;
    }
    const Vec3f &a = set_->vertices[corners[i]], &b = set_->vertices[corners[i + 1]],
                &c = set_->vertices[corners[i + 2]];
    const Vec3d p = Vec3d(a) - view().eye, u = Vec3d(b) - Vec3d(a), v = Vec3d(c) - Vec3d(a);
    const Vec3d normal = cross(u, v) * image.sign;
    const double size = length(u) * length(v),
                 reach = maxComponent(abs(p)) + maxComponent(abs(u)) + maxComponent(abs(v));
    // The value of the plane through the triangle at the eye.
    const double height = view().orthographic ? -dot(normal, view().unit_z) : -dot(normal, p);
    if (height < -1e-9 * size * (view().orthographic ? 1.0 : reach)) {
      continue;
    }
    depths.push_back(
        {extent.rectangle, boundOf(normal, -dot(normal, p) + 1e-14 * reach * size, size, extent.farthest)});
  }
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
  return boundOf(plane.normal, plane.evaluate(view().eye), 1.0, farthest);
}

DepthBound SurfaceView::boundOf(const Vec3d& normal, double at_eye, double size, double farthest) const {
  const scene::PixelView& view = extents_.view();
  const double floor = view.reciprocalDepth(farthest);
  // In perspective, what rounding of inSpace() makes of a depth is less than the margins below, each of which
  // is a fraction of the value.
  const double rounding = view.orthographic ? view.depth_rounding * view.metres : 0.0;
  DepthBound bound;
  bound.floor = static_cast<float>(floor - 1e-6 * std::abs(floor) - rounding);
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
  // inSpace() may also move the plane by 2^-16 pixels.
  const double sideways = view.depth_rounding > 0.0 ? 0x1p-16 * (std::abs(a) + std::abs(b)) : 0.0;
  if (!(range < 1e30)) {
    return bound;
  }
  // The least over the pixel's square, and less than rounding.
  bound.along_x = static_cast<float>(a);
  bound.along_y = static_cast<float>(b);
  bound.at_origin =
      static_cast<float>(c + std::min(a, 0.0) + std::min(b, 0.0) - 1e-6 * range - rounding - sideways);
  return bound;
}

}  // namespace sightline::occlusion
