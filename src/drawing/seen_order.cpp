#include "src/drawing/seen_order.h"

#include <algorithm>

#include "src/drawing/clipper_paths.h"
#include "src/drawing/sliver.h"

namespace sightline::drawing {
namespace {

constexpr std::size_t kMaxInFront = 16;  // outlines that are taken away from an object's image, at most

// Leaves what lies on the page; all of it if Clipper fails.
void cutToPage(const GridPath& page, ClipperLib::Paths& left) {
  ClipperLib::Paths result;
  const bool is_cut = clipSafely([&] {
    ClipperLib::Clipper clipper;
    clipper.AddPaths(left, ClipperLib::ptSubject, true);
    clipper.AddPath(clipperPath(page), ClipperLib::ptClip, true);
    return clipper.Execute(ClipperLib::ctIntersection, result, ClipperLib::pftNonZero,
                           ClipperLib::pftNonZero);
  });
  if (is_cut) {
    left = std::move(result);
  }
}

// Takes an outline away from what is left of an image. Nothing changes if Clipper fails.
// drop_slivers: rings that are slivers, as outlines leave out, do not count.
void takeAway(const std::vector<GridPath>& outline, bool drop_slivers, ClipperLib::Paths& left) {
  ClipperLib::Paths result;
  const bool is_taken = clipSafely([&] {
    ClipperLib::Clipper clipper;
    clipper.AddPaths(left, ClipperLib::ptSubject, true);
    for (const GridPath& ring : outline) {
      clipper.AddPath(clipperPath(ring), ClipperLib::ptClip, true);
    }
    return clipper.Execute(ClipperLib::ctDifference, result, ClipperLib::pftNonZero, ClipperLib::pftEvenOdd);
  });
  if (!is_taken) {
    return;
  }
  left = std::move(result);
  if (drop_slivers) {
    std::erase_if(left,
                  [](const ClipperLib::Path& ring) { return isSliver(gridPath(ring), Outliner::kMinWidth); });
  }
}

}  // namespace

SeenOrder::GridBox SeenOrder::boxOf(const GridPath& path) {
  GridBox box;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const GridPoint& p = path[i];
    box.low = i == 0 ? p : GridPoint{std::min(box.low.x, p.x), std::min(box.low.y, p.y)};
    box.high = i == 0 ? p : GridPoint{std::max(box.high.x, p.x), std::max(box.high.y, p.y)};
  }
  return box;
}

// Boxes that touch within a grid line overlap, so that rounding to the grid parts nothing.
bool SeenOrder::overlap(const GridBox& a, const GridBox& b) {
  return a.low.x <= b.high.x + 1 && b.low.x <= a.high.x + 1 && a.low.y <= b.high.y + 1 &&
         b.low.y <= a.high.y + 1;
}

// The objects whose hulls are in front of this one's and not behind it, those with the largest images first.
std::vector<ObjectId> SeenOrder::certainlyInFront(ObjectId object, const LayerOrder& order) const {
  std::vector<std::pair<double, ObjectId>> ranked;
  const GridBox& own = boxes_[object.value];
  for (const ObjectId front : fronts_[object.value]) {
    const LayerArc back_arc{PartId(object.value), PartId(front.value)};
    const GridBox& box = boxes_[front.value];
    if (overlap(own, box) && !std::binary_search(order.arcs.begin(), order.arcs.end(), back_arc)) {
      const auto width =
          static_cast<double>(std::min(own.high.x, box.high.x) - std::max(own.low.x, box.low.x));
      const auto height =
          static_cast<double>(std::min(own.high.y, box.high.y) - std::max(own.low.y, box.low.y));
      ranked.emplace_back(-width * height, front);
    }
  }
  std::sort(ranked.begin(), ranked.end());
  ranked.resize(std::min(ranked.size(), kMaxInFront));
  std::vector<ObjectId> fronts;
  for (const auto& [rank, front] : ranked) {
    fronts.push_back(front);
  }
  return fronts;
}

std::vector<SeenOrder::GridBox> SeenOrder::seenBoxes(ObjectId object, const Outliner& outliner,
                                                     const LayerOrder& order,
                                                     const OutlineOf& outline_of) const {
  const GridPath& image = images_[object.value];
  // An image without area, as of a pane seen edge on, is not clipped.
  if (image.size() < 3) {
    return {boxes_[object.value]};
  }
  ClipperLib::Paths left{clipperPath(image)};
  // The whole image of a thin wire is a sliver, and its strokes are seen all the same.
  const bool drop_slivers = !isSliver(image, Outliner::kMinWidth);
  cutToPage(outliner.page(), left);
  for (const ObjectId front : certainlyInFront(object, order)) {
    const std::vector<GridPath>& outline = outline_of(front);
    if (!outline.empty()) {
      takeAway(outline, drop_slivers, left);
    }
    if (left.empty()) {
      break;
    }
  }
  std::vector<GridBox> boxes;
  for (const ClipperLib::Path& path : left) {
    boxes.push_back(boxOf(gridPath(path)));
  }
  return boxes;
}

// Within its group an object needs the arcs to what its seen pieces may hide.
void SeenOrder::addArcsOf(ObjectId front, const Outliner& outliner, const LayerOrder& order,
                          const OutlineOf& outline_of) {
  const std::vector<GridBox> seen = seenBoxes(front, outliner, order, outline_of);
  for (const ObjectId back : backs_[front.value]) {
    const bool may_hide = std::any_of(seen.begin(), seen.end(),
                                      [&](const GridBox& box) { return overlap(box, boxes_[back.value]); });
    if (may_hide) {
      arcs_.push_back({PartId(front.value), PartId(back.value)});
    }
  }
}

const LayerOrder& SeenOrder::sort(const SceneView& scene, const Outliner& outliner, const LayerOrder& order,
                                  const OutlineOf& outline_of) {
  const std::size_t objects = scene.objects.size();
  group_of_.assign(objects, 0);
  bool any_group = false;
  for (std::uint32_t i = order.first_sorted; i < order.sorted_end; ++i) {
    any_group = any_group || order.group(i).size() > 1;
    for (const PartId part : order.group(i)) {
      if (part.value < objects) {
        group_of_[part.value] = i;
      }
    }
  }
  if (!any_group) {
    return order;
  }
  arcs_.clear();
  fronts_.assign(objects, {});
  backs_.assign(objects, {});
  for (const LayerArc& arc : order.arcs) {
    if (arc.front.value >= objects || arc.back.value >= objects) {
      continue;
    }
    fronts_[arc.back.value].emplace_back(arc.front.value);
    if (group_of_[arc.front.value] == group_of_[arc.back.value]) {
      backs_[arc.front.value].emplace_back(arc.back.value);
    } else {
      arcs_.push_back(arc);  // between groups the order stays as it is
    }
  }
  images_.assign(objects, {});
  boxes_.clear();
  for (std::uint32_t i = 0; i < objects; ++i) {
    outliner.imageHull(scene, ObjectId(i), images_[i]);
    boxes_.push_back(boxOf(images_[i]));
  }
  for (std::uint32_t i = 0; i < objects; ++i) {
    if (!backs_[i].empty()) {
      addArcsOf(ObjectId(i), outliner, order, outline_of);
    }
  }
  return sorter_.sort(order, arcs_);
}

}  // namespace sightline::drawing
