#pragma once

// What the targets have in common: checks, bytes to take numbers from, and files for readers that read files.

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include "sightline/base/result.h"

namespace sightline::fuzz {

inline void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

inline void requireOneLine(const Error& error) {
  require(!error.message.empty() && error.message.find('\n') == std::string::npos);
}

inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

inline std::span<const std::byte> bytesOf(std::string_view text) {
  return std::as_bytes(std::span(text));
}

// Takes a byte off the front; 0 if there is none.
inline std::uint8_t takeByte(std::string_view& text) {
  const std::uint8_t byte = text.empty() ? 0 : static_cast<std::uint8_t>(text.front());
  text.remove_prefix(text.empty() ? 0 : 1);
  return byte;
}

// A folder in memory, if there is such a place; removed at the end of the process.
class Folder {
 public:
  Folder() {
    std::error_code ignored;
    const std::filesystem::path memory("/dev/shm");
    const bool usable = std::filesystem::is_directory(memory, ignored) && ::access("/dev/shm", W_OK) == 0;
    std::string name =
        ((usable ? memory : std::filesystem::temp_directory_path()) / "sightline-fuzz-XXXXXX").string();
    path_ = ::mkdtemp(name.data());
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path() const { return path_.string(); }
  std::string file(const std::string& name) const { return (path_ / name).string(); }
  std::string write(const std::string& name, std::string_view bytes) const {
    std::ofstream stream(file(name), std::ios::binary | std::ios::trunc);
    stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return file(name);
  }

 private:
  std::filesystem::path path_;
};

inline const Folder& folder() {
  static const Folder kFolder;
  return kFolder;
}

}  // namespace sightline::fuzz
