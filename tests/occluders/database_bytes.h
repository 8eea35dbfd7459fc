#pragma once

// Tests of the bytes of an occluder database, written once for all kinds of databases. For each kind there
// are functions placeCount, placeOf, expectSamePlace and expectSameMeasures in namespace sightline.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "scenes/procedural.h"
#include "sightline/hierarchy/hierarchy.h"
#include "src/base/byte_stream.h"
#include "tests/occluders/flat_mesh.h"
#include "tests/support/object_arrays.h"

namespace sightline::database_bytes {

using flat_mesh::Random;
using Bytes = std::vector<std::byte>;
using Ids = std::vector<OccluderId>;

inline constexpr double kInf = std::numeric_limits<double>::infinity();
inline constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Model {
  OccluderSet set;
  Hierarchy kd_tree;
  Box bounds;
  std::uint32_t occluders() const { return static_cast<std::uint32_t>(set.occluders.size()); }
};

inline Model modelOf(const Scene& scene) {
  Model model;
  model.set = findOccluders(scene.view());
  const std::vector<Box> boxes = test::boxesOf(scene.objects);
  for (const Box& box : boxes) {
    model.bounds.extend(box);
  }
  model.kd_tree = buildHierarchy(boxes, {}, {.kind = HierarchyKind::kKdTree});
  return model;
}

inline const Model& city() {
  static const Model kCity = modelOf(makeCity({.copies = 1}));
  return kCity;
}

inline const Model& building() {
  static const Model kBuilding = modelOf(makeBuilding({.floors = 2, .plants = 3}));
  return kBuilding;
}

template <typename Database>
Ids listOf(const Database& database, std::uint32_t place, std::uint32_t direction) {
  const auto list = database.list(place, direction);
  return {list.begin(), list.end()};
}

// Viewpoints in the box, around it, far away and not finite.
inline std::vector<Vec3d> viewpoints(const Box& box, Random& random) {
  std::vector<Vec3d> points{{0, 0, 0}, {kNan, kNan, kNan}, {kInf, 0, -kInf}, {1e300, -1e300, 1e300}};
  const Vec3d middle = center(box), extent(box.extent());
  for (int i = 0; i < 300; ++i) {
    const Vec3d p = random.point(0.7);
    points.push_back(middle + Vec3d(p.x * extent.x, p.y * extent.y, p.z * extent.z));
  }
  return points;
}

template <typename Database>
std::string errorOf(const Bytes& bytes, std::uint32_t occluder_count) {
  const auto loaded = Database::load(bytes, occluder_count);
  return loaded ? "none" : loaded.error().message;
}

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// Queries everything in the database, and beyond it: a sanitizer detects reads beyond the end.
template <typename Database>
void askEverything(const Database& database, std::uint32_t occluders, Random& random) {
  const auto expectSound = [&](std::span<const OccluderId> list) {
    for (const OccluderId id : list) {
      ASSERT_LT(id.value, occluders);
    }
  };
  for (std::uint32_t place = 0; place < placeCount(database); ++place) {
    expectSamePlace(database, database, place);
    for (std::uint32_t d = 0; d < database.directionCount(); ++d) {
      expectSound(database.list(place, d));
    }
  }
  for (std::uint32_t d = 0; d < database.directionCount(); ++d) {
    EXPECT_NEAR(length(database.direction(d)), 1.0, 1e-9);
  }
  for (const Vec3d& viewpoint : viewpoints({{-50, -50, -50}, {50, 50, 50}}, random)) {
    ASSERT_LT(placeOf(database, viewpoint), placeCount(database));
    expectSound(database.find(viewpoint, random.point(1.0)));
  }
}

template <typename Database>
void expectSame(const Database& a, const Database& b, const Box& box) {
  ASSERT_EQ(placeCount(a), placeCount(b));
  ASSERT_EQ(a.directionCount(), b.directionCount());
  EXPECT_EQ(a.bytes(), b.bytes());
  expectSameMeasures(a, b);
  for (std::uint32_t place = 0; place < placeCount(a); ++place) {
    expectSamePlace(a, b, place);
    for (std::uint32_t d = 0; d < a.directionCount(); ++d) {
      ASSERT_EQ(listOf(a, place, d), listOf(b, place, d)) << "place " << place << ", direction " << d;
    }
  }
  for (std::uint32_t d = 0; d < a.directionCount(); ++d) {
    EXPECT_EQ(a.direction(d), b.direction(d));
  }
  Random random(7);
  for (const Vec3d& viewpoint : viewpoints(box, random)) {
    EXPECT_EQ(placeOf(a, viewpoint), placeOf(b, viewpoint));
    const Vec3d direction = random.point(1.0);
    EXPECT_EQ(a.nearestDirection(direction), b.nearestDirection(direction));
    EXPECT_TRUE(std::ranges::equal(a.find(viewpoint, direction), b.find(viewpoint, direction)));
  }
}

template <typename Database>
void expectToComeBack(const Database& database, const Model& model) {
  const Bytes bytes = database.save();
  const auto loaded = Database::load(bytes, model.occluders());
  ASSERT_TRUE(loaded) << loaded.error().message;
  expectSame(database, *loaded, model.bounds);
  EXPECT_EQ(loaded->save(), bytes);
}

template <typename Database>
void expectRefusedForOtherSets(const Database& database, std::uint32_t occluders) {
  const Bytes bytes = database.save();
  for (const std::uint32_t count : {0u, occluders - 1, occluders + 1, 0xffffffffu}) {
    const std::string error = errorOf<Database>(bytes, count);
    EXPECT_TRUE(has(error, "is of " + std::to_string(occluders) + " occluders, but the scene has " +
                               std::to_string(count)))
        << error;
  }
}

template <typename Database>
void expectAllTruncationsRefused(const Database& database, const Model& model, const std::string& name) {
  const Bytes bytes = database.save();
  ASSERT_LT(bytes.size(), 20000u);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const Bytes part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    const std::string error = errorOf<Database>(part, model.occluders());
    const std::string expected = "the " + name + " is truncated at byte ";
    ASSERT_EQ(error.substr(0, expected.size()), expected) << size << " of " << bytes.size() << " bytes";
    EXPECT_LE(std::stoull(error.substr(expected.size())), size);
  }
}

// Changes one to four places: a bit, a byte, or a 32-bit or 64-bit number, to a value that is likely to do
// harm.
inline void damage(Bytes& bytes, Random& random) {
  constexpr std::uint64_t kNumbers[] = {0,
                                        1,
                                        2,
                                        3,
                                        0x7fffffffu,
                                        0x80000000u,
                                        0xffffffffu,
                                        0x7f800000u,
                                        0x7fc00000u,
                                        0x2000000000000000u,
                                        0x7ff0000000000000u,
                                        ~std::uint64_t{0}};
  for (std::uint32_t times = 1 + random.below(4); times-- > 0;) {
    // Half of the time near the beginning, where the numbers of things are.
    const auto size = static_cast<std::uint32_t>(bytes.size());
    const std::uint32_t at = random.below(random.below(2) == 0 ? std::min(size, 64u) : size);
    const std::uint32_t kind = random.below(4);
    if (kind == 0) {
      bytes[at] ^= static_cast<std::byte>(1u << random.below(8));
    } else if (kind == 1) {
      bytes[at] = static_cast<std::byte>(random.below(256));
    } else {
      const std::uint64_t number = kNumbers[random.below(std::size(kNumbers))];
      for (std::uint32_t i = 0; i < (kind == 2 ? 4u : 8u) && at + i < size; ++i) {
        bytes[at + i] = static_cast<std::byte>(number >> 8 * i & 0xff);
      }
    }
  }
}

// If changed bytes are accepted, all of them are part of the database: saving it gives the same bytes.
template <typename Database>
void expectDamageDoesNoHarm(const Database& database, std::uint32_t occluders) {
  const Bytes sound = database.save();
  std::uint32_t loaded_ones = 0, refused = 0;
  for (std::uint64_t seed = 1; seed <= 4000; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    Bytes bytes = sound;
    damage(bytes, random);
    const auto loaded = Database::load(bytes, occluders);
    if (!loaded) {
      ++refused;
      EXPECT_FALSE(has(loaded.error().message, "\n"));
      continue;
    }
    ++loaded_ones;
    askEverything(*loaded, occluders, random);
    EXPECT_EQ(loaded->save(), bytes);
  }
  EXPECT_GT(loaded_ones, 100u);  // so that the queries were tried
  EXPECT_GT(refused, 1000u);
}

// Two different lists, {9, 0} and {5}.
struct SavedLists {
  std::uint64_t different = 2;
  std::vector<std::uint32_t> lengths{2, 1};
  std::vector<std::uint64_t> which;
  std::vector<std::uint32_t> ids{9, 0, 5};
};

struct Layout {
  std::string letters;
  std::uint32_t version = 1, directions = 2, occluders = 10;
  std::uint32_t places = 0;
  // An occluder database has a box and nodes.
  std::vector<float> box;
  struct Node {
    std::uint8_t axis = 3;
    float plane = 0.0f;
    std::uint32_t link = 0;
  };
  std::vector<Node> nodes;
  // A viewpoint database has a grid: the spacing and the points.
  std::vector<double> grid;
  SavedLists lists;
  std::string rest;

  Bytes bytes() const {
    base::ByteWriter writer;
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

inline Ids idsOf(std::initializer_list<std::uint32_t> values) {
  Ids ids;
  for (const std::uint32_t value : values) {
    ids.emplace_back(value);
  }
  return ids;
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

inline std::vector<Fault> faultsOfBoth() {
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

}  // namespace sightline::database_bytes
