// sightline layers: the order of parts, as JSON and as text.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <utility>

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

json layered(const std::vector<std::string>& more) {
  return toolJson(joined({"layers", "--no-times"}, more));
}

std::set<std::set<int>> groupsOf(const json& frame) {
  std::set<std::set<int>> groups;
  for (const json& group : frame["order"]) {
    groups.insert(std::set<int>(group.begin(), group.end()));
  }
  return groups;
}

TEST(Layers, EveryPartIsInOneGroupAndInOneLayer) {
  const json result = layered({"demo:toothpicks?n=60", "--frames", "0:30:10"});
  ASSERT_EQ(result["frames"].size(), 3u);
  EXPECT_EQ(result["parts"], 80);
  for (const json& frame : result["frames"]) {
    for (const char* lists : {"order", "layers"}) {
      std::multiset<int> parts;
      for (const json& list : frame[lists]) {
        parts.insert(list.begin(), list.end());
      }
      EXPECT_EQ(parts.size(), 80u) << lists;
      EXPECT_EQ(std::set<int>(parts.begin(), parts.end()).size(), 80u) << lists;
    }
    EXPECT_FALSE(frame["program"].empty());
    EXPECT_EQ(frame["sort_us"], 0.0);
  }
}

TEST(Layers, AnUnknownSearchIsRefusedByTheNamesOfTheKnownOnes) {
  const Outcome outcome = runTool({"layers", "demo:toothpicks?n=60", "--search", "automatic"});
  EXPECT_NE(outcome.code, 0);
  EXPECT_NE(outcome.err.find("'automatic' is not one of: scan, tree"), std::string::npos) << outcome.err;
}

std::set<std::pair<int, int>> arcsOf(const std::vector<std::string>& more, const char* frame = "40") {
  std::set<std::pair<int, int>> arcs;
  const json result = layered(joined({"--arcs", "all", "--frames", frame}, more));
  for (const json& arc : result["frames"][0]["arcs"]) {
    arcs.emplace(arc[0], arc[1]);
  }
  return arcs;
}

bool holds(const std::set<std::pair<int, int>>& all, const std::set<std::pair<int, int>>& some) {
  return std::includes(all.begin(), all.end(), some.begin(), some.end());
}

TEST(Layers, AnOrderForTwoEyesOrALensHasMoreArcsTheFartherItReaches) {
  const std::string scene = "demo:toothpicks?n=60";
  const auto eye = arcsOf({scene}), near = arcsOf({scene, "--stereo", "0.1"}),
             far = arcsOf({scene, "--stereo", "1"});
  EXPECT_TRUE(holds(near, eye));
  EXPECT_TRUE(holds(far, near));
  EXPECT_GT(far.size(), near.size());
  EXPECT_GT(near.size(), eye.size());
}

TEST(Layers, AnOrderForAShutterHoldsThatOfItsMiddle) {
  const TemporaryFolder folder;
  const std::vector<std::string> blur{"demo:toothpicks?n=60",
                                      "--width",
                                      "64",
                                      "--height",
                                      "36",
                                      "--motion-blur",
                                      "1",
                                      "--blurred",
                                      folder.file("a.png"),
                                      "--depth-of-field",
                                      "layers",
                                      "--focus",
                                      "2",
                                      "--aperture",
                                      "0.1"};
  const auto eye = arcsOf(joined(blur, {"--order-for", "eye"})), lens = arcsOf(blur);
  EXPECT_TRUE(holds(lens, eye));
  EXPECT_GT(lens.size(), eye.size());
  EXPECT_EQ(layered(joined(blur, {"--frames", "40"}))["options"]["order_for"], "lens");
  EXPECT_EQ(layered({"demo:toothpicks?n=60", "--frames", "0"})["options"]["order_for"], "eye");
}

using Eye = std::array<double, 3>;
// Arcs of the first frame of a camera path with these eyes.
std::set<std::pair<int, int>> arcsFrom(const std::vector<Eye>& eyes, const std::vector<std::string>& more) {
  const TemporaryFolder folder;
  json path = {{"frames", json::array()}};
  for (const Eye& eye : eyes) {
    path["frames"].push_back({{"eye", eye}, {"forward", {0, 0, -1}}});
  }
  return arcsOf(joined({"demo:toothpicks?n=60", "--width", "64", "--height", "36", "--path",
                        folder.write("path.json", path.dump())},
                       more),
                "0");
}

// Two eyes 0.6 m apart, as the shutter opens and as it closes.
TEST(Layers, AnOrderForAShutterHoldsThoseOfBothEyesAtItsEnds) {
  const TemporaryFolder folder;
  const auto all = arcsFrom({Eye{0.0, 0.0, 2.5}, Eye{0.0, 0.6, 2.5}},
                            {"--stereo", "0.6", "--motion-blur", "1", "--blurred", folder.file("a.png")});
  for (const double x : {-0.3, 0.3}) {
    for (const double y : {-0.3, 0.3}) {
      EXPECT_TRUE(holds(all, arcsFrom({Eye{x, y, 2.5}}, {}))) << x << ", " << y;
    }
  }
}

// The eyes are 0.6 m apart and each lens is 0.4 m wide. Their highest and farthest points are looked from.
TEST(Layers, AnOrderForALensHoldsThoseOfTheLensesOfBothEyes) {
  const TemporaryFolder folder;
  const auto all =
      arcsFrom({Eye{0.0, 0.0, 2.5}}, {"--stereo", "0.6", "--depth-of-field", "layers", "--focus", "2",
                                      "--aperture", "0.4", "--blurred", folder.file("a.png")});
  for (const auto& [x, y] :
       {std::pair{0.3, 0.2}, {0.3, -0.2}, {-0.3, 0.2}, {-0.3, -0.2}, {0.5, 0.0}, {-0.5, 0.0}}) {
    EXPECT_TRUE(holds(all, arcsFrom({Eye{x, y, 2.5}}, {}))) << x << ", " << y;
  }
}

// A ring around the y axis and a pole through it.
std::string ringAndPole() {
  std::string obj = "o ring\n";
  const auto vertex = [&](double x, double y, double z) {
    obj += "v " + std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  };
  const auto face = [&](int a, int b, int c, int d) {
    obj += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + " " +
           std::to_string(d) + "\n";
  };
  constexpr int kAround = 24;
  for (int i = 0; i < kAround; ++i) {
    const double x = std::cos(6.283185307 * i / kAround), z = std::sin(6.283185307 * i / kAround);
    vertex(x, -0.1, z), vertex(1.1 * x, -0.1, 1.1 * z), vertex(1.1 * x, 0.1, 1.1 * z), vertex(x, 0.1, z);
  }
  for (int i = 0; i < kAround; ++i) {
    const int at = 4 * i + 1, next = 4 * ((i + 1) % kAround) + 1;
    for (int k = 0; k < 4; ++k) {
      face(at + k, next + k, next + (k + 1) % 4, at + (k + 1) % 4);
    }
  }
  obj += "o pole\n";
  for (int i = 0; i < 8; ++i) {
    vertex((i & 1) != 0 ? 0.1 : -0.1, (i & 2) != 0 ? 2 : -2, (i & 4) != 0 ? 0.1 : -0.1);
  }
  const int first = 4 * kAround + 1;
  face(first, first + 1, first + 3, first + 2), face(first + 4, first + 5, first + 7, first + 6);
  return obj;
}

TEST(Layers, WithPiecesAPoleThroughARingHasAnOrder) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("ring.obj", ringAndPole());
  const std::string path =
      folder.write("above.json", R"({"fovy_deg": 60, "width": 64, "height": 36, "near": 0.1, "far": 100,
                        "frames": [{"eye": [0.3, 9, 0.2], "forward": [0, -1, 0.001], "up": [0, 0, 1]}]})");
  const json one = layered({scene, "--path", path}),
             pieces = layered({scene, "--path", path, "--pieces", "16"});
  ASSERT_EQ(one["parts"], 2);
  EXPECT_EQ(one["frames"][0]["order"].size(), 1u);
  EXPECT_EQ(pieces["frames"][0]["order"].size(), 2u);
  EXPECT_EQ(pieces["options"]["pieces"], 16);
  expectRefused({"layers", scene, "--path", path, "--pieces", "0"}, "--pieces");
  expectRefused({"layers", scene, "--path", path, "--pieces", "99999"}, "--pieces");
  expectRefused({"layers", "demo:toothpicks", "--frames", "0", "--pieces", "2"}, "hulls of their own");
}

// A gate, of two posts and a beam that are one object, and a block that stands in it.
std::string gateAndBlock() {
  std::string obj;
  int corners = 0;
  const auto box = [&](double x0, double x1, double y0, double y1, double depth) {
    for (int i = 0; i < 8; ++i) {
      obj += fmt::format("v {} {} {}\n", (i & 1) != 0 ? x1 : x0, (i & 2) != 0 ? y1 : y0,
                         (i & 4) != 0 ? depth : -depth);
    }
    for (const auto& [a, b, c, d] :
         {std::array{1, 3, 4, 2}, {5, 6, 8, 7}, {1, 2, 6, 5}, {3, 7, 8, 4}, {1, 5, 7, 3}, {2, 4, 8, 6}}) {
      obj += fmt::format("f {} {} {} {}\n", corners + a, corners + b, corners + c, corners + d);
    }
    corners += 8;
  };
  obj += "o gate\n";
  box(-3, -2, 0, 3, 0.5);
  box(2, 3, 0, 3, 0.5);
  box(-3, 3, 3, 4, 0.5);
  obj += "o block\n";
  box(-0.3, 0.3, 1, 1.6, 0.3);
  return obj;
}

TEST(Layers, ABlockInAGateHasAnOrderOnceTheGateIsCut) {
  const TemporaryFolder folder;
  const std::string scene = folder.write("gate.obj", gateAndBlock());
  const std::string path =
      folder.write("front.json", R"({"fovy_deg": 60, "width": 64, "height": 36, "near": 0.1, "far": 100,
                        "frames": [{"eye": [0.1, 1.9, 9], "forward": [0, 0, -1], "up": [0, 1, 0]}]})");
  const json whole = layered({scene, "--path", path}),
             cut = layered({scene, "--path", path, "--pre-split", "1", "--pre-split-overlap", "0.1"});
  ASSERT_EQ(whole["parts"], 2);
  EXPECT_EQ(whole["frames"][0]["order"].size(), 1u);
  EXPECT_GT(cut["parts"], 10);
  EXPECT_EQ(cut["frames"][0]["order"].size(), cut["parts"].get<std::size_t>());
  EXPECT_EQ(cut["options"]["pre_split"], 1.0);
  EXPECT_EQ(cut["options"]["pre_split_overlap"], 0.1);
  expectRefused({"layers", scene, "--path", path, "--pre-split", "nan"}, "--pre-split");
  expectRefused({"layers", scene, "--path", path, "--pre-split", "1", "--pre-split-overlap", "nan"},
                "--pre-split-overlap");
  expectRefused({"layers", scene, "--path", path, "--pre-split", "1", "--svg", folder.file("cut.svg")},
                "--pre-split: does not go with --svg");
  expectRefused({"layers", scene, "--path", path, "--pre-split", "-1"}, "--pre-split");
  expectRefused({"layers", "demo:toothpicks", "--frames", "0", "--pre-split", "2"}, "stay whole");
}

TEST(Layers, ArcsGoFromTheFrontToTheBack) {
  const json result = layered({"demo:toothpicks?n=60", "--frames", "0:30:10", "--arcs", "all"});
  for (const json& frame : result["frames"]) {
    std::map<int, std::size_t> group_of;
    for (std::size_t i = 0; i < frame["order"].size(); ++i) {
      for (const json& part : frame["order"][i]) {
        group_of[part.get<int>()] = i;
      }
    }
    EXPECT_GT(frame["arcs"].size(), 20u);
    for (const json& arc : frame["arcs"]) {
      EXPECT_LE(group_of.at(arc[0]), group_of.at(arc[1])) << arc;
    }
  }
}

TEST(Layers, SortersAndSearchesGiveTheSameGroups) {
  const std::vector<std::string> scene{"demo:toothpicks?n=100&scaling=ud&seed=3", "--frames", "0:40:10"};
  const json expected = layered(scene);
  for (const std::vector<std::string>& more : {std::vector<std::string>{"--sort", "incremental"},
                                               {"--search", "tree"},
                                               {"--search", "scan"},
                                               {"--extents", "world"},
                                               {"--conditioning", "off"}}) {
    const json other = layered(joined(scene, more));
    for (std::size_t i = 0; i < expected["frames"].size(); ++i) {
      EXPECT_EQ(groupsOf(other["frames"][i]), groupsOf(expected["frames"][i])) << more.back();
    }
  }
}

TEST(Layers, ObjectsOfAnySceneAreParts) {
  const json result =
      layered({"demo:building?floors=1", "--frames", "0:20:10", "--backdrop", "3,1", "--overlay", "2"});
  for (const json& frame : result["frames"]) {
    const json& order = frame["order"];
    EXPECT_EQ(order[0], json::array({2}));
    EXPECT_EQ(order[order.size() - 2], json::array({1}));
    EXPECT_EQ(order[order.size() - 1], json::array({3}));
  }
}

TEST(Layers, TheCanyonsSkyIsBehindEverything) {
  const json result = layered({"demo:canyon?grid=5", "--frames", "0:250:100", "--extents", "world"});
  const json first = result["frames"][0]["order"].back();
  ASSERT_EQ(first.size(), 1u);
  for (const json& frame : result["frames"]) {
    EXPECT_EQ(frame["order"].back(), first);
  }
}

TEST(Layers, BadUsageIsRefused) {
  expectRefused({"layers", "demo:toothpicks?n=0"}, "1 to");
  expectRefused({"layers", "demo:toothpicks?scaling=big"}, "ud");
  expectRefused({"layers", "demo:canyon?grid=x"}, "grid");
  expectRefused({"layers", "demo:toothpicks", "--sort", "bubble"}, "--sort");
  expectRefused({"layers", "demo:toothpicks", "--backdrop", "220"}, "--backdrop 220");
  expectRefused({"layers", "demo:toothpicks", "--overlay", "-1"}, "--overlay");
  expectRefused({"layers", "demo:toothpicks", "--frames", "9:3"}, "--frames");
  expectRefused({"layers", "demo:toothpicks", "--backdrop", "3", "--overlay", "3"}, "--overlay 3");
  expectRefused({"layers", "demo:toothpicks", "--backdrop", ""}, "--backdrop");
  expectRefused({"layers", "demo:toothpicks", "--json", ""}, "--json");
  expectRefused({"layers", ""}, "SCENE");
  expectRefused({"layers", "/nowhere/scene.glb"}, "/nowhere/scene.glb");
  expectRefused({"reproduce", "snyder-lengyel", "--scene", "demo:city"}, "leave them out");
  expectRefused({"reproduce", "snyder-lengyel", "--frames", "0:3"}, "leave them out");
}

}  // namespace
}  // namespace sightline::tool_test
