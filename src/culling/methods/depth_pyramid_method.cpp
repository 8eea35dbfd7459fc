#include "sightline/culling/depth_pyramid_method.h"

#include <algorithm>
#include <array>
#include <optional>

#include "src/culling/methods/draw_occluders.h"
#include "src/culling/methods/focus_maps.h"
#include "src/culling/methods/surface_drawing.h"
#include "src/culling/methods/traversal_options.h"
#include "src/culling/set_filter.h"
#include "src/culling/wide_traversal.h"

namespace sightline {
namespace {

class DepthPyramidMethod final : public CullingMethod {
 public:
  explicit DepthPyramidMethod(const DepthPyramidMethodSettings& settings)
      : settings_(settings),
        surfaces_(settings.surfaces, settings.drawing, settings.budget_us, settings.raster.coverage) {}

  MethodTraits traits() const override { return kDepthPyramidTraits; }
  bool wantsOccluders() const override { return surfaces_.wantsOccluders(); }
  bool drawsBodies() const override { return settings_.raster.coverage == nullptr; }
  bool answersForRegions() const override { return surfaces_.draws() && !surfaces_.wantsOccluders(); }

  void prepare(const CullingScene& scene) override {
    scene_ = scene;
    traversal_.emplace(*scene.hierarchy, scene.object_bounds);
    surfaces_.prepare(scene);
    pyramid_.emplace(DepthPyramidSettings{settings_.raster});
    surfaces_.prepareBuffer(*pyramid_);
    turn_ = 0;
    own_occluders_ = 0;
    focus_.reset();
    if (settings_.focus.windows > 0 && settings_.focus.magnification > 1.0 && drawsBodies()) {
      const DepthBufferView buffer = pyramid_->depthBuffer();
      focus_.emplace(settings_.focus, scene_, buffer.width, buffer.height, settings_.temporal_coherence);
    }
  }

  void build(const CullingFrame& frame) override {
    if (frame.filter_changed) {
      traversal_->restrictTo(frame.filter != nullptr ? frame.filter->objects() : culling::ObjectSet{});
    }
    if (frame.jumped) {
      traversal_->forget();
    }
    pyramid_->begin(frame.view, frame.viewers);
    own_occluders_ = culling::drawOccluders(*pyramid_, frame.occluders, *frame.parallel_for);
    surfaces_.begin(frame);
    work_ = surfaces_.drawMoving(*pyramid_, frame);
    drawSurfaces(frame);
    work_ += surfaces_.work();
    pyramid_->finish(*frame.parallel_for);
    if (focus_) {
      focus_->begin();
    }
  }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    // With surfaces most time goes into drawing, and testing everything costs little.
    const bool skips = settings_.temporal_coherence && !surfaces_.draws() && !surfaces_.drawsMoving(frame);
    const culling::TraversalOptions options = culling::optionsOf(frame, skips);
    surfaces_.traverse(*pyramid_, stats, visible, Asking{*this, frame, options});
    if (focus_ && frame.test_objects) {
      focus_->refine({.buffer = *pyramid_,
                      .frame = frame,
                      .surfaces = surfaces_,
                      .surface_work = work_,
                      .traversal = stats,
                      .changes_fast = surfaces_.changesFast()},
                     visible);
    }
  }

  void finish(CullStats& stats) override {
    surfaces_.finish(stats);
    const RasterStats& raster = pyramid_->stats();
    stats.occluders = raster.occluders;
    statistics_[0].value = raster.hidden;
    statistics_[1].value = focus_ ? focus_->windows() : 0;
    statistics_[2].value = focus_ ? focus_->hidden() : 0;
    statistics_[3].value = surfaces_.groups();
    statistics_[4].value = surfaces_.edges();
  }

  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    asked_.clear();
    seen_points_.clear();
    for (const MovingBox& box : boxes) {
      asked_.push_back(box.box);
      seen_points_.push_back(box.seen_point != nullptr ? *box.seen_point : Vec3f(center(box.box)));
    }
    seen_.resize(boxes.size());
    pyramid_->seesPoints(seen_points_, seen_);
    answers_.resize(std::max(answers_.size(), boxes.size()));
    const std::span<BoxAnswer> answers = std::span(answers_).first(boxes.size());
    pyramid_->classify(asked_, answers, {.not_hidden = seen_, .seen_points = seen_points_});
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      if (boxes[i].seen_point != nullptr) {
        *boxes[i].seen_point = seen_points_[i];
      }
    }
    if (focus_) {
      focus_->classify(*pyramid_, asked_, answers);
    }
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      states[i] = answers[i].visibility;
    }
  }

  // A finer buffer may hide what the first one shows.
  void seesPoints(std::span<const Vec3f> points, std::span<std::uint8_t> seen) const override {
    if (focus_ && focus_->windows() > 0) {
      CullingMethod::seesPoints(points, seen);
    } else {
      pyramid_->seesPoints(points, seen);
    }
  }

  std::span<const OccluderId> occludersUsed() const override {
    return pyramid_->occluders().first(own_occluders_);
  }
  DepthBufferView depthBuffer() const override { return pyramid_->depthBuffer(); }
  std::span<const MethodStatistic> statistics() const override { return statistics_; }

 private:
  // Asks what the buffer does not hide: all(), and again() once more has been drawn.
  struct Asking {
    DepthPyramidMethod& method;
    const CullingFrame& frame;
    const culling::TraversalOptions& options;

    void all(CullStats& stats, std::vector<ObjectId>& visible) {
      method.traversal_->run(*method.pyramid_, options, stats, visible, *frame.parallel_for);
    }
    // Objects are tested one by one if that is less work than to ask for all anew.
    void again(const CullStats& before, CullStats& stats, std::vector<ObjectId>& visible) {
      method.work_ += method.pyramid_->surfaceStats().work;
      method.pyramid_->finish(*frame.parallel_for);
      if (options.test_objects && visible.size() <= stats.nodes_tested + stats.objects_tested) {
        method.traversal_->testAgain(*method.pyramid_, options, stats, visible, *frame.parallel_for);
      } else {
        stats = before;
        visible.clear();
        all(stats, visible);
      }
    }
  };

  void drawSurfaces(const CullingFrame& frame) {
    hidden_.clear();
    if (settings_.temporal_coherence && !frame.jumped && surfaces_.draws()) {
      traversal_->appendHidden(culling::HidingAims<ObjectId>::kMaxHiddenBoxes, turn_++, hidden_);
    }
    if (hidden_.empty()) {
      surfaces_.draw(*pyramid_, frame, settings_.temporal_coherence);
      return;
    }
    surfaces_.drawWhatHides(*pyramid_, hidden_, frame.last_visible);
  }

  DepthPyramidMethodSettings settings_;
  culling::SurfaceDrawer surfaces_;
  CullingScene scene_;
  std::optional<culling::WideTraversal> traversal_;
  std::optional<DepthPyramid> pyramid_;
  std::size_t own_occluders_ = 0;            // occluders in the pyramid that are of the scene's set
  std::optional<culling::FocusMaps> focus_;  // empty if the settings turn finer depth buffers off
  double work_ = 0.0;                        // of surfaces in the view's own buffer, as budgets count it
  std::vector<Box> hidden_;                  // what is to be hidden in this view, as it was in the last one
  std::size_t turn_ = 0;
  // Scratch for one classify() call: all boxes, the points at which they were last seen and whether they
  // still are, and their answers.
  std::vector<Box> asked_;
  std::vector<Vec3f> seen_points_;
  std::vector<std::uint8_t> seen_;
  std::vector<BoxAnswer> answers_;
  std::array<MethodStatistic, 5> statistics_{{{"map", "occluders_hidden", "occluders behind others"},
                                              {"map", "focused", "finer maps"},
                                              {"map", "focus_hidden", "objects that finer maps hide"},
                                              {"surfaces", "groups", "groups of surfaces drawn"},
                                              {"surfaces", "edges", "edges of their boundaries"}}};
};

}  // namespace

std::unique_ptr<CullingMethod> depthPyramid(const DepthPyramidMethodSettings& settings) {
  return std::make_unique<DepthPyramidMethod>(settings);
}

}  // namespace sightline
