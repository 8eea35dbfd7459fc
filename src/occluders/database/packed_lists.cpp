#include "src/occluders/database/packed_lists.h"

#include <algorithm>
#include <string>
#include <utility>

namespace sightline::occluders {
namespace {

std::uint64_t hashOf(std::span<const OccluderId> list) {  // FNV-1a
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const OccluderId id : list) {
    hash = (hash ^ id.value) * 0x100000001b3ull;
  }
  return hash;
}

}  // namespace

void PackedLists::save(base::ByteWriter& writer) const {
  std::vector<std::uint64_t> firsts;  // of the different ones
  std::vector<std::uint32_t> lengths;
  std::uint64_t end = 0;
  for (const List& list : lists_) {
    if (list.length > 0 && list.first == end) {
      firsts.push_back(list.first);
      lengths.push_back(list.length);
      end += list.length;
    }
  }
  writer.add(std::uint64_t{lengths.size()});
  writer.addAll(std::span<const std::uint32_t>(lengths));
  for (const List& list : lists_) {
    const auto after = std::ranges::upper_bound(firsts, list.first);
    writer.add(static_cast<std::uint64_t>(list.length > 0 ? after - firsts.begin() : 0));
  }
  for (const OccluderId id : ids_) {
    writer.add(id.value);
  }
}

// entries: of all lists together.
Result<std::vector<PackedLists::List>> PackedLists::loadRanges(base::ByteReader& reader, std::uint64_t lists,
                                                               std::uint64_t& entries) {
  const auto different = reader.readCount<std::uint64_t>(sizeof(std::uint32_t));
  std::vector<List> ranges{List{}};  // [0]: empty
  entries = 0;
  for (std::uint64_t i = 0; i < different; ++i) {
    ranges.push_back({entries, reader.read<std::uint32_t>()});
    entries += ranges.back().length;
    reader.expect(entries, sizeof(std::uint32_t));
    if (!reader.ok() || ranges.back().length == 0) {
      return Error{"stores an empty list"};
    }
  }
  reader.expect(lists, sizeof(std::uint64_t));
  if (!reader.ok()) {
    return Error{"ends in its lists"};
  }
  std::vector<List> found;
  found.reserve(static_cast<std::size_t>(lists));
  std::uint64_t used = 0;
  for (std::uint64_t i = 0; i < lists; ++i) {
    const auto which = reader.read<std::uint64_t>();
    if (which > different || which > used + 1) {
      return Error{"refers to a list that it does not have"};
    }
    used = std::max(used, which);
    found.push_back(ranges[static_cast<std::size_t>(which)]);
  }
  if (used < different) {
    return Error{"stores a list that is none of its lists"};
  }
  return found;
}

Result<PackedLists> PackedLists::load(base::ByteReader& reader, std::uint64_t lists,
                                      std::uint32_t occluder_count) {
  std::uint64_t entries = 0;
  Result<std::vector<List>> ranges = loadRanges(reader, lists, entries);
  if (!ranges) {
    return ranges.error();
  }
  PackedLists packed;
  packed.lists_ = std::move(*ranges);
  reader.expect(entries, sizeof(std::uint32_t));
  if (!reader.ok()) {
    return Error{"ends in its lists"};
  }
  packed.ids_.reserve(static_cast<std::size_t>(entries));
  for (std::uint64_t i = 0; i < entries; ++i) {
    const auto id = reader.read<std::uint32_t>();
    if (id >= occluder_count) {
      return Error{"names occluder " + std::to_string(id) + " of " + std::to_string(occluder_count)};
    }
    packed.ids_.push_back(OccluderId(id));
  }
  return packed;
}

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

}  // namespace sightline::occluders
