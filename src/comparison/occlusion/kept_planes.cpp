// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, sections 3
// and 4. Differs from the paper in: a relation knows how far the eye may move before it changes (relation.h),
// and what joint occlusion is (occlusion/list_classifier.h).

#include "sightline/comparison/kept_planes.h"

#include <cmath>
#include <vector>

#include "src/comparison/occlusion/relation.h"
#include "src/comparison/occlusion/relation_store.h"
#include "src/occlusion/planes/active_occluders.h"
#include "src/occlusion/planes/list_classifier.h"

namespace sightline {

using namespace comparison;
using namespace occlusion;

struct KeptPlanes::Impl {
  static constexpr Item kNoItem = 0xffffffffu;

  explicit Impl(const KeptPlanesSettings& s)
      : settings(s), classifier(active, s.joint_occlusion), store(s.relation_bytes) {}

  void build(const View& view, std::span<const ChosenOccluders> sets);
  void extendPath(const Eye& from, const Eye& to);
  Visibility classify(const Box& box, Item item, OccluderList among, OccluderList& touching);
  EyePlaneTest test(const Box& box, Item item, std::uint32_t number);
  const Relation* reuse(Item item, const ActiveOccluder& occluder);
  Relation relate(Item item, const Box& box, const ActiveOccluder& occluder, PlaneSide side);

  KeptPlanesSettings settings;
  RelationStats stats;
  ActiveOccluders active;
  ListClassifier classifier;
  RelationStore store;
  const OccluderSet* first_set = nullptr;  // of the last build()
  bool has_eye = false;
  // Length of the eye's path so far, metres; orthographic: of the path of its direction on the unit sphere.
  double path = 0.0;

  // Scratch for one classify() call: relations that are to be kept, and their planes one after another.
  std::vector<Relation> fresh;
  std::vector<PlaneQuad> fresh_planes, plane_scratch;
};

// Rounding may only lengthen the path.
void KeptPlanes::Impl::extendPath(const Eye& from, const Eye& to) {
  const double step = to.orthographic ? length(to.sight - from.sight) : length(to.position - from.position);
  if (!has_eye || to.orthographic != from.orthographic || !std::isfinite(step)) {
    store.clear();
    path = 0.0;
  } else if (step > 0.0) {
    path = path * (1.0 + 0x1p-52) + step * (1.0 + 0x1p-40);
  }
  has_eye = true;
}

void KeptPlanes::Impl::build(const View& view, std::span<const ChosenOccluders> sets) {
  const OccluderSet* set = sets.empty() ? nullptr : sets[0].set;
  if (set == nullptr || set != first_set) {
    store.clear();
  }
  first_set = set;
  const Eye last_eye = active.eye();
  active.build(view, sets);
  classifier.begin();
  extendPath(last_eye, active.eye());
  store.beginFrame();
  stats = {};
}

// Makes a relation and evaluates it. It is kept when the box has an item.
Relation KeptPlanes::Impl::relate(Item item, const Box& box, const ActiveOccluder& occluder, PlaneSide side) {
  const std::span<const InsetEdge> edges = active.edgesOf(occluder);
  const std::size_t first_quad = fresh_planes.size();
  fresh_planes.resize(first_quad + (edges.size() + 3) / 4);
  const std::span<PlaneQuad> planes = std::span(fresh_planes).subspan(first_quad);
  Relation relation;
  makeRelation(occluder, edges, box, side, settings.tangent_search, relation, planes);
  evaluate(active.eye(), occluder, planes, path, relation);
  ++stats.rebuilt;
  if (item == kNoItem) {
    fresh_planes.resize(first_quad);
  } else {
    fresh.push_back(relation);
  }
  return relation;
}

// Returns the kept relation, evaluated again where a sign may have changed; null where there is none.
const Relation* KeptPlanes::Impl::reuse(Item item, const ActiveOccluder& occluder) {
  const RelationStore::Index kept = store.find(item, occluder.seen.id);
  if (kept == RelationStore::kNone ||
      !store[kept].fits(occluder.inset_exponent, occluder.seen.flipped, occluder.edge_count)) {
    return nullptr;
  }
  Relation& relation = store[kept];
  ++stats.reused;
  if (path < relation.until) {
    ++stats.unchanged;
  } else {
    evaluate(active.eye(), occluder, store.planes(kept, plane_scratch), path, relation);
  }
  return &relation;
}

// Compares one occluder and the box by planes through the box. Where the near plane clips the occluder, its
// outline changes with every step of the eye: then planes through the eye are used. Nothing is kept of the
// occluders of other sets than the first: their ids may be others' in the next frame.
EyePlaneTest KeptPlanes::Impl::test(const Box& box, Item item, std::uint32_t number) {
  const ActiveOccluder& occluder = active[number];
  ++stats.compared;
  if (occluder.set != 0) {
    item = kNoItem;
  }
  if (occluder.near_clipped) {
    return active.test(number, box);
  }
  if (const Relation* kept = item != kNoItem ? reuse(item, occluder) : nullptr) {
    return {kept->touches, kept->behind, kept->failing()};
  }
  const PlaneSide side = sideOf(occluder, box);
  if (side == PlaneSide::kFront) {
    return {};
  }
  const Relation relation = relate(item, box, occluder, side);
  return {relation.touches, relation.behind, relation.failing()};
}

Visibility KeptPlanes::Impl::classify(const Box& box, Item item, OccluderList among, OccluderList& touching) {
  if (!box.wellFormed()) {
    touching = {active.endOfLists(), 0};
    return Visibility::kVisible;
  }
  if (!settings.keep_relations) {
    item = kNoItem;
  }
  const Visibility visibility = classifier.classify(box, among, among.count, touching, [&](std::uint32_t i) {
    return test(box, item, active.inList(among, i));
  });
  std::size_t quad = 0;
  for (const Relation& relation : fresh) {
    store.keep(item, relation, std::span(fresh_planes).subspan(quad, relation.quads()));
    quad += relation.quads();
  }
  fresh.clear();
  fresh_planes.clear();
  return visibility;
}

KeptPlanes::KeptPlanes(const KeptPlanesSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
KeptPlanes::~KeptPlanes() = default;
KeptPlanes::KeptPlanes(KeptPlanes&&) noexcept = default;
KeptPlanes& KeptPlanes::operator=(KeptPlanes&&) noexcept = default;

void KeptPlanes::build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen) {
  const ChosenOccluders only{&set, chosen};
  impl_->build(view, {&only, 1});
}

void KeptPlanes::build(const View& view, std::span<const ChosenOccluders> sets) {
  impl_->build(view, sets);
}

OccluderList KeptPlanes::add(std::span<const OccluderId> more) {
  return impl_->active.hasSets() ? impl_->active.add(0, more) : OccluderList{};
}

OccluderList KeptPlanes::all() const {
  return impl_->active.all();
}

Visibility KeptPlanes::classify(const Box& box) {
  OccluderList touching;
  const Visibility visibility = impl_->classify(box, Impl::kNoItem, impl_->active.all(), touching);
  impl_->active.truncate(touching.first);
  return visibility;
}

Visibility KeptPlanes::classify(const Box& box, Item item, OccluderList among, OccluderList& touching) {
  return impl_->classify(box, item, among, touching);
}

bool KeptPlanes::forget(Item item) {
  const std::uint32_t count = impl_->store.forget(item);
  impl_->stats.dropped += count;
  return count > 0;
}

void KeptPlanes::forgetAll() {
  impl_->store.clear();
}

KeptPlanesStats KeptPlanes::stats() const {
  const SupportingPlanesStats active = impl_->active.stats();
  KeptPlanesStats stats{active.occluders, active.unusable, impl_->stats};
  stats.relations.evicted = impl_->store.evicted();
  stats.relations.kept = impl_->store.size();
  stats.relations.bytes = impl_->store.bytes();
  return stats;
}

std::uint32_t KeptPlanes::compared() const {
  return impl_->stats.compared;
}

std::span<const OccluderId> KeptPlanes::occluders() const {
  return impl_->active.used();
}

}  // namespace sightline
