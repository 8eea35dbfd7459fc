#pragma once

// What a plan view shows: the scene from above, every object coloured by its state in one frame of culling,
// with the camera's frustum and the occluders that hid things.

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

// sRGB. Told apart by colour-blind people by lightness too. Reports use them in the legend.
using PlanColor = std::array<std::uint8_t, 3>;
inline constexpr PlanColor kPlanOutside{216, 216, 212};
inline constexpr PlanColor kPlanHidden{196, 70, 56};
inline constexpr PlanColor kPlanKept{134, 202, 112};
inline constexpr PlanColor kPlanOccluder{20, 60, 190};
inline constexpr PlanColor kPlanCamera{24, 24, 24};
inline constexpr PlanColor kPlanBackground{250, 250, 248};

// Of what is larger than half the picture, such as the ground, so that what stands on it is seen.
constexpr PlanColor paleOf(const PlanColor& color) {
  PlanColor pale{};
  for (std::size_t c = 0; c < pale.size(); ++c) {
    pale[c] = static_cast<std::uint8_t>((color[c] + 3 * kPlanBackground[c]) / 4);
  }
  return pale;
}

// Right is +x, up is -z. All coordinates in scene space.
struct PlanView {
  View camera{};                // its eye is in the middle; its frustum is outlined
  double radius = 50.0;         // metres from the eye to each border of the square picture
  std::uint32_t size_px = 900;  // width and height, 1 to 16384
  double cut_height = std::numeric_limits<double>::infinity();  // what is above (y) is cut away; inf: nothing
  std::span<const ObjectState> states{};                        // one an object of the scene
  std::span<const Object> objects{};  // the scene's: what is larger than half the picture is pale; or empty
  const OccluderSet* occluders = nullptr;
  std::span<const OccluderId> occluders_used{};  // of *occluders; drawn on top of everything
};

}  // namespace sightline
