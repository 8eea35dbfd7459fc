#include "tools/sightline/reproduce/camera_path_line.h"

#include <algorithm>

namespace sightline::tool {
namespace {

Vec3d pointBetween(const Vec3d& a, const Vec3d& b, double t) {
  return a * (1.0 - t) + b * t;
}

// A direction between two; the nearer one of them if they cancel out.
Vec3d directionBetween(const Vec3d& a, const Vec3d& b, double t) {
  const Vec3d sum = pointBetween(normalized(a), normalized(b), t);
  constexpr double kCancelled = 1e-6;
  return sightline::length(sum) > kCancelled ? sum : t < 0.5 ? a : b;
}

}  // namespace

CameraPathLine::CameraPathLine(const CameraPath& path) : path_(path), camera_(path), distances_{0.0} {
  camera_.frames.clear();
  for (std::size_t f = 1; f < path.frames.size(); ++f) {
    const double step = sightline::length(path.frames[f].eye - path.frames[f - 1].eye);
    distances_.push_back(distances_.back() + step);
  }
}

CameraFrame CameraPathLine::at(double distance) const {
  const auto after = std::upper_bound(distances_.begin(), distances_.end(), distance);
  if (after == distances_.end()) {
    return path_.frames.back();
  }
  const std::size_t next = std::max<std::size_t>(1, static_cast<std::size_t>(after - distances_.begin()));
  const double begin = distances_[next - 1];
  const double t = std::clamp((distance - begin) / (distances_[next] - begin), 0.0, 1.0);
  const CameraFrame &a = path_.frames[next - 1], &b = path_.frames[next];
  return {pointBetween(a.eye, b.eye, t), directionBetween(a.forward, b.forward, t),
          directionBetween(a.up, b.up, t)};
}

View CameraPathLine::view(double distance, const Vec3d& scene_origin) const {
  CameraPath one = camera_;
  one.frames = {at(distance)};
  return one.view(0, scene_origin);
}

}  // namespace sightline::tool
