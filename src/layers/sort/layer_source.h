#pragma once

// The occlusion graph of a frame's parts: candidates by their extents, then exact tests of pairs.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "src/layers/extents/candidate_search.h"
#include "src/layers/extents/part_extents.h"
#include "src/layers/pairs/part_occlusion.h"
#include "src/layers/sort/occluder_source.h"

namespace sightline::layers {

class LayerSource final : public OccluderSource {
 public:
  // exact: false means that overlapping extents count as an occlusion.
  LayerSource(std::unique_ptr<CandidateSearch> search, bool exact, const PartExtents& extents,
              PartOcclusion& occlusion);

  // Call once a frame, after the extents and the occlusion tests have been given the view.
  // sorted: the parts to be sorted, in about their final order; they alone are active afterwards.
  void beginFrame(std::span<const std::uint32_t> sorted);
  void rebuildSearch() { search_->rebuild(extents_.table()); }

  void candidatesOf(std::uint32_t part, std::vector<std::uint32_t>& candidates) override;
  bool candidateOccludes(std::uint32_t candidate, std::uint32_t part) override;
  void occludersOf(std::span<const std::uint32_t> group, std::vector<std::uint32_t>& occluders) override;
  // Also where `front` is not active: LayerSorter asks about parts that are in the order.
  bool occludes(std::uint32_t front, std::uint32_t back) override;
  void setActive(std::uint32_t part, bool active) override;

  // Whether the extents allow that `front` occludes `back`; false is certain.
  bool mayOcclude(std::uint32_t front, std::uint32_t back) const;

  std::uint64_t queries() const { return queries_; }
  std::uint64_t candidates() const { return candidates_; }

 private:
  std::unique_ptr<CandidateSearch> search_;
  bool exact_;
  const PartExtents& extents_;
  PartOcclusion& occlusion_;
  std::uint64_t queries_ = 0, candidates_ = 0;
  std::vector<std::uint32_t> found_;  // scratch for one query
};

}  // namespace sightline::layers
