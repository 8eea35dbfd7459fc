#pragma once

// Strongly connected components of the occlusion graph, front to back, by correcting the last order.
//
// Based on: Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11,
// 1997, section 4 (incremental visibility sort).
// Differs from the paper in: places in the list are compared by labels, not by traversing the list; unmarking
// all objects increments a counter; of several occluders in a marked sequence the first is followed, without
// which the sort may not halt.

#include <cstdint>
#include <span>
#include <vector>

#include "src/comparison/layers/order_labels.h"
#include "src/layers/sort/layer_sort_algorithm.h"

namespace sightline::comparison {

using layers::GroupedOrder;
using layers::OccluderSource;

class IncrementalSort final : public LayerSortAlgorithm {
 public:
  // A function that is called at the start and after each step with the list and the output so far.
  struct Observer {
    void (*call)(void* user, const IncrementalSort& sort, const GroupedOrder& output) = nullptr;
    void* user = nullptr;
  };
  // An entry of the list: a part, or a group of parts in the previous order.
  struct Listed {
    std::vector<std::uint32_t> members;
    bool marked = false;
  };

  // Makes the same groups as DepthFirstSort. Halts for any source, also for one that contradicts itself: then
  // groups may be larger than necessary, and the order is right for the last answers of occludersOf(). Does
  // not allocate after a call of the same size.
  void sort(std::span<const std::uint32_t> previous, OccluderSource& source, GroupedOrder& order,
            const Observer& observer);
  void sort(std::span<const std::uint32_t> previous, OccluderSource& source, GroupedOrder& order) override {
    sort(previous, source, order, Observer{});
  }

  // How often the last sort put an object back into the list behind its furthest occluder.
  std::uint64_t reinsertions() const override { return reinsertions_; }
  // Returns the list from the front, for observers. Allocates.
  std::vector<Listed> list() const;

 private:
  void prepare(std::span<const std::uint32_t> previous, GroupedOrder& order);
  void step(std::uint32_t object, OccluderSource& source, GroupedOrder& order);
  bool groupCycle(std::uint32_t object, OccluderSource& source);
  void placeByOccluders(std::uint32_t object, OccluderSource& source, GroupedOrder& order);
  void formMarkedPrefix(std::uint32_t object);
  bool detectCycle(OccluderSource& source);
  void group(std::uint32_t object);
  void emit(GroupedOrder& order);
  bool occludes(std::uint32_t front, std::uint32_t back, OccluderSource& source) const;
  void setActive(std::uint32_t object, bool active, OccluderSource& source) const;
  void collectMembers(std::uint32_t object, std::vector<std::uint32_t>& members) const;
  bool marked(std::uint32_t object) const { return mark_[object] == epoch_; }

  // An object (a part or a group) is named by one of its parts. One element per part:
  std::vector<std::uint32_t> rank_;         // place in the previous order
  std::vector<std::uint32_t> object_;       // the object that it belongs to
  std::vector<std::uint32_t> next_member_;  // the next part of the same object; kNone: it is the last
  std::vector<std::uint32_t> last_member_;  // for an object: its last part
  std::vector<std::uint32_t> mark_;         // for an object: it is marked if this equals epoch_

  OrderLabels list_;
  std::uint32_t epoch_ = 1;
  std::uint64_t reinsertions_ = 0;
  // Number of consecutive reinsertions within the marked sequence at the front.
  std::uint64_t steps_in_prefix_ = 0;

  std::vector<std::uint32_t> members_, occluders_;
  std::vector<std::uint32_t> prefix_;  // the paper's S
  std::vector<std::uint32_t> path_;    // indices of prefix_
  std::vector<std::uint8_t> on_path_;  // one per element of prefix_
  std::vector<std::uint32_t> cycle_;   // objects of the cycle found last
};

}  // namespace sightline::comparison
