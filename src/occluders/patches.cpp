// Coplanar, connected patches of an object's triangles.

#include <algorithm>
#include <array>
#include <cmath>

#include "src/occluders/polygon_merge.h"

namespace sightline::occluders {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

std::uint64_t pairOf(std::uint32_t high, std::uint32_t low) {
  return std::uint64_t{high} << 32 | low;
}

}  // namespace

double roundingTolerance(double largest_coordinate) {
  return 0x1p-20 * largest_coordinate;
}

// Leaves out those that have no area beyond rounding, and doubles. Sorts them by their corners: from the
// least one on, or all of a double-sided triangle.
void PatchFinder::findUsable(std::span<const std::uint32_t> indices, bool double_sided) {
  keys_.clear();
  triangles_.clear();
  const auto doubleAreaNormal = [&](const std::uint32_t* t) {
    const Vec3d a = at(t[0]);
    return cross(at(t[1]) - a, at(t[2]) - a);
  };
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    const std::uint32_t* t = &indices[i];
    const Vec3d ab = at(t[1]) - at(t[0]), bc = at(t[2]) - at(t[1]), ca = at(t[0]) - at(t[2]);
    const double longest = std::sqrt(std::max({dot(ab, ab), dot(bc, bc), dot(ca, ca)}));
    if (length(doubleAreaNormal(t)) > 4.0 * tolerance_ * longest) {
      PatchTriangle key{t[0], t[1], t[2]};
      if (double_sided) {
        std::sort(key.begin(), key.end());
      } else {
        std::rotate(key.begin(), std::min_element(key.begin(), key.end()), key.end());
      }
      keys_.push_back({pairOf(key[0], key[1]), pairOf(key[2], static_cast<std::uint32_t>(i / 3))});
    }
  }
  sorter_.sort(keys_);
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    if (i == 0 || keys_[i].first != keys_[i - 1].first ||
        keys_[i].second >> 32 != keys_[i - 1].second >> 32) {
      const std::uint32_t* t = &indices[3 * (keys_[i].second & 0xffffffffu)];
      const Vec3d normal = doubleAreaNormal(t);
      triangles_.push_back({{t[0], t[1], t[2]}, normal, length(normal)});
    }
  }
}

void PatchFinder::findNeighbours(bool double_sided) {
  keys_.clear();
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles_[t].corners[k], b = triangles_[t].corners[(k + 1) % 3];
      keys_.push_back({pairOf(std::min(a, b), std::max(a, b)), pairOf(3 * t + k, a < b ? 1 : 0)});
    }
  }
  sorter_.sort(keys_);
  neighbour_.assign(keys_.size(), kNone);
  components_.reset(triangles_.size());
  for (std::size_t i = 0, end = 0; i < keys_.size(); i = end) {
    for (end = i + 1; end < keys_.size() && keys_[end].first == keys_[i].first;) {
      ++end;
    }
    const std::uint64_t a = keys_[i].second, b = keys_[end - 1].second;
    if (end - i == 2 && (double_sided || ((a ^ b) & 1) != 0)) {
      neighbour_[a >> 32] = static_cast<std::uint32_t>(b >> 32);
      neighbour_[b >> 32] = static_cast<std::uint32_t>(a >> 32);
      components_.unite(static_cast<std::uint32_t>(a >> 32) / 3, static_cast<std::uint32_t>(b >> 32) / 3);
    }
  }
}

void PatchFinder::append(Patch& patch, std::uint32_t t) {
  PatchTriangle triangle = triangles_[t].corners;
  if (flipped_[t] != 0) {
    std::swap(triangle[1], triangle[2]);
  }
  for (const std::uint32_t id : triangle) {
    patch.deviation = std::max(patch.deviation, std::abs(patch.plane.evaluate(at(id))));
  }
  in_patches_.push_back(triangle);
  ++patch.triangle_count;
}

// Whether the triangle beyond an edge lies in the plane. Turns it to the winding of the other one.
bool PatchFinder::joins(const Plane& plane, std::uint32_t from, std::uint32_t edge, std::uint32_t corner) {
  const Usable& other = triangles_[corner / 3];
  for (const std::uint32_t id : other.corners) {
    if (std::abs(plane.evaluate(at(id))) > tolerance_) {
      return false;
    }
  }
  const bool same_direction = triangles_[from].corners[edge] == other.corners[corner % 3];
  const bool flip = (flipped_[from] != 0) != same_direction;
  flipped_[corner / 3] = flip ? 1 : 0;
  return dot(other.normal * (flip ? -1.0 : 1.0), plane.normal) > 0.99 * other.size;
}

// Grows one patch from a seed over neighbours that lie in its plane.
void PatchFinder::grow(std::uint32_t seed) {
  Patch patch;
  const Vec3d normal = normalized(triangles_[seed].normal);
  patch.plane = {normal, -dot(normal, at(triangles_[seed].corners[0]))};
  patch.first = static_cast<std::uint32_t>(in_patches_.size());
  patch.component = components_.root(seed);
  queue_.assign(1, seed);
  taken_[seed] = 1;
  flipped_[seed] = 0;
  while (!queue_.empty()) {
    const std::uint32_t t = queue_.back();
    queue_.pop_back();
    append(patch, t);
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t corner = neighbour_[3 * t + k];
      if (corner != kNone && taken_[corner / 3] == 0 && joins(patch.plane, t, k, corner)) {
        taken_[corner / 3] = 1;
        queue_.push_back(corner / 3);
      }
    }
  }
  patches_.push_back(patch);
}

void PatchFinder::find(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices,
                       bool double_sided, double tolerance) {
  positions_ = positions;
  tolerance_ = tolerance;
  findUsable(indices, double_sided);
  findNeighbours(double_sided);
  taken_.assign(triangles_.size(), 0);
  flipped_.assign(triangles_.size(), 0);
  // Seeds from the largest triangle down: its plane is the best known.
  keys_.clear();
  for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
    keys_.push_back({base::descending(triangles_[t].size), t});
  }
  sorter_.sort(keys_);
  patches_.clear();
  in_patches_.clear();
  for (const base::SortKey& key : keys_) {
    if (taken_[key.second] == 0) {
      grow(static_cast<std::uint32_t>(key.second));
    }
  }
}

}  // namespace sightline::occluders
