// Another tree of the same items is built in slices and then takes the place of the first: where many items
// were inserted one by one, where its nodes have become large, or where all items get other boxes.

#include <algorithm>
#include <bit>
#include <utility>

#include "src/hierarchy/dynamic_tree.h"

namespace sightline::hierarchy {
namespace {

constexpr std::uint32_t kNumbersInStep = 16;  // so many numbers of items are looked at in a step
// Steps that it takes to copy an item, and to find another box for it.
constexpr std::uint32_t kStepsOfCopy = 2, kStepsOfBox = 8;
// Steps for an item that has come meanwhile, and for one that has moved or gone.
constexpr std::uint32_t kStepsOfInsertion = 40, kStepsOfChange = 5;
constexpr std::size_t kBits = 64;

}  // namespace

// Leaves the tree empty, with its memory.
void DynamicTree::clear() {
  nodes_.clear();
  boxes_.clear();
  children_.clear();
  places_.clear();
  free_.clear();
  root_ = kNone;
  size_ = 0;
  for (std::vector<std::uint32_t>& list : loose_) {
    list.clear();
  }
  worn_.clear();
  scattered_ = 0;
  measured_ = {};
  scratch_.clear();
  shares_.clear();
  dividing_ = false;
}

// To be called after each change of an item.
void DynamicTree::noteChange(std::uint32_t number) {
  if (replacement_.stage == Replacement::Stage::kNone) {
    return;
  }
  std::vector<std::uint64_t>& changed = replacement_.changed;
  const bool follows = replacement_.stage == Replacement::Stage::kFollows;
  if (!follows) {
    changed.resize(std::max(changed.size(), number / kBits + 1));
    changed[number / kBits] |= std::uint64_t{1} << number % kBits;
  } else if (number / kBits >= changed.size() || (changed[number / kBits] >> number % kBits & 1) == 0) {
    follow(number);
  }
}

Box DynamicTree::boxInReplacement(std::uint32_t number) const {
  return replacement_.box_of != nullptr ? replacement_.box_of(number) : boxOf(number);
}

// Makes an item of the replacement what it is here. Returns how many steps that takes.
std::uint32_t DynamicTree::follow(std::uint32_t number) {
  DynamicTree& tree = *replacement_.tree;
  const Box box = has(number) ? boxInReplacement(number) : Box{};
  if (!box.wellFormed()) {
    if (tree.has(number)) {
      tree.remove(number);
    }
    return kStepsOfChange;
  }
  if (tree.has(number)) {
    tree.move({number, box});
    return kStepsOfChange;
  }
  tree.insert({number, box});
  return kStepsOfInsertion;
}

void DynamicTree::endReplacement() {
  replacement_.stage = Replacement::Stage::kNone;
  replacement_.box_of = nullptr;
}

void DynamicTree::beginReplacement(BoxOf box_of) {
  if (replacement_.tree == nullptr) {
    replacement_.tree = std::make_unique<DynamicTree>();
  }
  DynamicTree& tree = *replacement_.tree;
  tree.clear();
  tree.reserve(size_);
  tree.places_.reserve(places_.size());
  tree.scratch_.reserve(size_);
  replacement_.changed.assign((places_.size() + kBits - 1) / kBits, 0);
  replacement_.next = 0;
  replacement_.box_of = std::move(box_of);
  replacement_.stage = Replacement::Stage::kCollects;
}

void DynamicTree::proceedReplacement(std::uint32_t& steps) {
  using Stage = Replacement::Stage;
  if (replacement_.stage == Stage::kNone) {
    if (size_ <= kChildren || (scattered_ * 4 <= size_ && !measured_.worn) || steps == 0) {
      return;
    }
    beginReplacement(nullptr);
  }
  DynamicTree& tree = *replacement_.tree;
  if (replacement_.stage == Stage::kCollects) {
    collectForReplacement(steps);
  }
  if (replacement_.stage == Stage::kFills) {
    const std::uint64_t before = tree.steps_taken_;
    const bool done = tree.fill(steps, 0);
    steps_taken_ += tree.steps_taken_ - before;
    if (done) {
      replacement_.stage = Stage::kFollows;
      replacement_.next = 0;
    }
  }
  if (replacement_.stage == Stage::kFollows) {
    std::vector<std::uint64_t>& changed = replacement_.changed;
    while (steps > 0 && replacement_.next < changed.size()) {
      std::uint64_t& bits = changed[replacement_.next];
      if (bits == 0) {
        ++replacement_.next;
        spend(steps, replacement_.next % kNumbersInStep == 0 ? 1 : 0);
        continue;
      }
      const auto bit = static_cast<std::uint32_t>(std::countr_zero(bits));
      bits &= bits - 1;
      spend(steps, follow(static_cast<std::uint32_t>(replacement_.next * kBits) + bit));
    }
    if (replacement_.next == changed.size() && replacement_.box_of == nullptr) {
      takeReplacement();
    }
  }
}

// Copies items whose numbers come next. More than there were at first have no room; they are made up for.
void DynamicTree::collectForReplacement(std::uint32_t& steps) {
  DynamicTree& tree = *replacement_.tree;
  std::uint32_t& next = replacement_.next;
  for (; steps > 0 && next < places_.size(); ++next) {
    tree.places_.push_back(kNone);
    if (!has(next)) {
      spend(steps, next % kNumbersInStep == 0 ? 1 : 0);
      continue;
    }
    if (tree.scratch_.size() == tree.scratch_.capacity()) {
      noteChange(next);
    } else if (const Box box = boxInReplacement(next); box.wellFormed()) {
      tree.scratch_.push_back({next, box});
    }
    spend(steps, replacement_.box_of != nullptr ? kStepsOfBox : kStepsOfCopy);
  }
  if (next < places_.size()) {
    return;
  }
  tree.size_ = tree.scratch_.size();
  if (tree.size_ > 0) {
    tree.root_ = tree.newNode(tree.heightFor(tree.size_));
    tree.open(tree.root_, 0, tree.size_, 0);
  }
  replacement_.stage = Replacement::Stage::kFills;
}

void DynamicTree::takeReplacement() {
  std::unique_ptr<DynamicTree> tree = std::move(replacement_.tree);
  std::swap(*this, *tree);
  // What belongs to no tree in particular stays where it was.
  std::swap(replacement_, tree->replacement_);
  std::swap(scratch_, tree->scratch_);
  std::swap(steps_taken_, tree->steps_taken_);
  tree->clear();
  endReplacement();
  replacement_.tree = std::move(tree);
}

}  // namespace sightline::hierarchy
