// What leaks where the edges of surfaces that touch are not joined? Two pictures of a view: pixels of the
// depth buffer that whole surfaces cover, before edges are divided at T-junctions
// (SurfaceSettings::join_edges) and after, and how many objects are kept. Near pixels are light and far ones
// dark; white pixels hide nothing. Pixels that are covered farther away before than after, or only after, are
// red before.
//
//   contacts --pictures NAME SCENE FRAME
//   contacts [SCENE...]
//
// The first form writes NAME_before.png and NAME_after.png. The second one prints what 17 views of each scene
// come to, together.

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "bench/benchmark_scene.h"
#include "sightline/io/image.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/object_boxes.h"
#include "tests/support/any_culler.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

constexpr std::uint32_t kWide = 2;  // pixels of a picture for one of the depth buffer, a side
constexpr float kFarther = 0.8f;    // of the reciprocal depth after: less before counts as farther away

// What a view comes to with some surfaces.
struct Culled {
  std::uint32_t width = 0, height = 0;
  std::vector<float> reciprocal_depth{};  // width * height, the lowest row first
  std::size_t covered = 0;                // pixels
  std::size_t kept = 0;                   // objects
};

// Culls by all surfaces of a scene, each view as the first one of a walk.
class Comparison {
 public:
  explicit Comparison(const std::string& scene)
      : loaded_(loadScene(scene, "contacts")),
        hierarchy_(buildHierarchy(loaded_.bounds, loaded_.cost)),
        boxes_(findObjectBoxes(loaded_.scene.view())),
        separate_(findSurfaces(loaded_.scene.view(), {.join_edges = false})),
        joined_(findSurfaces(loaded_.scene.view())) {}

  std::size_t frames() const { return loaded_.path.frames.size(); }
  // Precondition: frame < frames().
  Culled before(std::size_t frame) const { return cull(frame, separate_); }
  Culled after(std::size_t frame) const { return cull(frame, joined_); }

 private:
  Culled cull(std::size_t frame, const SurfaceSet& surfaces) const {
    AnyCuller culler(
        hierarchy_, loaded_.bounds, no_occluders_,
        {.method = AnyMethod::kDepthPyramid, .surfaces = SurfaceUse::kAlone, .object_boxes = true},
        {.surfaces = &surfaces, .object_boxes = &boxes_});
    culler.cull(loaded_.path.view(frame, loaded_.scene.origin));
    const DepthBufferView buffer = culler.depthBuffer();
    Culled culled{.width = buffer.width, .height = buffer.height, .kept = culler.visible().size()};
    for (std::uint32_t y = 0; y < buffer.height; ++y) {
      for (const float value : buffer.row(y)) {
        culled.reciprocal_depth.push_back(value);
        culled.covered += value > kUncovered ? 1 : 0;
      }
    }
    return culled;
  }

  BenchmarkScene loaded_;
  Hierarchy hierarchy_;
  ObjectBoxes boxes_;
  SurfaceSet separate_, joined_;
  OccluderSet no_occluders_;
};

using Color = std::array<std::uint8_t, 3>;

// The blend of two colours, `share` of it the second one.
Color blend(const Color& first, const Color& second, double share) {
  Color color{};
  for (std::size_t i = 0; i < color.size(); ++i) {
    color[i] = static_cast<std::uint8_t>(std::lround(first[i] + share * (second[i] - first[i])));
  }
  return color;
}

// `joined`: the same view with joined edges; its depths set the scale of the colours.
Image pictureOf(const Culled& culled, const Culled& joined) {
  float nearest = 0.0f, farthest = std::numeric_limits<float>::infinity();
  for (const float value : joined.reciprocal_depth) {
    if (value > kUncovered) {
      nearest = std::max(nearest, value);
      farthest = std::min(farthest, value);
    }
  }
  const double range = std::log(nearest / farthest);
  Image image{kWide * culled.width, kWide * culled.height, {}};
  for (std::uint32_t y = 0; y < image.height; ++y) {
    for (std::uint32_t x = 0; x < image.width; ++x) {
      const std::size_t i = std::size_t{culled.height - 1 - y / kWide} * culled.width + x / kWide;
      const float value = culled.reciprocal_depth[i], after = joined.reciprocal_depth[i];
      Color color{255, 255, 255};
      if (after > kUncovered && !(value > kFarther * after)) {
        color = {215, 40, 40};
      } else if (value > kUncovered) {
        const double share = range > 0.0 ? std::log(nearest / value) / range : 0.0;
        color = blend({214, 232, 190}, {40, 55, 110}, std::clamp(share, 0.0, 1.0));
      }
      image.rgba.insert(image.rgba.end(), {color[0], color[1], color[2], 255});
    }
  }
  return image;
}

void writeOrExit(const Image& image, const std::string& file) {
  if (const Status written = writePng(image, file); !written) {
    fmt::print(stderr, "contacts: {}\n", written.error().message);
    std::exit(2);
  }
}

void draw(const std::string& name, const std::string& scene, std::size_t frame) {
  const Comparison comparison(scene);
  if (frame >= comparison.frames()) {
    fmt::print(stderr, "contacts: frame {}: the path of {} has {} frames\n", frame, scene,
               comparison.frames());
    std::exit(2);
  }
  const Culled before = comparison.before(frame), after = comparison.after(frame);
  fmt::print(
      "{}, frame {}: {} of {} pixels are covered and {} objects kept before edges are joined, {} and {} "
      "after\n",
      scene, frame, before.covered, before.reciprocal_depth.size(), before.kept, after.covered, after.kept);
  writeOrExit(pictureOf(before, after), name + "_before.png");
  writeOrExit(pictureOf(after, after), name + "_after.png");
}

void printSums(const std::string& scene) {
  const Comparison comparison(scene);
  std::size_t pixels = 0, covered_before = 0, kept_before = 0, covered_after = 0, kept_after = 0;
  for (std::size_t frame = 0; frame < std::min<std::size_t>(170, comparison.frames()); frame += 10) {
    const Culled before = comparison.before(frame), after = comparison.after(frame);
    pixels += before.reciprocal_depth.size();
    covered_before += before.covered;
    kept_before += before.kept;
    covered_after += after.covered;
    kept_after += after.kept;
  }
  const auto percent = [&](std::size_t covered) {
    return 100.0 * static_cast<double>(covered) / static_cast<double>(pixels);
  };
  fmt::print(
      "{}: {:.2f} % of the pixels are covered and {} objects kept before edges are joined, {:.2f} % and {} "
      "after\n",
      scene, percent(covered_before), kept_before, percent(covered_after), kept_after);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> words;
  for (int i = 1; i < argc; ++i) {
    if (std::string_view(argv[i]) == "--pictures" || argv[i][0] != '-') {
      words.emplace_back(argv[i]);
    }
  }
  if (words.size() == 4 && words[0] == "--pictures") {
    draw(words[1], words[2], std::strtoul(words[3].c_str(), nullptr, 10));
    return 0;
  }
  if (!words.empty() && words[0] == "--pictures") {
    fmt::print(stderr, "contacts: give --pictures NAME SCENE FRAME\n");
    return 2;
  }
  for (const std::string& scene : words.empty() ? std::vector<std::string>{"demo:voxels"} : words) {
    printSums(scene);
  }
}
