// Based on: Saona-Vazquez, Navazo, Brunet. The Visibility Octree. Computers & Graphics 1999, section 3.2.
// Differs from the paper in: cells at the maximum depth also enlarge their search boxes before they give up.

#include "src/pvs/bake/cell_tree.h"

#include <algorithm>
#include <set>
#include <utility>

namespace sightline::pvs {
namespace {

BakedCell leafOf(const OctreeCell& cell, CellSets&& sets, StopReason reason) {
  BakedCell leaf;
  leaf.sets = std::move(sets);
  leaf.reason = reason;
  leaf.level = static_cast<std::uint8_t>(cell.level);
  return leaf;
}

// What decide() does while all doors are open.
CellOutcome decideOpen(CellBaker& baker, const BakeScene& scene, const CellTask& task) {
  const BakeSettings& settings = scene.settings;
  const bool deepest = !scene.mayDivide(task.cell);
  double distance = task.search_distance;
  if (!scene.holdsViewers(scene.boxOf(task.cell))) {
    CellSets everything;
    everything.whole = {{0, static_cast<std::uint32_t>(scene.boxes.objects.size())}};
    return {.leaf = leafOf(task.cell, std::move(everything), StopReason::kOutside)};
  }
  CellSets sets = baker.seenFrom(task.cell, distance, task.seen);
  for (;;) {
    const std::uint64_t triangles = trianglesOf(scene, sets);
    if (triangles <= settings.triangle_budget) {
      return {.leaf = leafOf(task.cell, std::move(sets), StopReason::kBudgetMet),
              .search_distance = distance};
    }
    if (!deepest &&
        (baker.tooLargeForItsOccluders(task.cell) || baker.dividingHelps(task.cell, distance, sets))) {
      baker.forgetSides();
      return {.search_distance = distance, .seen = std::move(sets.whole)};
    }
    bool gained = false;
    if (!baker.searchedAll(task.cell, distance)) {
      baker.lookFarther(task.cell, distance, 2.0 * distance, sets);
      distance *= 2.0;
      const double less = static_cast<double>(triangles) - static_cast<double>(trianglesOf(scene, sets));
      gained = less > 0.0 && less >= settings.min_gain * static_cast<double>(triangles);
    }
    if (!gained) {
      const StopReason reason = deepest ? StopReason::kMaxDepth : StopReason::kNothingGained;
      return {.leaf = leafOf(task.cell, std::move(sets), reason), .search_distance = distance};
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

BakedCell bakeCell(CellBaker& baker, const BakeScene& scene, const CellTask& task) {
  CellOutcome outcome = decide(baker, scene, task);
  baker.forgetOldest();
  if (outcome.leaf) {
    return std::move(*outcome.leaf);
  }
  BakedCell cell;
  cell.level = static_cast<std::uint8_t>(task.cell.level);
  for (std::uint32_t i = 0; i < 8; ++i) {
    cell.children.push_back(
        bakeCell(baker, scene, {task.cell.child(i), outcome.search_distance, outcome.seen}));
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

// The union of the cells' sets, or nothing if they are not all leaves or have different planes.
std::optional<CellSets> togetherOf(std::span<const BakedCell> cells) {
  CellSets all;
  for (const BakedCell& cell : cells) {
    if (!cell.leaf() || (cell.sets.plane && all.plane && *cell.sets.plane != *all.plane)) {
      return std::nullopt;
    }
    all.plane = cell.sets.plane ? cell.sets.plane : all.plane;
  }
  std::vector<SeenOf> whole, front, back;
  for (const BakedCell& cell : cells) {
    const CellSets& sets = cell.sets;
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

}  // namespace

void mergeChildren(const BakeScene& scene, BakedCell& cell) {
  std::optional<CellSets> all = cell.leaf() ? std::nullopt : togetherOf(cell.children);
  if (!all) {
    return;
  }
  std::uint64_t fewest = ~std::uint64_t{0};
  for (const BakedCell& child : cell.children) {
    fewest = std::min(fewest, trianglesOf(scene, child.sets));
  }
  const std::uint64_t together = trianglesOf(scene, *all);
  const bool alike =
      static_cast<double>(together) <= (1.0 + scene.settings.merge_tolerance) * static_cast<double>(fewest);
  const std::uint64_t budget = scene.settings.triangle_budget;
  if (alike && (together <= budget || fewest > budget)) {
    cell.children.clear();
    cell.sets = std::move(*all);
    cell.reason = StopReason::kMerged;
  }
}

void write(const Runs& runs, base::ByteWriter& bytes) {
  bytes.add(static_cast<std::uint32_t>(runs.size()));
  for (const ObjectRun& run : runs) {
    bytes.add(run.begin);
    bytes.add(run.end);
  }
}

bool read(base::ByteReader& bytes, std::uint32_t object_count, Runs& runs) {
  std::uint32_t after = 0;
  runs.resize(bytes.readCount<std::uint32_t>(2 * sizeof(std::uint32_t)));
  for (ObjectRun& run : runs) {
    run.begin = bytes.read<std::uint32_t>();
    run.end = bytes.read<std::uint32_t>();
    if (run.begin < after || run.end <= run.begin || run.end > object_count) {
      return false;
    }
    after = run.end + 1;
  }
  return bytes.ok();
}

namespace {

// First byte of an encoded cell. To that of a leaf of which doors hide something, kDoors is added.
constexpr std::uint8_t kInner = 0, kLeaf = 1, kLeafWithPlane = 2, kDoors = 4;

void write(const DoorRuns& doors, base::ByteWriter& bytes) {
  bytes.add(static_cast<std::uint32_t>(doors.size()));
  for (const HiddenByDoors& hidden : doors) {
    bytes.add(hidden.group);
    write(hidden.hidden, bytes);
  }
}

// False if the bytes are not what doors of the scene hide, by ascending group.
bool read(base::ByteReader& bytes, const BakeScene& scene, DoorRuns& doors) {
  const auto object_count = static_cast<std::uint32_t>(scene.boxes.objects.size());
  doors.resize(bytes.readCount<std::uint32_t>(2 * sizeof(std::uint32_t)));
  for (std::size_t i = 0; i < doors.size(); ++i) {
    doors[i].group = bytes.read<std::uint32_t>();
    if ((i > 0 && doors[i].group <= doors[i - 1].group) || doors[i].group >= scene.doors.groups.size() ||
        !read(bytes, object_count, doors[i].hidden)) {
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
  const bool doors = !sets.whole_doors.empty() || !sets.front_doors.empty() || !sets.back_doors.empty();
  const std::uint8_t kind = sets.plane ? kLeafWithPlane : kLeaf;
  bytes.add(doors ? static_cast<std::uint8_t>(kind + kDoors) : kind);
  bytes.add(static_cast<std::uint8_t>(cell.reason));
  write(cell.sets.whole, bytes);
  if (const std::optional<CellPlane>& plane = cell.sets.plane) {
    for (const double number :
         {plane->normal.x, plane->normal.y, plane->normal.z, plane->front, plane->back}) {
      bytes.add(number);
    }
    write(cell.sets.front, bytes);
    write(cell.sets.back, bytes);
  }
  if (doors) {
    write(sets.whole_doors, bytes);
    write(sets.front_doors, bytes);
    write(sets.back_doors, bytes);
  }
}

std::optional<BakedCell> readCell(base::ByteReader& bytes, std::uint32_t level, const BakeScene& scene) {
  const auto object_count = static_cast<std::uint32_t>(scene.boxes.objects.size());
  BakedCell cell;
  cell.level = static_cast<std::uint8_t>(level);
  const auto first = bytes.read<std::uint8_t>();
  const bool doors = first > kDoors;
  const auto kind = static_cast<std::uint8_t>(doors ? first - kDoors : first);
  if (!bytes.ok() || kind > kLeafWithPlane || level > kMaxOctreeDepth) {
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
  bool good = reason < kStopReasons && read(bytes, object_count, cell.sets.whole);
  if (good && kind == kLeafWithPlane) {
    CellPlane plane;
    for (double* number : {&plane.normal.x, &plane.normal.y, &plane.normal.z, &plane.front, &plane.back}) {
      *number = bytes.read<double>();
    }
    cell.sets.plane = plane;
    good = read(bytes, object_count, cell.sets.front) && read(bytes, object_count, cell.sets.back);
  }
  if (good && doors) {
    CellSets& sets = cell.sets;
    for (DoorRuns* part : {&sets.whole_doors, &sets.front_doors, &sets.back_doors}) {
      good = good && read(bytes, scene, *part);
    }
  }
  return good && bytes.ok() ? std::optional(std::move(cell)) : std::nullopt;
}

}  // namespace sightline::pvs
