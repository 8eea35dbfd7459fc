#include "sightline/culling/detail_objects.h"

#include <optional>
#include <utility>

#include "src/base/stopwatch.h"
#include "src/culling/methods/detail_test.h"

namespace sightline {
namespace {

class DetailObjects final : public CullingMethod {
 public:
  DetailObjects(std::unique_ptr<CullingMethod> method, const DetailObjectsSettings& settings)
      : method_(std::move(method)), settings_(settings) {
    collectStatistics();
  }

  MethodTraits traits() const override { return method_->traits(); }
  bool wantsOccluders() const override { return method_->wantsOccluders(); }
  bool drawsBodies() const override { return method_->drawsBodies(); }

  void prepare(const CullingScene& scene) override {
    method_->prepare(scene);
    scene_ = scene;
    planes_.emplace(settings_.planes);
  }
  void build(const CullingFrame& frame) override { method_->build(frame); }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    method_->traverse(frame, stats, visible);
    tested_ = culled_ = 0;
    if (scene_.near_objects != nullptr) {
      base::Stopwatch watch;
      test(frame.view, visible);
      stats.detail_us = watch.lap();
    }
  }

  void finish(CullStats& stats) override {
    method_->finish(stats);
    collectStatistics();
  }
  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    method_->classify(boxes, states);
  }
  void seesPoints(std::span<const Vec3f> points, std::span<std::uint8_t> seen) const override {
    method_->seesPoints(points, seen);
  }
  std::span<const OccluderId> occludersUsed() const override { return method_->occludersUsed(); }
  DepthBufferView depthBuffer() const override { return method_->depthBuffer(); }
  std::span<const MethodStatistic> statistics() const override { return statistics_; }

 private:
  void collectStatistics() {
    const std::span<const MethodStatistic> of_method = method_->statistics();
    statistics_.assign(of_method.begin(), of_method.end());
    statistics_.push_back({"detail", "tested", "detail tested", tested_});
    statistics_.push_back({"detail", "culled", "detail culled", culled_});
  }

  void test(const View& view, std::vector<ObjectId>& visible) {
    culling::DetailTest test(scene_, view, settings_.occluder_count);
    if (!method_->testDetail(test, visible)) {
      planes_->build(view, *scene_.occluders, {});
      test.run(*planes_, visible);
    }
    tested_ = test.tested;
    culled_ = test.culled;
  }

  std::unique_ptr<CullingMethod> method_;
  DetailObjectsSettings settings_;
  CullingScene scene_;
  std::optional<SupportingPlanes> planes_;  // where the method has none
  std::uint64_t tested_ = 0, culled_ = 0;   // objects of this frame
  std::vector<MethodStatistic> statistics_;
};

}  // namespace

std::unique_ptr<CullingMethod> detailObjects(std::unique_ptr<CullingMethod> method,
                                             const DetailObjectsSettings& settings) {
  return std::make_unique<DetailObjects>(std::move(method), settings);
}

}  // namespace sightline
