#include "src/comparison/layers/extent_tree.h"

#include <algorithm>

namespace sightline::comparison {
namespace {

constexpr std::uint32_t kInactive = 0xffffffffu;
// Frames with queries over which the number of visited parts is averaged.
constexpr std::uint32_t kWindowFrames = 8;

void setQuery(ExtentNodes::Query& query, const Extent& extent, const std::vector<ExtentAxis::Kind>& kinds) {
  query.tests.axes = static_cast<std::uint32_t>(kinds.size());
  for (std::size_t axis = 0; axis < kinds.size(); ++axis) {
    const Interval& own = extent[axis];
    const bool angular = kinds[axis] == ExtentAxis::Kind::kAngular;
    query.keys[axis] = keyInterval(own, angular);
    OverlapTests::Axis& along = query.tests.along[axis];
    along.count = angular ? 3 : 1;
    // The sums must be the same as in overlapsAngular().
    along.tests = {own, Interval{own.low + 4.0f, own.high + 4.0f}, Interval{own.low - 4.0f, own.high - 4.0f}};
  }
}

}  // namespace

ExtentTree::ExtentTree(const ExtentTreeSettings& settings) : settings_(settings) {}

void ExtentTree::update(const ExtentTable& table) {
  if (!built_ || parts_ != table.parts || kinds_ != table.kinds) {
    build(table);
    return;
  }
  closeFrame();
  keys_.set(table);
  if (!takeOver(table)) {
    trees_[current_].rebalance(keys_, table, work_);
  }
  activateAll();
}

void ExtentTree::build(const ExtentTable& table) {
  kinds_ = table.kinds;
  parts_ = table.parts;
  built_ = true;
  rebuilding_ = false;
  keys_.set(table);
  ExtentNodes& tree = trees_[current_];
  tree.begin(settings_, static_cast<std::uint32_t>(parts_), kinds_.size());
  while (!tree.makeSome(keys_, 0xffffffffu, work_)) {
  }
  tree.rebalance(keys_, table, work_);  // fills the leaves
  beginLife();
  seen_.resize(parts_);
  activateAll();
}

// Makes one step towards a new tree. Returns true if it is complete and up to date and has replaced the
// current one.
bool ExtentTree::takeOver(const ExtentTable& table) {
  ExtentNodes& next = trees_[1 - current_];
  if (!rebuilding_) {
    if (!mustRebuild()) {
      return false;
    }
    rebuilding_ = true;
    snapshot_ = keys_;
    next.begin(settings_, static_cast<std::uint32_t>(parts_), kinds_.size());
  }
  if (!next.makeSome(snapshot_, std::max(settings_.rebuild_steps, 1u), work_)) {
    return false;
  }
  next.rebalance(keys_, table, work_);
  current_ = 1 - current_;
  ++work_.takeovers;
  beginLife();
  return true;
}

void ExtentTree::beginLife() {
  rebuilding_ = false;
  imbalanced_ = false;
  frames_ = 0;
  first_ = recent_ = frame_ = {};
}

bool ExtentTree::mustRebuild() {
  return (settings_.rebuild_after > 0 && frames_ >= settings_.rebuild_after) || imbalanced_;
}

// Compares the number of parts visited per query with that of the first frames.
void ExtentTree::closeFrame() {
  ++frames_;
  if (frame_.queries == 0) {
    return;
  }
  Window& window = first_.frames < kWindowFrames ? first_ : recent_;
  window.visited += frame_.visited;
  window.queries += frame_.queries;
  ++window.frames;
  frame_ = {};
  if (recent_.frames == kWindowFrames) {
    // The usual work is one part at least: a scene whose first queries visited nothing is not rebuilt for
    // ever.
    const double usual = std::max(first_.average(), 1.0);
    imbalanced_ = settings_.rebuild_imbalance > 0 && recent_.average() > settings_.rebuild_imbalance * usual;
    recent_ = {};
  }
}

void ExtentTree::activateAll() {
  std::fill(seen_.begin(), seen_.end(), 0u);
  epoch_ = 0;
}

void ExtentTree::setActive(std::uint32_t part, bool active) {
  const bool is_active = seen_[part] != kInactive;
  if (is_active == active) {
    return;
  }
  seen_[part] = active ? 0 : kInactive;
  trees_[current_].countActive(keys_, part, active ? 1u : 0u - 1u);
}

void ExtentTree::query(const Extent& query, std::vector<std::uint32_t>& parts) {
  if (++epoch_ == kInactive) {
    for (std::uint32_t& seen : seen_) {
      seen = seen == kInactive ? kInactive : 0;
    }
    epoch_ = 1;
  }
  setQuery(asked_, query, kinds_);
  asked_.epoch = epoch_;
  const auto before = static_cast<std::ptrdiff_t>(parts.size());
  frame_.visited += trees_[current_].query(asked_, seen_, parts);
  ++frame_.queries;
  std::sort(parts.begin() + before, parts.end());
}

}  // namespace sightline::comparison
