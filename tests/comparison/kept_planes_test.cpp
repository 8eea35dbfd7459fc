#include "sightline/comparison/kept_planes.h"

#include <gtest/gtest.h>

#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using namespace test;

struct Budget {
  const char* name;
  std::size_t bytes;
};

class KeptRelations : public ::testing::TestWithParam<Budget> {};

TEST_P(KeptRelations, ChangeNoAnswer) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    RandomScene scene({"metres", 1.0, 0.0, false}, seed);
    const OccluderSet set = setOf(scene.polygons);
    std::vector<Box> boxes;
    for (int i = 0; i < 80; ++i) {
      boxes.push_back(scene.randomBox());
    }
    KeptPlanes kept({.relation_bytes = GetParam().bytes}), fresh({.keep_relations = false});
    View view = scene.view;
    std::vector<OccluderId> ids = all(set);
    for (int frame = 0; frame < 120; ++frame) {
      const std::uint64_t dice = scene.random.bits() % 20;
      if (dice == 0) {
        view.eye = scene.random.point(10.0);  // a jump
      } else if (dice == 1) {
        view.orthographic = !view.orthographic;
      } else if (dice > 3) {
        view.eye += scene.random.point(dice % 2 ? 0.02 : 0.5);  // else it stands still
      }
      if (dice % 3 == 0) {
        setOrientation(view, view.forward + scene.random.point(0.3), {0, 1, 0});
      }
      std::shuffle(ids.begin(), ids.end(), scene.random.engine());
      const std::span<const OccluderId> chosen(ids.data(), 1 + scene.random.bits() % ids.size());
      kept.build(view, set, chosen);
      fresh.build(view, set, chosen);
      for (std::uint32_t item = 0; item < boxes.size(); ++item) {
        if (scene.random.bits() % 8 == 0) {
          kept.forget(item);
          continue;
        }
        OccluderList a, b;
        EXPECT_EQ(kept.classify(boxes[item], item, kept.all(), a),
                  fresh.classify(boxes[item], item, fresh.all(), b))
            << "seed " << seed << " frame " << frame << " item " << item;
        EXPECT_EQ(a.count, b.count);
      }
      EXPECT_EQ(fresh.stats().relations.reused, 0u);
      EXPECT_LE(kept.stats().relations.bytes, GetParam().bytes + boxes.size() * 16);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Budgets, KeptRelations,
                         ::testing::Values(Budget{"Nothing", 0}, Budget{"OneBlock", 400},
                                           Budget{"FewBlocks", 4000}, Budget{"Thrashing", 100'000},
                                           Budget{"Enough", 64u << 20}),
                         [](const auto& param) { return std::string(param.param.name); });

// Relations that went for want of room are those of one frame, whether or not somebody asked in between.
TEST(KeptPlanes, AskingForStatsChangesNothing) {
  const std::vector<OraclePolygon> walls{wall(-1, 1, -1, 1, -5), wall(-1, 1, -1, 1, -6)};
  const OccluderSet set = setOf(walls);
  const KeptPlanesSettings little_room{.relation_bytes = 1000};
  KeptPlanes asked(little_room), alone(little_room);
  const auto frame = [&](KeptPlanes& planes, std::uint32_t items) {
    planes.build(kLookingBack, set, all(set));
    for (std::uint32_t item = 0; item < items; ++item) {
      OccluderList touching;
      planes.classify(Box{{-2, -1, -12}, {2, 1, -10}}, item, planes.all(), touching);
    }
  };
  frame(asked, 20);
  EXPECT_GT(asked.stats().relations.evicted, 0u);
  EXPECT_EQ(asked.stats().relations.evicted, asked.stats().relations.evicted);
  frame(alone, 20);
  frame(asked, 0);
  frame(alone, 0);
  EXPECT_EQ(alone.stats().relations.evicted, 0u) << "those of the frame before";
  EXPECT_EQ(asked.stats().relations.evicted, 0u);
  EXPECT_EQ(alone.stats().relations.kept, asked.stats().relations.kept);
}

// Against the contract, which asks for forgetAll(): answers may be those of before, but memory stays sound.
TEST(KeptPlanes, RelationsOfAnOccluderWithOtherEdgesAreMadeAnew) {
  const std::vector<OraclePolygon> square{wall(-1, 1, -1, 1, -5)};
  const std::vector<OraclePolygon> octagon{{{{-2, -1, -5},
                                             {-1, -2, -5},
                                             {1, -2, -5},
                                             {2, -1, -5},
                                             {2, 1, -5},
                                             {1, 2, -5},
                                             {-1, 2, -5},
                                             {-2, 1, -5}},
                                            false}};
  KeptPlanes planes;
  OccluderSet set;
  for (int frame = 0; frame < 6; ++frame) {
    set = setOf(frame % 2 == 0 ? square : octagon);
    planes.build(kLookingBack, set, all(set));
    OccluderList touching;
    // In the shadow of the octagon, and not of the square.
    const Visibility state = planes.classify(Box{{-3, -3, -12}, {3, 3, -11}}, 0, planes.all(), touching);
    EXPECT_EQ(state == Visibility::kHidden, frame % 2 == 1) << frame;
    EXPECT_EQ(planes.stats().relations.rebuilt, 1u);
    EXPECT_EQ(planes.stats().relations.kept, 1u);
  }
}

TEST(KeptPlanes, KeptRelationsAreReusedAndLeftUnlookedAtWhileTheEyeIsNear) {
  const std::vector<OraclePolygon> walls{wall(-1, 1, -1, 1, -5), wall(4, 5, -1, 1, -5)};
  const OccluderSet set = setOf(walls);
  KeptPlanes planes;
  const Box box{{-1, -1, -12}, {1, 1, -10}};
  View view = kLookingBack;
  OccluderList touching;
  planes.build(view, set, all(set));
  EXPECT_EQ(planes.classify(box, 0, planes.all(), touching), Visibility::kHidden);
  EXPECT_EQ(planes.stats().relations.rebuilt, planes.stats().relations.kept);
  EXPECT_GT(planes.stats().relations.kept, 0u);
  view.eye.x = 0.01;
  planes.build(view, set, all(set));
  EXPECT_EQ(planes.classify(box, 0, planes.all(), touching), Visibility::kHidden);
  EXPECT_EQ(planes.stats().relations.rebuilt, 0u);
  EXPECT_EQ(planes.stats().relations.unchanged, planes.stats().relations.reused);
  view.eye.x = 3.0;  // now the box comes out
  planes.build(view, set, all(set));
  EXPECT_NE(planes.classify(box, 0, planes.all(), touching), Visibility::kHidden);
  EXPECT_EQ(planes.stats().relations.unchanged, 0u);
  EXPECT_TRUE(planes.forget(0));
  EXPECT_FALSE(planes.forget(0));
  EXPECT_EQ(planes.stats().relations.kept, 0u);
}

}  // namespace
}  // namespace sightline
