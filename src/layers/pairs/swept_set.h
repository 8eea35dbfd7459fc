#pragma once

// The set that a hull sweeps towards the eye of an orthographic view.

#include "src/layers/pairs/convex_pair.h"

namespace sightline::layers {

// A bound of the magnitudes of a placed hull's coordinates.
double reachOf(const ConvexSet& set);

// Makes `back` the set that it sweeps towards the eye, just far enough to pass the hull in front. Returns
// false if that lies wholly farther from the eye than the hull behind.
// forward: of the view, any length > 0.
bool sweepPast(const Vec3d& forward, const ConvexSet& front, ConvexSet& back);

}  // namespace sightline::layers
