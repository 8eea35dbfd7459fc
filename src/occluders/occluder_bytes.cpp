// Occluders as bytes: a head, the report and the area, then the arrays of OccluderSet
// (src/base/array_bytes.h).

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "sightline/occluders/occluder_set.h"
#include "src/base/array_bytes.h"
#include "src/occluders/occluder_limits.h"

namespace sightline {
namespace {

using namespace occluders;

// The last two letters: raise them with every change of the arrays or of findOccluders().
constexpr base::ArraysHead kOccludersHead{
    {'S', 'L', 'o', 'c', 'c', 'l', '0', '2'},
    sizeof(Occluder) | sizeof(OccluderEdge) << 8 | sizeof(OccluderBody) << 16 | sizeof(BodyFace) << 24};

// What of a set are no arrays.
struct Sums {
  OccluderReport report;
  double area = 0.0;
};

// Calls visit(array) for all arrays, always in this order. Set: an OccluderSet, const or not.
template <typename Set, typename Visit>
void forEachOccluderArray(Set& set, Visit&& visit) {
  visit(set.occluders);
  visit(set.vertices);
  visit(set.edges);
  visit(set.lines);
  visit(set.neighbours);
  visit(set.edge_vertices);
  visit(set.objects);
  visit(set.first_of_object);
  visit(set.of_object);
  visit(set.first_unit_of_object);
  visit(set.unit_of_object);
  visit(set.bodies);
  visit(set.body_vertices);
  visit(set.body_edges);
  visit(set.body_faces);
  visit(set.body_of);
}

template <typename Items, typename Sound>
bool all(const Items& items, Sound&& sound) {
  return std::all_of(items.begin(), items.end(), sound);
}

bool isFinitePlane(const Plane& plane) {
  return isFinite(plane.normal) && std::isfinite(plane.offset);
}

bool areOccludersSound(const OccluderSet& set, std::uint32_t objects) {
  return set.edges.size() == set.vertices.size() && all(set.occluders, [&](const Occluder& o) {
           return base::isBoolAt(o, offsetof(Occluder, double_sided)) &&
                  base::isBoolAt(o, offsetof(Occluder, watertight_edges)) && o.vertex_count >= 3 &&
                  o.vertex_count <= 64 &&
                  base::isRange(o.first_vertex, o.vertex_count, set.vertices.size()) &&
                  (!o.object.valid() || o.object.value < objects) && std::isfinite(o.area) &&
                  std::isfinite(o.slack) && o.slack >= 0.0f && isFinite(o.centroid) && isFinitePlane(o.plane);
         });
}

bool areEdgesSound(const OccluderSet& set) {
  return all(set.edges, [&](const OccluderEdge& edge) {
    return edge.line < set.lines.size() && edge.mesh_edge_count <= kMaxMeshEdges &&
           base::isRange(edge.first_neighbour, edge.neighbour_count, set.neighbours.size()) &&
           (edge.mesh_edge_count == 0 ||
            base::isRange(edge.first_edge_vertex, edge.mesh_edge_count - 1u, set.edge_vertices.size())) &&
           all(set.neighboursOf(edge), [&](const EdgeNeighbour& neighbour) {
             return neighbour.occluder.value < set.occluders.size() &&
                    neighbour.mesh_edge < edge.mesh_edge_count;
           });
  });
}

bool areListsSound(const OccluderSet& set, std::uint32_t objects) {
  const auto are_occluders = [&](const auto& ids) {
    return all(ids, [&](OccluderId id) { return id.value < set.occluders.size(); });
  };
  return all(set.objects, [objects](ObjectId id) { return id.value < objects; }) &&
         std::adjacent_find(set.objects.begin(), set.objects.end(),
                            [](ObjectId a, ObjectId b) { return !(a < b); }) == set.objects.end() &&
         base::areRowStarts(set.first_of_object, set.objects.size(), set.of_object.size()) &&
         base::areRowStarts(set.first_unit_of_object, set.objects.size(), set.unit_of_object.size()) &&
         are_occluders(set.of_object) && are_occluders(set.unit_of_object);
}

bool areBodiesSound(const OccluderSet& set) {
  return set.body_of.size() == set.occluders.size() &&
         all(set.body_of,
             [&](std::uint32_t body) { return body == OccluderSet::kNoBody || body < set.bodies.size(); }) &&
         all(set.bodies, [&](const OccluderBody& body) {
           return body.face_count > 0 && body.face_count <= kMaxBodyFaces &&
                  body.vertex_count <= kMaxBodyVertices && body.edge_count <= kMaxBodyEdges &&
                  base::isRange(body.first_vertex, body.vertex_count, set.body_vertices.size()) &&
                  base::isRange(body.first_edge, body.edge_count, set.body_edges.size()) &&
                  base::isRange(body.first_face, body.face_count, set.body_faces.size()) &&
                  std::isfinite(body.slack) && body.slack >= 0.0f && body.bounds.wellFormed() &&
                  all(set.edgesOf(body),
                      [&](const BodyEdge& edge) {
                        return edge.from < body.vertex_count && edge.to < body.vertex_count &&
                               edge.left < body.face_count && edge.right < body.face_count;
                      }) &&
                  all(set.facesOf(body), [&](const BodyFace& face) {
                    return face.vertex < body.vertex_count && face.occluder.value < set.occluders.size() &&
                           isFinitePlane(face.plane);
                  });
         });
}

bool arePointsFinite(const OccluderSet& set) {
  const auto finite = [](const Vec3f& point) { return isFinite(point); };
  return all(set.vertices, finite) && all(set.edge_vertices, finite) && all(set.body_vertices, finite) &&
         all(set.lines,
             [](const std::array<Vec3f, 2>& line) { return isFinite(line[0]) && isFinite(line[1]); });
}

// What is wrong with the numbers of a set; empty if nothing is: no index leaves its array.
std::string flawOf(const OccluderSet& set, std::uint32_t objects) {
  return !areOccludersSound(set, objects) || !std::isfinite(set.area) ? "its polygons are broken"
         : !areEdgesSound(set)                                        ? "its edges are broken"
         : !areListsSound(set, objects)                               ? "its lists of objects are broken"
         : !areBodiesSound(set)                                       ? "its bodies are broken"
         : !arePointsFinite(set)                                      ? "some of its numbers are not finite"
                                                                      : "";
}

}  // namespace

LargeVector<std::byte> occluderBytes(const OccluderSet& set) {
  const Sums sums{set.report, set.area};
  return base::arrayBytes(kOccludersHead, [&](auto&& visit) {
    visit(sums);
    forEachOccluderArray(set, visit);
  });
}

Result<OccluderSet> occludersFrom(const SharedBytes& bytes, std::uint32_t object_count) {
  OccluderSet set;
  Sums sums;
  const Status read = base::readArrays(bytes, kOccludersHead, "occluders", [&](auto&& visit) {
    visit(sums);
    forEachOccluderArray(set, visit);
  });
  if (!read) {
    return read.error();
  }
  set.report = sums.report;
  set.area = sums.area;
  if (const std::string flaw = flawOf(set, object_count); !flaw.empty()) {
    return base::unsoundArrays("occluders", flaw);
  }
  return set;
}

}  // namespace sightline
