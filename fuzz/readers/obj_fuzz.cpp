// Feeds bytes to the reader of .obj and .mtl files, which must return a valid scene or an error: the text of
// an .obj file and, after a zero byte, that of an .mtl file.

#include <algorithm>

#include "fuzz/readers/fuzz_input.h"
#include "fuzz/readers/sound_scene.h"
#include "src/io/obj/obj.h"

using namespace sightline;
using namespace sightline::fuzz;

namespace {

const io::ImportLimits kLimits{.triangles = 100'000, .objects = 10'000, .name_bytes = 1 << 20};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text = textOf(data, size);
  const std::size_t zero = std::min(text.find('\0'), text.size());
  io::MtlMaterials materials;
  const Status read = materials.read(text.substr(std::min(zero + 1, text.size())), "fuzz.mtl");
  if (!read) {
    requireOneLine(read.error());
  }
  io::picturesOfMtl(text);
  io::librariesOfObj(text);
  const Result<io::ObjFile> file = io::parseObj(text.substr(0, zero), "fuzz.obj");
  if (!file) {
    requireOneLine(file.error());
    return 0;
  }
  io::ObjFindings findings;
  const Result<Scene> scene = io::sceneOfObj(*file, materials, "fuzz.obj", kLimits, findings);
  if (!scene) {
    requireOneLine(scene.error());
    return 0;
  }
  requireSound(*scene);
  return 0;
}
