#include "src/pvs/bake/file/encode_sight.h"

#include <algorithm>
#include <string>
#include <utility>

#include "src/pvs/format/set_code.h"
#include "src/pvs/format/structure.h"

namespace sightline::pvs {
namespace {

constexpr int kDatabaseLevel = 9;  // of zstd

void encodeDatabase(const DatabaseBlob& blob, ChunkWriter& writer, EncodedChunks& encoded) {
  DatabaseEntry entry{blob.name, blob.occluders, blob.bytes.size(),
                      static_cast<std::uint32_t>(encoded.chunks.size()), 0};
  for (std::span<const std::byte> rest(blob.bytes); !rest.empty(); ++entry.chunk_count) {
    const std::size_t length = std::min<std::size_t>(rest.size(), kDatabaseChunkBytes);
    writer.append(rest.first(length), kDatabaseLevel);
    rest = rest.subspan(length);
  }
  encoded.databases.push_back(entry);
}

class PayloadInMemory final : public Payload {
 public:
  explicit PayloadInMemory(std::vector<std::byte>& bytes) : bytes_(bytes) {}

  bool append(std::span<const std::byte> bytes) override {
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    return true;
  }
  bool read(std::uint64_t offset, std::span<std::byte> bytes) override {
    std::ranges::copy(std::span(bytes_).subspan(static_cast<std::size_t>(offset), bytes.size()),
                      bytes.begin());
    return true;
  }

 private:
  std::vector<std::byte>& bytes_;
};

Status checkSetsOf(const BakedVisibility& baked) {
  const NodeSets& sets = baked.sets;
  if (sets.first.empty() || sets.first.front() != 0 || sets.first.back() != sets.nodes.size() ||
      !std::is_sorted(sets.first.begin(), sets.first.end()) || sets.first.size() > 0x7fffffffu) {
    return Error{"the sets are not one after the other"};
  }
  for (std::uint32_t set = 0; set < sets.count(); ++set) {
    if (!soundSet(sets[set], baked.boxes.nodes)) {
      return Error{"set " + std::to_string(set) +
                   " is not ascending, not in the hierarchy, or names a node below another"};
    }
  }
  return Success{};
}

}  // namespace

void encodeDatabases(std::span<const DatabaseBlob> databases, Payload& payload, EncodedChunks& encoded) {
  ChunkWriter writer(payload, encoded);
  for (const DatabaseBlob& blob : databases) {
    encodeDatabase(blob, writer, encoded);
  }
}

EncodedChunks encodeChunks(const BakedVisibility& baked) {
  EncodedChunks encoded;
  PayloadInMemory payload(encoded.payload);
  SetWriter sets(baked.boxes.nodes, payload, encoded);
  for (std::uint32_t set = 0; set < baked.sets.count(); ++set) {
    sets.add(baked.sets[set]);
  }
  sets.finish();
  encodeDatabases(baked.databases, payload, encoded);
  return encoded;
}

SightView viewOf(const BakedVisibility& baked, const EncodedChunks& encoded) {
  SightView view;
  view.scene = baked.scene;
  view.near_distance = baked.record.near_distance;
  view.triangle_budget = baked.record.triangle_budget;
  view.max_depth = baked.record.max_depth;
  view.settings = baked.record.settings;
  view.boxes = baked.boxes.view();
  view.octree = baked.octree.view();
  view.set_chunks = encoded.set_chunks;
  view.sets = encoded.sets;
  view.doors = baked.doors.view();
  view.chunks = encoded.chunks;
  view.databases = encoded.databases;
  view.payload = encoded.payload;
  return view;
}

std::vector<std::byte> SightBytes::joined() const {
  std::vector<std::byte> all = structure;
  all.insert(all.end(), payload.begin(), payload.end());
  return all;
}

Result<SightBytes> encodeSight(const BakedVisibility& baked) {
  // The order matters: sets are checked by means of the hierarchy.
  Status sound = checkBoxTree(baked.boxes.view());
  if (sound) {
    sound = checkSetsOf(baked);
  }
  if (!sound) {
    return Error{"the data is not sound: " + sound.error().message};
  }
  EncodedChunks encoded = encodeChunks(baked);
  const SightView view = viewOf(baked, encoded);
  if (Status fits = checkView(view); !fits) {
    return Error{"the data is not sound: " + fits.error().message};
  }
  Result<std::vector<std::byte>> structure = structureBytes(view);
  if (!structure) {
    return structure.error();
  }
  return SightBytes{std::move(*structure), std::move(encoded.payload)};
}

}  // namespace sightline::pvs
