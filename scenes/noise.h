#pragma once

// Gradient noise, the same bits on every platform.
// Based on: Ken Perlin. Improving noise. SIGGRAPH 2002.
// Differs from the paper in: gradients, which are hashed and of any length up to 1 along each axis.

#include <cstdint>

#include "scenes/placement.h"

namespace sightline::scenes {

// Smooth, about -1 to 1, 0 at whole coordinates; it changes within a distance of 1.
double noise(const Vec3d& p, std::uint64_t seed);
double noise(Point2 p, std::uint64_t seed);

// A sum of `octaves` noises, each of half the size and twice the frequency of the one before.
double fractalNoise(const Vec3d& p, std::uint32_t octaves, std::uint64_t seed);
double fractalNoise(Point2 p, std::uint32_t octaves, std::uint64_t seed);

// Fractal noise with sharp ridges, 0 to 1: crests are at 1.
double ridgedNoise(Point2 p, std::uint32_t octaves, std::uint64_t seed);

// 0 up to `low`, 1 from `high` on, smooth between.
double smoothStep(double low, double high, double value);

}  // namespace sightline::scenes
