#include "tools/sightline/cull/hidden_pairs.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <tuple>

#include "oracle/split_mix.h"
#include "tools/sightline/input/doors.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kCandidates = 32;  // random objects, of which the best for a purpose is chosen
constexpr std::uint32_t kDraws = 8;        // parts of cells that are drawn for each pair wanted, at most

double distanceBetween(const Vec3d& min_a, const Vec3d& max_a, const Vec3d& min_b, const Vec3d& max_b) {
  const Vec3d zero{};
  return length(max(zero, max(min_a - max_b, min_b - max_a)));
}

class Sampler {
 public:
  Sampler(const SightFile& baked, std::span<const ObjectId> closed, const Scene& scene, std::uint64_t seed)
      : baked_(baked), closed_(closed), octree_(baked.octree()), scene_(scene), random_{seed} {
    pairs_.cells.resize(octree_.leaves.size());
    forEachLeaf(octree_, [&](std::uint32_t leaf, const OctreeCell& cell) { pairs_.cells[leaf] = cell; });
  }

  Result<HiddenPairs> draw(std::uint32_t count) {
    const std::uint64_t draws = std::uint64_t{count} * kDraws;
    for (std::uint64_t i = 0; i < draws && pairs_.pairs.size() < count && !pairs_.cells.empty(); ++i) {
      const std::uint32_t leaf = random_.below(static_cast<std::uint32_t>(pairs_.cells.size()));
      const bool divided = octree_.leaves[leaf].plane != OctreeLeaf::kNoPlane;
      const auto part = divided ? static_cast<CellPart>(1 + random_.below(3)) : CellPart::kWhole;
      if (const Status ok = readHidden(leaf, part); !ok) {
        return ok.error();
      }
      if (hidden_.empty() || EyePlaces(region_).empty()) {
        continue;
      }
      for (std::uint32_t purpose = 0; purpose < 4 && pairs_.pairs.size() < count; ++purpose) {
        const ObjectId object = choose(purpose);
        if (known_.emplace(leaf, part, object).second) {
          pairs_.pairs.push_back({leaf, part, object});
        }
      }
    }
    return std::move(pairs_);
  }

 private:
  Status readHidden(std::uint32_t leaf, CellPart part) {
    if (const Status ok = readVisible(baked_, leaf, part, closed_, is_visible_at_); !ok) {
      return ok;
    }
    is_visible_.assign(scene_.objects.size(), 0);
    for (std::size_t i = 0; i < is_visible_at_.size(); ++i) {
      is_visible_[baked_.boxes().objects[i].value] = is_visible_at_[i];
    }
    hidden_.clear(), visible_.clear();
    for (std::uint32_t o = 0; o < scene_.objects.size(); ++o) {
      (is_visible_[o] != 0 ? visible_ : hidden_).push_back(ObjectId(o));
    }
    region_ = regionOf(octree_, pairs_.cells[leaf], leaf, part);
    return Success{};
  }

  ObjectId any(const std::vector<ObjectId>& objects) {
    return objects[random_.below(static_cast<std::uint32_t>(objects.size()))];
  }

  ObjectId choose(std::uint32_t purpose) {
    if (purpose == 0) {
      return any(hidden_);
    }
    const Box beside = visible_.empty() ? Box{region_.min, region_.max} : boxOf(any(visible_));
    ObjectId best;
    double best_cost = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < kCandidates; ++i) {
      const ObjectId candidate = any(hidden_);
      const Box box = boxOf(candidate);
      const double from_cell = distanceBetween(region_.min, region_.max, box.min, box.max);
      const double size = length(box.max - box.min);
      const double cost = purpose == 1   ? from_cell / size
                          : purpose == 2 ? from_cell
                                         : distanceBetween(beside.min, beside.max, box.min, box.max);
      if (!best.valid() || cost < best_cost) {
        best = candidate;
        best_cost = cost;
      }
    }
    return best;
  }

  struct Box {
    Vec3d min, max;
  };
  Box boxOf(ObjectId object) const {
    const sightline::Box& bounds = scene_.objects[object.value].bounds;
    return {Vec3d(bounds.min), Vec3d(bounds.max)};
  }

  const SightFile& baked_;
  std::span<const ObjectId> closed_;
  const OctreeView octree_;
  const Scene& scene_;
  SplitMix random_;
  EyeRegion region_;
  std::vector<std::uint8_t> is_visible_, is_visible_at_;  // by object, and by place in the box tree
  std::vector<ObjectId> visible_, hidden_;
  std::set<std::tuple<std::uint32_t, CellPart, ObjectId>> known_;
  HiddenPairs pairs_;
};

}  // namespace

EyeRegion regionOf(const OctreeView& octree, const OctreeCell& cell, std::uint32_t leaf, CellPart part) {
  EyeRegion region{cellMin(octree.min, octree.max, cell), cellMax(octree.min, octree.max, cell), {}};
  OctreeCell own = cell;
  while (own.level > octree.depths[leaf]) {
    own = {own.level - 1, {own.at[0] / 2, own.at[1] / 2, own.at[2] / 2}};
  }
  const ViewerBounds viewers = octree.viewersOf(leaf);
  region.min = max(region.min, viewersMin(octree.min, octree.max, own, viewers));
  region.max = min(region.max, viewersMax(octree.min, octree.max, own, viewers));
  addSide(octree, leaf, part, region);
  return region;
}

void addSide(const OctreeView& octree, std::uint32_t leaf, CellPart part, EyeRegion& region) {
  if (part == CellPart::kWhole) {
    return;
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const CellPlane& plane = octree.planes[octree.leaves[leaf].plane];
  switch (part) {
    case CellPart::kFront:
      region.sides = {{plane.normal, plane.front}};
      break;
    case CellPart::kBack:
      region.sides = {{-plane.normal, -plane.back}};
      break;
    default:  // an eye on one of the two planes has the set of that side
      region.sides = {{plane.normal, std::nextafter(plane.back, kInfinity)},
                      {-plane.normal, -std::nextafter(plane.front, -kInfinity)}};
  }
}

Status readVisible(const SightFile& baked, std::uint32_t leaf, CellPart part,
                   std::span<const ObjectId> closed, std::vector<std::uint8_t>& is_visible) {
  const OctreeLeaf& record = baked.octree().leaves[leaf];
  const std::uint32_t set = part == CellPart::kFront  ? record.front_set
                            : part == CellPart::kBack ? record.back_set
                                                      : record.set;
  return readSeen(baked, set, closed, is_visible);
}

Result<HiddenPairs> sampleHiddenPairs(const SightFile& baked, std::span<const ObjectId> closed,
                                      const Scene& scene, std::uint32_t count, std::uint64_t seed) {
  return Sampler(baked, closed, scene, seed).draw(count);
}

}  // namespace sightline::tool
