#include "sightline/pvs/query/set_query.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/pvs/sight_checks.h"
#include "tests/support/not_finite.h"

namespace sightline::sight_test {
namespace {

using test::kInfinity;
using test::kNan;

// A file in memory and the data that it was made from.
struct Made {
  explicit Made(const made::Visibility& settings)
      : baked(made::visibility(settings)), bytes(bytesOf(baked)) {}

  SightFile file() const { return *opened(bytes); }
  SetQuery query(std::size_t cache_bytes = 16u << 20) const {
    return SetQuery(file(), {.cache_bytes = cache_bytes});
  }

  BakedVisibility baked;
  Bytes bytes;
};

std::vector<Made> someOctrees() {
  std::vector<Made> all;
  for (std::uint32_t seed = 1; seed <= 4; ++seed) {
    all.emplace_back(made::Visibility{.seed = seed, .leaves = seed * 100, .depth = seed + 1, .sets = 50});
  }
  all.emplace_back(made::Visibility{.leaves = 1, .depth = 0, .plane_every = 1});
  for (const std::uint32_t every : {1u, 3u}) {
    all.emplace_back(made::Visibility{.leaves = 200, .depth = 5, .partly_every = every});
  }
  return all;
}

// Searches all leaves. Cells include their lower borders; the last ones along an axis include the upper ones
// too.
CellPlace placeByLookingAtAll(const OctreeView& octree, const Vec3d& eye) {
  CellPlace place;
  forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) {
    const Vec3d min = cellMin(octree.min, octree.max, cell);
    const Vec3d max = cellMax(octree.min, octree.max, cell);
    for (int axis = 0; axis < 3; ++axis) {
      const bool last = cell.at[static_cast<std::size_t>(axis)] + 1 == 1u << cell.level;
      if (!(eye[axis] >= min[axis] && (eye[axis] < max[axis] || (last && eye[axis] == max[axis])))) {
        return;
      }
    }
    EXPECT_EQ(place.leaf, CellPlace::kOutside) << "cells overlap";
    place.leaf = leaf;
    place.cell = cell;
  });
  if (place.leaf != CellPlace::kOutside) {
    const OctreeLeaf& leaf = octree.leaves[place.leaf];
    place.set = leaf.set;
    if (leaf.plane != OctreeLeaf::kNoPlane) {
      const CellPlane& plane = octree.planes[leaf.plane];
      const double d = plane.normal.x * eye.x + plane.normal.y * eye.y + plane.normal.z * eye.z;
      place.set = d >= plane.front ? leaf.front_set : d <= plane.back ? leaf.back_set : leaf.set;
    }
    if (!octree.viewers.empty()) {
      const ViewerBounds& viewers = octree.viewers[place.leaf];
      const Vec3d min = viewersMin(octree.min, octree.max, place.cell, viewers);
      const Vec3d max = viewersMax(octree.min, octree.max, place.cell, viewers);
      for (int axis = 0; axis < 3; ++axis) {
        if (viewers != ViewerBounds{} && !(eye[axis] >= min[axis] && eye[axis] <= max[axis])) {
          place.set = VisibleSet::kEverything;
        }
      }
    }
  }
  return place;
}

Vec3d nudged(Vec3d point, made::Random& random) {
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t way = random() % 3;
    point[axis] = way == 0 ? point[axis] : std::nextafter(point[axis], way == 1 ? -kInfinity : kInfinity);
  }
  return point;
}

// Points anywhere in and near the octree, on corners of cells and one rounding step beside them, and on
// cells' planes.
std::vector<Vec3d> trickyPoints(const OctreeView& octree, std::uint32_t seed) {
  made::Random random(seed);
  std::vector<Vec3d> points;
  const Vec3d extent = octree.max - octree.min;
  for (int i = 0; i < 300; ++i) {
    points.push_back(made::point(random, octree.min - extent * 0.1, octree.max + extent * 0.1));
    OctreeCell cell{random() % 7, {}};
    for (std::uint32_t& at : cell.at) {
      at = random() % ((1u << cell.level) + 1);
    }
    points.push_back(cellMin(octree.min, octree.max, cell));
    points.push_back(nudged(points.back(), random));
    Vec3d on_faces = made::point(random, octree.min, octree.max);
    on_faces[static_cast<int>(random() % 3)] = points.back()[static_cast<int>(random() % 3)];
    points.push_back(on_faces);
  }
  for (const Vec3d& corner : {octree.min, octree.max}) {
    points.push_back(corner);
    for (int i = 0; i < 20; ++i) {
      points.push_back(nudged(corner, random));
    }
  }
  return points;
}

std::vector<Vec3d> pointsOutside(const OctreeView& octree) {
  std::vector<Vec3d> points;
  const Vec3d inside = (octree.min + octree.max) * 0.5;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double value :
         {std::nextafter(octree.min[axis], -kInfinity), std::nextafter(octree.max[axis], kInfinity), 1e300,
          -1e300, kInfinity, -kInfinity, kNan}) {
      points.push_back(inside);
      points.back()[axis] = value;
    }
  }
  points.push_back({kNan, kNan, kNan});
  return points;
}

void expectPlace(const CellPlace& place, const CellPlace& expected, const Vec3d& eye) {
  ASSERT_EQ(place.leaf, expected.leaf) << eye.x << " " << eye.y << " " << eye.z;
  if (place.leaf != CellPlace::kOutside) {
    EXPECT_EQ(place.cell, expected.cell);
    EXPECT_EQ(place.set, expected.set);
  }
}

void expectEverything(const VisibleSet& set) {
  EXPECT_EQ(set.id, VisibleSet::kEverything);
  ASSERT_EQ(set.nodes.size(), 1u);
  EXPECT_EQ(set.nodes[0], 0u);
}

TEST(SetQuery, FindsTheLeafThatALookAtAllLeavesFinds) {
  for (const Made& made : someOctrees()) {
    SetQuery query = made.query();
    const OctreeView octree = made.baked.octree.view();
    std::size_t inside = 0;
    for (const Vec3d& eye : trickyPoints(octree, 7)) {
      const CellPlace expected = placeByLookingAtAll(octree, eye);
      expectPlace(query.locate(eye), expected, eye);
      inside += expected.leaf != CellPlace::kOutside ? 1 : 0;
    }
    EXPECT_GT(inside, 300u);
  }
}

TEST(SetQuery, HandsOutTheSetOfThatLeaf) {
  for (const Made& made : someOctrees()) {
    SetQuery query = made.query();
    const OctreeView octree = made.baked.octree.view();
    for (const Vec3d& eye : trickyPoints(octree, 8)) {
      const CellPlace expected = placeByLookingAtAll(octree, eye);
      const VisibleSet set = query.find(eye, 0.25);
      if (expected.leaf == CellPlace::kOutside || expected.set == VisibleSet::kEverything) {
        expectEverything(set);
        continue;
      }
      EXPECT_EQ(set.id, expected.set);
      EXPECT_TRUE(sameBytes<std::uint32_t>(set.nodes, made.baked.sets[expected.set]));
    }
  }
}

TEST(SetQuery, FindsTheSameFromTheLastLeafAsFromNothing) {
  const Made made({.leaves = 500, .depth = 6, .sets = 50});
  const OctreeView octree = made.baked.octree.view();
  made::Random random(11);
  SetQuery warm = made.query();
  Vec3d eye = (octree.min + octree.max) * 0.5;
  for (int i = 0; i < 3000; ++i) {
    // Steps of all sizes, out of the octree and back.
    const double step = std::pow(10.0, made::number(random, -3.0, 2.0));
    eye += made::point(random, {-step, -step, -step}, {step, step, step});
    eye = random() % 50 == 0 ? made::point(random, octree.min, octree.max) : eye;
    SetQuery cold = made.query();
    expectPlace(warm.locate(eye), cold.locate(eye), eye);
  }
}

TEST(SetQuery, AnswersEverythingOutside) {
  for (const Made& made : someOctrees()) {
    SetQuery query = made.query();
    const std::vector<Vec3d> outside = pointsOutside(made.baked.octree.view());
    for (const Vec3d& eye : outside) {
      expectEverything(query.find(eye, 0.25));
      EXPECT_EQ(query.locate(eye).leaf, CellPlace::kOutside);
    }
    EXPECT_EQ(query.stats().outside, outside.size());
    EXPECT_EQ(query.stats().finds, outside.size());
    // It also finds its way back.
    const Vec3d inside = (made.baked.octree.min + made.baked.octree.max) * 0.5;
    EXPECT_NE(query.locate(inside).leaf, CellPlace::kOutside);
  }
}

TEST(SetQuery, AnswersEverythingForANearDistanceBeyondThatOfTheBake) {
  const Made made({});
  SetQuery query = made.query();
  const Vec3d inside = (made.baked.octree.min + made.baked.octree.max) * 0.5;
  for (const double near : {std::nextafter(0.25, 1.0), 1.0, kInfinity, kNan}) {
    expectEverything(query.find(inside, near));
  }
  EXPECT_EQ(query.stats().beyond_near, 4u);
  for (const double near : {0.25, 0.1, 0.0}) {
    EXPECT_NE(query.find(inside, near).id, VisibleSet::kEverything);
  }
}

TEST(SetQuery, TakesTheSideThatThePlaneSays) {
  BakedVisibility baked = made::visibility({.leaves = 1, .depth = 0, .sets = 5, .plane_every = 0});
  baked.octree.planes = {{{0, 1, 0}, 2.0, 1.5}};
  baked.octree.leaves[0] = {4, 0, 2, 3};
  const Bytes bytes = bytesOf(baked);
  SetQuery query(*opened(bytes));
  for (const auto& [y, set] :
       {std::pair{3.0, 2u}, {2.0, 2u}, {1.999, 4u}, {1.501, 4u}, {1.5, 3u}, {-9.0, 3u}}) {
    EXPECT_EQ(query.find({0, y, 0}, 0.25).id, set) << y;
  }
}

TEST(SetQuery, AnswersEverythingWhereNoViewerIsExpectedInTheCell) {
  BakedVisibility baked = made::visibility({.leaves = 1, .depth = 0, .sets = 5, .plane_every = 0});
  baked.octree.min = {0, 0, 0};
  baked.octree.max = {256, 256, 256};
  baked.octree.viewers = {{{10, 0, 200}, {19, 255, 255}}};
  const Bytes bytes = bytesOf(baked);
  SetQuery query(*opened(bytes));
  const std::vector<std::pair<Vec3d, bool>> eyes{
      {{10, 5, 210}, true},     {{20, 5, 210}, true},      {{15, 0, 200}, true},      {{15, 256, 256}, true},
      {{9.999, 5, 210}, false}, {{20.001, 5, 210}, false}, {{15, 5, 199.999}, false}, {{15, 5, 230}, true}};
  std::uint64_t outside = 0;
  for (const auto& [eye, expected] : eyes) {
    EXPECT_EQ(query.find(eye, 0.25).id != VisibleSet::kEverything, expected) << eye.x << " " << eye.z;
    outside += expected ? 0 : 1;
    EXPECT_EQ(query.stats().outside, outside);
  }
}

// Where min + (max - min) rounds to another value than max, no cell extends beyond the smaller of the two.
TEST(SetQuery, IsOutsideBeyondTheLastGridLine) {
  made::Random random(21);
  int before = 0, beyond = 0;
  while (before < 20 || beyond < 20) {
    BakedVisibility baked = made::visibility({.leaves = 8, .plane_every = 0});
    const double min = -made::number(random, 0.0, 1.0);
    const double max = made::number(random, 0.0, 1.0) + 0.01;
    const double line = gridLine(min, max, 0, 1);
    (line < max ? before : beyond) += line == max ? 0 : 1;
    baked.octree.min = {min, min, min};
    baked.octree.max = {max, max, max};
    const Bytes bytes = bytesOf(baked);
    SetQuery query(*opened(bytes));
    const double upper = std::min(line, max);
    EXPECT_NE(query.find({upper, 0, 0}, 0.1).id, VisibleSet::kEverything);
    expectEverything(query.find({std::nextafter(upper, 2.0), 0, 0}, 0.1));
  }
}

TEST(SetQuery, KeepsTheBudgetAndTheSetsUsedLast) {
  const Made made(
      {.objects = 3000, .leaves = 400, .depth = 6, .sets = 200, .set_nodes = 60, .plane_every = 0});
  const OctreeView octree = made.baked.octree.view();
  made::Random random(13);
  for (const std::size_t budget :
       {std::size_t{0}, std::size_t{1000}, std::size_t{5000}, std::size_t{1} << 20}) {
    SetQuery query = made.query(budget);
    std::set<std::uint32_t> seen;
    for (int i = 0; i < 4000; ++i) {
      const Vec3d eye = made::point(random, octree.min, octree.max);
      const std::uint64_t decoded = query.stats().decoded;
      const VisibleSet set = query.find(eye, 0.25);
      ASSERT_TRUE(sameBytes<std::uint32_t>(set.nodes, made.baked.sets[set.id])) << "budget " << budget;
      const std::size_t most = std::max(budget, set.nodes.size() * 5 / 4 * 4 + 64);
      ASSERT_LE(query.stats().cached_bytes, most);
      if (seen.insert(set.id).second) {
        EXPECT_EQ(query.stats().decoded, decoded + 1);
      }
      // The second look-up finds the set in the cache.
      const std::uint64_t before = query.stats().decoded;
      EXPECT_EQ(query.find(eye, 0.25).id, set.id);
      EXPECT_EQ(query.stats().decoded, before);
    }
    EXPECT_GT(seen.size(), 60u);
    if (budget == 1u << 20) {
      EXPECT_EQ(query.stats().decoded, seen.size()) << "all of them fit";
    } else {
      EXPECT_GT(query.stats().decoded, seen.size() * 2) << "so few bytes cannot hold them";
    }
  }
}

// With room for two sets, A B A C evicts B, not A.
TEST(SetQuery, DropsTheSetUsedLeastRecently) {
  BakedVisibility baked = made::visibility({.leaves = 8, .depth = 1, .sets = 8, .plane_every = 0});
  baked.sets = {};
  for (std::uint32_t set = 0; set < 8; ++set) {
    // Each set has one node, so that all have the same size.
    baked.sets.nodes.push_back(baked.boxes.nodes[0].end - 1);
    baked.sets.first.push_back(baked.sets.nodes.size());
  }
  const Bytes bytes = bytesOf(baked);
  SetQuery query(*opened(bytes), {.cache_bytes = 2 * sizeof(std::uint32_t)});
  const auto visit = [&](std::uint32_t child) {
    const Vec3d quarter = (baked.octree.max - baked.octree.min) * 0.25;
    Vec3d eye = baked.octree.min + quarter;
    for (int axis = 0; axis < 3; ++axis) {
      eye[axis] += (child >> axis & 1) != 0 ? 2.0 * quarter[axis] : 0.0;
    }
    const std::uint64_t before = query.stats().decoded;
    EXPECT_EQ(query.find(eye, 0.1).id, child);
    return query.stats().decoded > before;
  };
  const std::uint32_t a = 0, b = 3, c = 7;
  EXPECT_TRUE(visit(a));
  EXPECT_TRUE(visit(b));
  EXPECT_FALSE(visit(a));
  EXPECT_TRUE(visit(c));
  EXPECT_FALSE(visit(a)) << "it was used after b";
  EXPECT_TRUE(visit(b)) << "nothing made room for c";
}

TEST(SetQuery, CountsWhatStaysInTheCell) {
  const Made made({.leaves = 8, .depth = 1, .plane_every = 0});
  SetQuery query = made.query();
  const Vec3d lower = made.baked.octree.min + Vec3d(1, 1, 1);
  const Vec3d upper = made.baked.octree.max - Vec3d(1, 1, 1);
  for (const Vec3d& eye : {lower, lower, lower, upper, upper, lower}) {
    query.find(eye, 0.1);
  }
  EXPECT_EQ(query.stats().finds, 6u);
  EXPECT_EQ(query.stats().same_cell, 3u);
}

TEST(SetQuery, AnswersEverythingForABrokenChunkAndGoesOn) {
  const Made made({.objects = 3000, .leaves = 200, .sets = 200, .set_nodes = 80, .plane_every = 0});
  const pvs::EncodedChunks encoded = pvs::encodeChunks(made.baked);
  ASSERT_GT(encoded.set_chunks, 2u);
  // A byte in the middle of the second chunk, wherever the payload is in the file.
  Bytes bytes = made.bytes;
  const auto payload =
      std::search(bytes.begin(), bytes.end(), encoded.payload.begin(), encoded.payload.end());
  ASSERT_NE(payload, bytes.end());
  const pvs::Chunk& chunk = encoded.chunks[1];
  *(payload + static_cast<std::ptrdiff_t>(chunk.offset + chunk.bytes / 2)) ^= std::byte{4};

  const Result<SightFile> file = opened(bytes);
  ASSERT_TRUE(file) << "chunks are looked at when they are needed";
  EXPECT_FALSE(file->verifyAll());
  SetQuery query(*file);
  made::Random random(17);
  std::uint64_t broken = 0;
  for (int i = 0; i < 500; ++i) {
    const Vec3d eye = made::point(random, made.baked.octree.min, made.baked.octree.max);
    const std::uint32_t set = query.locate(eye).set;
    const VisibleSet answer = query.find(eye, 0.1);
    if (encoded.sets[set].chunk == 1) {
      expectEverything(answer);
      ++broken;
    } else {
      EXPECT_TRUE(sameBytes<std::uint32_t>(answer.nodes, made.baked.sets[set]));
    }
  }
  EXPECT_GT(broken, 0u);
  EXPECT_EQ(query.stats().broken, broken);
}

TEST(SetQuery, LivesOnWhenItsFileObjectIsGoneAndItIsMoved) {
  const Made made({});
  SetQuery query = made.query();
  const Vec3d eye = (made.baked.octree.min + made.baked.octree.max) * 0.5;
  const std::uint32_t id = query.find(eye, 0.1).id;
  SetQuery moved = std::move(query);
  EXPECT_EQ(moved.find(eye, 0.1).id, id);
  EXPECT_TRUE(sameTree(moved.boxes(), made.baked.boxes.view()));
  query = std::move(moved);
  EXPECT_EQ(query.find(eye, 0.1).id, id);
}

}  // namespace
}  // namespace sightline::sight_test
