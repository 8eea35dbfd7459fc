#pragma once

// Skips tests that need OpenGL.

#include <gtest/gtest.h>

#include <string>

#include "sightline/render/renderer.h"

namespace sightline::test {

// Returns an empty text if this machine can render pictures.
inline std::string whyNoPictures() {
  const Scene empty;
  const Result<Renderer> renderer = Renderer::create(empty.view(), 8, 8);
  return renderer ? "" : renderer.error().message;
}

}  // namespace sightline::test

// Ends a test or its SetUp on a machine without OpenGL, which the rest of the library does not need. With
// scripts/setup, as in CI, Mesa is installed and nothing is skipped.
#define SIGHTLINE_SKIP_WITHOUT_PICTURES()                                       \
  if (const std::string why = ::sightline::test::whyNoPictures(); !why.empty()) \
  GTEST_SKIP() << "no pictures on this machine: " << why
