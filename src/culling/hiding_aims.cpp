#include "src/culling/hiding_aims.h"

#include <algorithm>

namespace sightline::culling {

void HidingAims::beginView() {
  tried_.beginView();
  ++views_;
  boxes_.clear();
  aimed_at_.clear();
}

void HidingAims::aimAtHidden(std::span<const Box> boxes, std::span<const ObjectId> objects) {
  boxes_.assign(boxes.begin(), boxes.end());
  append(objects);
}

double HidingAims::aimAtShown(std::span<const ObjectId> shown, std::span<const ObjectId> news, double drawn) {
  aimed_at_.assign(news.begin(), news.end());
  if (!news.empty() || views_ % kViewsBetweenTries == 0) {
    for (const ObjectId object : shown) {
      if (!tried_.rests(object) && !std::binary_search(news.begin(), news.end(), object)) {
        aimed_at_.push_back(object);
      }
    }
  }
  const auto tries = static_cast<double>(aimed_at_.size() - news.size());
  owed_ += kWorkForNew * static_cast<double>(news.size()) + kWorkForTry * tries;
  if (aimed_at_.empty() || owed_ <= kLeastPart * drawn) {
    aimed_at_.clear();
    return 0.0;
  }
  boxes_.clear();
  append(aimed_at_);
  const double worth = std::min(owed_, std::max(kMostPart * drawn, kMostAtOnce));
  owed_ -= worth;
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
