// Tests `--doors` and `--closed`: what closed doors hide, and that nothing of it is wrong.

#include <gtest/gtest.h>

#include <memory>

#include "sightline/pvs/bake/write_sight.h"
#include "tests/support/rounds.h"
#include "tests/tool/formats_page.h"
#include "tests/tool/sight_contents.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

const std::string kHouse = "demo:building?floors=1&doors=shut";
// That of the room in which viewers are, and one along the corridor that is not seen from there.
const std::string kDoors = "floor 0 room 0-0 door leaf,floor 0 room 0-1*leaf";

class DoorCommands : public ::testing::Test {
 protected:
  // The bake of a part of one room is made once for all tests.
  static void SetUpTestSuite() {
    made_ = std::make_unique<TemporaryFolder>();
    report_ = bake("house.sight", {});
  }
  static void TearDownTestSuite() { made_.reset(); }

  static std::string file(const std::string& name = "house.sight") { return made_->file(name); }
  static json bake(const std::string& name, const std::vector<std::string>& more) {
    return toolJson(
        joined({"bake", kHouse, "-o", file(name), "--occlusion", "fused", "--depth", "1", "--triangle-budget",
                "300", "--region", "0.5,0.2,-4.2,3,2.2,-2", "--doors", kDoors},
               more));
  }
  static Outcome run(const std::string& command, const std::vector<std::string>& more) {
    return runTool(joined({command, kHouse, "--baked", file()}, more));
  }
  static std::string firstDoor() { return std::to_string(report_["doors"][0]["objects"][0].get<int>()); }

  inline static std::unique_ptr<TemporaryFolder> made_;
  inline static json report_;
};

TEST_F(DoorCommands, AreToldOfByBakeAndInfo) {
  expectDocumented(report_, {"bake", "info of a baked file"});
  const std::size_t groups = report_["doors"].size();
  ASSERT_EQ(groups, 3u);
  EXPECT_EQ(report_["doors"].back()["objects"].size(), groups - 1) << "all doors are the last group";
  EXPECT_EQ(report_["settings"]["all"]["doors"].size(), groups - 1);
  const json open = toolJson({"info", file()}), closed = toolJson({"info", file(), "--closed", "all"});
  expectDocumented(closed, {"info of a baked file"});
  EXPECT_LT(closed["sets"]["objects"]["mean"], open["sets"]["objects"]["mean"]);
}

TEST_F(DoorCommands, LeaveOutNothingThatIsVisibleWhicheverAreClosed) {
  for (const std::string& closed : {std::string(), firstDoor(), std::string("all")}) {
    const std::vector<std::string> doors =
        closed.empty() ? std::vector<std::string>() : std::vector<std::string>{"--closed", closed};
    const Outcome regions =
        run("verify", joined({"--proof", "--pairs", std::to_string(test::rounds(40)), "--json", "-"}, doors));
    EXPECT_EQ(regions.code, 0) << closed << regions.err;
    const Outcome views =
        run("verify", joined({"--path", "cells", "--frames", test::sanitized() ? "0:2000:6" : "0:2000:2",
                              "--width", "64", "--height", "64", "--method",
                              "visibility-octree,depth-pyramid", "--visible-sets", "on", "--json", "-"},
                             doors));
    EXPECT_EQ(views.code, 0) << closed << views.err << views.out.substr(0, 2000);
  }
}

// A file that hides with all doors open what only the closed ones hide is contradicted.
TEST_F(DoorCommands, AreContradictedWhereWhatTheyHideIsVisible) {
  const Result<SightFile> sight = SightFile::open(file());
  ASSERT_TRUE(sight);
  BakedVisibility baked = contentsOf(*sight);
  // Each door hides all but the doors, whatever the cell.
  const std::uint32_t everything = baked.sets.count();
  baked.sets.nodes.push_back(0);
  baked.sets.first.push_back(baked.sets.nodes.size());
  baked.doors.hidden.clear();
  baked.doors.hidden_ends.clear();
  for (std::uint32_t set = 0; set < baked.sets.count(); ++set) {
    baked.doors.hidden.push_back({0, everything});
    baked.doors.hidden_ends.push_back(set + 1);
  }
  ASSERT_TRUE(writeSight(file("forged.sight"), baked));
  const auto verify = [](const std::vector<std::string>& doors) {
    return runTool(
        joined({"verify", kHouse, "--baked", file("forged.sight"), "--proof", "--pairs", "40"}, doors));
  };
  EXPECT_EQ(verify({}).code, 0);
  EXPECT_EQ(verify({"--closed", firstDoor()}).code, 1);
}

TEST_F(DoorCommands, AreCheckedAsTheyAreClosed) {
  const auto check = [](const std::vector<std::string>& doors) {
    return toolJson(joined({"check", file(), kHouse, "--divisions", "0", "--rays", "2"}, doors));
  };
  EXPECT_GT(check({"--closed", "all"})["claims"], check({})["claims"]);
}

TEST_F(DoorCommands, ChangeWhatAQueryAnswers) {
  const auto visible = [](const std::vector<std::string>& doors) {
    const json report =
        toolJson(joined({"query", file(), "--points", "1,1,-3", "--points", "2,2,-4"}, doors));
    std::size_t count = 0;
    for (const json& point : report["points"]) {
      count += point["visible"].size();
    }
    return count;
  };
  EXPECT_EQ(visible({"--closed", "all"}), visible({"--closed", firstDoor()}));
  EXPECT_LT(visible({"--closed", firstDoor()}), visible({}));
}

TEST_F(DoorCommands, GiveTheSameBytesWhateverTheThreads) {
  bake("threads.sight", {"--threads", "3"});
  EXPECT_TRUE(contents(file("threads.sight")) == contents(file()));
}

TEST_F(DoorCommands, AreRefusedInOneLine) {
  const auto refused = [](const Outcome& outcome, const std::string& what) {
    EXPECT_EQ(outcome.code, 2) << what << outcome.out;
    EXPECT_EQ(outcome.errorLines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(what), std::string::npos) << outcome.err;
  };
  const auto bakeWith = [](const std::string& doors) {
    return runTool({"bake", kHouse, "-o", file("none.sight"), "--doors", doors});
  };
  refused(bakeWith("no such door"), "no such door");
  refused(bakeWith("1,,2"), "--doors");
  refused(bakeWith("100000"), "100000");
  refused(bakeWith("1+"), "--doors");
  EXPECT_EQ(contents(file("none.sight")), "");
  refused(run("walk", {"--closed", "0", "-o", file("report"), "--no-pictures"}), "--closed '0'");
  refused(run("cull", {"--closed", "x"}), "--closed 'x'");
  refused(run("verify", {"--closed", "1,all", "--proof"}), "--closed");
  refused(runTool({"query", file(), "--points", "1,1,1", "--closed", ""}), "--closed");
  refused(runTool({"verify", kHouse, "--closed", "1", "--frames", "0"}), "--baked");
  refused(runTool({"info", kHouse, "--closed", "1"}), "--closed");
}

}  // namespace
}  // namespace sightline::tool_test
