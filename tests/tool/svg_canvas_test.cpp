#include "tools/sightline/report/svg_canvas.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "tests/tool/markup_check.h"

namespace sightline::tool {
namespace {

const std::vector<SvgPoint> kTriangle{{1, 2}, {3, 4}, {5, 0}};

TEST(SvgCanvas, WritesAFileOfItsOwnWithAllShapes) {
  SvgCanvas canvas(200, 100, "A picture");
  canvas.polygon(kTriangle, {.fill = "#ff0000", .fill_opacity = 0.5});
  canvas.line({0, 0}, {10, 10}, {.stroke = "#00ff00", .dashes = "4 2"});
  canvas.arrow({0, 0}, {30, 0}, "#0000ff");
  canvas.circle({5, 5}, 2, {.stroke = "#123456"});
  canvas.rectangle({1, 1}, {8, 9}, {});
  canvas.text({50, 50}, "words", {.bold = true});
  const std::string file = canvas.file();
  EXPECT_EQ(firstMarkupError(file), "");
  EXPECT_TRUE(file.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\""));
  for (const char* part : {"<title>A picture</title>", "points=\"1.00,2.00 3.00,4.00 5.00,0.00\"",
                           "fill-opacity=\"0.50\"", "stroke-dasharray=\"4 2\"", "<circle", ">words</text>"}) {
    EXPECT_NE(file.find(part), std::string::npos) << part;
  }
}

TEST(SvgCanvas, TextIsNeverMarkup) {
  SvgCanvas canvas(10, 10, "<b>\"&");
  canvas.text({1, 1}, "</text><script>");
  EXPECT_EQ(firstMarkupError(canvas.file()), "");
  EXPECT_EQ(canvas.file().find("<script>"), std::string::npos);
}

TEST(SvgCanvas, ShapesThatAreNotFiniteAreLeftOut) {
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(),
                   kFar = std::numeric_limits<double>::infinity();
  SvgCanvas canvas(10, 10, "");
  const std::string empty = canvas.file();
  canvas.line({kNaN, 0}, {1, 1}, {});
  canvas.circle({0, kFar}, 1, {});
  canvas.text({kFar, 0}, "far");
  canvas.rectangle({0, 0}, {kNaN, 1}, {});
  canvas.arrow({kNaN, 0}, {1, 1}, "#000000");
  canvas.polygon(std::vector<SvgPoint>{{0, 0}, {1, kNaN}, {1, 1}}, {});
  canvas.polygon({}, {});
  EXPECT_EQ(canvas.file(), empty);
}

}  // namespace
}  // namespace sightline::tool
