// How close to exact are the sets of cells? A table row for each scene: cells around some eyes of its walk,
// and of all pairs of such a cell and an object how many the bake keeps, and how many random lines of sight
// see (Embree). All begin where viewers are in the cell. A line to a point of the object's box sees it if
// nothing opaque of another object is in between: what a test of one box an object has to keep. A line to a
// point of one of its triangles sees it if it shows the object: what every test has to keep, so that
// "seen, not kept" must be 0. A line to a point of the surface of the box sees the closed box if nothing is
// before that point: ties are visible, so a test of one box an object has to keep what only touches a surface
// that hides all else of it, such as what stands on a floor, from below. "Clipped" lines do not count what is
// closer to the viewer than the near distance, because near planes may clip it; sets have to keep what they
// see, in boxes, as well. The last two columns are of the walk's views from these eyes, culled by the frustum
// and by the set of the cell, or of the eye's side of its plane, alone: what is kept for each object that the
// pixels of 640 x 360 show. "Best" is what the closed boxes that lines see from all of the cell would give in
// place of the set: what is due to the size of the cell. Microseconds are of processor time.
//
//   region_sets [--cell=METRES] [--cells=COUNT] [--lines=COUNT] [--crack-width=METRES] [--free[=MAX_HEIGHT]]
//               [--whole] [--near=METRES] [--narrowings=N] [--divisions=N] [--boxes=N] SCENE...
//
// Cells are at most --cell wide, one for each of --cells eyes, spread evenly over the walk. With --free,
// viewers are where one gets from the walk (findFreeSpace), at most MAX_HEIGHT above the ground, and sets are
// those of what of it lies in the cell; with --whole, of all of the cell.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "oracle/exact_visibility.h"
#include "oracle/ray_scene.h"
#include "oracle/split_mix.h"
#include "sightline/occluders/closed_scene.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/pvs/bake/viewer_space.h"
#include "src/pvs/bake/bake_scene.h"
#include "src/pvs/bake/cell_sets.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

struct Options {
  double cell = 2.0, crack_width = 0.0, max_height = std::numeric_limits<double>::infinity();
  std::uint32_t cells = 43, lines = 2000;
  bool free = false;
  BakeSettings settings{.occlusion = BakeOcclusion::kFused};
  std::vector<std::string> scenes;
};

Options optionsOf(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto is = [&word](std::string_view name) { return word.rfind(name, 0) == 0; };
    const double number = std::atof(word.substr(std::min(word.find('=') + 1, word.size())).c_str());
    const auto whole = static_cast<std::uint32_t>(std::max(number, 0.0));
    if (is("--cells=")) {
      options.cells = whole;
    } else if (is("--cell=")) {
      options.cell = number;
    } else if (is("--lines=")) {
      options.lines = whole;
    } else if (is("--crack-width=")) {
      options.crack_width = number;
    } else if (is("--free")) {
      options.free = true;
      options.max_height = is("--free=") ? number : options.max_height;
    } else if (is("--whole")) {
      options.settings.whole_cells = true;
    } else if (is("--near=")) {
      options.settings.near_distance = number;
    } else if (is("--narrowings=")) {
      options.settings.narrowings = whole;
    } else if (is("--divisions=")) {
      options.settings.divisions = whole;
    } else if (is("--boxes=")) {
      options.settings.object_boxes = whole;
    } else if (!is("--benchmark_min_time")) {
      options.scenes.push_back(word);
    }
  }
  return options;
}

Vec3d randomIn(const Vec3d& min, const Vec3d& max, SplitMix& random) {
  return {random.in(min.x, max.x), random.in(min.y, max.y), random.in(min.z, max.z)};
}

// A point of one of the object's triangles.
Vec3d randomOn(const SceneView& scene, const Object& object, SplitMix& random) {
  const std::span<const std::uint32_t> indices = scene.indicesOf(object);
  const std::size_t first = 3 * random.below(static_cast<std::uint32_t>(indices.size() / 3));
  double u = random.unit(), v = random.unit();
  if (u + v > 1.0) {
    u = 1.0 - u;
    v = 1.0 - v;
  }
  const Vec3d a(scene.positions[indices[first]]), b(scene.positions[indices[first + 1]]),
      c(scene.positions[indices[first + 2]]);
  return a + (b - a) * u + (c - a) * v;
}

// Traces random lines from the region, 16 at a time, until test(the 16, their hits) holds for one of them.
// to(random): where a line leads, and `beyond` of its length farther. near: what is closer to its start does
// not block a line, metres.
template <typename To, typename Test>
bool someLine(const RayScene& rays, const pvs::CellBox& region, std::uint32_t lines, float beyond,
              double near, SplitMix& random, const To& to, const Test& test) {
  std::vector<RayHit> hits;
  for (std::uint32_t line = 0; line < lines; line += RayScene::kBatch) {
    RayScene::Batch batch;
    for (FloatRay& ray : batch) {
      const Vec3d eye = randomIn(region.min, region.max, random), target = to(random), sight = target - eye;
      const Vec3d from = eye + sight * std::min(1.0, near / std::max(length(sight), near));
      ray = {Vec3f(from), Vec3f(target - from), 1.0f + beyond};
    }
    hits.clear();
    rays.trace(batch, RayScene::kBatch, false, hits);
    if (test(batch, hits)) {
      return true;
    }
  }
  return false;
}

// Where lines to a box end.
enum class BoxPart : std::uint8_t { kInside, kSurface };

Vec3d randomIn(const Box& box, BoxPart part, SplitMix& random) {
  Vec3d point = randomIn(Vec3d(box.min), Vec3d(box.max), random);
  if (part == BoxPart::kSurface) {
    const int axis = static_cast<int>(random.below(3));
    point[axis] = double{random.below(2) == 0 ? box.min[axis] : box.max[axis]};
  }
  return point;
}

// Whether a line reaches the object's box with nothing opaque of another object before it. What is at the
// surface of the box, to the rounding of rays, is not before it.
bool lineSeesBox(const RayScene& rays, const pvs::CellBox& region, const Box& box, ObjectId object,
                 BoxPart part, std::uint32_t lines, double near, SplitMix& random) {
  return someLine(
      rays, region, lines, part == BoxPart::kSurface ? -1e-6f : 0.0f, near, random,
      [&](SplitMix& numbers) { return randomIn(box, part, numbers); },
      [&](const RayScene::Batch&, const std::vector<RayHit>& hits) {
        std::uint32_t blocked = 0;
        for (const RayHit& hit : hits) {
          blocked |= (hit.opaque && hit.object != object ? 1u : 0u) << hit.ray;
        }
        return blocked != (1u << RayScene::kBatch) - 1;
      });
}

// True if the line from an eye through the point reaches the object first, in exact arithmetic: Embree's
// single precision may slip through an edge.
bool isConfirmed(const ExactVisibility& exact, const Vec3d& eye, ObjectId object, const Vec3d& point) {
  View view;
  view.eye = eye;
  setOrientation(view, point - eye, {0.0, 1.0, 0.0});
  view.z_near = 1e-3;
  view.z_far = 1e6;
  return exact.confirm(view, {object, point});
}

// Whether a line to one of the object's triangles shows the object. exact: confirms what Embree says, or
// null.
bool lineSees(const RayScene& rays, const SceneView& scene, const pvs::CellBox& region, ObjectId object,
              std::uint32_t lines, const ExactVisibility* exact, SplitMix& random) {
  const Object& target = scene.objects[object.value];
  return target.triangleCount() > 0 &&
         someLine(
             rays, region, lines, 1e-4f, 0.0, random,
             [&](SplitMix& numbers) { return randomOn(scene, target, numbers); },
             [&](const RayScene::Batch& batch, const std::vector<RayHit>& hits) {
               return std::any_of(hits.begin(), hits.end(), [&](const RayHit& hit) {
                 const FloatRay& ray = batch[hit.ray];
                 return hit.object == object &&
                        (exact == nullptr || isConfirmed(*exact, Vec3d(ray.origin), object, ray.at(hit.t)));
               });
             });
}

// The cell of the deepest level that holds the eye.
OctreeCell cellAt(const pvs::BakeScene& bake, const Vec3d& eye) {
  OctreeCell cell{bake.settings.max_depth, {}};
  for (int axis = 0; axis < 3; ++axis) {
    const double share = (eye[axis] - bake.root.min[axis]) / (bake.root.max[axis] - bake.root.min[axis]);
    const double most = std::ldexp(1.0, static_cast<int>(cell.level));
    cell.at[static_cast<std::size_t>(axis)] =
        static_cast<std::uint32_t>(std::clamp(std::floor(share * most), 0.0, most - 1.0));
  }
  return cell;
}

// The objects in the frustum that the set of the view's eye keeps.
std::uint64_t keptInView(const pvs::BakeScene& bake, const pvs::CellSets& sets, const View& view) {
  const CellSide side = sets.plane ? sideOf(*sets.plane, view.eye) : CellSide::kBetween;
  const pvs::Runs& set = side == CellSide::kFront  ? sets.front
                         : side == CellSide::kBack ? sets.back
                                                   : sets.whole;
  const Frustum frustum = frustumOf(view);
  std::uint64_t kept = 0;
  for (const pvs::ObjectRun& run : set) {
    for (std::uint32_t position = run.begin; position < run.end; ++position) {
      std::uint8_t planes = kAllFrustumPlanes;
      kept += classify(frustum, bake.leafOf(position).bounds, planes) != FrustumSide::kOutside ? 1 : 0;
    }
  }
  return kept;
}

void measure(const std::string& name, const Options& options) {
  BenchmarkScene loaded = loadScene(name, "region_sets");
  Scene& scene = loaded.scene;
  BakeSettings settings = options.settings;
  if (options.crack_width > 0.0) {
    ClosedScene closed = closeCracks(scene.view(), options.crack_width);
    settings.box_margin = closed.margin();
    scene.indices = std::move(closed.indices);
    scene.objects = std::move(closed.objects);
  }
  std::vector<Vec3d> eyes;
  for (const CameraFrame& frame : loaded.path.frames) {
    eyes.push_back(frame.eye - scene.origin);
  }
  const Box bounds = sceneBounds(scene.view());
  settings.viewers = {bounds};
  if (options.free) {
    settings.viewers =
        valueOrExit(findFreeSpace(scene.view(), eyes, {.max_height = options.max_height}), "region_sets")
            .boxes;
  }
  Box around;
  for (const Box& box : settings.viewers) {
    around.extend(box);
  }
  const Vec3f extent = around.max - around.min;
  const double edge = std::max({extent.x, extent.y, extent.z}) * (1.0 + 0x1p-20);
  settings.max_depth = static_cast<std::uint32_t>(std::max(0.0, std::ceil(std::log2(edge / options.cell))));
  const pvs::BakeScene bake(scene.view(), findOccluders(scene.view(), {.area_fraction = 1.0}), settings,
                            serialFor);
  const RayScene rays(scene.view());
  const ExactVisibility exact(scene.view());
  std::set<std::array<std::uint32_t, 3>> known;
  std::uint64_t pairs = 0, kept = 0, box_seen = 0, closed_box_seen = 0, clipped_seen = 0, seen = 0,
                seen_but_hidden = 0, in_view = 0, best_in_view = 0, exact_in_view = 0;
  double us = 0.0;
  SplitMix random{1};
  pvs::CellBaker baker(bake);
  for (std::uint32_t i = 0; i < options.cells && !eyes.empty(); ++i) {
    const OctreeCell cell = cellAt(bake, eyes[i * eyes.size() / options.cells]);
    if (!known.insert(cell.at).second || !bake.holdsViewers(bake.boxOf(cell))) {
      continue;
    }
    pvs::CellSets sets;
    const double start = processorMicroseconds();
    sets = baker.seenFrom(cell, 0.125 * bake.diagonal, {});
    us += processorMicroseconds() - start;
    pvs::ObjectMask keeps;
    keeps.reset(static_cast<std::uint32_t>(bake.boxes.objects.size()));
    keeps.add(sets.whole);
    const View view = loaded.path.view(i * eyes.size() / options.cells, scene.origin);
    in_view += keptInView(bake, sets, view);
    pvs::CellSets best;
    exact_in_view += exact.visibleThroughPixels(view, 640, 360).size();
    const pvs::CellBox region = bake.regionOf(cell);
    for (std::uint32_t position = 0; position < bake.boxes.objects.size(); ++position) {
      const Box& box = bake.leafOf(position).bounds;
      if (!box.wellFormed()) {
        continue;
      }
      const ObjectId object = bake.boxes.objects[position];
      const auto seesBox = [&](BoxPart part, double near) {
        return lineSeesBox(rays, region, box, object, part, options.lines, near, random);
      };
      const bool sees_box = seesBox(BoxPart::kInside, 0.0);
      const bool sees_closed_box = sees_box || seesBox(BoxPart::kSurface, 0.0);
      // What is neither kept nor seen is hardly in doubt.
      const std::uint32_t lines =
          sees_closed_box || keeps.contains(position) ? options.lines : options.lines / 10;
      const bool sees = lineSees(rays, scene.view(), region, object, lines,
                                 keeps.contains(position) ? nullptr : &exact, random);
      const bool sees_any = sees_closed_box || sees;
      const bool clipped_sees = sees_any || seesBox(BoxPart::kInside, settings.near_distance);
      if (sees_any) {
        best.whole.push_back({position, position + 1});
      }
      closed_box_seen += sees_any ? 1 : 0;
      clipped_seen += clipped_sees ? 1 : 0;
      box_seen += sees_box ? 1 : 0;
      pairs += 1;
      kept += keeps.contains(position) ? 1 : 0;
      seen += sees ? 1 : 0;
      seen_but_hidden += sees && !keeps.contains(position) ? 1 : 0;
    }
    best_in_view += keptInView(bake, best, view);
  }
  const auto percent = [&](std::uint64_t count) {
    return 100.0 * static_cast<double>(count) / static_cast<double>(std::max<std::uint64_t>(pairs, 1));
  };
  const auto ratio = [](std::uint64_t a, std::uint64_t b) {
    return static_cast<double>(a) / static_cast<double>(b);
  };
  fmt::print("| {} | {:.3g} | {} | {} |", name.substr(name.rfind('/') + 1),
             std::ldexp(bake.root.extent().x, -static_cast<int>(settings.max_depth)), known.size(), pairs);
  for (const std::uint64_t count : {box_seen, closed_box_seen, clipped_seen, seen, kept}) {
    fmt::print(" {:.2f} |", percent(count));
  }
  for (const std::uint64_t count : {box_seen, closed_box_seen, clipped_seen, seen}) {
    fmt::print(" {:.3f} |", ratio(kept, count));
  }
  fmt::print(" {:.0f} | {} | {:.2f} | {:.2f} |\n", us / static_cast<double>(pairs), seen_but_hidden,
             ratio(in_view, exact_in_view), ratio(best_in_view, exact_in_view));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = optionsOf(argc, argv);
  fmt::print(
      "| scene | cell, m | cells | pairs | lines to boxes, % | closed boxes, % | clipped, % | to "
      "triangles, % "
      "| kept, % | kept / lines to boxes | closed boxes | clipped | to triangles | us a pair "
      "| seen, not kept | in view / exact | best |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : options.scenes) {
    measure(scene, options);
  }
  return 0;
}
