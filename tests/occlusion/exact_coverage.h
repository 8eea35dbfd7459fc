#pragma once

// An exact judge of buffers: is a closed pixel square inside the union of the images of some polygons, and
// how near are they there? Integers only. Points have small integer coordinates in camera space and the
// camera's tangents are powers of two, so that points of the buffer are quotients of small integers. Every
// piece that is left of a pixel is bounded by lines that were given, never by computed points, so numbers do
// not grow.
//
// Camera space: x to the right, y upwards, z the depth. Buffer space: pixels, the lower left corner at (0,
// 0), y upwards. A point of the buffer is (x, y, w), meaning (x / w, y / w), with w > 0.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <numeric>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "sightline/occluders/occluder_set.h"
#include "sightline/scene/camera.h"

namespace sightline::exact {

// What findOccluders makes of triangles, three corners each, that are joined where corners are equal.
inline OccluderSet setOfMesh(std::span<const std::vector<Vec3f>> triangles) {
  Scene scene;
  for (const std::vector<Vec3f>& triangle : triangles) {
    for (const Vec3f& p : triangle) {
      scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
      scene.positions.push_back(p);
    }
  }
  scene.materials.emplace_back();
  scene.objects.emplace_back();
  scene.objects[0].index_count = static_cast<std::uint32_t>(scene.indices.size());
  scene.objects[0].material = MaterialId(0u);
  weldPositions(scene);
  updateBounds(scene);
  return findOccluders(scene.view(), {.area_fraction = 1.0});
}

__extension__ typedef __int128 Wide;

struct Point {
  std::int64_t x = 0, y = 0, z = 0;
  friend bool operator==(const Point&, const Point&) = default;
};

// Random whole numbers, of which scenes are made.
class WholeNumbers {
 public:
  explicit WholeNumbers(std::uint64_t seed) : engine_(seed) {}
  std::int64_t in(std::int64_t low, std::int64_t high) {
    return low + static_cast<std::int64_t>(engine_() % static_cast<std::uint64_t>(high - low + 1));
  }
  bool once(std::int64_t in_how_many) { return in(1, in_how_many) == 1; }

 private:
  std::mt19937_64 engine_;
};

struct Polygon {
  std::vector<Point> vertices;  // convex, in one plane, counter-clockwise as seen from the front
  bool double_sided = false;
};

struct Camera {
  std::int64_t width = 1, height = 1;  // pixels
  bool orthographic = false;
  // Perspective: one over the tangents of the half angles. Orthographic: half the size of the picture.
  std::int64_t gx = 1, gy = 1;
  std::int64_t near = 1;
};

// The camera at a place of the scene, with axis-aligned directions.
inline View viewOf(const Camera& camera, const Vec3d& eye, const Vec3d& forward, const Vec3d& up) {
  View view;
  view.forward = forward;
  view.up = up;
  view.right = cross(forward, up);
  view.eye = eye;
  view.orthographic = camera.orthographic;
  view.z_near = static_cast<double>(camera.near);
  view.z_far = 1e4;
  const auto gx = static_cast<double>(camera.gx), gy = static_cast<double>(camera.gy);
  view.tan_half_fovy = 1.0 / gy;
  view.ortho_height = 2.0 * gy;
  view.aspect = camera.orthographic ? gx / gy : gy / gx;
  return view;
}

// The point of the scene with these coordinates in the view's camera space.
inline Vec3f inScene(const View& view, const Point& p) {
  return Vec3f(view.eye + view.right * static_cast<double>(p.x) + view.up * static_cast<double>(p.y) +
               view.forward * static_cast<double>(p.z));
}

// Aborts where 128 bits do not suffice: such a scene is too large for this judge.
inline Wide times(Wide a, Wide b) {
  Wide product = 0;
  if (__builtin_mul_overflow(a, b, &product)) {
    std::abort();
  }
  return product;
}

struct Triple {  // a point (x, y, w), or the line x X + y Y + w >= 0
  Wide x = 0, y = 0, w = 0;
};

inline Triple cross(const Triple& p, const Triple& q) {
  return {times(p.y, q.w) - times(p.w, q.y), times(p.w, q.x) - times(p.x, q.w),
          times(p.x, q.y) - times(p.y, q.x)};
}
inline Wide dot(const Triple& p, const Triple& q) {
  return times(p.x, q.x) + times(p.y, q.y) + times(p.w, q.w);
}
inline Triple negated(const Triple& p) {
  return {-p.x, -p.y, -p.w};
}
// Returns the same line with the smallest integer coefficients.
inline Triple reduced(const Triple& line) {
  const auto common = [](Wide a, Wide b) {
    a = a < 0 ? -a : a;
    b = b < 0 ? -b : b;
    while (b != 0) {
      const Wide rest = a % b;
      a = b;
      b = rest;
    }
    return a;
  };
  const Wide divisor = common(common(line.x, line.y), line.w);
  return divisor > 1 ? Triple{line.x / divisor, line.y / divisor, line.w / divisor} : line;
}

// A convex part of the buffer with an area: what is to the left of all its lines, which go round it
// counter-clockwise. No lines: the empty part.
using Part = std::vector<Triple>;

inline Triple corner(const Part& part, std::size_t i) {
  return cross(part[i], part[(i + 1) % part.size()]);  // w > 0, since the next line turns to the left
}

inline Part clipped(const Part& part, const Triple& line) {
  const std::size_t n = part.size();
  std::vector<int> side(n);
  bool inside = false, outside = false;
  for (std::size_t i = 0; i < n; ++i) {
    const Wide value = dot(line, corner(part, i));
    side[i] = value > 0 ? 1 : value < 0 ? -1 : 0;
    inside |= side[i] > 0;
    outside |= side[i] < 0;
  }
  if (!inside) {
    return {};
  }
  if (!outside) {
    return part;
  }
  std::size_t first = 0;  // of the corners that are inside, which follow each other
  while (!(side[first] > 0 && side[(first + n - 1) % n] <= 0)) {
    ++first;
  }
  Part result{line};
  std::size_t i = first;
  for (; side[i % n] > 0; ++i) {
    result.push_back(part[i % n]);
  }
  result.push_back(part[i % n]);
  return result;
}

// Returns whether the part lies in the union of the others, all of them closed.
inline bool isCovered(const Part& part, std::span<const Part> others) {
  std::vector<Part> left{part};
  for (const Part& other : others) {
    std::vector<Part> next;
    for (const Part& piece : left) {
      Part inside = piece;
      std::vector<Part> outside;
      for (const Triple& line : other) {
        Part beyond = clipped(inside, negated(line));
        if (!beyond.empty()) {
          outside.push_back(std::move(beyond));
        }
        inside = clipped(inside, line);
        if (inside.empty()) {
          break;
        }
      }
      if (inside.empty() || other.empty()) {
        next.push_back(piece);
      } else {
        next.insert(next.end(), outside.begin(), outside.end());
      }
    }
    left = std::move(next);
  }
  return left.empty();
}

// Returns whether the part lies in one other part.
inline bool contains(const Part& other, const Part& part) {
  for (std::size_t i = 0; i < part.size(); ++i) {
    const Triple point = corner(part, i);
    for (const Triple& line : other) {
      if (dot(line, point) < 0) {
        return false;
      }
    }
  }
  return true;
}

inline Part intersection(Part part, const Part& other) {
  for (std::size_t i = 0; i < other.size() && !part.empty(); ++i) {
    part = clipped(part, other[i]);
  }
  return part;
}

// Returns the closed pixel; with grow, its sides are moved outwards by 1 / grow of a pixel.
inline Part pixel(std::int64_t x, std::int64_t y, std::int64_t grow = 0) {
  const std::int64_t k = grow == 0 ? 1 : grow, d = grow == 0 ? 0 : 1;
  return {{k, 0, d - k * x}, {0, k, d - k * y}, {-k, 0, k * (x + 1) + d}, {0, -k, k * (y + 1) + d}};
}

// The image of the part of a polygon's front beyond the near plane.
struct Image {
  Part part;
  Triple reciprocal_depth;  // over the buffer, times denominator
  Wide denominator = 1;
  std::size_t polygon = 0;

  double reciprocalDepthAt(const Triple& point) const {
    return static_cast<double>(dot(reciprocal_depth, point)) /
           static_cast<double>(times(denominator, point.w));
  }
  // Returns the reciprocal depth of the farthest point within a part of the buffer.
  double minReciprocalDepth(const Part& where) const {
    double least = INFINITY;
    for (std::size_t i = 0; i < where.size(); ++i) {
      least = std::min(least, reciprocalDepthAt(corner(where, i)));
    }
    return least;
  }
};

// (x, y, z) / q in camera space.
inline Triple project(const Camera& c, const Point& p, std::int64_t q) {
  if (c.orthographic) {
    return {Wide{c.width} * (q * c.gx + p.x) * c.gy, Wide{c.height} * (q * c.gy + p.y) * c.gx,
            Wide{2} * q * c.gx * c.gy};
  }
  return {Wide{c.width} * (p.z + c.gx * p.x), Wide{c.height} * (p.z + c.gy * p.y), Wide{2} * p.z};
}

// Sets the reciprocal depth of the plane n . p = d as a linear function over the buffer.
inline void setReciprocalDepth(const Camera& c, const Polygon& polygon, Image& image) {
  const Point &a = polygon.vertices[0], &b = polygon.vertices[1], &e = polygon.vertices[2];
  const Triple n = cross({b.x - a.x, b.y - a.y, b.z - a.z}, {e.x - a.x, e.y - a.y, e.z - a.z});
  const Wide d = dot(n, {a.x, a.y, a.z});
  const Wide w = c.width, h = c.height, gx = c.gx, gy = c.gy;
  if (c.orthographic) {
    // -z = (nx x + ny y - d) / nz, with x = (2 X / w - 1) gx.
    image.reciprocal_depth = {2 * n.x * gx * h, 2 * n.y * gy * w, -(n.x * gx + n.y * gy + d) * w * h};
    image.denominator = n.w * w * h;
  } else {
    // 1 / z = n . (x / z, y / z, 1) / d, with x / z = (2 X / w - 1) / gx.
    image.reciprocal_depth = {2 * n.x * h * gy, 2 * n.y * w * gx,
                              (n.w * gx * gy - n.x * gy - n.y * gx) * w * h};
    image.denominator = d * w * h * gx * gy;
  }
  if (image.denominator < 0) {
    image.reciprocal_depth = negated(image.reciprocal_depth);
    image.denominator = -image.denominator;
  }
}

inline std::optional<Image> imageOf(const Camera& camera, const Polygon& polygon) {
  const auto& v = polygon.vertices;
  const Wide turn = dot(cross(project(camera, v[0], 1), project(camera, v[1], 1)), project(camera, v[2], 1));
  if (turn == 0 || (turn < 0 && !polygon.double_sided)) {
    return std::nullopt;
  }
  std::vector<Triple> corners;
  for (std::size_t i = 0; i < v.size(); ++i) {
    const Point &a = v[i], &b = v[(i + 1) % v.size()];
    if (a.z >= camera.near) {
      corners.push_back(project(camera, a, 1));
    }
    if ((a.z > camera.near && b.z < camera.near) || (a.z < camera.near && b.z > camera.near)) {
      // a + (b - a) (near - a.z) / (b.z - a.z), by positive multiples.
      const std::int64_t s = std::abs(camera.near - a.z), t = std::abs(b.z - camera.near);
      corners.push_back(project(camera, {a.x * t + b.x * s, a.y * t + b.y * s, a.z * t + b.z * s}, s + t));
    }
  }
  if (corners.size() < 3) {
    return std::nullopt;
  }
  Image image;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Triple line = reduced(cross(corners[i], corners[(i + 1) % corners.size()]));
    image.part.push_back(turn > 0 ? line : negated(line));
  }
  if (turn < 0) {
    image.part = Part(image.part.rbegin(), image.part.rend());
  }
  setReciprocalDepth(camera, polygon, image);
  return image;
}

// Images of polygons that are joined by edges with equal end points.
struct Surface {
  std::vector<Image> images;
  bool sheet = true;  // the images do not overlap
  bool tie = false;   // images touch along edges that the polygons do not share
};

inline bool shareAnEdge(const Polygon& a, const Polygon& b) {
  const std::size_t n = a.vertices.size(), m = b.vertices.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point &p = a.vertices[i], &q = a.vertices[(i + 1) % n];
    for (std::size_t j = 0; j < m; ++j) {
      const Point &r = b.vertices[j], &s = b.vertices[(j + 1) % m];
      if ((p == s && q == r) || (p == r && q == s)) {
        return true;
      }
    }
  }
  return false;
}

// Returns whether edges of the two images overlap, with the images on opposite sides.
inline bool touch(const Image& a, const Image& b) {
  const auto same = [](const Triple& p, const Triple& q) { return p.x == q.x && p.y == q.y && p.w == q.w; };
  // First and last point of an edge, measured along a direction.
  const auto range = [](const Part& part, std::size_t i, const Triple& line) {
    const auto at = [&](const Triple& p) {
      return static_cast<double>(times(line.y, p.x) - times(line.x, p.y)) / static_cast<double>(p.w);
    };
    const double from = at(corner(part, (i + part.size() - 1) % part.size())), to = at(corner(part, i));
    return std::pair(std::min(from, to), std::max(from, to));
  };
  for (std::size_t i = 0; i < a.part.size(); ++i) {
    for (std::size_t j = 0; j < b.part.size(); ++j) {
      if (same(a.part[i], negated(b.part[j]))) {
        const auto p = range(a.part, i, a.part[i]), q = range(b.part, j, a.part[i]);
        if (std::max(p.first, q.first) < std::min(p.second, q.second) - 1e-9) {
          return true;
        }
      }
    }
  }
  return false;
}

inline std::vector<Surface> surfacesOf(const Camera& camera, std::span<const Polygon> polygons) {
  std::vector<Image> images;
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (std::optional<Image> image = imageOf(camera, polygons[i])) {
      image->polygon = i;
      images.push_back(*image);
    }
  }
  std::vector<std::size_t> group(images.size());
  std::iota(group.begin(), group.end(), std::size_t{0});
  for (std::size_t i = 0; i < images.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if (group[i] != group[j] && shareAnEdge(polygons[images[i].polygon], polygons[images[j].polygon])) {
        const std::size_t from = group[i], to = group[j];
        for (std::size_t& g : group) {
          g = g == from ? to : g;
        }
      }
    }
  }
  std::vector<Surface> surfaces;
  for (std::size_t g = 0; g < images.size(); ++g) {
    Surface surface;
    for (std::size_t i = 0; i < images.size(); ++i) {
      if (group[i] != g) {
        continue;
      }
      for (const Image& other : surface.images) {
        surface.sheet &= intersection(images[i].part, other.part).empty();
        surface.tie |=
            touch(images[i], other) && !shareAnEdge(polygons[images[i].polygon], polygons[other.polygon]);
      }
      surface.images.push_back(images[i]);
    }
    if (!surface.images.empty()) {
      surfaces.push_back(std::move(surface));
    }
  }
  return surfaces;
}

inline bool covers(const Surface& surface, const Part& where) {
  // Most parts have a corner that no image contains, or lie in one image.
  for (std::size_t i = 0; i < where.size(); ++i) {
    const Triple point = corner(where, i);
    const auto is_in = [&](const Image& image) {
      return std::ranges::all_of(image.part, [&](const Triple& line) { return dot(line, point) >= 0; });
    };
    if (std::ranges::none_of(surface.images, is_in)) {
      return false;
    }
  }
  if (std::ranges::any_of(surface.images, [&](const Image& image) { return contains(image.part, where); })) {
    return true;
  }
  std::vector<Part> parts;
  for (const Image& image : surface.images) {
    parts.push_back(image.part);
  }
  return isCovered(where, parts);
}

// Returns the reciprocal depth of the farthest point of the surface's polygons in this part of the buffer.
inline double minReciprocalDepth(const Surface& surface, const Part& where) {
  double least = INFINITY;
  for (const Image& image : surface.images) {
    least = std::min(least, image.minReciprocalDepth(intersection(where, image.part)));
  }
  return least;
}

// The same of the whole planes of the polygons that the pixel touches, or nearly: over all of the pixel.
inline double minReciprocalDepthOfPlanes(const Surface& surface, std::int64_t x, std::int64_t y) {
  double least = INFINITY;
  for (const Image& image : surface.images) {
    if (!intersection(pixel(x, y, 50), image.part).empty()) {
      least = std::min(least, image.minReciprocalDepth(pixel(x, y)));
    }
  }
  return least;
}

// Does the surface hide all that is farther than this throughout the part? The reciprocal depth of
// overlapping polygons is compared with `stored` rounded to 12 bits, away from the eye; that of others is
// compared in double precision.
inline bool hides(const Surface& surface, const Part& where, double stored) {
  if (!covers(surface, where)) {
    return false;
  }
  const double least = minReciprocalDepth(surface, where);
  const double rounding = surface.images.size() == 1 ? 0.0 : 1e-14 * std::abs(least);
  if (stored <= least + rounding || surface.sheet) {
    return stored <= least + rounding;
  }
  int exponent = 0;
  const auto mantissa = static_cast<std::int64_t>(std::floor(std::frexp(stored, &exponent) * 4096.0));
  exponent -= 12;  // stored is at least mantissa 2 ^ exponent
  const Wide up = exponent > 0 ? Wide{1} << exponent : Wide{1};
  const Wide down = exponent < 0 ? Wide{1} << -exponent : Wide{1};
  std::vector<Part> near_parts;
  for (const Image& image : surface.images) {
    const Triple& n = image.reciprocal_depth;
    const Triple nearer{times(n.x, down), times(n.y, down),
                        times(n.w, down) - times(times(image.denominator, mantissa), up)};
    const bool everywhere = nearer.x == 0 && nearer.y == 0 && nearer.w >= 0;
    near_parts.push_back(everywhere ? image.part : clipped(image.part, reduced(nearer)));
  }
  std::erase_if(near_parts, [](const Part& part) { return part.empty(); });
  return isCovered(where, near_parts);
}

}  // namespace sightline::exact
