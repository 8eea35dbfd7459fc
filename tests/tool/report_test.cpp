#include "tools/sightline/report/report.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "sightline/io/file.h"
#include "sightline/io/image.h"
#include "tests/tool/markup_check.h"

namespace sightline::tool {
namespace {

namespace fs = std::filesystem;

Report smallReport() {
  Report report;
  report.title = "demo:city";
  report.summary = "A walk of 400 frames.";
  report.command = "sightline walk demo:city -o out";
  report.facts = {{"triangles", "1,104,233"}, {"objects", "8,120"}};
  ReportRow frustum;
  frustum.method = "frustum";
  frustum.triangles = 100000.0;
  frustum.draw_ms = 30.0;
  frustum.frame_ms = 30.1;
  ReportRow tree = frustum;
  tree.method = "occlusion-tree";
  tree.options = "FME, 32 occluders";
  tree.triangles_share = 0.33;
  tree.speed_up = 2.5;
  tree.frames_differing = 0;
  report.rows = {frustum, tree};
  report.plots = {{.title = "Polygons", .series = {{"frustum", {1.0, 2.0}}, {"occlusion-tree", {1.0, 1.5}}}}};
  report.pictures = {{.file = "frame 0.png", .caption = "kept", .frame = 0},
                     {.file = "plan_0.png", .caption = "plan", .frame = 0, .plan = true}};
  report.notes = {"drawn by software"};
  return report;
}

TEST(Report, IsBalancedAndShowsEverythingGiven) {
  const std::string html = toHtml(smallReport());
  EXPECT_EQ(firstMarkupError(html), "");
  for (const char* text : {"demo:city", "A walk of 400 frames.", "sightline walk demo:city -o out",
                           "1,104,233", "FME, 32 occluders", "100,000", "33 %", "2.50 ×", "equal", "Polygons",
                           "kept", "occluders used", "drawn by software"}) {
    EXPECT_NE(html.find(text), std::string::npos) << text;
  }
}

TEST(Report, AnEmptyOneIsAPageToo) {
  EXPECT_EQ(firstMarkupError(toHtml({})), "");
}

TEST(Report, AsksForNothingFromElsewhereAndNeedsNoScripts) {
  const std::string html = toHtml(smallReport());
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("<link"), std::string::npos);
  EXPECT_EQ(html.find("@import"), std::string::npos);
  EXPECT_EQ(countOf(html, "://"), countOf(html, "xmlns=\"http://www.w3.org/2000/svg\""));
}

TEST(Report, EveryTextIsEscaped) {
  const std::string evil = "\"'><script>alert(1)</script>&\xc3";
  Report report = smallReport();
  report.title = report.summary = report.command = evil;
  report.facts = {{evil, evil}};
  report.rows[0].method = report.rows[1].options = evil;
  report.plots[0].title = report.plots[0].series[0].name = evil;
  report.pictures[0].file = report.pictures[0].caption = evil;
  report.notes = {evil};
  const std::string html = toHtml(report);
  EXPECT_EQ(firstMarkupError(html), "");
  EXPECT_EQ(html.find("<script"), std::string::npos);
  EXPECT_EQ(html.find("alert(1)</"), std::string::npos);
}

TEST(Report, LinksStayInTheFolder) {
  Report report = smallReport();
  report.pictures = {{.file = "http://example.org/a.png", .caption = "", .frame = 1},
                     {.file = "a b#c?.png", .caption = "", .frame = 1}};
  const std::string html = toHtml(report);
  EXPECT_EQ(html.find("://example"), std::string::npos);
  EXPECT_NE(html.find("src=\"./a%20b%23c%3F.png\""), std::string::npos);
}

TEST(Report, PicturesThatDifferAreSaidLoudly) {
  Report report = smallReport();
  report.rows[1].frames_differing = 3;
  const std::string html = toHtml(report);
  EXPECT_NE(html.find("3 differ"), std::string::npos);
  EXPECT_NE(html.find("pictures differ from those without culling"), std::string::npos);
}

TEST(Report, TiesAreCountedButNoFailure) {
  Report report = smallReport();
  report.rows[1].frames_tied = 3;
  const std::string html = toHtml(report);
  EXPECT_EQ(firstMarkupError(html), "");
  EXPECT_NE(html.find("ties in 3"), std::string::npos);
  EXPECT_EQ(html.find("differ from"), std::string::npos);
}

TEST(Report, IsWrittenBesideItsPictures) {
  const fs::path folder = fs::path(::testing::TempDir()) / "sightline_report_test";
  fs::remove_all(folder);
  fs::create_directories(folder);
  const Image image{.width = 1, .height = 1, .rgba = {1, 2, 3, 255}};
  ASSERT_TRUE(writePng(image, (folder / "a.png").string()).has_value());
  Report report = smallReport();
  report.pictures = {{.file = "a.png", .caption = "a"}};
  ASSERT_TRUE(writeReport(report, folder.string()).has_value());
  const Result<std::string> html = readFile((folder / "index.html").string());
  ASSERT_TRUE(html.has_value());
  const std::size_t start = html->find("src=\"./") + 7;
  const std::string link = html->substr(start, html->find('"', start) - start);
  EXPECT_TRUE(fs::exists(folder / link)) << link;
  EXPECT_FALSE(writeReport(report, (folder / "missing").string()).has_value());
  fs::remove_all(folder);
}

}  // namespace
}  // namespace sightline::tool
