#pragma once

// The folder of real scenes, and skipping tests where it is missing.

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

// Ends a test if a file of that folder is missing. The scenes belong to others and are too large for the
// repository, so these tests run only if SIGHTLINE_SCENES names the folder, or if it is in ../shared/scenes.
#define SIGHTLINE_SKIP_WITHOUT_SCENE(file) \
  if (!std::filesystem::exists(file))      \
  GTEST_SKIP() << "no " << (file) << "; set SIGHTLINE_SCENES to run this test"
