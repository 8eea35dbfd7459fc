#include "tools/sightline/part_queue.h"

#include <algorithm>
#include <utility>

namespace sightline::tool {

void PartQueue::add(std::span<const std::uint32_t> parts) {
  const std::lock_guard lock(mutex_);
  parts_.insert(parts_.end(), parts.begin(), parts.end());
  more_parts_.notify_all();
}

void PartQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  more_parts_.notify_all();
}

void PartQueue::clear() {
  const std::lock_guard lock(mutex_);
  parts_.clear();
  closed_ = true;
  more_parts_.notify_all();
}

std::optional<std::uint32_t> PartQueue::take() {
  std::unique_lock lock(mutex_);
  more_parts_.wait(lock, [&] { return closed_ || !parts_.empty(); });
  if (parts_.empty()) {
    return std::nullopt;
  }
  const std::uint32_t part = parts_.front();
  parts_.pop_front();
  return part;
}

std::vector<std::uint32_t> PartQueue::takeNow(std::uint64_t most) {
  const std::lock_guard lock(mutex_);
  const auto end = parts_.begin() + static_cast<std::ptrdiff_t>(std::min<std::uint64_t>(most, parts_.size()));
  const std::vector<std::uint32_t> taken(parts_.begin(), end);
  parts_.erase(parts_.begin(), end);
  return taken;
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
