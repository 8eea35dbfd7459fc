// Based on: Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11,
// 1997. Differs from the paper in: depth-first search is the default sort; angular extents are periodic;
// parts may be unions of hulls, backdrops, overlays and containers; see docs/algorithms/layers.md.

#include "sightline/layers/layer_sorter.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

#include "src/layers/extents/extent_scan.h"
#include "src/layers/extents/part_extents.h"
#include "src/layers/pairs/pair_rules.h"
#include "src/layers/pairs/part_occlusion.h"
#include "src/layers/pairs/part_store.h"
#include "src/layers/sort/conditioning_sort.h"
#include "src/layers/sort/depth_first_sort.h"
#include "src/layers/sort/layer_sort_algorithm.h"
#include "src/layers/sort/layer_source.h"
#include "src/layers/sort/view_volume.h"
#include "src/scene/usable_view.h"

namespace sightline {

using namespace layers;

namespace {

using Place = PartSettings::Place;

constexpr std::uint32_t kNoPart = 0xffffffffu;

// Whether a part's number is in a list, in which those of removed parts stay for a while.
enum Listed : std::uint8_t {
  kNotListed,
  kIsListed,
  kWasListed,  // a removed part of this number is in the list
};

// The axis by which groups are conditioned, if they are.
std::optional<std::uint32_t> conditioningAxisOf(const LayerSettings& settings) {
  const std::vector<ExtentAxis>& axes = settings.extents;
  for (std::uint32_t i = 0; i < axes.size() && settings.conditioning; ++i) {
    if (axes[i].kind == ExtentAxis::Kind::kSpatial &&
        (settings.conditioning_axis ? i == *settings.conditioning_axis
                                    : axes[i].frame == ExtentAxis::Frame::kCamera)) {
      return i;
    }
  }
  return std::nullopt;
}

LayerSettings checked(LayerSettings settings) {
  if (settings.extents.size() > kMaxExtentAxes) {
    settings.extents.resize(kMaxExtentAxes);
  }
  if (!(settings.contact_tolerance > 0.0) || !std::isfinite(settings.contact_tolerance)) {
    settings.contact_tolerance = 0.0;
  }
  settings.conditioning_axis = conditioningAxisOf(settings);
  settings.conditioning = settings.conditioning_axis.has_value();
  return settings;
}

// Returns the view with its lines of sight as forward, if it is orthographic: right and up say where these
// go, if validate() accepts the view. forward may have any length, and is scaled by a power of two, so that
// no product of two of its coordinates underflows.
View alongSight(const View& view) {
  View result = view, usable = view;
  if (view.orthographic && scene::makeUsable(usable) == nullptr) {
    const Vec3d sight = scene::sightDirection(usable);
    result.forward = sight == usable.forward ? view.forward : sight;
  }
  const double largest = maxComponent(abs(result.forward));
  if (view.orthographic && std::isfinite(largest) && largest > 0.0) {
    const int exponent = std::ilogb(largest);
    for (double* coordinate : {&result.forward.x, &result.forward.y, &result.forward.z}) {
      *coordinate = std::ldexp(*coordinate, -exponent);
    }
  }
  return result;
}

std::unique_ptr<LayerSortAlgorithm> sortOf(const LayerSettings& settings) {
  return settings.sort ? settings.sort() : std::make_unique<DepthFirstSort>();
}

std::unique_ptr<CandidateSearch> searchOf(const LayerSettings& settings) {
  return settings.search ? settings.search() : std::make_unique<ExtentScan>();
}

}  // namespace

struct LayerSorter::Impl {
  explicit Impl(LayerSettings given)
      : settings(checked(std::move(given))),
        extents(settings.extents),
        occlusion(settings.contact_tolerance, &extents),
        source(searchOf(settings), settings.exact, extents, occlusion),
        sort_algorithm(sortOf(settings)) {}

  bool isFinite(std::uint32_t part) const;
  bool isPart(PartId part) const;
  bool isEnabled(std::uint32_t part) const { return enabled[part] != 0 && removed[part] == 0; }
  bool areParts(PartId first, PartId second) const { return isPart(first) && isPart(second); }
  void keepFree(std::uint32_t part);
  std::uint32_t makeRoom(std::size_t hulls);
  void chooseParts(const View& view, bool one_eye);
  void place(const View& view);
  void sort();
  void condition();
  void addArcsWithinGroups();
  void addArcsOf(std::span<const std::uint32_t> parts);
  void collect();
  void sortByDistance(const View& view, std::span<std::uint32_t> parts);
  double distance(const View& view, std::uint32_t part) const;
  LayerStats stats() const;

  LayerSettings settings;
  PartStore store;
  std::vector<PartSettings> part_settings;
  // One element per part; sorted: it has been in an update(); to_sort: it is in the order of this one.
  std::vector<std::uint8_t> enabled, moved, sorted, to_sort, removed;
  // Numbers of removed parts. Those with equally many hulls are a list, linked by next_free, the first
  // removed first.
  struct FreeParts {
    std::uint32_t first = kNoPart, last = kNoPart;
  };
  std::vector<FreeParts> free_parts;
  std::vector<std::uint32_t> next_free;    // one per part
  std::vector<std::uint64_t> generations;  // one per part: how many had been added with it
  std::uint64_t added = 0;                 // parts so far
  PairRules rules;
  PartExtents extents;
  PartOcclusion occlusion;
  LayerSource source;
  std::unique_ptr<LayerSortAlgorithm> sort_algorithm;
  ConditioningSort conditioning;

  std::vector<std::uint32_t> previous;    // parts to be sorted, in the last frame's order
  std::vector<Listed> listed;             // one per part: whether it is in `previous`
  std::vector<std::uint32_t> candidates;  // scratch for addArcsOf()
  std::vector<double> distances;          // one per part
  std::vector<double> group_distances;
  GroupedOrder order;
  std::uint64_t extent_updates = 0, conditioned = 0, outside = 0;

  std::vector<PartId> parts_out;
  std::vector<std::uint32_t> first_out;
  std::vector<LayerArc> arcs_out, collisions_out;
  LayerOrder out;
};

LayerSorter::LayerSorter(LayerSettings settings) : impl_(std::make_unique<Impl>(std::move(settings))) {}
LayerSorter::~LayerSorter() = default;
LayerSorter::LayerSorter(LayerSorter&&) noexcept = default;
LayerSorter& LayerSorter::operator=(LayerSorter&&) noexcept = default;

HullId LayerSorter::addHull(ConvexHull hull) {
  impl_->store.boxes.push_back(boxOf(hull));
  impl_->store.envelopes.emplace_back(hull, impl_->store.boxes.back());
  impl_->store.hulls.push_back(std::move(hull));
  return HullId(impl_->store.hulls.size() - 1);
}

bool LayerSorter::setHull(HullId hull, ConvexHull shape) {
  Impl& own = *impl_;
  assert(hull.value < own.store.hulls.size());
  const auto forEachPartWithIt = [&](auto&& visit) {
    for (std::uint32_t part = 0; part < own.store.parts(); ++part) {
      const std::span<const std::uint32_t> hulls = own.store.hullsOf(part);
      if (own.removed[part] == 0 && std::find(hulls.begin(), hulls.end(), hull.value) != hulls.end()) {
        visit(part);
      }
    }
  };
  bool is_fixed = false;
  forEachPartWithIt([&](std::uint32_t part) {
    is_fixed = is_fixed || (own.part_settings[part].is_static && own.sorted[part] != 0);
  });
  if (is_fixed) {
    return false;
  }
  own.store.boxes[hull.value] = boxOf(shape);
  own.store.envelopes[hull.value] = HullEnvelope(shape, own.store.boxes[hull.value]);
  own.store.hulls[hull.value] = std::move(shape);
  own.extents.replaceHull(hull.value, own.store);
  forEachPartWithIt([&](std::uint32_t part) {
    own.store.finite[part] = own.isFinite(part) ? 1 : 0;
    own.moved[part] = 1;
  });
  return true;
}

void LayerSorter::Impl::keepFree(std::uint32_t part) {
  const std::size_t hulls = store.hullsOf(part).size();
  free_parts.resize(std::max(free_parts.size(), hulls + 1));
  FreeParts& list = free_parts[hulls];
  (list.first == kNoPart ? list.first : next_free[list.last]) = part;
  list.last = part;
  next_free[part] = kNoPart;
}

// The number of a removed part with so many hulls, or of a new one. The caller sets all that belongs to it.
std::uint32_t LayerSorter::Impl::makeRoom(std::size_t hulls) {
  if (hulls < free_parts.size() && free_parts[hulls].first != kNoPart) {
    const std::uint32_t part = free_parts[hulls].first;
    free_parts[hulls].first = next_free[part];
    return part;
  }
  store.part_hulls.resize(store.part_hulls.size() + hulls);
  store.first_hull.push_back(static_cast<std::uint32_t>(store.part_hulls.size()));
  store.placements.emplace_back();
  const std::size_t parts = store.parts();
  store.finite.resize(parts);
  part_settings.resize(parts);
  generations.resize(parts);
  next_free.resize(parts);
  listed.resize(parts);
  for (std::vector<std::uint8_t>* const flags : {&enabled, &moved, &sorted, &removed}) {
    flags->resize(parts);
  }
  return static_cast<std::uint32_t>(parts - 1);
}

PartId LayerSorter::addPart(std::span<const HullId> hulls, const PartSettings& settings) {
  assert(!hulls.empty());
  Impl& own = *impl_;
  const std::uint32_t part = own.makeRoom(hulls.size());
  std::uint32_t instance = own.store.first_hull[part];
  for (const HullId hull : hulls) {
    assert(hull.value < own.store.hulls.size());
    own.store.part_hulls[instance++] = hull.value;
  }
  own.store.placements[part] = {};
  own.store.finite[part] = own.isFinite(part) ? 1 : 0;
  own.part_settings[part] = settings;
  own.generations[part] = ++own.added;
  own.enabled[part] = own.moved[part] = 1;
  own.sorted[part] = own.removed[part] = 0;
  return PartId(part);
}

void LayerSorter::removePart(PartId part) {
  Impl& own = *impl_;
  if (!own.isPart(part)) {
    return;
  }
  own.rules.clear(part.value);
  own.removed[part.value] = 1;
  own.keepFree(part.value);
  // A new part of this number begins at its own place in the order.
  if (own.listed[part.value] == kIsListed) {
    own.listed[part.value] = kWasListed;
  }
}

std::size_t LayerSorter::parts() const {
  return impl_->store.parts();
}

bool LayerSorter::setTransform(PartId part, const Mat4& world_from_part) {
  Impl& own = *impl_;
  if (!own.isPart(part)) {
    return false;
  }
  if (own.part_settings[part.value].is_static && own.sorted[part.value] != 0) {
    return false;
  }
  const Placement placement = placementOf(world_from_part);
  if (placement == own.store.placements[part.value]) {
    return true;
  }
  own.store.placements[part.value] = placement;
  own.store.finite[part.value] = own.isFinite(part.value) ? 1 : 0;
  own.moved[part.value] = 1;
  return true;
}

// A hull without vertices, which buildHull() never makes, has no position.
bool LayerSorter::Impl::isFinite(std::uint32_t part) const {
  const std::span<const std::uint32_t> hulls = store.hullsOf(part);
  return layers::isFinite(store.placements[part]) && !hulls.empty() &&
         std::none_of(hulls.begin(), hulls.end(),
                      [&](std::uint32_t hull) { return store.hulls[hull].vertices.empty(); });
}

bool LayerSorter::Impl::isPart(PartId part) const {
  return part.value < store.parts() && removed[part.value] == 0;
}

void LayerSorter::setEnabled(PartId part, bool enabled) {
  if (impl_->isPart(part)) {
    impl_->enabled[part.value] = enabled ? 1 : 0;
  }
}

void LayerSorter::setRule(PartId first, PartId second, const PairPlane& rule) {
  if (impl_->areParts(first, second)) {
    impl_->rules.set(first.value, second.value, rule);
  }
}

void LayerSorter::setRule(PartId first, PartId second, const SphereCylinderJoint& rule) {
  if (impl_->areParts(first, second)) {
    impl_->rules.set(first.value, second.value, rule);
  }
}

void LayerSorter::setRule(PartId first, PartId second, const PairCallback& rule) {
  if (impl_->areParts(first, second)) {
    impl_->rules.set(first.value, second.value, rule);
  }
}

void LayerSorter::clearRule(PartId first, PartId second) {
  if (impl_->areParts(first, second)) {
    impl_->rules.clear(first.value, second.value);
  }
}

void LayerSorter::setContainer(PartId front, PartId back) {
  if (impl_->areParts(front, back)) {
    impl_->rules.setContainer(front.value, back.value);
  }
}

std::vector<HullId> LayerSorter::hullsOf(PartId part) const {
  std::vector<HullId> hulls;
  if (impl_->isPart(part)) {
    for (const std::uint32_t hull : impl_->store.hullsOf(part.value)) {
      hulls.emplace_back(hull);
    }
  }
  return hulls;
}

PartSettings LayerSorter::settingsOf(PartId part) const {
  return impl_->isPart(part) ? impl_->part_settings[part.value] : PartSettings{};
}

Mat4 LayerSorter::transformOf(PartId part) const {
  return impl_->isPart(part) ? matrixOf(impl_->store.placements[part.value]) : Mat4{};
}

bool LayerSorter::isEnabled(PartId part) const {
  return impl_->isPart(part) && impl_->isEnabled(part.value);
}

bool LayerSorter::isInContainer(PartId part) const {
  return impl_->isPart(part) && impl_->rules.containerOf(part.value).other != PairRules::kNone;
}

const ConvexHull& LayerSorter::hull(HullId hull) const {
  assert(hull.value < impl_->store.hulls.size());
  return impl_->store.hulls[hull.value];
}

const LayerSettings& LayerSorter::settings() const {
  return impl_->settings;
}

const PartStore& LayerSorter::store() const {
  return impl_->store;
}

PairOrder LayerSorter::orderByRule(PartId first, PartId second) {
  return impl_->areParts(first, second) ? impl_->occlusion.orderByRule(first.value, second.value)
                                        : PairOrder{};
}

std::uint64_t LayerSorter::generationOf(PartId part) const {
  return impl_->isPart(part) ? impl_->generations[part.value] : 0;
}

void LayerSorter::copyRules(PartId from, PartId to) {
  if (impl_->areParts(from, to)) {
    impl_->rules.copy(from.value, to.value);
  }
}

void LayerSorter::rebuildSearch() {
  impl_->source.rebuildSearch();
}

void LayerSorter::reset() {
  impl_->previous.clear();
  std::fill(impl_->listed.begin(), impl_->listed.end(), kNotListed);
}

// Distance from the eye to the mean of the hulls' centres; in an orthographic view along the forward
// direction.
double LayerSorter::Impl::distance(const View& view, std::uint32_t part) const {
  const std::span<const std::uint32_t> hulls = store.hullsOf(part);
  Vec3d centre;
  for (const std::uint32_t hull : hulls) {
    centre += store.placements[part].point(store.hulls[hull].centre);
  }
  const Vec3d offset = centre / static_cast<double>(hulls.size()) - view.eye;
  const double value = view.orthographic ? dot(offset, view.forward) : length(offset);
  return std::isfinite(value) ? value : 0.0;
}

void LayerSorter::Impl::sortByDistance(const View& view, std::span<std::uint32_t> parts) {
  distances.resize(store.parts());
  for (const std::uint32_t part : parts) {
    distances[part] = distance(view, part);
  }
  std::sort(parts.begin(), parts.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(distances[a], a) < std::pair(distances[b], b);
  });
}

void LayerSorter::Impl::chooseParts(const View& view, bool one_eye) {
  to_sort.resize(store.parts());
  outside = 0;
  const std::optional<ViewVolume> volume =
      settings.frustum_culling && one_eye ? std::optional<ViewVolume>(view) : std::nullopt;
  for (std::uint32_t part = 0; part < store.parts(); ++part) {
    bool sorts = isEnabled(part) && part_settings[part].place == Place::kSorted;
    if (sorts && volume && volume->isOutside(store, part)) {
      sorts = false;
      ++outside;
    }
    to_sort[part] = sorts ? 1 : 0;
  }
}

// Brings `previous` up to date: the last order without removed parts, then new parts by distance.
void LayerSorter::Impl::place(const View& view) {
  const auto gone = std::remove_if(previous.begin(), previous.end(), [&](std::uint32_t part) {
    listed[part] = listed[part] == kIsListed && to_sort[part] != 0 ? kIsListed : kNotListed;
    return listed[part] == kNotListed;
  });
  previous.erase(gone, previous.end());
  const std::size_t known = previous.size();
  for (std::uint32_t part = 0; part < store.parts(); ++part) {
    if (listed[part] == kNotListed && to_sort[part] != 0) {
      listed[part] = kIsListed;
      previous.push_back(part);
    }
  }
  sortByDistance(view, std::span(previous).subspan(known));
}

void LayerSorter::Impl::sort() {
  source.beginFrame(previous);
  sort_algorithm->sort(previous, source, order);
}

// Conditions the order by each group's mean distance from the eye along the axis.
void LayerSorter::Impl::condition() {
  conditioned = 0;
  if (!settings.conditioning_axis) {
    return;
  }
  const std::size_t axis = *settings.conditioning_axis;
  distances.resize(store.parts());
  group_distances.clear();
  for (std::size_t i = 0; i < order.groups(); ++i) {
    double sum = 0.0;
    for (const std::uint32_t part : order.group(i)) {
      distances[part] = extents.distanceAlong(axis, part);
      sum += distances[part];
    }
    group_distances.push_back(sum / static_cast<double>(order.group(i).size()));
  }
  const ConditioningSort::MayOcclude may_occlude{[](void* user, std::uint32_t front, std::uint32_t back) {
                                                   return static_cast<const LayerSource*>(user)->mayOcclude(
                                                       front, back);
                                                 },
                                                 &source};
  conditioned = conditioning.sort(group_distances, distances, may_occlude, {}, order);
}

// Asks about the arcs within groups. Of few parts, all pairs are compared; a search would take longer.
void LayerSorter::Impl::addArcsWithinGroups() {
  constexpr std::size_t kFewParts = 16;
  for (std::size_t i = 0; i < order.groups(); ++i) {
    const std::span<const std::uint32_t> parts = order.group(i);
    if (parts.size() > kFewParts) {
      addArcsOf(parts);
      continue;
    }
    for (const std::uint32_t front : parts) {
      for (const std::uint32_t back : parts) {
        if (front != back && source.occludes(front, back)) {
          arcs_out.push_back({PartId(front), PartId(back)});
        }
      }
    }
  }
}

// Asks about the arcs between these parts; none is active before and after.
void LayerSorter::Impl::addArcsOf(std::span<const std::uint32_t> parts) {
  for (const std::uint32_t part : parts) {
    source.setActive(part, true);
  }
  for (const std::uint32_t back : parts) {
    candidates.clear();
    source.candidatesOf(back, candidates);
    for (const std::uint32_t front : candidates) {
      if (source.candidateOccludes(front, back)) {
        arcs_out.push_back({PartId(front), PartId(back)});
      }
    }
  }
  for (const std::uint32_t part : parts) {
    source.setActive(part, false);
  }
}

void LayerSorter::Impl::collect() {
  parts_out.clear();
  first_out.clear();
  const auto beginGroup = [&] { first_out.push_back(static_cast<std::uint32_t>(parts_out.size())); };
  const auto addEach = [&](Place place, auto&& before_each) {
    for (std::uint32_t part = 0; part < store.parts(); ++part) {
      if (isEnabled(part) && part_settings[part].place == place) {
        before_each();
        parts_out.emplace_back(part);
      }
    }
  };
  addEach(Place::kOverlay, beginGroup);
  const auto first_sorted = static_cast<std::uint32_t>(first_out.size());
  for (std::size_t i = 0; i < order.groups(); ++i) {
    beginGroup();
    for (const std::uint32_t part : order.group(i)) {
      parts_out.emplace_back(part);
    }
  }
  const auto sorted_end = static_cast<std::uint32_t>(first_out.size());
  std::uint32_t depth_buffered = LayerOrder::kNone;
  addEach(Place::kDepthBuffered, [&] {
    if (depth_buffered == LayerOrder::kNone) {
      depth_buffered = static_cast<std::uint32_t>(first_out.size());
      beginGroup();
    }
  });
  addEach(Place::kBackdrop, beginGroup);
  beginGroup();
  collisions_out.clear();
  for (const Arc& pair : occlusion.collisions()) {
    collisions_out.push_back({PartId(pair.front), PartId(pair.back)});
  }
  out = {parts_out, first_out, arcs_out, collisions_out, first_sorted, sorted_end, depth_buffered, stats()};
}

LayerStats LayerSorter::Impl::stats() const {
  const PairCounts& counts = occlusion.counts();
  return {.extent_updates = extent_updates,
          .occluder_queries = source.queries(),
          .candidates = source.candidates(),
          .pair_queries = occlusion.pairQueries(),
          .chung_steps = counts.chung_steps,
          .gjk_steps = counts.gjk_steps,
          .reinsertions = sort_algorithm->reinsertions(),
          .conditioned = conditioned,
          .known_pairs = occlusion.knownPairs(),
          .outside = outside};
}

const LayerOrder& LayerSorter::update(const View& given, std::span<const Vec3d> more_eyes) {
  Impl& own = *impl_;
  const View view = alongSight(given);
  more_eyes = more_eyes.first(std::min(more_eyes.size(), kMaxMoreEyes));
  own.chooseParts(given, more_eyes.empty() || view.orthographic);
  own.extent_updates = own.extents.update(view, own.store, own.moved, own.to_sort, more_eyes);
  std::fill(own.moved.begin(), own.moved.end(), 0);
  std::fill(own.sorted.begin(), own.sorted.end(), 1);
  own.occlusion.beginFrame(view, own.store, own.extents.table(), own.rules, own.settings.pair_expiry,
                           more_eyes);
  own.place(view);
  own.sort();
  own.condition();
  own.previous.assign(own.order.parts.begin(), own.order.parts.end());
  own.arcs_out.clear();
  if (own.settings.arcs == LayerArcs::kAll) {
    own.addArcsOf(own.order.parts);
  } else if (own.settings.arcs == LayerArcs::kWithinGroups) {
    own.addArcsWithinGroups();
  }
  std::sort(own.arcs_out.begin(), own.arcs_out.end());
  own.collect();
  return own.out;
}

}  // namespace sightline
