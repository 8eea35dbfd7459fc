#include "sightline/world/world_sight.h"

#include <algorithm>
#include <cmath>

#include "src/scene/usable_view.h"
#include "src/world/world_data.h"
#include "src/world/world_eye.h"

namespace sightline {

using namespace world;

namespace {

constexpr double kWidest = 4.0;  // tangent of half an angle of view

WorldCullerSettings cullerSettings(const WorldSightSettings& given) {
  WorldCullerSettings settings;
  settings.raster = {.width = given.pixels, .height = given.pixels};
  // A question is about few pixels.
  settings.drawing.min_pixels = 16.0;
  settings.drawing.min_patch_pixels = 16.0;
  settings.drawing.pixels_per_edge = 1.0;
  settings.drawing.budget = given.budget;
  settings.groups = given.groups;
  return settings;
}

// The narrowest view along the line to the middle of a box that has all of it. Returns false if there is
// none.
bool aimAt(const Vec3d& from, const Box& box, const Vec3d& origin, double near, View& view) {
  if (!box.wellFormed() || !isFinite(from) || !(near >= 0.0)) {
    return false;
  }
  view.eye = from;
  // Near the point, this difference is exact, however far both are from the origin of world space.
  const Vec3d to_point = from - origin;
  setOrientation(view, center(box) - to_point, {0, 1, 0});
  double wide = 0.0, high = 0.0, far = 0.0, nearest = HUGE_VAL;
  for (int i = 0; i < 8; ++i) {
    const Vec3d corner((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                       (i & 4) != 0 ? box.max.z : box.min.z);
    const Vec3d at = corner - to_point;
    const double depth = dot(view.forward, at);
    wide = std::max(wide, std::abs(dot(view.right, at)) / depth);
    high = std::max(high, std::abs(dot(view.up, at)) / depth);
    far = std::max(far, depth);
    nearest = std::min(nearest, depth);
  }
  // A box that is a point has a view, too.
  constexpr double kMargin = 1.001, kNarrowest = 1e-4;
  view.tan_half_fovy = std::max(kMargin * high, kNarrowest);
  view.aspect = std::max(kMargin * wide, kNarrowest) / view.tan_half_fovy;
  view.z_near = near;
  view.z_far = kMargin * far;
  return nearest > near && std::max(wide, high) < kWidest && scene::makeUsable(view) == nullptr;
}

}  // namespace

struct WorldSight::Impl {
  explicit Impl(const WorldSightSettings& given) : settings(given), eye(cullerSettings(given)) {}

  WorldSightSettings settings;
  WorldEye eye;
};

WorldSight::WorldSight(const WorldSightSettings& settings) : impl_(std::make_unique<Impl>(settings)) {}
WorldSight::~WorldSight() = default;
WorldSight::WorldSight(WorldSight&&) noexcept = default;
WorldSight& WorldSight::operator=(WorldSight&&) noexcept = default;

Visibility WorldSight::look(const World& world, const Vec3d& from_world, const Box& box_from_origin,
                            std::span<const InstanceId> ignored) {
  View view;
  if (!aimAt(from_world, box_from_origin, world.data_->origin, impl_->settings.near_distance, view)) {
    return Visibility::kPartial;
  }
  return impl_->eye.look(*world.data_, view, box_from_origin, ignored);
}

}  // namespace sightline
