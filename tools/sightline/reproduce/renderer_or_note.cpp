#include "tools/sightline/reproduce/renderer_or_note.h"

#include <fmt/format.h>

#include <utility>

namespace sightline::tool {

std::optional<Renderer> rendererOrNote(const SceneView& scene, const PictureOptions& size,
                                       const std::string& name, std::vector<std::string>& notes) {
  Result<Renderer> renderer = Renderer::create(scene, size.width, size.height);
  if (!renderer) {
    notes.push_back(fmt::format("{}: nothing was drawn: {}", name, renderer.error().message));
    return std::nullopt;
  }
  return std::move(*renderer);
}

}  // namespace sightline::tool
