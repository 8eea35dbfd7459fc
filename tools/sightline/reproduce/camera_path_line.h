#pragma once

// The polyline through the eyes of a camera path, along which an observer can move at any speed.

#include <vector>

#include "sightline/scene/camera.h"

namespace sightline::tool {

class CameraPathLine {
 public:
  explicit CameraPathLine(const CameraPath& path);

  double length() const { return distances_.back(); }  // metres
  // The camera at this distance (metres) along the line; place and direction are interpolated between two
  // frames.
  CameraFrame at(double distance) const;
  View view(double distance, const Vec3d& scene_origin) const;

 private:
  const CameraPath& path_;
  CameraPath camera_;              // the camera path without its frames
  std::vector<double> distances_;  // each frame's distance along the line, in metres
};

}  // namespace sightline::tool
