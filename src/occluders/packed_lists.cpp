#include "occluders/packed_lists.h"

#include <algorithm>
#include <utility>

namespace sightline::occluder_detail {
namespace {

std::uint64_t hashOf(std::span<const OccluderId> list) {  // FNV-1a
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const OccluderId id : list) {
    hash = (hash ^ id.value) * 0x100000001b3ull;
  }
  return hash;
}

}  // namespace

std::size_t PackedLists::bytes() const {
  return lists_.capacity() * sizeof(List) + ids_.capacity() * sizeof(OccluderId);
}

ListPacker::ListPacker(std::size_t lists, std::size_t entries) {
  packed_.lists_.reserve(lists);
  packed_.ids_.reserve(entries);
}

void ListPacker::add(std::span<const OccluderId> list) {
  const auto [found, is_new] = first_of_hash_.try_emplace(hashOf(list), packed_.size());
  if (!is_new && std::ranges::equal(list, packed_[found->second])) {
    packed_.lists_.push_back(packed_.lists_[found->second]);
    return;
  }
  packed_.lists_.push_back({packed_.ids_.size(), static_cast<std::uint32_t>(list.size())});
  packed_.ids_.insert(packed_.ids_.end(), list.begin(), list.end());
}

PackedLists ListPacker::finish() {
  first_of_hash_.clear();
  packed_.lists_.shrink_to_fit();
  packed_.ids_.shrink_to_fit();
  return std::exchange(packed_, {});
}

}  // namespace sightline::occluder_detail
