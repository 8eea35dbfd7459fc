#include "sightline/culling/frustum_method.h"

#include <optional>

#include "src/culling/methods/traversal_options.h"

namespace sightline {
namespace {

class FrustumMethod final : public CullingMethod {
 public:
  MethodTraits traits() const override { return kFrustumTraits; }
  void prepare(const CullingScene& scene) override {
    traversal_.emplace(*scene.hierarchy, scene.object_bounds);
  }
  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    traversal_->run(frame.frustum, culling::optionsOf(frame, false), culling::seeEverything(), stats,
                    visible);
  }

 private:
  std::optional<culling::HierarchicalTraversal> traversal_;
};

}  // namespace

std::unique_ptr<CullingMethod> frustumCulling() {
  return std::make_unique<FrustumMethod>();
}

}  // namespace sightline
