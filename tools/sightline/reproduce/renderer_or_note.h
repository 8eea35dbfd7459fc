#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sightline/render/renderer.h"
#include "tools/sightline/command_line/options.h"

namespace sightline::tool {

// A renderer of the scene for pictures of this size. Nothing if this machine cannot draw; the reason is added
// to the notes. name: of what is drawn, in the note.
std::optional<Renderer> rendererOrNote(const SceneView& scene, const PictureOptions& size,
                                       const std::string& name, std::vector<std::string>& notes);

}  // namespace sightline::tool
