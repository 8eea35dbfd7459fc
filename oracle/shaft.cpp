#include "oracle/shaft.h"

#include <algorithm>

namespace sightline {

Shaft::Shaft(const std::vector<Vec3d>& eyes, const DoubleBox& target) : hull_(eyes) {
  for (std::uint32_t i = 0; i < 8; ++i) {
    hull_.push_back(target.corner(i));
  }
  for (int axis = 0; axis < 3; ++axis) {
    Vec3d unit{};
    unit[axis] = 1.0;
    addSide(unit);
    addSide(-unit);
    for (const Vec3d& eye : eyes) {
      for (std::uint32_t i = 0; i < 8; ++i) {
        const Vec3d normal = cross(unit, target.corner(i) - eye);
        for (const Vec3d& n : {normal, -normal}) {
          // Only where both points support it.
          const double size = 0x1p-40 * sizeOf(n) * (sizeOf(eye) + sizeOf(target.max) + sizeOf(target.min));
          if (std::all_of(hull_.begin(), hull_.end(),
                          [&](const Vec3d& p) { return dot(n, p - eye) <= size; })) {
            addSide(n);
          }
        }
      }
    }
  }
}

void Shaft::addSide(const Vec3d& normal) {
  if (sizeOf(normal) == 0.0) {
    return;
  }
  const Vec3d* top = &hull_[0];
  for (const Vec3d& p : hull_) {
    top = dot(normal, p - *top) > 0.0 ? &p : top;
  }
  sides_.push_back({normal, *top});
}

bool Shaft::isBeyondTop(const Side& side, const Vec3d& p) {
  return along(side.normal, p, side.top).positive();
}

bool Shaft::isBeyond(const Side& side, const Vec3d& p) const {
  return std::all_of(hull_.begin(), hull_.end(),
                     [&](const Vec3d& h) { return along(side.normal, p, h).positive(); });
}

bool Shaft::isMissedBy(const Vec3d& p, const Vec3d& q) const {
  return std::any_of(sides_.begin(), sides_.end(), [&](const Side& side) {
    return isBeyondTop(side, p) && isBeyondTop(side, q) && isBeyond(side, p) && isBeyond(side, q);
  });
}

bool Shaft::isMissedBy(const Corners& t) const {
  return std::any_of(sides_.begin(), sides_.end(), [&](const Side& side) {
    return isBeyondTop(side, t.a) && isBeyondTop(side, t.b) && isBeyondTop(side, t.c) &&
           isBeyond(side, t.a) && isBeyond(side, t.b) && isBeyond(side, t.c);
  });
}

}  // namespace sightline
