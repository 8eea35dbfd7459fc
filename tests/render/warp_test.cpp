#include "src/render/reuse/warp.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "src/render/reuse/warp_image.h"
#include "tests/support/not_finite.h"

namespace sightline::render {
namespace {

using test::kInfinity;
using test::kNan;

struct Points {
  std::vector<PicturePoint> from, to;
};

Points randomPoints(std::mt19937& random, std::size_t count, const Warp& warp) {
  std::uniform_real_distribution<double> at(0.0, 400.0);
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const PicturePoint p{at(random), at(random)};
    points.from.push_back(p);
    points.to.push_back(warp(p));
  }
  return points;
}

Warp randomAffine(std::mt19937& random) {
  std::uniform_real_distribution<double> part(-0.4, 0.4), shift(-90.0, 90.0);
  return {{1.0 + part(random), part(random), shift(random), part(random), 1.0 + part(random), shift(random),
           0, 0, 1}};
}

Warp randomProjective(std::mt19937& random) {
  std::uniform_real_distribution<double> slant(-1e-3, 1e-3);
  Warp warp = randomAffine(random);
  warp.m[6] = slant(random);
  warp.m[7] = slant(random);
  return warp;
}

double sumOfSquares(const Warp& warp, const Points& points) {
  double sum = 0.0;
  for (std::size_t i = 0; i < points.from.size(); ++i) {
    const PicturePoint p = warp(points.from[i]);
    sum += std::pow(p.x - points.to[i].x, 2) + std::pow(p.y - points.to[i].y, 2);
  }
  return sum;
}

TEST(Warp, AffineFitFindsTheMapThatPointsFollow) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const Warp truth = randomAffine(random);
    const Points points = randomPoints(random, 3 + seed % 20, truth);
    const std::optional<Warp> found = fitAffine(points.from, points.to);
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_LT(largestDeviation(*found, points.from, points.to), 1e-6) << "seed " << seed;
    EXPECT_EQ(found->m[6], 0.0);
    EXPECT_EQ(found->m[7], 0.0);
    EXPECT_EQ(found->m[8], 1.0);
  }
}

TEST(Warp, NoNearbyAffineMapHasLessSquaresThanTheFit) {
  for (std::uint32_t seed = 0; seed < 50; ++seed) {
    std::mt19937 random(seed);
    Points points = randomPoints(random, 12, randomAffine(random));
    std::normal_distribution<double> noise(0.0, 5.0);
    for (PicturePoint& p : points.to) {
      p = {p.x + noise(random), p.y + noise(random)};
    }
    const Warp found = fitAffine(points.from, points.to).value();
    const double least = sumOfSquares(found, points);
    for (std::size_t i = 0; i < 6; ++i) {
      for (const double step : {-1.0, 1.0}) {
        Warp other = found;
        other.m[i] += step * (i % 3 == 2 ? 0.01 : 1e-4);
        EXPECT_GT(sumOfSquares(other, points), least) << "seed " << seed << ", element " << i;
      }
    }
  }
}

TEST(Warp, AffineFitOfPointsOnALineLeavesWhatIsAcrossAsItIs) {
  const std::vector<PicturePoint> from{{10, 50}, {20, 50}, {40, 50}}, to{{10, 57}, {30, 57}, {70, 57}};
  const Warp warp = fitAffine(from, to).value();
  EXPECT_LT(largestDeviation(warp, from, to), 1e-6);
  const PicturePoint above = warp({20, 45});
  EXPECT_NEAR(above.x, 30.0, 1e-6);
  EXPECT_NEAR(above.y, 52.0, 1e-6);
}

TEST(Warp, AffineFitOfOnePlaceIsAShift) {
  const std::vector<PicturePoint> from{{10, 50}, {10, 50}}, to{{14, 48}, {14, 48}};
  const Warp warp = fitAffine(from, to).value();
  EXPECT_EQ(warp({110, 150}), (PicturePoint{114, 148}));
  EXPECT_FALSE(fitAffine({}, {}));
}

TEST(Warp, ProjectiveFitFindsTheMapThatPointsFollow) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const Points points = randomPoints(random, 5 + seed % 20, randomProjective(random));
    const std::optional<Warp> found = fitProjective(points.from, points.to);
    ASSERT_TRUE(found) << "seed " << seed;
    EXPECT_LT(largestDeviation(*found, points.from, points.to), 1e-3) << "seed " << seed;
  }
}

TEST(Warp, FourCornersThatStayConvexAreMetExactly) {
  const std::vector<PicturePoint> from{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
  const std::vector<PicturePoint> to{{10, 5}, {120, 20}, {90, 80}, {-5, 110}};
  EXPECT_LT(largestDeviation(fitProjective(from, to).value(), from, to), 1e-3);
  EXPECT_GT(largestDeviation(fitAffine(from, to).value(), from, to), 5.0);
}

TEST(Warp, ProjectiveFitNeedsFourPointsAndAMapThatDoesNotTear) {
  const std::vector<PicturePoint> three{{0, 0}, {1, 0}, {0, 1}};
  EXPECT_FALSE(fitProjective(three, three));
  // Two corners change places: a bow tie, which no map without a tear makes of a square.
  const std::vector<PicturePoint> from{{0, 0}, {100, 0}, {100, 100}, {0, 100}};
  const std::vector<PicturePoint> to{{0, 0}, {100, 0}, {0, 100}, {100, 100}};
  if (const std::optional<Warp> warp = fitProjective(from, to)) {
    for (const PicturePoint& p : from) {
      EXPECT_GT(warp->divisor(p), 0.0);
    }
    EXPECT_GT(largestDeviation(*warp, from, to), 10.0);
  }
}

TEST(Warp, WhatIsNotFiniteIsFollowedByNoMap) {
  for (const double bad : {kNan, kInfinity, -kInfinity, 1e308}) {
    const std::vector<PicturePoint> good{{0, 0}, {9, 1}, {2, 8}, {5, 5}, {7, 3}};
    std::vector<PicturePoint> hostile = good;
    hostile[2].y = bad;
    for (const auto& [from, to] : {std::pair(good, hostile), {hostile, good}}) {
      for (const std::optional<Warp>& warp : {fitAffine(from, to), fitProjective(from, to)}) {
        if (warp) {
          for (const double element : warp->m) {
            EXPECT_TRUE(std::isfinite(element)) << bad;
          }
        }
      }
    }
  }
  const std::vector<PicturePoint> at{{1, 2}}, nowhere{{kNan, 2}};
  EXPECT_EQ(largestDeviation(Warp{}, at, nowhere), kInfinity);
  EXPECT_EQ(largestDeviation(Warp{}, {}, {}), 0.0);
}

TEST(Warp, InverseLeadsBack) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    const Warp warp = randomProjective(random);
    const Points points = randomPoints(random, 10, warp);
    const Warp back = inverseOf(warp).value();
    EXPECT_LT(largestDeviation(back, points.to, points.from), 1e-8) << "seed " << seed;
    EXPECT_LT(largestDeviation(back * warp, points.from, points.from), 1e-8) << "seed " << seed;
    for (std::size_t i = 0; i < points.from.size(); ++i) {
      EXPECT_EQ(warp.divisor(points.from[i]) > 0.0, back.divisor(points.to[i]) > 0.0) << "seed " << seed;
    }
  }
  EXPECT_FALSE(inverseOf(Warp{{1, 2, 0, 2, 4, 0, 0, 0, 1}}));
  EXPECT_FALSE(inverseOf(Warp{{kNan, 0, 0, 0, 1, 0, 0, 0, 1}}));
}

TEST(Warp, StretchIsThatOfTheDirectionThatChangesMost) {
  const double c = std::cos(0.7), s = std::sin(0.7);
  EXPECT_NEAR(largestStretch({{c, -s, 9, s, c, 3, 0, 0, 1}}, {5, 6}), 1.0, 1e-12);
  EXPECT_NEAR(largestStretch({{2 * c, -s, 0, 2 * s, c, 0, 0, 0, 1}}, {5, 6}), 2.0, 1e-12);
  EXPECT_NEAR(largestStretch({{0.25, 0, 0, 0, 1, 0, 0, 0, 1}}, {5, 6}), 4.0, 1e-12);
  EXPECT_EQ(largestStretch({{0, 0, 0, 0, 1, 0, 0, 0, 1}}, {5, 6}), kInfinity);
  EXPECT_EQ(largestStretch({{kNan, 0, 0, 0, 1, 0, 0, 0, 1}}, {5, 6}), kInfinity);
}

TEST(Warp, StretchOfAProjectiveMapIsThatOfSmallStepsInAllDirections) {
  for (std::uint32_t seed = 0; seed < 30; ++seed) {
    std::mt19937 random(seed);
    const Warp warp = randomProjective(random);
    const PicturePoint at{100.0 + seed, 200.0};
    double most = 1.0;
    for (int i = 0; i < 720; ++i) {
      const double angle = i * 3.141592653589793 / 720.0, step = 1e-4;
      const PicturePoint a = warp({at.x - step * std::cos(angle), at.y - step * std::sin(angle)});
      const PicturePoint b = warp({at.x + step * std::cos(angle), at.y + step * std::sin(angle)});
      const double stretch = std::hypot(b.x - a.x, b.y - a.y) / (2.0 * step);
      most = std::max({most, stretch, 1.0 / stretch});
    }
    EXPECT_NEAR(largestStretch(warp, at), most, 1e-3 * most) << "seed " << seed;
  }
}

template <typename Value>
LayerImage imageOf(std::uint32_t width, std::uint32_t height, Value&& value) {
  LayerImage image;
  image.clear(width, height);
  for (std::uint32_t y = 0; y < height; ++y) {
    for (std::uint32_t x = 0; x < width; ++x) {
      const auto v = static_cast<float>(value(x + 0.5, y + 0.5));
      image.pixels[std::size_t{y} * width + x] = {v, 0.5f * v, 0.25f * v, v};
    }
  }
  return image;
}

LayerImage warped(const LayerImage& image, const Warp& target_from_picture, const SideFlags& cut = {}) {
  Sprite sprite;
  cropSprite(image, {0, 0, image.width, image.height}, cut, sprite);
  LayerImage target;
  target.clear(image.width, image.height);
  drawWarped(sprite, inverseOf(target_from_picture).value(), target);
  return target;
}

Warp shift(double x, double y) {
  return {{1, 0, x, 0, 1, y, 0, 0, 1}};
}

TEST(WarpImage, ShiftByWholePixelsKeepsEveryPixel) {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> any(0.0f, 1.0f);
  LayerImage image;
  image.clear(20, 14);
  for (std::size_t i = 0; i < image.pixels.size(); ++i) {
    const std::size_t x = i % 20, y = i / 20;
    if (x > 4 && x < 12 && y > 3 && y < 9) {
      image.pixels[i] = {any(random), any(random), any(random), any(random)};
    }
  }
  for (const auto& [dx, dy] : {std::pair(0, 0), {3, 2}, {-4, 1}, {5, -3}}) {
    const LayerImage moved = warped(image, shift(dx, dy));
    for (int y = 0; y < 14; ++y) {
      for (int x = 0; x < 20; ++x) {
        const int sx = x - dx, sy = y - dy;
        const bool is_inside = sx >= 0 && sy >= 0 && sx < 20 && sy < 14;
        const ShapedPixel expected =
            is_inside ? image.pixels[static_cast<std::size_t>(20 * sy + sx)] : ShapedPixel{};
        EXPECT_EQ(moved.pixels[static_cast<std::size_t>(20 * y + x)], expected) << x << ' ' << y;
      }
    }
  }
}

TEST(WarpImage, ShiftByHalfAPixelIsTheMeanOfTwo) {
  const LayerImage image = imageOf(9, 3, [](double x, double y) { return x == 4.5 && y == 1.5 ? 1.0 : 0.0; });
  const LayerImage moved = warped(image, shift(0.5, 0.0));
  for (std::size_t x = 0; x < 9; ++x) {
    EXPECT_FLOAT_EQ(moved.pixels[9 + x].alpha, x == 4 || x == 5 ? 0.5f : 0.0f) << x;
    EXPECT_EQ(moved.pixels[x].alpha, 0.0f);
  }
}

// Bilinear resampling is exact where a picture is linear.
TEST(WarpImage, AffineMapsOfALinearPictureAreExact) {
  const auto ramp = [](double x, double y) { return 0.2 + 0.003 * x + 0.005 * y; };
  const LayerImage image = imageOf(80, 60, ramp);
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> part(-0.3, 0.3);
    const Warp map{{1 + part(random), part(random), 40 * part(random), part(random), 1 + part(random),
                    40 * part(random), 0, 0, 1}};
    const LayerImage moved = warped(image, map);
    const Warp back = inverseOf(map).value();
    std::size_t inside = 0;
    for (std::uint32_t y = 0; y < 60; ++y) {
      for (std::uint32_t x = 0; x < 80; ++x) {
        const PicturePoint p = back({x + 0.5, y + 0.5});
        const ShapedPixel& pixel = moved.pixels[80 * y + x];
        if (p.x >= 0.5 && p.y >= 0.5 && p.x <= 79.5 && p.y <= 59.5) {
          ++inside;
          EXPECT_NEAR(pixel.alpha, ramp(p.x, p.y), 1e-5) << "seed " << seed;
          EXPECT_NEAR(pixel.blue, 0.25 * ramp(p.x, p.y), 1e-5) << "seed " << seed;
        } else if (p.x < -0.5 || p.y < -0.5 || p.x > 80.5 || p.y > 60.5) {
          EXPECT_EQ(pixel, ShapedPixel{}) << "seed " << seed;
        }
      }
    }
    EXPECT_GT(inside, 500u) << "seed " << seed;
  }
}

// A smooth bell: bilinear resampling is wrong by at most an eighth of the second derivatives, one a
// direction.
TEST(WarpImage, MapsOfASmoothPictureAreAsExactAsBilinearResamplingCanBe) {
  constexpr double kWidth = 6.0;
  const auto bell = [](double x, double y) {
    const double r2 = ((x - 40) * (x - 40) + (y - 30) * (y - 30)) / (kWidth * kWidth);
    return r2 < 25.0 ? std::exp(-0.5 * r2) : 0.0;
  };
  const LayerImage image = imageOf(80, 60, bell);
  for (const Warp& map :
       {Warp{{0.9, -0.3, 15, 0.3, 0.9, -8, 0, 0, 1}}, Warp{{1.2, 0.1, -9, 0, 0.8, 5, 0, 0, 1}},
        Warp{{1.1, 0.1, -2, 0.1, 1.0, -3, 2e-3, 1e-3, 1}}}) {
    const LayerImage moved = warped(image, map);
    const Warp back = inverseOf(map).value();
    for (std::uint32_t y = 0; y < 60; ++y) {
      for (std::uint32_t x = 0; x < 80; ++x) {
        const PicturePoint p = back({x + 0.5, y + 0.5});
        EXPECT_NEAR(moved.pixels[80 * y + x].alpha, bell(p.x, p.y), 2.0 / (8.0 * kWidth * kWidth) + 1e-5);
      }
    }
  }
}

TEST(WarpImage, GoesOnBeyondSidesThatAreCutAndEndsAtOthers) {
  const LayerImage full = imageOf(8, 6, [](double, double) { return 1.0; });
  // Half a pixel to the right and down: the first column and row look half beyond the picture.
  const auto at = [&](const SideFlags& cut, double dx, double dy, std::size_t x, std::size_t y) {
    return warped(full, shift(dx, dy), cut).pixels[8 * y + x].alpha;
  };
  SideFlags none{}, left{}, top{}, right{}, bottom{};
  left[kLeftSide] = top[kTopSide] = right[kRightSide] = bottom[kBottomSide] = true;
  EXPECT_EQ(at(none, 0.5, 0, 0, 3), 0.5f);
  EXPECT_EQ(at(left, 0.5, 0, 0, 3), 1.0f);
  EXPECT_EQ(at(right, 0.5, 0, 0, 3), 0.5f);
  EXPECT_EQ(at(none, -0.5, 0, 7, 3), 0.5f);
  EXPECT_EQ(at(right, -0.5, 0, 7, 3), 1.0f);
  EXPECT_EQ(at(none, 0, 0.5, 3, 0), 0.5f);
  EXPECT_EQ(at(top, 0, 0.5, 3, 0), 1.0f);
  EXPECT_EQ(at(none, 0, -0.5, 3, 5), 0.5f);
  EXPECT_EQ(at(bottom, 0, -0.5, 3, 5), 1.0f);
}

TEST(WarpImage, CropsToWhatIsThereAndAMargin) {
  const LayerImage image =
      imageOf(30, 20, [](double x, double y) { return x > 7 && x < 12 && y > 4 && y < 15 ? 1.0 : 0.0; });
  Sprite sprite;
  cropSprite(image, {0, 0, 30, 20}, {}, sprite);
  EXPECT_EQ(sprite.left, 6);
  EXPECT_EQ(sprite.top, 3);
  EXPECT_EQ(sprite.width, 7u);
  EXPECT_EQ(sprite.height, 13u);
  EXPECT_EQ(sprite.pixels.size(), 7u * 13u);
}

TEST(WarpImage, NothingIsWarpedToNothing) {
  LayerImage empty;
  empty.clear(12, 10);
  EXPECT_EQ(warped(empty, shift(1.5, 2)).pixels, empty.pixels);
  const LayerImage full = imageOf(12, 10, [](double, double) { return 1.0; });
  Sprite sprite;
  cropSprite(full, {5, 5, 5, 9}, {}, sprite);
  EXPECT_TRUE(sprite.pixels.empty());
  cropSprite(full, {0, 0, 400, 400}, {}, sprite);
  EXPECT_EQ(sprite.pixels.size(), 14u * 12u);
  // Maps that lead nowhere.
  for (const Warp& bad :
       {Warp{{kNan, 0, 0, 0, 1, 0, 0, 0, 1}}, Warp{{1, 0, 0, 0, 1, 0, 0, 0, -1}},
        Warp{{1e308, 1e308, 0, 0, 1, 0, 0, 0, 1}}, Warp{{0, 0, kInfinity, 0, 1, 0, 0, 0, 1}}}) {
    LayerImage target = full;
    drawWarped(sprite, bad, target);
    EXPECT_EQ(target.pixels, empty.pixels);
  }
}

}  // namespace
}  // namespace sightline::render
