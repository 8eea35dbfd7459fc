// sightline layers --split-cycles.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "tests/support/pictures.h"
#include "tests/support/real_scenes.h"
#include "tests/tool/run_tool.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

json splitFrames(const std::vector<std::string>& more) {
  return toolJson(joined({"layers", "--no-times"}, more));
}

// The pieces of each divided part.
std::map<std::uint32_t, std::vector<json>> piecesOf(const json& frame) {
  std::map<std::uint32_t, std::vector<json>> pieces;
  for (const json& piece : frame["split"]["pieces"]) {
    pieces[piece["part"].get<std::uint32_t>()].push_back(piece);
  }
  return pieces;
}

// Each part is in the order once, or all of its pieces are.
void expectWholeOrPieces(const json& frame, std::uint32_t parts) {
  const auto pieces = piecesOf(frame);
  std::multiset<std::uint32_t> expected;
  for (std::uint32_t part = 0; part < parts; ++part) {
    if (pieces.count(part) == 0) {
      expected.insert(part);
    }
  }
  for (const auto& [part, list] : pieces) {
    EXPECT_GE(list.size(), 2u);
    for (const json& piece : list) {
      EXPECT_GE(piece["piece"].get<std::uint32_t>(), parts);
      EXPECT_FALSE(piece["sides"].empty());
      expected.insert(piece["piece"].get<std::uint32_t>());
    }
  }
  for (const char* lists : {"order", "layers"}) {
    std::multiset<std::uint32_t> found;
    for (const json& list : frame[lists]) {
      found.insert(list.begin(), list.end());
    }
    EXPECT_EQ(found, expected) << lists;
  }
}

TEST(LayerSplitting, TheRingOfPanesFallsApart) {
  const json result =
      splitFrames({"demo:glass", "--parts", "see-through", "--frames", "0:100:20", "--split-cycles", "32"});
  EXPECT_EQ(result["options"]["split_cycles"], 32);
  for (const json& frame : result["frames"]) {
    const json& split = frame["split"];
    expectWholeOrPieces(frame, result["parts"].get<std::uint32_t>());
    EXPECT_LT(split["largest_group"], split["largest_group_whole"]);
    EXPECT_LE(split["pieces"].size(), 32u);
    EXPECT_EQ(split["split_us"], 0.0);
  }
  EXPECT_GT(result["frames"][0]["split"]["cuts"], 0);
  EXPECT_FALSE(splitFrames({"demo:glass", "--frames", "0"})["frames"][0].contains("split"));
}

class LayerSplittingPictures : public ::testing::Test {
 protected:
  void SetUp() override { SIGHTLINE_SKIP_WITHOUT_PICTURES(); }

  json drawn(const std::string& scene, const std::vector<std::string>& more) const {
    const json result = splitFrames(joined({scene, "--width", "160", "--height", "90", "--frames", "0:40:20",
                                            "--split-cycles", "32", "--image", folder_.file("out.png")},
                                           more));
    EXPECT_FALSE(piecesOf(result["frames"][0]).empty());
    return result;
  }
  TemporaryFolder folder_;
};

TEST_F(LayerSplittingPictures, PicturesOfPiecesAreThoseOfWholeParts) {
  for (const char* parts : {"see-through", "all"}) {
    const json glass = drawn("demo:glass", {"--parts", parts});
    for (const json& frame : glass["frames"]) {
      EXPECT_LE(frame["picture"]["difference"]["largest"], 1.0);
      EXPECT_EQ(frame["picture"]["difference"]["share_beyond"], 0.0);
    }
  }
  const json toothpicks = drawn("demo:toothpicks", {"--parts", "all"});
  for (const json& frame : toothpicks["frames"]) {
    EXPECT_EQ(frame["picture"]["difference"]["largest"], 0.0);
  }
}

TEST_F(LayerSplittingPictures, NamedPartsStayWhole) {
  const json free = drawn("demo:glass", {});
  const std::uint32_t divided = piecesOf(free["frames"][0]).begin()->first;
  const json fixed = drawn("demo:glass", {"--without", std::to_string(divided)});
  for (const json& frame : fixed["frames"]) {
    EXPECT_EQ(piecesOf(frame).count(divided), 0u);
    const json& left_out = frame["picture"]["left_out"];
    EXPECT_NE(std::find(left_out.begin(), left_out.end(), divided), left_out.end());
  }
}

TEST(LayerSplitting, WhatNeedsWholePartsIsRefusedInOneLine) {
  const TemporaryFolder folder;
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--svg", folder.file("a.svg")},
                                               {"--pdf", folder.file("a.pdf")},
                                               {"--arcs", "seen"},
                                               {"--exact", "off"},
                                               {"--order-for", "lens"},
                                               {"--samples", "2", "--image", folder.file("a.png")}}) {
    const Outcome outcome = runTool(joined({"layers", "demo:glass", "--split-cycles", "8"}, more));
    EXPECT_EQ(outcome.code, 2) << more[0];
    EXPECT_NE(outcome.err.find("--split-cycles: does not go with " + more[0]), std::string::npos)
        << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1);
  }
  for (const char* number : {"-1", "many"}) {
    const Outcome outcome = runTool({"layers", "demo:glass", "--split-cycles", number});
    EXPECT_EQ(outcome.code, 2) << number;
    EXPECT_NE(outcome.err.find("--split-cycles"), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  }
}

// Where rays hit the triangles of a scene, and which parts.
struct SceneHit {
  double distance = 0.0;
  std::uint32_t part = 0;
  Vec3d point;
};

std::vector<SceneHit> hitsOf(const SceneView& scene, const Vec3d& from, const Vec3d& direction) {
  std::vector<SceneHit> hits;
  for (std::uint32_t part = 0; part < scene.objects.size(); ++part) {
    const std::span<const std::uint32_t> indices = scene.indicesOf(scene.objects[part]);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      const Vec3d a(scene.positions[indices[i]]);
      const Vec3d ab = Vec3d(scene.positions[indices[i + 1]]) - a,
                  ac = Vec3d(scene.positions[indices[i + 2]]) - a;
      const Vec3d p = cross(direction, ac);
      const double determinant = dot(ab, p);
      const Vec3d q = cross(from - a, ab);
      const double u = dot(from - a, p) / determinant, v = dot(direction, q) / determinant;
      const double distance = dot(ac, q) / determinant;
      if (determinant != 0.0 && u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0) {
        hits.push_back({distance, part, from + direction * distance});
      }
    }
  }
  std::sort(hits.begin(), hits.end(),
            [](const SceneHit& a, const SceneHit& b) { return a.distance < b.distance; });
  return hits;
}

std::uint32_t shownBy(const std::map<std::uint32_t, std::vector<json>>& pieces, const SceneHit& hit,
                      bool& near_a_plane) {
  const auto found = pieces.find(hit.part);
  if (found == pieces.end()) {
    return hit.part;
  }
  std::vector<std::uint32_t> shown;
  for (const json& piece : found->second) {
    bool inside = true;
    for (const json& side : piece["sides"]) {
      const auto plane = side["plane"].get<std::array<double, 4>>();
      const double height = dot(Vec3d{plane[0], plane[1], plane[2]}, hit.point) + plane[3];
      near_a_plane = near_a_plane || std::abs(height) < 1e-5;
      inside = inside && (height >= 0.0) == side["in_front"].get<bool>();
    }
    if (inside) {
      shown.push_back(piece["piece"].get<std::uint32_t>());
    }
  }
  EXPECT_EQ(shown.size(), 1u) << "a point of part " << hit.part << " is not in exactly one piece";
  return shown.empty() ? hit.part : shown.front();
}

class SharedScenes : public ::testing::TestWithParam<const char*> {};

TEST_P(SharedScenes, DividedPartsAreInOrderAlongRays) {
  const std::string name = GetParam();
  const std::string file = (test::folderOfScenes() / name / (name + ".glb")).string();
  SIGHTLINE_SKIP_WITHOUT_SCENE(file);
  const json result = splitFrames({file, "--frames", "40", "--split-cycles", "4"});
  const json& frame = result["frames"][0];
  expectWholeOrPieces(frame, result["parts"].get<std::uint32_t>());
  const auto pieces = piecesOf(frame);
  EXPECT_FALSE(pieces.empty());
  std::map<std::uint32_t, std::size_t> group_of;
  for (std::size_t i = 0; i < frame["order"].size(); ++i) {
    for (const std::uint32_t part : frame["order"][i]) {
      group_of[part] = i;
    }
  }
  Result<Scene> scene = tool::loadScene(file);
  ASSERT_TRUE(scene.has_value());
  const Result<tool::Walk> walk = tool::loadWalk({}, file, *scene);
  ASSERT_TRUE(walk.has_value());
  const Vec3d eye = walk->view(40, *scene).eye;
  std::mt19937_64 random(1);
  const auto share = [&] { return static_cast<double>(random() >> 11) * 0x1p-53; };
  const SceneView view = scene->view();
  std::size_t pairs = 0;  // of a hit and the one before it
  for (int ray = 0; ray < 40; ++ray) {
    const Object& object = view.objects[random() % view.objects.size()];
    const Vec3d target = center(object.bounds) + Vec3d(share(), share(), share()) * 0.2;
    double before = 0.0;
    std::size_t last_group = 0;
    for (const SceneHit& hit : hitsOf(view, eye, normalized(target - eye))) {
      bool near_a_plane = false;
      const std::uint32_t shown = shownBy(pieces, hit, near_a_plane);
      ASSERT_EQ(group_of.count(shown), 1u) << shown;
      if (near_a_plane || hit.distance - before < 1e-4) {
        continue;
      }
      EXPECT_GE(group_of[shown], last_group) << "part " << hit.part << " is drawn over what it is behind";
      ++pairs;
      last_group = std::max(last_group, group_of[shown]);
      before = hit.distance;
    }
  }
  EXPECT_GT(pairs, 20u);
}

INSTANTIATE_TEST_SUITE_P(All, SharedScenes,
                         ::testing::Values("stk_candela_city", "stk_gran_paradiso_island", "ingolstadt_lod3",
                                           "oa_ctf_compromise"));

}  // namespace
}  // namespace sightline::tool_test
