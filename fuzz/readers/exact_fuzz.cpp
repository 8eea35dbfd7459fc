// Feeds bytes to the reader of exact visibility that `sightline bench` keeps: as they are, and with a right
// checksum at the end, as a hostile file has it.

#include "fuzz/readers/fuzz_input.h"
#include "tools/sightline/exact/exact_bytes.h"

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

using namespace sightline;
using namespace sightline::fuzz;

namespace {

constexpr std::uint64_t kObjects = 50;

void read(std::string_view bytes) {
  const tool::ExactKey key({.hash = 7, .objects = kObjects, .triangles = 100}, View{}, {});
  if (const std::optional<tool::ExactObjects> found = tool::exactFromBytes(key, bytes)) {
    for (const auto* objects :
         {&found->witnessed, &found->undecided, &found->boxes, &found->undecided_boxes}) {
      for (const ObjectId object : *objects) {
        require(object.value < kObjects);
      }
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read(textOf(data, size));
  std::string summed(textOf(data, size));
  const std::uint64_t sum = pvs::checksumOf(bytesOf(summed));
  for (int shift = 0; shift < 64; shift += 8) {
    summed.push_back(static_cast<char>(sum >> shift & 0xff));
  }
  read(summed);
  return 0;
}
