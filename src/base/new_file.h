#pragma once

// How io and pvs write files. It is a header alone, because the runtime, whose room this is, opens no files
// and does without POSIX.

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <span>
#include <string>

namespace sightline::base {

// Makes and opens a new file beside the target, for reading and writing; a file or link that is there is left
// alone. `name` becomes its name, which ends in a number, because another process, also one with the same id
// elsewhere, may be writing the same target, and interrupted ones leave theirs. Returns the descriptor, which
// the caller closes, or -1 with the reason in errno.
inline int openNewFileBeside(const std::string& target, std::string& name) {
  constexpr std::size_t kMaxLength = 200;                // bytes of a name; file systems allow 255
  constexpr int kMaxNumber = 1'000'000;                  // more than are ever left over
  const std::size_t name_begin = target.rfind('/') + 1;  // 0 if there is no slash
  // A name that is longer would leave no room for the numbers.
  const std::string begin =
      target.size() - name_begin > kMaxLength ? target.substr(0, name_begin) + "sightline" : target;
  int descriptor = -1;
  for (int i = 0; i < kMaxNumber && descriptor < 0 && (i == 0 || errno == EEXIST); ++i) {
    name = begin + "." + std::to_string(::getpid()) + "." + std::to_string(i) + ".unfinished";
    descriptor = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  }
  return descriptor;
}

// Writes all of the bytes, however many the system takes at once. Returns false with the reason in errno if
// it takes no more.
inline bool writeAll(int descriptor, std::span<const std::byte> bytes) {
  constexpr std::size_t kMaxAtOnce = 1u << 30;  // bytes of one call of the system
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), std::min(bytes.size(), kMaxAtOnce));
    if (written == 0) {
      errno = EIO;
    }
    if (written == 0 || (written < 0 && errno != EINTR)) {
      return false;
    }
    bytes = bytes.subspan(static_cast<std::size_t>(std::max<ssize_t>(written, 0)));
  }
  return true;
}

}  // namespace sightline::base
