#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sightline::pvs {

// An LRU cache of decoded sets with a budget in bytes. Its index takes another four bytes per set of the
// file.
class SetCache {
 public:
  SetCache(std::uint32_t set_count, std::size_t budget_bytes);

  enum class State : std::uint8_t { kMissing, kCached, kBroken };
  State state(std::uint32_t set) const;

  // Requires state(set) == kCached. Marks the set as most recently used. Valid until the next insert().
  std::span<const std::uint32_t> use(std::uint32_t set);
  // Requires state(set) == kMissing. Copies the nodes. The new set is kept even if it alone exceeds the
  // budget.
  std::span<const std::uint32_t> insert(std::uint32_t set, std::span<const std::uint32_t> nodes);
  void markBroken(std::uint32_t set) { slot_of_[set] = kBrokenSet; }

  std::size_t bytes() const { return bytes_; }  // storage of the sets: at most the budget, or one set

 private:
  static constexpr std::uint32_t kNoSlot = 0xffffffffu, kBrokenSet = 0xfffffffeu;

  struct Slot {
    std::uint32_t set = 0;
    std::uint32_t newer = kNoSlot, older = kNoSlot;
    std::vector<std::uint32_t> nodes;
  };

  void unlink(std::uint32_t slot);
  void linkAsNewest(std::uint32_t slot);
  void setNodes(Slot& slot, std::span<const std::uint32_t> nodes);
  std::uint32_t freeSlot(std::size_t bytes);

  std::vector<std::uint32_t> slot_of_;  // by set
  std::vector<Slot> slots_;
  std::vector<std::uint32_t> free_;  // slots without a set and without storage
  std::uint32_t newest_ = kNoSlot, oldest_ = kNoSlot;
  std::size_t budget_, bytes_ = 0;
};

}  // namespace sightline::pvs
