#pragma once

// The triangles of a scene in Embree's structures: opaque ones, which stop rays, and see-through ones, which
// do not.

#include <embree3/rtcore.h>

#include <array>
#include <cstdint>
#include <vector>

#include "oracle/view_rays.h"
#include "sightline/scene/scene.h"

namespace sightline {

// A ray in single precision, as Embree traces it.
struct FloatRay {
  Vec3f origin, direction;
  float length = 0.0f;  // parameter of its end

  Vec3d at(float t) const { return Vec3d(origin) + Vec3d(direction) * static_cast<double>(t); }
};

struct RayHit {
  std::uint32_t ray = 0;  // index in the batch
  ObjectId object;
  float t = 0.0f;                 // parameter along the ray
  std::uint32_t first_index = 0;  // of the triangle, in the scene
  bool opaque = false;
};

// True if the object's triangles hide what lies behind them: see "The contract" in docs/conservative.md.
inline bool occludes(const SceneView& scene, const Object& object) {
  return scene.materialOf(object).opaque() && object.mark != OccluderMark::kNever;
}

class RayScene {
 public:
  static constexpr std::uint32_t kBatch = 16;
  using Batch = std::array<FloatRay, kBatch>;

  explicit RayScene(const SceneView& scene);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  // All surfaces that the first `count` rays show, unordered and with objects possibly repeated: the first
  // opaque triangle of each ray, and the see-through ones in front of it. Back faces of single-sided
  // triangles are ignored.
  void trace(const Batch& rays, std::uint32_t count, bool coherent, std::vector<RayHit>& hits) const;

 private:
  // One Embree geometry: the triangles of equal opacity and sidedness.
  struct Group {
    const RayScene* owner = nullptr;
    bool opaque = false, double_sided = false;
    std::vector<std::uint32_t> indices;              // three per triangle
    std::vector<std::uint32_t> object_of_prim;       // one per triangle
    std::vector<std::uint32_t> first_index_of_prim;  // in the scene
    RTCGeometry geometry = nullptr;
    unsigned geometry_id = RTC_INVALID_GEOMETRY_ID;
  };
  struct CollectContext;

  void gather(const SceneView& scene);
  void attach(Group& group);
  bool meetsBack(const Group& group, std::uint32_t prim, const Vec3d& direction) const;
  static void filter(const RTCFilterFunctionNArguments* arguments);

  std::vector<Vec3f> positions_;  // padded by one element, because Embree reads 16 bytes each
  std::array<Group, 4> groups_;
  RTCDevice device_ = nullptr;
  RTCScene opaque_ = nullptr, see_through_ = nullptr;
  bool has_see_through_ = false;
};

}  // namespace sightline
