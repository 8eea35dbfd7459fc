#include "src/layers/sort/layer_source.h"

#include <algorithm>
#include <utility>

namespace sightline::layers {
LayerSource::LayerSource(std::unique_ptr<CandidateSearch> search, bool exact, const PartExtents& extents,
                         PartOcclusion& occlusion)
    : search_(std::move(search)), exact_(exact), extents_(extents), occlusion_(occlusion) {}

void LayerSource::beginFrame(std::span<const std::uint32_t> sorted) {
  search_->beginFrame(extents_.table(), sorted);
  queries_ = candidates_ = 0;
}

void LayerSource::setActive(std::uint32_t part, bool active) {
  search_->setActive(part, active);
}

bool LayerSource::mayOcclude(std::uint32_t front, std::uint32_t back) const {
  return extents_.mayOcclude(front, back);
}

bool LayerSource::occludes(std::uint32_t front, std::uint32_t back) {
  return mayOcclude(front, back) && (!exact_ || occlusion_.occludes(front, back));
}

void LayerSource::candidatesOf(std::uint32_t part, std::vector<std::uint32_t>& candidates) {
  const auto begin = static_cast<std::ptrdiff_t>(candidates.size());
  search_->query(extents_.query(part), candidates);
  const auto self = std::lower_bound(candidates.begin() + begin, candidates.end(), part);
  if (self != candidates.end() && *self == part) {
    candidates.erase(self);
  }
  ++queries_;
  candidates_ += static_cast<std::uint64_t>(candidates.end() - candidates.begin() - begin);
}

bool LayerSource::candidateOccludes(std::uint32_t candidate, std::uint32_t part) {
  return !exact_ || occlusion_.occludes(candidate, part);
}

// The united extents of a group also enclose the space between its parts, so each part is tested alone
// (section 5.3 of the paper).
void LayerSource::occludersOf(std::span<const std::uint32_t> group, std::vector<std::uint32_t>& occluders) {
  found_.clear();
  search_->query(extents_.query(group), found_);
  ++queries_;
  for (const std::uint32_t part : found_) {
    if (std::find(group.begin(), group.end(), part) != group.end()) {
      continue;
    }
    ++candidates_;
    if (std::any_of(group.begin(), group.end(),
                    [&](std::uint32_t member) { return occludes(part, member); })) {
      occluders.push_back(part);
    }
  }
}

}  // namespace sightline::layers
