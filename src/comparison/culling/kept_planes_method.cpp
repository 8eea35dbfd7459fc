#include "sightline/comparison/kept_planes_method.h"

#include <array>
#include <optional>
#include <vector>

#include "src/comparison/culling/kept_planes_traversal.h"
#include "src/culling/methods/detail_test.h"
#include "src/culling/methods/traversal_options.h"

namespace sightline {
namespace {

class KeptPlanesMethod final : public CullingMethod {
 public:
  explicit KeptPlanesMethod(const KeptPlanesSettings& settings) : settings_(settings) {}

  MethodTraits traits() const override { return kKeptPlanesTraits; }

  void prepare(const CullingScene& scene) override {
    hierarchy_ = scene.hierarchy;
    traversal_.emplace(*scene.hierarchy, scene.object_bounds);
    planes_.emplace(settings_);
    entered_.assign(scene.hierarchy->nodes.size(), false);
  }

  void build(const CullingFrame& frame) override { planes_->build(frame.view, frame.occluders); }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    // Relations are their own temporal coherence, which needs every node's lists.
    node_pairs_ = 0;
    traversal_->run(frame.frustum, culling::optionsOf(frame, false),
                    comparison::KeptPlanesTraversal{*planes_, *hierarchy_, entered_, node_pairs_}, stats,
                    visible);
  }

  bool testDetail(culling::DetailTest& test, std::vector<ObjectId>& visible) override {
    test.run(*planes_, visible);
    return true;
  }

  void finish(CullStats& stats) override {
    const KeptPlanesStats counts = planes_->stats();
    stats.occluders = counts.occluders;
    const RelationStats& relations = counts.relations;
    const std::uint64_t values[] = {relations.reused,  relations.unchanged, relations.rebuilt,
                                    relations.evicted, relations.dropped,   relations.kept,
                                    relations.bytes,   node_pairs_};
    for (std::size_t i = 0; i < statistics_.size(); ++i) {
      statistics_[i].value = values[i];
    }
  }

  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      states[i] = planes_->classify(boxes[i].box);
    }
  }

  std::span<const OccluderId> occludersUsed() const override { return planes_->occluders(); }
  std::span<const MethodStatistic> statistics() const override { return statistics_; }

 private:
  KeptPlanesSettings settings_;
  const Hierarchy* hierarchy_ = nullptr;
  std::optional<culling::HierarchicalTraversal> traversal_;
  std::optional<KeptPlanes> planes_;
  std::vector<bool> entered_;     // by node, see KeptPlanesTraversal
  std::uint64_t node_pairs_ = 0;  // of the last frame
  std::array<MethodStatistic, 8> statistics_{{{"relations", "reused", "relations reused"},
                                              {"relations", "unchanged", "of them unchanged"},
                                              {"relations", "rebuilt", "relations rebuilt"},
                                              {"relations", "evicted", "relations evicted"},
                                              {"relations", "dropped", "relations dropped"},
                                              {"relations", "kept", "relations kept"},
                                              {"relations", "bytes", "bytes for them"},
                                              {"relations", "node_pairs", "occluder-node pairs"}}};
};

}  // namespace

std::unique_ptr<CullingMethod> keptPlanes(const KeptPlanesSettings& settings) {
  return std::make_unique<KeptPlanesMethod>(settings);
}

}  // namespace sightline
