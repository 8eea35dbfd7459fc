#include "sightline/pvs/query/set_query.h"

#include <array>
#include <utility>
#include <vector>

#include "src/pvs/query/cell_finder.h"
#include "src/pvs/query/chunk_decoder.h"
#include "src/pvs/query/set_cache.h"
#include "src/pvs/query/sight_data.h"

namespace sightline {
namespace {

using pvs::CellFinder;
using pvs::ChunkDecoder;
using pvs::SetCache;

constexpr std::array<std::uint32_t, 1> kRoot{0};

VisibleSet everything() {
  return {VisibleSet::kEverything, kRoot};
}

// The set of the side of the leaf's plane that the eye is on. CellPlane explains the rounding.
std::uint32_t setOf(const OctreeView& octree, const OctreeLeaf& leaf, const Vec3d& eye) {
  if (leaf.plane == OctreeLeaf::kNoPlane) {
    return leaf.set;
  }
  const CellSide side = sideOf(octree.planes[leaf.plane], eye);
  return side == CellSide::kFront ? leaf.front_set : side == CellSide::kBack ? leaf.back_set : leaf.set;
}

}  // namespace

struct SetQuery::Impl {
  Impl(SightFile opened, const SetQuerySettings& settings)
      : file(std::move(opened)),
        octree(file.octree()),
        near_distance(file.record().near_distance),
        finder(octree),
        cache(file.setCount(), settings.cache_bytes) {}

  // Decodes or looks up a set other than the last one.
  VisibleSet fetch(const pvs::SightView& view, std::uint32_t set);
  VisibleSet remember(std::uint32_t set, std::span<const std::uint32_t> nodes) { return last = {set, nodes}; }

  SightFile file;
  OctreeView octree;
  double near_distance;
  CellFinder finder;
  std::uint32_t last_leaf = CellFinder::kOutside;
  VisibleSet last = everything();
  SetCache cache;
  ChunkDecoder decoder;
  std::vector<std::uint32_t> decoded;  // scratch
  SetQueryStats stats;
};

VisibleSet SetQuery::Impl::fetch(const pvs::SightView& view, std::uint32_t set) {
  switch (cache.state(set)) {
    case SetCache::State::kCached:
      return remember(set, cache.use(set));
    case SetCache::State::kMissing: {
      decoded.clear();
      const bool sound = decoder.readSet(view, set, decoded);
      stats.chunk_bytes = decoder.bytesRead();
      if (sound) {
        ++stats.decoded;
        remember(set, cache.insert(set, decoded));
        stats.cached_bytes = cache.bytes();
        return last;
      }
      cache.markBroken(set);
      break;
    }
    case SetCache::State::kBroken:
      break;
  }
  ++stats.broken;
  return everything();
}

SetQuery::SetQuery(SightFile file, const SetQuerySettings& settings)
    : impl_(std::make_unique<Impl>(std::move(file), settings)) {}
SetQuery::~SetQuery() = default;
SetQuery::SetQuery(SetQuery&&) noexcept = default;
SetQuery& SetQuery::operator=(SetQuery&&) noexcept = default;

BoxTreeView SetQuery::boxes() const {
  return impl_->file.boxes();
}

VisibleSet SetQuery::find(const Vec3d& eye, double near_distance) {
  Impl& query = *impl_;
  ++query.stats.finds;
  // Negated so that NaN also counts as beyond.
  if (!(near_distance <= query.near_distance)) {
    ++query.stats.beyond_near;
    return everything();
  }
  const std::uint32_t leaf = query.finder.find(eye);
  query.stats.same_cell += leaf == query.last_leaf && leaf != CellFinder::kOutside ? 1 : 0;
  query.last_leaf = leaf;
  if (leaf == CellFinder::kOutside || !query.finder.expects(eye)) {
    ++query.stats.outside;
    return everything();
  }
  const std::uint32_t set = setOf(query.octree, query.octree.leaves[leaf], eye);
  return set == query.last.id ? query.last : query.fetch(query.file.data_->view, set);
}

CellPlace SetQuery::locate(const Vec3d& eye) {
  const std::uint32_t leaf = impl_->finder.find(eye);
  if (leaf == CellFinder::kOutside) {
    return {};
  }
  const OctreeView& octree = impl_->octree;
  const bool expected = impl_->finder.expects(eye);
  return {leaf, expected ? setOf(octree, octree.leaves[leaf], eye) : VisibleSet::kEverything,
          impl_->finder.cell()};
}

const SetQueryStats& SetQuery::stats() const {
  return impl_->stats;
}

}  // namespace sightline
