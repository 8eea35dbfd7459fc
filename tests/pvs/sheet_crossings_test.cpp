// Crossings of sheets by lines of sight against whole numbers, with many ties, on every instruction set.

#include "src/pvs/bake/surfaces/sheet_crossings.h"
#include "tests/support/instruction_sets.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

namespace sightline::pvs {
namespace {

using Whole = std::array<std::int64_t, 3>;

Whole operator-(const Whole& a, const Whole& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

std::int64_t determinant(const Whole& a, const Whole& b, const Whole& c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}

// 1 where the point is in front of the sheet, -1 behind it, 0 in its plane.
int sideOf(const std::array<Whole, 3>& sheet, const Whole& point) {
  const std::int64_t side = determinant(sheet[1] - sheet[0], sheet[2] - sheet[0], point - sheet[0]);
  return side > 0 ? 1 : side < 0 ? -1 : 0;
}

// A line that touches the border or the plane of a sheet without passing beside it is in doubt.
SheetCrossings exactly(const std::vector<std::array<Whole, 3>>& sheets, const Whole& from, const Whole& to) {
  SheetCrossings all;
  for (const std::array<Whole, 3>& sheet : sheets) {
    int left = 0, right = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::int64_t side = determinant(to - from, sheet[i] - from, sheet[(i + 1) % 3] - from);
      left += side > 0 ? 1 : 0;
      right += side < 0 ? 1 : 0;
    }
    const int start = sideOf(sheet, from), end = sideOf(sheet, to);
    if ((left > 0 && right > 0) || start * end > 0) {
      continue;
    }
    const bool within = left == 3 || right == 3, crosses = start * end < 0;
    all.in_doubt = all.in_doubt || !within || !crosses;
    all.front = all.front || (crosses && start > 0);
    all.sum += within && crosses ? start : 0;
  }
  return all;
}

TEST(SheetCrossings, AreThoseOfWholeNumbersOnEveryInstructionSet) {
  std::mt19937 random(7);
  const auto place = [&random](int most) {
    const auto number = [&] { return std::int64_t{std::uniform_int_distribution<int>(-most, most)(random)}; };
    return Whole{number(), number(), number()};
  };
  const auto asVector = [](const Whole& a) {
    return Vec3d(static_cast<double>(a[0]), static_cast<double>(a[1]), static_cast<double>(a[2]));
  };
  int front = 0, back = 0, in_doubt = 0, none = 0;
  for (int question = 0; question < 4000; ++question) {
    const int most = question % 2 == 0 ? 2 : 9;  // few places have many ties
    std::vector<std::array<Whole, 3>> sheets(random() % 10);
    std::vector<Vec3d> vertices;
    std::vector<std::uint32_t> corners;
    for (std::array<Whole, 3>& sheet : sheets) {
      for (Whole& corner : sheet) {
        corner = place(most);
        corners.push_back(static_cast<std::uint32_t>(vertices.size()));
        vertices.push_back(asVector(corner));
      }
    }
    const Whole from = place(most), to = place(most);
    const SheetCrossings expected = exactly(sheets, from, to);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(target);
      const SheetCrossings found =
          crossSheets(vertices, corners, {asVector(from), asVector(to), 0x1p-40}, 100.0);
      ASSERT_EQ(found.sum, expected.sum) << hwy::TargetName(target) << ", question " << question;
      ASSERT_EQ(found.front, expected.front) << hwy::TargetName(target) << ", question " << question;
      ASSERT_EQ(found.in_doubt, expected.in_doubt) << hwy::TargetName(target) << ", question " << question;
    }
    front += expected.sum > 0 ? 1 : 0;
    back += expected.sum < 0 ? 1 : 0;
    in_doubt += expected.in_doubt ? 1 : 0;
    none += sheets.empty() || expected.any() ? 0 : 1;
  }
  EXPECT_GT(std::min({front, back, in_doubt, none}), 300);
}

}  // namespace
}  // namespace sightline::pvs
