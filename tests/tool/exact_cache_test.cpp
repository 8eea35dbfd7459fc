#include "tools/sightline/exact/exact_cache.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/tool/run_tool.h"

namespace sightline::tool {
namespace {

using tool_test::TemporaryFolder;

const SceneId kSceneOfTen{.hash = 7, .objects = 10, .triangles = 12};

ExactKey keyOf(const SceneId& scene = kSceneOfTen, const View& view = {},
               const ExactSettings& settings = {}) {
  return {scene, view, settings};
}

std::vector<ObjectId> idsOf(const std::vector<std::uint32_t>& numbers) {
  std::vector<ObjectId> ids;
  for (const std::uint32_t number : numbers) {
    ids.emplace_back(number);
  }
  return ids;
}

ExactObjects frameOf(const std::vector<std::uint32_t>& witnessed, const std::vector<std::uint32_t>& undecided,
                     const std::vector<std::uint32_t>& boxes = {},
                     const std::vector<std::uint32_t>& undecided_boxes = {}) {
  return {idsOf(witnessed), idsOf(undecided), idsOf(boxes), idsOf(undecided_boxes)};
}

// The only file of the cache.
std::string onlyFile(const std::string& folder) {
  return std::filesystem::directory_iterator(folder)->path().string();
}

TEST(ExactCache, GivesBackWhatWasKept) {
  const TemporaryFolder folder;
  const Result<ExactCache> cache = ExactCache::open(folder.file("made/now"));
  ASSERT_TRUE(cache);
  EXPECT_FALSE(cache->find(keyOf()));
  for (const ExactObjects& frame : {frameOf({0, 3, 9}, {4}), frameOf({}, {}), frameOf({}, {0, 9}),
                                    frameOf({0}, {4, 5, 6}, {1, 4}, {5, 9})}) {
    ASSERT_TRUE(cache->keep(keyOf(), frame));
    EXPECT_EQ(cache->find(keyOf()), frame);
    EXPECT_EQ(ExactCache::open(cache->folder())->find(keyOf()), frame) << "in another run";
  }
}

TEST(ExactCache, WithoutAFolderKeepsNothing) {
  const Result<ExactCache> cache = ExactCache::open("");
  ASSERT_TRUE(cache);
  EXPECT_TRUE(cache->keep(keyOf(), frameOf({1}, {})));
  EXPECT_FALSE(cache->find(keyOf()));
}

TEST(ExactCache, AnythingThatTheAnswerDependsOnIsPartOfTheKey) {
  const TemporaryFolder folder;
  const Result<ExactCache> cache = ExactCache::open(folder.file("cache"));
  ASSERT_TRUE(cache);
  ASSERT_TRUE(cache->keep(keyOf(), frameOf({1}, {})));
  SceneId other_scene = kSceneOfTen;
  other_scene.hash = 8;
  EXPECT_FALSE(cache->find(keyOf(other_scene)));
  View moved, turned, wide, far, parallel, near, beside, above;
  moved.eye.z = 1e-300;
  turned.up.y = 1.0;
  wide.aspect = 2.0;
  far.z_far = 2000.0;
  near.z_near = 0.2;
  parallel.orthographic = true;
  beside.shift_x = above.shift_y = 1e-9;
  for (const View& view : {moved, turned, wide, far, near, parallel, beside, above}) {
    EXPECT_FALSE(cache->find(keyOf(kSceneOfTen, view)));
  }
  for (std::uint32_t ExactSettings::*number :
       {&ExactSettings::width, &ExactSettings::height, &ExactSettings::aimed_rays, &ExactSettings::edge_rays,
        &ExactSettings::steps}) {
    ExactSettings more;
    more.*number += 1;
    EXPECT_FALSE(cache->find(keyOf(kSceneOfTen, {}, more)));
  }
  EXPECT_TRUE(cache->find(keyOf()));
}

TEST(ExactCache, IgnoresDamagedFilesAndWritesThemAnew) {
  const TemporaryFolder folder;
  const Result<ExactCache> cache = ExactCache::open(folder.file("cache"));
  ASSERT_TRUE(cache);
  const ExactObjects frame = frameOf({0, 3}, {4}, {1}, {4});
  ASSERT_TRUE(cache->keep(keyOf(), frame));
  const std::string name = onlyFile(folder.file("cache"));
  const std::string whole = tool_test::contents(name);
  for (std::size_t length = 0; length < whole.size(); ++length) {
    folder.write("cache/" + std::filesystem::path(name).filename().string(), whole.substr(0, length));
    EXPECT_FALSE(cache->find(keyOf())) << "cut to " << length;
  }
  for (std::size_t byte = 0; byte < whole.size(); ++byte) {
    std::string changed = whole;
    changed[byte] = static_cast<char>(changed[byte] ^ 0x10);
    folder.write("cache/" + std::filesystem::path(name).filename().string(), changed);
    EXPECT_FALSE(cache->find(keyOf())) << "changed at " << byte;
  }
  folder.write("cache/" + std::filesystem::path(name).filename().string(), whole + "x");
  EXPECT_FALSE(cache->find(keyOf())) << "longer";
  ASSERT_TRUE(cache->keep(keyOf(), frame));
  EXPECT_EQ(cache->find(keyOf()), frame);
}

// Files whose checksum is right, but whose contents cannot be an answer.
TEST(ExactCache, IgnoresListsThatAreNoAnswer) {
  const TemporaryFolder folder;
  const Result<ExactCache> cache = ExactCache::open(folder.file("cache"));
  ASSERT_TRUE(cache);
  for (const ExactObjects& frame :
       {frameOf({3, 1}, {}), frameOf({1, 1}, {}), frameOf({10}, {}), frameOf({}, {10}), frameOf({1, 2}, {2}),
        frameOf({}, {}, {3, 1}), frameOf({}, {}, {}, {10}), frameOf({1, 2}, {}, {2}),
        frameOf({1, 2}, {}, {}, {2}), frameOf({}, {}, {2}, {2})}) {
    ASSERT_TRUE(cache->keep(keyOf(), frame));
    EXPECT_FALSE(cache->find(keyOf()));
  }
}

TEST(ExactCache, AFolderThatCannotBeMadeIsAnError) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "text");
  EXPECT_FALSE(ExactCache::open(file));
  EXPECT_FALSE(ExactCache::open(file + "/below"));
  EXPECT_EQ(tool_test::contents(file), "text");
}

}  // namespace
}  // namespace sightline::tool
