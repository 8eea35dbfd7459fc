#include "sightline/io/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "src/base/new_file.h"
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
  std::string name = file;
  const int number =
      in_place ? ::open(file.c_str(), O_WRONLY | O_CLOEXEC) : base::openNewFileBeside(file, name);
  if (number < 0) {
    return failure("{}: cannot be written: {}", file, std::strerror(errno));
  }
  const bool written = std::ranges::all_of(pieces, [number](std::string_view bytes) {
    return base::writeAll(number, std::as_bytes(std::span(bytes)));
  });
  const int write_error = written ? 0 : errno;
  const int error = ::close(number) == 0 || write_error != 0 ? write_error : errno;
  if (error != 0) {
    if (!in_place) {
      fs::remove(name, code);
    }
    return failure("{}: could not be written completely: {}", file, std::strerror(error));
  }
  if (in_place) {
    return Success{};
  }
  fs::rename(name, file, code);
  if (code) {
    std::error_code ignored;
    fs::remove(name, ignored);
    return failure("{}: cannot be written: {}", file, code.message());
  }
  return Success{};
}

}  // namespace sightline
