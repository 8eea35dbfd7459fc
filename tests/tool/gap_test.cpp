// Objects seen through a slit that no pixel's ray passes: `verify` must find them without being told to look.

#include <fmt/format.h>

#include <limits>
#include <optional>

#include "oracle/exact_visibility.h"
#include "sightline/scene/scene.h"
#include "tests/support/hand_made.h"
#include "tests/support/wide_ray.h"
#include "tests/tool/run_tool.h"

namespace sightline::tool_test {
namespace {

using nlohmann::json;

constexpr double kSlitEye = 0.00005;                                         // x, in the middle of the slit
constexpr int kObjectsBehind = 198, kSlitWalls = 2;                          // objects
constexpr float kSlitLeft = 0.0f, kSlitRight = 0.0001f, kSlitWallZ = -4.0f;  // metres

// Triangles of objects, corner after corner.
struct Gap {
  std::vector<std::vector<Vec3f>> objects;
  int seen = 0;  // of those behind the walls
};

// A third of the objects cross the plane of sight through the slit, one above the other; the others end a
// centimetre or more beside it.
Gap wallsWithSlit() {
  Gap gap;
  const auto addWall = [&](float x0, float x1) {
    const Vec3f a(x0, -8, kSlitWallZ), b(x1, -8, kSlitWallZ), c(x1, 8, kSlitWallZ), d(x0, 8, kSlitWallZ);
    gap.objects.push_back({a, b, c, a, c, d});
  };
  addWall(-8, kSlitLeft);
  addWall(kSlitRight, 8);
  for (int i = 0; i < kObjectsBehind; ++i) {
    const float distance = 6.0f + static_cast<float>((i * 37) % 140) * 0.1f;
    const float y = (static_cast<float>(i) / kObjectsBehind - 0.5f) * distance, size = 0.002f * distance;
    const bool crosses = i % 3 == 0;
    const float x = crosses ? -0.01f : i % 3 == 1 ? 0.01f + static_cast<float>(i % 7) * 0.1f : -1.0f;
    const float end = crosses ? 0.02f : x + 0.3f;
    gap.objects.push_back({Vec3f(x, y, -distance), Vec3f(end, y, -distance), Vec3f(end, y + size, -distance),
                           Vec3f(x, y, -distance), Vec3f(end, y + size, -distance),
                           Vec3f(x, y + size, -distance)});
    gap.seen += crosses ? 1 : 0;
  }
  return gap;
}

std::string slitObj(const Gap& gap) {
  std::string text;
  std::size_t corner = 1;
  for (std::size_t o = 0; o < gap.objects.size(); ++o) {
    text += fmt::format("o part{}\n", o);
    for (const Vec3f& p : gap.objects[o]) {
      text += fmt::format("v {} {} {}\n", p.x, p.y, p.z);
    }
    for (std::size_t i = 0; i < gap.objects[o].size(); i += 3, corner += 3) {
      text += fmt::format("f {} {} {}\n", corner, corner + 1, corner + 2);
    }
  }
  return text;
}

std::string slitPath() {
  return fmt::format(R"({{"fovy_deg": 60, "width": 640, "height": 480, "near": 0.1, "far": 100,
      "frames": [{{"eye": [{}, 0, 0], "forward": [0, 0, -1], "up": [0, 1, 0]}}]}})",
                     kSlitEye);
}

View slitView() {
  View view;
  view.eye = {kSlitEye, 0, 0};
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  view.tan_half_fovy = 0.577;
  view.aspect = 640.0 / 480.0;
  view.z_near = 0.1;
  view.z_far = 100.0;
  return view;
}

Scene sceneOf(const Gap& gap) {
  Scene scene;
  scene.materials.emplace_back();
  for (const std::vector<Vec3f>& corners : gap.objects) {
    hand_made::addTriangles(scene, MaterialId(0u), corners);
  }
  return scene;
}

// The objects that rays down the middle of the slit reach first, by arithmetic of 113 bits.
std::vector<bool> reachedThroughTheSlit(const Gap& gap) {
  std::vector<bool> reached(gap.objects.size());
  for (int i = -3000; i <= 3000; ++i) {
    const WideRay ray(slitView().eye, {0.0, i * 0.00018, -1.0});
    std::optional<std::size_t> first;
    Wide nearest = 0;
    for (std::size_t o = 0; o < gap.objects.size(); ++o) {
      for (std::size_t c = 0; c < gap.objects[o].size(); c += 3) {
        const std::vector<Vec3f>& corners = gap.objects[o];
        const std::optional<Wide> t = ray.intersect(corners[c], corners[c + 1], corners[c + 2], false);
        if (t && *t > 0 && (!first || *t < nearest)) {
          first = o;
          nearest = *t;
        }
      }
    }
    if (first) {
      reached[*first] = true;
    }
  }
  return reached;
}

TEST(Gap, TheProofFindsWhatRaysThroughTheSlitReach) {
  const Gap gap = wallsWithSlit();
  const Scene scene = sceneOf(gap);
  std::vector<ObjectId> all;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    all.emplace_back(o);
  }
  const std::vector<bool> reached = reachedThroughTheSlit(gap);
  const std::vector<Decision> decisions = ExactVisibility(scene.view()).decide(slitView(), all, 20000);
  int seen = 0;
  for (const ObjectId object : all) {
    const bool is_wall = object.value < kSlitWalls;
    EXPECT_EQ(decisions[object.value].verdict,
              is_wall || reached[object.value] ? Verdict::kVisible : Verdict::kHidden)
        << "object " << object.value;
    seen += reached[object.value] ? 1 : 0;
  }
  EXPECT_EQ(seen, gap.seen);
}

TEST(Gap, VerifyReportsWhatSampledCoverageCullsBehindASlit) {
  const TemporaryFolder folder;
  const Gap gap = wallsWithSlit();
  const std::string scene = folder.write("slit.obj", slitObj(gap)),
                    walk = folder.write("walk.json", slitPath());
  const auto verify = [&](const std::string& coverages) {
    const Outcome outcome =
        runTool({"verify",      scene,     "--path",   walk,  "--method",     "depth-pyramid,opacity-map",
                 "--coverage",  coverages, "--focus",  "0",   "--resolution", "64x48",
                 "--width",     "640",     "--height", "480", "--aimed-rays", "16",
                 "--edge-rays", "16",      "--json",   "-"});
    EXPECT_EQ(outcome.err, "");
    return std::pair(outcome.code, parse(outcome.out));
  };
  const auto [code, both] = verify("centre,inner");
  EXPECT_EQ(code, 1);
  ASSERT_EQ(both["runs"].size(), 4u);
  for (const json& run : both["runs"]) {
    const bool is_sampled = run["options"]["coverage"] == "centre";
    const json& frame = run["frames"][0];
    EXPECT_EQ(frame["exact"], kSlitWalls + gap.seen) << run["method"];
    EXPECT_EQ(run["false_culls"].get<int>() > 0, is_sampled) << run["method"] << ' ' << run["options"];
    EXPECT_EQ(frame["kept"].get<int>() >= kSlitWalls + gap.seen, !is_sampled) << run["method"];
    if (is_sampled) {
      // Whatever was culled of the visible ones is a false cull, no more and no less.
      EXPECT_GE(run["false_culls"].get<int>(), kSlitWalls + gap.seen - frame["kept"].get<int>());
    }
  }
  EXPECT_EQ(verify("inner").first, 0);
}

}  // namespace
}  // namespace sightline::tool_test
