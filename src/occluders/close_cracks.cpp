#include "src/occluders/close_cracks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <utility>

#include "sightline/math/box.h"
#include "src/base/rows.h"
#include "src/geometry/exact_point.h"
#include "src/geometry/whole.h"
#include "src/occluders/conform_pairs.h"

namespace sightline::occluders {
namespace {

// Distances are rounded by much less than this part of themselves and of the coordinates.
constexpr double kRounded = 1e-14;

struct OpenEdge {
  std::uint32_t low = 0, high = 0;  // vertices
  friend auto operator<=>(const OpenEdge&, const OpenEdge&) = default;
};

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
      leadEdges([this](const OpenEdge& edge, std::uint32_t v) {
        const double part = partOfEdge(edge, v), distance = distanceFrom(edge, v, part);
        return Place{part > 0.0 && part < 1.0 && distance < width_, part, distance};
      });
    }
    assemble();
    return std::move(result_);
  }

  ClosedCracks join(std::span<const std::uint8_t> open) {
    takeOpenEdges(open);
    lattice_ = geometry::Lattice::of(input_.vertices);
    leadEdges([this](const OpenEdge& edge, std::uint32_t v) { return placeOn(edge, v); });
    assemble();
    return std::move(result_);
  }

  std::vector<NearMiss> findNearMisses() {
    std::vector<NearMiss> misses;
    if (!(width_ > 0.0) || !std::isfinite(width_)) {
      return misses;
    }
    findOpenEdges();
    base::Rows<std::uint32_t> next_to;  // by vertex: those at the other ends of its open edges
    next_to.group(input_.vertices.size(), [&](auto&& pair) {
      for (const OpenEdge& edge : open_) {
        pair(edge.low, edge.high);
        pair(edge.high, edge.low);
      }
    });
    struct Found {
      std::uint32_t place, edge;
      double distance;
    };
    std::vector<std::vector<Found>> parts(edgeParts());
    forEdgesAndVertices([&](std::uint32_t part, std::uint32_t edge, std::uint32_t place) {
      const std::uint32_t v = vertices_[place];
      const double at_part = std::clamp(partOfEdge(open_[edge], v), 0.0, 1.0);
      const std::uint32_t end = at_part == 0.0 ? open_[edge].low : open_[edge].high;
      const std::span<const std::uint32_t> own = next_to[v];
      if ((at_part == 0.0 || at_part == 1.0) && std::find(own.begin(), own.end(), end) != own.end()) {
        return;
      }
      const double distance = distanceFrom(open_[edge], v, at_part);
      if (distance < width_) {
        parts[part].push_back({place, edge, distance});
      }
    });
    std::vector<Found> nearest(vertices_.size(), {0, 0, width_});
    for (const std::vector<Found>& part : parts) {
      for (const Found& found : part) {
        Found& best = nearest[found.place];
        if (std::tie(found.distance, found.edge) < std::tie(best.distance, best.edge)) {
          best = found;
        }
      }
    }
    std::vector<std::uint32_t> triangle_of(input_.vertices.size());
    for (std::uint32_t i = static_cast<std::uint32_t>(input_.triangles.size()); i-- > 0;) {
      triangle_of[input_.triangles[i]] = i / 3;
    }
    for (std::uint32_t place = 0; place < nearest.size(); ++place) {
      const auto [own, edge, distance] = nearest[place];
      const std::uint32_t v = vertices_[place];
      if (distance < width_ && distance > kRounded * maxComponent(abs(at(v)))) {
        misses.push_back({v, distance, triangle_of[v], triangle_at_[edge]});
      }
    }
    return misses;
  }

 private:
  static constexpr std::uint32_t kEdgesOfPart = 1024;

  const Vec3d& at(std::uint32_t vertex) const { return input_.vertices[vertex]; }

  // Finds the edges along which more triangles run one way than the other, and their vertices.
  void findOpenEdges() {
    struct Half {
      OpenEdge edge;
      int value;
      std::uint32_t triangle;
    };
    std::vector<Half> halves;
    halves.reserve(triangles_.size());
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      const std::uint32_t a = triangles_[i], b = triangles_[i % 3 == 2 ? i - 2 : i + 1];
      if (a != b) {
        halves.push_back(
            {{std::min(a, b), std::max(a, b)}, a < b ? 1 : -1, static_cast<std::uint32_t>(i / 3)});
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
        open_.push_back({std::min(a, b), std::max(a, b)});
      }
    }
    std::sort(open_.begin(), open_.end());
    open_.erase(std::unique(open_.begin(), open_.end()), open_.end());
    listVertices();
  }

  void listVertices() {
    vertices_.clear();
    for (const OpenEdge& edge : open_) {
      vertices_.insert(vertices_.end(), {edge.low, edge.high});
    }
    std::sort(vertices_.begin(), vertices_.end());
    vertices_.erase(std::unique(vertices_.begin(), vertices_.end()), vertices_.end());
    // They are sorted by place, so that the order of the input does not matter.
    std::sort(vertices_.begin(), vertices_.end(), [&](std::uint32_t a, std::uint32_t b) {
      return std::tie(at(a).x, at(a).y, at(a).z) < std::tie(at(b).x, at(b).y, at(b).z);
    });
  }

  // The vertices of open edges by their place in vertices_, each as large as a cube of this width.
  BoxPairs vertexBoxes(double width) const {
    std::vector<Box> boxes;
    for (const std::uint32_t v : vertices_) {
      boxes.push_back(grown(at(v), at(v), 0.5 * width));
    }
    std::vector<std::uint32_t> places(boxes.size());
    std::iota(places.begin(), places.end(), 0u);
    return {boxes, places};
  }

  // In the order of their places, a vertex becomes the closest earlier one that has stayed and is close
  // enough. So those that stay are farther apart than the width.
  void mergeVertices() {
    const BoxPairs pairs = vertexBoxes(width_);
    struct Near {
      std::uint32_t later, earlier;
    };
    std::vector<std::vector<Near>> parts(pairs.partCount());
    parallel_for_(pairs.partCount(), [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t part = begin; part < end; ++part) {
        pairs.forPairs(part, [&](std::uint32_t a, std::uint32_t b) {
          if (length(at(vertices_[a]) - at(vertices_[b])) < width_) {
            parts[part].push_back({std::max(a, b), std::min(a, b)});
          }
        });
      }
    });
    base::Rows<std::uint32_t> near;
    near.group(vertices_.size(), [&](auto&& pair) {
      for (const std::vector<Near>& part : parts) {
        for (const Near& n : part) {
          pair(n.later, n.earlier);
        }
      }
    });
    std::vector<std::uint32_t> kept(input_.vertices.size());
    std::iota(kept.begin(), kept.end(), 0u);
    for (std::uint32_t i = 0; i < vertices_.size(); ++i) {
      const std::uint32_t v = vertices_[i];
      double closest = width_;
      std::sort(near[i].begin(), near[i].end());
      for (const std::uint32_t earlier : near[i]) {
        const std::uint32_t other = vertices_[earlier];
        const double distance = length(at(other) - at(v));
        if (kept[other] == other && distance < closest) {
          closest = distance;
          kept[v] = other;
        }
      }
      if (kept[v] != v) {
        ++result_.merged;
        merging_ = std::max(merging_, closest + kRounded * maxComponent(abs(at(v))));
      }
    }
    for (std::uint32_t& v : triangles_) {
      v = kept[v];
    }
  }

  // Edges are looked at in so many parts, whatever the threads.
  std::uint32_t edgeParts() const {
    return (static_cast<std::uint32_t>(open_.size()) + kEdgesOfPart - 1) / kEdgesOfPart;
  }
  // Calls use(part, edge, place) for open edges and the places of vertices, other than their ends, that may
  // be closer to them than the width; those of a part one after the other.
  template <typename Use>
  void forEdgesAndVertices(const Use& use) const {
    const BoxPairs boxes = vertexBoxes(0.0);
    parallel_for_(edgeParts(), [&](std::uint32_t begin, std::uint32_t end) {
      const std::size_t last = std::min<std::size_t>(open_.size(), std::size_t{end} * kEdgesOfPart);
      for (auto edge = begin * kEdgesOfPart; edge < last; ++edge) {
        const auto [low, high] = open_[edge];
        boxes.forMeeting(grown(min(at(low), at(high)), max(at(low), at(high)), width_),
                         [&, low = low, high = high](std::uint32_t place) {
                           if (vertices_[place] != low && vertices_[place] != high) {
                             use(edge / kEdgesOfPart, edge, place);
                           }
                         });
      }
    });
  }

  // Where on the line of the edge the vertex's nearest point is: 0 at its lower end, 1 at its higher one.
  double partOfEdge(const OpenEdge& edge, std::uint32_t v) const {
    const Vec3d along = at(edge.high) - at(edge.low);
    return dot(at(v) - at(edge.low), along) / dot(along, along);
  }
  double distanceFrom(const OpenEdge& edge, std::uint32_t v, double part) const {
    return length(at(v) - at(edge.low) - (at(edge.high) - at(edge.low)) * part);
  }

  // Whether an edge is to be led through a vertex, where along it, and how far the vertex lies beside it.
  struct Place {
    bool leads = false;
    double along = 0.0, distance = 0.0;
  };

  // Of a vertex exactly on an edge, between its ends.
  Place placeOn(const OpenEdge& edge, std::uint32_t v) const {
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

  // Leads open edges through vertices. place_of(edge, vertex) is a Place.
  template <typename PlaceOf>
  void leadEdges(const PlaceOf& place_of) {
    struct Found {
      std::uint32_t edge;
      Beside beside;
      double distance;
    };
    std::vector<std::vector<Found>> parts(edgeParts());
    forEdgesAndVertices([&](std::uint32_t part, std::uint32_t edge, std::uint32_t place) {
      const std::uint32_t v = vertices_[place];
      if (const Place found = place_of(open_[edge], v); found.leads) {
        parts[part].push_back({edge, {found.along, v}, found.distance});
      }
    });
    beside_.group(open_.size(), [&](auto&& pair) {
      for (const std::vector<Found>& part : parts) {
        for (const Found& found : part) {
          pair(found.edge, found.beside);
        }
      }
    });
    for (const std::vector<Found>& part : parts) {
      for (const Found& found : part) {
        const OpenEdge& edge = open_[found.edge];
        const double reach = std::max(maxComponent(abs(at(edge.low))), maxComponent(abs(at(edge.high))));
        bending_ = std::max(bending_, width_ > 0.0 ? found.distance + kRounded * reach : 0.0);
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
    const OpenEdge edge{std::min(a, b), std::max(a, b)};
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
        steps_.push_back({{std::min(a, b), std::max(a, b)}, a < b});
      }
    }
    std::sort(steps_.begin(), steps_.end());
    for (std::size_t i = 0; i < steps_.size();) {
      int value = 0;
      const OpenEdge edge = steps_[i].first;
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
  std::vector<OpenEdge> open_;              // ascending
  std::vector<std::uint32_t> triangle_at_;  // by open edge: one that has it
  std::vector<std::uint32_t> vertices_;     // of open edges, by place
  base::Rows<Beside> beside_;               // by open edge, along it
  std::vector<std::uint32_t> ways_[3], loop_;
  std::vector<std::pair<OpenEdge, bool>> steps_;  // along loop_; true: from the lower vertex
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

std::vector<NearMiss> findNearMisses(const ConformInput& input, double width,
                                     const ParallelFor& parallel_for) {
  return Closing(input, width, parallel_for).findNearMisses();
}

}  // namespace sightline::occluders
