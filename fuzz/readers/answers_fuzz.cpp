// Feeds bytes to the readers of what `sightline bake --answers` writes: as a file; as one with the right
// version and checksum, as a hostile file has them; and as the answers of a single part, which what was read
// is written to again.

#include <algorithm>
#include <vector>

#include "fuzz/readers/forged_bytes.h"
#include "fuzz/readers/fuzz_input.h"
#include "src/base/byte_stream.h"
#include "src/pvs/bake/file/packed_bytes.h"
#include "src/pvs/bake/update/answers.h"
#include "src/pvs/bake/update/earlier_bake.h"

using namespace sightline;
using namespace sightline::fuzz;

namespace {

void readFile(std::span<const std::byte> bytes) {
  const Result<pvs::EarlierBake> earlier = pvs::readEarlierBake({bytes.begin(), bytes.end()});
  if (!earlier) {
    requireOneLine(earlier.error());
    return;
  }
  for (const auto& [part, answers] : earlier->parts) {
    pvs::decodeAnswers(answers, static_cast<std::uint32_t>(earlier->marks.objects.size()),
                       static_cast<std::uint32_t>(earlier->marks.nodes.size()));
  }
}

// Without the compression, which hides from the fuzzer what the bytes do.
void readAnswers(std::string_view text) {
  const std::uint32_t objects = takeByte(text), nodes = takeByte(text);
  base::ByteWriter plain;
  plain.add(static_cast<std::uint64_t>(text.size()));
  plain.addBytes(bytesOf(text));
  const std::optional<pvs::CellAnswers> answers = pvs::decodeAnswers(plain.take(), objects, nodes);
  if (answers) {
    const std::vector<std::byte> written = pvs::encodeAnswers(*answers);
    const std::optional<pvs::CellAnswers> again = pvs::decodeAnswers(written, objects, nodes);
    require(again && pvs::encodeAnswers(*again) == written);
  }
  if (const auto unpacked = pvs::unpack(bytesOf(text))) {
    require(unpacked->size() / pvs::kMaxPackedGain <= text.size());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = textOf(data, size);
  readFile(bytesOf(text));
  readAnswers(text);
  // The seeds have all but the checksum at the end.
  static const std::vector<std::byte> kEmpty = pvs::earlierBakeBytes({}, {}, {});
  const std::size_t head = sizeof(std::uint64_t) + sizeof(std::uint32_t);  // magic and version
  readFile(withChecksum(std::span(kEmpty).first(head), text));
  return 0;
}
