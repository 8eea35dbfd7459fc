#pragma once

// The cells of the occluder database are regions of a kd-tree's nodes. They are kept as a small tree of split
// planes of their own, because a Hierarchy keeps only tight boxes.

#include <cstdint>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/hierarchy/hierarchy.h"
#include "src/base/byte_stream.h"
#include "src/occluders/database/database_bytes.h"

namespace sightline::occluders {

// An inner node: points with p[axis] < plane are in nodes[link], all others, also NaN, in nodes[link + 1].
// A cell: axis is kCell, and link is the number of the cell.
struct CellNode {
  static constexpr std::uint32_t kCell = 3;
  float plane = 0.0f;
  std::uint32_t axis = kCell;
  std::uint32_t link = 0;
};

inline constexpr std::uint32_t kMaxCells = 1u << 30;

// Memory for each cell: a tree of n cells has 2 n - 1 nodes.
inline constexpr std::size_t kBytesPerCell = 2 * sizeof(CellNode) + sizeof(Box);

struct CellTree {
  static constexpr DatabaseKind kKind{"occluder database", "occd", "cells"};
  static constexpr std::uint32_t maxCount(std::uint32_t) { return kMaxCells; }

  std::vector<CellNode> nodes;  // [0] is the root
  // The box of each cell. Together they tile the slightly enlarged box of the root. The outermost cells go on
  // to infinity beyond it, which their boxes here do not show.
  std::vector<Box> regions;

  std::uint32_t count() const { return static_cast<std::uint32_t>(regions.size()); }
  // The one cell that holds the point. Takes at most as many comparisons as the hierarchy has levels.
  std::uint32_t cellOf(const Vec3d& point) const;
  std::size_t bytes() const;  // beside the object itself

  // The box of the root (six of 32 bits), then for each node its axis (8 bits) and, if it is not a cell, its
  // plane and its link (32 each). Cells are numbered in the order of their nodes.
  void save(base::ByteWriter& writer) const;
  // So many cells (at least 1, at most kMaxCells), for which the caller has to know that the bytes are
  // enough.
  static Result<CellTree> load(base::ByteReader& reader, std::uint32_t cells);
};

// Splits the cell with the longest diagonal (of equal ones, the one made first) as the kd-tree does, until
// there are max_cells of them or all that is left are leaves. A node that no plane separates is one cell, and
// so is what is not a kd-tree; objects with a broken box do not count. default_bounds: the region where the
// tree has no finite box of its own.
CellTree buildCells(const Hierarchy& kd_tree, const Box& default_bounds, std::uint32_t max_cells);

}  // namespace sightline::occluders
