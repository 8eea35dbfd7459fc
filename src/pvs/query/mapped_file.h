#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "sightline/base/result.h"

namespace sightline::pvs {

// A whole file as memory, read as it is used.
class MappedFile {
 public:
  MappedFile() = default;
  ~MappedFile();
  MappedFile(MappedFile&& other) noexcept;
  MappedFile& operator=(MappedFile&& other) noexcept;

  // Errors do not name the file.
  static Result<MappedFile> open(const std::string& file);

  std::span<const std::byte> bytes() const { return {begin_, size_}; }

 private:
  const std::byte* begin_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace sightline::pvs
