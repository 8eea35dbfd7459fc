#include "src/culling/focus_window.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <thread>
#include <utility>
#include <vector>

#include "oracle/exact_visibility.h"
#include "src/culling/doubt_memory.h"
#include "src/culling/focus_budget.h"
#include "src/culling/focus_choice.h"
#include "tests/culling/demo_frames.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/solids.h"

namespace sightline::culling {
namespace {

using test::Random;

constexpr std::uint32_t kWidth = 320, kHeight = 180;
constexpr std::uint32_t kFine = 64;

View anyView(Random& random) {
  View view;
  view.eye = random.point(100.0);
  setOrientation(view, random.point(1.0), {0, 0, 1});
  view.tan_half_fovy = random.in(0.2, 1.2);
  view.orthographic = random.in(0, 3) < 1;
  view.ortho_height = random.in(1.0, 50.0);
  view.near = random.in(0.05, 1.0);
  view.far = 500.0;
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
    EXPECT_EQ(window.near, view.near);
    EXPECT_EQ(window.far, view.far);
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
    const PixelView coarse_view(view, kWidth, kHeight), fine_view(window.view(), kFine, kFine);
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

TEST(FocusWindow, IsNotPlacedWhereNoViewIsSoFarOffCentre) {
  Random random(3);
  View view = anyView(random);
  view.shift_x = View::kLargestShift;
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

// A wall covers the left part of the picture, up to a pixel's middle: a coarse buffer cannot tell whether a
// box behind it shows there, a finer one can.
class Edge {
 public:
  static constexpr double kEdge = 160.5;  // pixels

  explicit Edge(bool orthographic) {
    view_ = test::viewFrom({0, 0, 0}, {0, 0, -1});
    view_.aspect = double{kWidth} / kHeight;
    view_.orthographic = orthographic;
    view_.ortho_height = 20.0;
    const double x = at(kEdge, 10.0);
    walls_ = {{{Vec3f(-100, -100, -10), Vec3f(Vec3d(x, -100, -10)), Vec3f(Vec3d(x, 100, -10)),
                Vec3f(-100, 100, -10)},
               true}};
    const OccluderSet set = test::setOf(walls_);
    coarse_.build(view_, set, test::all(set));
    window_ = placed(view_, {152, 82, 167, 97});
    Rasteriser raster({.width = kFine, .height = kFine});
    raster.begin(window_.view());
    raster.draw(set, test::all(set));
    window_.take(raster.depthBuffer());
  }

  // A box behind the wall that ends so many pixels to the right of its edge.
  Box boxEnding(double pixels, double bottom = 90.2, double top = 90.8) const {
    const PixelView buffer(view_, kWidth, kHeight);
    const double depth = 20.0, scale = view_.orthographic ? 1.0 : depth;
    const auto y = [&](double pixel) { return (pixel - buffer.middle_y) / buffer.scale_y * scale; };
    const double x = at(kEdge + pixels, depth);
    return {Vec3f(Vec3d(x - 0.4 * scale / buffer.scale_x, y(bottom), -depth)),
            Vec3f(Vec3d(x, y(top), -depth))};
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

 private:
  // The x coordinate, metres, of a column of the picture at a depth.
  double at(double pixel, double depth) const {
    const PixelView buffer(view_, kWidth, kHeight);
    return (pixel - buffer.middle_x) / buffer.scale_x * (view_.orthographic ? 1.0 : depth);
  }

  View view_;
  std::vector<test::OraclePolygon> walls_;
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

TEST(FocusChoice, FindsThePlacesOfTheGreatestWeightsOneAfterTheOther) {
  FocusChoice choice(kWidth, kHeight, 16, 16);
  choice.begin();
  const BufferPixel few{20, 20};
  const std::vector<BufferPixel> many{{300, 170}, {301, 171}, {302, 169}};
  choice.add({&few, 1}, 100);
  choice.add(many, 300);
  PixelRange range;
  ASSERT_EQ(choice.next(50.0, range), 300u);
  for (const BufferPixel& pixel : many) {
    EXPECT_TRUE(pixel.x >= range.x0 && pixel.x <= range.x1 && pixel.y >= range.y0 && pixel.y <= range.y1);
  }
  EXPECT_LT(range.x1, kWidth);
  EXPECT_LT(range.y1, kHeight);
  ASSERT_EQ(choice.next(50.0, range), 100u);
  EXPECT_TRUE(few.x >= range.x0 && few.x <= range.x1 && few.y >= range.y0 && few.y <= range.y1);
  EXPECT_EQ(choice.next(0.0, range), 0u) << "all weights have been taken";
  choice.begin();
  choice.add({&few, 1}, 100);
  EXPECT_EQ(choice.next(101.0, range), 0u);
  EXPECT_EQ(choice.next(100.0, range), 100u);
}

TEST(FocusChoice, StaysInBuffersOfAnySize) {
  Random random(5);
  for (const std::uint32_t width : {1u, 3u, 16u, 17u, 100u, 8192u}) {
    for (const std::uint32_t height : {1u, 5u, 16u, 90u}) {
      FocusChoice choice(width, height, 16, 16);
      choice.begin();
      const BufferPixel last{static_cast<std::uint16_t>(width - 1), static_cast<std::uint16_t>(height - 1)};
      choice.add({&last, 1}, 5);
      PixelRange range;
      ASSERT_EQ(choice.next(5.0, range), 5u) << width << " x " << height;
      EXPECT_EQ(range.x1 + 1u, width);
      EXPECT_EQ(range.y1 + 1u, height);
      EXPECT_LE(range.x0, range.x1);
      EXPECT_LE(range.y0, range.y1);
    }
  }
}

TEST(DoubtMemory, LetsWhatCouldBeSeenRestLongerEachTime) {
  DoubtMemory memory(1);
  const ObjectId object(std::uint32_t{0});
  std::uint32_t last = 0, last_chance = memory.chance(object);
  for (int time = 0; time < 6; ++time) {
    memory.seen(object);
    std::uint32_t views = 0;
    while (memory.rests(object)) {
      memory.beginView();
      ++views;
    }
    EXPECT_GE(views, last);
    EXPECT_LE(memory.chance(object), last_chance);
    EXPECT_LT(views, 200u);
    last = views;
    last_chance = memory.chance(object);
  }
  memory.hidden(object);
  EXPECT_FALSE(memory.rests(object));
  EXPECT_EQ(memory.chance(object), DoubtMemory::kCertain);
}

TEST(DoubtMemory, LetsNothingRestThatWasNeverLookedAt) {
  DoubtMemory memory(2);
  memory.seen(ObjectId(std::uint32_t{0}));
  for (int view = 0; view < 70'000; ++view) {
    memory.beginView();
    EXPECT_FALSE(memory.rests(ObjectId(std::uint32_t{1}))) << view;
  }
}

TEST(FocusBudget, AsksForMoreObjectsWhereTheyAreCheapOrWindowsAreDear) {
  FocusBudget dear(2.0), cheap(2.0), never(0.0);
  dear.view(1000.0, 10.0);
  cheap.view(1000.0, 100.0);
  never.view(1000.0, 10.0);
  EXPECT_LT(dear.minObjects(), cheap.minObjects());
  EXPECT_GT(never.minObjects(), 1e9);
  const double before = cheap.minObjects();
  cheap.drawn(100'000.0);
  EXPECT_GT(cheap.minObjects(), before);
  EXPECT_LT(cheap.left(), 0.0);
  for (int view = 0; view < 1000; ++view) {
    cheap.view(1000.0, 100.0);
    cheap.idle();
  }
  EXPECT_NEAR(cheap.minObjects(), before, 1.0) << "what windows cost is forgotten";
  EXPECT_GT(cheap.left(), 0.0);
}

// A street with blocks along it, walls that cross the near plane, and small boxes at its far end, all
// objects.
struct Street {
  std::vector<test::OraclePolygon> polygons;
  std::vector<Box> bounds;
  OccluderSet occluders;
  Hierarchy hierarchy;
  std::vector<View> views;
  std::size_t first_small = 0;

  explicit Street(std::uint64_t seed) {
    Random random(seed);
    std::vector<ObjectId> owners;
    for (int i = 0; i < 14; ++i) {
      const double side = i % 2 == 0 ? 1.0 : -1.0, z = -6.0 - 5.0 * i;
      const double x = side * random.in(1.5, 3.5), width = random.in(2.0, 5.0);
      addBlock({Vec3f(Vec3d(std::min(x, x + side * width), -2, z - random.in(2.0, 6.0))),
                Vec3f(Vec3d(std::max(x, x + side * width), random.in(2.0, 9.0), z))},
               owners);
    }
    addBlock({Vec3f(-3, -2, -90), Vec3f(3, static_cast<float>(random.in(0.5, 2.0)), -88)}, owners);
    for (int i = 0; i < 3; ++i) {
      addWallAcrossTheNearPlane(random, owners);
    }
    first_small = bounds.size();
    for (int i = 0; i < 250; ++i) {
      const Vec3d middle(random.in(-8, 8), random.in(-2, 4), random.in(-130, -20));
      const Vec3d half = Vec3d(0.05, 0.05, 0.05) + abs(random.point(0.4));
      bounds.push_back({Vec3f(middle - half), Vec3f(middle + half)});
    }
    std::vector<OccluderPolygon> input;
    for (std::size_t i = 0; i < polygons.size(); ++i) {
      input.push_back({polygons[i].vertices, polygons[i].double_sided, owners[i]});
    }
    occluders = makeOccluders(input);
    hierarchy = buildHierarchy(bounds, {});
    for (int frame = 0; frame < 6; ++frame) {
      View view = test::viewFrom({random.in(-0.2, 0.2), random.in(-0.2, 0.2), -0.3 * frame},
                                 {random.in(-0.1, 0.1), random.in(-0.05, 0.05), -1.0});
      view.near = 1.0;
      views.push_back(view);
    }
  }

 private:
  void addBlock(const Box& box, std::vector<ObjectId>& owners) {
    const test::Solid solid = test::block(box.min, box.max);
    for (std::size_t face = 0; face < solid.faces.size(); ++face) {
      polygons.push_back({solid.polygon(face), false});
      owners.push_back(ObjectId(bounds.size()));
    }
    bounds.push_back(box);
  }
  // Geometry in front of the near plane is not drawn: objects behind it are visible.
  void addWallAcrossTheNearPlane(Random& random, std::vector<ObjectId>& owners) {
    const double x = random.in(-0.4, 0.4), y = random.in(-0.6, 0.0), high = y + random.in(0.1, 0.5);
    const double from = random.in(0.2, 0.9), to = random.in(1.5, 6.0), lean = random.in(-0.8, 0.8);
    const std::vector<Vec3f> corners{Vec3f(Vec3d(x, y, -from)), Vec3f(Vec3d(x + lean, y, -to)),
                                     Vec3f(Vec3d(x + lean, high, -to)), Vec3f(Vec3d(x, high, -from))};
    polygons.push_back({corners, true});
    owners.push_back(ObjectId(bounds.size()));
    Box box;
    for (const Vec3f& corner : corners) {
      box.extend(corner);
    }
    bounds.push_back(box);
  }
};

bool kept(const AnyCuller& culler, std::size_t object) {
  return std::binary_search(culler.visible().begin(), culler.visible().end(), ObjectId(object));
}

// Whether rays reach a small box of the street.
bool seen(const Street& street, std::size_t object, const View& view) {
  std::mt19937_64 random(object);
  const std::span<const test::OraclePolygon> polygons(street.polygons);
  return test::lookAt(street.bounds[object], view, polygons, 400, random).seen;
}

AnySettings focused(bool coherent) {
  AnySettings settings{.method = AnyMethod::kDepthPyramid, .focus = {.worth = 1e9}};
  settings.raster = {.width = 96, .height = 96};  // coarse, so that it leaks
  settings.temporal_coherence = coherent;
  return settings;
}

TEST(FocusedCuller, CullsNothingThatARayReachesThoughWallsCrossTheNearPlane) {
  std::size_t focused_frames = 0, judged = 0, more = 0;
  for (std::uint64_t seed = 0; seed < 16; ++seed) {
    const Street street(seed);
    AnySettings settings = focused(seed % 2 == 0);
    AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
    settings.focus.magnification = 1.0;
    AnyCuller without(street.hierarchy, street.bounds, street.occluders, settings);
    for (std::size_t frame = 0; frame < street.views.size(); ++frame) {
      const View& view = street.views[frame];
      culler.cull(view);
      without.cull(view);
      focused_frames += culler.statistic("map", "focused");
      EXPECT_EQ(without.statistic("map", "focused"), 0u);
      for (std::size_t i = 0; i < street.bounds.size(); ++i) {
        if (kept(culler, i)) {
          continue;
        }
        ++judged;
        more += kept(without, i) ? 1 : 0;
        std::mt19937_64 random(i);
        // The polygons of an occluding object would block rays to itself.
        const std::span<const test::OraclePolygon> polygons(street.polygons);
        const test::Sight sight = i < street.first_small ? test::Sight{}
                                                         : test::lookAt(street.bounds[i], view, polygons,
                                                                        kept(without, i) ? 400 : 20, random);
        EXPECT_FALSE(sight.seen) << "seed " << seed << ", frame " << frame << ", object " << i << " at "
                                 << sight.point.x << " " << sight.point.y << " " << sight.point.z;
      }
    }
  }
  EXPECT_GT(focused_frames, 60u);
  EXPECT_GT(judged, 5'000u);
  EXPECT_GT(more, 40u) << "hidden by the window's map alone";
}

TEST(FocusedCuller, HasAtMostAsManyWindowsAsItIsToldAndNoneWithoutMagnification) {
  const Street street(3);
  for (const std::uint32_t windows : {0u, 1u, 2u, kMaxFocusWindows, 1'000'000u}) {
    AnySettings settings = focused(false);
    settings.focus.windows = windows;
    AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
    std::uint64_t most = 0;
    for (const View& view : street.views) {
      culler.cull(view);
      most = std::max(most, culler.statistic("map", "focused"));
    }
    EXPECT_LE(most, windows);
    EXPECT_EQ(most > 0, windows > 0);
  }
  for (const double magnification : {1.0, 0.5, 0.0, -3.0, std::numeric_limits<double>::quiet_NaN()}) {
    AnySettings settings = focused(false);
    settings.focus.magnification = magnification;
    AnyCuller other(street.hierarchy, street.bounds, street.occluders, settings);
    for (int frame = 0; frame < 3; ++frame) {
      other.cull(street.views[0]);
      EXPECT_EQ(other.statistic("map", "focused"), 0u) << magnification;
    }
  }
}

TEST(FocusedCuller, DrawsNoWindowThatDoesNotPay) {
  const Street street(3);
  for (const double worth : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    AnySettings settings = focused(false);
    settings.focus.worth = worth;
    AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
    for (const View& view : street.views) {
      culler.cull(view);
      EXPECT_EQ(culler.statistic("map", "focused"), 0u) << worth;
    }
  }
}

TEST(FocusedCuller, GivesTheSameAnswersWithAbsurdSettings) {
  const Street street(5);
  AnySettings without = focused(false);
  without.focus.windows = 0;
  for (const double magnification : {1.0001, 1e3, 1e9, 1e300, std::numeric_limits<double>::infinity()}) {
    AnySettings settings = focused(false);
    settings.focus.magnification = magnification;
    AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
    AnyCuller plain(street.hierarchy, street.bounds, street.occluders, without);
    for (const View& view : street.views) {
      culler.cull(view);
      plain.cull(view);
      for (const ObjectId object : culler.visible()) {
        EXPECT_TRUE(kept(plain, object.value)) << magnification;
      }
    }
  }
}

TEST(FocusedCuller, HidesObjectsInTheFirstFrameAndInOrthographicViews) {
  std::uint64_t hidden_first = 0, hidden_orthographic = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    const Street street(seed);
    AnyCuller first(street.hierarchy, street.bounds, street.occluders, focused(false));
    first.cull(street.views[0]);
    hidden_first += first.statistic("map", "focus_hidden");
    AnyCuller orthographic(street.hierarchy, street.bounds, street.occluders, focused(false));
    for (View view : street.views) {
      view.orthographic = true;
      for (const double height : {6.0, 20.0, 60.0}) {
        view.ortho_height = height;
        orthographic.cull(view);
        hidden_orthographic += orthographic.statistic("map", "focus_hidden");
      }
    }
  }
  EXPECT_GT(hidden_first, 0u);
  EXPECT_GT(hidden_orthographic, 0u);
}

// Boxes that move are tested by the windows too.
TEST(FocusedCuller, HidesMovingBoxesWhereItHidesObjects) {
  const Street street(3);
  AnySettings settings = focused(false);
  AnyCuller culler(street.hierarchy, street.bounds, street.occluders, settings);
  settings.focus.windows = 0;
  AnyCuller without(street.hierarchy, street.bounds, street.occluders, settings);
  std::size_t by_windows = 0;
  for (const View& view : street.views) {
    culler.cull(view, street.bounds);
    without.cull(view, street.bounds);
    for (std::size_t i = 0; i < street.bounds.size(); ++i) {
      if (culler.dynamicStates()[i] == Visibility::kHidden &&
          without.dynamicStates()[i] != Visibility::kHidden) {
        ++by_windows;
        EXPECT_FALSE(i >= street.first_small && seen(street, i, view)) << i;
      }
    }
  }
  EXPECT_GT(by_windows, 0u);
}

TEST(FocusedCuller, GivesTheSameAnswersWithThreads) {
  const Street street(4);
  AnyCuller serial(street.hierarchy, street.bounds, street.occluders, focused(true));
  AnyCuller threaded(street.hierarchy, street.bounds, street.occluders, focused(true));
  threaded.setParallelFor([](std::uint32_t count, const RangeBody& body) {
    std::vector<std::thread> threads;
    for (std::uint32_t i = 0; i < count; ++i) {
      threads.emplace_back([&body, i] { body(i, i + 1); });
    }
    for (std::thread& thread : threads) {
      thread.join();
    }
  });
  std::uint64_t windows = 0;
  for (int round = 0; round < 3; ++round) {
    for (const View& view : street.views) {
      serial.cull(view);
      threaded.cull(view);
      windows += serial.statistic("map", "focused");
      EXPECT_TRUE(std::ranges::equal(serial.visible(), threaded.visible()));
      EXPECT_EQ(serial.statistic("map", "focused"), threaded.statistic("map", "focused"));
    }
  }
  EXPECT_GT(windows, 0u);
}

const demo_frames::DemoScene& boxCity() {
  static const demo_frames::DemoScene kCity(makeBoxCity({500, 2500, 1}));
  return kCity;
}

std::vector<View> smoothFrames(std::size_t first, std::size_t count) {
  for (const CameraPath& path : boxCity().scene.paths) {
    if (path.name == "smooth") {
      return boxCity().frames(path, first, count);
    }
  }
  return {};
}

AnySettings focusedCity(double magnification) {
  AnySettings settings{.method = AnyMethod::kDepthPyramid, .focus = {.worth = 1e9}};
  settings.focus.magnification = magnification;
  settings.temporal_coherence = false;
  return settings;
}

TEST(FocusedCuller, KeepsASubsetOfWhatIsKeptWithoutAWindow) {
  std::size_t fewer = 0;
  for (const std::size_t place : {0u, 100u, 200u, 300u}) {
    AnyCuller with = boxCity().culler(HierarchyKind::kBvh, focusedCity(8.0));
    AnyCuller without = boxCity().culler(HierarchyKind::kBvh, focusedCity(1.0));
    std::size_t frame = place;
    for (const View& view : smoothFrames(place, 20)) {
      with.cull(view);
      without.cull(view);
      for (const ObjectId object : with.visible()) {
        EXPECT_TRUE(kept(without, object.value)) << "frame " << frame << ", object " << object.value;
      }
      fewer += with.visible().size() < without.visible().size() ? 1 : 0;
      ++frame;
    }
  }
  EXPECT_GT(fewer, 0u);
}

TEST(FocusedCuller, CullsNothingThatIsSeenInTheBoxCity) {
  const ExactVisibility exact(boxCity().scene.view());
  AnyCuller culler = boxCity().culler(HierarchyKind::kBvh, focusedCity(8.0));
  AnyCuller frustum = boxCity().culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum});
  std::size_t seen = 0, culled = 0, focused_frames = 0;
  std::size_t frame = 0;
  for (const View& view : smoothFrames(0, 20)) {
    culler.cull(view);
    frustum.cull(view);
    focused_frames += culler.statistic("map", "focused");
    std::vector<ObjectId> hidden;
    for (const ObjectId object : frustum.visible()) {
      if (!kept(culler, object.value)) {
        hidden.push_back(object);
      }
    }
    culled += hidden.size();
    std::vector<Witness> witnesses = exact.visibleThroughPixels(view, 320, 180);
    seen += witnesses.size();
    const std::vector<Witness> aimed = exact.visibleByAimedRays(view, hidden, 12);
    witnesses.insert(witnesses.end(), aimed.begin(), aimed.end());
    for (const Witness& witness : witnesses) {
      if (!kept(culler, witness.object.value)) {
        EXPECT_FALSE(exact.confirm(view, witness))
            << "frame " << frame << ", object " << witness.object.value;
      }
    }
    ++frame;
  }
  EXPECT_GT(focused_frames, 15u);
  EXPECT_GT(seen, 500u);
  EXPECT_GT(culled, 2000u);
}

}  // namespace
}  // namespace sightline::culling
