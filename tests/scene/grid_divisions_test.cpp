#include "src/scene/grid_divisions.h"

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/instruction_sets.h"
#include "tests/support/rounds.h"

namespace sightline::scene {
namespace {

// A grid of unit cells of which some are marked, the outermost ones among them.
struct Cells {
  std::vector<std::array<int, 3>> marked;
  std::vector<Vec3f> corners;
  int slabs;

  explicit Cells(std::uint32_t seed) : slabs(seed % 2 == 0 ? 16 : 32) {
    std::mt19937 random(seed);
    // Some blocks of cells, as an object of several parts has them.
    const int end = slabs - 1;
    std::vector<std::array<int, 6>> blocks{{0, 0, 0, 1, 1, 1}, {end, end, end, slabs, slabs, slabs}};
    for (std::uint32_t i = 0; i < 1 + seed % 5; ++i) {
      std::array<int, 6> block{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        block[axis] = static_cast<int>(random() % static_cast<unsigned>(end));
        block[axis + 3] =
            block[axis] + 1 + static_cast<int>(random() % static_cast<unsigned>(slabs - block[axis]));
      }
      blocks.push_back(block);
    }
    for (const std::array<int, 6>& b : blocks) {
      for (int x = b[0]; x < b[3]; ++x) {
        for (int y = b[1]; y < b[4]; ++y) {
          for (int z = b[2]; z < b[5]; ++z) {
            marked.push_back({x, y, z});
          }
        }
      }
    }
    for (int i = 1; i < slabs; ++i) {
      marked.push_back({i, i, i});  // so that there is a corner at each plane
    }
    while (slabs > 16 && marked.size() < kManyTriangles) {
      marked.push_back({0, 0, 0});  // only meshes of many triangles have so many slabs
    }
    for (const auto& [x, y, z] : marked) {
      const Vec3f at(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
      for (const Vec3f& corner : {at, at + Vec3f(1, 1, 0), at + Vec3f(1, 0, 1)}) {
        corners.push_back(corner);
      }
    }
  }
  CellGrid grid() const {
    const auto side = static_cast<float>(slabs);
    return CellGrid({{0, 0, 0}, {side, side, side}}, corners);
  }
};

// The volume of a box around the marked cells between slabs along an axis, by the definition: it ends at the
// dividing plane if there are cells beside it, or at the side of the whole, and otherwise in the middle of a
// slab; each side counts as longer by a 16th of the whole box's.
double volumeOf(const Cells& cells, std::size_t axis, int first, int last) {
  std::array<int, 3> low{99, 99, 99}, high{-1, -1, -1};
  for (const std::array<int, 3>& cell : cells.marked) {
    if (cell[axis] >= first && cell[axis] <= last) {
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], cell[a]);
        high[a] = std::max(high[a], cell[a]);
      }
    }
  }
  double volume = 1.0;
  for (std::size_t a = 0; a < 3; ++a) {
    const double begin = low[a] == (a == axis ? first : 0) ? low[a] : low[a] + 0.5;
    const double end = high[a] == (a == axis ? last : cells.slabs - 1) ? high[a] + 1.0 : high[a] + 0.5;
    volume *= (end - begin) / cells.slabs + 1.0 / 16.0;
  }
  return volume;
}

TEST(GridDivisions, TheFirstDivisionSavesAsMuchAsAnyCan) {
  std::size_t saves = 0;
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    const Cells cells(seed);
    ASSERT_EQ(cells.grid().slabs(0).count, static_cast<std::uint32_t>(cells.slabs));
    double least = 1e30;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (int plane = 1; plane < cells.slabs; ++plane) {
        least = std::min(least,
                         volumeOf(cells, axis, 0, plane - 1) + volumeOf(cells, axis, plane, cells.slabs - 1));
      }
    }
    DivisionTree tree;
    findDivisions(cells.grid(), {.max_boxes = 2, .max_divided = 1}, tree);
    const DivisionTree::Node& root = tree.nodes[0];
    ASSERT_EQ(tree.node_count, 3u);
    const double whole = std::pow(17.0 / 16.0, 3);
    EXPECT_NEAR(root.min_volume[1], whole, 1e-4);
    // Planes in the middle rank before others by up to a thousandth of the whole.
    const double chosen = tree.nodes[1].min_volume[1] + double{tree.nodes[2].min_volume[1]};
    EXPECT_GE(chosen, least - 1e-4) << "seed " << seed;
    EXPECT_LE(chosen, least + 1.1e-3 * whole) << "seed " << seed;
    EXPECT_EQ(tree.boxes == 2, chosen < root.min_volume[1]) << "seed " << seed;
    saves += tree.boxes == 2 ? 1 : 0;
  }
  EXPECT_GT(saves, 100u);
}

// Marked cells of a grid with any number of slabs, from its own masks.
struct MarkedCells {
  const CellGrid& grid;
  std::array<std::array<std::uint32_t, 2>, 3> reach{};  // the first and the last slab that is not empty

  // The volume of a box around the marked cells between two slabs along an axis, by the definition above.
  double volumeOf(int axis, std::uint32_t first, std::uint32_t last, bool whole) {
    std::array<std::array<std::uint32_t, 2>, 3> of{};
    of.fill({99, 0});
    for (std::uint32_t x = 0; x < grid.slabs(0).count; ++x) {
      for (std::uint32_t y = 0; y < grid.slabs(1).count; ++y) {
        for (std::uint32_t z = 0; z < grid.slabs(2).count; ++z) {
          const std::array<std::uint32_t, 3> cell{x, y, z};
          const std::uint32_t at = cell[static_cast<std::size_t>(axis)];
          if ((grid.marked(x)[y] >> z & 1) == 0 || at < first || at > last) {
            continue;
          }
          for (std::size_t a = 0; a < 3; ++a) {
            of[a] = {std::min(of[a][0], cell[a]), std::max(of[a][1], cell[a])};
          }
        }
      }
    }
    reach = whole ? of : reach;
    double volume = 1.0;
    for (int a = 0; a < 3; ++a) {
      const Slabs& slabs = grid.slabs(a);
      const auto [low, high] = of[static_cast<std::size_t>(a)];
      const auto [all_low, all_high] = reach[static_cast<std::size_t>(a)];
      const auto middle = [&](std::uint32_t i) {
        return 0.5 * (double{slabs.low[i]} + double{slabs.high[i]});
      };
      const bool ends_low = a == axis && low == first && first > all_low;
      const bool ends_high = a == axis && high == last && last < all_high;
      const double begin = ends_low || low == 0 ? slabs.low[low] : middle(low);
      const double end = ends_high || high + 1 == slabs.count ? slabs.high[high] : middle(high);
      volume *= end - begin + 1.0 / 16.0;
    }
    return volume;
  }
};

// So far from the origin, a side has few numbers in single precision, and so any number of slabs.
TEST(GridDivisions, TheFirstDivisionSavesAsMuchAsAnyCanInGridsOfAnyNumberOfSlabs) {
  constexpr float kFarAway = 0x1p20f, kStep = 0x1p-3f;
  std::array<std::size_t, kMaxSlabs + 1> counts{};
  for (std::uint32_t seed = 0; seed < test::rounds(600u); ++seed) {
    std::mt19937 random(seed);
    const std::uint32_t clumps = 2 + seed % 6, triangles = seed % 2 == 0 ? 40 : 200;
    // Clumps of triangles that are up to a third of the side wide.
    const auto steps = 9 + static_cast<std::uint32_t>(random() % 23);
    std::vector<std::array<std::uint32_t, 3>> middles(clumps);
    for (std::array<std::uint32_t, 3>& middle : middles) {
      for (std::uint32_t& at : middle) {
        at = static_cast<std::uint32_t>(random() % steps);
      }
    }
    std::vector<Vec3f> corners;
    Box box;
    for (std::uint32_t t = 0; t < triangles; ++t) {
      for (int k = 0; k < 3; ++k) {
        Vec3f corner;
        for (int axis = 0; axis < 3; ++axis) {
          const auto by = static_cast<std::uint32_t>(random() % (steps / 3));
          const std::uint32_t at = middles[t % clumps][static_cast<std::size_t>(axis)] + by;
          corner[axis] = kFarAway + kStep * static_cast<float>(std::min(at, steps));
        }
        corners.push_back(corner);
        box.extend(corner);
      }
    }
    const CellGrid grid(box, corners);
    MarkedCells cells{grid};
    DivisionTree tree;
    findDivisions(grid, {.max_boxes = 2, .max_divided = 1}, tree);
    const double whole = cells.volumeOf(0, 0, kMaxSlabs, true);
    EXPECT_NEAR(tree.nodes[0].min_volume[1], whole, 1e-4) << "seed " << seed;
    double least = 1e30;
    for (int axis = 0; axis < 3; ++axis) {
      const auto [first, last] = cells.reach[static_cast<std::size_t>(axis)];
      ++counts[grid.slabs(axis).count];
      for (std::uint32_t plane = first + 1; plane <= last; ++plane) {
        least = std::min(
            least, cells.volumeOf(axis, first, plane - 1, false) + cells.volumeOf(axis, plane, last, false));
      }
    }
    ASSERT_EQ(tree.node_count, 3u) << "seed " << seed;
    const double chosen = tree.nodes[1].min_volume[1] + double{tree.nodes[2].min_volume[1]};
    EXPECT_GE(chosen, least - 1e-4) << "seed " << seed;
    EXPECT_LE(chosen, least + 0.11 * whole) << "seed " << seed;
  }
  std::size_t between = 0;
  for (std::uint32_t slabs = 9; slabs < kMaxSlabs; ++slabs) {
    between += slabs == 16 ? 0 : counts[slabs];
  }
  EXPECT_GT(between, test::rounds(300u));
}

TEST(GridDivisions, MoreDivisionsAndBoxesNeverTakeMoreVolume) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    const Cells cells(seed);
    float before = 1e30f;
    for (const std::uint32_t divided : {1u, 3u, 15u, DivisionTree::kMaxDivided}) {
      DivisionTree tree;
      findDivisions(cells.grid(), {.max_divided = divided}, tree);
      const auto& min_volume = tree.nodes[0].min_volume;
      for (std::uint32_t count = 2; count <= kMaxObjectBoxes; ++count) {
        EXPECT_LE(min_volume[count], min_volume[count - 1]);
      }
      EXPECT_LE(min_volume[kMaxObjectBoxes], before);
      before = min_volume[kMaxObjectBoxes];
      EXPECT_LE(tree.node_count, 2 * divided + 1);
    }
  }
}

TEST(GridDivisions, ABoxThatSavesLessThanItCostsIsNotKept) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    DivisionTree tree;
    for (const double min_saving : {0.001, 0.01, 0.1, 1.0}) {
      findDivisions(Cells(seed).grid(), {.min_saving = min_saving}, tree);
      const auto& min_volume = tree.nodes[0].min_volume;
      const double price = min_saving * min_volume[1];
      for (std::uint32_t count = 1; count <= kMaxObjectBoxes; ++count) {
        EXPECT_LE(min_volume[tree.boxes] + price * tree.boxes, min_volume[count] + price * count + 1e-4);
      }
    }
    EXPECT_EQ(tree.boxes, 1u) << "nothing saves all";
  }
}

TEST(GridDivisions, AGridWithNothingInItIsOneBox) {
  DivisionTree tree;
  findDivisions(Cells(1).grid(), {}, tree);
  EXPECT_GT(tree.boxes, 1u);
  findDivisions(CellGrid({{0, 0, 0}, {1, 2, 3}}, {}), {}, tree);
  EXPECT_EQ(tree.boxes, 1u);
  EXPECT_EQ(tree.node_count, 1u);
}

TEST(GridDivisions, EveryInstructionSetGivesTheSameTree) {
  for (std::uint32_t seed = 0; seed < 20; ++seed) {
    const CellGrid grid = Cells(seed).grid();
    std::vector<DivisionTree> trees;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      const test::ForcedInstructionSet forced(target);
      findDivisions(grid, {}, trees.emplace_back());
    }
    ASSERT_FALSE(trees.empty());
    for (const DivisionTree& tree : trees) {
      ASSERT_EQ(tree.node_count, trees[0].node_count);
      EXPECT_EQ(tree.boxes, trees[0].boxes);
      for (std::uint32_t n = 0; n < tree.node_count; ++n) {
        EXPECT_EQ(tree.nodes[n].min_volume, trees[0].nodes[n].min_volume);
        EXPECT_EQ(tree.nodes[n].plane, trees[0].nodes[n].plane);
        EXPECT_EQ(tree.nodes[n].first_half, trees[0].nodes[n].first_half);
      }
    }
  }
}

}  // namespace
}  // namespace sightline::scene
