#include "src/culling/hiding_aims.h"

#include <algorithm>

namespace sightline::culling {

void HidingAims::beginView(bool jumped) {
  tried_.beginView();
  // Little is drawn after a jump, so that the next view is one in which kept objects are aimed at.
  views_ = jumped ? kViewsBetweenTries - 1 : views_ + 1;
  saved_work_ = jumped ? 0.0 : saved_work_;
  boxes_.clear();
  aimed_at_.clear();
}

void HidingAims::aimAtHidden(std::span<const Box> boxes, std::span<const ObjectId> objects) {
  boxes_.assign(boxes.begin(), boxes.end());
  append(objects);
}

std::uint32_t HidingAims::aimAtShown(std::span<const ObjectId> shown, std::span<const ObjectId> news,
                                     double drawn, std::uint32_t left) {
  aimed_at_.reserve(shown.size());
  aimed_at_.assign(news.begin(), news.end());
  if (!news.empty() || views_ % kViewsBetweenTries == 0) {
    for (const ObjectId object : shown) {
      if (!tried_.rests(object) && !std::binary_search(news.begin(), news.end(), object)) {
        aimed_at_.push_back(object);
      }
    }
  }
  const auto tries = static_cast<double>(aimed_at_.size() - news.size());
  saved_work_ += kWorkForNew * static_cast<double>(news.size()) + kWorkForTry * tries;
  const double most = std::max(kMaxShare * drawn, kMinCap);
  const auto worth = static_cast<std::uint32_t>(std::min({saved_work_, most, static_cast<double>(left)}));
  if (aimed_at_.empty() || saved_work_ <= kMinShare * drawn || worth == 0) {
    aimed_at_.clear();
    return 0;
  }
  saved_work_ = std::min(saved_work_ - worth, most);
  boxes_.clear();
  boxes_.reserve(shown.size());
  append(aimed_at_);
  return worth;
}

void HidingAims::endView(std::span<const ObjectId> kept, std::span<const ObjectId> news) {
  for (const ObjectId object : news) {
    tried_.forget(object);
  }
  for (const ObjectId object : aimed_at_) {
    if (std::binary_search(kept.begin(), kept.end(), object)) {
      tried_.seen(object);
    }
  }
}

void HidingAims::append(std::span<const ObjectId> objects) {
  for (const ObjectId object : objects) {
    boxes_.push_back(bounds_[object.value]);
  }
}

}  // namespace sightline::culling
