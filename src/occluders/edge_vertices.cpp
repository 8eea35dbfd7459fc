// Most edges of a scene have no vertex on them, and few have a place where one could be.
//
// Coordinates of single precision lie on a grid. Between two numbers of the same sign, each is a multiple of
// the last place of the one nearer to zero; and each is a multiple of the lowest bit that any of them has. So
// along each axis an edge has a whole number of units, (x, y, z), and a vertex on it, at the part t of the
// way, lies whole numbers of units from its beginning: x t, y t and z t are whole. Then t is a multiple of
// 1 / g, where g is the greatest common divisor of x, y and z. Of edges between numbers as they come from a
// modelling program, g is 1 for most, and for nearly all others so small that each place is looked up.
//
// An edge along an axis has a large g, but what lies on it has two coordinates of its ends: vertices are
// grouped by two coordinates. What remains is searched for in a tree of boxes: oblique edges between round
// numbers.

#include "src/occluders/edge_vertices.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <numeric>
#include <optional>
#include <tuple>
#include <vector>

#include "src/base/hash_slots.h"
#include "src/base/parallel_rows.h"
#include "src/base/scratch_array.h"
#include "src/geometry/exact_point.h"
#include "src/geometry/whole.h"
#include "src/occluders/conform/conform_pairs.h"
#include "src/occluders/near_line.h"

namespace sightline::occluders {
namespace {

using geometry::Lattice;

constexpr std::size_t kSearchesOfPart = 4096, kEndsOfPart = 65536, kLineRowsOfPart = 16384;
constexpr std::size_t kVerticesOfRow = 4;  // on average
constexpr int kWantedBitsOfRow = 3;        // a row has 2 to this power of bits for lines that are asked for
constexpr std::uint64_t kMostSteps = 16;   // more places of an edge than these are not looked up one by one

// How the vertices on an edge are found.
enum class Search : std::uint8_t { kAlongX, kAlongY, kAlongZ, kInSteps, kInBoxes, kNothing };

// The exponent of the last place of a number.
int lastPlace(float value) {
  const auto exponent = static_cast<int>(std::bit_cast<std::uint32_t>(value) >> 23 & 0xff);
  return std::max(exponent, 1) - 150;
}

// The exponent of the lowest bit of a number that is not 0.
int lowestBit(float value) {
  const std::uint32_t bits = std::bit_cast<std::uint32_t>(value) & 0x7fffffu;
  const bool normal = (std::bit_cast<std::uint32_t>(value) >> 23 & 0xff) != 0;
  return lastPlace(value) + std::countr_zero(normal ? bits | 0x800000u : bits);
}

double powerOfTwo(int exponent) {
  return std::bit_cast<double>(static_cast<std::uint64_t>(exponent + 1023) << 52);
}

// The places of an edge where vertices can be, at equal distances.
struct Steps {
  Vec3d step;               // from one place to the next
  std::uint64_t count = 0;  // of steps from end to end; 0: not known, too many
};

// Vertices by their two coordinates that are the same along an axis.
class AxisLines {
 public:
  // Entries are sorted by line, and along each line.
  struct Entry {
    std::uint64_t line = 0;  // the bits of the two coordinates
    float along = 0.0f;
    std::uint32_t vertex = 0;
    friend bool operator<(const Entry& a, const Entry& b) {
      return a.line != b.line     ? a.line < b.line
             : a.along != b.along ? a.along < b.along
                                  : a.vertex < b.vertex;
    }
  };

  // numbers: of the vertices to group. on_lines: points on all lines that are asked for.
  AxisLines(std::span<const Vec3f> vertices, std::span<const std::uint32_t> numbers,
            std::span<const Vec3f> on_lines, int axis, const ParallelFor& parallel_for)
      : vertices_(vertices),
        axis_(axis),
        shift_(64 - static_cast<int>(std::bit_width(numbers.size() / kVerticesOfRow + 1))) {
    // Which lines are asked for, by some bits of their hash: most vertices may be on none of them.
    const int bit_shift = shift_ - kWantedBitsOfRow;
    std::vector<bool> wanted(std::size_t{1} << (64 - bit_shift));
    for (const Vec3f& point : on_lines) {
      wanted[hashOf(entryOf(point, 0)) >> bit_shift] = true;
    }
    base::groupIntoRows(parallel_for, std::size_t{1} << (64 - shift_), numbers.size(), rows_.first(),
                        rows_.all(), [&](std::size_t begin, std::size_t end, auto&& pair) {
                          for (std::size_t i = begin; i < end; ++i) {
                            const Entry entry = entryOf(vertices[numbers[i]], numbers[i]);
                            const std::uint64_t hash = hashOf(entry);
                            if (wanted[hash >> bit_shift]) {
                              pair(static_cast<std::size_t>(hash >> shift_), entry);
                            }
                          }
                        });
    place_of_ = base::unsetVector<std::uint32_t>(rows_.items().empty() ? 0 : vertices.size());
    base::Parts(rows_.count(), kLineRowsOfPart)
        .run(parallel_for, [&](std::size_t, std::size_t begin, std::size_t end) {
          for (std::size_t row = begin; row < end; ++row) {
            std::sort(rows_[row].begin(), rows_[row].end());
            for (const Entry& entry : rows_[row]) {
              place_of_[entry.vertex] = static_cast<std::uint32_t>(&entry - rows_.items().data());
            }
          }
        });
  }

  // Returns those strictly between two of the vertices that lie on one line that was asked for, the first one
  // lower; of too many, more than kMostBends.
  std::span<const Entry> between(std::uint32_t first, std::uint32_t last) const {
    const std::span<const Entry> behind = rows_.items().subspan(place_of_[first]);
    const Entry& from = behind.front();
    const float to = vertices_[last][axis_];
    std::size_t begin = 1;
    while (begin < behind.size() && behind[begin].line == from.line && behind[begin].along == from.along) {
      ++begin;
    }
    std::size_t end = begin;  // few lie there, so each is looked at
    while (end < behind.size() && behind[end].line == from.line && behind[end].along < to &&
           end - begin <= kMostBends) {
      ++end;
    }
    return behind.subspan(begin, end - begin);
  }
  // Returns those at a point.
  std::span<const Entry> at(const Vec3f& point) const {
    return within(entryOf(point, 0), entryOf(point, 0xffffffffu));
  }

 private:
  Entry entryOf(const Vec3f& p, std::uint32_t vertex) const {
    return {std::uint64_t{bitsOf(p[(axis_ + 1) % 3])} << 32 | bitsOf(p[(axis_ + 2) % 3]), p[axis_], vertex};
  }
  // Adding zero turns -0 into +0, so that equal coordinates have equal bits.
  static std::uint32_t bitsOf(float coordinate) { return std::bit_cast<std::uint32_t>(coordinate + 0.0f); }
  static std::uint64_t hashOf(const Entry& entry) { return base::mixBits(entry.line); }
  std::size_t rowOf(const Entry& entry) const { return static_cast<std::size_t>(hashOf(entry) >> shift_); }
  // Returns those of the line of `low` that come after it and before `high`, or more than kMostBends of them.
  std::span<const Entry> within(const Entry& low, const Entry& high) const {
    const std::span<const Entry> row = rows_[rowOf(low)];
    const auto begin = std::lower_bound(row.begin(), row.end(), low);
    auto end = begin;  // few lie there, so each is looked at
    while (end != row.end() && *end < high && static_cast<std::size_t>(end - begin) <= kMostBends) {
      ++end;
    }
    return {begin, end};
  }

  std::span<const Vec3f> vertices_;
  int axis_, shift_;
  base::Rows<Entry> rows_;
  LargeVector<std::uint32_t> place_of_;  // by vertex that is in the rows: its place among all of them
};

class EdgeSearch {
 public:
  EdgeSearch(std::span<const Vec3f> vertices, std::span<const MeshEdge> edges,
             const ParallelFor& parallel_for)
      : vertices_(vertices), edges_(edges), parallel_for_(parallel_for) {}

  base::Rows<std::uint32_t> run() {
    searches_.assign(edges_.size(), Search::kNothing);
    listEnds();
    findUnits();
    chooseSearches();
    prepareSearches();
    return findAll();
  }

 private:
  // A vertex on an edge: the greater `along` is, the farther it is from the edge's lower vertex.
  struct OnEdge {
    float along = 0.0f;
    std::uint32_t vertex = 0;
    friend bool operator<(const OnEdge& a, const OnEdge& b) {
      return std::tie(a.along, a.vertex) < std::tie(b.along, b.vertex);
    }
  };
  // What lies on some edges, one after the other.
  struct Found {
    std::vector<std::uint32_t> edges, counts;  // edges that have any, and how many
    std::vector<std::uint32_t> vertices;
  };

  const Vec3f& at(std::uint32_t vertex) const { return vertices_[vertex]; }
  static bool allowed(const Vec3f& point) { return Lattice::allowed(Vec3d(point)); }

  // Lists the ends of edges, ascending, and leaves out edges that are left alone.
  void listEnds() {
    std::vector<bool> is_end(vertices_.size());
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      const auto [low, high] = edges_[e];
      if (allowed(at(low)) && allowed(at(high)) && at(low) != at(high)) {
        searches_[e] = Search::kInBoxes;
        is_end[low] = is_end[high] = true;
      }
    }
    for (std::uint32_t v = 0; v < vertices_.size(); ++v) {
      if (is_end[v]) {
        ends_.push_back(v);
      }
    }
  }

  // Finds, for each axis, the lowest bit that any coordinate has.
  void findUnits() {
    const base::Parts parts(ends_.size(), kEndsOfPart);
    constexpr int kHighest = 127;  // all may be 0
    std::vector<std::array<int, 3>> of_part(parts.count(), {kHighest, kHighest, kHighest});
    parts.run(parallel_for_, [&](std::size_t part, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
          const float coordinate = at(ends_[i])[axis];
          int& lowest = of_part[part][static_cast<std::size_t>(axis)];
          lowest = coordinate != 0.0f ? std::min(lowest, lowestBit(coordinate)) : lowest;
        }
      }
    });
    lowest_ = {kHighest, kHighest, kHighest};
    for (const std::array<int, 3>& part : of_part) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        lowest_[axis] = std::min(lowest_[axis], part[axis]);
      }
    }
  }

  // Units of an edge along an axis, and how large they are.
  struct Units {
    double count = 0.0, size = 1.0;
    bool exact = false;
  };
  Units unitsAlong(int axis, const Vec3f& low, const Vec3f& high) const {
    const float a = low[axis], b = high[axis];
    int exponent = lowest_[static_cast<std::size_t>(axis)];
    if ((a > 0.0f && b > 0.0f) || (a < 0.0f && b < 0.0f)) {
      exponent = std::max(exponent, lastPlace(std::min(std::abs(a), std::abs(b))));
    }
    // Whole numbers of less than 52 bits, their differences and their products with parts of an edge are
    // exact.
    constexpr double kExact = 0x1p52;
    const double scale = powerOfTwo(-exponent), from = a * scale, to = b * scale;
    return {to - from, powerOfTwo(exponent), std::abs(from) < kExact && std::abs(to) < kExact};
  }

  Steps stepsOf(const MeshEdge& edge) const {
    Steps steps;
    std::array<Units, 3> units;
    std::uint64_t divisor = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const Units along = unitsAlong(axis, at(edge.low), at(edge.high));
      if (!along.exact) {
        return steps;
      }
      divisor = std::gcd(divisor, static_cast<std::uint64_t>(std::abs(along.count)));
      units[static_cast<std::size_t>(axis)] = along;
    }
    for (int axis = 0; axis < 3; ++axis) {
      const Units& along = units[static_cast<std::size_t>(axis)];
      steps.step[axis] = along.count / static_cast<double>(divisor) * along.size;
    }
    steps.count = divisor;
    return steps;
  }

  // Calls visit(step, place) for the places of an edge where a vertex can be.
  template <typename Visit>
  void forEachPlace(const MeshEdge& edge, const Visit& visit) const {
    const Steps steps = stepsOf(edge);
    for (std::uint64_t i = 1; i < steps.count; ++i) {
      const Vec3d place = Vec3d(at(edge.low)) + steps.step * static_cast<double>(i);
      const Vec3f rounded(place);
      if (Vec3d(rounded) == place) {
        visit(i, rounded);
      }
    }
  }

  void chooseSearches() {
    base::Parts(edges_.size(), kSearchesOfPart)
        .run(parallel_for_, [this](std::size_t, std::size_t begin, std::size_t end) {
          for (std::size_t e = begin; e < end; ++e) {
            if (searches_[e] != Search::kNothing) {
              searches_[e] = searchOf(edges_[e]);
            }
          }
        });
  }
  Search searchOf(const MeshEdge& edge) const {
    const Vec3f &low = at(edge.low), &high = at(edge.high);
    const bool x = low.x == high.x, y = low.y == high.y, z = low.z == high.z;
    if (y && z) {
      return Search::kAlongX;
    }
    if (z && x) {
      return Search::kAlongY;
    }
    if (x && y) {
      return Search::kAlongZ;
    }
    const std::uint64_t steps = stepsOf(edge).count;
    return steps == 0 || steps > kMostSteps ? Search::kInBoxes
           : steps > 1                      ? Search::kInSteps
                                            : Search::kNothing;
  }

  void prepareSearches() {
    const auto endsIf = [this](bool wanted) {
      return wanted ? std::span<const std::uint32_t>(ends_) : std::span<const std::uint32_t>();
    };
    // By axis. Places of steps are looked up among the lines along the first axis.
    std::array<LargeVector<Vec3f>, 3> on_lines;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (searches_[e] == Search::kInSteps) {
        forEachPlace(edges_[e], [&](std::uint64_t, const Vec3f& place) { on_lines[0].push_back(place); });
      } else if (searches_[e] < Search::kInSteps) {
        on_lines[static_cast<std::size_t>(searches_[e])].push_back(at(edges_[e].low));
      }
    }
    for (int axis = 0; axis < 3; ++axis) {
      const LargeVector<Vec3f>& points = on_lines[static_cast<std::size_t>(axis)];
      lines_.emplace_back(vertices_, endsIf(!points.empty()), points, axis, parallel_for_);
    }
    const std::vector<std::uint32_t> numbers = endsInBoxes();
    std::vector<Vec3d> points;
    std::vector<Box> boxes;
    for (const std::uint32_t v : numbers) {
      points.emplace_back(at(v));
      boxes.push_back(grownBox(points.back(), points.back(), 0.0));
    }
    lattice_ = Lattice::of(points);
    boxes_.emplace(boxes, numbers);
  }

  // Lists the ends that may lie in boxes around the edges that are searched for in boxes: few, if those are
  // few. Ends in cells of a coarse grid that no such box reaches are left out. As cells share bits, a few of
  // them stay.
  std::vector<std::uint32_t> endsInBoxes() const {
    constexpr double kCells = 256.0;  // along the longest side
    constexpr std::uint64_t kBits = std::uint64_t{1} << 20;
    Box bounds;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (searches_[e] == Search::kInBoxes) {
        bounds.extend(at(edges_[e].low));
        bounds.extend(at(edges_[e].high));
      }
    }
    if (bounds.empty()) {
      return {};
    }
    const Vec3d corner(bounds.min);
    const double scale = kCells / maxComponent(Vec3d(bounds.max) - corner);
    using Cell = std::array<std::uint32_t, 3>;
    const auto cellOf = [&](const Vec3f& point) {
      const Vec3d place = (Vec3d(point) - corner) * scale;
      return Cell{static_cast<std::uint32_t>(place.x), static_cast<std::uint32_t>(place.y),
                  static_cast<std::uint32_t>(place.z)};
    };
    const auto bitOf = [](const Cell& cell) {
      return base::mixBits(std::uint64_t{cell[0]} << 40 | std::uint64_t{cell[1]} << 20 | cell[2]) % kBits;
    };
    std::vector<bool> reached(kBits);
    std::uint64_t cells = 0;
    for (std::size_t e = 0; e < edges_.size(); ++e) {
      if (searches_[e] != Search::kInBoxes) {
        continue;
      }
      const Vec3f &low = at(edges_[e].low), &high = at(edges_[e].high);
      const Cell first = cellOf(min(low, high)), last = cellOf(max(low, high));
      cells += std::uint64_t{last[0] - first[0] + 1} * (last[1] - first[1] + 1) * (last[2] - first[2] + 1);
      if (cells > ends_.size()) {
        return {ends_.begin(), ends_.end()};  // to mark them would take longer than is saved
      }
      for (Cell cell = first; cell[0] <= last[0]; ++cell[0]) {
        for (cell[1] = first[1]; cell[1] <= last[1]; ++cell[1]) {
          for (cell[2] = first[2]; cell[2] <= last[2]; ++cell[2]) {
            reached[bitOf(cell)] = true;
          }
        }
      }
    }
    std::vector<std::uint32_t> ends;
    for (const std::uint32_t v : ends_) {
      if (contains(bounds, {at(v), at(v)}) && reached[bitOf(cellOf(at(v)))]) {
        ends.push_back(v);
      }
    }
    return ends;
  }

  base::Rows<std::uint32_t> findAll() const {
    const base::Parts parts(edges_.size(), kSearchesOfPart);
    std::vector<Found> of_part(parts.count());
    parts.run(parallel_for_, [&](std::size_t part, std::size_t begin, std::size_t end) {
      Found& found = of_part[part];
      std::vector<OnEdge> on_edge;
      for (std::size_t e = begin; e < end; ++e) {
        if (searches_[e] == Search::kNothing) {
          continue;
        }
        on_edge.clear();
        find(edges_[e], searches_[e], on_edge);
        if (on_edge.empty() || on_edge.size() > kMostBends) {
          continue;
        }
        std::sort(on_edge.begin(), on_edge.end());
        found.edges.push_back(static_cast<std::uint32_t>(e));
        found.counts.push_back(static_cast<std::uint32_t>(on_edge.size()));
        for (const OnEdge& on : on_edge) {
          found.vertices.push_back(on.vertex);
        }
      }
    });
    base::Rows<std::uint32_t> all;
    all.first().assign(edges_.size() + 1, 0);
    for (const Found& found : of_part) {
      for (std::size_t i = 0; i < found.edges.size(); ++i) {
        all.first()[found.edges[i] + 1] = found.counts[i];
      }
      all.all().insert(all.all().end(), found.vertices.begin(), found.vertices.end());
    }
    std::partial_sum(all.first().begin(), all.first().end(), all.first().begin());
    return all;
  }

  // Finds what lies on an edge, in any order; of too many, kMostBends and one more or all.
  void find(const MeshEdge& edge, Search search, std::vector<OnEdge>& found) const {
    if (search == Search::kInBoxes) {
      findInBoxes(edge, found);
    } else if (search == Search::kInSteps) {
      findInSteps(edge, found);
    } else {
      findAlong(static_cast<int>(search), edge, found);
    }
  }

  void findAlong(int axis, const MeshEdge& edge, std::vector<OnEdge>& found) const {
    const Vec3f &low = at(edge.low), &high = at(edge.high);
    const bool up = low[axis] < high[axis];
    const auto between =
        lines_[static_cast<std::size_t>(axis)].between(up ? edge.low : edge.high, up ? edge.high : edge.low);
    for (const AxisLines::Entry& entry : between) {
      found.push_back({up ? entry.along : -entry.along, entry.vertex});
    }
  }

  void findInSteps(const MeshEdge& edge, std::vector<OnEdge>& found) const {
    forEachPlace(edge, [&](std::uint64_t step, const Vec3f& place) {
      for (const AxisLines::Entry& entry : lines_[0].at(place)) {
        found.push_back({static_cast<float>(step), entry.vertex});
      }
    });
  }

  void findInBoxes(const MeshEdge& edge, std::vector<OnEdge>& found) const {
    const Vec3f &low = at(edge.low), &high = at(edge.high);
    const Vec3d from(low), to(high);
    int axis = 0;  // points of a line are in the order of any coordinate that is not the same for all of them
    while (low[axis] == high[axis]) {
      ++axis;
    }
    const bool up = low[axis] < high[axis];
    const NearLine line(from, to, 0.0);
    boxes_->forMeeting(
        grownBox(min(from, to), max(from, to), 0.0), [&line](const Box& box) { return line.mayMeet(box); },
        [&](std::uint32_t v) {
          const float along = at(v)[axis];
          if ((up ? low[axis] < along && along < high[axis] : high[axis] < along && along < low[axis]) &&
              found.size() <= kMostBends && liesOnLine(from, to, Vec3d(at(v)))) {
            found.push_back({up ? along : -along, v});
          }
        });
  }
  bool liesOnLine(const Vec3d& a, const Vec3d& b, const Vec3d& p) const {
    return geometry::orientation(lattice_, 0, a, b, p) == 0 &&
           geometry::orientation(lattice_, 1, a, b, p) == 0 &&
           geometry::orientation(lattice_, 2, a, b, p) == 0;
  }

  std::span<const Vec3f> vertices_;
  std::span<const MeshEdge> edges_;
  const ParallelFor& parallel_for_;
  LargeVector<Search> searches_;     // by edge
  LargeVector<std::uint32_t> ends_;  // vertices at which edges end, ascending
  std::array<int, 3> lowest_{};      // by axis: the exponent of the lowest bit of any coordinate
  std::vector<AxisLines> lines_;     // by axis; empty if not wanted
  std::optional<BoxPairs> boxes_;    // of ends; empty if not wanted
  Lattice lattice_;                  // of ends, if there are boxes
};

}  // namespace

base::Rows<std::uint32_t> verticesOnEdges(std::span<const Vec3f> vertices, std::span<const MeshEdge> edges,
                                          const ParallelFor& parallel_for) {
  return EdgeSearch(vertices, edges, parallel_for).run();
}

}  // namespace sightline::occluders
