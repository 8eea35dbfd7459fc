#include "sightline/pvs/query/sight_file.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "src/pvs/format/sight_view.h"
#include "tests/pvs/sight_checks.h"

namespace sightline::sight_test {
namespace {

BakedVisibility smallBaked() {
  return made::visibility(
      {.objects = 12, .leaves = 20, .sets = 9, .set_nodes = 4, .database_bytes = {90, 0}});
}

// Checks that all contents of a file are unchanged, or that an error reports it as unreadable.
void expectSameOrError(const Result<SightFile>& file, const BakedVisibility& baked,
                       const std::string& where) {
  if (!file) {
    EXPECT_TRUE(oneLine(file.error().message)) << where;
    EXPECT_EQ(file.error().message.rfind("made.sight ", 0), 0u) << where << file.error().message;
    return;
  }
  EXPECT_EQ(file->scene(), baked.scene) << where;
  EXPECT_EQ(file->record(), baked.record) << where;
  EXPECT_TRUE(sameTree(file->boxes(), baked.boxes.view())) << where;
  EXPECT_TRUE(sameOctree(file->octree(), baked.octree.view())) << where;
  ASSERT_EQ(file->setCount(), baked.sets.count()) << where;
  for (std::uint32_t set = 0; set < baked.sets.count(); ++set) {
    std::vector<std::uint32_t> nodes;
    if (file->readSet(set, nodes)) {
      EXPECT_TRUE(sameBytes<std::uint32_t>(nodes, baked.sets[set])) << where;
    }
  }
  ASSERT_EQ(file->databaseNames().size(), baked.databases.size()) << where;
  for (const DatabaseBlob& expected : baked.databases) {
    const Result<DatabaseBlob> blob = file->readDatabase(expected.name);
    if (blob) {
      EXPECT_EQ(blob->occluders, expected.occluders) << where;
      EXPECT_EQ(blob->bytes, expected.bytes) << where;
    }
  }
}

void expectSame(const Bytes& bytes, const BakedVisibility& baked, const std::string& where) {
  const Result<SightFile> file = opened(bytes);
  ASSERT_TRUE(file) << where << errorOf(file);
  EXPECT_TRUE(file->verifyAll()) << where;
  expectSameOrError(file, baked, where);
}

TEST(SightFile, GivesBackAllThatWasWritten) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const BakedVisibility baked = made::visibility({.seed = seed,
                                                    .objects = 1 + seed * 50,
                                                    .leaves = seed * 30,
                                                    .depth = seed % 6,
                                                    .sets = 1 + seed * 20,
                                                    .set_nodes = seed * 5,
                                                    .plane_every = seed % 4,
                                                    .partly_every = seed % 3});
    expectSame(bytesOf(baked), baked, "seed " + std::to_string(seed) + " ");
  }
}

TEST(SightFile, HoldsSetsLongerThanAChunkAndDatabasesOfManyChunks) {
  // All leaves below the root: 30,000 nodes, none below another.
  BakedVisibility baked = made::visibility({.objects = 30'000, .database_bytes = {2'500'000}});
  for (std::uint32_t node = 0; node < baked.boxes.nodes.size(); ++node) {
    if (baked.boxes.view().leaf(node)) {
      baked.sets.nodes.push_back(node);
    }
  }
  baked.sets.first.push_back(baked.sets.nodes.size());
  expectSame(bytesOf(baked), baked, "");
}

TEST(SightFile, IsTheSameBytesForTheSameData) {
  const made::Visibility settings{.objects = 500, .sets = 200, .set_nodes = 40, .database_bytes = {5000}};
  EXPECT_EQ(bytesOf(made::visibility(settings)), bytesOf(made::visibility(settings)));
}

TEST(SightFile, IsSmallerThanItsSetsAsNumbers) {
  const BakedVisibility baked = made::visibility({.objects = 5000, .sets = 1000, .set_nodes = 200});
  const Bytes bytes = bytesOf(baked);
  const Result<SightFile> file = opened(bytes);
  ASSERT_TRUE(file);
  const auto sections = file->sections();
  const auto sets =
      std::find_if(sections.begin(), sections.end(), [](const auto& s) { return s.name == "sets"; });
  ASSERT_NE(sets, sections.end());
  EXPECT_LT(sets->bytes, sets->raw_bytes);
  EXPECT_LT(sets->raw_bytes, baked.sets.nodes.size() * sizeof(std::uint32_t));
}

TEST(SightFile, IsMadeUpOfItsSections) {
  const BakedVisibility baked = made::visibility({.objects = 5000, .sets = 1000, .set_nodes = 200});
  const Bytes bytes = bytesOf(baked);
  const Result<SightFile> file = opened(bytes);
  ASSERT_TRUE(file);
  EXPECT_EQ(file->fileBytes(), bytes.size());
  std::uint64_t sum = 0;
  for (const SightFile::Section& section : file->sections()) {
    sum += section.bytes;
  }
  EXPECT_LE(sum, bytes.size());
  EXPECT_GE(sum + 1000, bytes.size());
}

TEST(SightFile, IsReadAtAnyPlaceInMemory) {
  const BakedVisibility baked = smallBaked();
  const Bytes bytes = bytesOf(baked);
  for (std::size_t shift = 0; shift < 16; ++shift) {
    Bytes moved(shift);
    moved.insert(moved.end(), bytes.begin(), bytes.end());
    const Result<SightFile> file = opened(std::span<const std::byte>(moved).subspan(shift));
    ASSERT_TRUE(file) << errorOf(file);
    expectSameOrError(file, baked, "shift " + std::to_string(shift) + " ");
  }
}

TEST(SightFile, RefusesEveryTruncation) {
  const Bytes bytes = bytesOf(smallBaked());
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    const Result<SightFile> file = opened(std::span(bytes).first(length));
    ASSERT_FALSE(file) << length << " of " << bytes.size() << " bytes";
    EXPECT_TRUE(oneLine(file.error().message));
  }
}

TEST(SightFile, RefusesBytesThatFollowIt) {
  Bytes bytes = bytesOf(smallBaked());
  bytes.resize(bytes.size() + 1);
  EXPECT_FALSE(opened(bytes));
}

TEST(SightFile, GivesAnErrorOrTheSameAnswersForEveryAlteredByte) {
  const BakedVisibility baked = smallBaked();
  Bytes bytes = bytesOf(baked);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    const std::byte before = bytes[i];
    for (const int flip : {0x01, 0x10, 0x80, 0xff}) {
      bytes[i] = before ^ static_cast<std::byte>(flip);
      const Result<SightFile> file = opened(bytes);
      expectSameOrError(file, baked, "byte " + std::to_string(i) + " ");
      EXPECT_FALSE(file && file->verifyAll()) << "byte " << i << " is altered and nobody noticed";
    }
    bytes[i] = before;
  }
}

// Altered bytes with a correct seal, as in a hostile file: the results may be anything, but reading them is
// safe.
TEST(SightFile, IsSafeToReadWhateverItsSealedBytesAre) {
  const Bytes bytes = bytesOf(smallBaked());
  made::Random random(3);
  int taken = 0;
  for (int i = 0; i < 30'000; ++i) {
    Bytes altered = bytes;
    for (std::uint32_t count = 1 + random() % 3; count > 0; --count) {
      altered[random() % altered.size()] =
          static_cast<std::byte>(random() % 4 == 0 ? random() % 256 : random() % 4);
    }
    pvs::seal(altered);
    const Result<SightFile> file = opened(altered);
    if (!file) {
      EXPECT_TRUE(oneLine(file.error().message));
      continue;
    }
    ++taken;
    const auto check = [&](std::uint32_t, std::span<const std::uint32_t> nodes) {
      EXPECT_TRUE(std::is_sorted(nodes.begin(), nodes.end()));
      EXPECT_TRUE(nodes.empty() || nodes.back() < file->boxes().nodes.size());
    };
    if (!file->forEachSet(check)) {
      // It ends at the first set that is broken.
      for (std::uint32_t set = 0; set < file->setCount(); ++set) {
        std::vector<std::uint32_t> nodes;
        if (file->readSet(set, nodes)) {
          check(set, nodes);
        }
      }
    }
    const Status whole = file->verifyAll();
    EXPECT_TRUE(whole || oneLine(errorOf(whole)));
  }
  EXPECT_GT(taken, 100) << "the test reaches too little";
}

// Field 0 of the root table.
std::byte* versionIn(Bytes& bytes) {
  const auto number = [&](std::size_t at, auto value) {
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
  };
  const std::size_t table = number(0, std::uint32_t{});
  const std::size_t vtable = table - static_cast<std::size_t>(number(table, std::int32_t{}));
  return bytes.data() + table + number(vtable + 4, std::uint16_t{});
}

TEST(SightFile, SaysWhichOtherVersionItHas) {
  for (const std::uint32_t version : {pvs::kVersion - 1, pvs::kVersion + 1, 4'000'000'000u}) {
    Bytes bytes = bytesOf(smallBaked());
    std::memcpy(versionIn(bytes), &version, sizeof version);
    const std::string error = errorOf(opened(bytes));
    EXPECT_NE(error.find("version " + std::to_string(version)), std::string::npos) << error;
    EXPECT_NE(error.find(version < pvs::kVersion ? "older" : "newer"), std::string::npos) << error;
    EXPECT_NE(error.find("bake it again"), std::string::npos) << error;
  }
}

TEST(SightFile, SaysWhatIsNoSightFile) {
  EXPECT_NE(errorOf(opened({})).find("empty"), std::string::npos);
  const std::string text = "A text, and quite another kind of file.\n";
  const std::string error = errorOf(opened(std::as_bytes(std::span(text))));
  EXPECT_NE(error.find("not a .sight file"), std::string::npos) << error;
  const std::string missing = errorOf(SightFile::open("/nowhere/at\nall.sight"));
  EXPECT_NE(missing.find("No such file"), std::string::npos) << missing;
  EXPECT_TRUE(oneLine(missing));
  EXPECT_NE(errorOf(SightFile::open("/")).find("not a regular file"), std::string::npos);
}

TEST(SightFile, RefusesAnotherScene) {
  const BakedVisibility baked = made::visibility({.objects = 1234});
  const Bytes bytes = bytesOf(baked);
  const Result<SightFile> file = opened(bytes);
  ASSERT_TRUE(file);
  EXPECT_TRUE(file->matches(baked.scene));
  SceneId other = baked.scene;
  other.objects = 5'000'001;
  const std::string counts = errorOf(file->matches(other));
  for (const char* part : {"made.sight", "1,234 objects", "14,808 triangles", "5,000,001 objects", "bake"}) {
    EXPECT_NE(counts.find(part), std::string::npos) << counts;
  }
  other.objects = other.triangles = 1;
  EXPECT_NE(errorOf(file->matches(other)).find("1 object and 1 triangle:"), std::string::npos);
  other = baked.scene;
  other.hash ^= 1;
  EXPECT_TRUE(oneLine(errorOf(file->matches(other))));
}

TEST(SightFile, NamesTheDatabaseThatItDoesNotHold) {
  const Bytes bytes = bytesOf(smallBaked());
  const Result<DatabaseBlob> none = opened(bytes)->readDatabase("detail");
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().message.find("'detail'"), std::string::npos);
}

}  // namespace
}  // namespace sightline::sight_test
