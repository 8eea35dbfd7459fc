#include <gtest/gtest.h>

#include <string>

#include "sightline/io/file.h"
#include "sightline/io/image.h"
#include "tests/support/temporary_folder.h"

namespace sightline {
namespace {

class ReadPng : public ::testing::Test {
 protected:
  std::string path(const std::string& name) const { return folder_.file(name); }

  const test::TemporaryFolder folder_;
};

TEST_F(ReadPng, GivesBackWhatWasWritten) {
  Image image{.width = 5, .height = 3, .rgba = {}};
  for (std::uint32_t i = 0; i < 4 * 15; ++i) {
    image.rgba.push_back(static_cast<std::uint8_t>(37 * i));
  }
  ASSERT_TRUE(writePng(image, path("a.png")));
  const Result<Image> read = readPng(path("a.png"));
  ASSERT_TRUE(read);
  EXPECT_EQ(*read, image);
}

TEST_F(ReadPng, RefusesWhatIsNoWholePngAndNamesIt) {
  Image image{.width = 40, .height = 40, .rgba = std::vector<std::uint8_t>(6400, 99)};
  ASSERT_TRUE(writePng(image, path("a.png")));
  const std::string bytes = readFile(path("a.png")).value();
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    ASSERT_TRUE(writeFile(path("cut.png"), bytes.substr(0, size)));
    const Result<Image> read = readPng(path("cut.png"));
    // The last bytes mark the end, which nothing needs.
    if (size + 24 < bytes.size()) {
      ASSERT_FALSE(read) << size;
      EXPECT_NE(read.error().message.find("cut.png"), std::string::npos);
      EXPECT_EQ(read.error().message.find('\n'), std::string::npos);
    }
  }
  EXPECT_FALSE(readPng(path("missing.png")));
}

TEST_F(ReadPng, RefusesMoreThanItCanHold) {
  Image image{.width = 16385, .height = 1, .rgba = std::vector<std::uint8_t>(4 * 16385, 1)};
  ASSERT_TRUE(writePng(image, path("wide.png")));
  EXPECT_FALSE(readPng(path("wide.png")));
}

}  // namespace
}  // namespace sightline
