#pragma once

// Which instances of a World a light's shadow map needs: those that the light sees, and that can throw a
// shadow on what the camera sees.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/scene/camera.h"
#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"

namespace sightline {

struct ShadowCasterSettings {
  // How the view from the light is culled. `groups` names the instances that cast shadows.
  WorldCullerSettings culler{};
  std::uint32_t mask_pixels = 128;  // of each side of the light's picture of what is seen, 1 to 1024
  // Metres. A shadow map is read for a point beside the point's own line to the light too, up to this far
  // from it: give the size of a texel plus the radius of the map's filter, at the farthest point that is
  // shaded. Casters are widened by it. 0 is right for shadows that are exact.
  double filter = 0.0;
};

struct ShadowCasterStats {
  std::uint32_t seen_by_light = 0;   // instances that the culler kept
  std::uint32_t before_nothing = 0;  // of these, before nothing that the camera may see
  std::uint32_t beside_view = 0;     // of the others, those whose shadows miss the camera's frustum
};

// Conservative: with these instances alone in the map, every point that the camera sees has the light that it
// has with all. An instance that another one hides from the light wholly throws no shadow of its own; this
// holds for maps of front faces, or of both.
//
// Based on: Bittner, Mattausch, Silvennoinen, Wimmer. Shadow Caster Culling for Efficient Shadow Mapping. I3D
// 2011. Differs from the paper in: boxes of receivers are drawn, as rectangles with their farthest depth, on
// the processor; a caster's shadow volume is also compared with the camera's frustum.
//
// One for each light, or cascade. For one thread at a time.
class ShadowCasters {
 public:
  explicit ShadowCasters(const ShadowCasterSettings& settings = {});
  ~ShadowCasters();
  ShadowCasters(ShadowCasters&&) noexcept;
  ShadowCasters& operator=(ShadowCasters&&) noexcept;

  // light: the view that the map is drawn with, world space; orthographic for the sun. What is before its
  // near plane casts no shadow, as it is not in the map. seen: has culled this world for the camera, of one
  // or of several views, since the world was changed.
  void cull(const World& world, const View& light, const WorldCuller& seen);

  // Answers of the last cull(). Spans are valid until the next one, or until this is destroyed.
  std::span<const InstanceId> casters() const;  // ascending
  // Instance i is bit i % 64 of word i / 64, as in WorldCuller::visibleBits().
  std::span<const std::uint64_t> casterBits() const;
  const ShadowCasterStats& stats() const;
  const WorldCuller& light() const;  // of all that the light sees

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
