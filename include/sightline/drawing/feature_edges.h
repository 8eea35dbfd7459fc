#pragma once

// The lines of an object that a drawing shows.
//
// Whether an edge is a line depends on what is drawn on its two sides, as seen from the eye, not on how the
// file stores it: faces that are reversed, doubled, cut up or not welded give the same lines.
//
//   - A face is drawn if it turns its front to the eye; with a double-sided material also if it turns its
//     back. A face seen edge on, within the rounding of double precision, is not drawn. An edge of which no
//     face is drawn is not a line: an open single-sided sheet has no lines from behind.
//   - Corners of an object at the same place are one corner. If a corner lies on an edge that no other face
//     shares (within 2^-21 of the object's largest coordinate), the edge is cut there: T-junctions make no
//     lines.
//   - Faces at an edge that lie on one another (doubled, or back to back) count as one, whatever their
//     winding. Angles are measured as if both surfaces were wound alike.
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
  // The line is between faces whose normals differ by at least crease_deg; one that is drawn is enough.
  kCrease,
  // The object lies on one side of the line only: between a face seen from its front and one seen from its
  // back. A face seen edge on lies on neither side.
  kSilhouette,
  // The line is of one face alone, or of more than two faces.
  kBoundary,
};

struct FeatureSettings {
  bool creases = true, silhouettes = true, boundaries = true;
  double crease_deg = 30.0;  // smallest angle between normals at a crease, with a tolerance of 1e-9
};

struct FeatureLine {
  std::uint32_t a = 0, b = 0;  // indices into SceneView::positions, a < b
  // A line of several kinds has the first that is asked for, in the order boundary, silhouette, crease.
  LineKind kind = LineKind::kCrease;
  friend bool operator==(const FeatureLine&, const FeatureLine&) = default;
};

// The edges of all objects, found once from the triangles' indices. Positions may change from call to call,
// if objects move rigidly. Of corners at the same place the lowest index stands for all. Const functions may
// be called from several threads at once.
class FeatureEdges {
 public:
  // Precondition: indices are below the number of positions.
  explicit FeatureEdges(const SceneView& scene);

  // Replaces `lines` by the object's lines as seen from the view's eye, ascending by (a, b). Lines that are
  // hidden or outside the view are included; edges without length are not. scene must have the constructor's
  // objects and indices. Orthographic views look at right angles to right and up, which is along forward but
  // for the rounding of the axes, wherever the eye is.
  void select(const SceneView& scene, ObjectId object, const View& view, const FeatureSettings& settings,
              std::vector<FeatureLine>& lines) const;

 private:
  friend class drawing::EdgeBuilder;

  // One side of a triangle.
  struct FaceSide {
    std::uint32_t first_index = 0;  // of the triangle in SceneView::indices
    bool along = true;              // the triangle's winding leads from a to b
  };
  struct Edge {
    std::uint32_t a = 0, b = 0;
    std::uint32_t first_side = 0, side_count = 0;  // a range of sides_
  };
  std::vector<Edge> edges_;
  std::vector<FaceSide> sides_;
  std::vector<std::uint32_t> first_edge_;  // for each object its first edge, and the end of the last one's
};

}  // namespace sightline
