#include "src/pvs/bake/panels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "src/occluders/conform.h"
#include "src/occluders/surface_mesh.h"

namespace sightline::pvs {
namespace {

// In scenes of more triangles, mostly foliage, those that penetrate each other make too many pieces.
constexpr std::uint32_t kMostPenetrating = 500'000;
constexpr std::uint32_t kMostSheets = 32;  // of a panel
constexpr double kLeastCosine = 0.98;      // of the angle between normals of a panel
constexpr std::uint32_t kNone = 0xffffffffu;

// A side of a sheet, at the edge between two vertices.
struct Use {
  std::uint32_t low = 0, high = 0;  // vertices of the edge
  std::uint32_t half = 0;           // three times the sheet, plus the number of the side
  bool rises = false;               // from the lower to the higher vertex
};

// The use that each of some uses of one edge is joined with, or kNone. `uses` are in the order of their
// angles around the edge. A sheet that rises has its front towards greater angles, one that falls towards
// smaller ones. So the pairs are those of brackets, all around.
template <typename Uses, typename LeftOut>
void joinAround(const Uses& uses, LeftOut&& left_out, std::vector<std::uint32_t>& joined) {
  const auto count = static_cast<std::uint32_t>(uses.size());
  joined.assign(count, kNone);
  std::vector<std::uint32_t> open;
  for (std::uint32_t k = 0; k < 2 * count; ++k) {
    const std::uint32_t i = k % count;
    if (left_out(i) || joined[i] != kNone) {
      continue;
    }
    if (uses[i].rises) {
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
  explicit PanelMaker(const SceneView& scene, const ParallelFor& parallel_for) {
    divide(scene, parallel_for);
  }

  Panels make() && {
    join();
    gather();
    return std::move(panels_);
  }

 private:
  std::uint32_t sheetCount() const { return static_cast<std::uint32_t>(panels_.sheets.size() / 3); }
  const Vec3d& corner(std::uint32_t sheet, std::uint32_t k) const {
    return panels_.vertices[panels_.sheets[3 * sheet + k % 3]];
  }

  void divide(const SceneView& scene, const ParallelFor& parallel_for) {
    const occluders::OpaqueTriangles given = occluders::opaqueTriangles(scene);
    std::vector<Vec3d> vertices;
    vertices.reserve(given.vertices.size());
    for (const Vec3f& vertex : given.vertices) {
      vertices.emplace_back(vertex);
    }
    const auto divide = given.objects.size() > kMostPenetrating ? occluders::Divide::kFaces
                                                                : occluders::Divide::kPenetrations;
    const occluders::ConformedMesh mesh =
        occluders::conform({vertices, given.corners}, {.divide = divide}, parallel_for);
    panels_.vertices.assign(mesh.vertices.begin(), mesh.vertices.end());
    panels_.slack = mesh.slack;
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

  // Sets joined_ and instead_.
  void join() {
    std::vector<Use> uses;
    uses.reserve(panels_.sheets.size());
    for (std::uint32_t half = 0; half < panels_.sheets.size(); ++half) {
      const std::uint32_t from = panels_.sheets[half],
                          to = panels_.sheets[half % 3 == 2 ? half - 2 : half + 1];
      uses.push_back({std::min(from, to), std::max(from, to), half, from < to});
    }
    std::sort(uses.begin(), uses.end(), [](const Use& a, const Use& b) {
      return std::tie(a.low, a.high, a.half) < std::tie(b.low, b.high, b.half);
    });
    joined_.assign(panels_.sheets.size(), kNone);
    instead_.assign(panels_.sheets.size(), kNone);
    for (std::size_t first = 0, end = 0; first < uses.size(); first = end) {
      while (end < uses.size() && uses[end].low == uses[first].low && uses[end].high == uses[first].high) {
        ++end;
      }
      joinEdge(std::span(uses).subspan(first, end - first));
    }
  }

  void joinEdge(std::span<Use> uses) {
    sortAround(uses);
    joinAround(
        uses, [](std::uint32_t) { return false; }, pairs_);
    for (std::uint32_t i = 0; i < uses.size(); ++i) {
      joined_[uses[i].half] = pairs_[i] == kNone ? kNone : uses[pairs_[i]].half;
    }
    const auto objectAt = [&](std::uint32_t i) { return object_of_[uses[i].half / 3]; };
    const auto objectBeyond = [&](std::uint32_t i) {
      return pairs_[i] == kNone ? kNone : objectAt(pairs_[i]);
    };
    for (std::uint32_t i = 0; i < uses.size(); ++i) {
      const std::uint32_t out = objectBeyond(i);
      if (out == kNone || out == objectAt(i) || instead_[uses[i].half] != kNone) {
        continue;
      }
      // Only those are joined anew that lose the one that they are joined with.
      joinAround(
          uses, [&](std::uint32_t k) { return objectAt(k) == out || objectBeyond(k) != out; }, others_);
      for (std::uint32_t k = 0; k < uses.size(); ++k) {
        if (others_[k] != kNone) {
          instead_[uses[k].half] = uses[others_[k]].half;
        }
      }
    }
  }

  // By their angles around the edge, and of one triangle's two sides the falling one first: its front is
  // towards smaller angles.
  void sortAround(std::span<Use> uses) {
    if (uses.size() < 3) {
      return;
    }
    const Vec3d origin = panels_.vertices[uses[0].low],
                axis = normalized(panels_.vertices[uses[0].high] - origin);
    Vec3d zero;
    angles_.clear();
    for (const Use& use : uses) {
      const Vec3d towards = corner(use.half / 3, use.half + 2 - use.half / 3 * 3) - origin;
      const Vec3d across = towards - axis * dot(towards, axis);
      zero = angles_.empty() ? across : zero;
      angles_.emplace_back(std::atan2(dot(axis, cross(zero, across)), dot(zero, across)), use);
    }
    std::sort(angles_.begin(), angles_.end(), [](const auto& a, const auto& b) {
      return std::tuple(a.first, a.second.rises, a.second.half) <
             std::tuple(b.first, b.second.rises, b.second.half);
    });
    std::transform(angles_.begin(), angles_.end(), uses.begin(), [](const auto& a) { return a.second; });
  }

  // Makes panels of sheets that are joined, from the first sheet on.
  void gather() {
    const std::uint32_t count = sheetCount();
    std::vector<Vec3d> normals(count);
    for (std::uint32_t i = 0; i < count; ++i) {
      normals[i] = normalized(cross(corner(i, 1) - corner(i, 0), corner(i, 2) - corner(i, 0)));
    }
    std::vector<std::uint32_t> panel_of(count, kNone), order;
    order.reserve(count);
    for (std::uint32_t seed = 0; seed < count; ++seed) {
      if (panel_of[seed] != kNone) {
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
        for (std::uint32_t half = 3 * order[next]; half < 3 * order[next] + 3; ++half) {
          const std::uint32_t other = joined_[half] == kNone ? kNone : joined_[half] / 3;
          if (other != kNone && panel_of[other] == kNone && object_of_[other] == object_of_[seed] &&
              dot(normals[other], normals[seed]) >= kLeastCosine && order.size() - first < kMostSheets) {
            take(other);
          }
        }
      }
      panels_.panels.push_back({.first_sheet = static_cast<std::uint32_t>(first),
                                .sheet_count = static_cast<std::uint32_t>(order.size() - first),
                                .object = object_of_[seed]});
    }
    addEdges(panel_of, order);
    LargeVector<std::uint32_t> sheets;
    sheets.reserve(panels_.sheets.size());
    for (const std::uint32_t sheet : order) {
      sheets.insert(sheets.end(), panels_.sheets.begin() + 3 * std::ptrdiff_t{sheet},
                    panels_.sheets.begin() + 3 * std::ptrdiff_t{sheet} + 3);
    }
    panels_.sheets = std::move(sheets);
    addBounds();
  }

  void addEdges(std::span<const std::uint32_t> panel_of, std::span<const std::uint32_t> order) {
    const auto panelOf = [&](std::uint32_t half) { return half == kNone ? kNoPanel : panel_of[half / 3]; };
    for (Panel& panel : panels_.panels) {
      panel.first_edge = static_cast<std::uint32_t>(panels_.edges.size());
      for (const std::uint32_t sheet : order.subspan(panel.first_sheet, panel.sheet_count)) {
        for (std::uint32_t k = 0; k < 3; ++k) {
          const std::uint32_t half = 3 * sheet + k;
          if (joined_[half] == kNone || panelOf(joined_[half]) != panel_of[sheet]) {
            panels_.edges.push_back({panels_.sheets[half], panels_.sheets[3 * sheet + (k + 1) % 3],
                                     panelOf(joined_[half]), panelOf(instead_[half])});
          }
        }
      }
      panel.edge_count = static_cast<std::uint32_t>(panels_.edges.size()) - panel.first_edge;
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
    panels_.tree = buildBoxTree(panels_.bounds, {});
  }

  Panels panels_;
  std::vector<std::uint32_t> object_of_;         // by sheet
  std::vector<std::uint32_t> joined_, instead_;  // by side of a sheet: a side of another one
  std::vector<std::uint32_t> pairs_, others_;
  std::vector<std::pair<double, Use>> angles_;
};

}  // namespace

Panels findPanels(const SceneView& scene, const ParallelFor& parallel_for) {
  return PanelMaker(scene, parallel_for).make();
}

}  // namespace sightline::pvs
