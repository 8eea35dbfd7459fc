#include "src/pvs/bake/convex/samples.h"

#include <algorithm>
#include <bit>

#include "src/base/hash_slots.h"

namespace sightline::pvs {

std::size_t Sample::slotOf(std::uint32_t occluder) const {
  return base::probeSlots(slots_, base::mixBits(occluder), [&](const Slot& slot) {
    return slot.occluder == kFree || slot.occluder == occluder;
  });
}

std::optional<std::span<const ObjectRun>> Sample::find(std::uint32_t occluder) const {
  if (slots_.empty()) {
    return std::nullopt;
  }
  const Slot& slot = slots_[slotOf(occluder)];
  return slot.occluder == occluder ? std::optional(std::span(runs_).subspan(slot.first, slot.count))
                                   : std::nullopt;
}

void Sample::add(std::uint32_t occluder, std::span<const ObjectRun> runs) {
  if (4 * (used_ + 1) > 3 * slots_.size()) {
    grow();
  }
  slots_[slotOf(occluder)] = {occluder, static_cast<std::uint32_t>(runs_.size()),
                              static_cast<std::uint32_t>(runs.size())};
  runs_.insert(runs_.end(), runs.begin(), runs.end());
  ++used_;
}

void Sample::grow() {
  std::vector<Slot> old(slots_.empty() ? 16 : slots_.size() * 2);
  old.swap(slots_);
  for (const Slot& slot : old) {
    if (slot.occluder != kFree) {
      slots_[slotOf(slot.occluder)] = slot;
    }
  }
}

std::size_t SampleStore::KeyHash::operator()(const Key& k) const {
  return static_cast<std::size_t>(base::mixBits(k.x + base::mixBits(k.y + base::mixBits(k.z))));
}

SampleStore::Key SampleStore::keyOf(const Vec3d& eye) {
  // Adding 0.0 maps both zeros to one key.
  return {std::bit_cast<std::uint64_t>(eye.x + 0.0), std::bit_cast<std::uint64_t>(eye.y + 0.0),
          std::bit_cast<std::uint64_t>(eye.z + 0.0)};
}

Sample& SampleStore::at(const Vec3d& eye) {
  const auto [place, is_new] = places_.try_emplace(keyOf(eye));
  if (is_new) {
    samples_.emplace_front(eye);
    place->second = samples_.begin();
    bytes_ += samples_.front().bytes();
    stats_.samples += 1;
  } else {
    samples_.splice(samples_.begin(), samples_, place->second);
  }
  return samples_.front();
}

std::span<const ObjectRun> SampleStore::hidden(Sample& sample, std::uint32_t occluder) {
  if (const auto known = sample.find(occluder)) {
    return *known;
  }
  scratch_.clear();
  if (makeShadow(occluders_, occluders_[occluder], sample.eye(), reach_, shadow_)) {
    tree_.hiddenBy(shadow_, scratch_);
  }
  stats_.shadows += 1;
  const std::size_t before = sample.bytes();
  sample.add(occluder, scratch_);
  bytes_ += sample.bytes() - before;
  stats_.max_sample_bytes = std::max(stats_.max_sample_bytes, bytes_);
  return *sample.find(occluder);
}

// The intersection over the corners must be taken per occluder, and only then the union over all occluders:
// two occluders that hide an object from some corners each may leave it visible from a point in between.
bool SampleStore::hiddenFromAll(std::uint32_t occluder, std::span<Sample* const> corners, Runs& common) {
  const std::span<const ObjectRun> first = hidden(*corners[0], occluder);
  common.assign(first.begin(), first.end());
  for (std::size_t i = 1; i < corners.size() && !common.empty(); ++i) {
    intersect(common, hidden(*corners[i], occluder), both_);
    common.swap(both_);
  }
  return !common.empty();
}

void SampleStore::forgetOldest() {
  while (bytes_ > max_bytes_ && !samples_.empty()) {
    const Sample& oldest = samples_.back();
    bytes_ -= oldest.bytes();
    places_.erase(keyOf(oldest.eye()));
    samples_.pop_back();
    stats_.forgotten += 1;
  }
}

}  // namespace sightline::pvs
