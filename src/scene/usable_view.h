#pragma once

#include "sightline/scene/camera.h"

namespace sightline::scene {

// Normalises an axis unless it has unit length up to single precision. Returns false if it has no direction.
bool makeUnit(Vec3d& axis);

// Normalises right, up and forward in the same way. A left-handed basis stays one.
bool makeAxesUnit(View& view);
// A copy of the view whose axes makeAxesUnit() has normalised. An axis without a direction stays as it is.
View withUnitAxes(const View& view);

// Whether right, up and forward, of unit length, are a left-handed basis: the picture is mirrored.
bool isLeftHanded(const View& view);

// Prepares a caller's view as validate() describes; allocates nothing, so it can run in every frame. Returns
// null, or a static text that says what is wrong with the view, which is then unchanged.
const char* makeUsable(View& view);

// The direction of the lines of sight of an orthographic view that validate() accepts: what lies on one of
// them is at one place of the picture of clipFromScene(), which right and up alone decide. With axes of
// single precision it is not quite `forward`, along which depths are measured: a metre of depth is its length
// along the line of sight, so dot(view.forward, sightDirection(view)) = 1. It is `forward` itself where the
// axes are orthonormal up to double precision.
Vec3d sightDirection(const View& view);

}  // namespace sightline::scene
