#pragma once

// Who occludes whom among the parts of a frame: extents first, then exact tests of pairs.

#include <cstdint>
#include <span>
#include <vector>

#include "src/comparison/layers/extent_tree.h"
#include "src/layers/extents/extent_scan.h"
#include "src/layers/extents/part_extents.h"
#include "src/layers/pairs/part_occlusion.h"
#include "src/layers/sort/occluder_source.h"

namespace sightline::layers {

class LayerSource final : public OccluderSource {
 public:
  LayerSource(const LayerSettings& settings, const PartExtents& extents, PartOcclusion& occlusion);

  // Once a frame, when extents and occlusion know the view. sorted: the parts that take part, in about the
  // order in which they will leave; all of them are active, and no others.
  void beginFrame(std::span<const std::uint32_t> sorted);
  void rebuildTree() { tree_.build(extents_.table()); }

  void occludersOf(std::span<const std::uint32_t> members, std::vector<std::uint32_t>& occluders) override;
  bool occludes(std::uint32_t front, std::uint32_t back) override;
  void setActive(std::uint32_t part, bool active) override;

  // By extents alone: false is certain.
  bool mayOcclude(std::uint32_t front, std::uint32_t back) const;

  bool byTree() const { return by_tree_; }
  std::uint64_t queries() const { return queries_; }
  std::uint64_t candidates() const { return candidates_; }

 private:
  void deactivateOthers(std::span<const std::uint32_t> sorted);
  bool occludesOneOf(std::uint32_t front, std::span<const std::uint32_t> members);

  OccluderSearch search_;
  bool exact_;
  const PartExtents& extents_;
  PartOcclusion& occlusion_;
  ExtentScan scan_;
  ExtentTree tree_;
  bool by_tree_ = false;
  std::uint64_t queries_ = 0, candidates_ = 0;
  // Scratch.
  std::vector<std::uint32_t> found_;
  std::vector<std::uint8_t> listed_;  // one a part
};

}  // namespace sightline::layers
