// What runs in a process of its own: its answer comes back, and whatever goes wrong there is one error.

#include "src/io/child_process.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "src/io/scene_bytes.h"
#include "tests/io/scene_checks.h"
#include "tests/support/rounds.h"

namespace sightline::io {
namespace {

using Bytes = std::vector<std::byte>;
constexpr ChildLimits kLimits{.memory_bytes = 256 << 20, .seconds = 10};

std::string errorOf(const ChildLimits& limits, const std::function<Bytes()>& work) {
  const Result<Bytes> answer = runInChild(limits, work);
  return answer ? "an answer" : answer.error().message;
}

TEST(RunInChild, ReturnsWhatTheWorkReturns) {
  Bytes large(3'000'000);
  for (std::size_t i = 0; i < large.size(); ++i) {
    large[i] = static_cast<std::byte>(i * 31 + i / 256);
  }
  const Result<Bytes> answer = runInChild(kLimits, [&] { return large; });
  ASSERT_TRUE(answer) << answer.error().message;
  EXPECT_EQ(*answer, large);
  const Result<Bytes> nothing = runInChild(kLimits, [] { return Bytes(); });
  ASSERT_TRUE(nothing);
  EXPECT_TRUE(nothing->empty());
}

TEST(RunInChild, LeavesThisProcessAsItWas) {
  int here = 1;
  const pid_t own = ::getpid();
  const Result<Bytes> answer = runInChild(kLimits, [&] {
    here = 2;
    return Bytes(::getpid() == own ? 1 : 2);
  });
  ASSERT_TRUE(answer);
  EXPECT_EQ(here, 1);
  EXPECT_EQ(answer->size(), 2u) << "another process";
}

TEST(RunInChild, ACrashIsAnError) {
  EXPECT_NE(errorOf(kLimits, []() -> Bytes { std::abort(); }).find("its reader crashed"), std::string::npos);
  // What a library of others prints as it crashes stays with it.
  testing::internal::CaptureStderr();
  errorOf(kLimits, []() -> Bytes {
    std::fputs("free(): invalid pointer\n", stderr);
    std::abort();
  });
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST(RunInChild, ExceptionsAndEarlyEndsAreErrors) {
  EXPECT_EQ(errorOf(kLimits, []() -> Bytes { throw std::runtime_error("x"); }), "its reader failed");
  EXPECT_EQ(errorOf(kLimits, []() -> Bytes { ::_exit(7); }), "its reader failed");
  EXPECT_EQ(errorOf(kLimits, []() -> Bytes { throw std::bad_alloc(); }),
            "its reader needs more than 256 MiB");
}

TEST(RunInChild, AnEndlessLoopEnds) {
  const std::string error = errorOf({.memory_bytes = 256 << 20, .seconds = 1}, []() -> Bytes {
    for (std::atomic<unsigned> i = 0;; ++i) {
    }
  });
  EXPECT_EQ(error, "its reader was ended: it took more than 1 s, or more memory than there is");
}

TEST(RunInChild, WaitingForeverEnds) {
  const std::string error = errorOf({.memory_bytes = 256 << 20, .seconds = 0}, []() -> Bytes {
    ::pause();
    return {};
  });
  EXPECT_EQ(error, "its reader was ended: it took more than 0 s, or more memory than there is");
}

// The exit code of a process of its own that runs `work`; -1 if it crashed.
int exitCodeOf(const std::function<int()>& work) {
  const pid_t child = ::fork();
  if (child == 0) {
    ::_exit(work());
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// How many descriptors of this process are open and fulfil the condition.
int countDescriptors(const std::function<bool(int)>& counts) {
  int count = 0;
  for (int descriptor = 0; descriptor < 256; ++descriptor) {
    count += ::fcntl(descriptor, F_GETFD) >= 0 && counts(descriptor) ? 1 : 0;
  }
  return count;
}

// Beyond the standard ones, which a child has not from its parent.
bool isWriteEnd(int descriptor) {
  struct stat status {};
  return descriptor > STDERR_FILENO && ::fstat(descriptor, &status) == 0 && S_ISFIFO(status.st_mode) &&
         (::fcntl(descriptor, F_GETFL) & O_ACCMODE) == O_WRONLY;
}

// Whoever has the write end of another's pipe too makes that one's answer wait for it.
TEST(RunInChild, NoChildHasTheWriteEndOfAnother) {
  const int before = countDescriptors(isWriteEnd);
  std::atomic<int> most = 0, failed = 0;
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&] {
      for (int i = 0; i < 50; ++i) {
        const Result<Bytes> answer =
            runInChild(kLimits, [] { return Bytes(static_cast<std::size_t>(countDescriptors(isWriteEnd))); });
        failed += answer ? 0 : 1;
        const int count = answer ? static_cast<int>(answer->size()) : 0;
        for (int known = most; count > known && !most.compare_exchange_weak(known, count);) {
        }
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  EXPECT_EQ(failed, 0);
  EXPECT_EQ(most, before + 1);
}

TEST(RunInChild, AnswersWithoutStandardDescriptors) {
  const int code = exitCodeOf([] {
    for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
      ::close(descriptor);
    }
    const Result<Bytes> answer = runInChild(kLimits, [] { return Bytes(5); });
    return answer ? static_cast<int>(answer->size()) : 100;
  });
  EXPECT_EQ(code, 5);
}

TEST(RunInChild, HandlersOfThisProcessDoNotRunThereAndIgnoredSignalsStayIgnored) {
  const auto by_handler = std::signal(SIGUSR1, [](int) {});
  const auto ignored = std::signal(SIGINT, SIG_IGN);
  const auto after = [](int signal) {
    return errorOf(kLimits, [signal] {
      std::raise(signal);
      return Bytes();
    });
  };
  EXPECT_NE(after(SIGUSR1).find("its reader crashed"), std::string::npos) << after(SIGUSR1);
  EXPECT_EQ(after(SIGINT), "an answer");
  std::signal(SIGUSR1, by_handler);
  std::signal(SIGINT, ignored);
}

// An answer of 512 MiB, where this process may have no more.
TEST(RunInChild, LeavesNothingIfMemoryEndsWhileTheAnswerIsRead) {
  if (test::sanitized()) {
    GTEST_SKIP() << "AddressSanitizer reserves more address space for itself than the limit allows";
  }
  constexpr int kNoMemory = 7, kChildLeft = 8, kDescriptorLeft = 9;
  const int code = exitCodeOf([] {
    const auto any = [](int) { return true; };
    const int descriptors = countDescriptors(any);
    struct rlimit limits {};
    ::getrlimit(RLIMIT_AS, &limits);
    limits.rlim_cur = 512u << 20;
    ::setrlimit(RLIMIT_AS, &limits);
    try {
      static_cast<void>(
          runInChild({.memory_bytes = 1u << 30, .seconds = 10}, [] { return Bytes(512u << 20); }));
    } catch (const std::bad_alloc&) {
      const bool no_child = ::waitpid(-1, nullptr, WNOHANG) < 0 && errno == ECHILD;
      return !no_child ? kChildLeft : countDescriptors(any) != descriptors ? kDescriptorLeft : kNoMemory;
    }
    return 0;
  });
  EXPECT_EQ(code, kNoMemory);
}

TEST(RunInChild, AllMemoryIsNotTaken) {
  if (test::sanitized()) {
    GTEST_SKIP() << "AddressSanitizer reserves more address space for itself than the limit allows";
  }
  const std::string error = errorOf(kLimits, [] {
    std::vector<std::unique_ptr<Bytes>> all;
    for (int i = 0; i < 1000; ++i) {
      all.push_back(std::make_unique<Bytes>(1 << 20));
    }
    return Bytes(1);
  });
  EXPECT_EQ(error, "its reader needs more than 256 MiB");
}

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
