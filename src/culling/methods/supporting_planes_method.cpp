#include "sightline/culling/supporting_planes_method.h"

#include <optional>

#include "src/culling/methods/detail_test.h"
#include "src/culling/methods/traversal_options.h"

namespace sightline {
namespace {

using culling::TraversalBox;

// Each node is compared only with the occluders that hid some of its parent.
struct NarrowingPlanes {
  SupportingPlanes& planes;

  OccluderList start() const { return planes.all(); }
  Visibility classify(const TraversalBox& asked, OccluderList among, OccluderList& touching) {
    return planes.classify(asked.box, asked.item, among, touching);
  }
  void settled(NodeIndex) {}
};

class SupportingPlanesMethod final : public CullingMethod {
 public:
  explicit SupportingPlanesMethod(const SupportingPlanesSettings& settings) : settings_(settings) {}

  MethodTraits traits() const override { return kSupportingPlanesTraits; }

  void prepare(const CullingScene& scene) override {
    traversal_.emplace(*scene.hierarchy, scene.object_bounds);
    planes_.emplace(settings_);
  }

  void build(const CullingFrame& frame) override { planes_->build(frame.view, frame.occluders); }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    // Every node's list of occluders comes from its parent's, so that none may be skipped.
    traversal_->run(frame.frustum, culling::optionsOf(frame, false), NarrowingPlanes{*planes_}, stats,
                    visible);
  }

  bool testDetail(culling::DetailTest& test, std::vector<ObjectId>& visible) override {
    test.run(*planes_, visible);
    return true;
  }

  void finish(CullStats& stats) override { stats.occluders = planes_->stats().occluders; }

  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      states[i] = planes_->classify(boxes[i].box);
    }
  }

  std::span<const OccluderId> occludersUsed() const override { return planes_->occluders(); }

 private:
  SupportingPlanesSettings settings_;
  std::optional<culling::HierarchicalTraversal> traversal_;
  std::optional<SupportingPlanes> planes_;
};

}  // namespace

std::unique_ptr<CullingMethod> supportingPlanes(const SupportingPlanesSettings& settings) {
  return std::make_unique<SupportingPlanesMethod>(settings);
}

}  // namespace sightline
