#include "src/pvs/bake/file/run_code.h"

namespace sightline::pvs {

void addCount(std::uint64_t value, base::ByteWriter& bytes) {
  for (; value >= 0x80; value >>= 7) {
    bytes.add(static_cast<std::uint8_t>((value & 0x7f) | 0x80));
  }
  bytes.add(static_cast<std::uint8_t>(value));
}

std::uint64_t readCount(base::ByteReader& bytes) {
  std::uint64_t value = 0;
  for (std::uint32_t shift = 0; shift < 63; shift += 7) {
    const auto byte = bytes.read<std::uint8_t>();
    value |= std::uint64_t{byte & 0x7fu} << shift;
    if (byte < 0x80) {
      return bytes.ok() ? value : ~std::uint64_t{0};
    }
  }
  return ~std::uint64_t{0};
}

void addRuns(const Runs& runs, base::ByteWriter& bytes) {
  addCount(runs.size(), bytes);
  std::uint32_t end = 0;
  for (const ObjectRun& run : runs) {
    addCount(run.begin - end, bytes);
    addCount(run.end - run.begin, bytes);
    end = run.end;
  }
}

bool readRuns(base::ByteReader& bytes, std::uint32_t object_count, Runs& runs) {
  constexpr std::size_t kLeastRunBytes = 2;
  runs.clear();
  const std::uint64_t count = readCount(bytes);
  if (count > object_count || count > bytes.remaining() / kLeastRunBytes) {
    return false;
  }
  std::uint64_t end = 0;
  runs.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t gap = readCount(bytes), length = readCount(bytes);
    if (gap > object_count || length == 0 || length > object_count || end + gap + length > object_count ||
        (gap == 0 && i > 0)) {
      return false;
    }
    runs.push_back({static_cast<std::uint32_t>(end + gap), static_cast<std::uint32_t>(end + gap + length)});
    end += gap + length;
  }
  return true;
}

}  // namespace sightline::pvs
