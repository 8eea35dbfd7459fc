// A file of more than 4 GiB: its structure is small, and most of its payload is holes, which take no space on
// the disk. Two of its chunks are longer than their frames by such a hole. Their checksums do not hold, which
// nobody notices who does not decode them.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "sightline/pvs/query/set_query.h"
#include "tests/pvs/sight_checks.h"
#include "tests/support/temporary_folder.h"

namespace sightline::sight_test {
namespace {

using pvs::Chunk;

constexpr std::uint64_t kHole = 2'300'000'000u;  // bytes; two of them are more than 4 GiB

class LargeSight : public ::testing::Test {
 protected:
  void SetUp() override {
    pvs::EncodedChunks encoded = pvs::encodeChunks(baked_);
    ASSERT_GT(encoded.set_chunks, 3u);
    const std::vector<Chunk> small = encoded.chunks;
    std::uint64_t at = 0;
    for (std::size_t i = 0; i < encoded.chunks.size(); ++i) {
      Chunk& chunk = encoded.chunks[i];
      chunk.offset = at;
      chunk.bytes += i == 1 || i == 2 ? static_cast<std::uint32_t>(kHole) : 0;
      at += chunk.bytes;
    }
    for (std::size_t i = 0; i < encoded.chunks.size(); ++i) {
      const auto frame = std::span(encoded.payload).subspan(small[i].offset, small[i].bytes);
      pieces_.push_back({encoded.chunks[i].offset, {frame.begin(), frame.end()}});
    }
    pvs::SightView view = pvs::viewOf(baked_, encoded);
    view.payload = {};
    view.payload_elsewhere = at;
    const Result<Bytes> structure = pvs::structureBytes(view);
    ASSERT_TRUE(structure) << structure.error().message;
    structure_bytes_ = structure->size();
    write(0, *structure);
    for (const auto& [offset, bytes] : pieces_) {
      write(structure_bytes_ + offset, bytes);
    }
    std::filesystem::resize_file(name_, structure_bytes_ + at);
    chunks_ = encoded.chunks;
    places_ = encoded.sets;
    ASSERT_GT(chunks_.back().offset, std::uint64_t{1} << 32);
  }

  void write(std::uint64_t offset, std::span<const std::byte> bytes) {
    const int file = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    ASSERT_EQ(::pwrite(file, bytes.data(), bytes.size(), static_cast<off_t>(offset)),
              static_cast<ssize_t>(bytes.size()));
    ::close(file);
  }

  // How many bytes of the file are in memory.
  std::uint64_t bytesInMemory() const {
    const std::uint64_t size = std::filesystem::file_size(name_);
    const auto page = static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
    const int file = ::open(name_.c_str(), O_RDONLY | O_CLOEXEC);
    void* begin = ::mmap(nullptr, size, PROT_READ, MAP_SHARED, file, 0);
    ::close(file);
    std::vector<unsigned char> pages((size + page - 1) / page);
    EXPECT_EQ(::mincore(begin, size, pages.data()), 0);
    ::munmap(begin, size);
    return page * static_cast<std::uint64_t>(std::count_if(pages.begin(), pages.end(),
                                                           [](unsigned char p) { return (p & 1) != 0; }));
  }

  BakedVisibility baked_ = made::visibility(
      {.objects = 3000, .leaves = 200, .sets = 200, .set_nodes = 80, .plane_every = 0, .database_bytes = {}});
  const test::TemporaryFolder folder_;
  const std::string name_ = folder_.file("large.sight");
  std::uint64_t structure_bytes_ = 0;
  std::vector<std::pair<std::uint64_t, Bytes>> pieces_;
  std::vector<Chunk> chunks_;
  std::vector<pvs::SetPlace> places_;
};

TEST_F(LargeSight, GivesTheSetsBehindTheHolesAndReadsNothingElse) {
  const Result<SightFile> file = SightFile::open(name_);
  ASSERT_TRUE(file) << errorOf(file);
  EXPECT_GT(file->fileBytes(), std::uint64_t{1} << 32);
  EXPECT_TRUE(sameTree(file->boxes(), baked_.boxes.view()));
  EXPECT_TRUE(sameOctree(file->octree(), baked_.octree.view()));
  // Eyes in cells whose sets lie before, between and behind the holes' chunks, each for the first time.
  SetQuery query(*file);
  std::uint64_t expected_bytes = 0;
  std::uint32_t last_chunk = 0xffffffffu;
  std::size_t behind = 0;
  forEachLeaf(baked_.octree.view(), [&](std::uint32_t leaf, const OctreeCell& cell) {
    const std::uint32_t set = baked_.octree.leaves[leaf].set, chunk = places_[set].chunk;
    if (chunk == 1 || chunk == 2 || behind > 10) {
      return;
    }
    behind += chunk > 2 ? 1 : 0;
    const Vec3d min = cellMin(baked_.octree.min, baked_.octree.max, cell);
    const Vec3d max = cellMax(baked_.octree.min, baked_.octree.max, cell);
    const std::uint64_t decoded_before = query.stats().decoded;
    const VisibleSet found = query.find(0.5 * (min + max), 0.0);
    EXPECT_EQ(found.id, set);
    EXPECT_TRUE(sameBytes(found.nodes, baked_.sets[set]));
    if (query.stats().decoded > decoded_before && chunk != last_chunk) {
      expected_bytes += chunks_[chunk].bytes;
      last_chunk = chunk;
    }
  });
  EXPECT_GT(behind, 10u);
  EXPECT_EQ(query.stats().broken, 0u);
  EXPECT_GT(expected_bytes, 0u);
  EXPECT_EQ(query.stats().chunk_bytes, expected_bytes);
  EXPECT_LT(bytesInMemory(), std::uint64_t{64} << 20) << "something read the holes";
}

// A map that may be written to counts as memory in use, of which a machine may have less than the file.
TEST_F(LargeSight, IsMappedSoThatNobodyCanWriteToIt) {
  const Result<SightFile> file = SightFile::open(name_);
  ASSERT_TRUE(file) << errorOf(file);
  std::ifstream maps("/proc/self/maps");
  if (!maps) {
    // Only Linux has this file. The call that maps is the same everywhere.
    GTEST_SKIP() << "the system does not tell what is mapped";
  }
  std::size_t mapped = 0;
  for (std::string line; std::getline(maps, line);) {
    if (line.find(name_) != std::string::npos) {
      EXPECT_NE(line.find(" r--p "), std::string::npos) << line;
      mapped += 1;
    }
  }
  EXPECT_GT(mapped, 0u);
}

TEST_F(LargeSight, IsRefusedWhenItIsCutOffOrLonger) {
  const std::uint64_t size = std::filesystem::file_size(name_);
  for (const std::uint64_t other : {size - 1, size + 1, size - kHole, structure_bytes_, structure_bytes_ - 1,
                                    std::uint64_t{1} << 31, std::uint64_t{8}}) {
    std::filesystem::resize_file(name_, other);
    const std::string error = errorOf(SightFile::open(name_));
    EXPECT_NE(error.find("truncated or altered"), std::string::npos) << other << ": " << error;
    EXPECT_TRUE(oneLine(error));
  }
}

TEST_F(LargeSight, NoticesWhatIsAlteredBehindTheHoles) {
  Bytes frame = pieces_.back().second;
  frame[frame.size() / 2] ^= std::byte{1};
  write(structure_bytes_ + pieces_.back().first, frame);
  const Result<SightFile> file = SightFile::open(name_);
  ASSERT_TRUE(file) << errorOf(file) << "; chunks are checked when they are decoded";
  for (std::uint32_t set = 0; set < file->setCount(); ++set) {
    std::vector<std::uint32_t> nodes;
    const std::uint32_t chunk = places_[set].chunk;
    if (chunk != 1 && chunk != 2) {
      EXPECT_EQ(errorOf(file->readSet(set, nodes)).empty(), chunk + 1 != chunks_.size()) << set;
    }
  }
}

TEST_F(LargeSight, NoticesThatItsSizesAreAltered) {
  for (std::uint64_t at = 0; at < std::min<std::uint64_t>(structure_bytes_, 256); ++at) {
    Bytes one(1);
    const int descriptor = ::open(name_.c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_EQ(::pread(descriptor, one.data(), 1, static_cast<off_t>(at)), 1);
    one[0] ^= std::byte{0x40};
    ASSERT_EQ(::pwrite(descriptor, one.data(), 1, static_cast<off_t>(at)), 1);
    EXPECT_FALSE(SightFile::open(name_)) << "byte " << at;
    one[0] ^= std::byte{0x40};
    ASSERT_EQ(::pwrite(descriptor, one.data(), 1, static_cast<off_t>(at)), 1);
    ::close(descriptor);
  }
  EXPECT_TRUE(SightFile::open(name_));
}

}  // namespace
}  // namespace sightline::sight_test
