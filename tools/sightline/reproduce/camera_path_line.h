#pragma once

// The line through the eyes of a camera path, to be walked at any speed.

#include <vector>

#include "sightline/scene/camera.h"

namespace sightline::tool {

class CameraPathLine {
 public:
  explicit CameraPathLine(const CameraPath& path);

  double length() const { return distances_.back(); }  // metres
  // The camera that far along the line; position and look between two frames are interpolated.
  CameraFrame at(double distance) const;
  View view(double distance, const Vec3d& scene_origin) const;

 private:
  const CameraPath& path_;
  CameraPath camera_;              // the path without its frames
  std::vector<double> distances_;  // along the line, one a frame
};

}  // namespace sightline::tool
