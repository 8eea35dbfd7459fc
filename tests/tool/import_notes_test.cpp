// What a scene's file leaves open is said once, on stderr.

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

}  // namespace
}  // namespace sightline::tool_test
