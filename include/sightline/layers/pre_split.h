#pragma once

// Cuts a mesh (terrain, cups, trees) into overlapping pieces before it is sorted, so that a part that flies
// between the pieces is not grouped with the whole mesh.
//
// Based on: John Snyder, Jed Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. Microsoft
// Research MSR-TR-97-11, 1997, section 9. For opaque meshes only: neighbours both draw their overlap, which
// would show twice in a transparent mesh.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sightline/layers/pair_rule.h"
#include "sightline/math/plane.h"
#include "sightline/math/vec3.h"

namespace sightline {

// The heights between which a cell lies along one direction of its grid.
struct CellSlab {
  double low = -std::numeric_limits<double>::infinity();  // infinite: open on this side
  double high = std::numeric_limits<double>::infinity();
};

// Convex cells that fill space, or a part of it, without overlapping. A cell lies between two planes along
// each of `directions` and, if there are sectors, between two half planes that end in the axis.
struct SplitCells {
  std::vector<Vec3d> directions{};  // unit length
  std::vector<double> widths{};     // one per direction: a cell's width, of which inflation is a fraction
  std::vector<CellSlab> slabs{};    // cell c along direction d: slabs[c * directions.size() + d]

  std::uint32_t sectors = 0;               // number of sectors about the axis; 0: none
  std::vector<std::uint32_t> sector_of{};  // one per cell, if there are sectors
  Vec3d axis_point{};
  Vec3d zero{}, quarter{};    // unit vectors across the axis, at angles of 0 and of a quarter turn
  double sector_width = 0.0;  // width of a sector at the rim

  std::uint32_t count = 0;  // number of cells
};

// `count` >= 1 slabs of equal width from `low` to `high` > low. The first and the last are open outwards.
struct SplitAxis {
  Vec3d direction{};  // any length > 0; heights are measured along the unit vector
  double low = 0.0, high = 1.0;
  std::uint32_t count = 1;
};
// Returns the cells of a grid that fills space. The axes need not be perpendicular; the first counts fastest.
// Two axes suit terrain, three suit meshes without a main direction or symmetry.
SplitCells gridCells(std::span<const SplitAxis> axes);

struct CylinderOptions {
  Vec3d axis_point{};            // any point of the axis
  Vec3d axis{0, 1, 0};           // any length > 0
  Vec3d zero{1, 0, 0};           // the first sector begins there; not along the axis
  std::uint32_t sectors = 8;     // >= 1
  double radius = 1.0;           // radius of the mesh, at which the overlap of sectors is measured
  double low = 0.0, high = 1.0;  // heights along the axis, measured from axis_point
  std::uint32_t slices = 1;      // >= 1
};
// Returns sectors about an axis, cut into slices along it, as cells that fill space. Sectors count fastest;
// the first and the last slice are open outwards. They suit cups.
SplitCells cylinderCells(const CylinderOptions& options);

struct HexagonOptions {
  Vec3d origin{};                // the middle of a hexagon
  Vec3d u{1, 0, 0}, v{0, 0, 1};  // perpendicular unit vectors that span the plane of the hexagons
  double width = 1.0;            // distance of opposite sides of a hexagon, > 0
  double low_u = 0.0, high_u = 1.0, low_v = 0.0, high_v = 1.0;  // the rectangle, measured from the origin
};
// Returns the hexagons that intersect a rectangle, as infinite prisms with two sides across u. Every pair of
// cells has a separating plane. Points outside the rectangle may lie in no cell.
SplitCells hexagonCells(const HexagonOptions& options);

// Returns the planes of a cell, with inward unit normals.
// inflation: >= 0; moves each plane outwards by half this fraction of the cell's width along the normal (for
// a sector, its width at the rim), so that neighbours overlap by the whole fraction.
std::vector<Plane> cellPlanes(const SplitCells& cells, std::uint32_t cell, double inflation);

// Returns a plane with cell `first` in front and `second` behind, both without inflation, and a unit normal.
// Precondition: first != second.
Plane planeBetween(const SplitCells& cells, std::uint32_t first, std::uint32_t second);

struct SplitTriangle {
  std::array<Vec3d, 3> positions{};
  std::array<Vec3d, 3> weights{};  // each corner's barycentric coordinates in the source triangle
  std::uint32_t source = 0;        // the mesh's triangle
};

// The part of the mesh in one inflated cell; at least one triangle.
struct SplitPiece {
  std::uint32_t cell = 0;
  std::vector<SplitTriangle> triangles{};  // ascending by source, with the source's winding
};

// Two pieces whose bounding boxes intersect, and the plane between their cells without inflation.
struct SplitNeighbours {
  std::uint32_t first = 0, second = 0;  // indices of pieces, first < second
  PairPlane rule{};                     // in the mesh's space
};

struct SplitMesh {
  std::vector<SplitPiece> pieces{};           // by cell
  std::vector<SplitNeighbours> neighbours{};  // ascending
};

// Clips every triangle to each inflated cell that it intersects. Without inflation, a triangle in the plane
// between two cells goes to one of them. The time is proportional to triangles times cells.
// triangles: indices of positions, which are finite.
// Source of the clipping: Sutherland, Hodgman. Reentrant polygon clipping. CACM 1974.
SplitMesh splitMesh(std::span<const Vec3d> positions, std::span<const std::array<std::uint32_t, 3>> triangles,
                    const SplitCells& cells, double inflation);

}  // namespace sightline
