// scripts/compare_bench and scripts/results, on hand-made CSV files.

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

const std::string kSource = SIGHTLINE_SOURCE_DIR;

// Times in microseconds: the value, and the least and greatest of a round.
struct Row {
  std::string options = "bvh", method = "occlusion-tree", scene = "demo:city";
  double value = 100.0, low = 95.0, high = 105.0;
  std::string kept = "120", missed = "0", answers = "aa", scene_hash = "1", views = "2";
};

std::string csvOf(const std::vector<Row>& rows) {
  std::string text =
      "scene,path,method,options,scene_hash,views,kept,missed,answers,overestimate_low,overestimate_high";
  std::string times;
  for (const std::string kind : {"cull", "draw"}) {
    for (const std::string statistic : {"median", "mean", "p99"}) {
      for (const std::string end : {"", "_low", "_high"}) {
        text += "," + kind + "_us_" + statistic + end;
      }
    }
  }
  text += ",times_frustum_mean\n";
  for (const Row& row : rows) {
    text += row.scene + ",walk," + row.method + ",\"" + row.options + "\"," + row.scene_hash + "," +
            row.views + "," + row.kept + "," + row.missed + "," + row.answers + ",1.2,1.5";
    for (int statistic = 0; statistic < 3; ++statistic) {
      for (const double time : {row.value, row.low, row.high}) {
        text += "," + std::to_string(time);
      }
    }
    text += std::string(9, ',') + ",2.5\n";
  }
  return text;
}

class BenchScripts : public ::testing::Test {
 protected:
  void SetUp() override {
    // Skipped without Python, which neither the library nor the tool needs.
    if (runProgram("/usr/bin/python3", {"-c", ""}).code != 0) {
      GTEST_SKIP() << "the scripts need /usr/bin/python3";
    }
  }
  Outcome compare(const std::string& old_csv, const std::string& new_csv,
                  const std::vector<std::string>& more = {}) {
    return runProgram(kSource + "/scripts/compare_bench",
                      joined({folder_.write("old.csv", old_csv), folder_.write("new.csv", new_csv)}, more));
  }
  void expectSays(const Outcome& outcome, int code, const std::string& text) {
    EXPECT_EQ(outcome.code, code) << outcome.out << outcome.err;
    EXPECT_NE(outcome.out.find(text), std::string::npos) << text << " is not in:\n"
                                                         << outcome.out << outcome.err;
  }
  void expectBadInput(const Outcome& outcome, const std::string& about) {
    EXPECT_EQ(outcome.code, 2) << outcome.out;
    EXPECT_EQ(outcome.errorLines(), 1) << outcome.err;
    EXPECT_NE(outcome.err.find(about), std::string::npos) << about << " is not in:\n" << outcome.err;
    EXPECT_EQ(outcome.out, "");
  }

  TemporaryFolder folder_;
};

TEST_F(BenchScripts, EqualFilesHaveNotChanged) {
  expectSays(compare(csvOf({{}}), csvOf({{}})), 0, "nothing changed beyond the noise");
}

TEST_F(BenchScripts, TimesWithinTheNoiseHaveNotChanged) {
  expectSays(compare(csvOf({{}}), csvOf({{.value = 110, .low = 104, .high = 116}})), 0, "nothing changed");
  expectSays(compare(csvOf({{}}), csvOf({{.value = 107, .low = 106, .high = 108}})), 0, "nothing changed");
}

TEST_F(BenchScripts, SlowerAndLooserFail) {
  expectSays(compare(csvOf({{}}), csvOf({{.value = 120, .low = 110, .high = 130}})), 1,
             "slower: demo:city, path walk: occlusion-tree (bvh): cull_us_mean 100");
  expectSays(compare(csvOf({{}}), csvOf({{.kept = "121"}})), 1, "looser");
  expectSays(compare(csvOf({{}}), csvOf({{.missed = "1"}})), 1, "misses more");
}

TEST_F(BenchScripts, FasterTighterAndOtherAnswersAreSaidAndDoNotFail) {
  expectSays(compare(csvOf({{}}), csvOf({{.value = 50, .low = 45, .high = 55}})), 0, "faster");
  expectSays(compare(csvOf({{}}), csvOf({{.kept = "119", .answers = "bb"}})), 0, "tighter");
  expectSays(compare(csvOf({{}}), csvOf({{.answers = "bb"}})), 0, "other answers");
}

TEST_F(BenchScripts, TheFloorIsWhatTheUserSays) {
  const std::string slower = csvOf({{.value = 120, .low = 110, .high = 130}});
  EXPECT_EQ(compare(csvOf({{}}), slower, {"--floor", "5"}).code, 0);
  EXPECT_EQ(compare(csvOf({{}}), slower, {"--floor", "0"}).code, 1);
}

TEST_F(BenchScripts, RelativeTimesLeaveOutTheSpeedOfTheMachine) {
  const auto on = [](double factor) {
    return csvOf({{.method = "frustum", .value = 10 * factor, .low = 9.9 * factor, .high = 10.1 * factor},
                  {.value = 100 * factor, .low = 99 * factor, .high = 101 * factor}});
  };
  EXPECT_EQ(compare(on(1), on(2)).code, 1);
  EXPECT_EQ(compare(on(1), on(2), {"--relative"}).code, 0);
  const std::string slower = csvOf({{.method = "frustum", .value = 20, .low = 19.8, .high = 20.2},
                                    {.value = 300, .low = 299, .high = 301}});
  expectSays(compare(on(1), slower, {"--relative"}), 1, "slower");
  expectBadInput(compare(csvOf({{}}), csvOf({{}}), {"--relative"}), "view-frustum culling");
}

TEST_F(BenchScripts, RowsThatOneFileLacksAreNamed) {
  const std::string both = csvOf({{}, {.options = "kd"}}), one = csvOf({{}});
  expectSays(compare(both, one), 0, "missing in NEW: demo:city, path walk: occlusion-tree (kd)");
  expectSays(compare(one, both), 0, "missing in OLD: demo:city, path walk: occlusion-tree (kd)");
  expectSays(compare(both, csvOf({{}, {.options = "kd", .kept = "999", .views = "3"}})), 0, "not compared");
}

TEST_F(BenchScripts, BadInputIsOneLine) {
  const std::string good = csvOf({{}});
  expectBadInput(compare("", good), "old.csv");
  expectBadInput(compare(good, "a,b\n1,2\n"), "new.csv");
  expectBadInput(compare(good, good + "demo:city,walk\n"), "line 3");
  expectBadInput(compare(good, csvOf({{}, {}})), "twice");
  expectBadInput(compare(good, csvOf({{.kept = "many"}})), "many");
  expectBadInput(compare(good, csvOf({{.kept = "nan"}})), "nan");
  expectBadInput(compare(good, csvOf({{.low = 200}})), "low");
  expectBadInput(compare(good, csvOf({{.options = "kd"}})), "in common");
  expectBadInput(compare(good, "\xff\xfe"), "new.csv");
  expectBadInput(
      runProgram(kSource + "/scripts/compare_bench", {folder_.file("none.csv"), folder_.file("new.csv")}),
      "none.csv");
  EXPECT_EQ(runProgram(kSource + "/scripts/compare_bench", {}).code, 2);
}

const std::string kDocument =
    "# Results\n\nProse before.\n\n<!-- begin tightness\nplain = frustum: bvh\nFSE, 32 = occlusion-tree: "
    "FSE, bvh\n-->\n\n"
    "| scene | plain | boxes | FSE, 32 |\n|---|---|---|---|\n| `demo:city` | 9 | 1.16 | 8 |\n| forest | 3 | "
    "2 | 1 |\n\n"
    "<!-- end tightness -->\n\nProse after, with | bars |.\n";

class ResultTables : public BenchScripts {
 protected:
  Outcome results(const std::vector<std::string>& words) {
    return runProgram(kSource + "/scripts/results", joined({"--document", document_}, words));
  }
  std::string document_ = folder_.write("results.md", kDocument);
};

TEST_F(ResultTables, OfTheDocumentAreWellFormed) {
  const Outcome outcome = runProgram(kSource + "/scripts/results", {"--check"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
}

TEST_F(ResultTables, AreFilledAndNothingElseChanges) {
  const std::string csv =
      folder_.write("bench.csv", csvOf({{.options = "FSE, bvh"},
                                        {.method = "depth-pyramid"},
                                        {.options = "FSE, bvh", .scene = "maps/harbour/harbour.glb"}}));
  const Outcome outcome = results({csv});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  std::string expected = kDocument;
  const std::string old_rows = "| `demo:city` | 9 | 1.16 | 8 |\n| forest | 3 | 2 | 1 |\n";
  expected.replace(
      expected.find(old_rows), old_rows.size(),
      "| `demo:city` | 9 | 1.16 | 1.20–1.50 |\n| forest | 3 | 2 | 1 |\n| harbour | – | – | 1.20–1.50 |\n");
  EXPECT_EQ(contents(document_), expected);
  EXPECT_EQ(results({csv}).code, 0);
  EXPECT_EQ(contents(document_), expected) << "again";
  EXPECT_EQ(results({"--check"}).code, 0);
  EXPECT_EQ(folder_.entries(), 2u);
}

TEST_F(ResultTables, HaveTheLeastOfAnyTestOfBoxes) {
  std::string text = kDocument;
  text.replace(text.find("plain = frustum: bvh"), 20, "boxes = boxes: any test");
  folder_.write("results.md", text);
  const std::string csv =
      "scene,method,options,boxes_overestimate_low,boxes_overestimate_high\ndemo:city,frustum,bvh,1.1,1.104\n"
      "forest,frustum,bvh,1.2,1.3\n";
  EXPECT_EQ(results({folder_.write("bench.csv", csv)}).code, 0);
  EXPECT_NE(contents(document_).find("| `demo:city` | 9 | 1.10 | 8 |\n| forest | 3 | 1.20–1.30 | 1 |"),
            std::string::npos)
      << contents(document_);
}

TEST_F(ResultTables, OfTimesAreMillisecondsOrPartsOfFrustumCulling) {
  for (const auto& [kind, cell] :
       {std::pair<std::string, std::string>("time", "0.100"), {"of-frustum", "2.50"}}) {
    std::string text = kDocument;
    for (std::size_t at = text.find("tightness"); at != std::string::npos; at = text.find("tightness")) {
      text.replace(at, 9, kind);
    }
    folder_.write("results.md", text);
    EXPECT_EQ(results({folder_.write("bench.csv", csvOf({{.options = "FSE, bvh"}}))}).code, 0);
    EXPECT_NE(contents(document_).find("| `demo:city` | 9 | 1.16 | " + cell + " |"), std::string::npos)
        << kind;
  }
}

TEST_F(ResultTables, ThatAreMalformedAreNamedAndNothingIsWritten) {
  const std::string csv = folder_.write("bench.csv", csvOf({{.options = "FSE, bvh"}}));
  const std::vector<std::pair<std::string, std::string>> changes{
      {"<!-- end tightness -->", ""},
      {"<!-- end tightness -->", "<!-- end time -->"},
      {"begin tightness", "begin speed"},
      {"plain = frustum", "other = frustum"},
      {"plain = frustum: bvh", "plain"},
      {"plain = frustum", "FSE, 32 = frustum"},
      {"| 9 | 1.16 | 8 |", "| 9 | 1.16 |"},
      {"|---|---|---|---|", "|---|---|"},
      {"| forest", "forest"},
      {"<!-- begin", "<!-- end tightness -->\n<!-- begin"}};
  for (const auto& [from, to] : changes) {
    std::string text = kDocument;
    text.replace(text.find(from), from.size(), to);
    folder_.write("results.md", text);
    for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{{"--check"}, {csv}}) {
      const Outcome outcome = results(words);
      EXPECT_EQ(outcome.code, 2) << from << " -> " << to;
      EXPECT_EQ(outcome.errorLines(), 1) << outcome.err;
      EXPECT_NE(outcome.err.find("results.md"), std::string::npos) << outcome.err;
    }
    EXPECT_EQ(contents(document_), text);
  }
  folder_.write("results.md", kDocument);
  EXPECT_EQ(results({folder_.file("none.csv")}).code, 2);
  EXPECT_EQ(results({folder_.write("other.csv", "a,b\n1,2\n")}).code, 2);
  EXPECT_EQ(results({}).code, 2);
  EXPECT_EQ(contents(document_), kDocument);
}

}  // namespace
}  // namespace sightline::tool_test
