#pragma once

// The exact visibility of one view as bytes, under a key of everything that it depends on.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/pvs/format/scene_id.h"
#include "sightline/scene/camera.h"
#include "tools/sightline/exact/exact_frame.h"

namespace sightline::tool {

// The numbers of a view, as bytes that are the same on every machine.
std::vector<std::byte> viewBytes(const View& view);

// Everything that an ExactObjects depends on: the scene, the view, the settings and kExactFrameVersion.
struct ExactKey {
  ExactKey(const SceneId& scene, const View& view, const ExactSettings& settings);

  std::vector<std::byte> bytes;
  std::uint64_t object_count;
};

std::string exactBytes(const ExactKey& key, const ExactObjects& frame);
// Nothing if the bytes are damaged, or of another key.
std::optional<ExactObjects> exactFromBytes(const ExactKey& key, std::string_view bytes);

}  // namespace sightline::tool
