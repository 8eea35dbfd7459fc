// The experiments of Bittner, Havran and Slavik, on scenes that take a moment.

#include <map>
#include <set>

#include "tests/tool/formats_page.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

const std::string kBuilding = "demo:building?floors=1&plants=10";
const std::vector<int> kCounts{8, 16, 24, 32, 50};

// Measured once, for all tests.
class BittnerReproduced : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    outcome_ = new Outcome(
        runTool({"reproduce", "bittner", "--short", "--scene", kBuilding, "--scene", kCity, "--frames",
                 "0:400:40", "--width", "160", "--height", "90", "-o", folder_->file("report")}));
    ASSERT_EQ(outcome_->code, 0) << outcome_->err;
    result_ = new json(parse(contents(folder_->file("report/reproduce.json"))));
  }
  static void TearDownTestSuite() {
    delete result_;
    delete outcome_;
    delete folder_;
  }
  void SetUp() override { ASSERT_NE(result_, nullptr); }

  static const json& rows(const std::string& table) { return (*result_)["experiments"][table]["rows"]; }
  // The row of table 2 or of the steps. occluders: 0 for F.
  static json rowOf(const std::string& table, const std::string& scene, const std::string& method,
                    int occluders) {
    for (const json& row : rows(table)) {
      if (row["scene"] == scene && row["method"] == method && row.value("occluders", 0) == occluders) {
        return row;
      }
    }
    ADD_FAILURE() << table << " has no row of " << scene << ", " << method << ", " << occluders;
    return json::object();
  }
  static std::string file(const std::string& name) { return contents(folder_->file("report/" + name)); }

  inline static TemporaryFolder* folder_ = nullptr;
  inline static Outcome* outcome_ = nullptr;
  inline static json* result_ = nullptr;
};

TEST_F(BittnerReproduced, Table2HasEveryMethodWithEveryNumberOfOccluders) {
  expectDocumented(*result_, {"reproduce"});
  for (const std::string& scene : {kBuilding, kCity}) {
    EXPECT_DOUBLE_EQ(rowOf("table2", scene, "F", 0)["percent_of_frustum"], 100.0);
    for (const char* method : {"FME", "FSE", "FMC", "FSC", "FME, defaults"}) {
      for (const int occluders : kCounts) {
        const json row = rowOf("table2", scene, method, occluders);
        EXPECT_LT(row["percent_of_frustum"], 100.0) << row;
        EXPECT_NEAR(
            row["overhead_ms"].get<double>(),
            row["choose_ms"].get<double>() + row["build_ms"].get<double>() + row["traverse_ms"].get<double>(),
            1e-9);
        EXPECT_GT(row["build_ms"], 0.0) << row;
      }
    }
  }
  EXPECT_EQ(rows("table2").size(), 2 * (1 + 5 * kCounts.size()));
}

TEST_F(BittnerReproduced, PublishedFiguresStandBesideOurs) {
  // Table 2 of the paper: soda-5, FME, 24 occluders: 6537 of 18192 polygons, 276.5 ms to 116.0 ms.
  const json row = rowOf("table2", kBuilding, "FME", 24);
  EXPECT_NEAR(row["soda-5_percent"].get<double>(), 100.0 * 6537 / 18192, 1e-9);
  EXPECT_NEAR(row["soda-5_speed_up"].get<double>(), 276.5 / 116.0, 1e-9);
  EXPECT_FALSE(rowOf("table2", kBuilding, "FSC", 24).contains("soda-5_percent")) << "not published";
  ASSERT_EQ(rows("table2_published").size(), 21u);
  // The speed-ups that the paper prints with two decimals.
  const std::map<std::string, double> printed{{"soda-5 FME 8", 1.75}, {"soda-5 FSE 32", 2.76},
                                              {"big-7 FME 32", 3.75}, {"big-7 FSE 24", 2.87},
                                              {"soda FSE 24", 2.46},  {"soda F 0", 1.00}};
  std::size_t found = 0;
  for (const json& line : rows("table2_published")) {
    const auto entry =
        printed.find(line["scene"].get<std::string>() + " " + line["method"].get<std::string>() + " " +
                     std::to_string(line.value("occluders", 0)));
    if (entry != printed.end()) {
      EXPECT_NEAR(line["speed_up"].get<double>(), entry->second, 0.011) << line;
      ++found;
    }
  }
  EXPECT_EQ(found, printed.size());
}

TEST_F(BittnerReproduced, TheTableOfParametersBeginsWithThePapersAndEndsWithTheLibrarys) {
  ASSERT_EQ(rows("parameters").size(), 2u * 7);
  for (std::size_t scene = 0; scene < 2; ++scene) {
    const json &first = rows("parameters")[7 * scene], &last = rows("parameters")[7 * scene + 6];
    EXPECT_EQ(first["triangles"], rowOf("table2", first["scene"], "FME", 32)["triangles"]);
    EXPECT_EQ(last["triangles"], rowOf("table2", last["scene"], "FME, defaults", 32)["triangles"]);
  }
}

// The library's modified algorithm misses nothing that the standard one finds, up to rounding.
TEST_F(BittnerReproduced, ComparingWithPlanesRendersAsFewPolygonsAsSplitting) {
  for (const std::string& scene : {kBuilding, kCity}) {
    for (const int occluders : kCounts) {
      const double fme = rowOf("table2", scene, "FME", occluders)["triangles"];
      const double fse = rowOf("table2", scene, "FSE", occluders)["triangles"];
      EXPECT_NEAR(fme / fse, 1.0, 0.02) << scene << ", " << occluders;
    }
  }
}

TEST_F(BittnerReproduced, MoreOccludersMakeALargerTreeAndFewerStepsForEach) {
  for (const std::string& scene : {kBuilding, kCity}) {
    for (std::size_t i = 1; i < kCounts.size(); ++i) {
      const json less = rowOf("steps", scene, "FME", kCounts[i - 1]),
                 more = rowOf("steps", scene, "FME", kCounts[i]);
      EXPECT_GT(more["tree_nodes"], less["tree_nodes"]);
      EXPECT_LT(more["steps_of_occluders"], less["steps_of_occluders"]);
      EXPECT_LT(more["tree_nodes"], rowOf("steps", scene, "FSE", kCounts[i])["tree_nodes"]);
    }
    EXPECT_LE(rowOf("steps", scene, "FME", 8)["occluders_in_tree"], 8);
  }
}

TEST_F(BittnerReproduced, TheCurvesOfFigures9And10AreInAFileOfFrames) {
  const std::string csv = file("1-demo-building-floors-1-plants-10/frames.csv");
  std::istringstream lines(csv);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line, "frame,frustum_polygons,polygons,frustum_ms,ms");
  double frustum = 0.0, culled = 0.0;
  int frames = 0;
  for (; std::getline(lines, line); ++frames) {
    double number = 0, all = 0, kept = 0;
    ASSERT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf", &number, &all, &kept), 3) << line;
    EXPECT_EQ(number, 40 * frames);
    EXPECT_LE(kept, all) << line;
    frustum += all;
    culled += kept;
  }
  ASSERT_EQ(frames, 10);
  EXPECT_NEAR(frustum / frames, rowOf("table2", kBuilding, "F", 0)["triangles"].get<double>(), 1e-6);
  EXPECT_NEAR(culled / frames, rowOf("table2", kBuilding, "FME", 32)["triangles"].get<double>(), 1e-6);
}

TEST_F(BittnerReproduced, TheReportShowsTheFigures) {
  const std::string page = file("1-demo-building-floors-1-plants-10/index.html");
  for (const char* figure : {"1", "2", "5", "6", "7", "8"}) {
    EXPECT_NE(page.find(std::string("<h3>Figure ") + figure + "</h3>"), std::string::npos) << figure;
    EXPECT_NE(file(std::string("1-demo-building-floors-1-plants-10/figure-") + figure + ".svg").find("<svg"),
              std::string::npos);
  }
  EXPECT_NE(page.find("Figure 10: polygons rendered"), std::string::npos);
  EXPECT_NE(file("2-demo-city-copies-1/figure-5.svg").find("<svg"), std::string::npos);
  EXPECT_NE(file("2-demo-city-copies-1/figure-10.svg").find("<svg"), std::string::npos);
}

TEST_F(BittnerReproduced, EachStatementOfThePaperIsJudged) {
  const json& findings = (*result_)["findings"];
  EXPECT_GE(findings.size(), 6u);
  for (const json& finding : findings) {
    EXPECT_TRUE(finding["agrees"].is_boolean());
    EXPECT_FALSE(finding["claim"].get<std::string>().empty());
    EXPECT_EQ(finding["text"].get<std::string>().find("nan"), std::string::npos) << finding;
    EXPECT_EQ(finding["text"].get<std::string>().find("inf"), std::string::npos) << finding;
  }
  EXPECT_NE(outcome_->out.find("The paper's statements"), std::string::npos);
}

TEST_F(BittnerReproduced, TheTablesAreOnThePapersPageAndInFilesOfTheirOwn) {
  const std::string page = file("index.html");
  for (const std::string table : {"table2", "table2_published", "parameters", "steps", "curves"}) {
    EXPECT_NE(page.find(table + ".csv"), std::string::npos);
    const std::string csv = file(table + ".csv");
    EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), rows(table).size() + 1)
        << table;
  }
  EXPECT_EQ(file("table2.csv").substr(0, 31), "scene,method,occluders,triangle");
  EXPECT_NE(file("steps.csv").find("\"FME, defaults\""), std::string::npos) << "a comma is quoted";
  EXPECT_NE(page.find("1-demo-building-floors-1-plants-10/index.html"), std::string::npos);
  EXPECT_EQ(file("tables.txt"), outcome_->out);
}

}  // namespace
}  // namespace sightline::tool_test
