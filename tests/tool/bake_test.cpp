// Tests `bake`: the file is the same however the work is spread, and bad options are refused.

#include <fmt/format.h>

#include <array>
#include <sstream>
#include <string>

#include "sightline/comparison/viewpoint_database.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/io/import.h"
#include "sightline/occluders/occluder_database.h"
#include "sightline/pvs/query/sight_file.h"
#include "tests/tool/start_tool.h"
#include "tools/sightline/bake/checkpoint.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

const std::string kShip = "demo:ship?decks=3&rooms=4&machinery=0";
// A scene of two walls, one behind the other, far from the origin.
const std::string kWalls =
    "v 500000 0 0\nv 500010 0 0\nv 500010 5 0\nv 500000 5 0\n"
    "v 500002 1 -8\nv 500006 1 -8\nv 500006 3 -8\nf 1 2 3\nf 1 3 4\no behind\nf 5 6 7\n";

std::vector<std::string> bakeArguments(const std::string& scene, const std::string& output,
                                       const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"bake", scene, "-o", output, "--depth", "4"};
  if (scene == kShip && std::find(more.begin(), more.end(), "--triangle-budget") == more.end()) {
    arguments.insert(arguments.end(), {"--triangle-budget", "300"});  // so few that there are many parts
  }
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

// How many lines the tool itself wrote (mpirun adds some when a process fails), without the one that says how
// to go on after an interruption: a bake that takes longer than two seconds writes it.
std::ptrdiff_t ownLines(const std::string& text) {
  std::istringstream all(text);
  std::ptrdiff_t lines = 0;
  for (std::string line; std::getline(all, line);) {
    lines += line.starts_with("sightline: ") && line.find("should this be interrupted") == std::string::npos;
  }
  return lines;
}

// The plan's hash, which the report gives as 16 hexadecimal digits.
std::uint64_t planOf(const json& report) {
  return std::stoull(report["plan"].get<std::string>(), nullptr, 16);
}

TEST(Bake, GivesTheSameBytesWithAnyThreads) {
  const TemporaryFolder folder;
  const std::string file = folder.file("1.sight");
  const Outcome one = runTool(bakeArguments(kShip, file, {"--threads", "1"}));
  ASSERT_EQ(one.code, 0) << one.err;
  EXPECT_EQ(folder.entries(), 1u) << "nothing is left but the file";
  const Outcome two =
      runTool(bakeArguments(kShip, folder.file("2.sight"), {"--threads", "2", "--sample-memory", "1"}));
  ASSERT_EQ(two.code, 0) << two.err;
  EXPECT_TRUE(contents(file) == contents(folder.file("2.sight")));
}

TEST(Bake, GivesTheSameBytesWithAnyProcesses) {
  if (!haveMpirun()) {
    GTEST_SKIP() << kNoMpirun;
  }
  const TemporaryFolder folder;
  ASSERT_EQ(runTool(bakeArguments(kShip, folder.file("0.sight"))).code, 0);
  const std::string expected = contents(folder.file("0.sight"));
  for (int processes = 1; processes <= 3; ++processes) {
    const std::string file = folder.file(std::to_string(processes) + ".sight");
    const Outcome outcome =
        Started(toolWords(processes, bakeArguments(kShip, file, {"--threads", "2", "--json", "-"}))).wait();
    const json report = printedJson(outcome);
    EXPECT_TRUE(contents(file) == expected) << processes << " processes";
    EXPECT_EQ(report["processes"], processes) << outcome.out;
    EXPECT_GE(report["all_peak_bytes"], report["peak_bytes"]);
  }
  EXPECT_EQ(folder.entries(), 4u);
}

TEST(Bake, EndsAllProcessesWithOneLine) {
  if (!haveMpirun()) {
    GTEST_SKIP() << kNoMpirun;
  }
  const TemporaryFolder folder;
  const std::string file = folder.file("F.sight");
  for (const std::vector<std::string>& bad :
       {bakeArguments(folder.file("missing.glb"), file), bakeArguments(kShip, folder.file("")),
        bakeArguments(kShip, file, {"--bogus"})}) {
    const Outcome outcome = Started(toolWords(3, bad)).wait();
    EXPECT_EQ(outcome.code, 2) << ::testing::PrintToString(bad);
    EXPECT_EQ(ownLines(outcome.err), 1) << outcome.err;
    EXPECT_EQ(folder.entries(), 0u);
  }
}

TEST(Bake, ReportsWhatItMade) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.sight"), report_file = folder.file("report.json");
  const Outcome outcome =
      runTool(bakeArguments(kShip, file, {"--json", report_file, "--triangle-budget", "77"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("budget        77 triangles"), std::string::npos) << outcome.out;
  const json report = parse(contents(report_file));
  const Result<SightFile> sight = SightFile::open(file);
  ASSERT_TRUE(sight) << sight.error().message;
  EXPECT_TRUE(sight->verifyAll());
  EXPECT_EQ(report["bytes"], std::filesystem::file_size(file));
  EXPECT_EQ(report["cells"], sight->octree().leaves.size());
  EXPECT_EQ(report["different_sets"], sight->setCount());
  EXPECT_EQ(report["settings"]["triangle_budget"], 77);
  EXPECT_EQ(report["databases"], json::array());
  EXPECT_EQ(sight->record().triangle_budget, 77u);
  EXPECT_EQ(sight->record().max_depth, 4u);
  EXPECT_EQ(report["parts_before"], 0);
  EXPECT_GT(report["parts"], 1);
  std::uint64_t reasons = 0;
  for (const auto& [reason, count] : report["stop_reasons"].items()) {
    reasons += count.get<std::uint64_t>();
  }
  EXPECT_EQ(reasons, sight->octree().leaves.size());
}

TEST(Bake, StoresTheDatabasesThatAreAskedForAsTheLibraryBuildsThem) {
  const TemporaryFolder folder;
  const std::string scene_file = folder.write("walls.obj", kWalls), file = folder.file("F.sight");
  const Outcome outcome = runTool(bakeArguments(
      scene_file, file, {"--databases", "first-hit,detail,area-angle,detail", "--threads", "2"}));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  const Result<SightFile> sight = SightFile::open(file);
  ASSERT_TRUE(sight) << sight.error().message;
  EXPECT_EQ(sight->databaseNames(), (std::vector<std::string>{"area-angle", "detail", "first-hit"}));
  const Result<Scene> scene = importScene(scene_file);
  ASSERT_TRUE(scene);
  // The occluders that `cull` finds, not the many that the bake considers.
  const OccluderSet set = findOccluders(scene->view());
  const std::vector<Box> bounds{scene->objects[0].bounds, scene->objects[1].bounds};
  const std::vector<std::uint32_t> triangles{2, 1};
  HierarchySettings kd;
  kd.kind = HierarchyKind::kKdTree;
  const Hierarchy cells = buildHierarchy(bounds, triangles, kd);
  for (const std::string name : {"area-angle", "detail"}) {
    const Result<DatabaseBlob> blob = sight->readDatabase(name);
    ASSERT_TRUE(blob) << blob.error().message;
    EXPECT_EQ(blob->occluders, occluderSetHash(set));
    OccluderDatabaseSettings settings;
    settings.turned_away = name == "detail";
    EXPECT_TRUE(blob->bytes == OccluderDatabase::build(cells, set, settings).save()) << name;
  }
  const Result<DatabaseBlob> blob = sight->readDatabase("first-hit");
  ASSERT_TRUE(blob) << blob.error().message;
  const auto count = static_cast<std::uint32_t>(set.occluders.size());
  EXPECT_TRUE(ViewpointDatabase::load(blob->bytes, count));
}

TEST(Bake, FitsABudgetInBytesOrSaysThatItCannot) {
  const TemporaryFolder folder;
  const std::string file = folder.file("ship.sight");
  const Outcome fitted = runTool(bakeArguments(kShip, file, {"--byte-budget", "140000", "--json", "-"}));
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  const json info = toolJson({"info", file});
  EXPECT_EQ(info["settings"]["all"]["byte_budget"], 140000);
  const std::string settings = info["settings"]["all"].dump();
  EXPECT_LE(info["bytes"].get<std::size_t>(), 140000 + settings.size() + 64);
  EXPECT_GT(info["cells"], 1);
}

// All parts are there before it is known that they do not fit: they must not be lost.
TEST(Bake, ABudgetInBytesThatIsTooSmallLeavesThePartsForALargerOne) {
  const TemporaryFolder folder;
  const std::string file = folder.file("F.sight"), witnesses = folder.file("F.witnesses");
  const auto withBudget = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--witnesses", witnesses, "--answers"});
    return runTool(bakeArguments(kShip, file, more));
  };
  const Outcome too_small = withBudget({"--byte-budget", "1000"});
  EXPECT_EQ(too_small.code, 2);
  EXPECT_EQ(ownLines(too_small.err), 1) << too_small.err;
  for (const std::string& part : {std::string("byte budget of 1000; give a larger one"),
                                  "kept in " + file + ".parts", std::string("--resume")}) {
    EXPECT_NE(too_small.err.find(part), std::string::npos) << too_small.err;
  }
  for (const std::string& other : {file, file + ".answers", witnesses}) {
    EXPECT_FALSE(std::filesystem::exists(other)) << other;
  }
  const Outcome larger = withBudget({"--byte-budget", "140000", "--resume", "--json", "-"});
  const json report = printedJson(larger);
  EXPECT_EQ(report["parts_before"], report["parts"]);
  EXPECT_FALSE(std::filesystem::exists(file + ".parts"));
}

TEST(Bake, ChoosesABudgetAndSaysIt) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("walls.obj", kWalls);
  const Outcome outcome = runTool(bakeArguments(scene, folder.file("F.sight")));
  ASSERT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_NE(outcome.out.find("100 triangles a cell (chosen"), std::string::npos) << outcome.out;
}

// Appends a box with its lower corner at (x, 0, z).
void addBox(std::string& obj, int& corners, double x, double z, double width, double height, double depth) {
  obj += fmt::format("o box{}\n", corners / 8);
  for (int i = 0; i < 8; ++i) {
    obj += fmt::format("v {} {} {}\n", x + (i % 2) * width, (i / 2 % 2) * height, z + (i / 4) * depth);
  }
  for (const auto& face : {std::array{0, 2, 3, 1}, std::array{4, 5, 7, 6}, std::array{0, 4, 6, 2},
                           std::array{1, 3, 7, 5}, std::array{0, 1, 5, 4}, std::array{2, 6, 7, 3}}) {
    obj += fmt::format("f {} {} {} {}\n", corners + face[0] + 1, corners + face[1] + 1, corners + face[2] + 1,
                       corners + face[3] + 1);
  }
  corners += 8;
}

// A street between two rows of houses with crates behind, 240 m long.
std::string streetObj() {
  std::string obj;
  int corners = 0;
  for (int i = 0; i < 20; ++i) {
    for (const double side : {-1.0, 1.0}) {
      addBox(obj, corners, 12.0 * i, side > 0 ? 8.0 : -18.0, 12.0, 9.0, 10.0);
      addBox(obj, corners, 12.0 * i + 5.0, side > 0 ? 20.0 : -21.0, 1.0, 1.0, 1.0);
    }
  }
  return obj;
}

// The line that a bake says on stderr; what the report and `info` say as well.
std::string warningOf(const TemporaryFolder& folder, const std::string& scene,
                      const std::vector<std::string>& more = {}) {
  const std::string file = folder.file("F.sight");
  std::vector<std::string> arguments{"bake", scene, "-o", file, "--json", "-"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  const Outcome outcome = runTool(arguments);
  const json report = printedJson(outcome), info = toolJson({"info", file});
  EXPECT_EQ(report["warning"], info["warning"]);
  const std::string text = runTool({"info", file}).out;
  if (report["warning"].is_null()) {
    EXPECT_EQ(outcome.err.find("warning"), std::string::npos) << outcome.err;
    EXPECT_EQ(text.find("warning"), std::string::npos) << text;
    return {};
  }
  const std::string warning = report["warning"];
  EXPECT_NE(outcome.err.find(fmt::format("sightline: warning: {}: {}\n", file, warning)), std::string::npos)
      << outcome.err;
  EXPECT_NE(text.find(warning), std::string::npos) << text;
  return warning;
}

TEST(Bake, WarnsWhenItsSetsHideNothingAndSaysWhy) {
  const TemporaryFolder folder;
  const std::string street = folder.write("street.obj", streetObj());
  EXPECT_EQ(warningOf(folder, street), "");
  const auto expectSays = [&](const std::string& word, const std::string& scene,
                              const std::vector<std::string>& more) {
    const std::string warning = warningOf(folder, scene, more);
    EXPECT_NE(warning.find(word), std::string::npos) << "'" << warning << "' should name " << word;
  };
  expectSays("too small for the smallest cells", street, {"--depth", "2"});
  expectSays("--depth 5 or more", street, {"--depth", "2"});
  expectSays("--near-distance", street, {"--depth", "5", "--near-distance", "100"});
  expectSays("--triangle-budget", street, {"--triangle-budget", "960"});
  expectSays("one object", folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), {});
  // Two tiles of a floor.
  const std::string floor =
      "v 0 0 0\nv 9 0 0\nv 0 0 9\nv 9 0 9\nv 0 5 0\nv 0 5 1\no a\nf 1 3 4 2\no b\nf 1 5 5\nf 1 6 6\n";
  expectSays("can occlude", folder.write("floor.obj", floor), {"--triangle-budget", "1"});
  // A wall that hides one small tile. Most triangles are seen from everywhere.
  std::string open =
      "v -9 0 -9\nv 9 9 9\nv -8 0 -9\nv -3 0 0\nv 3 0 0\nv 3 9 0\nv -3 9 0\nv 0 0 4\nv 1 0 4\nv 0 1 4\no a\n";
  for (int i = 0; i < 100; ++i) {
    open += "f 1 2 3\n";
  }
  open += "o wall\nf 4 5 6 7\no tile\nf 8 9 10\n";
  open = folder.write("open.obj", open);
  expectSays("--occlusion fused", open, {"--triangle-budget", "1", "--depth", "3"});
  expectSays("surfaces hide little", open,
             {"--triangle-budget", "1", "--depth", "3", "--occlusion", "fused"});
}

// A quarter of the crates are behind a wall, so the sets are of some use.
TEST(Bake, TellsOfSurfacesWhereSingleOccludersHideLittle) {
  const TemporaryFolder folder;
  std::string obj;
  int corners = 0;
  addBox(obj, corners, 0.0, 0.0, 8.0, 8.0, 1.0);
  for (int i = 0; i < 40; ++i) {
    addBox(obj, corners, i < 10 ? 3.0 : -40.0 - i, i < 10 ? 2.0 + 0.1 * i : 4.0, 0.05, 0.05, 0.05);
  }
  const std::string scene = folder.write("crates.obj", obj);
  const std::vector<std::string> fixed{"--region", "0,0,-4,8,8,-2", "--triangle-budget", "1", "--depth", "2"};
  const std::string warning = warningOf(folder, scene, fixed);
  EXPECT_EQ(warning.find("the sets keep "), 0u) << warning;
  EXPECT_NE(warning.find("--occlusion fused"), std::string::npos);
  EXPECT_EQ(warningOf(folder, scene, joined(fixed, {"--force", "--occlusion", "fused"})), "");
}

TEST(Bake, TakesAndAnswersPointsInWorldSpace) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("walls.obj", kWalls), file = folder.file("F.sight");
  ASSERT_EQ(runTool(bakeArguments(scene, file, {"--region", "500000,0,-4,500010,5,4"})).code, 0);
  const json info = toolJson({"info", file});
  // The octree may be larger than the region, to be a cube.
  EXPECT_LE(info["min"][0].get<double>(), 500000.0);
  EXPECT_GE(info["min"][0].get<double>(), 499990.0);
  EXPECT_GE(info["max"][0].get<double>(), 500010.0);
  EXPECT_LE(info["max"][0].get<double>(), 500020.0);
  EXPECT_GE(info["max"][2].get<double>(), 4.0);
  const json inside = toolJson({"query", file, "--points", "500005,2,3.9"});
  EXPECT_TRUE(inside["points"][0]["cell"].is_number());
  const json outside = toolJson({"query", file, "--points", "500005,2,30"});
  EXPECT_TRUE(outside["points"][0]["cell"].is_null());
  EXPECT_EQ(outside["points"][0]["visible"], json::array({0, 1}));
}

TEST(Bake, OfAPathHoldsSetsWhereItLeadsAndOfFreeSpaceWhereItCanLead) {
  const TemporaryFolder folder;
  const auto facts = [&](const std::vector<std::string>& more) {
    return toolJson(bakeArguments(kShip, folder.file("F.sight"), joined({"--force"}, more)));
  };
  const json everywhere = facts({}), path = facts({"--viewers", "path", "--reach", "0.5"});
  const json free = facts({"--viewers", "free"}), low = facts({"--viewers", "free", "--max-height", "1"});
  EXPECT_TRUE(everywhere["settings"]["all"]["viewers"].is_null());
  EXPECT_TRUE(everywhere["settings"]["all"]["region"].is_null());
  EXPECT_EQ(path["settings"]["all"]["viewers"]["where"], "path");
  EXPECT_EQ(path["settings"]["all"]["viewers"]["reach"], 0.5);
  EXPECT_EQ(path["settings"]["all"]["region"].size(), 6u);
  EXPECT_EQ(free["settings"]["all"]["viewers"]["where"], "free");
  EXPECT_EQ(free["settings"]["all"]["viewers"]["voxel"], 0.25);
  EXPECT_EQ(free["settings"]["all"]["viewers"]["max_height"], 0.0);
  EXPECT_EQ(low["settings"]["all"]["viewers"]["max_height"], 1.0);
  EXPECT_GT(path["stop_reasons"]["outside"], everywhere["stop_reasons"]["outside"]);
  EXPECT_NE(low["plan"], free["plan"]);
  // No eye of the camera path is outside.
  const Outcome walk =
      runTool({"verify", kShip, "--method", "visibility-octree", "--baked", folder.file("F.sight"),
               "--frames", "0:1000000:50", "--width", "160", "--height", "90"});
  EXPECT_EQ(walk.code, 0) << walk.out << walk.err;
  EXPECT_EQ(walk.err.find("outside"), std::string::npos) << walk.err;
}

TEST(Bake, TakesSeveralRegionsAndPointsToStartFrom) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("walls.obj", kWalls), file = folder.file("F.sight");
  const auto cellAt = [&](const std::string& point) {
    return toolJson({"query", file, "--points", point})["points"][0];
  };
  ASSERT_EQ(runTool(bakeArguments(scene, file,
                                  {"--region", "500000,0,-10,500010,5,-9", "--region",
                                   "500000,0,9,500010,5,10", "--triangle-budget", "1"}))
                .code,
            0);
  const json report = toolJson({"info", file});
  EXPECT_EQ(report["settings"]["all"]["viewers"]["boxes"], 2);
  EXPECT_GT(report["stop_reasons"]["outside"], 0);
  EXPECT_EQ(cellAt("500005,2,9.5")["visible"], json::array({0})) << "the wall hides what is behind it";
  EXPECT_EQ(cellAt("500005,2,0.1")["visible"], json::array({0, 1}));
  const Outcome free = runTool(bakeArguments(scene, file,
                                             {"--viewers", "free", "--from", "500005,2,3", "--region",
                                              "500000,0,-10,500010,5,10", "--voxel", "0.5", "--json", "-"}));
  ASSERT_EQ(free.code, 0) << free.err;
  EXPECT_EQ(parse(free.out)["settings"]["all"]["viewers"]["voxel"], 0.5);
}

TEST(Bake, RefusesOptionsOfViewersThatDoNotGoTogether) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("walls.obj", kWalls);
  const std::vector<std::pair<std::string, std::vector<std::string>>> bad = {
      {"--reach", {"--reach", "2"}},
      {"--from", {"--from", "1,2,3"}},
      {"--from", {"--viewers", "path", "--from", "1,2,3"}},
      {"--voxel", {"--viewers", "path", "--voxel", "1"}},
      {"--max-height", {"--max-height", "2"}},
      {"--path", {"--path", "x.json"}},
      {"--frames", {"--frames", "1:2"}},
      {"--path", {"--viewers", "free", "--from", "1,2,3", "--path", "x.json"}},
      {"camera", {"--viewers", "path"}},
      {"free space", {"--viewers", "free", "--from", "0,0,0"}},
      {"--region", {"--viewers", "free", "--from", "500005,2,-4", "--region", "1,1,1,0,0,0"}},
  };
  for (const auto& [word, more] : bad) {
    expectRefused(bakeArguments(scene, folder.file("F.sight"), more), word);
  }
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Bake, GoesOnOnlyFromItsOwnCheckpointAndOnlyWhenToldTo) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("walls.obj", kWalls);
  const std::string other = folder.write("other.obj", kWalls + "f 5 7 6\n");
  const std::string file = folder.file("F.sight"), parts = file + ".parts";
  const Outcome first = runTool(bakeArguments(scene, file, {"--json", "-", "--resume"}));
  ASSERT_EQ(first.code, 0) << first.err;
  const std::string expected = contents(file);
  const json report = parse(first.out);
  const auto leave = [&](std::uint64_t plan, bool with_a_part = false) {
    Result<tool::Checkpoint> left = tool::Checkpoint::open(parts, tool::CheckpointUse::kRestart);
    ASSERT_TRUE(left);
    ASSERT_TRUE(left->begin(plan));
    if (with_a_part) {
      ASSERT_TRUE(left->append(0, BakedPart(100)));
    }
  };
  leave(planOf(report), true);
  const std::string left = contents(parts);
  expectRefused(bakeArguments(scene, file), "--resume");
  expectRefused(bakeArguments(scene, file, {"--resume", "--near-distance", "0.3"}), "--restart");
  expectRefused(bakeArguments(scene, file, {"--resume", "--triangle-budget", "99"}), "--restart");
  expectRefused(bakeArguments(other, file, {"--resume"}), "--restart");
  EXPECT_EQ(contents(parts), left) << "a refused bake leaves the checkpoint as it is";
  EXPECT_TRUE(contents(file) == expected) << "and the old file";
  // What had finished nothing yet is in nobody's way.
  for (const char* option : {"--resume", "--restart", ""}) {
    leave(planOf(report));
    std::vector<std::string> options{"--threads", "2"};
    if (*option != 0) {
      options.emplace_back(option);
    }
    EXPECT_EQ(runTool(bakeArguments(scene, file, options)).code, 0) << option;
  }
  EXPECT_FALSE(std::filesystem::exists(parts));
  leave(planOf(report) + 1);
  EXPECT_EQ(runTool(bakeArguments(scene, file, {"--restart"})).code, 0);
  EXPECT_TRUE(contents(file) == expected);
  EXPECT_EQ(folder.entries(), 3u) << "the scenes and the file";
  folder.write("F.sight.parts", "not a checkpoint");
  expectRefused(bakeArguments(scene, file, {"--resume"}), "F.sight.parts");
}

TEST(Bake, RefusesOutputsThatCannotBe) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("walls.obj", kWalls);
  expectRefused(bakeArguments(scene, folder.file("")), folder.file(""));
  expectRefused(bakeArguments(scene, folder.file("no/such.sight")), "such.sight");
  expectRefused(bakeArguments(scene, "/dev/null"), "/dev/null");
  expectRefused(bakeArguments(scene, "-"), "--output");
  expectRefused(bakeArguments(scene, ""), "--output");
  expectRefused(bakeArguments(scene, scene), "the input itself");
  expectRefused(bakeArguments(scene, folder.file("F.sight"), {"--json", folder.file("F.sight")}),
                "the file of --output too");
  expectRefused({"info", scene, "--json", scene}, "the input itself");
  expectRefused(bakeArguments(scene, folder.file("F.sight"), {"--json", folder.file("no/such.json")}),
                "such.json");
  std::filesystem::create_directory(folder.file("G.sight.parts"));
  expectRefused(bakeArguments(scene, folder.file("G.sight")), "G.sight.parts");
  EXPECT_EQ(contents(scene), kWalls);
  EXPECT_EQ(folder.entries(), 2u);
  expectRefused({"bake", scene}, "--output");
  expectRefused({"bake"}, "SCENE");
}

TEST(Bake, RefusesValuesOutOfRange) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("walls.obj", kWalls);
  const std::vector<std::pair<std::string, std::vector<std::string>>> bad = {
      {"--triangle-budget", {"0", "-1", "x", "1e3", "99999999999999999999", ""}},
      {"--depth", {"21", "-1", "x", ""}},
      {"--near-distance", {"-1", "nan", "inf", "1e999", "x", ""}},
      {"--search-distance", {"-1", "nan"}},
      {"--occluder-size", {"-1", "nan"}},
      {"--similarity", {"-0.1", "1.5", "nan"}},
      {"--min-gain", {"-0.1", "1.5", "nan"}},
      {"--merge-tolerance", {"-0.1", "nan"}},
      {"--sample-memory", {"-1", "x", "99999999"}},
      {"--region",
       {"1,2,3", "0,0,0,0,1,1", "1,1,1,0,0,0", "a,b,c,d,e,f", "0,0,0,1,1,nan", "0,0,0,1,1,inf", ",,,,,"}},
      {"--viewers", {"", "bogus", "path,free"}},
      {"--from", {"1,2", "a,b,c", "1,2,nan", ""}},
      {"--reach", {"-1", "nan", "x"}},
      {"--voxel", {"0", "-1", "nan"}},
      {"--max-height", {"-1", "nan", "inf"}},
      {"--databases", {"bogus", "area-angle,,detail", ","}},
      {"--threads", {"0", "-1"}},
  };
  for (const auto& [option, values] : bad) {
    for (const std::string& value : values) {
      expectRefused(bakeArguments(scene, folder.file("F.sight"), {option, value}), option);
    }
  }
  expectRefused(bakeArguments(scene, folder.file("F.sight"), {"--resume", "--restart"}), "--restart");
  EXPECT_EQ(folder.entries(), 1u);
}

TEST(Bake, HelpSaysHowToGoOnAndHowToSpread) {
  const Outcome help = runTool({"bake", "--help"});
  EXPECT_EQ(help.code, 0);
  for (const std::string word : {"--resume", "--restart", "mpirun", "sightline bake ", "projected-size"}) {
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
  }
}

}  // namespace
}  // namespace sightline::tool_test
