#include "src/occluders/conform/close_cracks.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "sightline/math/box.h"
#include "src/base/hash_slots.h"
#include "src/base/rows.h"
#include "src/geometry/whole.h"
#include "src/occluders/conform/conform_pairs.h"
#include "src/occluders/near_line.h"

namespace sightline::occluders {
namespace {

// Distances are rounded by much less than this part of themselves and of the coordinates.
constexpr double kRounded = 1e-14;

// No two numbers of single precision are closer than this. With much smaller widths, cells overflow.
constexpr double kLeastWidth = std::numeric_limits<float>::denorm_min();

// A vertex beside an edge. The greater `along` is, the farther it is from the edge's lower end.
struct Beside {
  double along = 0.0;
  std::uint32_t vertex = 0;
};

class Closing {
 public:
  Closing(const ConformInput& input, double width, const ParallelFor& parallel_for)
      : input_(input),
        width_(width),
        parallel_for_(parallel_for),
        triangles_(input.triangles.begin(), input.triangles.end()) {}

  ClosedCracks close() {
    if (width_ >= kLeastWidth && std::isfinite(width_)) {
      findOpenEdges();
      mergeVertices();
      findOpenEdges();
      leadEdges();
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
      for (const MeshEdge& edge : open_) {
        pair(edge.low, edge.high);
        pair(edge.high, edge.low);
      }
    });
    std::vector<Box> boxes;
    for (const MeshEdge& edge : open_) {
      boxes.push_back(grownBox(min(at(edge.low), at(edge.high)), max(at(edge.low), at(edge.high)), width_));
    }
    std::vector<std::uint32_t> numbers(boxes.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    const BoxPairs edges(boxes, numbers);
    std::vector<std::pair<double, std::uint32_t>> nearest(vertices_.size(), {width_, 0});  // and its edge
    parallel_for_(static_cast<std::uint32_t>(vertices_.size()), [&](std::uint32_t begin, std::uint32_t end) {
      for (std::uint32_t place = begin; place < end; ++place) {
        const std::uint32_t v = vertices_[place];
        edges.forMeeting(grownBox(at(v), at(v), 0.0), [&](std::uint32_t edge) {
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
      boxes.push_back(grownBox(at(v), at(v), 0.0));
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

  // Leads open edges through the vertices beside them.
  void leadEdges() {
    const BoxPairs boxes = vertexBoxes();
    const auto count = static_cast<std::uint32_t>(open_.size());
    const std::uint32_t parts = (count + kEdgesOfPart - 1) / kEdgesOfPart;  // whatever the threads
    std::vector<base::Rows<Beside>> of_part(parts);
    std::vector<double> bending(parts, 0.0);
    parallel_for_(parts, [&](std::uint32_t begin, std::uint32_t end) {
      std::vector<Beside> found;
      for (std::uint32_t e = begin * kEdgesOfPart; e < std::min(count, end * kEdgesOfPart); ++e) {
        const std::uint32_t part = e / kEdgesOfPart;
        const double farthest = findBeside(boxes, open_[e], found);
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
        const std::span<Beside> beside = of_part[part][row];
        std::sort(beside.begin(), beside.end(), [&](const Beside& a, const Beside& b) {
          return std::tie(a.along, at(a.vertex).x, at(a.vertex).y, at(a.vertex).z) <
                 std::tie(b.along, at(b.vertex).x, at(b.vertex).y, at(b.vertex).z);
        });
        for (const Beside& b : beside) {
          through_.add(b.vertex);
        }
        through_.endRow();
        result_.bent += beside.size();
      }
    }
  }

  // Finds the vertices beside an edge, or kMostBends of them and one more. Returns a bound of how far they
  // lie beside it.
  double findBeside(const BoxPairs& boxes, const MeshEdge& edge, std::vector<Beside>& found) const {
    const double reach = std::max(maxComponent(abs(at(edge.low))), maxComponent(abs(at(edge.high))));
    double farthest = 0.0;
    found.clear();
    const NearLine line(at(edge.low), at(edge.high), width_);
    boxes.forMeeting(
        grownBox(min(at(edge.low), at(edge.high)), max(at(edge.low), at(edge.high)), width_),
        [&line](const Box& box) { return line.mayMeet(box); },
        [&](std::uint32_t place) {
          const std::uint32_t v = vertices_[place];
          if (v == edge.low || v == edge.high || found.size() > kMostBends) {
            return;
          }
          const double part = partOfEdge(edge, v), distance = distanceFrom(edge, v, part);
          if (part > 0.0 && part < 1.0 && distance < width_) {
            found.push_back({part, v});
            farthest = std::max(farthest, distance + kRounded * reach);
          }
        });
    return farthest;
  }

  void assemble() {
    const std::span<const MeshEdge> led = through_.count() > 0 ? open_ : std::span<const MeshEdge>();
    TriangleBender bender(led, through_, result_);
    for (std::uint32_t t = 0; t < triangles_.size() / 3; ++t) {
      bender.add({triangles_[3 * t], triangles_[3 * t + 1], triangles_[3 * t + 2]}, t);
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
  base::Rows<std::uint32_t> through_;       // by open edge: the vertices that it is led through
  double merging_ = 0.0, bending_ = 0.0;    // how far each step moves a point at most
  ClosedCracks result_;
};

}  // namespace

ClosedCracks closeCracks(const ConformInput& input, double width, const ParallelFor& parallel_for) {
  return Closing(input, width, parallel_for).close();
}

std::vector<NearMiss> findNearMisses(const ConformInput& input, double width,
                                     const ParallelFor& parallel_for) {
  return Closing(input, width, parallel_for).findNearMisses();
}

}  // namespace sightline::occluders
