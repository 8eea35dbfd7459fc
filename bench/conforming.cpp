// What does conforming cost as the scene grows, and what does it close? Terrain, houses that are pushed into
// it, and walls of panels whose corners lie on each other's edges, of about 100,000 triangles and up; then
// the scenes that are named. In the same run, of the same triangles: the time that joining equal positions
// takes, which is all that was done before.
//
//   conforming [--threads N] [--largest TRIANGLES] [--divide edges|faces|penetrations] [--crack-width METRES]
//              [SCENE...]
//
// boundary, after: how often triangles run along an edge, less how often they run back, summed over all
// edges.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "bench/benchmark_scene.h"
#include "src/base/stopwatch.h"
#include "src/occluders/conform/conform.h"
#include "src/occluders/surfaces/surface_mesh.h"

namespace {

using namespace sightline;

struct Triangles {
  std::vector<Vec3f> positions;
  std::vector<std::uint32_t> indices;

  void quad(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
    const auto first = static_cast<std::uint32_t>(positions.size());
    positions.insert(positions.end(), {a, b, c, d});
    indices.insert(indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  }
};

float heightAt(std::uint32_t x, std::uint32_t z) {
  return 2.0f * std::sin(0.11f * static_cast<float>(x)) * std::cos(0.07f * static_cast<float>(z));
}

// Cells of a metre. In every block of 32 x 32 stands a house of five faces, and a wall whose panels are half
// a panel apart from row to row.
Triangles village(std::uint32_t cells) {
  Triangles scene;
  for (std::uint32_t z = 0; z < cells; ++z) {
    for (std::uint32_t x = 0; x < cells; ++x) {
      const auto at = [&](std::uint32_t i, std::uint32_t k) {
        return Vec3f{static_cast<float>(x + i), heightAt(x + i, z + k), static_cast<float>(z + k)};
      };
      scene.quad(at(0, 0), at(0, 1), at(1, 1), at(1, 0));
      if (x % 32 == 8 && z % 32 == 8) {
        const float x0 = static_cast<float>(x) + 0.3f, x1 = x0 + 7.4f, z0 = static_cast<float>(z) + 0.6f,
                    z1 = z0 + 5.2f;
        scene.quad({x0, -3, z0}, {x0, 6, z0}, {x1, 6, z0}, {x1, -3, z0});
        scene.quad({x1, -3, z1}, {x1, 6, z1}, {x0, 6, z1}, {x0, -3, z1});
        scene.quad({x0, -3, z1}, {x0, 6, z1}, {x0, 6, z0}, {x0, -3, z0});
        scene.quad({x1, -3, z0}, {x1, 6, z0}, {x1, 6, z1}, {x1, -3, z1});
        scene.quad({x0, 6, z0}, {x0, 6, z1}, {x1, 6, z1}, {x1, 6, z0});
        for (std::uint32_t row = 0; row < 4; ++row) {
          for (std::uint32_t panel = 0; panel < 5; ++panel) {
            const float low = 4.0f + static_cast<float>(row),
                        left = x0 + static_cast<float>(2 * panel + row % 2);
            scene.quad({left, low, z1 + 9}, {left + 2, low, z1 + 9}, {left + 2, low + 1, z1 + 9},
                       {left, low + 1, z1 + 9});
          }
        }
      }
    }
  }
  return scene;
}

occluders::SurfaceMesh weldVillage(const Triangles& village) {
  const Object object{.first_index = 0,
                      .index_count = static_cast<std::uint32_t>(village.indices.size()),
                      .material = MaterialId(0u)};
  const Material material;
  return occluders::weld({village.positions, village.indices, {&object, 1}, {&material, 1}}, serialFor);
}

struct Boundary {
  std::uint64_t edges = 0;
  double metres = 0.0;
};

// Sums over all edges of how often triangles run along them, less how often they run back.
Boundary boundaryOf(std::span<const Vec3d> vertices, std::span<const std::uint32_t> triangles) {
  std::vector<std::pair<std::uint64_t, int>> edges;
  edges.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const std::uint64_t a = triangles[i], b = triangles[i % 3 == 2 ? i - 2 : i + 1];
    edges.emplace_back(std::min(a, b) << 32 | std::max(a, b), a < b ? 1 : -1);
  }
  std::sort(edges.begin(), edges.end());
  Boundary boundary;
  for (std::size_t i = 0; i < edges.size();) {
    int value = 0;
    const std::uint64_t edge = edges[i].first;
    for (; i < edges.size() && edges[i].first == edge; ++i) {
      value += edges[i].second;
    }
    boundary.edges += static_cast<std::uint64_t>(std::abs(value));
    if (value != 0) {
      boundary.metres += std::abs(value) * length(vertices[edge >> 32] - vertices[edge & 0xffffffffu]);
    }
  }
  return boundary;
}

// Hands out ranges in turn.
ParallelFor onThreads(std::uint32_t threads) {
  return [threads](std::uint32_t count, const RangeBody& body) {
    const std::uint32_t step = std::max(1u, count / (64 * threads));
    std::atomic<std::uint64_t> next{0};
    std::vector<std::thread> pool;
    for (std::uint32_t i = 0; i < threads; ++i) {
      pool.emplace_back([&] {
        for (std::uint64_t begin = next.fetch_add(step); begin < count; begin = next.fetch_add(step)) {
          body(static_cast<std::uint32_t>(begin),
               static_cast<std::uint32_t>(std::min<std::uint64_t>(count, begin + step)));
        }
      });
    }
    for (std::thread& thread : pool) {
      thread.join();
    }
  };
}

template <typename Weld>
void measure(std::string_view name, const Weld& weld, std::uint32_t threads,
             const occluders::ConformSettings& settings) {
  base::Stopwatch watch;
  const occluders::SurfaceMesh mesh = weld();
  const double welding_s = 1e-6 * watch.lap();
  std::vector<Vec3d> vertices;
  for (const Vec3f& v : mesh.vertices) {
    vertices.emplace_back(v);
  }
  std::vector<std::uint32_t> triangles;
  for (const std::array<std::uint32_t, 3>& corners : mesh.triangles) {
    triangles.insert(triangles.end(), corners.begin(), corners.end());
  }
  watch.lap();
  const occluders::ConformedMesh conformed =
      occluders::conform({vertices, triangles}, settings, onThreads(threads));
  const double conforming_s = 1e-6 * watch.lap();
  const Boundary before = boundaryOf(vertices, triangles),
                 after = boundaryOf(conformed.vertices, conformed.triangles);
  fmt::print("{:<24} {:>9} {:>9} {:>8} {:>7.2f} {:>7.2f} {:>9} {:>9} {:>9.0f} {:>9.0f} {:>9.1e}\n", name,
             triangles.size() / 3, conformed.source.size(), conformed.divided, welding_s, conforming_s,
             before.edges, after.edges, before.metres, after.metres, conformed.slack);
}

occluders::Divide divideOrExit(std::string_view word) {
  if (word == "edges") {
    return occluders::Divide::kEdges;
  }
  if (word == "faces") {
    return occluders::Divide::kFaces;
  }
  if (word == "penetrations") {
    return occluders::Divide::kPenetrations;
  }
  fmt::print(stderr, "conforming: --divide {}: unknown word; give edges, faces or penetrations\n", word);
  std::exit(2);
}

}  // namespace

int main(int argc, char** argv) {
  std::uint32_t threads = 1;
  double largest = 1e6;
  occluders::ConformSettings settings;
  std::vector<std::string> scenes;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument == "--threads" && i + 1 < argc) {
      threads = static_cast<std::uint32_t>(std::max(1, std::atoi(argv[++i])));
    } else if (argument == "--largest" && i + 1 < argc) {
      largest = std::atof(argv[++i]);
    } else if (argument == "--divide" && i + 1 < argc) {
      settings.divide = divideOrExit(argv[++i]);
    } else if (argument == "--crack-width" && i + 1 < argc) {
      settings.crack_width = std::atof(argv[++i]);
    } else if (argument.rfind("--benchmark_min_time", 0) == 0) {
      largest = 1e5;
    } else if (argument.rfind("--", 0) != 0) {
      scenes.push_back(argument);
    } else {
      fmt::print(stderr,
                 "conforming: {}: unknown option, or its value is missing; give --threads, --largest, "
                 "--divide or --crack-width with a value\n",
                 argument);
      return 2;
    }
  }
  fmt::print("{} threads; weld: on one\n{:<24} {:>9} {:>9} {:>8} {:>7} {:>7} {:>9} {:>9} {:>9} {:>9} {:>9}\n",
             threads, "scene", "triangles", "pieces", "divided", "weld s", "conf. s", "boundary", "after",
             "metres", "after", "slack m");
  for (const std::uint32_t cells : {224u, 704u, 2208u}) {
    if (2.0 * cells * cells <= 1.05 * largest) {
      const Triangles triangles = village(cells);
      measure(
          fmt::format("village of {}", cells), [&] { return weldVillage(triangles); }, threads, settings);
    }
  }
  for (const std::string& name : scenes) {
    const Scene scene = isDemoUrl(name) ? bench::valueOrExit(makeDemoScene(name), "conforming")
                                        : bench::valueOrExit(importScene(name), "conforming");
    measure(
        name.substr(name.rfind('/') + 1), [&] { return occluders::weld(scene.view(), serialFor); }, threads,
        settings);
  }
}
