// How long does a bake take after one object was moved, if it takes over the answers of the bake before? A
// table row for each scene and each of some moved objects, with the full bake of the same scene in the same
// run. The parts of both are compared: they have to give the same sets.
//
//   updates [--depth=D] [--fused] [--narrowings=N] [--budget=TRIANGLES] [--objects=COUNT] SCENE...

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "sightline/pvs/bake/bake.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

struct Options {
  BakeSettings settings{.answers = true};
  std::uint32_t objects = 1;
  std::vector<std::string> scenes;
};

Options optionsOf(int argc, char** argv) {
  Options options;
  options.settings.max_depth = 5;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto number = [&word](std::string_view name) {
      return word.rfind(name, 0) == 0
                 ? static_cast<std::uint32_t>(std::strtoul(word.c_str() + name.size(), nullptr, 10))
                 : 0u;
    };
    if (word == "--fused") {
      options.settings.occlusion = BakeOcclusion::kFused;
    } else if (word.rfind("--depth=", 0) == 0) {
      options.settings.max_depth = number("--depth=");
    } else if (word.rfind("--narrowings=", 0) == 0) {
      options.settings.narrowings = number("--narrowings=");
    } else if (word.rfind("--budget=", 0) == 0) {
      options.settings.triangle_budget = number("--budget=");
    } else if (word.rfind("--objects=", 0) == 0) {
      options.objects = number("--objects=");
    } else if (word.rfind("--", 0) != 0) {
      options.scenes.push_back(word);
    }
  }
  return options;
}

// A bake and what it took, microseconds.
struct Run {
  double plan = 0.0, bake = 0.0;
  BakeStats stats{};
  BakedVisibility baked{};
  std::vector<std::byte> answers{};
};

Run bakeScene(const Scene& scene, const BakeSettings& settings, const std::vector<std::byte>& answers) {
  Run run;
  std::vector<Bake> bake;
  run.plan = microseconds([&] {
    const OccluderSet occluders = findOccluders(scene.view(), {.area_fraction = 1.0});
    bake.push_back(valueOrExit(Bake::plan(scene.view(), occluders, settings), "updates"));
    if (!answers.empty()) {
      const Bake::TakenOver taken = valueOrExit(bake[0].takeOver(answers), "updates");
      if (!taken.difference.empty()) {
        fmt::print(stderr, "updates: nothing can be taken over: {}\n", taken.difference);
      }
    }
  });
  BakedParts parts;
  run.bake = microseconds([&] {
    parts = bake[0].bakeAll(serialFor, {}, &run.stats);
    run.baked = valueOrExit(bake[0].assemble(parts), "updates");
  });
  run.answers = bake[0].answers(parts);
  return run;
}

bool same(const BakedVisibility& a, const BakedVisibility& b) {
  return a.boxes.objects == b.boxes.objects && a.octree.nodes == b.octree.nodes &&
         a.octree.planes == b.octree.planes && a.octree.reasons == b.octree.reasons &&
         a.sets.first == b.sets.first && a.sets.nodes == b.sets.nodes;
}

// Moves an object by its own width along x, or the other way where it would leave the scene's bounds. False
// if it would either way.
bool moveObject(Scene& scene, std::uint32_t number) {
  const Box all = sceneBounds(scene.view()), box = scene.objects[number].bounds;
  const float width = box.max.x - box.min.x;
  const float by = box.max.x + width < all.max.x ? width : -width;
  if (box.min.x + by <= all.min.x || box.max.x + by >= all.max.x || !(width > 0.0f)) {
    return false;
  }
  // Other objects may share its vertices.
  const std::span<std::uint32_t> indices =
      std::span(scene.indices).subspan(scene.objects[number].first_index, scene.objects[number].index_count);
  for (std::uint32_t& index : indices) {
    const Vec3f moved = scene.positions[index] + Vec3f(by, 0, 0);
    index = static_cast<std::uint32_t>(scene.positions.size());
    scene.positions.push_back(moved);
  }
  weldPositions(scene);
  updateBounds(scene);
  return true;
}

void compare(const std::string& name, const Options& options) {
  const Scene scene = loadScene(name, "updates").scene;
  BakeSettings settings = options.settings;
  if (settings.triangle_budget == 0) {
    settings.triangle_budget = std::max<std::uint64_t>(scene.triangleCount() / 50, 100);
  }
  const Run before = bakeScene(scene, settings, {});
  const auto count = static_cast<std::uint32_t>(scene.objects.size());
  std::uint32_t done = 0;
  for (std::uint32_t i = 0; i < count && done < options.objects; ++i) {
    // Spread over the scene's objects.
    const std::uint32_t number = static_cast<std::uint32_t>((i * 2654435761ull + count / 2) % count);
    Scene moved = scene;
    if (!moveObject(moved, number)) {
      continue;
    }
    ++done;
    const Run full = bakeScene(moved, settings, {}), update = bakeScene(moved, settings, before.answers);
    fmt::print("| {} | {} | {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {} | {} | {:.2f} | {} | {} |\n", name,
               count, number, full.plan * 1e-6, full.bake * 1e-6, update.plan * 1e-6, update.bake * 1e-6,
               update.stats.questions, update.stats.asked,
               100.0 * static_cast<double>(update.stats.asked) /
                   static_cast<double>(std::max<std::uint64_t>(update.stats.questions, 1)),
               update.answers.size(), same(full.baked, update.baked) ? "yes" : "NO");
    std::fflush(stdout);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = optionsOf(argc, argv);
  fmt::print(
      "| scene | objects | moved | full: plan, s | bake, s | update: plan, s | bake, s | questions | asked | "
      "% "
      "| bytes of answers | same |\n|---|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (const std::string& scene : options.scenes) {
    compare(scene, options);
  }
  return 0;
}
