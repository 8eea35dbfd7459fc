// sightline layers --svg, --pdf, --plot.

#include <algorithm>
#include <set>

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

std::vector<std::string> with(const std::vector<std::string>& more) {
  return joined({"layers", "demo:toothpicks?n=40", "--width", "320", "--height", "240", "--no-times"}, more);
}

json drawn(const std::vector<std::string>& more) {
  return toolJson(with(more));
}

std::size_t countOf(const std::string& text, const std::string& word) {
  std::size_t count = 0;
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    ++count;
  }
  return count;
}

TEST(LayerDrawings, AFrameIsDrawnAsSvgAndPdfOfThePicturesSize) {
  const TemporaryFolder folder;
  const std::string svg_file = folder.file("a.svg"), pdf_file = folder.file("a.pdf");
  const json result = drawn({"--frames", "3", "--svg", svg_file, "--pdf", pdf_file});
  const std::string svg = contents(svg_file), pdf = contents(pdf_file);
  EXPECT_NE(svg.find("width=\"320\" height=\"240\""), std::string::npos);
  // Parts keep their names.
  for (const char* name : {"corner_0", "edge_11"}) {
    EXPECT_EQ(countOf(svg, std::string("<g id=\"") + name + "\""), 1u) << name;
  }
  EXPECT_EQ(pdf.rfind("%PDF-1.5", 0), 0u);
  EXPECT_NE(pdf.find("/MediaBox [0 0 320 240]"), std::string::npos);
  EXPECT_NE(pdf.find("/Name (corner 0)"), std::string::npos);
  const json& drawing = result["frames"][0]["drawing"];
  EXPECT_EQ(drawing["form"], "painter");
  EXPECT_EQ(drawing["svg_bytes"], svg.size());
  EXPECT_EQ(drawing["pdf_bytes"], pdf.size());
  EXPECT_GT(drawing["lines"], 100);
  EXPECT_GT(drawing["strokes"], 50);
  EXPECT_LT(drawing["object_tests"], drawing["object_tests_without_sort"]);
}

TEST(LayerDrawings, WhatIsSeenFirstHasSmallerGroups) {
  const TemporaryFolder folder;
  const auto drawingOf = [&](const char* arcs) {
    const json result =
        toolJson({"layers", "demo:building?floors=1&plants=5", "--frames", "0", "--width", "320", "--height",
                  "180", "--arcs", arcs, "--svg", folder.file("a.svg"), "--no-times"});
    return result["frames"][0]["drawing"];
  };
  const json hulls = drawingOf("all"), seen = drawingOf("seen");
  EXPECT_LT(seen["largest_group"], hulls["largest_group"]);
  EXPECT_LT(seen["object_tests"], hulls["object_tests"]);
  EXPECT_EQ(seen["lines"], hulls["lines"]);
}

TEST(LayerDrawings, APlotHasNoFillsAndTestsMoreThanThePaintersForm) {
  const TemporaryFolder folder;
  const std::string painted = folder.file("a.svg"), plotted = folder.file("b.svg");
  const json paint = drawn({"--frames", "0", "--svg", painted});
  const json plot = drawn({"--frames", "0", "--plot", "--svg", plotted});
  EXPECT_GT(countOf(contents(painted), "fill=\"#ffffff\""), 40u);
  EXPECT_EQ(countOf(contents(plotted), "fill=\"#ffffff\""), 0u);
  const json &p = plot["frames"][0]["drawing"], &q = paint["frames"][0]["drawing"];
  EXPECT_EQ(p["form"], "plot");
  EXPECT_EQ(p["lines"], q["lines"]);
  // With the arcs between groups, which the painter's form does not need.
  EXPECT_GT(p["object_tests"], q["object_tests"]);
}

TEST(LayerDrawings, KindsOfLinesAreChosen) {
  const TemporaryFolder folder;
  const auto lines = [&](const std::vector<std::string>& options) {
    const json result = drawn(joined({"--frames", "0", "--svg", folder.file("a.svg")}, options));
    return result["frames"][0]["drawing"]["lines"].get<int>();
  };
  const int all = lines({});
  EXPECT_LT(lines({"--no-creases"}), all);
  EXPECT_GT(lines({"--crease", "5"}), all);
  EXPECT_EQ(lines({"--no-boundaries"}), all);  // all parts are closed
}

TEST(LayerDrawings, SeveralFramesAreSeveralFilesOfPartsThatMove) {
  const TemporaryFolder folder;
  const json result = drawn({"--frames", "0:40:20", "--svg", folder.file("a.svg")});
  ASSERT_EQ(result["frames"].size(), 2u);
  EXPECT_EQ(folder.entries(), 2u);
  EXPECT_EQ(result["frames"][1]["drawing"]["svg"], folder.file("a_0020.svg"));
  EXPECT_NE(contents(folder.file("a_0000.svg")), contents(folder.file("a_0020.svg")));
}

TEST(LayerDrawings, TheSameCommandWritesTheSameBytes) {
  const TemporaryFolder folder;
  for (const char* name : {"a", "b"}) {
    const std::string file = folder.file(name);
    ASSERT_EQ(runTool(with({"--frames", "0", "--plot", "--svg", file + ".svg", "--pdf", file + ".pdf"})).code,
              0);
  }
  EXPECT_EQ(contents(folder.file("a.svg")), contents(folder.file("b.svg")));
  EXPECT_EQ(contents(folder.file("a.pdf")), contents(folder.file("b.pdf")));
}

TEST(LayerDrawings, SaysWhatWasDrawn) {
  const TemporaryFolder folder;
  const Outcome outcome = runTool(with({"--frames", "0", "--svg", folder.file("a.svg")}));
  EXPECT_EQ(outcome.code, 0);
  for (const char* words :
       {"drawings (painter's form)", "visible pieces", "saved by the sort", "SVG, bytes"}) {
    EXPECT_NE(outcome.out.find(words), std::string::npos) << words;
  }
}

TEST(LayerDrawings, RefusesWhatMakesNoDrawing) {
  const TemporaryFolder folder;
  const std::string svg = folder.file("a.svg");
  expectRefused(with({"--svg", folder.file("a.png")}), ".svg");
  expectRefused(with({"--pdf", folder.file("none/a.pdf")}), "none");
  expectRefused(with({"--plot"}), "--svg");
  expectRefused(with({"--svg", svg, "--crease", "200"}), "--crease");
  expectRefused(with({"--svg", svg, "--no-creases", "--no-silhouettes", "--no-boundaries"}), "line");
  expectRefused(with({"--svg", svg, "--crease", "nan"}), "--crease");
  expectRefused(with({"--svg", svg, "--stroke-width", "nan"}), "--stroke-width");
  expectRefused(with({"--crease", "20"}), "--svg");
  expectRefused(with({"--no-creases"}), "--svg");
  expectRefused(with({"--svg", ""}), "--svg");
  EXPECT_EQ(folder.entries(), 0u);
}

TEST(LayerDrawings, NoTwoOutputsAreOneFile) {
  const TemporaryFolder folder;
  const std::string svg = folder.file("a.svg");
  expectRefused(with({"--svg", svg, "--json", svg}), "--json");
  expectRefused(
      with({"--svg", svg, "--json",
            folder.file("../") + std::filesystem::path(svg).parent_path().filename().string() + "/a.svg"}),
      "too; name another");
  const std::string png = folder.file("a.png");
  expectRefused(with({"--image", png, "--motion-blur", "1", "--blurred", png}), "too; name another");
  EXPECT_EQ(folder.entries(), 0u);
}

}  // namespace
}  // namespace sightline::tool_test
