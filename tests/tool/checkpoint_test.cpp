// Tests what an unfinished bake leaves: whatever happened to the file, whole parts are found again, and no
// others.

#include "tools/sightline/bake/checkpoint.h"

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using tool::Checkpoint;
using tool::CheckpointUse;

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

void appendAll(const std::string& file, CheckpointUse use) {
  Result<Checkpoint> checkpoint = Checkpoint::open(file, use);
  ASSERT_TRUE(checkpoint) << checkpoint.error().message;
  ASSERT_TRUE(checkpoint->begin(kPlan));
  for (const auto& [part, bytes] : kFinished) {
    ASSERT_TRUE(checkpoint->append(part, bytes));
  }
}

Result<BakedParts> resume(const std::string& file, std::uint64_t plan = kPlan) {
  Result<Checkpoint> checkpoint = Checkpoint::open(file, CheckpointUse::kResume);
  if (!checkpoint) {
    return checkpoint.error();
  }
  return checkpoint->begin(plan);
}

// The number n if `parts` holds exactly the first n of kFinished, otherwise -1.
int firstOnes(const BakedParts& parts) {
  for (std::size_t n = 0; n <= kFinished.size(); ++n) {
    BakedParts expected;
    for (std::size_t i = 0; i < n; ++i) {
      expected[kFinished[i].first] = kFinished[i].second;
    }
    if (parts == expected) {
      return static_cast<int>(n);
    }
  }
  return -1;
}

TEST(Checkpoint, GivesBackWhatWasAppended) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  appendAll(file, CheckpointUse::kNew);
  const Result<BakedParts> parts = resume(file);
  ASSERT_TRUE(parts) << parts.error().message;
  EXPECT_EQ(firstOnes(*parts), 3);
}

TEST(Checkpoint, CutAnywhereItHasTheWholePartsBeforeTheCutAndGoesOn) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  appendAll(file, CheckpointUse::kNew);
  const std::string whole = contents(file);
  int before = 0;
  for (std::size_t length = 0; length <= whole.size(); ++length) {
    folder.write("F.parts", whole.substr(0, length));
    const Result<BakedParts> parts = resume(file);
    ASSERT_TRUE(parts) << length << ": " << parts.error().message;
    const int found = firstOnes(*parts);
    EXPECT_GE(found, before) << length;
    EXPECT_LE(found, before + 1) << length;
    before = found;
    // What is appended now is not lost behind the torn end.
    appendAll(file, CheckpointUse::kResume);
    const Result<BakedParts> again = resume(file);
    ASSERT_TRUE(again) << length;
    EXPECT_EQ(firstOnes(*again), 3) << length;
  }
  EXPECT_EQ(before, 3);
}

TEST(Checkpoint, AlteredAnywhereItGivesNoAlteredPart) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.parts");
  appendAll(file, CheckpointUse::kNew);
  const std::string whole = contents(file);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const int bit : {0, 7}) {
      std::string altered = whole;
      altered[at] = static_cast<char>(altered[at] ^ (1 << bit));
      folder.write("F.parts", altered);
      const Result<BakedParts> parts = resume(file);
      if (parts) {
        const int found = firstOnes(*parts);
        EXPECT_GE(found, 0) << "byte " << at;
        EXPECT_LT(found, 3) << "byte " << at;
      } else {
        EXPECT_NE(parts.error().message.find("F.parts"), std::string::npos);
      }
    }
  }
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
  const Result<BakedParts> parts = anew->begin(kPlan + 1);
  ASSERT_TRUE(parts);
  EXPECT_EQ(firstOnes(*parts), 0);
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
  EXPECT_EQ(firstOnes(*resume(file)), 1);
}

TEST(Checkpoint, ThatNothingWasWrittenToIsGone) {
  const TemporaryFolder folder;
  { ASSERT_TRUE(Checkpoint::open(folder.file("F.parts"), CheckpointUse::kNew)); }
  EXPECT_EQ(folder.entries(), 0u);
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
  const Result<BakedParts> parts = resume(folder.write("letter", foreign));
  ASSERT_FALSE(parts);
  EXPECT_NE(parts.error().message.find("letter"), std::string::npos);
  EXPECT_EQ(contents(folder.file("letter")), foreign);
  EXPECT_FALSE(Checkpoint::open(folder.file(""), CheckpointUse::kNew));
  EXPECT_FALSE(Checkpoint::open(folder.file("no/such/folder"), CheckpointUse::kNew));
  EXPECT_FALSE(Checkpoint::open("/dev/null", CheckpointUse::kResume));
}

}  // namespace
}  // namespace sightline::tool_test
