// All papers with one command, on scenes that take a moment.

#include <filesystem>

#include "tests/tool/all_papers.h"
#include "tests/tool/formats_page.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

TEST_F(AllPapers, EachPaperHasAPageAndTheIndexLeadsToIt) {
  const std::string index = contents(out() + "/index.html");
  const json all = parse(contents(folder_->file("all.json")));
  ASSERT_EQ(all["papers"].size(), kPapers.size());
  for (std::size_t i = 0; i < kPapers.size(); ++i) {
    const std::string& paper = kPapers[i];
    EXPECT_NE(index.find("./" + paper + "/index.html"), std::string::npos) << paper;
    EXPECT_NE(contents(out() + "/" + paper + "/index.html").find("<table>"), std::string::npos) << paper;
    EXPECT_EQ(all["papers"][i], parse(contents(jsonOf(paper)))) << paper;
    expectDocumented(all["papers"][i], {"reproduce"});
  }
}

TEST_F(AllPapers, FinishedPapersAreNotRunAgain) {
  std::vector<std::string> before;
  for (const std::string& paper : kPapers) {
    before.push_back(contents(jsonOf(paper)));
  }
  const Outcome again = reproduceAll(out());
  ASSERT_EQ(again.code, 0) << again.err;
  for (std::size_t i = 0; i < kPapers.size(); ++i) {
    EXPECT_NE(again.out.find(kPapers[i] + ": finished before"), std::string::npos) << again.out;
    EXPECT_EQ(contents(jsonOf(kPapers[i])), before[i]) << "times differ from run to run";
  }
}

TEST_F(AllPapers, WhatIsDamagedOrMeasuredOtherwiseIsRunAgain) {
  const std::string other = folder_->file("other");
  std::filesystem::copy(out(), other, std::filesystem::copy_options::recursive);
  const auto path = [&](const std::string& paper) { return other + "/" + paper + "/reproduce.json"; };
  json otherwise = parse(contents(path("bittner")));
  otherwise["measured_by"] = "other options";
  std::ofstream(path("bittner")) << otherwise;
  const std::string whole = contents(path("saona-vazquez"));
  std::ofstream(path("saona-vazquez")) << whole.substr(0, whole.size() / 2);
  const Outcome again = reproduceAll(other);
  ASSERT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(again.out.find("bittner: finished before"), std::string::npos);
  EXPECT_EQ(again.out.find("saona-vazquez: finished before"), std::string::npos);
  EXPECT_NE(again.out.find("snyder-lengyel: finished before"), std::string::npos);
  EXPECT_EQ(parse(contents(path("bittner")))["measured_by"],
            parse(contents(jsonOf("bittner")))["measured_by"]);
  EXPECT_EQ(parse(contents(path("saona-vazquez")))["paper"], "saona-vazquez");
}

TEST_F(AllPapers, OtherOptionsAreAnotherMeasurement) {
  const json bittner = parse(contents(jsonOf("bittner"))), snyder = parse(contents(jsonOf("snyder-lengyel")));
  EXPECT_EQ(bittner["measured_by"],
            "reproduce bittner --scene demo:city?copies=1 --frames 0:400:100 --width 64 --height 36 --short");
  EXPECT_EQ(snyder["measured_by"], "reproduce snyder-lengyel --height 36 --short")
      << "what means nothing for a paper is left out";
}

TEST(ReproduceAll, NeedsAFolder) {
  expectRefused({"reproduce", "all"}, "-o");
}

}  // namespace
}  // namespace sightline::tool_test
