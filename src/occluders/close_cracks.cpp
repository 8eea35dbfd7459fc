#include "src/occluders/close_cracks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "sightline/math/box.h"
#include "src/base/hash_slots.h"
#include "src/base/rows.h"
#include "src/geometry/exact_point.h"
#include "src/geometry/whole.h"
#include "src/occluders/conform_pairs.h"

namespace sightline::occluders {
namespace {

// Distances are rounded by much less than this part of themselves and of the coordinates.
constexpr double kRounded = 1e-14;

// A vertex beside an edge or on it. The greater `along` is, the farther it is from the edge's lower end.
struct Beside {
  double along = 0.0;
  std::uint32_t vertex = 0;
};

// Grows a box in single precision, outwards, so that boxes meet if the points are closer than the width.
Box grown(const Vec3d& low, const Vec3d& high, double by) {
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    constexpr float kFar = std::numeric_limits<float>::max();
    box.min[axis] = std::nextafterf(static_cast<float>(low[axis] - by), -kFar);
    box.max[axis] = std::nextafterf(static_cast<float>(high[axis] + by), kFar);
  }
  return box;
}

// What is close to a line. Source: the separating axes of a segment and a box (Gottschalk, Lin, Manocha.
// OBBTree: a hierarchical structure for rapid interference detection. SIGGRAPH 1996), of which those that are
// normal to the line and to an edge of the box.
class Line {
 public:
  Line(const Vec3d& at, const Vec3d& to, double width) : at_(at), along_(to - at), width_(width) {}

  // False only if all of the box is farther from the line than the width.
  bool mayMeet(const Box& box) const {
    // Rounding is by much less than this part of what is added up.
    constexpr double kMargin = 1e-12;
    const Vec3d low(box.min), high(box.max);
    const Vec3d from = at_ - (low + high) * 0.5, half = (high - low) * 0.5 + Vec3d(width_, width_, width_);
    for (int axis = 0; axis < 3; ++axis) {
      const int i = (axis + 1) % 3, k = (axis + 2) % 3;
      const double p = from[i] * along_[k], q = from[k] * along_[i];
      const double reach = half[i] * std::abs(along_[k]) + half[k] * std::abs(along_[i]);
      if (std::abs(p - q) > reach + kMargin * (std::abs(p) + std::abs(q) + reach)) {
        return false;
      }
    }
    return true;
  }

 private:
  Vec3d at_, along_;
  double width_;
};

class Closing {
 public:
  Closing(const ConformInput& input, double width, const ParallelFor& parallel_for)
      : input_(input),
        width_(width),
        parallel_for_(parallel_for),
        triangles_(input.triangles.begin(), input.triangles.end()) {}

  ClosedCracks close() {
    if (width_ > 0.0 && std::isfinite(width_)) {
      findOpenEdges();
      mergeVertices();
      findOpenEdges();
      leadEdges([this](const MeshEdge& edge, std::uint32_t v) {
        const double part = partOfEdge(edge, v), distance = distanceFrom(edge, v, part);
        return Place{part > 0.0 && part < 1.0 && distance < width_, part, distance};
      });
    }
    assemble();
    return std::move(result_);
  }

  ClosedCracks join(std::span<const std::uint8_t> open) {
    takeOpenEdges(open);
    joinOpenEdges();
    assemble();
    return std::move(result_);
  }

  base::Rows<std::uint32_t> verticesOn(std::span<const MeshEdge> edges) {
    const auto taken = [this](const MeshEdge& edge) {
      return geometry::Lattice::allowed(at(edge.low)) && geometry::Lattice::allowed(at(edge.high)) &&
             at(edge.low) != at(edge.high);
    };
    std::copy_if(edges.begin(), edges.end(), std::back_inserter(open_), taken);
    listVertices();
    joinOpenEdges();
    base::Rows<std::uint32_t> on_edges;
    std::size_t next = 0;
    for (const MeshEdge& edge : edges) {
      if (next < open_.size() && open_[next] == edge) {
        for (const Beside& beside : beside_[next++]) {
          on_edges.add(beside.vertex);
        }
      }
      on_edges.endRow();
    }
    return on_edges;
  }

  std::vector<NearMiss> findNearMisses() {
    std::vector<NearMiss> misses;
    if (!(width_ > 0.0) || !std::isfinite(width_)) {
      return misses;
    }
    findOpenEdges();
    base::Rows<std::uint32_t> next_to;  // by vertex: those at the other ends of its open edges
    next_to.group(input_.vertices.size(), [&](auto&& pair) {
      for (const MeshEdge& edge : open_) {
        pair(edge.low, edge.high);
        pair(edge.high, edge.low);
      }
    });
    std::vector<Box> boxes;
    for (const MeshEdge& edge : open_) {
      boxes.push_back(grown(min(at(edge.low), at(edge.high)), max(at(edge.low), at(edge.high)), width_));
    }
    std::vector<std::uint32_t> numbers(boxes.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    const BoxPairs edges(boxes, numbers);
    std::vector<std::pair<double, std::uint32_t>> nearest(vertices_.size(), {width_, 0});  // and its edge
    parallel_for_(static_cast<std::uint32_t>(vertices_.size()), [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t place = begin; place < end; ++place) {
        const std::uint32_t v = vertices_[place];
        edges.forMeeting(grown(at(v), at(v), 0.0), [&](std::uint32_t edge) {
          const auto [low, high] = open_[edge];
          const double part = std::clamp(partOfEdge(open_[edge], v), 0.0, 1.0);
          const std::span<const std::uint32_t> own = next_to[v];
          const bool next_to_own = part == 0.0   ? std::find(own.begin(), own.end(), low) != own.end()
                                   : part == 1.0 ? std::find(own.begin(), own.end(), high) != own.end()
                                                 : false;
          if (v != low && v != high && !next_to_own) {
            nearest[place] = std::min(nearest[place], {distanceFrom(open_[edge], v, part), edge});
          }
        });
      }
    });
    std::vector<std::uint32_t> triangle_of(input_.vertices.size());
    for (std::uint32_t i = static_cast<std::uint32_t>(input_.triangles.size()); i-- > 0;) {
      triangle_of[input_.triangles[i]] = i / 3;
    }
    for (std::uint32_t place = 0; place < nearest.size(); ++place) {
      const auto [distance, edge] = nearest[place];
      const std::uint32_t v = vertices_[place];
      if (distance < width_ && distance > kRounded * maxComponent(abs(at(v)))) {
        misses.push_back({v, distance, triangle_of[v], triangle_at_[edge]});
      }
    }
    return misses;
  }

 private:
  static constexpr std::uint32_t kEdgesOfPart = 1024;
  static constexpr std::size_t kMostBends = 4096;

  const Vec3d& at(std::uint32_t vertex) const { return input_.vertices[vertex]; }

  // Finds the edges along which more triangles run one way than the other, and their vertices.
  void findOpenEdges() {
    struct Half {
      MeshEdge edge;
      int value;
      std::uint32_t triangle;
    };
    std::vector<Half> halves;
    halves.reserve(triangles_.size());
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const std::uint32_t a = triangles_[i], b = triangles_[i % 3 == 2 ? i - 2 : i + 1];
      if (a != b) {
        halves.push_back({meshEdge(a, b), a < b ? 1 : -1, static_cast<std::uint32_t>(i / 3)});
      }
    }
    std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
      return std::tie(a.edge, a.triangle) < std::tie(b.edge, b.triangle);
    });
    open_.clear();
    triangle_at_.clear();
    for (std::size_t i = 0; i < halves.size();) {
      int value = 0;
      const auto [edge, own_value, triangle] = halves[i];
      for (; i < halves.size() && halves[i].edge == edge; ++i) {
        value += halves[i].value;
      }
      if (value != 0 && geometry::Lattice::allowed(at(edge.low)) &&
          geometry::Lattice::allowed(at(edge.high))) {
        open_.push_back(edge);
        triangle_at_.push_back(triangle);
      }
    }
    listVertices();
  }

  // Takes those that are named: by triangle, bit k for the edge from corner k to the next.
  void takeOpenEdges(std::span<const std::uint8_t> open) {
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const std::uint32_t a = triangles_[i], b = triangles_[i % 3 == 2 ? i - 2 : i + 1];
      if ((open[i / 3] >> (i % 3) & 1) != 0 && a != b && geometry::Lattice::allowed(at(a)) &&
          geometry::Lattice::allowed(at(b))) {
        open_.push_back(meshEdge(a, b));
      }
    }
    std::sort(open_.begin(), open_.end());
    open_.erase(std::unique(open_.begin(), open_.end()), open_.end());
    listVertices();
  }

  void listVertices() {
    vertices_.clear();
    for (const MeshEdge& edge : open_) {
      vertices_.insert(vertices_.end(), {edge.low, edge.high});
    }
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    // They are sorted by place, so that the order of the input does not matter.
    std::sort(vertices_.begin(), vertices_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tie(at(a).x, at(a).y, at(a).z) < std::tie(at(b).x, at(b).y, at(b).z);
    });
  }

  // The vertices of open edges by their place in vertices_.
  BoxPairs vertexBoxes() const {
    std::vector<Box> boxes;
    for (const std::uint32_t v : vertices_) {
      boxes.push_back(grown(at(v), at(v), 0.0));
    }
    std::vector<std::uint32_t> places(boxes.size());
    std::iota(places.begin(), places.end(), 0u);
    return {boxes, places};
  }

  // In the order of their places, a vertex becomes the closest earlier one that has stayed and is close
  // enough. So those that stay are farther apart than the width.
  void mergeVertices() {
    std::vector<std::uint32_t> kept(input_.vertices.size());
    std::iota(kept.begin(), kept.end(), 0u);
    std::unordered_multimap<std::uint64_t, std::uint32_t> stayed;  // by cell: places in vertices_
    for (std::uint32_t place = 0; place < vertices_.size(); ++place) {
      const std::uint32_t v = vertices_[place];
      const Vec3d cell = cellOf(at(v));
      std::pair<double, std::uint32_t> closest{width_, 0};
      for (int near = 0; near < 27; ++near) {
        const int x = near % 3 - 1;
        const int y = near / 3 % 3 - 1;
        const int z = near / 9 - 1;
        const auto [begin, end] = stayed.equal_range(hashOf(cell + Vec3d(x, y, z)));
        for (auto other = begin; other != end; ++other) {
          closest = std::min(closest, {length(at(vertices_[other->second]) - at(v)), other->second});
        }
      }
      if (closest.first < width_) {
        kept[v] = vertices_[closest.second];
        ++result_.merged;
        merging_ = std::max(merging_, closest.first + kRounded * maxComponent(abs(at(v))));
      } else {
        stayed.emplace(hashOf(cell), place);
      }
    }
    for (std::uint32_t& v : triangles_) {
      v = kept[v];
    }
  }

  // Points that are closer than the width lie in the same cell of a grid or in cells that touch. Where a
  // quotient is too large for its last digit, numbers of single precision differ by more than the width.
  Vec3d cellOf(const Vec3d& p) const {
    return {std::floor(p.x / width_), std::floor(p.y / width_), std::floor(p.z / width_)};
  }
  static std::uint64_t hashOf(const Vec3d& cell) {
    std::uint64_t hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
      hash = base::mixBits(hash ^ std::bit_cast<std::uint64_t>(cell[axis] + 0.0));
    }
    return hash;
  }

  // Where on the line of the edge the vertex's nearest point is: 0 at its lower end, 1 at its higher one.
  double partOfEdge(const MeshEdge& edge, std::uint32_t v) const {
    const Vec3d along = at(edge.high) - at(edge.low);
    return dot(at(v) - at(edge.low), along) / dot(along, along);
  }
  double distanceFrom(const MeshEdge& edge, std::uint32_t v, double part) const {
    return length(at(v) - at(edge.low) - (at(edge.high) - at(edge.low)) * part);
  }

  // Whether an edge is to be led through a vertex, where along it, and how far the vertex lies beside it.
  struct Place {
    bool leads = false;
    double along = 0.0, distance = 0.0;
  };

  // Leads open edges through the vertices that lie on them exactly.
  void joinOpenEdges() {
    lattice_ = geometry::Lattice::of(input_.vertices);
    leadEdges([this](const MeshEdge& edge, std::uint32_t v) { return placeOn(edge, v); });
  }

  // Returns the place of a vertex that is exactly on an edge, between its ends.
  Place placeOn(const MeshEdge& edge, std::uint32_t v) const {
    const Vec3d &low = at(edge.low), &high = at(edge.high), &p = at(v);
    for (int axis = 0; axis < 3; ++axis) {
      if (geometry::orientation(lattice_, axis, low, high, p) != 0) {
        return {};
      }
    }
    // Points of a line are in the order of any coordinate that is not the same for all of them.
    int axis = 0;
    while (low[axis] == high[axis]) {
      ++axis;
    }
    const bool up = low[axis] < high[axis];
    const double along = up ? p[axis] : -p[axis];
    return {along > (up ? low[axis] : -low[axis]) && along < (up ? high[axis] : -high[axis]), along, 0.0};
  }

  // Leads open edges through vertices. place_of(edge, vertex) is a Place. An edge of more than kMostBends
  // places stays as it is: many long edges beside many vertices would take their product of memory.
  template <typename PlaceOf>
  void leadEdges(const PlaceOf& place_of) {
    const BoxPairs boxes = vertexBoxes();
    const auto count = static_cast<std::uint32_t>(open_.size());
    const std::uint32_t parts = (count + kEdgesOfPart - 1) / kEdgesOfPart;  // whatever the threads
    std::vector<base::Rows<Beside>> of_part(parts);
    std::vector<double> bending(parts, 0.0);
    parallel_for_(parts, [&](std::uint32_t begin, std::uint32_t end) {
      std::vector<Beside> found;
      for (std::uint32_t e = begin * kEdgesOfPart; e < std::min(count, end * kEdgesOfPart); ++e) {
        const MeshEdge& edge = open_[e];
        const std::uint32_t part = e / kEdgesOfPart;
        const double reach = std::max(maxComponent(abs(at(edge.low))), maxComponent(abs(at(edge.high))));
        double farthest = 0.0;
        found.clear();
        const Line line(at(edge.low), at(edge.high), width_);
        boxes.forMeeting(
            grown(min(at(edge.low), at(edge.high)), max(at(edge.low), at(edge.high)), width_),
            [&line](const Box& box) { return line.mayMeet(box); },
            [&](std::uint32_t place) {
              const std::uint32_t v = vertices_[place];
              if (v == edge.low || v == edge.high || found.size() > kMostBends) {
                return;
              }
              if (const Place at_edge = place_of(edge, v); at_edge.leads) {
                found.push_back({at_edge.along, v});
                farthest = std::max(farthest, width_ > 0.0 ? at_edge.distance + kRounded * reach : 0.0);
              }
            });
        if (found.size() <= kMostBends) {
          bending[part] = std::max(bending[part], farthest);
          for (const Beside& beside : found) {
            of_part[part].add(beside);
          }
        }
        of_part[part].endRow();
      }
    });
    for (std::uint32_t part = 0; part < parts; ++part) {
      bending_ = std::max(bending_, bending[part]);
      for (std::size_t row = 0; row < of_part[part].count(); ++row) {
        for (const Beside& beside : of_part[part][row]) {
          beside_.add(beside);
        }
        beside_.endRow();
      }
    }
    for (std::size_t edge = 0; edge < beside_.count(); ++edge) {
      std::sort(beside_[edge].begin(), beside_[edge].end(), [&](const Beside& a, const Beside& b) {
        return std::tie(a.along, at(a.vertex).x, at(a.vertex).y, at(a.vertex).z) <
               std::tie(b.along, at(b.vertex).x, at(b.vertex).y, at(b.vertex).z);
      });
      result_.bent += beside_[edge].size();
    }
  }

  // The vertices through which the way from a to b is led, in this direction.
  void findWay(std::uint32_t a, std::uint32_t b, std::vector<std::uint32_t>& way) const {
    way.clear();
    const MeshEdge edge = meshEdge(a, b);
    const auto found = std::lower_bound(open_.begin(), open_.end(), edge);
    if (found == open_.end() || *found != edge || beside_.count() == 0) {
      return;
    }
    for (const Beside& beside : beside_[static_cast<std::size_t>(found - open_.begin())]) {
      way.push_back(beside.vertex);
    }
    if (a > b) {
      std::reverse(way.begin(), way.end());
    }
  }

  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t source) {
    if (a != b && b != c && c != a) {
      result_.triangles.insert(result_.triangles.end(), {a, b, c});
      result_.source.push_back(source);
    } else {
      result_.collapsed.insert(result_.collapsed.end(), {a, b, c});
      result_.collapsed_source.push_back(source);
    }
  }

  // Adds the triangles between a point and each step of the way from a to b.
  void addFan(std::uint32_t point, std::uint32_t a, std::span<const std::uint32_t> way, std::uint32_t b,
              std::uint32_t source) {
    for (const std::uint32_t next : way) {
      add(point, a, next, source);
      a = next;
    }
    add(point, a, b, source);
  }

  // Whether what is left of a triangle runs back along its own border: its corners lie on a line, or have
  // come to do so.
  bool isFolded(const std::uint32_t (&corners)[3]) {
    loop_.clear();
    for (std::size_t k = 0; k < 3; ++k) {
      loop_.push_back(corners[k]);
      loop_.insert(loop_.end(), ways_[k].begin(), ways_[k].end());
    }
    steps_.clear();
    for (std::size_t i = 0; i < loop_.size(); ++i) {
      const std::uint32_t a = loop_[i], b = loop_[i + 1 < loop_.size() ? i + 1 : 0];
      if (a != b) {
        steps_.push_back({meshEdge(a, b), a < b});
      }
    }
    std::sort(steps_.begin(), steps_.end());
    for (std::size_t i = 0; i < steps_.size();) {
      int value = 0;
      const MeshEdge edge = steps_[i].first;
      for (; i < steps_.size() && steps_[i].first == edge; ++i) {
        value += steps_[i].second ? 1 : -1;
      }
      if (value != 0) {
        return false;
      }
    }
    return true;
  }

  // A triangle whose edges are led through vertices is divided as if these lay on the edges: a fan from a
  // corner to the opposite edge, whose first and last triangle are fans to the other edges.
  void addBent(const std::uint32_t (&corners)[3], std::uint32_t source) {
    for (std::size_t k = 0; k < 3; ++k) {
      findWay(corners[k], corners[(k + 1) % 3], ways_[k]);
    }
    std::size_t first = 0;
    while (first < 3 && ways_[first].empty()) {
      ++first;
    }
    if (first == 3) {
      add(corners[0], corners[1], corners[2], source);
      return;
    }
    if (isFolded(corners)) {
      for (std::size_t i = 0; i < loop_.size(); ++i) {
        const std::uint32_t next = loop_[i + 1 < loop_.size() ? i + 1 : 0];
        add(loop_[i], next, next, source);
      }
      return;
    }
    const std::uint32_t a = corners[first], b = corners[(first + 1) % 3], c = corners[(first + 2) % 3];
    const std::vector<std::uint32_t>&to_b = ways_[first], &to_c = ways_[(first + 1) % 3],
          &to_a = ways_[(first + 2) % 3];
    addFan(to_b.front(), c, to_a, a, source);
    if (to_b.size() > 1) {
      addFan(c, to_b.front(), std::span(to_b).subspan(1, to_b.size() - 2), to_b.back(), source);
    }
    addFan(to_b.back(), b, to_c, c, source);
  }

  void assemble() {
    for (std::uint32_t t = 0; t < triangles_.size() / 3; ++t) {
      const std::uint32_t corners[3] = {triangles_[3 * t], triangles_[3 * t + 1], triangles_[3 * t + 2]};
      addBent(corners, t);
    }
    result_.slack = merging_ + bending_;
  }

  const ConformInput& input_;
  const double width_;
  const ParallelFor& parallel_for_;
  std::vector<std::uint32_t> triangles_;    // as the input's, of the vertices that stay
  std::vector<MeshEdge> open_;              // ascending
  std::vector<std::uint32_t> triangle_at_;  // by open edge: one that has it
  std::vector<std::uint32_t> vertices_;     // of open edges, by place
  base::Rows<Beside> beside_;               // by open edge, along it
  std::vector<std::uint32_t> ways_[3], loop_;
  std::vector<std::pair<MeshEdge, bool>> steps_;  // along loop_; true: from the lower vertex
  geometry::Lattice lattice_;                     // if vertices have to lie on edges exactly
  double merging_ = 0.0, bending_ = 0.0;          // how far each step moves a point at most
  ClosedCracks result_;
};

}  // namespace

ClosedCracks closeCracks(const ConformInput& input, double width, const ParallelFor& parallel_for) {
  return Closing(input, width, parallel_for).close();
}

ClosedCracks joinEdges(const ConformInput& input, std::span<const std::uint8_t> open,
                       const ParallelFor& parallel_for) {
  return Closing(input, 0.0, parallel_for).join(open);
}

base::Rows<std::uint32_t> verticesOnEdges(std::span<const Vec3d> vertices, std::span<const MeshEdge> edges,
                                          const ParallelFor& parallel_for) {
  return Closing({vertices, {}}, 0.0, parallel_for).verticesOn(edges);
}

std::vector<NearMiss> findNearMisses(const ConformInput& input, double width,
                                     const ParallelFor& parallel_for) {
  return Closing(input, width, parallel_for).findNearMisses();
}

}  // namespace sightline::occluders
