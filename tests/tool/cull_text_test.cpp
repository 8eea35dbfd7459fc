// What `cull` prints.

#include <string>
#include <string_view>
#include <vector>

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

std::string cullText(const std::vector<std::string>& options) {
  const Outcome outcome = runTool(joined({"cull", kCity, "--frames", "0"}, options));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  return outcome.out;
}

// The lines of numbers, each of which begins with two spaces.
std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0, end = 0; (end = text.find('\n', begin)) != std::string::npos; begin = end + 1) {
    if (text.compare(begin, 2, "  ") == 0) {
      lines.push_back(text.substr(begin, end - begin));
    }
  }
  return lines;
}

TEST(CullText, NumbersStandBelowEachOtherWhateverTheyCount) {
  for (const char* method :
       {"frustum", "supporting-planes", "occlusion-tree", "depth-pyramid", "opacity-map"}) {
    const std::string text = cullText({"--method", method});
    const std::vector<std::string> lines = linesOf(text);
    ASSERT_GE(lines.size(), 4u) << text;
    for (const std::string& line : lines) {
      EXPECT_EQ(line.find('.'), lines.front().find('.')) << text;
    }
  }
}

TEST(CullText, OccludersAreCountedWhereSomeAreChosenAlone) {
  const std::string_view occluders = "\n  occluders  ", behind = "\n  occluders behind others  ";
  const std::string alone = cullText({"--method", "depth-pyramid", "--surfaces", "alone"});
  EXPECT_EQ(alone.find("occluders"), std::string::npos) << alone;
  const std::string chosen = cullText({"--method", "depth-pyramid", "--surfaces", "none"});
  EXPECT_NE(chosen.find(occluders), std::string::npos) << chosen;
  EXPECT_NE(chosen.find(behind), std::string::npos) << chosen;
}

}  // namespace
}  // namespace sightline::tool_test
