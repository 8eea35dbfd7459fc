#include "scenes/surface_nets.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace sightline::scenes {
namespace {

constexpr std::uint32_t kNoVertex = 0xffffffffu;

bool isOnBorder(const ValueGrid& grid, std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return x == 0 || y == 0 || z == 0 || x + 1 == grid.points[0] || y + 1 == grid.points[1] ||
         z + 1 == grid.points[2];
}

// Marks all points on the same side as `start` that are connected to it along edges of the grid.
std::vector<bool> connectedTo(const ValueGrid& grid, std::size_t start) {
  const std::size_t strides[] = {1, grid.points[0], std::size_t{grid.points[0]} * grid.points[1]};
  std::vector<bool> reached(grid.values.size(), false);
  const bool solid = grid.values[start] > 0.0f;
  std::vector<std::size_t> waiting{start};
  reached[start] = true;
  while (!waiting.empty()) {
    const std::size_t at = waiting.back();
    waiting.pop_back();
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::size_t coordinate = at / strides[axis] % grid.points[axis];
      const auto visit = [&](std::size_t next) {
        if (!reached[next] && (grid.values[next] > 0.0f) == solid) {
          reached[next] = true;
          waiting.push_back(next);
        }
      };
      if (coordinate > 0) {
        visit(at - strides[axis]);
      }
      if (coordinate + 1 < grid.points[axis]) {
        visit(at + strides[axis]);
      }
    }
  }
  return reached;
}

// Moves the points of one side that were not reached to the other side, close to the surface.
void flipUnreached(ValueGrid& grid, const std::vector<bool>& reached, bool solid) {
  for (std::size_t i = 0; i < grid.values.size(); ++i) {
    if ((grid.values[i] > 0.0f) == solid && !reached[i]) {
      const float away = std::max(std::abs(grid.values[i]), 1e-3f);
      grid.values[i] = solid ? -away : away;
    }
  }
}

// Fills the free corner nearest to the surface, if the corners of the face lie crosswise. Returns true if so.
bool fillPinch(ValueGrid& grid, const std::array<std::size_t, 4>& face) {
  std::array<bool, 4> solid{};
  for (std::size_t i = 0; i < 4; ++i) {
    solid[i] = grid.values[face[i]] > 0.0f;
  }
  if (solid[0] != solid[2] || solid[1] != solid[3] || solid[0] == solid[1]) {
    return false;
  }
  const std::size_t first = solid[0] ? 1 : 0;
  float &a = grid.values[face[first]], &b = grid.values[face[first + 2]];
  float& nearest = a > b ? a : b;
  nearest = std::max(-nearest, 1e-3f);
  return true;
}

// The mean of the crossings of a cell's edges, or nothing if there are none.
bool findVertex(const ValueGrid& grid, std::uint32_t x, std::uint32_t y, std::uint32_t z, Vec3d& vertex) {
  std::array<double, 8> value{};
  for (std::uint32_t k = 0; k < 8; ++k) {
    value[k] = grid.values[grid.index(x + (k & 1), y + (k >> 1 & 1), z + (k >> 2))];
  }
  Vec3d sum;
  int crossings = 0;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    for (std::uint32_t low = 0; low < 8; ++low) {
      const std::uint32_t high = low | 1u << axis;
      if (low == high || (value[low] > 0.0) == (value[high] > 0.0)) {
        continue;
      }
      Vec3d at(low & 1, low >> 1 & 1, low >> 2);
      at[static_cast<int>(axis)] = value[low] / (value[low] - value[high]);
      sum += at;
      ++crossings;
    }
  }
  vertex = crossings > 0 ? grid.point(x, y, z) + sum * (grid.cell / crossings) : Vec3d();
  return crossings > 0;
}

// Appends the quad around the grid's edge from a point along an axis, if the surface crosses it.
void addQuad(const ValueGrid& grid, const std::vector<std::uint32_t>& vertex_of, std::size_t at, int axis,
             const std::size_t (&strides)[3], SurfaceNet& net) {
  const bool solid = grid.values[at] > 0.0f;
  if (solid == (grid.values[at + strides[axis]] > 0.0f)) {
    return;
  }
  const std::size_t u = strides[(axis + 1) % 3], v = strides[(axis + 2) % 3];
  std::array<std::uint32_t, 4> quad{vertex_of[at - u - v], vertex_of[at - v], vertex_of[at],
                                    vertex_of[at - u]};
  if (!solid) {
    std::swap(quad[1], quad[3]);
  }
  net.quads.push_back(quad);
}

}  // namespace

void keepConnected(ValueGrid& grid, const Vec3d& start) {
  std::uint32_t at[3];
  for (int axis = 0; axis < 3; ++axis) {
    const double cells = (start[axis] - grid.origin[axis]) / grid.cell + 0.5;
    at[axis] = static_cast<std::uint32_t>(std::clamp(cells, 0.0, grid.points[axis] - 1.0));
  }
  for (std::uint32_t z = 0; z < grid.points[2]; ++z) {
    for (std::uint32_t y = 0; y < grid.points[1]; ++y) {
      for (std::uint32_t x = 0; x < grid.points[0]; ++x) {
        float& value = grid.values[grid.index(x, y, z)];
        value = isOnBorder(grid, x, y, z) ? std::max(value, 0.1f) : value;
      }
    }
  }
  flipUnreached(grid, connectedTo(grid, grid.index(at[0], at[1], at[2])), false);
  flipUnreached(grid, connectedTo(grid, 0), true);
}

void fillPinches(ValueGrid& grid) {
  const std::size_t strides[3] = {1, grid.points[0], std::size_t{grid.points[0]} * grid.points[1]};
  for (bool changed = true; changed;) {
    changed = false;
    for (std::uint32_t z = 0; z + 1 < grid.points[2]; ++z) {
      for (std::uint32_t y = 0; y + 1 < grid.points[1]; ++y) {
        for (std::uint32_t x = 0; x + 1 < grid.points[0]; ++x) {
          const std::size_t at = grid.index(x, y, z);
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const std::size_t u = strides[axis], v = strides[(axis + 1) % 3];
            changed = fillPinch(grid, {at, at + u, at + u + v, at + v}) || changed;
          }
        }
      }
    }
  }
}

SurfaceNet surfaceNet(const ValueGrid& grid) {
  SurfaceNet net;
  std::vector<std::uint32_t> vertex_of(grid.values.size(), kNoVertex);
  for (std::uint32_t z = 0; z + 1 < grid.points[2]; ++z) {
    for (std::uint32_t y = 0; y + 1 < grid.points[1]; ++y) {
      for (std::uint32_t x = 0; x + 1 < grid.points[0]; ++x) {
        Vec3d vertex;
        if (findVertex(grid, x, y, z, vertex)) {
          vertex_of[grid.index(x, y, z)] = static_cast<std::uint32_t>(net.points.size());
          net.points.push_back(vertex);
        }
      }
    }
  }
  const std::size_t strides[3] = {1, grid.points[0], std::size_t{grid.points[0]} * grid.points[1]};
  for (std::uint32_t z = 0; z + 1 < grid.points[2]; ++z) {
    for (std::uint32_t y = 0; y + 1 < grid.points[1]; ++y) {
      for (std::uint32_t x = 0; x + 1 < grid.points[0]; ++x) {
        const std::uint32_t at[] = {x, y, z};
        for (int axis = 0; axis < 3; ++axis) {
          // An edge in the grid's border has fewer than four cells.
          if (at[(axis + 1) % 3] > 0 && at[(axis + 2) % 3] > 0) {
            addQuad(grid, vertex_of, grid.index(x, y, z), axis, strides, net);
          }
        }
      }
    }
  }
  return net;
}

}  // namespace sightline::scenes
