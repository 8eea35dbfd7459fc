#include "tools/sightline/reproduce/layer_figures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "tests/support/pictures.h"
#include "tests/tool/run_tool.h"
#include "tools/sightline/reproduce/layer_figure_scene.h"

namespace sightline::tool {
namespace {

const LayerFigureOptions kSmall{
    .height = 96, .samples = 1, .passes = 6, .toothpicks = 40, .reused_frames = 3};

const ReportFile* fileOf(const LayerFigures& figures, const std::string& name) {
  const auto found = std::find_if(figures.files.begin(), figures.files.end(),
                                  [&](const ReportFile& file) { return file.name == name; });
  return found == figures.files.end() ? nullptr : &*found;
}

// Drawn once, for all tests.
class LayerFiguresDrawn : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { drawn_ = new Result<LayerFigures>(layerFigures(kSmall)); }
  static void TearDownTestSuite() { delete drawn_; }
  void SetUp() override {
    SIGHTLINE_SKIP_WITHOUT_PICTURES();
    ASSERT_TRUE(drawn_->has_value());
  }
  static const LayerFigures& figures() { return **drawn_; }
  static Json rowOf(const std::string& start) {
    for (const Json& row : figures().experiments.front().rows) {
      if (row["method"].get<std::string>().starts_with(start) && row["figure"] == 16) {
        return row;
      }
    }
    return {};
  }

  static Result<LayerFigures>* drawn_;
};
Result<LayerFigures>* LayerFiguresDrawn::drawn_ = nullptr;

TEST_F(LayerFiguresDrawn, LayersAreNearerTheReferenceThanSinglePictures) {
  const double layers = rowOf("(c)")["difference"].get<double>();
  EXPECT_GT(layers, 0.0);
  EXPECT_LT(2.0 * layers, rowOf("(a)")["difference"].get<double>());
  EXPECT_LT(2.0 * layers, rowOf("(b)")["difference"].get<double>());
}

TEST_F(LayerFiguresDrawn, EachPictureOfTheReportIsAFileOfTheHeightAskedFor) {
  std::set<std::string> names;
  std::set<std::uint32_t> numbers;
  for (const ReportPicture& picture : figures().pictures) {
    EXPECT_TRUE(names.insert(picture.file).second) << picture.file;
    EXPECT_NE(picture.heading, "");
    numbers.insert(picture.frame);
    const ReportFile* file = fileOf(figures(), picture.file);
    ASSERT_NE(file, nullptr) << picture.file;
    EXPECT_EQ(file->picture.height, kSmall.height) << picture.file;
  }
  EXPECT_EQ(names.size(), figures().files.size());
  EXPECT_EQ(numbers, (std::set<std::uint32_t>{16, 17, 22, 23, 24}));
}

TEST_F(LayerFiguresDrawn, ThePieceInACycleIsSeenInItsOwnColour) {
  const ReportFile* canyon = fileOf(figures(), "figure23_canyon.png");
  ASSERT_NE(canyon, nullptr);
  std::size_t red = 0;
  for (std::size_t i = 0; i < canyon->picture.rgba.size(); i += 4) {
    red += canyon->picture.rgba[i] > 1.5 * canyon->picture.rgba[i + 1] ? 1 : 0;
  }
  EXPECT_GT(red, 4u);
}

TEST_F(LayerFiguresDrawn, ThePapersGridStandsBesideTheOneWithACycle) {
  const ReportFile* papers = fileOf(figures(), "figure23_papers_grid.png");
  ASSERT_NE(papers, nullptr);
  EXPECT_NE(papers->picture, fileOf(figures(), "figure23_canyon.png")->picture);
  ASSERT_EQ(figures().findings.size(), 1u);
  EXPECT_FALSE(figures().findings.front().agrees) << "no frame of our canyon has a cycle with 14 x 14";
}

TEST(LayerFigures, HiddenLinesAreOneSvgWithAGroupForEachToothpick) {
  const LayerFigures figures = hiddenLineFigure(kSmall);
  ASSERT_EQ(figures.files.size(), 1u);
  const std::string& svg = figures.files.front().text;
  for (std::uint32_t i = 0; i < kSmall.toothpicks; ++i) {
    EXPECT_NE(svg.find("\"toothpick " + std::to_string(i) + "\""), std::string::npos) << i;
  }
  const Json& row = figures.experiments.front().rows.front();
  EXPECT_EQ(row["bytes"], svg.size());
  EXPECT_LT(row["pairs"].get<double>(), 0.2 * row["all_pairs"].get<double>());
}

TEST(LayerFigures, ADifferenceIsDarkWhereThereIsOne) {
  const Image a{2, 1, {10, 20, 30, 255, 10, 20, 30, 255}}, b{2, 1, {10, 20, 30, 255, 10, 25, 29, 255}};
  EXPECT_EQ(differenceStrength(a, b), (Image{2, 1, {255, 255, 255, 255, 235, 235, 235, 255}}));
}

}  // namespace
}  // namespace sightline::tool
