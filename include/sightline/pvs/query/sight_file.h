#pragma once

// A .sight file, opened by memory map and verified: whatever its bytes are, reading it is safe.

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

// Does not change: any number of threads may read it. Copies share one memory.
class SightFile {
 public:
  // Errors name the file and say what is wrong: not such a file, another version, truncated, altered.
  // Verified when opened: the structure and the checksum of all that is read in place (hierarchy, octree,
  // the index of sets). Compressed chunks are verified when they are decoded. The file is read as it is used:
  // it must not be changed while it is open, but another one may be renamed over it, as writeSight does.
  static Result<SightFile> open(const std::string& file);
  // The same of bytes in memory, which must outlive it; name: for errors. Bytes that do not start at a
  // multiple of eight are copied.
  static Result<SightFile> fromBytes(std::span<const std::byte> bytes, const std::string& name);

  const SceneId& scene() const;
  const BakeRecord& record() const;
  BoxTreeView boxes() const;
  OctreeView octree() const;
  std::uint32_t setCount() const;

  // Success where the file was baked from this scene. The objects of boxes() are then those of the scene,
  // each once.
  Status matches(const SceneId& scene) const;

  // Decodes a set: appends the nodes. set < setCount(). An error where the chunk is broken. For many sets in
  // a row SetQuery is faster.
  Status readSet(std::uint32_t set, std::vector<std::uint32_t>& nodes) const;
  // Calls visit(set, nodes) for all of them, ascending, each chunk decoded once; ends at the first broken
  // one.
  Status forEachSet(const std::function<void(std::uint32_t, std::span<const std::uint32_t>)>& visit) const;
  // Decodes all chunks, as a check.
  Status verifyAll() const;

  // Names of the occluder databases in it, and what they were saved as.
  std::vector<std::string> databaseNames() const;
  Result<DatabaseBlob> readDatabase(const std::string& name) const;

  struct Section {
    std::string name{};
    std::uint64_t bytes = 0;      // in the file
    std::uint64_t raw_bytes = 0;  // before compression
  };
  std::vector<Section> sections() const;  // they make up the file, but for some hundred bytes
  std::uint64_t fileBytes() const;

 private:
  friend class SetQuery;
  struct Data;
  explicit SightFile(std::shared_ptr<const Data> data);
  static Result<SightFile> read(std::shared_ptr<Data> data);

  std::shared_ptr<const Data> data_;
};

}  // namespace sightline
