#pragma once

// A scene with all that an engine passes to a culler of it.

#include <cstdint>
#include <utility>
#include <vector>

#include "sightline/culling/culler.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/scene.h"
#include "tests/support/object_arrays.h"

namespace sightline {

struct CulledScene {
  Scene scene;
  std::vector<Box> bounds;
  Hierarchy hierarchy;
  OccluderSet occluders;
  SurfaceSet surfaces;

  explicit CulledScene(Scene made) : scene(std::move(made)) {
    test::ObjectArrays objects(scene);
    bounds = std::move(objects.boxes);
    hierarchy = buildHierarchy(bounds, objects.triangles);
    occluders = findOccluders(scene.view());
    surfaces = findSurfaces(scene.view());
  }

  CullingScene parts() const {
    return {.hierarchy = &hierarchy, .object_bounds = bounds, .occluders = &occluders, .surfaces = &surfaces};
  }
};

}  // namespace sightline
