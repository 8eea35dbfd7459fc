// A cone must find every box that a point of it lies in, and few of those that are far from it.

#include "src/pvs/bake/convex/cone_search.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include "tests/pvs/convex_scenes.h"
#include "tests/support/instruction_sets.h"

namespace sightline::pvs {
namespace {

using test::Random;

constexpr double kReach = 100.0;

CellBox randomBox(Random& random, bool flat) {
  const Vec3d middle = random.point(kReach);
  const double size = flat ? 0.0 : std::pow(10.0, random.in(-3.0, 1.5));
  const Vec3d half(size, random.below(3) == 0 ? 0.0 : size, size);
  return {middle - half, middle + half};
}

// A box through a point of the cone: with a corner or a side there as often as the point inside.
Box boxThrough(const Vec3d& point, Random& random) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const double before = random.below(3) == 0 ? 0.0 : random.in(0.0, 2.0),
                 after = random.below(3) == 0 ? 0.0 : random.in(0.0, 2.0);
    box.min[axis] = std::nextafter(static_cast<float>(point[axis] - before), -INFINITY);
    box.max[axis] = std::nextafter(static_cast<float>(point[axis] + after), INFINITY);
  }
  return box;
}

std::vector<std::uint32_t> placesMetOf(const BoxLanes& boxes, std::span<const Cone> cones) {
  std::vector<std::uint32_t> places;
  placesMet(boxes, cones, places);
  return places;
}

// The numbers of what the tree finds; it must not find more than `most`.
std::vector<std::uint32_t> numbersIn(const ConeTree& tree, std::span<const Cone> cones, std::size_t most) {
  std::vector<std::uint32_t> found;
  EXPECT_TRUE(tree.find(cones, most, found));
  for (std::uint32_t& place : found) {
    place = tree.boxes().number[place];
  }
  return found;
}

bool has(std::span<const std::uint32_t> found, std::uint32_t number) {
  return std::ranges::find(found, number) != found.end();
}

TEST(ConeSearch, LeavesOutNoBoxThatThePointsOfTheConeLieIn) {
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Vec3d eye = random.point(kReach);
    CellBox to = randomBox(random, seed % 2 == 0);
    if (seed % 5 == 0) {
      to.min.x = to.max.x = eye.x;  // no extent along an axis
    }
    if (seed % 7 == 0) {
      to = {eye - Vec3d{1, 1, 1}, eye + Vec3d{1, 1, 1}};  // the eye is in the box
    }
    const Cone cone(eye, to, 1e-9, 2.0 * kReach);
    std::vector<Box> boxes;
    const std::uint32_t count = 1 + random.below(120);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3d in_box(random.in(to.min.x, to.max.x), random.in(to.min.y, to.max.y),
                         random.in(to.min.z, to.max.z));
      const double t = i % 4 == 0 ? 0.0 : i % 4 == 1 ? 1.0 : random.in(0.0, 1.0);
      boxes.push_back(boxThrough(eye + (in_box - eye) * t, random));
    }
    std::vector<std::uint32_t> numbers(boxes.size());
    std::iota(numbers.begin(), numbers.end(), 1000u);
    BoxLanes lanes;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      lanes.add(boxes[i], numbers[i]);
    }
    lanes.pad();
    const ConeTree tree(boxes, numbers);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(target);
      EXPECT_EQ(placesMetOf(lanes, {&cone, 1}).size(), boxes.size()) << "seed " << seed;
      EXPECT_TRUE(std::ranges::is_permutation(numbersIn(tree, {&cone, 1}, boxes.size()), numbers))
          << "seed " << seed;
      std::vector<std::uint32_t> found;
      EXPECT_FALSE(tree.find({&cone, 1}, boxes.size() - 1, found));
    }
  }
}

TEST(ConeSearch, LeavesOutNoBoxThatALineFromBoxToBoxPasses) {
  std::size_t beside = 0, left_out = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    const CellBox from = randomBox(random, seed % 3 == 0);
    CellBox to = randomBox(random, seed % 2 == 0);
    if (seed % 5 == 0) {
      to.max.x = from.max.x;  // one side, or both, do not move along an axis
      to.min.x = seed % 10 == 0 ? from.min.x : std::min(to.min.x, to.max.x);
    }
    const Cone lines(from, to, 1e-9, 2.0 * kReach);
    const auto placeIn = [&random](const CellBox& box) {
      Vec3d place;
      for (int axis = 0; axis < 3; ++axis) {
        place[axis] = random.below(4) == 0   ? box.min[axis]
                      : random.below(3) == 0 ? box.max[axis]
                                             : random.in(box.min[axis], box.max[axis]);
      }
      return place;
    };
    BoxLanes passed, others;
    for (std::uint32_t i = 0; i < 80; ++i) {
      const Vec3d a = placeIn(from), b = placeIn(to);
      const double t = i % 4 == 0 ? 0.0 : i % 4 == 1 ? 1.0 : random.in(0.0, 1.0);
      passed.add(boxThrough(a + (b - a) * t, random), i);
      others.add(boxThrough(random.point(kReach), random), i);
    }
    passed.pad();
    others.pad();
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(target);
      EXPECT_EQ(placesMetOf(passed, {&lines, 1}).size(), passed.size()) << "seed " << seed;
    }
    beside += others.size();
    left_out += others.size() - placesMetOf(others, {&lines, 1}).size();
  }
  EXPECT_GT(left_out, beside / 2);
}

TEST(ConeSearch, LeavesNothingOutAtTheEndOfTheRangeOfSinglePrecision) {
  for (int exponent = 120; exponent < 128; ++exponent) {
    const double size = std::ldexp(1.0, exponent);
    const CellBox from{{-size, -size, 0.0}, {-size, size, 0.0}}, to{{size, -size, 0.0}, {size, size, 0.0}};
    const Cone lines(from, to, 0.0, size);
    BoxLanes boxes;
    for (const double at : {-1.0, -0.5, 0.0, 0.5, 1.0}) {
      const auto x = static_cast<float>(at * size);
      boxes.add({{x, 0.0f, 0.0f}, {x, 0.0f, 0.0f}}, static_cast<std::uint32_t>(boxes.size()));
    }
    const auto count = boxes.size();
    boxes.pad();
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(target);
      EXPECT_EQ(placesMetOf(boxes, {&lines, 1}).size(), count) << "2^" << exponent;
    }
  }
}

TEST(ConeSearch, LeavesOutMostOfWhatIsBesideTheCone) {
  std::size_t beside = 0, found_beside = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    Random random(seed);
    const Vec3d eye = random.point(kReach), to = random.point(kReach);
    const Cone line(eye, {to, to}, 1e-9, 2.0 * kReach);
    std::vector<Box> boxes;
    std::vector<std::uint32_t> numbers;
    for (std::uint32_t i = 0; i < 300; ++i) {
      boxes.push_back(boxThrough(random.point(kReach), random));
      numbers.push_back(i);
    }
    BoxLanes lanes;
    for (std::uint32_t i = 0; i < 300; ++i) {
      lanes.add(boxes[i], i);
    }
    lanes.pad();
    const std::vector<std::uint32_t> met = placesMetOf(lanes, {&line, 1});
    EXPECT_TRUE(std::ranges::is_permutation(met, numbersIn(ConeTree(boxes, numbers), {&line, 1}, 300)))
        << "seed " << seed;
    for (std::uint32_t i = 0; i < 300; ++i) {
      // The distance of the box's middle from the line says that it is clearly beside it.
      const Vec3d along = normalized(to - eye), middle = center(boxes[i]) - eye;
      const double distance = length(middle - along * dot(middle, along));
      if (distance > length(Vec3d(boxes[i].max) - Vec3d(boxes[i].min))) {
        ++beside;
        found_beside += has(met, i) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(beside, 10000u);
  EXPECT_EQ(found_beside, 0u);
}

TEST(ConeSearch, FindsWhatAllConesMeet) {
  Random random(3);
  std::vector<Box> boxes;
  std::vector<std::uint32_t> numbers;
  BoxLanes lanes;
  for (std::uint32_t i = 0; i < 500; ++i) {
    boxes.push_back(boxThrough(random.point(10.0), random));
    numbers.push_back(i);
    lanes.add(boxes.back(), i);
  }
  lanes.pad();
  const ConeTree tree(boxes, numbers);
  const std::array cones{Cone({-20, 0, 0}, {{9, -1, -1}, {10, 1, 1}}, 0.0, 20.0),
                         Cone({-20, 1, 3}, {{9, -1, -1}, {10, 1, 1}}, 0.0, 20.0)};
  std::set<std::uint32_t> both;
  for (const Cone& cone : cones) {
    const std::vector<std::uint32_t> met = placesMetOf(lanes, {&cone, 1});
    const std::set<std::uint32_t> alone(met.begin(), met.end());
    std::set<std::uint32_t> in_all;
    for (const std::uint32_t i : alone) {
      if (&cone == &cones[0] || both.contains(i)) {
        in_all.insert(i);
      }
    }
    both = in_all;
  }
  const std::vector<std::uint32_t> met = placesMetOf(lanes, cones), found = numbersIn(tree, cones, 500);
  EXPECT_EQ(std::set<std::uint32_t>(met.begin(), met.end()), both);
  EXPECT_GT(both.size(), 5u);
  EXPECT_LT(both.size(), 400u);
  EXPECT_EQ(std::set<std::uint32_t>(found.begin(), found.end()), both);
}

TEST(ConeSearch, IsEmptyWithoutBoxes) {
  const Cone cone({0, 0, 0}, {{1, 1, 1}, {2, 2, 2}}, 0.0, 2.0);
  std::vector<std::uint32_t> found{7};
  EXPECT_TRUE(placesMetOf(BoxLanes(), {}).empty());
  EXPECT_TRUE(ConeTree().find({&cone, 1}, 0, found));
  EXPECT_TRUE(found.empty());
}

}  // namespace
}  // namespace sightline::pvs
