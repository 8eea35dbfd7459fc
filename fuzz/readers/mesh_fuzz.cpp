// Feeds bytes to the readers of all formats that Assimp parses. The first byte chooses the format. What
// crashes or hangs Assimp must be one error; what it can read must be a valid scene. That is read once more
// in this process, so that the fuzzer sees how our part of the reader gets on.

#include <array>

#include "fuzz/readers/fuzz_input.h"
#include "fuzz/readers/sound_scene.h"
#include "src/io/assimp.h"

using namespace sightline;
using namespace sightline::fuzz;

namespace {

constexpr std::array kFormats{".nff", ".ply", ".stl",  ".off", ".dae", ".fbx", ".3ds", ".x",
                              ".ac",  ".lwo", ".ms3d", ".md2", ".md3", ".smd", ".b3d", ".ase"};
const io::ImportLimits kLimits{.triangles = 100'000, .objects = 10'000};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text = textOf(data, size);
  const char* const format = kFormats[takeByte(text) % kFormats.size()];
  const std::string file = folder().write(std::string("fuzz") + format, text);
  io::AssimpFindings found, found_here;
  const Result<Scene> in_child =
      io::importAssimpInChild(file, text.size(), kLimits, found, /*most_seconds=*/1);
  if (!in_child) {
    requireOneLine(in_child.error());
    return 0;
  }
  requireSound(*in_child);
  const Result<Scene> here = io::importAssimp(file, kLimits, found_here);
  require(here && found.uncertain_polygons == found_here.uncertain_polygons &&
          here->positions == in_child->positions && here->indices == in_child->indices);
  return 0;
}
