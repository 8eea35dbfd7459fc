#pragma once

// Where the objects are, as the scene's vertex shader for moved objects reads it.

#include <epoxy/gl.h>

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/math/mat4.h"

namespace sightline::render {

// Precondition of create() and bind(): the context is current.
class ObjectPlaces {
 public:
  // Errors: more objects than the driver's buffers have room for.
  static Result<ObjectPlaces> create(std::uint32_t objects);

  // Objects beyond the list are as stored; so are all, where it is empty.
  void set(std::span<const Mat4> scene_from_stored);
  bool asStored() const { return scene_from_stored_.empty(); }

  // Whether an object can be drawn: its transform is finite.
  bool drawable(std::uint32_t object) const {
    return object < objects_ && (asStored() || drawable_[object] != 0);
  }
  const Mat4& of(std::uint32_t object) const { return asStored() ? stored_ : scene_from_stored_[object]; }
  // Of each object, not 0 where its transform mirrors; empty where none is moved.
  std::span<const std::uint8_t> mirrored() const { return mirrored_; }

  // To the shader's texture unit, relative to the eye; made anew where the eye or the places are others than
  // last time. Nothing where all are as stored.
  void bind(const Vec3d& eye);

 private:
  std::uint32_t objects_ = 0;
  std::vector<Mat4> scene_from_stored_;  // one an object, or none
  Mat4 stored_;
  std::vector<std::uint8_t> drawable_, mirrored_;  // as many
  std::vector<float> texels_;
  Vec3d eye_;                // that the buffer was made for
  bool up_to_date_ = false;  // for eye_ and scene_from_stored_
  GLuint buffer_ = 0, texture_ = 0;
};

}  // namespace sightline::render
