#include "tools/sightline/methods/setting.h"

namespace sightline::tool {

SurfaceUse Setting::surfaces() const {
  if (raster.coverage != nullptr || !method->has("surfaces")) {
    return SurfaceUse::kNone;
  }
  switch (surface_option) {
    case SurfaceOption::kNone:
      return SurfaceUse::kNone;
    case SurfaceOption::kAlone:
      return SurfaceUse::kAlone;
    case SurfaceOption::kWithOccluders:
      return SurfaceUse::kWithOccluders;
    case SurfaceOption::kAutomatic:
      break;
  }
  return method->name == "depth-pyramid" && occluders == OccluderChoice::kAreaAngle ? SurfaceUse::kAlone
                                                                                    : SurfaceUse::kNone;
}

std::uint32_t Setting::objectBoxes() const {
  const std::uint32_t usual = method->name == "depth-pyramid" ? kMaxObjectBoxes : 1;
  return !culler.test_objects ? 1 : object_box_option > 0 ? object_box_option : usual;
}

bool Setting::usesOccluders() const {
  return method->traits.occluders;
}

bool Setting::choosesOccluders() const {
  return usesOccluders() && surfaces() != SurfaceUse::kAlone;
}

bool Setting::usesDatabase() const {
  return choosesOccluders() && occluders == OccluderChoice::kDatabase;
}

bool Setting::usesViewpoints() const {
  return choosesOccluders() &&
         (occluders == OccluderChoice::kMinimumSets || occluders == OccluderChoice::kFirstHit ||
          occluders == OccluderChoice::kProjectedSize);
}

bool Setting::usesDepthBuffer() const {
  return method->has("resolution");
}

bool Setting::approximate() const {
  const bool tolerates = method->name == "opacity-map" && opacity_map.map.tolerance > 0;
  return (usesDepthBuffer() && raster.coverage != nullptr) || tolerates;
}

bool Setting::testsDetailObjects() const {
  return usesOccluders() && detail_objects;
}

bool Setting::knowsRendererCost() const {
  return usesOccluders() && (renderer.object_us > 0.0 || renderer.triangle_us > 0.0);
}

bool Setting::usesVisibleSets() const {
  const SetUse use = method->traits.sets;
  return use == SetUse::kAlways || (use == SetUse::kIfAsked && culler.visible_sets);
}

std::unique_ptr<CullingMethod> makeMethod(const Setting& setting) {
  std::unique_ptr<CullingMethod> method = setting.method->make(setting);
  if (setting.testsDetailObjects()) {
    DetailObjectsSettings detail = setting.detail;
    detail.planes.joint_occlusion = !setting.method->has("joint") || setting.kept_planes.joint_occlusion;
    method = detailObjects(std::move(method), detail);
  }
  return setting.knowsRendererCost() ? whileItPays(std::move(method), setting.renderer) : std::move(method);
}

OccluderCriterion criterionOf(OccluderChoice choice) {
  return choice == OccluderChoice::kFirstHit        ? OccluderCriterion::kFirstHit
         : choice == OccluderChoice::kProjectedSize ? OccluderCriterion::kProjectedSize
                                                    : OccluderCriterion::kMinimumSets;
}

std::string methodName(const Setting& setting) {
  return std::string(setting.method->name);
}

}  // namespace sightline::tool
