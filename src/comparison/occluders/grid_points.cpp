#include "src/comparison/occluders/grid_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "src/math/longest_axis.h"

namespace sightline::comparison {
namespace {

constexpr std::uint32_t kMaxPoints = 65536;
constexpr std::uint32_t kMaxLists = 1u << 22;
constexpr double kFarthest = 1e12;           // metres from the origin
constexpr std::uint32_t kChosenPoints = 48;  // near viewpoints, when the spacing is chosen
constexpr double kFinestOfExtent = 1.0 / 1024.0;
constexpr double kLayersPerSpacing = 8.0;
constexpr double kGrowth = 1.4142135623730951;  // of the spacing, while there are too many points

double extentOf(const Vec3d& low, const Vec3d& high) {
  return length(high - low);
}

// The layer of each viewpoint, and the height of each layer: that of its lowest viewpoint.
struct Layers {
  std::vector<std::int64_t> layer_of;
  std::vector<double> height;
};

Layers layersOf(std::span<const Vec3d> viewpoints, double thickness) {
  Layers layers;
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < viewpoints.size(); ++i) {
    order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return viewpoints[a].y < viewpoints[b].y; });
  layers.layer_of.resize(viewpoints.size());
  for (const std::uint32_t i : order) {
    const double y = viewpoints[i].y;
    if (layers.height.empty() || y > layers.height.back() + thickness) {
      layers.height.push_back(y);
    }
    layers.layer_of[i] = static_cast<std::int64_t>(layers.height.size()) - 1;
  }
  return layers;
}

// The grid points nearest to the viewpoints, in the order of these. Ends early, with one point too many, when
// there are more than max_points.
std::vector<Vec3d> pointsNear(std::span<const Vec3d> viewpoints, double spacing, std::uint32_t max_points) {
  const Layers layers = layersOf(viewpoints, spacing / kLayersPerSpacing);
  const Vec3d origin = viewpoints[0];
  std::set<std::array<std::int64_t, 3>> made;
  std::vector<Vec3d> points;
  for (std::size_t i = 0; i < viewpoints.size() && points.size() <= max_points; ++i) {
    const double column = std::floor((viewpoints[i].x - origin.x) / spacing + 0.5);
    const double row = std::floor((viewpoints[i].z - origin.z) / spacing + 0.5);
    const std::array<std::int64_t, 3> key = {static_cast<std::int64_t>(column), layers.layer_of[i],
                                             static_cast<std::int64_t>(row)};
    if (made.insert(key).second) {
      points.emplace_back(origin.x + column * spacing,
                          layers.height[static_cast<std::size_t>(layers.layer_of[i])],
                          origin.z + row * spacing);
    }
  }
  return points;
}

PointGrid gridNear(std::span<const Vec3d> viewpoints, double extent, double spacing,
                   std::uint32_t max_points) {
  const bool chosen = !(spacing > 0.0);
  const double finest = extent > 0.0 ? extent * kFinestOfExtent : 1.0;
  // Not finer than what keeps the numbers of columns and rows exact.
  PointGrid grid{{}, std::max(chosen ? finest : spacing, extent * 0x1p-50)};
  const std::uint32_t limit = chosen ? std::min(kChosenPoints, max_points) : max_points;
  for (grid.points = pointsNear(viewpoints, grid.spacing, limit); grid.points.size() > limit;
       grid.points = pointsNear(viewpoints, grid.spacing, limit)) {
    grid.spacing *= kGrowth;
  }
  grid.points.shrink_to_fit();
  return grid;
}

PointGrid gridIn(const Vec3d& low, const Vec3d& high, double spacing, std::uint32_t max_points) {
  const Vec3d size = high - low;
  const double extent = extentOf(low, high);
  PointGrid grid{{},
                 spacing > 0.0  ? std::max(spacing, extent * 0x1p-50)
                 : extent > 0.0 ? extent / max_points
                                : 1.0};
  const auto countAlong = [&](int axis) { return std::max(1.0, std::floor(size[axis] / grid.spacing)); };
  while (countAlong(0) * countAlong(1) * countAlong(2) > max_points) {
    grid.spacing *= std::sqrt(std::sqrt(kGrowth));
  }
  const Vec3d counts(countAlong(0), countAlong(1), countAlong(2));
  const Vec3d first = 0.5 * (low + high) - 0.5 * grid.spacing * (counts - Vec3d(1.0, 1.0, 1.0));
  for (double y = 0.0; y < counts.y; y += 1.0) {
    for (double z = 0.0; z < counts.z; z += 1.0) {
      for (double x = 0.0; x < counts.x; x += 1.0) {
        grid.points.push_back(first + grid.spacing * Vec3d(x, y, z));
      }
    }
  }
  grid.points.shrink_to_fit();
  return grid;
}

}  // namespace

PointGrid makeGrid(const Box& bounds, std::span<const Vec3d> viewpoints, double spacing,
                   std::uint32_t max_points) {
  const bool sound = bounds.wellFormed();
  const Vec3d low = sound ? Vec3d(bounds.min) : Vec3d(), high = sound ? Vec3d(bounds.max) : Vec3d();
  const double wanted = std::isfinite(spacing) && spacing > 0.0 ? spacing : 0.0;
  if (viewpoints.empty()) {
    return gridIn(low, high, wanted, max_points);
  }
  std::vector<Vec3d> usable;
  Vec3d lowest, highest;
  for (const Vec3d& v : viewpoints) {
    if (isFinite(v) && maxComponent(abs(v)) <= kFarthest) {
      lowest = usable.empty() ? v : min(lowest, v);
      highest = usable.empty() ? v : max(highest, v);
      usable.push_back(v);
    }
  }
  if (usable.empty()) {
    usable.push_back(0.5 * (low + high));
  }
  return gridNear(usable, std::max(extentOf(low, high), extentOf(lowest, highest)), wanted, max_points);
}

PointTree::PointTree(std::span<const Vec3d> points) {
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    nodes_.push_back({points[i], i, 0});
  }
  split(0, nodes_.size());
}

void PointTree::split(std::size_t begin, std::size_t end) {
  if (end - begin < 2) {
    return;
  }
  Vec3d low = nodes_[begin].point, high = low;
  for (std::size_t i = begin; i < end; ++i) {
    low = min(low, nodes_[i].point);
    high = max(high, nodes_[i].point);
  }
  const int axis = math::longestAxis(high - low);
  const std::size_t middle = begin + (end - begin) / 2;
  const auto at = [this](std::size_t i) { return nodes_.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [axis](const Node& a, const Node& b) {
    return a.point[axis] < b.point[axis] || (a.point[axis] == b.point[axis] && a.index < b.index);
  });
  nodes_[middle].axis = static_cast<std::uint32_t>(axis);
  split(begin, middle);
  split(middle + 1, end);
}

void PointTree::search(std::size_t begin, std::size_t end, const Vec3d& place, Best& best) const {
  if (begin == end) {
    return;
  }
  const std::size_t middle = begin + (end - begin) / 2;
  const Node& node = nodes_[middle];
  const Vec3d offset = place - node.point;
  const double squared = dot(offset, offset);
  if (squared < best.squared || (squared == best.squared && node.index < best.index)) {
    best = {squared, node.index};
  }
  const double beyond = offset[static_cast<int>(node.axis)];
  const bool after_first = beyond > 0.0;
  search(after_first ? middle + 1 : begin, after_first ? end : middle, place, best);
  if (beyond * beyond <= best.squared) {
    search(after_first ? begin : middle + 1, after_first ? middle : end, place, best);
  }
}

std::uint32_t PointTree::nearest(const Vec3d& place) const {
  Best best{std::numeric_limits<double>::infinity(), 0};
  if (isFinite(place)) {
    search(0, nodes_.size(), place, best);
  }
  return best.index;
}

std::uint32_t GridPoints::maxCount(std::uint32_t directions) {
  return std::min(kMaxPoints, kMaxLists / directions);
}

void GridPoints::save(base::ByteWriter& writer) const {
  writer.add(grid_.spacing);
  for (const Vec3d& point : grid_.points) {
    for (int axis = 0; axis < 3; ++axis) {
      writer.add(point[axis]);
    }
  }
}

Result<GridPoints> GridPoints::load(base::ByteReader& reader, std::uint32_t points) {
  PointGrid grid;
  grid.spacing = reader.read<double>();
  reader.expect(points, 3 * sizeof(double));
  if (!reader.ok() || !std::isfinite(grid.spacing) || !(grid.spacing > 0.0)) {
    return Error{"has no spacing of its points"};
  }
  grid.points.resize(points);
  for (Vec3d& point : grid.points) {
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] = reader.read<double>();
    }
    if (!isFinite(point)) {
      return Error{"has a point that is not finite"};
    }
  }
  return GridPoints(std::move(grid));
}

}  // namespace sightline::comparison
