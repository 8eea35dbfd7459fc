#include "src/pvs/bake/update/recall.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <map>
#include <optional>
#include <unordered_map>
#include <utility>

#include "src/pvs/bake/box_search.h"

namespace sightline::pvs {
namespace {

// The shaft of a question holds boxes that are wider by 2^-18 of the coordinates (fused_occlusion.cpp).
// Those that are compared with what has changed are wider than that.
constexpr double kComparedWidening = 0x1p-15;

CellBox wider(const CellBox& box, double by) {
  return {box.min - Vec3d{by, by, by}, box.max + Vec3d{by, by, by}};
}

}  // namespace

Recall::Recall(EarlierBake earlier, const BakeScene& scene, const SceneMarks& marks)
    : earlier_(std::move(earlier)), magnitude_(scene.magnitude), slack_(scene.panels.slack) {
  for (const Vec3d& vertex : scene.panels.vertices) {
    magnitude_ = std::max(magnitude_, maxComponent(abs(vertex)));
  }
  magnitude_ *= 1.0 + 4.0 * kComparedWidening;
  matchObjects(marks);
  matchNodes(scene);
  comparePanels(marks);
}

void Recall::matchObjects(const SceneMarks& marks) {
  const std::vector<ObjectMark>& old = earlier_.marks.objects;
  before_.assign(marks.objects.size(), kNone);
  now_.assign(old.size(), kNone);
  std::unordered_map<std::uint64_t, std::uint32_t> places;
  for (std::uint32_t i = 0; i < old.size(); ++i) {
    places.emplace(old[i].content, i);
  }
  for (std::uint32_t i = 0; i < marks.objects.size(); ++i) {
    const auto place = places.find(marks.objects[i].content);
    if (place != places.end() && old[place->second].bounds == marks.objects[i].bounds &&
        now_[place->second] == kNone) {
      before_[i] = place->second;
      now_[place->second] = i;
    }
  }
  const auto addChanged = [this](std::span<const ObjectMark> objects, std::span<const std::uint32_t> other,
                                 std::uint64_t& triangles, std::uint32_t& count) {
    for (std::size_t i = 0; i < objects.size(); ++i) {
      if (other[i] == kNone) {
        triangles += objects[i].triangles;
        count += 1;
        if (objects[i].occludes) {
          changed_occluders_.push_back(objects[i].bounds);
        }
      }
    }
  };
  addChanged(old, now_, triangles_gone_, objects_gone_);
  addChanged(marks.objects, before_, triangles_come_, objects_come_);
}

void Recall::matchNodes(const BakeScene& scene) {
  const std::vector<BoxNode>& old = earlier_.marks.nodes;
  const auto keyOf = [](const Box& box) {
    return std::array<float, 6>{box.min.x, box.min.y, box.min.z, box.max.x, box.max.y, box.max.z};
  };
  std::map<std::array<float, 6>, std::uint32_t> inner;  // the first of those with equal boxes
  std::vector<std::uint32_t> leaf_of(earlier_.marks.objects.size(), kNone);
  for (std::uint32_t n = 0; n < old.size(); ++n) {
    if (old[n].end == n + 1) {
      leaf_of[old[n].first_object] = n;
    } else if (old[n].bounds.wellFormed()) {
      inner.emplace(keyOf(old[n].bounds), n);
    }
  }
  const BoxTreeView boxes = scene.boxes.view();
  node_before_.assign(boxes.nodes.size(), kNone);
  for (std::uint32_t n = 0; n < boxes.nodes.size(); ++n) {
    if (boxes.leaf(n)) {
      const std::uint32_t before = before_[boxes.nodes[n].first_object];
      node_before_[n] = before == kNone ? kNone : leaf_of[before];
    } else if (boxes.nodes[n].bounds.wellFormed()) {
      const auto same = inner.find(keyOf(boxes.nodes[n].bounds));
      node_before_[n] = same == inner.end() ? kNone : same->second;
    }
  }
}

void Recall::comparePanels(const SceneMarks& marks) {
  std::vector<PanelMark> changed;
  std::set_symmetric_difference(earlier_.marks.panels.begin(), earlier_.marks.panels.end(),
                                marks.panels.begin(), marks.panels.end(), std::back_inserter(changed),
                                before);
  std::vector<Box> bounds;
  for (const PanelMark& panel : changed) {
    bounds.push_back(panel.bounds);
  }
  changed_panels_ = buildBoxTree(bounds, {});
}

bool Recall::panelsDiffer(const CellBox& region, const Box& box) const {
  if (changed_panels_.nodes.empty()) {
    return false;
  }
  const double by = kComparedWidening * magnitude_;
  const CellBox target{Vec3d(box.min), Vec3d(box.max)};
  const Shaft shaft(wider(region, by), wider(target, by), magnitude_, slack_);
  return anyLeaf(
      changed_panels_.view(), [&](const Box& bounds) { return shaft.misses(bounds); },
      [](const BoxNode&) { return true; });
}

bool Recall::panelsDiffer(const Box& box) const {
  const CellBox wide = wider({Vec3d(box.min), Vec3d(box.max)}, kComparedWidening * magnitude_);
  return anyLeaf(
      changed_panels_.view(), [&](const Box& bounds) { return !intersects(wide, bounds); },
      [](const BoxNode&) { return true; });
}

std::uint64_t Recall::partOf(std::uint64_t cell) const {
  while (cell != 0 && !earlier_.parts.contains(cell)) {
    cell >>= 3;
  }
  return cell;
}

const Answer* RecalledAnswers::find(std::uint64_t cell, AnswerKind kind, std::uint64_t question) {
  const std::uint64_t part = recall_.partOf(cell);
  if (part != part_) {
    part_ = part;
    const EarlierBake& earlier = recall_.earlier();
    std::optional<CellAnswers> decoded;
    if (part != 0) {
      decoded =
          decodeAnswers(earlier.parts.at(part), static_cast<std::uint32_t>(earlier.marks.objects.size()),
                        static_cast<std::uint32_t>(earlier.marks.nodes.size()));
    }
    answers_ = decoded ? std::move(*decoded) : CellAnswers();
  }
  const auto of_cell = answers_.find(cell);
  if (of_cell == answers_.end()) {
    return nullptr;
  }
  const auto answer = std::find_if(of_cell->second.begin(), of_cell->second.end(),
                                   [&](const Answer& a) { return a.kind == kind && a.question == question; });
  return answer == of_cell->second.end() ? nullptr : &*answer;
}

}  // namespace sightline::pvs
