#include "sightline/culling/opacity_map_method.h"

#include <cmath>
#include <optional>
#include <vector>

#include "src/culling/adaptive_coverage.h"
#include "src/culling/methods/draw_occluders.h"
#include "src/culling/methods/surface_drawing.h"
#include "src/culling/methods/traversal_options.h"

namespace sightline {
namespace {

using culling::TraversalBox;

class OpacityMapMethod final : public CullingMethod {
 public:
  explicit OpacityMapMethod(const OpacityMapMethodSettings& settings)
      : settings_(settings),
        surfaces_(settings.surfaces, settings.drawing, settings.budget_us, settings.map.raster.coverage) {
    if (settings.surfaces != SurfaceUse::kNone) {
      surface_statistics_ = statistics_.size();
      statistics_.push_back({"surfaces", "groups", "groups of surfaces drawn"});
      statistics_.push_back({"surfaces", "edges", "edges of their boundaries"});
    }
    if (adapts()) {
      adaptive_statistics_ = statistics_.size();
      statistics_.push_back({"map", "suspended", "frames without occlusion culling"});
      statistics_.push_back({"coverage", "per_mille", "coverage ratio, per mille"});
    }
  }

  MethodTraits traits() const override { return kOpacityMapTraits; }
  bool wantsOccluders() const override { return !coverage_->suspended() && surfaces_.wantsOccluders(); }
  bool drawsBodies() const override { return settings_.map.raster.coverage == nullptr; }

  void prepare(const CullingScene& scene) override {
    traversal_.emplace(*scene.hierarchy, scene.object_bounds);
    surfaces_.prepare(scene);
    map_.emplace(settings_.map);
    surfaces_.prepareBuffer(*map_);
    coverage_.emplace(settings_.map.coverage_ratio);
    own_occluders_ = 0;
    suspended_ = false;
  }

  void build(const CullingFrame& frame) override {
    map_->setCoverageRatio(coverage_->ratio());
    const bool was_suspended = suspended_;
    suspended_ = coverage_->suspended();
    if (!suspended_) {
      map_->begin(frame.view);
      own_occluders_ = culling::drawOccluders(*map_, frame.occluders, *frame.parallel_for);
      surfaces_.begin(frame);
      surfaces_.draw(*map_, frame, !was_suspended);
      surfaces_.drawMoving(*map_, frame);
      map_->finish();
    }
  }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    if (suspended_) {
      traversal_->run(frame.frustum, culling::optionsOf(frame, false), culling::seeEverything(), stats,
                      visible);
      return;
    }
    surfaces_.traverse(*map_, stats, visible, Asking{*this, frame});
  }

  void finish(CullStats& stats) override {
    if (!suspended_) {
      surfaces_.finish(stats);
    }
    const OpacityMapStats counts = suspended_ ? OpacityMapStats{} : map_->stats();
    stats.occluders = counts.raster.occluders;
    statistics_[0].value = counts.raster.hidden;
    statistics_[1].value = counts.overlap_tests;
    statistics_[2].value = counts.overlap_failed;
    statistics_[3].value = counts.given_up;
    statistics_[4].value = counts.depth_tests;
    statistics_[5].value = counts.depths_compared;
    statistics_[6].value = counts.sparse_rows;
    if (surface_statistics_ > 0) {
      statistics_[surface_statistics_].value = suspended_ ? 0 : surfaces_.groups();
      statistics_[surface_statistics_ + 1].value = suspended_ ? 0 : surfaces_.edges();
    }
    if (adapts()) {
      statistics_[adaptive_statistics_].value = suspended_ ? 1 : 0;
      statistics_[adaptive_statistics_ + 1].value =
          static_cast<std::uint64_t>(std::llround(1000.0 * coverage_->ratio()));
      if (const std::optional<double> us = triangleUs()) {
        coverage_->frame(stats.choose_us + stats.build_us + stats.traverse_us,
                         static_cast<double>(stats.hidden_triangles) * *us);
      }
    }
  }

  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      states[i] = suspended_ ? Visibility::kVisible : map_->classify(boxes[i].box);
    }
  }

  std::span<const OccluderId> occludersUsed() const override {
    return suspended_ ? std::span<const OccluderId>() : map_->occluders().first(own_occluders_);
  }
  DepthBufferView depthBuffer() const override {
    return suspended_ ? DepthBufferView{} : map_->depthBuffer();
  }
  std::span<const MethodStatistic> statistics() const override { return statistics_; }

 private:
  bool adapts() const { return settings_.renderer != nullptr || settings_.triangle_us > 0.0; }
  std::optional<double> triangleUs() const {
    return settings_.renderer != nullptr ? settings_.renderer->triangleUs() : settings_.triangle_us;
  }
  // Asks what the map does not hide: all(), and again() once more has been drawn.
  struct Asking {
    OpacityMapMethod& method;
    const CullingFrame& frame;

    void all(CullStats& stats, std::vector<ObjectId>& visible) {
      const auto classify = [this](const TraversalBox& asked) { return method.map_->classify(asked.box); };
      method.traversal_->run(frame.frustum, culling::optionsOf(frame, false), culling::AskAll{classify},
                             stats, visible);
    }
    void again(const CullStats& before, CullStats& stats, std::vector<ObjectId>& visible) {
      method.map_->finish();
      stats = before;
      visible.clear();
      all(stats, visible);
    }
  };

  OpacityMapMethodSettings settings_;
  culling::SurfaceDrawer surfaces_;
  std::optional<culling::HierarchicalTraversal> traversal_;
  std::optional<OpacityMap> map_;
  std::optional<culling::AdaptiveCoverage> coverage_;
  bool suspended_ = false;         // in this frame
  std::size_t own_occluders_ = 0;  // occluders in the map that are of the scene's set
  std::vector<MethodStatistic> statistics_{{"map", "occluders_hidden", "occluders behind others"},
                                           {"map", "overlap_tests", "overlap tests"},
                                           {"map", "overlap_failed", "of them failed"},
                                           {"map", "given_up", "given up for little coverage"},
                                           {"map", "depth_tests", "depth tests"},
                                           {"map", "depths_compared", "depths compared"},
                                           {"map", "sparse_rows", "rows compared at peaks"}};
  // The first of the statistics of surfaces, and of an adaptive coverage ratio; 0: there are none.
  std::size_t surface_statistics_ = 0, adaptive_statistics_ = 0;
};

}  // namespace

std::unique_ptr<CullingMethod> opacityMap(const OpacityMapMethodSettings& settings) {
  return std::make_unique<OpacityMapMethod>(settings);
}

}  // namespace sightline
