// Keys go to buckets by their highest bits that differ, in one pass, and each bucket is sorted alone, in the
// cache. Keys that all but fill one bucket take as long as with a common sort.

#include "src/base/sort_keys.h"

#include <algorithm>
#include <bit>
#include <numeric>

#include "src/base/parts.h"

namespace sightline::base {
namespace {

constexpr std::size_t kFew = 64;            // are sorted at once
constexpr std::size_t kKeysOfBucket = 8;    // on average, unless there are many
constexpr std::size_t kMaxBuckets = 4096;   // more of them would miss the cache as they are filled
constexpr std::size_t kBucketsOfPart = 64;  // sorted by one thread

}  // namespace

void KeySorter::sort(LargeVector<SortKey>& keys, const ParallelFor& parallel_for) {
  if (keys.size() <= kFew) {
    std::sort(keys.begin(), keys.end());
    return;
  }
  std::uint64_t low = keys[0].first, high = low;
  for (const SortKey& key : keys) {
    low = std::min(low, key.first);
    high = std::max(high, key.first);
  }
  const std::size_t most = std::min(kMaxBuckets, std::bit_floor(keys.size() / kKeysOfBucket));
  const auto width = static_cast<int>(std::bit_width(high - low));
  const int shift = std::max(0, width - static_cast<int>(std::bit_width(most)) + 1);
  bucket_ends_.assign(((high - low) >> shift) + 1, 0);
  for (const SortKey& key : keys) {
    ++bucket_ends_[(key.first - low) >> shift];
  }
  std::exclusive_scan(bucket_ends_.begin(), bucket_ends_.end(), bucket_ends_.begin(), 0u);
  sorted_.resize(keys.size());
  for (const SortKey& key : keys) {
    sorted_[bucket_ends_[(key.first - low) >> shift]++] = key;
  }
  Parts(bucket_ends_.size(), kBucketsOfPart)
      .run(parallel_for, [&](std::size_t, std::size_t begin, std::size_t end) {
        for (std::size_t bucket = begin; bucket < end; ++bucket) {
          const std::size_t first = bucket == 0 ? 0 : bucket_ends_[bucket - 1];
          std::sort(sorted_.begin() + static_cast<std::ptrdiff_t>(first),
                    sorted_.begin() + bucket_ends_[bucket]);
        }
      });
  keys.swap(sorted_);
}

}  // namespace sightline::base
