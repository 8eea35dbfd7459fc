#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace sightline {

enum class Opacity : std::uint8_t {
  kOpaque,       // hides whatever is behind it
  kBlended,      // glass, smoke: drawn, never hides anything
  kAlphaTested,  // foliage, fences: drawn with holes, never hides anything
};

struct Material {
  std::string name{};
  Opacity opacity = Opacity::kOpaque;
  bool double_sided = false;                                // back faces are drawn and hide too
  std::array<float, 4> base_color{0.8f, 0.8f, 0.8f, 1.0f};  // linear RGBA; used only for pictures

  bool opaque() const { return opacity == Opacity::kOpaque; }
};

}  // namespace sightline
