#include "src/pvs/bake/file/part_code.h"

#include <utility>

#include "src/pvs/bake/file/packed_bytes.h"
#include "src/pvs/bake/file/run_code.h"
#include "src/pvs/format/witness_code.h"

namespace sightline::pvs {
namespace {

std::span<const std::byte> readBlock(base::ByteReader& bytes) {
  const auto length = bytes.read<std::uint64_t>();
  return bytes.readBytes(length);
}

}  // namespace

void write(const PartHead& head, base::ByteWriter& bytes) {
  bytes.add(head.magic);
  bytes.add(head.plan);
  bytes.add(head.id);
  bytes.add(head.summary.leaves);
  bytes.add(head.summary.mean_triangles);
  bytes.add(head.summary.share);
  bytes.add(head.search_distance);
}

PartHead readHead(base::ByteReader& bytes) {
  PartHead head;
  head.magic = bytes.read<std::uint64_t>();
  head.plan = bytes.read<std::uint64_t>();
  head.id = bytes.read<std::uint64_t>();
  head.summary.leaves = bytes.read<std::uint32_t>();
  head.summary.mean_triangles = bytes.read<double>();
  head.summary.share = bytes.read<double>();
  head.search_distance = bytes.read<double>();
  return head;
}

void addBlock(std::span<const std::byte> block, base::ByteWriter& bytes) {
  bytes.add(static_cast<std::uint64_t>(block.size()));
  bytes.addBytes(block);
}

std::optional<PartContent> contentOf(const BakeSettings& settings, std::span<const std::byte> part) {
  base::ByteReader bytes(part);
  PartContent content;
  content.head = readHead(bytes);
  content.main = readBlock(bytes);
  if (settings.witnesses) {
    content.witnesses = readBlock(bytes);
  }
  if (settings.answers) {
    content.answers = readBlock(bytes);
  }
  return bytes.atEnd() ? std::optional(content) : std::nullopt;
}

std::optional<BakedCell> cellOf(const BakeScene& scene, const PartContent& content) {
  const std::optional<std::vector<std::byte>> main = unpack(content.main);
  if (!main || content.head.divided()) {
    return std::nullopt;
  }
  base::ByteReader bytes(*main);
  std::optional<BakedCell> cell = readCell(bytes, cellOfNumber(content.head.id).level, scene);
  return cell && bytes.atEnd() ? std::move(cell) : std::nullopt;
}

bool soundlyDivided(const BakeScene& scene, const PartContent& content) {
  const std::optional<std::vector<std::byte>> main = unpack(content.main);
  if (!main || !content.head.divided() || cellOfNumber(content.head.id).level >= kMaxOctreeDepth) {
    return false;
  }
  base::ByteReader bytes(*main);
  Runs seen;
  return readRuns(bytes, static_cast<std::uint32_t>(scene.boxes.objects.size()), seen) && bytes.atEnd();
}

std::optional<std::vector<HidingWitness>> witnessesOf(const BakeSettings& settings,
                                                      const PartContent& content) {
  std::vector<HidingWitness> witnesses;
  if (!settings.witnesses) {
    return witnesses;
  }
  const std::optional<std::vector<std::byte>> plain = unpack(content.witnesses);
  base::ByteReader bytes(plain ? *plain : std::span<const std::byte>());
  return read(bytes, witnesses) && bytes.atEnd() ? std::optional(std::move(witnesses)) : std::nullopt;
}

}  // namespace sightline::pvs
