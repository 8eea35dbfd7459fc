#include <flatbuffers/flatbuffers.h>
#include <sight_generated.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <type_traits>

#include "src/pvs/format/checksum.h"
#include "src/pvs/format/set_code.h"
#include "src/pvs/format/sight_view.h"

namespace sightline::pvs {
namespace {

static_assert(std::endian::native == std::endian::little, ".sight files are read in place");

// A struct of the schema and our struct with the same bytes.
template <typename Stored, typename Ours>
constexpr bool kSameLayout =
    sizeof(Stored) == sizeof(Ours) &&
    alignof(Stored) == alignof(Ours) && std::is_trivially_copyable_v<Ours>&& std::is_standard_layout_v<Ours>;
static_assert(kSameLayout<sight::BoxNode, BoxNode> && kSameLayout<sight::OctreeLeaf, OctreeLeaf> &&
              kSameLayout<sight::CellPlane, CellPlane> && kSameLayout<sight::Chunk, Chunk> &&
              kSameLayout<sight::SetPlace, SetPlace> && kSameLayout<sight::Double3, Vec3d> &&
              kSameLayout<std::uint32_t, ObjectId> && kSameLayout<sight::DoorSet, DoorSet>);

template <typename Stored, typename Ours>
auto writeArray(flatbuffers::FlatBufferBuilder& builder, std::span<const Ours> values) {
  if constexpr (std::is_scalar_v<Stored>) {
    return builder.CreateVector(reinterpret_cast<const Stored*>(values.data()), values.size());
  } else {
    return builder.CreateVectorOfStructs(reinterpret_cast<const Stored*>(values.data()), values.size());
  }
}

// The same for an array that is left out of the file if it is empty.
template <typename Stored, typename Ours>
auto writeOptionalArray(flatbuffers::FlatBufferBuilder& builder, std::span<const Ours> values) {
  using Vector = decltype(writeArray<Stored>(builder, values));
  return values.empty() ? Vector() : writeArray<Stored>(builder, values);
}

// Returns false if the vector is not aligned for its elements. One that is empty or left out may be
// anywhere.
template <typename Ours, typename Vector>
bool readArray(const Vector* stored, std::span<const Ours>& values) {
  if (stored == nullptr) {
    values = {};
    return true;
  }
  const auto* data = reinterpret_cast<const Ours*>(stored->Data());
  values = stored->size() == 0 ? std::span<const Ours>() : std::span<const Ours>(data, stored->size());
  return values.empty() || reinterpret_cast<std::uintptr_t>(data) % alignof(Ours) == 0;
}

sight::Double3 stored(const Vec3d& v) {
  return {v.x, v.y, v.z};
}

Vec3d ours(const sight::Double3& v) {
  return {v.x(), v.y(), v.z()};
}

std::size_t estimatedBytes(const SightView& view) {
  return 4096 + view.payload.size() + view.settings.size() + view.boxes.nodes.size_bytes() +
         view.boxes.objects.size_bytes() + view.octree.nodes.size_bytes() + view.octree.leaves.size_bytes() +
         2 * view.octree.leaves.size() + view.octree.planes.size_bytes() + view.sets.size_bytes() +
         view.chunks.size_bytes() + view.doors.doors.size_bytes() + view.doors.group_ends.size_bytes() +
         view.doors.hidden.size_bytes() + view.doors.hidden_ends.size_bytes();
}

auto writeDatabases(flatbuffers::FlatBufferBuilder& builder, const SightView& view) {
  std::vector<flatbuffers::Offset<sight::Database>> tables;
  for (const DatabaseEntry& entry : view.databases) {
    const auto name = builder.CreateString(entry.name.data(), entry.name.size());
    tables.push_back(sight::CreateDatabase(builder, name, entry.occluders, entry.raw_bytes, entry.first_chunk,
                                           entry.chunk_count));
  }
  return builder.CreateVector(tables);
}

// FlatBuffers puts what is created first at the end of the file.
void writeFile(flatbuffers::FlatBufferBuilder& builder, const SightView& view) {
  const auto hidden_ends = writeOptionalArray<std::uint32_t>(builder, view.doors.hidden_ends);
  const auto hidden = writeOptionalArray<sight::DoorSet>(builder, view.doors.hidden);
  const auto group_ends = writeOptionalArray<std::uint32_t>(builder, view.doors.group_ends);
  const auto doors = writeOptionalArray<std::uint32_t>(builder, view.doors.doors);
  const auto payload = writeArray<std::uint8_t>(builder, view.payload);
  const auto chunks = writeArray<sight::Chunk>(builder, view.chunks);
  const auto sets = writeArray<sight::SetPlace>(builder, view.sets);
  const auto objects = writeArray<std::uint32_t>(builder, view.boxes.objects);
  const auto boxes = writeArray<sight::BoxNode>(builder, view.boxes.nodes);
  const auto planes = writeArray<sight::CellPlane>(builder, view.octree.planes);
  const auto reasons = writeArray<std::uint8_t>(builder, view.octree.reasons);
  const auto depths = writeArray<std::uint8_t>(builder, view.octree.depths);
  const auto leaves = writeArray<sight::OctreeLeaf>(builder, view.octree.leaves);
  const auto nodes = writeArray<std::uint32_t>(builder, view.octree.nodes);
  const auto databases = writeDatabases(builder, view);
  const auto settings = builder.CreateString(view.settings.data(), view.settings.size());
  const auto record =
      sight::CreateRecord(builder, view.near_distance, view.triangle_budget, view.max_depth, settings);
  const sight::Seal seal(0, 0);
  const sight::Scene scene(view.scene.hash, view.scene.objects, view.scene.triangles);
  const sight::Extent extent(stored(view.octree.min), stored(view.octree.max));
  builder.Finish(sight::CreateFile(builder, kVersion, &seal, &scene, record, boxes, objects, &extent, nodes,
                                   leaves, depths, reasons, planes, view.set_chunks, sets, chunks, databases,
                                   payload, doors, group_ends, hidden, hidden_ends),
                 sight::FileIdentifier());
}

const std::uint8_t* startOf(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

template <typename Table>
const Table* verified(std::span<const std::byte> bytes) {
  flatbuffers::Verifier verifier(startOf(bytes), bytes.size(), 8, 4 * kMaxDatabases);
  const bool sound = bytes.size() <= kMaxFileBytes && verifier.VerifyBuffer<Table>(sight::FileIdentifier());
  return sound ? flatbuffers::GetRoot<Table>(bytes.data()) : nullptr;
}

// Offset of a part of the file, which must lie in the bytes.
std::size_t offsetIn(std::span<const std::byte> bytes, const void* part) {
  return static_cast<std::size_t>(static_cast<const std::byte*>(part) - bytes.data());
}

// Checksum of everything that is read in place: all bytes except its own eight and the payload.
std::uint64_t sealOf(std::span<const std::byte> bytes, const sight::File& file) {
  struct Gap {
    std::size_t begin, end;
  };
  const std::size_t own = offsetIn(bytes, file.seal()) + sizeof(std::uint64_t);
  const std::size_t payload = offsetIn(bytes, file.payload()->Data());
  std::array<Gap, 2> gaps{{{own, own + sizeof(std::uint64_t)}, {payload, payload + file.payload()->size()}}};
  if (gaps[1].begin < gaps[0].begin) {
    std::swap(gaps[0], gaps[1]);
  }
  Checksum checksum;
  std::size_t at = 0;
  for (const Gap& gap : gaps) {
    checksum.add(bytes.subspan(at, std::max(gap.begin, at) - at));  // gaps may overlap in forged files
    at = std::max(gap.end, at);
  }
  checksum.add(bytes.subspan(at));
  return checksum.value();
}

// Fills in the checksums of the chunks that lie in the payload; others keep theirs.
void sealChunks(std::span<std::byte> bytes, const sight::File& file) {
  const std::span<std::byte> payload =
      bytes.subspan(offsetIn(bytes, file.payload()->Data()), file.payload()->size());
  std::span<const Chunk> chunks;
  if (!readArray(file.chunks(), chunks)) {
    return;
  }
  for (const Chunk& chunk : chunks) {
    if (chunk.offset <= payload.size() && chunk.bytes <= payload.size() - chunk.offset) {
      const std::uint64_t checksum = checksumOf(payload.subspan(chunk.offset, chunk.bytes));
      std::memcpy(bytes.data() + offsetIn(bytes, &chunk), &checksum, sizeof checksum);
    }
  }
}

// Checks that these may be the complete bytes of a file of this version.
Status checkVersion(std::span<const std::byte> bytes) {
  if (bytes.empty()) {
    return Error{"is empty: bake it again"};
  }
  if (bytes.size() > kMaxFileBytes) {
    return Error{"is not a .sight file: it is larger than 2 GiB"};
  }
  constexpr std::size_t kHead = 8;  // root offset and identifier
  if (bytes.size() < kHead || !flatbuffers::BufferHasIdentifier(bytes.data(), sight::FileIdentifier())) {
    return Error{"is not a .sight file"};
  }
  const auto* any = verified<sight::FileOfAnyVersion>(bytes);
  if (any == nullptr || any->seal() == nullptr) {
    return Error{"is truncated or altered: bake it again"};
  }
  if (any->version() != kVersion) {
    const bool newer = any->version() > kVersion;
    return Error{"has version " + std::to_string(any->version()) + " of the format, which is " +
                 (newer ? "newer" : "older") + " than " + std::to_string(kVersion) +
                 (newer ? ": update Sightline, or bake it again" : ": bake it again")};
  }
  if (any->seal()->file_bytes() != bytes.size()) {
    return Error{"is truncated or altered: it has " + std::to_string(bytes.size()) +
                 " bytes and should have " + std::to_string(any->seal()->file_bytes()) + ": bake it again"};
  }
  return Success{};
}

bool readArrays(const sight::File& file, SightView& view) {
  OctreeView& octree = view.octree;
  octree.min = ours(file.extent()->min());
  octree.max = ours(file.extent()->max());
  return readArray(file.boxes(), view.boxes.nodes) && readArray(file.objects(), view.boxes.objects) &&
         readArray(file.nodes(), octree.nodes) && readArray(file.leaves(), octree.leaves) &&
         readArray(file.depths(), octree.depths) && readArray(file.reasons(), octree.reasons) &&
         readArray(file.planes(), octree.planes) && readArray(file.sets(), view.sets) &&
         readArray(file.chunks(), view.chunks) && readArray(file.payload(), view.payload) &&
         readArray(file.doors(), view.doors.doors) &&
         readArray(file.door_group_ends(), view.doors.group_ends) &&
         readArray(file.door_hidden(), view.doors.hidden) &&
         readArray(file.door_hidden_ends(), view.doors.hidden_ends);
}

// Returns false if a part is not aligned for its elements.
bool readView(const sight::File& file, SightView& view) {
  view.scene = {file.scene()->hash(), file.scene()->objects(), file.scene()->triangles()};
  view.near_distance = file.record()->near_distance();
  view.triangle_budget = file.record()->triangle_budget();
  view.max_depth = file.record()->max_depth();
  view.settings = file.record()->settings()->string_view();
  view.set_chunks = file.set_chunks();
  for (const sight::Database* database : *file.databases()) {
    view.databases.push_back({database->name()->string_view(), database->occluders(), database->raw_bytes(),
                              database->first_chunk(), database->chunk_count()});
  }
  return readArrays(file, view);
}

}  // namespace

Result<std::vector<std::byte>> sightBytes(const SightView& view) {
  const std::size_t estimate = estimatedBytes(view);
  if (estimate > kMaxFileBytes) {
    return Error{"would be larger than 2 GiB: bake with a larger triangle budget or a smaller depth"};
  }
  flatbuffers::FlatBufferBuilder builder(estimate);
  writeFile(builder, view);
  const auto* begin = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  std::vector<std::byte> bytes(begin, begin + builder.GetSize());
  seal(bytes);
  return bytes;
}

void seal(std::span<std::byte> bytes) {
  // In forged bytes, the field that is written may be part of something else, so the bytes are verified again
  // after each step.
  if (const auto* file = verified<sight::File>(bytes); file != nullptr) {
    const std::uint64_t size = bytes.size();
    std::memcpy(bytes.data() + offsetIn(bytes, file->seal()), &size, sizeof size);
  }
  if (const auto* file = verified<sight::File>(bytes); file != nullptr) {
    sealChunks(bytes, *file);
  }
  if (const auto* file = verified<sight::File>(bytes); file != nullptr) {
    const std::uint64_t checksum = sealOf(bytes, *file);
    std::memcpy(bytes.data() + offsetIn(bytes, file->seal()) + sizeof checksum, &checksum, sizeof checksum);
  }
}

Result<SightView> viewOf(std::span<const std::byte> bytes) {
  if (Status version = checkVersion(bytes); !version) {
    return version.error();
  }
  const auto* file = verified<sight::File>(bytes);
  if (file == nullptr) {
    return Error{"is truncated or altered: bake it again"};
  }
  if (sealOf(bytes, *file) != file->seal()->checksum()) {
    return Error{"is altered, its checksum is another one: bake it again"};
  }
  SightView view;
  const Status sound = readView(*file, view) ? checkView(view) : Error{"its arrays are not aligned"};
  if (!sound) {
    return Error{"is damaged: " + sound.error().message + ": bake it again"};
  }
  view.ends = endsOf(view.boxes.nodes);
  return view;
}

}  // namespace sightline::pvs
