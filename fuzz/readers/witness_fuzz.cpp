// Feeds bytes to the reader of what `sightline bake --witnesses` writes: as they are, and behind the head of
// such a file with a right checksum at the end, as a hostile file has it. What is read is written as the same
// bytes.

#include <algorithm>
#include <vector>

#include "fuzz/readers/fuzz_input.h"
#include "sightline/pvs/format/witness.h"

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

using namespace sightline;
using namespace sightline::fuzz;

namespace {

void readWitnessFile(std::span<const std::byte> bytes) {
  const Result<Witnesses> read = readWitnesses(bytes, "file");
  if (!read) {
    requireOneLine(read.error());
    return;
  }
  const std::vector<std::byte> written = witnessBytes(*read);
  require(std::equal(written.begin(), written.end(), bytes.begin(), bytes.end()));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = textOf(data, size);
  readWitnessFile(bytesOf(text));
  static const std::vector<std::byte> kEmpty = witnessBytes({});
  std::vector<std::byte> forged(kEmpty.begin(), kEmpty.begin() + 8);
  const std::span<const std::byte> given = bytesOf(text);
  forged.insert(forged.end(), given.begin(), given.end());
  const std::uint64_t sum = pvs::checksumOf(forged);
  for (int shift = 0; shift < 64; shift += 8) {
    forged.push_back(static_cast<std::byte>(sum >> shift & 0xff));
  }
  readWitnessFile(forged);
  return 0;
}
