#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "src/pvs/format/set_code.h"
#include "src/pvs/format/sight_view.h"
#include "src/pvs/format/structure.h"

namespace sightline::pvs {
namespace {

// Checks that the chunks are consecutive and make up the payload.
Status checkChunks(const SightView& view) {
  std::uint64_t at = 0;
  for (const Chunk& chunk : view.chunks) {
    if (chunk.offset != at || chunk.bytes == 0 || chunk.bytes > view.payloadBytes() - at) {
      return Error{"its chunks do not make up its payload"};
    }
    at += chunk.bytes;
  }
  return at == view.payloadBytes() ? Status(Success{})
                                   : Status(Error{"its chunks do not make up its payload"});
}

// Checks that all chunks of sets are referenced, in order, from their first byte on, and that none is longer
// than its sets may be.
Status checkSets(const SightView& view) {
  if (view.set_chunks > view.chunks.size()) {
    return Error{"chunks of sets are missing"};
  }
  std::uint32_t chunks_begun = 0;
  std::size_t sets_in_chunk = 0;
  for (std::size_t set = 0; set < view.sets.size(); ++set) {
    const auto [chunk, offset] = view.sets[set];
    const bool begins = chunk == chunks_begun && offset == 0;
    const bool goes_on = chunk + 1 == chunks_begun && sets_in_chunk > 0 && offset > view.sets[set - 1].offset;
    if (!(begins || goes_on) || chunk >= view.set_chunks || offset >= view.chunks[chunk].raw_bytes) {
      return Error{"the index of sets is not sound (set " + std::to_string(set) + ")"};
    }
    chunks_begun += begins ? 1 : 0;
    sets_in_chunk = begins ? 1 : sets_in_chunk + 1;
    const std::uint64_t max_bytes =
        sets_in_chunk > 1 ? kMaxSetChunkBytes
                          : std::max<std::uint64_t>(kMaxSetChunkBytes, maxSetBytes(view.boxes.nodes.size()));
    if (view.chunks[chunk].raw_bytes > max_bytes) {
      return Error{"a chunk of sets claims more bytes than sets can have (set " + std::to_string(set) + ")"};
    }
  }
  return chunks_begun == view.set_chunks ? Status(Success{}) : Status(Error{"a chunk holds no set"});
}

Status checkDatabases(const SightView& view) {
  if (view.databases.size() > kMaxDatabases) {
    return Error{"it claims more occluder databases than there can be"};
  }
  std::uint64_t next_chunk = view.set_chunks;
  for (std::size_t i = 0; i < view.databases.size(); ++i) {
    const DatabaseEntry& entry = view.databases[i];
    if (entry.first_chunk != next_chunk || entry.chunk_count > view.chunks.size() - next_chunk) {
      return Error{"an occluder database's chunks are missing"};
    }
    std::uint64_t raw_bytes = 0;
    for (const Chunk& chunk : view.chunks.subspan(entry.first_chunk, entry.chunk_count)) {
      raw_bytes += chunk.raw_bytes;
      if (chunk.raw_bytes > kDatabaseChunkBytes) {
        return Error{"an occluder database's chunk claims more bytes than it can have"};
      }
    }
    if (raw_bytes != entry.raw_bytes || raw_bytes > kMaxDatabaseBytes) {
      return Error{"an occluder database claims more bytes than it has, or can have"};
    }
    for (std::size_t other = 0; other < i; ++other) {
      if (view.databases[other].name == entry.name) {
        return Error{"two occluder databases have one name"};
      }
    }
    next_chunk += entry.chunk_count;
  }
  return next_chunk == view.chunks.size() ? Status(Success{}) : Status(Error{"a chunk belongs to nothing"});
}

// True if the rows that end there are one after the other and are all of so many items.
bool soundEnds(std::span<const std::uint32_t> ends, std::size_t items) {
  return std::is_sorted(ends.begin(), ends.end()) && (ends.empty() ? 0 : ends.back()) == items;
}

// True if the items of each row are ascending, each once, by before(a, b).
template <typename Item, typename Before>
bool ascendingRows(std::span<const Item> items, std::span<const std::uint32_t> ends, Before&& before) {
  std::size_t begin = 0;
  for (const std::uint32_t end : ends) {
    for (std::size_t i = begin + 1; i < end; ++i) {
      if (!before(items[i - 1], items[i])) {
        return false;
      }
    }
    begin = end;
  }
  return true;
}

Status checkDoors(const SightView& view) {
  const DoorsView& doors = view.doors;
  const std::size_t sets = doors.doors.empty() ? 0 : view.sets.size();
  // A group without doors would count as closed always.
  if (std::adjacent_find(doors.group_ends.begin(), doors.group_ends.end()) != doors.group_ends.end() ||
      (!doors.group_ends.empty() && doors.group_ends.front() == 0)) {
    return Error{"a group of doors has no door"};
  }
  if (!soundEnds(doors.group_ends, doors.doors.size()) ||
      !soundEnds(doors.hidden_ends, doors.hidden.size()) || doors.hidden_ends.size() != sets) {
    return Error{"its doors, or what they hide, are not one after the other"};
  }
  const auto byGroup = [](const DoorSet& a, const DoorSet& b) { return a.group < b.group; };
  if (!ascendingRows(doors.doors, doors.group_ends, std::less<>()) ||
      !ascendingRows(doors.hidden, doors.hidden_ends, byGroup)) {
    return Error{"its doors, or what they hide, are not in order"};
  }
  const auto isObject = [&](ObjectId door) { return door.value < view.boxes.objects.size(); };
  const auto isThere = [&](const DoorSet& hidden) {
    return hidden.group < doors.groupCount() && hidden.hidden < view.sets.size();
  };
  if (!std::all_of(doors.doors.begin(), doors.doors.end(), isObject) ||
      !std::all_of(doors.hidden.begin(), doors.hidden.end(), isThere)) {
    return Error{"a door, or what it hides, is not there"};
  }
  return Success{};
}

}  // namespace

Status checkView(const SightView& view) {
  if (!(view.near_distance >= 0.0) || !std::isfinite(view.near_distance)) {
    return Error{"its near distance is negative or not finite"};
  }
  if (view.scene.objects != view.boxes.objects.size()) {
    return Error{"its hierarchy does not hold the objects of its scene"};
  }
  if (Status status = checkBoxTree(view.boxes); !status) {
    return status;
  }
  if (Status status = checkOctree(view.octree, view.sets.size()); !status) {
    return status;
  }
  if (Status status = checkChunks(view); !status) {
    return status;
  }
  if (Status status = checkSets(view); !status) {
    return status;
  }
  if (Status status = checkDoors(view); !status) {
    return status;
  }
  return checkDatabases(view);
}

}  // namespace sightline::pvs
