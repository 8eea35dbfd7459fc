#include "oracle/ray_scene.h"

#include <cmath>

namespace sightline {
namespace {

constexpr std::uint64_t kManyTriangles = 4'000'000;  // above this count, prefer less memory to more speed

// Embree may end the program at origins and directions with larger numbers.
constexpr float kFarthestRay = 1e18f;

// Whether Embree may trace the ray. Others meet nothing, and what they might have shown is left to the exact
// search that comes after rays.
bool isTraceable(const FloatRay& ray) {
  const auto near = [](const Vec3f& v) {
    return std::abs(v.x) <= kFarthestRay && std::abs(v.y) <= kFarthestRay && std::abs(v.z) <= kFarthestRay;
  };
  return near(ray.origin) && near(ray.direction);
}

Vec3d normalOf(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  return cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a));
}

RTCScene newScene(RTCDevice device, bool compact) {
  RTCScene scene = rtcNewScene(device);
  const int flags = RTC_SCENE_FLAG_ROBUST | (compact ? RTC_SCENE_FLAG_COMPACT : RTC_SCENE_FLAG_NONE);
  rtcSetSceneFlags(scene, static_cast<RTCSceneFlags>(flags));
  return scene;
}

void setRays(const RayScene::Batch& rays, std::uint32_t count, RTCRayHit16& packet) {
  for (std::uint32_t i = 0; i < RayScene::kBatch; ++i) {
    // Where vectors are short, Embree also looks at those that are not to be traced.
    const FloatRay ray =
        i < count && isTraceable(rays[i]) ? rays[i] : FloatRay{{}, {0.0f, 0.0f, 1.0f}, -1.0f};
    packet.ray.org_x[i] = ray.origin.x;
    packet.ray.org_y[i] = ray.origin.y;
    packet.ray.org_z[i] = ray.origin.z;
    packet.ray.dir_x[i] = ray.direction.x;
    packet.ray.dir_y[i] = ray.direction.y;
    packet.ray.dir_z[i] = ray.direction.z;
    packet.ray.tnear[i] = 0.0f;
    packet.ray.tfar[i] = ray.length;
    packet.ray.time[i] = 0.0f;
    packet.ray.mask[i] = 0xffffffffu;
    packet.ray.flags[i] = 0;
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    packet.hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
}

}  // namespace

// Passed to the filter by Embree; receives the hits of see-through triangles with one ray.
struct RayScene::CollectContext {
  RTCIntersectContext base;
  std::uint32_t ray = 0;  // index in the batch
  std::vector<RayHit>* hits = nullptr;
};

RayScene::RayScene(const SceneView& scene) {
  // One thread: Embree's parallel builder may order triangles differently, which would change ties.
  device_ = rtcNewDevice("threads=1");
  const bool compact = scene.indices.size() / 3 > kManyTriangles;
  opaque_ = newScene(device_, compact);
  see_through_ = newScene(device_, compact);
  gather(scene);
  for (Group& group : groups_) {
    attach(group);
  }
  rtcCommitScene(opaque_);
  rtcCommitScene(see_through_);
}

RayScene::~RayScene() {
  for (Group& group : groups_) {
    if (group.geometry != nullptr) {
      rtcReleaseGeometry(group.geometry);
    }
  }
  rtcReleaseScene(opaque_);
  rtcReleaseScene(see_through_);
  rtcReleaseDevice(device_);
}

// Copies all triangles that can be hit: those with finite corners and an area.
void RayScene::gather(const SceneView& scene) {
  positions_.assign(scene.positions.begin(), scene.positions.end());
  positions_.push_back({});
  for (std::uint32_t i = 0; i < groups_.size(); ++i) {
    groups_[i].owner = this;
    groups_[i].opaque = (i & 1u) != 0;
    groups_[i].double_sided = (i & 2u) != 0;
  }
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    const Material& material = scene.materialOf(object);
    Group& group = groups_[(occludes(scene, object) ? 1u : 0u) + (material.double_sided ? 2u : 0u)];
    const std::span<const std::uint32_t> indices = scene.indicesOf(object);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      const Vec3f &a = scene.positions[indices[i]], &b = scene.positions[indices[i + 1]],
                  &c = scene.positions[indices[i + 2]];
      if (isFinite(a) && isFinite(b) && isFinite(c) && normalOf(a, b, c) != Vec3d{}) {
        group.indices.insert(group.indices.end(), {indices[i], indices[i + 1], indices[i + 2]});
        group.object_of_prim.push_back(o);
        group.first_index_of_prim.push_back(static_cast<std::uint32_t>(object.first_index + i));
      }
    }
  }
}

void RayScene::attach(Group& group) {
  if (group.object_of_prim.empty()) {
    return;
  }
  group.geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetSharedGeometryBuffer(group.geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, positions_.data(),
                             0, sizeof(Vec3f), positions_.size() - 1);
  rtcSetSharedGeometryBuffer(group.geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, group.indices.data(),
                             0, 3 * sizeof(std::uint32_t), group.object_of_prim.size());
  rtcSetGeometryUserData(group.geometry, &group);
  if (!group.opaque || !group.double_sided) {
    rtcSetGeometryIntersectFilterFunction(group.geometry, &RayScene::filter);
  }
  rtcCommitGeometry(group.geometry);
  group.geometry_id = rtcAttachGeometry(group.opaque ? opaque_ : see_through_, group.geometry);
  has_see_through_ = has_see_through_ || !group.opaque;
}

bool RayScene::meetsBack(const Group& group, std::uint32_t prim, const Vec3d& direction) const {
  const std::uint32_t* index = group.indices.data() + 3 * static_cast<std::size_t>(prim);
  return dot(normalOf(positions_[index[0]], positions_[index[1]], positions_[index[2]]), direction) >= 0.0;
}

// Rejects back faces of single-sided triangles. For see-through triangles, records the hit and lets the ray
// continue.
void RayScene::filter(const RTCFilterFunctionNArguments* arguments) {
  const Group& group = *static_cast<const Group*>(arguments->geometryUserPtr);
  const unsigned n = arguments->N;
  for (unsigned i = 0; i < n; ++i) {
    if (arguments->valid[i] != -1) {
      continue;
    }
    const std::uint32_t prim = RTCHitN_primID(arguments->hit, n, i);
    const Vec3d direction(RTCRayN_dir_x(arguments->ray, n, i), RTCRayN_dir_y(arguments->ray, n, i),
                          RTCRayN_dir_z(arguments->ray, n, i));
    const bool back = !group.double_sided && group.owner->meetsBack(group, prim, direction);
    if (back || !group.opaque) {
      arguments->valid[i] = 0;
    }
    if (!back && !group.opaque) {
      auto* context = reinterpret_cast<CollectContext*>(arguments->context);
      context->hits->push_back({context->ray, ObjectId(group.object_of_prim[prim]),
                                RTCRayN_tfar(arguments->ray, n, i), group.first_index_of_prim[prim], false});
    }
  }
}

void RayScene::trace(const Batch& rays, std::uint32_t count, bool coherent, std::vector<RayHit>& hits) const {
  alignas(64) RTCRayHit16 packet;
  alignas(64) int valid[kBatch];
  setRays(rays, count, packet);
  for (std::uint32_t i = 0; i < kBatch; ++i) {
    valid[i] = i < count && isTraceable(rays[i]) ? -1 : 0;
  }
  CollectContext context{};
  rtcInitIntersectContext(&context.base);
  context.base.flags = coherent ? RTC_INTERSECT_CONTEXT_FLAG_COHERENT : RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT;
  context.hits = &hits;
  rtcIntersect16(valid, opaque_, &context.base, &packet);
  for (std::uint32_t i = 0; i < count; ++i) {
    for (const Group& group : groups_) {
      if (valid[i] != 0 && packet.hit.geomID[i] != RTC_INVALID_GEOMETRY_ID && group.opaque &&
          packet.hit.geomID[i] == group.geometry_id) {
        const std::uint32_t prim = packet.hit.primID[i];
        hits.push_back({i, ObjectId(group.object_of_prim[prim]), packet.ray.tfar[i],
                        group.first_index_of_prim[prim], true});
      }
    }
    packet.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  }
  // One by one, up to the opaque hit at tfar. Where the processor's vectors are too short for a packet,
  // Embree traces it in parts, loses the ids of the rays, and also traces those that are not valid: the
  // filter could not tell which ray it is called for.
  for (std::uint32_t i = 0; i < count && has_see_through_; ++i) {
    if (valid[i] == 0) {
      continue;
    }
    context.ray = i;
    RTCRayHit ray = rtcGetRayHitFromRayHitN(reinterpret_cast<RTCRayHitN*>(&packet), kBatch, i);
    rtcIntersect1(see_through_, &context.base, &ray);
  }
}

}  // namespace sightline
