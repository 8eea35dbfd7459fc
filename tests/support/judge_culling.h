#pragma once

// Culls a scene with methods and options drawn by chance, and asks the exact verifier about all that is
// culled.

#include <algorithm>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "oracle/exact_visibility.h"
#include "sightline/occluders/occluder_database.h"
#include "tests/support/any_culler.h"
#include "tests/support/hostile_scenes.h"
#include "tests/support/object_arrays.h"

namespace sightline::test {

struct FalseCull {
  ObjectId object;
  std::size_t view = 0;
  std::string method;
  Vec3d seen_at;  // scene space
};

struct JudgeCounts {
  std::uint64_t scenes = 0, culled = 0;     // culled: by any method, once a view
  std::uint64_t proved = 0, undecided = 0;  // of these
  std::uint64_t frustum = 0;                // of these: outside the view for the frustum test alone
  std::uint64_t held = 0;                   // views that were culled together with others
};

// The result depends on the seed alone.
class CullingJudge {
 public:
  CullingJudge(const HostileScene& hostile, std::uint64_t seed, std::uint32_t max_steps = 400)
      : hostile_(hostile),
        scene_(hostile.scene.view()),
        random_(~seed),
        max_steps_(max_steps),
        bounds_(boxesOf(scene_.objects)) {
    const bool moves = !hostile.may_move.empty() && chance(3);
    static_occluders_ = occludersOf(moves, true);
    moving_occluders_ = moves ? occludersOf(true, false) : OccluderSet{};
    surfaces_ = surfacesOf(moves);
    object_boxes_ = findObjectBoxes(scene_, {.min_saving = 0.0});
    const std::uint32_t leaf = 1u + below(2);
    kd_tree_ = buildHierarchy(bounds_, {}, {.kind = HierarchyKind::kKdTree, .max_leaf_objects = leaf});
    bvh_ = buildHierarchy(bounds_, {}, {.kind = HierarchyKind::kBvh, .max_leaf_objects = leaf});
    lists_ = OccluderDatabase::build(kd_tree_, static_occluders_, {.directions = 8, .occluder_count = 64});
    near_lists_ = OccluderDatabase::build(kd_tree_, static_occluders_,
                                          {.directions = 8, .occluder_count = 64, .turned_away = true});
    for (std::uint32_t i = 0; i < kCullers; ++i) {
      addCuller(i);
    }
  }
  CullingJudge(const CullingJudge&) = delete;
  CullingJudge& operator=(const CullingJudge&) = delete;

  // Culls all views one after the other. Adds to the counts.
  std::vector<FalseCull> judge(JudgeCounts& counts) {
    std::vector<FalseCull> wrong;
    const ExactVisibility exact(scene_);
    counts.scenes += 1;
    for (std::size_t v = 0; v < hostile_.views.size(); ++v) {
      cull(hostile_.views[v]);
      counts.held += cullers_[kOfSeveralViews]->stats().held ? 1 : 0;
      std::vector<ObjectId> culled;
      for (std::uint32_t o = 0; o < bounds_.size(); ++o) {
        if (!culled_by_[o].empty()) {
          culled.emplace_back(o);
          counts.frustum += culled_by_[o].front() == 0 ? 1 : 0;
        }
      }
      const std::vector<Decision> decisions = exact.decide(hostile_.views[v], culled, max_steps_);
      for (std::size_t i = 0; i < culled.size(); ++i) {
        const Verdict verdict = decisions[i].verdict;
        counts.culled += 1;
        counts.proved += verdict == Verdict::kHidden ? 1 : 0;
        counts.undecided += verdict == Verdict::kUndecided ? 1 : 0;
        for (std::size_t c = 0; verdict == Verdict::kVisible && c < culled_by_[culled[i].value].size(); ++c) {
          wrong.push_back({culled[i], v, names_[culled_by_[culled[i].value][c]], decisions[i].witness.point});
        }
      }
    }
    return wrong;
  }

 private:
  // The last culler culls several views at once. Its options are drawn last, so that the others keep theirs.
  static constexpr std::uint32_t kOfSeveralViews = 10, kCullers = kOfSeveralViews + 1;

  std::uint32_t below(std::uint32_t count) { return static_cast<std::uint32_t>(random_() % count); }
  bool chance(std::uint32_t one_in) { return below(one_in) == 0; }

  // Returns the objects; those that move, or those that do not, are marked never to be occluders.
  std::vector<Object> marked(bool some_move, bool of_static) const {
    std::vector<Object> objects(scene_.objects.begin(), scene_.objects.end());
    for (std::uint32_t o = 0; some_move && o < objects.size(); ++o) {
      const bool moves = std::binary_search(hostile_.may_move.begin(), hostile_.may_move.end(), ObjectId(o));
      objects[o].mark = moves == of_static ? OccluderMark::kNever : OccluderMark::kAutomatic;
    }
    return objects;
  }

  // Finds the occluders of the objects that do not move, or of those that do.
  OccluderSet occludersOf(bool some_move, bool of_static) {
    const std::vector<Object> objects = marked(some_move, of_static);
    SceneView chosen = scene_;
    chosen.objects = objects;
    return findOccluders(chosen, {.area_fraction = chance(3) ? 0.98 : 1.0});
  }

  // Finds the surfaces of what does not move, in pieces of any size.
  SurfaceSet surfacesOf(bool some_move) {
    const std::vector<Object> objects = marked(some_move, true);
    SceneView chosen = scene_;
    chosen.objects = objects;
    constexpr std::uint32_t kSizes[] = {1, 3, 16, 1024};
    return findSurfaces(chosen, {.part_triangles = kSizes[below(4)],
                                 .patch_triangles = kSizes[below(4)],
                                 .cluster_triangles = kSizes[below(4)],
                                 .max_angle_deg = chance(2) ? 10.0 : 180.0,
                                 .join_edges = chance(2)});
  }

  // The first culler only culls by the frustum; each other method comes in turn, with options by chance.
  void addCuller(std::uint32_t number) {
    constexpr AnyMethod kMethods[] = {AnyMethod::kFrustum,          AnyMethod::kOcclusionTree,
                                      AnyMethod::kSupportingPlanes, AnyMethod::kKeptPlanes,
                                      AnyMethod::kOpacityMap,       AnyMethod::kDepthPyramid};
    constexpr std::uint32_t kWidths[] = {1, 5, 16, 64, 100, 256};
    AnySettings s;
    s.method = number == 0 ? AnyMethod::kFrustum : kMethods[1 + number % 5];
    s.variant = std::array{OcclusionTreeVariant::kFSE, OcclusionTreeVariant::kFSC, OcclusionTreeVariant::kFME,
                           OcclusionTreeVariant::kFMC}[below(4)];
    s.supporting_planes.joint_occlusion = s.kept_planes.joint_occlusion = !chance(4);
    s.raster.width = kWidths[below(6)];
    s.raster.height = kWidths[below(6)];
    s.focus.magnification = chance(2) ? 8.0 : 0.0;
    s.focus.worth = 1e9;
    s.temporal_coherence = chance(2);
    s.occluder_count = chance(4) ? 4u : 256u;
    s.surfaces = std::array{SurfaceUse::kNone, SurfaceUse::kAlone, SurfaceUse::kAlone,
                            SurfaceUse::kWithOccluders}[below(4)];
    if (!chance(4)) {
      s.drawing = {.min_pixels = 0.0, .min_patch_pixels = 0.0, .pixels_per_edge = 0.0};
    }
    s.drawing.budget = chance(6) ? 20u : s.drawing.budget;
    s.detail_objects = chance(6);
    s.use_lists = chance(6);
    s.object_boxes = number % 2 == 1;
    const bool kd = chance(3);
    if (number == 0) {
      s = {.method = AnyMethod::kFrustum};
    } else if (number == kOfSeveralViews) {
      s.method = AnyMethod::kDepthPyramid;
      s.surfaces = SurfaceUse::kAlone;
      s.views_at_once = 2 + below(15);
    }
    constexpr const char* kNames[] = {"frustum",     "occlusion tree", "supporting planes",
                                      "kept planes", "opacity map",    "depth pyramid"};
    names_.push_back(
        std::string(kNames[static_cast<std::size_t>(s.method)]) + " (variant " +
        std::to_string(static_cast<int>(s.variant)) + ", joint " +
        std::to_string(s.supporting_planes.joint_occlusion) + ", map " + std::to_string(s.raster.width) +
        " x " + std::to_string(s.raster.height) + ", focus " + std::to_string(s.focus.magnification > 1.0) +
        ", coherence " + std::to_string(s.temporal_coherence) + ", occluders " +
        std::to_string(s.occluder_count) + ", detail " + std::to_string(s.detail_objects) + ", surfaces " +
        std::to_string(static_cast<int>(s.surfaces)) + ", lists " + std::to_string(s.use_lists) + ", boxes " +
        std::to_string(s.object_boxes) + ", views at once " + std::to_string(s.views_at_once) +
        (kd ? ", kd-tree" : ", bvh") + ")");
    cullers_.push_back(
        std::make_unique<AnyCuller>(kd ? kd_tree_ : bvh_, bounds_, static_occluders_, s,
                                    AnyLists{&lists_, &near_lists_, &surfaces_, &object_boxes_}));
  }

  // Views over which a camera comes to this one, moving and turning by the same each frame.
  std::vector<View> approachTo(const View& view) {
    const auto in = [&](double low, double high) {
      return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
    };
    const double size = 10.0 * view.z_near * std::exp2(in(-14.0, -1.0)),
                 angle = chance(2) ? 0.0 : in(-0.02, 0.02);
    const Vec3d step = (view.right * in(-1, 1) + view.up * in(-1, 1) + view.forward * in(-1, 1)) * size;
    std::vector<View> views;
    for (std::uint32_t before = 2 + below(2); before > 0; --before) {
      View earlier = view;
      earlier.eye = view.eye - step * before;
      earlier.forward = view.forward * std::cos(angle * before) + view.right * std::sin(angle * before);
      earlier.right = view.right * std::cos(angle * before) - view.forward * std::sin(angle * before);
      views.push_back(earlier);
    }
    return views;
  }

  // Targets are given as moving boxes too: what either answer leaves out is culled.
  void cull(const View& view) {
    culled_by_.assign(bounds_.size(), {});
    const std::span<const Box> boxes = std::span(bounds_).subspan(hostile_.first_target);
    const OccluderSet* moving = moving_occluders_.occluders.empty() ? nullptr : &moving_occluders_;
    for (const View& earlier : approachTo(view)) {
      cullers_[kOfSeveralViews]->cull(earlier, boxes, moving);
    }
    for (std::size_t c = 0; c < cullers_.size(); ++c) {
      AnyCuller& culler = *cullers_[c];
      culler.cull(view, boxes, moving);
      for (std::uint32_t o = 0; o < bounds_.size(); ++o) {
        const bool kept = std::binary_search(culler.visible().begin(), culler.visible().end(), ObjectId(o));
        const bool hidden = o >= hostile_.first_target &&
                            culler.dynamicStates()[o - hostile_.first_target] == Visibility::kHidden;
        if (!kept || hidden) {
          culled_by_[o].push_back(c);
        }
      }
    }
  }

  const HostileScene& hostile_;
  SceneView scene_;
  std::mt19937_64 random_;
  std::uint32_t max_steps_;
  std::vector<Box> bounds_;
  OccluderSet static_occluders_, moving_occluders_;
  SurfaceSet surfaces_;
  ObjectBoxes object_boxes_;
  Hierarchy kd_tree_, bvh_;
  OccluderDatabase lists_, near_lists_;
  std::vector<std::string> names_;
  std::vector<std::unique_ptr<AnyCuller>> cullers_;
  std::vector<std::vector<std::size_t>> culled_by_;  // cullers, by object
};

}  // namespace sightline::test
