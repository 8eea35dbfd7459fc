#pragma once

// Groups items by row on several threads. The items go to a few hundred buckets of neighbouring rows first,
// so that each bucket is then grouped alone, in the cache.

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "src/base/parts.h"
#include "src/base/rows.h"
#include "src/base/scratch_array.h"

namespace sightline::base {

// As groupIntoRows(): for_each_pair(begin, end, body) calls body(row, item) for every pair of the sources
// `begin` to `end`, of all of which there are `sources`.
template <typename Item, typename ForEachPair>
void groupIntoRows(const ParallelFor& parallel_for, std::size_t rows, std::size_t sources,
                   LargeVector<std::uint32_t>& first, LargeVector<Item>& items,
                   const ForEachPair& for_each_pair) {
  constexpr std::size_t kFewSources = 8192, kMostParts = 64, kMostBuckets = 256;
  if (sources <= kFewSources) {
    groupIntoRows(rows, first, items, [&](auto&& pair) { for_each_pair(0, sources, pair); });
    return;
  }
  const Parts parts(sources, std::max(kFewSources, (sources + kMostParts - 1) / kMostParts));
  const int shift = static_cast<int>(std::bit_width(rows / kMostBuckets));
  const std::size_t buckets = (rows >> shift) + 1;
  // By bucket and part: first a count, then where the next item goes.
  std::vector<std::uint32_t> next(buckets * parts.count() + 1, 0);
  parts.run(parallel_for, [&](std::size_t part, std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> counts(buckets, 0);
    for_each_pair(begin, end, [&](std::size_t row, const Item&) { ++counts[row >> shift]; });
    for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
      next[bucket * parts.count() + part] = counts[bucket];
    }
  });
  std::exclusive_scan(next.begin(), next.end(), next.begin(), 0u);

  struct Pair {
    std::uint32_t row;
    Item item;
  };
  ScratchArray<Pair> pairs(next.back());
  std::vector<std::uint32_t> bucket_begin(buckets + 1, next.back());
  for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
    bucket_begin[bucket] = next[bucket * parts.count()];
  }
  parts.run(parallel_for, [&](std::size_t part, std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> at(buckets);
    for (std::size_t bucket = 0; bucket < buckets; ++bucket) {
      at[bucket] = next[bucket * parts.count() + part];
    }
    for_each_pair(begin, end, [&](std::size_t row, const Item& item) {
      pairs[at[row >> shift]++] = {static_cast<std::uint32_t>(row), item};
    });
  });

  first = unsetVector<std::uint32_t>(rows + 1);
  items = unsetVector<Item>(pairs.size());
  forEach(parallel_for, buckets, [&](std::uint32_t bucket) {
    const std::size_t row = std::size_t{bucket} << shift;
    const std::size_t end_row = std::min(rows, (std::size_t{bucket} + 1) << shift);
    if (row >= end_row) {
      return;
    }
    const auto begin = first.begin() + static_cast<std::ptrdiff_t>(row);
    const auto end = first.begin() + static_cast<std::ptrdiff_t>(end_row);
    std::fill(begin, end, 0u);
    for (std::size_t i = bucket_begin[bucket]; i < bucket_begin[bucket + 1]; ++i) {
      ++first[pairs[i].row];
    }
    std::exclusive_scan(begin, end, begin, bucket_begin[bucket]);
    for (std::size_t i = bucket_begin[bucket]; i < bucket_begin[bucket + 1]; ++i) {
      items[first[pairs[i].row]++] = pairs[i].item;
    }
    std::copy_backward(begin, end - 1, end);
    *begin = bucket_begin[bucket];
  });
  first[rows] = static_cast<std::uint32_t>(pairs.size());
}

}  // namespace sightline::base
