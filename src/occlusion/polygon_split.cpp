#include "occlusion/polygon_split.h"

namespace sightline::occlusion_detail {
namespace {

constexpr PlaneRef kNoPlane{};

bool named(PlaneRef ref) {
  return ref.bits != kNoPlane.bits;
}

}  // namespace

SplitResult PolygonStack::split(Piece piece, const Plane& plane, PlaneRef ref, double scale) {
  const std::uint32_t n = piece.count;
  const std::uint32_t first = piece.first;
  SplitResult result;
  if (n + 2 > kMaxCorners) {
    overflow = true;
    return result;
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const Vec3d& p = corners[first + i].position;
    distance_[i] = plane.evaluate(p);
    const double on_plane = kOnPlane * (magnitude(p) + scale);
    sign_[i] = static_cast<std::int8_t>(distance_[i] > on_plane ? 1 : distance_[i] < -on_plane ? -1 : 0);
  }
  const auto next = [n](std::uint32_t i) { return i + 1 == n ? 0 : i + 1; };
  if (named(ref)) {
    // An edge that was made by this very plane lies in it, whatever rounding says.
    for (std::uint32_t i = 0; i < n; ++i) {
      if (corners[first + i].edge.samePlane(ref)) {
        sign_[i] = sign_[next(i)] = 0;
      }
    }
  }
  bool any_front = false, any_back = false;
  for (std::uint32_t i = 0; i < n; ++i) {
    any_front |= sign_[i] > 0;
    any_back |= sign_[i] < 0;
  }
  if (!any_front || !any_back) {
    result.side = any_front ? Side::kFront : any_back ? Side::kBack : Side::kOnPlane;
    if (named(ref) && result.side != Side::kOnPlane) {
      for (std::uint32_t i = 0; i < n; ++i) {
        if (sign_[i] == 0 && sign_[next(i)] == 0) {
          corners[first + i].edge = any_front ? ref.other() : ref;
          corners[first + i].embedded = true;
        }
      }
    }
    return result;
  }
  result.side = Side::kBoth;
  const auto cut = [&](std::uint32_t i, std::uint32_t j) {
    const Vec3d& a = corners[first + i].position;
    const Vec3d& b = corners[first + j].position;
    return a + (b - a) * (distance_[i] / (distance_[i] - distance_[j]));
  };
  for (const int wanted : {1, -1}) {
    Piece& part = wanted > 0 ? result.front : result.back;
    part.first = static_cast<std::uint32_t>(corners.size());
    const PlaneRef cut_edge = wanted > 0 ? ref.other() : ref;
    for (std::uint32_t i = 0; i < n; ++i) {
      const std::uint32_t j = next(i);
      const int si = sign_[i] * wanted, sj = sign_[j] * wanted;
      if (si >= 0) {
        Corner corner = corners[first + i];
        if (si == 0 && sj <= 0) {
          corner.edge = named(ref) ? cut_edge : kNoPlane;
          corner.embedded = named(ref);
        }
        corners.push_back(corner);
      }
      if (si * sj < 0) {
        Corner corner{cut(i, j), corners[first + i].edge, corners[first + i].embedded};
        if (si > 0) {
          corner.edge = named(ref) ? cut_edge : kNoPlane;
          corner.embedded = named(ref);
        }
        corners.push_back(corner);
      }
    }
    part.count = static_cast<std::uint32_t>(corners.size()) - part.first;
  }
  return result;
}

}  // namespace sightline::occlusion_detail
