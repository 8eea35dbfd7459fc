#include <flatbuffers/flatbuffers.h>
#include <sight_generated.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <optional>
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
              kSameLayout<sight::ViewerBounds, ViewerBounds> && kSameLayout<sight::SetPlace, SetPlace> &&
              kSameLayout<sight::Double3, Vec3d> && kSameLayout<std::uint32_t, ObjectId> &&
              kSameLayout<sight::DoorSet, DoorSet>);

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
  return 4096 + view.settings.size() + view.boxes.nodes.size_bytes() + view.boxes.objects.size_bytes() +
         view.octree.nodes.size_bytes() + view.octree.leaves.size_bytes() + 2 * view.octree.leaves.size() +
         view.octree.planes.size_bytes() + view.octree.viewers.size_bytes() + view.sets.size_bytes() +
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

// FlatBuffers puts what is created first at the end of the structure.
void writeStructure(flatbuffers::FlatBufferBuilder& builder, const SightView& view) {
  const auto hidden_ends = writeOptionalArray<std::uint32_t>(builder, view.doors.hidden_ends);
  const auto hidden = writeOptionalArray<sight::DoorSet>(builder, view.doors.hidden);
  const auto group_ends = writeOptionalArray<std::uint32_t>(builder, view.doors.group_ends);
  const auto doors = writeOptionalArray<std::uint32_t>(builder, view.doors.doors);
  const auto chunks = writeArray<sight::Chunk>(builder, view.chunks);
  const auto sets = writeArray<sight::SetPlace>(builder, view.sets);
  const auto objects = writeArray<std::uint32_t>(builder, view.boxes.objects);
  const auto boxes = writeArray<sight::BoxNode>(builder, view.boxes.nodes);
  const auto viewers = writeOptionalArray<sight::ViewerBounds>(builder, view.octree.viewers);
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
  builder.Finish(sight::CreateFile(builder, kVersion, &seal, view.payloadBytes(), &scene, record, boxes,
                                   objects, &extent, nodes, leaves, depths, reasons, planes, view.set_chunks,
                                   sets, chunks, databases, viewers, doors, group_ends, hidden, hidden_ends),
                 sight::FileIdentifier());
}

const std::uint8_t* startOf(std::span<const std::byte> bytes) {
  return reinterpret_cast<const std::uint8_t*>(bytes.data());
}

// The table with which the bytes begin; null if they do not, or if it reaches beyond them. No table reaches
// beyond kMaxStructureBytes.
template <typename Table>
const Table* verified(std::span<const std::byte> bytes) {
  const std::span<const std::byte> first =
      bytes.first(std::min<std::size_t>(bytes.size(), kMaxStructureBytes));
  flatbuffers::Verifier verifier(startOf(first), first.size(), 8, 4 * kMaxDatabases);
  const bool sound = verifier.VerifyBuffer<Table>(sight::FileIdentifier());
  return sound ? flatbuffers::GetRoot<Table>(first.data()) : nullptr;
}

// How many of these bytes of a whole file are the structure; nothing if they do not begin with one.
std::optional<std::size_t> structureSize(std::span<const std::byte> bytes) {
  const auto* head = verified<sight::FileHead>(bytes);
  const bool sound = head != nullptr && head->payload_bytes() <= bytes.size() &&
                     bytes.size() - head->payload_bytes() <= kMaxStructureBytes;
  return sound ? std::optional(bytes.size() - static_cast<std::size_t>(head->payload_bytes())) : std::nullopt;
}

// Offset of a part of the structure, which must lie in the bytes.
std::size_t offsetIn(std::span<const std::byte> bytes, const void* part) {
  return static_cast<std::size_t>(static_cast<const std::byte*>(part) - bytes.data());
}

// Checksum of everything that is read in place: all bytes of the structure except its own eight.
std::uint64_t sealOf(std::span<const std::byte> structure, const sight::File& file) {
  const std::size_t own = offsetIn(structure, file.seal()) + sizeof(std::uint64_t);
  Checksum checksum;
  checksum.add(structure.first(own));
  checksum.add(structure.subspan(own + sizeof(std::uint64_t)));
  return checksum.value();
}

// Fills in the checksums of the chunks that lie in the payload; others keep theirs.
void sealChunks(std::span<std::byte> structure, std::span<const std::byte> payload, const sight::File& file) {
  std::span<const Chunk> chunks;
  if (!readArray(file.chunks(), chunks)) {
    return;
  }
  for (const Chunk& chunk : chunks) {
    if (chunk.offset <= payload.size() && chunk.bytes <= payload.size() - chunk.offset) {
      const std::uint64_t checksum = checksumOf(payload.subspan(chunk.offset, chunk.bytes));
      std::memcpy(structure.data() + offsetIn(structure, &chunk), &checksum, sizeof checksum);
    }
  }
}

// payload: as much of the payload_bytes as is in memory. In forged bytes, the field that is written may be
// part of something else, so the bytes are verified again after each step.
void sealStructure(std::span<std::byte> structure, std::span<const std::byte> payload,
                   std::uint64_t payload_bytes) {
  if (const auto* file = verified<sight::File>(structure); file != nullptr) {
    const std::uint64_t size = structure.size() + payload_bytes;
    std::memcpy(structure.data() + offsetIn(structure, file->seal()), &size, sizeof size);
  }
  if (const auto* file = verified<sight::File>(structure); file != nullptr) {
    sealChunks(structure, payload, *file);
  }
  if (const auto* file = verified<sight::File>(structure); file != nullptr) {
    const std::uint64_t checksum = sealOf(structure, *file);
    std::memcpy(structure.data() + offsetIn(structure, file->seal()) + sizeof checksum, &checksum,
                sizeof checksum);
  }
}

// Checks that these may be the complete bytes of a file of this version.
Status checkVersion(std::span<const std::byte> bytes) {
  if (bytes.empty()) {
    return Error{"is empty: bake it again"};
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
         readArray(file.planes(), octree.planes) && readArray(file.viewers(), octree.viewers) &&
         readArray(file.sets(), view.sets) && readArray(file.chunks(), view.chunks) &&
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

Result<std::vector<std::byte>> structureBytes(const SightView& view) {
  const std::size_t estimate = estimatedBytes(view);
  if (estimate > kMaxStructureBytes) {
    return Error{
        "would have more than 2 GiB of cells and of places of sets: bake with a larger triangle budget or a "
        "smaller depth"};
  }
  flatbuffers::FlatBufferBuilder builder(estimate);
  writeStructure(builder, view);
  const auto* begin = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  std::vector<std::byte> bytes(begin, begin + builder.GetSize());
  sealStructure(bytes, view.payload, view.payloadBytes());
  return bytes;
}

void seal(std::span<std::byte> bytes) {
  if (const std::optional<std::size_t> size = structureSize(bytes)) {
    const std::span<const std::byte> payload = bytes.subspan(*size);
    sealStructure(bytes.first(*size), payload, payload.size());
  }
}

Result<SightView> viewOf(std::span<const std::byte> bytes) {
  if (Status version = checkVersion(bytes); !version) {
    return version.error();
  }
  const std::span<const std::byte> structure = bytes.first(structureSize(bytes).value_or(0));
  const auto* file = verified<sight::File>(structure);
  if (file == nullptr) {
    return Error{"is truncated or altered: bake it again"};
  }
  if (sealOf(structure, *file) != file->seal()->checksum()) {
    return Error{"is altered, its checksum is another one: bake it again"};
  }
  SightView view;
  view.payload = bytes.subspan(structure.size());
  const Status sound = readView(*file, view) ? checkView(view) : Error{"its arrays are not aligned"};
  if (!sound) {
    return Error{"is damaged: " + sound.error().message + ": bake it again"};
  }
  view.ends = endsOf(view.boxes.nodes);
  return view;
}

}  // namespace sightline::pvs
