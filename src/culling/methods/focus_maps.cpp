#include "src/culling/methods/focus_maps.h"

#include <algorithm>
#include <cmath>

#include "src/scene/pixel_view.h"

namespace sightline::culling {
namespace {

constexpr std::uint32_t kMaxPixels = 24;  // in which an object that is in doubt may show
// New doubts are looked for after so many views, or after more of them where no window was worth drawing.
constexpr std::uint32_t kSearchViews = 4, kMaxSearchViews = 32;
// Work, as FocusBudget counts it.
constexpr double kOccluderWork = 10.0, kChoiceWork = 0.5, kTestWork = 0.5;

// The side of a window, pixels of the first buffer. fine: that of its own buffer, pixels.
std::uint32_t coarseSize(std::uint32_t fine, double magnification) {
  return static_cast<std::uint32_t>(
      std::clamp<double>(std::round(fine / magnification), 1.0, kMaxBufferSize));
}

// Makes room for what may be looked at in a view. How much really is differs from view to view, so the
// storage depends on the number of objects that are kept alone.
template <typename T>
void makeRoom(std::vector<T>& list, std::size_t size) {
  if (list.capacity() < size) {
    list.reserve(std::max(size, 2 * list.capacity()));
  }
}

bool intersect(const occlusion::PixelBox& image, const occlusion::PixelRange& range) {
  return image.x0 <= range.x1 && image.x1 >= range.x0 && image.y0 <= range.y1 && image.y1 >= range.y0;
}

}  // namespace

FocusMaps::FocusMaps(const FocusSettings& settings, const CullingScene& scene, std::uint32_t width,
                     std::uint32_t height, bool coherent)
    : settings_(settings),
      scene_(scene),
      width_(width),
      height_(height),
      coherent_(coherent),
      raster_({.width = settings.raster.width, .height = settings.raster.height}),
      choice_(width, height, coarseSize(raster_.settings().width, settings.magnification),
              coarseSize(raster_.settings().height, settings.magnification)),
      budget_(settings.worth),
      memory_(coherent ? scene.object_bounds.size() : 0),
      windows_(std::min(settings.windows, kMaxFocusWindows)) {
  for (FocusWindow& window : windows_) {
    window.take(raster_.depthBuffer());  // takes memory now rather than in some view
  }
}

void FocusMaps::begin() {
  memory_.beginView();
  window_count_ = 0;
  hidden_ = 0;
}

void FocusMaps::refine(const CulledView& view, std::vector<ObjectId>& visible) {
  const double occluders = view.buffer.stats().occluders,
               tests = view.traversal.nodes_tested + view.traversal.objects_tested;
  budget_.view(view.surface_work + kOccluderWork * occluders + kTestWork * tests,
               static_cast<double>(visible.size()));
  const bool searches = !coherent_ || view.frame.jumped || view.changes_fast || search_in_ == 0;
  makeRoom(asked_, visible.size());
  makeRoom(boxes_, visible.size());
  makeRoom(counts_, visible.size());
  makeRoom(doubts_, visible.size());
  makeRoom(images_, visible.size());
  makeRoom(shown_, visible.size());
  makeRoom(pixels_, visible.size() * kMaxPixels);
  makeRoom(ranges_, kMaxPixels);
  findDoubts(view.buffer, visible, searches);
  drawWindows(view.frame, view.surfaces, visible);
  removeHidden(visible);
  if (window_count_ == 0) {
    budget_.idle();
  }
  if (searches) {
    const bool found = window_count_ > 0 || view.frame.jumped;
    search_views_ = found ? kSearchViews : std::min(2 * search_views_, kMaxSearchViews);
    search_in_ = search_views_;
  }
  --search_in_;
}

void FocusMaps::findDoubts(const DepthPyramid& buffer, std::span<const ObjectId> visible, bool all) {
  asked_.clear();
  boxes_.clear();
  for (std::uint32_t at = 0; at < visible.size(); ++at) {
    if (memory_.wasHidden(visible[at]) || (all && !memory_.rests(visible[at]))) {
      asked_.push_back(at);
      boxes_.push_back(scene_.object_bounds[visible[at].value]);
    }
  }
  pixels_.clear();
  doubts_.clear();
  counts_.resize(boxes_.size());
  buffer.openPixels(boxes_, kMaxPixels, counts_, pixels_);
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    if (counts_[i] == kManyPixels) {
      memory_.showsClearly(visible[asked_[i]]);
      continue;
    }
    // What the first buffer hides is kept because it was not tested, and that is not in doubt.
    if (counts_[i] > 0) {
      doubts_.push_back({asked_[i], first, counts_[i]});
      first += counts_[i];
    }
  }
}

void FocusMaps::drawWindows(const CullingFrame& frame, const SurfaceDrawer& surfaces,
                            std::span<const ObjectId> visible) {
  choice_.begin();
  for (const Doubt& doubt : doubts_) {
    choice_.add(pixelsOf(doubt), memory_.chance(visible[doubt.at]));
  }
  while (window_count_ < windows_.size() && budget_.left() > 0.0) {
    occlusion::PixelRange range;
    const std::uint32_t weight = choice_.next(budget_.minObjects() * DoubtMemory::kCertain, range);
    if (weight == 0) {
      return;
    }
    FocusWindow& window = windows_[window_count_];
    const RasterSettings& fine = raster_.settings();
    if (!window.place(frame.view, width_, height_, range, fine.width, fine.height)) {
      continue;
    }
    if (window_count_ == 0) {
      projectAll(frame.view, visible);
    }
    const double objects = static_cast<double>(weight) / DoubtMemory::kCertain;
    budget_.drawn(draw(window, frame, surfaces, visible, budget_.left(objects)));
    ++window_count_;
  }
}

void FocusMaps::projectAll(const View& view, std::span<const ObjectId> visible) {
  boxes_.clear();
  for (const ObjectId object : visible) {
    boxes_.push_back(scene_.object_bounds[object.value]);
  }
  images_.resize(boxes_.size());
  occlusion::projectBoxes(scene::PixelView(view, width_, height_), width_, height_, boxes_, images_);
}

double FocusMaps::draw(FocusWindow& window, const CullingFrame& frame, const SurfaceDrawer& surfaces,
                       std::span<const ObjectId> visible, double budget) {
  shown_.clear();
  for (std::size_t i = 0; i < visible.size(); ++i) {
    const occlusion::PixelBox& image = images_[i];
    if (image.place == occlusion::BoxPlace::kUnbounded ||
        (image.place == occlusion::BoxPlace::kOnBuffer && intersect(image, window.range()))) {
      shown_.push_back(visible[i]);
    }
  }
  raster_.begin(window.view(), frame.viewers);
  double work = drawOccluders(window, frame, surfaces.wantsOccluders() && frame.max_occluders > 0);
  const double pixel_factor = std::sqrt(settings_.magnification);
  work += surfaces.drawOf(raster_, shown_, pixel_factor, budget - work);
  work += surfaces.drawMoving(raster_, frame, budget - work);
  window.take(raster_.depthBuffer());
  return work;
}

// Draws the chosen occluders, and with choose_more the best ones of the objects that may be in the window.
double FocusMaps::drawOccluders(const FocusWindow& window, const CullingFrame& frame, bool choose_more) {
  double work = 0.0;
  for (std::size_t i = 0; i < frame.occluders.size(); ++i) {
    chosen_.assign(frame.occluders[i].chosen.begin(), frame.occluders[i].chosen.end());
    if (i == 0 && choose_more && settings_.occluder_count > 0) {
      const ChoiceSettings choice{.count = settings_.occluder_count, .bodies = true};
      const auto more =
          chooser_.choose(window.view(), *scene_.occluders, shown_, scene_.object_bounds, choice);
      chosen_.insert(chosen_.end(), more.begin(), more.end());
      for (const ObjectId object : shown_) {
        work += kChoiceWork * static_cast<double>(scene_.occluders->occludersOf(object).size());
      }
    }
    raster_.draw(*frame.occluders[i].set, chosen_, *frame.parallel_for);
    work += kOccluderWork * static_cast<double>(chosen_.size());
  }
  return work;
}

FocusMaps::Sight FocusMaps::lookAt(const Box& box, std::span<BufferPixel> pixels) {
  for (const FocusWindow& window : windowsDrawn()) {
    const auto inside = std::partition(pixels.begin(), pixels.end(),
                                       [&](const BufferPixel& pixel) { return !window.contains(pixel); });
    const auto outside = static_cast<std::size_t>(inside - pixels.begin());
    if (outside < pixels.size() && !window.hides(box, pixels.subspan(outside), ranges_)) {
      return Sight::kSeen;
    }
    pixels = pixels.first(outside);
  }
  return pixels.empty() ? Sight::kHidden : Sight::kUnknown;
}

void FocusMaps::removeHidden(std::vector<ObjectId>& visible) {
  std::size_t kept = 0, next = 0;
  for (std::size_t at = 0; at < visible.size(); ++at) {
    const ObjectId object = visible[at];
    if (next < doubts_.size() && doubts_[next].at == at) {
      const Sight sight = lookAt(scene_.object_bounds[object.value], pixelsOf(doubts_[next++]));
      if (sight == Sight::kHidden) {
        memory_.hidden(object);
        ++hidden_;
        continue;
      }
      if (sight == Sight::kSeen) {
        memory_.seen(object);
      }
    }
    visible[kept++] = object;
  }
  visible.resize(kept);
}

void FocusMaps::classify(const DepthPyramid& buffer, std::span<const Box> boxes,
                         std::span<BoxAnswer> answers) {
  if (window_count_ == 0) {
    return;
  }
  const auto windows = windowsDrawn();
  asked_.clear();
  boxes_.clear();
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    const BufferPixel middle{answers[i].x, answers[i].y};
    const bool in_window = answers[i].on_buffer &&
                           std::any_of(windows.begin(), windows.end(),
                                       [&](const FocusWindow& window) { return window.contains(middle); });
    if (in_window && answers[i].visibility != Visibility::kHidden) {
      asked_.push_back(i);
      boxes_.push_back(boxes[i]);
    }
  }
  pixels_.clear();
  counts_.resize(boxes_.size());
  buffer.openPixels(boxes_, kMaxPixels, counts_, pixels_);
  std::uint32_t first = 0;
  for (std::size_t i = 0; i < asked_.size(); ++i) {
    if (counts_[i] == kManyPixels) {
      continue;
    }
    if (lookAt(boxes_[i], std::span(pixels_).subspan(first, counts_[i])) == Sight::kHidden) {
      answers[asked_[i]].visibility = Visibility::kHidden;
    }
    first += counts_[i];
  }
}

}  // namespace sightline::culling
