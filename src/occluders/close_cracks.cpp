#include "src/occluders/close_cracks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>

#include "sightline/math/box.h"
#include "src/base/rows.h"
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

// A vertex beside an edge, at this part of its length.
struct Beside {
  double at = 0.0;
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

  ClosedCracks run() {
    if (width_ > 0.0 && std::isfinite(width_)) {
      findOpenEdges();
      mergeVertices();
      findOpenEdges();
      bendEdges();
    }
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
    const auto edges = static_cast<std::uint32_t>(open_.size());
    const BoxPairs pairs = edgesAndVertices();
    std::vector<std::vector<Found>> parts(pairs.partCount());
    forPairs(pairs, parallel_for_, [&](std::uint32_t part, std::uint32_t a, std::uint32_t b) {
      const std::uint32_t edge = std::min(a, b), place = std::max(a, b) - edges;
      if (edge >= edges || std::max(a, b) < edges) {
        return;
      }
      const std::uint32_t v = vertices_[place];
      const auto [low, high] = open_[edge];
      if (v == low || v == high) {
        return;
      }
      const double at_part = std::clamp(partOfEdge(open_[edge], v), 0.0, 1.0);
      const std::uint32_t end = at_part == 0.0 ? low : high;
      const std::span<const std::uint32_t> own = next_to[v];
      if ((at_part == 0.0 || at_part == 1.0) && std::find(own.begin(), own.end(), end) != own.end()) {
        return;
      }
      const double distance = length(at(v) - at(low) - (at(high) - at(low)) * at_part);
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

  // Calls use(part, a, b) for boxes that meet, on several threads.
  template <typename Use>
  static void forPairs(const BoxPairs& pairs, const ParallelFor& parallel_for, const Use& use) {
    parallel_for(pairs.partCount(), [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t part = begin; part < end; ++part) {
        pairs.forPairs(part, [&](std::uint32_t a, std::uint32_t b) { use(part, a, b); });
      }
    });
  }

  static std::vector<std::uint32_t> numbersTo(std::size_t count) {
    std::vector<std::uint32_t> numbers(count);
    std::iota(numbers.begin(), numbers.end(), 0u);
    return numbers;
  }

  // In the order of their places, a vertex becomes the closest earlier one that has stayed and is close
  // enough. So those that stay are farther apart than the width.
  void mergeVertices() {
    std::vector<Box> boxes;
    for (const std::uint32_t v : vertices_) {
      boxes.push_back(grown(at(v), at(v), 0.5 * width_));
    }
    const BoxPairs pairs(boxes, numbersTo(boxes.size()));
    struct Near {
      std::uint32_t later, earlier;
    };
    std::vector<std::vector<Near>> parts(pairs.partCount());
    forPairs(pairs, parallel_for_, [&](std::uint32_t part, std::uint32_t a, std::uint32_t b) {
      if (length(at(vertices_[a]) - at(vertices_[b])) < width_) {
        parts[part].push_back({std::max(a, b), std::min(a, b)});
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

  // The boxes of open edges and then those of their vertices, which meet if they are closer than the width.
  BoxPairs edgesAndVertices() const {
    std::vector<Box> boxes;
    for (const OpenEdge& edge : open_) {
      boxes.push_back(grown(min(at(edge.low), at(edge.high)), max(at(edge.low), at(edge.high)), width_));
    }
    for (const std::uint32_t v : vertices_) {
      boxes.push_back(grown(at(v), at(v), 0.0));
    }
    return {boxes, numbersTo(boxes.size())};
  }

  // Where on the line of the edge the vertex's nearest point is: 0 at its lower end, 1 at its higher one.
  double partOfEdge(const OpenEdge& edge, std::uint32_t v) const {
    const Vec3d along = at(edge.high) - at(edge.low);
    return dot(at(v) - at(edge.low), along) / dot(along, along);
  }

  void bendEdges() {
    const auto edges = static_cast<std::uint32_t>(open_.size());
    const BoxPairs pairs = edgesAndVertices();
    struct Found {
      std::uint32_t edge;
      Beside beside;
      double distance;
    };
    std::vector<std::vector<Found>> parts(pairs.partCount());
    forPairs(pairs, parallel_for_, [&](std::uint32_t part, std::uint32_t a, std::uint32_t b) {
      const std::uint32_t edge = std::min(a, b), place = std::max(a, b);
      if (edge >= edges || place < edges) {
        return;
      }
      const std::uint32_t v = vertices_[place - edges];
      const auto [low, high] = open_[edge];
      const double part_of_edge = partOfEdge(open_[edge], v);
      const double distance = length(at(v) - at(low) - (at(high) - at(low)) * part_of_edge);
      if (v != low && v != high && part_of_edge > 0.0 && part_of_edge < 1.0 && distance < width_) {
        parts[part].push_back({edge, {part_of_edge, v}, distance});
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
        bending_ = std::max(bending_, found.distance + kRounded * reach);
      }
    }
    for (std::size_t edge = 0; edge < beside_.count(); ++edge) {
      std::sort(beside_[edge].begin(), beside_[edge].end(), [&](const Beside& a, const Beside& b) {
        return std::tie(a.at, at(a.vertex).x, at(a.vertex).y, at(a.vertex).z) <
               std::tie(b.at, at(b.vertex).x, at(b.vertex).y, at(b.vertex).z);
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
  std::vector<std::uint32_t> ways_[3];
  double merging_ = 0.0, bending_ = 0.0;  // how far each step moves a point at most
  ClosedCracks result_;
};

}  // namespace

ClosedCracks closeCracks(const ConformInput& input, double width, const ParallelFor& parallel_for) {
  return Closing(input, width, parallel_for).run();
}

std::vector<NearMiss> findNearMisses(const ConformInput& input, double width,
                                     const ParallelFor& parallel_for) {
  return Closing(input, width, parallel_for).findNearMisses();
}

}  // namespace sightline::occluders
