#pragma once

// The convex hull of a region and a box, which all lines of sight between them are in; for RegionProof.

#include <vector>

#include "oracle/region_hull.h"

namespace sightline {

class Shaft {
 public:
  // eyes: points whose hull holds the region.
  Shaft(const std::vector<Vec3d>& eyes, const DoubleBox& target);

  // True only if the segment, or the triangle, misses the shaft.
  bool isMissedBy(const Vec3d& p, const Vec3d& q) const;
  bool isMissedBy(const Corners& t) const;

 private:
  // All of the shaft is on one side of the plane.
  struct Side {
    Vec3d normal;  // outwards
    Vec3d top;     // a point of the hull at which it is greatest, but for rounding
  };

  void addSide(const Vec3d& normal);
  // True only if the point is beyond all of the hull. isBeyondTop() tests one point of it, so it is a quick
  // and necessary condition.
  static bool isBeyondTop(const Side& side, const Vec3d& p);
  bool isBeyond(const Side& side, const Vec3d& p) const;

  std::vector<Vec3d> hull_;
  std::vector<Side> sides_;
};

}  // namespace sightline
