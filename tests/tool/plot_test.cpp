#include "tools/sightline/report/plot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/tool/markup_check.h"

namespace sightline::tool {
namespace {

constexpr double kPlotGap = std::numeric_limits<double>::quiet_NaN();

Plot twoCurves() {
  return {.title = "Frame times",
          .x_label = "frame",
          .y_label = "frame time (ms)",
          .series = {{"frustum", {10.0, 12.0, 11.0}}, {"occlusion-tree", {4.0, kPlotGap, 3.0}}}};
}

TEST(MarkupCheck, FindsWhatItIsThereToFind) {
  EXPECT_EQ(firstMarkupError("<a><b/><meta x><c d=\"e\">f</c></a>"), "");
  EXPECT_NE(firstMarkupError("<a><b></a></b>"), "");
  EXPECT_NE(firstMarkupError("<a>"), "");
  EXPECT_NE(firstMarkupError("<a b=\"c>"), "");
}

TEST(Plot, IsOneBalancedSvgElementWithTitleLabelsAndLegend) {
  const std::string svg = toSvg(twoCurves());
  EXPECT_EQ(firstMarkupError(svg), "");
  EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  for (const char* text :
       {">Frame times<", ">frame<", ">frame time (ms)<", ">frustum<", ">occlusion-tree<"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
}

TEST(Plot, ASeriesKeepsItsPenWhenOthersAreLeftOut) {
  Plot plot = twoCurves();
  const std::string both = toSvg(plot);
  plot.series = {plot.series[1]};
  plot.series[0].pen = 1;
  const std::string alone = toSvg(plot);
  const auto last_color = [](const std::string& svg) { return svg.substr(svg.rfind("stroke=\"#") + 8, 7); };
  EXPECT_EQ(last_color(alone), last_color(both));
}

TEST(Plot, TheHorizontalAxisShowsTheNumbersGiven) {
  Plot plot = twoCurves();
  plot.first_x = 100.0;
  plot.step_x = 50.0;
  const std::string svg = toSvg(plot);
  EXPECT_NE(svg.find(">100<"), std::string::npos);
  EXPECT_NE(svg.find(">200<"), std::string::npos);
}

TEST(Plot, AGapBreaksTheCurve) {
  const std::string svg = toSvg(twoCurves());
  const std::size_t curve = svg.rfind("<path d=\"");
  const std::string path = svg.substr(curve, svg.find("fill", curve) - curve);
  EXPECT_EQ(countOf(path, "M"), 2u);
  EXPECT_EQ(countOf(path, "L"), 0u);
}

TEST(Plot, TextIsEscapedAndBadBytesAreReplaced) {
  Plot plot = twoCurves();
  plot.title = "<script>alert('1')</script>&\"";
  plot.y_label = "\"><svg onload=x>";
  plot.series[0].name = "a\xff\x01z</text>";
  const std::string svg = toSvg(plot);
  EXPECT_EQ(firstMarkupError(svg), "");
  EXPECT_EQ(svg.find("<script"), std::string::npos);
  EXPECT_EQ(svg.find("onload=x>"), std::string::npos);
  EXPECT_NE(svg.find("a\xef\xbf\xbdz&lt;/text&gt;"), std::string::npos);
}

TEST(Plot, TicksAreRoundNumbers) {
  Plot plot{.y_label = "polygons", .series = {{"a", {137000.0, 468000.0}}}};
  const std::string svg = toSvg(plot);
  EXPECT_NE(svg.find(">0<"), std::string::npos);
  EXPECT_NE(svg.find(">500,000<"), std::string::npos);
  plot.series = {{"a", {0.013, 0.046}}};
  EXPECT_NE(toSvg(plot).find(">0.04<"), std::string::npos);
}

TEST(Plot, ALogarithmicAxisHasPowersOfTenAndSkipsZero) {
  Plot plot{.series = {{"a", {0.0, 3.0, 20000.0}}}, .log_y = true};
  const std::string svg = toSvg(plot);
  for (const char* text : {">1<", ">10<", ">10,000<", ">100,000<"}) {
    EXPECT_NE(svg.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Plot, OddDataStillMakeAPicture) {
  const double inf = std::numeric_limits<double>::infinity();
  const double huge = std::numeric_limits<double>::max();
  const std::vector<std::vector<double>> cases{
      {},          {kPlotGap},       {5.0},       {0.0, 0.0},         {-3.0, -3.0},
      {inf, -inf}, {1e-300, 2e-300}, {huge, 1.0}, {1e17, 1e17 + 16.0}};
  for (const std::vector<double>& values : cases) {
    for (const bool log_y : {false, true}) {
      const std::string svg = toSvg({.series = {{"a", values}}, .log_y = log_y});
      EXPECT_EQ(firstMarkupError(svg), "");
      EXPECT_EQ(svg.find("nan"), std::string::npos) << svg;
    }
  }
  EXPECT_EQ(firstMarkupError(toSvg({})), "");
}

}  // namespace
}  // namespace sightline::tool
