#include "src/occlusion/polygons/polygon_builder.h"

#include <algorithm>

#include "src/occlusion/polygons/body_polygon.h"

namespace sightline::occlusion {

// Appends bodies to the polygons and makes all other chosen occluders active.
void PolygonBuilder::takeChosen(const PolygonProjection& projection, const Eye& eye, const OccluderSet& set,
                                std::span<const OccluderId> chosen, BufferPolygons& polygons) {
  active_.begin(set);
  body_taken_.resize(std::max(body_taken_.size(), set.bodies.size()), false);
  for (const OccluderId id : chosen) {
    if (id.value >= set.occluders.size() || active_.contains(id)) {
      continue;
    }
    const OccluderBody* body = projection.form() == PolygonForm::kConservative ? set.bodyOf(id) : nullptr;
    if (body == nullptr) {
      ++polygons.considered;
      activate(projection, eye, set, id, id);
      continue;
    }
    const auto number = static_cast<std::uint32_t>(body - set.bodies.data());
    if (!body_taken_[number]) {
      ++polygons.considered;
      body_taken_[number] = true;
      bodies_taken_.push_back(number);
      if (!appendBody(projection, eye, set, id, *body, outline_, polygons)) {
        for (const BodyFace& face : set.facesOf(*body)) {
          activate(projection, eye, set, face.occluder, id);
        }
      }
    }
  }
  for (const std::uint32_t body : bodies_taken_) {
    body_taken_[body] = false;
  }
  bodies_taken_.clear();
}

void PolygonBuilder::activate(const PolygonProjection& projection, const Eye& eye, const OccluderSet& set,
                              OccluderId id, OccluderId chosen) {
  const std::optional<EyeOccluder> seen = faceOccluder(eye, set, id);
  const double inset = seen ? outlineInset(seen->deviation, seen->reach, seen->grazing) : 0.0;
  const scene::PixelView& view = projection.view();
  // Occluders whose position error exceeds the guard band around the buffer are skipped.
  if (seen && keepsShape(set[id], inset) &&
      projection.marginAt(inset, 1.0 / std::max(seen->nearest, view.near)) <
          0.5 * std::min(view.width, view.height)) {
    active_.add(*seen, chosen, inset);
  }
}

void PolygonBuilder::appendPolygon(const PolygonProjection& projection, const Eye& eye,
                                   const OccluderSet& set, std::uint32_t number, double clip_depth,
                                   BufferPolygons& polygons) {
  const ActivePolygon& active = active_[number];
  outline_.corners.clear();
  open_parts_.clear();
  for (std::uint32_t side = 0; side < set[active.seen.id].vertex_count; ++side) {
    const Outline outline = outlineOf(eye, set, active.seen, side);
    EdgeKind kind = EdgeKind::kOpen;
    if (projection.form() == PolygonForm::kConservative) {
      const std::uint64_t open = active_.joinAcross(set, eye, number, outline);
      if (open != allMeshEdges(set.edges[outline.edge])) {
        kind = EdgeKind::kShared;
        appendOpenParts(set, projection.view(), active.seen, outline.edge, open, open_parts_);
      }
    }
    outline_.corners.push_back({projection.view().toCamera(outline.from), kind});
  }
  if (!projection.clip(clip_depth, outline_)) {
    return;
  }
  BufferPolygon polygon = projection.appendOutline(active.chosen, outline_.corners, active.inset, polygons);
  polygon.group = number;
  for (const CameraSegment& part : open_parts_) {
    if (const std::optional<CameraSegment> clipped = projection.clip(clip_depth, part)) {
      polygons.edges.push_back(projection.openEdge(*clipped, active.inset));
      ++polygon.gap_count;
    }
  }
  const double slack = active.seen.depth_slack + 4.0 * kDepthMargin * active.seen.reach;
  polygon.add(projection.depthOf(active.seen.support, slack, polygon, polygons.corners(polygon)));
  polygons.polygons.push_back(polygon);
}

void PolygonBuilder::build(const PolygonProjection& projection, const OccluderSet& set,
                           std::span<const OccluderId> chosen, BufferPolygons& polygons) {
  const scene::PixelView& view = projection.view();
  polygons.clear();
  if (!view.sane()) {
    polygons.considered = static_cast<std::uint32_t>(chosen.size());
    return;
  }
  Eye eye;
  eye.position = view.eye;
  eye.forward = view.forward;
  eye.sight = view.unit_z;
  eye.near = view.near;
  eye.orthographic = view.orthographic;
  takeChosen(projection, eye, set, chosen, polygons);
  const double clip_depth = active_.commonClipDepth(view.near);
  for (std::uint32_t number = 0; number < active_.size(); ++number) {
    appendPolygon(projection, eye, set, number, clip_depth, polygons);
  }
  for (BufferPolygon& polygon : polygons.polygons) {
    if (polygon.group != BufferPolygon::kNoGroup) {
      polygon.group = active_.groupOf(polygon.group);
    }
  }
  active_.end();
}

}  // namespace sightline::occlusion
