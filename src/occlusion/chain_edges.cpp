#include "src/occlusion/chain_edges.h"

#include <algorithm>
#include <tuple>

namespace sightline::occlusion {
namespace {

// The nearest whole number; halves go to the even one.
double nearestWhole(double v) {
  constexpr double kWhole = 0x1.8p52;  // so large numbers have no places after the point
  return (v + kWhole) - kWhole;
}

}  // namespace

void ChainEdges::reserve(const SurfaceSet& set) {
  images_.resize(std::max<std::size_t>(images_.size(), set.chains.size()));
}

void ChainEdges::begin(const SurfaceSet& set, const PixelView& view, double clip_depth,
                       const EdgeBuffer& buffer) {
  view_ = view;
  clip_depth_ = clip_depth;
  buffer_ = buffer;
  edges_.clear();
  set_ = &set;
  reserve(set);
  if (++number_ == 0) {
    std::fill(images_.begin(), images_.end(), Image{});
    number_ = 1;
  }
}

GridPoint ChainEdges::pixelOf(const Vec3d& camera) const {
  const double inverse = view_.inverseDepth(camera);
  return {nearestWhole(view_.pixelX(camera, inverse) * kGridStep),
          nearestWhole(view_.pixelY(camera, inverse) * kGridStep)};
}

// Where an edge crosses the clip plane; the same from both sides.
GridPoint ChainEdges::cutPoint(const Vec3f& a, const Vec3f& b) const {
  const bool ascending = std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  const Vec3d from = toCamera(ascending ? a : b), to = toCamera(ascending ? b : a);
  const double t = (clip_depth_ - from.z) / (to.z - from.z);
  Vec3d point = from + (to - from) * t;
  point.z = clip_depth_;
  return pixelOf(point);
}

void ChainEdges::addEdge(const GridPoint& from, const GridPoint& to) {
  const BoundaryEdge edge = prepareEdge(from, to, buffer_);
  if (edge.matters) {
    edges_.push_back(edge);
  }
}

void ChainEdges::prepare(std::uint32_t chain, Image& image) {
  const std::span<const Vec3f> vertices = set_->verticesOf(set_->chains[chain]);
  image = {number_, static_cast<std::uint32_t>(edges_.size()), 0};
  Vec3d from = toCamera(vertices[0]);
  GridPoint from_pixel = from.z >= clip_depth_ ? pixelOf(from) : GridPoint{};
  for (std::size_t i = 1; i < vertices.size(); ++i) {
    const Vec3d to = toCamera(vertices[i]);
    const bool from_shows = from.z >= clip_depth_, to_shows = to.z >= clip_depth_;
    const GridPoint to_pixel = to_shows ? pixelOf(to) : GridPoint{};
    if (from_shows && to_shows) {
      addEdge(from_pixel, to_pixel);
    } else if (from_shows || to_shows) {
      const GridPoint cut = cutPoint(vertices[i - 1], vertices[i]);
      addEdge(from_shows ? from_pixel : cut, to_shows ? to_pixel : cut);
    }
    from = to;
    from_pixel = to_pixel;
  }
  image.count = static_cast<std::uint32_t>(edges_.size()) - image.first;
}

void ChainEdges::addCut(std::span<const std::uint32_t, 3> triangle, std::int32_t value,
                        std::vector<BoundaryChain>& boundary) {
  bool shows[3];
  for (std::size_t k = 0; k < 3; ++k) {
    shows[k] = toCamera(set_->vertices[triangle[k]]).z >= clip_depth_;
  }
  if (shows[0] == shows[1] && shows[1] == shows[2]) {
    return;
  }
  // From where the border of the triangle leaves to where it comes back.
  GridPoint from, to;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if (shows[k] != shows[next]) {
      (shows[k] ? from : to) = cutPoint(set_->vertices[triangle[k]], set_->vertices[triangle[next]]);
    }
  }
  const auto first = static_cast<std::uint32_t>(edges_.size());
  addEdge(from, to);
  if (edges_.size() > first) {
    boundary.push_back({first, 1, value});
  }
}

}  // namespace sightline::occlusion
