#pragma once

// Lists of occluders one after the other in one array, equal ones stored once.

#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/result.h"
#include "src/base/byte_stream.h"

namespace sightline::occluders {

// Made by a ListPacker or by load(); does not change afterwards.
class PackedLists {
 public:
  std::size_t size() const { return lists_.size(); }
  // The list that was added as number `index` < size().
  std::span<const OccluderId> operator[](std::size_t index) const {
    return std::span(ids_).subspan(lists_[index].first, lists_[index].length);
  }

  // The different lists that are not empty, in the order in which they first occur: their number (64 bits)
  // and lengths (32); for each list 0 if it is empty, else which of those it is, from 1 (64); their ids (32).
  void save(base::ByteWriter& writer) const;
  // Reads so many lists of ids < occluder_count. Allocates at most a few times as much as the bytes take.
  static Result<PackedLists> load(base::ByteReader& reader, std::uint64_t lists,
                                  std::uint32_t occluder_count);
  static constexpr std::size_t savedBytesPerList() { return sizeof(std::uint64_t); }  // at least

  std::size_t bytes() const;  // beside the object itself
  // Memory that a list takes beside its entries.
  static constexpr std::size_t bytesPerList() { return sizeof(List); }

 private:
  friend class ListPacker;

  // A range of ids_.
  struct List {
    std::uint64_t first = 0;
    std::uint32_t length = 0;
  };
  static Result<std::vector<List>> loadRanges(base::ByteReader& reader, std::uint64_t lists,
                                              std::uint64_t& entries);

  std::vector<List> lists_;  // equal ones are the same range
  std::vector<OccluderId> ids_;
};

// Packs lists one after the other. Lists of neighbouring cells, points and directions are often equal: a list
// that equals an earlier one refers to it.
class ListPacker {
 public:
  // Reserves room for so many lists with so many entries together, even if no two are equal.
  ListPacker(std::size_t lists, std::size_t entries);

  void add(std::span<const OccluderId> list);
  // The packed lists, without unused memory; leaves this empty.
  PackedLists finish();

 private:
  PackedLists packed_;
  std::unordered_map<std::uint64_t, std::size_t> first_of_hash_;  // the number of a list
};

}  // namespace sightline::occluders
