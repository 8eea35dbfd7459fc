#pragma once

// Tests of `reproduce all`, which is run once for all of them.

#include <memory>
#include <string>
#include <vector>

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {

inline const std::vector<std::string> kPapers{"bittner", "coorg-teller", "poon-wang", "saona-vazquez",
                                              "snyder-lengyel"};

inline Outcome reproduceAll(const std::string& folder, const std::vector<std::string>& more = {}) {
  return runTool(joined({"reproduce", "all", "--short", "--scene", "demo:city?copies=1", "--frames",
                         "0:400:100", "--width", "64", "--height", "36", "--depth", "3", "-o", folder},
                        more));
}

class AllPapers : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = std::make_unique<TemporaryFolder>();
    outcome_ = std::make_unique<Outcome>(reproduceAll(out(), {"--json", folder_->file("all.json")}));
  }
  static void TearDownTestSuite() {
    outcome_.reset();
    folder_.reset();
  }
  void SetUp() override { ASSERT_EQ(outcome_->code, 0) << outcome_->err; }

  static std::string out() { return folder_->file("reports"); }
  static std::string jsonOf(const std::string& paper) { return out() + "/" + paper + "/reproduce.json"; }

  inline static std::unique_ptr<TemporaryFolder> folder_;
  inline static std::unique_ptr<Outcome> outcome_;
};

}  // namespace sightline::tool_test
