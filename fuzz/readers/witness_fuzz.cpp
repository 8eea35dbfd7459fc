// Feeds bytes to the reader of what `sightline bake --witnesses` writes: as they are, and behind the head of
// such a file with a right checksum at the end, as a hostile file has it. What is read is written as the same
// bytes.

#include <algorithm>
#include <vector>

#include "fuzz/readers/forged_bytes.h"
#include "fuzz/readers/fuzz_input.h"
#include "sightline/pvs/format/witness.h"

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
  readWitnessFile(withChecksum(std::span(kEmpty).first(8), text));
  return 0;
}
