// Scenes whose narrow cracks count as closed, against exact visibility: nothing is hidden that can be seen
// past their triangles, and of the given triangles only what lies beside an edge or behind a crack.

#include "sightline/occluders/closed_scene.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "oracle/exact_visibility.h"
#include "sightline/culling/culler.h"
#include "sightline/culling/depth_pyramid_method.h"
#include "sightline/culling/occlusion_tree_method.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "tests/support/hand_made.h"
#include "tests/support/object_arrays.h"

namespace sightline {
namespace {

using namespace hand_made;

constexpr double kEndless = std::numeric_limits<double>::infinity();
constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

// What the caller of a culler makes of a scene with closed cracks.
struct ClosedCulling {
  ClosedCulling(const Scene& scene, double width)
      : closed(closeCracks(scene.view(), width)),
        surfaces(findSurfaces(closed.view(scene.view()))),
        occluders(findOccluders(closed.view(scene.view()))),
        boxes(findObjectBoxes(closed.view(scene.view()), {.min_saving = 0.0, .margin = closed.margin()})),
        bounds(test::boxesOf(closed.objects)),
        hierarchy(buildHierarchy(bounds, {})) {}

  std::vector<ObjectId> kept(const View& view, bool pyramid) const {
    Culler culler({.hierarchy = &hierarchy,
                   .object_bounds = bounds,
                   .object_boxes = &boxes,
                   .occluders = &occluders,
                   .surfaces = &surfaces},
                  pyramid ? depthPyramid() : occlusionTree());
    culler.cull(view);
    return {culler.visible().begin(), culler.visible().end()};
  }

  ClosedScene closed;
  SurfaceSet surfaces;
  OccluderSet occluders;
  ObjectBoxes boxes;
  std::vector<Box> bounds;
  Hierarchy hierarchy;
};

bool contains(const std::vector<ObjectId>& ids, ObjectId id) {
  return std::binary_search(ids.begin(), ids.end(), id);
}

// Two walls side by side with a slit between them, and a small object behind it.
struct Slit {
  explicit Slit(float width) {
    const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
    addWall(scene, material, -5.0f, -20.0f, 0.0f, -20.0f, 20.0f);
    addWall(scene, material, -5.0f, width, 20.0f, -20.0f, 20.0f);
    behind = addWall(scene, material, -9.0f, -0.3f, 0.3f, -0.3f, 0.3f);
    across = addWall(scene, material, -9.0f, 3.0f, 3.2f, -0.1f, 0.1f);
  }
  Scene scene;
  ObjectId behind, across;
};

TEST(ClosedScenes, ASlitIsClosedByAWidthAboveItsOwn) {
  const Slit slit(0.001f);
  for (const bool pyramid : {false, true}) {
    for (const double width : {0.0, 0.0009, kUndefined, kEndless, -1.0}) {
      EXPECT_TRUE(contains(ClosedCulling(slit.scene, width).kept(frontView(), pyramid), slit.behind))
          << width << " " << pyramid;
    }
    const ClosedCulling wide(slit.scene, 0.0011);
    EXPECT_EQ(wide.closed.merged, 2u);
    EXPECT_FALSE(contains(wide.kept(frontView(), pyramid), slit.across)) << pyramid;
  }
  EXPECT_FALSE(contains(ClosedCulling(slit.scene, 0.0011).kept(frontView(), true), slit.behind));
}

TEST(ClosedScenes, WithoutAWidthTheSceneIsTheSame) {
  const Slit slit(0.001f);
  for (const double width : {0.0, -1.0, kUndefined, kEndless}) {
    const ClosedScene closed = closeCracks(slit.scene.view(), width);
    EXPECT_EQ(closed.indices, slit.scene.indices);
    EXPECT_EQ(closed.slack, 0.0);
    for (std::size_t o = 0; o < closed.objects.size(); ++o) {
      EXPECT_EQ(closed.objects[o].bounds, slit.scene.objects[o].bounds);
    }
    EXPECT_TRUE(findCracks(slit.scene.view(), width).empty() || width == 0.0);
  }
  const ClosedScene empty = closeCracks({}, 0.1);
  EXPECT_TRUE(empty.indices.empty() && empty.objects.empty());
  EXPECT_TRUE(findCracks({}, 0.1).empty());
}

// What may not occlude, or has no place, is passed on as it is.
TEST(ClosedScenes, OnlyOccludersAreTouched) {
  Scene scene;
  const MaterialId glass = addMaterial(scene, Opacity::kBlended, true),
                   solid = addMaterial(scene, Opacity::kOpaque, true);
  addWall(scene, glass, -5.0f, -1.0f, 0.0f, -1.0f, 1.0f);
  addWall(scene, solid, -5.0f, 0.001f, 1.0f, -1.0f, 1.0f);
  scene.objects[1].mark = OccluderMark::kNever;
  addWall(scene, solid, -5.0f, 0.002f, 1.0f, -1.0f, 1.0f);
  scene.positions[scene.indices[scene.objects[2].first_index]].x = std::numeric_limits<float>::quiet_NaN();
  addWall(scene, solid, -5.0f, 0.003f, 0.0031f, -1.0f, 1.0f);
  const ClosedScene closed = closeCracks(scene.view(), 0.01);
  ASSERT_EQ(closed.objects.size(), 4u);
  for (const std::size_t o : {0u, 1u}) {
    EXPECT_EQ(closed.objects[o].triangleCount(), 2u);
    EXPECT_EQ(closed.objects[o].material, scene.objects[o].material);
    EXPECT_EQ(closed.objects[o].mark, scene.objects[o].mark);
  }
  const auto sliver = closed.view(scene.view()).indicesOf(closed.objects[3]);
  ASSERT_FALSE(sliver.empty()) << "narrower than the width: it hides nothing, but boxes hold it";
  for (std::size_t i = 0; i < sliver.size(); i += 3) {
    EXPECT_TRUE(sliver[i] == sliver[i + 1] || sliver[i + 1] == sliver[i + 2] || sliver[i] == sliver[i + 2]);
  }
  EXPECT_TRUE(sightline::contains(closed.objects[3].bounds, scene.objects[3].bounds));
  for (const Crack& crack : findCracks(scene.view(), 0.01)) {
    EXPECT_GE(crack.object.value, 2u);
  }
}

TEST(ClosedScenes, BoundsThatAreNotFiniteStaySo) {
  Scene scene;
  const MaterialId solid = addMaterial(scene, Opacity::kOpaque, true);
  addWall(scene, solid, -5.0f, -1.0f, 1.0f, -1.0f, 1.0f);
  addTriangles(scene, solid,
               std::array<Vec3f, 6>{{{0, 0, -9},
                                     {1, 0, -9},
                                     {0, 1, -9},
                                     {0, 0, -9},
                                     {std::numeric_limits<float>::infinity(), 0, -9},
                                     {0, 1, -9}}});
  const ClosedCulling closing(scene, 0.001);
  EXPECT_EQ(closing.closed.objects[1].bounds, scene.objects[1].bounds);
  EXPECT_EQ(closing.closed.objects[1].triangleCount(), 2u);
  EXPECT_TRUE(contains(closing.kept(frontView(), true), ObjectId(1u)));
}

// Hundreds of triangles within the width of each other: every pair of them is near, and few places stay.
TEST(ClosedScenes, CrowdsWithinTheWidthBecomeFewPlaces) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(0.0f, 0.005f);
  Scene scene;
  std::vector<Vec3f> corners;
  for (int i = 0; i < 3 * 800; ++i) {
    corners.push_back({place(random), place(random), place(random)});
  }
  addTriangles(scene, addMaterial(scene, Opacity::kOpaque, false), corners);
  const ClosedScene closed = closeCracks(scene.view(), 0.01);
  EXPECT_GT(closed.merged, 2300u);
  EXPECT_LE(closed.slack, 0.0201);
  EXPECT_GE(findCracks(scene.view(), 0.01).size(), 2300u);
}

// Between two segments. The distance of a point that moves along a segment from another one is convex.
double distanceOfSegments(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const auto distance = [&](double part) {
    const Vec3d p = a + (b - a) * part;
    const double along = std::clamp(dot(p - c, d - c) / dot(d - c, d - c), 0.0, 1.0);
    return length(p - c - (d - c) * along);
  };
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 80; ++i) {
    const double left = low + (high - low) / 3.0, right = high - (high - low) / 3.0;
    (distance(left) < distance(right) ? high : low) = distance(left) < distance(right) ? right : left;
  }
  return distance(low);
}

// A grid of panels with corners of their own, each up to `by` beside its place, and targets behind them.
Scene shakenPanels(unsigned seed, float by) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> shake(-by, by), place(-2.0f, 2.0f), size(0.02f, 0.2f),
      far(-4.2f, -2.0f);
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  for (int i = -4; i < 4; ++i) {
    for (int j = -4; j < 4; ++j) {
      const float x0 = 0.5f * static_cast<float>(i), y0 = 0.5f * static_cast<float>(j);
      const auto corner = [&](float x, float y) {
        return Vec3f(x + shake(random), y + shake(random), -2.0f + 0.1f * std::sin(x + y) + shake(random));
      };
      // T-junctions: every other panel is divided along its middle.
      const Vec3f a = corner(x0, y0), b = corner(x0 + 0.5f, y0), c = corner(x0 + 0.5f, y0 + 0.5f),
                  d = corner(x0, y0 + 0.5f), left = corner(x0, y0 + 0.25f),
                  right = corner(x0 + 0.5f, y0 + 0.25f);
      if ((i + j) % 2 == 0) {
        addTriangles(scene, material, std::array<Vec3f, 6>{a, b, c, a, c, d});
      } else {
        addTriangles(scene, material,
                     std::array<Vec3f, 12>{a, b, right, a, right, left, left, right, c, left, c, d});
      }
    }
  }
  for (int i = 0; i < 120; ++i) {
    const float x = place(random), y = place(random), s = size(random);
    addWall(scene, material, far(random) - 0.2f, x, x + s, y, y + s);
  }
  return scene;
}

TEST(ClosedScenes, HideNothingThatShowsOtherThanBesideAnEdge) {
  constexpr float kShake = 0.0004f;
  constexpr double kWidth = 0.003;
  std::size_t more = 0, beside = 0;
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Scene given = shakenPanels(seed, kShake);
    const ClosedCulling closing(given, kWidth), open(given, 0.0);
    EXPECT_GT(closing.closed.slack, 0.0);
    EXPECT_LE(closing.closed.slack, 2.0 * kWidth);
    Scene closed = given;
    closed.indices = closing.closed.indices;
    closed.objects = closing.closed.objects;
    const ExactVisibility of_given(given.view()), of_closed(closed.view());
    std::vector<ObjectId> all;
    for (std::size_t o = 0; o < given.objects.size(); ++o) {
      all.push_back(ObjectId(o));
    }
    for (const double x : {0.0, 0.3, 1.7}) {
      View view = frontView();
      view.eye = {x, 0.2 * x, 0.01};
      for (const bool pyramid : {false, true}) {
        const std::vector<ObjectId> kept = closing.kept(view, pyramid);
        more += open.kept(view, pyramid).size() - kept.size();
        for (const Decision& decision : of_closed.decide(view, all, 20'000)) {
          if (decision.verdict == Verdict::kVisible) {
            EXPECT_TRUE(contains(kept, decision.witness.object)) << seed << " " << pyramid;
          }
        }
        for (const Decision& decision : of_given.decide(view, all, 20'000)) {
          if (decision.verdict != Verdict::kVisible || contains(kept, decision.witness.object)) {
            continue;
          }
          beside += 1;
          double nearest = kEndless;
          for (std::size_t i = 0; i < given.indices.size(); ++i) {
            const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
            nearest = std::min(nearest, distanceOfSegments(view.eye, decision.witness.point,
                                                           Vec3d(given.positions[given.indices[i]]),
                                                           Vec3d(given.positions[given.indices[next]])));
          }
          EXPECT_LE(nearest, closing.closed.slack) << decision.witness.object.value;
        }
      }
    }
  }
  EXPECT_GT(more, 60u) << "closing has to hide something";
  EXPECT_GT(beside, 10u) << "some of it has to show through cracks";
}

TEST(ClosedScenes, BoxesHoldBothScenesAndAreApartFromThem) {
  Scene given = shakenPanels(9, 0.001f);
  // An object of a far part and of a sliver, which collapses.
  const std::vector<Vec3f> apart{{3, 3, -4}, {4, 3, -4},         {3, 4, -4},
                                 {0, 5, -4}, {0.5f, 5.002f, -4}, {0, 5.004f, -4}};
  addTriangles(given, given.objects[0].material, apart);
  const ClosedCulling closing(given, 0.005);
  const double slack = closing.closed.slack;
  std::size_t several = 0;
  for (std::uint32_t o = 0; o < given.objects.size(); ++o) {
    const Box& bounds = closing.closed.objects[o].bounds;
    const Box& before = given.objects[o].bounds;
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_LE(bounds.min[axis], before.min[axis] - slack * 0.999);
      EXPECT_GE(bounds.max[axis], before.max[axis] + slack * 0.999);
    }
    const std::span<const Box> of = closing.boxes.of(ObjectId(o));
    several += of.empty() ? 0 : 1;
    Box together;
    for (const Box& box : of) {
      together.extend(box);
    }
    EXPECT_TRUE(of.empty() || together == bounds) << "or the boxes are not used";
    for (const std::uint32_t index : given.view().indicesOf(given.objects[o])) {
      const Vec3f& p = given.positions[index];
      const auto holds = [&](const Box& box) { return sightline::contains(box, Box{p, p}); };
      EXPECT_TRUE(of.empty() || std::any_of(of.begin(), of.end(), holds));
    }
  }
  EXPECT_GT(several, 10u);
}

TEST(Cracks, AreCountedByWidth) {
  Scene scene;
  const MaterialId material = addMaterial(scene, Opacity::kOpaque, true);
  // A long edge, and three corners of other objects beside it: on it, a unit in the last place beside it, and
  // half a millimetre.
  addTriangles(scene, material, std::array<Vec3f, 3>{{{0, 0, 0}, {8, 0, 0}, {4, -4, 0}}});
  addTriangles(scene, material, std::array<Vec3f, 3>{{{1, 0, 0}, {2, 4, 0}, {0, 4, 0}}});
  addTriangles(scene, material,
               std::array<Vec3f, 3>{{{3, std::nextafter(0.0f, 1.0f), 0}, {4, 4, 0}, {3, 4, 0}}});
  addTriangles(scene, material, std::array<Vec3f, 3>{{{5, 0.0005f, 0}, {6, 4, 0}, {5, 4, 0}}});
  const ObjectId near_edge(3u), edge(0u);
  std::vector<Crack> cracks = findCracks(scene.view(), 0.001);
  ASSERT_EQ(cracks.size(), 1u) << "below a rounding of the distance itself nothing is told apart";
  EXPECT_EQ(cracks[0].object, near_edge);
  EXPECT_EQ(cracks[0].other, edge);
  EXPECT_FLOAT_EQ(static_cast<float>(cracks[0].width), 0.0005f);
  EXPECT_EQ(cracks[0].at, Vec3f(5, 0.0005f, 0));
  EXPECT_TRUE(findCracks(scene.view(), 0.0004).empty());
  scene.positions[6].y = 1e-6f;  // the corner at x = 3
  cracks = findCracks(scene.view(), 0.001);
  ASSERT_EQ(cracks.size(), 2u);
  EXPECT_FLOAT_EQ(static_cast<float>(cracks[0].width), 1e-6f);
}

}  // namespace
}  // namespace sightline
