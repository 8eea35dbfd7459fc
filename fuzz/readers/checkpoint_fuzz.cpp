// Feeds bytes to the reader of an unfinished bake's parts. A record counts only with its checksum, so the
// bytes are tried as they are, and as the parts of a file that is cut off somewhere.

#include <algorithm>
#include <vector>

#include "fuzz/readers/fuzz_input.h"
#include "tools/sightline/bake/checkpoint.h"

using namespace sightline;
using namespace sightline::fuzz;

namespace {

constexpr std::uint64_t kPlan = 0x0123456789abcdef;

Result<tool::KeptParts> resumed(const std::string& file) {
  Result<tool::Checkpoint> checkpoint = tool::Checkpoint::open(file, tool::CheckpointUse::kResume);
  return checkpoint ? checkpoint->begin(kPlan) : Result<tool::KeptParts>(checkpoint.error());
}

void readAsItIs(std::string_view bytes) {
  const std::string file = folder().write("fuzz.parts", bytes);
  const Result<tool::KeptParts> kept = resumed(file);
  if (!kept) {
    requireOneLine(kept.error());
    return;
  }
  std::size_t size = 0;
  for (const auto& [part, record] : kept->parts) {
    size += record.size();
  }
  require(size <= bytes.size());
  // The file was mended.
  const Result<tool::KeptParts> again = resumed(file);
  require(again && again->parts == kept->parts && tool::lossText(file, *again).empty());
}

// What was appended and not cut off comes back.
void readWhatWasWritten(std::string_view text) {
  const std::size_t cut = takeByte(text);
  const std::string file = folder().file("written.parts");
  std::filesystem::remove(file);
  std::vector<std::vector<std::byte>> written;
  {
    Result<tool::Checkpoint> checkpoint = tool::Checkpoint::open(file, tool::CheckpointUse::kNew);
    require(checkpoint && checkpoint->begin(kPlan));
    while (!text.empty() && written.size() < 5) {
      const std::size_t size = std::min<std::size_t>(takeByte(text), text.size());
      const std::span<const std::byte> part = bytesOf(text.substr(0, size));
      text.remove_prefix(size);
      require(checkpoint->append(written.size(), {part.begin(), part.end()}).has_value());
      written.emplace_back(part.begin(), part.end());
    }
  }
  const auto whole = std::filesystem::file_size(file);
  std::filesystem::resize_file(file, whole - std::min<std::uintmax_t>(cut, whole));
  const Result<tool::KeptParts> kept = resumed(file);
  require(kept && !kept->damaged && (cut > 0 || kept->parts.size() == written.size()));
  for (const auto& [part, record] : kept->parts) {
    require(part < written.size() && record == written[part]);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  readAsItIs(textOf(data, size));
  readWhatWasWritten(textOf(data, size));
  return 0;
}
