#include "tools/sightline/report/scatter_plot.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/tool/markup_check.h"

namespace sightline::tool {
namespace {

ScatterPoint pointAt(double x, double y) {
  return {.name = "point", .x = x, .y_low = y, .y_high = y};
}

TEST(ScatterPlot, DrawsEachPointAndMarksTheFrontAndTheChosenOne) {
  ScatterPlot plot{
      .title = "Time", .x_label = "ms", .y_label = "kept", .groups = {"frustum", "occlusion-tree"}};
  plot.points = {pointAt(0.01, 9.0), pointAt(0.1, 1.5), pointAt(0.2, 1.6)};
  plot.points[0].on_front = plot.points[1].on_front = true;
  plot.points[1].chosen = true;
  const std::string svg = toSvg(plot);
  EXPECT_EQ(firstMarkupError(svg), "");
  EXPECT_EQ(countOf(svg, "<g stroke"), 3u);
  EXPECT_EQ(countOf(svg, "fill=\"transparent\""), 1u) << "the point that is not on the front";
  EXPECT_EQ(countOf(svg, "r=\"10\""), 1u) << "the chosen one";
  EXPECT_EQ(countOf(svg, "stroke-dasharray=\"4 3\""), 1u) << "the front";
}

TEST(ScatterPlot, AnIntervalIsALine) {
  ScatterPlot plot;
  plot.points = {pointAt(1.0, 2.0)};
  const std::size_t lines = countOf(toSvg(plot), "stroke-width=\"1.5\"/>");
  plot.points[0].y_low = 1.0;
  EXPECT_EQ(countOf(toSvg(plot), "stroke-width=\"1.5\"/>"), lines + 1);
}

TEST(ScatterPlot, LeavesOutWhatHasNoPlaceOnLogarithmicAxes) {
  ScatterPlot plot;
  for (const double bad :
       {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    plot.points.push_back(pointAt(bad, 1.0));
    plot.points.push_back(pointAt(1.0, bad));
  }
  const std::string svg = toSvg(plot);
  EXPECT_EQ(firstMarkupError(svg), "");
  EXPECT_EQ(countOf(svg, "<g stroke"), 0u);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
}

TEST(ScatterPlot, EscapesAllText) {
  const std::string text = "<b>\"&";
  ScatterPlot plot{
      .title = text, .x_label = text, .y_label = text, .groups = {text}, .points = {pointAt(1.0, 1.0)}};
  plot.points[0].name = text;
  const std::string svg = toSvg(plot);
  EXPECT_EQ(firstMarkupError(svg), "");
  EXPECT_EQ(svg.find("<b>"), std::string::npos);
}

}  // namespace
}  // namespace sightline::tool
