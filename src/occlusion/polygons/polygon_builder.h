#pragma once

// Makes the polygons of a depth buffer from chosen occluders: bodies, then all others with their shared
// edges.

#include <cstdint>
#include <span>
#include <vector>

#include "src/occlusion/polygons/buffer_polygon.h"
#include "src/occlusion/polygons/shared_edges.h"

namespace sightline::occlusion {

// Holds nothing but scratch between two calls.
class PolygonBuilder {
 public:
  // Replaces `polygons` by those of the chosen occluders that can be used from this view and may be on the
  // buffer: first bodies, then the others, each in the order of `chosen`.
  void build(const PolygonProjection& projection, const OccluderSet& set, std::span<const OccluderId> chosen,
             BufferPolygons& polygons);

 private:
  void takeChosen(const PolygonProjection& projection, const Eye& eye, const OccluderSet& set,
                  std::span<const OccluderId> chosen, BufferPolygons& polygons);
  void activate(const PolygonProjection& projection, const Eye& eye, const OccluderSet& set, OccluderId id,
                OccluderId chosen);
  void appendPolygon(const PolygonProjection& projection, const Eye& eye, const OccluderSet& set,
                     std::uint32_t number, double clip_depth, BufferPolygons& polygons);

  ActivePolygons active_;
  std::vector<bool> body_taken_;  // by body; false between builds
  std::vector<std::uint32_t> bodies_taken_;
  // Scratch for one polygon.
  CameraOutline outline_;
  std::vector<CameraSegment> open_parts_;
};

}  // namespace sightline::occlusion
