#include "src/comparison/layers/incremental_sort.h"

#include <algorithm>

namespace sightline::comparison {

namespace {

constexpr std::uint32_t kNone = OrderLabels::kNone;

}  // namespace

void IncrementalSort::sort(std::span<const std::uint32_t> previous, OccluderSource& source,
                           GroupedOrder& order, const Observer& observer) {
  prepare(previous, order);
  if (observer.call != nullptr) {
    observer.call(observer.user, *this, order);
  }
  while (!list_.empty()) {
    const std::uint32_t object = list_.first();
    list_.remove(object);
    step(object, source, order);
    if (observer.call != nullptr) {
      observer.call(observer.user, *this, order);
    }
  }
}

std::vector<IncrementalSort::Listed> IncrementalSort::list() const {
  std::vector<Listed> listed;
  for (std::uint32_t object = list_.first(); object != kNone; object = list_.next(object)) {
    Listed& entry = listed.emplace_back();
    collectMembers(object, entry.members);
    entry.marked = marked(object);
  }
  return listed;
}

void IncrementalSort::prepare(std::span<const std::uint32_t> previous, GroupedOrder& order) {
  order.parts.clear();
  order.first_of.assign(1, 0);
  std::size_t bound = 0;
  for (const std::uint32_t part : previous) {
    bound = std::max(bound, std::size_t{part} + 1);
  }
  rank_.resize(bound);
  object_.resize(bound);
  next_member_.assign(bound, kNone);
  last_member_.resize(bound);
  mark_.assign(bound, 0);
  for (std::size_t i = 0; i < previous.size(); ++i) {
    rank_[previous[i]] = static_cast<std::uint32_t>(i);
    object_[previous[i]] = previous[i];
    last_member_[previous[i]] = previous[i];
  }
  list_.assign(previous, bound);
  epoch_ = 1;
  reinsertions_ = 0;
  steps_in_prefix_ = 0;
}

// One iteration of the loop in Figure 4 for the first object, which has been removed from the list.
void IncrementalSort::step(std::uint32_t object, OccluderSource& source, GroupedOrder& order) {
  prefix_.clear();
  if (marked(object) && groupCycle(object, source)) {
    return;
  }
  setActive(object, false, source);
  placeByOccluders(object, source, order);
}

// Groups the marked object with others of the marked sequence at the front, if they form a cycle. Returns
// whether it did.
//
// Halting: let p objects form the sequence, and let no step output an object, group some, or take one out of
// the sequence. As no cycle was found, following the first occluder in the sequence ended at an object
// without an occluder in it. That object has not been first since, or it would have left. An object becomes
// first again only after each of its occluders has, so an object k arcs from that one becomes first at most k
// times, and there are at most (p - 1)^2 steps. A source that contradicts itself can cause more; then the
// whole sequence is grouped.
bool IncrementalSort::groupCycle(std::uint32_t object, OccluderSource& source) {
  formMarkedPrefix(object);
  if (!detectCycle(source)) {
    const std::uint64_t size = prefix_.size();
    if (size < 2 || steps_in_prefix_ <= size * size) {
      return false;
    }
    cycle_.assign(prefix_.begin(), prefix_.end());
  }
  group(object);
  return true;
}

// Outputs the object or, if it is occluded, marks it and puts it behind its furthest occluder.
void IncrementalSort::placeByOccluders(std::uint32_t object, OccluderSource& source, GroupedOrder& order) {
  collectMembers(object, members_);
  occluders_.clear();
  source.occludersOf(members_, occluders_);
  if (occluders_.empty()) {
    emit(order);
    return;
  }
  std::uint32_t furthest = object_[occluders_.front()];
  for (const std::uint32_t part : occluders_) {
    if (list_.before(furthest, object_[part])) {
      furthest = object_[part];
    }
  }
  const bool stays = prefix_.size() > 1 && !list_.before(prefix_.back(), furthest);
  steps_in_prefix_ = stays ? steps_in_prefix_ + 1 : 0;
  list_.insertAfter(object, furthest);
  setActive(object, true, source);
  mark_[object] = epoch_;
  ++reinsertions_;
}

void IncrementalSort::formMarkedPrefix(std::uint32_t object) {
  prefix_.assign(1, object);
  for (std::uint32_t next = list_.first(); next != kNone && marked(next); next = list_.next(next)) {
    prefix_.push_back(next);
  }
}

// Figure 5. Always follows the first occluder in the sequence. So if each of the first m objects is occluded
// by one of them, the path never leaves them and closes.
bool IncrementalSort::detectCycle(OccluderSource& source) {
  path_.assign(1, 0);
  on_path_.assign(prefix_.size(), 0);
  while (path_.size() <= prefix_.size()) {
    const std::uint32_t last = path_.back();
    on_path_[last] = 1;
    for (std::size_t k = 0; k + 1 < path_.size(); ++k) {
      if (occludes(prefix_[path_[k]], prefix_[last], source)) {
        cycle_.clear();
        for (std::size_t i = k; i < path_.size(); ++i) {
          cycle_.push_back(prefix_[path_[i]]);
        }
        return true;
      }
    }
    std::uint32_t occluder = 0;  // objects on the path have just been tested
    while (occluder < prefix_.size() &&
           (on_path_[occluder] != 0 || !occludes(prefix_[occluder], prefix_[last], source))) {
      ++occluder;
    }
    if (occluder == prefix_.size()) {
      return false;
    }
    path_.push_back(occluder);
  }
  return false;
}

// Makes one object of cycle_ and puts it, unmarked, at the front. `object` is not in the list and need not be
// in the cycle.
void IncrementalSort::group(std::uint32_t object) {
  list_.insertFirst(object);
  const std::uint32_t name = cycle_.front();
  list_.remove(name);
  for (std::size_t i = 1; i < cycle_.size(); ++i) {
    const std::uint32_t joined = cycle_[i];
    list_.remove(joined);
    for (std::uint32_t part = joined; part != kNone; part = next_member_[part]) {
      object_[part] = name;
    }
    next_member_[last_member_[name]] = joined;
    last_member_[name] = last_member_[joined];
  }
  list_.insertFirst(name);
  mark_[name] = 0;
  steps_in_prefix_ = 0;
}

// Outputs the object whose parts are in members_; it is neither in the list nor active.
void IncrementalSort::emit(GroupedOrder& order) {
  order.parts.insert(order.parts.end(), members_.begin(), members_.end());
  order.first_of.push_back(static_cast<std::uint32_t>(order.parts.size()));
  ++epoch_;  // unmarks all objects
  steps_in_prefix_ = 0;
}

// Whether a part of one object occludes a part of another.
bool IncrementalSort::occludes(std::uint32_t front, std::uint32_t back, OccluderSource& source) const {
  for (std::uint32_t f = front; f != kNone; f = next_member_[f]) {
    for (std::uint32_t b = back; b != kNone; b = next_member_[b]) {
      if (source.occludes(f, b)) {
        return true;
      }
    }
  }
  return false;
}

void IncrementalSort::setActive(std::uint32_t object, bool active, OccluderSource& source) const {
  for (std::uint32_t part = object; part != kNone; part = next_member_[part]) {
    source.setActive(part, active);
  }
}

// Collects the parts of an object in the previous order.
void IncrementalSort::collectMembers(std::uint32_t object, std::vector<std::uint32_t>& members) const {
  members.clear();
  for (std::uint32_t part = object; part != kNone; part = next_member_[part]) {
    members.push_back(part);
  }
  std::sort(members.begin(), members.end(),
            [this](std::uint32_t a, std::uint32_t b) { return rank_[a] < rank_[b]; });
}

}  // namespace sightline::comparison
