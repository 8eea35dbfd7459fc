// Where skins and morph targets place vertices. The expected places are worked out by hand from the
// specification.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "src/io/failure.h"
#include "tests/io/glb_builder.h"
#include "tests/io/scene_checks.h"

namespace sightline {
namespace {

using nlohmann::json;
using test::areaVector;
using test::cornerOf;
using test::errorOf;
using test::Glb;
using test::imported;

constexpr std::size_t kVertices = 3;

// A triangle (0,0,0), (1,0,0), (0,1,0) in node 0, with a skin of the joints that are nodes 1 and 2. Node 0
// stands far away, which moves nothing; joint 1 stands at x = 10, and joint 2 at (0, 20, 0) in twice the
// size.
struct SkinnedTriangle {
  template <typename Joint, typename Weight>
  SkinnedTriangle(const std::vector<Joint>& joints, const std::vector<Weight>& weights) {
    const int positions = glb.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0});
    json primitive = Glb::primitive(positions);
    primitive["attributes"]["JOINTS_0"] = glb.addAccessor<Joint>(joints, "VEC4", 4);
    primitive["attributes"]["WEIGHTS_0"] = glb.addAccessor<Weight>(weights, "VEC4", 4);
    glb.addNode({{"mesh", glb.addMesh({primitive})}, {"skin", 0}, {"translation", {500, 600, 700}}});
    glb.addNode({{"translation", {10, 0, 0}}});
    glb.addNode({{"translation", {0, 20, 0}}, {"scale", {2, 2, 2}}});
    glb.json["scenes"][0]["nodes"] = {0, 1, 2};
    glb.json["skins"] = {{{"joints", {1, 2}}}};
  }
  SkinnedTriangle()
      : SkinnedTriangle(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0},
                        std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 0.75f, 0.25f, 0, 0}) {}

  json& attributes() { return glb.json["meshes"][0]["primitives"][0]["attributes"]; }
  json& accessor(const char* attribute) { return glb.json["accessors"][attributes()[attribute].get<int>()]; }

  Glb glb;
};

void expectCorners(const Scene& scene, const Vec3d (&wanted)[kVertices], const std::string& what) {
  ASSERT_EQ(scene.indices.size(), kVertices) << what;
  for (std::size_t i = 0; i < kVertices; ++i) {
    EXPECT_LT(length(cornerOf(scene, i) - wanted[i]), 1e-5) << what << ", corner " << i;
  }
}

// (0,0,0) by joint 1; (1,0,0) by joint 2; (0,1,0) by three quarters of (10,1,0) and one of (0,22,0).
constexpr Vec3d kPlaced[kVertices] = {{10, 0, 0}, {2, 20, 0}, {7.5, 6.25, 0}};

TEST(GltfSkin, JointsPlaceVerticesAndTheNodeOfTheMeshDoesNot) {
  const Scene scene = imported(SkinnedTriangle().glb.bytes());
  expectCorners(scene, kPlaced, "two joints");
  EXPECT_LT(sceneBounds(scene.view()).max.y, 21.0f);
}

TEST(GltfSkin, EveryTypeOfJointsAndWeightsIsRead) {
  const std::vector<std::uint8_t> bytes{0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0};
  const std::vector<std::uint16_t> shorts(bytes.begin(), bytes.end());
  const std::vector<float> floats{1, 0, 0, 0, 1, 0, 0, 0, 0.75f, 0.25f, 0, 0};
  expectCorners(imported(SkinnedTriangle(shorts, floats).glb.bytes()), kPlaced, "short joints");
  // 240 = 3 * 80 of 320 do not add up to 255: their ratio counts.
  SkinnedTriangle by_bytes(bytes, std::vector<std::uint8_t>{255, 0, 0, 0, 255, 0, 0, 0, 180, 60, 0, 0});
  by_bytes.accessor("WEIGHTS_0")["normalized"] = true;
  expectCorners(imported(by_bytes.glb.bytes()), kPlaced, "weights of bytes");
  SkinnedTriangle by_shorts(bytes,
                            std::vector<std::uint16_t>{65535, 0, 0, 0, 65535, 0, 0, 0, 48000, 16000, 0, 0});
  by_shorts.accessor("WEIGHTS_0")["normalized"] = true;
  expectCorners(imported(by_shorts.glb.bytes()), kPlaced, "weights of shorts");
}

TEST(GltfSkin, FurtherSetsOfJointsCountAsWell) {
  SkinnedTriangle skinned(std::vector<std::uint8_t>{0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0},
                          std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 0.75f, 0, 0, 0});
  skinned.attributes()["JOINTS_1"] =
      skinned.glb.addAccessor<std::uint8_t>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}, "VEC4", 4);
  skinned.attributes()["WEIGHTS_1"] =
      skinned.glb.addAccessor<float>({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.25f}, "VEC4", 4);
  expectCorners(imported(skinned.glb.bytes()), kPlaced, "two sets");
}

TEST(GltfSkin, InverseBindMatricesComeFirstAndJointsStandInTheirParents) {
  SkinnedTriangle skinned(std::vector<std::uint8_t>(12, 0),
                          std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  Glb& glb = skinned.glb;
  // Column-major: three times the size, then by (0, 0, -5). The last row is as an exporter may round it.
  const std::vector<float> inverse_bind{3, 0, 0, 0, 0, 3, 0, 0, 0, 0, 3, 0, 0, 0, -5, 0.9999999f};
  glb.json["skins"][0] = {{"joints", {1}},
                          {"inverseBindMatrices", glb.addAccessor<float>(inverse_bind, "MAT4", 16)}};
  // The joint below a node that is turned by 90 degrees about Y, which takes Z to X and X to -Z.
  const double half = std::sqrt(0.5);
  glb.addNode({{"rotation", {0, half, 0, half}}, {"children", {1}}});
  glb.json["scenes"][0]["nodes"] = {0, 2, 3};
  // p -> 3 p + (10, 0, -5) -> turned.
  expectCorners(imported(glb.bytes()), {{-5, 0, -10}, {-5, 0, -13}, {-5, 3, -10}}, "inverse bind matrix");
}

TEST(GltfSkin, TheOrderOfCornersStaysWhateverMirrors) {
  SkinnedTriangle skinned(std::vector<std::uint8_t>(12, 0),
                          std::vector<float>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  skinned.glb.json["nodes"][0]["scale"] = {-1, 1, 1};
  EXPECT_EQ(areaVector(imported(skinned.glb.bytes()), 0), Vec3d(0, 0, 1)) << "the node does not count";
  skinned.glb.json["nodes"][1]["scale"] = {-1, 1, 1};
  EXPECT_EQ(areaVector(imported(skinned.glb.bytes()), 0), Vec3d(0, 0, -1)) << "as the corners are placed";
}

TEST(GltfSkin, ASkinnedMeshHidesNothingUnlessItIsMarked) {
  SkinnedTriangle skinned;
  const Scene scene = imported(skinned.glb.bytes());
  EXPECT_EQ(scene.objects[0].mark, OccluderMark::kNever);
  ASSERT_EQ(scene.notes.size(), 1u);
  EXPECT_NE(scene.notes[0].find("objects that move, by animations, skins or morph targets: 1."),
            std::string::npos)
      << scene.notes[0];
  skinned.glb.json["meshes"][0]["extras"] = {{"occluder", true}};
  const Scene marked = imported(skinned.glb.bytes());
  EXPECT_EQ(marked.objects[0].mark, OccluderMark::kOccluder);
  EXPECT_TRUE(marked.notes.empty());
  skinned.glb.json["nodes"][0]["extras"] = {{"occluder", false}};
  EXPECT_EQ(imported(skinned.glb.bytes()).objects[0].mark, OccluderMark::kNever) << "the node's is stronger";
}

TEST(GltfSkin, ASkinnedMeshHidesNothingWhereSomeRenderersTurnItOver) {
  for (const double scale : {1.0, -1.0, 0.0}) {
    SkinnedTriangle skinned;
    skinned.glb.json["meshes"][0]["extras"] = {{"occluder", true}};
    skinned.glb.json["nodes"][0]["scale"] = {1, 1, scale};
    EXPECT_EQ(imported(skinned.glb.bytes()).objects[0].mark,
              scale > 0.0 ? OccluderMark::kOccluder : OccluderMark::kNever)
        << scale;
  }
}

TEST(GltfSkin, AMeshWithJointsButNoSkinIsPlacedByItsNode) {
  SkinnedTriangle skinned;
  skinned.glb.json["nodes"][0].erase("skin");
  const Scene scene = imported(skinned.glb.bytes());
  expectCorners(scene, {{500, 600, 700}, {501, 600, 700}, {500, 601, 700}}, "no skin");
  EXPECT_EQ(scene.objects[0].mark, OccluderMark::kAutomatic);
  EXPECT_TRUE(scene.notes.empty());
}

TEST(GltfSkin, WhatIsWrongIsSaidInOneLine) {
  const auto errorAfter = [](const std::function<void(SkinnedTriangle&)>& change) {
    SkinnedTriangle skinned;
    change(skinned);
    return errorOf(skinned.glb.bytes());
  };
  EXPECT_EQ(errorAfter([](auto& s) { s.glb.json["nodes"][0]["skin"] = 3; }),
            "scene.glb: node 0: skin 3 does not exist (the file has 1)");
  EXPECT_EQ(errorAfter([](auto& s) { s.glb.json["skins"][0]["joints"] = json::array(); }),
            "scene.glb: skin 0: has no joints");
  EXPECT_EQ(errorAfter([](auto& s) {
              s.glb.json["skins"][0]["joints"] = {1, 7};
            }),
            "scene.glb: skin 0: joint 1: node 7 does not exist (the file has 3)");
  EXPECT_EQ(errorAfter([](auto& s) {
              s.glb.json["scenes"][0]["nodes"] = {0, 1};
            }),
            "scene.glb: skin 0: joint 1: node 2 is not in the scene that the skin's mesh is in");
  EXPECT_EQ(errorAfter([](auto& s) { s.glb.json["skins"][0]["joints"] = {1}; }),
            "scene.glb: node 0: mesh 0 primitive 0: joint 1 of vertex 1 is out of range (its skin has 1)");
  EXPECT_EQ(errorAfter([](auto& s) { s.glb.json["nodes"][1]["children"] = {1}; }),
            "scene.glb: node 1: is its own ancestor, or hangs below such a node");
  EXPECT_EQ(errorAfter([](auto& s) { s.attributes().erase("WEIGHTS_0"); }),
            "scene.glb: mesh 0 primitive 0: has 1 sets JOINTS_n, but 0 WEIGHTS_n");
  EXPECT_EQ(errorAfter([](auto& s) {
              s.attributes().erase("JOINTS_0");
              s.attributes().erase("WEIGHTS_0");
            }),
            "scene.glb: node 0: has a skin, but mesh 0 primitive 0 has no JOINTS_0 and WEIGHTS_0");
  EXPECT_EQ(errorAfter([](auto& s) { s.accessor("JOINTS_0")["count"] = 2; }),
            "scene.glb: mesh 0 primitive 0: 2 joints and 3 weights do not go with 3 vertices");
  EXPECT_EQ(
      errorAfter([](auto& s) { s.accessor("JOINTS_0")["componentType"] = test::kByte; }),
      "scene.glb: mesh 0 primitive 0: joints must be VEC4 of unsigned bytes or shorts, and weights VEC4 "
      "of floats or unsigned bytes or shorts, but accessor 1 or 2 is not");
  EXPECT_EQ(errorAfter([](auto& s) {
              for (int set = 1; set < 9; ++set) {
                s.attributes()[fmt::format("JOINTS_{}", set)] = s.attributes()["JOINTS_0"];
              }
            }),
            "scene.glb: mesh 0 primitive 0 attributes: has more than 8 sets JOINTS_n");
  EXPECT_EQ(errorAfter([](auto& s) {
              s.glb.json["skins"][0]["inverseBindMatrices"] =
                  s.glb.template addAccessor<float>(std::vector<float>(16), "MAT4", 16);
            }),
            "scene.glb: skin 0: accessor 3 does not hold a MAT4 of floats for each of its 2 joints");
  EXPECT_EQ(errorAfter([](auto& s) {
              s.glb.json["skins"][0]["inverseBindMatrices"] =
                  s.glb.template addAccessor<float>(std::vector<float>(32), "MAT4", 16);
            }),
            "scene.glb: skin 0: inverse bind matrix 0: it is not finite, or its last row is not 0 0 0 1");
  EXPECT_EQ(
      errorOf(SkinnedTriangle(std::vector<std::uint8_t>(12, 0), std::vector<float>(12, 0.0f)).glb.bytes()),
      "scene.glb: mesh 0 primitive 0: no joint of its skin places vertex 0: its weights are all 0");
  EXPECT_EQ(
      errorOf(SkinnedTriangle(std::vector<std::uint8_t>(12, 0), std::vector<float>(12, -1.0f)).glb.bytes()),
      "scene.glb: mesh 0 primitive 0: weight -1 of vertex 0 is negative or not finite");
}

}  // namespace
}  // namespace sightline
