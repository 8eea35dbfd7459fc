// A world that changes at random for as long as one likes: whatever is culled is proved hidden in some of the
// frames, and memory must not grow.
//
//   world_soak [FRAMES [SEED [CHECK_EVERY]]]

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>

#include "tests/world/hard_story.h"

namespace {

using namespace sightline;

// Memory of this process that is in use, MiB.
double residentMebibytes() {
  std::ifstream statm("/proc/self/statm");
  double total = 0.0, resident = 0.0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / (1 << 20);
}

}  // namespace

int main(int argc, char** argv) {
  const auto number = [&](int i, std::uint64_t otherwise) {
    return argc > i ? std::strtoull(argv[i], nullptr, 10) : otherwise;
  };
  const std::uint64_t frames = number(1, 20000), check_every = std::max<std::uint64_t>(number(3, 50), 1);
  const std::uint64_t seed = number(2, 1);
  // Odd seeds: thirty kilometres from the zero of the world.
  world_story::HardStory story(static_cast<std::uint32_t>(seed),
                               seed % 2 == 0 ? Vec3d() : Vec3d(20000, 0, -24000));
  story.world.setOrigin(story.base);
  WorldCuller culler, both({.raster = {.width = 160, .height = 90}});
  std::size_t checked = 0, culled = 0;
  double first = 0.0;
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    const View view = story.next();
    View other = view;
    other.eye = view.eye + view.right * 0.0625;
    culler.cull(story.world, story.inWorld(view));
    both.cull(story.world, std::array{story.inWorld(view), story.inWorld(other)});
    if (frame % check_every == 0) {
      for (const WorldCuller* const each : {&culler, &both}) {
        const world_story::Judged judged = story.judged(view, *each, ~0u);
        checked += 1;
        culled += judged.culled;
        if (!judged.wrong.empty()) {
          fmt::print(stderr, "frame {}: {}\n", frame, judged.wrong);
          return 1;
        }
      }
    }
    if (frame + 1 == frames / 10) {
      first = residentMebibytes();
    }
    if ((frame + 1) % std::max<std::uint64_t>(frames / 10, 1) == 0) {
      fmt::print("{} frames, {} judged, {} instances proved hidden, {:.1f} MiB\n", frame + 1, checked, culled,
                 residentMebibytes());
      std::fflush(stdout);
    }
  }
  // The allocator keeps some; what a world leaks grows with the frames.
  if (frames >= 1000 && residentMebibytes() > 1.5 * first + 8.0) {
    fmt::print(stderr, "memory has grown from {:.1f} to {:.1f} MiB\n", first, residentMebibytes());
    return 1;
  }
  return 0;
}
