#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <random>
#include <vector>

#include "sightline/layers/shaped_image.h"

namespace sightline {
namespace {

constexpr std::uint32_t kWidth = 37, kHeight = 11;
constexpr std::size_t kStride = 41;

using Pixels = std::vector<ShapedPixel>;

// A cycle of four layers with a chord, a single layer, and a cycle of three layers.
FrameLayers someLayers() {
  FrameLayers frame;
  frame.first_layer = {0, 4, 5, 8};
  for (std::uint32_t i = 0; i <= 8; ++i) {
    frame.first_part.push_back(i);
  }
  for (std::uint32_t i = 0; i < 8; ++i) {
    frame.parts.push_back(PartId(i));
  }
  for (const auto& [front, back] : std::vector<std::pair<std::uint32_t, std::uint32_t>>{
           {0, 1}, {0, 2}, {1, 2}, {2, 3}, {3, 0}, {5, 6}, {6, 7}, {7, 5}}) {
    frame.occlusions.push_back({LayerId(front), LayerId(back)});
  }
  return frame;
}

Pixels randomPixels(std::mt19937& random, std::size_t count) {
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  Pixels pixels(count);
  for (ShapedPixel& p : pixels) {
    p.alpha = random() % 3 == 0 ? static_cast<float>(random() % 2) : unit(random);
    p.red = p.alpha * unit(random);
    p.green = p.alpha * unit(random);
    p.blue = p.alpha * unit(random);
  }
  return pixels;
}

struct Fixture {
  std::mt19937 random{7};
  CompositingCompiler compiler;
  CompositingProgram program;
  std::vector<Pixels> pixels;
  std::vector<ShapedImage> images;

  explicit Fixture(CompositingForm form) : program(compiler.compile(someLayers(), form)) {
    for (std::size_t i = 0; i < program.layers; ++i) {
      pixels.push_back(randomPixels(random, kStride * kHeight));
    }
    for (const Pixels& p : pixels) {
      images.push_back({.pixels = p.data(), .width = kWidth, .height = kHeight, .stride = kStride});
    }
  }
  Pixels evaluated(std::size_t scratch_size) const {
    Pixels result(kStride * kHeight, ShapedPixel{9, 9, 9, 9});
    Pixels scratch(scratch_size, ShapedPixel{5, 5, 5, 5});
    EXPECT_TRUE(evaluate(program, images, {result.data(), kWidth, kHeight, kStride}, scratch));
    return result;
  }
};

bool sameBits(const ShapedPixel& a, const ShapedPixel& b) {
  return std::memcmp(&a, &b, sizeof(ShapedPixel)) == 0;
}

constexpr CompositingForm kAllForms[] = {CompositingForm::kSumOfOuts, CompositingForm::kOverAtop,
                                         CompositingForm::kCheapest};

TEST(Evaluate, GivesTheBitsOfASinglePixelWhateverTheScratch) {
  for (const CompositingForm form : kAllForms) {
    const Fixture f(form);
    for (const std::size_t scratch :
         {std::size_t{2}, std::size_t{3}, std::size_t{16}, std::size_t{26}, kCompositingScratch}) {
      const Pixels result = f.evaluated(scratch);
      for (std::size_t i = 0; i < result.size(); ++i) {
        Pixels layers;
        for (const Pixels& p : f.pixels) {
          layers.push_back(p[i]);
        }
        const bool between_rows = i % kStride >= kWidth;
        const ShapedPixel expected =
            between_rows ? ShapedPixel{9, 9, 9, 9} : evaluatePixel(f.program, layers);
        ASSERT_TRUE(sameBits(result[i], expected)) << "pixel " << i << ", scratch " << scratch;
      }
    }
  }
}

// Runs each operation by its definition, in the same precision and order.
TEST(Evaluate, DoesEachOperationAsDefinedOnLayersAndRegisters) {
  using enum CompositingOp;
  const ShapedPixel a{0.3f, 0.1f, 0.2f, 0.5f}, b{0.25f, 0.5f, 0.0f, 0.75f}, c{0.125f, 0.0f, 0.25f, 0.25f};
  const Pixels layers{a, b, c};
  const LayerId la(0u), lb(1u), lc(2u), reg;
  const auto run = [&](std::vector<CompositingStep> steps) {
    CompositingProgram program{.steps = std::move(steps), .first_of = {}, .layers = 3};
    EXPECT_TRUE(checkProgram(program.steps, 3));
    return evaluatePixel(program, layers);
  };
  EXPECT_EQ(run({{kStartImage, lb}}), b);
  EXPECT_EQ(run({{kLoad, lb}, {kIn, la}, {kStartSum, reg}, {kStartImage, reg}}),
            (ShapedPixel{0.125f, 0.25f, 0.0f, 0.375f}));
  EXPECT_EQ(run({{kLoad, lb}, {kOut, lc}, {kStartSum, reg}, {kStartImage, reg}}),
            (ShapedPixel{0.1875f, 0.375f, 0.0f, 0.5625f}));
  EXPECT_EQ(run({{kStartSum, lb}, {kAdd, lc}, {kStartImage, reg}}), (ShapedPixel{0.375f, 0.5f, 0.25f, 1.0f}));
  EXPECT_EQ(run({{kLoad, lc}, {kStartSum, lb}, {kAdd, reg}, {kStartImage, reg}}),
            (ShapedPixel{0.375f, 0.5f, 0.25f, 1.0f}));
  EXPECT_EQ(run({{kStartImage, lb}, {kOver, lc}}), (ShapedPixel{0.28125f, 0.5f, 0.0625f, 0.8125f}));
  EXPECT_EQ(run({{kStartSum, lc}, {kStartImage, lb}, {kOver, reg}}),
            (ShapedPixel{0.28125f, 0.5f, 0.0625f, 0.8125f}));
}

TEST(Evaluate, TakesAnImageWithoutPixelsForATransparentOne) {
  for (const CompositingForm form : kAllForms) {
    for (std::size_t missing = 0; missing < 8; ++missing) {
      Fixture f(form);
      f.images[missing].pixels = nullptr;
      f.images[missing].width = 3;  // the size of an image without pixels is ignored
      const Pixels without = f.evaluated(kCompositingScratch);
      const Pixels empty(kStride * kHeight);
      f.images[missing] = {empty.data(), kWidth, kHeight, kStride};
      const Pixels with = f.evaluated(kCompositingScratch);
      for (std::size_t i = 0; i < with.size(); ++i) {
        ASSERT_EQ(without[i], with[i]) << "layer " << missing << ", pixel " << i;
      }
    }
  }
}

TEST(Evaluate, OfAnEmptyProgramClearsTheTarget) {
  Pixels result(kStride * kHeight, ShapedPixel{9, 9, 9, 9}), scratch(10);
  ASSERT_TRUE(evaluate({}, {}, {result.data(), kWidth, kHeight, kStride}, scratch));
  for (std::size_t i = 0; i < result.size(); ++i) {
    ASSERT_EQ(result[i].alpha, i % kStride < kWidth ? 0.0f : 9.0f);
  }
}

TEST(Evaluate, OfATargetWithoutPixelsDoesNothing) {
  Pixels scratch(10);
  EXPECT_TRUE(evaluate({}, {}, {}, scratch));
}

TEST(Evaluate, RefusesWhatDoesNotFitAndLeavesTheTarget) {
  const auto refused = [&](auto change) {
    Fixture f(CompositingForm::kCheapest);
    Pixels result(kStride * kHeight, ShapedPixel{9, 9, 9, 9}), scratch(64);
    ShapedTarget target{result.data(), kWidth, kHeight, kStride};
    std::span<ShapedPixel> registers = scratch;
    change(f, target, registers);
    return !evaluate(f.program, f.images, target, registers) &&
           std::all_of(result.begin(), result.end(), [](const ShapedPixel& p) { return p.red == 9.0f; });
  };
  EXPECT_FALSE(refused([](Fixture&, ShapedTarget&, auto&) {}));
  EXPECT_TRUE(refused([](Fixture& f, ShapedTarget&, auto&) { f.images.pop_back(); }));
  EXPECT_TRUE(refused([](Fixture& f, ShapedTarget&, auto&) { f.images[3].width = kWidth - 1; }));
  EXPECT_TRUE(refused([](Fixture& f, ShapedTarget&, auto&) { f.images[3].height = kHeight + 1; }));
  EXPECT_TRUE(refused([](Fixture& f, ShapedTarget&, auto&) { f.images[7].stride = kWidth - 1; }));
  EXPECT_TRUE(refused([](Fixture&, ShapedTarget& t, auto&) { t.stride = kWidth - 1; }));
  EXPECT_TRUE(refused([](Fixture&, ShapedTarget& t, auto&) { t.pixels = nullptr; }));
  EXPECT_TRUE(refused([](Fixture&, ShapedTarget&, auto& scratch) { scratch = scratch.first(1); }));
  EXPECT_TRUE(refused([](Fixture& f, ShapedTarget&, auto&) { f.program.steps[0].layer = LayerId(8u); }));
  EXPECT_TRUE(
      refused([](Fixture& f, ShapedTarget&, auto&) { f.program.steps.erase(f.program.steps.begin()); }));
}

}  // namespace
}  // namespace sightline
