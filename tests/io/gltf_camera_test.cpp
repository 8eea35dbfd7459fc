// Cameras of a glTF file, at rest and animated.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/io/glb_builder.h"
#include "tests/io/scene_checks.h"

namespace sightline {
namespace {

using nlohmann::json;
using test::errorOf;
using test::Glb;
using test::imported;

json perspective() {
  return {
      {"type", "perspective"},
      {"perspective", {{"yfov", std::numbers::pi / 2}, {"znear", 0.5}, {"zfar", 100}, {"aspectRatio", 2}}}};
}

json orthographic() {
  return {{"type", "orthographic"}, {"orthographic", {{"xmag", 6}, {"ymag", 3}, {"znear", 0}, {"zfar", 50}}}};
}

// Node 0 carries the camera and hangs below node 1, the root.
Glb oneCamera(const json& camera) {
  Glb glb;
  glb.json["cameras"] = json::array({camera});
  glb.addNode({{"name", "eye"}, {"camera", 0}});
  glb.addNode({{"name", "arm"}, {"children", {0}}});
  glb.json["scenes"][0]["nodes"] = {1};
  return glb;
}

void addChannel(Glb& glb, int node, const char* path, const std::vector<float>& times,
                const std::vector<float>& values, const char* interpolation = "LINEAR") {
  const bool rotation = std::string(path) == "rotation";
  if (!glb.json.contains("animations")) {
    glb.json["animations"] = json::array({{{"channels", json::array()}, {"samplers", json::array()}}});
  }
  json& animation = glb.json["animations"][0];
  const int input = glb.addAccessor(times, "SCALAR", 1);
  const int output = rotation ? glb.addAccessor(values, "VEC4", 4) : glb.addAccessor(values, "VEC3", 3);
  animation["channels"].push_back(
      {{"sampler", animation["samplers"].size()}, {"target", {{"node", node}, {"path", path}}}});
  animation["samplers"].push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
}

void expectNear(const Vec3d& a, const Vec3d& b, double tolerance = 1e-6) {
  EXPECT_LT(length(a - b), tolerance)
      << "(" << a.x << ", " << a.y << ", " << a.z << ") is not (" << b.x << ", " << b.y << ", " << b.z << ")";
}

TEST(GltfCamera, AStillCameraIsAPathOfOneFrame) {
  Glb glb = oneCamera(perspective());
  const double half = std::sqrt(0.5);
  glb.json["nodes"][0]["rotation"] = {0, half, 0, half};  // a quarter turn to the left: looks along -X
  glb.json["nodes"][1]["translation"] = {1, 2, 3};
  glb.json["nodes"][1]["scale"] = {2, 2, 2};
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.paths.size(), 1u);
  const CameraPath& path = scene.paths[0];
  EXPECT_EQ(path.name, "eye");
  EXPECT_NEAR(path.fovy_deg, 90.0, 1e-9);
  EXPECT_EQ(path.z_near, 0.5);
  EXPECT_EQ(path.z_far, 100.0);
  EXPECT_EQ(path.width, 2 * path.height);
  ASSERT_EQ(path.frames.size(), 1u);
  expectNear(path.frames[0].eye, {1, 2, 3});
  expectNear(path.frames[0].forward, {-1, 0, 0});
  expectNear(path.frames[0].up, {0, 1, 0});
}

TEST(GltfCamera, AnEndlessCameraReachesTheWholeScene) {
  json camera = perspective();
  camera["perspective"].erase("zfar");
  Glb glb = oneCamera(camera);
  glb.json["nodes"][0]["translation"] = {0, 0, 1000};
  const int mesh = glb.addMesh({Glb::primitive(glb.addPositions({0, 0, -500, 1, 0, -500, 0, 1, -500}))});
  glb.json["nodes"][1]["mesh"] = mesh;
  const CameraPath path = imported(glb.bytes()).paths.at(0);
  EXPECT_GE(path.z_far, 1500.0);
  EXPECT_LT(path.z_far, 2000.0);
}

TEST(GltfCamera, AnOrthographicCameraKeepsItsHeight) {
  Glb glb = oneCamera(orthographic());
  const CameraPath path = imported(glb.bytes()).paths.at(0);
  EXPECT_EQ(path.ortho_height, 6.0);
  EXPECT_EQ(path.width, 2 * path.height);
  // The near plane stays at the node, the far plane 50 metres beyond, though near must be positive.
  EXPECT_GT(path.z_near, 0.0);
  EXPECT_NEAR(path.frames.at(0).eye.z - path.z_near, 0.0, 1e-12);
  EXPECT_NEAR(path.frames.at(0).eye.z - path.z_far, -50.0, 1e-12);
}

TEST(GltfCamera, APerspectiveCameraAfterAnOrthographicOneStandsAtItsNode) {
  Glb glb = oneCamera(orthographic());
  glb.json["cameras"].push_back(perspective());
  glb.json["scenes"][0]["nodes"].push_back(glb.addNode({{"camera", 1}, {"translation", {1, 2, 3}}}));
  const Scene scene = imported(glb.bytes());
  ASSERT_EQ(scene.paths.size(), 2u);
  ASSERT_GT(scene.paths[0].frames.at(0).eye.z, 0.0) << "the orthographic camera steps back";
  expectNear(scene.paths[1].frames.at(0).eye, {1, 2, 3}, 1e-12);
}

TEST(GltfCamera, AnAnimatedAncestorMovesTheCamera) {
  Glb glb = oneCamera(perspective());
  glb.json["nodes"][0]["translation"] = {0, 1, 0};
  addChannel(glb, 1, "translation", {0, 1}, {0, 0, 0, 3, 0, 0});
  const CameraPath path = imported(glb.bytes()).paths.at(0);
  ASSERT_EQ(path.frames.size(), 31u) << "30 frames a second, both ends";
  expectNear(path.frames[0].eye, {0, 1, 0});
  expectNear(path.frames[10].eye, {1, 1, 0});
  expectNear(path.frames[30].eye, {3, 1, 0});
}

TEST(GltfCamera, RotationsGoAlongTheSphere) {
  Glb glb = oneCamera(perspective());
  const float half = std::sqrt(0.5f);
  // A quarter turn to the left within one second, its end given by the quaternion of the opposite sign.
  addChannel(glb, 0, "rotation", {0, 1}, {0, 0, 0, 1, 0, -half, 0, -half});
  const CameraPath path = imported(glb.bytes()).paths.at(0);
  ASSERT_EQ(path.frames.size(), 31u);
  for (std::size_t i = 0; i <= 30; ++i) {
    const double angle = std::numbers::pi / 2 * static_cast<double>(i) / 30.0;
    expectNear(path.frames[i].forward, {-std::sin(angle), 0, -std::cos(angle)}, 1e-5);
  }
}

TEST(GltfCamera, StepsHoldTheirValue) {
  Glb glb = oneCamera(perspective());
  addChannel(glb, 0, "translation", {0, 0.5, 1}, {0, 0, 0, 7, 0, 0, 9, 0, 0}, "STEP");
  const CameraPath path = imported(glb.bytes()).paths.at(0);
  ASSERT_EQ(path.frames.size(), 31u);
  expectNear(path.frames[14].eye, {0, 0, 0});
  expectNear(path.frames[16].eye, {7, 0, 0});
  expectNear(path.frames[29].eye, {7, 0, 0});
  expectNear(path.frames[30].eye, {9, 0, 0});
}

TEST(GltfCamera, SplinesFollowTheirTangents) {
  Glb glb = oneCamera(perspective());
  // x = t^2 on [0, 1]: tangents 0 and 2. In-tangent, value, out-tangent for each key.
  addChannel(glb, 0, "translation", {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 1, 0, 0, 0, 0, 0},
             "CUBICSPLINE");
  const CameraPath path = imported(glb.bytes()).paths.at(0);
  ASSERT_EQ(path.frames.size(), 31u);
  for (std::size_t i = 0; i <= 30; ++i) {
    const double time = static_cast<double>(i) / 30.0;
    expectNear(path.frames[i].eye, {time * time, 0, 0});
  }
}

TEST(GltfCamera, WrongProjectionsAreRefused) {
  const auto message = [](const char* key, const json& value) {
    json camera = perspective();
    camera["perspective"][key] = value;
    return errorOf(oneCamera(camera).bytes());
  };
  EXPECT_NE(message("yfov", 0).find("node 0: camera 0: yfov 0"), std::string::npos);
  EXPECT_NE(message("yfov", 3.2).find("yfov 3.2"), std::string::npos);
  EXPECT_NE(message("znear", 0).find("0 < znear < zfar"), std::string::npos);
  EXPECT_NE(message("zfar", 0.25).find("0 < znear < zfar"), std::string::npos);
  EXPECT_NE(message("aspectRatio", 1e9).find("is not usable"), std::string::npos);
  EXPECT_NE(message("yfov", "wide").find("camera 0 perspective: \"yfov\" must be a number"),
            std::string::npos);
}

TEST(GltfCamera, WrongAnimationsAreRefused) {
  const auto message = [](const std::vector<float>& times, const std::vector<float>& values) {
    Glb glb = oneCamera(perspective());
    addChannel(glb, 0, "translation", times, values);
    return errorOf(glb.bytes());
  };
  EXPECT_NE(message({0, 0}, {0, 0, 0, 1, 0, 0}).find("animation 0 sampler 0: time 0 of key 1"),
            std::string::npos);
  EXPECT_NE(message({0, NAN}, {0, 0, 0, 1, 0, 0}).find("time nan of key 1"), std::string::npos);
  EXPECT_NE(message({0, 1}, {0, 0, 0}).find("1 values do not go with 2 keys"), std::string::npos);
  EXPECT_NE(message({0, 1e30f}, {0, 0, 0, 1, 0, 0}).find("need more than"), std::string::npos);
  EXPECT_NE(message({0, 1}, {0, 0, 0, NAN, 0, 0}).find("is not usable"), std::string::npos);
}

TEST(GltfCamera, ACameraFlattenedByItsTransformIsRefused) {
  Glb glb = oneCamera(perspective());
  glb.json["nodes"][1]["scale"] = {1, 1, 0};
  EXPECT_NE(errorOf(glb.bytes()).find("node 0: camera 0: frame 0"), std::string::npos);
}

}  // namespace
}  // namespace sightline
