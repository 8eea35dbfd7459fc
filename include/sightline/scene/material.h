#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace sightline {

enum class Opacity : std::uint8_t {
  kOpaque,       // hides what is behind it
  kBlended,      // glass, smoke: drawn, never hides
  kAlphaTested,  // foliage, fences: drawn with holes, never hides
};

struct Material {
  std::string name{};
  Opacity opacity = Opacity::kOpaque;
  bool double_sided = false;                                // backs are drawn too, and hide
  std::array<float, 4> base_color{0.8f, 0.8f, 0.8f, 1.0f};  // linear RGBA, for pictures only

  bool opaque() const { return opacity == Opacity::kOpaque; }
};

}  // namespace sightline
