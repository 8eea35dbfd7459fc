#pragma once

// Files that are made in one step: complete, or not there.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "sightline/base/result.h"

namespace sightline::pvs {

// A temporary file beside the target. The destructor deletes it unless it was renamed to the target. The
// first error is kept, and nothing is done after it.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::string& target);
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

  // Takes the name away, so that the file is gone when this object is, or the process.
  void makeNameless();
  // Appends. False after an error.
  bool write(std::span<const std::byte> bytes);
  // Reads what was written there. False after an error, and if there is less.
  bool read(std::uint64_t offset, std::span<std::byte> bytes);
  // Gives the space of the first bytes back to the disk where the file system can; they are not read again.
  void dropFirst(std::uint64_t bytes);
  // Writes everything to the disk and renames the file to the target; then flushes the folder, so that the
  // name survives a crash.
  bool finish();
  Status status() const;  // an error names the target

 private:
  void check(bool succeeded);  // keeps errno otherwise

  std::string target_, name_;
  int number_ = -1;
  int error_ = 0;
};

}  // namespace sightline::pvs
