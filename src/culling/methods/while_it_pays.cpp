#include "sightline/culling/while_it_pays.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "src/base/stopwatch.h"
#include "src/culling/adaptive_coverage.h"
#include "src/culling/hierarchical_traversal.h"
#include "src/culling/methods/traversal_options.h"

namespace sightline {
namespace {

class WhileItPays final : public CullingMethod {
 public:
  WhileItPays(std::unique_ptr<CullingMethod> method, const RendererCost& cost)
      : method_(std::move(method)), cost_{usable(cost.object_us), usable(cost.triangle_us)} {
    collectStatistics();
  }

  // By itself it needs a hierarchy to cull by the frustum.
  MethodTraits traits() const override {
    MethodTraits traits = method_->traits();
    traits.hierarchy = true;
    return traits;
  }
  bool wantsOccluders() const override { return !pays_.suspended() && method_->wantsOccluders(); }
  bool drawsBodies() const override { return method_->drawsBodies(); }
  bool answersForRegions() const override { return !pays_.suspended() && method_->answersForRegions(); }

  void prepare(const CullingScene& scene) override {
    method_->prepare(scene);
    frustum_.emplace(*scene.hierarchy, scene.object_bounds);
    findCosts(*scene.hierarchy, scene.object_bounds.size());
    pays_ = culling::AdaptiveCoverage(kNoSteps, kLongestDelay);
    given_up_ = filter_changed_ = false;
    since_trial_ = 0;
    saved_us_ = 0.0;
  }

  void build(const CullingFrame& frame) override {
    const bool gave_up = std::exchange(given_up_, pays_.suspended());
    resumes_ = gave_up && !given_up_;
    since_trial_ = resumes_ ? 0 : since_trial_ + 1;
    filter_changed_ = filter_changed_ || frame.filter_changed;
    // Answers for several views are expected to hold for as many frames as the last ones did.
    frames_ = frame.viewers.several() ? 1.0 + frame.held_before : 1.0;
    if (frame.jumped) {
      pays_.tryAgain();
    }
    if (!given_up_) {
      method_->build(forMethod(frame));
    }
  }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    compared_ = false;
    if (given_up_) {
      cullByFrustum(frame, stats, visible);
      return;
    }
    method_->traverse(forMethod(frame), stats, visible);
    if (since_trial_ < culling::AdaptiveCoverage::kTrial || since_trial_ % kComparison == 0) {
      compare(frame, visible);
    }
  }

  void finish(CullStats& stats) override {
    if (!given_up_) {
      method_->finish(stats);
      filter_changed_ = false;
    }
    if (given_up_ || compared_) {
      // Without the method the frustum would have culled once a frame, for the comparison it did so once
      // more.
      pays_.frame((stats.totalUs() - frustum_us_) / frames_ - frustum_us_, saved_us_);
    }
    collectStatistics();
  }

  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    if (given_up_) {
      std::fill(states.begin(), states.end(), Visibility::kVisible);
    } else {
      method_->classify(boxes, states);
    }
  }
  void seesPoints(std::span<const Vec3f> points, std::span<std::uint8_t> seen) const override {
    if (given_up_) {
      CullingMethod::seesPoints(points, seen);
    } else {
      method_->seesPoints(points, seen);
    }
  }
  bool testDetail(culling::DetailTest& test, std::vector<ObjectId>& visible) override {
    return !given_up_ && method_->testDetail(test, visible);
  }
  std::span<const OccluderId> occludersUsed() const override {
    return given_up_ ? std::span<const OccluderId>() : method_->occludersUsed();
  }
  DepthBufferView depthBuffer() const override {
    return given_up_ ? DepthBufferView{} : method_->depthBuffer();
  }
  std::span<const MethodStatistic> statistics() const override { return statistics_; }

 private:
  static constexpr double kNoSteps = 1.0;
  static constexpr std::uint32_t kLongestDelay = 128;
  static constexpr double kMostUs = 1e15;          // so that sums are finite
  static constexpr std::uint32_t kComparison = 4;  // frames from one comparison to the next

  static double usable(double us) { return std::isfinite(us) ? std::clamp(us, 0.0, kMostUs) : 0.0; }

  // The frame as the method is told about it. After frames that it has not seen, it knows nothing of the last
  // one.
  CullingFrame forMethod(const CullingFrame& frame) const {
    CullingFrame told = frame;
    told.filter_changed = filter_changed_;
    if (resumes_) {
      told.jumped = true;
      told.last_visible = {};
    }
    return told;
  }

  void cullByFrustum(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) {
    frustum_->run(frame.frustum, culling::optionsOf(frame, false), culling::seeEverything(), stats, visible);
  }

  // Estimates what the method saves in this frame.
  void compare(const CullingFrame& frame, std::span<const ObjectId> visible) {
    base::Stopwatch watch;
    in_frustum_.clear();
    CullStats ignored;
    cullByFrustum(frame, ignored, in_frustum_);
    frustum_us_ = watch.lap();
    saved_us_ = std::max(costOf(in_frustum_) - costOf(visible), 0.0);
    compared_ = true;
  }

  double costOf(std::span<const ObjectId> objects) const {
    double sum = 0.0;
    for (const ObjectId object : objects) {
      sum += object_us_[object.value];
    }
    return sum;
  }

  // Objects share the triangles of their leaf; of several leaves, those of the largest share count.
  void findCosts(const Hierarchy& hierarchy, std::size_t count) {
    object_us_.assign(count, cost_.object_us);
    for (std::size_t i = 0; i < hierarchy.nodes.size(); ++i) {
      const HierarchyNode& node = hierarchy.nodes[i];
      if (node.leaf()) {
        const std::span<const ObjectId> objects = hierarchy.objectsBelow(NodeIndex(i));
        for (const ObjectId object : objects) {
          const double triangles = static_cast<double>(node.cost) / static_cast<double>(objects.size());
          double& us = object_us_[object.value];
          us = std::max(us, cost_.object_us + triangles * cost_.triangle_us);
        }
      }
    }
  }

  void collectStatistics() {
    const std::span<const MethodStatistic> of_method = method_->statistics();
    statistics_.assign(of_method.begin(), of_method.end());
    for (MethodStatistic& statistic : statistics_) {
      statistic.value = given_up_ ? 0 : statistic.value;
    }
    statistics_.push_back(
        {"renderer", "given_up", "frames without occlusion culling", std::uint64_t{given_up_}});
    statistics_.push_back({"renderer", "saved_us", "microseconds of drawing saved",
                           static_cast<std::uint64_t>(std::llround(std::min(saved_us_, kMostUs)))});
  }

  std::unique_ptr<CullingMethod> method_;
  RendererCost cost_;
  std::vector<double> object_us_;  // by object: what drawing it takes
  std::optional<culling::HierarchicalTraversal> frustum_;
  culling::AdaptiveCoverage pays_{kNoSteps, kLongestDelay};
  bool given_up_ = false;                     // in this frame
  bool resumes_ = false;                      // and it was in the last one
  bool filter_changed_ = false;               // since the last frame that the method saw
  bool compared_ = false;                     // in this frame
  std::uint32_t since_trial_ = 0;             // frames of which this was told
  double frames_ = 1.0;                       // for which the answers of this one are expected to hold
  double frustum_us_ = 0.0, saved_us_ = 0.0;  // of the last comparison
  std::vector<ObjectId> in_frustum_;
  std::vector<MethodStatistic> statistics_;
};

}  // namespace

std::unique_ptr<CullingMethod> whileItPays(std::unique_ptr<CullingMethod> method, const RendererCost& cost) {
  return std::make_unique<WhileItPays>(std::move(method), cost);
}

}  // namespace sightline
