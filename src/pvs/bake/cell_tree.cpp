// Based on: Saona-Vazquez, Navazo, Brunet. The Visibility Octree. Computers & Graphics 1999, section 3.2.
// Differs from the paper in: cells at the maximum depth also enlarge their search boxes before they give up.

#include "src/pvs/bake/cell_tree.h"

#include <algorithm>
#include <array>
#include <functional>
#include <set>
#include <utility>

#include "src/pvs/bake/file/run_code.h"

namespace sightline::pvs {
namespace {

BakedCell leafOf(const OctreeCell& cell, const ViewerBounds& viewers, CellSets&& sets, StopReason reason) {
  BakedCell leaf;
  leaf.sets = std::move(sets);
  leaf.viewers = viewers;
  leaf.reason = reason;
  leaf.level = static_cast<std::uint8_t>(cell.level);
  return leaf;
}

// What decide() does while all doors are open.
CellOutcome decideOpen(CellBaker& baker, const BakeScene& scene, const CellTask& task) {
  const BakeSettings& settings = scene.settings;
  const bool deepest = !scene.mayDivide(task.cell);
  const std::uint64_t work_before = baker.work();
  double distance = task.search_distance;
  if (!scene.holdsViewers(scene.boxOf(task.cell))) {
    CellSets everything;
    everything.whole = {{0, static_cast<std::uint32_t>(scene.boxes.objects.size())}};
    return {.leaf = leafOf(task.cell, {}, std::move(everything), StopReason::kOutside)};
  }
  const ViewerBounds viewers = scene.viewersIn(task.cell);
  CellSets sets = baker.seenFrom(task.cell, distance, task.seen);
  const auto leaf = [&](StopReason reason) {
    if (!deepest) {
      baker.lookCloser(task.cell, sets);
    }
    return CellOutcome{.leaf = leafOf(task.cell, viewers, std::move(sets), reason),
                       .search_distance = distance};
  };
  for (;;) {
    const std::uint64_t triangles = trianglesOf(scene, sets);
    if (triangles <= settings.triangle_budget) {
      return leaf(StopReason::kBudgetMet);
    }
    if (!deepest &&
        (baker.tooLargeForItsOccluders(task.cell) || baker.dividingHelps(task.cell, distance, sets))) {
      baker.forgetSides();
      return {.search_distance = distance, .seen = std::move(sets.whole), .work = baker.work() - work_before};
    }
    bool gained = false;
    if (!baker.searchedAll(task.cell, distance)) {
      baker.lookFarther(task.cell, distance, 2.0 * distance, sets);
      distance *= 2.0;
      const double less = static_cast<double>(triangles) - static_cast<double>(trianglesOf(scene, sets));
      gained = less > 0.0 && less >= settings.min_gain * static_cast<double>(triangles);
    }
    if (!gained) {
      return leaf(deepest ? StopReason::kMaxDepth : StopReason::kNothingGained);
    }
  }
}

}  // namespace

CellOutcome decide(CellBaker& baker, const BakeScene& scene, const CellTask& task) {
  CellOutcome outcome = decideOpen(baker, scene, task);
  if (outcome.leaf && outcome.leaf->reason != StopReason::kOutside) {
    baker.closeDoors(task.cell, outcome.search_distance, outcome.leaf->sets);
  }
  return outcome;
}

BakedCell bakeBelow(CellBaker& baker, const BakeScene& scene, const OctreeCell& place,
                    CellOutcome&& outcome) {
  baker.forgetOldest();
  if (outcome.leaf) {
    return std::move(*outcome.leaf);
  }
  BakedCell cell;
  cell.level = static_cast<std::uint8_t>(place.level);
  for (std::uint32_t i = 0; i < 8; ++i) {
    const CellTask child{place.child(i), outcome.search_distance, outcome.seen};
    cell.children.push_back(bakeBelow(baker, scene, child.cell, decide(baker, scene, child)));
  }
  mergeChildren(scene, cell);
  return cell;
}

namespace {

void add(const Runs& more, Runs& runs) {
  Runs both;
  unite(runs, more, both);
  runs.swap(both);
}

// A child without viewers holds all objects, but nobody asks it. It does not count for the cell that the
// children become, where that says which part of it holds viewers.
using Counts = std::array<bool, 8>;

Counts countsOf(const BakeScene& scene, std::span<const BakedCell> children) {
  Counts counts{};
  for (std::size_t i = 0; i < children.size(); ++i) {
    counts[i] = scene.settings.whole_cells || children[i].reason != StopReason::kOutside;
  }
  return counts;
}

// The set of one cell or of a side of it.
struct SeenOf {
  const Runs& seen;
  const DoorRuns& doors;
};

// What doors hide from all of these cells of what is seen from any of them, `seen`.
DoorRuns hiddenFromAll(std::span<const SeenOf> cells, const Runs& seen) {
  std::set<std::uint32_t> groups;
  for (const SeenOf& cell : cells) {
    for (const HiddenByDoors& doors : cell.doors) {
      groups.insert(doors.group);
    }
  }
  DoorRuns all;
  Runs left, of_cell;
  for (const std::uint32_t group : groups) {
    left.clear();
    for (const SeenOf& cell : cells) {
      const auto found =
          std::ranges::find_if(cell.doors, [group](const auto& doors) { return doors.group == group; });
      subtract(cell.seen, found == cell.doors.end() ? Runs() : found->hidden, of_cell);
      add(of_cell, left);
    }
    HiddenByDoors doors{.group = group};
    subtract(seen, left, doors.hidden);
    if (!doors.hidden.empty()) {
      all.push_back(std::move(doors));
    }
  }
  return all;
}

// The union of the sets of the cells that count, or nothing if the cells are not all leaves or have different
// planes.
std::optional<CellSets> togetherOf(std::span<const BakedCell> cells, const Counts& counts) {
  CellSets all;
  for (const BakedCell& cell : cells) {
    if (!cell.leaf() || (cell.sets.plane && all.plane && *cell.sets.plane != *all.plane)) {
      return std::nullopt;
    }
    all.plane = cell.sets.plane ? cell.sets.plane : all.plane;
  }
  std::vector<SeenOf> whole, front, back;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!counts[i]) {
      continue;
    }
    const CellSets& sets = cells[i].sets;
    const SeenOf anywhere{sets.whole, sets.whole_doors};
    whole.push_back(anywhere);
    front.push_back(sets.plane ? SeenOf{sets.front, sets.front_doors} : anywhere);
    back.push_back(sets.plane ? SeenOf{sets.back, sets.back_doors} : anywhere);
  }
  const auto uniteAll = [](std::span<const SeenOf> parts, Runs& seen, DoorRuns& doors) {
    for (const SeenOf& part : parts) {
      add(part.seen, seen);
    }
    doors = hiddenFromAll(parts, seen);
  };
  uniteAll(whole, all.whole, all.whole_doors);
  if (all.plane) {
    uniteAll(front, all.front, all.front_doors);
    uniteAll(back, all.back, all.back_doors);
  }
  return all;
}

// A box of steps of a cell's children.
struct StepBox {
  std::array<std::uint32_t, 3> begin{}, end{};

  std::uint64_t volume() const {
    return std::uint64_t{end[0] - begin[0]} * (end[1] - begin[1]) * (end[2] - begin[2]);
  }
};

// The viewers of a child as seen from the cell, whose children have twice as many steps along an axis.
StepBox stepsOf(const ViewerBounds& viewers, std::uint32_t child) {
  StepBox box;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    const std::uint32_t from = (child >> axis & 1) << kViewerLevels;
    box.begin[axis] = from + viewers.first[axis];
    box.end[axis] = from + viewers.last[axis] + 1;
  }
  return box;
}

// The box around the viewers of all children that count; nothing if none does.
std::optional<StepBox> stepsAround(std::span<const BakedCell> children, const Counts& counts) {
  std::optional<StepBox> around;
  for (std::uint32_t i = 0; i < children.size(); ++i) {
    if (!counts[i]) {
      continue;
    }
    const StepBox box = stepsOf(children[i].viewers, i);
    around = around.value_or(box);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      around->begin[axis] = std::min(around->begin[axis], box.begin[axis]);
      around->end[axis] = std::max(around->end[axis], box.end[axis]);
    }
  }
  return around;
}

// The least viewers of the cell that hold the box.
ViewerBounds boundsOf(const StepBox& box) {
  ViewerBounds viewers;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    viewers.first[axis] = static_cast<std::uint8_t>(box.begin[axis] / 2);
    viewers.last[axis] = static_cast<std::uint8_t>((box.end[axis] - 1) / 2);
  }
  return viewers;
}

// The viewers of all children that count, if their boxes fill a box of whole steps of the cell. No two of
// them overlap, so they do if their volumes add up to that of the box around them.
std::optional<ViewerBounds> viewersOfAll(std::span<const BakedCell> children, const Counts& counts) {
  const std::optional<StepBox> around = stepsAround(children, counts);
  if (!around) {
    return std::nullopt;
  }
  std::uint64_t volume = 0;
  for (std::uint32_t i = 0; i < children.size(); ++i) {
    volume += counts[i] ? stepsOf(children[i].viewers, i).volume() : 0;
  }
  bool whole_steps = true;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    whole_steps = whole_steps && around->begin[axis] % 2 == 0 && around->end[axis] % 2 == 0;
  }
  return whole_steps && volume == around->volume() ? std::optional(boundsOf(*around)) : std::nullopt;
}

}  // namespace

std::optional<BakedCell> joined(const BakeScene& scene, std::span<const BakedCell> children) {
  const Counts counts = countsOf(scene, children);
  std::optional<CellSets> all = togetherOf(children, counts);
  const std::optional<ViewerBounds> viewers = viewersOfAll(children, counts);
  if (!all || !viewers) {
    return std::nullopt;
  }
  BakedCell cell;
  cell.sets = std::move(*all);
  cell.viewers = *viewers;
  cell.reason = StopReason::kMerged;
  cell.level = static_cast<std::uint8_t>(children[0].level - 1);
  return cell;
}

BakedCell allObjectsIn(const BakeScene& scene, std::span<const BakedCell> children) {
  BakedCell cell;
  cell.sets.whole = {{0, static_cast<std::uint32_t>(scene.boxes.objects.size())}};
  cell.reason = StopReason::kMerged;
  cell.level = static_cast<std::uint8_t>(children[0].level - 1);
  if (const std::optional<StepBox> around = stepsAround(children, countsOf(scene, children))) {
    cell.viewers = boundsOf(*around);
  }
  return cell;
}

namespace {

// Triangles of a set without what doors of a group hide.
std::uint64_t leftBy(const BakeScene& scene, std::uint32_t group, const Runs& seen, const DoorRuns& doors) {
  const auto found = std::ranges::find_if(doors, [group](const auto& d) { return d.group == group; });
  return scene.triangles.of(seen) - (found == doors.end() ? 0 : scene.triangles.of(found->hidden));
}

// trianglesOf() while the doors of a group are closed.
std::uint64_t trianglesBehind(const BakeScene& scene, std::uint32_t group, const CellSets& sets) {
  return sets.plane ? std::max(leftBy(scene, group, sets.front, sets.front_doors),
                               leftBy(scene, group, sets.back, sets.back_doors))
                    : leftBy(scene, group, sets.whole, sets.whole_doors);
}

// Numbers of triangles: of the cell that children become together, and the fewest of any child.
struct MergedTriangles {
  std::uint64_t together = 0, fewest = ~std::uint64_t{0};

  // True if they are alike as far as merging tolerates differences.
  bool alike(const BakeScene& scene) const {
    return static_cast<double>(together) <=
           (1.0 + scene.settings.merge_tolerance) * static_cast<double>(fewest);
  }
};

}  // namespace

void mergeChildren(const BakeScene& scene, BakedCell& cell) {
  std::optional<BakedCell> one = cell.leaf() ? std::nullopt : joined(scene, cell.children);
  if (!one) {
    return;
  }
  const Counts counts = countsOf(scene, cell.children);
  const auto countBy = [&](const auto& triangles) {
    MergedTriangles merged{.together = triangles(one->sets)};
    for (std::size_t i = 0; i < cell.children.size(); ++i) {
      if (counts[i]) {
        merged.fewest = std::min(merged.fewest, triangles(cell.children[i].sets));
      }
    }
    return merged;
  };
  const MergedTriangles open = countBy([&](const CellSets& sets) { return trianglesOf(scene, sets); });
  const std::uint64_t budget = scene.settings.triangle_budget;
  bool good = open.alike(scene) && (open.together <= budget || open.fewest > budget);
  for (std::uint32_t group = 0; group < scene.doors.groups.size() && good; ++group) {
    good = countBy([&](const CellSets& sets) { return trianglesBehind(scene, group, sets); }).alike(scene);
  }
  if (good) {
    cell = std::move(*one);
  }
}

namespace {

// First byte of an encoded cell. kPartly is added to that of a leaf with viewers in a part of its cell only,
// and kDoors to that of a leaf of which doors hide something.
constexpr std::uint8_t kInner = 0, kLeaf = 1, kLeafWithPlane = 2, kPartly = 4, kDoors = 8;

void addDoors(const DoorRuns& doors, base::ByteWriter& bytes) {
  bytes.add(static_cast<std::uint32_t>(doors.size()));
  for (const HiddenByDoors& hidden : doors) {
    bytes.add(hidden.group);
    addRuns(hidden.hidden, bytes);
  }
}

// False if the bytes are not what doors of the scene hide, by ascending group.
bool readDoors(base::ByteReader& bytes, const BakeScene& scene, DoorRuns& doors) {
  const auto object_count = static_cast<std::uint32_t>(scene.boxes.objects.size());
  constexpr std::size_t kLeastBytes =
      sizeof(std::uint32_t) + 3;  // a group, the number of its runs, and one run
  doors.resize(bytes.readCount<std::uint32_t>(kLeastBytes));
  for (std::size_t i = 0; i < doors.size(); ++i) {
    doors[i].group = bytes.read<std::uint32_t>();
    if ((i > 0 && doors[i].group <= doors[i - 1].group) || doors[i].group >= scene.doors.groups.size() ||
        !readRuns(bytes, object_count, doors[i].hidden) || doors[i].hidden.empty()) {
      return false;
    }
  }
  return bytes.ok();
}

}  // namespace

void write(const BakedCell& cell, base::ByteWriter& bytes) {
  if (!cell.leaf()) {
    bytes.add(kInner);
    for (const BakedCell& child : cell.children) {
      write(child, bytes);
    }
    return;
  }
  const CellSets& sets = cell.sets;
  const bool partly = cell.viewers != ViewerBounds{};
  const bool doors = !sets.whole_doors.empty() || !sets.front_doors.empty() || !sets.back_doors.empty();
  bytes.add(static_cast<std::uint8_t>((sets.plane ? kLeafWithPlane : kLeaf) + (partly ? kPartly : 0) +
                                      (doors ? kDoors : 0)));
  bytes.add(static_cast<std::uint8_t>(cell.reason));
  if (partly) {
    bytes.addAll(std::span<const std::uint8_t>(cell.viewers.first));
    bytes.addAll(std::span<const std::uint8_t>(cell.viewers.last));
  }
  addRuns(sets.whole, bytes);
  if (const std::optional<CellPlane>& plane = sets.plane) {
    for (const double number :
         {plane->normal.x, plane->normal.y, plane->normal.z, plane->front, plane->back}) {
      bytes.add(number);
    }
    addRuns(sets.front, bytes);
    addRuns(sets.back, bytes);
  }
  if (doors) {
    addDoors(sets.whole_doors, bytes);
    addDoors(sets.front_doors, bytes);
    addDoors(sets.back_doors, bytes);
  }
}

namespace {

// False if the bytes are not the viewers of a cell.
bool readViewers(base::ByteReader& bytes, ViewerBounds& viewers) {
  for (std::uint8_t& step : viewers.first) {
    step = bytes.read<std::uint8_t>();
  }
  for (std::uint8_t& step : viewers.last) {
    step = bytes.read<std::uint8_t>();
  }
  return std::ranges::equal(viewers.first, viewers.last, std::less_equal<>());
}

}  // namespace

std::optional<BakedCell> readCell(base::ByteReader& bytes, std::uint32_t level, const BakeScene& scene) {
  const auto object_count = static_cast<std::uint32_t>(scene.boxes.objects.size());
  BakedCell cell;
  cell.level = static_cast<std::uint8_t>(level);
  const auto first = bytes.read<std::uint8_t>();
  const bool partly = (first & kPartly) != 0, doors = (first & kDoors) != 0;
  const int kind = first & ~(kPartly | kDoors);
  if (!bytes.ok() || kind > kLeafWithPlane || (kind == kInner && first != kInner) ||
      level > kMaxOctreeDepth) {
    return std::nullopt;
  }
  if (kind == kInner) {
    for (std::uint32_t i = 0; i < 8; ++i) {
      std::optional<BakedCell> child = readCell(bytes, level + 1, scene);
      if (!child) {
        return std::nullopt;
      }
      cell.children.push_back(std::move(*child));
    }
    return cell;
  }
  const auto reason = bytes.read<std::uint8_t>();
  cell.reason = static_cast<StopReason>(reason);
  bool good = reason < kStopReasons && (!partly || readViewers(bytes, cell.viewers)) &&
              readRuns(bytes, object_count, cell.sets.whole);
  if (good && kind == kLeafWithPlane) {
    CellPlane plane;
    for (double* number : {&plane.normal.x, &plane.normal.y, &plane.normal.z, &plane.front, &plane.back}) {
      *number = bytes.read<double>();
    }
    cell.sets.plane = plane;
    good = readRuns(bytes, object_count, cell.sets.front) && readRuns(bytes, object_count, cell.sets.back);
  }
  if (good && doors) {
    CellSets& sets = cell.sets;
    for (DoorRuns* part : {&sets.whole_doors, &sets.front_doors, &sets.back_doors}) {
      good = good && readDoors(bytes, scene, *part);
    }
  }
  return good && bytes.ok() ? std::optional(std::move(cell)) : std::nullopt;
}

}  // namespace sightline::pvs
