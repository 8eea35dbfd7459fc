#pragma once

// The exact shape of a box's image: its outline, and how near it is at each place of the buffer.

#include <cstdint>

#include "sightline/math/box.h"
#include "src/scene/pixel_view.h"

namespace sightline::occlusion {

// What outlines need of a view, computed once for many boxes.
struct OutlineView {
  OutlineView() = default;
  explicit OutlineView(const scene::PixelView& pixel_view);

  scene::PixelView view;
  bool sane = false;                // see PixelView::sane()
  double per_x = 0.0, per_y = 0.0;  // change of tx and ty for a pixel, see box_outline.cpp
  // By coordinate of a function and by its slot: what it has of the slot's two factors.
  alignas(64) double first[3][16] = {}, second[3][16] = {};
};

// Functions of the pixels x, y from a place of the buffer: along_x x + along_y y + at_origin, rounded up.
// Each has a slot.
struct BoxOutline {
  // Slots of the edges: each function is >= 0 within the convex hull of the box's image: the plane through
  // the eye and an edge between a face that is seen and one that is not.
  static constexpr std::uint32_t kEdges = 6;
  // Slots of the faces that are seen: where a ray intersects the box, no point of it before the eye has a
  // greater reciprocal depth than the least of their functions.
  static constexpr std::uint32_t kFirstFace = 8, kFaces = 3;
  static constexpr std::uint32_t kSlots = kFirstFace + kFaces;
  // What is written beyond them, so that vectors are whole, has no meaning.
  static constexpr std::uint32_t kStored = 16;

  // A slot without an edge or a face, or whose function would be too large, has one that says nothing: it is
  // everywhere greater than 0, or as great as can be.
  alignas(64) float along_x[kStored], along_y[kStored], at_origin[kStored];
  bool has_faces = false;  // the function of some face says something
};

// Returns the outline of a well-formed box, as far as it lies before the eye. Functions are of pixels from
// (x, y). They are upper bounds, with all rounding of their evaluation in single precision, up to `reach`
// pixels from there along each axis. Every instruction set gives the same bits.
BoxOutline outlineOf(const OutlineView& view, const Box& box, std::uint32_t x, std::uint32_t y, double reach);

}  // namespace sightline::occlusion
