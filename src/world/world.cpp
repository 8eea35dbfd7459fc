#include "sightline/world/world.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include "src/world/world_data.h"

namespace sightline {

using namespace world;
using hierarchy::DynamicTree;

namespace world {
namespace {

constexpr std::uint32_t kNone = InstanceData::kNone;
constexpr std::uint32_t kSettleAfter = 60;  // frames without movement

// Numbers of single precision that are surely not above, and not below; by a few units in the last place.
float below(double x) {
  return static_cast<float>(x - 0x1p-22 * std::abs(x) - 0x1p-148);
}
float above(double x) {
  return static_cast<float>(x + 0x1p-22 * std::abs(x) + 0x1p-148);
}

// Whether all numbers are the same bits.
bool same(const Mat4& a, const Mat4& b) {
  const auto x = std::bit_cast<std::array<std::uint64_t, 16>>(a.m),
             y = std::bit_cast<std::array<std::uint64_t, 16>>(b.m);
  std::uint64_t differing = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    differing |= x[i] ^ y[i];
  }
  return differing == 0;
}

}  // namespace

std::uint64_t newWorldNumber() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

MeshExtent::MeshExtent(const Box& bounds) : known(bounds.wellFormed()) {
  if (known) {
    middle = center(bounds);
    half = (Vec3d(bounds.max) - Vec3d(bounds.min)) * 0.5;
    farthest = abs(middle) + half;
  }
}

namespace {

// The box, from an origin, of what has this extent and matrix, grown by what single precision may move its
// points. It is well formed, or empty if it cannot be told, as where a number of the matrix is not finite.
Box placed(const MeshExtent& extent, const Mat4& matrix, double displacement, const Vec3d& origin) {
  const std::array<double, 16>& m = matrix.m;
  const bool affine = m[3] == 0.0 && m[7] == 0.0 && m[11] == 0.0 && m[15] == 1.0;
  if (!extent.known || !affine || !(displacement >= 0.0)) {
    return {};
  }
  // Single precision, in which renderers transform vertices, is off by less than this part of all terms.
  constexpr double kRounding = 0x1p-21;
  std::array<float, 4> low, high, zero;  // zero: NaN where the others are not finite
  const std::array<double, 4> origin_rows{origin.x, origin.y, origin.z, 0.0};
  // The loop goes over rows of the matrix. The fourth row only makes vectors full.
  for (std::size_t row = 0; row < 4; ++row) {
    const double x = m[row], y = m[row + 4], z = m[row + 8], w = m[row + 12] - origin_rows[row];
    const double at = x * extent.middle.x + y * extent.middle.y + z * extent.middle.z + w;
    const double terms = std::abs(x) * extent.farthest.x + std::abs(y) * extent.farthest.y +
                         std::abs(z) * extent.farthest.z + std::abs(w);
    const double reach = std::abs(x) * extent.half.x + std::abs(y) * extent.half.y +
                         std::abs(z) * extent.half.z + displacement + kRounding * terms;
    low[row] = below(at - reach);
    high[row] = above(at + reach);
    zero[row] = low[row] * 0.0f + high[row] * 0.0f;
  }
  if (!((zero[0] + zero[1]) + (zero[2] + zero[3]) == 0.0f)) {
    return {};
  }
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

}  // namespace

Box WorldData::boundsOf(std::uint32_t id, const Vec3d& from) const {
  const InstanceData& own = instances[id];
  return own.mesh < meshes.size()
             ? placed(meshes[own.mesh].extent, world_from_mesh[id], double{own.displacement}, from)
             : Box{};
}

// Puts an instance that is shown where those are found who cull.
void WorldData::place(std::uint32_t id) {
  InstanceData& own = instances[id];
  const Box box = boundsOf(id);
  if (box.empty()) {
    unplace(id);
    own.where = Whereabouts::kUnbounded;
    extras[id].in_unbounded = static_cast<std::uint32_t>(unbounded.size());
    unbounded.emplace_back(id);
  } else if (own.where == Whereabouts::kMoving) {
    moving.move({id, box});
  } else if (own.moves) {
    unplace(id);
    moving.insert({id, box});
    setMoving(id);
  } else {
    unplace(id);
    own.where = Whereabouts::kSettled;
    settled.insert({id, box});
  }
}

// Notes that an instance has just come into the moving tree.
void WorldData::setMoving(std::uint32_t id) {
  InstanceData& own = instances[id];
  own.where = Whereabouts::kMoving;
  own.last_moved = frame;
  if (!own.listed) {
    own.listed = true;
    movers.emplace_back(id);
  }
}

void WorldData::unplace(std::uint32_t id) {
  InstanceData& own = instances[id];
  if (own.where == Whereabouts::kSettled) {
    settled.remove(id);
  } else if (own.where == Whereabouts::kMoving) {
    moving.remove(id);
  } else if (own.where == Whereabouts::kUnbounded) {
    const std::uint32_t place = extras[id].in_unbounded;
    extras[unbounded.back().value].in_unbounded = place;
    unbounded[place] = unbounded.back();
    unbounded.pop_back();
  }
  own.where = Whereabouts::kNowhere;
}

// What moves is in a tree of its own, which is small, so that keeping it good costs little.
void WorldData::moved(std::uint32_t id) {
  InstanceData& own = instances[id];
  own.last_moved = frame;
  if (!own.shown) {
    return;
  }
  if (own.where == Whereabouts::kSettled) {
    const Box box = settled.boxOf(id);
    settled.remove(id);
    moving.insert({id, box});
    setMoving(id);
  }
  place(id);
}

// Gives another matrix to an instance that is in the moving tree and stays there, and returns its box for
// that tree. Of all others, and where the matrix is the same, it changes nothing, and the number it returns
// is not valid.
DynamicTree::Item WorldData::movedInPlace(InstanceId instance, const Mat4& to, std::uint64_t new_version) {
  const DynamicTree::Item none{kNone, {}};
  if (instance.value >= instances.size()) {
    return none;
  }
  InstanceData& own = instances[instance.value];
  if (own.where != Whereabouts::kMoving || own.join != kNone || own.baked ||
      same(world_from_mesh[instance.value], to)) {
    return none;
  }
  const Box box = placed(meshes[own.mesh].extent, to, double{own.displacement}, origin);
  if (box.empty()) {
    return none;
  }
  world_from_mesh[instance.value] = to;
  own.version = new_version;
  own.last_moved = frame;
  return {instance.value, box};
}

std::uint32_t WorldData::addInstance(const Instance& given) {
  const std::uint32_t id = numberIn(instances, free_instances);
  world_from_mesh.resize(instances.size());
  InstanceData& own = instances[id];
  own = {.there = true, .shown = given.shown, .occludes = given.occludes, .listed = own.listed};
  own.moves = given.moves;
  own.groups = given.groups;
  extras.resize(instances.size());
  extras[id] = {.user_data = given.user_data};
  own.displacement = static_cast<float>(given.displacement);
  if (!(double{own.displacement} >= given.displacement)) {
    own.displacement = std::nextafterf(own.displacement, std::numeric_limits<float>::infinity());
  }
  own.version = own.born = ++version;
  world_from_mesh[id] = given.world_from_mesh;
  if (given.mesh.value < meshes.size() && meshes[given.mesh.value].there) {
    own.mesh = given.mesh.value;
    extras[id].in_mesh = static_cast<std::uint32_t>(meshes[own.mesh].instances.size());
    meshes[own.mesh].instances.emplace_back(id);
  }
  ++count;
  in_no_group += own.groups == 0 ? 1 : 0;
  return id;
}

// Looks at some of those that moved, and puts those that have not done so for a while among the settled ones.
void WorldData::settle(std::uint32_t looks) {
  for (std::uint32_t i = 0; i < looks && !movers.empty(); ++i) {
    next_mover = next_mover < movers.size() ? next_mover : 0;
    const std::uint32_t id = movers[next_mover].value;
    InstanceData& own = instances[id];
    const bool in_tree = own.where == Whereabouts::kMoving;
    if (in_tree && frame - own.last_moved < kSettleAfter) {
      ++next_mover;
      continue;
    }
    own.listed = false;
    movers[next_mover] = movers.back();
    movers.pop_back();
    if (in_tree) {
      const Box box = moving.boxOf(id);
      moving.remove(id);
      settled.insert({id, box});
      own.where = Whereabouts::kSettled;
    }
  }
}

// Sees to it that the trees are copied with boxes from the next origin.
void WorldData::goOnToOrigin() {
  const auto begin = [this](DynamicTree& tree) {
    if (!tree.hasOtherBoxes()) {  // it has not begun, or the tree was built anew meanwhile
      tree.beginReplacement([this](std::uint32_t id) {
        const Box box = boundsOf(id, next_origin);
        if (box.empty()) {
          lost.emplace_back(id);
        }
        return box;
      });
    }
  };
  begin(settled);
  // While a copy is kept up to date, moving costs twice as much, so that of what moves is made last.
  if (settled.replacementIsComplete()) {
    begin(moving);
  }
}

void WorldData::takeOrigin() {
  settled.takeReplacement();
  moving.takeReplacement();
  origin = next_origin;
  origin_moves = false;
  lost.insert(lost.end(), unbounded.begin(), unbounded.end());
  unbounded.clear();
  placeAnew(std::vector(std::move(lost)));
}

// Places those that are shown and are in none of the trees. The list may name some twice.
void WorldData::placeAnew(std::span<const InstanceId> list) {
  for (const InstanceId id : list) {
    if (!settled.has(id.value) && !moving.has(id.value)) {
      instances[id.value].where = Whereabouts::kNowhere;
    }
  }
  for (const InstanceId id : list) {
    const InstanceData& own = instances[id.value];
    if (own.shown && own.where == Whereabouts::kNowhere) {
      place(id.value);
    }
  }
}

}  // namespace world

World::World() : data_(std::make_unique<WorldData>()) {}
World::~World() = default;
World::World(World&&) noexcept = default;
World& World::operator=(World&&) noexcept = default;

MeshId World::addMesh(WorldMesh mesh) {
  const std::uint32_t number = numberIn(data_->meshes, data_->free_meshes);
  const MeshExtent extent(mesh.bounds);
  data_->meshes[number] = {.there = true, .extent = extent, .mesh = std::move(mesh), .instances = {}};
  return MeshId(number);
}

void World::removeMesh(MeshId mesh) {
  WorldData& own = *data_;
  if (mesh.value >= own.meshes.size() || !own.meshes[mesh.value].there) {
    return;
  }
  while (!own.meshes[mesh.value].instances.empty()) {
    remove(own.meshes[mesh.value].instances.back());
  }
  own.meshes[mesh.value] = MeshData();
  own.free_meshes.push_back(mesh.value);
}

void World::reserve(std::size_t instances) {
  data_->instances.reserve(instances);
  data_->extras.reserve(instances);
  data_->world_from_mesh.reserve(instances);
  data_->settled.reserve(instances);
}

InstanceId World::add(const Instance& instance) {
  const std::uint32_t id = data_->addInstance(instance);
  if (instance.shown) {
    data_->place(id);
  }
  return InstanceId(id);
}

void World::add(std::span<const Instance> given, std::vector<InstanceId>& ids) {
  WorldData& own = *data_;
  std::vector<DynamicTree::Item> items, moving_items;
  for (const Instance& instance : given) {
    const std::uint32_t id = own.addInstance(instance);
    ids.emplace_back(id);
    InstanceData& added = own.instances[id];
    const Box box = added.shown ? own.boundsOf(id) : Box{};
    if (!box.empty() && added.moves) {
      moving_items.push_back({id, box});
      own.setMoving(id);
    } else if (!box.empty()) {
      items.push_back({id, box});
      added.where = Whereabouts::kSettled;
    } else if (added.shown) {
      own.place(id);
    }
  }
  own.settled.insert(items);
  own.moving.insert(moving_items);
}

void World::remove(InstanceId instance) {
  WorldData& own = *data_;
  if (!has(instance)) {
    return;
  }
  const std::uint32_t id = instance.value;
  InstanceData& gone = own.instances[id];
  own.unplace(id);
  own.leaveJoin(id);
  own.leaveSets(id);
  if (gone.mesh != InstanceData::kNone) {
    std::vector<InstanceId>& of_mesh = own.meshes[gone.mesh].instances;
    const std::uint32_t place = own.extras[id].in_mesh;
    own.extras[of_mesh.back().value].in_mesh = place;
    of_mesh[place] = of_mesh.back();
    of_mesh.pop_back();
  }
  own.in_no_group -= gone.groups == 0 ? 1 : 0;
  gone = {.listed = gone.listed};
  gone.version = ++own.version;
  own.free_instances.push_back(id);
  --own.count;
}

void World::replace(InstanceId instance, const Instance& by) {
  if (has(instance)) {
    remove(instance);
    [[maybe_unused]] const InstanceId again = add(by);
    assert(again == instance);  // the number that was set free last
  }
}

void World::setTransform(InstanceId instance, const Mat4& world_from_mesh) {
  WorldData& own = *data_;
  const DynamicTree::Item moved = own.movedInPlace(instance, world_from_mesh, own.version + 1);
  if (moved.number != kNone) {
    ++own.version;
    own.moving.move(moved);
    return;
  }
  if (!has(instance) || same(own.world_from_mesh[instance.value], world_from_mesh)) {
    return;
  }
  own.world_from_mesh[instance.value] = world_from_mesh;
  own.instances[instance.value].version = ++own.version;
  own.leaveJoin(instance.value);
  own.leaveSets(instance.value);
  own.moved(instance.value);
}

void World::setTransforms(std::span<const InstanceId> instances, std::span<const Mat4> world_from_mesh,
                          const ParallelFor& parallel_for) {
  WorldData& own = *data_;
  const std::size_t count = std::min(instances.size(), world_from_mesh.size());
  own.moves.resize(std::max(own.moves.size(), count));
  const auto move = [&](std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t i = begin; i < end; ++i) {
      own.moves[i] = own.movedInPlace(instances[i], world_from_mesh[i], own.version + i + 1);
    }
  };
  // std::function keeps one reference without memory of its own; `move` has more.
  parallel_for(static_cast<std::uint32_t>(count),
               [&move](std::uint32_t begin, std::uint32_t end) { move(begin, end); });
  own.version += count;
  own.moving.move(std::span(own.moves).first(count));
  for (std::size_t i = 0; i < count; ++i) {
    if (own.moves[i].number == kNone) {
      setTransform(instances[i], world_from_mesh[i]);
    }
  }
}

void World::setShown(InstanceId instance, bool shown) {
  WorldData& own = *data_;
  if (!has(instance) || own.instances[instance.value].shown == shown) {
    return;
  }
  InstanceData& changed = own.instances[instance.value];
  changed.shown = shown;
  changed.version = ++own.version;
  if (shown) {
    own.place(instance.value);
  } else {
    own.leaveJoin(instance.value);
    own.leaveSets(instance.value);
    own.unplace(instance.value);
  }
}

void World::setGroups(InstanceId instance, std::uint32_t groups) {
  WorldData& own = *data_;
  if (!has(instance) || own.instances[instance.value].groups == groups) {
    return;
  }
  InstanceData& changed = own.instances[instance.value];
  own.in_no_group += groups == 0 ? 1 : 0;
  own.in_no_group -= changed.groups == 0 ? 1 : 0;
  changed.groups = groups;
  changed.version = ++own.version;
  own.leaveJoin(instance.value);
  own.leaveSets(instance.value);
}

bool World::has(InstanceId instance) const {
  return instance.value < data_->instances.size() && data_->instances[instance.value].there;
}
std::size_t World::instances() const {
  return data_->count;
}
std::size_t World::idBound() const {
  return data_->instances.size();
}
MeshId World::meshOf(InstanceId instance) const {
  return has(instance) ? MeshId(data_->instances[instance.value].mesh) : MeshId();
}
std::uint64_t World::userDataOf(InstanceId instance) const {
  return has(instance) ? data_->extras[instance.value].user_data : 0;
}
std::uint64_t World::bornOf(InstanceId instance) const {
  return has(instance) ? data_->instances[instance.value].born : 0;
}
Box World::boxFromOrigin(const Vec3d& min_world, const Vec3d& max_world) const {
  const Vec3d min = min_world - data_->origin, max = max_world - data_->origin;
  return {{below(min.x), below(min.y), below(min.z)}, {above(max.x), above(max.y), above(max.z)}};
}
Box World::boundsOf(InstanceId instance) const {
  return has(instance) ? data_->boundsOf(instance.value) : Box{};
}

// The trees stay as they are: that all boxes move by the same vector changes nothing but their rounding.
void World::setOrigin(const Vec3d& origin) {
  WorldData& own = *data_;
  if (!isFinite(origin)) {
    return;
  }
  moveOrigin(own.origin);  // ends a move to another one
  if (origin == own.origin) {
    return;
  }
  own.origin = origin;
  std::vector<InstanceId> lost;  // overflow has left them without a box
  const auto box = [&](std::uint32_t id) {
    const Box now = own.boundsOf(id);
    if (now.empty()) {
      lost.emplace_back(id);
    }
    return now;
  };
  own.settled.setBoxes(box);
  own.moving.setBoxes(box);
  for (const InstanceId id : lost) {
    own.place(id.value);
  }
  own.placeAnew(std::vector(std::move(own.unbounded)));
}

void World::moveOrigin(const Vec3d& origin) {
  WorldData& own = *data_;
  if (!isFinite(origin) || origin == (own.origin_moves ? own.next_origin : own.origin)) {
    return;
  }
  if (own.origin_moves) {
    own.settled.endReplacement();
    own.moving.endReplacement();
  }
  own.lost.clear();
  own.next_origin = origin;
  own.origin_moves = origin != own.origin;
}
Vec3d World::origin() const {
  return data_->origin;
}

void World::rebuild() {
  data_->settled.rebuild();
  data_->moving.rebuild();
}

void World::tidy(std::uint32_t steps) {
  WorldData& own = *data_;
  ++own.frame;
  if (own.origin_moves) {
    own.goOnToOrigin();
  }
  const std::uint32_t kept = steps / 4;  // for what rests: what moves may use up any number of steps
  const std::uint32_t left = own.moving.tidy(steps - kept) + kept;
  own.settle(std::min<std::uint32_t>(left, 256));
  own.settled.tidy(left);
  if (own.origin_moves && own.moving.replacementIsComplete() && own.settled.replacementIsComplete()) {
    own.takeOrigin();
  }
}

}  // namespace sightline
