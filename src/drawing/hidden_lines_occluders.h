#pragma once

// The triangles of a view that hide what is behind them.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/scene/scene.h"
#include "src/drawing/hidden_lines_tree.h"
#include "src/drawing/triangle_hiding.h"
#include "src/drawing/triangle_side.h"

namespace sightline::drawing {

class HidingTriangles {
 public:
  // Reads the triangles of all objects and builds a tree for each object.
  void set(const SceneView& scene, const LineView& view);

  std::size_t objects() const { return roots_.size(); }
  std::uint32_t rootOf(std::uint32_t object) const { return roots_[object]; }  // or HidingTrees::kNoTree
  const HidingTrees& trees() const { return trees_; }
  const HidingTriangle& operator[](std::uint32_t id) const { return triangles_[id]; }

 private:
  void addObject(const SceneView& scene, const Object& object, const TriangleSides& sides,
                 const LineView& view);
  void addTriangle(const SceneView& scene, std::span<const std::uint32_t> corners, const LineView& view);

  std::vector<HidingTriangle> triangles_;
  HidingTrees trees_;
  std::vector<std::uint32_t> roots_;
  std::vector<HidingTrees::Item> items_;
};

}  // namespace sightline::drawing
