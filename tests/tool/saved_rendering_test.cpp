#include "tools/sightline/reproduce/saved_rendering.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "tests/support/pictures.h"

namespace sightline::tool {
namespace {

class SavedRendering : public ::testing::Test {
 protected:
  void SetUp() override { SIGHTLINE_SKIP_WITHOUT_PICTURES(); }

  static std::vector<Experiment> measured(const SavedRenderingOptions& options) {
    Result<std::vector<Experiment>> tables = savedRendering(options);
    EXPECT_TRUE(tables.has_value());
    return tables ? std::move(*tables) : std::vector<Experiment>(2);
  }
};

const SavedRenderingOptions kShortRendering{.height = 40,
                                            .samples = 1,
                                            .guard_px = 6,
                                            .max_frames = 4,
                                            .grids = {5},
                                            .tolerances_px = {0.0, 0.5, 3.0}};

TEST_F(SavedRendering, DrawsLessAndDiffersMoreTheMoreIsTolerated) {
  const std::vector<Experiment> tables = measured(kShortRendering);
  ASSERT_EQ(tables.size(), 2u);
  const std::vector<Json>& rows = tables[0].rows;
  ASSERT_EQ(rows.size(), 6u);
  for (const std::size_t first : {0u, 3u}) {
    EXPECT_EQ(rows[first]["scene"], first == 0 ? "canyon 5 x 5" : "toothpicks");
    // Without a tolerance what moves is drawn, as are all layers here: the eye moves.
    EXPECT_EQ(rows[first]["layers"], 100.0);
    EXPECT_EQ(rows[first]["triangles"], 100.0);
    EXPECT_EQ(rows[first]["error"], 0.0);
    for (std::size_t i = first + 1; i < first + 3; ++i) {
      EXPECT_LT(rows[i]["layers"], 90.0);
      EXPECT_LE(rows[i]["layers"], rows[i - 1]["layers"]);
      EXPECT_LE(rows[i]["triangles"], rows[i - 1]["triangles"]);
      EXPECT_GE(rows[i]["largest"], rows[i]["difference"]);
      EXPECT_LE(rows[i]["error"], rows[i]["tolerance"]);
      EXPECT_EQ(rows[i]["frames"], 3);
    }
  }
  // In the canyon pieces of terrain that lie on each other are drawn together: what they show is chance.
  EXPECT_LT(rows[3]["difference"], 0.05);
  EXPECT_GT(rows[4]["difference"], rows[3]["difference"]);
  EXPECT_GE(rows[5]["difference"], rows[4]["difference"]);
}

TEST_F(SavedRendering, UpdateRatesStandBesideThePapers) {
  SavedRenderingOptions options = kShortRendering;
  options.toothpicks = false;
  const std::vector<Experiment> tables = measured(options);
  const std::vector<Json>& rows = tables[1].rows;
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows[0]["aircraft"], 20.0);
  EXPECT_EQ(rows[0]["terrain"], 70.0);
  EXPECT_EQ(rows[0]["sky"], 40.0);
  EXPECT_EQ(rows[0]["poly"], 72.0);
  // All is drawn: by parts 100 %; by polygons more, since a split terrain has more than it had.
  for (const char* name : {"aircraft", "terrain", "sky", "unit"}) {
    EXPECT_EQ(rows[1][name], 100.0) << name;
    EXPECT_LT(rows[3][name], 100.0) << name;
  }
  EXPECT_GT(rows[1]["poly"], 100.0);
  for (const Experiment& table : tables) {
    for (const Json& row : table.rows) {
      std::set<std::string> known{"frames"};
      for (const Column& column : table.columns) {
        known.insert(column.key);
      }
      for (const auto& [key, value] : row.items()) {
        EXPECT_TRUE(known.contains(key)) << key << " has no column";
        EXPECT_FALSE(value.is_null()) << key;
      }
    }
  }
}

TEST_F(SavedRendering, ShortFormTakesFewFrames) {
  EXPECT_LT(savedRenderingOptions({.fewer_frames = true}).max_frames, 10u);
  EXPECT_GE(savedRenderingOptions({}).max_frames, 250u);
  EXPECT_EQ(savedRenderingOptions({}).grids, (std::vector<std::uint32_t>{20, 14, 10, 7, 5}));
}

TEST_F(SavedRendering, PicturesThatCannotBeMadeAreAnError) {
  SavedRenderingOptions options = kShortRendering;
  options.height = 100000;
  EXPECT_FALSE(savedRendering(options).has_value());
}

}  // namespace
}  // namespace sightline::tool
