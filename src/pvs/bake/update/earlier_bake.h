#pragma once

// What a bake leaves for a bake of the same scene after a change: the answers to all that it asked, and what
// tells whether they still hold.

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/pvs/format/scene_id.h"
#include "src/pvs/bake/bake_scene.h"

namespace sightline::pvs {

// An object as answers depend on it.
struct ObjectMark {
  // A hash of its bounds, its number of triangles, its boxes and its convex occluders. Of equal objects, each
  // has its own, by their order.
  std::uint64_t content = 0;
  Box bounds{};  // of its leaf in the box tree
  std::uint32_t triangles = 0;
  bool occludes = false;  // some convex occluder is its
};

// A panel as answers depend on it.
struct PanelMark {
  std::uint64_t content = 0;  // a hash of its sheets, its edges, its object, and the panels joined with it
  Box bounds{};
};
bool before(const PanelMark& a, const PanelMark& b);  // their order in SceneMarks

// A scene as answers depend on it.
struct SceneMarks {
  // Hashes of all that every answer depends on: the settings that say what may hide something, and the root
  // and bounds of coordinates.
  std::uint64_t settings = 0, space = 0;
  Box frame{};                        // of the boxes in answers
  std::vector<ObjectMark> objects{};  // by place in the box tree
  std::vector<BoxNode> nodes{};       // of the box tree
  std::vector<PanelMark> panels{};    // in ascending order
};
SceneMarks marksOf(const BakeScene& scene);

struct EarlierBake {
  SceneId scene{};
  SceneMarks marks{};
  std::vector<std::byte> bytes{};  // of the file
  // By part: its answers (see encodeAnswers), in `bytes`.
  std::map<std::uint64_t, std::span<const std::byte>> parts{};
};

// Writes and reads the bytes of a file. Reading is for bytes of any origin: an error tells what is wrong with
// them.
std::vector<std::byte> earlierBakeBytes(const SceneId& scene, const SceneMarks& marks,
                                        const std::map<std::uint64_t, std::span<const std::byte>>& parts);
Result<EarlierBake> readEarlierBake(std::vector<std::byte> bytes);
// True if the bytes begin as those of such a file do.
bool beginsAsAnswers(std::span<const std::byte> bytes);

}  // namespace sightline::pvs
