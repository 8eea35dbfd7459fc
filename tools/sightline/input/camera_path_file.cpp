#include "tools/sightline/input/camera_path_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "sightline/io/camera_path_json.h"
#include "sightline/io/file.h"
#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/suggest.h"

namespace sightline::tool {
namespace {

std::string describe(const UnknownKey& unknown) {
  const std::vector<std::string> known(unknown.known.begin(), unknown.known.end());
  std::string where;
  if (unknown.frame) {
    where = fmt::format("frame {}{}: ", *unknown.frame,
                        unknown.frames > 1 ? fmt::format(" (and {} more)", unknown.frames - 1) : "");
  }
  // Control characters would affect the terminal.
  std::string key = unknown.key;
  std::replace_if(
      key.begin(), key.end(), [](char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }, '?');
  return fmt::format("{}the key \"{}\" is not known and ignored{}", where, key,
                     didYouMean(unknown.key, known));
}

}  // namespace

Result<CameraPath> readCameraPathFile(const std::string& file) {
  const Result<std::string> text = readFile(file);
  return text ? parseCameraPathFile(*text, file) : Result<CameraPath>(text.error());
}

Result<CameraPath> parseCameraPathFile(std::string_view text, const std::string& file) {
  std::vector<UnknownKey> unknown_keys;
  Result<CameraPath> path = parseCameraPath(text, file, &unknown_keys);
  if (!path) {
    Error error = path.error();
    for (const UnknownKey& unknown : unknown_keys) {
      error.message += "; " + describe(unknown);
    }
    return error;
  }
  for (const UnknownKey& unknown : unknown_keys) {
    printNote("{}: {}", file, describe(unknown));
  }
  return path;
}

}  // namespace sightline::tool
