#pragma once

// Exact visibility by ray casting with Embree: the reference for `verify` and the tests. Independent of the
// culler's geometry code: it reads only the scene's triangles and the view's numbers.
//
// Embree works in single precision: a ray may slip through the edge between two triangles, or hit the wrong
// one of two surfaces that are closer together than its rounding. Evidence against a culler is therefore
// confirmed first, by confirm(), in exact arithmetic. decide() answers in exact arithmetic both ways.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/parallel_for.h"
#include "sightline/scene/scene.h"

namespace sightline {

// A point of an object that a ray from the eye reaches.
struct SeenPoint {
  ObjectId object;
  Vec3d point;  // scene space

  friend bool operator==(const SeenPoint&, const SeenPoint&) = default;
};

enum class Verdict : std::uint8_t {
  kHidden,     // proved: no point of the object is visible
  kVisible,    // with a point that proves it
  kUndecided,  // too little work was allowed
};

struct Decision {
  Verdict verdict = Verdict::kUndecided;
  SeenPoint witness;  // if visible: its point is rounded to double precision
};

// All const functions may be called from several threads at once. Results do not depend on the ParallelFor.
class ExactVisibility {
 public:
  // Builds the ray-casting structures. The scene's memory must outlive this object.
  explicit ExactVisibility(const SceneView& scene);
  ~ExactVisibility();
  ExactVisibility(ExactVisibility&&) noexcept;
  ExactVisibility& operator=(ExactVisibility&&) noexcept;

  // Objects hit by a ray through the centre of any of width x height pixels, ascending by id, each with the
  // point of the first such pixel (rows from the top). Transparent materials are hit but do not stop rays;
  // back faces of single-sided materials are ignored; only hits between the near and the far plane count.
  std::vector<SeenPoint> visibleThroughPixels(const View& view, std::uint32_t width, std::uint32_t height,
                                              const ParallelFor& parallel_for = serialFor) const;

  // The points where the same rays hit one object, for all pixels that show it, in pixel order.
  std::vector<SeenPoint> pixelsShowing(ObjectId object, const View& view, std::uint32_t width,
                                       std::uint32_t height,
                                       const ParallelFor& parallel_for = serialFor) const;

  // Tries to reach each of these objects with rays aimed at `samples` points of its triangles: vertices, edge
  // and face points, distributed by area, with a seed that depends only on object and eye. Returns a witness
  // for each object that was reached, in the order of `objects`.
  std::vector<SeenPoint> visibleByAimedRays(const View& view, std::span<const ObjectId> objects,
                                            std::uint32_t samples,
                                            const ParallelFor& parallel_for = serialFor) const;

  // Objects visible close beside the edges of these objects. For each object, `samples` rays pass to the left
  // or right of edges of its triangles, by 1e-7 to 1e-2 of the distance, with a seed that depends only on
  // object and eye. The rays run along silhouettes and through narrow gaps, which pixels miss. One point per
  // object, ascending by id.
  std::vector<SeenPoint> visibleBesideEdges(const View& view, std::span<const ObjectId> objects,
                                            std::uint32_t samples,
                                            const ParallelFor& parallel_for = serialFor) const;

  // True if the ray from the eye through the witness's point reaches the object before any opaque surface, in
  // the view. Decided in exact arithmetic on the coordinates as they stand; edges belong to triangles. A
  // surface at the same distance does not hide the object (ties are visible).
  bool confirm(const View& view, const SeenPoint& witness) const;

  // Decides for each of these objects, in exact arithmetic, whether any of its points is visible. The images
  // of nearer triangles are subtracted from the object's own until nothing is left or a ray through what is
  // left reaches it. Each object may take `max_steps` steps of up to 16 rays each. Ties are visible;
  // triangles that are seen edge on and triangles without area show and hide nothing.
  std::vector<Decision> decide(const View& view, std::span<const ObjectId> objects, std::uint32_t max_steps,
                               const ParallelFor& parallel_for = serialFor) const;

  // Decides for each of these objects, in exact arithmetic, whether any point of its bounding box
  // (Object::bounds) in the view volume is visible, as if the box were solid and hid nothing. It is if the
  // object is. Boxes that are not finite are visible, those of objects without triangles are hidden. As in
  // decide(), sides that are seen edge on show nothing. The point of a witness is one of the box.
  std::vector<Decision> decideBoxes(const View& view, std::span<const ObjectId> objects,
                                    std::uint32_t max_steps,
                                    const ParallelFor& parallel_for = serialFor) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
