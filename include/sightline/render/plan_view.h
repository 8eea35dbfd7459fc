#pragma once

// A plan view shows the scene from above: every object in the colour of its state in one frame of culling,
// the camera's frustum, and the occluders that were used.

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>

#include "sightline/base/ids.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/scene.h"

namespace sightline {

enum class ObjectState : std::uint8_t {
  kOutside,  // outside the frustum
  kHidden,   // inside it, culled
  kKept,     // inside it, drawn
};

// Colours of plan views and of their legends, sRGB. They differ in lightness too, for colour-blind readers.
using PlanColor = std::array<std::uint8_t, 3>;
inline constexpr PlanColor kPlanOutside{216, 216, 212};
inline constexpr PlanColor kPlanHidden{196, 70, 56};
inline constexpr PlanColor kPlanKept{134, 202, 112};
inline constexpr PlanColor kPlanOccluder{20, 60, 190};
inline constexpr PlanColor kPlanCamera{24, 24, 24};
inline constexpr PlanColor kPlanBackground{250, 250, 248};

// The colour of an object larger than half the picture, such as the ground, so that objects on it stand out.
constexpr PlanColor paleOf(const PlanColor& color) {
  PlanColor pale{};
  for (std::size_t c = 0; c < pale.size(); ++c) {
    pale[c] = static_cast<std::uint8_t>((color[c] + 3 * kPlanBackground[c]) / 4);
  }
  return pale;
}

// Right is +x, up is -z. All coordinates are in scene space.
struct PlanView {
  View camera{};                // its eye is in the picture's middle; its frustum is outlined
  double radius = 50.0;         // metres from the eye to each border of the square picture
  std::uint32_t size_px = 900;  // width and height, 1 to 16384
  double cut_height = std::numeric_limits<double>::infinity();  // surfaces above this y are cut away
  std::span<const ObjectState> states{};                        // one for each object of the scene
  std::span<const Object> objects{};  // the scene's, to draw large ones in a pale colour; or empty
  const OccluderSet* occluders = nullptr;
  std::span<const OccluderId> occluders_used{};  // ids in *occluders; drawn on top of everything
};

}  // namespace sightline
