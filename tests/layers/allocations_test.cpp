#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <random>
#include <vector>

#include "sightline/layers/shaped_image.h"
#include "src/layers/extents/extent_scan.h"
#include "src/layers/extents/part_extents.h"
#include "src/layers/sort/conditioning_sort.h"
#include "src/layers/sort/depth_first_sort.h"
#include "tests/layers/extent_scene.h"
#include "tests/layers/graph_source.h"
#include "tests/layers/moving_sorter.h"
#include "tests/layers/sorter_choices.h"
#include "tests/support/count_allocations.h"

namespace sightline::layers {
namespace {

TEST(Sorts, DoNotAllocateOnceTheyHaveSortedAsMuch) {
  std::mt19937 random(3);
  const std::vector<std::uint32_t> previous = shuffledOrder(60, random);
  GraphSource graph = randomGraph(60, 25, random);
  DepthFirstSort depth_first;
  ConditioningSort conditioning;
  GroupedOrder order;
  std::vector<double> keys(60);
  for (double& key : keys) {
    key = below(100, random);
  }
  std::size_t before = 0;
  std::uint64_t conditioned = 0;
  for (int round = 0; round < 3; ++round) {
    before = allocations.load();
    graph.reset();
    depth_first.sort(previous, graph, order);
    conditioned =
        conditioning.sort(std::span(keys).first(order.groups()), keys, {askGraph, &graph}, {}, order);
  }
  EXPECT_EQ(allocations.load() - before, 0u);
  EXPECT_GT(conditioned, 0u);
}

}  // namespace
}  // namespace sightline::layers

namespace sightline::layers::extent_tests {
namespace {

TEST(PartExtents, DoNotAllocateAfterTheFirstFrame) {
  shapes::Random random(2);
  ExtentScene scene;
  const std::uint32_t hulls[] = {scene.addHull(shapes::toothpick(0.7)), scene.addHull(shapes::cube())};
  for (int i = 0; i < 50; ++i) {
    scene.addPart(hulls, randomPlacement(random, random.direction() * 5.0, 1));
  }
  PartExtents extents(cameraExtents());
  ExtentScan scan;
  std::vector<std::uint32_t> found, order(50);
  std::iota(order.begin(), order.end(), 0u);
  found.reserve(50);
  std::size_t before = 0;
  for (int frame = 0; frame < 20; ++frame) {
    if (frame == 1) {
      before = allocations;
    }
    const View view = randomView(random, random.direction() * 8.0, frame % 5 == 4);
    for (std::uint32_t part = 0; part < 50; ++part) {
      scene.place(part, randomPlacement(random, random.direction() * 5.0, 1));
    }
    extents.update(view, scene.store, scene.moved, scene.used);
    std::next_permutation(order.begin(), order.end());
    scan.beginFrame(extents.table(), order);
    for (std::uint32_t part = 0; part < 50; ++part) {
      found.clear();
      scan.query(extents.query(part), found);
    }
  }
  EXPECT_EQ(allocations - before, 0u);
}

}  // namespace
}  // namespace sightline::layers::extent_tests

namespace sightline {
namespace {

TEST(Compositing, DoesNotAllocateAfterWarmUp) {
  const std::uint32_t n = 12;
  std::vector<PartId> parts;
  std::vector<LayerArc> arcs;
  for (std::uint32_t i = 0; i < n; ++i) {
    parts.push_back(PartId(i));
  }
  for (std::uint32_t i = 0; i + 1 < n; ++i) {
    arcs.push_back({PartId(i), PartId((i + 1) % (n - 1))});
  }
  arcs.push_back({PartId(4u), PartId(3u)});
  arcs.push_back({PartId(2u), PartId(7u)});
  const std::vector<std::uint32_t> first_of{0, n - 1, n};
  const LayerOrder order{.parts = parts, .first_of = first_of, .arcs = arcs};

  std::vector<ShapedPixel> pixels(64 * 4, ShapedPixel{0.1f, 0.2f, 0.3f, 0.4f}), result(64 * 4), scratch(32);
  const std::vector<ShapedImage> images(n, ShapedImage{pixels.data(), 64, 4, 64});
  LayerMerger merger;
  CompositingCompiler compiler;
  std::size_t layers = 0;
  const auto frame = [&] {
    for (const auto form :
         {CompositingForm::kSumOfOuts, CompositingForm::kOverAtop, CompositingForm::kCheapest}) {
      const CompositingProgram& program = compiler.compile(merger.merge(order), form);
      layers = program.layers;
      EXPECT_TRUE(evaluate(program, images, {result.data(), 64, 4, 64}, scratch));
    }
  };
  frame();
  ASSERT_EQ(layers, n - 1u);
  const std::size_t before = allocations.load();
  frame();
  EXPECT_EQ(allocations.load(), before);
}

// Sorts all frames three times. The results of pairs kept at the end of one round are there at the beginning
// of the next, so the third round starts like the second and all storage has reached its greatest size.
void expectNoAllocations(const MovingScene& scene, LayerSettings settings) {
  MovingSorter moving(scene, settings);
  LayerMerger merger;
  CompositingCompiler compiler;
  std::size_t before = 0, groups = 0;
  for (int round = 0; round < 3; ++round) {
    moving.sorter().reset();
    before = allocations;
    for (std::uint32_t frame = 0; frame < scene.frames; ++frame) {
      const LayerOrder& order = moving.update(frame);
      compiler.compile(merger.merge(order));
      groups = order.groups();
    }
  }
  EXPECT_EQ(allocations - before, 0u);
  EXPECT_GT(groups, 20u);
}

TEST(LayerSorter, DoesNotAllocateAfterWarmUp) {
  MovingScene scene = makeToothpicks({.count = 60});
  scene.frames = 60;
  for (const SortChoice sort : kSortChoices) {
    for (const SearchChoice search : kSearchChoices) {
      for (const bool all_arcs : {false, true}) {
        SCOPED_TRACE(::testing::Message() << nameOf(sort) << nameOf(search) << all_arcs);
        LayerSettings settings;
        settings.sort = sortOf(sort);
        settings.search = searchOf(search);
        settings.arcs = all_arcs ? LayerArcs::kAll : LayerArcs::kWithinGroups;
        expectNoAllocations(scene, settings);
      }
    }
  }
}

}  // namespace
}  // namespace sightline
