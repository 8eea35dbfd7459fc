// The file: magic, the scene, the octree's box, the witnesses, and a checksum of all before it.
// Little-endian.

#include "sightline/pvs/format/witness.h"

#include <bit>

#include "src/pvs/format/checksum.h"
#include "src/pvs/format/witness_code.h"

namespace sightline {

using namespace pvs;

namespace {

constexpr std::uint64_t kMagic = 0x3153534e54495753u;
// A witness without runs takes so much, and each run.
constexpr std::size_t kHeadBytes = 8 + 1 + 1 + 4 + 4 + 48 + 4, kRunBytes = 8;

bool inRange(const HidingWitness& witness, std::uint8_t kind, std::uint8_t part) {
  const auto bits = static_cast<std::uint32_t>(std::bit_width(witness.cell) - 1);
  if (witness.cell == 0 || bits % 3 != 0 || bits / 3 > kMaxOctreeDepth || kind >= kWitnessKinds ||
      part >= kWitnessParts || witness.hidden.empty() || !isFinite(witness.from) || !isFinite(witness.to)) {
    return false;
  }
  std::uint32_t after = 0;
  for (const HidingWitness::Run& run : witness.hidden) {
    if (run.begin < after || run.end <= run.begin) {
      return false;
    }
    after = run.end;
  }
  return true;
}

void write(const Vec3d& v, base::ByteWriter& bytes) {
  for (const double number : {v.x, v.y, v.z}) {
    bytes.add(number);
  }
}

Vec3d readVec(base::ByteReader& bytes) {
  Vec3d v;
  for (double* number : {&v.x, &v.y, &v.z}) {
    *number = bytes.read<double>();
  }
  return v;
}

}  // namespace

std::uint64_t cellNumber(const OctreeCell& cell) {
  std::uint64_t number = 1;
  for (std::uint32_t bit = cell.level; bit-- > 0;) {
    number =
        8 * number + ((cell.at[0] >> bit & 1) | (cell.at[1] >> bit & 1) << 1 | (cell.at[2] >> bit & 1) << 2);
  }
  return number;
}

OctreeCell cellOfNumber(std::uint64_t number) {
  const auto level = static_cast<std::uint32_t>((std::bit_width(number) - 1) / 3);
  OctreeCell cell;
  for (std::uint32_t i = level; i-- > 0;) {
    cell = cell.child(static_cast<std::uint32_t>(number >> 3 * i & 7));
  }
  return cell;
}

void pvs::write(const std::vector<HidingWitness>& witnesses, base::ByteWriter& bytes) {
  bytes.add(static_cast<std::uint64_t>(witnesses.size()));
  for (const HidingWitness& witness : witnesses) {
    bytes.add(witness.cell);
    bytes.add(static_cast<std::uint8_t>(witness.part));
    bytes.add(static_cast<std::uint8_t>(witness.kind));
    bytes.add(witness.occluder);
    bytes.add(witness.object.value);
    sightline::write(witness.from, bytes);
    sightline::write(witness.to, bytes);
    bytes.add(static_cast<std::uint32_t>(witness.hidden.size()));
    for (const HidingWitness::Run& run : witness.hidden) {
      bytes.add(run.begin);
      bytes.add(run.end);
    }
  }
}

bool pvs::read(base::ByteReader& bytes, std::vector<HidingWitness>& witnesses) {
  witnesses.resize(bytes.readCount<std::uint64_t>(kHeadBytes));
  for (HidingWitness& witness : witnesses) {
    witness.cell = bytes.read<std::uint64_t>();
    const auto part = bytes.read<std::uint8_t>(), kind = bytes.read<std::uint8_t>();
    witness.part = static_cast<WitnessPart>(part);
    witness.kind = static_cast<WitnessKind>(kind);
    witness.occluder = bytes.read<std::uint32_t>();
    witness.object = ObjectId(bytes.read<std::uint32_t>());
    witness.from = readVec(bytes);
    witness.to = readVec(bytes);
    witness.hidden.resize(bytes.readCount<std::uint32_t>(kRunBytes));
    for (HidingWitness::Run& run : witness.hidden) {
      run.begin = bytes.read<std::uint32_t>();
      run.end = bytes.read<std::uint32_t>();
    }
    if (!bytes.ok() || !inRange(witness, kind, part)) {
      return false;
    }
  }
  return bytes.ok();
}

std::vector<std::byte> witnessBytes(const Witnesses& witnesses) {
  base::ByteWriter bytes;
  bytes.add(kMagic);
  for (const std::uint64_t number :
       {std::uint64_t{witnesses.scene.hash}, std::uint64_t{witnesses.scene.objects},
        std::uint64_t{witnesses.scene.triangles}}) {
    bytes.add(number);
  }
  write(witnesses.root_min, bytes);
  write(witnesses.root_max, bytes);
  pvs::write(witnesses.all, bytes);
  std::vector<std::byte> all = bytes.take();
  base::ByteWriter tail;
  tail.add(checksumOf(all));
  const std::vector<std::byte> sum = tail.take();
  all.insert(all.end(), sum.begin(), sum.end());
  return all;
}

Result<Witnesses> readWitnesses(std::span<const std::byte> bytes, const std::string& name) {
  base::ByteReader start(bytes);
  if (start.read<std::uint64_t>() != kMagic || !start.ok()) {
    return Error{name + ": is no file of witnesses; `sightline bake --witnesses` writes one"};
  }
  const Error damaged{name + ": is damaged or cut off; bake it again"};
  if (bytes.size() < 16) {
    return damaged;
  }
  base::ByteReader tail(bytes.last(8));
  if (tail.read<std::uint64_t>() != checksumOf(bytes.first(bytes.size() - 8))) {
    return damaged;
  }
  base::ByteReader reader(bytes.first(bytes.size() - 8));
  reader.read<std::uint64_t>();
  Witnesses witnesses;
  witnesses.scene.hash = reader.read<std::uint64_t>();
  witnesses.scene.objects = reader.read<std::uint64_t>();
  witnesses.scene.triangles = reader.read<std::uint64_t>();
  witnesses.root_min = readVec(reader);
  witnesses.root_max = readVec(reader);
  if (!pvs::read(reader, witnesses.all) || !reader.atEnd()) {
    return Error{name + ": holds what is no witness; bake it again"};
  }
  return witnesses;
}

}  // namespace sightline
