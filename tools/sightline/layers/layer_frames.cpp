#include "tools/sightline/layers/layer_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace sightline::tool {

PartId SortedFrame::wholeOf(PartId part_or_piece) const {
  const auto piece =
      std::lower_bound(pieces.begin(), pieces.end(), part_or_piece.value,
                       [](const ObjectPiece& p, std::uint32_t value) { return p.piece.value < value; });
  return piece != pieces.end() && piece->piece.value == part_or_piece.value ? PartId(piece->object.value)
                                                                            : part_or_piece;
}

Result<LayerRenderer> makeRenderer(const FrameMakerInput& input) {
  return LayerRenderer::create(
      input.input.moving.scene.view(),
      {.width = input.width, .height = input.height, .samples = input.samples, .tints = input.tints});
}

std::string frameFile(const std::string& target, std::uint32_t frame, bool several_frames) {
  if (!several_frames) {
    return target;
  }
  const std::filesystem::path path(target);
  const std::string name = fmt::format("{}_{:04}{}", path.stem().string(), frame, path.extension().string());
  return (path.parent_path() / name).string();
}

}  // namespace sightline::tool
