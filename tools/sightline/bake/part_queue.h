#pragma once

// The queue between the main thread and the baking threads of a process: parts to bake, and finished parts.

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sightline/pvs/bake/bake.h"

namespace sightline::tool {

struct FinishedPart {
  std::uint64_t id = 0;
  BakedPart bytes{};
};

// Each taker of parts (a thread of this process, or another process) has a number. The parts that a part was
// divided into are first offered to the taker that baked it, which has most of their samples in memory. Any
// thread may call any function.
class PartQueue {
 public:
  explicit PartQueue(std::uint32_t takers) : parts_(takers) {}

  // Adds parts, offered to this taker first, in this order.
  void add(std::uint32_t taker, std::span<const PartTask> parts);
  void close();  // no more parts will be added
  void clear();  // drops the parts that were not taken, and closes the queue

  // Takes the taker's own next part or, if it has none, the first one of another taker, which is usually the
  // largest. Waits for a part; none if no more will come.
  std::optional<PartTask> take(std::uint32_t taker);
  // Takes up to max_parts parts without waiting.
  std::vector<PartTask> takeNow(std::uint32_t taker, std::uint64_t max_parts);
  // How many parts nobody has taken yet.
  std::size_t waiting() const;

  void finish(FinishedPart part);
  void fail(const std::string& reason);  // called in place of finish() if a part cannot be baked
  // The parts finished since the last call. Waits up to `patience` for one.
  std::vector<FinishedPart> finished(std::chrono::milliseconds patience);
  std::optional<std::string> failure() const;  // the reason given first

 private:
  std::optional<PartTask> next(std::uint32_t taker);  // precondition: the lock is held

  mutable std::mutex mutex_;
  std::condition_variable more_parts_, more_finished_;
  std::vector<std::deque<PartTask>> parts_;  // one for each taker; its next part is the last one
  std::vector<FinishedPart> finished_;
  std::optional<std::string> failure_;
  bool closed_ = false;
};

}  // namespace sightline::tool
