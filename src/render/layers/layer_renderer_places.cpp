#include "src/render/layers/layer_renderer_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "src/render/scene/scene_programs.h"

namespace sightline::render {
namespace {

constexpr std::size_t kFloats = 20;  // for each object: five texels of four floats

// The point that the transform moves to p; the origin if the transform is singular or the point too far away.
Vec3d inverseOf(const Mat4& m, const Vec3d& p) {
  const Vec3d x(m(0, 0), m(1, 0), m(2, 0)), y(m(0, 1), m(1, 1), m(2, 1)), z(m(0, 2), m(1, 2), m(2, 2));
  const Vec3d from(p.x - m(0, 3), p.y - m(1, 3), p.z - m(2, 3));
  const double determinant = determinant3(m);
  const Vec3d found =
      Vec3d(dot(from, cross(y, z)), dot(from, cross(z, x)), dot(from, cross(x, y))) / determinant;
  constexpr double kFarthest = 1e12;
  return isFinite(found) && maxComponent(abs(found)) < kFarthest ? found : Vec3d();
}

// With L the linear part of M: M p - eye = L (p - pivot) + (M pivot - eye). Any pivot is correct. For the
// pivot that M moves to the eye the second term is no more than the pivot's rounding.
void write(const Mat4& m, const Vec3d& eye, std::span<float, kFloats> texels) {
  const Vec3d pivot = inverseOf(m, eye);
  const Vec3d rest = transformPoint(m, pivot) - eye;
  const Vec3f high(pivot);
  const Vec3f low(pivot - Vec3d(high));
  for (int row = 0; row < 3; ++row) {
    const std::size_t at = 4 * static_cast<std::size_t>(row);
    for (int column = 0; column < 3; ++column) {
      texels[at + static_cast<std::size_t>(column)] = static_cast<float>(m(row, column));
    }
    texels[at + 3] = static_cast<float>(rest[row]);
    texels[12 + static_cast<std::size_t>(row)] = high[row];
    texels[16 + static_cast<std::size_t>(row)] = low[row];
  }
  texels[15] = texels[19] = 0.0f;
}

// Whether all elements are so small that the square of a float stays finite.
bool canBeDrawn(const Mat4& m) {
  return std::all_of(m.m.begin(), m.m.end(), [](double value) { return std::abs(value) < 1e18; });
}

}  // namespace

Result<ObjectPlaces> ObjectPlaces::create(std::uint32_t objects) {
  GLint max_texels = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &max_texels);
  if (objects > static_cast<std::uint32_t>(max_texels) / 5) {
    return Error{fmt::format("the scene's {} objects are more than the {} that the OpenGL driver can move",
                             objects, max_texels / 5)};
  }
  ObjectPlaces places;
  places.objects_ = objects;
  glGenBuffers(1, &places.buffer_);
  glGenTextures(1, &places.texture_);
  glBindBuffer(GL_TEXTURE_BUFFER, places.buffer_);
  glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(kFloats * sizeof(float)), nullptr, GL_DYNAMIC_DRAW);
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(kPlacesUnit));
  glBindTexture(GL_TEXTURE_BUFFER, places.texture_);
  glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA32F, places.buffer_);
  return places;
}

void ObjectPlaces::set(std::span<const Mat4> scene_from_stored) {
  const std::size_t given = std::min<std::size_t>(scene_from_stored.size(), objects_);
  scene_from_stored_.assign(scene_from_stored.begin(),
                            scene_from_stored.begin() + static_cast<std::ptrdiff_t>(given));
  scene_from_stored_.resize(given == 0 ? 0 : objects_);
  drawable_.clear();
  mirrored_.clear();
  for (const Mat4& m : scene_from_stored_) {
    drawable_.push_back(canBeDrawn(m) ? 1 : 0);
    mirrored_.push_back(determinant3(m) < 0.0 ? 1 : 0);
  }
  up_to_date_ = false;
}

void ObjectPlaces::bind(const Vec3d& eye) {
  if (asStored()) {
    return;
  }
  if (!up_to_date_ || eye != eye_) {
    texels_.resize(kFloats * scene_from_stored_.size());
    for (std::size_t i = 0; i < scene_from_stored_.size(); ++i) {
      const Mat4 m = drawable_[i] != 0 ? scene_from_stored_[i] : Mat4();
      write(m, eye, std::span(texels_).subspan(kFloats * i).first<kFloats>());
    }
    glBindBuffer(GL_TEXTURE_BUFFER, buffer_);
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(texels_.size() * sizeof(float)), texels_.data(),
                 GL_DYNAMIC_DRAW);
    eye_ = eye;
    up_to_date_ = true;
  }
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(kPlacesUnit));
  glBindTexture(GL_TEXTURE_BUFFER, texture_);
  glActiveTexture(GL_TEXTURE0);
}

}  // namespace sightline::render
