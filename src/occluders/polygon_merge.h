#pragma once

// Makes convex polygons of the triangles of one object, for findOccluders() and makeOccluders(). There are
// objects of a dozen triangles by the million, so what works on one keeps its storage for the next.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/large_vector.h"
#include "sightline/math/plane.h"
#include "sightline/math/vec3.h"
#include "src/base/sort_keys.h"
#include "src/base/union_find.h"

namespace sightline::occluders {

// A convex polygon over shared vertices, before ranking. Large scenes have ten million, so each is kept
// small.
class FoundPolygon {
 public:
  static constexpr std::uint32_t kNoBody = 0xffffffffu;

  Plane plane;  // unit normal
  double area = 0.0;
  Vec3f centroid;
  float slack = 0.0f;  // rounded up
  std::uint32_t triangle_count = 0;
  std::uint32_t body = kNoBody;  // of the object's bodies, see bodies.h
  std::uint8_t body_size = 0;    // polygons that it has, at most kMaxBodyFaces
  bool double_sided = false;

  // Vertex ids along the whole boundary, counter-clockwise.
  std::span<const std::uint32_t> loop() const { return {outline_, loop_size_}; }
  // Positions in the loop where the boundary turns, at most 64.
  std::span<const std::uint32_t> corners() const { return {outline_ + loop_size_, corner_count_}; }
  // outline: the loop and then the corners, which stay where they are.
  void setOutline(std::span<const std::uint32_t> outline, std::size_t corner_count) {
    outline_ = outline.data();
    loop_size_ = static_cast<std::uint32_t>(outline.size() - corner_count);
    corner_count_ = static_cast<std::uint8_t>(corner_count);
  }

 private:
  std::uint8_t corner_count_ = 0;
  std::uint32_t loop_size_ = 0;
  const std::uint32_t* outline_ = nullptr;
};

// Holds the outlines of found polygons. They stay where they are, also when this is moved.
class IdStore {
 public:
  // Returns a copy of the ids of a loop and of its corners, one after the other.
  std::span<const std::uint32_t> copy(std::span<const std::uint32_t> loop,
                                      std::span<const std::uint32_t> corners);

 private:
  std::vector<std::vector<std::uint32_t>> blocks_;
};

// Places count as equal when they differ by no more than this: eight units in the last place of
// single-precision coordinates of that size.
double roundingTolerance(double largest_coordinate);

using PatchTriangle = std::array<std::uint32_t, 3>;  // vertex ids

// A coplanar, connected set of triangles, consistently wound.
struct Patch {
  Plane plane;
  double deviation = 0.0;                       // largest distance of a vertex from the plane
  std::uint32_t first = 0, triangle_count = 0;  // into PatchFinder::triangles()
  // Patches of the object that adjoin each other, directly or by others, have the same number, below the
  // number of its triangles.
  std::uint32_t component = 0;
};

// Cuts the triangles of objects into patches, one object after the other.
class PatchFinder {
 public:
  // indices: vertex ids into positions, three for each triangle.
  void find(std::span<const Vec3f> positions, std::span<const std::uint32_t> indices, bool double_sided,
            double tolerance);

  // The patches of the object that find() was last called for.
  std::span<const Patch> patches() const { return patches_; }
  std::span<const PatchTriangle> trianglesOf(const Patch& patch) const {
    return std::span(in_patches_).subspan(patch.first, patch.triangle_count);
  }

 private:
  struct Usable {
    PatchTriangle corners;
    Vec3d normal;  // twice as long as the area
    double size;   // the normal's length
  };
  void findUsable(std::span<const std::uint32_t> indices, bool double_sided);
  void findNeighbours(bool double_sided);
  void grow(std::uint32_t seed);
  void append(Patch& patch, std::uint32_t triangle);
  bool joins(const Plane& plane, std::uint32_t from, std::uint32_t edge, std::uint32_t corner);
  Vec3d at(std::uint32_t id) const { return Vec3d(positions_[id]); }

  std::span<const Vec3f> positions_;
  double tolerance_ = 0.0;
  base::KeySorter sorter_;
  LargeVector<base::SortKey> keys_;
  std::vector<Usable> triangles_;
  // The one triangle beyond each edge, as 3 * triangle + edge; kNone where there is none, or more than one.
  std::vector<std::uint32_t> neighbour_;
  base::UnionFind components_;                 // of triangles, over these edges
  std::vector<std::uint8_t> taken_, flipped_;  // by triangle
  std::vector<std::uint32_t> queue_;
  std::vector<Patch> patches_;
  std::vector<PatchTriangle> in_patches_;
};

// A polygon of one patch, while it grows.
struct GrowingPolygon {
  std::vector<std::uint32_t> loop, corners;  // see FoundPolygon; an empty loop: it is part of another one
  Vec3d centroid;
  double area = 0.0;
  double slack = 0.0;
  std::uint32_t triangle_count = 0;
};

// Finishes polygons of one plane.
class PolygonFinisher {
 public:
  PolygonFinisher(std::span<const Vec3f> positions, std::uint32_t max_vertices)
      : positions_(positions), max_vertices_(max_vertices) {}

  void setPlane(const Plane& plane, double tolerance);
  // Fills corners, area, centroid and slack from the loop; false when the loop is not convex within the
  // tolerance or has more than max_vertices corners.
  bool finish(GrowingPolygon& polygon);

 private:
  struct Point2 {
    double x, y;
  };
  static double distanceToLine(const Point2& p, const Point2& a, const Point2& b);
  // -1: not convex.
  int markCorners(std::vector<std::uint32_t>& corners) const;
  bool cornersDescribe(std::span<const std::uint32_t> corners, double& slack) const;

  std::span<const Vec3f> positions_;
  std::uint32_t max_vertices_;
  double tolerance_ = 0.0;
  Vec3d u_, v_;  // axes of the plane
  std::vector<Point2> points_;
};

// The polygon as it is found, with loop and corners in the store.
FoundPolygon foundPolygon(const GrowingPolygon& polygon, const Plane& plane, IdStore& ids);

// Merges the triangles of patches to convex polygons that can't be merged any further, one patch after the
// other.
class PolygonMerger {
 public:
  // max_vertices: corners of a polygon at most.
  PolygonMerger(std::span<const Vec3f> positions, std::uint32_t max_vertices)
      : positions_(positions), finisher_(positions, max_vertices) {}

  // Appends the polygons to found. tolerance: with which the patch was found.
  void merge(const Patch& patch, std::span<const PatchTriangle> triangles, double tolerance,
             std::vector<FoundPolygon>& found, IdStore& ids);

 private:
  // To which polygon each directed edge belongs.
  class EdgeOwners {
   public:
    void reset(std::size_t most_edges);
    std::uint32_t of(std::uint64_t edge) const { return slots_[slotOf(edge)].owner; }  // kNone: to none
    void set(std::uint64_t edge, std::uint32_t owner) { slots_[slotOf(edge)] = {edge, owner}; }

   private:
    struct Slot {
      std::uint64_t edge = 0;
      std::uint32_t owner = 0xffffffffu;
    };
    std::size_t slotOf(std::uint64_t edge) const;

    std::vector<Slot> slots_;  // a power of two, at least half of them free
  };

  void start(const Patch& patch, std::span<const PatchTriangle> triangles);
  void mergeAll();
  void orderByArea();
  bool edgesAreFree(std::span<const std::uint32_t> loop) const;
  void claimEdges(std::span<const std::uint32_t> loop, std::uint32_t p);
  std::uint32_t beyond(std::uint32_t p, std::size_t i) const;
  double compactness(const GrowingPolygon& polygon) const;
  bool turnsRight(std::uint32_t p, std::uint32_t q, std::uint32_t r) const;
  bool join(std::uint32_t p, std::uint32_t q, std::size_t i, GrowingPolygon& result) const;
  bool mergeBest(std::uint32_t p);
  // The next one of polygons_, whose storage stays when they are forgotten.
  GrowingPolygon& addPolygon();

  std::span<const Vec3f> positions_;
  PolygonFinisher finisher_;
  double tolerance_ = 0.0;
  Vec3d normal_;  // of the patch
  std::vector<GrowingPolygon> polygons_;
  std::uint32_t polygon_count_ = 0, alive_ = 0;
  EdgeOwners owners_;  // stale ones are inside polygons
  std::vector<std::uint32_t> order_;
  GrowingPolygon candidate_, best_;
};

}  // namespace sightline::occluders
