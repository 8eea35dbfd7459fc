// Feeds bytes to the reader of an unfinished bake's parts. A record counts only with its checksum, so the
// bytes are tried as they are, and as the parts of a file that is cut off somewhere.

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "fuzz/readers/fuzz_input.h"
#include "tools/sightline/bake/checkpoint.h"

using namespace sightline;
using namespace sightline::fuzz;

namespace {

constexpr std::uint64_t kPlan = 0x0123456789abcdef;

// What a checkpoint has, with the bytes of its parts.
struct Resumed {
  tool::KeptParts kept;
  BakedParts parts;
};

Result<Resumed> resumed(const std::string& file) {
  Result<tool::Checkpoint> checkpoint = tool::Checkpoint::open(file, tool::CheckpointUse::kResume);
  if (!checkpoint) {
    return checkpoint.error();
  }
  const Result<tool::KeptParts> kept = checkpoint->begin(kPlan);
  if (!kept) {
    return kept.error();
  }
  Resumed found{*kept, {}};
  for (const std::uint64_t part : kept->parts) {
    std::optional<BakedPart> bytes = checkpoint->read(part);
    require(bytes.has_value());
    found.parts.emplace(part, std::move(*bytes));
  }
  return found;
}

void readAsItIs(std::string_view bytes) {
  const std::string file = folder().write("fuzz.parts", bytes);
  const Result<Resumed> found = resumed(file);
  if (!found) {
    requireOneLine(found.error());
    return;
  }
  std::size_t size = 0;
  for (const auto& [part, record] : found->parts) {
    size += record.size();
  }
  require(size <= bytes.size());
  // The file was mended.
  const Result<Resumed> again = resumed(file);
  require(again && again->parts == found->parts && tool::lossText(file, again->kept).empty());
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
  const Result<Resumed> found = resumed(file);
  require(found && !found->kept.damaged && (cut > 0 || found->parts.size() == written.size()));
  for (const auto& [part, record] : found->parts) {
    require(part < written.size() && record == written[part]);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  readAsItIs(textOf(data, size));
  readWhatWasWritten(textOf(data, size));
  return 0;
}
