#include "src/pvs/bake/surfaces/region_occlusion.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "oracle/region_proof.h"
#include "tests/pvs/bake_scenes.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/rounds.h"

namespace sightline::pvs {
namespace {

using test::block;
using test::dicedBlock;
using test::sceneOf;
using test::Solid;

constexpr double kNear = 0.1;

// Independent of the code under test: whether a line of sight is free, by a test of each triangle. A triangle
// that the line nearly misses does not block it.
bool seesByLine(const Scene& scene, const Vec3d& eye, const Vec3d& point, double near) {
  const Vec3d along = point - eye;
  const double size = length(along);
  for (const Object& object : scene.objects) {
    const Material& material = scene.materials[object.material.value];
    for (std::uint32_t i = object.first_index; i < object.first_index + object.index_count; i += 3) {
      const Vec3d a(scene.positions[scene.indices[i]]), u = Vec3d(scene.positions[scene.indices[i + 1]]) - a,
                                                        v = Vec3d(scene.positions[scene.indices[i + 2]]) - a;
      const double facing = dot(cross(u, v), along);
      if (facing == 0.0 || (facing > 0.0 && !material.double_sided)) {
        continue;
      }
      const Vec3d from = eye - a;
      const double s = dot(cross(from, v), along) / facing, t = dot(cross(u, from), along) / facing,
                   at = -dot(cross(u, v), from) / facing;
      if (s >= 0.0 && t >= 0.0 && s + t <= 1.0 && at * size > near && at < 1.0 - 1e-9) {
        return false;
      }
    }
  }
  return true;
}

// A point of a box, often on its border.
Vec3d placeIn(const CellBox& box, std::mt19937& random) {
  Vec3d place;
  for (int axis = 0; axis < 3; ++axis) {
    const double t = std::uniform_real_distribution<double>(0.0, 1.0)(random);
    const auto border = random() % 6;
    place[axis] = border == 0   ? box.min[axis]
                  : border == 1 ? box.max[axis]
                                : box.min[axis] + (box.max[axis] - box.min[axis]) * t;
  }
  return place;
}

bool seesByLines(const Scene& scene, const CellBox& region, const CellBox& target, int lines,
                 std::mt19937& random, double near = kNear) {
  for (int i = 0; i < lines; ++i) {
    if (seesByLine(scene, placeIn(region, random), placeIn(target, random), near)) {
      return true;
    }
  }
  return false;
}

bool hides(const Scene& scene, const Panels& panels, const CellBox& region, const FusedTarget& target,
           const RegionEffort& effort = {}, double near = kNear) {
  RegionOcclusion occlusion(panels, near, 100.0);
  const bool hidden = occlusion.hides(region, target, effort);
  std::mt19937 random(11);
  EXPECT_FALSE(hidden && seesByLines(scene, region, target.box, 2000, random, near));
  return hidden;
}
bool hides(const Scene& scene, const CellBox& region, const FusedTarget& target,
           const RegionEffort& effort = {}, double near = kNear) {
  return hides(scene, findPanels(scene.view()), region, target, effort, near);
}

// A wall across x = 0 of many rectangles, 8 metres wide and high, with its front towards -x. `without` is one
// that is left out, counted along z and then y.
Solid wallOfTiles(int count, int without = -1, bool reversed = false) {
  Solid solid;
  const auto at = [&](int i) { return -4.0f + 8.0f * static_cast<float>(i) / static_cast<float>(count); };
  for (int y = 0; y <= count; ++y) {
    for (int z = 0; z <= count; ++z) {
      solid.points.emplace_back(0.0f, at(y), at(z));
    }
  }
  for (int y = 0; y < count; ++y) {
    for (int z = 0; z < count; ++z) {
      if (y * count + z != without) {
        const auto first = static_cast<std::uint32_t>(y * (count + 1) + z);
        const auto row = static_cast<std::uint32_t>(count + 1);
        std::vector<std::uint32_t> face{first, first + 1, first + row + 1, first + row};
        if (reversed) {
          std::reverse(face.begin(), face.end());
        }
        solid.faces.push_back(face);
      }
    }
  }
  return solid;
}

const CellBox kViewers{{-6, -0.5, -0.5}, {-5, 0.5, 0.5}};
const FusedTarget kBehind{.box = {{3, -1, -1}, {4, 1, 1}}};

TEST(RegionOcclusion, ManySmallTrianglesHideTogether) {
  EXPECT_TRUE(hides(sceneOf({wallOfTiles(20)}), kViewers, kBehind));
}

TEST(RegionOcclusion, AHoleInTheShaftIsSeenThroughAndOneBesideItIsNot) {
  EXPECT_FALSE(hides(sceneOf({wallOfTiles(20, 10 * 20 + 10)}), kViewers, kBehind));
  EXPECT_TRUE(hides(sceneOf({wallOfTiles(20, 0)}), kViewers, kBehind));
}

TEST(RegionOcclusion, BacksHideNothingButDoubleSidedTrianglesDo) {
  Scene scene = sceneOf({wallOfTiles(5, -1, true)});
  EXPECT_FALSE(hides(scene, kViewers, kBehind));
  EXPECT_TRUE(hides(scene, kBehind.box, {.box = kViewers})) << "from the other side";
  scene.materials[0].double_sided = true;
  EXPECT_TRUE(hides(scene, kViewers, kBehind));
}

TEST(RegionOcclusion, WhatTheNearPlaneMayClipHidesNothing) {
  const Scene scene = sceneOf({wallOfTiles(5)});
  const CellBox close{{-1, -0.5, -0.5}, {-0.05, 0.5, 0.5}};
  EXPECT_FALSE(hides(scene, close, kBehind, {.divisions = 3}, 0.1));
  EXPECT_TRUE(hides(scene, close, kBehind, {}, 0.01));
}

TEST(RegionOcclusion, ASlitIsSeenThroughAndATouchIsNot) {
  const auto halves = [](float slit) {
    return sceneOf({block({0, -4, -4}, {0.5f, 4, 0}), block({0, -4, slit}, {0.5f, 4, 4})});
  };
  EXPECT_FALSE(hides(halves(1e-4f), kViewers, kBehind, {.divisions = 4}));
  EXPECT_FALSE(hides(halves(std::nextafter(0.0f, 1.0f)), kViewers, kBehind, {.divisions = 4}));
  EXPECT_TRUE(hides(halves(0.0f), kViewers, kBehind));
}

TEST(RegionOcclusion, WhatTouchesOrPenetratesIsOneSurface) {
  // Boards on each other's edges, a post pushed into them, and a wall that stands on a slab.
  EXPECT_TRUE(hides(sceneOf({block({0, -4, -4}, {0.5f, 0.25f, 0.25f}),
                             block({0, -4, 0.25f}, {0.5f, 0.25f, 4}), block({0, 0.25f, -4}, {0.5f, 4, 4})}),
                    kViewers, kBehind));
  EXPECT_TRUE(hides(sceneOf({block({0, -4, -4}, {0.5f, 4, -0.1f}), block({0, -4, 0.1f}, {0.5f, 4, 4}),
                             block({-0.25f, -4, -0.3f}, {0.25f, 4, 0.3f})}),
                    kViewers, kBehind));
  const Scene standing = sceneOf({block({-8, -2, -8}, {8, -1, 8}), block({0, -1, -4}, {0.5f, 4, 4})});
  EXPECT_TRUE(hides(standing, kViewers, {.box = {{3, -1, -1}, {4, 1, 1}}}));
}

TEST(RegionOcclusion, ATargetMayStandOnWhatHidesIt) {
  // The floor and the wall are one mesh; the target's lower face lies on the floor.
  Solid solid = wallOfTiles(4);
  const auto first = static_cast<std::uint32_t>(solid.points.size());
  for (const Vec3f& point : {Vec3f(0, -4, -4), Vec3f(0, -4, 4), Vec3f(8, -4, 4), Vec3f(8, -4, -4)}) {
    solid.points.push_back(point);
  }
  solid.faces.push_back({first, first + 1, first + 2, first + 3});
  const Scene scene = sceneOf({solid});
  EXPECT_TRUE(hides(scene, kViewers, {.box = {{3, -4, -1}, {4, -3, 1}}}));
}

TEST(RegionOcclusion, ATargetThatTouchesTheWallIsLeftOut) {
  const Scene scene = sceneOf({block({0, -4, -4}, {0.5f, 4, 4}), block({0.5f, -1, -1}, {1, 1, 1}),
                               block({-0.5f, -1, -1}, {0, 1, 1})});
  EXPECT_TRUE(hides(scene, kViewers, {.box = {{0.5, -1, -1}, {1, 1, 1}}, .object = 1}));
  EXPECT_FALSE(hides(scene, kViewers, {.box = {{-0.5, -1, -1}, {0, 1, 1}}, .object = 2}, {.divisions = 4}))
      << "in front of the wall";
}

TEST(RegionOcclusion, AFlatTargetOnTheBackOfAWallIsHidden) {
  const Scene scene = sceneOf({block({0, -4, -4}, {0.5f, 4, 4})});
  EXPECT_TRUE(hides(scene, kViewers, {.box = {{0.5, -1, -1}, {0.5, 1, 1}}}));
  EXPECT_FALSE(hides(scene, kViewers, {.box = {{0, -1, -1}, {0, 1, 1}}}, {.divisions = 4})) << "on its front";
}

TEST(RegionOcclusion, ARoomIsClosedFromInsideAndOpenFromOutside) {
  // A box with its fronts inwards.
  Solid room = dicedBlock({-4, -4, -4}, {4, 4, 4}, 3);
  for (std::vector<std::uint32_t>& face : room.faces) {
    std::reverse(face.begin(), face.end());
  }
  const Scene scene = sceneOf({room});
  const CellBox inside{{-1, -1, -1}, {1, 1, 1}};
  const FusedTarget outside{.box = {{9, -2, 3}, {11, 2, 7}}};
  EXPECT_TRUE(hides(scene, inside, outside));
  EXPECT_FALSE(hides(scene, outside.box, {.box = inside}, {.divisions = 4}));
}

TEST(RegionOcclusion, DividingShowsWhatNoSurfaceHidesByItself) {
  // Two walls with an edge each in the shaft, one behind the other.
  const Scene scene = sceneOf({block({0, -4, -4}, {0.25f, 4, 0.5f}), block({1, -4, -0.5f}, {1.25f, 4, 4})});
  const CellBox viewers{{-12, -0.5, -1}, {-11, 0.5, 1}};
  const FusedTarget target{.box = {{3, -0.5, -1}, {3.25, 0.5, 1}}};
  EXPECT_FALSE(hides(scene, viewers, target));
  EXPECT_TRUE(hides(scene, viewers, target, {.divisions = 3}));
  EXPECT_TRUE(hides(scene, viewers, target, {.narrowings = 1}));
}

// A wall across x, from z = -9 to 9, with a door 0.8 metres wide around `door`.
std::vector<Solid> wallWithDoor(float x, float door) {
  return {block({x, -4, -9}, {x + 0.25f, 4, door - 0.4f}), block({x, -4, door + 0.4f}, {x + 0.25f, 4, 9})};
}

Scene twoDoors(float first, float second) {
  std::vector<Solid> solids = wallWithDoor(0, first);
  const std::vector<Solid> more = wallWithDoor(4, second);
  solids.insert(solids.end(), more.begin(), more.end());
  return sceneOf(solids);
}

TEST(RegionOcclusion, NarrowingShowsThatTwoDoorsAreNotInLine) {
  const FusedTarget wide{.box = {{8, -1, -8}, {9, 1, 8}}};
  for (const float second : {-3.5f, 3.5f}) {
    const Scene scene = twoDoors(0, second);
    EXPECT_FALSE(hides(scene, kViewers, wide)) << "there is a door in the shaft in each wall";
    EXPECT_TRUE(hides(scene, kViewers, wide, {.narrowings = 2}));
    EXPECT_TRUE(hides(scene, wide.box, {.box = kViewers}, {.narrowings = 2}));
  }
  for (const float second : {-1.4f, 0.0f, 1.4f}) {
    EXPECT_FALSE(hides(twoDoors(0, second), kViewers, wide, {.narrowings = 8, .divisions = 4}));
  }
}

TEST(RegionOcclusion, NarrowingLooksAlongEveryAxisAndBothWays) {
  const FusedTarget wide{.box = {{8, -1, -8}, {9, 1, 8}}};
  for (int turn = 0; turn < 3; ++turn) {
    for (const float sign : {1.0f, -1.0f}) {
      // A rotation, and with the sign another one: by half a turn around an axis.
      const auto turned = [&](const Vec3f& p) {
        const Vec3f q{sign * p.x, p.y, sign * p.z};
        return turn == 0 ? q : turn == 1 ? Vec3f{q.y, q.z, q.x} : Vec3f{q.z, q.x, q.y};
      };
      const auto box = [&](const CellBox& b) {
        const Vec3d one(turned(Vec3f(b.min))), other(turned(Vec3f(b.max)));
        return CellBox{min(one, other), max(one, other)};
      };
      Scene scene = twoDoors(0, 3.5f);
      for (Vec3f& point : scene.positions) {
        point = turned(point);
      }
      for (Object& object : scene.objects) {
        Box bounds;
        for (const Vec3d& corner : {Vec3d(object.bounds.min), Vec3d(object.bounds.max)}) {
          bounds.extend(turned(Vec3f(corner)));
        }
        object.bounds = bounds;
      }
      EXPECT_FALSE(hides(scene, box(kViewers), {.box = box(wide.box)}));
      EXPECT_TRUE(hides(scene, box(kViewers), {.box = box(wide.box)}, {.narrowings = 2}));
    }
  }
}

// What lines reach is rounded outwards: a flat region and a flat target that see each other through a slit
// along just one line have a window as narrow as that line.
TEST(RegionOcclusion, NarrowingKeepsEveryLineHoweverFlatItsEndsAre) {
  const Scene scene = sceneOf({block({0, -9, -9}, {0.25f, 9, 0.3f}), block({0, -9, 0.6f}, {0.25f, 9, 9})});
  const Panels panels = findPanels(scene.view());
  RegionOcclusion occlusion(panels, kNear, 20.0);
  std::mt19937 random(1);
  const auto any = [&random] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
  for (int i = 0; i < 500; ++i) {
    const double x = -5.5 + any(), y = 1.7 * any() * any(), to_x = 8.0 + any(), to_y = 1.3 * any() * any();
    const CellBox region{{x, y, -0.5}, {x, y, 0.5}}, target{{to_x, to_y, -3}, {to_x, to_y, 3}};
    EXPECT_FALSE(occlusion.hides(region, {target, kNoObject}, {.narrowings = 3})) << i;
  }
}

TEST(RegionOcclusion, NoWindowIsCloserThanTheNearPlane) {
  // What hides the target from a window between may be clipped for viewers this close.
  const CellBox close{{-0.75, -0.5, -0.5}, {-0.25, 0.5, 0.5}};
  const FusedTarget target{.box = {{0.75, -1, -1}, {1, 1, 1}}};
  const Scene scene = sceneOf({wallOfTiles(5)});
  EXPECT_FALSE(hides(scene, close, target, {.narrowings = 4}, 0.6));
  EXPECT_TRUE(hides(scene, close, target, {}, 0.2));
}

TEST(RegionOcclusion, WithoutSurfacesNothingIsHidden) {
  Scene scene = sceneOf({wallOfTiles(2)});
  scene.materials[0].opacity = Opacity::kBlended;
  EXPECT_FALSE(hides(scene, kViewers, kBehind, {.divisions = 2}));
  const Panels none;
  RegionOcclusion occlusion(none, kNear, 100.0);
  EXPECT_FALSE(occlusion.hides(kViewers, kBehind, {.narrowings = 2, .divisions = 2}));
}

// Walls, boards and crates on a grid of half metres, so that most of them touch, with coordinates a unit in
// the last place off here and there, some of them double-sided or with reversed triangles.
Scene untidyScene(std::mt19937& random) {
  const auto whole = [&](int low, int high) {
    return 0.5f * static_cast<float>(std::uniform_int_distribution<int>(low, high)(random));
  };
  std::vector<Solid> solids;
  for (int i = 0; i < 14; ++i) {
    Vec3f low(whole(-8, 6), whole(-6, 2), whole(-8, 6)), size(whole(1, 3), whole(1, 8), whole(1, 12));
    if (random() % 2 != 0) {
      std::swap(size.x, size.z);
    }
    Solid solid = random() % 3 == 0 ? dicedBlock(low, low + size, 2) : block(low, low + size);
    for (Vec3f& point : solid.points) {
      if (random() % 64 == 0) {
        point.x = std::nextafter(point.x, random() % 2 != 0 ? 100.0f : -100.0f);
      }
    }
    if (random() % 8 == 0) {
      solid.faces.erase(solid.faces.begin() + static_cast<std::ptrdiff_t>(random() % solid.faces.size()));
    }
    if (random() % 8 == 0) {
      std::reverse(solid.faces[0].begin(), solid.faces[0].end());
    }
    solids.push_back(solid);
  }
  Scene scene = sceneOf(solids);
  scene.materials.push_back({.double_sided = true});
  for (Object& object : scene.objects) {
    object.material = MaterialId(random() % 4 == 0 ? 1u : 0u);
  }
  return scene;
}

TEST(RegionOcclusion, HidesNothingThatALineSees) {
  std::size_t hidden = 0, asked = 0;
  for (std::uint32_t seed = 1; seed <= test::rounds(30u); ++seed) {
    std::mt19937 random(seed);
    const Scene scene = untidyScene(random);
    const Panels panels = findPanels(scene.view());
    RegionOcclusion occlusion(panels, kNear, 100.0);
    for (int i = 0; i < 40; ++i) {
      const auto place = [&] { return std::uniform_real_distribution<double>(-5.0, 5.0)(random); };
      const Vec3d at{place(), place(), place()};
      const double half = random() % 2 != 0 ? 0.25 : 0.0;
      const CellBox region{at - Vec3d{half, half, half}, at + Vec3d{half, half, half}};
      for (std::uint32_t object = 0; object < scene.objects.size(); ++object) {
        const Box& box = scene.objects[object].bounds;
        const FusedTarget target{.box = {Vec3d(box.min), Vec3d(box.max)},
                                 .object = random() % 2 != 0 ? object : kNoObject};
        ++asked;
        const RegionEffort effort{.narrowings = random() % 3 == 0 ? 2u : 0u,
                                  .divisions = random() % 2 == 0 ? 2u : 0u};
        if (!intersects(region, box) && occlusion.hides(region, target, effort)) {
          ++hidden;
          ASSERT_FALSE(seesByLines(scene, region, target.box, 60, random))
              << "seed " << seed << ", object " << object << ", region at " << at.x << " " << at.y << " "
              << at.z;
        }
      }
    }
  }
  EXPECT_GT(hidden, asked / 20) << "the test would prove little";
}

// A box somewhere in this one, flat where it is.
CellBox partOf(const CellBox& box, std::mt19937& random) {
  const Vec3d a = placeIn(box, random), b = placeIn(box, random);
  return {min(a, b), max(a, b)};
}

// A focus only spares looking at panels that no line meets. A window is as wide along each axis as lines of
// sight are anywhere, so that lines through its corners may leave the shaft of the two boxes.
TEST(FusedOcclusion, AnswersTheSameInFocus) {
  using Answer = FusedOcclusion::Answer;
  std::array<int, 3> counts{};
  int clear = 0, blocked = 0;
  for (std::uint32_t seed = 1; seed <= test::rounds(40u); ++seed) {
    std::mt19937 random(seed);
    const Scene scene = untidyScene(random);
    const Panels panels = findPanels(scene.view());
    FusedOcclusion all(panels, 100.0), focused(panels, 100.0);
    const CellBox space{{-6, -5, -6}, {6, 5, 6}};
    for (int i = 0; i < 12; ++i) {
      const CellBox region = partOf(space, random), target = partOf(space, random),
                    window = partOf(space, random);
      focused.focus(FusedOcclusion::kAll, region, target);
      focused.focus(FusedOcclusion::kBeforeWindow, region, window);
      focused.focus(FusedOcclusion::kBehindWindow, window, target);
      const std::array<std::array<const CellBox*, 2>, 4> ends{
          {{&region, &target}, {&region, &window}, {&window, &target}, {&target, &region}}};
      for (int question = 0; question < 24; ++question) {
        const auto [from, to] = ends[static_cast<std::size_t>(question % 4)];
        const CellBox start = partOf(*from, random);
        const FusedTarget end{
            .box = partOf(*to, random),
            .object = random() % 2 != 0 ? static_cast<std::uint32_t>(random() % 14) : kNoObject};
        const Answer answer = all.ask(start, end, kNear);
        ASSERT_EQ(focused.ask(start, end, kNear), answer) << "seed " << seed;
        ++counts[static_cast<std::size_t>(answer)];
        const Vec3d eye = placeIn(start, random), point = placeIn(end.box, random);
        const bool is_clear = all.isClear(eye, point);
        ASSERT_EQ(focused.isClear(eye, point), is_clear) << "seed " << seed;
        ++(is_clear ? clear : blocked);
      }
    }
  }
  EXPECT_GT(*std::ranges::min_element(counts), 100) << "all answers, or the test would prove little";
  EXPECT_GT(std::min(clear, blocked), 1000);
}

bool isIn(const CellBox& box, const Vec3d& point) {
  return min(point, box.min) == box.min && max(point, box.max) == box.max;
}

TEST(FusedOcclusion, BeginsWithTheLineOfAnEarlierQuestionOfItsSearch) {
  const Scene scene = sceneOf({wallOfTiles(8)});
  const Panels panels = findPanels(scene.view());
  FusedOcclusion questions(panels, 100.0);
  const CellBox region{{-3, -0.5, -0.5}, {-2, 0.5, 0.5}}, target{{2, -0.5, -0.5}, {3, 0.5, 0.5}};
  const auto lineTo = [&](const CellBox& box, std::uint32_t object = kNoObject) {
    EXPECT_EQ(questions.ask(region, {box, object}, kNear), FusedOcclusion::Answer::kHidden);
    return questions.proof().to;
  };
  const Vec3d end = lineTo(target);
  CellBox holds = target, misses = target;
  holds.max.x = misses.min.x = end.x + 0.01;
  EXPECT_EQ(lineTo(holds), end);
  EXPECT_TRUE(isIn(questions.endsIn(misses), lineTo(misses)));
  EXPECT_EQ(lineTo(holds), end);
  EXPECT_NE(lineTo(holds, 1), end) << "other sheets count";
  lineTo(target);
  questions.startSearch();
  EXPECT_NE(lineTo(holds), end);
}

TEST(FusedOcclusion, TwoLinesServeQuestionsAboutAllHalvesOfBothBoxes) {
  const Scene scene = sceneOf({wallOfTiles(8)});
  const Panels panels = findPanels(scene.view());
  FusedOcclusion questions(panels, 100.0);
  const CellBox region{{-3, -0.5, -0.5}, {-2, 0.5, 0.5}}, target{{2, -0.5, -0.5}, {3, 0.5, 0.5}};
  std::set<std::array<double, 3>> ends;
  for (int half = 0; half < 12; ++half) {
    CellBox from = region, to = target;
    CellBox& box = half < 6 ? to : from;
    const int axis = half / 2 % 3;
    (half % 2 == 0 ? box.min : box.max)[axis] = box.centre()[axis];
    ASSERT_EQ(questions.ask(from, {to}, kNear), FusedOcclusion::Answer::kHidden);
    const Vec3d end = questions.proof().to;
    ends.insert({end.x, end.y, end.z});
  }
  EXPECT_EQ(ends.size(), 2u);
}

// A search asks about ever smaller boxes, as narrowing does.
TEST(FusedOcclusion, LinesOfEarlierQuestionsHideNothingThatALineSees) {
  int hidden = 0, by_earlier_line = 0;
  for (std::uint32_t seed = 1; seed <= test::rounds(60u); ++seed) {
    std::mt19937 random(seed);
    const Scene scene = untidyScene(random);
    const Panels panels = findPanels(scene.view());
    FusedOcclusion questions(panels, 100.0);
    const CellBox space{{-6, -5, -6}, {6, 5, 6}};
    for (int search = 0; search < 12; ++search) {
      questions.startSearch();
      CellBox region = partOf(space, random), target = partOf(space, random);
      for (int question = 0; question < 12; ++question) {
        if (questions.ask(region, {target}, kNear) == FusedOcclusion::Answer::kHidden) {
          const FusedOcclusion::Proof& proof = questions.proof();
          ASSERT_TRUE(isIn(region, proof.from) && isIn(questions.endsIn(target), proof.to))
              << "seed " << seed;
          ASSERT_FALSE(seesByLines(scene, region, target, 100, random)) << "seed " << seed;
          ++hidden;
          const Vec3d start = FusedOcclusion::startOf(region), mirrored = region.min + region.max - start;
          by_earlier_line +=
              std::min(length(proof.from - start), length(proof.from - mirrored)) > 1e-9 ? 1 : 0;
        }
        CellBox& part = random() % 2 == 0 ? region : target;
        const int axis = static_cast<int>(random() % 3);
        (random() % 2 == 0 ? part.min : part.max)[axis] = part.centre()[axis];
      }
    }
  }
  EXPECT_GT(hidden, test::rounds(100));
  EXPECT_GT(by_earlier_line, test::rounds(50)) << "the test would prove little";
}

// The shaft against points of the hull, and against lines that lie beside it.
TEST(Shaft, HoldsTheHullOfBothBoxesAndLittleMore) {
  std::mt19937 random(5);
  const auto whole = [&](int low, int high) {
    return static_cast<double>(std::uniform_int_distribution<int>(low, high)(random));
  };
  int outside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d a(whole(-9, 9), whole(-9, 9), whole(-9, 9)), b(whole(-9, 9), whole(-9, 9), whole(-9, 9));
    const CellBox region{a, a + Vec3d(whole(0, 4), whole(0, 4), whole(0, 4))},
        target{b, b + Vec3d(whole(0, 4), whole(0, 4), whole(0, 4))};
    const Shaft shaft(region, target, 20.0, 0.0);
    const double t = whole(0, 8) / 8.0;
    const Vec3d from = placeIn(region, random), to = placeIn(target, random), in = from * (1.0 - t) + to * t;
    const Vec3d beside(whole(-3, 3), whole(-3, 3), whole(-3, 3));
    ASSERT_FALSE(shaft.misses(in + beside, in - beside));
    ASSERT_FALSE(shaft.misses(from, to));
    // A point beside a plane that touches both boxes from the other side.
    const Vec3d normal(whole(-3, 3), whole(-3, 3), whole(-3, 3)),
        point(whole(-9, 9), whole(-9, 9), whole(-9, 9));
    double most = -1e9;
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      most = std::max({most, dot(normal, region.corner(corner)), dot(normal, target.corner(corner))});
    }
    if (dot(normal, point) > most + 1e-6) {
      ++outside;
      EXPECT_TRUE(shaft.misses(point, point));
      EXPECT_TRUE(shaft.misses(Box{Vec3f(point), Vec3f(point)}));
    }
  }
  EXPECT_GT(outside, 200);
}

// The same normals and levels as Shaft::misses has, which the test above compares with the hull.
TEST(Shaft, FindsTheSidesThatAPointIsBeyondOnEveryInstructionSet) {
  std::mt19937 random(6);
  const auto place = [&random] {
    const auto whole = [&] { return static_cast<double>(std::uniform_int_distribution<int>(-9, 9)(random)); };
    return Vec3d(whole(), whole(), whole());
  };
  int beyond = 0, within = 0;
  for (int i = 0; i < 4000; ++i) {
    const Vec3d a = place(), b = place(), c = place(), d = place();
    const Shaft shaft({min(a, b), max(a, b)}, {min(c, d), max(c, d)}, 20.0, 0.0);
    const Vec3d point = place();
    const std::uint32_t sides = shaft.sidesBeyond(point);
    ASSERT_EQ(sides != 0, shaft.misses(point, point));
    (sides != 0 ? beyond : within) += 1;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(target);
      const std::uint32_t same = shaft.sidesBeyond(point);
      ASSERT_EQ(same, sides) << hwy::TargetName(target);
    }
  }
  EXPECT_GT(std::min(beyond, within), 300);
}

std::size_t bareEdges(const Panels& panels) {
  return static_cast<std::size_t>(std::count_if(panels.edges.begin(), panels.edges.end(),
                                                [](const PanelEdge& e) { return e.beyond == kNoPanel; }));
}

TEST(Panels, JoinWhatAViewerSeesAsOneSurface) {
  EXPECT_EQ(bareEdges(findPanels(sceneOf({block({0, 0, 0}, {1, 1, 1})}).view())), 0u);
  EXPECT_EQ(bareEdges(findPanels(sceneOf({wallOfTiles(3)}).view())), 12u) << "the border";
  Scene two_sided = sceneOf({wallOfTiles(3)});
  two_sided.materials[0].double_sided = true;
  EXPECT_EQ(bareEdges(findPanels(two_sided.view())), 0u) << "fronts go on on backs";
  // A wall without a bottom on a floor: it is joined with the floor before it. Of the floor below it, the
  // border is left.
  Solid wall = block({-1, 0, -1}, {1, 2, 1});
  wall.faces.erase(wall.faces.begin() + 2);
  const Scene scene = sceneOf({block({-4, -1, -4}, {4, 0, 4}), wall});
  const Panels panels = findPanels(scene.view());
  int joined = 0;
  for (const Panel& panel : panels.panels) {
    for (const PanelEdge& edge : panels.edgesOf(panel)) {
      if (edge.beyond != kNoPanel && panels.panels[edge.beyond].object != panel.object) {
        ++joined;
        const std::uint32_t instead = panels.joinedWithout(edge, [&](std::uint32_t other) {
          return panels.panels[other].object == panels.panels[edge.beyond].object;
        });
        // Without the wall the floor goes on below it; without the floor, the wall ends.
        if (panel.object == 0) {
          ASSERT_NE(instead, kNoPanel);
          EXPECT_EQ(panels.panels[instead].object, 0u);
        } else {
          EXPECT_EQ(instead, kNoPanel);
        }
      }
    }
  }
  EXPECT_EQ(joined, 8) << "four sides of the wall, and the floor around them";
  EXPECT_EQ(bareEdges(panels), 4u);
}

// Boxes that touch, overlap and share faces, some without a face.
Scene anyBlocks(std::mt19937& random, int count) {
  std::vector<Solid> solids;
  for (int i = 0; i < count; ++i) {
    const auto at = [&] { return static_cast<float>(random() % 4); };
    const Vec3f low{at(), at(), at()};
    solids.push_back(block(low, low + Vec3f{1.0f + static_cast<float>(random() % 2), 1.0f, 1.0f}));
    if (random() % 3 == 0) {
      solids.back().faces.erase(solids.back().faces.begin() + random() % 6);
    }
  }
  Scene scene = sceneOf(solids);
  scene.materials[0].double_sided = random() % 3 == 0;
  return scene;
}

// Whatever objects are left out: at every edge, one panel is joined with another as often as the other way
// around, along the edge in the opposite direction. Otherwise a set of joined panels would have a boundary.
TEST(Panels, AreJoinedBothWaysWhateverIsLeftOut) {
  std::mt19937 random(3);
  int joined_anew = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const Panels panels = findPanels(anyBlocks(random, 6).view());
    const std::uint32_t left_out = random() % 64;
    const auto isOut = [&](std::uint32_t panel) {
      return (left_out >> panels.panels[panel].object & 1) != 0;
    };
    std::map<std::array<std::uint32_t, 4>, int> joins;
    for (std::uint32_t i = 0; i < panels.panels.size(); ++i) {
      if (isOut(i)) {
        continue;
      }
      for (const PanelEdge& edge : panels.edgesOf(panels.panels[i])) {
        std::uint32_t beyond = edge.beyond;
        if (beyond == kNoPanel || isOut(beyond)) {
          beyond = panels.joinedWithout(edge, isOut);
          joined_anew += beyond == kNoPanel ? 0 : 1;
        }
        if (beyond != kNoPanel) {
          EXPECT_FALSE(isOut(beyond));
          ++joins[{edge.from, edge.to, i, beyond}];
        }
      }
    }
    for (const auto& [join, times] : joins) {
      const auto other = joins.find({join[1], join[0], join[3], join[2]});
      EXPECT_EQ(other == joins.end() ? 0 : other->second, times) << "trial " << trial;
    }
  }
  EXPECT_GT(joined_anew, 100);
}

// A storey: tiles of floor 0.2 metres thick, a tile for each room, and walls between the rooms that stand on
// two tiles each. Rooms are 4 metres wide and in a row along x, from x = 0 on.
Scene rooms(int count) {
  std::vector<Solid> solids;
  for (int i = 0; i < count; ++i) {
    const float x = 4.0f * static_cast<float>(i);
    solids.push_back(block({x, -0.2f, -2}, {x + 4, 0, 2}));
    solids.push_back(block({x, 3, -2}, {x + 4, 3.2f, 2}));
    solids.push_back(block({x + 3.9f, 0, -2}, {x + 4.1f, 3, 2}));
    solids.push_back(block({x + (i == 0 ? 0.0f : 0.1f), 0, 1.8f}, {x + 3.9f, 3, 2}));
    solids.push_back(block({x + (i == 0 ? 0.0f : 0.1f), 0, -2}, {x + 3.9f, 3, -1.8f}));
  }
  return sceneOf(solids);
}

TEST(RegionOcclusion, AFloorThatViewersAreInDoesNotKeepAWallFromHiding) {
  // From the floor to below the ceiling, less than the near distance away from either, and through both.
  const FusedTarget on_the_floor{.box = {{9, 0, -1}, {10, 1, 1}}}, below{.box = {{9, -0.2, -1}, {10, 1, 1}}};
  for (const CellBox& viewers : {CellBox{{1, 0, -1}, {2, 1, 1}}, CellBox{{1, -0.1, -1}, {2, 3.1, 1}},
                                 CellBox{{1, 1, -1}, {2, 2.95, 1}}}) {
    EXPECT_TRUE(hides(rooms(3), viewers, on_the_floor));
    EXPECT_TRUE(hides(rooms(3), viewers, below));
  }
  // The wall itself does not hide from viewers in it, and no other is in the way of what is in the next room.
  EXPECT_FALSE(hides(rooms(3), {{3.5, 0, -1}, {4, 1, 1}}, {.box = {{6, 0, -1}, {7, 1, 1}}}));
  EXPECT_TRUE(hides(rooms(3), {{3.5, 0, -1}, {4, 1, 1}}, on_the_floor));
}

TEST(RegionOcclusion, AnOpenGroundDoesNotKeepAHouseFromHiding) {
  // The ground is one rectangle with its front up, and nothing joins its border.
  Solid ground = block({-10, -1, -10}, {10, 0, 10});
  ground.faces = {*std::find_if(ground.faces.begin(), ground.faces.end(), [&](const auto& face) {
    return std::all_of(face.begin(), face.end(), [&](std::uint32_t i) { return ground.points[i].y == 0.0f; });
  })};
  const Solid house = block({0, -1, -6}, {2, 8, 6});
  const FusedTarget behind{.box = {{4, 0, -1}, {5, 1, 1}}};
  EXPECT_TRUE(hides(sceneOf({ground, house}), {{-6, 0, -1}, {-5, 1, 1}}, behind));
  EXPECT_FALSE(hides(sceneOf({ground, house}), {{-6, -8, -1}, {-5, 1, 1}}, behind)) << "seen from below";
  EXPECT_FALSE(hides(sceneOf({ground, house}), {{-6, 0, -1}, {-5, 1, 1}}, {.box = {{4, 0, -1}, {5, 30, 1}}}));
}

TEST(RegionOcclusion, WhatIsLeftOutMakesNoLineClear) {
  // The floor is too near, and all that is in the way.
  const Panels panels = findPanels(sceneOf({block({-8, -1, -8}, {8, 0, 8})}).view());
  FusedOcclusion occlusion(panels, 100.0);
  const FusedTarget below{.box = {{0, -3, 0}, {1, -2, 1}}};
  EXPECT_EQ(occlusion.ask({{0, 0.05, 0}, {1, 1, 1}}, below, 0.1), FusedOcclusion::Answer::kUndecided);
  EXPECT_EQ(occlusion.ask({{0, 0.05, 0}, {1, 1, 1}}, below, 0.01), FusedOcclusion::Answer::kHidden);
  EXPECT_EQ(occlusion.ask({{0, 0.05, 0}, {1, 1, 1}}, {.box = {{0, 2, 0}, {1, 3, 1}}}, 0.1),
            FusedOcclusion::Answer::kClear);
}

TEST(FusedOcclusion, WhatIsCloserThanTheNearDistanceBlocksNoLine) {
  const Panels panels = findPanels(sceneOf({block({0, -4, -4}, {0.5f, 4, 4})}).view());
  FusedOcclusion questions(panels, 100.0);
  const Vec3d close{-0.05, 0.3, 0.2}, farther{-0.15, 0.3, 0.2}, behind{6, 0.7, 0.4};
  EXPECT_FALSE(questions.isClear(close, behind));
  EXPECT_TRUE(questions.isClear(close, behind, kNoObject, 0.1));
  EXPECT_FALSE(questions.isClear(farther, behind, kNoObject, 0.1));
  EXPECT_TRUE(questions.isClear(farther, {0.1, 0.3, 0.2}, kNoObject, 1.0)) << "shorter than that";
  // What blocked the last line is still too near for this one.
  EXPECT_TRUE(questions.isClear(close, behind, kNoObject, 0.1));
}

// What is remembered of one question, such as what blocked its lines, must not decide another.
TEST(RegionOcclusion, ALineInThePlaneOfWhatBlockedAnotherIsClearBesideIt) {
  const Panels panels = findPanels(sceneOf({block({0, 0, 0}, {1, 1, 1})}).view());
  for (int axis = 0; axis < 3; ++axis) {
    FusedOcclusion questions(panels, 100.0);
    Vec3d above{0.3, 0.3, 0.4}, beside{5.0, 5.0, 0.0}, to{5.0, 5.0, 9.0};
    above[axis] = 2.0;
    beside[axis] = to[axis] = 1.0;
    EXPECT_FALSE(questions.isClear(above, {0.31, 0.5, 0.41}));
    EXPECT_TRUE(questions.isClear(beside, to)) << "axis " << axis;
  }
}

TEST(RegionOcclusion, AnswersDoNotDependOnEarlierSearches) {
  std::map<FusedOcclusion::Answer, int> answers;
  int clear_lines = 0;
  for (std::uint32_t seed = 1; seed <= 8; ++seed) {
    std::mt19937 random(seed);
    const Scene scene = untidyScene(random);
    const Panels panels = findPanels(scene.view());
    FusedOcclusion asked_before(panels, 100.0);
    for (int i = 0; i < 300; ++i) {
      const auto place = [&] { return std::uniform_real_distribution<double>(-5.0, 5.0)(random); };
      const Vec3d at{place(), place(), place()};
      const auto object = static_cast<std::uint32_t>(random() % scene.objects.size());
      const Box& box = scene.objects[object].bounds;
      const FusedTarget target{.box = {Vec3d(box.min), Vec3d(box.max)}, .object = object};
      const std::uint32_t left_out = random() % 2 == 0 ? object : kNoObject;
      FusedOcclusion fresh(panels, 100.0), fresh_for_line(panels, 100.0);
      const FusedOcclusion::Answer answer = fresh.ask({at, at + Vec3d{0.5, 0.5, 0.5}}, target, kNear);
      asked_before.startSearch();
      ASSERT_EQ(asked_before.ask({at, at + Vec3d{0.5, 0.5, 0.5}}, target, kNear), answer) << "seed " << seed;
      const Vec3d end = placeIn(target.box, random);
      const bool is_clear = fresh_for_line.isClear(at, end, left_out);
      ASSERT_EQ(asked_before.isClear(at, end, left_out), is_clear) << "seed " << seed;
      ++answers[answer];
      clear_lines += is_clear ? 1 : 0;
    }
  }
  for (const auto answer : {FusedOcclusion::Answer::kHidden, FusedOcclusion::Answer::kClear,
                            FusedOcclusion::Answer::kUndecided}) {
    EXPECT_GT(answers[answer], 50) << "the test would prove little";
  }
  EXPECT_GT(clear_lines, 50);
  EXPECT_LT(clear_lines, 2300);
}

TEST(RegionOcclusion, PanelsDoNotReachAroundTheEndOfAWall) {
  // A floor of many pieces goes on around a wall: what is before the wall is joined with what is behind it
  // only beside the shaft. Viewers are beside the floor, on both sides of its height, so that the edge of the
  // wall on it is in the shaft.
  const Scene scene = sceneOf({dicedBlock({-4, -1, -4}, {4, 0, 4}, 4), block({0, 0, -1}, {0.25f, 4, 1})});
  EXPECT_TRUE(hides(scene, {{-6, -0.5, -0.2}, {-5, 1, 0.2}}, {.box = {{2, 0, -0.2}, {3, 1, 0.2}}}));
}

// A wall of two blocks is one surface, of which the line that proves crosses the one or the other.
TEST(FusedOcclusion, TheLineThatProvesCrossesTheObjectThatItNames) {
  const Solid left = block({-8, -8, -2}, {0, 8, -1}), right = block({0, -8, -2}, {8, 8, -1});
  const Vec3d eye{0, 0, 2};
  for (const std::vector<Solid>& wall : {std::vector{left, right}, {right, left}}) {
    const Scene scene = sceneOf(wall);
    const Panels panels = findPanels(scene.view());
    const RegionProof exact(scene.view());
    for (const double low : {-0.75, -0.5, -0.25}) {
      FusedOcclusion occlusion(panels, 100.0);
      ASSERT_EQ(occlusion.ask({eye, eye}, {.box = {{low, -1, -6}, {low + 1, 1, -4}}}, kNear),
                FusedOcclusion::Answer::kHidden);
      const FusedOcclusion::Proof& proof = occlusion.proof();
      EXPECT_FALSE(exact.misses(proof.from, proof.to, ObjectId(proof.object))) << low;
    }
  }
}

// Viewers anywhere among walls, floors and furniture, in them as well.
TEST(RegionOcclusion, HidesNothingThatALineSeesFromWithinSolids) {
  std::mt19937 random(5);
  int hidden = 0;
  const Scene three_rooms = rooms(3);
  const Panels panels_of_rooms = findPanels(three_rooms.view());
  for (int trial = 0; trial < test::rounds(300); ++trial) {
    std::optional<Scene> blocks;
    if (random() % 2 == 0) {
      blocks = anyBlocks(random, 12);
    }
    const auto at = [&] { return 0.5 * static_cast<double>(random() % 24); };
    const auto box = [&] {
      const Vec3d low{at(), 0.5 * static_cast<double>(random() % 6) - 0.5,
                      0.5 * static_cast<double>(random() % 8) - 2.0};
      return CellBox{low, low + Vec3d{0.5, 0.5 + 0.5 * static_cast<double>(random() % 3), 0.5}};
    };
    const CellBox viewers = box(), target = box();
    if (!intersects(viewers, target)) {
      const double near = random() % 2 == 0 ? 0.0 : 0.3;
      hidden += (blocks ? hides(*blocks, viewers, {.box = target}, {}, near)
                        : hides(three_rooms, panels_of_rooms, viewers, {.box = target}, {}, near))
                    ? 1
                    : 0;
    }
  }
  EXPECT_GT(hidden, test::rounds(20));
}

}  // namespace
}  // namespace sightline::pvs
