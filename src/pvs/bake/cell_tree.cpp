// Based on: Saona-Vazquez, Navazo, Brunet. The Visibility Octree. Computers & Graphics 1999, section 3.2.
// Differs from the paper in: cells at the maximum depth also enlarge their search boxes before they give up.

#include "src/pvs/bake/cell_tree.h"

#include <algorithm>
#include <utility>

#include "src/pvs/bake/run_code.h"

namespace sightline::pvs {
namespace {

BakedCell leafOf(const OctreeCell& cell, CellSets&& sets, StopReason reason) {
  BakedCell leaf;
  leaf.sets = std::move(sets);
  leaf.reason = reason;
  leaf.level = static_cast<std::uint8_t>(cell.level);
  return leaf;
}

}  // namespace

CellOutcome decide(CellBaker& baker, const BakeScene& scene, const CellTask& task) {
  const BakeSettings& settings = scene.settings;
  const bool deepest = !scene.mayDivide(task.cell);
  const std::uint64_t work_before = baker.work();
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
      return {.leaf = leafOf(task.cell, std::move(sets), StopReason::kBudgetMet)};
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
      const StopReason reason = deepest ? StopReason::kMaxDepth : StopReason::kNothingGained;
      return {.leaf = leafOf(task.cell, std::move(sets), reason)};
    }
  }
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

// The union of the cells' sets, or nothing if they are not all leaves or have different planes.
std::optional<CellSets> togetherOf(std::span<const BakedCell> cells) {
  CellSets all;
  for (const BakedCell& cell : cells) {
    if (!cell.leaf() || (cell.sets.plane && all.plane && *cell.sets.plane != *all.plane)) {
      return std::nullopt;
    }
    all.plane = cell.sets.plane ? cell.sets.plane : all.plane;
  }
  for (const BakedCell& cell : cells) {
    add(cell.sets.whole, all.whole);
    if (all.plane) {
      add(cell.sets.plane ? cell.sets.front : cell.sets.whole, all.front);
      add(cell.sets.plane ? cell.sets.back : cell.sets.whole, all.back);
    }
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

namespace {

// First byte of an encoded cell.
constexpr std::uint8_t kInner = 0, kLeaf = 1, kLeafWithPlane = 2;

}  // namespace

void write(const BakedCell& cell, base::ByteWriter& bytes) {
  if (!cell.leaf()) {
    bytes.add(kInner);
    for (const BakedCell& child : cell.children) {
      write(child, bytes);
    }
    return;
  }
  bytes.add(cell.sets.plane ? kLeafWithPlane : kLeaf);
  bytes.add(static_cast<std::uint8_t>(cell.reason));
  addRuns(cell.sets.whole, bytes);
  if (const std::optional<CellPlane>& plane = cell.sets.plane) {
    for (const double number :
         {plane->normal.x, plane->normal.y, plane->normal.z, plane->front, plane->back}) {
      bytes.add(number);
    }
    addRuns(cell.sets.front, bytes);
    addRuns(cell.sets.back, bytes);
  }
}

std::optional<BakedCell> readCell(base::ByteReader& bytes, std::uint32_t level, std::uint32_t object_count) {
  BakedCell cell;
  cell.level = static_cast<std::uint8_t>(level);
  const auto kind = bytes.read<std::uint8_t>();
  if (!bytes.ok() || kind > kLeafWithPlane || level > kMaxOctreeDepth) {
    return std::nullopt;
  }
  if (kind == kInner) {
    for (std::uint32_t i = 0; i < 8; ++i) {
      std::optional<BakedCell> child = readCell(bytes, level + 1, object_count);
      if (!child) {
        return std::nullopt;
      }
      cell.children.push_back(std::move(*child));
    }
    return cell;
  }
  const auto reason = bytes.read<std::uint8_t>();
  cell.reason = static_cast<StopReason>(reason);
  bool good = reason < kStopReasons && readRuns(bytes, object_count, cell.sets.whole);
  if (good && kind == kLeafWithPlane) {
    CellPlane plane;
    for (double* number : {&plane.normal.x, &plane.normal.y, &plane.normal.z, &plane.front, &plane.back}) {
      *number = bytes.read<double>();
    }
    cell.sets.plane = plane;
    good = readRuns(bytes, object_count, cell.sets.front) && readRuns(bytes, object_count, cell.sets.back);
  }
  return good && bytes.ok() ? std::optional(std::move(cell)) : std::nullopt;
}

}  // namespace sightline::pvs
