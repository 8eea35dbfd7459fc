#pragma once

// The potential occluders of a scene: convex polygons merged out of coplanar opaque triangles.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "sightline/base/ids.h"
#include "sightline/base/large_vector.h"
#include "sightline/base/parallel_for.h"
#include "sightline/base/result.h"
#include "sightline/math/box.h"
#include "sightline/math/plane.h"
#include "sightline/scene/scene.h"

namespace sightline {

// A convex polygon, counter-clockwise seen from its front, as triangles of a SceneView are. Its boundary runs
// along edges of the mesh.
struct Occluder {
  std::uint32_t first_vertex = 0;  // into OccluderSet::vertices and OccluderSet::edges
  std::uint16_t vertex_count = 0;
  bool double_sided = false;
  // No corner is sharper than 3 degrees: edges shared with neighbours may be watertight
  // (docs/conservative.md).
  bool watertight_edges = false;
  ObjectId object{};  // the object of its triangles; not valid: none
  float area = 0.0f;  // square metres
  // Metres: bounds the distance between the polygon and its triangles, in its plane and across it.
  float slack = 0.0f;
  Vec3f centroid{};  // of its area
  Plane plane{};     // unit normal, towards the front; scene space
};

// The edge from one corner of an occluder to the next.
struct OccluderEdge {
  std::uint32_t line = 0;  // into OccluderSet::lines; edges along one shared edge have the same line
  std::uint32_t first_neighbour = 0;  // into OccluderSet::neighbours
  std::uint16_t neighbour_count = 0;
  // Number of mesh edges along this edge, end to end; 0: the edge is never watertight.
  std::uint16_t mesh_edge_count = 0;
  // Into OccluderSet::edge_vertices: the mesh_edge_count - 1 mesh vertices between its corners.
  std::uint32_t first_edge_vertex = 0;
};

// Another occluder that has one of an edge's mesh edges in its own boundary. A mesh edge of more than 64
// occluders has none.
struct EdgeNeighbour {
  OccluderId occluder{};
  std::uint32_t mesh_edge = 0;  // number of the mesh edge within the edge, from 0
};

// A convex solid of one object that occluders enclose: seen from outside, everything behind its image is
// hidden.
struct OccluderBody {
  std::uint32_t first_vertex = 0, first_edge = 0, first_face = 0;  // into OccluderSet::body_...
  std::uint8_t vertex_count = 0, edge_count = 0, face_count = 0;
  std::uint8_t unused = 0;  // files hold the struct as it lies in memory
  float slack = 0.0f;       // metres, as of an occluder; of all faces
  Box bounds{};
};
// From vertex `from` to vertex `to`, with face `left` on its left as seen from outside, `right` on its right;
// numbers within the body.
struct BodyEdge {
  std::uint8_t from = 0, to = 0, left = 0, right = 0;
};
struct BodyFace {
  Plane plane{};  // the occluder's
  OccluderId occluder{};
  std::uint8_t vertex = 0;               // on the plane, number within the body
  std::array<std::uint8_t, 3> unused{};  // as OccluderBody::unused
};

// How many triangles became part of an occluder, and why the others did not.
struct OccluderReport {
  std::uint64_t used = 0;          // in occluders
  std::uint64_t see_through = 0;   // blended or alpha-tested material
  std::uint64_t marked_never = 0;  // by the scene's author
  std::uint64_t degenerate = 0;    // without area, doubled, or a polygon thinner than rounding
  std::uint64_t too_small = 0;     // the merged polygon is not among the large ones
};

struct OccluderSettings {
  std::uint32_t max_vertices = 16;  // of a polygon, 3 to 64
  // The largest polygons that together hold this fraction of the area of all polygons are kept, whatever the
  // scene's scale; those of objects marked as occluders always. The faces of a convex body are kept together.
  double area_fraction = 0.98;
  double min_area = 0.0;            // square metres, in addition
  std::uint32_t max_occluders = 0;  // in addition; 0: no limit
};

// Ranked by area, largest first: a smaller OccluderId is a larger polygon. Made by the functions below and
// not to be changed by hand: bodies have corners and planes of their own.
struct OccluderSet {
  LargeVector<Occluder> occluders{};
  LargeVector<Vec3f> vertices{};              // corners of all occluders, scene space
  LargeVector<OccluderEdge> edges{};          // edge i starts at vertex i
  LargeVector<std::array<Vec3f, 2>> lines{};  // two points on each line
  LargeVector<EdgeNeighbour> neighbours{};    // by edge, then by mesh edge, then by occluder
  LargeVector<Vec3f> edge_vertices{};         // mesh vertices along edges, between the corners
  // Ascending: all objects of the scene in which occluders were found, or those that given polygons name.
  LargeVector<ObjectId> objects{};
  LargeVector<std::uint32_t> first_of_object{};  // by place in objects, and one more; into of_object
  LargeVector<OccluderId> of_object{};           // occluders by object
  // The same without the faces of bodies but the first one, which stands for the body.
  LargeVector<std::uint32_t> first_unit_of_object{};
  LargeVector<OccluderId> unit_of_object{};
  static constexpr std::uint32_t kNoBody = 0xffffffffu;
  LargeVector<OccluderBody> bodies{};
  LargeVector<Vec3f> body_vertices{};  // scene space
  LargeVector<BodyEdge> body_edges{};
  LargeVector<BodyFace> body_faces{};    // of a body: ascending by occluder
  LargeVector<std::uint32_t> body_of{};  // by OccluderId: into bodies, or kNoBody
  OccluderReport report{};
  double area = 0.0;  // of all occluders, square metres

  const Occluder& operator[](OccluderId id) const { return occluders[id.value]; }
  std::span<const Vec3f> verticesOf(const Occluder& o) const {
    return std::span(vertices).subspan(o.first_vertex, o.vertex_count);
  }
  std::span<const OccluderEdge> edgesOf(const Occluder& o) const {
    return std::span(edges).subspan(o.first_vertex, o.vertex_count);
  }
  std::span<const EdgeNeighbour> neighboursOf(const OccluderEdge& e) const {
    return std::span(neighbours).subspan(e.first_neighbour, e.neighbour_count);
  }
  const OccluderBody* bodyOf(OccluderId id) const {
    const std::uint32_t body = id.value < body_of.size() ? body_of[id.value] : kNoBody;
    return body == kNoBody ? nullptr : &bodies[body];
  }
  std::span<const Vec3f> verticesOf(const OccluderBody& b) const {
    return std::span(body_vertices).subspan(b.first_vertex, b.vertex_count);
  }
  std::span<const BodyEdge> edgesOf(const OccluderBody& b) const {
    return std::span(body_edges).subspan(b.first_edge, b.edge_count);
  }
  std::span<const BodyFace> facesOf(const OccluderBody& b) const {
    return std::span(body_faces).subspan(b.first_face, b.face_count);
  }
  std::span<const OccluderId> occludersOf(ObjectId object) const {
    return listOf(placeOf(object), first_of_object, of_object);
  }
  std::span<const OccluderId> unitsOf(ObjectId object) const {
    return listOf(placeOf(object), first_unit_of_object, unit_of_object);
  }
  // The object's place in objects, or objects.size(). Where objects has all from 0 on, that is its number.
  std::size_t placeOf(ObjectId object) const {
    if (object.value < objects.size() && objects[object.value] == object) {
      return object.value;
    }
    const auto at = std::lower_bound(objects.begin(), objects.end(), object);
    return at != objects.end() && *at == object ? static_cast<std::size_t>(at - objects.begin())
                                                : objects.size();
  }

 private:
  static std::span<const OccluderId> listOf(std::size_t place, std::span<const std::uint32_t> first,
                                            std::span<const OccluderId> ids) {
    if (place + 1 >= first.size()) {
      return {};
    }
    return ids.subspan(first[place], first[place + 1] - first[place]);
  }
};

// Some occluders of one set. Occlusion structures take several sets, for instance that of the scene and that
// of what moves in it. Sets do not know each other: no edge between occluders of two sets is watertight.
struct ChosenOccluders {
  const OccluderSet* set = nullptr;
  std::span<const OccluderId> chosen{};
};

// Finds the occluders of a scene in its triangles. The result does not depend on the threads.
OccluderSet findOccluders(const SceneView& scene, const OccluderSettings& settings = {},
                          const ParallelFor& parallel_for = serialFor);

// A polygon that the caller gives: it has to be drawn and opaque, or what lies behind it is wrongly hidden.
struct OccluderPolygon {
  // Scene space, convex, in one plane. The front is that of the triangle of any three consecutive vertices
  // that are not in one line, as SceneView says it.
  std::span<const Vec3f> vertices{};
  bool double_sided = false;
  // The object that shows this polygon, any number: OccluderChooser, and so a Culler, looks for occluders
  // among the objects in view. ObjectId(): none. Such an occluder is used only where the caller names it, as
  // for an OcclusionTree, and where it moves: Culler::cull uses all that move.
  ObjectId object = ObjectId(0u);
};

// Makes a set of the caller's polygons, for scenes that change or come without meshes. Edges with equal end
// points are watertight between their polygons, and so are parts of edges, up to 64 of one, that end at
// corners of others which lie on them exactly. An edge of more than 64 polygons is open in all of them. The
// time grows with the number of edges, however they lie: 16,000 long strips side by side, aslant, take
// 0.08 s. Polygons without area, and those that deviate from convex or planar by more than rounding, are left
// out, which is conservative: they hide nothing.
OccluderSet makeOccluders(std::span<const OccluderPolygon> polygons);

// The occluders as bytes, to be read again instead of found: on a machine of the same kind, by a program of
// the same version. They say neither of which scene nor with which settings they were found.
LargeVector<std::byte> occluderBytes(const OccluderSet& set);
// Error if they are cut off, of another version, or name what they do not have; such a set cannot be read
// beyond its arrays, and all of its numbers are finite. Whether they are those that were written, of this
// scene, is for the caller to check, by a checksum: occluders of another scene hide what is visible. If the
// bytes have an owner and begin at a multiple of 16, the arrays of the set lie in them and keep the owner.
Result<OccluderSet> occludersFrom(const SharedBytes& bytes, std::uint32_t object_count);

}  // namespace sightline
