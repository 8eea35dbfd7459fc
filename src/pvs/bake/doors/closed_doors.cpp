#include "src/pvs/bake/doors/closed_doors.h"

#include <algorithm>
#include <iterator>

#include "src/pvs/bake/shaft.h"

namespace sightline::pvs {
namespace {

bool contains(std::span<const ObjectRun> runs, std::uint32_t position) {
  const auto after = std::ranges::upper_bound(runs, position, {}, &ObjectRun::begin);
  return after != runs.begin() && position < std::prev(after)->end;
}

}  // namespace

ClosedDoors::ClosedDoors(const BakeScene& scene, SampleStore& samples) : scene_(scene), samples_(samples) {
  for (const Panels& panels : scene.closed_panels) {
    surfaces_.emplace_back(scene, panels);
  }
}

void ClosedDoors::hide(const CellBox& cell, const CellBox& search, CellSets& sets) {
  if (scene_.doors.all.empty()) {
    return;
  }
  const std::vector<Vec3d> corners = cornersOf(cell);
  hideFrom({corners, cell}, search, sets.whole, sets.whole_doors);
  if (!sets.plane) {
    return;
  }
  const SideCorners sides(cell, *sets.plane, scene_.side_margin);
  const auto hideFromSide = [&](std::span<const Vec3d> of_side, Runs& seen, DoorRuns& doors) {
    if (of_side.empty()) {
      return;  // there are no viewers
    }
    doors = sets.whole_doors;
    const CellBox around = boundsOf(of_side);
    hideFrom({of_side, around, around.extent() != cell.extent()}, search, seen, doors);
  };
  hideFromSide(sides.front, sets.front, sets.front_doors);
  hideFromSide(sides.back, sets.back, sets.back_doors);
}

void ClosedDoors::hideFrom(const Region& region, const CellBox& search, Runs& seen, DoorRuns& doors) {
  if (seen.empty()) {
    seen = scene_.door_runs;
    doors.clear();
    return;
  }
  const DoorRuns before = std::move(doors);
  doors.clear();
  std::size_t next = 0;  // in `before`
  for (std::uint32_t group = 0; group < scene_.doors.groups.size(); ++group) {
    known_.clear();
    const auto know = [this](const Runs& runs) {
      unite(known_, runs, common_);
      known_.swap(common_);
    };
    if (next < before.size() && before[next].group == group) {
      know(before[next++].hidden);
    }
    for (const HiddenByDoors& part : doors) {
      if (scene_.doors.isWithin(part.group, group)) {
        know(part.hidden);
      }
    }
    findSeenDoors(group, seen);
    HiddenByDoors found{.group = group};
    // A door that is hidden adds nothing, and a single one that is seen is a group by itself.
    if (seen_doors_.size() == scene_.doors.groups[group].size() || seen_doors_.size() > 1) {
      found.hidden = hiddenBy(group, region, search, seen);
    } else {
      intersect(seen, known_, found.hidden);
    }
    if (!found.hidden.empty()) {
      doors.push_back(std::move(found));
    }
  }
}

Runs ClosedDoors::hiddenBy(std::uint32_t group, const Region& region, const CellBox& search,
                           const Runs& seen) {
  subtract(seen, known_, left_);
  hidden_.resetWithout(left_, static_cast<std::uint32_t>(scene_.boxes.objects.size()));
  if (const std::vector<ObjectId>& members = scene_.doors.groups[group]; members.size() == 1) {
    hideByConvex(members[0], region, search);
  }
  if (!surfaces_.empty() && region.ask_surfaces) {
    hideBelow(0, group, region.box);
  }
  hidden_.complement(left_);
  Runs hidden;
  subtract(seen, left_, hidden);
  return hidden;
}

void ClosedDoors::findSeenDoors(std::uint32_t group, const Runs& seen) {
  seen_doors_.clear();
  for (const ObjectId door : scene_.doors.groups[group]) {
    if (contains(seen, scene_.position_of[door.value])) {
      seen_doors_.push_back(door);
    }
  }
}

void ClosedDoors::hideByConvex(ObjectId door, const Region& region, const CellBox& search) {
  std::vector<Sample*> samples;
  for (const std::uint32_t i : scene_.occludersOfDoor(door)) {
    const ConvexOccluder& occluder = scene_.occluders[i];
    if (!intersects(search, occluder.bounds) ||
        !separated(scene_.occluders, occluder, region.corners, scene_.settings.near_distance)) {
      continue;
    }
    if (samples.empty()) {
      for (const Vec3d& corner : region.corners) {
        samples.push_back(&samples_.at(corner));
      }
    }
    if (samples_.hiddenFromAll(i, samples, common_)) {
      hidden_.add(common_);
    }
  }
}

void ClosedDoors::hideBelow(std::uint32_t number, std::uint32_t group, const CellBox& region) {
  const BoxTreeView boxes = scene_.boxes.view();
  const BoxNode& node = boxes.nodes[number];
  const ObjectRun objects{node.first_object, node.first_object + node.object_count};
  if (hidden_.containsAll(objects)) {
    return;
  }
  if (node.bounds.wellFormed() && !intersects(region, node.bounds)) {
    const Shaft shaft(region, {Vec3d(node.bounds.min), Vec3d(node.bounds.max)}, scene_.magnitude, 0.0);
    const auto misses = [&](ObjectId door) {
      return shaft.misses(scene_.leafOf(scene_.position_of[door.value]).bounds);
    };
    if (std::all_of(seen_doors_.begin(), seen_doors_.end(), misses)) {
      return;  // the doors hide nothing of the node that is seen while they are open
    }
    if (surfaces_[group].hides(number, region, effortOf(scene_.settings))) {
      hidden_.add(std::span(&objects, 1));
      return;
    }
  }
  for (std::uint32_t child = number + 1; child < node.end; child = boxes.nodes[child].end) {
    hideBelow(child, group, region);
  }
}

}  // namespace sightline::pvs
