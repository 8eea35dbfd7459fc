#include "sightline/culling/depth_pyramid_method.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <optional>

#include "sightline/occluders/choose_occluders.h"
#include "src/culling/focus_window.h"
#include "src/culling/methods/draw_occluders.h"
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

  void prepare(const CullingScene& scene) override {
    scene_ = scene;
    traversal_.emplace(*scene.hierarchy, scene.object_bounds);
    surfaces_.prepare(scene);
    pyramid_.emplace(DepthPyramidSettings{settings_.raster});
    own_occluders_ = 0;
    focused_ = false;
    last_kept_.clear();
    news_.clear();
    if (settings_.focus.magnification > 1.0 && drawsBodies()) {
      const DepthBufferView buffer = pyramid_->depthBuffer();
      window_.emplace(settings_.focus, buffer.width, buffer.height);
      RasterSettings fine = settings_.focus.raster;
      fine.coverage = settings_.raster.coverage;
      fine_pyramid_.emplace(DepthPyramidSettings{fine});
    }
  }

  void build(const CullingFrame& frame) override {
    if (frame.filter_changed) {
      traversal_->restrictTo(frame.filter != nullptr ? frame.filter->objects() : culling::ObjectSet{});
    }
    if (frame.jumped) {
      traversal_->forget();
    }
    own_occluders_ = culling::drawOccluders(*pyramid_, frame.view, frame.occluders, *frame.parallel_for);
    surfaces_.begin(frame);
    surfaces_.draw(*pyramid_, frame, settings_.temporal_coherence);
    groups_ = edges_ = 0;
    countSurfaces();
    surfaces_.drawMoving(*pyramid_, frame);
    pyramid_->finish(*frame.parallel_for);
    focused_ = false;
    if (window_) {
      window_->begin(frame.view, !frame.jumped && frame.max_occluders > 0);
      focused_ = window_->found();
      if (focused_) {
        drawFocus(frame);
      }
    }
  }

  void traverse(const CullingFrame& frame, CullStats& stats, std::vector<ObjectId>& visible) override {
    if (surfaces_.draws() && !frame.jumped && news_.size() * kCalm > last_kept_.size()) {
      drawNews(frame);
    }
    // With surfaces most time goes into drawing, and testing everything costs little.
    const bool skips = settings_.temporal_coherence && !surfaces_.draws() && !surfaces_.drawsMoving(frame);
    traversal_->run(buffers(), culling::optionsOf(frame, skips), stats, visible, *frame.parallel_for);
    if (surfaces_.draws()) {
      findNews(visible);
      last_kept_ = visible;
    }
  }

  void finish(CullStats& stats) override {
    surfaces_.finish(stats);
    const RasterStats& raster = pyramid_->stats().raster;
    stats.occluders = raster.occluders;
    statistics_[0].value = raster.hidden;
    statistics_[1].value = focused_ ? 1 : 0;
    statistics_[2].value = groups_;
    statistics_[3].value = edges_;
  }

  void classify(std::span<const MovingBox> boxes, std::span<Visibility> states) override {
    asked_.clear();
    for (const MovingBox& box : boxes) {
      asked_.push_back(box.box);
    }
    answers_.resize(std::max(answers_.size(), boxes.size()));
    const std::span<BoxAnswer> answers = std::span(answers_).first(boxes.size());
    pyramid_->classify(asked_, answers);
    fine_boxes_.clear();
    in_doubt_.clear();
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      states[i] = answers[i].visibility;
      if (focused_ && states[i] != Visibility::kHidden && answers[i].on_buffer &&
          window_->mayContain(answers[i].x, answers[i].y)) {
        fine_boxes_.push_back(boxes[i].box);
        in_doubt_.push_back(i);
      }
    }
    if (fine_boxes_.empty()) {
      return;
    }
    fine_pyramid_->classify(fine_boxes_, answers.first(fine_boxes_.size()), {.plain_from = 0});
    for (std::size_t i = 0; i < in_doubt_.size(); ++i) {
      if (answers[i].within_view && answers[i].visibility == Visibility::kHidden) {
        states[in_doubt_[i]] = Visibility::kHidden;
      }
    }
  }

  std::span<const OccluderId> occludersUsed() const override {
    return pyramid_->occluders().first(own_occluders_);
  }
  DepthBufferView depthBuffer() const override { return pyramid_->depthBuffer(); }
  std::span<const MethodStatistic> statistics() const override { return statistics_; }

 private:
  // Draws the finer depth buffer: the chosen occluders in the window, and the best ones of the objects in the
  // window that the last frame kept.
  void drawFocus(const CullingFrame& frame) {
    in_window_.clear();
    for (const ObjectId object : frame.last_visible) {
      if (window_->mayShow(scene_.object_bounds[object.value])) {
        in_window_.push_back(object);
      }
    }
    fine_chosen_.clear();
    for (const OccluderId id : frame.occluders[0].chosen) {
      const OccluderBody* body = scene_.occluders->bodyOf(id);
      if (body == nullptr || window_->mayShow(body->bounds)) {
        fine_chosen_.push_back(id);
      }
    }
    if (wantsOccluders()) {
      const ChoiceSettings choice{.count = settings_.focus.occluder_count, .bodies = true};
      const auto more =
          chooser_.choose(window_->view(), *scene_.occluders, in_window_, scene_.object_bounds, choice);
      fine_chosen_.insert(fine_chosen_.end(), more.begin(), more.end());
    }
    std::array<ChosenOccluders, 2> sets{{{scene_.occluders, fine_chosen_}, {}}};
    const bool moving = frame.occluders.size() > 1;
    if (moving) {
      sets[1] = frame.occluders[1];
    }
    culling::drawOccluders(*fine_pyramid_, window_->view(), std::span(sets).first(moving ? 2 : 1),
                           *frame.parallel_for);
    surfaces_.drawOf(*fine_pyramid_, in_window_);
    surfaces_.drawMoving(*fine_pyramid_, frame);
    fine_pyramid_->finish(*frame.parallel_for);
  }

  culling::TraversalBuffers buffers() {
    return {*pyramid_, window_ ? &*window_ : nullptr, focused_ ? &*fine_pyramid_ : nullptr};
  }

  // Sets news_ to the objects that the last frame did not keep.
  void findNews(std::span<const ObjectId> kept) {
    news_.clear();
    std::set_difference(kept.begin(), kept.end(), last_kept_.begin(), last_kept_.end(),
                        std::back_inserter(news_));
  }

  // Draws the surfaces of objects that come into view in this frame.
  void drawNews(const CullingFrame& frame) {
    found_.clear();
    CullStats ignored;
    traversal_->run({*pyramid_}, culling::optionsOf(frame, false), ignored, found_, *frame.parallel_for);
    findNews(found_);
    surfaces_.drawMore(*pyramid_, news_);
    countSurfaces();
    pyramid_->finish(*frame.parallel_for);
  }

  // Adds what the last draw() of surfaces drew to the frame's counts.
  void countSurfaces() {
    if (surfaces_.draws()) {
      groups_ += pyramid_->surfaceStats().groups;
      edges_ += pyramid_->surfaceStats().edges;
    }
  }

  // Where more than one of so many objects that were kept is new, the view changes fast, and the surfaces of
  // what the last frame kept are not enough.
  static constexpr std::size_t kCalm = 16;

  DepthPyramidMethodSettings settings_;
  culling::SurfaceDrawer surfaces_;
  std::vector<ObjectId> last_kept_, news_, found_;
  CullingScene scene_;
  std::optional<culling::WideTraversal> traversal_;
  std::optional<DepthPyramid> pyramid_;
  std::size_t own_occluders_ = 0;  // occluders in the pyramid that are of the scene's set
  // The focus window and its finer depth buffer; empty if the settings turn them off.
  std::optional<culling::FocusWindow> window_;
  std::optional<DepthPyramid> fine_pyramid_;
  bool focused_ = false;                  // this frame has a window
  std::uint64_t groups_ = 0, edges_ = 0;  // of the surfaces in the pyramid
  // Scratch for one classify() call: all boxes, those that are tested against the finer depth buffer too,
  // their numbers among all, and answers.
  std::vector<Box> asked_, fine_boxes_;
  std::vector<BoxAnswer> answers_;
  std::vector<std::size_t> in_doubt_;
  OccluderChooser chooser_;
  std::vector<ObjectId> in_window_;
  std::vector<OccluderId> fine_chosen_;
  std::array<MethodStatistic, 4> statistics_{{{"map", "occluders_hidden", "occluders behind others"},
                                              {"map", "focused", "frames with a finer map"},
                                              {"surfaces", "groups", "groups of surfaces drawn"},
                                              {"surfaces", "edges", "edges of their boundaries"}}};
};

}  // namespace

std::unique_ptr<CullingMethod> depthPyramid(const DepthPyramidMethodSettings& settings) {
  return std::make_unique<DepthPyramidMethod>(settings);
}

}  // namespace sightline
