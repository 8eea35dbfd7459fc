#include "tests/scenes/scene_checks.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>
#include <span>
#include <utility>

#include "sightline/scene/check_scene.h"
#include "src/base/union_find.h"

namespace sightline::scene_checks {
namespace {

class Hash {
 public:
  void add(std::uint64_t value) {
    for (int byte = 0; byte < 8; ++byte) {
      value_ = (value_ ^ (value >> (8 * byte) & 0xff)) * 0x100000001b3ull;
    }
  }
  void add(float value) { add(std::uint64_t{std::bit_cast<std::uint32_t>(value)}); }
  void add(double value) { add(std::bit_cast<std::uint64_t>(value)); }
  template <typename T>
  void add(const Vec3<T>& v) {
    add(v.x);
    add(v.y);
    add(v.z);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ull;
};

using Triangle = std::array<Vec3d, 3>;

Triangle triangleAt(const Scene& scene, std::size_t first_index) {
  Triangle triangle;
  for (std::size_t k = 0; k < 3; ++k) {
    triangle[k] = Vec3d(scene.positions[scene.indices[first_index + k]]);
  }
  return triangle;
}

bool segmentHits(const Vec3d& from, const Vec3d& to, const Triangle& t) {
  const Vec3d direction = to - from, e1 = t[1] - t[0], e2 = t[2] - t[0], p = cross(direction, e2);
  const double det = dot(e1, p);
  if (std::abs(det) < 1e-15) {
    return false;
  }
  const Vec3d s = from - t[0], q = cross(s, e1);
  const double u = dot(s, p) / det, v = dot(direction, q) / det, along = dot(e2, q) / det;
  return u >= 0.0 && v >= 0.0 && u + v <= 1.0 && along >= 0.0 && along <= 1.0;
}

double distanceToSegment(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d d = b - a;
  const double t = std::clamp(dot(p - a, d) / std::max(dot(d, d), 1e-30), 0.0, 1.0);
  return length(p - (a + d * t));
}

double distanceTo(const Vec3d& p, const Triangle& t) {
  const Vec3d normal = normalized(cross(t[1] - t[0], t[2] - t[0]));
  const double height = dot(p - t[0], normal);
  bool inside = true;
  double nearest = 1e30;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3d &a = t[k], &b = t[(k + 1) % 3];
    inside = inside && dot(cross(b - a, p - a), normal) >= 0.0;
    nearest = std::min(nearest, distanceToSegment(p, a, b));
  }
  return inside ? std::abs(height) : nearest;
}

Box boxAround(const Vec3d& a, const Vec3d& b, double margin) {
  Box box;
  box.extend(Vec3f(min(a, b) - Vec3d(margin, margin, margin)));
  box.extend(Vec3f(max(a, b) + Vec3d(margin, margin, margin)));
  return box;
}

// The edges of triangles. Each is a number of its two vertices and its direction, so that sorting brings
// those between the same vertices together.
class Edges {
 public:
  void add(const Scene& scene, const Object& object) {
    for (std::uint32_t i = 0; i < object.index_count; ++i) {
      const std::uint32_t next = i % 3 == 2 ? i - 2 : i + 1;
      const std::uint64_t a = scene.indices[object.first_index + i],
                          b = scene.indices[object.first_index + next];
      edges_.push_back(std::min(a, b) << 33 | std::max(a, b) << 1 | (a < b ? 0 : 1));
    }
  }
  // Calls look(forwards, backwards) for each pair of vertices: how many triangles have the edge in either
  // direction.
  template <typename Look>
  void forEach(Look&& look) {
    std::sort(edges_.begin(), edges_.end());
    for (std::size_t i = 0; i < edges_.size();) {
      std::array<std::size_t, 2> count{};
      for (const std::uint64_t vertices = edges_[i] >> 1; i < edges_.size() && edges_[i] >> 1 == vertices;
           ++i) {
        ++count[edges_[i] & 1];
      }
      look(count[0], count[1]);
    }
  }

 private:
  std::vector<std::uint64_t> edges_;
};

}  // namespace

std::uint64_t hashOf(const Scene& scene) {
  Hash hash;
  for (const Vec3f& position : scene.positions) {
    hash.add(position);
  }
  for (const std::uint32_t index : scene.indices) {
    hash.add(std::uint64_t{index});
  }
  for (const Object& object : scene.objects) {
    hash.add(std::uint64_t{object.first_index});
    hash.add(std::uint64_t{object.index_count});
    hash.add(std::uint64_t{object.material.value});
  }
  for (const CameraPath& path : scene.paths) {
    for (const CameraFrame& frame : path.frames) {
      hash.add(frame.eye);
      hash.add(frame.forward);
    }
  }
  return hash.value();
}

std::string whatIsWrong(const Scene& scene) {
  if (scene.object_names.size() != scene.objects.size()) {
    return "as many names as objects";
  }
  for (const Vec3f& position : scene.positions) {
    if (!isFinite(position)) {
      return "a position is not finite";
    }
  }
  if (const Status status = checkScene(scene.view()); !status) {
    return status.error().message;
  }
  Scene exact = scene;
  updateBounds(exact);
  std::uint64_t next = 0;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    const Object& object = scene.objects[i];
    if (object.first_index != next || object.index_count == 0 || object.bounds != exact.objects[i].bounds) {
      return scene.object_names[i] + ": indices or bounds";
    }
    next += object.index_count;
  }
  return next == scene.indices.size() ? "" : "indices that belong to no object";
}

double degenerateShare(const Scene& scene) {
  std::size_t degenerate = 0;
  for (std::size_t i = 0; i < scene.indices.size(); i += 3) {
    const Triangle t = triangleAt(scene, i);
    degenerate += length(cross(t[1] - t[0], t[2] - t[0])) * 0.5 < 1e-7 ? 1 : 0;
  }
  return static_cast<double>(degenerate) / static_cast<double>(scene.triangleCount());
}

bool isClosed(const Scene& scene, const Object& object) {
  Edges edges;
  edges.add(scene, object);
  bool closed = true;
  edges.forEach([&](std::size_t forwards, std::size_t backwards) { closed &= forwards == backwards; });
  return closed;
}

double volumeOf(const Scene& scene, const Object& object) {
  const Vec3d middle = center(object.bounds);
  double sixfold = 0.0;
  for (std::uint32_t i = 0; i < object.index_count; i += 3) {
    const Triangle t = triangleAt(scene, object.first_index + i);
    sixfold += dot(t[0] - middle, cross(t[1] - middle, t[2] - middle));
  }
  return sixfold / 6.0;
}

SolidCounts countSolids(const Scene& scene) {
  SolidCounts counts;
  for (const Object& object : scene.objects) {
    if (isClosed(scene, object)) {
      ++counts.closed;
      counts.inside_out += volumeOf(scene, object) <= 0.0 ? 1 : 0;
    }
  }
  return counts;
}

std::string whatIsHit(const Scene& scene, const CameraPath& path, double clearance) {
  for (std::size_t f = 0; f < path.frames.size(); ++f) {
    const Vec3d eye = path.frames[f].eye - scene.origin;
    const Vec3d next = path.frames[std::min(f + 1, path.frames.size() - 1)].eye - scene.origin;
    const Box around = boxAround(eye, next, clearance);
    for (std::size_t o = 0; o < scene.objects.size(); ++o) {
      const Object& object = scene.objects[o];
      for (std::uint32_t i = 0; overlaps(around, object.bounds) && i < object.index_count; i += 3) {
        const Triangle triangle = triangleAt(scene, object.first_index + i);
        if (segmentHits(eye, next, triangle) || distanceTo(eye, triangle) < clearance) {
          return path.name + " frame " + std::to_string(f) + ": " + scene.object_names[o];
        }
      }
    }
  }
  return "";
}

std::vector<std::size_t> namesThatEndWith(const Scene& scene, std::string_view end) {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < scene.object_names.size(); ++i) {
    const std::string& name = scene.object_names[i];
    if (name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0) {
      found.push_back(i);
    }
  }
  return found;
}

NamedCounts countNamed(const Scene& scene, std::string_view start) {
  NamedCounts counts;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    if (scene.object_names[o].starts_with(start)) {
      ++counts.objects;
      counts.triangles += scene.objects[o].triangleCount();
    }
  }
  return counts;
}

SheetCounts countSheet(const Scene& scene, std::string_view start, bool whole_name) {
  SheetCounts counts;
  Edges edges;
  base::UnionFind pieces(scene.positions.size());
  std::vector<bool> used(scene.positions.size(), false);
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const std::string& name = scene.object_names[o];
    if (!name.starts_with(start) || (whole_name && name.size() != start.size())) {
      continue;
    }
    edges.add(scene, scene.objects[o]);
    const std::span<const std::uint32_t> indices = scene.view().indicesOf(scene.objects[o]);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      used[indices[i]] = true;
      pieces.unite(indices[i], indices[i - i % 3]);
    }
  }
  edges.forEach([&](std::size_t forwards, std::size_t backwards) {
    counts.open_edges += forwards != backwards ? 1 : 0;
    counts.crowded_edges += forwards + backwards > 2 ? 1 : 0;
  });
  for (std::uint32_t i = 0; i < used.size(); ++i) {
    counts.pieces += used[i] && pieces.root(i) == i ? 1 : 0;
  }
  return counts;
}

double heightOf(const Scene& scene, std::string_view start, const Vec3d& point, bool below) {
  double highest = -std::numeric_limits<double>::infinity();
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    if (scene.object_names[o].compare(0, start.size(), start) != 0 || point.x < object.bounds.min.x ||
        point.x > object.bounds.max.x || point.z < object.bounds.min.z || point.z > object.bounds.max.z) {
      continue;
    }
    for (std::uint32_t i = 0; i < object.index_count; i += 3) {
      const Triangle t = triangleAt(scene, object.first_index + i);
      const Vec3d normal = cross(t[1] - t[0], t[2] - t[0]);
      const auto isLeft = [&](std::size_t k) {
        const Vec3d d = t[(k + 1) % 3] - t[k], p = point - t[k];
        return d.z * p.x - d.x * p.z >= -1e-9;
      };
      if (normal.y > 0.0 && isLeft(0) && isLeft(1) && isLeft(2)) {
        const double y = t[0].y - (normal.x * (point.x - t[0].x) + normal.z * (point.z - t[0].z)) / normal.y;
        highest = below && y > point.y ? highest : std::max(highest, y);
      }
    }
  }
  return highest;
}

std::string whatLacksGround(const Scene& scene, const CameraPath& path, std::string_view start, double most) {
  for (std::size_t f = 0; f < path.frames.size(); ++f) {
    const Vec3d eye = path.frames[f].eye - scene.origin;
    if (!(eye.y - heightOf(scene, start, eye, true) <= most)) {
      return path.name + " frame " + std::to_string(f);
    }
  }
  return "";
}

double smallestTurnCosine(const CameraPath& path) {
  double smallest = 1.0;
  for (std::size_t f = 1; f < path.frames.size(); ++f) {
    smallest =
        std::min(smallest, dot(normalized(path.frames[f - 1].forward), normalized(path.frames[f].forward)));
  }
  return smallest;
}

double longestStep(const CameraPath& path) {
  double longest = 0.0;
  for (std::size_t f = 1; f < path.frames.size(); ++f) {
    longest = std::max(longest, length(path.frames[f].eye - path.frames[f - 1].eye));
  }
  return longest;
}

std::size_t countSeeThrough(const Scene& scene) {
  return static_cast<std::size_t>(std::ranges::count_if(
      scene.objects, [&](const Object& object) { return !scene.view().materialOf(object).opaque(); }));
}

std::string whatIsWrongWithWalk(const Scene& scene, const WalkLimits& limits) {
  if (scene.paths.size() != 1 || scene.paths.front().frames.size() != 400) {
    return "not one path of 400 frames";
  }
  const CameraPath& path = scene.paths.front();
  if (const std::string hit = whatIsHit(scene, path, limits.clearance); !hit.empty()) {
    return "too close: " + hit;
  }
  if (const std::string lacking = whatLacksGround(scene, path, limits.ground, limits.most_height);
      !lacking.empty()) {
    return "no ground: " + lacking;
  }
  if (!(smallestTurnCosine(path) > limits.turn_cosine)) {
    return "a turn of cosine " + std::to_string(smallestTurnCosine(path));
  }
  if (!(longestStep(path) < limits.step)) {
    return "a step of " + std::to_string(longestStep(path)) + " metres";
  }
  return "";
}

}  // namespace sightline::scene_checks
