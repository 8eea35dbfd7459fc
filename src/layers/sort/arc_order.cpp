#include "sightline/layers/arc_order.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "src/layers/sort/depth_first_sort.h"
#include "src/layers/sort/occluder_source.h"

namespace sightline {

using namespace layers;

namespace {

// Answers from a list of arcs.
class ArcSource : public OccluderSource {
 public:
  // parts: those to be sorted. arcs: ascending.
  void begin(std::size_t numbers, std::span<const std::uint32_t> parts, std::span<const LayerArc> arcs) {
    active_.assign(numbers, 0);
    for (const std::uint32_t part : parts) {
      active_[part] = 1;
    }
    by_back_.clear();
    for (const LayerArc& arc : arcs) {
      if (arc.front != arc.back && arc.front.value < numbers && arc.back.value < numbers &&
          active_[arc.front.value] != 0 && active_[arc.back.value] != 0) {
        by_back_.push_back({arc.back.value, arc.front.value});
      }
    }
    std::sort(by_back_.begin(), by_back_.end());
  }

  void candidatesOf(std::uint32_t part, std::vector<std::uint32_t>& candidates) override {
    const auto of_part = std::lower_bound(by_back_.begin(), by_back_.end(), BackArc{part, 0});
    for (auto arc = of_part; arc != by_back_.end() && arc->back == part; ++arc) {
      if (active_[arc->front] != 0) {
        candidates.push_back(arc->front);
      }
    }
  }
  bool candidateOccludes(std::uint32_t, std::uint32_t) override { return true; }
  void setActive(std::uint32_t part, bool active) override { active_[part] = active ? 1 : 0; }

 private:
  struct BackArc {
    std::uint32_t back = 0, front = 0;

    friend auto operator<=>(const BackArc&, const BackArc&) = default;
  };
  std::vector<BackArc> by_back_;  // ascending
  std::vector<std::uint8_t> active_;
};

}  // namespace

struct ArcSorter::Impl {
  // This is what a result refers to.
  struct Storage {
    std::vector<PartId> parts;
    std::vector<std::uint32_t> first_of;
    std::vector<LayerArc> arcs;
  };

  ArcSource source;
  DepthFirstSort algorithm;
  std::vector<std::uint32_t> previous;
  GroupedOrder sorted;
  Storage made, last;  // the last result may be what is sorted now
  LayerOrder out;

  void takeGroups(const LayerOrder& order, std::size_t begin, std::size_t end);
};

ArcSorter::ArcSorter() : impl_(std::make_unique<Impl>()) {}
ArcSorter::~ArcSorter() = default;
ArcSorter::ArcSorter(ArcSorter&&) noexcept = default;
ArcSorter& ArcSorter::operator=(ArcSorter&&) noexcept = default;

// Appends groups as they are.
void ArcSorter::Impl::takeGroups(const LayerOrder& order, std::size_t begin, std::size_t end) {
  for (std::size_t i = begin; i < end; ++i) {
    made.first_of.push_back(static_cast<std::uint32_t>(made.parts.size()));
    made.parts.insert(made.parts.end(), order.group(i).begin(), order.group(i).end());
  }
}

const LayerOrder& ArcSorter::sort(const LayerOrder& order, std::span<const LayerArc> arcs) {
  Impl& own = *impl_;
  std::swap(own.made, own.last);
  own.made.arcs.assign(arcs.begin(), arcs.end());
  std::sort(own.made.arcs.begin(), own.made.arcs.end());
  own.made.arcs.erase(std::unique(own.made.arcs.begin(), own.made.arcs.end()), own.made.arcs.end());

  const std::size_t end = order.sorted_end;
  own.previous.clear();
  std::uint32_t numbers = 0;
  for (const PartId part : order.parts) {
    numbers = std::max(numbers, part.value + 1);
  }
  for (std::size_t i = order.first_sorted; i < end; ++i) {
    for (const PartId part : order.group(i)) {
      own.previous.push_back(part.value);
    }
  }
  own.source.begin(numbers, own.previous, own.made.arcs);
  own.algorithm.sort(own.previous, own.source, own.sorted);

  own.made.parts.clear();
  own.made.first_of.clear();
  own.takeGroups(order, 0, order.first_sorted);
  for (std::size_t i = 0; i < own.sorted.groups(); ++i) {
    own.made.first_of.push_back(static_cast<std::uint32_t>(own.made.parts.size()));
    for (const std::uint32_t part : own.sorted.group(i)) {
      own.made.parts.emplace_back(part);
    }
  }
  const auto sorted_end = static_cast<std::uint32_t>(own.made.first_of.size());
  own.takeGroups(order, end, order.groups());
  own.made.first_of.push_back(static_cast<std::uint32_t>(own.made.parts.size()));
  own.out = order;
  own.out.parts = own.made.parts;
  own.out.first_of = own.made.first_of;
  own.out.arcs = own.made.arcs;
  own.out.sorted_end = sorted_end;
  if (order.depth_buffered != LayerOrder::kNone) {
    own.out.depth_buffered = sorted_end + (order.depth_buffered - static_cast<std::uint32_t>(end));
  }
  return own.out;
}

}  // namespace sightline
