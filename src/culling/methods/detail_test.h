#pragma once

// The second test of objects that a method kept: is the eye hidden from the object by occluders near the
// object?
//
// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, section 5.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/culling/culling_method.h"
#include "sightline/occlusion/supporting_planes.h"

namespace sightline::culling {

// The test for one frame. The scene has near_objects.
class DetailTest {
 public:
  DetailTest(const CullingScene& scene, const View& view, std::uint32_t occluder_count)
      : scene_(scene), view_(view), occluder_count_(occluder_count) {}

  // Removes the objects that are hidden. planes: SupportingPlanes, or what has their interface, built for
  // the view from occluders of the scene's set.
  template <typename Planes>
  void run(Planes& planes, std::vector<ObjectId>& visible) {
    const std::size_t items = scene_.hierarchy->nodes.size() + scene_.hierarchy->objects.size();
    const auto first_item = static_cast<std::uint32_t>(items);
    std::span<const OccluderId> last_near;
    OccluderList list;
    std::erase_if(visible, [&](ObjectId object) {
      const Box& box = scene_.object_bounds[object.value];
      if (!box.wellFormed()) {
        return false;
      }
      const std::span<const OccluderId> near = occludersNear(box);
      if (near.data() != last_near.data() || near.size() != last_near.size()) {
        last_near = near;
        list = planes.add(near);
      }
      OccluderList touching;
      const bool hidden =
          planes.classify(box, first_item + object.value, list, touching) == Visibility::kHidden;
      tested += 1;
      culled += hidden ? 1 : 0;
      return hidden;
    });
  }

  std::uint64_t tested = 0, culled = 0;  // objects

 private:
  // Towards the eye: what stands in between faces the eye, and turns its back to the object.
  std::span<const OccluderId> occludersNear(const Box& box) const {
    const Vec3d middle = center(box);
    const Vec3d to_eye = view_.orthographic ? -view_.forward : view_.eye - middle;
    const std::span<const OccluderId> found = scene_.near_objects->find(middle, to_eye);
    return found.first(std::min<std::size_t>(found.size(), occluder_count_));
  }

  const CullingScene& scene_;
  const View& view_;
  std::uint32_t occluder_count_;
};

}  // namespace sightline::culling
