// What the tool says of a scene that it has read.

#include "tests/io/glb_builder.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

TEST(SceneNotes, ObjectsThatMoveAreCountedOnStderr) {
  const TemporaryFolder folder;
  test::Glb glb = test::oneTriangle();
  const std::string still = folder.write("still.glb", glb.bytes());
  const Outcome of_still = runTool({"info", still});
  EXPECT_EQ(of_still.code, 0) << of_still.err;
  EXPECT_EQ(of_still.err, "");

  const int times = glb.addAccessor<float>({0, 1}, "SCALAR", 1);
  const int values = glb.addPositions({0, 0, 0, 9, 0, 0});
  glb.json["animations"] = {
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
       {"samplers", {{{"input", times}, {"output", values}}}}}};
  const std::string moving = folder.write("moving.glb", glb.bytes());
  const Outcome of_moving = runTool({"info", moving});
  EXPECT_EQ(of_moving.code, 0) << of_moving.err;
  EXPECT_EQ(of_moving.err.find("sightline: " + moving + ": objects that move,"), 0u) << of_moving.err;
  EXPECT_NE(of_moving.err.find(": 1. They stand in their rest pose"), std::string::npos) << of_moving.err;
  EXPECT_EQ(of_moving.errorLines(), 1);
}

}  // namespace
}  // namespace sightline::tool_test
