#pragma once

// Lines of sight in a World, from any point to any box, as gameplay asks for them: a guard and a thief, a
// turret and its targets.

#include <cstdint>
#include <memory>
#include <span>

#include "sightline/math/box.h"
#include "sightline/occlusion/visibility.h"
#include "sightline/world/world.h"

namespace sightline {

struct WorldSightSettings {
  std::uint32_t pixels = 64;           // of each side of the depth buffer that is drawn for a question
  double near_distance = 0.05;         // metres: what is nearer to the point hides nothing
  std::uint32_t groups = 0xffffffffu;  // only instances with one of these bits hide (Instance::groups)
  std::uint32_t budget = 20000;        // SurfaceLimits::budget, of each question
};

// Answers for whole boxes, not for a few rays to them: kHidden only if no point of the box can be seen from
// the point, which two crates together may bring about, or a hill. kVisible only if no other instance reaches
// between them, so that all of the box can be seen. kPartial: otherwise, or the question is too hard: the
// point is nearer to the box than about its size, or in it, or something is not finite. Gaps between members
// of a join count as closed as with the default of WorldCullerSettings::join_rounding.
//
// One question takes some microseconds more than a frustum's cull. Several threads may ask about one world,
// each with a WorldSight of its own. Nothing is allocated once the storage has grown.
class WorldSight {
 public:
  explicit WorldSight(const WorldSightSettings& settings = {});
  ~WorldSight();
  WorldSight(WorldSight&&) noexcept;
  WorldSight& operator=(WorldSight&&) noexcept;

  // The point and the box are in different spaces. from_world: world space. box_from_origin: world space less
  // World::origin(), as World::boundsOf() gives it, and World::boxFromOrigin() for what is no instance.
  // ignored: these hide nothing, as the one who looks and what is looked for.
  Visibility look(const World& world, const Vec3d& from_world, const Box& box_from_origin,
                  std::span<const InstanceId> ignored = {});

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
