#include "src/occlusion/chain_points.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

namespace sightline::occlusion {

void ChainPoints::begin(const SurfaceSet& set, const PixelView& view, double clip_depth) {
  view_ = view;
  clip_depth_ = clip_depth;
  points_.clear();
  set_ = &set;
  images_.resize(std::max<std::size_t>(images_.size(), set.chains.size()));
  if (++number_ == 0) {
    std::fill(images_.begin(), images_.end(), Image{});
    number_ = 1;
  }
}

GridPoint ChainPoints::pixelOf(const Vec3d& camera) const {
  const double inverse = view_.inverseDepth(camera);
  return {std::nearbyint(view_.pixelX(camera, inverse) * kGridStep),
          std::nearbyint(view_.pixelY(camera, inverse) * kGridStep)};
}

// Where an edge crosses the clip plane; the same from both sides.
GridPoint ChainPoints::cutPoint(const Vec3f& a, const Vec3f& b) const {
  const bool ascending = std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  const Vec3d from = toCamera(ascending ? a : b), to = toCamera(ascending ? b : a);
  const double t = (clip_depth_ - from.z) / (to.z - from.z);
  Vec3d point = from + (to - from) * t;
  point.z = clip_depth_;
  return pixelOf(point);
}

void ChainPoints::project(std::uint32_t chain, Image& image) {
  const std::span<const Vec3f> vertices = set_->verticesOf(set_->chains[chain]);
  image = {number_, static_cast<std::uint32_t>(points_.size()), 0, false};
  for (const Vec3f& vertex : vertices) {
    const Vec3d camera = toCamera(vertex);
    image.clipped = image.clipped || camera.z < clip_depth_;
    if (image.clipped) {
      break;
    }
    points_.push_back(pixelOf(camera));
  }
  if (image.clipped) {
    points_.resize(image.first);
    for (std::size_t i = 1; i < vertices.size(); ++i) {
      const Vec3d from = toCamera(vertices[i - 1]), to = toCamera(vertices[i]);
      const bool from_shows = from.z >= clip_depth_, to_shows = to.z >= clip_depth_;
      if (from_shows || to_shows) {
        points_.push_back(from_shows ? pixelOf(from) : cutPoint(vertices[i - 1], vertices[i]));
        points_.push_back(to_shows ? pixelOf(to) : cutPoint(vertices[i - 1], vertices[i]));
      }
    }
  }
  image.count = static_cast<std::uint32_t>(points_.size()) - image.first;
}

bool ChainPoints::cut(std::span<const std::uint32_t, 3> triangle, GridSegment& line) const {
  bool shows[3];
  for (std::size_t k = 0; k < 3; ++k) {
    shows[k] = toCamera(set_->vertices[triangle[k]]).z >= clip_depth_;
  }
  if (shows[0] == shows[1] && shows[1] == shows[2]) {
    return false;
  }
  // From where the border of the triangle leaves to where it comes back.
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if (shows[k] != shows[next]) {
      (shows[k] ? line.from : line.to) =
          cutPoint(set_->vertices[triangle[k]], set_->vertices[triangle[next]]);
    }
  }
  return true;
}

}  // namespace sightline::occlusion
