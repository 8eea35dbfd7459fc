#pragma once

// The least that any test of several boxes an object must keep.

#include <cstdint>
#include <memory>

#include "sightline/scene/object_boxes.h"
#include "tools/sightline/exact/exact_cache.h"
#include "tools/sightline/exact/exact_frame.h"

namespace sightline::tool {

// Decides which of several boxes are visible past all opaque triangles, those of their own object included,
// as if the boxes were solid and hid nothing. An object with a visible one has to be kept.
class ExactSeveralBoxes {
 public:
  // boxes: of the scene. Both must outlive this.
  ExactSeveralBoxes(const SceneView& scene, const ObjectBoxes& boxes);
  ~ExactSeveralBoxes();

  // Returns, as `boxes` and `undecided_boxes`, what of those of the frame is left with several boxes an
  // object. frame: after addBoxes().
  ExactObjects left(const View& view, const ExactObjects& frame, const ExactSettings& settings,
                    const ParallelFor& parallel_for) const;

 private:
  const ObjectBoxes& boxes_;
  Scene boxed_;  // with a see-through object for each box, behind the scene's own
  std::uint32_t first_box_ = 0;
  std::unique_ptr<ExactVisibility> oracle_;
};

// Under which key the answers of left() are kept.
ExactKey severalBoxesKey(ExactKey key, const ObjectBoxes& boxes);

}  // namespace sightline::tool
