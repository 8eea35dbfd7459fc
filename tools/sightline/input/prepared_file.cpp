// A file: surfaceBytes(), and behind them eight letters, the scene's id, the width of the
// cracks that were closed and a checksum of all before it.

#include "tools/sightline/input/prepared_file.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <span>
#include <string_view>

#include "sightline/io/file.h"
#include "tools/sightline/command_line/output_files.h"

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

namespace sightline::tool {
namespace {

struct Tail {
  char letters[8] = {'S', 'L', 'p', 'r', 'e', 'p', '0', '2'};
  SceneId scene{};
  std::uint64_t crack_width = 0;  // the bits of a double, metres
  std::uint64_t checksum = 0;
};
static_assert(std::has_unique_object_representations_v<Tail>);

constexpr std::string_view kBegin = "SLsurf";  // of surfaceBytes()

// Why the surfaces in the file cannot be used; empty if they can.
std::string read(std::string_view text, PreparedFile& file) {
  Tail tail;
  if (text.size() < sizeof(tail)) {
    return "it is cut off";
  }
  const std::span<const std::byte> bytes = std::as_bytes(std::span(text));
  std::memcpy(&tail, bytes.last(sizeof(tail)).data(), sizeof(tail));
  if (std::memcmp(tail.letters, Tail{}.letters, sizeof(tail.letters)) != 0) {
    return "it is cut off, or of another version";
  }
  if (tail.checksum != pvs::checksumOf(bytes.first(bytes.size() - sizeof(tail.checksum)))) {
    return "it is damaged";
  }
  if (tail.crack_width != std::bit_cast<std::uint64_t>(file.crack_width)) {
    return fmt::format("it is of --crack-width {}", std::bit_cast<double>(tail.crack_width));
  }
  if (tail.scene != file.scene) {
    return "it is of another scene";
  }
  Result<SurfaceSet> surfaces =
      surfacesFrom(bytes.first(bytes.size() - sizeof(tail)), static_cast<std::uint32_t>(file.scene.objects));
  if (!surfaces) {
    return surfaces.error().message;
  }
  file.surfaces = std::make_shared<SurfaceSet>(std::move(*surfaces));
  return "";
}

}  // namespace

Result<PreparedFile> openPrepared(const std::string& name, const SceneId& scene, double crack_width) {
  PreparedFile file{name, scene, crack_width};
  std::error_code ignored;
  if (name.empty() || !std::filesystem::exists(name, ignored)) {
    return file;
  }
  const Result<std::string> text = readFile(name);
  if (!text) {
    return Error{"--prepared " + text.error().message};
  }
  if (!text->empty() && !text->starts_with(kBegin)) {
    return Error{fmt::format("--prepared {}: is there and holds no surfaces; name another file", name)};
  }
  if (const std::string reason = read(*text, file); !reason.empty()) {
    fmt::print(stderr, "sightline: {} is written anew: {}\n", name, reason);
  }
  return file;
}

void keepPrepared(const PreparedFile& file, const SurfaceSet& surfaces) {
  LargeVector<std::byte> bytes = surfaceBytes(surfaces);
  const std::size_t size = bytes.size();
  Tail tail;
  tail.scene = file.scene;
  tail.crack_width = std::bit_cast<std::uint64_t>(file.crack_width);
  bytes.resize(size + sizeof(tail));
  std::memcpy(&bytes[size], &tail, sizeof(tail));
  tail.checksum = pvs::checksumOf(std::span(bytes).first(bytes.size() - sizeof(tail.checksum)));
  std::memcpy(&bytes[size], &tail, sizeof(tail));
  const Status kept = saveFile(file.name, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  if (!kept) {
    fmt::print(stderr, "sightline: the surfaces are not kept: {}\n", kept.error().message);
  }
}

}  // namespace sightline::tool
