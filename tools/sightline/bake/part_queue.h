#pragma once

// What the threads of one process bake, and what they baked: between them and the main thread.

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

// Whoever takes parts has a number: the threads of this process, and other processes. What a part is divided
// into is first offered to who baked it, who has most of its viewpoints at hand. Any thread may call
// anything.
class PartQueue {
 public:
  explicit PartQueue(std::uint32_t takers) : parts_(takers) {}

  // For this taker first; the first of them before the others.
  void add(std::uint32_t taker, std::span<const PartTask> parts);
  void close();  // nothing will be added any more
  void clear();  // drops what was not taken, and closes

  // Takes the taker's own next part, or, where it has none, the first one of another taker, which is mostly
  // the largest. Waits for one. Nothing: there will be none.
  std::optional<PartTask> take(std::uint32_t taker);
  // Up to so many of them, without waiting.
  std::vector<PartTask> takeNow(std::uint32_t taker, std::uint64_t most);

  void finish(FinishedPart part);
  void fail(const std::string& reason);  // instead
  // What was finished since the last call, waiting so long for something.
  std::vector<FinishedPart> finished(std::chrono::milliseconds patience);
  std::optional<std::string> failure() const;  // the first

 private:
  std::optional<PartTask> next(std::uint32_t taker);  // under the lock

  mutable std::mutex mutex_;
  std::condition_variable more_parts_, more_finished_;
  std::vector<std::deque<PartTask>> parts_;  // by taker; the next one is the last
  std::vector<FinishedPart> finished_;
  std::optional<std::string> failure_;
  bool closed_ = false;
};

}  // namespace sightline::tool
