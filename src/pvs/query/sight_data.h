#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightline/pvs/query/sight_file.h"
#include "src/pvs/format/sight_view.h"
#include "src/pvs/query/mapped_file.h"

namespace sightline {

struct SightFile::Data {
  std::string name;  // for errors, a single line
  pvs::MappedFile mapped;
  std::vector<std::uint64_t> copied;  // a copy of bytes from memory that were not aligned
  std::span<const std::byte> bytes;   // of the mapped file, of `copied`, or the caller's
  BakeRecord record;
  pvs::SightView view;  // view of `bytes`
};

}  // namespace sightline
