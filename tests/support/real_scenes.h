#pragma once

// The folder of real scenes, and how tests go without it.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace sightline::test {

inline std::filesystem::path folderOfScenes() {
  const char* const from_environment = std::getenv("SIGHTLINE_SCENES");
  return from_environment != nullptr
             ? std::filesystem::path(from_environment)
             : std::filesystem::path(SIGHTLINE_SOURCE_DIR) / ".." / "shared" / "scenes";
}

}  // namespace sightline::test

// Ends a test where a file of that folder is missing. The scenes are other people's and too large for the
// repository: these tests run where SIGHTLINE_SCENES names the folder, or it is in ../shared/scenes.
#define SIGHTLINE_SKIP_WITHOUT_SCENE(file) \
  if (!std::filesystem::exists(file))      \
  GTEST_SKIP() << "no " << (file) << "; set SIGHTLINE_SCENES to run this test"
