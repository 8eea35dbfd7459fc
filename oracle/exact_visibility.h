#pragma once

// Exact visibility by ray casting with Embree: the reference that `verify` and the tests compare a culler
// with. Independent of the culler's geometry code: it reads the scene's triangles and the view's numbers,
// nothing else.
//
// Embree works in single precision: a ray may slip through the seam of two triangles, or take the wrong one
// of two surfaces that lie closer together than its rounding. What is to be held against a culler is
// confirmed first, by confirm(), which follows one ray through all triangles in 113-bit arithmetic.

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
struct Witness {
  ObjectId object;
  Vec3d point;  // scene space

  friend bool operator==(const Witness&, const Witness&) = default;
};

// All const functions may be called from several threads at once. Results do not depend on the ParallelFor.
class ExactVisibility {
 public:
  // Builds the ray-casting structures. The scene's memory must outlive this.
  explicit ExactVisibility(const SceneView& scene);
  ~ExactVisibility();
  ExactVisibility(ExactVisibility&&) noexcept;
  ExactVisibility& operator=(ExactVisibility&&) noexcept;

  // Objects hit by a ray through the centre of any of width x height pixels, with a point each (of the first
  // such pixel, rows from the top), ascending by id. See-through materials are seen but do not stop rays;
  // backs of single-sided faces are not there at all; only what lies between the near and the far plane
  // counts.
  std::vector<Witness> visibleThroughPixels(const View& view, std::uint32_t width, std::uint32_t height,
                                            const ParallelFor& parallel_for = serialFor) const;

  // The points where the same rays reach one object, of all pixels that show it, in the order of the pixels.
  std::vector<Witness> pixelsShowing(ObjectId object, const View& view, std::uint32_t width,
                                     std::uint32_t height, const ParallelFor& parallel_for = serialFor) const;

  // Tries to see each of these objects by rays aimed at `samples` points of its triangles (vertices, edge and
  // face points, spread over its triangles by area, by a seed fixed by object and eye). Returns a witness for
  // each one that was reached, in the order of `objects`.
  std::vector<Witness> visibleByAimedRays(const View& view, std::span<const ObjectId> objects,
                                          std::uint32_t samples,
                                          const ParallelFor& parallel_for = serialFor) const;

  // Objects that show close beside the edges of these: hit by one of `samples` rays for each that pass to the
  // left or right of an edge of its triangles, by 1e-7 to 1e-2 of the distance (by a seed fixed by object and
  // eye). So rays go along silhouettes and through narrow gaps, which pixels miss. A point each, ascending by
  // id.
  std::vector<Witness> visibleBesideEdges(const View& view, std::span<const ObjectId> objects,
                                          std::uint32_t samples,
                                          const ParallelFor& parallel_for = serialFor) const;

  // Whether the ray from the eye through the witness's point really reaches the object, beyond what rounding
  // can explain: tested against every triangle in wide precision, edges belonging to triangles. A surface at
  // exactly the same distance does not hide it (ties are visible).
  bool confirm(const View& view, const Witness& witness) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sightline
