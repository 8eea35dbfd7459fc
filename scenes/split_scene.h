#pragma once

// Scenes whose large meshes are cut into overlapping pieces before their parts are sorted.

#include <cstdint>
#include <vector>

#include "scenes/moving_scene.h"
#include "sightline/base/progress.h"
#include "sightline/layers/pre_split.h"
#include "sightline/scene/scene.h"

namespace sightline {

// The triangles of a piece, in single precision, with equal positions stored once. Triangles that collapse to
// lines there are left out, which may leave none.
Scene pieceMesh(const SplitPiece& piece);

struct SplitScene {
  Scene scene;                      // object i is part i
  std::vector<MovingPlane> planes;  // between neighbouring pieces of an object
};

// Cuts each object that is wider than a cell along an axis, by a grid over its bounds; the others stay as
// they are. Blended objects stay whole, since neighbours both draw their overlap. The pieces of an object
// follow each other, and are named after it.
// width: of a cell, metres, > 0; doubled for an object as often as it would have more than kMostSplitCells
// cells. inflation: the overlap of neighbours as a fraction of the width, >= 0.
inline constexpr std::uint32_t kMostSplitCells = 1024;
SplitScene splitScene(const Scene& scene, double width, double inflation, const Progress& progress = {});

}  // namespace sightline
