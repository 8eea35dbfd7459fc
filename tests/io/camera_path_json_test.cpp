#include "sightline/io/camera_path_json.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace sightline {
namespace {

using nlohmann::json;

json soundPath() {
  return {{"fovy_deg", 50}, {"width", 640},
          {"height", 480},  {"near", 0.25},
          {"far", 500},     {"frames", {{{"eye", {1, 2, 3}}, {"forward", {0, 0, -2}}, {"up", {0, 1, 0}}}}}};
}

std::string errorOf(const json& document) {
  const Result<CameraPath> path = parseCameraPath(document.dump(), "walk.path.json");
  return path ? "accepted" : path.error().message;
}

TEST(CameraPathJson, ReadsEveryKey) {
  const Result<CameraPath> path = parseCameraPath(soundPath().dump(), "dir/walk.path.json");
  ASSERT_TRUE(path) << path.error().message;
  EXPECT_EQ(path->fovy_deg, 50.0);
  EXPECT_EQ(path->width, 640u);
  EXPECT_EQ(path->height, 480u);
  EXPECT_EQ(path->z_near, 0.25);
  EXPECT_EQ(path->z_far, 500.0);
  EXPECT_EQ(path->shift_x, 0.0);
  EXPECT_EQ(path->shift_y, 0.0);
  ASSERT_EQ(path->frames.size(), 1u);
  EXPECT_EQ(path->frames[0].eye, Vec3d(1, 2, 3));
  EXPECT_EQ(path->frames[0].forward, Vec3d(0, 0, -2));
  EXPECT_EQ(path->frames[0].up, Vec3d(0, 1, 0));
}

TEST(CameraPathJson, NamesKeysThatItDoesNotKnowOnceEach) {
  json document = soundPath();
  document["fovydeg"] = 1;
  document["frames"].push_back(document["frames"][0]);
  document["frames"].push_back(document["frames"][0]);
  document["frames"][1]["fovydeg"] = document["frames"][2]["fovydeg"] = 1;
  std::vector<UnknownKey> unknown;
  EXPECT_TRUE(parseCameraPath(document.dump(), "walk", &unknown));
  ASSERT_EQ(unknown.size(), 2u);
  EXPECT_EQ(unknown[0].key, "fovydeg");
  EXPECT_FALSE(unknown[0].frame);
  EXPECT_EQ(unknown[0].known.size(), 9u);
  EXPECT_EQ(unknown[1].key, "fovydeg");
  EXPECT_EQ(unknown[1].frame, 1u);
  EXPECT_EQ(unknown[1].frames, 2u);
  EXPECT_EQ(unknown[1].known.size(), 3u);
}

TEST(CameraPathJson, KnowsEveryKeyThatItWrites) {
  CameraPath path;
  path.frames = {{{1, 2, 3}, {1, 0, 0}, {0, 0, 1}}};
  std::vector<UnknownKey> unknown;
  EXPECT_TRUE(parseCameraPath(toJson(path), "walk", &unknown));
  path.ortho_height = 2.0;
  path.shift_x = 0.5;
  EXPECT_TRUE(parseCameraPath(toJson(path), "walk", &unknown));
  EXPECT_TRUE(unknown.empty());
}

TEST(CameraPathJson, WritesWhatItReadsBackBitForBit) {
  CameraPath path;
  path.name = "a \"quoted\" walk";
  path.fovy_deg = 1.0 / 3.0;
  path.z_near = 0.1;
  path.z_far = 12345.678901234567;
  path.frames = {{{5e6 + 0.001, -0.0, 1e-300}, {0.1, 0.2, 0.3}, {0, 1, 0}},
                 {{1, 2, 3}, {1, 0, 0}, {0, 0, 1}}};
  const Result<CameraPath> again = parseCameraPath(toJson(path), "again");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(again->name, path.name);
  EXPECT_EQ(again->fovy_deg, path.fovy_deg);
  EXPECT_EQ(again->ortho_height, 0.0);
  EXPECT_EQ(again->z_far, path.z_far);
  ASSERT_EQ(again->frames.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(again->frames[i].eye, path.frames[i].eye);
    EXPECT_EQ(again->frames[i].forward, path.frames[i].forward);
    EXPECT_EQ(again->frames[i].up, path.frames[i].up);
  }
  EXPECT_EQ(again->shift_x, 0.0);
  EXPECT_EQ(toJson(path).find("shift"), std::string::npos) << "only views that are off-centre have one";
  path.shift_x = -1.0 / 3.0;
  path.shift_y = 1e-5;
  const Result<CameraPath> shifted = parseCameraPath(toJson(path), "again");
  ASSERT_TRUE(shifted) << shifted.error().message;
  EXPECT_EQ(shifted->shift_x, path.shift_x);
  EXPECT_EQ(shifted->shift_y, path.shift_y);
  path.ortho_height = 12.5;
  EXPECT_EQ(parseCameraPath(toJson(path), "again").value().ortho_height, 12.5);
}

TEST(CameraPathJson, IgnoresUnknownKeys) {
  json document = soundPath();
  document["comment"] = {{"by", "somebody"}};
  document["frames"][0]["time"] = 0;
  EXPECT_TRUE(parseCameraPath(document.dump(), "walk"));
}

TEST(CameraPathJson, NamesTheKeyThatIsWrong) {
  const auto with = [](const char* key, const json& value) {
    json document = soundPath();
    document[key] = value;
    return errorOf(document);
  };
  EXPECT_EQ(with("fovy_deg", 180), "walk.path.json: \"fovy_deg\" must be between 0 and 180");
  EXPECT_EQ(with("fovy_deg", 0), "walk.path.json: \"fovy_deg\" must be between 0 and 180");
  EXPECT_EQ(with("fovy_deg", "60"), "walk.path.json: \"fovy_deg\" must be a finite number");
  EXPECT_EQ(with("ortho_height", 0), "walk.path.json: \"ortho_height\" must be greater than 0");
  EXPECT_EQ(with("near", 0), "walk.path.json: \"near\" must be greater than 0");
  EXPECT_EQ(with("near", 500), "walk.path.json: \"far\" must be greater than \"near\"");
  EXPECT_EQ(with("shift", {-1000, 1000}), "accepted");
  for (const json& bad : {json({1, 2, 3}), json({1}), json({1, "2"}), json({0, 1000.5}), json({-1e308, 0}),
                          json(0.5), json(nullptr), json::object()}) {
    EXPECT_EQ(with("shift", bad), "walk.path.json: \"shift\" must be two numbers from -1000 to 1000");
  }
  EXPECT_NE(with("width", 0).find("\"width\" must be a whole number"), std::string::npos);
  EXPECT_NE(with("height", 4.5).find("\"height\" must be a whole number"), std::string::npos);
  EXPECT_NE(with("width", 1e18).find("\"width\" must be a whole number"), std::string::npos);
  EXPECT_EQ(with("frames", json::array()),
            "walk.path.json: \"frames\" must be an array of at least one frame");
  EXPECT_EQ(with("frames", 3), "walk.path.json: \"frames\" must be an array of at least one frame");
  EXPECT_NE(with("frames", {1}).find("frame 0: must be an object"), std::string::npos);
}

TEST(CameraPathJson, NamesTheFrameThatIsWrong) {
  json document = soundPath();
  const json frame = document["frames"][0];
  const auto with = [&](const char* key, const json& value) {
    document["frames"] = {frame, frame};
    document["frames"][1][key] = value;
    return errorOf(document);
  };
  EXPECT_EQ(with("eye", {1, 2}), "walk.path.json: frame 1: \"eye\" must be three finite numbers");
  EXPECT_EQ(with("eye", {1, 2, "3"}), "walk.path.json: frame 1: \"eye\" must be three finite numbers");
  EXPECT_EQ(with("eye", nullptr), "walk.path.json: frame 1: \"eye\" must be three finite numbers");
  EXPECT_NE(with("forward", {0, 0, 0}).find("frame 1: \"forward\" must be a direction"), std::string::npos);
  EXPECT_NE(with("up", {0, 0, 0}).find("frame 1: \"up\" must be a direction"), std::string::npos);
  document["frames"] = json::array({frame});
  document["frames"][0].erase("eye");
  EXPECT_EQ(errorOf(document), "walk.path.json: frame 0: \"eye\" is missing");
}

TEST(CameraPathJson, RefusesWhatIsNotJson) {
  for (const char* text :
       {"", "{", "[]", "3", "{\"frames\":[{\"eye\":[1e999,0,0],\"forward\":[0,0,1]}]}", "\xff"}) {
    const Result<CameraPath> path = parseCameraPath(text, "bad");
    ASSERT_FALSE(path) << text;
    EXPECT_EQ(path.error().message.find("bad: "), 0u) << path.error().message;
    EXPECT_EQ(path.error().message.find('\n'), std::string::npos) << path.error().message;
    EXPECT_EQ(path.error().message.find("exception"), std::string::npos) << path.error().message;
  }
}

TEST(CameraPathJson, SaysThatAFileIsMissing) {
  EXPECT_EQ(readCameraPath("/nowhere/walk.path.json").error().message,
            "/nowhere/walk.path.json: no such file");
}

}  // namespace
}  // namespace sightline
