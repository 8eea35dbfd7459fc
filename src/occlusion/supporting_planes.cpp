// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, sections 3
// and 4. Differs from the paper in: joint occlusion is decided by elimination, so that a connected set hides
// a box also when only part of it does, see docs/algorithms/supporting-planes.md.

#include "sightline/occlusion/supporting_planes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "src/occlusion/relation.h"
#include "src/occlusion/relation_store.h"
#include "src/scene/usable_view.h"

namespace sightline {

using namespace occlusion;

struct SupportingPlanes::Impl {
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr Item kNoItem = 0xffffffffu;

  // An occluder that has all of the box behind it and may hide some of it.
  struct Partial {
    std::uint32_t member = 0;
    std::uint64_t failing = 0;  // edges whose supporting plane the eye does not satisfy
  };

  enum class Role : std::uint8_t { kUnknown, kAlive, kRejected };
  static constexpr std::size_t kMaxJoint = 256;  // members of a set that hides together

  explicit Impl(const SupportingPlanesSettings& s) : settings(s), store(s.relation_bytes) {}

  // A set of build(). Its occluders have the numbers from first_number on, after those of the sets before.
  struct Source {
    const OccluderSet* set = nullptr;
    std::uint32_t first_number = 0;
  };

  void build(const View& view, std::span<const ChosenOccluders> sets);
  void follow(const Eye& next);
  void takeSources(std::span<const ChosenOccluders> sets);
  const OccluderSet& setOf(const Member& member) const { return *sources[member.set].set; }
  std::uint32_t& memberSlot(std::uint32_t source, OccluderId id) {
    return member_of[sources[source].first_number + id.value];
  }
  std::uint32_t memberOf(std::uint32_t source, OccluderId id);
  OccluderList listOf(std::uint32_t source, std::span<const OccluderId> ids);
  std::span<const InsetEdge> edgesOf(const Member& member) const;
  void findSeams(Member& member);
  EyeLook lookThrough(const Box& box, Item item, std::uint32_t index);
  const Relation* lookAgain(Item item, const Member& member);
  Relation relate(Item item, const Box& box, const Member& member, PlaneSide side);
  Visibility classify(const Box& box, Item item, OccluderList among, OccluderList& touching);
  bool hiddenJointly(const Box& box);
  bool survives(const Partial& partial, const Box& box);
  bool recruit(std::uint32_t source, OccluderId id, const Box& box);

  SupportingPlanesSettings settings;
  SupportingPlanesStats stats;
  std::vector<Source> sources;
  Eye eye;
  bool has_eye = false;
  bool usable_view = false;  // of the last build(): see validate(). Without one, no occluder hides
  double path = 0.0;         // of the eye, metres; orthographic: of its direction on the unit sphere
  std::vector<Member> members;
  std::uint32_t recruitable = 0;         // so many of them are those of build()
  std::vector<std::uint32_t> member_of;  // by the number of an occluder, see Source
  std::vector<std::uint32_t> asked;      // numbers that have an entry there
  std::vector<OccluderId> used;          // of build(), of the first set
  std::vector<InsetEdge> inset_edges;
  std::vector<EyeShape> shapes;  // by member
  std::vector<EyeQuad> eye_quads;
  std::vector<Plane> seams;          // by edge of a member, the member behind it, relative to the eye
  std::vector<std::uint32_t> lists;  // members; in each list set by set, ascending by OccluderId
  OccluderList all;
  RelationStore store;

  // Of one call of classify().
  std::vector<Relation> fresh;
  std::vector<PlaneQuad> fresh_planes, plane_scratch;
  std::vector<EyeLook> looks;
  std::vector<Partial> partials;
  std::vector<Role> roles;              // by member, in the search for a set that hides the box
  std::vector<std::uint32_t> examined;  // members that have a role
};

// The way of the eye since the last frame makes the path longer. Rounding may only lengthen it.
void SupportingPlanes::Impl::follow(const Eye& next) {
  const double step =
      next.orthographic ? length(next.forward - eye.forward) : length(next.position - eye.position);
  if (!has_eye || next.orthographic != eye.orthographic || !std::isfinite(step)) {
    store.clear();
    path = 0.0;
  } else if (step > 0.0) {
    path = path * (1.0 + 0x1p-52) + step * (1.0 + 0x1p-40);
  }
  has_eye = true;
  eye = next;
}

void SupportingPlanes::Impl::takeSources(std::span<const ChosenOccluders> sets) {
  for (const std::uint32_t number : asked) {
    member_of[number] = kNone;
  }
  asked.clear();
  if (sources.empty() || sets.empty() || sources[0].set != sets[0].set) {
    store.clear();
  }
  sources.clear();
  std::size_t numbers = 0;
  for (const ChosenOccluders& part : sets) {
    sources.push_back({part.set, static_cast<std::uint32_t>(numbers)});
    numbers += part.set->occluders.size();
  }
  member_of.resize(std::max(member_of.size(), numbers), kNone);
}

void SupportingPlanes::Impl::build(const View& given, std::span<const ChosenOccluders> sets) {
  View view = given;
  usable_view = makeUsable(view) == nullptr;
  takeSources(sets);
  follow(Eye(view));
  store.beginFrame();
  members.clear();
  inset_edges.clear();
  shapes.clear();
  eye_quads.clear();
  seams.clear();
  lists.clear();
  used.clear();
  roles.clear();
  stats = {};
  for (std::uint32_t source = 0; source < sets.size(); ++source) {
    listOf(source, sets[source].chosen);
  }
  all = {0, static_cast<std::uint32_t>(lists.size())};
  recruitable = static_cast<std::uint32_t>(members.size());
  for (const Member& member : members) {
    if (member.set == 0) {
      used.push_back(member.seen.id);
    }
  }
  stats.occluders = recruitable;
  stats.unusable = static_cast<std::uint32_t>(asked.size()) - stats.occluders;
}

// kNone where the occluder can't be used from here.
std::uint32_t SupportingPlanes::Impl::memberOf(std::uint32_t source, OccluderId id) {
  constexpr std::uint32_t kUnusable = kNone - 1;
  const OccluderSet& set = *sources[source].set;
  std::uint32_t& index = memberSlot(source, id);
  if (index == kNone) {
    asked.push_back(sources[source].first_number + id.value);
    index = kUnusable;
    if (const std::optional<Member> member = makeMember(eye, set, id)) {
      index = static_cast<std::uint32_t>(members.size());
      members.push_back(*member);
      members.back().set = source;
      members.back().first_edge = static_cast<std::uint32_t>(inset_edges.size());
      appendInsetEdges(set, *member, inset_edges);
      shapes.push_back(eyeShapeOf(eye, *member, edgesOf(members.back()), eye_quads));
      roles.push_back(Role::kUnknown);
    }
  }
  return index == kUnusable ? kNone : index;
}

OccluderList SupportingPlanes::Impl::listOf(std::uint32_t source, std::span<const OccluderId> ids) {
  const std::size_t first = lists.size();
  for (const OccluderId id : ids) {
    const bool known =
        usable_view && source < sources.size() && id.value < sources[source].set->occluders.size();
    const std::uint32_t member = known ? memberOf(source, id) : kNone;
    if (member != kNone) {
      lists.push_back(member);
    }
  }
  const auto begin = lists.begin() + static_cast<std::ptrdiff_t>(first);
  std::sort(begin, lists.end(),
            [this](std::uint32_t a, std::uint32_t b) { return members[a].seen.id < members[b].seen.id; });
  lists.erase(std::unique(begin, lists.end()), lists.end());
  return {static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(lists.size() - first)};
}

std::span<const InsetEdge> SupportingPlanes::Impl::edgesOf(const Member& member) const {
  return std::span(inset_edges).subspan(member.first_edge, member.edge_count);
}

void SupportingPlanes::Impl::findSeams(Member& member) {
  if (member.first_seam != Member::kNotYet) {
    return;
  }
  const OccluderSet& set = setOf(member);
  const Occluder& occluder = set[member.seen.id];
  member.first_seam = static_cast<std::uint32_t>(seams.size());
  seams.resize(seams.size() + occluder.vertex_count);
  for (std::uint32_t side = 0; side < occluder.vertex_count; ++side) {
    const Outline outline = outlineOf(eye, set, member.seen, side);
    if (const std::optional<Seam> seam = seamOf(eye, set, member.seen, outline)) {
      const std::uint32_t e = outline.edge - occluder.first_vertex;
      seams[member.first_seam + e] = seam->oriented();
      member.sealable |= std::uint64_t{1} << e;
    }
  }
}

// An occluder that need not touch the box: it may still be what an edge of another one goes on in.
bool SupportingPlanes::Impl::recruit(std::uint32_t source, OccluderId id, const Box& box) {
  const std::uint32_t index = memberSlot(source, id);
  if (index >= recruitable || roles[index] != Role::kUnknown || partials.size() >= kMaxJoint) {
    return false;
  }
  Member& member = members[index];
  roles[index] = Role::kRejected;
  examined.push_back(index);
  EyeLook look;
  lookPast(shapes, eye_quads, {&index, 1}, EyeBox::of(box, eye.position), {&look, 1});
  if (!look.behind) {
    return false;
  }
  const Partial partial{index, look.failing};
  findSeams(member);
  if ((partial.failing & ~member.sealable) != 0) {
    return false;
  }
  roles[index] = Role::kAlive;
  partials.push_back(partial);
  return true;
}

// Whether what lies beyond each failing edge is covered by occluders that are alive, or are now made so.
bool SupportingPlanes::Impl::survives(const Partial& partial, const Box& box) {
  const std::uint32_t source = members[partial.member].set;
  const OccluderSet& set = *sources[source].set;
  const Occluder& occluder = set[members[partial.member].seen.id];
  const auto centroidOf = [&](OccluderId id) -> const Vec3d* {
    const std::uint32_t other = memberSlot(source, id);
    return other < members.size() && roles[other] == Role::kAlive ? &members[other].seen.centroid : nullptr;
  };
  for (std::uint32_t e = 0; e < occluder.vertex_count; ++e) {
    if ((partial.failing >> e & 1) == 0) {
      continue;
    }
    const OccluderEdge& edge = set.edges[occluder.first_vertex + e];
    const Plane seam = seams[members[partial.member].first_seam + e];
    std::uint64_t open = openElements(set, edge, seam, centroidOf);
    for (std::uint32_t c = 0; c < edge.cover_count && open != 0; ++c) {
      const EdgeCover& cover = set.covers[edge.first_cover + c];
      if ((open >> cover.element & 1) != 0 && recruit(source, cover.occluder, box)) {
        open = openElements(set, edge, seam, centroidOf);
      }
    }
    if (open != 0) {
      return false;
    }
  }
  return true;
}

// A set of occluders hides what lies behind all of them and satisfies the supporting planes of all edges but
// those at which the set goes on. The largest such set is what elimination leaves.
bool SupportingPlanes::Impl::hiddenJointly(const Box& box) {
  examined.clear();
  std::erase_if(partials, [this](const Partial& partial) {
    Member& member = members[partial.member];
    findSeams(member);
    const bool dead = (partial.failing & ~member.sealable) != 0;
    roles[partial.member] = dead ? Role::kRejected : Role::kAlive;
    examined.push_back(partial.member);
    return dead;
  });
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < partials.size();) {
      const Partial partial = partials[i];
      if (survives(partial, box)) {
        ++i;
      } else {
        roles[partial.member] = Role::kRejected;
        partials[i] = partials.back();
        partials.pop_back();
        changed = true;
      }
    }
  }
  for (const std::uint32_t member : examined) {
    roles[member] = Role::kUnknown;
  }
  return !partials.empty();
}

// A new relation, evaluated; remembered to be kept.
Relation SupportingPlanes::Impl::relate(Item item, const Box& box, const Member& member, PlaneSide side) {
  const std::span<const InsetEdge> edges = edgesOf(member);
  const std::size_t first_quad = fresh_planes.size();
  fresh_planes.resize(first_quad + (edges.size() + 3) / 4);
  const std::span<PlaneQuad> planes = std::span(fresh_planes).subspan(first_quad);
  Relation relation;
  makeRelation(member, edges, box, side, settings.tangent_search, relation, planes);
  evaluate(member, planes, path, relation);
  ++stats.relations.rebuilt;
  if (item == kNoItem) {
    fresh_planes.resize(first_quad);
  } else {
    fresh.push_back(relation);
  }
  return relation;
}

// One occluder and the box, by planes through the box. Where the near plane cuts the occluder, its outline
// changes with every step: then by planes through the eye. Of an occluder that may move nothing is kept: its
// id may be another's in the next frame.
EyeLook SupportingPlanes::Impl::lookThrough(const Box& box, Item item, std::uint32_t index) {
  const Member& member = members[index];
  if (member.set != 0) {
    item = kNoItem;
  }
  if (member.near_clipped) {
    EyeLook look;
    lookPast(shapes, eye_quads, {&index, 1}, EyeBox::of(box, eye.position), {&look, 1});
    return look;
  }
  if (const Relation* kept = item != kNoItem ? lookAgain(item, member) : nullptr) {
    return {kept->touches, kept->behind, kept->failing()};
  }
  const PlaneSide side = sideOf(member, box);
  if (side == PlaneSide::kFront) {
    return {};
  }
  const Relation relation = relate(item, box, member, side);
  return {relation.touches, relation.behind, relation.failing()};
}

// A kept relation, looked at again where a sign may have changed; null: there is none.
const Relation* SupportingPlanes::Impl::lookAgain(Item item, const Member& member) {
  const RelationStore::Index kept = store.find(item, member.seen.id);
  if (kept == RelationStore::kNone ||
      !store[kept].fits(member.inset_exponent, member.seen.flipped, member.edge_count)) {
    return nullptr;
  }
  Relation& relation = store[kept];
  ++stats.relations.reused;
  if (path < relation.until) {
    ++stats.relations.unchanged;
  } else {
    evaluate(member, store.planes(kept, plane_scratch), path, relation);
  }
  return &relation;
}

Visibility SupportingPlanes::Impl::classify(const Box& box, Item item, OccluderList among,
                                            OccluderList& touching) {
  touching = {static_cast<std::uint32_t>(lists.size()), 0};
  if (!box.wellFormed()) {
    return Visibility::kVisible;
  }
  if (!settings.keep_relations) {
    item = kNoItem;
  }
  partials.clear();
  bool hidden = false;
  const bool through_eye = settings.form == PlaneForm::kThroughEye;
  std::uint32_t count = among.count;
  if (through_eye) {
    looks.resize(std::max<std::size_t>(looks.size(), count));
    const std::span<const std::uint32_t> list = std::span(lists).subspan(among.first, count);
    count =
        static_cast<std::uint32_t>(lookPast(shapes, eye_quads, list, EyeBox::of(box, eye.position), looks));
  }
  for (std::uint32_t i = 0; i < count && !hidden; ++i) {
    const std::uint32_t index = lists[among.first + i];
    const EyeLook look = through_eye ? looks[i] : lookThrough(box, item, index);
    if (!look.touches) {
      continue;
    }
    lists.push_back(index);
    if (look.behind) {
      hidden = look.failing == 0;
      partials.push_back({index, look.failing});
    }
  }
  std::size_t quad = 0;
  for (const Relation& relation : fresh) {
    store.keep(item, relation, std::span(fresh_planes).subspan(quad, relation.quads()));
    quad += relation.quads();
  }
  fresh.clear();
  fresh_planes.clear();
  if (hidden || (settings.joint_occlusion && !partials.empty() && hiddenJointly(box))) {
    lists.resize(touching.first);
    return Visibility::kHidden;
  }
  touching.count = static_cast<std::uint32_t>(lists.size()) - touching.first;
  return touching.count == 0 ? Visibility::kVisible : Visibility::kPartial;
}

SupportingPlanes::SupportingPlanes(const SupportingPlanesSettings& settings)
    : impl_(std::make_unique<Impl>(settings)) {}
SupportingPlanes::~SupportingPlanes() = default;
SupportingPlanes::SupportingPlanes(SupportingPlanes&&) noexcept = default;
SupportingPlanes& SupportingPlanes::operator=(SupportingPlanes&&) noexcept = default;

void SupportingPlanes::build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen) {
  const ChosenOccluders only{&set, chosen};
  impl_->build(view, {&only, 1});
}

void SupportingPlanes::build(const View& view, std::span<const ChosenOccluders> sets) {
  impl_->build(view, sets);
}

OccluderList SupportingPlanes::add(std::span<const OccluderId> more) {
  return impl_->sources.empty() ? OccluderList{} : impl_->listOf(0, more);
}

OccluderList SupportingPlanes::all() const {
  return impl_->all;
}

Visibility SupportingPlanes::classify(const Box& box) {
  OccluderList touching;
  const Visibility visibility = impl_->classify(box, Impl::kNoItem, impl_->all, touching);
  impl_->lists.resize(touching.first);
  return visibility;
}

Visibility SupportingPlanes::classify(const Box& box, Item item, OccluderList among, OccluderList& touching) {
  return impl_->classify(box, item, among, touching);
}

bool SupportingPlanes::forget(Item item) {
  const std::uint32_t count = impl_->store.forget(item);
  impl_->stats.relations.dropped += count;
  return count > 0;
}

void SupportingPlanes::forgetAll() {
  impl_->store.clear();
}

SupportingPlanesStats SupportingPlanes::stats() const {
  SupportingPlanesStats stats = impl_->stats;
  stats.relations.evicted = impl_->store.evicted();
  stats.relations.kept = impl_->store.size();
  stats.relations.bytes = impl_->store.bytes();
  return stats;
}

std::span<const OccluderId> SupportingPlanes::occluders() const {
  return impl_->used;
}

}  // namespace sightline
