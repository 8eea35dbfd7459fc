#pragma once

// Divides parts that occlude each other in a cycle, while they do, so that the group falls apart.
//
// Based on: John Snyder, Jed Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. Microsoft
// Research MSR-TR-97-11, 1997, which leaves adaptive splitting to future work.

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "sightline/base/inline.h"
#include "sightline/layers/layer_sorter.h"
#include "sightline/math/plane.h"

namespace sightline {

// One side of a plane in a part's space: where the plane is >= 0, or where it is less. So every point is on
// exactly one side.
struct PieceSide {
  Plane plane{};  // unit normal
  bool in_front = true;

  SIGHTLINE_INLINE bool contains(const Vec3d& point) const {
    return (plane.evaluate(point) >= 0.0) == in_front;
  }
  friend bool operator==(const PieceSide&, const PieceSide&) = default;
};

// The largest number of sides of one piece, for CycleSplitter and for all that draws pieces.
inline constexpr std::uint32_t kMaxPieceSides = 16;

// The part of `part` on all of these sides. The pieces of a part have no point in common, and together are
// the part.
struct PartPiece {
  PartId piece{};                  // its number in the order
  PartId part{};                   // which is disabled meanwhile, and not in the order
  std::vector<PieceSide> sides{};  // at most kMaxPieceSides
};

// Appends the triangles of a part, in its space, which all lie in its hulls.
using PartTriangles = std::function<void(PartId part, std::vector<std::array<Vec3d, 3>>& triangles)>;

struct CycleSplitSettings {
  std::uint32_t max_pieces = 64;   // pieces of all parts together, at most
  std::uint32_t max_trials = 300;  // planes tried in one update, at most
  // Frames for which a division is kept after it has become superfluous, so that pieces do not come and go.
  std::uint32_t keep_frames = 30;
  std::uint32_t retry_frames = 15;  // frames until a group is tried again that no plane made fall apart
  // Empty: pieces are those of the part's hulls. Triangles give tighter hulls to the pieces of parts that are
  // not convex, as half rings.
  PartTriangles triangles{};
};

// Counts of the last update().
struct CycleSplitStats {
  std::uint32_t divided = 0;  // parts that are divided
  std::uint32_t pieces = 0;   // of them all
  std::uint32_t cuts = 0;     // made in this update
  std::uint32_t joins = 0;    // taken back in this update
  std::uint32_t trials = 0;   // planes tried
};

// Sorts the parts of a LayerSorter and divides those in cycles by planes. Where a group of several parts has
// no order, planes through its parts are tried, and those kept that make the group fall apart; no others. A
// division is kept from frame to frame, moves with its part, and is taken back when the parts have been in
// order without it for some frames.
//
// A piece is a part of the sorter with a number of its own, which is used again when the piece is gone. It
// has its part's settings and rules, and a rule for the other pieces: the plane between. The order is right
// for the pieces as it is for parts, whichever planes were chosen. Two convex parts that pass through each
// other have no order, however they are divided.
//
// Only sorted parts are divided, and none of a container. Nothing is divided if the sorter is told to find no
// arcs, or not to test exactly.
//
// While a part is divided, it is disabled, and setEnabled() has no effect: join() it before. Rules that are
// set for it do not reach its pieces, and they keep their shape if setHull() changes one of its hulls: join()
// it before these, too. It may be moved by setTransform() and removed by removePart(); its pieces follow at
// the next update(). When this is destroyed, all parts are whole again. For one thread at a time.
class CycleSplitter {
 public:
  // sorter must outlive this, in place.
  explicit CycleSplitter(LayerSorter& sorter, CycleSplitSettings settings = {});
  ~CycleSplitter();
  CycleSplitter(CycleSplitter&&) noexcept;
  CycleSplitter& operator=(CycleSplitter&&) noexcept;

  // Whether a part may be divided from now on, until it is removed; all may at first.
  void setMayDivide(PartId part, bool may);
  // Makes a divided part whole again.
  void join(PartId part);

  // As LayerSorter::update(). The result is valid until the next update of either.
  const LayerOrder& update(const View& view, std::span<const Vec3d> more_eyes = {});
  // The pieces of the last order, ascending.
  std::span<const PartPiece> pieces() const;
  // The part of a piece; any other number is its own part.
  PartId partOf(PartId piece) const;
  const CycleSplitStats& stats() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
