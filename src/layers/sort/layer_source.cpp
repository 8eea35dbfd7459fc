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

// The united extents of a group also enclose the space between its parts, so each part is tested alone
// (section 5.3 of the paper).
bool LayerSource::occludesOneOf(std::uint32_t front, std::span<const std::uint32_t> group) {
  if (group.size() == 1) {  // the search has compared the extents already
    return !exact_ || occlusion_.occludes(front, group[0]);
  }
  return std::any_of(group.begin(), group.end(),
                     [&](std::uint32_t member) { return occludes(front, member); });
}

void LayerSource::occludersOf(std::span<const std::uint32_t> group, std::vector<std::uint32_t>& occluders) {
  const Extent query = group.size() == 1 ? extents_.query(group[0]) : extents_.query(group);
  found_.clear();
  search_->query(query, found_);
  ++queries_;
  for (const std::uint32_t part : found_) {
    if (std::find(group.begin(), group.end(), part) != group.end()) {
      continue;
    }
    ++candidates_;
    if (occludesOneOf(part, group)) {
      occluders.push_back(part);
    }
  }
}

}  // namespace sightline::layers
