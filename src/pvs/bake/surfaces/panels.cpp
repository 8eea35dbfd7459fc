#include "src/pvs/bake/surfaces/panels.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

#include "src/base/scratch_array.h"
#include "src/occluders/conform/conform.h"
#include "src/occluders/surfaces/surface_mesh.h"
#include "src/pvs/bake/update/number_hash.h"

namespace sightline::pvs {
namespace {

// In scenes of more triangles, mostly foliage, those that penetrate each other make too many pieces.
constexpr std::uint32_t kMostPenetrating = 500'000;
constexpr double kLeastCosine = 0.98;  // of the angle between normals of a panel
constexpr std::uint32_t kNone = 0xffffffffu;

// The least power of two that is not smaller; 0 for 0. The slack counts in all questions to all panels, so it
// had better not change with every object that moves.
double roundedUp(double slack) {
  int exponent = 0;
  const double fraction = std::frexp(slack, &exponent);
  return fraction > 0.5 ? std::ldexp(1.0, exponent) : slack;
}

// Each sheet has three half-edges: number 3 s + k runs from corner k of sheet s to the next one.
constexpr std::uint32_t sheetOf(std::uint32_t half_edge) {
  return half_edge / 3;
}
constexpr std::uint32_t nextInSheet(std::uint32_t half_edge) {
  return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1;
}

// A half-edge at the edge between two vertices.
struct HalfEdge {
  std::uint32_t low = 0, high = 0;  // vertices of the edge
  std::uint32_t number = 0;
  bool rises = false;  // from the lower to the higher vertex
};

// The one that each of some half-edges at one edge is joined with, or kNone. They are in the order of their
// sheets' angles around the edge. A sheet whose half-edge rises has its front towards greater angles, one
// whose falls towards smaller ones. So the pairs are those of brackets, all around.
void joinAround(std::span<const HalfEdge> around, std::vector<std::uint32_t>& joined) {
  const auto count = static_cast<std::uint32_t>(around.size());
  joined.assign(count, kNone);
  std::vector<std::uint32_t> open;
  for (std::uint32_t k = 0; k < 2 * count; ++k) {
    const std::uint32_t i = k % count;
    if (joined[i] != kNone) {
      continue;
    }
    if (around[i].rises) {
      if (k < count) {
        open.push_back(i);
      }
    } else if (!open.empty()) {
      joined[i] = open.back();
      joined[open.back()] = i;
      open.pop_back();
    }
  }
}

class PanelMaker {
 public:
  explicit PanelMaker(std::uint32_t most_sheets) : most_sheets_(most_sheets) {}

  Panels make(const SceneView& scene, const ParallelFor& parallel_for) && {
    divideTriangles(scene, parallel_for);
    join();
    gather();
    return std::move(panels_);
  }

 private:
  std::uint32_t sheetCount() const { return static_cast<std::uint32_t>(panels_.sheets.size() / 3); }
  // Where a half-edge begins.
  const Vec3d& startOf(std::uint32_t half_edge) const { return panels_.vertices[panels_.sheets[half_edge]]; }

  void divideTriangles(const SceneView& scene, const ParallelFor& parallel_for) {
    const occluders::OpaqueTriangles given = occluders::opaqueTriangles(scene, parallel_for);
    std::vector<Vec3d> vertices;
    vertices.reserve(given.vertices.size());
    for (const Vec3f& vertex : given.vertices) {
      vertices.emplace_back(vertex);
    }
    const bool many = given.objects.size() > kMostPenetrating;
    const occluders::ConformedMesh mesh = occluders::conform(
        {vertices, given.corners},
        {.divide = many ? occluders::Divide::kFaces : occluders::Divide::kPenetrations}, parallel_for);
    panels_.vertices.assign(mesh.vertices.begin(), mesh.vertices.end());
    content_of_.resize(scene.objects.size());
    for (std::size_t i = 0; i < given.objects.size(); ++i) {
      NumberHash hash;
      hash.add(content_of_[given.objects[i]]);
      for (std::size_t corner = 3 * i; corner < 3 * i + 3; ++corner) {
        hash.add(vertices[given.corners[corner]]);
      }
      content_of_[given.objects[i]] = hash.value();
    }
    panels_.slack = roundedUp(mesh.slack);
    for (std::size_t i = 0; i < mesh.source.size(); ++i) {
      const std::uint32_t object = given.objects[mesh.source[i]];
      const std::uint32_t* corners = mesh.triangles.data() + 3 * i;
      panels_.sheets.insert(panels_.sheets.end(), corners, corners + 3);
      object_of_.push_back(object);
      if (scene.materialOf(scene.objects[object]).double_sided) {
        panels_.sheets.insert(panels_.sheets.end(), {corners[2], corners[1], corners[0]});
        object_of_.push_back(object);
      }
    }
  }

  // Sets joined_, rings_ and ring_of_.
  void join() {
    rings_.reserve(panels_.sheets.size());
    for (std::uint32_t number = 0; number < panels_.sheets.size(); ++number) {
      const std::uint32_t from = panels_.sheets[number], to = panels_.sheets[nextInSheet(number)];
      rings_.push_back({std::min(from, to), std::max(from, to), number, from < to});
    }
    std::sort(rings_.begin(), rings_.end(), [](const HalfEdge& a, const HalfEdge& b) {
      return std::tie(a.low, a.high, a.number) < std::tie(b.low, b.high, b.number);
    });
    joined_.assign(panels_.sheets.size(), kNone);
    ring_of_.resize(panels_.sheets.size());
    for (std::uint32_t first = 0, end = 0; first < rings_.size(); first = end) {
      while (end < rings_.size() && rings_[end].low == rings_[first].low &&
             rings_[end].high == rings_[first].high) {
        ++end;
      }
      const std::span<HalfEdge> around = std::span(rings_).subspan(first, end - first);
      sortAround(around);
      joinAround(around, pairs_);
      for (std::uint32_t i = 0; i < around.size(); ++i) {
        joined_[around[i].number] = pairs_[i] == kNone ? kNone : around[pairs_[i]].number;
        ring_of_[around[i].number] = {first, end - first, i};
      }
    }
  }

  // By their sheets' angles around the edge, and of the two sheets of one triangle the falling one first: its
  // front is towards smaller angles.
  void sortAround(std::span<HalfEdge> around) {
    if (around.size() < 3) {
      return;
    }
    const Vec3d origin = panels_.vertices[around[0].low],
                axis = normalized(panels_.vertices[around[0].high] - origin);
    Vec3d zero;
    angles_.clear();
    for (const HalfEdge& half_edge : around) {
      const Vec3d towards = startOf(nextInSheet(nextInSheet(half_edge.number))) - origin;
      const Vec3d across = towards - axis * dot(towards, axis);
      zero = angles_.empty() ? across : zero;
      angles_.emplace_back(std::atan2(dot(axis, cross(zero, across)), dot(zero, across)), half_edge);
    }
    std::sort(angles_.begin(), angles_.end(), [](const auto& a, const auto& b) {
      return std::tuple(a.first, a.second.rises, a.second.number) <
             std::tuple(b.first, b.second.rises, b.second.number);
    });
    std::transform(angles_.begin(), angles_.end(), around.begin(), [](const auto& a) { return a.second; });
  }

  // Makes panels of sheets that are joined, from the first sheet on.
  void gather() {
    const std::uint32_t count = sheetCount();
    std::vector<Vec3d> normals(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      const Vec3d &a = startOf(3 * i), &b = startOf(3 * i + 1), &c = startOf(3 * i + 2);
      normals[i] = normalized(cross(b - a, c - a));
    }
    std::vector<std::uint32_t> panel_of(count, kNoPanel), order;
    order.reserve(count);
    for (std::uint32_t seed = 0; seed < count; ++seed) {
      if (panel_of[seed] != kNoPanel) {
        continue;
      }
      const auto number = static_cast<std::uint32_t>(panels_.panels.size());
      const std::size_t first = order.size();
      const auto take = [&](std::uint32_t sheet) {
        panel_of[sheet] = number;
        order.push_back(sheet);
      };
      take(seed);
      for (std::size_t next = first; next < order.size(); ++next) {
        for (std::uint32_t half_edge = 3 * order[next]; half_edge < 3 * order[next] + 3; ++half_edge) {
          if (joined_[half_edge] == kNone) {
            continue;
          }
          const std::uint32_t other = sheetOf(joined_[half_edge]);
          if (panel_of[other] == kNoPanel && object_of_[other] == object_of_[seed] &&
              dot(normals[other], normals[seed]) >= kLeastCosine && order.size() - first < most_sheets_) {
            take(other);
          }
        }
      }
      panels_.panels.push_back({.first_sheet = static_cast<std::uint32_t>(first),
                                .sheet_count = static_cast<std::uint32_t>(order.size() - first),
                                .object = object_of_[seed]});
    }
    addEdges(panel_of, order);
    base::freeVector(rings_);
    base::freeVector(ring_of_);
    base::freeVector(joined_);
    LargeVector<std::uint32_t> sheets;
    sheets.reserve(panels_.sheets.size());
    for (const std::uint32_t sheet : order) {
      sheets.insert(sheets.end(), panels_.sheets.begin() + 3 * std::ptrdiff_t{sheet},
                    panels_.sheets.begin() + 3 * std::ptrdiff_t{sheet} + 3);
    }
    panels_.sheets = std::move(sheets);
    addRanks();
    addBounds();
  }

  void addEdges(std::span<const std::uint32_t> panel_of, std::span<const std::uint32_t> order) {
    const auto panelAt = [&](std::uint32_t half_edge) {
      return half_edge == kNone ? kNoPanel : panel_of[sheetOf(half_edge)];
    };
    // By index into rings_: where those of that edge are in Panels::around, or kNone.
    std::vector<std::uint32_t> added(rings_.size(), kNone);
    const auto addRing = [&](const RingPlace& place) {
      if (added[place.first] == kNone) {
        added[place.first] = static_cast<std::uint32_t>(panels_.around.size());
        for (const HalfEdge& half_edge : std::span(rings_).subspan(place.first, place.count)) {
          panels_.around.push_back(
              {panelAt(half_edge.number), panelAt(joined_[half_edge.number]), half_edge.rises});
        }
      }
      return added[place.first];
    };
    for (Panel& panel : panels_.panels) {
      panel.first_edge = static_cast<std::uint32_t>(panels_.edges.size());
      for (const std::uint32_t sheet : order.subspan(panel.first_sheet, panel.sheet_count)) {
        for (std::uint32_t number = 3 * sheet; number < 3 * sheet + 3; ++number) {
          if (panelAt(joined_[number]) == panel_of[sheet]) {
            continue;
          }
          PanelEdge edge{panels_.sheets[number], panels_.sheets[nextInSheet(number)],
                         panelAt(joined_[number])};
          if (const RingPlace& place = ring_of_[number]; place.count > 2) {
            edge.ring = static_cast<std::uint32_t>(panels_.rings.size());
            panels_.rings.push_back({addRing(place), place.count, place.self});
          }
          panels_.edges.push_back(edge);
        }
      }
      panel.edge_count = static_cast<std::uint32_t>(panels_.edges.size()) - panel.first_edge;
    }
  }

  void addRanks() {
    panels_.ranks.resize(panels_.panels.size());
    for (std::size_t i = 0; i < panels_.panels.size(); ++i) {
      const Panel& panel = panels_.panels[i];
      NumberHash hash;
      hash.add(content_of_[panel.object]);
      for (const std::uint32_t vertex : panels_.sheetsOf(panel)) {
        hash.add(panels_.vertices[vertex]);
      }
      panels_.ranks[i] = {kMostSteps, hash.value()};
    }
    countSteps();
    std::vector<std::uint32_t> sorted(panels_.panels.size());
    std::iota(sorted.begin(), sorted.end(), 0u);
    std::ranges::stable_sort(sorted, {}, [this](std::uint32_t panel) { return panels_.ranks[panel]; });
    panels_.order.resize(sorted.size());
    for (std::uint32_t place = 0; place < sorted.size(); ++place) {
      panels_.order[sorted[place]] = place;
    }
  }

  // Counts each panel's steps to the nearest border, from the borders inwards.
  void countSteps() {
    std::vector<std::uint32_t> reached;
    const auto reach = [&](std::uint32_t panel, std::uint32_t steps) {
      if (steps < panels_.ranks[panel].steps) {
        panels_.ranks[panel].steps = steps;
        reached.push_back(panel);
      }
    };
    for (std::uint32_t i = 0; i < panels_.panels.size(); ++i) {
      for (const PanelEdge& edge : panels_.edgesOf(panels_.panels[i])) {
        if (edge.beyond == kNoPanel) {
          reach(i, 0);
        }
      }
    }
    for (std::size_t next = 0; next < reached.size(); ++next) {
      for (const PanelEdge& edge : panels_.edgesOf(panels_.panels[reached[next]])) {
        if (edge.beyond != kNoPanel) {
          reach(edge.beyond, panels_.ranks[reached[next]].steps + 1);
        }
      }
    }
  }

  void addBounds() {
    for (const Panel& panel : panels_.panels) {
      Box box;
      for (const std::uint32_t vertex : panels_.sheetsOf(panel)) {
        box.extend(Vec3f(panels_.vertices[vertex]));
      }
      // Single precision is off by less than half of its last place.
      const double reach = maxComponent(max(abs(Vec3d(box.min)), abs(Vec3d(box.max))));
      panels_.bounds.push_back(widened(box, panels_.slack + 0x1p-24 * reach));
    }
    std::vector<std::uint32_t> numbers(panels_.panels.size());
    std::iota(numbers.begin(), numbers.end(), 0u);
    panels_.tree = ConeTree(panels_.bounds, numbers);
  }

  Panels panels_;
  std::vector<std::uint64_t> content_of_;  // by object: a hash of its triangles as they were given
  std::vector<std::uint32_t> object_of_;   // by sheet
  std::vector<std::uint32_t> joined_;      // by half-edge: one of another sheet, or kNone
  std::vector<HalfEdge> rings_;            // those of one edge together, by their sheets' angles
  struct RingPlace {
    std::uint32_t first = 0, count = 0;  // of its edge, in rings_
    std::uint32_t self = 0;              // itself, from the first one on
  };
  std::vector<RingPlace> ring_of_;  // by half-edge
  std::uint32_t most_sheets_;       // of a panel
  // Scratch for one edge.
  std::vector<std::uint32_t> pairs_;
  std::vector<std::pair<double, HalfEdge>> angles_;
};

}  // namespace

Panels findPanels(const SceneView& scene, std::uint32_t most_sheets, const ParallelFor& parallel_for) {
  return PanelMaker(most_sheets).make(scene, parallel_for);
}

}  // namespace sightline::pvs
