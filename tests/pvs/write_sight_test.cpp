#include "sightline/pvs/bake/write_sight.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "tests/pvs/sight_checks.h"
#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace sightline::sight_test {
namespace {

namespace fs = std::filesystem;

using Names = std::vector<std::string>;

TEST(WriteSight, WritesWhatCanBeOpened) {
  const test::TemporaryFolder folder;
  const BakedVisibility baked = made::visibility();
  ASSERT_EQ(errorOf(writeSight(folder.file("a.sight"), baked)), "");
  const Result<SightFile> file = SightFile::open(folder.file("a.sight"));
  ASSERT_TRUE(file) << errorOf(file);
  EXPECT_TRUE(file->verifyAll());
  EXPECT_TRUE(sameOctree(file->octree(), baked.octree.view()));
  EXPECT_EQ(folder.names(), Names{"a.sight"});
}

TEST(WriteSight, WritesTheSameBytesAgain) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a", "b"}) {
    ASSERT_EQ(errorOf(writeSight(folder.file(name), made::visibility())), "");
  }
  EXPECT_EQ(test::contents(folder.file("a")), test::contents(folder.file("b")));
}

TEST(WriteSight, ReplacesAFileThatSomebodyReads) {
  const test::TemporaryFolder folder;
  const std::string name = folder.file("a.sight");
  const BakedVisibility before = made::visibility({.seed = 1});
  const BakedVisibility after = made::visibility({.seed = 2, .objects = 77});
  ASSERT_EQ(errorOf(writeSight(name, before)), "");
  const Result<SightFile> file = SightFile::open(name);
  ASSERT_TRUE(file);
  ASSERT_EQ(errorOf(writeSight(name, after)), "");
  EXPECT_TRUE(sameTree(file->boxes(), before.boxes.view()));
  EXPECT_TRUE(file->verifyAll());
  EXPECT_TRUE(SightFile::open(name)->matches(after.scene));
}

TEST(WriteSight, LeavesNothingInAFolderThatIsNotThere) {
  const test::TemporaryFolder folder;
  const std::string name = folder.file("none/a.sight");
  const std::string error = errorOf(writeSight(name, made::visibility()));
  EXPECT_NE(error.find(name), std::string::npos) << error;
  EXPECT_NE(error.find("No such file or directory"), std::string::npos) << error;
  EXPECT_TRUE(folder.names().empty());
}

TEST(WriteSight, WritesBesideWhatManyInterruptedRunsLeftAndFollowsNoLink) {
  const test::TemporaryFolder folder;
  const auto leftOver = [&](int i) {
    return "a.sight." + std::to_string(::getpid()) + "." + std::to_string(i) + ".unfinished";
  };
  fs::create_symlink(folder.write("victim", "precious"), folder.file(leftOver(0)));
  for (int i = 1; i < 150; ++i) {
    folder.write(leftOver(i), "left over");
  }
  ASSERT_EQ(errorOf(writeSight(folder.file("a.sight"), made::visibility())), "");
  EXPECT_TRUE(SightFile::open(folder.file("a.sight")));
  EXPECT_EQ(test::contents(folder.file("victim")), "precious");
  EXPECT_EQ(folder.entries(), 152u) << "nothing is removed but its own";
}

TEST(WriteSight, NamesMayBeAsLongAsTheFileSystemAllows) {
  const test::TemporaryFolder folder;
  const std::string longest = std::string(249, 'n') + ".sight";
  ASSERT_EQ(errorOf(writeSight(folder.file(longest), made::visibility())), "");
  EXPECT_TRUE(SightFile::open(folder.file(longest)));
  EXPECT_NE(errorOf(writeSight(folder.file("n" + longest), made::visibility())).find("File name too long"),
            std::string::npos);
  EXPECT_EQ(folder.names(), Names{longest});
}

// The target is a folder, so writing succeeds until the rename.
TEST(WriteSight, RemovesTheUnfinishedFileWhenItCannotBeRenamed) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder.file("a.sight/child"));
  const std::string error = errorOf(writeSight(folder.file("a.sight"), made::visibility()));
  EXPECT_NE(error.find("directory"), std::string::npos) << error;
  EXPECT_EQ(folder.names(), Names{"a.sight"});
}

TEST(WriteSight, LeavesTheOldFileUntouchedWhenTheDiskIsFull) {
  const test::TemporaryFolder folder;
  const std::string name = folder.file("a.sight");
  ASSERT_EQ(errorOf(writeSight(name, made::visibility())), "");
  const std::string before = test::contents(name);

  std::string error;
  {
    const test::FullDisk full(1000);
    error = errorOf(writeSight(name, made::visibility({.seed = 5})));
  }
  EXPECT_NE(error.find("File too large"), std::string::npos) << error;
  EXPECT_EQ(test::contents(name), before);
  EXPECT_EQ(folder.names(), Names{"a.sight"});
}

TEST(WriteSight, WritesNothingThatNoReaderWouldTake) {
  const test::TemporaryFolder folder;
  using Damage = void (*)(BakedVisibility&);
  const std::vector<std::pair<const char*, Damage>> damages{
      {"no hierarchy", [](BakedVisibility& b) { b.boxes = {}; }},
      {"no octree", [](BakedVisibility& b) { b.octree = {}; }},
      {"another number of objects", [](BakedVisibility& b) { ++b.scene.objects; }},
      {"a set that is not there", [](BakedVisibility& b) { b.octree.leaves[0].set = b.sets.count(); }},
      {"a node that is not there", [](BakedVisibility& b) { b.sets.nodes.back() = 1'000'000; }},
      {"a set that descends", [](BakedVisibility& b) { std::swap(b.sets.nodes[0], b.sets.nodes[1]); }},
      {"a node below another", [](BakedVisibility& b) { b.sets.nodes[0] = 0; }},
      {"sets without end", [](BakedVisibility& b) { b.sets.first.pop_back(); }},
      {"sets beyond their nodes", [](BakedVisibility& b) { b.sets.first.back() += 1; }},
      {"sets that go back", [](BakedVisibility& b) { b.sets.first[3] = 1'000'000; }},
      {"no near distance", [](BakedVisibility& b) { b.record.near_distance = std::nan(""); }},
      {"two databases of one name", [](BakedVisibility& b) { b.databases[1].name = b.databases[0].name; }}};
  for (const auto& [what, apply] : damages) {
    BakedVisibility baked = made::visibility();
    apply(baked);
    const std::string error = errorOf(writeSight(folder.file("a.sight"), baked));
    EXPECT_TRUE(oneLine(error)) << what;
    EXPECT_NE(error.find("a.sight"), std::string::npos) << error;
  }
  EXPECT_TRUE(folder.names().empty());
}

}  // namespace
}  // namespace sightline::sight_test
