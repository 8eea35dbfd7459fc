#include "sightline/io/file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "src/io/failure.h"

namespace sightline {

using namespace io;

namespace fs = std::filesystem;

namespace {

constexpr std::size_t kMaxAtOnce = 1u << 30;  // bytes of one call of the system
constexpr std::size_t kMaxNameLength = 200;   // bytes; file systems allow 255

// Makes and opens a new file beside the target; a file or link of that name is left alone. Its name has a
// number because another process, also one with the same id elsewhere, may be writing the same target, and
// interrupted ones leave theirs. Returns -1 and sets errno if that fails.
int openBeside(const std::string& target, std::string& name) {
  const fs::path path = target;
  std::string begin = path.filename().string();
  if (begin.size() > kMaxNameLength) {
    begin = "sightline";  // a longer one would leave no room for the numbers
  }
  int number = -1;
  for (int i = 0; i < 100 && number < 0 && (i == 0 || errno == EEXIST); ++i) {
    name = (path.parent_path() / fmt::format("{}.{}.{}.unfinished", begin, ::getpid(), i)).string();
    number = ::open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  return number;
}

// Sets errno if it fails.
bool writePieces(int number, std::span<const std::string_view> pieces) {
  for (std::string_view bytes : pieces) {
    while (!bytes.empty()) {
      const ssize_t written = ::write(number, bytes.data(), std::min(bytes.size(), kMaxAtOnce));
      if (written < 0 && errno != EINTR) {
        return false;
      }
      bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
    }
  }
  return true;
}

}  // namespace

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
  const int number = in_place ? ::open(file.c_str(), O_WRONLY | O_CLOEXEC) : openBeside(file, name);
  if (number < 0) {
    return failure("{}: cannot be written: {}", file, std::strerror(errno));
  }
  const int write_error = writePieces(number, pieces) ? 0 : errno;
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
