#pragma once

// What all methods that draw whole surfaces have in common.

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "sightline/culling/culling_method.h"
#include "src/culling/hiding_aims.h"
#include "src/culling/last_view.h"
#include "src/culling/nearest_objects.h"
#include "src/culling/timed_budget.h"
#include "src/culling/usual_work.h"

namespace sightline::culling {

// Draws the surfaces of the objects that the last frame kept, all of them or those that hid something, and
// where much comes into view, or may be hidden by now, what else may hide that; after a jump the surfaces of
// the nearest objects in the frustum, and then of those that these do not hide.
class SurfaceDrawer {
 public:
  // budget_us: see DepthPyramidMethodSettings.
  SurfaceDrawer(SurfaceUse use, const SurfaceLimits& limits, double budget_us, const CoverageRule* coverage)
      : use_(coverage == nullptr ? use : SurfaceUse::kNone), limits_(limits), budget_us_(budget_us) {}

  void prepare(const CullingScene& scene) {
    surfaces_ = use_ != SurfaceUse::kNone ? scene.surfaces : nullptr;
    usual_work_ = {};
    work_ = 0.0;
    timed_ = TimedBudget(budget_us_);
    last_kept_.clear();
    news_.clear();
    bounds_ = scene.object_bounds;
    aims_ = HidingAims<ObjectId>(surfaces_ != nullptr ? bounds_.size() : 0);
    nearest_.reset();
    if (surfaces_ != nullptr) {
      nearest_.emplace(*scene.hierarchy, scene.object_bounds);
    }
  }

  // The same for a buffer into which they will be drawn.
  template <typename Buffer>
  void prepareBuffer(Buffer& buffer) const {
    if (draws()) {
      buffer.reserve(*surfaces_);
    }
  }

  // Whether those of the scene are drawn.
  bool draws() const { return surfaces_ != nullptr; }
  bool wantsOccluders() const { return !draws() || use_ == SurfaceUse::kWithOccluders; }

  // Call this once a frame, before draw().
  void begin(const CullingFrame& frame) {
    parallel_for_ = frame.parallel_for;
    work_ = built_work_ = 0.0;
    groups_ = edges_ = 0;
    in_frustum_.clear();
    aims_.beginView(frame.jumped);
    jumped_ = frame.jumped;
    more_in_frustum_ = draws() && frame.jumped &&
                       !nearest_->find(frame.frustum, frame.view.eye, frame.filter, kNearest, in_frustum_);
  }
  // follows: the view follows the last one for which this buffer was drawn.
  template <typename Buffer>
  void draw(Buffer& buffer, const CullingFrame& frame, bool follows) {
    draw(buffer, frame.jumped ? std::span<const ObjectId>(in_frustum_) : frame.last_visible,
         follows && !frame.jumped ? ViewStep::kNext : ViewStep::kJump, whatIsLeft(frame.jumped));
    built_work_ = count(buffer);
    work_ += built_work_;
  }
  // Draws only what hides something, in a view that follows the last one for which this buffer was drawn.
  // hidden: boxes that the buffer hid in that view, at most HidingAims<ObjectId>::kMaxHiddenBoxes. First
  // comes what hid most there.
  template <typename Buffer>
  void drawWhatHides(Buffer& buffer, std::span<const Box> hidden, std::span<const ObjectId> last_visible) {
    // What several boxes or a finer buffer hid, the box as a whole does not say.
    findNews(last_kept_, last_visible);
    aims_.aimAtHidden(hidden, news_, [this](ObjectId object) { return boundsOf(object); });
    SurfaceDrawing drawing = whatIsLeft(false);
    drawing.targets = aims_.boxes();
    drawing.useful_only = true;
    draw(buffer, {}, ViewStep::kNext, drawing);
    built_work_ = count(buffer);
    work_ += built_work_;
  }

  // Fills `visible`, which is empty, with the objects that the buffer does not hide after draw(), by
  // asking.all(stats, visible), which adds to the one and appends to the other, ascending. Where that calls
  // for more surfaces to be drawn, draws them and removes what these hide, by asking.again(before, stats,
  // visible), where before is what the counts were at first: those of two whole traversals are not added up.
  template <typename Buffer, typename Asking>
  void traverse(Buffer& buffer, CullStats& stats, std::vector<ObjectId>& visible, Asking&& asking) {
    const CullStats before = stats;
    asking.all(stats, visible);
    if (draws()) {
      if (drawFound(buffer, visible)) {
        asking.again(before, stats, visible);
      }
      findNews(visible, last_kept_);
      last_kept_ = visible;
      aims_.endView(last_kept_, news_);
    }
  }
  // Whether many of the objects that the buffer shows are new in this frame.
  bool changesFast() const { return culling::changesFast(news_.size(), last_kept_.size()); }
  // The frame ends: stats has its times.
  void finish(const CullStats& stats) {
    usual_work_.frame(work_);
    timed_.frame(built_work_, stats.build_us, work_ - built_work_, stats.totalUs() - stats.build_us);
  }

  // What counts in the budget of this frame.
  double work() const { return work_; }

  // Draws the surfaces of some of the objects in a view that follows no other, up to so much work. Where a
  // surface must have some number of pixels to be drawn, it must have pixel_factor times as many. Returns the
  // work.
  template <typename Buffer>
  double drawOf(Buffer& buffer, std::span<const ObjectId> objects, double pixel_factor, double budget) const {
    SurfaceDrawing drawing = upTo(budget);
    drawing.limits.min_pixels *= pixel_factor;
    drawing.limits.min_patch_pixels *= pixel_factor;
    draw(buffer, objects, ViewStep::kJump, drawing);
    return draws() ? buffer.surfaceStats().work : 0.0;
  }
  // Draws the surfaces that move, up to so much work in all. Returns the work.
  template <typename Buffer>
  double drawMoving(Buffer& buffer, const CullingFrame& frame,
                    double budget = std::numeric_limits<double>::infinity()) const {
    double work = 0.0;
    for (std::size_t i = 0; drawsMoving(frame) && i < frame.moving_surfaces.size() && work < budget; ++i) {
      work += buffer.draw(frame.moving_surfaces[i], upTo(budget - work), *parallel_for_).work;
    }
    return work;
  }
  bool drawsMoving(const CullingFrame& frame) const {
    return use_ != SurfaceUse::kNone && !frame.moving_surfaces.empty();
  }
  // What the functions above drew of the scene's surfaces in this frame: groups, and edges of boundaries.
  std::uint64_t groups() const { return groups_; }
  std::uint64_t edges() const { return edges_; }

 private:
  // So many objects are looked at after a jump before anything is hidden.
  static constexpr std::size_t kNearest = 512;

  const Box& boundsOf(ObjectId object) const { return bounds_[object.value]; }
  // Sets news_ to those of some objects that are not among others; both ascending.
  void findNews(std::span<const ObjectId> objects, std::span<const ObjectId> others) {
    news_.clear();
    std::set_difference(objects.begin(), objects.end(), others.begin(), others.end(),
                        std::back_inserter(news_));
  }

  // Draws surfaces that draw() did not, once it is known what the buffer shows: after a jump those of objects
  // that were too far away; else what may hide some of these objects, or where nothing is known of that, the
  // surfaces of those that the last frame did not keep, if they are many. Returns whether it drew.
  template <typename Buffer>
  bool drawFound(Buffer& buffer, std::span<const ObjectId> shown) {
    if (jumped_) {
      if (!more_in_frustum_) {
        return false;
      }
      findNews(shown, in_frustum_);
      draw(buffer, news_, ViewStep::kSame, whatIsLeft(true));
      work_ += count(buffer);
      return buffer.surfaceStats().groups > 0;
    }
    findNews(shown, last_kept_);
    const bool most_is_new = culling::mostIsNew(news_.size(), shown.size());
    if (!aims_.boxes().empty()) {
      SurfaceDrawing drawing = whatIsLeft(false);
      drawing.draw_resting = most_is_new;
      drawing.limits.budget = aims_.aimAtShown(shown, news_, built_work_, drawing.limits.budget,
                                               [this](ObjectId object) { return boundsOf(object); });
      if (drawing.limits.budget == 0) {
        return false;
      }
      drawing.targets = aims_.boxes();
      draw(buffer, shown, ViewStep::kSame, drawing);
      work_ += count(buffer);
      return buffer.surfaceStats().groups > 0;
    }
    if (!culling::changesFast(news_.size(), shown.size())) {
      return false;
    }
    // What comes into view is not counted in the budget, but for one of time.
    SurfaceDrawing drawing = timed_.limits() ? whatIsLeft(false) : SurfaceDrawing{.limits = limits_};
    drawing.draw_resting = most_is_new;
    draw(buffer, news_, ViewStep::kSame, drawing);
    const double drawn = count(buffer);
    work_ += timed_.limits() ? drawn : 0.0;
    return buffer.surfaceStats().groups > 0;
  }

  // How surfaces are drawn with what is left of the frame's budget.
  SurfaceDrawing whatIsLeft(bool jumped) const {
    SurfaceLimits limits = usual_work_.limited(limits_, jumped);
    const double budget = timed_.limits() ? std::min<double>(limits.budget, timed_.work()) : limits.budget;
    limits.budget = static_cast<std::uint32_t>(std::max(budget - work_, 0.0));
    return {.limits = limits};
  }
  // Counts what was drawn last, and returns its work.
  template <typename Buffer>
  double count(const Buffer& buffer) {
    if (!draws()) {
      return 0.0;
    }
    groups_ += buffer.surfaceStats().groups;
    edges_ += buffer.surfaceStats().edges;
    return buffer.surfaceStats().work;
  }
  SurfaceDrawing upTo(double budget) const {
    SurfaceLimits limits = limits_;
    limits.budget = static_cast<std::uint32_t>(std::clamp<double>(budget, 0.0, limits.budget));
    return {.limits = limits};
  }
  template <typename Buffer>
  void draw(Buffer& buffer, std::span<const ObjectId> objects, ViewStep step, SurfaceDrawing drawing) const {
    if (draws()) {
      drawing.step = step;
      buffer.draw(*surfaces_, objects, drawing, *parallel_for_);
    }
  }

  SurfaceUse use_;
  SurfaceLimits limits_;
  double budget_us_;
  TimedBudget timed_{0.0};
  // These are the frame's, as SurfaceStats::work: what counts in the budget, and what of it was drawn before
  // the traversal.
  double work_ = 0.0, built_work_ = 0.0;
  std::uint64_t groups_ = 0, edges_ = 0;
  UsualWork usual_work_;
  const SurfaceSet* surfaces_ = nullptr;
  const ParallelFor* parallel_for_ = nullptr;  // of the frame
  std::optional<NearestObjects> nearest_;
  bool jumped_ = false;               // whether the view of this frame has little to do with the last one
  std::vector<ObjectId> in_frustum_;  // objects whose surfaces are drawn first after a jump
  bool more_in_frustum_ = false;      // whether there are others in the frustum
  std::vector<ObjectId> last_kept_, news_;
  std::span<const Box> bounds_;  // of all objects
  HidingAims<ObjectId> aims_;    // while it has no boxes, surfaces are drawn whatever they hide
};

}  // namespace sightline::culling
