// The bytes of the two occluder databases, written by hand: what they mean, and which of them are refused.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <string>

#include "src/base/byte_stream.h"
#include "tests/occluders/database_bytes.h"

namespace sightline {
namespace {

using namespace database_bytes;

constexpr float kNanFloat = std::numeric_limits<float>::quiet_NaN();

// Two different lists, {9, 0} and {5}.
struct Lists {
  std::uint64_t different = 2;
  std::vector<std::uint32_t> lengths{2, 1};
  std::vector<std::uint64_t> which;
  std::vector<std::uint32_t> ids{9, 0, 5};
};

struct Layout {
  std::string letters;
  std::uint32_t version = 1, directions = 2, occluders = 10;
  std::uint32_t places = 0;
  // Of an occluder database.
  std::vector<float> box;
  struct Node {
    std::uint8_t axis = 3;
    float plane = 0.0f;
    std::uint32_t link = 0;
  };
  std::vector<Node> nodes;
  // Of a viewpoint database: the spacing and the points.
  std::vector<double> grid;
  Lists lists;
  std::string rest;

  Bytes bytes() const {
    ByteWriter writer;
    writer.addAll(std::span<const char>(letters));
    for (const std::uint32_t value : {version, directions, occluders, places}) {
      writer.add(value);
    }
    writer.addAll(std::span<const float>(box));
    for (const Node& node : nodes) {
      writer.add(node.axis);
      if (node.axis != 3) {
        writer.add(node.plane);
        writer.add(node.link);
      }
    }
    writer.addAll(std::span<const double>(grid));
    writer.add(lists.different);
    writer.addAll(std::span<const std::uint32_t>(lists.lengths));
    writer.addAll(std::span<const std::uint64_t>(lists.which));
    writer.addAll(std::span<const std::uint32_t>(lists.ids));
    writer.addAll(std::span<const char>(rest));
    return writer.take();
  }
};

// Cells: x < 4; x >= 4 and y < 2; the rest.
Layout threeCells() {
  Layout layout;
  layout.letters = "occd";
  layout.places = 3;
  layout.box = {0, 0, 0, 8, 8, 8};
  layout.nodes = {{0, 4.0f, 1}, {}, {1, 2.0f, 3}, {}, {}};
  layout.lists.which = {0, 1, 2, 1, 0, 2};
  return layout;
}

Layout twoPoints() {
  Layout layout;
  layout.letters = "vptd";
  layout.places = 2;
  layout.grid = {2.5, 1, 2, 3, 4, 5, 6};
  layout.lists.which = {0, 1, 2, 1};
  return layout;
}

Ids idsOf(std::initializer_list<std::uint32_t> values) {
  Ids ids;
  for (const std::uint32_t value : values) {
    ids.emplace_back(value);
  }
  return ids;
}

TEST(OccluderDatabaseBytes, MeanWhatIsDocumented) {
  const auto loaded = OccluderDatabase::load(threeCells().bytes(), 10);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->cellCount(), 3u);
  EXPECT_EQ(loaded->directionCount(), 2u);
  EXPECT_EQ(loaded->cellOf({3.9, 7, 1}), 0u);
  EXPECT_EQ(loaded->cellOf({4.0, 1.9, 1}), 1u);
  EXPECT_EQ(loaded->cellOf({4.1, 2.0, 1}), 2u);
  EXPECT_EQ(loaded->cellRegion(0), (Box{{0, 0, 0}, {4, 8, 8}}));
  EXPECT_EQ(loaded->cellRegion(1), (Box{{4, 0, 0}, {8, 2, 8}}));
  EXPECT_EQ(loaded->cellRegion(2), (Box{{4, 2, 0}, {8, 8, 8}}));
  const Ids two = idsOf({9, 0}), one = idsOf({5});
  const Ids expected[] = {{}, two, one, two, {}, one};
  for (std::uint32_t i = 0; i < 6; ++i) {
    EXPECT_EQ(listOf(*loaded, i / 2, i % 2), expected[i]) << "list " << i;
  }
  EXPECT_EQ(loaded->save(), threeCells().bytes());
}

TEST(ViewpointDatabaseBytes, MeanWhatIsDocumented) {
  const auto loaded = ViewpointDatabase::load(twoPoints().bytes(), 10);
  ASSERT_TRUE(loaded) << loaded.error().message;
  EXPECT_EQ(loaded->pointCount(), 2u);
  EXPECT_EQ(loaded->directionCount(), 2u);
  EXPECT_EQ(loaded->spacing(), 2.5);
  EXPECT_EQ(loaded->point(0), Vec3d(1, 2, 3));
  EXPECT_EQ(loaded->point(1), Vec3d(4, 5, 6));
  EXPECT_EQ(loaded->nearestPoint({5, 5, 5}), 1u);
  EXPECT_EQ(listOf(*loaded, 0, 0), Ids());
  EXPECT_EQ(listOf(*loaded, 0, 1), idsOf({9, 0}));
  EXPECT_EQ(listOf(*loaded, 1, 0), idsOf({5}));
  EXPECT_EQ(listOf(*loaded, 1, 1), idsOf({9, 0}));
  EXPECT_EQ(loaded->save(), twoPoints().bytes());
}

struct Fault {
  std::string expected;  // in the error
  std::function<void(Layout&)> make;
};

template <typename Database>
void expectRefused(const Layout& sound, const std::vector<Fault>& faults) {
  for (std::size_t i = 0; i < faults.size(); ++i) {
    Layout layout = sound;
    faults[i].make(layout);
    const std::string error = errorOf<Database>(layout.bytes(), 10);
    EXPECT_TRUE(has(error, faults[i].expected)) << "fault " << i << ": " << error;
  }
}

std::vector<Fault> faultsOfBoth() {
  constexpr std::uint64_t kHuge = ~std::uint64_t{0};
  return {
      {"something else", [](Layout& l) { l.letters[2] = 'x'; }},
      {"version 2", [](Layout& l) { l.version = 2; }},
      {"has 4097 directions", [](Layout& l) { l.directions = 4097; }},
      {"is of 11 occluders", [](Layout& l) { l.occluders = 11; }},
      {"is of 10 occluders", [](Layout& l) { l.directions = 0; }},
      {"followed by other bytes from byte 16 on", [](Layout& l) { l.directions = l.occluders = 0; }},
      {"truncated", [](Layout& l) { l.directions = 4096; }},
      {"truncated at byte 16", [](Layout& l) { l.places = 0xffffffffu; }},
      {"truncated", [](Layout& l) { l.lists.different = kHuge; }},
      {"truncated", [](Layout& l) { l.lists.different = kHuge / 4 + 2; }},  // times 4: 4
      {"truncated",
       [](Layout& l) {
         l.lists.lengths = {0xffffffffu, 1};
       }},
      {"truncated",
       [](Layout& l) {
         l.lists.lengths = {2, 2};
       }},
      {"stores an empty list",
       [](Layout& l) {
         l.lists.lengths = {3, 0};
       }},
      {"followed by other bytes",
       [](Layout& l) {
         l.lists.lengths = {1, 1};
       }},
      {"followed by other bytes", [](Layout& l) { l.rest = "?"; }},
      {"names occluder 10 of 10", [](Layout& l) { l.lists.ids[1] = 10; }},
      {"names occluder 4294967295 of 10", [](Layout& l) { l.lists.ids[2] = 0xffffffffu; }},
      {"list that it does not have", [](Layout& l) { l.lists.which.back() = 3; }},
      {"list that it does not have", [](Layout& l) { l.lists.which.back() = kHuge; }},
      {"list that it does not have", [](Layout& l) { l.lists.which[1] = 2; }},  // out of order
      {"none of its lists", [](Layout& l) { std::ranges::replace(l.lists.which, 2u, 1u); }},
  };
}

TEST(OccluderDatabaseBytes, AreRefusedWithFaults) {
  expectRefused<OccluderDatabase>(threeCells(), faultsOfBoth());
  const std::string no_tree = "not a tree of finite boxes", no_split = "not divided into two";
  constexpr float kInfFloat = std::numeric_limits<float>::infinity();
  const std::vector<Fault> faults{
      {"has 0 cells", [](Layout& l) { l.places = 0; }},
      {no_tree, [](Layout& l) { l.box[0] = kNanFloat; }},
      {no_tree, [](Layout& l) { l.box[5] = kInfFloat; }},
      {no_tree, [](Layout& l) { l.box[4] = -1.0f; }},
      {no_tree,
       [](Layout& l) {
         l.nodes[1] = {4, 1.0f, 3};
       }},
      {no_tree, [](Layout& l) { l.nodes[0] = {}; }},       // the others have no parent
      {no_split, [](Layout& l) { l.nodes[0].link = 0; }},  // its own child
      {no_split, [](Layout& l) { l.nodes[2].link = 2; }},  // the same
      {no_split, [](Layout& l) { l.nodes[2].link = 0; }},  // a cycle
      {no_split, [](Layout& l) { l.nodes[2].link = 1; }},  // a cycle, and two parents
      {no_split,
       [](Layout& l) {
         l.nodes[1] = {1, 2.0f, 2};
       }},  // two parents
      // Numbers that all rise, each with a parent, two with two of them; one cell less than
      // there should be.
      {no_split,
       [](Layout& l) {
         l.nodes = {{0, 4.0f, 1}, {1, 4.0f, 2}, {2, 4.0f, 3}, {}, {}};
       }},
      {no_split, [](Layout& l) { l.nodes[2].link = 4; }},  // one child is beyond the end
      {no_split, [](Layout& l) { l.nodes[2].link = 5; }},  // both are
      {no_split, [](Layout& l) { l.nodes[2].link = 0xffffffffu; }},
      {no_split, [](Layout& l) { l.nodes[2].plane = kNanFloat; }},
      {no_split, [](Layout& l) { l.nodes[2].plane = 0.0f; }},  // in the border of its cell
      {no_split,
       [](Layout& l) {
         l.nodes[2] = {0, 3.0f, 3};
       }},  // in the neighbour's cell
      {no_split, [](Layout& l) { l.nodes[0].plane = kInfFloat; }},
  };
  expectRefused<OccluderDatabase>(threeCells(), faults);
}

TEST(ViewpointDatabaseBytes, AreRefusedWithFaults) {
  expectRefused<ViewpointDatabase>(twoPoints(), faultsOfBoth());
  const std::string no_spacing = "has no spacing", no_point = "has a point that is not finite";
  const std::vector<Fault> faults{
      {"has 0 points", [](Layout& l) { l.places = 0; }}, {no_spacing, [](Layout& l) { l.grid[0] = 0.0; }},
      {no_spacing, [](Layout& l) { l.grid[0] = -1.0; }}, {no_spacing, [](Layout& l) { l.grid[0] = kNan; }},
      {no_spacing, [](Layout& l) { l.grid[0] = kInf; }}, {no_point, [](Layout& l) { l.grid[1] = kNan; }},
      {no_point, [](Layout& l) { l.grid[6] = -kInf; }},
  };
  expectRefused<ViewpointDatabase>(twoPoints(), faults);
}

// Points at the largest numbers: their differences are not finite.
TEST(ViewpointDatabaseBytes, MayHoldPointsAtTheEndOfNumbers) {
  constexpr double kMax = std::numeric_limits<double>::max();
  Layout layout = twoPoints();
  layout.grid = {kMax, -kMax, -kMax, -kMax, kMax, kMax, kMax};
  const auto loaded = ViewpointDatabase::load(layout.bytes(), 10);
  ASSERT_TRUE(loaded) << loaded.error().message;
  Random random(1);
  askEverything(*loaded, 10, random);
}

// More than it builds.
TEST(ViewpointDatabaseBytes, AreRefusedWithTooManyPoints) {
  Layout layout = twoPoints();
  layout.directions = 1;
  layout.places = 65537;
  layout.grid.assign(1 + 3 * 65537, 1.0);
  layout.lists.which.assign(65537, 1);
  layout.lists.which.back() = 2;
  EXPECT_EQ(errorOf<ViewpointDatabase>(layout.bytes(), 10), "the viewpoint database has 65537 points");
  layout.places = 65536;
  layout.grid.resize(layout.grid.size() - 3);
  layout.lists.which.erase(layout.lists.which.begin());
  EXPECT_EQ(errorOf<ViewpointDatabase>(layout.bytes(), 10), "none");
}

}  // namespace
}  // namespace sightline
