#pragma once

// Cutting a mesh into overlapping pieces before it is sorted, so that what flies between them is not grouped
// with all of it: terrain, cups, trees.
//
// Based on: John Snyder, Jed Lengyel. Visibility Sorting and Compositing for Image-Based Rendering.
// Microsoft Research MSR-TR-97-11, 1997, section 9. Right for opaque meshes only: neighbours both draw what
// they share, which of a transparent mesh would show twice.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sightline/layers/pair_rule.h"
#include "sightline/math/plane.h"
#include "sightline/math/vec3.h"

namespace sightline {

// Where a cell lies along one of its grid's directions.
struct CellSlab {
  double low = -std::numeric_limits<double>::infinity();  // heights along the direction; infinite: open
  double high = std::numeric_limits<double>::infinity();
};

// Convex cells that fill space, or a part of it, without overlapping. Each lies between two planes along each
// of `directions`, and, if there are sectors, between two half planes that end in the axis.
struct SplitCells {
  std::vector<Vec3d> directions{};  // unit length
  std::vector<double> widths{};     // of a cell, one a direction: what inflation is a fraction of
  std::vector<CellSlab> slabs{};    // of cell c along direction d: [c * directions + d]

  // Sectors about an axis; 0: none.
  std::uint32_t sectors = 0;
  std::vector<std::uint32_t> sector_of{};  // one a cell, if there are sectors
  Vec3d axis_point{};
  Vec3d zero{}, quarter{};    // unit vectors across the axis: where angles of 0 and of a quarter turn are
  double sector_width = 0.0;  // of a sector at the rim

  std::uint32_t count = 0;  // of cells
};

// `count` >= 1 slabs of the same width from low to high > low. The first and the last are open outwards.
struct SplitAxis {
  Vec3d direction{};  // any length > 0; heights are those along the unit vector
  double low = 0.0, high = 1.0;
  std::uint32_t count = 1;
};
// Two axes for terrain, three for what has neither a direction nor a symmetry. The axes need not be
// perpendicular to each other. The first axis counts fastest. Fills space.
SplitCells gridCells(std::span<const SplitAxis> axes);

struct CylinderOptions {
  Vec3d axis_point{};            // any point of the axis
  Vec3d axis{0, 1, 0};           // any length > 0
  Vec3d zero{1, 0, 0};           // the first sector begins there; not along the axis
  std::uint32_t sectors = 8;     // >= 1
  double radius = 1.0;           // of what is cut: where overlaps of sectors are measured
  double low = 0.0, high = 1.0;  // along the axis, from axis_point
  std::uint32_t slices = 1;      // >= 1
};
// Sectors, cut in slices along the axis, the first and last open outwards: for cups. Sectors count fastest.
// Fills space.
SplitCells cylinderCells(const CylinderOptions& options);

struct HexagonOptions {
  Vec3d origin{};                // the middle of a hexagon
  Vec3d u{1, 0, 0}, v{0, 0, 1};  // unit vectors, perpendicular to each other: the plane of the hexagons
  double width = 1.0;            // of a hexagon, between two sides: > 0
  double low_u = 0.0, high_u = 1.0, low_v = 0.0, high_v = 1.0;  // from the origin
};
// The hexagons that meet a rectangle, two of each one's sides across u, as prisms without ends. No plane
// separates them all; each pair has one. What lies outside of the rectangle may be in no cell.
SplitCells hexagonCells(const HexagonOptions& options);

// The planes of a cell, unit normals inwards. inflation >= 0: each is moved outwards by half of this fraction
// of the cell's width along its normal (of a sector: its width at the rim), so that neighbours overlap by the
// whole fraction.
std::vector<Plane> cellPlanes(const SplitCells& cells, std::uint32_t cell, double inflation);

// A plane with cell `first` in front and `second` behind, both without inflation; unit normal. The cells are
// different.
Plane planeBetween(const SplitCells& cells, std::uint32_t first, std::uint32_t second);

struct SplitTriangle {
  std::array<Vec3d, 3> positions{};
  std::array<Vec3d, 3> weights{};  // of each corner: barycentric coordinates in the source triangle
  std::uint32_t source = 0;        // triangle of the mesh
};

// What of the mesh lies in an inflated cell: at least one triangle.
struct SplitPiece {
  std::uint32_t cell = 0;
  std::vector<SplitTriangle> triangles{};  // by source; winding as there
};

// Two pieces whose boxes meet; the rule is that of the cells, which stands whatever the inflation.
struct SplitNeighbours {
  std::uint32_t first = 0, second = 0;  // into pieces, first < second
  PairPlane rule{};                     // in the mesh's space
};

struct SplitMesh {
  std::vector<SplitPiece> pieces{};           // by cell
  std::vector<SplitNeighbours> neighbours{};  // ascending
};

// Cuts every triangle to each inflated cell that it meets. Without inflation, what lies exactly between two
// cells belongs to one of them. indices: into positions, which are finite. Time: triangles times cells.
// Source of the clipping: Sutherland, Hodgman. Reentrant polygon clipping. CACM 1974.
SplitMesh splitMesh(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles,
                    const SplitCells& cells, double inflation);

}  // namespace sightline
