#pragma once

// A tree of boxes that come, go and move at any time, with many children a node: for tests of many boxes at
// once.
//
// Based on: Guttman. R-Trees: A Dynamic Index Structure for Spatial Searching. SIGMOD 1984; Beckmann et al.
// The R*-Tree. SIGMOD 1990. Differs from the papers in: nodes are split by surface area; boxes of nodes grow
// at once and shrink later; the children of a worn node's children are divided anew, at any height; and where
// that is not enough, the whole tree is built anew in slices, while the old one stays in use.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sightline/math/box.h"
#include "src/hierarchy/sliced_division.h"

namespace sightline::hierarchy {

// At any time the box of a node contains those of all items below it, so a search misses nothing, whether
// tidy() is called or not.
class DynamicTree {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr std::uint32_t kChildren = 16;  // at most, of a node

  using Item = NumberedBox;  // the number is not that of another item of the tree

  void insert(const Item& item);
  // Builds the tree anew if these are many beside what it holds.
  void insert(std::span<const Item> items);
  // The following are for items of the tree alone.
  void remove(std::uint32_t number);
  void move(const Item& item);
  // The same for many; those whose number is kNone are passed over. If they are many beside what the tree
  // holds, the boxes of all nodes are made anew, once.
  void move(std::span<const Item> items);
  const Box& boxOf(std::uint32_t number) const { return boxes_[places_[number]]; }
  bool has(std::uint32_t number) const { return number < places_.size() && places_[number] != kNone; }
  std::size_t size() const { return size_; }

  // Gives each item another box, boxOf(number), and leaves the tree as it is. A box that is not well formed
  // is for the caller to remove or to move before anything else.
  template <typename BoxOf>
  void setBoxes(const BoxOf& box_of) {
    endReplacement();  // it has the old boxes
    if (root_ != kNone) {
      setBoxes(root_, box_of);
    }
  }

  // Replaces all items. Takes n log n time; far less than inserting them one by one.
  void build(std::span<const Item> items);
  // Builds the tree anew from the items that it has, as build() does.
  void rebuild();
  // Makes room for so many items, with numbers below the same, so that inserting them does not copy the tree.
  void reserve(std::size_t items);
  // Shrinks boxes of nodes and divides worn nodes anew, until that took so many steps of about 20
  // nanoseconds, and at most two thousand more. Returns how many steps are left over.
  //
  // Where more than a quarter of the items was inserted one by one, or the surface area of all nodes for an
  // item has become half as large again since the tree was built, another tree is built of the same items,
  // over as many calls as that takes, and then replaces it. Its memory is kept for the next time.
  std::uint32_t tidy(std::uint32_t steps);

  // Begins another tree of the same items in which each has another box: box_of(number), called whenever
  // tidy() copies an item, and when one that was copied is inserted or moved. Items whose box is not well
  // formed are left out. The tree itself stays as it is until takeReplacement().
  using BoxOf = std::function<Box(std::uint32_t number)>;
  void beginReplacement(BoxOf box_of);
  // False before beginReplacement(), and after whatever builds the tree anew or gives it other boxes.
  bool hasOtherBoxes() const {
    return replacement_.stage != Replacement::Stage::kNone && replacement_.box_of != nullptr;
  }
  // Whether enough calls of tidy() were made for all items to be in the other tree.
  bool replacementIsComplete() const {
    return hasOtherBoxes() && replacement_.stage == Replacement::Stage::kFollows &&
           replacement_.next == replacement_.changed.size();
  }
  // Makes the other tree, which is complete, this one.
  void takeReplacement();
  // Gives up the other tree. It only keeps its memory.
  void endReplacement();
  // Steps that tidy() took so far, all calls together.
  std::uint64_t stepsTaken() const { return steps_taken_; }

  // kNone if there are no items.
  std::uint32_t root() const { return root_; }
  struct Node {
    std::span<const Box> boxes;
    std::span<const std::uint32_t> children;  // as many: numbers of items, or of nodes
    bool leaf = false;                        // the children are items
  };
  Node node(std::uint32_t number) const {
    const std::size_t first = std::size_t{number} * kChildren;
    const std::size_t count = nodes_[number].count;
    return {std::span(boxes_).subspan(first, count), std::span(children_).subspan(first, count),
            nodes_[number].height == 0};
  }

 private:
  struct NodeData {
    std::uint32_t parent = kNone;  // place of this node among its parent's children, an index of children_
    std::uint8_t count = 0;
    std::uint8_t height = 0;  // all leaves have 0
    bool loose = false;       // its box in its parent may be too large; listed in loose_
    bool worn = false;        // listed in worn_
    double built_area = 0.0;  // surface area when it was built or split
  };
  static constexpr std::uint32_t kFew = 4;         // children of a node after a split, at least
  static constexpr std::uint32_t kMaxHeight = 16;  // kFew^16 is 2^32: no number of items needs more levels

  // Parts of scratch_ that are to be divided among so many new children of a node; none: all of the node's
  // children are there and have been filled.
  struct Share {
    std::uint32_t node = kNone;
    std::size_t first = 0, count = 0, children = 0;
  };

  // How large nodes are, which says how many of them a search looks at. Measured node by node, again and
  // again while items move or go.
  struct Measured {
    bool changed = true;          // the tree is new, or items have moved or gone since a measurement began
    std::uint32_t next_node = 0;  // the node to be measured next; 0: no measurement goes on
    double area = 0.0;            // the sum over the nodes before it
    double first = 0.0;           // the area for an item that the first measurement found; 0: there was none
    bool worn = false;            // whether the last one found too much more than the first
  };

  // Another tree of the same items that tidy() builds in slices.
  struct Replacement {
    enum class Stage : std::uint8_t {
      kNone,      // it is empty, and only keeps its memory
      kCollects,  // items are copied, by number
      kFills,     // they are divided among nodes
      kFollows,   // changes are made to it as to this tree, and those of the stages before are made up for
    };
    Stage stage = Stage::kNone;
    std::uint32_t next = 0;                // number of an item that is looked at next
    std::vector<std::uint64_t> changed{};  // a bit by number: inserted, moved or removed, and not made up for
    std::unique_ptr<DynamicTree> tree{};
    BoxOf box_of{};  // of its items; null: they have the boxes that they have in this tree
  };

  std::uint32_t newNode(std::uint32_t height);
  void freeNode(std::uint32_t node);
  Box boundsOf(std::uint32_t node) const;
  std::uint32_t leafFor(const Box& box) const;
  void insertOne(const Item& item);
  void removeOne(std::uint32_t number);
  void moveOne(const Item& item);
  void addChild(std::uint32_t node, std::uint32_t child, const Box& box);
  void setPlace(std::uint32_t place, bool leaf);
  void split(std::uint32_t node, std::uint32_t child, const Box& box);
  void removeChild(std::uint32_t place);
  void grow(std::uint32_t node, const Box& box);
  void loosen(std::uint32_t node);
  void wear(std::uint32_t node);
  void tighten(std::uint32_t node);
  Box refit(std::uint32_t node);
  std::uint32_t divideAnew(std::uint32_t node);
  void measureSome(std::uint32_t& steps);
  void collect(std::uint32_t node);
  void open(std::uint32_t node, std::size_t first, std::size_t count, std::uint32_t bottom);
  bool fill(std::uint32_t& steps, std::uint32_t bottom);
  void clear();
  void spend(std::uint32_t& steps, std::uint32_t spent);
  void noteChange(std::uint32_t number);
  std::uint32_t follow(std::uint32_t number);
  Box boxInReplacement(std::uint32_t number) const;
  void proceedReplacement(std::uint32_t& steps);
  void collectForReplacement(std::uint32_t& steps);
  template <typename BoxOf>
  Box setBoxes(std::uint32_t node, const BoxOf& box_of) {
    Box bounds;
    for (std::uint32_t place = node * kChildren; place < node * kChildren + nodes_[node].count; ++place) {
      boxes_[place] =
          nodes_[node].height == 0 ? box_of(children_[place]) : setBoxes(children_[place], box_of);
      bounds.extend(boxes_[place]);
    }
    return bounds;
  }
  std::uint32_t heightFor(std::size_t items) const;

  std::vector<NodeData> nodes_;
  // The children of node n are those from kChildren * n on. An index of these columns is a "place".
  std::vector<Box> boxes_;
  std::vector<std::uint32_t> children_;
  std::vector<std::uint32_t> places_;  // by item: its place, or kNone
  std::vector<std::uint32_t> free_;    // numbers of nodes that are not used
  std::uint32_t root_ = kNone;
  std::size_t size_ = 0;
  std::array<std::vector<std::uint32_t>, kMaxHeight> loose_;  // nodes, by height
  std::vector<std::uint32_t> worn_;
  std::size_t next_loose_ = 0;  // where tidy() looks next in a list of loose nodes
  std::size_t scattered_ = 0;   // items that were inserted one by one since the tree was built
  Measured measured_;
  std::uint64_t steps_taken_ = 0;
  Replacement replacement_;
  std::vector<Item> scratch_;  // what nodes are filled with: items, or nodes with their boxes
  std::vector<Share> shares_;  // of these, that are not done
  SlicedDivision division_;    // of the last one, if dividing_
  bool dividing_ = false;
  std::vector<Item> leaving_;  // scratch for move()
};

}  // namespace sightline::hierarchy
