#pragma once

// Groups of parts that occlude each other in a circle, front to back, by correcting the last order.
//
// Based on: Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11,
// 1997, section 4 (incremental visibility sort).
// Differs from the paper in: an object's place in the list is a label that is compared, not found by walking;
// unmarking everything is counting up; of several occluders in a marked sequence the first one is followed,
// without which the sort need not halt; all arcs within groups are asked for at the end.

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
  // Called with the list as it is at the start and after each step, and the output so far.
  struct Observer {
    void (*call)(void* user, const IncrementalSort& sort, const GroupedOrder& output) = nullptr;
    void* user = nullptr;
  };
  // An entry of the list: one part, or several that have been grouped, in the previous order.
  struct Listed {
    std::vector<std::uint32_t> members;
    bool marked = false;
  };

  // previous: every part that is to be sorted, each once, ungrouped. The source answers with these parts
  // alone; afterwards none is active. The same groups as DepthFirstSort's, parts of a group in the previous
  // order. Halts for any source, also for one that contradicts itself: then parts may be joined that need
  // not be, and the order is right for what occludersOf() answered last. No allocation after calls as large.
  void sort(std::span<const std::uint32_t> previous, OccluderSource& source, GroupedOrder& order,
            const Observer& observer);
  void sort(std::span<const std::uint32_t> previous, OccluderSource& source, GroupedOrder& order) override {
    sort(previous, source, order, Observer{});
  }

  // Of the last sort: how often an object went back into the list behind its furthest occluder.
  std::uint64_t reinsertions() const override { return reinsertions_; }
  // The list from the front; for observers. Allocates.
  std::vector<Listed> list() const;

 private:
  void prepare(std::span<const std::uint32_t> previous, GroupedOrder& order);
  void step(std::uint32_t object, OccluderSource& source, GroupedOrder& order);
  bool groupCycle(std::uint32_t object, OccluderSource& source);
  void placeByOccluders(std::uint32_t object, OccluderSource& source, GroupedOrder& order);
  void formMarkedPrefix(std::uint32_t object);
  bool detectCycle(OccluderSource& source);
  void group(std::uint32_t object, OccluderSource& source);
  void emit(GroupedOrder& order);
  void collectArcs(OccluderSource& source, GroupedOrder& order) const;
  bool occludes(std::uint32_t front, std::uint32_t back, OccluderSource& source) const;
  void setActive(std::uint32_t object, bool active, OccluderSource& source) const;
  void collectMembers(std::uint32_t object, std::vector<std::uint32_t>& members) const;
  bool marked(std::uint32_t object) const { return mark_[object] == epoch_; }

  // An object is named by one of its parts. One a part:
  std::vector<std::uint32_t> rank_;         // in the previous order
  std::vector<std::uint32_t> object_;       // which it belongs to
  std::vector<std::uint32_t> next_member_;  // of the same object; kNone: last
  std::vector<std::uint32_t> last_member_;  // of an object
  std::vector<std::uint32_t> mark_;         // of an object: marked if it is the epoch

  OrderLabels list_;
  std::uint32_t epoch_ = 1;
  std::uint64_t reinsertions_ = 0;
  // Objects that were reinserted within the marked sequence at the front since something else happened.
  std::uint64_t steps_in_prefix_ = 0;

  std::vector<std::uint32_t> members_, occluders_;
  std::vector<std::uint32_t> prefix_;  // the paper's S
  std::vector<std::uint32_t> path_;    // into prefix_
  std::vector<std::uint8_t> on_path_;  // one a place in prefix_
  std::vector<std::uint32_t> cycle_;   // objects
};

}  // namespace sightline::comparison
