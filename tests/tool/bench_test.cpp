// sightline bench, end to end.

#include <set>

#include "tests/support/pictures.h"
#include "tests/tool/bench_csv.h"
#include "tests/tool/formats_page.h"
#include "tests/tool/markup_check.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

const std::string kBenchCity = "demo:city?copies=1", kBenchBuilding = "demo:building?floors=1";

// A short bench.
std::vector<std::string> benchOf(const std::string& scene, const std::vector<std::string>& more,
                                 const std::string& frames = "0:400:100", const std::string& repeats = "2") {
  return joined({"bench", scene, "--frames", frames, "--width", "64", "--height", "36", "--repeats", repeats},
                more);
}

std::vector<CsvRow> rowsOf(const std::vector<std::string>& arguments) {
  const Outcome outcome = runTool(joined(arguments, {"--csv", "-"}));
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  return csvRows(outcome.out);
}

double numberOf(const CsvRow& row, const std::string& column) {
  return row.contains(column) && !row.at(column).empty() ? std::stod(row.at(column)) : -1.0;
}

// Which objects each setting keeps, as hashes. A change that makes a method tighter or looser changes them,
// and then they are to be replaced by what this test prints.
TEST(BenchAnswers, AreTheSameOnEveryMachineWithAnyNumberOfThreads) {
  // What is exactly visible is the same for all methods and threads, and is not what is looked at here.
  const TemporaryFolder folder;
  const std::string cache = folder.file("cache");
  const std::vector<std::string> methods{
      "--cache",          cache,
      "--method",         "frustum,occlusion-tree,supporting-planes,opacity-map,depth-pyramid",
      "--occluder-count", "16,64"};
  const std::vector<std::string> pyramids{"--cache",          cache,        "--method",
                                          "depth-pyramid",    "--surfaces", "none,with-occluders",
                                          "--occluder-count", "16,64"};
  const std::vector<std::string> city{"f93ff134933fb1fa", "15e3a98d38db7cef", "b791e06f658d136f",
                                      "1de2a4420b725f9c", "9c34d2550b16d4b1", "e86b3200d5db48f2",
                                      "4acaf4093a7416b7", "9092e699b0ac061c"};
  const std::vector<std::string> city_pyramids{"f93ff134933fb1fa", "5dfa4b38696eba97", "87c1708b585bb053",
                                               "428254f029131eb3", "4e555ee66b1d417e"};
  const std::vector<std::string> building{"40d83cb56c4b5ca0", "de43e5e7f280b4fa", "65176768266b17de",
                                          "3158f99542937da3", "df79ff0470312c73", "c80bfd7fcd088f8b",
                                          "933295b24856760f", "fab51d6f9a28e4e7"};
  const std::vector<std::string> building_pyramids{"40d83cb56c4b5ca0", "88c758a4312cab63", "1f539526d61c93af",
                                                   "fab51d6f9a28e4e7", "ebc0bf52c53148a9"};
  struct Case {
    std::string scene;
    std::vector<std::string> options, golden;
  };
  for (const auto& [scene, options, golden] :
       {Case{kBenchCity, methods, city}, Case{kBenchCity, pyramids, city_pyramids},
        Case{kBenchBuilding, methods, building}, Case{kBenchBuilding, pyramids, building_pyramids}}) {
    for (const std::string threads : {"1", "3"}) {
      std::vector<std::string> answers;
      for (const CsvRow& row :
           rowsOf(joined(benchOf(scene, options, "0:400:100", "1"), {"--threads", threads}))) {
        answers.push_back(row.at("answers"));
      }
      EXPECT_EQ(answers, golden) << scene << ", threads " << threads;
    }
  }
}

TEST(Bench, CountsAreConsistentAndFrustumCullingIsTheBaseline) {
  const std::vector<CsvRow> rows = rowsOf(
      benchOf(kBenchCity, {"--no-cache", "--occluder-count", "64", "--method", "occlusion-tree,depth-pyramid",
                           "--occluders", "area-angle,database", "--object-boxes", "1"}));
  ASSERT_EQ(rows.size(), 5u);
  EXPECT_EQ(rows[0].at("method"), "frustum");
  EXPECT_EQ(numberOf(rows[0], "times_frustum_mean"), 1.0);
  int advised = 0;
  std::set<std::string> settings;
  for (const CsvRow& row : rows) {
    settings.insert(row.at("method") + row.at("options"));
    EXPECT_LE(numberOf(row, "kept"), numberOf(rows[0], "kept"));
    EXPECT_GE(numberOf(row, "kept") + numberOf(row, "missed"), numberOf(row, "witnessed"));
    EXPECT_EQ(numberOf(row, "missed"), 0.0);
    EXPECT_NEAR(numberOf(row, "overestimate_high"), numberOf(row, "kept") / numberOf(row, "witnessed"), 1e-6);
    EXPECT_NEAR(numberOf(row, "overestimate_low"),
                numberOf(row, "kept") / (numberOf(row, "witnessed") + numberOf(row, "undecided")), 1e-6);
    EXPECT_NEAR(numberOf(row, "boxes_overestimate_high"), numberOf(row, "boxes") / numberOf(row, "witnessed"),
                1e-6);
    EXPECT_NEAR(numberOf(row, "boxes_overestimate_low"),
                numberOf(row, "boxes") / (numberOf(row, "witnessed") + numberOf(row, "undecided")), 1e-6);
    EXPECT_GE(numberOf(row, "boxes"), numberOf(row, "witnessed"));
    EXPECT_LE(numberOf(row, "boxes"), numberOf(row, "kept"))
        << "a conservative test of one box keeps at least the visible boxes";
    EXPECT_EQ(numberOf(row, "undecided_boxes"), 0.0);
    EXPECT_LE(numberOf(row, "several_boxes"), numberOf(row, "boxes")) << "they lie in the one box";
    EXPECT_GE(numberOf(row, "several_boxes"), numberOf(row, "witnessed"));
    EXPECT_NEAR(numberOf(row, "several_boxes_overestimate_high"),
                numberOf(row, "several_boxes") / numberOf(row, "witnessed"), 1e-6);
    EXPECT_EQ(row.at("frames"), "4");
    EXPECT_EQ(row.at("rounds"), "2");
    for (const std::string time : {"cull_us_median", "cull_us_mean", "cull_us_p99", "cpu_us_mean"}) {
      EXPECT_LE(numberOf(row, time + "_low"), numberOf(row, time + "_high")) << time;
      EXPECT_GE(numberOf(row, time + "_low"), 0.0) << time;
    }
    EXPECT_EQ(row.at("draw_us_mean"), "") << "nothing was drawn";
    EXPECT_GT(numberOf(row, "hierarchy_bytes"), 0.0);
    EXPECT_EQ(numberOf(row, "databases_bytes") > 0.0,
              row.at("options").find("database") != std::string::npos);
    advised += row.at("advised") == "1" ? 1 : 0;
    EXPECT_TRUE(row.at("advised") == "0" || row.at("front") == "1");
  }
  EXPECT_EQ(advised, 1);
  EXPECT_EQ(settings.size(), rows.size());
}

// How `bench` is called on a wall with objects behind it, which are given as OBJ and whose first vertex is
// the fifth, as seen from the origin.
std::vector<std::string> benchOfWall(const TemporaryFolder& folder, const std::string& objects) {
  const std::string scene = folder.write(
                        "wall.obj",
                        "o wall\nv -4 -4 -5\nv 1 -4 -5\nv 1 4 -5\nv -4 4 -5\nf 1 2 3 4\n" + objects),
                    path = folder.write("path.json", R"({"frames":[{"eye":[0,0,0],"forward":[0,0,-1]}]})");
  return {"bench", scene, "--path", path, "--no-cache", "--method", "frustum"};
}

// A wall, and an object of two triangles behind it, one near, one far and to the side: a corner of the box
// around both looks out beside the wall, those around each do not.
TEST(Bench, SeveralBoxesAnObjectAreFewerThanOne) {
  const TemporaryFolder folder;
  const std::vector<std::string> bench =
      benchOfWall(folder,
                  "o two\nv -1 -1 -10\nv 0 -1 -10\nv 0 0 -10\n"
                  "v 2 -1 -13\nv 2.5 -1 -13\nv 2.5 0 -13\nf 5 6 7\nf 8 9 10\n");
  const json result = toolJson(bench)["scenes"][0];
  EXPECT_EQ(result["witnessed"], 1);
  EXPECT_EQ(result["boxes"], 2);
  EXPECT_EQ(result["several_boxes"], 1);
  EXPECT_EQ(result["undecided_several_boxes"], 0);
  EXPECT_EQ(result["several_boxes_overestimate"], json::parse("[1.0, 1.0]"));
  EXPECT_NE(runTool(bench).out.find("1.00 that of several (1 objects)"), std::string::npos);
  const TemporaryFolder kept;
  std::vector<std::string> cached = bench;
  std::erase(cached, "--no-cache");
  cached.insert(cached.end(), {"--cache", kept.file("cache")});
  for (int run = 0; run < 2; ++run) {
    const json again = toolJson(cached)["scenes"][0];
    EXPECT_EQ(again["frames_from_cache"], run);
    EXPECT_EQ(again["several_boxes"], 1) << "the answers for several boxes have a file of their own";
    EXPECT_EQ(again["boxes"], 2);
  }
}

// A wall, an object behind it that is hidden while the far corner of its box looks out beside the wall, and
// one whose box is hidden as well.
TEST(Bench, BoxesAreThoseThatAnyTestOfBoxesMustKeep) {
  const TemporaryFolder folder;
  const std::vector<std::string> bench =
      benchOfWall(folder,
                  "o slanted\nv -1 -1 -10\nv 1 -1 -10\nv 2.5 1 -13\nf 5 6 7\n"
                  "o hidden\nv -1 -1 -8\nv 0 -1 -8\nv 0 0 -9\nf 8 9 10\n");
  const json result = toolJson(bench)["scenes"][0];
  EXPECT_EQ(result["witnessed"], 1);
  EXPECT_EQ(result["boxes"], 2);
  EXPECT_EQ(result["undecided_boxes"], 0);
  EXPECT_EQ(result["boxes_overestimate"], json::parse("[2.0, 2.0]"));
  EXPECT_EQ(result["runs"][0]["kept"], 3);
  EXPECT_NE(runTool(bench).out.find("boxes: 2.00 kept/exact"), std::string::npos);
  const json undecided = toolJson(joined(bench, {"--proof-steps", "0"}))["scenes"][0];
  EXPECT_EQ(undecided["boxes"], 1) << "only what rays have seen";
  EXPECT_EQ(undecided["undecided_boxes"], 2);
}

TEST(Bench, KeepsWhatCullKeeps) {
  const json result = toolJson(benchOf(kBenchCity, {"--no-cache", "--method", "occlusion-tree",
                                                    "--occluder-count", "64", "--variant", "FSC"}));
  const json cull = toolJson(
      {"cull", kBenchCity, "--frames", "0:400:100", "--method", "occlusion-tree", "--variant", "FSC"});
  std::size_t kept = 0;
  for (const json& frame : cull["frames"]) {
    kept += frame["visible"].size();
  }
  ASSERT_EQ(result["scenes"][0]["runs"].size(), 2u);
  EXPECT_EQ(result["scenes"][0]["runs"][1]["options"], cull["options"]);
  EXPECT_EQ(result["scenes"][0]["runs"][1]["kept"], kept);
}

TEST(Bench, ColumnsAndKeysAreDescribed) {
  const TemporaryFolder folder;
  expectDocumented(toolJson(benchOf(kBenchCity, {"--no-cache", "--draw", "--method", "occlusion-tree",
                                                 "--csv", folder.file("bench.csv")})),
                   {"bench"});
  std::set<std::string> words = wordsOfSection("## bench");
  const std::vector<std::vector<std::string>> lines = csvLines(contents(folder.file("bench.csv")));
  ASSERT_FALSE(lines.empty());
  for (const std::string& column : lines.front()) {
    const std::size_t end = std::min(column.rfind("_low"), column.rfind("_high"));
    EXPECT_TRUE(words.contains(column) || (end != std::string::npos && words.contains(column.substr(0, end))))
        << "docs/formats.md does not describe the column " << column;
  }
}

TEST(Bench, ExactVisibilityIsKeptFromRunToRun) {
  const TemporaryFolder folder;
  const auto bench_of = [&](const std::string& scene, const std::string& frames) {
    return benchOf(scene, {"--cache", folder.file("cache"), "--method", "frustum"}, frames, "1");
  };
  const std::vector<std::string> bench = bench_of(kBenchCity, "0:400:100");
  const auto scene = [](const std::vector<std::string>& arguments) {
    return toolJson(arguments)["scenes"][0];
  };
  const json first = scene(bench);
  EXPECT_EQ(first["frames_from_cache"], 0);
  const json second = scene(bench);
  EXPECT_EQ(second["frames_from_cache"], 4);
  for (const auto& entry : std::filesystem::directory_iterator(folder.file("cache"))) {
    std::filesystem::resize_file(entry.path(), 20);
  }
  const json damaged = scene(bench);
  EXPECT_EQ(damaged["frames_from_cache"], 0);
  const json mended = scene(bench);
  EXPECT_EQ(mended["frames_from_cache"], 4);
  EXPECT_EQ(scene(bench_of(kBenchCity, "0:400:50"))["frames_from_cache"], 4)
      << "frames are kept by their views";
  EXPECT_EQ(scene(bench_of("demo:city?copies=1&seed=2", "0:400:100"))["frames_from_cache"], 0);
  EXPECT_EQ(scene(joined(bench, {"--proof-steps", "5"}))["frames_from_cache"], 0);
  for (const json& other : {second, damaged, mended}) {
    EXPECT_EQ(first["witnessed"], other["witnessed"]);
    EXPECT_EQ(first["undecided"], other["undecided"]);
    EXPECT_EQ(first["boxes"], other["boxes"]);
    EXPECT_EQ(first["undecided_boxes"], other["undecided_boxes"]);
  }
}

TEST(Bench, TheUsualCacheIsWhereTheEnvironmentSays) {
  const TemporaryFolder folder;
  const auto bench_in = [&](const std::string& variables, const std::vector<std::string>& more) {
    std::vector<std::string> words{"-c", "env -u XDG_CACHE_HOME -u HOME " + variables + " \"$0\" \"$@\"",
                                   toolFile()};
    return runProgram("/bin/sh",
                      joined(words, benchOf(kBenchCity, joined({"--method", "frustum"}, more), "0", "1")));
  };
  EXPECT_EQ(bench_in("XDG_CACHE_HOME=" + folder.file("cache"), {}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.file("cache/sightline")));
  EXPECT_EQ(bench_in("HOME=" + folder.file("home"), {}).code, 0);
  EXPECT_TRUE(std::filesystem::exists(folder.file("home/.cache/sightline")));
  const Outcome homeless = bench_in("A=1", {});
  EXPECT_EQ(homeless.code, 0) << homeless.err;
  EXPECT_EQ(homeless.err, "");
  const Outcome no_folder = bench_in("HOME=/dev/null", {});
  EXPECT_EQ(no_folder.code, 0);
  EXPECT_NE(no_folder.err.find("is not kept"), std::string::npos) << no_folder.err;
  const std::size_t before = folder.entries();
  EXPECT_EQ(bench_in("HOME=" + folder.file("other"), {"--no-cache"}).code, 0);
  EXPECT_EQ(folder.entries(), before);
}

TEST(Bench, WritesAReportOfAllScenes) {
  const TemporaryFolder folder;
  const std::string report = folder.file("new/report");
  const Outcome outcome = runTool({"bench", kBenchCity, kBenchBuilding, "--frames", "0:400:200", "--width",
                                   "64", "--height", "36", "--repeats", "1", "--no-cache", "-o", report});
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("for " + kBenchCity + " use "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find("for " + kBenchBuilding + " use "), std::string::npos) << outcome.out;
  EXPECT_NE(outcome.out.find(" core "), std::string::npos) << outcome.out;
  const std::string page = contents(report + "/index.html");
  EXPECT_EQ(tool::firstMarkupError(page), "");
  EXPECT_NE(page.find("demo:building?floors=1"), std::string::npos);
  EXPECT_NE(page.find("--frames 0:400:200"), std::string::npos) << "the whole command line";
  EXPECT_NE(page.find("advised"), std::string::npos);
  EXPECT_NE(page.find("boxes: 1."), std::string::npos) << "the least that any test of boxes must keep";
  EXPECT_EQ(parse(contents(report + "/bench.json"))["scenes"].size(), 2u);
  EXPECT_EQ(csvRows(contents(report + "/bench.csv")).size(), 2u * 11u)
      << "unless told otherwise: frustum culling, three methods with three numbers of occluders, and "
         "surfaces";
}

TEST(Bench, DrawsWhatIsKept) {
  SIGHTLINE_SKIP_WITHOUT_PICTURES();
  for (const CsvRow& row :
       rowsOf(benchOf(kBenchCity, {"--no-cache", "--draw", "--method", "occlusion-tree"}))) {
    EXPECT_GT(numberOf(row, "draw_us_mean"), 0.0);
  }
}

TEST(Bench, ASettingIsMeasuredOnce) {
  EXPECT_EQ(rowsOf(benchOf(kBenchCity, {"--no-cache", "--occluder-count", "64", "--method",
                                        "frustum,occlusion-tree,frustum"}))
                .size(),
            2u);
}

TEST(Bench, BadUsageAndInputAreOneLine) {
  const TemporaryFolder folder;
  expectRefused({"bench"}, "SCENE");
  expectRefused({"bench", ""}, "SCENE");
  expectRefused({"bench", kBenchCity, folder.file("missing.glb")}, "missing.glb");
  expectRefused({"bench", folder.write("cut.glb", "glTF")}, "cut.glb");
  expectRefused({"bench", kBenchCity, kBenchCity}, "twice");
  expectRefused({"bench", kBenchCity, "--method", "oclusion-tree"}, "did you mean 'occlusion-tree'?");
  expectRefused({"bench", kBenchCity, "--frames", "9:3"}, "--frames");
  expectRefused({"bench", kBenchCity, "--path", "nowhere"}, "nowhere");
  expectRefused({"bench", kBenchCity, "--cache", "a", "--no-cache"}, "--cache");
  expectRefused({"bench", kBenchCity, "--csv", "-", "--json", "-"}, "--csv");
  expectRefused({"bench", kBenchCity, kBenchBuilding, "--baked", "F.sight"}, "--baked");
  for (const std::string bad : {"0", "-1", "x", "", "99999999999"}) {
    expectRefused({"bench", kBenchCity, "--repeats", bad}, "--repeats");
  }
}

TEST(Bench, OutputsThatCannotBeWrittenAreRefusedBeforeTheWork) {
  const TemporaryFolder folder;
  const std::string file = folder.write("file", "old");
  expectRefused(benchOf(kBenchCity, {"--no-cache", "--csv", folder.file("no/such/bench.csv")}), "bench.csv");
  expectRefused(benchOf(kBenchCity, {"--no-cache", "--json", folder.file("")}), folder.file(""));
  expectRefused(benchOf(kBenchCity, {"--no-cache", "-o", file}), "file");
  expectRefused(benchOf(kBenchCity, {"--no-cache", "-o", file + "/below"}), "below");
  expectRefused(benchOf(kBenchCity, {"--cache", file}), "--cache");
  expectRefused(benchOf(kBenchCity, {"--cache", file + "/below"}), "--cache");
  expectRefused(benchOf(kBenchCity, {"--no-cache", "--csv", file, "--json", file}), "--csv");
  EXPECT_EQ(contents(file), "old");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Bench, OutputsAreNeverInputs) {
  const TemporaryFolder folder;
  const std::string triangle = "v 0 0 -5\nv 1 0 -5\nv 0 1 -5\nf 1 2 3\n";
  const std::string path = R"({"frames":[{"eye":[0,0,0],"forward":[0,0,-1]}]})";
  const std::string scene = folder.write("s.obj", triangle), walk = folder.write("bench.json", path);
  const std::vector<std::string> bench{"bench", scene, "--path", walk, "--no-cache"};
  for (const std::string& input : {scene, walk}) {
    expectRefused(joined(bench, {"--csv", input}), "the input itself");
    expectRefused(joined(bench, {"--json", input}), "the input itself");
  }
  expectRefused(joined(bench, {"-o", std::filesystem::path(scene).parent_path().string()}),
                "the input itself");
  EXPECT_EQ(contents(scene), triangle);
  EXPECT_EQ(contents(walk), path);
}

}  // namespace
}  // namespace sightline::tool_test
