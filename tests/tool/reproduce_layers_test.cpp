// Snyder and Lengyel's tables, findings and page, as `reproduce all` writes them.

#include <map>
#include <utility>

#include "tests/tool/all_papers.h"
#include "tests/tool/formats_page.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

json rowsOf(const json& result, const std::string& table) {
  return result["experiments"][table]["rows"];
}

// `more` exceeds `less` by this many percent.
void expectMore(const json& percent, const json& more, const json& less) {
  EXPECT_NEAR(percent.get<double>(), 100.0 * (more.get<double>() / less.get<double>() - 1.0), 1e-6);
}

TEST_F(AllPapers, LayersTablesStandBesideOursAndInAReportWithItsPictures) {
  const std::string report = out() + "/snyder-lengyel/1-snyder-lengyel/";
  const json result = parse(contents(jsonOf("snyder-lengyel")));
  const std::string page = contents(report + "index.html");
  EXPECT_NE(page.find("<h3>Figure 17"), std::string::npos);
  EXPECT_NE(page.find("figure17_lines.svg"), std::string::npos);
  for (const std::string plot :
       {"Figure 18: the incremental sort with the kd-tree", "Figure 18: the same frames sorted depth-first",
        "Figure 19: time to build", "Figure 20: time of a frame", "Figure 20: by how much",
        "Figure 21: time of a frame"}) {
    EXPECT_NE(page.find(plot), std::string::npos) << plot;
  }
  EXPECT_NE(contents(report + "figure17_lines.svg").find("<svg"), std::string::npos);
  expectDocumented(result, {"reproduce"});
  const std::map<std::string, std::size_t> counts{{"components", 3},  {"growth", 7},      {"builds", 7},
                                                  {"velocities", 11}, {"directions", 6},  {"canyon", 10},
                                                  {"inflation", 10},  {"hidden_lines", 1}};
  for (const auto& [table, count] : counts) {
    EXPECT_EQ(rowsOf(result, table).size(), count) << table;
  }
  // Within what the scene's own sizes, which the paper does not give, leave open.
  for (const json& row : rowsOf(result, "components")) {
    EXPECT_NEAR(row["groups"], row["paper_groups"], 0.3 * row["paper_groups"].get<double>());
  }
}

TEST_F(AllPapers, EachSeriesOfLayersFigures18And21HasATimeForEachNumberOfToothpicks) {
  const json result = parse(contents(jsonOf("snyder-lengyel")));
  for (const char* scaling : {"ud", "us"}) {
    for (const json& row : rowsOf(result, "growth")) {
      for (const char* key : {"_ivs", "_ivs_max", "_mean", "_max", "_paper_mean", "_paper_max"}) {
        EXPECT_GT(row[std::string(scaling) + key], 0.0) << scaling << key << " with " << row["n"];
      }
    }
    for (const json& row : rowsOf(result, "directions")) {
      for (const std::string whose : {"", "_paper"}) {
        const std::string key = scaling + whose;
        EXPECT_GT(row[key + "_k3"], 0.0);
        expectMore(row[key + "_more"], row[key + "_k1"], row[key + "_k3"]);
      }
    }
  }
}

TEST_F(AllPapers, LayersFigure20HasThePapersRowOfDifferences) {
  const json result = parse(contents(jsonOf("snyder-lengyel")));
  // The paper's table, rounded as it is there.
  const std::vector<double> published{17.7, 19.3, 17.5, 18.5, 19.6, 21.7, 20.8, 21.0, 29.6, 19.9, 27.0};
  const json velocities = rowsOf(result, "velocities");
  ASSERT_EQ(velocities.size(), published.size());
  for (std::size_t i = 0; i < published.size(); ++i) {
    const json& row = velocities[i];
    EXPECT_NEAR(row["paper_more"], published[i], 0.7) << "the paper's times have three digits";
    expectMore(row["incremental_more"], row["incremental_max"], row["incremental"]);
    expectMore(row["more"], row["max"], row["mean"]);
  }
}

TEST_F(AllPapers, TheCanyonExpandsMoreWithMoreInflationAndThePublishedFactorsAreBracketed) {
  const json result = parse(contents(jsonOf("snyder-lengyel")));
  const json table = rowsOf(result, "inflation"), canyon = rowsOf(result, "canyon");
  const std::size_t tried = table.size() - 2;
  const std::vector<std::pair<std::string, double>> published{
      {"grid_20", 5.04}, {"grid_14", 3.78}, {"grid_10", 3.09}, {"grid_7", 2.58}, {"grid_5", 2.28}};
  for (std::size_t g = 0; g < published.size(); ++g) {
    const auto& [grid, factor] = published[g];
    EXPECT_GT(table[0][grid], 1.0) << "division alone cuts triangles";
    for (std::size_t i = 1; i < tried; ++i) {
      EXPECT_GE(table[i][grid], table[i - 1][grid]) << grid;
    }
    EXPECT_EQ(table[2]["inflation"], "0.2, used here");
    EXPECT_EQ(table[2][grid], canyon[2 * g]["expansion"]) << "the canyon's own table";
    EXPECT_EQ(table[tried][grid], factor);
    const double fit = table[tried + 1][grid];
    const auto below = static_cast<std::size_t>(10.0 * fit);  // rows are a tenth apart
    EXPECT_LE(table[below][grid], factor);
    EXPECT_GE(table[below + 1][grid], factor);
  }
}

TEST_F(AllPapers, EachFigureOfLayersHasASentenceOnWhatAgrees) {
  const json result = parse(contents(jsonOf("snyder-lengyel")));
  const json findings = result["findings"];
  std::string claims;
  for (const json& finding : findings) {
    claims += finding["claim"].get<std::string>() + "\n";
    EXPECT_TRUE(finding["agrees"].is_boolean());
    EXPECT_GT(finding["text"].get<std::string>().size(), 20u);
  }
  for (const std::string figure : {"figure 17", "figure 18", "figure 19", "figure 20", "figure 21", "canyon",
                                   "inflation", "components"}) {
    EXPECT_NE(claims.find(figure), std::string::npos) << figure;
  }
}

}  // namespace
}  // namespace sightline::tool_test
