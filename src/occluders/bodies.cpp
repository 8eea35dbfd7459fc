#include "src/occluders/bodies.h"

#include <algorithm>
#include <compare>

#include "sightline/base/large_vector.h"
#include "src/base/union_find.h"

namespace sightline::occluders {
namespace {

// Of a body; vertices, faces and edges are numbered in bytes.
constexpr std::size_t kMaxFaces = 32, kMaxEdges = 64, kMaxVertices = 32;

// The mesh vertices from one corner of a polygon to the next, both included.
struct Chain {
  const FoundPolygon* polygon = nullptr;
  std::uint32_t begin = 0, length = 0;  // in the loop
  std::uint32_t owner = 0;              // which of the polygons

  std::uint32_t at(std::uint32_t i) const { return polygon->loop[(begin + i) % polygon->loop.size()]; }
  std::uint32_t from() const { return at(0); }
  std::uint32_t to() const { return at(length - 1); }
  std::pair<std::uint32_t, std::uint32_t> key() const {
    return {std::min(from(), to()), std::max(from(), to())};
  }
  bool reverses(const Chain& other) const {
    bool same = length == other.length;
    for (std::uint32_t i = 0; same && i < length; ++i) {
      same = at(i) == other.at(length - 1 - i);
    }
    return same;
  }
};

void appendChains(const FoundPolygon& polygon, std::uint32_t owner, std::vector<Chain>& chains) {
  const auto corners = static_cast<std::uint32_t>(polygon.corners.size());
  const auto size = static_cast<std::uint32_t>(polygon.loop.size());
  for (std::uint32_t i = 0; i < corners; ++i) {
    const std::uint32_t begin = polygon.corners[i], end = polygon.corners[(i + 1) % corners];
    chains.push_back({&polygon, begin, (end + size - begin) % size + 1, owner});
  }
}

// Pairs of chains that run against each other; nothing where some chain has no or several partners.
// Sorted by key, of equal ones by owner.
struct Mates {
  std::vector<Chain> chains;
  std::vector<bool> mated;  // by owner: all its chains have one

  Mates(std::span<const FoundPolygon* const> polygons) : mated(polygons.size(), true) {
    for (std::uint32_t p = 0; p < polygons.size(); ++p) {
      appendChains(*polygons[p], p, chains);
    }
    std::stable_sort(chains.begin(), chains.end(),
                     [](const Chain& a, const Chain& b) { return a.key() < b.key(); });
    for (std::size_t first = 0, last = 0; first < chains.size(); first = last) {
      while (last < chains.size() && chains[last].key() == chains[first].key()) {
        ++last;
      }
      if (last - first != 2 || !chains[first].reverses(chains[first + 1])) {
        for (std::size_t i = first; i < last; ++i) {
          mated[chains[i].owner] = false;
        }
      }
    }
  }
};

// Whether the faces bound a convex solid that has some thickness below each of them.
bool isConvex(std::span<const Vec3f> positions, std::span<const FoundPolygon* const> faces,
              double tolerance) {
  for (const FoundPolygon* face : faces) {
    double lowest = 0.0;
    for (const FoundPolygon* other : faces) {
      for (const std::uint32_t corner : other->corners) {
        const double height = face->plane.evaluate(Vec3d(positions[other->loop[corner]]));
        if (height > tolerance) {
          return false;
        }
        lowest = std::min(lowest, height);
      }
    }
    if (!(lowest < -4.0 * tolerance)) {
      return false;  // flat: a sheet may have a notch
    }
  }
  return true;
}

// A polygon of a body.
struct BodyFace {
  std::uint32_t object, body, polygon;
  friend auto operator<=>(const BodyFace&, const BodyFace&) = default;
};

// Adds bodies to a set, one after the other.
class BodyMaker {
 public:
  BodyMaker(std::span<const Vec3f> positions, OccluderSet& set) : positions_(positions), set_(set) {}

  void add(std::span<const RankedPolygon> polygons, std::span<const std::uint32_t> ids) {
    std::vector<const FoundPolygon*> faces;
    OccluderBody body;
    body.first_vertex = static_cast<std::uint32_t>(set_.body_vertices.size());
    body.first_edge = static_cast<std::uint32_t>(set_.body_edges.size());
    body.first_face = static_cast<std::uint32_t>(set_.body_faces.size());
    body.face_count = static_cast<std::uint8_t>(ids.size());
    vertices_.clear();
    for (const std::uint32_t id : ids) {
      faces.push_back(&polygons[id].polygon);
      const Occluder& occluder = set_.occluders[id];
      body.slack = std::max(body.slack, occluder.slack);
      for (const std::uint32_t corner : faces.back()->corners) {
        numberOf(faces.back()->loop[corner], body.bounds);
      }
      set_.body_faces.push_back(
          {occluder.plane, OccluderId(id), numberOf(firstCorner(*faces.back()), body.bounds)});
      set_.body_of[id] = static_cast<std::uint32_t>(set_.bodies.size());
    }
    for (const FoundPolygon* face : faces) {
      for (const std::uint32_t corner : face->corners) {
        for (const FoundPolygon* other : faces) {
          body.slack = std::max(
              body.slack,
              static_cast<float>(1.001 * other->plane.evaluate(Vec3d(positions_[face->loop[corner]]))));
        }
      }
    }
    const Mates mates(faces);
    for (std::size_t i = 0; i + 1 < mates.chains.size(); i += 2) {
      const Chain &a = mates.chains[i], &b = mates.chains[i + 1];
      set_.body_edges.push_back({numberOf(a.from(), body.bounds), numberOf(a.to(), body.bounds),
                                 static_cast<std::uint8_t>(a.owner), static_cast<std::uint8_t>(b.owner)});
    }
    body.edge_count = static_cast<std::uint8_t>(mates.chains.size() / 2);
    body.vertex_count = static_cast<std::uint8_t>(vertices_.size());
    set_.bodies.push_back(body);
  }

 private:
  static std::uint32_t firstCorner(const FoundPolygon& polygon) { return polygon.loop[polygon.corners[0]]; }

  std::uint8_t numberOf(std::uint32_t vertex, Box& bounds) {
    const auto found = std::find(vertices_.begin(), vertices_.end(), vertex);
    if (found == vertices_.end()) {
      vertices_.push_back(vertex);
      set_.body_vertices.push_back(positions_[vertex]);
      bounds.extend(positions_[vertex]);
      return static_cast<std::uint8_t>(vertices_.size() - 1);
    }
    return static_cast<std::uint8_t>(found - vertices_.begin());
  }

  std::span<const Vec3f> positions_;
  OccluderSet& set_;
  std::vector<std::uint32_t> vertices_;  // of the body
};

}  // namespace

void findBodies(std::span<const Vec3f> positions, std::span<FoundPolygon* const> polygons, double tolerance) {
  const std::vector<const FoundPolygon*> read(polygons.begin(), polygons.end());
  const Mates mates(read);
  base::UnionFind components(polygons.size());  // of polygons that share edges
  for (std::size_t i = 0; i + 1 < mates.chains.size(); ++i) {
    if (mates.chains[i].key() == mates.chains[i + 1].key()) {
      components.unite(mates.chains[i].owner, mates.chains[i + 1].owner);
    }
  }
  std::vector<std::vector<const FoundPolygon*>> component(polygons.size());
  std::vector<bool> closed(polygons.size(), true);
  for (std::uint32_t p = 0; p < polygons.size(); ++p) {
    component[components.root(p)].push_back(read[p]);
    closed[components.root(p)] = closed[components.root(p)] && mates.mated[p];
  }
  std::uint32_t next = 0;
  std::vector<std::uint32_t> number(polygons.size(), FoundPolygon::kNoBody);
  for (std::uint32_t p = 0; p < polygons.size(); ++p) {
    std::size_t edges = 0;
    for (const FoundPolygon* face : component[p]) {
      edges += face->corners.size();
    }
    edges /= 2;
    // Euler: as many vertices as edges and two, less the faces.
    const std::size_t faces = component[p].size();
    if (faces >= 4 && closed[p] && faces <= kMaxFaces && edges <= kMaxEdges &&
        edges + 2 - faces <= kMaxVertices && isConvex(positions, component[p], tolerance)) {
      number[p] = next++;
    }
  }
  for (std::uint32_t p = 0; p < polygons.size(); ++p) {
    polygons[p]->body = number[components.root(p)];
    polygons[p]->body_size = static_cast<std::uint32_t>(component[components.root(p)].size());
  }
}

void assembleBodies(std::span<const Vec3f> positions, std::span<const RankedPolygon> polygons,
                    OccluderSet& set) {
  set.body_of.assign(polygons.size(), OccluderSet::kNoBody);
  LargeVector<BodyFace> faces;
  for (std::uint32_t p = 0; p < polygons.size(); ++p) {
    if (polygons[p].polygon.body != FoundPolygon::kNoBody) {
      faces.push_back({polygons[p].object.value, polygons[p].polygon.body, p});
    }
  }
  std::sort(faces.begin(), faces.end());
  std::vector<std::uint32_t> ids;  // of one body
  BodyMaker maker(positions, set);
  for (std::size_t first = 0, last = 0; first < faces.size(); first = last) {
    ids.clear();
    while (last < faces.size() && faces[last].object == faces[first].object &&
           faces[last].body == faces[first].body) {
      ids.push_back(faces[last++].polygon);
    }
    if (ids.size() == polygons[ids[0]].polygon.body_size) {
      maker.add(polygons, ids);
    }
  }
}

}  // namespace sightline::occluders
