#include "sightline/pvs/query/set_query.h"

#include <algorithm>
#include <array>
#include <optional>
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
// Sets of a file have smaller numbers.
constexpr std::uint32_t kFirstLeftId = 0x80000000u;

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

// Appends the nodes that hold all objects of a set but those below the hidden nodes. set: ascending, none
// below another. hidden: ascending. ends: BoxNode::end of each node.
void appendLeft(std::span<const std::uint32_t> set, std::span<const std::uint32_t> hidden,
                std::span<const std::uint32_t> ends, std::vector<std::uint32_t>& left) {
  std::size_t h = 0;
  for (const std::uint32_t top : set) {
    for (std::uint32_t node = top; node < ends[top];) {
      while (h < hidden.size() && ends[hidden[h]] <= node) {
        ++h;
      }
      if (h < hidden.size() && hidden[h] <= node) {
        node = ends[node];  // it is hidden, or below what is
      } else if (h < hidden.size() && hidden[h] < ends[node]) {
        ++node;  // something below it is hidden
      } else {
        left.push_back(node);
        node = ends[node];
      }
    }
  }
}

// Sorts the nodes and leaves out those that are there twice.
void sortOnce(std::vector<std::uint32_t>& nodes) {
  std::sort(nodes.begin(), nodes.end());
  nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
}

}  // namespace

struct SetQuery::Impl {
  // of_file: the view of the opened file.
  Impl(SightFile opened, const pvs::SightView& of_file, const SetQuerySettings& settings)
      : file(std::move(opened)),
        view(of_file),
        octree(file.octree()),
        near_distance(file.record().near_distance),
        finder(octree),
        cache(file.setCount(), settings.cache_bytes),
        is_closed(file.doors().groupCount(), 0) {
    closed.reserve(file.doors().doors.size());
  }

  // The nodes of a set, decoded or looked up; nothing if its chunk is corrupt. Valid until the next call.
  std::optional<std::span<const std::uint32_t>> nodesOf(std::uint32_t set);
  // Decodes or looks up a set other than the last one.
  VisibleSet fetch(std::uint32_t set);
  // The set without what closed doors hide of it.
  VisibleSet withoutHidden(std::uint32_t set);

  SightFile file;
  const pvs::SightView& view;
  OctreeView octree;
  double near_distance;
  CellFinder finder;
  std::uint32_t last_leaf = CellFinder::kOutside;
  VisibleSet last = everything();
  SetCache cache;
  ChunkDecoder decoder;
  std::vector<std::uint32_t> decoded;  // scratch
  // Doors.
  std::vector<ObjectId> closed;         // ascending
  std::vector<std::uint8_t> is_closed;  // by group
  bool any_closed = false;
  std::optional<std::uint32_t> left_of;  // the set that `left` was made from, for the doors of now
  VisibleSet left;                       // of left_nodes, or of the cache
  std::vector<std::uint32_t> left_nodes, hidden_nodes;
  std::uint32_t next_id = kFirstLeftId;  // of a set that is no set of the file
  SetQueryStats stats;
};

std::optional<std::span<const std::uint32_t>> SetQuery::Impl::nodesOf(std::uint32_t set) {
  switch (cache.state(set)) {
    case SetCache::State::kCached:
      return cache.use(set);
    case SetCache::State::kMissing: {
      decoded.clear();
      const bool sound = decoder.readSet(view, set, decoded);
      stats.chunk_bytes = decoder.bytesRead();
      if (sound) {
        ++stats.decoded;
        const std::span<const std::uint32_t> nodes = cache.insert(set, decoded);
        stats.cached_bytes = cache.bytes();
        return nodes;
      }
      cache.markBroken(set);
      break;
    }
    case SetCache::State::kBroken:
      break;
  }
  return std::nullopt;
}

VisibleSet SetQuery::Impl::fetch(std::uint32_t set) {
  if (const auto nodes = nodesOf(set)) {
    return last = {set, *nodes};
  }
  ++stats.broken;
  return everything();
}

VisibleSet SetQuery::Impl::withoutHidden(std::uint32_t set) {
  if (left_of == set) {
    return left;
  }
  left_of.reset();
  last = everything();  // its nodes may leave the cache below; fetch() sets it again
  hidden_nodes.clear();
  for (const DoorSet& door : view.doors.hiddenOf(set)) {
    if (is_closed[door.group] == 0) {
      continue;
    }
    // What cannot be decoded counts as seen.
    if (const auto nodes = nodesOf(door.hidden)) {
      hidden_nodes.insert(hidden_nodes.end(), nodes->begin(), nodes->end());
      // Many groups may hide the same nodes.
      if (hidden_nodes.size() > 2 * view.boxes.nodes.size()) {
        sortOnce(hidden_nodes);
      }
    }
  }
  // The set comes last, so that it stays in the cache as the last one.
  const VisibleSet open = fetch(set);
  if (open.id == VisibleSet::kEverything) {
    return open;
  }
  left_of = set;
  if (hidden_nodes.empty() || next_id == VisibleSet::kEverything) {
    return left = open;  // or there are no more numbers for sets
  }
  sortOnce(hidden_nodes);
  left_nodes.clear();
  appendLeft(open.nodes, hidden_nodes, view.ends, left_nodes);
  return left = {next_id++, left_nodes};
}

SetQuery::SetQuery(SightFile file, const SetQuerySettings& settings) {
  const pvs::SightView& view = file.data_->view;
  impl_ = std::make_unique<Impl>(std::move(file), view, settings);
}
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
  if (query.any_closed) {
    return query.withoutHidden(set);
  }
  return set == query.last.id ? query.last : query.fetch(set);
}

void SetQuery::setClosedDoors(std::span<const ObjectId> doors) {
  Impl& query = *impl_;
  query.closed.assign(doors.begin(), doors.end());
  std::sort(query.closed.begin(), query.closed.end());
  const DoorsView all = query.file.doors();
  query.any_closed = false;
  for (std::uint32_t group = 0; group < all.groupCount(); ++group) {
    const std::uint8_t now = isClosed(all, group, query.closed) ? 1 : 0;
    if (std::exchange(query.is_closed[group], now) != now) {
      query.left_of.reset();
    }
    query.any_closed |= now != 0;
  }
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
