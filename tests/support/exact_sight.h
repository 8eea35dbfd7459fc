#pragma once

// Whether an object of a tiny scene is visible, by brute force in whole numbers: the reference for the tests
// of the exact verifier, with which it shares no code.
//
// All lines in which anything can change divide the image: edges of triangles, the lines where the planes of
// two triangles cross, the cuts of the near and the far plane, and the borders of the picture. Visibility is
// the same everywhere within a face, within an edge between two crossings, and at a crossing. So one
// direction of each is looked along: every crossing, a direction between neighbouring crossings of each line,
// and the directions beside that one on both sides of the line.

#include <algorithm>
#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sightline/scene/scene.h"

namespace sightline::test {

// Finds what one view of a scene shows. Triangles that are seen edge on, and triangles with coordinates that
// are not finite, neither show nor hide anything. The shifts of the view are multiples of 1/64.
class ExactSight {
 public:
  ExactSight(const SceneView& scene, const View& view);

  bool isVisible(ObjectId object) const;
  // True if the line of sight through this point, exact as it stands, shows the object.
  bool reaches(const Vec3d& point, ObjectId object) const;

 private:
  using Whole = boost::multiprecision::number<
      boost::multiprecision::cpp_int_backend<512, 0, boost::multiprecision::signed_magnitude,
                                             boost::multiprecision::unchecked>,
      boost::multiprecision::et_off>;
  struct Vec {
    Whole x, y, z;

    bool isZero() const { return x == 0 && y == 0 && z == 0; }
  };
  // Its depth in a direction d is (depth . d) / (scale . d), in units of 2^(position_unit_ + axis_unit_).
  struct Triangle {
    ObjectId object;
    bool opaque = false;
    std::array<Vec, 3> edges;  // n . d >= 0 inside
    Vec depth, scale;
    Whole volume;                 // positive
    Vec beyond_near, before_far;  // n . d >= 0 there
  };
  // What of a triangle can be seen, and by what it can be hidden.
  struct Blocker {
    const Triangle* triangle = nullptr;
    Vec behind;  // n . d < 0 where the blocker is nearer than the target
  };
  struct Target {
    const Triangle* triangle = nullptr;
    std::vector<Blocker> blockers;
  };

  static Vec add(const Vec& a, const Vec& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  static Vec times(const Vec& a, const Whole& f) { return {a.x * f, a.y * f, a.z * f}; }
  static Vec cross(const Vec& a, const Vec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  }
  static Whole dot(const Vec& a, const Vec& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
  static int side(const Vec& line, const Vec& d) { return dot(line, d).sign(); }
  static Whole power(int exponent) { return Whole(1) << static_cast<unsigned>(exponent); }

  static constexpr int kShiftUnits = 64;

  static int unitOf(double value) { return value == 0.0 ? 0 : std::ilogb(value) - 52; }
  static int unitOf(const Vec3d& v) { return std::min({unitOf(v.x), unitOf(v.y), unitOf(v.z), 0}); }
  static Whole whole(double value, int unit) { return Whole(std::ldexp(value, -unit)); }
  static Vec whole(const Vec3d& v, int unit) {
    return {whole(v.x, unit), whole(v.y, unit), whole(v.z, unit)};
  }

  void setUpPicture();
  Vec image(const Vec& from_eye, const Whole& unit) const;
  void addTriangle(std::span<const Vec3f, 3> corners, const Material& material, ObjectId object);
  Vec beyond(const Triangle& triangle, double depth) const;
  Target targetOf(const Triangle& triangle) const;
  std::vector<Vec> linesOf(const Target& target) const;
  bool isInside(const Triangle& triangle, const Vec& d) const;
  bool isSeen(const Target& target, const Vec& d) const;
  bool showsAnything(const Target& target) const;
  bool showsAnythingAlong(const Target& target, const std::vector<Vec>& lines, std::size_t line,
                          unsigned shift) const;

  View view_;
  int position_unit_ = 0, axis_unit_ = 0;  // exponents of two
  Vec eye_, right_, up_, forward_;
  Vec before_eye_;              // n . d > 0 for every direction
  std::array<Vec, 4> picture_;  // n . d >= 0 inside
  std::vector<Triangle> triangles_;
};

inline ExactSight::ExactSight(const SceneView& scene, const View& view) : view_(view) {
  position_unit_ = unitOf(view.eye);
  for (const Vec3f& p : scene.positions) {
    position_unit_ = isFinite(p) ? std::min(position_unit_, unitOf(Vec3d(p))) : position_unit_;
  }
  axis_unit_ = std::min({unitOf(view.right), unitOf(view.up), unitOf(view.forward)});
  eye_ = whole(view.eye, position_unit_);
  right_ = whole(view.right, axis_unit_);
  up_ = whole(view.up, axis_unit_);
  forward_ = whole(view.forward, axis_unit_);
  setUpPicture();
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    for (std::uint32_t i = 0; i + 2 < object.index_count; i += 3) {
      std::array<Vec3f, 3> corners;
      for (std::uint32_t c = 0; c < 3; ++c) {
        corners[c] = scene.positions[scene.indices[object.first_index + i + c]];
      }
      addTriangle(corners, scene.materialOf(object), ObjectId(o));
    }
  }
}

// Perspective: |right . d - shift tan aspect (forward . d)| <= tan aspect (forward . d). Orthographic: a
// point is x right + y up + z forward, and d is (x, y, 1), with x and y times the volume of the axes.
inline void ExactSight::setUpPicture() {
  const double height = view_.orthographic ? 0.5 * view_.ortho_height : view_.tan_half_fovy;
  const int height_unit = unitOf(height), aspect_unit = unitOf(view_.aspect);
  const Whole y = whole(height, height_unit);
  const Whole x = y * whole(view_.aspect, aspect_unit);
  const auto set = [&](int at, const Vec& axis, const Vec& along, Whole extent, int unit, double shift) {
    // axis . d <= extent 2^unit (1 + shift) (along . d), and the same to the other side
    const int one = shift == 0.0 ? 1 : kShiftUnits, shifted = static_cast<int>(shift * one);
    const Vec border = times(along, extent * power(std::max(unit, 0)));
    const Vec scaled = times(axis, power(std::max(-unit, 0)) * one);
    picture_[static_cast<std::size_t>(at)] = add(times(border, one - shifted), scaled);
    picture_[static_cast<std::size_t>(at) + 1] = add(times(border, one + shifted), times(scaled, -1));
  };
  if (!view_.orthographic) {
    before_eye_ = forward_;
    set(0, right_, forward_, x, height_unit + aspect_unit, view_.shift_x);
    set(2, up_, forward_, y, height_unit, view_.shift_y);
    return;
  }
  before_eye_ = {0, 0, 1};
  const Whole volume = abs(dot(cross(right_, up_), forward_));
  const int unit = axis_unit_ - position_unit_ + height_unit;
  set(0, {1, 0, 0}, before_eye_, x * volume, unit + aspect_unit, view_.shift_x);
  set(2, {0, 1, 0}, before_eye_, y * volume, unit, view_.shift_y);
}

inline ExactSight::Vec ExactSight::image(const Vec& from_eye, const Whole& unit) const {
  if (!view_.orthographic) {
    return from_eye;
  }
  const int turned = dot(cross(right_, up_), forward_).sign();
  return {dot(from_eye, cross(up_, forward_)) * turned, dot(from_eye, cross(forward_, right_)) * turned,
          unit};
}

inline void ExactSight::addTriangle(std::span<const Vec3f, 3> corners, const Material& material,
                                    ObjectId object) {
  std::array<Vec, 3> from_eye, d;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!isFinite(corners[i])) {
      return;
    }
    from_eye[i] = add(whole(Vec3d(corners[i]), position_unit_), times(eye_, -1));
    d[i] = image(from_eye[i], 1);
  }
  Triangle triangle;
  triangle.object = object;
  triangle.opaque = material.opaque();
  triangle.volume = dot(d[0], cross(d[1], d[2]));
  const int sign = triangle.volume.sign();
  const Vec normal =
      cross(add(from_eye[1], times(from_eye[0], -1)), add(from_eye[2], times(from_eye[0], -1)));
  const int facing = view_.orthographic ? -side(normal, forward_) : -side(normal, from_eye[0]);
  if (sign == 0 || facing == 0 || (facing < 0 && !material.double_sided)) {
    return;
  }
  triangle.volume *= sign;
  triangle.scale = triangle.depth = {0, 0, 0};
  for (std::size_t i = 0; i < 3; ++i) {
    triangle.edges[i] = times(cross(d[(i + 1) % 3], d[(i + 2) % 3]), sign);
    triangle.scale = add(triangle.scale, triangle.edges[i]);
    triangle.depth = add(triangle.depth, times(triangle.edges[i], dot(from_eye[i], forward_)));
  }
  triangle.beyond_near = beyond(triangle, view_.z_near);
  triangle.before_far = std::isfinite(view_.z_far) ? times(beyond(triangle, view_.z_far), -1) : Vec{0, 0, 0};
  triangles_.push_back(triangle);
}

// n . d >= 0 where the triangle is at least this deep.
inline ExactSight::Vec ExactSight::beyond(const Triangle& triangle, double depth) const {
  const int unit = unitOf(depth), shift = unit - position_unit_ - axis_unit_;
  return add(times(triangle.depth, power(std::max(-shift, 0))),
             times(triangle.scale, -whole(depth, unit) * power(std::max(shift, 0))));
}

inline ExactSight::Target ExactSight::targetOf(const Triangle& triangle) const {
  Target target{&triangle, {}};
  for (const Triangle& other : triangles_) {
    if (&other != &triangle && other.opaque) {
      // In a perspective view depth . d = volume (forward . d); in an orthographic one scale . d = volume.
      const Vec behind = view_.orthographic
                             ? add(times(other.depth, triangle.volume), times(triangle.depth, -other.volume))
                             : add(times(triangle.scale, other.volume), times(other.scale, -triangle.volume));
      target.blockers.push_back({&other, behind});
    }
  }
  return target;
}

inline std::vector<ExactSight::Vec> ExactSight::linesOf(const Target& target) const {
  std::vector<Vec> lines(picture_.begin(), picture_.end());
  const auto addLine = [&](const Vec& line) {
    const auto isSame = [&](const Vec& other) { return cross(line, other).isZero(); };
    if (!line.isZero() && std::none_of(lines.begin(), lines.end(), isSame)) {
      lines.push_back(line);
    }
  };
  addLine(target.triangle->before_far);
  const auto addTriangleLines = [&](const Triangle& triangle) {
    for (const Vec& edge : triangle.edges) {
      addLine(edge);
    }
    addLine(triangle.beyond_near);
  };
  addTriangleLines(*target.triangle);
  for (const Blocker& blocker : target.blockers) {
    addTriangleLines(*blocker.triangle);
    addLine(blocker.behind);
  }
  return lines;
}

inline bool ExactSight::isInside(const Triangle& triangle, const Vec& d) const {
  return std::all_of(triangle.edges.begin(), triangle.edges.end(),
                     [&](const Vec& edge) { return side(edge, d) >= 0; }) &&
         side(triangle.beyond_near, d) >= 0;
}

inline bool ExactSight::isSeen(const Target& target, const Vec& d) const {
  return side(before_eye_, d) > 0 && isInside(*target.triangle, d) &&
         side(target.triangle->before_far, d) >= 0 &&
         std::all_of(picture_.begin(), picture_.end(), [&](const Vec& line) { return side(line, d) >= 0; }) &&
         std::none_of(target.blockers.begin(), target.blockers.end(), [&](const Blocker& blocker) {
           return side(blocker.behind, d) < 0 && isInside(*blocker.triangle, d);
         });
}

inline bool ExactSight::showsAnything(const Target& target) const {
  const std::vector<Vec> lines = linesOf(target);
  // A step of one beside a direction times 2^shift crosses no line that does not run through the direction.
  Whole largest = 1;
  for (const Vec& line : lines) {
    largest = std::max({largest, Whole(abs(line.x)), Whole(abs(line.y)), Whole(abs(line.z))});
  }
  const unsigned shift = 2u * static_cast<unsigned>(msb(largest) + 1) + 4u;
  for (std::size_t line = 0; line < lines.size(); ++line) {
    if (showsAnythingAlong(target, lines, line, shift)) {
      return true;
    }
  }
  return false;
}

inline bool ExactSight::showsAnythingAlong(const Target& target, const std::vector<Vec>& lines,
                                           std::size_t line, unsigned shift) const {
  const Vec& along = lines[line];
  const auto mayShow = [&](const Vec& d) {
    return std::all_of(target.triangle->edges.begin(), target.triangle->edges.end(),
                       [&](const Vec& edge) { return side(edge, d) >= 0; }) &&
           std::all_of(picture_.begin(), picture_.end(),
                       [&](const Vec& border) { return side(border, d) >= 0; });
  };
  std::vector<Vec> crossings;
  for (std::size_t other = 0; other < lines.size(); ++other) {
    Vec d = cross(along, lines[other]);
    const int before_eye = side(before_eye_, d);
    if (before_eye == 0) {
      continue;  // the same line, or a crossing that is infinitely far away
    }
    d = times(d, before_eye);
    if (mayShow(d)) {
      if (isSeen(target, d)) {
        return true;
      }
      crossings.push_back(d);
    }
  }
  std::sort(crossings.begin(), crossings.end(),
            [&](const Vec& a, const Vec& b) { return side(along, cross(a, b)) > 0; });
  for (std::size_t i = 0; i + 1 < crossings.size(); ++i) {
    if (cross(crossings[i], crossings[i + 1]).isZero()) {
      continue;
    }
    const Vec between = add(crossings[i], crossings[i + 1]), far = times(between, Whole(1) << shift);
    if (isSeen(target, between) || isSeen(target, add(far, along)) ||
        isSeen(target, add(far, times(along, -1)))) {
      return true;
    }
  }
  return false;
}

inline bool ExactSight::isVisible(ObjectId object) const {
  return std::any_of(triangles_.begin(), triangles_.end(), [&](const Triangle& triangle) {
    return triangle.object == object && showsAnything(targetOf(triangle));
  });
}

inline bool ExactSight::reaches(const Vec3d& point, ObjectId object) const {
  const int unit = std::min(position_unit_, unitOf(point));
  const Whole finer = power(position_unit_ - unit);
  const Vec d = image(add(whole(point, unit), times(eye_, -finer)), finer);
  return (!view_.orthographic || side(forward_, add(whole(point, unit), times(eye_, -finer))) > 0) &&
         std::any_of(triangles_.begin(), triangles_.end(), [&](const Triangle& triangle) {
           return triangle.object == object && isSeen(targetOf(triangle), d);
         });
}

}  // namespace sightline::test
