#include "sightline/io/file.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "src/io/failure.h"

namespace sightline {

using namespace io;

namespace fs = std::filesystem;

Result<std::string> readFile(const std::string& file) {
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  if (!fs::exists(status)) {
    return failure("{}: no such file", file);
  }
  if (fs::is_directory(status)) {
    return failure("{}: is a directory, not a file", file);
  }
  if (!fs::is_regular_file(status)) {
    return failure("{}: is not a regular file", file);
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) {
    return failure("{}: cannot be opened for reading: {}", file, std::strerror(errno));
  }
  const std::uintmax_t size = fs::file_size(file, code);
  if (code) {
    return failure("{}: its size cannot be read: {}", file, code.message());
  }
  std::string bytes;
  try {
    bytes.resize(size);
  } catch (const std::exception&) {
    return failure("{}: {} bytes do not fit into memory", file, size);
  }
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size) {
    return failure("{}: ended after {} of {} bytes while it was read", file, stream.gcount(), size);
  }
  return bytes;
}

Status writeFile(const std::string& file, std::string_view bytes) {
  return writeFile(file, std::span(&bytes, 1));
}

Status writeFile(const std::string& file, std::span<const std::string_view> pieces) {
  std::error_code code;
  const fs::file_status status = fs::status(file, code);
  // A device or a pipe is written to, not replaced.
  const bool in_place = fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
  const std::string unfinished = in_place ? file : fmt::format("{}.{}.unfinished", file, ::getpid());
  {
    std::ofstream stream(unfinished, std::ios::binary | std::ios::trunc);
    if (!stream) {
      return failure("{}: cannot be written: {}", file, std::strerror(errno));
    }
    for (const std::string_view bytes : pieces) {
      stream.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }
    stream.close();
    if (!stream) {
      const std::string reason = std::strerror(errno);
      if (!in_place) {
        fs::remove(unfinished, code);
      }
      return failure("{}: could not be written completely: {}", file, reason);
    }
  }
  if (in_place) {
    return Success{};
  }
  fs::rename(unfinished, file, code);
  if (code) {
    std::error_code ignored;
    fs::remove(unfinished, ignored);
    return failure("{}: cannot be written: {}", file, code.message());
  }
  return Success{};
}

}  // namespace sightline
