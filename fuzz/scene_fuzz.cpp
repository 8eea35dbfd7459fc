// Makes hostile scenes, culls them with all methods, and proves of all that was culled that it is hidden.
// Usage: scene_fuzz [--seconds N] [--seed S] [--scenes N] [--out FOLDER]. A false cull is written as a scene
// and a camera path for `sightline verify`, and ends the run with exit code 1.

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <string>

#include "sightline/io/camera_path_json.h"
#include "sightline/io/file.h"
#include "tests/support/judge_culling.h"

namespace {

using namespace sightline;

struct Options {
  double seconds = 60.0;
  std::uint64_t seed = 1, scenes = ~std::uint64_t{0};
  std::string folder = ".";
};

// Returns false where the arguments are not as above.
bool parse(int argc, char** argv, Options& options) {
  for (int i = 1; i < argc; i += 2) {
    const std::string name = argv[i];
    if (i + 1 == argc) {
      return false;
    }
    char* end = nullptr;
    if (name == "--seconds") {
      options.seconds = std::strtod(argv[i + 1], &end);
    } else if (name == "--seed") {
      options.seed = std::strtoull(argv[i + 1], &end, 10);
    } else if (name == "--scenes") {
      options.scenes = std::strtoull(argv[i + 1], &end, 10);
    } else if (name == "--out") {
      options.folder = argv[i + 1];
      continue;
    } else {
      return false;
    }
    if (end == argv[i + 1] || *end != '\0') {
      return false;
    }
  }
  return true;
}

std::string objOf(const Scene& scene) {
  std::string text;
  char line[128];
  for (const Vec3f& p : scene.positions) {
    std::snprintf(line, sizeof line, "v %.9g %.9g %.9g\n", double(p.x), double(p.y), double(p.z));
    text += line;
  }
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    text += "o object" + std::to_string(o) + "\n";
    const std::span<const std::uint32_t> indices = scene.view().indicesOf(scene.objects[o]);
    for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
      std::snprintf(line, sizeof line, "f %u %u %u\n", indices[i] + 1, indices[i + 1] + 1,
                    indices[i + 2] + 1);
      text += line;
    }
  }
  return text;
}

// All frames of a path have one shift: that of this view.
CameraPath pathOf(const std::vector<View>& views, std::size_t shown) {
  CameraPath path;
  const View& first = views.front();
  path.fovy_deg = std::atan(first.tan_half_fovy) * 114.59155902616465;
  path.ortho_height = first.orthographic ? first.ortho_height : 0.0;
  path.width = static_cast<std::uint32_t>(1000.0 * first.aspect);
  path.height = 1000;
  path.shift_x = views[shown].shift_x;
  path.shift_y = views[shown].shift_y;
  path.z_near = first.z_near;
  path.z_far = std::min(first.z_far, 1e12);
  for (const View& view : views) {
    path.frames.push_back({view.eye, view.forward, view.up});
  }
  return path;
}

void report(const test::HostileScene& hostile, const std::vector<test::FalseCull>& wrong, std::uint64_t seed,
            const std::string& folder) {
  for (const test::FalseCull& cull : wrong) {
    std::printf("FALSE CULL: seed %llu (%s), view %zu, object %u, seen at %.17g %.17g %.17g, culled by %s\n",
                static_cast<unsigned long long>(seed), hostile.family.c_str(), cull.view, cull.object.value,
                cull.seen_at.x, cull.seen_at.y, cull.seen_at.z, cull.method.c_str());
  }
  const std::string base = folder + "/false-cull-" + std::to_string(seed);
  const bool written = writeFile(base + ".obj", objOf(hostile.scene)) &&
                       writeFile(base + ".json", toJson(pathOf(hostile.views, wrong.front().view)));
  if (written) {
    std::printf("the scene: %s.obj, the path: %s.json (materials are lost; the seed makes them again)\n",
                base.c_str(), base.c_str());
  }
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  if (!parse(argc, argv, options)) {
    std::fprintf(stderr, "usage: scene_fuzz [--seconds N] [--seed S] [--scenes N] [--out FOLDER]\n");
    return 2;
  }
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - start).count(); };
  test::JudgeCounts counts;
  std::map<std::string, std::uint64_t> hidden_of_family;
  std::uint64_t seed = options.seed;
  for (; seconds() < options.seconds && seed - options.seed < options.scenes; ++seed) {
    const test::HostileScene hostile = test::HostileSceneMaker(seed).make();
    test::CullingJudge judge(hostile, seed);
    const std::uint64_t before = counts.culled - counts.frustum;
    const std::vector<test::FalseCull> wrong = judge.judge(counts);
    hidden_of_family[hostile.family] += counts.culled - counts.frustum - before;
    if (!wrong.empty()) {
      report(hostile, wrong, seed, options.folder);
      std::printf("found after %.1f s\n", seconds());
      return 1;
    }
  }
  std::printf(
      "seeds %llu to %llu, %.1f a second: %llu scenes, %llu culled (%llu by the frustum alone), "
      "%llu proved hidden, %llu undecided, %llu views held, no false cull\n",
      static_cast<unsigned long long>(options.seed), static_cast<unsigned long long>(seed - 1),
      static_cast<double>(counts.scenes) / seconds(), static_cast<unsigned long long>(counts.scenes),
      static_cast<unsigned long long>(counts.culled), static_cast<unsigned long long>(counts.frustum),
      static_cast<unsigned long long>(counts.proved), static_cast<unsigned long long>(counts.undecided),
      static_cast<unsigned long long>(counts.held));
  for (const auto& [family, hidden] : hidden_of_family) {
    if (family.find(" and ") == std::string::npos) {
      std::printf("  %-10s %llu hidden\n", family.c_str(), static_cast<unsigned long long>(hidden));
    }
  }
  return 0;
}
