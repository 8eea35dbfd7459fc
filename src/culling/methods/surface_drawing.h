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
#include "src/culling/doubt_memory.h"
#include "src/culling/last_view.h"
#include "src/culling/nearest_objects.h"
#include "src/culling/timed_budget.h"
#include "src/culling/usual_work.h"

namespace sightline::culling {

// Draws the surfaces of the objects that the last frame kept, all of them or those that hide something, and,
// where these do not hide much of what comes into view, of that; after a jump of those in the frustum, first
// of the nearest ones, then of what these do not hide.
class SurfaceDrawer {
 public:
  // budget_us: see DepthPyramidMethodSettings.
  SurfaceDrawer(SurfaceUse use, const SurfaceDrawing& drawing, double budget_us, const CoverageRule* coverage)
      : use_(coverage == nullptr ? use : SurfaceUse::kNone), drawing_(drawing), budget_us_(budget_us) {
    drawing_.targets = {};
    drawing_.useful_only = false;
  }

  void prepare(const CullingScene& scene) {
    surfaces_ = use_ != SurfaceUse::kNone ? scene.surfaces : nullptr;
    usual_work_ = {};
    work_ = 0.0;
    timed_ = TimedBudget(budget_us_);
    last_kept_.clear();
    news_.clear();
    bounds_ = scene.object_bounds;
    tried_ = DoubtMemory(surfaces_ != nullptr ? bounds_.size() : 0);
    views_ = 0;
    owed_ = 0.0;
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
    to_try_.clear();
    aims_ = false;
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
  // hidden: boxes that the buffer hid in that view, at most kMostHidden. First comes what hid most there.
  // What is left of the boxes after that, and objects that were kept and may be hidden by now, are then aimed
  // at with what else there is. remove_hidden(boxes) removes those that the buffer, as it is, hides.
  template <typename Buffer, typename RemoveHidden>
  void drawWhatHides(Buffer& buffer, const CullingFrame& frame, std::vector<Box>& hidden,
                     const RemoveHidden& remove_hidden) {
    aims_ = true;
    targets_ = hidden;
    listTries(frame.last_visible);  // before findNews() forgets what was new in the last view
    // What several boxes or a finer buffer hid, the box as a whole does not say.
    findNews(last_kept_, frame.last_visible);
    appendBounds(news_, targets_);
    SurfaceDrawing drawing = whatIsLeft(false);
    drawing.targets = targets_;
    drawing.useful_only = true;
    draw(buffer, {}, ViewStep::kNext, drawing);
    built_work_ = count(buffer);
    work_ += built_work_;
    remove_hidden(hidden);
    owed_ += kWorkForHidden * static_cast<double>(hidden.size()) +
             kWorkForTry * static_cast<double>(to_try_.size());
    appendBounds(to_try_, hidden);
    if (hidden.empty() || owed_ <= kLeastWorth * built_work_) {
      to_try_.clear();
      return;
    }
    aimAt(buffer, hidden, owed_, frame.last_visible, whatIsLeft(false));
    owed_ = 0.0;
    const double more = count(buffer);
    built_work_ += more;
    work_ += more;
  }
  static constexpr std::size_t kMostHidden = 128;

  // Fills `visible`, which is empty, with the objects that the buffer does not hide after draw(), by
  // ask(stats, visible), which adds to the one and appends to the other, ascending. Where that calls for more
  // surfaces to be drawn, draws them, calls finish() and asks once more; `stats` counts the last time alone,
  // and the buffer's own statistics count both.
  template <typename Buffer, typename Finish, typename Ask>
  void traverse(Buffer& buffer, CullStats& stats, std::vector<ObjectId>& visible, const Finish& finish,
                const Ask& ask) {
    CullStats found = stats;
    ask(found, visible);
    if (draws()) {
      if (drawFound(buffer, visible)) {
        finish();
        visible.clear();
        found = stats;
        ask(found, visible);
      }
      findNews(visible, last_kept_);
      last_kept_ = visible;
      learnTries();
    }
    stats = found;
  }
  // Whether many of the objects that the buffer shows are new in this frame.
  bool changesFast() const { return culling::changesFast(news_.size(), last_kept_.size()); }
  // The frame ends: stats has its times.
  void finish(const CullStats& stats) {
    usual_work_.frame(work_);
    timed_.frame(built_work_, stats.build_us, stats.totalUs() - stats.build_us);
  }

  // What counts in the budget of this frame.
  double work() const { return work_; }

  // Draws the surfaces of some of the objects in a view that follows no other, up to so much work. Where a
  // surface must have some number of pixels to be drawn, it must have pixel_factor times as many. Returns the
  // work.
  template <typename Buffer>
  double drawOf(Buffer& buffer, std::span<const ObjectId> objects, double pixel_factor, double budget) const {
    SurfaceDrawing drawing = upTo(budget);
    drawing.min_pixels *= pixel_factor;
    drawing.min_patch_pixels *= pixel_factor;
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
  // Where more than one of so many is new, what was of no use in earlier views says nothing of this one.
  static constexpr std::size_t kStill = 2;
  // Kept objects that may be hidden by now are aimed at in one of so many views.
  static constexpr std::uint32_t kViewsBetweenTries = 4;
  // So much is drawn for each box that was hidden in the last view or is new, and for each of these objects.
  static constexpr double kWorkForHidden = 100.0, kWorkForTry = 50.0;
  // They are not aimed at before all of that, added up over the views since it was done last, is more than
  // this part of what was drawn before.
  static constexpr double kLeastWorth = 1.5;

  // Sets news_ to those of some objects that are not among others; both ascending.
  void findNews(std::span<const ObjectId> objects, std::span<const ObjectId> others) {
    news_.clear();
    std::set_difference(objects.begin(), objects.end(), others.begin(), others.end(),
                        std::back_inserter(news_));
  }

  // Draws the surfaces of objects that the buffer shows, and for which draw() did not: after a jump those
  // that were too far away, else those that the last frame did not keep, if they are many. Returns whether it
  // drew.
  template <typename Buffer>
  bool drawFound(Buffer& buffer, std::span<const ObjectId> not_hidden) {
    if (jumped_) {
      if (!more_in_frustum_) {
        return false;
      }
      findNews(not_hidden, in_frustum_);
      draw(buffer, news_, ViewStep::kSame, whatIsLeft(true));
      work_ += count(buffer);
      return true;
    }
    findNews(not_hidden, last_kept_);
    if (!culling::changesFast(news_.size(), not_hidden.size())) {
      return false;
    }
    // What comes into view is not counted in the budget, but for one of time.
    SurfaceDrawing drawing = timed_.limits() ? whatIsLeft(false) : drawing_;
    drawing.draw_resting = news_.size() * kStill > not_hidden.size();
    if (aims_ && !drawing.draw_resting) {
      targets_.clear();
      appendBounds(news_, targets_);
      aimAt(buffer, targets_, kWorkForHidden * static_cast<double>(news_.size()), not_hidden, drawing);
      count(buffer);
      return true;
    }
    draw(buffer, news_, ViewStep::kSame, drawing);
    count(buffer);
    return true;
  }

  void appendBounds(std::span<const ObjectId> objects, std::vector<Box>& boxes) const {
    for (const ObjectId object : objects) {
      boxes.push_back(bounds_[object.value]);
    }
  }
  // Lists the kept objects that may be hidden by now: those that were new in the last view, and now and then
  // the others.
  void listTries(std::span<const ObjectId> kept) {
    tried_.beginView();
    for (const ObjectId object : news_) {
      tried_.forget(object);
    }
    ++views_;
    if (!news_.empty() || views_ % kViewsBetweenTries == 0) {
      for (const ObjectId object : kept) {
        if (!tried_.rests(object)) {
          to_try_.push_back(object);
        }
      }
    }
  }
  // Those that were aimed at and are still kept are left alone for a while.
  void learnTries() {
    for (const ObjectId object : to_try_) {
      if (std::binary_search(last_kept_.begin(), last_kept_.end(), object)) {
        tried_.seen(object);
      }
    }
  }
  // Draws surfaces of some objects before boxes that are to be hidden, as much as these are worth.
  template <typename Buffer>
  void aimAt(Buffer& buffer, std::span<const Box> boxes, double worth, std::span<const ObjectId> objects,
             SurfaceDrawing drawing) {
    drawing.targets = boxes;
    drawing.budget = static_cast<std::uint32_t>(std::min<double>(drawing.budget, worth));
    draw(buffer, objects, ViewStep::kSame, drawing);
  }

  // How surfaces are drawn with what is left of the frame's budget.
  SurfaceDrawing whatIsLeft(bool jumped) const {
    SurfaceDrawing drawing = usual_work_.limited(drawing_, jumped);
    const double budget = timed_.limits() ? std::min<double>(drawing.budget, timed_.work()) : drawing.budget;
    drawing.budget = static_cast<std::uint32_t>(std::max(budget - work_, 0.0));
    return drawing;
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
    SurfaceDrawing drawing = drawing_;
    drawing.budget = static_cast<std::uint32_t>(std::clamp<double>(budget, 0.0, drawing.budget));
    return drawing;
  }
  template <typename Buffer>
  void draw(Buffer& buffer, std::span<const ObjectId> objects, ViewStep step, SurfaceDrawing drawing) const {
    if (draws()) {
      drawing.step = step;
      buffer.draw(*surfaces_, objects, drawing, *parallel_for_);
    }
  }

  SurfaceUse use_;
  SurfaceDrawing drawing_;
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
  std::span<const Box> bounds_;  // of the scene's objects
  bool aims_ = false;            // only what hides something is drawn in this frame
  std::vector<Box> targets_;
  DoubtMemory tried_{0};          // kept objects that were aimed at
  std::vector<ObjectId> to_try_;  // those that are in this frame
  std::uint32_t views_ = 0;
  double owed_ = 0.0;  // work for what was not aimed at yet, see kLeastWorth
};

}  // namespace sightline::culling
