#include "sightline/layers/extent_axis.h"

namespace sightline {

std::vector<ExtentAxis> cameraExtents() {
  using Kind = ExtentAxis::Kind;
  constexpr auto kCamera = ExtentAxis::Frame::kCamera;
  return {{Kind::kAngular, kCamera, {1, 0, 0}, {0, 0, 1}},
          {Kind::kAngular, kCamera, {0, 1, 0}, {0, 0, 1}},
          {Kind::kSpatial, kCamera, {0, 0, 1}, {}}};
}

std::vector<ExtentAxis> worldExtents() {
  using Kind = ExtentAxis::Kind;
  constexpr auto kWorld = ExtentAxis::Frame::kWorld;
  return {{Kind::kSpatial, kWorld, {1, 0, 0}, {}},
          {Kind::kSpatial, kWorld, {0, 1, 0}, {}},
          {Kind::kSpatial, kWorld, {0, 0, 1}, {}}};
}

}  // namespace sightline
