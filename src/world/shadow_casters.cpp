#include "sightline/world/shadow_casters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "sightline/math/frustum.h"
#include "src/math/infinite_box.h"
#include "src/occlusion/boxes/pixel_boxes.h"
#include "src/scene/usable_view.h"
#include "src/world/culler_impl.h"

namespace sightline {

using namespace world;
using occlusion::BoxPlace;
using occlusion::PixelBox;

namespace {

constexpr float kAnyDepth = -std::numeric_limits<float>::infinity();  // reciprocal: everything is before it

// A box around a view's volume, larger than it by more than rounding. All of space if the far plane is at
// infinity.
Box boxAround(const View& view) {
  Box box;
  if (!std::isfinite(view.z_far)) {
    return math::infiniteBox();
  }
  const double high = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
  double size = 0.0;
  for (const double depth : {view.z_near, view.z_far}) {
    const double spread = high * (view.orthographic ? 1.0 : depth);
    for (const double x : {view.shift_x - 1.0, view.shift_x + 1.0}) {
      for (const double y : {view.shift_y - 1.0, view.shift_y + 1.0}) {
        const Vec3d corner = view.eye + view.forward * depth + view.right * (x * spread * view.aspect) +
                             view.up * (y * spread);
        box.extend(Vec3f(corner));
        size = std::max(size, maxComponent(abs(corner)));
      }
    }
  }
  return widened(box, 1e-5 * size);
}

// Not well formed if the instance has none, or is not there any more.
Box boxOf(const WorldData& data, InstanceId id) {
  return id.value < data.instances.size() && data.hasBox(id.value) ? data.boxOf(id.value) : Box{};
}

// The light as shadow volumes see it.
struct Light {
  bool directional = false;
  Vec3d at;            // a point light
  Vec3d direction;     // of rays, one metre deep in the map
  double reach = 0.0;  // metres: how deep shadows are
};

double farthestAlong(const Vec3d& normal, const Box& box) {
  const Vec3d half = (Vec3d(box.max) - Vec3d(box.min)) * 0.5;
  return dot(normal, center(box)) + dot(abs(normal), half);
}

// Whether what a box shades lies wholly outside of one of the planes, unit normals inwards.
bool shadesNothingIn(const Frustum& frustum, const Box& box, const Light& light) {
  const double size = maxComponent(max(abs(Vec3d(box.min)), abs(Vec3d(box.max))));
  return std::any_of(frustum.planes.begin(), frustum.planes.end(), [&](const Plane& plane) {
    const double rounding = 1e-12 * (size + std::abs(plane.offset) + maxComponent(abs(light.at)));
    const double inside = farthestAlong(plane.normal, box) + plane.offset + rounding;
    if (!(inside < 0.0)) {
      return false;
    }
    if (light.directional) {
      const double towards = dot(plane.normal, light.direction) + 1e-12;
      return towards <= 0.0 || inside + towards * light.reach < 0.0;
    }
    return farthestAlong(plane.normal, box) - dot(plane.normal, light.at) + rounding <= 0.0;
  });
}

}  // namespace

struct ShadowCasters::Impl {
  explicit Impl(const ShadowCasterSettings& given)
      : pixels(std::clamp(given.mask_pixels, 1u, 1024u)), filter(given.filter), light(given.culler) {}

  void drawReceivers(const WorldData& data, const scene::PixelView& map, const WorldCuller::Impl& seen);
  bool isBeforeSomething(const PixelBox& image) const;
  void choose(const WorldData& data, const View& light_view, const scene::PixelView& map,
              std::span<const View> views);
  void project(const scene::PixelView& map) {
    images.resize(boxes.size());
    occlusion::projectBoxes(map, pixels, pixels, boxes, images);
  }

  std::uint32_t pixels;
  double filter;
  WorldCuller light;
  ShadowCasterStats counts;
  std::vector<float> farthest;  // of the receivers in each pixel, reciprocal depth; infinite: none
  std::vector<Box> boxes;
  std::vector<PixelBox> images;
  std::vector<Frustum> frusta;
  std::vector<InstanceId> casters;
  IdBits bits;
};

ShadowCasters::ShadowCasters(const ShadowCasterSettings& settings)
    : impl_(std::make_unique<Impl>(settings)) {}
ShadowCasters::~ShadowCasters() = default;
ShadowCasters::ShadowCasters(ShadowCasters&&) noexcept = default;
ShadowCasters& ShadowCasters::operator=(ShadowCasters&&) noexcept = default;

// Writes into each pixel of the mask how far from the light the camera may see something there.
void ShadowCasters::Impl::drawReceivers(const WorldData& data, const scene::PixelView& map,
                                        const WorldCuller::Impl& seen) {
  const bool all = seen.counts.view_fault != nullptr;
  const bool any_place = all || std::any_of(seen.visible.begin(), seen.visible.end(),
                                            [&](InstanceId id) { return boxOf(data, id).empty(); });
  farthest.assign(std::size_t{pixels} * pixels,
                  any_place ? kAnyDepth : std::numeric_limits<float>::infinity());
  if (any_place) {
    return;
  }
  Box volume;
  for (const View& view : seen.views) {
    volume.extend(boxAround(data.fromOrigin(view)));
  }
  boxes.clear();
  for (const InstanceId id : seen.visible) {
    const Box box = intersection(boxOf(data, id), volume);
    if (!box.empty()) {
      boxes.push_back(box);
    }
  }
  project(map);
  for (const PixelBox& image : images) {
    if (image.place == BoxPlace::kOutside) {
      continue;
    }
    const bool known = image.place == BoxPlace::kOnBuffer;
    const std::uint32_t x0 = known ? image.x0 : 0, x1 = known ? image.x1 : pixels - 1,
                        y0 = known ? image.y0 : 0, y1 = known ? image.y1 : pixels - 1;
    const float depth = known ? image.farthest : kAnyDepth;
    for (std::uint32_t y = y0; y <= y1; ++y) {
      for (std::uint32_t x = x0; x <= x1; ++x) {
        float& pixel = farthest[std::size_t{y} * pixels + x];
        pixel = std::min(pixel, depth);
      }
    }
  }
}

bool ShadowCasters::Impl::isBeforeSomething(const PixelBox& image) const {
  if (image.place != BoxPlace::kOnBuffer) {
    return true;
  }
  for (std::uint32_t y = image.y0; y <= image.y1; ++y) {
    for (std::uint32_t x = image.x0; x <= image.x1; ++x) {
      if (farthest[std::size_t{y} * pixels + x] <= image.nearest) {
        return true;
      }
    }
  }
  return false;
}

void ShadowCasters::Impl::choose(const WorldData& data, const View& light_view, const scene::PixelView& map,
                                 std::span<const View> views) {
  // What has the same place in the map lies along unit_z, which is not quite forward where the axes are off.
  const Light from{light_view.orthographic, light_view.eye - data.origin, map.unit_z,
                   light_view.z_far - light_view.z_near};
  frusta.clear();
  for (const View& view : views) {
    frusta.push_back(frustumOf(data.fromOrigin(view)));
  }
  boxes.clear();
  for (const InstanceId id : light.visible()) {
    boxes.push_back(widened(boxOf(data, id), filter));
  }
  project(map);
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const InstanceId id = light.visible()[i];
    if (boxes[i].wellFormed() && !isBeforeSomething(images[i])) {
      ++counts.before_nothing;
    } else if (boxes[i].wellFormed() && !frusta.empty() &&
               std::all_of(frusta.begin(), frusta.end(), [&](const Frustum& frustum) {
                 return shadesNothingIn(frustum, boxes[i], from);
               })) {
      ++counts.beside_view;
    } else {
      casters.push_back(id);
      bits.insert(id.value);
    }
  }
}

void ShadowCasters::cull(const World& world, const View& light, const WorldCuller& seen) {
  const WorldData& data = *world.data_;
  Impl& own = *impl_;
  own.counts = {};
  own.casters.clear();
  own.bits.clear(data.instances.size());
  own.light.cull(world, light);
  own.counts.seen_by_light = static_cast<std::uint32_t>(own.light.visible().size());
  View view = light;
  const WorldCuller::Impl& camera = *seen.impl_;
  if (scene::makeUsable(view) != nullptr) {
    for (const InstanceId id : own.light.visible()) {
      own.casters.push_back(id);
      own.bits.insert(id.value);
    }
    return;
  }
  const scene::PixelView map(data.fromOrigin(view), own.pixels, own.pixels);
  own.drawReceivers(data, map, camera);
  own.choose(data, view, map,
             camera.counts.view_fault != nullptr ? std::span<const View>() : std::span(camera.views));
}

std::span<const InstanceId> ShadowCasters::casters() const {
  return impl_->casters;
}
std::span<const std::uint64_t> ShadowCasters::casterBits() const {
  return impl_->bits.words();
}
const ShadowCasterStats& ShadowCasters::stats() const {
  return impl_->counts;
}
const WorldCuller& ShadowCasters::light() const {
  return impl_->light;
}

}  // namespace sightline
