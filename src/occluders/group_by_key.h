#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <vector>

namespace sightline::occluders {

// From pairs to lists: values of key k are at [first[k], first[k + 1]), in the order of the pairs.
// for_each_pair(body) calls body(key, value) for all pairs, each time it is called the same ones. key < keys.
template <typename ForEachPair>
void groupByKey(std::uint32_t keys, std::vector<std::uint32_t>& values, std::vector<std::uint32_t>& first,
                ForEachPair&& for_each_pair) {
  first.assign(keys + 1, 0);
  for_each_pair([&](std::uint32_t key, std::uint32_t) { ++first[key + 1]; });
  std::partial_sum(first.begin(), first.end(), first.begin());
  values.resize(first.back());
  // While it fills, first[k] is where the next value of k goes; afterwards that is the beginning of k + 1.
  for_each_pair([&](std::uint32_t key, std::uint32_t value) { values[first[key]++] = value; });
  std::copy_backward(first.begin(), first.end() - 1, first.end());
  first[0] = 0;
}

}  // namespace sightline::occluders
