#include "sightline/occlusion/occlusion_tree.h"

#include <gtest/gtest.h>

#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using namespace test;

Visibility ask(OcclusionTreeVariant variant, const View& view, std::span<const OraclePolygon> polygons,
               const Box& box) {
  const OccluderSet set = setOf(polygons);
  OcclusionTree tree({.variant = variant});
  tree.build(view, set, all(set));
  return tree.classify(box);
}

TEST(OcclusionTree, HidesABoxBehindOneWall) {
  const std::vector<OraclePolygon> walls{wall(-1, 1, -1, 1, -5)};
  for (const auto variant : kTreeVariants) {
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{-1, -1, -12}, {1, 1, -10}}), Visibility::kHidden);
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{-1, -1, -4}, {1, 1, -3}}), Visibility::kVisible);
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{-9, -1, -12}, {1, 1, -10}}), Visibility::kPartial);
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{5, -1, -12}, {6, 1, -10}}), Visibility::kVisible);
  }
}

TEST(OcclusionTree, WithoutOccludersHidesNothingInView) {
  for (const auto variant : kTreeVariants) {
    EXPECT_EQ(ask(variant, kLookingBack, {}, {{-1, -1, -12}, {1, 1, -10}}), Visibility::kVisible);
  }
}

TEST(OcclusionTree, WithoutTheFrustumBoxesOutsideTheViewAreHiddenByOccludersAlone) {
  const std::vector<OraclePolygon> walls{wall(-40, 40, -4, 4, -5)};
  const OccluderSet set = setOf(walls);
  const Box behind{{29, -1, -12}, {31, 1, -10}}, before{{29, -1, -4}, {31, 1, -3}},
      beside{{110, -1, -12}, {112, 1, -10}}, at_the_end{{75, -1, -12}, {90, 1, -10}};
  for (const auto variant : kTreeVariants) {
    for (const bool clip : {false, true}) {
      OcclusionTree tree({.variant = variant, .clip_to_frustum = clip});
      tree.build(kLookingBack, set, all(set));
      EXPECT_EQ(tree.classify(behind), Visibility::kHidden);
      EXPECT_EQ(tree.classify(before), clip ? Visibility::kHidden : Visibility::kVisible);
      EXPECT_EQ(tree.classify(beside), clip ? Visibility::kHidden : Visibility::kVisible);
      EXPECT_EQ(tree.classify(at_the_end), clip ? Visibility::kHidden : Visibility::kPartial);
    }
  }
}

TEST(OcclusionTree, ABoxThatTouchesTheWallFromBehindIsNotHidden) {
  const std::vector<OraclePolygon> walls{wall(-4, 4, -4, 4, -5)};
  for (const auto variant : kTreeVariants) {
    EXPECT_NE(ask(variant, kLookingBack, walls, {{-1, -1, -6}, {1, 1, -5}}), Visibility::kHidden);
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{-1, -1, -6}, {1, 1, -5.001f}}), Visibility::kHidden);
  }
}

TEST(OcclusionTree, AdjoiningWallsHideABoxAcrossTheirSharedEdgeTogether) {
  const std::vector<OraclePolygon> walls{wall(-4, 0.3f, -4, 4, -5), wall(0.3f, 4, -4, 4, -5)};
  for (const auto variant : kTreeVariants) {
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{-1, -1, -12}, {1, 1, -10}}), Visibility::kHidden);
  }
}

TEST(OcclusionTree, TheSidesOfACornerHideTogether) {
  // A building's corner towards the eye: two walls that share a vertical edge.
  const std::vector<OraclePolygon> walls{
      {{{-3, -2, -8}, {0, -2, -5}, {0, 2, -5}, {-3, 2, -8}}, false},
      {{{0, -2, -5}, {3, -2, -8}, {3, 2, -8}, {0, 2, -5}}, false},
  };
  for (const auto variant : kTreeVariants) {
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{-0.5, -0.5, -12}, {0.5, 0.5, -10}}), Visibility::kHidden);
  }
}

TEST(OcclusionTree, ASharedPartWithoutRoomTakesNothingFromTheRestOfTheEdge) {
  // Above the lower wall stands one on the left, with which it shares half of its edge, and one on the right,
  // with which it shares the last ten micrometres: too little for a margin at both ends of them, since the
  // edge is straight up to a micrometre only.
  const float end = -1e-5f, bend = -1e-6f;
  const std::vector<OraclePolygon> two{
      {{{-4, -4, -5}, {0, -4, -5}, {0, 0, -5}, {end, 0, -5}, {-2, bend, -5}, {-4, 0, -5}}, true},
      {{{-4, 0, -5}, {-2, bend, -5}, {-2, 4, -5}, {-4, 4, -5}}, true}};
  std::vector<OraclePolygon> three = two;
  three.push_back({{{end, 0, -5}, {0, 0, -5}, {4, 0, -5}, {4, 4, -5}, {end, 4, -5}}, true});
  const Box behind_the_seam{{-7, -1, -12}, {-5.5f, 1, -11}}, behind_the_gap{{-3, -1, -12}, {-2, 1, -11}};
  for (const auto variant : kTreeVariants) {
    for (const auto& walls : {two, three}) {
      EXPECT_EQ(ask(variant, kLookingBack, walls, behind_the_seam), Visibility::kHidden) << walls.size();
      EXPECT_NE(ask(variant, kLookingBack, walls, behind_the_gap), Visibility::kHidden) << walls.size();
    }
  }
}

TEST(OcclusionTree, DisconnectedWallsAtDifferentDepthsHideTogether) {
  const std::vector<OraclePolygon> walls{wall(-2, 0.5f, -4, 4, -4), wall(0, 5, -8, 8, -6)};
  EXPECT_EQ(ask(OcclusionTreeVariant::kFSE, kLookingBack, walls, {{-1, -1, -12}, {1, 1, -10}}),
            Visibility::kHidden);
}

TEST(OcclusionTree, NeverHidesABoxSeenThroughAGap) {
  forEachGap([](std::span<const OraclePolygon> walls, const Box& box, const std::string& what) {
    for (const auto variant : kTreeVariants) {
      EXPECT_NE(ask(variant, kLookingBack, walls, box), Visibility::kHidden) << what;
    }
  });
}

TEST(OcclusionTree, TouchingSilhouettesOfUnconnectedWallsCountAsAGap) {
  // The right wall is farther away and begins exactly where the left one ends, as seen from the eye.
  const std::vector<OraclePolygon> walls{wall(-4, 1, -4, 4, -4), wall(2, 12, -8, 8, -8)};
  for (const auto variant : kTreeVariants) {
    EXPECT_NE(ask(variant, kLookingBack, walls, {{1, -1, -14}, {5, 1, -12}}), Visibility::kHidden);
  }
}

TEST(OcclusionTree, TheTipOfAGapThatEndsOnASharedEdgeIsSeen) {
  // The lower polygon's upper edge runs through v, which lies a little below the line of the shared edge.
  // Above it two polygons adjoin, one on each side of v, with a gap in the form of a V between them: its tip
  // is at v.
  for (const double dent : {0.0, 1e-7, 5e-7}) {
    const Vec3f u(-1, 0, -1), v(0, static_cast<float>(-dent), -1), w(1, 0, -1);
    const std::vector<OraclePolygon> polygons{{{{-1, -1, -1}, {1, -1, -1}, w, v, u}, true},
                                              {{u, v, {-0.5f, 0.5f, -1}, {-1, 0.5f, -1}}, true},
                                              {{v, w, {1, 0.5f, -1}, {0.5f, 0.5f, -1}}, true}};
    for (const double part : {0.02, 0.2, 0.6}) {
      const auto top = static_cast<float>(dent > 0.0 ? -part * dent : 1e-7);
      const Box box{{-0.1f, -0.5f, -3}, {0.1f, top, -2}};
      ASSERT_EQ(test::castAtAll(polygons, kLookingBack, {0, dent > 0.0 ? 1.5 * top : 0.5 * top, -2}),
                test::RayAnswer::kClear);
      for (const auto variant : kTreeVariants) {
        EXPECT_NE(ask(variant, kLookingBack, polygons, box), Visibility::kHidden) << dent << " " << part;
      }
    }
  }
}

TEST(OcclusionTree, AnOpenEdgeInLineWithAWatertightEdgeKeepsItsMargin) {
  // A wall and the ground share an edge. A second wall in line with the first does not adjoin the ground: the
  // middle of its lower edge is raised by 0.9 mm, which merging may ignore at such coordinates, and lets one
  // see through.
  const float x = 1000;
  const std::vector<OraclePolygon> polygons{
      {{{x, 0, 0}, {x + 1, 0, 0}, {x + 1, 3, 0}, {x, 3, 0}}, false},
      {{{x, 0, 0}, {x, 0, 3}, {x + 1, 0, 3}, {x + 1, 0, 0}}, false},
      {{{x + 2, 0, 0}, {x + 3, 0.0009f, 0}, {x + 4, 0, 0}, {x + 4, 3, 0}, {x + 2, 3, 0}}, false}};
  const View view = viewFrom({x + 1.5, 0.5, 2}, {0.3, -0.1, -1});
  for (const double height : {0.0002, 0.0005, 0.0008}) {
    const Vec3d through = Vec3d(x + 3, height, 0) - view.eye;
    const Vec3d target = view.eye + through * 1.2;
    ASSERT_EQ(test::castAtAll(polygons, view, target), test::RayAnswer::kClear);
    const Box box{Vec3f(target), Vec3f(target)};
    for (const auto variant : kTreeVariants) {
      EXPECT_NE(ask(variant, view, polygons, box), Visibility::kHidden) << height;
    }
  }
}

TEST(OcclusionTree, ABoxThatTouchesTheFrustumFromOutsideIsInIt) {
  View orthographic = kLookingBack;
  orthographic.orthographic = true;
  orthographic.ortho_height = 2;
  for (const auto variant : kTreeVariants) {
    EXPECT_NE(ask(variant, kLookingBack, {}, {{2, -0.5f, -2}, {3, 0.5f, -1}}), Visibility::kHidden);
    EXPECT_NE(ask(variant, orthographic, {}, {{1, -0.5f, -3}, {2, 0.5f, -2}}), Visibility::kHidden);
    EXPECT_EQ(ask(variant, orthographic, {}, {{1.001f, -0.5f, -3}, {2, 0.5f, -2}}), Visibility::kHidden);
  }
}

TEST(OcclusionTree, FromAnEyeThatIsNotFiniteNothingIsHidden) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const auto variant : kTreeVariants) {
    EXPECT_EQ(ask(variant, viewFrom({nan, 0, 0}, {0, 0, -1}), {{wall(-9, 9, -9, 9, -5)}},
                  {{-1, -1, -12}, {1, 1, -10}}),
              Visibility::kVisible);
  }
}

TEST(OcclusionTree, SingleSidedWallsHideNothingFromBehind) {
  OraclePolygon turned = wall(-4, 4, -4, 4, -5);
  std::reverse(turned.vertices.begin(), turned.vertices.end());
  OraclePolygon both = turned;
  both.double_sided = true;
  for (const auto variant : kTreeVariants) {
    const Box behind{{-1, -1, -12}, {1, 1, -10}};
    EXPECT_EQ(ask(variant, kLookingBack, {{turned}}, behind), Visibility::kVisible);
    EXPECT_EQ(ask(variant, kLookingBack, {{both}}, behind), Visibility::kHidden);
  }
}

TEST(OcclusionTree, WhatTheNearPlaneClipsHidesNothing) {
  View view = kLookingBack;
  view.z_near = 5.5;
  for (const auto variant : kTreeVariants) {
    EXPECT_NE(ask(variant, view, {{wall(-9, 9, -9, 9, -5)}}, {{-1, -1, -12}, {1, 1, -10}}),
              Visibility::kHidden);
  }
  // A wall that crosses the near plane hides with the part beyond it only.
  const OraclePolygon side{{{-1, -4, 0}, {3, -4, -8}, {3, 4, -8}, {-1, 4, 0}}, true};
  std::mt19937_64 random(3);
  for (int i = 0; i < 2000; ++i) {
    const double x = -6.0 + 0.006 * i;
    const Box box{Vec3f(Vec3d(x, -0.2, -12)), Vec3f(Vec3d(x + 0.5, 0.2, -11))};
    for (const auto variant : kTreeVariants) {
      if (ask(variant, view, {{side}}, box) == Visibility::kHidden) {
        EXPECT_FALSE(test::lookAt(box, view, {{side}}, 200, random).seen) << "x " << x;
      }
    }
  }
}

TEST(OcclusionTree, TheEyeInAnOccludersPlaneOrInsideTheBoxHidesNothing) {
  const OraclePolygon edge_on{{{-4, 0, -2}, {4, 0, -2}, {4, 0, -9}, {-4, 0, -9}}, true};
  for (const auto variant : kTreeVariants) {
    EXPECT_EQ(ask(variant, kLookingBack, {{edge_on}}, {{-1, -1, -12}, {1, 1, -10}}), Visibility::kVisible);
    EXPECT_EQ(ask(variant, kLookingBack, {{wall(-1, 1, -1, 1, -5)}}, {{-3, -3, -3}, {3, 3, 3}}),
              Visibility::kPartial);
  }
}

TEST(OcclusionTree, BoxesThatAreNotWellFormedAreVisible) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  for (const auto variant : kTreeVariants) {
    for (const Box& box : {Box{}, Box{{nan, 0, 0}, {1, 1, 1}}, Box{{-1, -1, -inf}, {1, 1, -10}}}) {
      EXPECT_EQ(ask(variant, kLookingBack, {{wall(-9, 9, -9, 9, -5)}}, box), Visibility::kVisible);
    }
  }
}

TEST(OcclusionTree, FlatAndPointLikeBoxesAreAnsweredToo) {
  for (const auto variant : kTreeVariants) {
    const std::vector<OraclePolygon> walls{wall(-2, 2, -2, 2, -5)};
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{-1, -1, -10}, {1, 1, -10}}), Visibility::kHidden);
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{0, 0, -10}, {0, 0, -10}}), Visibility::kHidden);
    EXPECT_EQ(ask(variant, kLookingBack, walls, {{3, 3, -6}, {3, 3, -6}}), Visibility::kVisible);
  }
}

TEST(OcclusionTree, ABoxInFrontThatCrossesTheSupportingPlaneBesideTheOccluderIsNotHidden) {
  // In front of the slanted wall within its cone, behind its plane outside of it; it is disjoint from the
  // wall.
  const OraclePolygon slanted{{{-1, -1, -4}, {1, -1, -6}, {1, 1, -6}, {-1, 1, -4}}, true};
  std::mt19937_64 random(11);
  for (int i = 0; i < 4000; ++i) {
    const Vec3d c((static_cast<double>(random() % 4000) - 2000) * 1e-3, 0.0,
                  -3.0 - static_cast<double>(random() % 4000) * 1e-3);
    const Vec3d h(0.2, 0.2, 0.4);
    const Box box{Vec3f(c - h), Vec3f(c + h)};
    const test::Sight sight = test::lookAt(box, kLookingBack, {{slanted}}, 60, random);
    for (const auto variant : kTreeVariants) {
      if (sight.seen) {
        EXPECT_NE(ask(variant, kLookingBack, {{slanted}}, box), Visibility::kHidden) << c.x << " " << c.z;
      }
    }
  }
}

TEST(OcclusionTree, ABoxThatCrossesAnOccludersPlaneBesideItIsHiddenOnlyByTheExactTest) {
  // The nearer wall hides the left of the box. What the slanted one hides lies behind it; the box crosses its
  // plane only to the left of it.
  const std::vector<OraclePolygon> walls{wall(-9, 0.2f, -9, 9, -5),
                                         {{{0, -20, -10}, {0, 20, -10}, {4, 20, -6}, {4, -20, -6}}, true}};
  const Box box{{-2.5f, -1, -12}, {1, 1, -11}};
  std::mt19937_64 random(5);
  ASSERT_TRUE(test::lookAt(box, kLookingBack, walls, 2000, random).blocked);
  EXPECT_EQ(ask(OcclusionTreeVariant::kFSE, kLookingBack, walls, box), Visibility::kHidden);
  EXPECT_EQ(ask(OcclusionTreeVariant::kFME, kLookingBack, walls, box), Visibility::kHidden);
  EXPECT_EQ(ask(OcclusionTreeVariant::kFSC, kLookingBack, walls, box), Visibility::kPartial);
  EXPECT_EQ(ask(OcclusionTreeVariant::kFMC, kLookingBack, walls, box), Visibility::kPartial);
}

TEST(OcclusionTree, PlanesOfTheFrustumThatABoxIsInsideOfAreNotAsked) {
  const OccluderSet nothing, one = setOf({{wall(-1, 1, -1, 1, -5)}});
  const Box ahead{{-1, -1, -12}, {1, 1, -10}}, across{{-12, -1, -12}, {1, 1, -10}};
  for (const auto variant : kTreeVariants) {
    OcclusionTree tree({.variant = variant});
    tree.build(kLookingBack, nothing, {});
    EXPECT_EQ(tree.classify(ahead, 0), Visibility::kVisible);
    EXPECT_EQ(tree.stats().plane_tests, 0u);
    EXPECT_EQ(tree.classify(ahead), Visibility::kVisible);
    EXPECT_EQ(tree.stats().plane_tests, 4u) << "one face, each plane once";
    EXPECT_EQ(tree.stats().cuts, 0u);
    EXPECT_EQ(tree.classify({{-12, -1, -12}, {-10.5f, 1, -11.5f}}, 1), Visibility::kVisible)
        << "the plane that it crosses";
    EXPECT_EQ(tree.classify({{-12, -1, -9}, {-10.5f, 1, -8}}, 1), Visibility::kHidden) << "wholly outside";
    EXPECT_GT(tree.stats().plane_tests, 4u);

    tree.build(kLookingBack, one, all(one));
    EXPECT_EQ(tree.stats().plane_tests, 0u);
    EXPECT_EQ(tree.classify(ahead, 0), Visibility::kHidden);
    EXPECT_EQ(tree.stats().cuts, 0u);
    EXPECT_EQ(tree.classify(across, 1), tree.classify(across));
  }
}

TEST(OcclusionTree, NeverHidesWhatShowsAmongSilhouettesThatCoincide) {
  // Panels with gaps between them, and the same ones twice and three times as far and as large: from the eye
  // all silhouettes coincide. Boxes end at the same lines of sight, or a little beside them.
  Random random(17);
  for (const bool orthographic : {false, true}) {
    std::vector<OraclePolygon> panels;
    for (int layer = 1; layer <= 3; ++layer) {
      const auto s = static_cast<float>(orthographic ? 1 : layer);
      for (int i = -4; i < 4; ++i) {
        for (int j = -2; j < 2; ++j) {
          if ((i + 3 * j + 7 * layer) % 4 == 0) {
            continue;
          }
          const auto x = static_cast<float>(i), y = static_cast<float>(j);
          panels.push_back(wall(s * x, s * (x + ((i + j) % 3 == 0 ? 0.75f : 1.0f)), s * y, s * (y + 1.0f),
                                -4.0f * static_cast<float>(layer)));
        }
      }
    }
    View view = kLookingBack;
    view.orthographic = orthographic;
    view.ortho_height = 10;
    const OccluderSet set = setOf(panels);
    std::vector<OcclusionTree> trees;
    for (const auto variant : kTreeVariants) {
      trees.emplace_back(OcclusionTreeSettings{.variant = variant});
      trees.back().build(view, set, all(set));
    }
    int hidden = 0, seen = 0;
    for (int i = 0; i < 3000; ++i) {
      const double s = orthographic ? 1.0 : 3.5;
      const auto at = [&](int from, int to) {
        const double exact = 0.25 * (from + static_cast<int>(random.bits() % (to - from)));
        return static_cast<float>(s * (exact + (random.bits() % 3 == 0 ? random.in(-1e-6, 1e-6) : 0.0)));
      };
      Box box;
      box.extend(Vec3f(at(-16, 16), at(-8, 8), -14.0f));
      box.extend(Vec3f(at(-16, 16), at(-8, 8), random.bits() % 2 == 0 ? -14.0f : -15.0f));
      const test::Sight sight = test::lookAt(box, view, panels, 300, random.engine());
      for (std::size_t v = 0; v < trees.size(); ++v) {
        const bool hides = trees[v].classify(box) == Visibility::kHidden;
        hidden += hides ? 1 : 0;
        EXPECT_FALSE(hides && sight.seen)
            << "box " << i << ", variant " << v << ", orthographic " << orthographic;
      }
      seen += sight.seen ? 1 : 0;
    }
    EXPECT_GT(hidden, 50);
    EXPECT_GT(seen, 50);
  }
}

class OcclusionTreeFamilies : public ::testing::TestWithParam<Family> {};

TEST_P(OcclusionTreeFamilies, NothingThatARayReachesIsHidden) {
  const Family family = GetParam();
  int hidden = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    RandomScene scene(family, seed);
    const OccluderSet set = setOf(scene.polygons);
    std::vector<OcclusionTree> trees;
    for (const auto variant : kTreeVariants) {
      trees.emplace_back(OcclusionTreeSettings{.variant = variant});
      trees.back().build(scene.view, set, all(set));
    }
    for (int i = 0; i < 60; ++i) {
      const Box box = scene.randomBox();
      std::vector<Visibility> states;
      for (OcclusionTree& tree : trees) {
        states.push_back(tree.classify(box));
      }
      const bool any_hidden = std::count(states.begin(), states.end(), Visibility::kHidden) > 0;
      hidden += any_hidden ? 1 : 0;
      if (any_hidden) {
        const test::Sight sight = test::lookAt(box, scene.view, scene.polygons, 400, scene.random.engine());
        EXPECT_FALSE(sight.seen) << family.name << " seed " << seed << " box " << i << " variants "
                                 << static_cast<int>(states[0]) << static_cast<int>(states[1])
                                 << static_cast<int>(states[2]) << static_cast<int>(states[3]);
      }
      // What the conservative algorithms hide, the exact one hides as well.
      if (states[2] == Visibility::kHidden || states[3] == Visibility::kHidden) {
        EXPECT_EQ(states[0], Visibility::kHidden) << family.name << " seed " << seed << " box " << i;
      }
    }
  }
  EXPECT_GT(hidden, 100);
}

INSTANTIATE_TEST_SUITE_P(Scales, OcclusionTreeFamilies, ::testing::ValuesIn(kFamilies),
                         [](const auto& param) { return "Family" + std::to_string(param.index); });

TEST(OcclusionTree, TheExactVariantFindsAllThatTheOccludersHide) {
  // Every box that 3,000 rays find blocked, with none near an edge, must be called hidden.
  int blocked = 0, missed = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const Family family{"metres", 1.0, 0.0, false};
    std::vector<OraclePolygon> polygons;
    for (int i = 0; i < 6; ++i) {
      polygons.push_back(randomPolygon(random, family, {0, 0, -10}));
    }
    const View view = kLookingBack;
    const OccluderSet set = setOf(polygons);
    OcclusionTree tree({.variant = OcclusionTreeVariant::kFSE});
    tree.build(view, set, all(set));
    for (int i = 0; i < 40; ++i) {
      const Vec3d c = Vec3d(0, 0, -18) + random.point(6.0);
      const Vec3d h = abs(random.point(0.6)) + Vec3d(0.05, 0.05, 0.05);
      const Box box{Vec3f(c - h), Vec3f(c + h)};
      const test::Sight sight = test::lookAt(box, view, polygons, 3000, random.engine());
      if (!sight.seen && sight.blocked) {
        ++blocked;
        missed += tree.classify(box) != Visibility::kHidden ? 1 : 0;
      }
    }
  }
  EXPECT_GT(blocked, 200);
  // Rays are samples: a visible corner can be smaller than what 3,000 of them find.
  EXPECT_LE(missed, blocked / 50);
}

TEST(OcclusionTree, TheOrderOfTheChosenOccludersDoesNotMatterForSafety) {
  Random random(5);
  const Family family{"metres", 1.0, 0.0, false};
  std::vector<OraclePolygon> polygons;
  for (int i = 0; i < 30; ++i) {
    polygons.push_back(randomPolygon(random, family, {0, 0, -12}));
  }
  const OccluderSet set = setOf(polygons);
  std::vector<OccluderId> ids = all(set);
  for (int round = 0; round < 20; ++round) {
    std::shuffle(ids.begin(), ids.end(), random.engine());
    OcclusionTree tree;
    tree.build(kLookingBack, set, ids);
    for (int i = 0; i < 60; ++i) {
      const Vec3d c = Vec3d(0, 0, -16) + random.point(8.0);
      const Box box{Vec3f(c - Vec3d(0.3, 0.3, 0.3)), Vec3f(c + Vec3d(0.3, 0.3, 0.3))};
      if (tree.classify(box) == Visibility::kHidden) {
        EXPECT_FALSE(test::lookAt(box, kLookingBack, polygons, 300, random.engine()).seen);
      }
    }
  }
}

TEST(OcclusionTree, TooFewNodesCostTightnessButNeverSafety) {
  Random random(9);
  const Family family{"metres", 1.0, 0.0, false};
  std::vector<OraclePolygon> polygons;
  for (int i = 0; i < 30; ++i) {
    polygons.push_back(randomPolygon(random, family, {0, 0, -12}));
  }
  const OccluderSet set = setOf(polygons);
  OcclusionTree tree({.max_nodes = 40});
  tree.build(kLookingBack, set, all(set));
  EXPECT_GT(tree.stats().dropped, 0u);
  EXPECT_LE(tree.stats().nodes, 40u);
  for (int i = 0; i < 500; ++i) {
    const Vec3d c = Vec3d(0, 0, -16) + random.point(8.0);
    const Box box{Vec3f(c - Vec3d(0.3, 0.3, 0.3)), Vec3f(c + Vec3d(0.3, 0.3, 0.3))};
    if (tree.classify(box) == Visibility::kHidden) {
      EXPECT_FALSE(test::lookAt(box, kLookingBack, polygons, 300, random.engine()).seen);
    }
  }
}

TEST(OcclusionTree, TheModifiedTreeHasNoMoreNodesThanTheStandardOne) {
  Random random(13);
  const Family family{"metres", 1.0, 0.0, false};
  for (int round = 0; round < 20; ++round) {
    std::vector<OraclePolygon> polygons;
    for (int i = 0; i < 12; ++i) {
      polygons.push_back(randomPolygon(random, family, {0, 0, -12}));
    }
    const OccluderSet set = setOf(polygons);
    OcclusionTree standard({.variant = OcclusionTreeVariant::kFSE}),
        modified({.variant = OcclusionTreeVariant::kFME});
    standard.build(kLookingBack, set, all(set));
    modified.build(kLookingBack, set, all(set));
    EXPECT_LE(modified.stats().nodes, standard.stats().nodes);
  }
}

}  // namespace
}  // namespace sightline
