// What do the tables for tangent vertices save? Boxes and lines from all 27 regions (the box around the
// line's point: 1 in 27), in the same run:
//
//   tables        the paper's: region, silhouette, signs, tangents
//   vertices      the plane of each of the eight vertices, checked against all of them until it fails
//   extremes      the eight vertices once: the lowest and the highest so far
//   vertices SIMD the planes of the eight vertices against all of them, the vertices in vector lanes
//
// random, parallel: ns for the two tangent vertices of one line, of any direction or parallel to an axis.
// planes: ns for the eight planes through the four edges of a quad that touch a box. `per_tables`: the time
// over that of the tables, measured in turns.

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "bench/tangent_planes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "src/geometry/box_tangents.h"

HWY_BEFORE_NAMESPACE();
namespace sightline::tangent_bench {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Lanes are the planes of vertices. `low`, `high`: bit v: all vertices are on that side of the plane of v.
geometry::BoxTangents tangentsOfVectors(const Vec3d& box_min, const Vec3d& box_max, const Vec3d& direction) {
  const hn::CappedTag<double, 8> d;
  const std::size_t lanes = hn::Lanes(d);
  HWY_ALIGN const double xs[8] = {box_min.x, box_max.x, box_min.x, box_max.x,
                                  box_min.x, box_max.x, box_min.x, box_max.x};
  HWY_ALIGN const double ys[8] = {box_min.y, box_min.y, box_max.y, box_max.y,
                                  box_min.y, box_min.y, box_max.y, box_max.y};
  HWY_ALIGN const double zs[8] = {box_min.z, box_min.z, box_min.z, box_min.z,
                                  box_max.z, box_max.z, box_max.z, box_max.z};
  HWY_ALIGN double nx[8], ny[8], nz[8];
  const auto ax = hn::Set(d, direction.x), ay = hn::Set(d, direction.y), az = hn::Set(d, direction.z);
  for (std::size_t i = 0; i < 8; i += lanes) {
    const auto x = hn::Load(d, xs + i), y = hn::Load(d, ys + i), z = hn::Load(d, zs + i);
    hn::Store(hn::Sub(hn::Mul(ay, z), hn::Mul(az, y)), d, nx + i);
    hn::Store(hn::Sub(hn::Mul(az, x), hn::Mul(ax, z)), d, ny + i);
    hn::Store(hn::Sub(hn::Mul(ax, y), hn::Mul(ay, x)), d, nz + i);
  }
  // The margin is for the rounding of a vertex against its own plane.
  unsigned low = 0, high = 0;
  for (std::size_t i = 0; i < 8; i += lanes) {
    const auto vx = hn::Load(d, nx + i), vy = hn::Load(d, ny + i), vz = hn::Load(d, nz + i);
    auto least = hn::Zero(d), most = hn::Zero(d);
    for (std::size_t vertex = 0; vertex < 8; ++vertex) {
      const auto side =
          hn::Add(hn::Add(hn::Mul(vx, hn::Set(d, xs[vertex])), hn::Mul(vy, hn::Set(d, ys[vertex]))),
                  hn::Mul(vz, hn::Set(d, zs[vertex])));
      least = hn::Min(least, side), most = hn::Max(most, side);
    }
    const auto margin = hn::Set(d, 1e-9);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(d, hn::Ge(hn::Add(least, margin), hn::Zero(d)), bits);
    low |= static_cast<unsigned>(bits[0]) << i;
    hn::StoreMaskBits(d, hn::Le(hn::Sub(most, margin), hn::Zero(d)), bits);
    high |= static_cast<unsigned>(bits[0]) << i;
  }
  if (low == 0 || high == 0) {
    return {};
  }
  return {static_cast<std::uint8_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(low)),
          static_cast<std::uint8_t>(hwy::Num0BitsBelowLS1Bit_Nonzero32(high)), true};
}

}  // namespace HWY_NAMESPACE
}  // namespace sightline::tangent_bench
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
#include <benchmark/benchmark.h>

#include <array>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "bench/measuring.h"

namespace sightline::tangent_bench {
namespace {

using geometry::BoxTangents;
using geometry::cornerOf;

HWY_EXPORT(tangentsOfVectors);

using Find = BoxTangents (*)(const Vec3d&, const Vec3d&, const Vec3d&);

BoxTangents tangentsInLanes(const Vec3d& box_min, const Vec3d& box_max, const Vec3d& direction) {
  return HWY_DYNAMIC_DISPATCH(tangentsOfVectors)(box_min, box_max, direction);
}

// The lowest and the highest vertex so far, then whether all are between them: no plane that is not a
// candidate.
BoxTangents tangentsOfExtremes(const Vec3d& box_min, const Vec3d& box_max, const Vec3d& direction) {
  BoxTangents t;
  Vec3d low = cross(direction, box_min), high = low;
  for (std::uint8_t i = 1; i < 8; ++i) {
    const Vec3d x = cornerOf(box_min, box_max, i);
    if (dot(low, x) < 0.0) {
      low = cross(direction, x);
      t.low = i;
    }
    if (dot(high, x) > 0.0) {
      high = cross(direction, x);
      t.high = i;
    }
  }
  t.exist = true;
  for (std::uint8_t i = 0; i < 8; ++i) {
    const Vec3d x = cornerOf(box_min, box_max, i);
    t.exist = t.exist && (i == t.low || dot(low, x) >= 0.0) && (i == t.high || dot(high, x) <= 0.0);
  }
  return t;
}

struct Query {
  Vec3d box_min, box_max, direction;
};

class Random {
 public:
  double in(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53;
  }
  Vec3d point(double r) { return {in(-r, r), in(-r, r), in(-r, r)}; }

 private:
  std::mt19937_64 engine_{1};
};

constexpr std::size_t kCount = 27 * 256;

enum class Lines { kRandom, kParallelToAxes };

// Box number i seen from region i % 27, shuffled, so that no branch can learn their order.
std::vector<Query> makeQueries(Lines lines) {
  Random random;
  std::vector<Query> queries(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    Query& q = queries[i];
    for (int axis = 0, rest = static_cast<int>(i % 27); axis < 3; ++axis, rest /= 3) {
      const double near = random.in(0.1, 5.0), far = near + random.in(0.1, 5.0);
      q.box_min[axis] = rest % 3 == 1 ? near : rest % 3 == 2 ? -far : -near;
      q.box_max[axis] = rest % 3 == 1 ? far : rest % 3 == 2 ? -near : random.in(0.1, 5.0);
    }
    q.direction = random.point(3.0);
    if (lines == Lines::kParallelToAxes) {
      const int axis = static_cast<int>(i / 27 % 3);
      q.direction[(axis + 1) % 3] = q.direction[(axis + 2) % 3] = 0.0;
    }
  }
  std::shuffle(queries.begin(), queries.end(), std::mt19937_64(2));
  return queries;
}

struct Occluder {
  std::array<Vec3d, 4> corners;
};

// Rectangles around the boxes' origins, of any orientation.
std::vector<Occluder> makeOccluders() {
  Random random;
  std::vector<Occluder> occluders(kCount);
  for (Occluder& o : occluders) {
    const Vec3d middle = random.point(1.0), u = random.point(2.0),
                v = normalized(cross(u, random.point(1.0))) * random.in(0.5, 3.0);
    o.corners = {middle - u - v, middle + u - v, middle + u + v, middle - u + v};
  }
  return occluders;
}

struct TangentPlane {
  Vec3d normal;
  double offset = 0.0;
};

// Returns the number of planes.
std::size_t buildPlanes(Find find, const Query& box, const Occluder& occluder,
                        std::array<TangentPlane, 8>& planes) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    const Vec3d& p = occluder.corners[i];
    const Vec3d edge = occluder.corners[(i + 1) % 4] - p;
    const Vec3d low = box.box_min - p, high = box.box_max - p;
    const BoxTangents tangents = find(low, high, edge);
    if (!tangents.exist) {
      continue;
    }
    const double edge_length = length(edge);
    for (const std::uint8_t corner : {tangents.low, tangents.high}) {
      const Vec3d tangent = cornerOf(low, high, corner);
      const Vec3d normal = cross(edge, tangent) / (edge_length * length(tangent));
      planes[count++] = {normal, -dot(normal, p)};
    }
  }
  return count;
}

// Times `method` and the tables in turns and compares their medians, so that what else the machine does meets
// both.
void compare(benchmark::State& state, const auto& run, Find method) {
  std::vector<double> method_us, tables_us;
  for ([[maybe_unused]] auto _ : state) {
    method_us.push_back(bench::microseconds([&] { run(method); }));
    tables_us.push_back(bench::microseconds([&] { run(geometry::tangentsByTables); }));
    state.SetIterationTime(1e-6 * method_us.back());
  }
  state.counters["ns"] = bench::medianOf(method_us) * 1e3 / static_cast<double>(kCount);
  state.counters["tables_ns"] = bench::medianOf(tables_us) * 1e3 / static_cast<double>(kCount);
  state.counters["per_tables"] = bench::medianOf(method_us) / bench::medianOf(tables_us);
}

void vertices(benchmark::State& state, Find method, Lines lines) {
  const std::vector<Query> queries = makeQueries(lines);
  const auto run = [&](Find find) {
    for (const Query& q : queries) {
      benchmark::DoNotOptimize(find(q.box_min, q.box_max, q.direction));
    }
  };
  compare(state, run, method);
  state.counters["exist"] =
      static_cast<double>(
          std::count_if(queries.begin(), queries.end(),
                        [&](const Query& q) { return method(q.box_min, q.box_max, q.direction).exist; })) /
      static_cast<double>(kCount);
}

void planes(benchmark::State& state, Find method) {
  const std::vector<Query> boxes = makeQueries(Lines::kRandom);
  const std::vector<Occluder> occluders = makeOccluders();
  std::array<TangentPlane, 8> result;
  const auto run = [&](Find find) {
    std::size_t built = 0;
    for (std::size_t i = 0; i < kCount; ++i) {
      built += buildPlanes(find, boxes[i], occluders[i], result);
      benchmark::DoNotOptimize(result);
    }
    return built;
  };
  compare(state, run, method);
  state.counters["planes"] = static_cast<double>(run(method)) / static_cast<double>(kCount);
}

// Random lines touch no box, none is in a face's plane: all methods must name the same corners.
bool agree(Find a, Find b) {
  const std::vector<Query> queries = makeQueries(Lines::kRandom);
  return std::all_of(queries.begin(), queries.end(), [&](const Query& q) {
    const BoxTangents s = a(q.box_min, q.box_max, q.direction), t = b(q.box_min, q.box_max, q.direction);
    return s.exist == t.exist && (!s.exist || (s.low == t.low && s.high == t.high));
  });
}

}  // namespace
}  // namespace sightline::tangent_bench

int main(int argc, char** argv) {
  using namespace sightline;
  using namespace sightline::tangent_bench;
  benchmark::Initialize(&argc, argv);
  const struct {
    const char* name;
    Find find;
  } methods[] = {{"tables", geometry::tangentsByTables},
                 {"vertices", geometry::tangentsOfAllVertices},
                 {"extremes", tangentsOfExtremes},
                 {"vertices_simd", tangentsInLanes}};
  for (const auto& method : methods) {
    if (!agree(methods[0].find, method.find)) {
      std::fprintf(stderr, "tangent_planes: %s and tables disagree\n", method.name);
      return EXIT_FAILURE;
    }
  }
  const auto add = [&](const char* what, const auto& method, auto... arguments) {
    benchmark::RegisterBenchmark((std::string(what) + "/" + method.name).c_str(), arguments...)
        ->UseManualTime();
  };
  for (const auto& method : methods) {
    add("random", method, vertices, method.find, Lines::kRandom);
  }
  for (const auto& method : methods) {
    add("parallel", method, vertices, method.find, Lines::kParallelToAxes);
  }
  for (const auto& method : methods) {
    add("planes", method, planes, method.find);
  }
  benchmark::RunSpecifiedBenchmarks();
  return EXIT_SUCCESS;
}
#endif  // HWY_ONCE
