#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "sightline/base/result.h"

namespace sightline::pvs {

// A memory-mapped file; its pages are read on demand.
class MappedFile {
 public:
  // Whether someone may write to the pages. A page that is written to is copied first, so the file stays as
  // it is. Some systems count all pages that may be copied as memory in use, and refuse a file larger than
  // that.
  enum class Pages : std::uint8_t { kReadOnly, kCopiedWhenWritten };

  MappedFile() = default;
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;

  // Errors do not contain the file's name.
  static Result<MappedFile> open(const std::string& file, Pages pages);

  std::span<const std::byte> bytes() const { return {begin_, size_}; }
  // Gives the memory of these bytes of the file back; they are read from the disk again when they are asked
  // for. Nobody may have written to them.
  void release(std::span<const std::byte> part) const;

 private:
  const std::byte* begin_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace sightline::pvs
