#include "src/layers/pairs/pair_table.h"

namespace sightline::layers {

void PairTable::beginFrame(std::uint32_t expiry) {
  ++frame_;
  keep_.resize(index_.size());
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keep_.size(); ++i) {
    keep_[i] = frame_ - last_used_[i] <= expiry ? 1 : 0;
    if (keep_[i] != 0) {
      if (kept != i) {
        witnesses_[kept] = witnesses_[i];
        last_used_[kept] = last_used_[i];
      }
      ++kept;
    }
  }
  witnesses_.resize(kept);
  last_used_.resize(kept);
  index_.keepOnly(keep_);
}

namespace {

PairKey keyOf(std::uint32_t a, std::uint32_t b, PairTable::Question question) {
  const bool swapped = question == PairTable::Question::kIntersection && a > b;
  return {swapped ? b : a, swapped ? a : b, static_cast<std::uint32_t>(question)};
}

}  // namespace

PairTable::Kept PairTable::find(std::uint32_t a, std::uint32_t b, Question question) const {
  const std::uint32_t entry = index_.find(keyOf(a, b, question));
  return entry == PairIndex::kNone ? Kept{} : Kept{&witnesses_[entry], last_used_[entry] == frame_};
}

PairTable::Used PairTable::use(std::uint32_t a, std::uint32_t b, Question question) {
  const PairKey key = keyOf(a, b, question);
  std::uint32_t entry = index_.find(key);
  const bool known = entry != PairIndex::kNone;
  const bool again = known && last_used_[entry] == frame_;
  if (!known) {
    entry = static_cast<std::uint32_t>(index_.size());
    index_.add(key);
    witnesses_.emplace_back();
    last_used_.push_back(frame_);
  }
  last_used_[entry] = frame_;
  return {witnesses_[entry], again};
}

}  // namespace sightline::layers
