#pragma once

// Shared by the tests of .sight files.

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "sightline/pvs/query/set_query.h"
#include "sightline/pvs/query/sight_file.h"
#include "src/pvs/bake/file/encode_sight.h"
#include "tests/support/made_visibility.h"

namespace sightline::sight_test {

using Bytes = std::vector<std::byte>;

inline Bytes bytesOf(const BakedVisibility& baked) {
  const Result<pvs::SightBytes> bytes = pvs::encodeSight(baked);
  EXPECT_TRUE(bytes) << bytes.error().message;
  return bytes ? bytes->joined() : Bytes{};
}

inline Result<SightFile> opened(std::span<const std::byte> bytes) {
  return SightFile::fromBytes(bytes, "made.sight");
}

// What a look-up returned, as flags by object.
inline std::vector<bool> membersOf(const BoxTreeView& boxes, const VisibleSet& found) {
  std::vector<bool> members(boxes.objects.size(), false);
  for (const std::uint32_t node : found.nodes) {
    for (const ObjectId object : boxes.objectsBelow(node)) {
      members[object.value] = true;
    }
  }
  return members;
}
inline std::vector<bool> seenBy(SetQuery& query, const Vec3d& eye, double near_distance) {
  return membersOf(query.boxes(), query.find(eye, near_distance));
}

inline bool oneLine(const std::string& text) {
  return !text.empty() && text.find('\n') == std::string::npos;
}

// The error's message; empty for success.
inline std::string errorOf(const Status& status) {
  return status ? "" : status.error().message;
}
inline std::string errorOf(const Result<SightFile>& file) {
  return file ? "" : file.error().message;
}

template <typename T>
bool sameBytes(std::span<const T> a, std::span<const T> b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
}

inline bool sameTree(const BoxTreeView& a, const BoxTreeView& b) {
  return sameBytes(a.nodes, b.nodes) && sameBytes(a.objects, b.objects);
}

inline bool sameOctree(const OctreeView& a, const OctreeView& b) {
  return a.min == b.min && a.max == b.max && sameBytes(a.nodes, b.nodes) && sameBytes(a.leaves, b.leaves) &&
         sameBytes(a.depths, b.depths) && sameBytes(a.reasons, b.reasons) && sameBytes(a.planes, b.planes) &&
         sameBytes(a.viewers, b.viewers);
}

}  // namespace sightline::sight_test
