#include "src/occlusion/boxes/depth_levels.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "src/occlusion/boxes/box_depth_test.h"
#include "tests/occlusion/random_views.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/rounds.h"

namespace sightline::occlusion {
namespace {

using test::randomBox, test::randomView, test::ViewRandom;

// A depth buffer with random values; pixels beyond its width are NaN.
struct TestBuffer {
  std::uint32_t width, height, stride;
  std::vector<float> reciprocal_depth;

  TestBuffer(std::uint32_t w, std::uint32_t h, std::uint32_t s)
      : width(w),
        height(h),
        stride(s),
        reciprocal_depth(std::size_t{s} * h, std::numeric_limits<float>::quiet_NaN()) {
    for (std::uint32_t y = 0; y < h; ++y) {
      std::fill_n(reciprocal_depth.begin() + static_cast<std::ptrdiff_t>(std::size_t{y} * s), w, kUncovered);
    }
  }
  float& at(std::uint32_t x, std::uint32_t y) { return reciprocal_depth[std::size_t{y} * stride + x]; }
  DepthBufferView view() const { return {reciprocal_depth, width, height, stride}; }
};

void forCutRanges(std::uint32_t count, const RangeBody& body) {
  // From the last to the first.
  for (std::uint32_t i = count; i > 0; --i) {
    body(i - 1, i);
  }
}

TEST(DepthLevels, HoldTheMinimumAndTheMaximumOfEachBlock) {
  const std::uint32_t sizes[][3] = {{1, 1, 1},    {7, 3, 9},       {8, 8, 8},      {9, 9, 16},  {64, 65, 64},
                                    {65, 9, 100}, {320, 180, 320}, {513, 40, 520}, {3, 700, 24}};
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  for (const auto& size : sizes) {
    ViewRandom random(size[0]);
    TestBuffer buffer(size[0], size[1], size[2]);
    for (std::uint32_t y = 0; y < buffer.height; ++y) {
      for (std::uint32_t x = 0; x < buffer.width; ++x) {
        buffer.at(x, y) = random.below(5) == 0 ? kUncovered : static_cast<float>(random.in(-3.0, 3.0));
      }
    }
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      DepthLevels levels;
      levels.build(buffer.view(), target == targets.front() ? ParallelFor(forCutRanges) : serialFor);
      const std::span<const DepthLevel> all = levels.levels();
      ASSERT_FALSE(all.empty());
      EXPECT_LE(std::max(all.back().width, all.back().height), kBlock);
      for (std::size_t k = 0; k < all.size(); ++k) {
        const std::uint32_t side = 1u << (kBlockShift * k);
        ASSERT_EQ(all[k].width, (buffer.width + side - 1) / side);
        ASSERT_EQ(all[k].height, (buffer.height + side - 1) / side);
        for (std::uint32_t y = 0; y < all[k].height; ++y) {
          for (std::uint32_t x = 0; x < all[k].width; ++x) {
            float min = INFINITY, max = -INFINITY;
            for (std::uint32_t j = y * side; j < std::min(buffer.height, (y + 1) * side); ++j) {
              for (std::uint32_t i = x * side; i < std::min(buffer.width, (x + 1) * side); ++i) {
                min = std::min(min, buffer.at(i, j));
                max = std::max(max, buffer.at(i, j));
              }
            }
            const std::size_t cell = std::size_t{y} * all[k].stride + x;
            ASSERT_EQ(all[k].min[cell], min) << hwy::TargetName(target) << " level " << k;
            ASSERT_EQ(all[k].max[cell], max) << hwy::TargetName(target) << " level " << k;
          }
        }
      }
    }
  }
}

// ---- Boxes, pixel by pixel

struct Place {
  double x, y;
};

// The image of a box by brute force: its hull from the corners, its depth from rays and planes.
class PlainBox {
 public:
  PlainBox(const scene::PixelView& view, const Box& box) : view_(view), box_(box) {
    for (unsigned corner = 0; corner < 8; ++corner) {
      Vec3d d;
      for (int axis = 0; axis < 3; ++axis) {
        d[axis] =
            static_cast<double>((corner >> axis & 1u) != 0 ? box.max[axis] : box.min[axis]) - view.eye[axis];
      }
      const Vec3d camera = view.toCamera(d);
      corners_.push_back({view.pixelX(camera), view.pixelY(camera)});
    }
    makeHull();
    makeAxes();
  }

  // How far the hull is from the square of a pixel, negative inside: the best separating axis, pixels.
  double distanceTo(std::uint32_t x, std::uint32_t y) const {
    double distance = -INFINITY;
    for (const Axis& axis : axes_) {
      const double square_max = axis.nx * x + axis.ny * y + std::max(axis.nx, 0.0) + std::max(axis.ny, 0.0);
      distance = std::max(distance, axis.hull_min - square_max);
    }
    return distance;
  }

  // Returns the minimum, over the visible faces, of the maximum reciprocal depth of the face's plane in the
  // pixel's square.
  double reciprocalDepthIn(std::uint32_t x, std::uint32_t y) const {
    double own = INFINITY;
    for (int axis = 0; axis < 3; ++axis) {
      const std::optional<double> face = seenFace(axis);
      if (!face) {
        continue;
      }
      double max = -INFINITY;
      for (unsigned i = 0; i < 4; ++i) {
        const double tx = (x + (i & 1u) - view_.middle_x) / view_.scale_x;
        const double ty = (y + (i >> 1) - view_.middle_y) / view_.scale_y;
        const Vec3d across = view_.right * tx + view_.up * ty;
        const double depth_or_inverse = view_.orthographic ? -(*face - across[axis]) / view_.forward[axis]
                                                           : (across + view_.forward)[axis] / *face;
        max = std::max(max, depth_or_inverse);
      }
      own = std::min(own, max);
    }
    return own;
  }

 private:
  // A unit vector along which the hull and a square may lie apart, and where the hull begins along it.
  struct Axis {
    double nx, ny, hull_min;
  };

  // Of one axis, its position relative to the eye.
  std::optional<double> seenFace(int axis) const {
    const double low = static_cast<double>(box_.min[axis]) - view_.eye[axis];
    const double high = static_cast<double>(box_.max[axis]) - view_.eye[axis];
    const double from = view_.orthographic ? -view_.forward[axis] : 0.0;
    if (view_.orthographic) {
      return from < 0.0 ? std::optional(low) : from > 0.0 ? std::optional(high) : std::nullopt;
    }
    return low > 0.0 ? std::optional(low) : high < 0.0 ? std::optional(high) : std::nullopt;
  }

  void makeHull() {
    std::vector<Place> p = corners_;
    std::sort(p.begin(), p.end(),
              [](const Place& a, const Place& b) { return a.x != b.x ? a.x < b.x : a.y < b.y; });
    const auto turn = [](const Place& a, const Place& b, const Place& c) {
      return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    };
    for (int pass = 0; pass < 2; ++pass) {
      const std::size_t begin = hull_.size();
      for (const Place& q : p) {
        while (hull_.size() >= begin + 2 && turn(hull_[hull_.size() - 2], hull_.back(), q) <= 0.0) {
          hull_.pop_back();
        }
        hull_.push_back(q);
      }
      hull_.pop_back();
      std::reverse(p.begin(), p.end());
    }
    if (hull_.empty()) {
      hull_.push_back(p[0]);
    }
  }

  void makeAxes() {
    for (const auto& [nx, ny] :
         {std::pair(1.0, 0.0), std::pair(-1.0, 0.0), std::pair(0.0, 1.0), std::pair(0.0, -1.0)}) {
      addAxis(nx, ny);
    }
    for (std::size_t i = 0; i < hull_.size(); ++i) {
      const Place &a = hull_[i], &b = hull_[(i + 1) % hull_.size()];
      addAxis(a.y - b.y, b.x - a.x);
      addAxis(b.y - a.y, a.x - b.x);
    }
  }
  void addAxis(double nx, double ny) {
    const double length = std::hypot(nx, ny);
    if (length == 0.0) {
      return;
    }
    Axis axis{nx / length, ny / length, INFINITY};
    for (const Place& p : hull_) {
      axis.hull_min = std::min(axis.hull_min, axis.nx * p.x + axis.ny * p.y);
    }
    axes_.push_back(axis);
  }

  const scene::PixelView& view_;
  Box box_;
  std::vector<Place> corners_, hull_;
  std::vector<Axis> axes_;
};

struct Bed {
  explicit Bed(std::uint64_t seed) : random(seed), buffer(1, 1, 1) {
    const std::uint32_t sizes[][3] = {
        {320, 180, 320}, {100, 70, 104}, {17, 23, 21}, {64, 64, 64}, {640, 24, 640}};
    const auto& size = sizes[random.below(5)];
    buffer = TestBuffer(size[0], size[1], size[2]);
    eye_view = randomView(random);
    view = scene::PixelView(eye_view, buffer.width, buffer.height);
    box = randomBox(random, eye_view);
    projectBoxes(view, buffer.width, buffer.height, {&box, 1}, {&image, 1});
  }
  // Rounding of the rectangle's and the outline's borders, pixels.
  double pixelTolerance() const {
    const double depth = view.orthographic ? 1.0 : 1.0 / image.nearest;
    const Vec3d farthest = max(abs(Vec3d(box.min) - view.eye), abs(Vec3d(box.max) - view.eye));
    const double in_rectangle =
        0x1p-19 * std::max(view.scale_x, view.scale_y) * maxComponent(farthest) / depth;
    return 1e-3 + 1e-5 * std::max(buffer.width, buffer.height) + 3.0 * in_rectangle * (1.0 + spread());
  }
  // The largest tangent of the view.
  double spread() const {
    return view.orthographic ? 0.0 : std::max(view.reachX() / view.scale_x, view.reachY() / view.scale_y);
  }
  BoxAnswer ask() const {
    DepthLevels levels;
    levels.build(buffer.view());
    BoxAnswer answer;
    testBoxes(levels.levels(), OutlineView(view), {&box, 1}, {&image, 1}, {&answer, 1});
    return answer;
  }

  ViewRandom random;
  TestBuffer buffer;
  View eye_view;
  scene::PixelView view;
  Box box;
  PixelBox image;
};

// What is known of one pixel of the box's rectangle by itself.
struct PlainPixel {
  double distance;  // from the hull, pixels
  double own;       // the box's reciprocal depth in it
};

// Draws into the buffer what is a little nearer than the box in every pixel that its outline intersects, and
// nothing (or something farther) elsewhere; then opens some pixels. Returns the pixels of the box's
// rectangle, row by row.
std::vector<PlainPixel> drawAround(Bed& bed, const PlainBox& plain, int opened) {
  std::vector<PlainPixel> pixels;
  const double tolerance = bed.pixelTolerance();
  const double range = std::abs(static_cast<double>(bed.image.nearest) - bed.image.farthest);
  const double ahead =
      bed.random.sized(1e-4, 0.3) * range + 1e-4 * std::abs(static_cast<double>(bed.image.nearest));
  for (std::uint32_t y = bed.image.y0; y <= bed.image.y1; ++y) {
    for (std::uint32_t x = bed.image.x0; x <= bed.image.x1; ++x) {
      const double own = std::min<double>(plain.reciprocalDepthIn(x, y), bed.image.nearest);
      pixels.push_back({plain.distanceTo(x, y), own});
      if (pixels.back().distance < tolerance) {
        bed.buffer.at(x, y) = static_cast<float>(own + ahead);
      }
    }
  }
  for (int i = 0; i < opened; ++i) {
    const auto x =
        bed.image.x0 + static_cast<std::uint32_t>(bed.random.below(bed.image.x1 - bed.image.x0 + 1u));
    const auto y =
        bed.image.y0 + static_cast<std::uint32_t>(bed.random.below(bed.image.y1 - bed.image.y0 + 1u));
    const double own = std::min<double>(plain.reciprocalDepthIn(x, y), bed.image.nearest);
    bed.buffer.at(x, y) = bed.random.below(2) == 0 ? kUncovered : static_cast<float>(own - ahead);
  }
  return pixels;
}

TEST(BoxDepthTest, AgreesWithEveryPixelTakenByItself) {
  int hidden = 0, refined = 0, open = 0, visible = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(6000u); ++seed) {
    Bed bed(seed);
    if (bed.image.place != BoxPlace::kOnBuffer) {
      EXPECT_EQ(bed.ask().visibility,
                bed.image.place == BoxPlace::kOutside ? Visibility::kHidden : Visibility::kPartial);
      continue;
    }
    const PlainBox plain(bed.view, bed.box);
    const std::vector<PlainPixel> pixels = drawAround(bed, plain, static_cast<int>(bed.random.below(3)));
    auto pixel = pixels.begin();
    bool surely_open = false, maybe_open = false, before = false, rectangle_hides = true;
    const double tolerance = bed.pixelTolerance();
    for (std::uint32_t y = bed.image.y0; y <= bed.image.y1; ++y) {
      for (std::uint32_t x = bed.image.x0; x <= bed.image.x1; ++x) {
        const double at = bed.buffer.at(x, y);
        const auto [distance, own] = *pixel++;
        const double slack = 2e-5 * std::abs(own);
        surely_open |= distance < -tolerance && at <= own - slack;
        maybe_open |= distance < tolerance && at <= own + slack;
        before |= at > bed.image.farthest;
        rectangle_hides &= at > bed.image.nearest;
      }
    }
    const Visibility answer = bed.ask().visibility;
    EXPECT_FALSE(surely_open && answer == Visibility::kHidden) << "seed " << seed;
    EXPECT_FALSE(!maybe_open && answer == Visibility::kPartial) << "seed " << seed;
    if (answer != Visibility::kHidden) {
      EXPECT_EQ(answer == Visibility::kVisible, !before) << "seed " << seed;
    }
    hidden += answer == Visibility::kHidden ? 1 : 0;
    refined += answer == Visibility::kHidden && !rectangle_hides ? 1 : 0;
    open += answer == Visibility::kPartial ? 1 : 0;
    visible += answer == Visibility::kVisible ? 1 : 0;
  }
  EXPECT_GT(hidden, test::rounds(500));
  EXPECT_GT(refined, test::rounds(300));
  EXPECT_GT(open, test::rounds(500));
  EXPECT_GT(visible, test::rounds(20));
}

// Checks the contract directly: a point of the box is hidden if the buffer is nearer than the point.
TEST(BoxDepthTest, NeverHidesAPointThatTheBufferIsNotInFrontOf) {
  int hidden = 0, points = 0;
  for (std::uint64_t seed = 1; seed <= test::rounds(3000u); ++seed) {
    Bed bed(seed);
    if (bed.image.place == BoxPlace::kOnBuffer) {
      const PlainBox plain(bed.view, bed.box);
      drawAround(bed, plain, seed % 3 == 0 ? 1 : 0);
    }
    if (bed.ask().visibility != Visibility::kHidden) {
      continue;
    }
    ++hidden;
    for (int i = 0; i < 200; ++i) {
      Vec3d p;
      for (int axis = 0; axis < 3; ++axis) {
        const double t =
            bed.random.below(3) == 0 ? static_cast<double>(bed.random.below(2)) : bed.random.in(0, 1);
        p[axis] = bed.box.min[axis] * (1.0 - t) + bed.box.max[axis] * t;
      }
      const Vec3d camera = bed.view.toCamera(p - bed.view.eye);
      const double x = camera.z > 0.0 || bed.view.orthographic ? bed.view.pixelX(camera) : -1.0;
      const double y = camera.z > 0.0 || bed.view.orthographic ? bed.view.pixelY(camera) : -1.0;
      const double margin = 1e-9 * bed.buffer.width;
      if (camera.z < bed.view.near || camera.z > bed.view.far ||
          !(x > margin && x < bed.buffer.width - margin) || !(y > margin && y < bed.buffer.height - margin)) {
        continue;
      }
      ++points;
      EXPECT_GT(bed.buffer.at(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y)),
                bed.view.reciprocalDepth(camera.z) - 1e-12)
          << "seed " << seed;
    }
  }
  EXPECT_GT(hidden, test::rounds(500));
  EXPECT_GT(points, test::rounds(20000));
}

TEST(BoxDepthTest, EveryInstructionSetAndEverySplitGiveTheSameAnswers) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  int hidden = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    Bed bed(seed);
    if (bed.image.place == BoxPlace::kOnBuffer) {
      drawAround(bed, PlainBox(bed.view, bed.box), static_cast<int>(seed % 2));
    }
    // Tests the box itself and parts of it, which are hidden more often.
    std::vector<Box> boxes{bed.box};
    for (int i = 0; i < 30; ++i) {
      boxes.push_back(randomBox(bed.random, bed.eye_view));
      Box part;
      for (int c = 0; c < 2; ++c) {
        Vec3f p;
        for (int axis = 0; axis < 3; ++axis) {
          p[axis] = static_cast<float>(bed.random.in(bed.box.min[axis], bed.box.max[axis]));
        }
        part.extend(p);
      }
      boxes.push_back(part);
    }
    std::vector<PixelBox> images(boxes.size());
    projectBoxes(bed.view, bed.buffer.width, bed.buffer.height, boxes, images);
    DepthLevels levels;
    levels.build(bed.buffer.view());
    std::vector<BoxAnswer> all(boxes.size());
    testBoxes(levels.levels(), OutlineView(bed.view), boxes, images, all);
    const auto same = [&](const std::vector<BoxAnswer>& answers) {
      return std::ranges::equal(all, answers, [](const BoxAnswer& a, const BoxAnswer& b) {
        return a.visibility == b.visibility && a.within_view == b.within_view;
      });
    };
    for (const std::int64_t target : targets) {
      const test::ForcedInstructionSet forced(target);
      std::vector<BoxAnswer> answers(boxes.size());
      testBoxes(levels.levels(), OutlineView(bed.view), boxes, images, answers);
      EXPECT_TRUE(same(answers)) << hwy::TargetName(target) << ", seed " << seed;
    }
    std::vector<BoxAnswer> parts(boxes.size());
    for (std::size_t first = 0; first < boxes.size();) {
      const std::size_t count = std::min<std::size_t>(1 + bed.random.below(9), boxes.size() - first);
      testBoxes(levels.levels(), OutlineView(bed.view), std::span(boxes).subspan(first, count),
                std::span(images).subspan(first, count), std::span(parts).subspan(first, count));
      first += count;
    }
    EXPECT_TRUE(same(parts)) << "seed " << seed;
    for (const BoxAnswer& answer : all) {
      hidden += answer.visibility == Visibility::kHidden ? 1 : 0;
    }
  }
  EXPECT_GT(hidden, 1000);
}

}  // namespace
}  // namespace sightline::occlusion
