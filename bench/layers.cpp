// Measures the time to sort a frame's parts: 200, 1,600 and 10,000 tumbling toothpicks of the same density or
// the same size. One run compares on the same frames:
//
//   sorter     LayerSorter with the depth-first and the incremental sort
// all pairs  a test of every ordered pair with libccd (does one hull intersect the set between the other and
// the eye?), then Boost's strongly connected components, as a program with a collision library and
//              a graph library would do; on a few frames only
//   distance   a sort of the parts by the distance of their centres, and how many arcs it gets wrong
//
// Then it replaces the toothpicks by rings, which are not convex: as unions of 64 hulls, and as one hull
// each.
//
//   layers [COUNT...]

#include <ccd/ccd.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/strong_components.hpp>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <string>
#include <vector>

#include "bench/measuring.h"
#include "scenes/moving_scene.h"
#include "sightline/comparison/layer_sorting.h"
#include "sightline/layers/layer_sorter.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

// A placed hull for libccd, with or without the eye.
struct Shape {
  const ConvexHull* hull = nullptr;
  const Mat4* world_from_hull = nullptr;
  const Vec3d* eye = nullptr;
};

void support(const void* object, const ccd_vec3_t* direction, ccd_vec3_t* point) {
  const Shape& shape = *static_cast<const Shape*>(object);
  const Vec3d along(direction->v[0], direction->v[1], direction->v[2]);
  const Mat4& m = *shape.world_from_hull;
  const Vec3d local(dot(along, Vec3d(m(0, 0), m(1, 0), m(2, 0))),
                    dot(along, Vec3d(m(0, 1), m(1, 1), m(2, 1))),
                    dot(along, Vec3d(m(0, 2), m(1, 2), m(2, 2))));
  const Vec3d* best = &shape.hull->vertices.front();
  for (const Vec3d& vertex : shape.hull->vertices) {
    best = dot(local, vertex) > dot(local, *best) ? &vertex : best;
  }
  Vec3d farthest = transformPoint(m, *best);
  if (shape.eye != nullptr && dot(along, *shape.eye) > dot(along, farthest)) {
    farthest = *shape.eye;
  }
  ccdVec3Set(point, farthest.x, farthest.y, farthest.z);
}

// Finds all arcs with libccd and the number of components with Boost.
std::size_t allPairs(const std::vector<Shape>& shapes, const Vec3d& eye,
                     std::vector<std::pair<std::uint32_t, std::uint32_t>>& arcs) {
  ccd_t ccd;
  CCD_INIT(&ccd);
  ccd.support1 = ccd.support2 = support;
  ccd.max_iterations = 100;
  arcs.clear();
  boost::adjacency_list<boost::vecS, boost::vecS, boost::directedS> graph(shapes.size());
  for (std::uint32_t front = 0; front < shapes.size(); ++front) {
    for (std::uint32_t back = 0; back < shapes.size(); ++back) {
      Shape with_eye = shapes[back];
      with_eye.eye = &eye;
      if (front != back && ccdGJKIntersect(&shapes[front], &with_eye, &ccd) != 0) {
        arcs.emplace_back(front, back);
        boost::add_edge(front, back, graph);
      }
    }
  }
  std::vector<int> component(shapes.size());
  return static_cast<std::size_t>(boost::strong_components(graph, component.data()));
}

std::vector<Shape> shapesOf(const MovingScene& scene, const std::vector<Mat4>& poses) {
  std::vector<Shape> shapes;
  for (std::size_t part = 0; part < scene.parts.size(); ++part) {
    shapes.push_back({&scene.hulls[scene.parts[part].hulls.front()], &poses[part]});
  }
  return shapes;
}

struct Distances {
  double sort_us = 0.0;
  std::size_t wrong_arcs = 0;
};

Distances sortByDistance(const std::vector<Shape>& shapes, const Vec3d& eye, std::span<const LayerArc> arcs) {
  std::vector<double> distances(shapes.size());
  std::vector<std::uint32_t> order(shapes.size()), rank(shapes.size());
  Distances result;
  result.sort_us = microseconds([&] {
    for (std::size_t i = 0; i < shapes.size(); ++i) {
      distances[i] = length(transformPoint(*shapes[i].world_from_hull, shapes[i].hull->centre) - eye);
    }
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return distances[a] < distances[b]; });
  });
  for (std::uint32_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = i;
  }
  result.wrong_arcs =
      static_cast<std::size_t>(std::count_if(arcs.begin(), arcs.end(), [&](const LayerArc& arc) {
        return rank[arc.front.value] > rank[arc.back.value];
      }));
  return result;
}

void measure(const ToothpickOptions& options, bool brief) {
  const MovingScene scene = makeToothpicks(options);
  LayerSorter depth_first = makeSorter(scene, {});
  LayerSorter incremental = makeSorter(scene, {.sort = incrementalSort()});
  LayerSorter all_arcs = makeSorter(scene, {.arcs = LayerArcs::kAll});
  std::vector<Mat4> poses(scene.parts.size());
  std::vector<std::pair<std::uint32_t, std::uint32_t>> arcs;
  std::vector<double> first_us, depth_first_us, incremental_us, pairs_us, distance_us;
  double pair_queries = 0.0, arc_count = 0.0, wrong = 0.0;
  const std::uint32_t frames = brief ? 40 : scene.frames;
  const std::size_t pair_frames = scene.parts.size() > 2000 ? 0 : scene.parts.size() > 500 ? 1 : 5;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    const View view = scene.scene.paths.front().view(frame, scene.scene.origin);
    pose(scene, frame, poses, depth_first);
    pose(scene, frame, poses, incremental);
    (frame == 0 ? first_us : depth_first_us).push_back(microseconds([&] {
      pair_queries += static_cast<double>(depth_first.update(view).stats.pair_queries);
    }));
    incremental_us.push_back(microseconds([&] { incremental.update(view); }));
    const bool compared = frame % 10 == 0;
    if (!compared) {
      continue;
    }
    pose(scene, frame, poses, all_arcs);
    const LayerOrder& order = all_arcs.update(view);
    const std::vector<Shape> shapes = shapesOf(scene, poses);
    const Distances distances = sortByDistance(shapes, view.eye, order.arcs);
    distance_us.push_back(distances.sort_us);
    arc_count += static_cast<double>(order.arcs.size());
    wrong += static_cast<double>(distances.wrong_arcs);
    if (pairs_us.size() < pair_frames) {
      pairs_us.push_back(microseconds([&] { allPairs(shapes, view.eye, arcs); }));
    }
  }
  const auto compared = static_cast<double>(distance_us.size());
  fmt::print(
      "{:>7} {:>3} | {:>9.1f} {:>9.1f} {:>9.1f} {:>9.1f} | {:>8.1f} | {:>11.0f} {:>9.0f} | {:>8.1f} {:>9.1f} "
      "{:>8.1f}\n",
      scene.parts.size(), options.uniform_density ? "ud" : "us", first_us.front(), meanOf(depth_first_us),
      *std::max_element(depth_first_us.begin(), depth_first_us.end()), meanOf(incremental_us),
      pair_queries / frames, meanOf(pairs_us), meanOf(pairs_us) / meanOf(depth_first_us), meanOf(distance_us),
      arc_count / compared, wrong / compared);
  std::fflush(stdout);
}

// A ring around the y axis, as wedges with a square section.
std::vector<ConvexHull> ringOf(std::uint32_t wedges, double radius, double thickness) {
  std::vector<ConvexHull> hulls;
  for (std::uint32_t i = 0; i < wedges; ++i) {
    std::vector<Vec3d> points;
    for (const std::uint32_t end : {i, i + 1}) {
      const double angle = 2.0 * std::numbers::pi * end / wedges;
      for (const double at : {radius - thickness, radius + thickness}) {
        points.emplace_back(at * std::cos(angle), -thickness, at * std::sin(angle));
        points.emplace_back(at * std::cos(angle), thickness, at * std::sin(angle));
      }
    }
    hulls.push_back(*buildHull(points));
  }
  return hulls;
}

struct Rings {
  std::vector<double> sort_us;
  double groups = 0.0, largest = 0.0, known_pairs = 0.0;  // means of a frame
};

// Sorts parts with these hulls along the paths of the toothpicks.
Rings sortRings(const MovingScene& scene, const std::vector<ConvexHull>& hulls, std::uint32_t frames) {
  LayerSorter sorter;
  std::vector<HullId> ids;
  for (const ConvexHull& hull : hulls) {
    ids.push_back(sorter.addHull(hull));
  }
  for (std::size_t part = 0; part < scene.parts.size(); ++part) {
    sorter.addPart(ids);
  }
  std::vector<Mat4> poses;
  Rings rings;
  for (std::uint32_t frame = 0; frame < frames; ++frame) {
    pose(scene, frame, poses, sorter);
    const View view = scene.scene.paths.front().view(frame, scene.scene.origin);
    const LayerOrder* order = nullptr;
    const double us = microseconds([&] { order = &sorter.update(view); });
    if (frame > 0) {
      rings.sort_us.push_back(us);
    }
    std::size_t largest = 0;
    for (std::size_t i = 0; i < order->groups(); ++i) {
      largest = std::max(largest, order->group(i).size());
    }
    rings.groups += static_cast<double>(order->groups()) / frames;
    rings.largest += static_cast<double>(largest) / frames;
    rings.known_pairs += static_cast<double>(order->stats.known_pairs) / frames;
  }
  return rings;
}

void measureRings(std::uint32_t count, bool brief) {
  constexpr std::uint32_t kWedges = 64;
  const MovingScene scene = makeToothpicks({.count = count});
  const std::vector<ConvexHull> wedges = ringOf(kWedges, 0.12, 0.004);
  std::vector<Vec3d> points;
  for (const ConvexHull& wedge : wedges) {
    points.insert(points.end(), wedge.vertices.begin(), wedge.vertices.end());
  }
  const std::uint32_t frames = brief ? 5 : 60;
  for (const bool as_union : {true, false}) {
    const Rings rings =
        sortRings(scene, as_union ? wedges : std::vector<ConvexHull>{*buildHull(points)}, frames);
    fmt::print("{:>7} {:>3} | {:>9.0f} {:>9.0f} | {:>9.1f} {:>9.1f} | {:>11.0f}\n", scene.parts.size(),
               as_union ? kWedges : 1, meanOf(rings.sort_us), medianOf(rings.sort_us), rings.groups,
               rings.largest, rings.known_pairs);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = argumentsOf(argc, argv);
  std::vector<std::uint32_t> counts;
  for (const std::string& word : arguments.words) {
    counts.push_back(static_cast<std::uint32_t>(std::stoul(word)));
  }
  if (counts.empty()) {
    counts = arguments.brief ? std::vector<std::uint32_t>{200} : std::vector<std::uint32_t>{200, 1600, 10000};
  }
  fmt::print("{:>11} | {:>39} | {:>8} | {:>21} | {:>27}\n", "", "sorter, us a frame", "exact",
             "all pairs, libccd", "by distance of centres");
  fmt::print("{:>11} | {:>9} {:>9} {:>9} {:>9} | {:>8} | {:>11} {:>9} | {:>8} {:>9} {:>8}\n", "parts",
             "first", "mean", "largest", "increm.", "pairs", "us", "/ mean", "us", "arcs", "wrong");
  for (const std::uint32_t count : counts) {
    measure({.count = count, .uniform_density = true}, arguments.brief);
    if (count < 5000) {
      measure({.count = count}, arguments.brief);
    }
  }
  fmt::print("\n{:>7} {:>3} | {:>9} {:>9} | {:>9} {:>9} | {:>11}\n", "rings", "of", "mean, us", "median",
             "groups", "largest", "hull pairs");
  for (const std::uint32_t count : {50u, 200u}) {
    measureRings(count, arguments.brief);
  }
}
