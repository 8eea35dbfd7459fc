// Compares the parts that rays hit first with those that come first in the order.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "tests/layers/hull_rays.h"
#include "tests/layers/moving_sorter.h"
#include "tests/layers/sorter_choices.h"
#include "tests/support/layer_shapes.h"

namespace sightline {
namespace {

using shapes::Random;
using test::HullRays;
using test::RayStretch;

struct Ray {
  Vec3d from, direction;
};

// Returns the view's ray through a point.
Ray rayThrough(const View& view, const Vec3d& point) {
  if (!view.orthographic) {
    return {view.eye, point - view.eye};
  }
  return {point - view.forward * (dot(point - view.eye, view.forward) + 100.0), view.forward};
}

// Returns a point of the part's hull near its silhouette on the side of `towards`.
Vec3d farSide(const MovingSorter& moving, std::uint32_t part, const Vec3d& towards) {
  const ConvexHull& hull = moving.scene().hulls[moving.scene().parts[part].hulls[0]];
  const Mat4& m = moving.poses()[part];
  Vec3d best = transformPoint(m, hull.vertices[0]);
  for (const Vec3d& vertex : hull.vertices) {
    const Vec3d world = transformPoint(m, vertex);
    best = dot(world, towards) > dot(best, towards) ? world : best;
  }
  // The point is a little inside, since a ray through the vertex itself hits no inner point.
  return best + (transformPoint(m, hull.centre) - best) * 1e-5;
}

// Returns two rays for each two parts that are near each other in the view: through the side of each part
// that is nearest to the other. They hit both parts even if these hardly overlap.
void addRaysAtPairs(const MovingSorter& moving, const View& view, std::vector<Ray>& rays) {
  struct Ball {
    Vec3d centre;
    double radius = 0.0;
  };
  std::vector<Ball> balls;
  for (std::uint32_t i = 0; i < moving.scene().parts.size(); ++i) {
    const ConvexHull& hull = moving.scene().hulls[moving.scene().parts[i].hulls[0]];
    balls.push_back({transformPoint(moving.poses()[i], hull.centre), hull.radius});
  }
  for (std::uint32_t a = 0; a < balls.size(); ++a) {
    if (moving.scene().parts[a].settings.place != PartSettings::Place::kSorted) {
      continue;
    }
    for (std::uint32_t b = 0; b < balls.size(); ++b) {
      const Vec3d forward = normalized(rayThrough(view, balls[a].centre).direction);
      Vec3d across = balls[b].centre - rayThrough(view, balls[b].centre).from;
      across = across - forward * dot(across, forward);
      if (view.orthographic) {
        across = balls[b].centre - balls[a].centre;
        across = across - forward * dot(across, forward);
      }
      if (a == b || length(across) > 2.0 * (balls[a].radius + balls[b].radius) || !(length(across) > 0.0)) {
        continue;
      }
      rays.push_back(rayThrough(view, farSide(moving, a, across)));
    }
  }
}

std::vector<Ray> manyRays(const MovingSorter& moving, const View& view, Random& random, int anywhere) {
  std::vector<Ray> rays;
  for (int i = 0; i < anywhere; ++i) {
    rays.push_back(view.orthographic ? rayThrough(view, random.point({0, 0, 0}, {1, 1, 1}))
                                     : Ray{view.eye, random.direction()});
  }
  for (std::uint32_t part = 0; part < moving.scene().parts.size(); ++part) {
    for (int i = 0; i < 4; ++i) {
      rays.push_back(rayThrough(view, farSide(moving, part, random.direction())));
    }
  }
  addRaysAtPairs(moving, view, rays);
  return rays;
}

struct Seen {
  std::size_t pairs = 0;   // pairs of parts that a ray hits one after the other
  std::size_t images = 0;  // rays that hit several parts, all in groups of one part
};

// A part that the ray enters before it leaves another must occlude that one.
void expectArcs(const MovingSorter& moving, std::span<const RayStretch> hits, const LayerOrder& order,
                Seen& seen) {
  for (const RayStretch& a : hits) {
    for (const RayStretch& b : hits) {
      if (a.part == b.part || a.enter > b.leave || moving.hasRule(a.part, b.part)) {
        continue;
      }
      ++seen.pairs;
      const LayerArc arc{PartId(a.part), PartId(b.part)};
      EXPECT_TRUE(std::binary_search(order.arcs.begin(), order.arcs.end(), arc))
          << moving.scene().parts[a.part].name << " occludes " << moving.scene().parts[b.part].name;
    }
  }
}

// The part that is drawn last is the nearest one, so painting gives the same image as a depth buffer.
void expectFirstIsNearest(const MovingSorter& moving, std::span<const RayStretch> hits,
                          std::span<const std::uint32_t> place, std::span<const std::uint32_t> group_size,
                          Seen& seen) {
  const bool alone =
      std::all_of(hits.begin(), hits.end(), [&](const RayStretch& m) { return group_size[m.part] == 1; });
  if (hits.size() < 2 || !alone) {
    return;
  }
  const RayStretch& first = *std::min_element(
      hits.begin(), hits.end(),
      [&](const RayStretch& a, const RayStretch& b) { return place[a.part] < place[b.part]; });
  for (const RayStretch& other : hits) {
    if (!moving.hasRule(first.part, other.part)) {
      EXPECT_LE(first.enter, other.enter) << moving.scene().parts[first.part].name << " is drawn over "
                                          << moving.scene().parts[other.part].name;
    }
  }
  ++seen.images;
}

void checkFrame(MovingSorter& moving, const View& view, Random& random, int anywhere, Seen& seen) {
  const HullRays hulls(moving.scene(), moving.poses());
  const LayerOrder& order = moving.sorter().update(view);
  std::vector<std::uint32_t> place(order.parts.size()), group_size(order.parts.size());
  for (std::uint32_t i = 0; i < order.parts.size(); ++i) {
    place[order.parts[i].value] = i;
  }
  for (std::size_t i = 0; i < order.groups(); ++i) {
    for (const PartId part : order.group(i)) {
      group_size[part.value] = static_cast<std::uint32_t>(order.group(i).size());
    }
  }
  for (const Ray& ray : manyRays(moving, view, random, anywhere)) {
    const std::vector<RayStretch> hits = hulls.hits(ray.from, ray.direction);
    expectArcs(moving, hits, order, seen);
    expectFirstIsNearest(moving, hits, place, group_size, seen);
    if (::testing::Test::HasFailure()) {
      return;
    }
  }
}

LayerSettings settingsOf(SortChoice sort, SearchChoice search) {
  LayerSettings settings;
  settings.sort = sortOf(sort);
  settings.search = searchOf(search);
  settings.arcs = LayerArcs::kAll;
  return settings;
}

Seen checkToothpicks(std::uint32_t count, const LayerSettings& settings) {
  const MovingScene scene = makeToothpicks({.count = count});
  MovingSorter moving(scene, settings);
  Random random(count);
  Seen seen;
  for (std::uint32_t frame = 0; frame < 5; ++frame) {
    SCOPED_TRACE(::testing::Message() << "seed " << count << ", frame " << frame);
    moving.pose(frame * 40);
    View view = moving.view(frame * 40);
    if (frame == 2) {
      view.eye = random.point({0.2, 0.2, 0.2}, {0.8, 0.8, 0.8});  // among the toothpicks
    }
    view.orthographic = frame == 3;
    checkFrame(moving, view, random, 2000, seen);
    if (::testing::Test::HasFailure()) {
      break;
    }
  }
  return seen;
}

TEST(LayerSorterRays, AgreeOnSixtyToothpicks) {
  for (const SortChoice sort : kSortChoices) {
    for (const SearchChoice search : kSearchChoices) {
      const Seen seen = checkToothpicks(60, settingsOf(sort, search));
      EXPECT_GT(seen.pairs, 500u);
      EXPECT_GT(seen.images, 100u);
    }
  }
  LayerSettings settings = settingsOf(SortChoice::kDepthFirst, SearchChoice::kTree);
  settings.extents = worldExtents();
  const Seen seen = checkToothpicks(60, settings);
  EXPECT_GT(seen.pairs, 500u);
  EXPECT_GT(seen.images, 100u);
}

TEST(LayerSorterRays, AgreeOnTheCanyon) {
  const MovingScene scene = makeCanyon({.grid = 10});
  LayerSettings settings = settingsOf(SortChoice::kDepthFirst, SearchChoice::kScan);
  settings.extents = worldExtents();
  MovingSorter moving(scene, settings);
  Random random(3);
  Seen seen;
  for (const std::uint32_t frame : {0u, 77u, 150u, 249u}) {
    SCOPED_TRACE(::testing::Message() << "seed 3, frame " << frame);
    moving.pose(frame);
    checkFrame(moving, moving.view(frame), random, 4000, seen);
    if (HasFailure()) {
      break;
    }
  }
  EXPECT_GT(seen.pairs, 500u);
  EXPECT_GT(seen.images, 100u);
}

}  // namespace
}  // namespace sightline
