// Feeds bytes to the reader of .sight files, which must open them or return an error, whatever they are.
// Everything that it then returns must be valid.
//
// Checksums would stop altered bytes before they reach most of the code. So bytes that begin like a .sight
// file are opened twice: unchanged, and with correct checksums, as a hostile file has them. All other bytes
// are used as a decompressed set, which no fuzzer would reach through the compression.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "sightline/pvs/query/set_query.h"
#include "sightline/pvs/query/sight_file.h"
#include "src/pvs/format/set_code.h"
#include "src/pvs/format/sight_view.h"

namespace {

using namespace sightline;
using Bytes = std::vector<std::byte>;

void require(bool condition) {
  if (!condition) {
    std::abort();
  }
}

void requireOneLine(const Error& error) {
  require(!error.message.empty() && error.message.find('\n') == std::string::npos);
}

void checkNodes(std::span<const std::uint32_t> nodes, const BoxTreeView& tree) {
  std::uint32_t next = 0;
  for (const std::uint32_t node : nodes) {
    require(node >= next && node < tree.nodes.size());
    next = tree.nodes[node].end;
  }
}

// Checks that every object is reached once through the leaves, and through the children of every node.
void checkTree(const BoxTreeView& tree) {
  std::size_t objects = 0;
  for (std::uint32_t node = 0; node < tree.nodes.size(); ++node) {
    for (const ObjectId object : tree.objectsBelow(node)) {
      require(object.value < tree.objects.size());
    }
    objects += tree.leaf(node) ? tree.nodes[node].object_count : 0;
    for (std::uint32_t child = node + 1; child < tree.nodes[node].end; child = tree.nodes[child].end) {
      require(tree.nodes[child].end > child && tree.nodes[child].end <= tree.nodes[node].end);
    }
    // Trees that consist of one long branch take quadratic time.
    if (node > 2000) {
      return;
    }
  }
  require(objects == tree.objects.size());
}

void checkOctree(const OctreeView& octree, std::uint32_t sets) {
  std::size_t leaves = 0;
  forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) {
    require(leaf < octree.leaves.size() && cell.level == octree.depths[leaf]);
    require(octree.leaves[leaf].set < sets && octree.reasons[leaf] < kStopReasons);
    ++leaves;
  });
  require(leaves == octree.leaves.size());
}

void checkSets(const SightFile& file) {
  for (std::uint32_t set = 0; set < std::min(file.setCount(), 200u); ++set) {
    std::vector<std::uint32_t> nodes;
    if (const Status read = file.readSet(set, nodes); read) {
      checkNodes(nodes, file.boxes());
    } else {
      requireOneLine(read.error());
      require(nodes.empty());
    }
  }
  if (const Status all = file.verifyAll(); !all) {
    requireOneLine(all.error());
  }
}

void checkQuery(const SightFile& file) {
  SetQuery query(file, {.cache_bytes = 1000});
  const OctreeView octree = file.octree();
  int rest = 50;
  forEachLeaf(octree, [&](std::uint32_t leaf, const OctreeCell& cell) {
    if (--rest < 0) {
      return;
    }
    const Vec3d min = cellMin(octree.min, octree.max, cell);
    const Vec3d max = cellMax(octree.min, octree.max, cell);
    for (const Vec3d& eye : {min, max, (min + max) * 0.5}) {
      checkNodes(query.find(eye, file.record().near_distance).nodes, file.boxes());
    }
    const CellPlace place = query.locate(min);
    // Cells may be too small for a number to exist between their borders.
    require(min.x == max.x || min.y == max.y || min.z == max.z || place.leaf == leaf);
  });
}

void checkDatabases(const SightFile& file) {
  for (const std::string& name : file.databaseNames()) {
    if (const Result<DatabaseBlob> database = file.readDatabase(name); !database) {
      requireOneLine(database.error());
    }
  }
}

void open(std::span<const std::byte> bytes) {
  const Result<SightFile> file = SightFile::fromBytes(bytes, "fuzz.sight");
  if (!file) {
    requireOneLine(file.error());
    return;
  }
  checkTree(file->boxes());
  checkOctree(file->octree(), file->setCount());
  // A few bytes may decompress to many; a slow input is not a finding.
  std::uint64_t raw_bytes = 0;
  for (const SightFile::Section& section : file->sections()) {
    raw_bytes += section.raw_bytes;
  }
  if (raw_bytes < 16u << 20) {
    checkSets(*file);
    checkQuery(*file);
    checkDatabases(*file);
  }
}

// A root with a hundred inner nodes of two leaves each.
std::vector<BoxNode> treeOfSets() {
  std::vector<BoxNode> tree(301);
  tree[0].end = 301;
  for (std::uint32_t node = 1; node < 301; ++node) {
    tree[node].end = node % 3 == 1 ? node + 3 : node + 1;
  }
  return tree;
}

void decode(std::span<const std::byte> bytes) {
  static const std::vector<BoxNode> tree = treeOfSets();
  static const std::vector<std::uint32_t> ends = pvs::endsOf(tree);
  std::vector<std::uint32_t> nodes;
  if (pvs::decodeSet(bytes, ends, nodes)) {
    checkNodes(nodes, {tree, {}});
  } else {
    require(nodes.empty());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  if (size < 8 || std::memcmp(data + 4, "SGHT", 4) != 0) {
    decode(bytes);
    return 0;
  }
  open(bytes);
  Bytes sealed(bytes.begin(), bytes.end());
  pvs::seal(sealed);
  open(sealed);
  return 0;
}
