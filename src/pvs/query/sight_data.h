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
  std::string name;  // for errors, one line
  pvs::MappedFile mapped;
  std::vector<std::uint64_t> copied;  // of bytes that came from elsewhere and were not aligned
  std::span<const std::byte> bytes;   // in one of these, or the caller's
  BakeRecord record;
  pvs::SightView view;  // of bytes
};

}  // namespace sightline
