// Shell, main deck, double bottom and bulkheads.

#include <algorithm>
#include <cmath>

#include "scenes/ship_parts.h"

namespace sightline::scenes::ship {
namespace {

constexpr double kFrame = 5.0;  // maximum distance between frames, metres

// A corner of half a cross-section: its fraction of the half breadth, and its height.
struct Row {
  double part, z;
};
constexpr std::array<Row, 9> kRows = {{{0.0, 0.0},
                                       {0.8, 0.0},
                                       {0.95, 0.5},
                                       {1.0, 1.5},
                                       {1.0, 6.0},
                                       {1.0, 10.0},
                                       {1.0, 14.0},
                                       {1.0, 17.5},
                                       {1.0, kBulwarkTop}}};

// y and z of a row's corner at x, `inside` metres within the shell's outer side.
Point2 corner(double x, std::size_t row, double inside) {
  const Row& r = kRows[row];
  const double y = r.part * halfBreadth(x, r.z), up = r.z < 0.1 ? 1.0 : r.z < 1.0 ? 0.6 : 0.0;
  return {std::max(0.0, y - inside * r.part), r.z + up * inside};
}

void addShellPlate(MeshBuilder& mesh, double x0, double x1, std::size_t row, bool port) {
  std::array<Vec3d, 8> c;
  for (std::size_t k = 0; k < 8; ++k) {
    // Bit 0 (east) is the bow, bit 1 (north) the outside, bit 2 (top) the upper row. To starboard, north is
    // inside.
    const bool outside = ((k & 2) != 0) == port;
    const double x = k & 1 ? x1 : x0;
    const Point2 p = corner(x, k & 4 ? row + 1 : row, outside ? 0.0 : kShell);
    c[k] = {x, port ? p.x : -p.x, p.y};
  }
  addHexahedron(mesh, c);
}

void addShell(MeshBuilder& mesh) {
  const auto frames = static_cast<std::uint32_t>(kHullLength / kFrame);
  for (const bool port : {false, true}) {
    for (std::uint32_t f = 0; f < frames; ++f) {
      for (std::size_t row = 0; row + 1 < kRows.size(); ++row) {
        mesh.startObject(std::string("hull ") + (port ? "port " : "starboard ") + std::to_string(f) +
                             " plate " + std::to_string(row),
                         id(Paint::kHull));
        addShellPlate(mesh, f * kFrame, (f + 1) * kFrame, row, port);
      }
    }
  }
}

// A level plate from shell to shell, without the part closer than `inner` to the centre line.
struct Level {
  std::string name;
  double x0, x1, z0, z1, inner = 0.0;
  Paint paint = Paint::kDeck;
};

void addLevel(MeshBuilder& mesh, const Level& level) {
  const double pieces = std::ceil((level.x1 - level.x0) / kFrame);
  const auto at = [&](double i) { return level.x0 + (level.x1 - level.x0) * i / pieces; };
  for (double i = 0.0; i < pieces; ++i) {
    const double a = at(i), b = at(i + 1);
    const double at_a = halfBreadthInShell(a, level.z0), at_b = halfBreadthInShell(b, level.z0);
    const std::string name = level.name + " " + std::to_string(static_cast<int>(i));
    if (level.inner == 0.0) {
      mesh.startObject(name, id(level.paint));
      mesh.prism(std::array<Point2, 4>{{{a, -at_a}, {b, -at_b}, {b, at_b}, {a, at_a}}}, level.z0, level.z1);
      continue;
    }
    mesh.startObject(name + " port", id(level.paint));
    mesh.prism(std::array<Point2, 4>{{{a, level.inner}, {b, level.inner}, {b, at_b}, {a, at_a}}}, level.z0,
               level.z1);
    mesh.startObject(name + " starboard", id(level.paint));
    mesh.prism(std::array<Point2, 4>{{{a, -at_a}, {b, -at_b}, {b, -level.inner}, {a, -level.inner}}},
               level.z0, level.z1);
  }
}

// Adds a plate across the ship, out to the middle of the shell's thickness and up to `top`.
void addBulkhead(MeshBuilder& mesh, const std::string& name, double x, double thickness, double top) {
  std::vector<Point2> outline;
  for (std::size_t row = 1; row < kRows.size() && kRows[row].z < top; ++row) {
    outline.push_back(corner(x, row, kShell * 0.5));
  }
  outline.push_back({halfBreadthInShell(x, top), top});
  for (std::size_t i = outline.size(); i-- > 0;) {
    outline.push_back({-outline[i].x, outline[i].y});
  }
  mesh.place(standingAlong({}, {x, 0, 0}, 0));
  mesh.startObject(name, id(Paint::kBulkhead));
  mesh.prism(outline, 0.0, thickness);
  mesh.place({});
}

void addDoubleBottom(MeshBuilder& mesh) {
  addLevel(mesh, {.name = "double bottom top",
                  .x0 = 0.2,
                  .x1 = kHullLength - 0.3,
                  .z0 = kTankTop - kSlab,
                  .z1 = kTankTop,
                  .paint = Paint::kFloor});
  const auto frames = static_cast<std::uint32_t>(kHullLength / kFrame);
  for (std::uint32_t f = 1; f < frames; ++f) {
    const double x = f * kFrame;
    mesh.startObject("double bottom floor " + std::to_string(f), id(Paint::kBulkhead));
    mesh.box({x - 0.05, -0.8 * halfBreadth(x, 0), 0.2},
             {x + 0.05, 0.8 * halfBreadth(x, 0), kTankTop - kSlab});
  }
}

}  // namespace

void addHull(MeshBuilder& mesh, const Plan& plan) {
  const double aft = kBlockStart - kOuterWall, fore = plan.blockEnd() + kOuterWall;
  const double engine_top = deckHeight(0), under_deck = kMainDeck - kSlab;
  mesh.place({});
  addShell(mesh);
  addDoubleBottom(mesh);
  addLevel(mesh, {.name = "main deck aft", .x0 = 0.2, .x1 = aft, .z0 = under_deck, .z1 = kMainDeck});
  addLevel(mesh, {.name = "main deck beside the block",
                  .x0 = aft,
                  .x1 = fore,
                  .z0 = under_deck,
                  .z1 = kMainDeck,
                  .inner = kBlockHalf + kOuterWall});
  addLevel(mesh,
           {.name = "main deck", .x0 = fore, .x1 = kHullLength - 0.2, .z0 = under_deck, .z1 = kMainDeck});
  addLevel(mesh, {.name = "engine room ceiling",
                  .x0 = aft,
                  .x1 = fore,
                  .z0 = engine_top - kSlab,
                  .z1 = engine_top,
                  .inner = kBlockHalf + kOuterWall,
                  .paint = Paint::kFloor});
  addBulkhead(mesh, "transom", 0.1, 0.3, kBulwarkTop - 0.1);
  addBulkhead(mesh, "stem", kHullLength - 0.4, 0.3, kBulwarkTop - 0.1);
  addBulkhead(mesh, "aft bulkhead", aft - 0.25, 0.25, under_deck);
  addBulkhead(mesh, "engine room bulkhead", fore, 0.25, under_deck);
  for (std::uint32_t hold = 1; hold <= kHolds; ++hold) {
    addBulkhead(mesh, "hold bulkhead " + std::to_string(hold), plan.holdStart(hold) - 0.5, 0.5, under_deck);
  }
}

}  // namespace sightline::scenes::ship
