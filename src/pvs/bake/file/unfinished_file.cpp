#include "src/pvs/bake/file/unfinished_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>

#include "src/base/new_file.h"

namespace sightline::pvs {
namespace {

constexpr std::size_t kMaxAtOnce = 1u << 30;  // bytes of one call of the system

// Errors are ignored because the file already exists.
void flushFolderOf(const std::string& file) {
  const std::string folder = std::filesystem::path(file).parent_path().string();
  const int number = ::open(folder.empty() ? "." : folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (number >= 0) {
    ::fsync(number);
    ::close(number);
  }
}

}  // namespace

UnfinishedFile::UnfinishedFile(const std::string& target) : target_(target) {
  number_ = base::openNewFileBeside(target, name_);
  check(number_ >= 0);
}

UnfinishedFile::~UnfinishedFile() {
  if (number_ >= 0) {
    makeNameless();
    ::close(number_);
  }
}

void UnfinishedFile::makeNameless() {
  if (number_ >= 0 && !name_.empty()) {
    ::unlink(name_.c_str());
    name_.clear();
  }
}

bool UnfinishedFile::write(std::span<const std::byte> bytes) {
  if (error_ == 0) {
    check(base::writeAll(number_, bytes));
  }
  return error_ == 0;
}

bool UnfinishedFile::read(std::uint64_t offset, std::span<std::byte> bytes) {
  while (error_ == 0 && !bytes.empty()) {
    const ssize_t read =
        ::pread(number_, bytes.data(), std::min(bytes.size(), kMaxAtOnce), static_cast<off_t>(offset));
    check(read >= 0 || errno == EINTR);
    if (read == 0) {
      error_ = EIO;
    }
    const auto count = static_cast<std::size_t>(std::max<ssize_t>(read, 0));
    bytes = bytes.subspan(count);
    offset += count;
  }
  return error_ == 0;
}

void UnfinishedFile::dropFirst(std::uint64_t bytes) {
#ifdef FALLOC_FL_PUNCH_HOLE
  if (error_ == 0 && bytes > 0) {
    static_cast<void>(
        ::fallocate(number_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, 0, static_cast<off_t>(bytes)));
  }
#else
  static_cast<void>(bytes);
#endif
}

bool UnfinishedFile::finish() {
  if (error_ == 0) {
    check(::fsync(number_) == 0);
  }
  if (error_ == 0) {
    check(std::rename(name_.c_str(), target_.c_str()) == 0);
  }
  if (error_ == 0) {
    name_.clear();
    check(::close(number_) == 0);
    number_ = -1;
    flushFolderOf(target_);
  }
  return error_ == 0;
}

Status UnfinishedFile::status() const {
  return error_ == 0 ? Status(Success{})
                     : Status(Error{target_ + " cannot be written: " + std::strerror(error_)});
}

void UnfinishedFile::check(bool succeeded) {
  if (error_ == 0 && !succeeded) {
    error_ = errno;
  }
}

}  // namespace sightline::pvs
