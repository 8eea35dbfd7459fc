// A bake that is killed at any moment leaves no broken file, and goes on to the same bytes.

#include <chrono>
#include <cstring>
#include <random>
#include <thread>

#include "tests/support/rounds.h"
#include "tests/tool/start_tool.h"

namespace sightline::tool_test {
namespace {

constexpr std::uint32_t kSeed = 20261;
const int kKills = test::rounds(4);  // of each kind

void nap() {
  std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

std::uintmax_t sizeOf(const std::string& file) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  return error ? 0 : size;
}

class KilledBake : public ::testing::Test {
 protected:
  static std::vector<std::string> arguments(const std::string& output, const std::string& threads) {
    return {"bake",
            "demo:ship?decks=3&rooms=4&machinery=0",
            "-o",
            output,
            "--depth",
            "4",
            "--triangle-budget",
            "300",
            "--threads",
            threads,
            "--resume"};
  }

  // The bake that nobody kills is made once for all tests.
  static void SetUpTestSuite() {
    const TemporaryFolder folder;
    const std::string file = folder.file("reference.sight");
    Started bake(toolWords(0, joined(arguments(file, "1"), {"--json", "-"})));
    while (bake.running()) {
      max_ = std::max(max_, sizeOf(file + ".parts"));
      nap();
    }
    const Outcome outcome = bake.wait();
    reference_parts_ = printedJson(outcome)["parts"];
    reference_ = contents(file);
    ASSERT_FALSE(reference_.empty());
  }

  // Waits until the checkpoint has a random share of its final size, or for a random time.
  void waitForSomeMoment(Started& bake, const std::string& file) {
    const std::uintmax_t size = std::uniform_int_distribution<std::uintmax_t>(0, max_)(random_);
    const auto after = std::chrono::microseconds(std::uniform_int_distribution<int>(0, 20000)(random_));
    while (bake.running() && sizeOf(file + ".parts") < size && sizeOf(file) == 0) {
      nap();
    }
    std::this_thread::sleep_for(after);
  }

  void expectAbsentOrWhole(const std::string& file) {
    if (std::filesystem::exists(file)) {
      EXPECT_EQ(contents(file), reference_) << "seed " << kSeed;
    }
  }

  void expectResumes(const std::string& file, int processes) {
    const Outcome outcome = Started(toolWords(processes, arguments(file, "2"))).wait();
    EXPECT_EQ(outcome.code, 0) << outcome.err << " seed " << kSeed;
    EXPECT_TRUE(contents(file) == reference_) << "seed " << kSeed;
    EXPECT_FALSE(std::filesystem::exists(file + ".parts"));
  }

  TemporaryFolder folder_;
  std::mt19937 random_{kSeed};
  inline static std::string reference_;
  inline static std::uint64_t reference_parts_ = 0;
  inline static std::uintmax_t max_ = 0;  // bytes of a checkpoint, about
};

// How many parts a checkpoint holds whole, counted by the lengths in it (see checkpoint.cpp).
std::uint64_t wholeParts(const std::string& bytes) {
  constexpr std::size_t kHeader = 16, kHead = 40, kLengthAt = 16;
  std::uint64_t count = 0;
  for (std::size_t at = kHeader; at + kHead <= bytes.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, bytes.data() + at + kLengthAt, sizeof length);
    if (length > bytes.size() - at - kHead) {
      break;
    }
    at += kHead + length;
    ++count;
  }
  return count;
}

TEST_F(KilledBake, KeepsAllPartsThatWereFinishedAndThereAreManyOfThem) {
  EXPECT_GT(reference_parts_, 40u) << "a bake of few parts loses much";
  std::uint64_t finished_in_all = 0, kills_in_the_middle = 0;
  for (int i = 0; i < kKills; ++i) {
    const std::string file = folder_.file("finished" + std::to_string(i));
    Started bake(toolWords(0, arguments(file, "2")));
    waitForSomeMoment(bake, file);
    const std::uint64_t finished = wholeParts(contents(file + ".parts"));
    bake.kill(SIGKILL);
    bake.wait();
    expectAbsentOrWhole(file);
    if (!std::filesystem::exists(file + ".parts")) {
      continue;  // it was complete, or had not begun
    }
    const nlohmann::json report =
        printedJson(Started(toolWords(0, joined(arguments(file, "2"), {"--json", "-"}))).wait());
    EXPECT_GE(report["parts_before"].get<std::uint64_t>(), finished) << "seed " << kSeed;
    EXPECT_EQ(report["parts"].get<std::uint64_t>(), reference_parts_);
    EXPECT_TRUE(contents(file) == reference_) << "seed " << kSeed;
    EXPECT_FALSE(std::filesystem::exists(file + ".parts"));
    finished_in_all += finished;
    kills_in_the_middle += 1;
  }
  EXPECT_GT(kills_in_the_middle, 0u) << "no bake was killed in the middle";
  EXPECT_GT(finished_in_all, 0u) << "the test would prove little";
}

TEST_F(KilledBake, GoesOnAfterManyKillsOneAfterTheOther) {
  const std::string file = folder_.file("often");
  for (int i = 0; i < kKills; ++i) {
    Started bake(toolWords(0, arguments(file, i % 2 == 0 ? "1" : "2")));
    waitForSomeMoment(bake, file);
    bake.kill(SIGKILL);
    bake.wait();
    expectAbsentOrWhole(file);
  }
  expectResumes(file, 0);
}

TEST_F(KilledBake, GoesOnAfterOneOfTwoProcessesIsKilled) {
  if (!haveMpirun()) {
    GTEST_SKIP() << kNoMpirun;
  }
  for (int i = 0; i < kKills; ++i) {
    const std::string file = folder_.file("mpi" + std::to_string(i));
    Started bake(toolWords(2, arguments(file, "1")));
    waitForSomeMoment(bake, file);
    if (const std::vector<pid_t> processes = bake.children(); !processes.empty()) {
      ::kill(processes[random_() % processes.size()], SIGKILL);
    }
    bake.wait();
    expectAbsentOrWhole(file);
    expectResumes(file, i % 2 == 0 ? 0 : 2);
  }
}

// The first record is of the root, above all other parts: these must not be baked again.
TEST_F(KilledBake, SaysWhatOfItsCheckpointIsAlteredAndBakesThatAloneAgain) {
  for (const int processes : haveMpirun() ? std::vector<int>{0, 2} : std::vector<int>{0}) {
    const std::string file = folder_.file("altered" + std::to_string(processes));
    for (int tries = 0; tries < 20 && sizeOf(file + ".parts") == 0; ++tries) {
      Started bake(toolWords(0, arguments(file, "2")));
      while (bake.running() && sizeOf(file + ".parts") <= max_ / 4 && sizeOf(file) == 0) {
        nap();
      }
      bake.kill(SIGTERM);
      bake.wait();
    }
    std::string parts = contents(file + ".parts");
    ASSERT_GT(parts.size(), 100u) << "no bake could be ended in the middle";
    parts[60] = static_cast<char>(parts[60] ^ 1);
    folder_.write("altered" + std::to_string(processes) + ".parts", parts);
    const Outcome outcome =
        Started(toolWords(processes, joined(arguments(file, "2"), {"--json", "-"}))).wait();
    const std::uint64_t kept = printedJson(outcome)["parts_before"];
    EXPECT_GT(kept, 0u);
    EXPECT_NE(outcome.err.find("sightline: warning: " + file + ".parts: is damaged: 1 of " +
                               std::to_string(kept + 1) + " parts could not be read and is baked again\n"),
              std::string::npos)
        << outcome.err << kept;
    EXPECT_TRUE(contents(file) == reference_);
    EXPECT_FALSE(std::filesystem::exists(file + ".parts"));
  }
}

TEST_F(KilledBake, SaysHowToGoOnWhenToldToEnd) {
  for (const int signal : {SIGTERM, SIGINT}) {
    const std::string file = folder_.file("told" + std::to_string(signal));
    Started bake(toolWords(0, arguments(file, "2")));
    while (bake.running() && sizeOf(file + ".parts") <= max_ / 4 && sizeOf(file) == 0) {
      nap();
    }
    bake.kill(signal);
    const Outcome outcome = bake.wait();
    if (outcome.code != 0 && outcome.code != -1) {  // neither ready already nor about to write
      EXPECT_EQ(outcome.code, 128 + signal);
      EXPECT_NE(outcome.err.find("--resume"), std::string::npos) << outcome.err;
      EXPECT_NE(outcome.err.find("parts known so far are kept"), std::string::npos) << outcome.err;
      EXPECT_EQ(outcome.out, "");
    }
    expectAbsentOrWhole(file);
    expectResumes(file, 0);
  }
}

}  // namespace
}  // namespace sightline::tool_test
