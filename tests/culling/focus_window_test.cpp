#include "src/culling/focus_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <type_traits>
#include <utility>
#include <vector>

#include "tests/culling/edge_scene.h"

namespace sightline::culling {
namespace {

using occlusion::PixelRange;
using test::Random;

constexpr std::uint32_t kWidth = test::EdgeScene::kWidth, kHeight = test::EdgeScene::kHeight;
constexpr std::uint32_t kFine = 64;

View anyView(Random& random) {
  View view;
  view.eye = random.point(100.0);
  setOrientation(view, random.point(1.0), {0, 0, 1});
  view.tan_half_fovy = random.in(0.2, 1.2);
  view.orthographic = random.in(0, 3) < 1;
  view.ortho_height = random.in(1.0, 50.0);
  view.z_near = random.in(0.05, 1.0);
  view.z_far = 500.0;
  if (random.in(0, 2) < 1) {
    view.shift_x = random.in(-1.5, 1.5);
    view.shift_y = random.in(-1.5, 1.5);
  }
  return view;
}

PixelRange anyRange(Random& random) {
  const auto within = [&](double size) {
    return static_cast<std::uint16_t>(std::min(random.in(0, size), size - 1.0));
  };
  const std::uint16_t x[] = {within(kWidth), within(kWidth)}, y[] = {within(kHeight), within(kHeight)};
  return {std::min(x[0], x[1]), std::min(y[0], y[1]), std::max(x[0], x[1]), std::max(y[0], y[1])};
}

FocusWindow placed(const View& view, const PixelRange& range) {
  FocusWindow window;
  EXPECT_TRUE(window.place(view, kWidth, kHeight, range, kFine, kFine));
  return window;
}

TEST(FocusWindow, HasTheEyeTheAxesAndTheNearPlaneOfItsView) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const View view = anyView(random);
    const View window = placed(view, anyRange(random)).view();
    EXPECT_EQ(window.eye, view.eye);
    EXPECT_EQ(window.forward, view.forward);
    EXPECT_EQ(window.right, view.right);
    EXPECT_EQ(window.up, view.up);
    EXPECT_EQ(window.z_near, view.z_near);
    EXPECT_EQ(window.z_far, view.z_far);
    EXPECT_TRUE(validate(window).has_value());
  }
}

// Each point of a coarse pixel, its corners and edges too, lies in the finer pixels that are said to be its.
TEST(FocusWindow, FindsTheFinerPixelsOfEachPointOfAPixel) {
  Random random(2);
  std::size_t beside = 0;
  for (int i = 0; i < 2000; ++i) {
    const View view = anyView(random);
    const FocusWindow window = placed(view, anyRange(random));
    const PixelRange& range = window.range();
    const BufferPixel pixel{static_cast<std::uint16_t>(std::floor(random.in(range.x0, range.x1 + 0.99))),
                            static_cast<std::uint16_t>(std::floor(random.in(range.y0, range.y1 + 0.99)))};
    ASSERT_TRUE(window.contains(pixel));
    const PixelRange fine = window.finePixels(pixel);
    const scene::PixelView coarse_view(view, kWidth, kHeight), fine_view(window.view(), kFine, kFine);
    for (int k = 0; k < 8; ++k) {
      const double x = pixel.x + (k < 4 ? k & 1 : random.in(0, 1));
      const double y = pixel.y + (k < 4 ? k >> 1 : random.in(0, 1));
      const double depth = random.in(0.1, 100.0), scale = view.orthographic ? 1.0 : depth;
      const Vec3d c((x - coarse_view.middle_x) / coarse_view.scale_x * scale,
                    (y - coarse_view.middle_y) / coarse_view.scale_y * scale, depth);
      const double fine_x = fine_view.pixelX(c), fine_y = fine_view.pixelY(c);
      EXPECT_GE(fine_x, fine.x0 - 1e-9);
      EXPECT_LE(fine_x, fine.x1 + 1.0 + 1e-9);
      EXPECT_GE(fine_y, fine.y0 - 1e-9);
      EXPECT_LE(fine_y, fine.y1 + 1.0 + 1e-9);
    }
    // No more than one beside what it covers.
    const double across = kFine / (range.x1 + 1.0 - range.x0);
    beside += fine.x1 + 1 - fine.x0 > across + 3.0 ? 1 : 0;
  }
  EXPECT_EQ(beside, 0u);
}

// Where borders of coarse and finer pixels coincide, a point on such a border lies in the pixels on both
// sides.
TEST(FocusWindow, CountsFinerPixelsBeyondTheBordersOfAPixel) {
  const FocusWindow window = placed(test::EdgeScene().view, {152, 82, 167, 97});
  EXPECT_EQ(window.finePixels({153, 84}), (PixelRange{3, 7, 8, 12}));
  EXPECT_EQ(window.finePixels({152, 82}), (PixelRange{0, 0, 4, 4})) << "but none beyond the window";
  EXPECT_EQ(window.finePixels({167, 97}), (PixelRange{59, 59, 63, 63}));
}

TEST(FocusWindow, IsNotPlacedWhereNoViewIsSoFarOffCentre) {
  Random random(3);
  View view = anyView(random);
  view.shift_x = View::kMaxShift;
  FocusWindow window;
  EXPECT_FALSE(window.place(view, kWidth, kHeight, {4, 4, 7, 7}, kFine, kFine));
  view.shift_x = 0.0;
  EXPECT_TRUE(window.place(view, kWidth, kHeight, {4, 4, 7, 7}, kFine, kFine));
}

TEST(FocusWindow, HidesNothingBeforeABufferIsDrawn) {
  Random random(4);
  View view = anyView(random);
  const FocusWindow window = placed(view, {0, 0, kWidth - 1, kHeight - 1});
  std::vector<PixelRange> scratch;
  const BufferPixel pixel{3, 3};
  const Vec3f ahead(view.eye + view.forward * 20.0);
  EXPECT_FALSE(window.hides({ahead, ahead}, {&pixel, 1}, scratch));
}

// A wall covers the left part of the picture, up to the middle of a column of pixels.
class Edge {
 public:
  static constexpr double kEdge = 160.5;  // pixels

  explicit Edge(bool orthographic) : scene_(orthographic) {
    const std::vector<test::OraclePolygon> walls{scene_.wallBetween(-100.0, kEdge)};
    const OccluderSet set = test::setOf(walls);
    coarse_.build(scene_.view, set, test::all(set));
    window_ = placed(scene_.view, {152, 82, 167, 97});
    Rasteriser raster({.width = kFine, .height = kFine});
    raster.begin(window_.view());
    raster.draw(set, test::all(set));
    window_.take(raster.depthBuffer());
  }

  // A box behind the wall that ends so many pixels to the right of its edge.
  Box boxEnding(double pixels, double bottom = 90.2, double top = 90.8) const {
    return scene_.boxBetween(kEdge + pixels - 0.4, kEdge + pixels, bottom, top);
  }
  std::vector<BufferPixel> openPixels(const Box& box) const {
    std::vector<BufferPixel> pixels;
    std::uint32_t count = 0;
    coarse_.openPixels({&box, 1}, 24, {&count, 1}, pixels);
    return pixels;
  }
  bool windowHides(const Box& box, std::span<const BufferPixel> pixels) const {
    std::vector<PixelRange> scratch;
    return window_.hides(box, pixels, scratch);
  }
  const FocusWindow& window() const { return window_; }
  FocusWindow takeWindow() { return std::move(window_); }

 private:
  test::EdgeScene scene_;
  DepthPyramid coarse_{{.raster = {.width = kWidth, .height = kHeight}}};
  FocusWindow window_;
};

TEST(FocusWindow, HidesABoxWhereACoarsePixelIsHalfCovered) {
  for (const bool orthographic : {false, true}) {
    const Edge edge(orthographic);
    const Box box = edge.boxEnding(-0.3);
    const std::vector<BufferPixel> pixels = edge.openPixels(box);
    ASSERT_EQ(pixels.size(), 1u) << orthographic;
    EXPECT_EQ(pixels[0], (BufferPixel{160, 90}));
    EXPECT_TRUE(edge.windowHides(box, pixels)) << orthographic;
  }
}

TEST(FocusWindow, HidesNoBoxThatShowsByAThousandthOfAPixelOrTouchesTheEdge) {
  for (const bool orthographic : {false, true}) {
    const Edge edge(orthographic);
    for (const double pixels : {0.0, 0.001, 0.01, 0.3}) {
      const Box box = edge.boxEnding(pixels);
      EXPECT_FALSE(edge.windowHides(box, edge.openPixels(box))) << orthographic << " " << pixels;
    }
  }
}

// The first and the last rows of the window, and a box that ends exactly where the window does.
TEST(FocusWindow, JudgesBoxesAtItsBorders) {
  const Edge edge(false);
  for (const auto& [bottom, top] : {std::pair(82.0, 82.6), std::pair(97.4, 98.0), std::pair(82.2, 97.8)}) {
    const Box behind = edge.boxEnding(-0.3, bottom, top), before = edge.boxEnding(0.001, bottom, top);
    const auto inWindow = [&](std::vector<BufferPixel> pixels) {
      std::erase_if(pixels, [&](const BufferPixel& pixel) { return !edge.window().contains(pixel); });
      return pixels;
    };
    EXPECT_TRUE(edge.windowHides(behind, inWindow(edge.openPixels(behind)))) << bottom;
    EXPECT_FALSE(edge.windowHides(before, inWindow(edge.openPixels(before)))) << bottom;
  }
}

static_assert(!std::is_copy_constructible_v<FocusWindow> && !std::is_copy_assignable_v<FocusWindow>);

TEST(FocusWindow, HidesTheSameAfterItWasMoved) {
  Edge edge(false);
  const Box behind = edge.boxEnding(-0.3), before = edge.boxEnding(0.001);
  const std::vector<BufferPixel> open_behind = edge.openPixels(behind), open_before = edge.openPixels(before);
  std::vector<FocusWindow> windows;
  windows.push_back(edge.takeWindow());
  windows.resize(20);
  std::vector<PixelRange> scratch;
  EXPECT_TRUE(windows[0].hides(behind, open_behind, scratch));
  EXPECT_FALSE(windows[0].hides(before, open_before, scratch));
}

}  // namespace
}  // namespace sightline::culling
