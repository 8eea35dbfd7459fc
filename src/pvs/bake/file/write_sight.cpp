#include "sightline/pvs/bake/write_sight.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "src/pvs/bake/file/encode_sight.h"

namespace sightline {
namespace {

Error failed(const std::string& file, int reason) {
  return Error{file + " cannot be written: " + std::strerror(reason)};
}

// A temporary file beside the target. The destructor deletes it unless it was renamed to the target.
class Unfinished {
 public:
  explicit Unfinished(const std::string& file) {
    // The name has a number, because another program may be writing the same file, and interrupted ones leave
    // theirs.
    for (int i = 0; i < 100 && number_ < 0; ++i) {
      name_ = file + "." + std::to_string(::getpid()) + "." + std::to_string(i) + ".unfinished";
      number_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (number_ < 0 && errno != EEXIST) {
        break;
      }
    }
    error_ = number_ < 0 ? errno : 0;
  }
  ~Unfinished() {
    if (number_ >= 0) {
      ::close(number_);
      ::unlink(name_.c_str());
    }
  }
  Unfinished(const Unfinished&) = delete;
  Unfinished& operator=(const Unfinished&) = delete;

  // The functions below return 0 or an errno, and do nothing after an error.
  int write(std::span<const std::byte> bytes) {
    while (error_ == 0 && !bytes.empty()) {
      constexpr std::size_t kMaxAtOnce = 1u << 30;
      const ssize_t written = ::write(number_, bytes.data(), std::min(bytes.size(), kMaxAtOnce));
      if (written >= 0) {
        bytes = bytes.subspan(static_cast<std::size_t>(written));
      } else if (errno != EINTR) {
        error_ = errno;
      }
    }
    return error_;
  }
  // The bytes are flushed to disk before the rename; otherwise a crash could leave a truncated file with the
  // final name.
  int finishAs(const std::string& file) {
    if (error_ == 0) {
      check(::fsync(number_));
    }
    if (error_ == 0) {
      check(std::rename(name_.c_str(), file.c_str()));
    }
    if (error_ == 0) {
      check(::close(number_));
      number_ = -1;
    }
    return error_;
  }

 private:
  void check(int result) {
    if (error_ == 0 && result != 0) {
      error_ = errno;
    }
  }

  std::string name_;
  int number_ = -1;
  int error_ = 0;
};

// Flushes the folder, so that the name survives a crash. Errors are ignored because the file already exists.
void flushFolderOf(const std::string& file) {
  const std::string folder = std::filesystem::path(file).parent_path().string();
  const int number = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (number >= 0) {
    ::fsync(number);
    ::close(number);
  }
}

}  // namespace

Status writeSight(const std::string& file, const BakedVisibility& baked) {
  const Result<pvs::SightBytes> bytes = pvs::encodeSight(baked);
  if (!bytes) {
    return Error{file + " cannot be written: " + bytes.error().message};
  }
  Unfinished unfinished(file);
  unfinished.write(bytes->structure);
  unfinished.write(bytes->payload);
  if (const int error = unfinished.finishAs(file); error != 0) {
    return failed(file, error);
  }
  flushFolderOf(file);
  return Success{};
}

}  // namespace sightline
