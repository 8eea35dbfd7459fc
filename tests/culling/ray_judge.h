#pragma once

// Culls the same views with every setting, and checks the results by casting rays.

#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "tests/culling/demo_frames.h"
#include "tests/culling/kept_objects.h"
#include "tests/culling/seen_though_culled.h"

namespace sightline::demo_frames {

using kept_objects::isKept;

struct NamedCuller {
  std::string name;
  AnyCuller culler;
};

// Makes cullers with all structures and hierarchies, with and without temporal coherence, one of the two with
// few occluders; and cullers with occluders from the database and the second test of detail objects. In a
// single frame, structures without joint occlusion hide nothing that those with it do not hide (TwoForms), so
// they are judged with coherence alone.
inline std::vector<NamedCuller> allCullers(const DemoScene& demo) {
  std::vector<NamedCuller> cullers;
  const auto add = [&](std::string name, HierarchyKind kind, const AnySettings& settings) {
    name += " " + nameOf(kind) + (settings.temporal_coherence ? " coherent " : " incoherent ") +
            std::to_string(settings.occluder_count) + " occluders";
    cullers.push_back({std::move(name), demo.culler(kind, settings)});
  };
  for (const HierarchyKind kind : kKinds) {
    for (const NamedSettings& structure : kStructures) {
      AnySettings settings = structure.settings;
      const bool joint = settings.supporting_planes.joint_occlusion && settings.kept_planes.joint_occlusion;
      for (const bool coherence : {true, false}) {
        settings.temporal_coherence = coherence;
        settings.occluder_count = coherence == (kind == HierarchyKind::kBvh) ? 64 : 8;
        if (coherence || joint) {
          add(structure.name, kind, settings);
        }
      }
    }
    for (const NamedSettings& method : kMethods) {
      AnySettings settings = method.settings;
      settings.use_lists = true;
      settings.detail_objects = true;
      add(std::string("database, detail objects, ") + method.name, kind, settings);
    }
  }
  return cullers;
}

// Makes cullers that draw whole surfaces, in the ways that they can be combined with other settings.
inline std::vector<NamedCuller> surfaceCullers(const DemoScene& demo) {
  const AnySettings surfaces{
      .method = AnyMethod::kDepthPyramid, .surfaces = SurfaceUse::kAlone, .object_boxes = true};
  std::vector<NamedCuller> cullers;
  const auto add = [&](std::string name, const auto& change) {
    AnySettings settings = surfaces;
    change(settings);
    cullers.push_back({std::move(name), demo.culler(HierarchyKind::kBvh, settings)});
  };
  cullers.push_back({"surfaces, kd-tree", demo.culler(HierarchyKind::kKdTree, surfaces)});
  add("surfaces", [](AnySettings&) {});
  add("surfaces, incoherent", [](AnySettings& s) { s.temporal_coherence = false; });
  add("surfaces, focused", [](AnySettings& s) { s.focus.worth = 1e9; });
  add("surfaces, not focused", [](AnySettings& s) { s.focus.magnification = 0.0f; });
  add("surfaces, eight views at once", [](AnySettings& s) { s.views_at_once = 8; });
  add("surfaces, little to draw", [](AnySettings& s) { s.drawing.budget = 300; });
  add("surfaces, few pixels", [](AnySettings& s) { s.raster = {.width = 61, .height = 35}; });
  add("surfaces with occluders", [](AnySettings& s) { s.surfaces = SurfaceUse::kWithOccluders; });
  add("surfaces in an opacity map", [](AnySettings& s) { s.method = AnyMethod::kOpacityMap; });
  return cullers;
}

// Returns the objects that at least one of the cullers left out.
inline std::vector<ObjectId> culledByAny(const DemoScene& demo, const std::vector<NamedCuller>& cullers) {
  std::vector<std::size_t> keepers(demo.bounds.size(), 0);
  for (const NamedCuller& c : cullers) {
    for (const ObjectId object : c.culler.visible()) {
      ++keepers[object.value];
    }
  }
  std::vector<ObjectId> culled;
  for (std::size_t i = 0; i < keepers.size(); ++i) {
    if (keepers[i] < cullers.size()) {
      culled.push_back(ObjectId(i));
    }
  }
  return culled;
}

// The names of the cullers that left out the object.
inline std::string namesWithout(const std::vector<NamedCuller>& cullers, ObjectId object) {
  std::string names;
  for (const NamedCuller& c : cullers) {
    names += isKept(c.culler, object) ? "" : c.name + "; ";
  }
  return names;
}

struct Counts {
  std::size_t seen = 0, hidden = 0;  // objects seen by rays; culled ones within the frustum
};

class Judge {
 public:
  explicit Judge(const DemoScene& demo) : Judge(demo, allCullers(demo)) {}
  Judge(const DemoScene& demo, std::vector<NamedCuller> cullers)
      : demo_(demo),
        exact_(demo.scene.view()),
        cullers_(std::move(cullers)),
        frustum_(demo.culler(HierarchyKind::kBvh, {.method = AnyMethod::kFrustum})) {}

  // Culls a view that is not judged, so that the next ones follow it.
  void pass(const View& view) {
    for (NamedCuller& c : cullers_) {
      c.culler.cull(view);
    }
  }

  void judge(const View& view, const std::string& where) {
    pass(view);
    for (const NamedCuller& c : cullers_) {
      const std::span<const ObjectId> visible = c.culler.visible();
      EXPECT_TRUE(std::adjacent_find(visible.begin(), visible.end(), std::greater_equal<>()) == visible.end())
          << "not ascending, or twice the same: " << c.name << ", " << where;
    }
    frustum_.cull(view);
    std::vector<ObjectId> culled = culledByAny(demo_, cullers_);
    std::erase_if(culled, [&](ObjectId object) { return !isKept(frustum_, object); });
    counts.hidden += culled.size();
    const kept_objects::Sightings sightings =
        kept_objects::lookForCulled(exact_, view, {.width = 128, .height = 72, .samples = 6}, culled,
                                    [&](ObjectId object) { return cullersWithout(object).empty(); });
    counts.seen += sightings.through_pixels;
    for (const SeenPoint& witness : sightings.though_culled) {
      ADD_FAILURE() << "object " << witness.object.value << " is seen at " << witness.point.x << " "
                    << witness.point.y << " " << witness.point.z << ", " << where << ", but culled by "
                    << cullersWithout(witness.object);
    }
  }

  Counts counts;

 private:
  // The names of those that culled the object.
  std::string cullersWithout(ObjectId object) const {
    return namesWithout(cullers_, object) + (isKept(frustum_, object) ? "" : "frustum");
  }

  const DemoScene& demo_;
  ExactVisibility exact_;
  std::vector<NamedCuller> cullers_;
  AnyCuller frustum_;
};

}  // namespace sightline::demo_frames
