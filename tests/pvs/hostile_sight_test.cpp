// Files with correct checksums and invalid contents.

#include <gtest/gtest.h>
#include <zstd.h>

#include <functional>

#include "src/pvs/format/set_code.h"
#include "tests/pvs/sight_checks.h"

namespace sightline::sight_test {
namespace {

using namespace pvs;

// A file in parts, which tests alter before assembling them.
struct Parts {
  BakedVisibility baked = made::visibility(
      {.objects = 400, .leaves = 30, .sets = 90, .set_nodes = 150, .database_bytes = {2'200'000, 10}});
  pvs::EncodedChunks encoded = pvs::encodeChunks(baked);

  Bytes bytes() const {
    const Result<Bytes> structure = structureBytes(pvs::viewOf(baked, encoded));
    EXPECT_TRUE(structure);
    return structure ? SightBytes{*structure, encoded.payload}.joined() : Bytes{};
  }
  // Replaces the frame of a chunk and moves the chunks behind it.
  void setFrame(std::size_t chunk, const Bytes& frame) {
    Chunk& changed = encoded.chunks[chunk];
    const auto begin = encoded.payload.begin() + static_cast<std::ptrdiff_t>(changed.offset);
    encoded.payload.erase(begin, begin + changed.bytes);
    encoded.payload.insert(encoded.payload.begin() + static_cast<std::ptrdiff_t>(changed.offset),
                           frame.begin(), frame.end());
    changed.bytes = static_cast<std::uint32_t>(frame.size());
    for (std::size_t i = chunk + 1; i < encoded.chunks.size(); ++i) {
      encoded.chunks[i].offset = encoded.chunks[i - 1].offset + encoded.chunks[i - 1].bytes;
    }
  }
};

const Parts& soundParts() {
  static const Parts parts;
  return parts;
}

Bytes frameOf(std::size_t size, std::byte value) {
  const Bytes raw(size, value);
  Bytes frame(ZSTD_compressBound(size));
  frame.resize(ZSTD_compress(frame.data(), frame.size(), raw.data(), raw.size(), 1));
  return frame;
}

TEST(HostileSight, StartsFromASoundFile) {
  const Parts& parts = soundParts();
  ASSERT_GT(parts.encoded.set_chunks, 2u);
  const Bytes bytes = parts.bytes();
  const Result<SightFile> file = opened(bytes);
  ASSERT_TRUE(file) << errorOf(file);
  EXPECT_TRUE(file->verifyAll());
}

TEST(HostileSight, IsRefusedWhenItsPartsDoNotFit) {
  const std::vector<std::pair<const char*, std::function<void(Parts&)>>> damages{
      {"hierarchy", [](Parts& p) { p.baked.boxes.nodes[3].end = 2; }},
      {"objects", [](Parts& p) { p.baked.boxes.objects[3] = p.baked.boxes.objects[4]; }},
      {"number of objects", [](Parts& p) { ++p.baked.scene.objects; }},
      {"octree", [](Parts& p) { p.baked.octree.nodes[0] = 0; }},
      {"set of a cell", [](Parts& p) { p.baked.octree.leaves[1].set = 90; }},
      {"near distance", [](Parts& p) { p.baked.record.near_distance = -1.0; }},
      {"near distance, no number", [](Parts& p) { p.baked.record.near_distance = std::nan(""); }},
      {"chunks that overlap", [](Parts& p) { p.encoded.chunks[1].offset = 0; }},
      {"chunk beyond the payload", [](Parts& p) { p.encoded.chunks.back().bytes += 1; }},
      {"offset beyond the payload", [](Parts& p) { p.encoded.chunks[1].offset = ~std::uint64_t{0}; }},
      {"chunk without bytes", [](Parts& p) { p.encoded.chunks[0].bytes = 0; }},
      {"payload that nobody has", [](Parts& p) { p.encoded.payload.push_back({}); }},
      {"more chunks of sets than chunks", [](Parts& p) { p.encoded.set_chunks = 1000; }},
      {"chunk that holds no set", [](Parts& p) { ++p.encoded.set_chunks; }},
      {"set in a database's chunk", [](Parts& p) { --p.encoded.set_chunks; }},
      {"set in no chunk", [](Parts& p) { p.encoded.sets.back().chunk = 77; }},
      {"set in an earlier chunk",
       [](Parts& p) {
         p.encoded.sets.back() = {0, 0};
       }},
      {"first set that begins late", [](Parts& p) { p.encoded.sets[0].offset = 1; }},
      {"sets at one place", [](Parts& p) { p.encoded.sets[2].offset = p.encoded.sets[1].offset; }},
      {"set beyond its chunk", [](Parts& p) { p.encoded.sets.back().offset = 1u << 30; }},
      {"chunk of several sets that claims much", [](Parts& p) { p.encoded.chunks[0].raw_bytes = 70'000; }},
      {"chunk of sets that claims 4 GiB", [](Parts& p) { p.encoded.chunks[0].raw_bytes = 0xffffffffu; }},
      {"database's chunk that claims much",
       [](Parts& p) {
         p.encoded.chunks.back().raw_bytes = 0x7fffffffu, p.encoded.databases[1].raw_bytes = 0x7fffffffu;
       }},
      {"database that claims much", [](Parts& p) { p.encoded.databases[0].raw_bytes = ~std::uint64_t{0}; }},
      {"database without its chunks", [](Parts& p) { p.encoded.databases[1].first_chunk = 0; }},
      {"database with more chunks than there are",
       [](Parts& p) { p.encoded.databases[1].chunk_count = 0xffffffffu; }},
      {"two databases of one name",
       [](Parts& p) { p.encoded.databases[1].name = p.encoded.databases[0].name; }},
      {"too many databases", [](Parts& p) {
         for (int i = 0; i < 200; ++i) {
           p.encoded.databases.push_back({"x", 0, 0, static_cast<std::uint32_t>(p.encoded.chunks.size()), 0});
         }
       }}};
  for (const auto& [what, apply] : damages) {
    Parts parts = soundParts();
    apply(parts);
    const Bytes bytes = parts.bytes();
    const Result<SightFile> file = opened(bytes);
    EXPECT_FALSE(file) << what;
    EXPECT_TRUE(oneLine(errorOf(file))) << what;
    EXPECT_NE(errorOf(file).find("bake it again"), std::string::npos) << errorOf(file);
  }
}

TEST(HostileSight, IsRefusedWhenItsDoorsDoNotFit) {
  Parts sound = soundParts();
  BakedDoors& doors = sound.baked.doors;
  doors.doors = {ObjectId(3u), ObjectId(5u), ObjectId(3u), ObjectId(5u)};
  doors.group_ends = {1, 2, 4};
  doors.hidden = {{0, 7}, {2, 8}};
  doors.hidden_ends.assign(sound.baked.sets.count(), 2);
  const Bytes sound_bytes = sound.bytes();
  ASSERT_TRUE(opened(sound_bytes)) << errorOf(opened(sound_bytes));
  const std::vector<std::pair<const char*, std::function<void(BakedDoors&)>>> damages{
      {"a group without doors",
       [](BakedDoors& d) {
         d.group_ends = {1, 1, 4};
       }},
      {"a first group without doors",
       [](BakedDoors& d) {
         d.group_ends = {0, 1, 4};
       }},
      {"groups that overlap",
       [](BakedDoors& d) {
         d.group_ends = {2, 1, 4};
       }},
      {"a group beyond the doors", [](BakedDoors& d) { d.group_ends.back() = 5; }},
      {"doors of no group", [](BakedDoors& d) { d.group_ends.back() = 3; }},
      {"doors that are not in order", [](BakedDoors& d) { std::swap(d.doors[2], d.doors[3]); }},
      {"a door that is no object", [](BakedDoors& d) { d.doors[3] = ObjectId(400u); }},
      {"what a group hides twice", [](BakedDoors& d) { d.hidden[1].group = 0; }},
      {"what no group hides", [](BakedDoors& d) { d.hidden[1].group = 3; }},
      {"a hidden set that is not there", [](BakedDoors& d) { d.hidden[0].hidden = 90; }},
      {"too few sets", [](BakedDoors& d) { d.hidden_ends.pop_back(); }},
      {"sets that overlap", [](BakedDoors& d) { d.hidden_ends[4] = 1; }},
      {"a set beyond what is hidden", [](BakedDoors& d) { d.hidden_ends.back() = 3; }},
      {"no doors, but what they hide", [](BakedDoors& d) { d.doors.clear(), d.group_ends.clear(); }},
      {"doors without what they hide", [](BakedDoors& d) { d.hidden.clear(), d.hidden_ends.clear(); }}};
  for (const auto& [what, apply] : damages) {
    Parts parts = sound;
    apply(parts.baked.doors);
    const Bytes bytes = parts.bytes();
    const Result<SightFile> file = opened(bytes);
    EXPECT_FALSE(file) << what;
    EXPECT_TRUE(oneLine(errorOf(file))) << what;
    EXPECT_NE(errorOf(file).find("bake it again"), std::string::npos) << errorOf(file);
  }
}

TEST(HostileSight, GivesAnErrorForTheSetsOfABrokenChunk) {
  const std::vector<std::pair<const char*, std::function<Bytes(std::uint32_t)>>> frames{
      {"not a frame", [](std::uint32_t) { return Bytes(20, std::byte{1}); }},
      {"zeros", [](std::uint32_t size) { return frameOf(size, std::byte{0}); }},
      {"nodes without end", [](std::uint32_t size) { return frameOf(size, std::byte{0xff}); }},
      {"one byte more", [](std::uint32_t size) { return frameOf(size + 1, std::byte{0}); }},
      {"one byte less", [](std::uint32_t size) { return frameOf(size - 1, std::byte{0}); }},
      {"a gigabyte", [](std::uint32_t) { return frameOf(100'000'000, std::byte{0}); }},
      {"nothing", [](std::uint32_t) { return frameOf(0, std::byte{0}); }}};
  for (const auto& [what, frame] : frames) {
    Parts parts = soundParts();
    parts.setFrame(1, frame(parts.encoded.chunks[1].raw_bytes));
    const Bytes bytes = parts.bytes();
    const Result<SightFile> file = opened(bytes);
    ASSERT_TRUE(file) << what << errorOf(file);
    EXPECT_TRUE(oneLine(errorOf(file->verifyAll()))) << what;
    for (std::uint32_t set = 0; set < file->setCount(); ++set) {
      std::vector<std::uint32_t> nodes;
      const bool broken = parts.encoded.sets[set].chunk == 1;
      EXPECT_EQ(errorOf(file->readSet(set, nodes)).empty(), !broken) << what << ", set " << set;
      EXPECT_EQ(nodes.size(), broken ? 0u : parts.baked.sets[set].size());
    }
  }
}

TEST(HostileSight, GivesAnErrorForADatabaseOfABrokenChunk) {
  Parts parts = soundParts();
  parts.setFrame(parts.encoded.databases[0].first_chunk + 1, frameOf(1u << 20, std::byte{0}));
  Bytes bytes = parts.bytes();
  // A valid chunk: nothing checks the contents of a database here.
  EXPECT_TRUE(opened(bytes)->readDatabase("database-0"));
  parts.setFrame(parts.encoded.databases[0].first_chunk + 1, frameOf(50'000'000, std::byte{0}));
  bytes = parts.bytes();
  const Result<SightFile> file = opened(bytes);
  ASSERT_TRUE(file);
  const Result<DatabaseBlob> broken = file->readDatabase("database-0");
  ASSERT_FALSE(broken);
  EXPECT_TRUE(oneLine(broken.error().message));
  EXPECT_TRUE(file->readDatabase("database-1"));
}

TEST(HostileSight, SealingIsSafeForAnyBytes) {
  const Bytes sound = bytesOf(made::visibility({.objects = 5, .leaves = 8, .sets = 3, .database_bytes = {}}));
  made::Random random(9);
  for (int i = 0; i < 20'000; ++i) {
    Bytes bytes = sound;
    bytes.resize(random() % 4 == 0 ? random() % (sound.size() + 1) : sound.size());
    for (std::uint32_t count = random() % 5; count > 0 && !bytes.empty(); --count) {
      bytes[random() % bytes.size()] = static_cast<std::byte>(random() % 256);
    }
    seal(bytes);
  }
  Bytes bytes = sound;
  seal(bytes);
  EXPECT_EQ(bytes, sound);
}

}  // namespace
}  // namespace sightline::sight_test
