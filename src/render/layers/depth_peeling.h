#pragma once

// Blends surfaces in the order of depth at each sample, however many lie over each other.
//
// Based on: Everitt. Interactive Order-Independent Transparency. 2001.
// Differs from it in: peels go from the farthest surface to the nearest, so that each is blended directly
// over the picture. Surfaces of equal depth are peeled together, in the order in which they are drawn, so
// that none is lost.

#include <epoxy/gl.h>

#include <cstdint>
#include <functional>

#include "sightline/base/result.h"
#include "src/render/layers/layer_renderer_target.h"

namespace sightline::render {

// Precondition of all functions: the context that it was created in is current.
class DepthPeeler {
 public:
  // Makes two depth buffers of the target's size. Error if the driver has no memory for them.
  static Result<DepthPeeler> create(const LayerTarget& target);

  enum class Stage : std::uint8_t { kDepth, kColor };
  // Blends all peels over the target's picture and returns how many there were; stops after max_peels, for
  // which the number of triangles is enough. draw(stage) draws the blended surfaces with a program that
  // discards fragments not nearer than the depths in texture unit kBehindUnit, and in stage kColor writes
  // colour times opacity. The target's depths stay as they are.
  std::uint32_t peel(const LayerTarget& target, std::uint64_t max_peels,
                     const std::function<void(Stage)>& draw);

 private:
  bool findNext(GLuint framebuffer, const std::function<void(Stage)>& draw) const;

  GLuint depths_[2] = {0, 0}, framebuffers_[2] = {0, 0}, query_ = 0;
};

}  // namespace sightline::render
