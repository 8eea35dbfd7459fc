// What runs in a process of its own: its answer comes back, and whatever goes wrong there is one error.

#include "src/io/apart.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>

#include "src/io/scene_bytes.h"
#include "tests/io/scene_checks.h"

namespace sightline::io {
namespace {

using Bytes = std::vector<std::byte>;
constexpr ApartLimits kLimits{.memory_bytes = 256 << 20, .seconds = 10};

std::string errorOf(const ApartLimits& limits, const std::function<Bytes()>& work) {
  const Result<Bytes> answer = runApart(limits, work);
  return answer ? "an answer" : answer.error().message;
}

TEST(RunApart, ReturnsWhatTheWorkReturns) {
  Bytes large(3'000'000);
  for (std::size_t i = 0; i < large.size(); ++i) {
    large[i] = static_cast<std::byte>(i * 31 + i / 256);
  }
  const Result<Bytes> answer = runApart(kLimits, [&] { return large; });
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(*answer, large);
  const Result<Bytes> nothing = runApart(kLimits, [] { return Bytes(); });
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->empty());
}

TEST(RunApart, LeavesThisProcessAsItWas) {
  int here = 1;
  const pid_t own = ::getpid();
  const Result<Bytes> answer = runApart(kLimits, [&] {
    here = 2;
    return Bytes(::getpid() == own ? 1 : 2);
  });
  ASSERT_TRUE(answer);
  EXPECT_EQ(here, 1);
  EXPECT_EQ(answer->size(), 2u) << "another process";
}

TEST(RunApart, ACrashIsAnError) {
  EXPECT_NE(errorOf(kLimits, []() -> Bytes { std::abort(); }).find("its reader crashed"), std::string::npos);
  // What a library of others prints as it crashes stays with it.
  testing::internal::CaptureStderr();
  errorOf(kLimits, []() -> Bytes {
    std::fputs("free(): invalid pointer\n", stderr);
    std::abort();
  });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(RunApart, ExceptionsAndEarlyEndsAreErrors) {
  EXPECT_EQ(errorOf(kLimits, []() -> Bytes { throw std::runtime_error("x"); }), "its reader failed");
  EXPECT_EQ(errorOf(kLimits, []() -> Bytes { ::_exit(7); }), "its reader failed");
  EXPECT_EQ(errorOf(kLimits, []() -> Bytes { throw std::bad_alloc(); }),
            "its reader needs more than 256 MiB");
}

TEST(RunApart, AnEndlessLoopEnds) {
  const std::string error = errorOf({.memory_bytes = 256 << 20, .seconds = 1}, []() -> Bytes {
    for (std::atomic<unsigned> i = 0;; ++i) {
    }
  });
  EXPECT_EQ(error, "its reader was ended: it took more than 1 s, or more memory than there is");
}

TEST(RunApart, WaitingForeverEnds) {
  const std::string error = errorOf({.memory_bytes = 256 << 20, .seconds = 0}, []() -> Bytes {
    ::pause();
    return {};
  });
  EXPECT_EQ(error, "its reader was ended: it took more than 0 s, or more memory than there is");
}

#if !defined(__SANITIZE_ADDRESS__)
TEST(RunApart, AllMemoryIsNotTaken) {
  const std::string error = errorOf(kLimits, [] {
    std::vector<std::unique_ptr<Bytes>> all;
    for (int i = 0; i < 1000; ++i) {
      all.push_back(std::make_unique<Bytes>(1 << 20));
    }
    return Bytes(1);
  });
  EXPECT_EQ(error, "its reader needs more than 256 MiB");
}
#endif

Scene smallScene() {
  Scene scene;
  scene.materials = {{.name = "stone"},
                     {.name = "glass\n", .opacity = Opacity::kBlended, .double_sided = true}};
  scene.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, -2.5f}};
  scene.indices = {0, 1, 2, 0, 1, 3, 1, 2, 3};
  scene.objects = {
      {.first_index = 0, .index_count = 3, .material = MaterialId(1u)},
      {.first_index = 3, .index_count = 6, .material = MaterialId(0u), .mark = OccluderMark::kNever}};
  scene.object_names = {"", "wall"};
  scene.origin = {1e6, -2.0, 0.5};
  updateBounds(scene);
  return scene;
}

TEST(SceneBytes, ComeBackAsTheScene) {
  const Scene scene = smallScene();
  const std::optional<Scene> back = sceneFromBytes(sceneBytes(scene));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->positions, scene.positions);
  EXPECT_EQ(back->indices, scene.indices);
  EXPECT_EQ(back->object_names, scene.object_names);
  EXPECT_EQ(back->origin, scene.origin);
  ASSERT_EQ(back->objects.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(back->objects[i].first_index, scene.objects[i].first_index);
    EXPECT_EQ(back->objects[i].index_count, scene.objects[i].index_count);
    EXPECT_EQ(back->objects[i].material, scene.objects[i].material);
    EXPECT_EQ(back->objects[i].mark, scene.objects[i].mark);
    EXPECT_EQ(back->objects[i].bounds, scene.objects[i].bounds);
    EXPECT_EQ(back->materials[i].name, scene.materials[i].name);
    EXPECT_EQ(back->materials[i].opacity, scene.materials[i].opacity);
    EXPECT_EQ(back->materials[i].double_sided, scene.materials[i].double_sided);
    EXPECT_EQ(back->materials[i].base_color, scene.materials[i].base_color);
  }
}

TEST(SceneBytes, AnyOtherBytesAreRefusedOrAValidScene) {
  const Bytes whole = sceneBytes(smallScene());
  for (std::size_t size = 0; size < whole.size(); ++size) {
    EXPECT_FALSE(sceneFromBytes(std::span(whole).first(size))) << size;
  }
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const int value : {0, 1, 2, 3, 0x7f, 0x80, 0xff}) {
      Bytes changed = whole;
      changed[i] = static_cast<std::byte>(value);
      if (const std::optional<Scene> scene = sceneFromBytes(changed)) {
        EXPECT_TRUE(test::isSound(*scene)) << "byte " << i << " is " << value;
      }
    }
  }
}

}  // namespace
}  // namespace sightline::io
