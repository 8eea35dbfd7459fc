#pragma once

// Characteristic points of layers: where they are told from the scene, and where they are seen.

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

// A view with the picture that it makes; rows from the top.
class PictureView {
 public:
  PictureView() = default;
  PictureView(const View& view, std::uint32_t width, std::uint32_t height);

  const Frustum& frustum() const { return frustum_; }
  // Where a point of the scene is seen; none: before the near plane, beyond the far one, or nowhere.
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

// What is known of a layer when its picture is drawn.
struct LayerPoints {
  std::vector<CharacteristicPoint> points;
  std::vector<PicturePoint> seen_at;  // one a point
  std::vector<ObjectId> unseen;       // objects of which nothing is in the picture
  SideFlags cut{};                    // sides of the picture beyond which the layer goes on
  bool cut_in_depth = false;          // something is before the near plane or beyond the far one
};

// The shapes of a scene's objects.
class LayerShapes {
 public:
  explicit LayerShapes(const SceneView& scene);

  std::size_t objects() const { return shapes_.size(); }
  std::uint64_t triangles(ObjectId object) const { return shapes_[object.value].index_count / 3; }
  // Some of the object's surface is inside the frustum. scene_from_stored: finite.
  bool isSeen(ObjectId object, const Mat4& scene_from_stored, const Frustum& frustum) const;
  // The points of the objects in a picture; transforms: one an object of the scene, finite.
  LayerPoints pointsOf(std::span<const ObjectId> objects, std::span<const Mat4> scene_from_stored,
                       const PictureView& view) const;

 private:
  struct Shape {
    std::uint32_t first_index = 0, index_count = 0;
    std::array<Vec3d, 8> corners;  // of the box
    std::vector<Vec3d> extremes;   // vertices farthest in some directions
  };
  // Clips each triangle by the frustum, its sides first; as stored. visit(corners that are left, was it cut
  // in depth) returns whether to go on.
  template <typename Visit>
  void clipTriangles(const Shape& shape, const Mat4& scene_from_stored, const Frustum& frustum,
                     Visit&& visit) const;
  // Of an object that is partly in the picture.
  void addClipped(ObjectId object, const Mat4& scene_from_stored, const PictureView& view,
                  LayerPoints& layer) const;

  std::vector<Vec3f> positions_;
  std::vector<std::uint32_t> indices_;
  std::vector<Shape> shapes_;
};

// Numbers of points that are farthest of all in one of 26 directions, which are those from the middle of the
// points' box to its corners and to the middles of its edges and sides. Ascending, each once.
std::vector<std::size_t> extremesOf(std::span<const Vec3d> points);

}  // namespace sightline::render
