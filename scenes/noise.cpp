#include "scenes/noise.h"

#include <algorithm>
#include <cmath>

#include "scenes/random.h"

namespace sightline::scenes {
namespace {

// A hash of a point of the lattice.
std::uint64_t hashOf(std::int64_t x, std::int64_t y, std::int64_t z, std::uint64_t seed) {
  std::uint64_t h = seed * 0x9e3779b97f4a7c15ull;
  for (const std::int64_t v : {x, y, z}) {
    h = (h ^ static_cast<std::uint64_t>(v)) * 0xbf58476d1ce4e5b9ull;
    h ^= h >> 29;
  }
  return Random(h).next();
}

// One of the hash's three numbers of 21 bits, from -1 to 1.
double part(std::uint64_t hash, int axis) {
  return static_cast<double>(hash >> (21 * axis) & 0x1fffffu) * (2.0 / 0x1fffff) - 1.0;
}

double fade(double t) {
  return t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
}

double mix(double a, double b, double t) {
  return a + (b - a) * t;
}

// The sum over octaves of a noise of points of any dimension.
template <typename P>
double sumOfOctaves(const P& p, std::uint32_t octaves, std::uint64_t seed) {
  double sum = 0.0, size = 1.0;
  P at = p;
  for (std::uint32_t i = 0; i < octaves; ++i) {
    sum += size * noise(at, seed + i);
    at = at * 2.0;
    size *= 0.5;
  }
  return sum;
}

}  // namespace

double noise(const Vec3d& p, std::uint64_t seed) {
  const double fx = std::floor(p.x), fy = std::floor(p.y), fz = std::floor(p.z);
  const double x = p.x - fx, y = p.y - fy, z = p.z - fz;
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy),
             iz = static_cast<std::int64_t>(fz);
  const auto corner = [&](int i, int j, int k) {
    const std::uint64_t hash = hashOf(ix + i, iy + j, iz + k, seed);
    return part(hash, 0) * (x - i) + part(hash, 1) * (y - j) + part(hash, 2) * (z - k);
  };
  const double u = fade(x), v = fade(y), w = fade(z);
  const auto layer = [&](int k) {
    return mix(mix(corner(0, 0, k), corner(1, 0, k), u), mix(corner(0, 1, k), corner(1, 1, k), u), v);
  };
  return mix(layer(0), layer(1), w);
}

double noise(Point2 p, std::uint64_t seed) {
  const double fx = std::floor(p.x), fy = std::floor(p.y);
  const double x = p.x - fx, y = p.y - fy;
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  const auto corner = [&](int i, int j) {
    const std::uint64_t hash = hashOf(ix + i, iy + j, 0, seed);
    return part(hash, 0) * (x - i) + part(hash, 1) * (y - j);
  };
  const double u = fade(x);
  return mix(mix(corner(0, 0), corner(1, 0), u), mix(corner(0, 1), corner(1, 1), u), fade(y));
}

double fractalNoise(const Vec3d& p, std::uint32_t octaves, std::uint64_t seed) {
  return sumOfOctaves(p, octaves, seed);
}

double fractalNoise(Point2 p, std::uint32_t octaves, std::uint64_t seed) {
  return sumOfOctaves(p, octaves, seed);
}

double ridgedNoise(Point2 p, std::uint32_t octaves, std::uint64_t seed) {
  double sum = 0.0, size = 0.5, total = 0.0, before = 1.0;
  Point2 at = p;
  for (std::uint32_t i = 0; i < octaves; ++i) {
    const double crest = std::clamp(1.0 - 1.6 * std::abs(noise(at, seed + i)), 0.0, 1.0);
    // Small ridges grow on large ones.
    const double here = crest * crest * before;
    sum += size * here;
    total += size;
    before = std::clamp(here * 1.6, 0.0, 1.0);
    at = at * 2.0;
    size *= 0.5;
  }
  return sum / total;
}

double smoothStep(double low, double high, double value) {
  const double t = std::clamp((value - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace sightline::scenes
