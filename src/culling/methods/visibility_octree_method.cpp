#include "sightline/culling/visibility_octree_method.h"

#include <optional>

#include "src/culling/methods/traversal_options.h"
#include "src/culling/set_filter.h"
#include "src/culling/set_traversal.h"

namespace sightline {
namespace {

class VisibilityOctreeMethod final : public CullingMethod {
 public:
  MethodTraits traits() const override { return kVisibilityOctreeTraits; }

  void prepare(const CullingScene& scene) override {
    scene_ = scene;
    of_set_.emplace(scene.object_bounds.size());
    of_all_.reset();
    if (!scene.hierarchy->nodes.empty()) {
      of_all_.emplace(*scene.hierarchy, scene.object_bounds);
    }
  }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    if (frame.filter != nullptr) {
      of_set_->run(frame.frustum, frame.filter->boxes(), frame.filter->nodes(), stats, visible);
    } else if (of_all_) {
      of_all_->run(frame.frustum, culling::optionsOf(frame, false), culling::seeEverything(), stats, visible);
    } else {
      keepAllInFrustum(frame.frustum, stats, visible);
    }
  }

 private:
  void keepAllInFrustum(const Frustum& frustum, CullStats& stats, std::vector<ObjectId>& visible) const {
    for (std::size_t i = 0; i < scene_.object_bounds.size(); ++i) {
      std::uint8_t planes = kAllFrustumPlanes;
      if (sightline::classify(frustum, scene_.object_bounds[i], planes) != FrustumSide::kOutside) {
        visible.push_back(ObjectId(i));
      }
    }
    stats.nodes_visited += static_cast<std::uint32_t>(scene_.object_bounds.size());
  }

  CullingScene scene_;
  std::optional<culling::SetTraversal> of_set_;
  std::optional<culling::HierarchicalTraversal> of_all_;  // where there is a hierarchy
};

}  // namespace

std::unique_ptr<CullingMethod> visibilityOctree() {
  return std::make_unique<VisibilityOctreeMethod>();
}

}  // namespace sightline
