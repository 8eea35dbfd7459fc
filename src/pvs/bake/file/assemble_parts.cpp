#include "src/pvs/bake/file/assemble_parts.h"

#include <utility>
#include <vector>

namespace sightline::pvs {
namespace {

// A cell that was divided into parts, while these are read. Its leaves wait: eight with like sets become one,
// and then the cell is a leaf itself. As soon as one of its children is not a leaf, it stays divided, and so
// do all cells around it.
class OpenCell {
 public:
  OpenCell(Flattener& flattener, OpenCell* around) : flattener_(flattener), around_(around) {}

  // The next child, with all below it.
  void add(BakedCell&& child) {
    if (child.leaf() && !stays_) {
      waiting_.push_back(std::move(child));
      return;
    }
    stay();
    flattener_.add(child, first_ + written_++);
  }
  // The next child was a cell like this one and is written.
  void skip() { written_ += 1; }

  // Writes the node of this cell, and what waits.
  void stay() {
    if (stays_) {
      return;
    }
    stays_ = true;
    std::uint32_t node = 0;
    if (around_ != nullptr) {
      around_->stay();
      node = around_->first_ + around_->written_;
    }
    first_ = flattener_.divide(node);
    for (const BakedCell& leaf : std::exchange(waiting_, {})) {
      flattener_.add(leaf, first_ + written_++);
    }
  }

  bool stays() const { return stays_; }
  std::vector<BakedCell> takeWaiting() { return std::exchange(waiting_, {}); }

 private:
  Flattener& flattener_;
  OpenCell* around_;
  std::vector<BakedCell> waiting_;
  bool stays_ = false;
  std::uint32_t first_ = 0, written_ = 0;  // the node of the first child; how many children are written
};

class PartFlattener {
 public:
  PartFlattener(const BakeScene& scene, const ReadCell& read, Flattener& flattener)
      : scene_(scene), read_(read), flattener_(flattener) {}

  // Returns the id of a part that cannot be read, or 0.
  std::uint64_t add(std::uint64_t id, OpenCell* around) {
    std::optional<PartCell> part = read_(id);
    if (!part) {
      return id;
    }
    if (part->cell) {
      give(std::move(*part->cell), around);
      return 0;
    }
    OpenCell open(flattener_, around);
    for (std::uint64_t i = 0; i < 8; ++i) {
      if (const std::uint64_t broken = add(8 * id + i, &open); broken != 0) {
        return broken;
      }
    }
    if (open.stays()) {
      if (around != nullptr) {
        around->skip();
      }
      return 0;
    }
    BakedCell cell;
    cell.level = static_cast<std::uint8_t>(cellOfNumber(id).level);
    cell.children = open.takeWaiting();
    mergeChildren(scene_, cell);
    give(std::move(cell), around);
    return 0;
  }

 private:
  void give(BakedCell&& cell, OpenCell* around) {
    if (around != nullptr) {
      around->add(std::move(cell));
    } else {
      flattener_.add(cell, 0);
    }
  }

  const BakeScene& scene_;
  const ReadCell& read_;
  Flattener& flattener_;
};

// The cell of a part with all below it.
std::optional<BakedCell> cellOfPart(const BakeScene& scene, const ReadCell& read, std::uint64_t id,
                                    std::uint64_t& broken) {
  std::optional<PartCell> part = read(id);
  broken = id;
  if (!part) {
    return std::nullopt;
  }
  if (part->cell) {
    return std::move(part->cell);
  }
  BakedCell cell;
  cell.level = static_cast<std::uint8_t>(cellOfNumber(id).level);
  for (std::uint64_t i = 0; i < 8; ++i) {
    std::optional<BakedCell> child = cellOfPart(scene, read, 8 * id + i, broken);
    if (!child) {
      return std::nullopt;
    }
    cell.children.push_back(std::move(*child));
  }
  mergeChildren(scene, cell);
  return cell;
}

}  // namespace

std::optional<BakedCell> cellOfParts(const BakeScene& scene, const ReadCell& read, std::uint64_t& broken) {
  return cellOfPart(scene, read, kRootPart, broken);
}

std::uint64_t flattenParts(const BakeScene& scene, const ReadCell& read, Flattener& flattener) {
  const std::uint64_t broken = PartFlattener(scene, read, flattener).add(kRootPart, nullptr);
  if (broken == 0) {
    flattener.finish();
  }
  return broken;
}

}  // namespace sightline::pvs
