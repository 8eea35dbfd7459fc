#include "src/occlusion/surfaces/need_map.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "tests/support/instruction_sets.h"
#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"

namespace sightline::occlusion {
namespace {

struct ToHide {
  PixelRectangle rectangle;
  float nearest = 0.0f;
};

// A depth buffer, and boxes that are to be hidden in it.
struct NeedBed {
  explicit NeedBed(test::Random& random)
      : width(1 + static_cast<std::int32_t>(random.below(70))),
        height(1 + static_cast<std::int32_t>(random.below(40))),
        stride((width + 15) / 8 * 8),
        values(static_cast<std::size_t>(stride) * static_cast<std::size_t>(height)) {
    for (float& value : values) {
      value = static_cast<float>(random.below(6));
    }
    for (std::size_t i = random.below(5); i > 0; --i) {
      boxes.push_back({randomRectangle(random), static_cast<float>(random.below(6))});
    }
  }

  void setNeeds() {
    map.clear(target());
    for (const ToHide& box : boxes) {
      map.add(box.rectangle, box.nearest);
    }
  }
  // Looks at the target once, or twice where it was farther before.
  void look(test::Random& random) {
    SquareDepths depths;
    if (random.below(2) == 0) {
      std::vector<float> farther = values;
      for (float& value : farther) {
        value -= static_cast<float>(random.below(3));
      }
      DepthTarget before = target();
      before.reciprocal_depth = farther.data();
      depths.look(before);
      map.look(depths);
    }
    depths.look(target());
    map.look(depths);
  }
  // Brings some pixels nearer, and looks at these alone.
  void comeNearer(const PixelRectangle& where) {
    for (std::int32_t y = where.y0; y < where.y1; ++y) {
      for (std::int32_t x = where.x0; x < where.x1; ++x) {
        values[static_cast<std::size_t>(y * stride + x)] += 2.0f;
      }
    }
    SquareDepths depths;
    depths.look(target());
    map.look(depths, where);
  }

  PixelRectangle randomRectangle(test::Random& random) const {
    const auto below = [&](std::int32_t end) {
      return static_cast<std::int32_t>(random.below(static_cast<std::uint32_t>(end)));
    };
    const std::int32_t x = below(width), y = below(height);
    return {x, y, x + 1 + below(width - x), y + 1 + below(height - y)};
  }
  DepthTarget target() {
    return {values.data(), static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height),
            static_cast<std::uint32_t>(stride)};
  }
  float at(std::int32_t x, std::int32_t y) const { return values[static_cast<std::size_t>(y * stride + x)]; }

  // The same as NeedMap::pixels(), pixel by pixel. A square ends beyond the buffer where that ends in it.
  std::uint32_t pixels(const PixelRectangle& r, const DepthBound& depth) const {
    constexpr std::int32_t k = SquareDepths::kSize;
    std::int32_t squares = 0;
    for (std::int32_t row = r.y0 / k; row * k < r.y1; ++row) {
      for (std::int32_t column = r.x0 / k; column * k < r.x1; ++column) {
        float farthest_box = std::numeric_limits<float>::infinity(), nearest_box = -farthest_box;
        for (const ToHide& box : boxes) {
          const PixelRectangle& b = box.rectangle;
          if (b.x0 / k <= column && column <= (b.x1 - 1) / k && b.y0 / k <= row && row <= (b.y1 - 1) / k) {
            farthest_box = std::min(farthest_box, box.nearest);
            nearest_box = std::max(nearest_box, box.nearest);
          }
        }
        float farthest_pixel = std::numeric_limits<float>::infinity(), nearest = -farthest_pixel;
        for (std::int32_t y = row * k; y < (row + 1) * k; ++y) {
          for (std::int32_t x = column * k; x < (column + 1) * k; ++x) {
            if (x < width && y < height) {
              farthest_pixel = std::min(farthest_pixel, at(x, y));
            }
            const float here = depth.along_x * static_cast<float>(x) + depth.along_y * static_cast<float>(y);
            nearest = std::max({nearest, here + depth.at_origin, depth.floor});
          }
        }
        const bool open = farthest_pixel < nearest_box;
        squares += open && nearest > std::max(farthest_box, farthest_pixel) ? 1 : 0;
      }
    }
    return static_cast<std::uint32_t>(std::min(squares * k * k, r.area()));
  }

  std::int32_t width, height, stride;
  std::vector<float> values;
  std::vector<ToHide> boxes;
  NeedMap map;
};

// Sums of its values are exact.
DepthBound randomBound(test::Random& random) {
  const auto between = [&](int low, int high) {
    return static_cast<float>(low +
                              static_cast<int>(random.below(static_cast<std::uint32_t>(high - low + 1))));
  };
  return {between(-4, 4) / 16.0f, between(-4, 4) / 16.0f, between(-2, 8), between(-3, 3)};
}

TEST(NeedMap, NeedsWhatIsBeforeABoxWhereItIsNotHidden) {
  test::Random random(3);
  std::size_t needed = 0, not_needed = 0, sloping_needed = 0, sloping_not_needed = 0;
  for (int n = 0; n < test::rounds(4000); ++n) {
    NeedBed bed(random);
    for (int k = 0; k < 5; ++k) {
      const PixelRectangle rectangle = bed.randomRectangle(random), changed = bed.randomRectangle(random);
      const auto nearest = static_cast<float>(random.below(7));
      const DepthBound level{.at_origin = nearest, .floor = nearest}, sloping = randomBound(random);
      const std::uint32_t expected = bed.pixels(rectangle, level),
                          of_sloping = bed.pixels(rectangle, sloping);
      for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        const test::ForcedInstructionSet forced(target);
        bed.setNeeds();
        bed.look(random);
        EXPECT_EQ(bed.map.pixels(rectangle, nearest), expected) << n << ", " << hwy::TargetName(target);
        EXPECT_EQ(bed.map.pixels(rectangle, sloping), of_sloping) << n << ", " << hwy::TargetName(target);
        NeedBed nearer = bed;
        nearer.comeNearer(changed);
        EXPECT_EQ(nearer.map.pixels(rectangle, nearest), nearer.pixels(rectangle, level))
            << n << ", " << hwy::TargetName(target);
      }
      (expected > 0 ? needed : not_needed) += 1;
      (of_sloping > 0 ? sloping_needed : sloping_not_needed) += 1;
    }
  }
  EXPECT_GT(needed, test::rounds(2000u));
  EXPECT_GT(not_needed, test::rounds(2000u));
  EXPECT_GT(sloping_needed, test::rounds(2000u));
  EXPECT_GT(sloping_not_needed, test::rounds(2000u));
}

TEST(NeedMap, ABoxIsNotHiddenByWhatIsBehindItOrBesideIt) {
  std::vector<float> values(std::size_t{48} * 32, -1.0f);
  const DepthTarget target{values.data(), 40, 32, 48};
  NeedMap map;
  SquareDepths depths;
  map.clear(target);
  map.add({8, 8, 16, 16}, 2.0f);
  depths.look(target);
  map.look(depths);
  EXPECT_EQ(map.pixels({0, 0, 40, 32}, 2.5f), 64u);
  EXPECT_EQ(map.pixels({0, 0, 40, 32}, 2.0f), 0u) << "no nearer than the box";
  EXPECT_EQ(map.pixels({0, 0, 8, 32}, 2.5f), 0u) << "to the left of it";
  EXPECT_EQ(map.pixels({0, 16, 40, 32}, 2.5f), 0u) << "above it";
  EXPECT_EQ(map.pixels({10, 10, 12, 32}, 2.5f), 44u) << "no more than there are";
  for (std::size_t y = 8; y < 16; ++y) {
    std::fill_n(values.begin() + static_cast<std::ptrdiff_t>(48 * y + 8), 8, 2.0f);
  }
  depths.look(target);
  map.look(depths);
  EXPECT_EQ(map.pixels({0, 0, 40, 32}, 2.5f), 0u) << "it is hidden";
  values[48 * 12 + 11] = 1.9f;
  map.clear(target);
  map.add({8, 8, 16, 16}, 2.0f);
  depths.look(target);
  map.look(depths);
  EXPECT_EQ(map.pixels({0, 0, 40, 32}, 2.5f), 64u) << "but for one pixel";
}

}  // namespace
}  // namespace sightline::occlusion
