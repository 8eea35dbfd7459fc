// Whole scenes, for which all sorts and searches must give the same result.

#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <vector>

#include "tests/layers/made_parts.h"
#include "tests/layers/moving_sorter.h"
#include "tests/layers/sorter_choices.h"

namespace sightline {
namespace {

using made::Answer;

// Compares all sorters in every `step`th frame, and in some frames with a fresh sorter.
void expectSameInAllFrames(const MovingScene& scene, const std::vector<ExtentAxis>& extents,
                           std::uint32_t step, bool all_arcs) {
  std::vector<MovingSorter> sorters;
  std::vector<LayerSettings> settings;
  for (const SortChoice sort : kSortChoices) {
    for (const SearchChoice search : kSearchChoices) {
      LayerSettings one;
      one.sort = sortOf(sort);
      one.search = searchOf(search, {.rebuild_after = 20});
      one.extents = extents;
      one.arcs = all_arcs ? LayerArcs::kAll : LayerArcs::kWithinGroups;
      one.conditioning = sort != SortChoice::kIncremental || search != SearchChoice::kTree;
      one.conditioning_axis = 2;
      sorters.emplace_back(scene, one);
      settings.push_back(one);
    }
  }
  for (std::uint32_t frame = 0; frame < scene.frames; frame += step) {
    SCOPED_TRACE(::testing::Message() << "frame " << frame);
    const Answer first(sorters[0].update(frame));
    made::expectOrdered(first, first.arcs);
    for (std::size_t i = 1; i < sorters.size(); ++i) {
      SCOPED_TRACE(::testing::Message() << "sorter " << i);
      const Answer other(sorters[i].update(frame));
      expectSame(first, other);
      made::expectOrdered(other, other.arcs);
    }
    if (frame % 50 == 0) {
      MovingSorter fresh(scene, settings[0]);
      expectSame(first, Answer(fresh.update(frame)));
    }
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
}

TEST(LayerSorterScenes, AllWaysToSortToothpicksGiveTheSame) {
  expectSameInAllFrames(makeToothpicks({.count = 100}), cameraExtents(), 1, false);
}

TEST(LayerSorterScenes, AllWaysToSortToothpicksByWorldExtentsGiveTheSame) {
  expectSameInAllFrames(makeToothpicks({.count = 60, .velocity = 8.0, .seed = 2}), worldExtents(), 5, true);
}

TEST(LayerSorterScenes, AllWaysToSortTheCanyonGiveTheSame) {
  expectSameInAllFrames(makeCanyon({}), worldExtents(), 10, false);
  expectSameInAllFrames(makeCanyon({.grid = 7}), cameraExtents(), 25, true);
}

TEST(LayerSorterScenes, ExtentsDoNotChangeTheArcs) {
  const MovingScene scene = makeToothpicks({.count = 100});
  LayerSettings settings;
  settings.arcs = LayerArcs::kAll;
  MovingSorter by_camera(scene, settings);
  settings.extents = worldExtents();
  MovingSorter by_world(scene, settings);
  settings.extents = {};
  MovingSorter by_none(scene, settings);
  for (const std::uint32_t frame : {0u, 1u, 100u, 249u}) {
    SCOPED_TRACE(::testing::Message() << "frame " << frame);
    const Answer camera(by_camera.update(frame));
    expectSame(camera, Answer(by_world.update(frame)));
    expectSame(camera, Answer(by_none.update(frame)));
  }
}

// The unit of length may have any size, and the scene may lie far from the origin.
TEST(LayerSorterScenes, ToothpicksOfAnySizeAnywhereAreGroupedTheSame) {
  const MovingScene scene = makeToothpicks({.count = 60});
  LayerSettings settings;
  settings.arcs = LayerArcs::kAll;
  MovingSorter here(scene, settings);
  for (const auto& [scale, shift] :
       {std::pair(1e-6, 0.0), {1e6, 0.0}, {1.0, 1e6}, {1e-6, 1.0}, {1e6, -1e9}}) {
    SCOPED_TRACE(::testing::Message() << "scale " << scale << ", shift " << shift);
    MovingScene elsewhere = scene;
    elsewhere.pose = [&, scale = scale, shift = shift](std::uint32_t frame, std::span<Mat4> world_from_part) {
      scene.pose(frame, world_from_part);
      for (Mat4& m : world_from_part) {
        for (int row = 0; row < 3; ++row) {
          for (int column = 0; column < 4; ++column) {
            m(row, column) *= scale;
          }
          m(row, 3) += shift;
        }
      }
    };
    MovingSorter there(elsewhere, settings);
    for (const std::uint32_t frame : {0u, 125u, 249u}) {
      SCOPED_TRACE(::testing::Message() << "frame " << frame);
      View view = here.view(frame);
      here.pose(frame);
      const Answer expected(here.sorter().update(view));
      view.eye = view.eye * scale + Vec3d{shift, shift, shift};
      there.pose(frame);
      expectSame(Answer(there.sorter().update(view)), expected);
    }
  }
}

TEST(LayerSorterScenes, TheSkyIsTheLastPartOfTheCanyon) {
  const MovingScene scene = makeCanyon({.grid = 5});
  MovingSorter moving(scene, {});
  const LayerOrder& order = moving.update(100);
  EXPECT_EQ(order.parts.size(), scene.parts.size());
  EXPECT_EQ(scene.parts[order.parts.back().value].name, "sky");
  EXPECT_EQ(order.group(order.groups() - 1).size(), 1u);
}

}  // namespace
}  // namespace sightline
