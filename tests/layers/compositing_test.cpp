#include "sightline/layers/compositing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sightline/layers/shaped_image.h"

namespace sightline {
namespace {

using enum CompositingForm;
constexpr CompositingForm kForms[] = {kSumOfOuts, kOverAtop, kCheapest};

// Layers in groups, and the occlusions in each group.
struct Scene {
  FrameLayers frame;
  std::vector<std::vector<bool>> occludes;  // [front][back]

  explicit Scene(const std::vector<std::uint32_t>& group_sizes) {
    frame.first_part = {0};
    frame.first_layer = {0};
    for (const std::uint32_t size : group_sizes) {
      for (std::uint32_t i = 0; i < size; ++i) {
        frame.parts.push_back(PartId(frame.parts.size()));
        frame.first_part.push_back(static_cast<std::uint32_t>(frame.parts.size()));
      }
      frame.first_layer.push_back(static_cast<std::uint32_t>(frame.parts.size()));
    }
    occludes.assign(frame.parts.size(), std::vector<bool>(frame.parts.size(), false));
  }
  std::size_t layers() const { return frame.layers(); }
  void add(std::size_t front, std::size_t back) {
    if (front != back && !occludes[back][front]) {
      occludes[front][back] = true;
    }
  }
  void addRing(std::size_t first, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      add(first + i, first + (i + 1) % size);
    }
  }
  const FrameLayers& finished() {
    frame.occlusions.clear();
    for (std::size_t a = 0; a < layers(); ++a) {
      for (std::size_t b = 0; b < layers(); ++b) {
        if (occludes[a][b]) {
          frame.occlusions.push_back({LayerId(a), LayerId(b)});
        }
      }
    }
    return frame;
  }
  std::size_t groupOf(std::size_t layer) const {
    std::size_t g = 0;
    while (frame.first_layer[g + 1] <= layer) {
      ++g;
    }
    return g;
  }
};

Scene ring(std::uint32_t n) {
  Scene scene({n});
  scene.addRing(0, n);
  scene.finished();
  return scene;
}

// Returns groups of up to ten layers: single layers, rings with chords, chains of rings, or any graph.
Scene randomLayers(std::mt19937& random) {
  std::vector<std::uint32_t> sizes(1 + random() % 3);
  for (std::uint32_t& size : sizes) {
    size = static_cast<std::uint32_t>(1 + random() % 10);
  }
  Scene scene(sizes);
  for (std::size_t g = 0; g < sizes.size(); ++g) {
    const std::size_t first = scene.frame.first_layer[g], size = sizes[g];
    const auto kind = random() % 3, density = random() % 101;
    if (kind == 0 && size >= 3) {
      scene.addRing(first, size);
    } else if (kind == 1 && size >= 6) {
      scene.addRing(first, size / 2);
      scene.addRing(first + size / 2, size - size / 2);
    }
    for (std::size_t a = first; a < first + size; ++a) {
      for (std::size_t b = a + 1; b < first + size; ++b) {
        if (random() % 100 < density) {
          random() % 2 == 0 ? scene.add(a, b) : scene.add(b, a);
        }
      }
    }
  }
  scene.finished();
  return scene;
}

// Returns layers that may cover one pixel, front to back: within a group, any two of them have an occlusion,
// and there is no cycle.
std::vector<std::size_t> randomCover(const Scene& scene, std::mt19937& random) {
  std::vector<std::size_t> candidates(scene.layers());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    candidates[i] = i;
  }
  std::shuffle(candidates.begin(), candidates.end(), random);
  const auto isBefore = [&](std::size_t a, std::size_t b) {
    const std::size_t ga = scene.groupOf(a), gb = scene.groupOf(b);
    return ga != gb ? ga < gb : static_cast<bool>(scene.occludes[a][b]);
  };
  std::vector<std::size_t> cover;
  for (const std::size_t layer : candidates) {
    const auto place = static_cast<std::ptrdiff_t>(
        std::count_if(cover.begin(), cover.end(), [&](std::size_t c) { return isBefore(c, layer); }));
    const bool fits =
        std::all_of(cover.begin(), cover.begin() + place,
                    [&](std::size_t c) { return isBefore(c, layer); }) &&
        std::all_of(cover.begin() + place, cover.end(), [&](std::size_t c) { return isBefore(layer, c); });
    if (fits && random() % 8 != 0) {
      cover.insert(cover.begin() + place, layer);
    }
  }
  return cover;
}

std::vector<ShapedPixel> randomFragments(const std::vector<std::size_t>& cover, std::size_t layers,
                                         std::mt19937& random) {
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<ShapedPixel> pixels(layers);
  const bool opaque = random() % 2 == 0;
  for (const std::size_t layer : cover) {
    const float alpha = opaque || random() % 3 == 0 ? 1.0f : unit(random);
    pixels[layer] = {unit(random) * alpha, unit(random) * alpha, unit(random) * alpha, alpha};
  }
  return pixels;
}

// Composites front to back: each layer is attenuated by those in front of it.
std::array<double, 4> composited(const std::vector<std::size_t>& front_to_back,
                                 const std::vector<ShapedPixel>& pixels) {
  std::array<double, 4> sum{};
  double through = 1.0;
  for (const std::size_t layer : front_to_back) {
    const ShapedPixel& p = pixels[layer];
    sum[0] += through * p.red;
    sum[1] += through * p.green;
    sum[2] += through * p.blue;
    through *= 1.0 - p.alpha;
  }
  sum[3] = 1.0 - through;
  return sum;
}

void expectClose(const ShapedPixel& p, const std::array<double, 4>& expected) {
  const double error = std::max({std::abs(p.red - expected[0]), std::abs(p.green - expected[1]),
                                 std::abs(p.blue - expected[2]), std::abs(p.alpha - expected[3])});
  ASSERT_LT(error, 1e-6);
}

void expectRightAtRandomPixels(const Scene& scene, std::mt19937& random, int pixels) {
  CompositingCompiler compiler;
  for (const CompositingForm form : kForms) {
    SCOPED_TRACE(static_cast<int>(form));
    const CompositingProgram& program = compiler.compile(scene.frame, form);
    for (int i = 0; i < pixels; ++i) {
      const auto cover = randomCover(scene, random);
      const auto fragments = randomFragments(cover, scene.layers(), random);
      ASSERT_NO_FATAL_FAILURE(expectClose(evaluatePixel(program, fragments), composited(cover, fragments)));
    }
  }
}

TEST(CompositingProgram, OfRingsShowsWhatTheSortedFragmentsShow) {
  std::mt19937 random(1);
  for (std::uint32_t n = 3; n <= 12; ++n) {
    SCOPED_TRACE(n);
    expectRightAtRandomPixels(ring(n), random, 200);
  }
}

TEST(CompositingProgram, OfAnyGraphWithoutPairsShowsWhatTheSortedFragmentsShow) {
  std::size_t deepest = 0;
  for (unsigned seed = 0; seed < 1500; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Scene scene = randomLayers(random);
    ASSERT_NO_FATAL_FAILURE(expectRightAtRandomPixels(scene, random, 20));
    deepest = std::max(deepest, randomCover(scene, random).size());
  }
  EXPECT_GE(deepest, 6u);  // pixels with few layers would test little
}

TEST(CompositingProgram, OfACycleWithinWhatIsLeftIsRight) {
  // Two rings that share layer 0, and a third beside: without 0 there is one ring less, not two.
  Scene scene({8});
  scene.addRing(0, 3);
  scene.addRing(4, 4);
  scene.add(0, 3);
  scene.add(3, 2);
  scene.add(2, 4);
  scene.add(6, 0);
  scene.finished();
  std::mt19937 random(4);
  expectRightAtRandomPixels(scene, random, 500);
}

TEST(CompositingProgram, OfFigure14IsTheSumOfOutsThatThePaperPrints) {
  // A, B, C are 0, 1, 2; C occludes A, A occludes B, B occludes C.
  const Scene scene = ring(3);
  CompositingCompiler compiler;
  EXPECT_EQ(describe(compiler.compile(scene.frame, kSumOfOuts)),
            "load 0\nout 2\nstart sum\n"
            "load 1\nout 0\nadd\n"
            "load 2\nout 1\nadd\n"
            "start image\n");
}

TEST(CompositingProgram, OfFigure14IsTheOverAtopThatThePaperPrints) {
  // Expected: (C atop A) over B over C.
  const Scene scene = ring(3);
  CompositingCompiler compiler;
  EXPECT_EQ(describe(compiler.compile(scene.frame, kOverAtop)),
            "load 2\nin 0\nstart sum\n"
            "load 0\nout 2\nadd\n"
            "start image\nover 1\nover 2\n");
}

TEST(CompositingProgram, OfARingTakesAsManyOperationsAsThePaperCounts) {
  CompositingCompiler compiler;
  for (std::uint32_t n = 3; n <= 40; ++n) {
    SCOPED_TRACE(n);
    const Scene scene = ring(n);
    const CompositingCounts sum = countSteps(compiler.compile(scene.frame, kSumOfOuts).steps);
    EXPECT_EQ(sum, (CompositingCounts{.loads = n, .moves = 2, .outs = n, .adds = n - 1}));
    const CompositingCounts atop = countSteps(compiler.compile(scene.frame, kOverAtop).steps);
    EXPECT_EQ(atop,
              (CompositingCounts{.loads = 2, .moves = 2, .ins = 1, .outs = 1, .adds = 1, .overs = n - 1}));
    EXPECT_EQ(countSteps(compiler.compile(scene.frame, kCheapest).steps), atop);
  }
}

TEST(CompositingProgram, OfSingleLayersIsAChainOfOvers) {
  Scene scene({1, 1, 1, 1});
  CompositingCompiler compiler;
  for (const CompositingForm form : kForms) {
    const CompositingProgram& program = compiler.compile(scene.finished(), form);
    EXPECT_EQ(describe(program), "start image 0\nover 1\nover 2\nover 3\n");
    EXPECT_EQ(program.first_of, (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
  }
}

TEST(CompositingProgram, OfNothingIsEmptyAndTransparent) {
  CompositingCompiler compiler;
  for (const FrameLayers& frame : {FrameLayers{}, Scene({}).frame}) {
    const CompositingProgram& program = compiler.compile(frame);
    EXPECT_TRUE(program.steps.empty());
    EXPECT_EQ(program.layers, 0u);
    EXPECT_EQ(evaluatePixel(program, {}), ShapedPixel{});
  }
}

TEST(CompositingProgram, TakesTheLayerWithTheFewestOccludersOutFirst) {
  // 0 and 1 have two occluders each; 2 to 4 have one each, and 3 of these occludes most.
  Scene scene({5});
  scene.addRing(0, 5);
  scene.add(3, 0);
  scene.add(3, 1);
  CompositingCompiler compiler;
  EXPECT_EQ(describe(compiler.compile(scene.finished(), kOverAtop)),
            "load 2\nin 3\nstart sum\nload 3\nout 2\nadd\nstart image\nover 4\nover 0\nover 1\nover 2\n");
}

// The costs of the forms as their descriptions define them, by plain recursion.
struct PlainCost {
  const Scene& scene;
  CompositingForm form;
  using Layers = std::vector<std::size_t>;

  std::size_t arcsAmong(const Layers& layers) const {
    std::size_t count = 0;
    for (const std::size_t a : layers) {
      count += occludersOf(a, layers).size();
    }
    return count;
  }
  Layers occludersOf(std::size_t layer, const Layers& among) const {
    Layers result;
    std::copy_if(among.begin(), among.end(), std::back_inserter(result),
                 [&](std::size_t other) { return scene.occludes[other][layer]; });
    return result;
  }
  std::vector<Layers> cyclesOf(Layers layers) const {
    auto reaches = scene.occludes;
    for (const std::size_t via : layers) {
      for (const std::size_t a : layers) {
        for (const std::size_t b : layers) {
          reaches[a][b] = reaches[a][b] || (reaches[a][via] && reaches[via][b]);
        }
      }
    }
    std::vector<Layers> cycles;
    while (!layers.empty()) {
      const std::size_t first = layers[0];
      Layers cycle{first};
      std::copy_if(layers.begin() + 1, layers.end(), std::back_inserter(cycle),
                   [&](std::size_t other) { return reaches[first][other] && reaches[other][first]; });
      std::erase_if(layers, [&](std::size_t other) {
        return std::find(cycle.begin(), cycle.end(), other) != cycle.end();
      });
      cycles.push_back(cycle);
    }
    return cycles;
  }
  // Returns the number of operations, with one "over" for each cycle.
  std::size_t of(const Layers& layers) const {
    std::size_t total = 0;
    for (const Layers& cycle : cyclesOf(layers)) {
      total += cycle.size() == 1 ? 1 : ofCycle(cycle);
    }
    return total;
  }
  std::size_t ofCycle(const Layers& cycle) const {
    const std::size_t sum = arcsAmong(cycle) + cycle.size() - 1 + 1;
    if (form == kSumOfOuts) {
      return sum;
    }
    const auto rank = [&](std::size_t layer) {
      const auto occluded =
          std::count_if(cycle.begin(), cycle.end(), [&](std::size_t b) { return scene.occludes[layer][b]; });
      return std::pair(occludersOf(layer, cycle).size(), -occluded);
    };
    const std::size_t out = *std::min_element(
        cycle.begin(), cycle.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
    const Layers around = occludersOf(out, cycle);
    Layers rest = cycle;
    std::erase(rest, out);
    const std::size_t in = around.size(), outs = around.size() + arcsAmong(around), adds = around.size();
    const std::size_t atop = in + outs + adds + 1 + of(rest);
    return form == kOverAtop ? atop : std::min(sum, atop);
  }
};

TEST(CompositingProgram, TakesAsManyOperationsAsThePlainRecursion) {
  CompositingCompiler compiler;
  std::size_t sum_wins = 0, atop_wins = 0;
  for (unsigned seed = 0; seed < 600; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Scene scene = randomLayers(random);
    if (seed % 4 == 0) {  // larger groups, whose cheapest program uses both forms
      scene = Scene({30});
      scene.addRing(0, 30);
      for (std::size_t more = random() % 300; more > 0; --more) {
        scene.add(random() % 30, random() % 30);
      }
      scene.finished();
    }
    PlainCost::Layers all(scene.layers());
    std::iota(all.begin(), all.end(), std::size_t{0});
    const auto operations = [&](CompositingForm form) {
      return countSteps(compiler.compile(scene.frame, form).steps).operations();
    };
    for (const CompositingForm form : kForms) {
      // Groups are independent, since no cycle spans two of them. The first step is not an "over".
      const std::size_t expected = PlainCost{scene, form}.of(all) - 1;
      ASSERT_EQ(operations(form), expected);
    }
    const std::size_t sum = operations(kSumOfOuts), atop = operations(kOverAtop);
    ASSERT_LE(operations(kCheapest), std::min(sum, atop));
    sum_wins += sum < atop ? 1 : 0;
    atop_wins += atop < sum ? 1 : 0;
  }
  EXPECT_GT(sum_wins, 0u);
  EXPECT_GT(atop_wins, 0u);
}

TEST(CompositingProgram, NamesEveryLayerAndNoOtherAndUsesRegistersAfterTheyAreStarted) {
  CompositingCompiler compiler;
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Scene scene = randomLayers(random);
    for (const CompositingForm form : kForms) {
      const CompositingProgram& program = compiler.compile(scene.frame, form);
      ASSERT_TRUE(checkProgram(program.steps, scene.layers()));
      std::vector<bool> named(scene.layers(), false);
      for (std::size_t g = 0; g < scene.frame.groups(); ++g) {
        for (const CompositingStep& step : program.group(g)) {
          if (step.layer.valid()) {
            ASSERT_EQ(scene.groupOf(step.layer.value), g);
            named[step.layer.value] = true;
          }
        }
      }
      ASSERT_EQ(std::count(named.begin(), named.end(), true), static_cast<std::ptrdiff_t>(named.size()));
    }
  }
}

TEST(CompositingProgram, WithoutALayerShowsWhatAnEmptyImageInItsPlaceShows) {
  CompositingCompiler with, without;
  for (unsigned seed = 0; seed < 500; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Scene scene = randomLayers(random);
    std::vector<LayerId> left_out;
    for (std::size_t i = 0; i < scene.layers(); ++i) {
      if (random() % 3 == 0) {
        left_out.push_back(LayerId(i));
      }
    }
    for (const CompositingForm form : kForms) {
      const CompositingProgram& less = without.compile(scene.frame, form, left_out);
      const CompositingProgram& all = with.compile(scene.frame, form);
      ASSERT_LE(countSteps(less.steps).operations(), countSteps(all.steps).operations());
      for (const CompositingStep& step : less.steps) {
        ASSERT_EQ(std::count(left_out.begin(), left_out.end(), step.layer), 0);
      }
      for (int i = 0; i < 10; ++i) {
        auto cover = randomCover(scene, random);
        const auto fragments = randomFragments(cover, scene.layers(), random);
        auto emptied = fragments;
        for (const LayerId layer : left_out) {
          emptied[layer.value] = {};
        }
        const auto expected = composited(cover, emptied);
        ASSERT_NO_FATAL_FAILURE(expectClose(evaluatePixel(less, fragments), expected));
        ASSERT_NO_FATAL_FAILURE(expectClose(evaluatePixel(all, emptied), expected));
      }
    }
  }
}

TEST(CompositingProgram, OfARingWithoutOneLayerIsAChain) {
  const Scene scene = ring(5);
  CompositingCompiler compiler;
  const LayerId left_out[] = {LayerId(2u)};
  EXPECT_EQ(describe(compiler.compile(scene.frame, kSumOfOuts, left_out)),
            "start image 3\nover 4\nover 0\nover 1\n");
}

TEST(CompositingProgram, IsTheSameFromACompilerThatHasSeenOtherFrames) {
  CompositingCompiler used;
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const Scene scene = randomLayers(random);
    for (const CompositingForm form : kForms) {
      CompositingCompiler fresh;
      ASSERT_EQ(used.compile(scene.frame, form).steps, fresh.compile(scene.frame, form).steps);
    }
  }
}

TEST(CompositingProgram, OfAVeryLongRingNeedsNoDeepStack) {
  const std::uint32_t n = 100000;
  FrameLayers frame;
  frame.first_layer = {0, n};
  for (std::uint32_t i = 0; i <= n; ++i) {
    frame.first_part.push_back(i);
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    frame.parts.push_back(PartId(i));
    frame.occlusions.push_back({LayerId(i), LayerId((i + 1) % n)});
  }
  CompositingCompiler compiler;
  const CompositingCounts counts = countSteps(compiler.compile(frame).steps);
  EXPECT_EQ(counts.operations(), n + 2u);
}

TEST(CheckProgram, RefusesARegisterBeforeItIsStarted) {
  using enum CompositingOp;
  const LayerId layer(0u), none;
  const std::vector<std::vector<CompositingStep>> bad{
      {{kIn, layer}},
      {{kStartSum, none}, {kStartImage, none}},
      {{kAdd, layer}, {kStartImage, none}},
      {{kOver, layer}},
      {{kStartImage, none}},
      {{kLoad, layer}},
      {{kLoad, none}, {kStartImage, layer}},
      {{kStartImage, LayerId(1u)}},
      {{static_cast<CompositingOp>(7), layer}, {kStartImage, layer}},
  };
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_FALSE(checkProgram(bad[i], 1)) << i;
  }
  const std::vector<CompositingStep> good{{kStartSum, layer}, {kAdd, layer}, {kStartImage, none}};
  EXPECT_TRUE(checkProgram(good, 1));
  EXPECT_TRUE(checkProgram({}, 0));
}

}  // namespace
}  // namespace sightline
