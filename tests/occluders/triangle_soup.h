#pragma once

// Lists of triangles for tests of conforming.

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include "sightline/scene/scene.h"
#include "src/occluders/conform/conform.h"

namespace sightline::test {

class SoupRandom {
 public:
  explicit SoupRandom(unsigned seed) : random_(seed) {}
  int below(int end) { return std::uniform_int_distribution<int>(0, end - 1)(random_); }
  double in(double low, double high) {
    return double{static_cast<float>(std::uniform_real_distribution<>(low, high)(random_))};
  }
  std::mt19937& engine() { return random_; }

 private:
  std::mt19937 random_;
};

// A list of triangles whose equal positions are one vertex.
struct Soup {
  std::vector<Vec3d> vertices;
  std::vector<std::uint32_t> triangles;

  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    for (const Vec3d& v : {a, b, c}) {
      triangles.push_back(vertexAt(v));
    }
  }
  void addQuad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    add(a, b, c);
    add(a, c, d);
  }
  // A box whose faces look outwards.
  void addBox(const Vec3d& low, const Vec3d& high) {
    const auto corner = [&](int bits) {
      return Vec3d{(bits & 1) != 0 ? high.x : low.x, (bits & 2) != 0 ? high.y : low.y,
                   (bits & 4) != 0 ? high.z : low.z};
    };
    for (const auto& face :
         {std::array{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}) {
      addQuad(corner(face[0]), corner(face[1]), corner(face[2]), corner(face[3]));
    }
  }
  std::uint32_t count() const { return static_cast<std::uint32_t>(triangles.size() / 3); }
  occluders::ConformInput input() const { return {vertices, triangles}; }
  void move(Vec3d (*place)(const Vec3d&)) {
    for (Vec3d& v : vertices) {
      v = place(v);
    }
  }

 private:
  std::uint32_t vertexAt(const Vec3d& v) {
    if (!isFinite(v)) {
      vertices.push_back(v);
      return static_cast<std::uint32_t>(vertices.size() - 1);
    }
    const auto [at, added] =
        numbers_.try_emplace(std::array{v.x, v.y, v.z}, static_cast<std::uint32_t>(vertices.size()));
    if (added) {
      vertices.push_back(v);
    }
    return at->second;
  }
  std::map<std::array<double, 3>, std::uint32_t> numbers_;
};

// How many directed edges are left after each is cancelled against its opposite.
inline std::size_t boundaryEdges(std::span<const std::uint32_t> triangles) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> values;
  for (std::size_t i = 0; i < triangles.size(); i += 3) {
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t a = triangles[i + k], b = triangles[i + (k + 1) % 3];
      values[std::minmax(a, b)] += a < b ? 1 : -1;
    }
  }
  std::size_t left = 0;
  for (const auto& value : values) {
    left += static_cast<std::size_t>(std::abs(value.second));
  }
  return left;
}

// The faces of random voxels, merged greedily to rectangles, as voxel engines do.
inline Soup greedyVoxels(unsigned seed, int size) {
  SoupRandom random(seed);
  std::vector<bool> solid(static_cast<std::size_t>(size * size * size));
  for (std::size_t i = 0; i < solid.size(); ++i) {
    solid[i] = random.below(5) < 3;
  }
  const auto at = [&](const int(&p)[3]) {
    for (const int c : p) {
      if (c < 0 || c >= size) {
        return false;
      }
    }
    return static_cast<bool>(solid[static_cast<std::size_t>((p[2] * size + p[1]) * size + p[0])]);
  };
  Soup soup;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (int plane = 0; plane <= size; ++plane) {
      for (const int side : {-1, 1}) {  // faces that look down or up
        std::vector<bool> face(static_cast<std::size_t>(size * size));
        for (int b = 0; b < size; ++b) {
          for (int a = 0; a < size; ++a) {
            int in[3], out[3];
            in[u] = out[u] = a;
            in[v] = out[v] = b;
            in[axis] = side < 0 ? plane : plane - 1;
            out[axis] = side < 0 ? plane - 1 : plane;
            face[static_cast<std::size_t>(b * size + a)] = at(in) && !at(out);
          }
        }
        for (int b = 0; b < size; ++b) {
          for (int a = 0; a < size; ++a) {
            const auto free = [&](int x, int y) { return face[static_cast<std::size_t>(y * size + x)]; };
            if (!free(a, b)) {
              continue;
            }
            int right = a, top = b;
            while (right < size && free(right, b)) {
              ++right;
            }
            const auto rowFree = [&](int y) {
              for (int x = a; x < right; ++x) {
                if (!free(x, y)) {
                  return false;
                }
              }
              return true;
            };
            while (top < size && rowFree(top)) {
              ++top;
            }
            for (int y = b; y < top; ++y) {
              for (int x = a; x < right; ++x) {
                face[static_cast<std::size_t>(y * size + x)] = false;
              }
            }
            const auto corner = [&](int x, int y) {
              Vec3d p;
              p[axis] = plane;
              p[u] = x;
              p[v] = y;
              return p;
            };
            if (side > 0) {
              soup.addQuad(corner(a, b), corner(right, b), corner(right, top), corner(a, top));
            } else {
              soup.addQuad(corner(a, b), corner(a, top), corner(right, top), corner(right, b));
            }
          }
        }
      }
    }
  }
  return soup;
}

// A scene of a soup's triangles, whose coordinates must be of single precision, in so many opaque objects.
inline Scene sceneOf(const Soup& soup, std::uint32_t objects = 1) {
  Scene scene;
  for (const Vec3d& v : soup.vertices) {
    scene.positions.emplace_back(v);
  }
  scene.indices = soup.triangles;
  scene.materials.push_back({.name = "plain"});
  for (std::uint32_t o = 0; o < objects; ++o) {
    const std::uint32_t first = soup.count() * o / objects, end = soup.count() * (o + 1) / objects;
    scene.objects.push_back(
        {.first_index = 3 * first, .index_count = 3 * (end - first), .material = MaterialId(0u)});
    scene.object_names.emplace_back("soup");
  }
  updateBounds(scene);
  return scene;
}

}  // namespace sightline::test
