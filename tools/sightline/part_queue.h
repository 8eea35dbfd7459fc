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
  std::uint32_t part = 0;
  BakedPart bytes{};
};

// Any thread may call anything.
class PartQueue {
 public:
  void add(std::span<const std::uint32_t> parts);
  void close();  // nothing will be added any more
  void clear();  // drops what was not taken, and closes

  // The next part; waits for one. Nothing: there will be none.
  std::optional<std::uint32_t> take();
  // Up to so many of the next parts, without waiting.
  std::vector<std::uint32_t> takeNow(std::uint64_t most);

  void finish(FinishedPart part);
  void fail(const std::string& reason);  // instead
  // What was finished since the last call, waiting so long for something.
  std::vector<FinishedPart> finished(std::chrono::milliseconds patience);
  std::optional<std::string> failure() const;  // the first

 private:
  mutable std::mutex mutex_;
  std::condition_variable more_parts_, more_finished_;
  std::deque<std::uint32_t> parts_;
  std::vector<FinishedPart> finished_;
  std::optional<std::string> failure_;
  bool closed_ = false;
};

}  // namespace sightline::tool
