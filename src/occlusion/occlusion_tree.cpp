// Based on: Bittner, Havran, Slavik. Hierarchical Visibility Culling with Occlusion Trees. CGI 1998.
// Differs from the paper in: the frustum's side planes are the tree's first nodes, so that only what is in
// view counts; outlines are drawn in by a margin where no occluder adjoins them and are exactly shared
// where one does (see docs/conservative.md); and how boxes are classified (see tree_classify.cpp).

#include "sightline/occlusion/occlusion_tree.h"

#include <algorithm>

#include "src/occlusion/tree/tree_build.h"
#include "src/occlusion/tree/tree_classify.h"
#include "src/scene/usable_view.h"

namespace sightline {

using namespace occlusion;

namespace {

std::size_t sizeOf(std::span<const ChosenOccluders> sets) {
  std::size_t size = 0;
  for (const ChosenOccluders& part : sets) {
    size += part.chosen.size();
  }
  return size;
}

}  // namespace

struct OcclusionTree::Impl {
  OcclusionTreeSettings settings;
  TreeBuilder builder;
  TreeData tree;
  SplittingQuery splitting;
  PlaneQuery planes;
  OcclusionTreeStats stats;
  bool usable_view = false;            // build() was called, and validate() accepts its view
  std::vector<ChosenOccluders> parts;  // the chosen occluders that the tree is built from
  std::vector<OccluderId> used;        // of the first set

  // Takes as many of the chosen occluders as may find room, for each needs at least three nodes.
  void takeFirst(std::span<const ChosenOccluders> sets) {
    parts.clear();
    std::size_t room = settings.max_nodes / 3;
    for (const ChosenOccluders& part : sets) {
      parts.push_back({part.set, part.chosen.first(std::min(part.chosen.size(), room))});
      room -= parts.back().chosen.size();
    }
  }
  std::size_t partSize() const { return sizeOf(parts); }

  bool modified() const {
    return settings.variant == OcclusionTreeVariant::kFME || settings.variant == OcclusionTreeVariant::kFMC;
  }
  bool exact() const {
    return settings.variant == OcclusionTreeVariant::kFSE || settings.variant == OcclusionTreeVariant::kFME;
  }
};

OcclusionTree::OcclusionTree(const OcclusionTreeSettings& settings) : impl_(std::make_unique<Impl>()) {
  impl_->settings = settings;
}
OcclusionTree::~OcclusionTree() = default;
OcclusionTree::OcclusionTree(OcclusionTree&&) noexcept = default;
OcclusionTree& OcclusionTree::operator=(OcclusionTree&&) noexcept = default;

void OcclusionTree::build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen) {
  const ChosenOccluders only{&set, chosen};
  build(view, {&only, 1});
}

void OcclusionTree::build(const View& given, std::span<const ChosenOccluders> sets) {
  Impl& impl = *impl_;
  View view = given;
  impl.usable_view = scene::makeUsable(view) == nullptr;
  const TreeLimits limits{impl.modified(), impl.settings.clip_to_frustum, impl.settings.max_nodes};
  impl.takeFirst(sets);
  while (!impl.builder.build(view, impl.parts, limits, impl.tree) && impl.partSize() > 0) {
    for (ChosenOccluders& part : impl.parts) {
      part.chosen = part.chosen.first(part.chosen.size() / 2);
    }
  }
  const VolumeBuilder& volumes = impl.tree.volumes;
  impl.used.clear();
  for (std::size_t v = 0; !sets.empty() && v < volumes.volumes_of_set[0]; ++v) {
    impl.used.push_back(volumes.volumes[v].occluder);
  }
  OcclusionTreeStats& stats = impl.stats;
  stats.occluders = static_cast<std::uint32_t>(volumes.volumes.size());
  stats.dropped = static_cast<std::uint32_t>(sizeOf(sets) - impl.partSize());
  stats.unusable = static_cast<std::uint32_t>(impl.partSize()) - stats.occluders;
  stats.nodes = static_cast<std::uint32_t>(impl.tree.nodes.size());
  stats.leaves = static_cast<std::uint32_t>(impl.tree.leaves.size());
  stats.depth = impl.tree.depth;
  impl.splitting.counts = impl.planes.counts = {};
  stats.plane_tests = stats.cuts = 0;
}

Visibility OcclusionTree::classify(const Box& box, std::uint8_t frustum_planes) {
  Impl& impl = *impl_;
  if (!box.wellFormed() || !impl.usable_view) {
    return Visibility::kVisible;
  }
  const Eye& eye = impl.tree.volumes.eye;
  const EyeBox relative = EyeBox::of(box, eye.position);
  if (!eye.orthographic && relative.min.x <= 0.0 && relative.min.y <= 0.0 && relative.min.z <= 0.0 &&
      relative.max.x >= 0.0 && relative.max.y >= 0.0 && relative.max.z >= 0.0) {
    return Visibility::kPartial;  // the eye is inside: the box is not hidden, but parts of it may be
  }
  const BoxQuestion question{relative, impl.exact(), frustum_planes};
  const State state = impl.modified() ? impl.planes.classify(impl.tree, question)
                                      : impl.splitting.classify(impl.tree, question);
  const QueryCounts& counts = impl.modified() ? impl.planes.counts : impl.splitting.counts;
  impl.stats.plane_tests = counts.plane_tests;
  impl.stats.cuts = counts.cuts;
  switch (state) {
    case State::kVisible:
      return Visibility::kVisible;
    case State::kPartial:
      return Visibility::kPartial;
    default:
      return Visibility::kHidden;
  }
}

const OcclusionTreeStats& OcclusionTree::stats() const {
  return impl_->stats;
}
std::span<const OccluderId> OcclusionTree::occluders() const {
  return impl_->used;
}

}  // namespace sightline
