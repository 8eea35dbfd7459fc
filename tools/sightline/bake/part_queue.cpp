#include "tools/sightline/bake/part_queue.h"

#include <algorithm>
#include <utility>

namespace sightline::tool {

void PartQueue::add(std::uint32_t taker, std::span<const PartTask> parts) {
  const std::lock_guard lock(mutex_);
  if (closed_) {
    return;  // after a failure nobody needs further parts
  }
  parts_[taker].insert(parts_[taker].end(), parts.rbegin(), parts.rend());
  more_parts_.notify_all();
}

void PartQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  more_parts_.notify_all();
}

void PartQueue::clear() {
  const std::lock_guard lock(mutex_);
  for (std::deque<PartTask>& own : parts_) {
    own.clear();
  }
  closed_ = true;
  more_parts_.notify_all();
}

// Ids grow with the level, so the smallest id belongs to the largest cell.
std::optional<PartTask> PartQueue::next(std::uint32_t taker) {
  if (std::deque<PartTask>& own = parts_[taker]; !own.empty()) {
    const PartTask part = own.back();
    own.pop_back();
    return part;
  }
  const auto other = std::ranges::min_element(parts_, {}, [](const std::deque<PartTask>& others) {
    return others.empty() ? ~std::uint64_t{0} : others.front().id;
  });
  if (other->empty()) {
    return std::nullopt;
  }
  const PartTask part = other->front();
  other->pop_front();
  return part;
}

std::optional<PartTask> PartQueue::take(std::uint32_t taker) {
  std::unique_lock lock(mutex_);
  std::optional<PartTask> part;
  more_parts_.wait(lock, [&] { return (part = next(taker)) || closed_; });
  return part;
}

std::vector<PartTask> PartQueue::takeNow(std::uint32_t taker, std::uint64_t max_parts) {
  const std::lock_guard lock(mutex_);
  std::vector<PartTask> taken;
  while (taken.size() < max_parts) {
    const std::optional<PartTask> part = next(taker);
    if (!part) {
      break;
    }
    taken.push_back(*part);
  }
  return taken;
}

std::size_t PartQueue::waiting() const {
  const std::lock_guard lock(mutex_);
  std::size_t count = 0;
  for (const std::deque<PartTask>& own : parts_) {
    count += own.size();
  }
  return count;
}

void PartQueue::finish(FinishedPart part) {
  const std::lock_guard lock(mutex_);
  finished_.push_back(std::move(part));
  more_finished_.notify_one();
}

void PartQueue::fail(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  failure_ = failure_.value_or(reason);
  more_finished_.notify_one();
}

std::vector<FinishedPart> PartQueue::finished(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  more_finished_.wait_for(lock, patience, [&] { return !finished_.empty() || failure_; });
  return std::exchange(finished_, {});
}

std::optional<std::string> PartQueue::failure() const {
  const std::lock_guard lock(mutex_);
  return failure_;
}

}  // namespace sightline::tool
