#include "src/occluders/bodies.h"

#include <algorithm>
#include <tuple>

#include "src/base/parts.h"
#include "src/occluders/occluder_limits.h"

namespace sightline::occluders {
namespace {

constexpr std::size_t kObjectsOfPart = 1024;

std::uint32_t cornerOf(const FoundPolygon& polygon, std::size_t number) {
  return polygon.loop()[polygon.corners()[number]];
}

// Vertex number i of a chain.
std::uint32_t vertexOf(const FoundPolygon& polygon, const CornerChain& chain, std::uint32_t i) {
  const std::size_t at = std::size_t{chain.begin} + i;
  return polygon.loop()[at < polygon.loop().size() ? at : at - polygon.loop().size()];
}

bool runAgainst(const FoundPolygon& p, const CornerChain& a, const FoundPolygon& q, const CornerChain& b) {
  bool same = a.edge_count == b.edge_count;
  for (std::uint32_t i = 0; same && i <= a.edge_count; ++i) {
    same = vertexOf(p, a, i) == vertexOf(q, b, b.edge_count - i);
  }
  return same;
}

// What bodies add to a set. Numbers of vertices, edges and faces count from the first one here.
struct BodyLists {
  std::vector<OccluderBody> bodies;
  std::vector<Vec3f> vertices;
  std::vector<BodyEdge> edges;
  std::vector<BodyFace> faces;
};

// Adds bodies to lists, one after the other.
class BodyMaker {
 public:
  BodyMaker(std::span<const Vec3f> positions, const OccluderSet& set, BodyLists& lists)
      : positions_(positions), set_(set), lists_(lists) {}

  // faces: polygons of the set, ascending by id.
  void add(std::span<const RankedPolygon* const> faces) {
    OccluderBody& body = lists_.bodies.emplace_back();
    body.first_vertex = static_cast<std::uint32_t>(lists_.vertices.size());
    body.first_edge = static_cast<std::uint32_t>(lists_.edges.size());
    body.first_face = static_cast<std::uint32_t>(lists_.faces.size());
    body.face_count = static_cast<std::uint8_t>(faces.size());
    vertices_.clear();
    polygons_.clear();
    for (const RankedPolygon* face : faces) {
      const FoundPolygon& polygon = *face->polygon;
      polygons_.push_back(&polygon);
      body.slack = std::max(body.slack, set_[face->id].slack);
      for (const std::uint32_t corner : polygon.corners()) {
        numberOf(polygon.loop()[corner], body.bounds);
      }
      BodyFace& body_face = lists_.faces.emplace_back();
      body_face.plane = polygon.plane;
      body_face.occluder = face->id;
      body_face.vertex = numberOf(cornerOf(polygon, 0), body.bounds);
    }
    addThickness(body);
    addEdges(body);
    body.vertex_count = static_cast<std::uint8_t>(vertices_.size());
  }

 private:
  // Corners that lie before planes count as slack.
  void addThickness(OccluderBody& body) const {
    for (const std::uint32_t vertex : vertices_) {
      for (const FoundPolygon* other : polygons_) {
        body.slack = std::max(body.slack,
                              static_cast<float>(1.001 * other->plane.evaluate(Vec3d(positions_[vertex]))));
      }
    }
  }

  void addEdges(OccluderBody& body) {
    mates_.find(polygons_);
    const std::span<const CornerChain> chains = mates_.chains();
    for (std::size_t i = 0; i + 1 < chains.size(); i += 2) {
      const CornerChain &a = chains[i], &b = chains[i + 1];
      const FoundPolygon& polygon = *polygons_[a.polygon];
      lists_.edges.push_back({numberOf(vertexOf(polygon, a, 0), body.bounds),
                              numberOf(vertexOf(polygon, a, a.edge_count), body.bounds),
                              static_cast<std::uint8_t>(a.polygon), static_cast<std::uint8_t>(b.polygon)});
    }
    body.edge_count = static_cast<std::uint8_t>(chains.size() / 2);
  }

  std::uint8_t numberOf(std::uint32_t vertex, Box& bounds) {
    const auto found = std::find(vertices_.begin(), vertices_.end(), vertex);
    if (found == vertices_.end()) {
      vertices_.push_back(vertex);
      lists_.vertices.push_back(positions_[vertex]);
      bounds.extend(positions_[vertex]);
      return static_cast<std::uint8_t>(vertices_.size() - 1);
    }
    return static_cast<std::uint8_t>(found - vertices_.begin());
  }

  std::span<const Vec3f> positions_;
  const OccluderSet& set_;
  BodyLists& lists_;
  ChainMates mates_;
  // Scratch for one body: its vertices and polygons.
  std::vector<std::uint32_t> vertices_;
  std::vector<const FoundPolygon*> polygons_;
};

// Adds the bodies of one object of which no polygon is missing. in_bodies: scratch.
void addBodies(std::span<const RankedPolygon> polygons, std::vector<const RankedPolygon*>& in_bodies,
               BodyMaker& maker) {
  in_bodies.clear();
  for (const RankedPolygon& polygon : polygons) {
    if (polygon.polygon->body != FoundPolygon::kNoBody) {
      in_bodies.push_back(&polygon);
    }
  }
  std::sort(in_bodies.begin(), in_bodies.end(), [](const RankedPolygon* a, const RankedPolygon* b) {
    return std::tie(a->polygon->body, a->id) < std::tie(b->polygon->body, b->id);
  });
  for (std::size_t first = 0, last = 0; first < in_bodies.size(); first = last) {
    const FoundPolygon& polygon = *in_bodies[first]->polygon;
    while (last < in_bodies.size() && in_bodies[last]->polygon->body == polygon.body) {
      ++last;
    }
    if (last - first == polygon.body_size) {
      maker.add(std::span(in_bodies).subspan(first, last - first));
    }
  }
}

// Appends what a part found.
void append(const BodyLists& part, OccluderSet& set) {
  const auto first_vertex = static_cast<std::uint32_t>(set.body_vertices.size());
  const auto first_edge = static_cast<std::uint32_t>(set.body_edges.size());
  const auto first_face = static_cast<std::uint32_t>(set.body_faces.size());
  for (const OccluderBody& of_part : part.bodies) {
    OccluderBody& body = set.bodies.emplace_back(of_part);
    for (std::uint32_t face = body.first_face; face < body.first_face + body.face_count; ++face) {
      set.body_of[part.faces[face].occluder.value] = static_cast<std::uint32_t>(set.bodies.size() - 1);
    }
    body.first_vertex += first_vertex;
    body.first_edge += first_edge;
    body.first_face += first_face;
  }
  set.body_vertices.insert(set.body_vertices.end(), part.vertices.begin(), part.vertices.end());
  set.body_edges.insert(set.body_edges.end(), part.edges.begin(), part.edges.end());
  set.body_faces.insert(set.body_faces.end(), part.faces.begin(), part.faces.end());
}

}  // namespace

void ChainMates::find(std::span<const FoundPolygon* const> polygons) {
  keys_.clear();
  for (std::uint32_t p = 0; p < polygons.size(); ++p) {
    const auto corners = static_cast<std::uint32_t>(polygons[p]->corners().size());
    std::uint32_t from = corners > 0 ? cornerOf(*polygons[p], corners - 1) : 0;
    for (std::uint32_t i = 0; i < corners; ++i) {
      const std::uint32_t to = cornerOf(*polygons[p], i), number = i > 0 ? i - 1 : corners - 1;
      keys_.push_back(
          {std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), std::uint64_t{p} << 32 | number});
      from = to;
    }
  }
  sorter_.sort(keys_);
  chains_.clear();
  for (const base::SortKey& key : keys_) {
    const auto p = static_cast<std::uint32_t>(key.second >> 32), i = static_cast<std::uint32_t>(key.second);
    const std::span<const std::uint32_t> corners = polygons[p]->corners();
    const std::uint32_t begin = corners[i], end = corners[i + 1 < corners.size() ? i + 1 : 0];
    const auto size = static_cast<std::uint32_t>(polygons[p]->loop().size());
    chains_.push_back({key.first, p, begin, end > begin ? end - begin : end + size - begin});
  }
  mated_.assign(polygons.size(), 1);
  for (std::size_t first = 0, last = 0; first < chains_.size(); first = last) {
    while (last < chains_.size() && chains_[last].key == chains_[first].key) {
      ++last;
    }
    const CornerChain &a = chains_[first], &b = chains_[last - 1];
    if (last - first != 2 || !runAgainst(*polygons[a.polygon], a, *polygons[b.polygon], b)) {
      for (std::size_t i = first; i < last; ++i) {
        mated_[chains_[i].polygon] = 0;
      }
    }
  }
}

// Whether the faces bound a convex solid that has some thickness below each of them.
bool BodyFinder::isBody(std::span<const FoundPolygon* const> faces, double tolerance) {
  std::size_t edges = 0;
  for (const FoundPolygon* face : faces) {
    edges += face->corners().size();
  }
  edges /= 2;
  // Euler: as many vertices as edges and two, less the faces.
  if (faces.size() < 4 || faces.size() > kMaxBodyFaces || edges > kMaxBodyEdges ||
      edges + 2 - faces.size() > kMaxBodyVertices) {
    return false;
  }
  vertices_.clear();
  corners_.clear();
  for (const FoundPolygon* face : faces) {
    for (std::size_t corner = 0; corner < face->corners().size(); ++corner) {
      const std::uint32_t vertex = cornerOf(*face, corner);
      if (std::find(vertices_.begin(), vertices_.end(), vertex) == vertices_.end()) {
        vertices_.push_back(vertex);
        corners_.emplace_back(positions_[vertex]);
      }
    }
  }
  for (const FoundPolygon* face : faces) {
    double lowest = 0.0;
    for (const Vec3d& corner : corners_) {
      const double height = face->plane.evaluate(corner);
      if (height > tolerance) {
        return false;
      }
      lowest = std::min(lowest, height);
    }
    if (!(lowest < -4.0 * tolerance)) {
      return false;  // flat: a sheet may have a notch
    }
  }
  return true;
}

void BodyFinder::find(std::span<FoundPolygon* const> polygons, double tolerance) {
  read_.assign(polygons.begin(), polygons.end());
  mates_.find(read_);
  components_.reset(polygons.size());
  const std::span<const CornerChain> chains = mates_.chains();
  for (std::size_t i = 0; i + 1 < chains.size(); ++i) {
    if (chains[i].key == chains[i + 1].key) {
      components_.unite(chains[i].polygon, chains[i + 1].polygon);
    }
  }
  closed_.assign(polygons.size(), 1);
  for (std::uint32_t p = 0; p < polygons.size(); ++p) {
    if (!mates_.allMated(p)) {
      closed_[components_.root(p)] = 0;
    }
  }
  by_component_.group(polygons.size(), [this](auto&& pair) {
    for (std::uint32_t p = 0; p < read_.size(); ++p) {
      if (closed_[components_.root(p)] != 0) {
        pair(components_.root(p), p);
      }
    }
  });
  std::uint32_t next = 0;
  for (std::size_t component = 0; component < by_component_.count(); ++component) {
    const std::span<const std::uint32_t> members = by_component_[component];
    faces_.clear();
    for (const std::uint32_t p : members) {
      faces_.push_back(read_[p]);
    }
    if (isBody(faces_, tolerance)) {
      for (const std::uint32_t p : members) {
        polygons[p]->body = next;
        polygons[p]->body_size = static_cast<std::uint8_t>(members.size());
      }
      ++next;
    }
  }
}

void assembleBodies(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                    const ParallelFor& parallel_for, OccluderSet& set) {
  set.body_of.assign(polygons.size(), OccluderSet::kNoBody);
  std::vector<std::uint32_t> first_of_object;  // and one more
  for (std::uint32_t i = 0; i < polygons.size(); ++i) {
    if (i == 0 || polygons[i].object != polygons[i - 1].object) {
      first_of_object.push_back(i);
    }
  }
  const base::Parts parts(first_of_object.size(), kObjectsOfPart);
  first_of_object.push_back(static_cast<std::uint32_t>(polygons.size()));
  std::vector<BodyLists> of_part(parts.count());
  parts.run(parallel_for, [&](std::size_t part, std::size_t begin, std::size_t end) {
    BodyMaker maker(positions, set, of_part[part]);
    std::vector<const RankedPolygon*> in_bodies;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t first = first_of_object[i];
      addBodies(polygons.subspan(first, first_of_object[i + 1] - first), in_bodies, maker);
    }
  });
  for (BodyLists& part : of_part) {
    append(part, set);
    part = {};
  }
}

}  // namespace sightline::occluders
