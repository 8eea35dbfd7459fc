// Based on: Poon, Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. IV 1999, section 4.1.
// Differs from the paper in: one set of layers, sorted by depth, serves all occludees of a picture; layers
// behind all occludees of a pixel are left out; so are all but the 64 nearest of a pixel, which bounds the
// memory.

#include "src/comparison/occluders/occluder_stack.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace sightline::comparison {
namespace {

// An occluder that lies in an occludee's own front face does not hide it: it has to be nearer by more than
// the rounding of single precision.
constexpr double kInFront = 1.0 + 0x1p-17;

constexpr std::uint32_t kMaxLayers = 64;  // of a pixel

// False: not in the picture, or not wholly beyond the near plane.
bool project(const Box& box, const scene::PixelView& view, std::uint32_t resolution, Occludee& occludee) {
  const double infinity = std::numeric_limits<double>::infinity();
  double left = infinity, right = -infinity, low = infinity, high = -infinity, nearest = infinity;
  for (int i = 0; i < 8; ++i) {
    const Vec3d corner((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                       (i & 4) != 0 ? box.max.z : box.min.z);
    const Vec3d c = view.toCamera(corner - view.eye);
    if (!(c.z > view.near)) {
      return false;
    }
    left = std::min(left, view.pixelX(c));
    right = std::max(right, view.pixelX(c));
    low = std::min(low, view.pixelY(c));
    high = std::max(high, view.pixelY(c));
    nearest = std::min(nearest, c.z);
  }
  const double size = resolution;
  if (!(right > 0.0 && high > 0.0 && left < size && low < size)) {
    return false;
  }
  const auto down = [](double x) { return static_cast<std::uint32_t>(std::floor(std::max(x, 0.0))); };
  const auto up = [=](double x) { return static_cast<std::uint32_t>(std::ceil(std::min(x, size))); };
  occludee.rect = {down(left), down(low), up(right), up(high)};
  // A flat box seen from its side has a row of pixels all the same.
  occludee.rect.right = std::max(occludee.rect.right, occludee.rect.left + 1);
  occludee.rect.high = std::max(occludee.rect.high, occludee.rect.low + 1);
  occludee.reciprocal_depth = static_cast<float>(view.reciprocalDepth(nearest) * kInFront);
  return true;
}

template <typename Body>
void forEachPixel(const PixelRect& rect, std::uint32_t resolution, Body&& body) {
  for (std::uint32_t y = rect.low; y < rect.high; ++y) {
    for (std::uint32_t x = rect.left; x < rect.right; ++x) {
      body(y * resolution + x);
    }
  }
}

}  // namespace

std::vector<NodeIndex> findOccludees(const Hierarchy& hierarchy, std::uint32_t min_triangles,
                                     std::uint32_t max_triangles) {
  std::vector<NodeIndex> found;
  for (std::uint32_t n = 0; n < hierarchy.nodes.size();) {
    const HierarchyNode& node = hierarchy.nodes[n];
    if (node.cost > max_triangles && !node.leaf()) {
      ++n;
      continue;
    }
    if (node.cost > min_triangles && node.bounds.wellFormed()) {
      found.emplace_back(n);
    }
    n = hierarchy.end(NodeIndex(n));
  }
  return found;
}

void occludeesInPicture(const Hierarchy& hierarchy, std::span<const NodeIndex> nodes,
                        const scene::PixelView& view, std::uint32_t resolution,
                        std::vector<Occludee>& found) {
  found.clear();
  for (const NodeIndex node : nodes) {
    Occludee occludee{node, {}, 0.0f};
    if (project(hierarchy.nodes[node.value].bounds, view, resolution, occludee)) {
      found.push_back(occludee);
    }
  }
}

bool hides(const IdBuffer& buffer, std::uint32_t resolution, const Occludee& occludee,
           std::uint32_t& first_pixel) {
  const PixelRect& rect = occludee.rect;
  std::uint32_t x = first_pixel % resolution, y = first_pixel / resolution;
  for (; y < rect.high; ++y, x = rect.left) {
    for (; x < rect.right; ++x) {
      if (!(buffer.reciprocalDepthAt(y * resolution + x) > occludee.reciprocal_depth)) {
        first_pixel = y * resolution + x;
        return false;
      }
    }
  }
  return true;
}

std::uint64_t OccluderStack::layerOf(float reciprocal_depth, std::uint32_t occluder) {
  // ReciprocalDepth is positive, so that its bits grow with it.
  return (std::uint64_t{~std::bit_cast<std::uint32_t>(reciprocal_depth)} << 32u) | occluder;
}

void OccluderStack::build(const OccluderPicture& picture, const IdBuffer& nearest,
                          std::span<const Occludee> occludees) {
  resolution_ = picture.resolution();
  hidden_.clear();
  farthest_.assign(picture.pixelCount(), std::numeric_limits<float>::infinity());
  for (std::uint32_t i = 0; i < occludees.size(); ++i) {
    const Occludee& occludee = occludees[i];
    std::uint32_t pixel = occludee.rect.low * resolution_ + occludee.rect.left;
    if (hides(nearest, resolution_, occludee, pixel)) {
      hidden_.push_back(i);
      forEachPixel(occludee.rect, resolution_, [&](std::uint32_t p) {
        farthest_[p] = std::min(farthest_[p], occludee.reciprocal_depth);
      });
    }
  }
  first_of_.assign(picture.pixelCount() + 1, 0);
  const auto occluder_count = static_cast<std::uint32_t>(picture.occluders().size());
  for (std::uint32_t o = 0; o < occluder_count; ++o) {
    picture.forEachPixel(o, [&](std::uint32_t pixel, float reciprocal_depth) {
      first_of_[pixel + 1] += reciprocal_depth > farthest_[pixel] ? 1u : 0u;
    });
  }
  for (std::uint32_t p = 0; p < picture.pixelCount(); ++p) {
    first_of_[p + 1] = first_of_[p] + std::min(first_of_[p + 1], kMaxLayers);
  }
  layers_.resize(first_of_.back());
  end_of_.assign(first_of_.begin(), first_of_.end() - 1);
  for (std::uint32_t o = 0; o < occluder_count; ++o) {
    picture.forEachPixel(o, [&](std::uint32_t pixel, float reciprocal_depth) {
      if (reciprocal_depth > farthest_[pixel]) {
        addLayer(pixel, layerOf(reciprocal_depth, o));
      }
    });
  }
  for (std::uint32_t p = 0; p < picture.pixelCount(); ++p) {
    std::sort_heap(layers_.begin() + first_of_[p], layers_.begin() + end_of_[p]);
  }
}

// A pixel's layers are a heap while they are collected, the farthest one on top, which goes when there is no
// room for a nearer one.
void OccluderStack::addLayer(std::uint32_t pixel, std::uint64_t layer) {
  const auto begin = layers_.begin() + first_of_[pixel];
  if (end_of_[pixel] == first_of_[pixel + 1]) {
    if (layer >= *begin) {
      return;
    }
    std::pop_heap(begin, layers_.begin() + end_of_[pixel]--);
  }
  layers_[end_of_[pixel]++] = layer;
  std::push_heap(begin, layers_.begin() + end_of_[pixel]);
}

void OccluderStack::layersBefore(std::uint32_t pixel, float reciprocal_depth,
                                 std::vector<std::uint32_t>& occluders) const {
  occluders.clear();
  const std::uint64_t end = layerOf(reciprocal_depth, 0);  // the first one that is not nearer
  for (std::uint32_t i = first_of_[pixel]; i < end_of_[pixel] && layers_[i] < end; ++i) {
    occluders.push_back(static_cast<std::uint32_t>(layers_[i] & 0xffffffffu));
  }
}

void OccluderStack::tableOf(const Occludee& occludee, CombinationTable& table) {
  const PixelRect& rect = occludee.rect;
  table.clear();
  // Most pixels have the same layers as a neighbour.
  below_.resize(rect.right - rect.left);
  for (std::uint32_t y = rect.low; y < rect.high; ++y) {
    for (std::uint32_t x = rect.left; x < rect.right; ++x) {
      layersBefore(y * resolution_ + x, occludee.reciprocal_depth, here_);
      std::vector<std::uint32_t>& below = below_[x - rect.left];
      const bool known = (x > rect.left && here_ == left_) || (y > rect.low && here_ == below);
      if (!known) {
        table.add(here_);
      }
      below = here_;
      left_.swap(here_);
    }
  }
  table.finish();
}

}  // namespace sightline::comparison
