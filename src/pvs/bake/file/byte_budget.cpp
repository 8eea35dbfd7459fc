// Based on: Breiman, Friedman, Olshen, Stone. Classification and Regression Trees. 1984, section 3.3
// (minimal cost-complexity pruning). The cost of a tree of cells is what a viewer sees in the mean, plus a
// price for each byte. For a given price, the best tree is found from the leaves up, and the price is
// searched for which it has as many bytes as allowed.

#include "src/pvs/bake/file/byte_budget.h"

#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "src/pvs/bake/file/encode_sight.h"
#include "src/pvs/bake/file/flatten.h"

namespace sightline::pvs {
namespace {

// The size of the viewers' space in a leaf, as a fraction of the root.
double viewerVolume(const BakedCell& leaf) {
  if (leaf.reason == StopReason::kOutside) {
    return 0.0;
  }
  return std::ldexp(volumeOf(leaf.viewers), -3 * static_cast<int>(leaf.level));
}

// About how many bytes of the file are the leaf's. Equal sets are stored once, which is not known here.
double bytesOf(const BakedCell& leaf) {
  constexpr double kLeafBytes = 28.0, kRunBytes = 2.0;  // a leaf in the octree; a run of a compressed set
  const CellSets& sets = leaf.sets;
  std::size_t runs = sets.whole.size() + sets.front.size() + sets.back.size();
  for (const DoorRuns* doors : {&sets.whole_doors, &sets.front_doors, &sets.back_doors}) {
    for (const HiddenByDoors& hidden : *doors) {
      runs += hidden.hidden.size();
    }
  }
  return kLeafBytes + kRunBytes * static_cast<double>(runs);
}

// A cell, and what it is as a leaf: itself, or what all below it become together.
struct Choice {
  BakedCell as_leaf;
  double volume = 0.0;           // of the viewers' space in the cell
  double triangles = 0.0;        // of the leaf, times that volume
  double bytes = 0.0;            // of the leaf
  std::vector<Choice> children;  // eight or none
};

// What leaves become together. Where their planes differ, it has none. Where nobody has asked about all of
// the box around their viewers, it holds all objects.
BakedCell togetherOf(const BakeScene& scene, std::vector<BakedCell> leaves) {
  std::optional<BakedCell> one = joined(scene, leaves);
  if (!one) {
    for (BakedCell& leaf : leaves) {
      leaf.sets = {.whole = std::move(leaf.sets.whole), .whole_doors = std::move(leaf.sets.whole_doors)};
    }
    one = joined(scene, leaves);
  }
  return one ? std::move(*one) : allObjectsIn(scene, leaves);
}

Choice choiceOf(const BakeScene& scene, const BakedCell& cell) {
  Choice choice;
  if (cell.leaf()) {
    choice.as_leaf = cell;
    choice.volume = viewerVolume(cell);
  } else {
    std::vector<BakedCell> leaves;
    for (const BakedCell& child : cell.children) {
      choice.children.push_back(choiceOf(scene, child));
      leaves.push_back(choice.children.back().as_leaf);
      choice.volume += choice.children.back().volume;
    }
    choice.as_leaf = togetherOf(scene, std::move(leaves));
  }
  choice.triangles = choice.volume * static_cast<double>(trianglesOf(scene, choice.as_leaf.sets));
  choice.bytes = bytesOf(choice.as_leaf);
  return choice;
}

// Makes the tree that costs least at this price of a byte, and returns its cost.
double cheapest(const Choice& choice, double price, std::uint32_t level, BakedCell& cell) {
  const double as_leaf = choice.triangles + price * choice.bytes;
  if (!choice.children.empty()) {
    cell.level = static_cast<std::uint8_t>(level);
    cell.children.resize(choice.children.size());
    double divided = 0.0;
    for (std::size_t i = 0; i < choice.children.size(); ++i) {
      divided += cheapest(choice.children[i], price, level + 1, cell.children[i]);
    }
    if (divided < as_leaf) {
      return divided;
    }
  }
  cell = choice.as_leaf;
  return as_leaf;
}

}  // namespace

Status fitBytes(const BakeScene& scene, const BakedCell& root, std::uint64_t bytes, BakedVisibility& baked) {
  Status last = Success{};  // whether the file with the last cells fits
  const auto fits = [&](const BakedCell& cells) {
    const Vec3d min = baked.octree.min, max = baked.octree.max;
    baked.octree = {};
    baked.octree.min = min;
    baked.octree.max = max;
    baked.sets = {};
    baked.doors = {};
    flatten(cells, scene, baked);
    const Result<SightBytes> file = encodeSight(baked);
    if (!file) {
      last = file.error();
    } else if (file->size() > bytes) {
      last = Error{"the file has " + std::to_string(file->size()) +
                   " bytes even with the fewest cells, more than the byte budget of " +
                   std::to_string(bytes) + "; give a larger one"};
    } else {
      last = Success{};
    }
    return last.has_value();
  };
  if (fits(root)) {
    return last;
  }
  const Choice choices = choiceOf(scene, root);
  const auto fitsAt = [&](double price) {
    BakedCell cells;
    cheapest(choices, price, root.level, cells);
    return fits(cells);
  };
  // Prices are powers of two here: at the highest, one byte is worth all triangles of the scene.
  constexpr int kSteps = 12;
  double low = -60.0, high = std::log2(static_cast<double>(scene.boxes.nodes[0].triangles) + 1.0);
  if (!fitsAt(std::exp2(high))) {
    return last;
  }
  for (int step = 0; step < kSteps; ++step) {
    const double middle = 0.5 * (low + high);
    (fitsAt(std::exp2(middle)) ? high : low) = middle;
  }
  fitsAt(std::exp2(high));
  return last;
}

}  // namespace sightline::pvs
