// What a glTF file moves, hides and exchanges, by animations and by extensions.

#include <gtest/gtest.h>

#include <functional>

#include "tests/io/glb_builder.h"
#include "tests/io/scene_checks.h"

namespace sightline {
namespace {

using nlohmann::json;
using test::cornerOf;
using test::errorOf;
using test::Glb;
using test::imported;

std::vector<OccluderMark> marksOf(const Scene& scene) {
  std::vector<OccluderMark> marks;
  for (const Object& object : scene.objects) {
    marks.push_back(object.mark);
  }
  return marks;
}

constexpr OccluderMark kNever = OccluderMark::kNever, kAutomatic = OccluderMark::kAutomatic;

// Nodes 0 to 3 show a triangle each; 1 and 2 hang below 0, 3 is a root of its own.
Glb fourNodes() {
  Glb glb;
  const int mesh = glb.addMesh({Glb::primitive(glb.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0}))});
  glb.addNode({{"name", "zero"}, {"mesh", mesh}, {"children", {1}}});
  glb.addNode({{"name", "one"}, {"mesh", mesh}, {"children", {2}}});
  glb.addNode({{"name", "two"}, {"mesh", mesh}});
  glb.addNode({{"name", "three"}, {"mesh", mesh}});
  glb.json["scenes"][0]["nodes"] = {0, 3};
  return glb;
}

// Adds an animation whose only channel has this target.
void animate(Glb& glb, const json& target) {
  const int times = glb.addAccessor<float>({0, 1}, "SCALAR", 1);
  const int values = glb.addAccessor<float>({0, 0, 0, 100, 0, 0}, "VEC3", 3);
  glb.json["animations"].push_back({{"channels", {{{"sampler", 0}, {"target", target}}}},
                                    {"samplers", {{{"input", times}, {"output", values}}}}});
}
void animatePointer(Glb& glb, const std::string& pointer) {
  animate(glb, {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}});
}

TEST(GltfMoving, NodesThatAnimationsMoveHideNothingNorDoThoseBelow) {
  for (const char* path : {"translation", "rotation", "scale"}) {
    Glb glb = fourNodes();
    animate(glb, {{"node", 3}, {"path", "translation"}});
    animate(glb, {{"node", 1}, {"path", path}});
    glb.json["nodes"][1]["translation"] = {0, 7, 0};
    const Scene scene = imported(glb.bytes());
    EXPECT_EQ(marksOf(scene), (std::vector<OccluderMark>{kAutomatic, kNever, kNever, kNever})) << path;
    EXPECT_EQ(cornerOf(scene, 3), Vec3d(0, 7, 0)) << "where the node stands, whatever the keys say";
    ASSERT_EQ(scene.notes.size(), 1u);
    EXPECT_NE(scene.notes[0].find("morph targets: 3."), std::string::npos) << scene.notes[0];
  }
  EXPECT_TRUE(imported(fourNodes().bytes()).notes.empty());
}

TEST(GltfMoving, TheMarkOfTheAuthorStands) {
  Glb glb = fourNodes();
  animate(glb, {{"node", 0}, {"path", "translation"}});
  glb.json["nodes"][1]["extras"] = {{"occluder", true}};
  glb.json["nodes"][2]["extras"] = {{"occluder", false}};
  const Scene scene = imported(glb.bytes());
  EXPECT_EQ(marksOf(scene), (std::vector<OccluderMark>{kNever, OccluderMark::kOccluder, kNever, kAutomatic}));
  EXPECT_NE(scene.notes.at(0).find("morph targets: 1."), std::string::npos) << scene.notes[0];
}

TEST(GltfMoving, AnAnimatedCameraMovesNothingElse) {
  Glb glb = fourNodes();
  glb.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}}};
  glb.addNode({{"camera", 0}});
  glb.json["scenes"][0]["nodes"] = {0, 3, 4};
  animate(glb, {{"node", 4}, {"path", "translation"}});
  const Scene scene = imported(glb.bytes());
  EXPECT_EQ(marksOf(scene), std::vector<OccluderMark>(4, kAutomatic));
  EXPECT_TRUE(scene.notes.empty());
  ASSERT_EQ(scene.paths.size(), 1u);
  EXPECT_EQ(scene.paths[0].frames.size(), 31u);
}

TEST(GltfMoving, PointersOfAnimationsCountLikeTheirTargets) {
  const auto marksWith = [](const std::string& pointer) {
    Glb glb = fourNodes();
    animatePointer(glb, pointer);
    return marksOf(imported(glb.bytes()));
  };
  const std::vector<OccluderMark> below_one{kAutomatic, kNever, kNever, kAutomatic};
  EXPECT_EQ(marksWith("/nodes/1/rotation"), below_one);
  EXPECT_EQ(marksWith("/nodes/1/extensions/KHR_node_visibility/visible"), below_one);
  for (const char* harmless :
       {"/nodes/9/rotation", "/nodes/1", "/nodes/x/scale", "/cameras/1/perspective/yfov", "", "/",
        "nodes/1/scale", "/nodes/99999999999999999999999/scale", "/nodes/-1/scale", "/nodes/1/weights/0",
        "/meshes/0/weights"}) {
    EXPECT_EQ(marksWith(harmless), std::vector<OccluderMark>(4, kAutomatic)) << harmless;
  }
}

TEST(GltfMoving, HiddenNodesMakeNoObjects) {
  Glb glb = fourNodes();
  glb.json["nodes"][1]["extensions"] = {{"KHR_node_visibility", {{"visible", false}}}};
  glb.json["nodes"][2]["extensions"] = {{"KHR_node_visibility", {{"visible", true}}}};
  glb.json["nodes"][3]["extensions"] = {{"KHR_node_visibility", json::object()}};
  glb.json["extensionsUsed"] = {"KHR_node_visibility"};
  EXPECT_EQ(imported(glb.bytes()).object_names, (std::vector<std::string>{"zero", "three"}));
  glb.json["extensionsRequired"] = {"KHR_node_visibility"};
  EXPECT_EQ(imported(glb.bytes()).object_names, (std::vector<std::string>{"zero", "three"}));
}

TEST(GltfMoving, HiddenNodesThatAnAnimationShowsStayAndHideNothing) {
  Glb glb = fourNodes();
  glb.json["nodes"][1]["extensions"] = {{"KHR_node_visibility", {{"visible", false}}}};
  glb.json["nodes"][3]["extensions"] = {{"KHR_node_visibility", {{"visible", false}}}};
  animatePointer(glb, "/nodes/1/extensions/KHR_node_visibility/visible");
  const Scene scene = imported(glb.bytes());
  EXPECT_EQ(scene.object_names, (std::vector<std::string>{"zero", "one", "two"}));
  EXPECT_EQ(marksOf(scene), (std::vector<OccluderMark>{kAutomatic, kNever, kNever}));
}

TEST(GltfMoving, HiddenNodesStillPlaceWhatTheirJointsMove) {
  Glb glb;
  json primitive = Glb::primitive(glb.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0}));
  primitive["attributes"]["JOINTS_0"] =
      glb.addAccessor<std::uint8_t>(std::vector<std::uint8_t>(12, 0), "VEC4", 4);
  primitive["attributes"]["WEIGHTS_0"] =
      glb.addAccessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  glb.addNode({{"mesh", glb.addMesh({primitive})}, {"skin", 0}});
  glb.addNode({{"translation", {10, 0, 0}}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
  glb.json["scenes"][0]["nodes"] = {0, 1};
  glb.json["skins"] = {{{"joints", {1}}}};
  EXPECT_EQ(cornerOf(imported(glb.bytes()), 0), Vec3d(10, 0, 0));
}

TEST(GltfMoving, WhatExtensionsMoveOrExchangeHidesNothing) {
  const auto marksWith = [](const json& extensions) {
    Glb glb = fourNodes();
    glb.json["nodes"][1]["extensions"] = extensions;
    return marksOf(imported(glb.bytes()));
  };
  const std::vector<OccluderMark> below_one{kAutomatic, kNever, kNever, kAutomatic};
  EXPECT_EQ(marksWith({{"MSFT_lod", {{"ids", {3}}}}}), below_one);
  EXPECT_EQ(marksWith({{"AGI_articulations", {{"articulationName", "arm"}}}}), below_one);
  EXPECT_EQ(marksWith({{"KHR_physics_rigid_bodies", {{"motion", {{"mass", 1}}}}}}), below_one);
  EXPECT_EQ(marksWith({{"KHR_physics_rigid_bodies", {{"collider", json::object()}}}}),
            std::vector<OccluderMark>(4, kAutomatic));
}

// A triangle whose first target moves it by (100, 0, 0) and whose second moves its last corner by (0, 0, 8);
// its third moves normals only.
struct MorphedTriangle {
  MorphedTriangle() {
    json primitive = Glb::primitive(glb.addPositions({0, 0, 0, 1, 0, 0, 0, 1, 0}));
    const int shift = glb.addPositions({100, 0, 0, 100, 0, 0, 100, 0, 0});
    // Sparse, with no bytes of its own: zero but for the last corner.
    const int where = glb.addView<std::uint8_t>({2});
    const int what = glb.addView<float>({0, 0, 8});
    glb.json["accessors"].push_back(
        {{"componentType", test::kFloat},
         {"count", 3},
         {"type", "VEC3"},
         {"sparse",
          {{"count", 1},
           {"indices", {{"bufferView", where}, {"componentType", test::kUnsignedByte}}},
           {"values", {{"bufferView", what}}}}}});
    const int bend = static_cast<int>(glb.json["accessors"].size()) - 1;
    primitive["targets"] = {
        {{"POSITION", shift}, {"NORMAL", shift}}, {{"POSITION", bend}}, {{"NORMAL", shift}}};
    glb.addNode({{"mesh", glb.addMesh({primitive})}, {"scale", {2, 2, 2}}});
  }
  Glb glb;
};

TEST(GltfMorph, WeightsOfTheNodeElseOfTheMeshMoveVerticesBeforeTheNodeDoes) {
  MorphedTriangle morphed;
  Glb& glb = morphed.glb;
  Scene scene = imported(glb.bytes());
  EXPECT_EQ(cornerOf(scene, 2), Vec3d(0, 2, 0));
  EXPECT_EQ(marksOf(scene), std::vector<OccluderMark>{kAutomatic}) << "all weights are zero";
  glb.json["meshes"][0]["weights"] = {0.5, 0.25, 1};
  scene = imported(glb.bytes());
  EXPECT_EQ(cornerOf(scene, 0), Vec3d(100, 0, 0));
  EXPECT_EQ(cornerOf(scene, 1), Vec3d(102, 0, 0));
  EXPECT_EQ(cornerOf(scene, 2), Vec3d(100, 2, 4));
  EXPECT_EQ(marksOf(scene), std::vector<OccluderMark>{kNever});
  EXPECT_EQ(scene.notes.size(), 1u);
  glb.json["nodes"][0]["weights"] = {0, 1, 0};
  EXPECT_EQ(cornerOf(imported(glb.bytes()), 2), Vec3d(0, 2, 16));
  glb.json["nodes"][0]["weights"] = {0, 0, 0};
  scene = imported(glb.bytes());
  EXPECT_EQ(cornerOf(scene, 2), Vec3d(0, 2, 0));
  EXPECT_EQ(marksOf(scene), std::vector<OccluderMark>{kAutomatic});
}

TEST(GltfMorph, QuantizedDisplacementsAreRead) {
  MorphedTriangle morphed;
  Glb& glb = morphed.glb;
  const int bytes = glb.addAccessor<std::int8_t>({127, 0, 0, 0, 127, 0, 0, 0, -128}, "VEC3", 3);
  glb.json["accessors"][static_cast<std::size_t>(bytes)]["normalized"] = true;
  glb.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = bytes;
  glb.json["meshes"][0]["weights"] = {3, 0, 0};
  const Scene scene = imported(glb.bytes());
  EXPECT_EQ(cornerOf(scene, 0), Vec3d(6, 0, 0));
  EXPECT_EQ(cornerOf(scene, 1), Vec3d(2, 6, 0));
  EXPECT_EQ(cornerOf(scene, 2), Vec3d(0, 2, -6));
}

TEST(GltfMorph, TargetsCountBeforeJointsDo) {
  MorphedTriangle morphed;
  Glb& glb = morphed.glb;
  json& attributes = glb.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = glb.addAccessor<std::uint8_t>(std::vector<std::uint8_t>(12, 0), "VEC4", 4);
  attributes["WEIGHTS_0"] = glb.addAccessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4", 4);
  glb.addNode({{"scale", {3, 3, 3}}});
  glb.json["nodes"][0]["skin"] = 0;
  glb.json["scenes"][0]["nodes"] = {0, 1};
  glb.json["skins"] = {{{"joints", {1}}}};
  glb.json["meshes"][0]["weights"] = {1, 0, 0};
  EXPECT_EQ(cornerOf(imported(glb.bytes()), 1), Vec3d(303, 0, 0));
}

TEST(GltfMorph, AnimatedWeightsMoveTheirNodeAloneAndOnlyIfItHasTargets) {
  for (const bool pointer : {false, true}) {
    MorphedTriangle morphed;
    Glb& glb = morphed.glb;
    const int plain = glb.addMesh({Glb::primitive(0)});
    glb.json["nodes"][0]["children"] = {1};
    glb.addNode({{"mesh", plain}});
    glb.addNode({{"mesh", 0}});
    glb.json["scenes"][0]["nodes"] = {0, 2};
    for (const int node : {0, 1}) {
      pointer ? animatePointer(glb, "/nodes/" + std::to_string(node) + "/weights/1")
              : animate(glb, {{"node", node}, {"path", "weights"}});
    }
    EXPECT_EQ(marksOf(imported(glb.bytes())), (std::vector<OccluderMark>{kNever, kAutomatic, kAutomatic}));
    animatePointer(glb, "/meshes/0/weights");
    EXPECT_EQ(marksOf(imported(glb.bytes())), (std::vector<OccluderMark>{kNever, kAutomatic, kNever}));
  }
}

TEST(GltfMorph, WhatIsWrongIsSaidInOneLine) {
  const auto errorAfter = [](const std::function<void(json&)>& change) {
    MorphedTriangle morphed;
    change(morphed.glb.json);
    return errorOf(morphed.glb.bytes());
  };
  EXPECT_EQ(
      errorAfter([](json& file) { file["accessors"][1]["count"] = 2; }),
      "scene.glb: mesh 0 primitive 0: morph target 0 must displace each of 3 vertices, by VEC3 of floats, "
      "bytes or shorts, but accessor 1 does not");
  EXPECT_EQ(errorAfter([](json& file) { file["meshes"][0]["primitives"][0]["targets"][1]["POSITION"] = 9; }),
            "scene.glb: mesh 0 primitive 0: accessor 9 does not exist (the file has 3)");
  EXPECT_EQ(errorAfter([](json& file) {
              file["meshes"][0]["weights"] = {1, "a"};
            }),
            "scene.glb: mesh 0: \"weights\" must be an array of numbers");
  EXPECT_EQ(errorAfter([](json& file) {
              file["meshes"][0]["weights"] = {1e308, 1e308};
            }),
            "scene.glb: mesh 0 primitive 0: vertex 0 of accessor 0 is not finite");
}

}  // namespace
}  // namespace sightline
