#pragma once

// The objects' transforms in the form that the vertex shader for moved objects reads.

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
  // Error if there are more objects than the driver's buffers hold.
  static Result<ObjectPlaces> create(std::uint32_t objects);

  // Objects beyond the end of the list are drawn as stored. An empty list leaves all objects as stored.
  void set(std::span<const Mat4> scene_from_stored);
  bool asStored() const { return scene_from_stored_.empty(); }
  std::span<const Mat4> all() const { return scene_from_stored_; }  // one for each object, or none

  // Whether an object can be drawn: it is one of the scene's and its transform is finite.
  bool drawable(std::uint32_t object) const {
    return object < objects_ && (asStored() || drawable_[object] != 0);
  }
  const Mat4& of(std::uint32_t object) const { return asStored() ? stored_ : scene_from_stored_[object]; }
  // One entry for each object, not 0 if its transform mirrors; empty if all objects are as stored.
  std::span<const std::uint8_t> mirrored() const { return mirrored_; }

  // Binds the transforms, relative to the eye, to the shader's texture unit. Uploads them only if the eye or
  // the transforms have changed since the last call. Does nothing if all objects are as stored.
  void bind(const Vec3d& eye);

 private:
  std::uint32_t objects_ = 0;
  std::vector<Mat4> scene_from_stored_;  // one for each object, or empty
  Mat4 stored_;
  std::vector<std::uint8_t> drawable_, mirrored_;  // as many as scene_from_stored_
  std::vector<float> texels_;
  Vec3d eye_;                // the eye that the buffer was made for
  bool up_to_date_ = false;  // the buffer was made for eye_ and scene_from_stored_
  GLuint buffer_ = 0, texture_ = 0;
};

}  // namespace sightline::render
