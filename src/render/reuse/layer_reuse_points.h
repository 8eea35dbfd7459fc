#pragma once

// Characteristic points of layers: points of their objects, and where a picture shows them.

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "sightline/math/frustum.h"
#include "sightline/math/mat4.h"
#include "sightline/scene/scene.h"
#include "src/render/reuse/warp_image.h"

namespace sightline::render {

// A view, with axes of unit length, and the size of its picture in pixels; rows count from the top.
class PictureView {
 public:
  PictureView() = default;
  PictureView(const View& view, std::uint32_t width, std::uint32_t height);

  const Frustum& frustum() const { return frustum_; }
  // Where the picture shows a point of the scene. None where the point lies before the near plane or beyond
  // the far plane, or where its place is not finite.
  std::optional<PicturePoint> find(const Vec3d& point_scene) const;

 private:
  friend class LayerShapes;
  View view_;
  Frustum frustum_;
  double scale_x_ = 0.0, scale_y_ = 0.0;  // pixels for 1 of x / depth, or of x
  double width_ = 0.0, height_ = 0.0;
};

struct CharacteristicPoint {
  ObjectId object;
  Vec3d position;  // as stored
};

// What is kept of a layer beside its image when the image is drawn.
struct LayerPoints {
  std::vector<CharacteristicPoint> points;
  std::vector<PicturePoint> seen_at;  // one a point
  std::vector<ObjectId> unseen;       // objects of which nothing is in the picture
  SideFlags cut{};                    // sides of the picture beyond which the layer goes on
  bool cut_in_depth = false;          // something is before the near plane or beyond the far one
};

// The triangles of a scene's objects, with a box and some extreme vertices of each. Immutable.
class LayerShapes {
 public:
  explicit LayerShapes(const SceneView& scene);

  std::size_t objects() const { return shapes_.size(); }
  std::uint64_t triangles(ObjectId object) const { return shapes_[object.value].index_count / 3; }
  // Whether some of the object's surface lies inside the frustum. Precondition: scene_from_stored is finite.
  bool isSeen(ObjectId object, const Mat4& scene_from_stored, const Frustum& frustum) const;
  // The characteristic points that a picture shows of these objects. scene_from_stored has one finite
  // transform for each object of the scene.
  LayerPoints pointsOf(std::span<const ObjectId> objects, std::span<const Mat4> scene_from_stored,
                       const PictureView& view) const;

 private:
  struct Shape {
    std::uint32_t first_index = 0, index_count = 0;
    std::array<Vec3d, 8> corners;  // of the box
    std::vector<Vec3d> extremes;   // vertices farthest in some directions
  };
  // Clips each triangle, in stored coordinates, by the frustum: by its sides first, then by near and far.
  // visit(corners, cut_in_depth) gets what is left of a triangle and returns whether to go on.
  template <typename Visit>
  void clipTriangles(const Shape& shape, const Mat4& scene_from_stored, const Frustum& frustum,
                     Visit&& visit) const;
  // Adds the points of an object that is only partly in the picture.
  void addClipped(ObjectId object, const Mat4& scene_from_stored, const PictureView& view,
                  LayerPoints& layer) const;

  std::vector<Vec3f> positions_;
  std::vector<std::uint32_t> indices_;
  std::vector<Shape> shapes_;
};

// The indices of the points that lie farthest in one of 26 directions: those from the middle of the points'
// box to its corners, to the middles of its edges and to the middles of its sides. Ascending, each index
// once.
std::vector<std::size_t> extremesOf(std::span<const Vec3d> points);

}  // namespace sightline::render
