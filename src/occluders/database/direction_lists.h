#pragma once

// What all occluder databases have in common: a list of occluders for each place and each direction, and the
// bytes that they are saved as. A place is a cell of the scene or a point of a grid.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sightline/base/result.h"
#include "src/occluders/database/database_bytes.h"
#include "src/occluders/database/packed_lists.h"
#include "src/occluders/database/sphere_directions.h"

namespace sightline::occluders {

// Places_ has these members:
//   static constexpr DatabaseKind kKind;
//   static std::uint32_t maxCount(std::uint32_t directions);  // more places than these are refused
//   std::uint32_t count() const;
//   std::size_t bytes() const;                                // of memory, beside the object itself
//   void save(base::ByteWriter& writer) const;                // without their number
//   static Result<Places_> load(base::ByteReader& reader, std::uint32_t count);
template <typename Places_>
struct DirectionLists {
  using Places = Places_;

  std::uint32_t occluder_count = 0;  // of the set
  SphereDirections directions;
  Places places;
  PackedLists lists;  // by place * directions + direction

  DirectionLists(std::uint32_t direction_count, std::uint32_t occluders, Places places_ = {})
      : occluder_count(occluders), directions(direction_count), places(std::move(places_)) {}

  std::span<const OccluderId> list(std::uint32_t place, std::uint32_t direction) const {
    return lists[std::size_t{place} * directions.count() + direction];
  }
  std::size_t bytes() const {
    return sizeof(DirectionLists) + directions.bytes() + places.bytes() + lists.bytes();
  }
};

// The bytes of a database; null: of one that was default constructed.
template <typename Places>
std::vector<std::byte> saveLists(const DirectionLists<Places>* data) {
  base::ByteWriter writer;
  if (data == nullptr) {
    addDatabaseHead(writer, Places::kKind, {});
    return writer.take();
  }
  addDatabaseHead(writer, Places::kKind, {data->directions.count(), data->occluder_count});
  writer.add(data->places.count());
  data->places.save(writer);
  data->lists.save(writer);
  return writer.take();
}

// Null: the lists of a default-constructed database. An error lacks its subject. Data is a DirectionLists or
// derives from one.
template <typename Data>
Result<std::shared_ptr<const Data>> readLists(base::ByteReader& reader, std::uint32_t occluder_count) {
  using Places = typename Data::Places;
  using Loaded = std::shared_ptr<const Data>;
  const Result<std::uint32_t> directions = readDatabaseHead(reader, Places::kKind, occluder_count);
  if (!directions) {
    return directions.error();
  }
  if (*directions == 0) {
    return Loaded();
  }
  const auto count =
      reader.readCount<std::uint32_t>(std::size_t{*directions} * PackedLists::savedBytesPerList());
  if (count == 0 || count > Places::maxCount(*directions)) {
    return Error{"has " + std::to_string(count) + " " + std::string(Places::kKind.places)};
  }
  Result<Places> places = Places::load(reader, count);
  if (!places) {
    return places.error();
  }
  Result<PackedLists> lists = PackedLists::load(reader, std::uint64_t{count} * *directions, occluder_count);
  if (!lists) {
    return lists.error();
  }
  // Directions come last: their tables take more memory than their number in the bytes justifies; the lists
  // do.
  const auto data = std::make_shared<Data>(*directions, occluder_count, std::move(*places));
  data->lists = std::move(*lists);
  return Loaded(data);
}

// What saveLists() gave, checked so far that any bytes are safe. An error says what is wrong with them.
template <typename Data>
Result<std::shared_ptr<const Data>> loadLists(std::span<const std::byte> bytes,
                                              std::uint32_t occluder_count) {
  base::ByteReader reader(bytes);
  Result<std::shared_ptr<const Data>> data = readLists<Data>(reader, occluder_count);
  if (!data || !reader.atEnd()) {
    return databaseError(Data::Places::kKind, reader, data ? nullptr : &data.error());
  }
  return data;
}

}  // namespace sightline::occluders
