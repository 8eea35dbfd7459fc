#include "src/occlusion/tree/polygon_split.h"

#include <cmath>
#include <utility>

namespace sightline::occlusion {
namespace {

constexpr PlaneRef kNoPlane{};

bool named(PlaneRef ref) {
  return ref.bits != kNoPlane.bits;
}

}  // namespace

bool PolygonStack::agrees(const Corner& corner, const Plane& plane, PlaneRef ref, PlaneRef oriented) const {
  if (corner.open || !named(corner.edge)) {
    return false;
  }
  // On the other side of a frustum's plane is nobody who would ask about a gap that ends there.
  const double width = (*tolerances)[ref.plane()], own_width = (*tolerances)[corner.edge.plane()];
  if (!(width > kTouching && own_width > kTouching) || std::abs(own_width - width) > equal_tolerance) {
    return false;
  }
  const Vec3d& stored = (*planes)[corner.edge.plane()].normal;
  const double cosine = dot(stored, plane.normal);
  const bool same_way = corner.edge.flipped() == (oriented.flipped() != ref.flipped());
  return same_way ? cosine > 0.0 : cosine < 0.0;
}

SplitResult PolygonStack::split(Piece piece, const Plane& plane, PlaneRef ref, double scale,
                                double relative) {
  const std::uint32_t n = piece.count;
  const std::uint32_t first = piece.first;
  SplitResult result;
  if (n + 2 > kMaxCorners) {
    overflow = true;
    return result;
  }
  if (named(ref)) {
    bool made_by_it = false;
    for (Corner& corner : of(piece)) {
      if (corner.edge.samePlane(ref)) {
        corner.embedded = true;
        made_by_it = true;
        result.side = corner.edge.flipped() == ref.flipped() ? Side::kBack : Side::kFront;
      }
    }
    if (made_by_it) {
      return result;
    }
  }
  bool any_front = false, any_back = false;
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3d& p = corners[first + i].position;
    distance_[i] = plane.evaluate(p);
    const double on_plane = kOnPlane * (relative * l1Norm(p) + scale);
    sign_[i] = static_cast<std::int8_t>(distance_[i] > on_plane ? 1 : distance_[i] < -on_plane ? -1 : 0);
    any_front |= distance_[i] > 4.0 * on_plane;
    any_back |= distance_[i] < -4.0 * on_plane;
  }
  const auto next = [n](std::uint32_t i) { return i + 1 == n ? 0 : i + 1; };
  if (!any_front || !any_back) {
    result.side = any_front ? Side::kFront : any_back ? Side::kBack : Side::kOnPlane;
    if (named(ref) && result.side != Side::kOnPlane) {
      for (std::uint32_t i = 0; i < n; ++i) {
        if (sign_[i] == 0 && sign_[next(i)] == 0) {
          Corner& corner = corners[first + i];
          corner.embedded |= agrees(corner, plane, ref, any_front ? ref.other() : ref);
        }
      }
    }
    return result;
  }
  result.side = Side::kBoth;
  // Rounding grows with the distance of the corner from which the cut is measured, so it is the nearer one.
  const auto cut = [&](std::uint32_t i, std::uint32_t j) {
    if (l1Norm(corners[first + j].position) < l1Norm(corners[first + i].position)) {
      std::swap(i, j);
    }
    const Vec3d& a = corners[first + i].position;
    const Vec3d& b = corners[first + j].position;
    return a + (b - a) * (distance_[i] / (distance_[i] - distance_[j]));
  };
  for (const int wanted : {1, -1}) {
    Piece& part = wanted > 0 ? result.front : result.back;
    part.first = static_cast<std::uint32_t>(corners.size());
    const PlaneRef oriented = !named(ref) ? PlaneRef{} : wanted > 0 ? ref.other() : ref;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = next(i);
      const int si = sign_[i] * wanted, sj = sign_[j] * wanted;
      Corner corner = corners[first + i];
      if (si > 0 || (si == 0 && sj > 0)) {
        corners.push_back(corner);
      } else if (si == 0 && sj == 0) {
        corner.embedded |= named(ref) && agrees(corner, plane, ref, oriented);
        corners.push_back(corner);
      } else if (si == 0) {
        corners.push_back({corner.position, oriented, named(ref), false});
      }
      if (si * sj < 0) {
        corner.position = cut(i, j);
        if (si > 0) {
          corner.edge = oriented;
          corner.embedded = named(ref);
          corner.open = false;
        }
        corners.push_back(corner);
      }
    }
    part.count = static_cast<std::uint32_t>(corners.size()) - part.first;
  }
  return result;
}

}  // namespace sightline::occlusion
