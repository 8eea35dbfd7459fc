// Each cluster is drawn in several groups: the boundary between two clusters is none within a group, but the
// depth of a pixel is that of the group's farthest part in it. The nearest answer counts.

#include "src/occlusion/surfaces/surface_raster.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/occlusion/surfaces/surface_aims.h"

namespace sightline::occlusion {
namespace {

constexpr std::uint32_t kLongestRest = 63;  // views, before up to half as many are added
// What surfaces hide of each other changes as the eye moves past them. So a rest of more than kSteadyRest
// views ends where the eye has travelled this fraction of the surface's distance for each view of the rest.
// In an orthographic view it changes as the view turns, and no rest is longer.
constexpr std::uint32_t kSteadyRest = 7;
constexpr double kTravelOfView = 1.0 / 400.0;

// Sums of a sound set stay far below. A group with one that reaches this is drawn as runs, of which only the
// signs count, or not at all.
constexpr std::int32_t kMostSum = (1 << 30) + 1;

// Groups are drawn when this work waits, plus half of the work already done in the view. What is behind them
// is noticed from then on.
constexpr std::uint64_t kFirstRound = 128;

// At most so many tiles are looked at for a group with this rectangle.
std::uint32_t tilesIn(const PixelRectangle& r) {
  const auto tiles = [](std::int32_t first, std::int32_t end, std::int32_t size) {
    return static_cast<std::uint32_t>((end - 1) / size - first / size + 1);
  };
  return r.empty() ? 0 : tiles(r.x0, r.x1, kTileWidth) * tiles(r.y0, r.y1, kTileHeight);
}

// What a group costs, as SurfaceLimits::budget counts it.
std::uint64_t workOf(std::uint32_t edges, std::uint32_t tiles) {
  return std::uint64_t{edges} + tiles + 8;
}

// The boundary of a patch has at least so many edges, or the patch covers nothing.
constexpr std::uint32_t kFewestEdges = 3;

constexpr PixelRectangle kNoPixels{1 << 30, 1 << 30, 0, 0};

PixelRectangle join(const PixelRectangle& a, const PixelRectangle& b) {
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

}  // namespace

void SurfaceRaster::reserve(const SurfaceSet& set, SurfaceMemory& memory) {
  sums_.require(set.chains.size());
  memory.reserve(set);
}

void SurfaceRaster::draw(const SurfaceSet& set, const scene::PixelView& view,
                         std::span<const ObjectId> candidates, const SurfaceDrawing& drawing,
                         SurfaceMemory& memory, WindingMap& map, const ParallelFor& parallel_for) {
  drawing_ = drawing;
  parallel_for_ = &parallel_for;
  map_ = &map;
  winding_ = view.mirrored ? -1 : 1;
  memory_ = &memory;
  start(set);
  memory.beginView(set, view.eye, drawing.step);
  view_.begin(set, view, drawing.limits.min_pixels, map.target());
  chains_.begin(set, view, view_.clipDepth(), map.buffer());
  if (drawing_.useful_only) {
    listUseful();
  } else {
    view_.listParts(candidates);
  }
  for (const PartImage& part : view_.parts()) {
    if (!withinBudget()) {
      break;
    }
    if (const std::uint32_t pixels = map.wanted(part.rectangle, part.nearest); pixels > 0) {
      addPart(part, pixels);
      if (waiting_work_ > kFirstRound + work_ / 2) {
        drawGroups();
      }
    }
  }
  drawGroups();
  stats_.work = static_cast<std::uint32_t>(work_);
}

void SurfaceRaster::start(const SurfaceSet& set) {
  stats_ = {};
  work_ = waiting_work_ = 0;
  rested_ = 0;
  set_ = &set;
  sums_.require(set.chains.size());
}

// Whether something is left out in this view.
bool SurfaceRaster::rests(const SurfaceMemory::Rest& rest) const {
  const std::uint32_t age = memory_->view_number - rest.since;
  return !drawing_.draw_resting && rest.since >= memory_->first_view && age > 0 && age <= rest.length &&
         (age <= kSteadyRest || (!view_.view().orthographic && memory_->travel <= rest.travel));
}

// Whether a group is not drawn now, whatever it covers.
bool SurfaceRaster::leavesOut(const SurfaceMemory::Rest& rest) const {
  return rest.drawn_in == memory_->view_number ||
         (drawing_.useful_only && rest.paid_in + 1 != memory_->view_number) || rests(rest);
}

// Lists the parts of which something paid in the view before, the most useful ones first.
void SurfaceRaster::listUseful() {
  std::sort(memory_->useful_before.begin(), memory_->useful_before.end(),
            [](const SurfaceMemory::UsefulPart& a, const SurfaceMemory::UsefulPart& b) {
              return a.gain != b.gain ? a.gain > b.gain : a.part < b.part;
            });
  useful_parts_.clear();
  for (const SurfaceMemory::UsefulPart& useful : memory_->useful_before) {
    useful_parts_.push_back(useful.part);
  }
  view_.listParts(useful_parts_);
}

// Whether a surface is worth drawing at all. pixels: that may become nearer.
bool SurfaceRaster::pays(std::uint32_t pixels, std::uint32_t edges) const {
  return pixels >= drawing_.limits.pixels_per_edge * edges;
}

// What is known of a patch is found again only when the eye has moved. In an orthographic view it depends on
// the direction instead.
const SurfaceMemory::Facing& SurfaceRaster::facingOf(std::uint32_t patch) {
  SurfaceMemory::Facing& facing = memory_->facings[patch];
  if (view_.view().orthographic || facing.since < memory_->first_of_set ||
      !(memory_->travel < facing.travel)) {
    const PatchSide found = view_.sideOf(patch);
    constexpr double kRoundDown = 1.0 - std::numeric_limits<double>::epsilon();
    facing = {memory_->view_number, found.side < 0 && !set_->patches[patch].double_sided,
              static_cast<std::int8_t>(found.side), (memory_->travel + found.travel) * kRoundDown};
  }
  return facing;
}

// Adds the large patches of a part, each alone, and all of them together.
void SurfaceRaster::addPart(const PartImage& image, std::uint32_t pixels) {
  const SurfacePart& part = set_->parts[image.part];
  part_ = image.part;
  part_distance_ = length(center(set_->part_bounds[image.part]) - memory_->eye);
  const std::span<const std::uint32_t> adjoining = set_->adjoiningOf(image.part);
  bool together = part.patch_count + adjoining.size() > 1 && pays(pixels, part.edge_count) &&
                  !leavesOut(memory_->part_rests[image.part]);
  if (!together && !pays(pixels, kFewestEdges)) {
    return;  // none of its patches pays either
  }
  listPatches(part, together);
  // What adjoins the part is drawn for the seams alone, and is not counted.
  const std::uint64_t patch_pixels = countWanted();
  together = together &&
             pays(static_cast<std::uint32_t>(std::min<std::uint64_t>(pixels, patch_pixels)), part.edge_count);
  const std::size_t first_cluster = view_.clusters().size();
  PixelRectangle rectangle = kNoPixels;
  std::uint32_t shown = 0;
  patches_.clear();
  for (std::size_t i = 0; i < shown_.size(); ++i) {
    PatchImage& patch = shown_[i];
    const SurfacePatch& source = set_->patches[patch.patch];
    const bool alone = !leavesOut(memory_->patch_rests[patch.patch]) &&
                       patch.rectangle.area() >= drawing_.limits.min_patch_pixels &&
                       pays(wanted_[i], source.edge_count);
    if (wanted_[i] == 0 || !(together || alone)) {
      continue;
    }
    if (patch.sign != 0) {
      patches_.push_back(patch);
    } else {
      view_.addClusters(source, patch);
      if (patch.count == 0) {
        continue;
      }
    }
    ++shown;
    rectangle = join(rectangle, patch.rectangle);
    if (alone && withinBudget()) {
      addPatch(patch, memory_->patch_rests[patch.patch]);
    }
  }
  if (together && shown > 0) {
    const std::size_t own = view_.clusters().size();
    view_.addClusters(adjoining);
    for (const ClusterImage& cluster : view_.clusters().subspan(own)) {
      rectangle = join(rectangle, cluster.rectangle);
      ++shown;
    }
  }
  if (together && shown > 1 && withinBudget()) {
    addTogether(view_.clusters().subspan(first_cluster), patches_, rectangle,
                memory_->part_rests[image.part]);
  }
}

// Sets wanted_ to the pixels in which each of shown_ may gain something, and returns their sum.
std::uint64_t SurfaceRaster::countWanted() {
  wanted_.clear();
  std::uint64_t sum = 0;
  for (PatchImage& patch : shown_) {
    std::uint32_t pixels = map_->wanted(patch.rectangle, patch.nearest);
    if (pixels > 0 && patch.sign != 0) {
      view_.setDepth(patch);
      pixels = std::min(pixels, map_->wanted(patch.rectangle, patch.depth));
    }
    wanted_.push_back(pixels);
    sum += pixels;
  }
  return sum;
}

// Sets shown_ to the patches of a part that may be drawn. together: all of them, however small, as one group.
void SurfaceRaster::listPatches(const SurfacePart& part, bool together) {
  sides_.clear();
  for (std::uint32_t patch = part.first_patch; patch < part.first_patch + part.patch_count; ++patch) {
    if (together || !leavesOut(memory_->patch_rests[patch])) {
      const SurfaceMemory::Facing& facing = facingOf(patch);
      if (!facing.away) {
        sides_.push_back({patch, facing.side});
      }
    }
  }
  view_.imagesOf(sides_, together ? 0.0 : drawing_.limits.min_patch_pixels, shown_);
}

// Adds a patch alone, as one group.
void SurfaceRaster::addPatch(const PatchImage& patch, SurfaceMemory::Rest& rest) {
  const std::span<const ClusterImage> clusters = view_.clusters().subspan(patch.first, patch.count);
  if (!patch.flat) {
    addTogether(clusters, {}, patch.rectangle, rest);
    return;
  }
  beginGroup();
  if (patch.sign == 0) {
    addBoundary(clusters, {});
  } else {
    for (const PatchChain& chain : set_->chainsOf(set_->patches[patch.patch])) {
      addEdges(chain.chain, chain.value * patch.sign);
    }
  }
  depths_.push_back({patch.rectangle, patch.depth});
  endGroup(patch.rectangle, true, rest);
}

void SurfaceRaster::addTogether(std::span<const ClusterImage> clusters, std::span<const PatchImage> patches,
                                const PixelRectangle& rectangle, SurfaceMemory::Rest& rest) {
  beginGroup();
  addBoundary(clusters, patches);
  for (const PatchImage& image : patches) {
    depths_.push_back({image.rectangle, image.depth});
  }
  for (const ClusterImage& image : clusters) {
    view_.addDepths(image, depths_);
  }
  endGroup(rectangle, false, rest);
}

void SurfaceRaster::beginGroup() {
  if (++group_ == 0) {
    sums_.clear();
    group_ = 1;
  }
  Group group;
  group.first_chain = static_cast<std::uint32_t>(boundary_.size());
  group.first_depth = static_cast<std::uint32_t>(depths_.size());
  groups_.push_back(group);
}

void SurfaceRaster::endGroup(const PixelRectangle& rectangle, bool flat, SurfaceMemory::Rest& rest) {
  Group& group = groups_.back();
  group.edges = chains_.endGroup(boundary_);
  group.chain_count = static_cast<std::uint32_t>(boundary_.size()) - group.first_chain;
  group.depth_count = static_cast<std::uint32_t>(depths_.size()) - group.first_depth;
  group.rectangle = rectangle;
  group.flat = flat;
  group.distance = part_distance_;
  group.part = part_;
  group.rest = &rest;
  waiting_work_ += workOf(group.edges, tilesIn(rectangle));
}

// What groups cost is only known when they have been drawn.
bool SurfaceRaster::withinBudget() {
  if (work_ + waiting_work_ >= drawing_.limits.budget) {
    drawGroups();
  }
  return work_ < drawing_.limits.budget;
}

// Draws the groups that wait, and finds out of what use they are.
void SurfaceRaster::drawGroups() {
  if (groups_.empty()) {
    return;
  }
  drawn_.clear();
  for (const Group& group : groups_) {
    drawn_.push_back({group.rectangle, std::span(boundary_).subspan(group.first_chain, group.chain_count),
                      std::span(depths_).subspan(group.first_depth, group.depth_count), group.flat});
  }
  gains_.resize(std::max(gains_.size(), groups_.size()));
  map_->draw(drawn_, chains_.edges(), gains_, *parallel_for_);
  for (std::size_t i = 0; i < groups_.size(); ++i) {
    const std::uint64_t work = workOf(groups_[i].edges, gains_[i].tiles);
    account(groups_[i], gains_[i], work);
    work_ += work;
    stats_.edges += groups_[i].edges;
  }
  stats_.groups += static_cast<std::uint32_t>(groups_.size());
  waiting_work_ = 0;
  groups_.clear();
  boundary_.clear();
  depths_.clear();
  chains_.forget();
}

// Adds the boundary of clusters and whole patches: chains with what is left over of all that end at them.
void SurfaceRaster::addBoundary(std::span<const ClusterImage> clusters, std::span<const PatchImage> patches) {
  summed_.clear();
  for (const ClusterImage& image : clusters) {
    for (const std::uint32_t chain : set_->chainsOf(set_->clusters[image.cluster])) {
      const std::span<const ChainUse> uses = set_->usesOf(set_->chains[chain]);
      const auto use = std::ranges::lower_bound(uses, image.cluster, {}, &ChainUse::cluster);
      if (use != uses.end() && use->cluster == image.cluster) {
        addToSum(chain, use->value * image.sign);
      }
    }
    if (image.cut) {
      addCuts(image);
    }
  }
  for (const PatchImage& image : patches) {
    for (const PatchChain& chain : set_->chainsOf(set_->patches[image.patch])) {
      addToSum(chain.chain, chain.value * image.sign);
    }
  }
  for (const std::uint32_t chain : summed_) {
    if (sums_[chain].value != 0) {
      addEdges(chain, sums_[chain].value);
    }
  }
}

void SurfaceRaster::addToSum(std::uint32_t chain, std::int32_t value) {
  ChainSum& sum = sums_[chain];
  if (sum.group != group_) {
    sum = {group_, 0};
    summed_.push_back(chain);
  }
  sum.value = std::clamp(sum.value + value, -kMostSum, kMostSum);
}

// Adds the lines along which the near plane cuts the cluster's triangles.
void SurfaceRaster::addCuts(const ClusterImage& image) {
  const std::span<const std::uint32_t> corners = set_->trianglesOf(set_->clusters[image.cluster]);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    chains_.addCut(corners.subspan(i).first<3>(), image.sign * winding_);
  }
}

// What did not pay in a view for which it was drawn because it had paid before is not drawn first in the next
// one; what did not pay otherwise rests.
void SurfaceRaster::account(const Group& group, const WindingGain& gain, std::uint64_t work) {
  stats_.gain += gain.nearer;
  group.rest->drawn_in = memory_->view_number;
  if (!(gain.nearer < leastGain(!drawing_.targets.empty()) * static_cast<double>(work))) {
    *group.rest = {.drawn_in = memory_->view_number, .paid_in = memory_->view_number};
    std::uint32_t& place = memory_->place_in_useful[group.part];
    if (place == 0) {
      memory_->useful.push_back({group.part, 0});
      place = static_cast<std::uint32_t>(memory_->useful.size());
    }
    memory_->useful[place - 1].gain += gain.nearer;
  } else if (!drawing_.useful_only) {
    rest(group);
  }
}

// A group that rests again does so twice as long as the last time. Groups that begin to rest in the same view
// come back in different ones, or drawing them all would make one view slow.
void SurfaceRaster::rest(const Group& group) {
  SurfaceMemory::Rest& rest = *group.rest;
  const std::uint32_t first = memory_->view_number == memory_->first_view ? 1 : 0;
  const std::uint32_t last = rest.since >= memory_->first_view ? rest.length : first;
  const std::uint32_t length = std::min(2 * last + 1, kLongestRest);
  rest.since = memory_->view_number;
  rest.length = length + rested_++ % (length / 2 + 1);
  rest.travel = memory_->travel + kTravelOfView * (length + 1) * group.distance;
}

}  // namespace sightline::occlusion
