// Tests what an unfinished bake leaves: whatever happened to the file, whole parts are found again, no
// others, and it is said how many others there were.

#include "tools/sightline/bake/checkpoint.h"

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using tool::Checkpoint;
using tool::CheckpointUse;
using tool::KeptParts;

constexpr std::uint64_t kPlan = 0x123456789abcdef0u;

BakedPart bytesOf(const std::string& text) {
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}

// Parts in the order in which they are finished; one has no bytes.
const std::vector<std::pair<std::uint64_t, BakedPart>> kFinished = {
    {3, bytesOf("third")},
    {1, bytesOf("")},
    {std::uint64_t{1} << 60, bytesOf("the fourth, which is longer")}};

// Returns the size of the file before each part and at the end.
std::vector<std::size_t> appendAll(const std::string& file, CheckpointUse use) {
  Result<Checkpoint> checkpoint = Checkpoint::open(file, use);
  EXPECT_TRUE(checkpoint && checkpoint->begin(kPlan));
  std::vector<std::size_t> sizes{contents(file).size()};
  for (const auto& [part, bytes] : kFinished) {
    EXPECT_TRUE(checkpoint->append(part, bytes));
    sizes.push_back(contents(file).size());
  }
  return sizes;
}

// What a checkpoint has, with the bytes of its parts.
struct Found : KeptParts {
  BakedParts parts{};
};

Result<Found> foundIn(Checkpoint& checkpoint, std::uint64_t plan) {
  Result<KeptParts> kept = checkpoint.begin(plan);
  if (!kept) {
    return kept.error();
  }
  Found found{*kept, {}};
  for (const std::uint64_t part : kept->parts) {
    const std::optional<BakedPart> bytes = checkpoint.read(part);
    EXPECT_TRUE(bytes) << part;
    found.parts.emplace(part, bytes.value_or(BakedPart{}));
  }
  return found;
}

Result<Found> resume(const std::string& file, std::uint64_t plan = kPlan) {
  Result<Checkpoint> checkpoint = Checkpoint::open(file, CheckpointUse::kResume);
  if (!checkpoint) {
    return checkpoint.error();
  }
  return foundIn(*checkpoint, plan);
}

// All of kFinished but the n-th ones given.
BakedParts allBut(const std::vector<std::size_t>& lost) {
  BakedParts parts(kFinished.begin(), kFinished.end());
  for (const std::size_t n : lost) {
    parts.erase(kFinished[n].first);
  }
  return parts;
}

// Bakes the lost parts again; then all are there and nothing is said any more.
void expectMended(const std::string& file, const std::vector<std::size_t>& lost) {
  {
    Result<Checkpoint> checkpoint = Checkpoint::open(file, CheckpointUse::kResume);
    ASSERT_TRUE(checkpoint && checkpoint->begin(kPlan));
    for (const std::size_t n : lost) {
      ASSERT_TRUE(checkpoint->append(kFinished[n].first, kFinished[n].second));
    }
  }
  const Result<Found> kept = resume(file);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->parts, allBut({}));
  EXPECT_EQ(lossText(file, *kept), "");
}

TEST(Checkpoint, GivesBackWhatWasAppended) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  appendAll(file, CheckpointUse::kNew);
  const Result<Found> kept = resume(file);
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_EQ(kept->parts, allBut({}));
  EXPECT_EQ(lossText(file, *kept), "");
}

TEST(Checkpoint, CutAnywhereItHasTheWholePartsBeforeTheCutAndGoesOn) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  const std::vector<std::size_t> sizes = appendAll(file, CheckpointUse::kNew);
  const std::string whole = contents(file);
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    SCOPED_TRACE(length);
    folder.write("F.parts", whole.substr(0, length));
    const Result<Found> kept = resume(file);
    ASSERT_TRUE(kept) << kept.error().message;
    std::vector<std::size_t> lost;
    for (std::size_t n = 0; n < kFinished.size(); ++n) {
      if (sizes[n + 1] > length) {
        lost.push_back(n);
      }
    }
    EXPECT_EQ(kept->parts, allBut(lost));
    EXPECT_FALSE(kept->damaged);
    const std::string loss = lossText(file, *kept);
    const std::size_t found = kFinished.size() - lost.size();
    if (length > 0 && length < sizes[0]) {
      EXPECT_EQ(loss, file + ": is cut off before its first part; all parts are baked");
    } else if (length == 0 || length == sizes[found]) {
      EXPECT_EQ(loss, "") << "the end of a part, or of none";
    } else {
      EXPECT_EQ(loss, file + ": its end is cut off, as after a kill: 1 of " + std::to_string(found + 1) +
                          " parts could not be read and is baked again");
    }
    // What is appended now is not lost behind the torn end.
    expectMended(file, lost);
  }
}

TEST(Checkpoint, AlteredAnywhereItGivesTheOtherPartsAndSaysThatOneIsLost) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  const std::vector<std::size_t> sizes = appendAll(file, CheckpointUse::kNew);
  const std::string whole = contents(file);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int bit : {0, 7}) {
      SCOPED_TRACE(at);
      std::string altered = whole;
      altered[at] = static_cast<char>(altered[at] ^ (1 << bit));
      folder.write("F.parts", altered);
      const Result<Found> kept = resume(file);
      if (at < sizes[0]) {
        ASSERT_FALSE(kept);
        EXPECT_NE(kept.error().message.find("F.parts"), std::string::npos);
        EXPECT_TRUE(contents(file) == altered) << "a refused file stays as it is";
        continue;
      }
      ASSERT_TRUE(kept) << kept.error().message;
      std::size_t lost = 0;
      while (sizes[lost + 1] <= at) {
        lost += 1;
      }
      EXPECT_EQ(kept->parts, allBut({lost}));
      EXPECT_EQ(lossText(file, *kept),
                file + ": is damaged: 1 of 3 parts could not be read and is baked again");
      expectMended(file, {lost});
    }
  }
}

TEST(Checkpoint, SaysHowManyPartsAreLost) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  const std::vector<std::size_t> sizes = appendAll(file, CheckpointUse::kNew);
  const std::string whole = contents(file);
  // The heads of two parts, which lie one behind the other.
  std::string altered = whole;
  altered[sizes[0] + 20] ^= 1;
  altered[sizes[1] + 20] ^= 1;
  folder.write("F.parts", altered);
  const Result<Found> two = resume(file);
  ASSERT_TRUE(two);
  EXPECT_EQ(two->parts, allBut({0, 1}));
  EXPECT_EQ(lossText(file, *two), file + ": is damaged: 2 of 3 parts could not be read and are baked again");
  // One altered and one cut off is damage.
  altered = whole.substr(0, whole.size() - 3);
  altered[sizes[0] + 20] ^= 1;
  folder.write("F.parts", altered);
  const Result<Found> both = resume(file);
  ASSERT_TRUE(both);
  EXPECT_EQ(both->parts, allBut({0, 2}));
  EXPECT_EQ(lossText(file, *both), file + ": is damaged: 2 of 3 parts could not be read and are baked again");
  // A crash of the machine may leave zeros in place of what was written.
  folder.write("F.parts", whole + std::string(100, '\0'));
  const Result<Found> zeros = resume(file);
  ASSERT_TRUE(zeros);
  EXPECT_EQ(zeros->parts, allBut({}));
  EXPECT_EQ(lossText(file, *zeros), file + ": is damaged: 1 of 4 parts could not be read and is baked again");
}

TEST(Checkpoint, OfAnotherPlanIsAnErrorAndStays) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  appendAll(file, CheckpointUse::kNew);
  const std::string whole = contents(file);
  EXPECT_NE(resume(file, kPlan + 1).error().message.find("--restart"), std::string::npos);
  EXPECT_EQ(contents(file), whole);
}

TEST(Checkpoint, IsOverwrittenOnlyWhenAskedFor) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  appendAll(file, CheckpointUse::kNew);
  const std::string whole = contents(file);
  const Result<Checkpoint> refused = Checkpoint::open(file, CheckpointUse::kNew);
  ASSERT_FALSE(refused);
  EXPECT_NE(refused.error().message.find("--resume"), std::string::npos);
  EXPECT_EQ(contents(file), whole);
  Result<Checkpoint> anew = Checkpoint::open(file, CheckpointUse::kRestart);
  ASSERT_TRUE(anew);
  const Result<Found> kept = foundIn(*anew, kPlan + 1);
  ASSERT_TRUE(kept);
  EXPECT_EQ(kept->parts, BakedParts());
  EXPECT_LT(contents(file).size(), whole.size());
}

TEST(Checkpoint, IsOfOneBakeAtATime) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  {
    Result<Checkpoint> first = Checkpoint::open(file, CheckpointUse::kNew);
    ASSERT_TRUE(first);
    const Result<Checkpoint> second = Checkpoint::open(file, CheckpointUse::kNew);
    ASSERT_FALSE(second);
    EXPECT_NE(second.error().message.find("another bake"), std::string::npos);
    EXPECT_TRUE(std::filesystem::exists(file)) << "the second took the first one's file away";
    ASSERT_TRUE(first->begin(kPlan));
    ASSERT_TRUE(first->append(3, kFinished[0].second));
  }
  EXPECT_EQ(resume(file)->parts, allBut({1, 2}));
}

TEST(Checkpoint, ThatNothingWasWrittenToIsGone) {
  const TemporaryFolder folder;
  { ASSERT_TRUE(Checkpoint::open(folder.file("F.parts"), CheckpointUse::kNew)); }
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Checkpoint, GivesBackEachPartWhileOthersAreAppended) {
  const TemporaryFolder folder;
  Result<Checkpoint> checkpoint = Checkpoint::open(folder.file("F.parts"), CheckpointUse::kNew);
  ASSERT_TRUE(checkpoint && checkpoint->begin(kPlan));
  for (std::size_t n = 0; n < kFinished.size(); ++n) {
    EXPECT_FALSE(checkpoint->read(kFinished[n].first)) << "not there yet";
    ASSERT_TRUE(checkpoint->append(kFinished[n].first, kFinished[n].second));
    for (std::size_t before = 0; before <= n; ++before) {
      EXPECT_EQ(checkpoint->read(kFinished[before].first), kFinished[before].second);
    }
  }
  ASSERT_TRUE(checkpoint->append(3, bytesOf("baked once more")));
  EXPECT_EQ(checkpoint->read(3), bytesOf("baked once more"));
}

TEST(Checkpoint, GivesNoPartThatIsAlteredAfterItWasWritten) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  const std::vector<std::size_t> sizes = appendAll(file, CheckpointUse::kNew);
  const std::string whole = contents(file);
  Result<Checkpoint> checkpoint = Checkpoint::open(file, CheckpointUse::kResume);
  ASSERT_TRUE(checkpoint && checkpoint->begin(kPlan));
  for (std::size_t at = sizes[0]; at < whole.size(); ++at) {
    SCOPED_TRACE(at);
    std::string altered = whole;
    altered[at] = static_cast<char>(altered[at] ^ 1);
    folder.write("F.parts", altered);
    for (std::size_t n = 0; n < kFinished.size(); ++n) {
      const bool here = sizes[n] <= at && at < sizes[n + 1];
      EXPECT_EQ(checkpoint->read(kFinished[n].first),
                here ? std::nullopt : std::optional(kFinished[n].second));
    }
  }
}

TEST(Checkpoint, OfACompleteBakeIsGone) {
  const TemporaryFolder folder;
  {
    Result<Checkpoint> checkpoint = Checkpoint::open(folder.file("F.parts"), CheckpointUse::kNew);
    ASSERT_TRUE(checkpoint);
    ASSERT_TRUE(checkpoint->begin(kPlan));
    ASSERT_TRUE(checkpoint->remove());
  }
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(Checkpoint, IsNotMadeOfForeignFilesOrFolders) {
  const TemporaryFolder folder;
  const std::string foreign = "a letter of somebody's, kept for years";
  const Result<Found> kept = resume(folder.write("letter", foreign));
  ASSERT_FALSE(kept);
  EXPECT_NE(kept.error().message.find("letter"), std::string::npos);
  EXPECT_EQ(contents(folder.file("letter")), foreign);
  EXPECT_FALSE(Checkpoint::open(folder.file(""), CheckpointUse::kNew));
  EXPECT_FALSE(Checkpoint::open(folder.file("no/such/folder"), CheckpointUse::kNew));
  EXPECT_FALSE(Checkpoint::open("/dev/null", CheckpointUse::kResume));
}

}  // namespace
}  // namespace sightline::tool_test
