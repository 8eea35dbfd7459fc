#include "src/hierarchy/dynamic_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/random_numbers.h"
#include "tests/support/rounds.h"

namespace sightline::hierarchy {
namespace {

using Item = DynamicTree::Item;
using Boxes = std::map<std::uint32_t, Box>;  // by number

struct Counts {
  std::size_t nodes = 0;
  double area = 0.0;  // of all nodes
};

// Empty when the tree holds exactly these boxes, and each node's box those of its children. tight: no larger
// than that.
std::string whatIsWrong(const DynamicTree& tree, const Boxes& boxes, bool tight, Counts& counts) {
  std::vector<std::uint32_t> open;
  if (tree.root() != DynamicTree::kNone) {
    open.push_back(tree.root());
  }
  std::vector<std::pair<std::uint32_t, Box>> found;
  while (!open.empty()) {
    const DynamicTree::Node node = tree.node(open.back());
    open.pop_back();
    ++counts.nodes;
    if (node.boxes.empty() || node.boxes.size() > DynamicTree::kChildren) {
      return "a node has no children or too many";
    }
    for (std::size_t i = 0; i < node.boxes.size(); ++i) {
      if (node.leaf) {
        found.emplace_back(node.children[i], node.boxes[i]);
        continue;
      }
      Box below;
      for (const Box& box : tree.node(node.children[i]).boxes) {
        below.extend(box);
      }
      if (!contains(node.boxes[i], below)) {
        return "a node does not contain its children";
      }
      if (tight && !(node.boxes[i] == below)) {
        return "a node is too large";
      }
      counts.area += surfaceArea(below);
      open.push_back(node.children[i]);
    }
  }
  const auto same = [](const auto& a, const auto& b) { return a.first == b.first && a.second == b.second; };
  std::ranges::sort(found, {}, &std::pair<std::uint32_t, Box>::first);
  if (!std::ranges::equal(found, boxes, same)) {  // also where an item is there twice
    return "other items";
  }
  for (const auto& [number, box] : boxes) {
    if (!tree.has(number) || !(tree.boxOf(number) == box)) {
      return "an item is not where it is said to be";
    }
  }
  return tree.size() == boxes.size() ? "" : "another size";
}

std::string whatIsWrong(const DynamicTree& tree, const Boxes& boxes, bool tight = false) {
  Counts counts;
  return whatIsWrong(tree, boxes, tight, counts);
}

class RandomBoxes {
 public:
  explicit RandomBoxes(std::uint32_t seed) : engine_(seed), number_(test::numbersFrom<float>(engine_)) {}

  Box next(float spread, float size) {
    Box box;
    const Vec3f at{number_(-spread, spread), number_(-spread, spread), number_(-spread, spread)};
    box.extend(at);
    box.extend(at + Vec3f{number_(0.0f, size), number_(0.0f, size), number_(0.0f, size)});
    return box;
  }
  // Items 0 to count - 1.
  Boxes items(std::uint32_t count, float spread, float size) {
    Boxes boxes;
    for (std::uint32_t i = 0; i < count; ++i) {
      boxes[i] = next(spread, size);
    }
    return boxes;
  }
  std::uint32_t below(std::uint32_t bound) { return static_cast<std::uint32_t>(engine_() % bound); }

 private:
  std::mt19937 engine_;
  decltype(test::numbersFrom<float>(std::declval<std::mt19937&>())) number_;
};

std::vector<Item> itemsOf(const Boxes& boxes) {
  std::vector<Item> items;
  for (const auto& [number, box] : boxes) {
    items.push_back({number, box});
  }
  return items;
}

TEST(DynamicTree, HoldsWhatIsInsertedMovedAndRemoved) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    RandomBoxes random(seed);
    DynamicTree tree;
    Boxes boxes;
    // All boxes alike, in one place, or wide apart.
    const float spread = seed % 3 == 0 ? 0.0f : 100.0f, size = seed % 2 == 0 ? 0.0f : 3.0f;
    for (std::uint32_t step = 0; step < 4000; ++step) {
      const std::uint32_t number = random.below(600);
      const Box box = random.next(spread, size);
      if (!tree.has(number)) {
        tree.insert({number, box});
        boxes[number] = box;
      } else if (random.below(4) == 0 || (step > 2000 && step < 2600)) {
        tree.remove(number);
        boxes.erase(number);
      } else {
        tree.move({number, box});
        boxes[number] = box;
      }
      if (step % 7 == 0) {
        tree.tidy(random.below(40));
      }
      if (step % 50 == 0) {
        ASSERT_EQ(whatIsWrong(tree, boxes), "") << seed << " " << step;
      }
    }
    while (tree.tidy(100) < 100) {
    }
    ASSERT_EQ(whatIsWrong(tree, boxes, true), "") << seed;
    for (const Item& item : itemsOf(boxes)) {
      tree.remove(item.number);
    }
    EXPECT_EQ(tree.size(), 0u);
    EXPECT_EQ(tree.root(), DynamicTree::kNone);
  }
}

TEST(DynamicTree, IsBuiltOfAnyNumberOfItems) {
  RandomBoxes random(1);
  for (const std::uint32_t count :
       {0u, 1u, 2u, 11u, 12u, 13u, 16u, 17u, 191u, 192u, 193u, 256u, 257u, 3071u, 3073u, 5000u}) {
    Boxes boxes;
    for (std::uint32_t i = 0; i < count; ++i) {
      boxes[3 * i] = random.next(50.0f, 1.0f);
    }
    DynamicTree tree;
    tree.insert({7, random.next(1.0f, 1.0f)});
    tree.build(itemsOf(boxes));
    EXPECT_EQ(whatIsWrong(tree, boxes, true), "") << count;
    for (std::uint32_t i = 0; i < 40; ++i) {
      boxes[3 * i + 1] = random.next(50.0f, 1.0f);
      tree.insert({3 * i + 1, boxes[3 * i + 1]});
    }
    EXPECT_EQ(whatIsWrong(tree, boxes), "") << count;
    for (const std::uint32_t more : {0u, 3u, 700u}) {
      std::vector<Item> items;
      for (std::uint32_t i = 0; i < more; ++i) {
        items.push_back({100000 + 1000 * more + i, random.next(50.0f, 1.0f)});
        boxes[items.back().number] = items.back().box;
      }
      tree.insert(items);
      EXPECT_EQ(whatIsWrong(tree, boxes), "") << count << " and " << more;
    }
  }
}

// Neither a list nor building anew gives back what was reserved: nodes stay where they are in memory.
TEST(DynamicTree, KeepsTheMemoryThatWasReserved) {
  RandomBoxes random(4);
  Boxes boxes = random.items(2000, 100.0f, 2.0f);
  DynamicTree tree;
  tree.reserve(8000);
  tree.insert(itemsOf(boxes));
  const auto first = [&] { return tree.node(0).boxes.data(); };
  const Box* const place = first();
  tree.rebuild();
  EXPECT_EQ(first(), place);
  for (std::uint32_t i = 2000; i < 8000; ++i) {
    tree.insert({i, random.next(100.0f, 2.0f)});
  }
  EXPECT_EQ(first(), place);
}

// A few or all at once, by small steps or anywhere: no box of a node is too small, and after all have moved
// none of one that stayed in its node is too large either.
TEST(DynamicTree, ManyMoveAtOnce) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    RandomBoxes random(seed);
    Boxes boxes;
    for (std::uint32_t i = 0; i < (seed % 2 == 0 ? 9u : 700u); ++i) {
      boxes[2 * i] = random.next(100.0f, 2.0f);
    }
    DynamicTree tree;
    tree.build(itemsOf(boxes));
    for (std::uint32_t frame = 0; frame < 60; ++frame) {
      std::vector<Item> moved;
      for (auto& [number, box] : boxes) {
        if (random.below(frame % 2 == 0 ? 1 : 20) == 0) {
          const Box step = random.next(1.5f, 0.0f);
          box =
              random.below(50) == 0 ? random.next(300.0f, 2.0f) : Box{box.min + step.min, box.max + step.min};
          moved.push_back({number, box});
          moved.push_back({DynamicTree::kNone, {}});
        }
      }
      tree.move(moved);
      ASSERT_EQ(whatIsWrong(tree, boxes), "") << seed << " " << frame;
      tree.tidy(random.below(3) * 50);
    }
    tree.move(itemsOf(boxes));
    while (tree.tidy(100) < 100) {
    }
    EXPECT_EQ(whatIsWrong(tree, boxes, true), "") << seed;
  }
}

// All numbers that a search for what overlaps a box finds, ascending.
std::vector<std::uint32_t> found(const DynamicTree& tree, const Box& wanted) {
  std::vector<std::uint32_t> open, numbers;
  if (tree.root() != DynamicTree::kNone) {
    open.push_back(tree.root());
  }
  while (!open.empty()) {
    const DynamicTree::Node node = tree.node(open.back());
    open.pop_back();
    for (std::size_t i = 0; i < node.boxes.size(); ++i) {
      if (overlaps(node.boxes[i], wanted)) {
        (node.leaf ? numbers : open).push_back(node.children[i]);
      }
    }
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

// Items that come, go and move in every call of tidy() while the whole tree is built anew, time after time:
// searches find what a search of all boxes finds, and no call does more than it may.
TEST(DynamicTree, IsBuiltAnewInSlicesWhileItChanges) {
  constexpr std::uint32_t kNumbers = 12000;
  for (std::uint32_t seed = 0; seed < 3 * test::rounds(2u); ++seed) {
    RandomBoxes random(seed);
    DynamicTree tree;
    Boxes boxes;
    // Wide apart; all in one place; or a few that all move in every call.
    const float spread = seed % 3 == 1 ? 0.0f : 100.0f;
    const std::uint32_t numbers = seed % 3 == 2 ? 1500 : kNumbers;
    const auto change = [&](std::uint32_t number) {
      const Box box = random.next(spread, 2.0f);
      if (!tree.has(number)) {
        tree.insert({number, box});
        boxes[number] = box;
      } else if (random.below(3) == 0) {
        tree.remove(number);
        boxes.erase(number);
      } else {
        tree.move({number, box});
        boxes[number] = box;
      }
    };
    for (std::uint32_t number = 0; number < numbers / 2; ++number) {
      change(number);
    }
    for (std::uint32_t call = 0; call < 900; ++call) {
      for (std::uint32_t changes = random.below(20); changes > 0; --changes) {
        change(random.below(numbers));
      }
      if (seed % 3 == 2) {
        std::vector<Item> moved = itemsOf(boxes);
        for (Item& item : moved) {
          const Box step = random.next(1.5f, 0.0f);
          item.box = {item.box.min + step.min, item.box.max + step.min};
          boxes[item.number] = item.box;
        }
        tree.move(moved);
      }
      if (call == 110 || call % 500 == 400) {  // the first while another tree is half built
        tree.setBoxes([&](std::uint32_t number) {
          return boxes[number] = {boxes[number].min + Vec3f{1, 2, 3}, boxes[number].max + Vec3f{1, 2, 3}};
        });
      }
      const std::uint32_t steps = 20 + random.below(call % 200 < 100 ? 100 : 4000);
      const std::uint64_t before = tree.stepsTaken();
      tree.tidy(steps);
      EXPECT_LE(tree.stepsTaken() - before, steps + 2000) << seed << " " << call;
      const Box wanted = random.next(spread, 30.0f);
      std::vector<std::uint32_t> expected;
      for (const auto& [number, box] : boxes) {
        if (overlaps(box, wanted)) {
          expected.push_back(number);
        }
      }
      ASSERT_EQ(found(tree, wanted), expected) << seed << " " << call;
      if (call % 25 == 0) {
        ASSERT_EQ(whatIsWrong(tree, boxes), "") << seed << " " << call;
      }
    }
    while (tree.tidy(100000) < 100000) {
    }
    ASSERT_EQ(whatIsWrong(tree, boxes, true), "") << seed;
    while (!boxes.empty()) {
      tree.remove(boxes.begin()->first);
      boxes.erase(boxes.begin());
    }
    EXPECT_EQ(tree.root(), DynamicTree::kNone);
    tree.tidy(1000);
    tree.insert({3, random.next(1.0f, 1.0f)});
    EXPECT_EQ(tree.size(), 1u);
  }
}

// The nodes of a tree, each as the numbers of its items; of leaves alone.
std::vector<std::vector<std::uint32_t>> leavesOf(const DynamicTree& tree) {
  std::vector<std::uint32_t> open{tree.root()};
  std::vector<std::vector<std::uint32_t>> leaves;
  while (!open.empty()) {
    const DynamicTree::Node node = tree.node(open.back());
    open.pop_back();
    if (node.leaf) {
      leaves.emplace_back(node.children.begin(), node.children.end());
      std::sort(leaves.back().begin(), leaves.back().end());
    } else {
      open.insert(open.end(), node.children.begin(), node.children.end());
    }
  }
  std::sort(leaves.begin(), leaves.end());
  return leaves;
}

// However many slices it takes, and nothing stops for it: the tree becomes the one that is built at once.
TEST(DynamicTree, ThatWasFilledOneByOneBecomesTheOneThatIsBuiltOfAList) {
  for (const std::uint32_t count : {1100u, 30000u}) {
    for (const std::uint32_t steps : {50u, 3000u}) {
      RandomBoxes random(count);
      Boxes boxes;
      DynamicTree tree, list;
      for (std::uint32_t i = 0; i < count; ++i) {
        boxes[i] = random.next(100.0f, 2.0f);
        tree.insert({i, boxes[i]});
      }
      list.build(itemsOf(boxes));
      EXPECT_NE(leavesOf(tree), leavesOf(list));
      std::uint32_t calls = 0;
      while (tree.tidy(steps) < steps) {
        ++calls;
      }
      EXPECT_EQ(leavesOf(tree), leavesOf(list)) << count << " " << steps;
      EXPECT_EQ(whatIsWrong(tree, boxes, true), "");
      EXPECT_GT(calls, count / steps);
    }
  }
}

// The surface area of all nodes of a tree of these boxes, in units of that of a tree that is built of them.
double wearOf(const DynamicTree& tree, const Boxes& boxes) {
  Counts worn, good;
  DynamicTree fresh;
  fresh.build(itemsOf(boxes));
  EXPECT_EQ(whatIsWrong(tree, boxes, false, worn), "");
  EXPECT_EQ(whatIsWrong(fresh, boxes, true, good), "");
  return worn.area / good.area;
}

// A district of a large tree, less than a quarter of it, in which all items go by small steps to where other
// items were, or most of them are taken away: its nodes are made good again, a few in each call of tidy().
TEST(DynamicTree, AWornPartOfALargeTreeIsMadeGoodInSlices) {
  RandomBoxes random(5);
  Boxes boxes;
  std::vector<std::uint32_t> district;
  for (std::uint32_t i = 0; i < 40000; ++i) {
    boxes[i] = random.next(100.0f, 1.0f);
    if (maxComponent(abs(center(boxes[i]))) < 55.0) {
      district.push_back(i);
    }
  }
  ASSERT_LT(4 * district.size(), boxes.size());
  ASSERT_GT(district.size(), 4096u);
  DynamicTree tree;
  tree.build(itemsOf(boxes));
  std::vector<Box> goals;
  for (std::size_t i = 0; i < district.size(); ++i) {
    goals.push_back(boxes[district[(7 * i + 1) % district.size()]]);
  }
  const auto tidied = [&] {
    for (int call = 0; call < 300; ++call) {
      const std::uint64_t before = tree.stepsTaken();
      tree.tidy(2000);
      EXPECT_LE(tree.stepsTaken() - before, 4000u);
    }
  };
  constexpr int kFrames = 400;
  for (int frame = 0; frame < kFrames; ++frame) {
    for (std::size_t i = 0; i < district.size(); ++i) {
      Box& box = boxes[district[i]];
      const Vec3f step((center(goals[i]) - center(box)) * (1.0 / (kFrames - frame)));
      box = {box.min + step, box.max + step};
      tree.move({district[i], box});
    }
    tree.tidy(30000);
  }
  tidied();
  EXPECT_LT(wearOf(tree, boxes), 1.4);

  for (std::size_t i = 0; i < district.size(); ++i) {
    if (i % 10 != 0) {
      tree.remove(district[i]);
      boxes.erase(district[i]);
    }
  }
  tidied();
  EXPECT_LT(wearOf(tree, boxes), 1.4);
}

// Another tree of the same items, each of which has another box, or none, is built in slices while items
// come, go and move; then it takes the place of the first.
TEST(DynamicTree, GetsOtherBoxesInSlicesWhileItChanges) {
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    RandomBoxes random(seed);
    DynamicTree tree;
    Boxes boxes;
    const std::uint32_t numbers = seed == 3 ? 10 : test::rounds(6000u);
    const auto change = [&](std::uint32_t number) {
      const Box box = random.next(100.0f, 2.0f);
      if (!tree.has(number)) {
        boxes[number] = box;
        tree.insert({number, box});
      } else if (random.below(3) == 0) {
        boxes.erase(number);
        tree.remove(number);
      } else {
        boxes[number] = box;
        tree.move({number, box});
      }
    };
    const auto other = [&](std::uint32_t number) {
      const Box& box = boxes.at(number);
      const Vec3f shift{500, 0, -500};
      // What reaches far up has no box there.
      return box.max.y > 95.0f ? Box{} : Box{box.min + shift, box.max + shift};
    };
    for (std::uint32_t number = 0; number < numbers; ++number) {
      if (number % 3 != 0) {
        change(number);
      }
    }
    EXPECT_FALSE(tree.hasOtherBoxes());
    tree.beginReplacement(other);
    std::uint32_t calls = 0;
    while (!tree.replacementIsComplete()) {
      ASSERT_TRUE(tree.hasOtherBoxes());
      for (std::uint32_t changes = random.below(8); changes > 0; --changes) {
        change(random.below(numbers + 50));
      }
      const std::uint64_t before = tree.stepsTaken();
      tree.tidy(300);
      ASSERT_LE(tree.stepsTaken() - before, 2300u);
      if (calls % 8 == 0) {
        ASSERT_EQ(whatIsWrong(tree, boxes), "") << seed << " " << calls;
      }
      ++calls;
    }
    EXPECT_GT(calls, numbers / 200);
    // It stays complete, whatever changes, and is not taken by itself.
    for (std::uint32_t i = 0; i < 200; ++i) {
      change(random.below(numbers + 200));
      tree.tidy(i % 2 == 0 ? 0 : 1000);
      ASSERT_TRUE(tree.replacementIsComplete());
    }
    ASSERT_EQ(whatIsWrong(tree, boxes), "") << seed;
    Boxes others;
    for (const auto& [number, box] : boxes) {
      if (const Box now = other(number); !now.empty()) {
        others[number] = now;
      }
    }
    EXPECT_TRUE(seed == 3 || others.size() < boxes.size());
    tree.takeReplacement();
    EXPECT_FALSE(tree.hasOtherBoxes());
    EXPECT_EQ(whatIsWrong(tree, others), "") << seed;
    tree.beginReplacement(other);
    tree.setBoxes([&](std::uint32_t number) { return others.at(number); });
    EXPECT_FALSE(tree.hasOtherBoxes());
  }
}

// A crowd in which all go the same way one by one, with far fewer steps than its leaves alone take: the boxes
// of all nodes follow it, and another tree that was asked for gets done.
TEST(DynamicTree, ThatMovesMoreThanItsStepsAllowGetsAllWorkDone) {
  RandomBoxes random(9);
  Boxes boxes = random.items(1000, 20.0f, 1.0f);
  DynamicTree tree;
  tree.build(itemsOf(boxes));
  const auto frames = [&](std::uint32_t most) {
    std::uint32_t frame = 0;
    for (; frame < most && !tree.replacementIsComplete(); ++frame) {
      for (auto& [number, box] : boxes) {
        box = {box.min + Vec3f{0.5f, 0, 0}, box.max + Vec3f{0.5f, 0, 0}};
        tree.move({number, box});
      }
      tree.tidy(100);
    }
    return frame;
  };
  frames(200);
  EXPECT_LT(wearOf(tree, boxes), 3.0);
  tree.beginReplacement([&](std::uint32_t number) { return boxes.at(number); });
  EXPECT_LT(frames(3000), 3000u);
  tree.takeReplacement();
  EXPECT_EQ(whatIsWrong(tree, boxes), "");
}

// A world in which everything moves and comes and goes stays about as good as one built anew.
TEST(DynamicTree, StaysGoodWhateverChanges) {
  RandomBoxes random(3);
  Boxes boxes;
  DynamicTree tree;
  std::size_t most_nodes = 0;
  for (std::uint32_t frame = 0; frame < 600; ++frame) {
    for (std::uint32_t i = 0; i < 20; ++i) {
      const std::uint32_t number = random.below(4000);
      if (tree.has(number)) {
        tree.remove(number);
        boxes.erase(number);
      } else {
        boxes[number] = random.next(100.0f, 2.0f);
        tree.insert({number, boxes[number]});
      }
    }
    std::uint32_t moved = 0;
    for (auto& [number, box] : boxes) {
      if (++moved % 3 == 0) {
        const Box step = random.next(1.5f, 0.0f);
        box = {box.min + step.min, box.max + step.min};
        tree.move({number, box});
      }
    }
    tree.tidy(2000);
    if (frame % 20 == 0) {
      Counts counts;
      ASSERT_EQ(whatIsWrong(tree, boxes, false, counts), "") << frame;
      most_nodes = std::max(most_nodes, counts.nodes);
    }
  }
  Counts worn, fresh;
  DynamicTree anew;
  anew.build(itemsOf(boxes));
  ASSERT_EQ(whatIsWrong(tree, boxes, false, worn), "");
  ASSERT_EQ(whatIsWrong(anew, boxes, true, fresh), "");
  EXPECT_LT(worn.area, 2.0 * fresh.area);
  EXPECT_LT(most_nodes, 2 * fresh.nodes);
}

}  // namespace
}  // namespace sightline::hierarchy
