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

Result<BakedParts> resumed(const std::string& file) {
  Result<tool::Checkpoint> checkpoint = tool::Checkpoint::open(file, tool::CheckpointUse::kResume);
  return checkpoint ? checkpoint->begin(kPlan) : Result<BakedParts>(checkpoint.error());
}

void readAsItIs(std::string_view bytes) {
  const Result<BakedParts> parts = resumed(folder().write("fuzz.parts", bytes));
  if (!parts) {
    requireOneLine(parts.error());
    return;
  }
  std::size_t size = 0;
  for (const auto& [part, record] : *parts) {
    size += record.size();
  }
  require(size <= bytes.size());
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
  const Result<BakedParts> parts = resumed(file);
  require(parts && (cut > 0 || parts->size() == written.size()));
  for (const auto& [part, record] : *parts) {
    require(part < written.size() && record == written[part]);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  readAsItIs(textOf(data, size));
  readWhatWasWritten(textOf(data, size));
  return 0;
}
