#pragma once

// The occluders that one draw takes as polygons, and which of them share edges. A depth buffer must have no
// hole along an edge at which another polygon goes on.

#include <cstdint>
#include <vector>

#include "src/occlusion/eye_occluder.h"
#include "src/occlusion/polygons/polygon_projection.h"

namespace sightline::occlusion {

struct ActivePolygon {
  EyeOccluder seen;
  OccluderId chosen;        // the occluder that stands for it; of a body that is drawn by its faces one face
  double inset = 0.0;       // metres in its plane by which it is smaller than its outline
  std::uint32_t group = 0;  // parent in the forest of groups
};

class ActivePolygons {
 public:
  // Starts a draw of the set's occluders.
  void begin(const OccluderSet& set);
  // Ends it: forgets which occluders were active, so that the next draw may be of another set.
  void end();

  bool contains(OccluderId id) const { return number_of_[id.value] != kNone; }
  void add(const EyeOccluder& seen, OccluderId chosen, double inset);
  std::uint32_t size() const { return static_cast<std::uint32_t>(polygons_.size()); }
  const ActivePolygon& operator[](std::uint32_t number) const { return polygons_[number]; }

  // Returns the depth, in metres, at which all polygons are clipped. Polygons that share an edge must be
  // clipped at the same depth, else one of them would have an end there that the other does not know of.
  double commonClipDepth(double near) const;

  // Returns the mesh edges of an edge of a polygon, a bit each, beyond which no active polygon goes on; joins
  // the groups of those that do go on with the polygon's.
  std::uint64_t joinAcross(const OccluderSet& set, const Eye& eye, std::uint32_t number,
                           const Outline& outline);
  // The number that stands for the polygon's group; final once all edges have been joined.
  std::uint32_t groupOf(std::uint32_t number);

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  std::vector<ActivePolygon> polygons_;
  std::vector<std::uint32_t> number_of_;  // by OccluderId; kNone for what is not active
};

// Appends the open parts of an edge, in camera space. open: its mesh edges, as joinAcross() returns them.
void appendOpenParts(const OccluderSet& set, const scene::PixelView& view, const EyeOccluder& seen,
                     std::uint32_t edge_index, std::uint64_t open, std::vector<CameraSegment>& parts);

}  // namespace sightline::occlusion
