#include "sightline/world/views_ahead.h"

#include <algorithm>
#include <cmath>

namespace sightline {
namespace {

// Rodrigues' formula.
Vec3d turned(const Vec3d& v, const Vec3d& axis, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1.0 - c));
}

// The tangent of an angle of that tangent, made larger.
double wider(double tangent, double angle) {
  constexpr double kWidest = 1.3;  // radians
  return std::tan(std::max(std::atan(tangent), std::min(std::atan(tangent) + angle, kWidest)));
}

// Moves all borders of a view outwards: by an angle, or by a length if the view is orthographic. The axis of
// a view may be nearer to one border than to the other, or outside of both.
void widen(View& view, double by) {
  if (by == 0.0) {
    return;
  }
  const auto outwards = [&](double border) { return view.orthographic ? border + by : wider(border, by); };
  const auto both = [&](double& half, double& shift) {
    const double high = outwards(half * (1.0 + shift)), low = -outwards(half * (1.0 - shift));
    half = 0.5 * (high - low);
    shift = (high + low) / (high - low);
  };
  double& size = view.orthographic ? view.ortho_height : view.tan_half_fovy;
  const double halves = view.orthographic ? 0.5 : 1.0;
  double height = halves * size;
  double width = height * view.aspect;
  both(height, view.shift_y);
  both(width, view.shift_x);
  size = height / halves;
  view.aspect = width / height;
}

// See CameraMotion::depth.
double usualDepth(const View& view) {
  constexpr double kLeastNear = 0.01, kWithoutEnd = 10.0;  // metres
  return std::isfinite(view.z_far) ? std::sqrt(std::max(view.z_near, kLeastNear) * view.z_far) : kWithoutEnd;
}

}  // namespace

void viewsAhead(const View& view, const CameraMotion& motion, double seconds, std::span<View> views) {
  const double rate = length(motion.turn_rad_per_s);
  const Vec3d axis = normalized(motion.turn_rad_per_s);
  const double depth = motion.depth > 0.0 ? motion.depth : usualDepth(view);
  for (std::size_t i = 0; i < views.size(); ++i) {
    const double step = seconds / static_cast<double>(views.size());
    const double time = step * static_cast<double>(i + 1);
    View& ahead = views[i];
    ahead = view;
    ahead.eye = view.eye + motion.velocity * time;
    if (rate > 0.0) {
      ahead.right = turned(view.right, axis, rate * time);
      ahead.up = turned(view.up, axis, rate * time);
      ahead.forward = turned(view.forward, axis, rate * time);
    }
    if (view.orthographic) {
      widen(ahead, motion.spread * time);
      continue;
    }
    // What is at the side of the frustum moves across it by what the eye may be off.
    widen(ahead, rate * step + std::atan(motion.spread * time / depth));
  }
}

}  // namespace sightline
