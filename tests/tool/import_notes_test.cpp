// What a scene's file leaves open is said once, on stderr.

#include "tests/io/glb_builder.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

TEST(ImportNotes, TellWhichMaterialsAreMissing) {
  const TemporaryFolder folder;
  const std::string scene =
      folder.write("s.obj", "mtllib paint.mtl\nv 1 0 -5\nv 1 1 -5\nv 0 1 -5\nusemtl red\nf 1 2 3\n");
  const Outcome outcome = runTool({"info", scene});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err,
            "sightline: " + scene +
                ": 1 face has a material that no .mtl file defines (\"red\"); it may be glass, so "
                "it hides nothing; put \"paint.mtl\" beside the file, or define them\n");
  folder.write("paint.mtl", "newmtl red\n");
  EXPECT_EQ(runTool({"info", scene}).err, "");
}

TEST(ImportNotes, TellThatPolygonsCrossThemselves) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("s.obj", "v 0 0 -5\nv 1 1 -5\nv 1 0 -5\nv 0 1 -5\nf 1 2 3 4\n");
  const Outcome outcome = runTool({"info", scene});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.errorLines(), 1) << outcome.err;
  EXPECT_NE(outcome.err.find("s.obj: 1 polygon crosses itself"), std::string::npos) << outcome.err;
}

TEST(ImportNotes, TellHowManyObjectsMove) {
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
