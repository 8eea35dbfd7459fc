#include "src/layers/sort/layer_source.h"

#include <algorithm>

namespace sightline::layers {
LayerSource::LayerSource(const LayerSettings& settings, const PartExtents& extents, PartOcclusion& occlusion)
    : search_(settings.search),
      exact_(settings.exact),
      extents_(extents),
      occlusion_(occlusion),
      tree_(settings.tree) {}

void LayerSource::beginFrame(std::span<const std::uint32_t> sorted) {
  const ExtentTable& table = extents_.table();
  by_tree_ = search_ == OccluderSearch::kTree;
  if (by_tree_) {
    tree_.update(table);
    deactivateOthers(sorted);
  } else {
    scan_.begin(table, sorted);
  }
  queries_ = candidates_ = 0;
}

void LayerSource::deactivateOthers(std::span<const std::uint32_t> sorted) {
  const std::size_t parts = extents_.table().parts;
  if (sorted.size() == parts) {
    return;
  }
  listed_.assign(parts, 0);
  for (const std::uint32_t part : sorted) {
    listed_[part] = 1;
  }
  for (std::uint32_t part = 0; part < parts; ++part) {
    if (listed_[part] == 0) {
      tree_.setActive(part, false);
    }
  }
}

void LayerSource::setActive(std::uint32_t part, bool active) {
  by_tree_ ? tree_.setActive(part, active) : scan_.setActive(part, active);
}

bool LayerSource::mayOcclude(std::uint32_t front, std::uint32_t back) const {
  return extents_.mayOcclude(front, back);
}

bool LayerSource::occludes(std::uint32_t front, std::uint32_t back) {
  return mayOcclude(front, back) && (!exact_ || occlusion_.occludes(front, back));
}

// The united extents of a group enclose room between its members, so each is asked about alone (section 5.3).
bool LayerSource::occludesOneOf(std::uint32_t front, std::span<const std::uint32_t> members) {
  if (members.size() == 1) {  // whose extents are those that found it
    return !exact_ || occlusion_.occludes(front, members[0]);
  }
  return std::any_of(members.begin(), members.end(),
                     [&](std::uint32_t member) { return occludes(front, member); });
}

void LayerSource::occludersOf(std::span<const std::uint32_t> members, std::vector<std::uint32_t>& occluders) {
  const Extent query = members.size() == 1 ? extents_.query(members[0]) : extents_.query(members);
  found_.clear();
  by_tree_ ? tree_.query(query, found_) : scan_.query(query, found_);
  ++queries_;
  for (const std::uint32_t part : found_) {
    if (std::find(members.begin(), members.end(), part) != members.end()) {
      continue;
    }
    ++candidates_;
    if (occludesOneOf(part, members)) {
      occluders.push_back(part);
    }
  }
}

}  // namespace sightline::layers
