#include "src/base/new_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <vector>

#include "tests/support/full_disk.h"
#include "tests/support/temporary_folder.h"

namespace sightline::base {
namespace {

bool write(int descriptor, const std::string& text) {
  return writeAll(descriptor, std::as_bytes(std::span(text)));
}

TEST(NewFile, IsMadeBesideTheTargetAndNeverTwice) {
  const test::TemporaryFolder folder;
  std::vector<std::string> names;
  for (int i = 0; i < 150; ++i) {
    std::string name;
    const int descriptor = openNewFileBeside(folder.file("a"), name);
    ASSERT_GE(descriptor, 0) << std::strerror(errno);
    EXPECT_TRUE(write(descriptor, name));
    ::close(descriptor);
    names.push_back(name);
  }
  EXPECT_EQ(folder.entries(), 150u);
  for (const std::string& name : names) {
    EXPECT_EQ(std::filesystem::path(name).parent_path(), folder.path());
    EXPECT_EQ(test::contents(name), name);
  }
}

TEST(NewFile, IsNotMadeWhereALinkPoints) {
  const test::TemporaryFolder folder;
  std::string first;
  ::close(openNewFileBeside(folder.file("a"), first));
  std::filesystem::remove(first);
  std::filesystem::create_symlink(folder.file("b"), first);  // to what is not there
  std::string second;
  const int descriptor = openNewFileBeside(folder.file("a"), second);
  ASSERT_GE(descriptor, 0);
  ::close(descriptor);
  EXPECT_NE(second, first);
  EXPECT_FALSE(std::filesystem::exists(folder.file("b")));
}

TEST(NewFile, HasRoomForItsNumberHoweverLongTheTargetsNameIs) {
  const test::TemporaryFolder folder;
  for (const std::size_t length : {199u, 200u, 201u, 255u}) {
    std::string name;
    const int descriptor = openNewFileBeside(folder.file(std::string(length, 'n')), name);
    EXPECT_GE(descriptor, 0) << length;
    ::close(descriptor);
    EXPECT_EQ(std::filesystem::path(name).parent_path(), folder.path()) << length;
  }
  EXPECT_EQ(folder.entries(), 4u);
}

TEST(NewFile, SaysWhyItCannotBeMade) {
  const test::TemporaryFolder folder;
  std::string name;
  EXPECT_EQ(openNewFileBeside(folder.file("none/a"), name), -1);
  EXPECT_EQ(errno, ENOENT);
}

TEST(NewFile, IsWrittenAsFarAsThereIsRoom) {
  const test::TemporaryFolder folder;
  std::string name;
  const int descriptor = openNewFileBeside(folder.file("a"), name);
  {
    const test::FullDisk full(10);
    EXPECT_TRUE(write(descriptor, "12345"));
    EXPECT_FALSE(write(descriptor, "67890 and more"));
    EXPECT_EQ(errno, EFBIG);
  }
  ::close(descriptor);
  EXPECT_EQ(test::contents(name), "1234567890");
}

}  // namespace
}  // namespace sightline::base
