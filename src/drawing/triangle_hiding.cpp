#include "src/drawing/triangle_hiding.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sightline/geometry/tolerance.h"

namespace sightline::drawing {
namespace {

constexpr double kSideRounding = 0x1p-48;
constexpr double kCameraRounding = 0x1p-46;
constexpr double kCornerRounding = 0x1p-21;

// Narrows [from, to] to where the line is on the inner side of the edge from p to q.
bool insideEdge(const Vec3d& p, const Vec3d& q, const HidableLine& line, bool orthographic, double& from,
                double& to) {
  const Vec3d edge = q - p;
  const double size_p = l1Norm(p);
  const double size_q = l1Norm(q);
  const Vec3d& nearer = size_p < size_q ? p : q;
  if (orthographic) {
    const double wider = kSideRounding * (std::abs(edge.x) + std::abs(edge.y));
    const auto side = [&](const Vec3d& point) {
      return edge.x * (point.y - nearer.y) - edge.y * (point.x - nearer.x) +
             wider * std::max({size_p, size_q, l1Norm(point)});
    };
    return narrow(side(line.a), side(line.b), from, to);
  }
  const Vec3d inwards = cross(nearer, edge);
  const double wider = kSideRounding * std::min(size_p, size_q) * l1Norm(edge);
  return narrow(dot(inwards, line.a) + wider * l1Norm(line.a), dot(inwards, line.b) + wider * l1Norm(line.b),
                from, to);
}

// Narrows [from, to] to where the ray from the eye intersects the triangle at or beyond the near plane.
bool beyondNear(const HidingTriangle& triangle, const Vec3d& normal, const HidableLine& line,
                const View& view, double& from, double& to) {
  const Vec3d& p = triangle.corners[0];
  const auto excess = [&](const Vec3d& point) {
    if (!view.orthographic) {
      return point.z * dot(normal, p) - view.z_near * dot(normal, point);
    }
    return (p.z - view.z_near) * normal.z - normal.x * (point.x - p.x) - normal.y * (point.y - p.y);
  };
  return narrow(excess(line.a), excess(line.b), from, to);
}

// Narrows [from, to] to where the line is behind the triangle's plane.
bool behindPlane(const HidingTriangle& triangle, const Vec3d& normal, const HidableLine& line, double& from,
                 double& to) {
  const Vec3d& p = triangle.corners[0];
  const double behind_a = dot(normal, line.a - p);
  const double behind_b = dot(normal, line.b - p);
  // 1 behind the plane, -1 before it, 0 in it as far as rounding tells.
  const auto place = [&](double share, double& behind) {
    const double rest = 1.0 - share;
    behind = rest * behind_a + share * behind_b;
    const double size = std::max(triangle.size, rest * line.size_a + share * line.size_b);
    const double reach = triangle.reach + rest * l1Norm(line.a) + share * l1Norm(line.b);
    const double bound = kCornerRounding * size + kCameraRounding * reach;
    return behind > bound ? 1 : behind < -bound ? -1 : 0;
  };
  double behind_from = 0.0;
  double behind_to = 0.0;
  const int place_from = place(from, behind_from);
  const int place_to = place(to, behind_to);
  if (place_from <= 0 && place_to <= 0) {
    return false;
  }
  if (place_from + place_to == 0) {
    const double crossing = from + (to - from) * (behind_from / (behind_from - behind_to));
    (place_from > 0 ? to : from) = std::clamp(crossing, from, to);
  }
  return true;
}

}  // namespace

bool turnToEye(HidingTriangle& triangle, bool orthographic) {
  auto& [p, q, r] = triangle.corners;
  const double volume = orthographic ? cross(q - p, r - p).z : dot(p, cross(q, r));
  if (volume < 0.0) {
    std::swap(q, r);
  }
  return volume != 0.0 && std::isfinite(volume);
}

bool hiddenPart(const HidingTriangle& triangle, const HidableLine& line, const View& view, double& from,
                double& to) {
  from = line.from;
  to = line.to;
  const auto& [p, q, r] = triangle.corners;
  if (!insideEdge(p, q, line, view.orthographic, from, to) ||
      !insideEdge(q, r, line, view.orthographic, from, to) ||
      !insideEdge(r, p, line, view.orthographic, from, to)) {
    return false;
  }
  const Vec3d normal = normalized(cross(q - p, r - p));
  const bool crosses_near = std::min({p.z, q.z, r.z}) < view.z_near;
  return behindPlane(triangle, normal, line, from, to) &&
         (!crosses_near || beyondNear(triangle, normal, line, view, from, to));
}

}  // namespace sightline::drawing
