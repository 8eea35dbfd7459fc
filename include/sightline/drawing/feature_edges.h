#pragma once

// The lines of an object that a drawing shows.
//
// What a line is depends on what is drawn on its two sides, as seen from the eye, and not on how the file
// says it: faces that are reversed, doubled, cut up or not welded look alike.
//
//   - A face is drawn where it turns its front to the eye, with a double-sided material also its back. A face
//     seen edge on, within the rounding of double precision, shows nothing and is not drawn. Edges of which
//     no face is drawn are no lines: an open single-sided sheet has none from behind.
//   - Corners at the same place are one corner within an object. Where a corner lies on an edge that no other
//     face shares (within 2^-21 of the object's largest coordinate), the edge ends there and goes on: walls
//     whose faces meet in T-junctions have no lines in them.
//   - Faces at an edge that lie on one another (doubled, or back to back) count as one, whatever their
//   winding.
//     Angles are between the surfaces, as if both were wound alike.
//   - Between two faces that are coplanar, as far as single precision can tell, there is no line of any kind,
//     at any crease_deg, from any eye.
//   - Triangles without area, thinner than that 2^-21, or with coordinates that are not finite are left out.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/scene/camera.h"
#include "sightline/scene/scene.h"

namespace sightline {

namespace drawing {
class EdgeBuilder;
}

enum class LineKind : std::uint8_t {
  kCrease,      // between faces whose normals differ by at least crease_deg; a drawn one is enough
  kSilhouette,  // all that is there lies on one side of the line in the picture, a face edge on on neither:
                // between a face seen from its front and one seen from its back
  kBoundary,    // of one face alone, or of more than two
};

struct FeatureSettings {
  bool creases = true, silhouettes = true, boundaries = true;
  double crease_deg = 30.0;  // reached within 1e-9 is reached
};

struct FeatureLine {
  std::uint32_t a = 0, b = 0;         // into SceneView::positions, a < b
  LineKind kind = LineKind::kCrease;  // the first that is asked for: boundary, silhouette, crease
  friend bool operator==(const FeatureLine&, const FeatureLine&) = default;
};

// The edges of all objects, found once from the triangles' indices; positions may change from call to call
// (objects that move rigidly). Of corners at the same place the lowest index stands for all. Const functions
// may be called from several threads at once.
class FeatureEdges {
 public:
  // Indices must be below the number of positions.
  explicit FeatureEdges(const SceneView& scene);

  // The object's lines as seen from the view's eye, ascending by (a, b), hidden ones too, also those outside
  // the view. lines: replaced. Edges without length and triangles without area make no lines. scene: the same
  // objects and indices. Orthographic views look along forward, wherever the eye is.
  void select(const SceneView& scene, ObjectId object, const View& view, const FeatureSettings& settings,
              std::vector<FeatureLine>& lines) const;

 private:
  friend class drawing::EdgeBuilder;

  // One side of a triangle.
  struct FaceSide {
    std::uint32_t first_index = 0;  // of the triangle, into SceneView::indices
    bool along = true;              // its winding leads from a to b
  };
  struct Edge {
    std::uint32_t a = 0, b = 0;
    std::uint32_t first_side = 0, side_count = 0;  // into sides_
  };
  std::vector<Edge> edges_;
  std::vector<FaceSide> sides_;
  std::vector<std::uint32_t> first_edge_;  // objects + 1
};

}  // namespace sightline
