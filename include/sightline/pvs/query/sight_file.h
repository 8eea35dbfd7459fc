#pragma once

// A .sight file, memory-mapped and verified: reading it is safe whatever its bytes are.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/hierarchy/box_tree.h"
#include "sightline/pvs/format/baked_visibility.h"

namespace sightline {

// Immutable: any number of threads may read it. Copies share the same memory.
class SightFile {
 public:
  // Opens and verifies a file: its structure and the checksum of everything that is read in place (hierarchy,
  // octree, index of sets). Compressed chunks are verified when they are decoded. Errors name the file and
  // say what is wrong: not a .sight file, another version, truncated, altered. The file is read while it is
  // used, so it must not be modified while it is open; another file may be renamed over it, as writeSight
  // does.
  static Result<SightFile> open(const std::string& file);
  // Does the same with bytes in memory, which must outlive the result. name: for errors. Bytes that do not
  // start at a multiple of eight are copied.
  static Result<SightFile> fromBytes(std::span<const std::byte> bytes, const std::string& name);

  const SceneId& scene() const;
  const BakeRecord& record() const;
  BoxTreeView boxes() const;
  OctreeView octree() const;
  std::uint32_t setCount() const;  // including the sets that doors hide
  // The objects that hide only while they are closed, and what they hide. Empty if there are none.
  DoorsView doors() const;

  // Success if the file was baked from this scene. boxes() then contains each object of the scene exactly
  // once.
  Result<void> matches(const SceneId& scene) const;

  // Decodes a set and appends its nodes. set < setCount(). Returns an error if the chunk is corrupt. SetQuery
  // is faster for many look-ups.
  Result<void> readSet(std::uint32_t set, std::vector<std::uint32_t>& nodes) const;
  // Calls visit(set, nodes) for all sets in ascending order, decoding each chunk once, and gives back
  // the memory of a mapped file behind it. Stops at the first corrupt chunk.
  Result<void> forEachSet(
      const std::function<void(std::uint32_t, std::span<const std::uint32_t>)>& visit) const;
  // Decodes all chunks, as a check.
  Result<void> verifyAll() const;

  // Names of the occluder databases in the file, and their saved bytes.
  std::vector<std::string> databaseNames() const;
  Result<DatabaseBlob> readDatabase(const std::string& name) const;

  struct Section {
    std::string name{};
    std::uint64_t bytes = 0;      // size in the file
    std::uint64_t raw_bytes = 0;  // size before compression
  };
  // All sections. They make up the file except for a few hundred bytes.
  std::vector<Section> sections() const;
  std::uint64_t fileBytes() const;

 private:
  friend class SetQuery;
  struct Data;
  explicit SightFile(std::shared_ptr<const Data> data);
  static Result<SightFile> read(std::shared_ptr<Data> data);

  std::shared_ptr<const Data> data_;
};

}  // namespace sightline
