#include "sightline/culling/occlusion_tree_method.h"

#include <array>
#include <optional>

#include "src/culling/methods/traversal_options.h"

namespace sightline {
namespace {

using culling::TraversalBox;

class OcclusionTreeMethod final : public CullingMethod {
 public:
  explicit OcclusionTreeMethod(const OcclusionTreeMethodSettings& settings) : settings_(settings) {}

  MethodTraits traits() const override { return kOcclusionTreeTraits; }

  void prepare(const CullingScene& scene) override {
    traversal_.emplace(*scene.hierarchy, scene.object_bounds);
    tree_.emplace(OcclusionTreeSettings{.variant = settings_.variant});
  }

  void build(const CullingFrame& frame) override { tree_->build(frame.view, frame.occluders); }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    traversal_->run(frame.frustum, culling::optionsOf(frame, settings_.temporal_coherence),
                    culling::AskAll{[this](const TraversalBox& asked) {
                      return tree_->classify(asked.box, asked.frustum_planes);
                    }},
                    stats, visible);
  }

  void finish(CullStats& stats) override {
    stats.occluders = tree_->stats().occluders;
    statistics_[0].value = tree_->stats().nodes;
    statistics_[1].value = tree_->stats().plane_tests;
    statistics_[2].value = tree_->stats().dropped;
  }

  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      states[i] = tree_->classify(boxes[i].box, boxes[i].frustum_planes);
    }
  }

  std::span<const OccluderId> occludersUsed() const override { return tree_->occluders(); }
  std::span<const MethodStatistic> statistics() const override { return statistics_; }

 private:
  OcclusionTreeMethodSettings settings_;
  std::optional<culling::HierarchicalTraversal> traversal_;
  std::optional<OcclusionTree> tree_;
  std::array<MethodStatistic, 3> statistics_{{{"tree", "nodes", "nodes of the tree"},
                                              {"tree", "plane_tests", "plane tests"},
                                              {"tree", "dropped", "occluders without room"}}};
};

}  // namespace

std::unique_ptr<CullingMethod> occlusionTree(const OcclusionTreeMethodSettings& settings) {
  return std::make_unique<OcclusionTreeMethod>(settings);
}

}  // namespace sightline
