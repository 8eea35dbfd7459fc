#include "src/pvs/bake/file/encode_sight.h"

#include <zstd.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "src/pvs/format/set_code.h"
#include "src/pvs/format/structure.h"

namespace sightline::pvs {
namespace {

using namespace pvs;

// Both levels decompress equally fast. Sets are compressed hardest because they make up most of a file.
constexpr int kSetLevel = 19;
constexpr int kDatabaseLevel = 9;

class Compressor {
 public:
  explicit Compressor(EncodedChunks& encoded) : encoded_(encoded), context_(ZSTD_createCCtx()) {}

  // Appends a chunk. A zstd frame compressed in one call stores its size.
  void append(std::span<const std::byte> raw, int level) {
    std::vector<std::byte>& payload = encoded_.payload;
    const std::size_t offset = payload.size();
    payload.resize(offset + ZSTD_compressBound(raw.size()));
    const std::size_t written = ZSTD_compressCCtx(context_.get(), payload.data() + offset,
                                                  payload.size() - offset, raw.data(), raw.size(), level);
    // With room for the bound, compression fails only if memory runs out; the check finds the resulting empty
    // chunk.
    payload.resize(offset + (ZSTD_isError(written) != 0 ? 0 : written));
    encoded_.chunks.push_back({0, offset, static_cast<std::uint32_t>(payload.size() - offset),
                               static_cast<std::uint32_t>(raw.size())});
  }

 private:
  struct Free {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };

  EncodedChunks& encoded_;
  std::unique_ptr<ZSTD_CCtx, Free> context_;
};

// Packs sets into a chunk until the next one would make it too long.
void encodeSets(const NodeSets& sets, std::span<const BoxNode> tree, Compressor& compressor,
                EncodedChunks& encoded) {
  std::vector<std::byte> raw, set_bytes;
  const auto finishChunk = [&] {
    if (!raw.empty()) {
      compressor.append(raw, kSetLevel);
      raw.clear();
    }
  };
  for (std::uint32_t set = 0; set < sets.count(); ++set) {
    set_bytes.clear();
    appendSet(set_bytes, sets[set], tree);
    if (raw.size() + set_bytes.size() > kSetChunkBytes) {
      finishChunk();
    }
    encoded.sets.push_back(
        {static_cast<std::uint32_t>(encoded.chunks.size()), static_cast<std::uint32_t>(raw.size())});
    raw.insert(raw.end(), set_bytes.begin(), set_bytes.end());
  }
  finishChunk();
  encoded.set_chunks = static_cast<std::uint32_t>(encoded.chunks.size());
}

void encodeDatabase(const DatabaseBlob& blob, Compressor& compressor, EncodedChunks& encoded) {
  DatabaseEntry entry{blob.name, blob.occluders, blob.bytes.size(),
                      static_cast<std::uint32_t>(encoded.chunks.size()), 0};
  for (std::span<const std::byte> rest(blob.bytes); !rest.empty(); ++entry.chunk_count) {
    const std::size_t length = std::min<std::size_t>(rest.size(), kDatabaseChunkBytes);
    compressor.append(rest.first(length), kDatabaseLevel);
    rest = rest.subspan(length);
  }
  encoded.databases.push_back(entry);
}

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

EncodedChunks encodeChunks(const BakedVisibility& baked) {
  EncodedChunks encoded;
  Compressor compressor(encoded);
  encodeSets(baked.sets, baked.boxes.nodes, compressor, encoded);
  for (const DatabaseBlob& blob : baked.databases) {
    encodeDatabase(blob, compressor, encoded);
  }
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
