#pragma once

// How a scene comes back from the process that reads it (child_process.h).

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "sightline/scene/scene.h"

namespace sightline::io {

// A scene as bytes, from one process to another; its camera paths are left out.
std::vector<std::byte> sceneBytes(const Scene& scene);
// Back. Nothing if the bytes are not those of a scene whose numbers are all in range.
std::optional<Scene> sceneFromBytes(std::span<const std::byte> bytes);

}  // namespace sightline::io
