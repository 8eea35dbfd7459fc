#pragma once

// Blended surfaces in the order of depth, pixel by pixel, however many lie over each other.
//
// Based on: Everitt. Interactive Order-Independent Transparency. 2001.
// Differs from it in: peels go from the farthest surface to the nearest, so that each is blended straight
// over the picture; what lies at one depth is peeled at once, in the order in which it is drawn, so that
// equal depths lose nothing.

#include <epoxy/gl.h>

#include <cstdint>
#include <functional>

#include "sightline/base/result.h"
#include "src/render/layers/layer_renderer_target.h"

namespace sightline::render {

// Precondition of all functions: the context that it was created in is current.
class DepthPeeler {
 public:
  // Two depth buffers of the target's size. Errors: the driver has no room for them.
  static Result<DepthPeeler> create(const LayerTarget& target);

  enum class Stage : std::uint8_t { kDepth, kColor };
  // Blends all peels over what the target shows. draw: the blended surfaces, with a program that leaves away
  // what is not nearer than the depths in texture unit kBehindUnit; colour times opacity in stage kColor.
  // most: ends it in any case; the number of triangles is enough. The target's depths stay as they are.
  // Returns how many peels there were.
  std::uint32_t peel(const LayerTarget& target, std::uint64_t most, const std::function<void(Stage)>& draw);

 private:
  bool findNext(GLuint framebuffer, const std::function<void(Stage)>& draw) const;

  GLuint depths_[2] = {0, 0}, framebuffers_[2] = {0, 0}, query_ = 0;
};

}  // namespace sightline::render
