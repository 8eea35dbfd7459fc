#include "tools/sightline/exact/exact_cache.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>

#include "sightline/io/file.h"
#include "tools/sightline/command_line/output_files.h"

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

namespace sightline::tool {

Result<ExactCache> ExactCache::open(const std::string& folder) {
  if (folder.empty()) {
    return ExactCache("");
  }
  if (const Status made = makeFolder(folder); !made) {
    return made.error();
  }
  if (::access(folder.c_str(), R_OK | W_OK | X_OK) != 0) {
    return Error{fmt::format("{}: cannot keep files in this folder; name another", folder)};
  }
  return ExactCache(folder);
}

std::string ExactCache::usualFolder() {
  const char* cache = std::getenv("XDG_CACHE_HOME");
  if (cache != nullptr && std::filesystem::path(cache).is_absolute()) {
    return (std::filesystem::path(cache) / "sightline").string();
  }
  const char* home = std::getenv("HOME");
  return home != nullptr && *home != '\0' ? (std::filesystem::path(home) / ".cache" / "sightline").string()
                                          : std::string();
}

std::string ExactCache::fileOf(const ExactKey& key) const {
  return fmt::format("{}/{:016x}.exact", folder_, pvs::checksumOf(key.bytes));
}

std::optional<ExactObjects> ExactCache::find(const ExactKey& key) const {
  if (folder_.empty()) {
    return {};
  }
  const Result<std::string> text = readFile(fileOf(key));
  return text ? exactFromBytes(key, *text) : std::optional<ExactObjects>();
}

Status ExactCache::keep(const ExactKey& key, const ExactObjects& frame) const {
  return folder_.empty() ? Status(Success{}) : saveFile(fileOf(key), exactBytes(key, frame));
}

}  // namespace sightline::tool
