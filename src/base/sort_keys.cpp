// Keys go to buckets by their highest bits that differ, so that few are left in each; large buckets are
// divided again in the same way, small ones are sorted by insertion.

#include "src/base/sort_keys.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>

#include "src/base/parts.h"

namespace sightline::base {
namespace {

constexpr std::size_t kFew = 24;            // are sorted by insertion
constexpr std::size_t kKeysOfBucket = 2;    // on average, unless there are many
constexpr std::size_t kMaxBuckets = 4096;   // more of them would miss the cache as they are filled
constexpr std::size_t kBucketsOfPart = 64;  // sorted by one thread

void sortFew(std::span<SortKey> keys) {
  for (std::size_t i = 1; i < keys.size(); ++i) {
    const SortKey key = keys[i];
    std::size_t at = i;
    for (; at > 0 && key < keys[at - 1]; --at) {
      keys[at] = keys[at - 1];
    }
    keys[at] = key;
  }
}

// Writes keys to `sorted` bucket by bucket, and sets where each bucket ends. False if all keys have the same
// first number: then nothing is written.
bool distribute(std::span<const SortKey> keys, std::span<SortKey> sorted, std::vector<std::uint32_t>& ends) {
  std::uint64_t low = keys[0].first, high = low;
  for (const SortKey& key : keys) {
    low = std::min(low, key.first);
    high = std::max(high, key.first);
  }
  if (low == high) {
    return false;
  }
  const std::size_t most = std::min(kMaxBuckets, std::bit_floor(keys.size() / kKeysOfBucket));
  const auto width = static_cast<int>(std::bit_width(high - low));
  const int shift = std::max(0, width - static_cast<int>(std::bit_width(most)) + 1);
  ends.assign(((high - low) >> shift) + 1, 0);
  for (const SortKey& key : keys) {
    ++ends[(key.first - low) >> shift];
  }
  std::exclusive_scan(ends.begin(), ends.end(), ends.begin(), 0u);
  for (const SortKey& key : keys) {
    sorted[ends[(key.first - low) >> shift]++] = key;
  }
  return true;
}

// spare: as many keys, whose values do not matter.
void sortSpan(std::span<SortKey> keys, std::span<SortKey> spare) {
  if (keys.size() <= kFew) {
    sortFew(keys);
    return;
  }
  std::vector<std::uint32_t> ends;
  if (!distribute(keys, spare, ends)) {
    std::sort(keys.begin(), keys.end());
    return;
  }
  std::copy(spare.begin(), spare.end(), keys.begin());
  for (std::size_t bucket = 0, first = 0; bucket < ends.size(); first = ends[bucket++]) {
    const std::size_t count = ends[bucket] - first;
    sortSpan(keys.subspan(first, count), spare.subspan(first, count));
  }
}

}  // namespace

void KeySorter::sort(LargeVector<SortKey>& keys, const ParallelFor& parallel_for) {
  if (keys.size() <= kFew) {
    sortFew(keys);
    return;
  }
  sorted_.resize(keys.size());
  if (!distribute(keys, sorted_, bucket_ends_)) {
    std::sort(keys.begin(), keys.end());
    return;
  }
  Parts(bucket_ends_.size(), kBucketsOfPart)
      .run(parallel_for, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t bucket = begin; bucket < end; ++bucket) {
          const std::size_t first = bucket == 0 ? 0 : bucket_ends_[bucket - 1];
          const std::size_t count = bucket_ends_[bucket] - first;
          sortSpan(std::span(sorted_).subspan(first, count), std::span(keys).subspan(first, count));
        }
      });
  keys.swap(sorted_);
}

}  // namespace sightline::base
