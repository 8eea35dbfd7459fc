#pragma once

// Random scenes at the limits of every tolerance in docs/conservative.md: cracks, slits, lattices, walls of
// touching boxes, folds, sharp corners, grazing and short edges, surfaces just behind each other. The objects
// to be culled are small and stand where only a line of sight close beside an edge of an occluder reaches
// them.

#include <array>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "sightline/scene/scene.h"

namespace sightline::test {

struct HostileScene {
  std::string family;
  Scene scene;
  std::vector<View> views;           // in the order in which they are to be culled
  std::vector<ObjectId> may_move{};  // occluders that may be given as moving ones
  std::uint32_t first_target = 0;    // the objects from here on are to be culled
};

// The same seed makes the same scene with one compiler on one kind of machine: in which order the arguments
// of a call are drawn is the compiler's choice, and GCC chooses another one for ARM than for x86.
class HostileSceneMaker {
 public:
  explicit HostileSceneMaker(std::uint64_t seed) : random_(seed), of_contacts_(seed % 15 == 14) {}

  HostileScene make();

 private:
  using Triangles = std::vector<Vec3d>;  // three corners each
  struct Family {
    const char* name;
    void (HostileSceneMaker::*build)();
  };
  static const std::vector<Family>& families();

  double in(double low, double high) {
    return low + (high - low) * static_cast<double>(random_() >> 11) * 0x1p-53;
  }
  int below(int count) { return static_cast<int>(random_() % static_cast<std::uint64_t>(count)); }
  bool chance(int one_in) { return below(one_in) == 0; }
  double sign() { return chance(2) ? 1.0 : -1.0; }
  // It has all sizes, from a rounding of double precision to a quarter.
  double tiny() { return std::exp2(in(-52.0, -2.0)); }
  // Around a tolerance.
  double around(int exponent) { return std::exp2(exponent + in(-3.0, 3.0)); }
  double tinyOrNone() { return chance(3) ? 0.0 : sign() * tiny(); }

  // The eye is at the origin and looks along -z; lengths are in metres. Both are turned, moved and scaled
  // later.
  void quad(Triangles& to, const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d);
  void grid(Triangles& to, const Vec3d& origin, const Vec3d& u, const Vec3d& v, int columns, int rows,
            double bump, int holes);
  void box(Triangles& to, const Vec3d& low, const Vec3d& high, bool inwards = false, int without = -1);
  void addOccluder(const Triangles& triangles) { occluders_.push_back(triangles); }

  void slit();
  void wedge();
  void corner();
  void bricks();
  void lattice();
  void patchwork();
  void fan();
  void bodies();
  void grazing();
  void soup();
  void city();
  void room();
  void stack();
  void junction();
  void contacts();

  Vec3d pointNearAnEdge();
  void addTargets();
  void place(HostileScene& made);
  void addViews(HostileScene& made);
  void shiftViews(HostileScene& made);

  std::mt19937_64 random_;
  // One more family, by the seed itself: other seeds keep the scenes in which they have found mistakes.
  const bool of_contacts_;
  std::vector<Triangles> occluders_, targets_;
  std::vector<Vec3d> critical_;       // points around which targets gather
  Vec3d right_, up_, back_, offset_;  // of the eye's axes, scene space
  double scale_ = 1.0;
};

inline void HostileSceneMaker::quad(Triangles& to, const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                    const Vec3d& d) {
  if (chance(2)) {
    to.insert(to.end(), {a, b, c, a, c, d});
  } else {
    to.insert(to.end(), {a, b, d, b, c, d});
  }
}

// Cells of a parallelogram, whose inner vertices may be off its plane by `bump`.
inline void HostileSceneMaker::grid(Triangles& to, const Vec3d& origin, const Vec3d& u, const Vec3d& v,
                                    int columns, int rows, double bump, int holes) {
  const Vec3d normal = normalized(cross(u, v));
  std::vector<Vec3d> points;
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      points.push_back(origin + u * (double(c) / columns) + v * (double(r) / rows) +
                       normal * (chance(3) ? bump * in(-1, 1) : 0.0));
    }
  }
  const auto at = [&](int c, int r) { return points[static_cast<std::size_t>(r * (columns + 1) + c)]; };
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      if (below(columns * rows) >= holes) {
        quad(to, at(c, r), at(c + 1, r), at(c + 1, r + 1), at(c, r + 1));
      }
    }
  }
}

inline void HostileSceneMaker::box(Triangles& to, const Vec3d& low, const Vec3d& high, bool inwards,
                                   int without) {
  const auto at = [&](int corner) {
    return Vec3d((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                 (corner & 4) != 0 ? high.z : low.z);
  };
  constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
  for (int face = 0; face < 6; ++face) {
    const int* f = kFaces[face];
    if (face != without) {
      if (inwards) {
        quad(to, at(f[0]), at(f[3]), at(f[2]), at(f[1]));
      } else {
        quad(to, at(f[0]), at(f[1]), at(f[2]), at(f[3]));
      }
    }
  }
}

// Two walls with a gap between them, side by side or one behind the other, at any angle.
inline void HostileSceneMaker::slit() {
  const double depth = -in(2, 8), gap = std::abs(depth) * tinyOrNone(),
               behind = depth - (chance(2) ? 0.0 : tiny());
  const double angle = chance(2) ? 0.0 : in(0, 3), x = chance(2) ? 0.0 : in(-1, 1), size = in(2, 20);
  const Vec3d across(std::cos(angle), std::sin(angle), 0), along(-std::sin(angle), std::cos(angle), 0);
  const Vec3d left(across * (x - size) - along * size + Vec3d(0, 0, depth)),
      right(across * (x + gap) - along * size + Vec3d(0, 0, behind));
  Triangles walls;
  const int cells = 1 + below(3);
  grid(walls, left, across * size, along * (2 * size), 1 + below(2), cells, 0.0, 0);
  if (chance(2)) {
    addOccluder(walls);
    walls.clear();
  }
  grid(walls, right, across * size, along * (2 * size), 1 + below(2), chance(2) ? cells : 1 + below(3), 0.0,
       0);
  addOccluder(walls);
}

// A crack between two walls that closes where they share a vertex.
inline void HostileSceneMaker::wedge() {
  const double depth = -in(2, 8), size = in(2, 10), gap = std::abs(depth) * tiny();
  const Vec3d tip(in(-0.5, 0.5), in(-1, 1), depth + (chance(2) ? 0.0 : in(-0.5, 0.5)));
  const Vec3d low(tip.x, -size, depth), high(tip.x, size, depth),
      other(tip.x + gap, size, depth - tinyOrNone());
  critical_.push_back(tip);
  Triangles walls{Vec3d(-size, -size, depth), low, tip,
                  Vec3d(-size, -size, depth), tip, Vec3d(-size, size, depth),
                  Vec3d(-size, size, depth),  tip, high};
  if (chance(3)) {
    addOccluder(walls);
    walls.clear();
  }
  const Vec3d far_low(size, -size, depth - in(-1, 1)), far_high(size, size, depth - in(-1, 1));
  walls.insert(walls.end(), {low, far_low, tip, tip, far_low, far_high, tip, far_high, other});
  addOccluder(walls);
}

// Walls that share an edge, whose vertices lie on it up to rounding or a little more.
inline void HostileSceneMaker::corner() {
  const double depth = -in(2, 6), size = in(2, 8);
  const int pieces = 1 + below(4);
  const double ulps = chance(2) ? 0.0 : std::exp2(-24 + below(8));
  std::vector<Vec3d> edge;
  for (int i = 0; i <= pieces; ++i) {
    edge.emplace_back((i > 0 && i < pieces ? in(-ulps, ulps) : 0.0), -size + 2 * size * i / pieces,
                      depth + (i > 0 && i < pieces ? in(-ulps, ulps) : 0.0));
  }
  critical_.insert(critical_.end(), edge.begin(), edge.end());
  Triangles walls;
  const int sides = 2 + below(2);
  for (int s = 0; s < sides; ++s) {
    const double away = s == 0 ? -size : s == 1 ? size : in(-1, 1) * size;
    const double turn = chance(3) ? in(-1, 1) * std::exp2(-in(0, 20)) : in(-2, 2);
    const int first = chance(4) ? below(pieces) : 0;
    // Perhaps a gap that begins at a vertex of the edge.
    const int parting = chance(2) ? 1 + below(pieces) : 2 * pieces;
    const double parted = size * (chance(2) ? in(0.0, 0.3) : tiny()), turn_beyond = turn + in(-1, 1);
    for (int i = first; i < pieces; ++i) {
      const Vec3d a = edge[std::size_t(i)], b = edge[std::size_t(i) + 1];
      const double depth_there = i < parting ? turn : turn_beyond;
      const Vec3d c = b + Vec3d(away, i == parting - 1 ? -parted : 0.0, depth_there),
                  d = a + Vec3d(away, i == parting ? parted : 0.0, depth_there);
      if (away < 0) {
        quad(walls, a, b, c, d);
      } else {
        quad(walls, b, a, d, c);
      }
    }
    if (chance(3)) {
      addOccluder(walls);
      walls.clear();
    }
  }
  addOccluder(walls);
}

// A wall of boxes that touch, overlap or stand a little apart.
inline void HostileSceneMaker::bricks() {
  const int columns = 2 + below(4), rows = 2 + below(4);
  const double depth = -in(3, 8), size = in(0.5, 3), looseness = chance(2) ? 0.0 : tiny();
  Triangles all;
  const bool single = chance(2), shifted = chance(2);
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const Vec3d low((c - columns / 2.0 + (shifted && r % 2 == 1 ? 0.5 : 0.0)) * size,
                      (r - rows / 2.0) * size, depth - 1);
      const Vec3d loose(looseness * in(-1, 1), looseness * in(-1, 1), looseness * in(-1, 1));
      box(all, low + loose, low + Vec3d(size, size, 1), false, chance(8) ? below(6) : -1);
      if (!single) {
        addOccluder(all);
        all.clear();
      }
    }
  }
  addOccluder(all);
}

inline void HostileSceneMaker::lattice() {
  const int bars = 2 + below(5);
  const double depth = -in(2, 8), pitch = in(0.2, 2), hole = pitch * (chance(3) ? 0.5 : tiny());
  Triangles all;
  for (int layer = 0; layer < 2; ++layer) {
    for (int i = -bars; i <= bars; ++i) {
      const Vec3d u = layer == 0 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0),
                  v = layer == 0 ? Vec3d(0, 1, 0) : Vec3d(-1, 0, 0);
      const double z = depth - layer * (chance(2) ? 0.0 : tiny());
      grid(all, u * (i * pitch) - v * (bars * pitch) + Vec3d(0, 0, z), u * (pitch - hole),
           v * (2 * bars * pitch), 1, 1 + below(2), 0.0, 0);
    }
  }
  addOccluder(all);
}

// A surface of nearly coplanar cells, of which some are missing.
inline void HostileSceneMaker::patchwork() {
  Triangles all;
  const double depth = -in(2, 6), size = in(1, 8),
               bump = chance(2)   ? around(-22) * -depth
                      : chance(2) ? tiny()
                                  : 0.0;
  const Vec3d tilt_u(0, 0, chance(2) ? 0.0 : in(-1, 1)), tilt_v(0, 0, chance(2) ? 0.0 : in(-1, 1));
  const int columns = 1 + below(6), rows = 1 + below(6);
  grid(all, {-size, -size, depth}, Vec3d(2 * size, 0, 0) + tilt_u, Vec3d(0, 2 * size, 0) + tilt_v, columns,
       rows, bump, below(3));
  addOccluder(all);
}

// Triangles around a vertex, with corners of about three degrees, and perhaps a gap between two of them.
inline void HostileSceneMaker::fan() {
  const double depth = -in(2, 6), size = in(1, 6), start = in(0, 6.28);
  const Vec3d tip(in(-0.5, 0.5), in(-0.5, 0.5), depth + in(-0.5, 0.5) * below(2));
  Triangles all;
  double angle = start;
  const int gap = below(12);
  const double pleat = chance(3) ? 0.0 : in(-1, 1), half = chance(3) ? in(0.2, 0.8) : std::exp2(-in(2, 22));
  critical_.push_back(tip);
  std::vector<Vec3d> rim;
  for (int i = 0; i < 40 && angle < start + 6.2; ++i) {
    rim.emplace_back(std::cos(angle) * size, std::sin(angle) * size, depth + (i % 2 == 0 ? pleat : 0.0));
    angle += chance(2) ? in(0.2, 4.0) * 0.0174533 : in(0.05, 1.0);
  }
  const bool whole = chance(3);
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const Vec3d &p = rim[i], &q = rim[(i + 1) % rim.size()];
    if (int(i) == gap) {
      continue;
    }
    if (whole) {
      all.insert(all.end(), {tip, p, q});
    } else {
      // Vertices along the edges, which rounding moves off them.
      const Vec3d a = tip + (p - tip) * half, b = tip + (q - tip) * half;
      all.insert(all.end(), {tip, a, b, a, p, q, a, q, b});
    }
  }
  addOccluder(all);
}

inline void HostileSceneMaker::bodies() {
  const int count = 1 + below(4);
  for (int b = 0; b < count; ++b) {
    Vec3d middle(in(-2, 2), in(-2, 2), -in(2, 8));
    const Vec3d half(in(0.1, 2), in(0.1, 2), in(0.1, 1.5));
    if (chance(3)) {  // one face is seen nearly edge on
      middle.y = half.y + sign() * (chance(2) ? around(-10) : tiny());
    }
    Triangles all;
    if (chance(2)) {
      box(all, middle - half, middle + half, false, chance(3) ? below(6) : -1);
    } else {
      const int sides = 3 + below(4);
      std::vector<Vec3d> ring;
      for (int i = 0; i < sides; ++i) {
        const double a = 6.2831853 * i / sides;
        ring.emplace_back(middle.x + half.x * std::cos(a), middle.y - half.y,
                          middle.z + half.z * std::sin(a));
      }
      const Vec3d top(middle.x, middle.y + half.y, middle.z);
      for (int i = 0; i < sides; ++i) {
        const Vec3d &p = ring[std::size_t(i)], &q = ring[std::size_t((i + 1) % sides)];
        all.insert(all.end(), {q, p, top});
        if (i > 0 && i + 1 < sides) {
          all.insert(all.end(), {ring[0], p, q});
        }
      }
    }
    if (chance(3)) {
      const Vec3d from = all[std::size_t(below(int(all.size())))],
                  to = from + Vec3d(in(-1, 1), in(-1, 1), in(-1, 1)) * tiny();
      for (Vec3d& p : all) {
        p = p == from ? to : p;
      }
    }
    addOccluder(all);
  }
}

// Walls seen at a grazing angle, short edges, slivers.
inline void HostileSceneMaker::grazing() {
  const int walls = 1 + below(4);
  for (int w = 0; w < walls; ++w) {
    Triangles all;
    const double x = in(-1, 1), depth = in(1, 6), sine = chance(2) ? around(-10) : std::exp2(-in(4, 30));
    const int kind = below(3);
    if (kind == 0) {
      grid(all, {-depth * sine, -2, -depth}, Vec3d(0.002, 0, -in(1, 5)), Vec3d(0, 4, 0), 1, 1 + below(3), 0.0,
           0);
    } else if (kind == 1) {
      const double edge = depth * (chance(2) ? around(-20) : std::exp2(-in(8, 36)));
      all = {Vec3d(x, -3, -depth), Vec3d(x + edge, -3, -depth), Vec3d(in(-3, 3), 3, -depth)};
      quad(all, {x + edge, -3, -depth}, {4, -3, -depth}, {4, 3, -depth}, all[2]);
    } else {
      const double thin = depth * tiny();
      grid(all, {-3, x, -depth}, Vec3d(6, 0, 0), Vec3d(0, thin, 0), 1 + below(2), 1, 0.0, 0);
      grid(all, {-3, x + thin, -depth}, Vec3d(6, 0, 0), Vec3d(0, 3, 0), 1 + below(2), 1, 0.0, 0);
    }
    addOccluder(all);
  }
}

// Triangles with small whole coordinates: coplanar, doubled, folded and interpenetrating ones.
inline void HostileSceneMaker::soup() {
  std::vector<Vec3d> pool;
  const int count = 5 + below(8);
  for (int i = 0; i < count; ++i) {
    pool.emplace_back(below(9) - 4, below(9) - 4, -2 - below(4));
  }
  const int objects = 1 + below(4);
  for (int o = 0; o < objects; ++o) {
    Triangles all;
    const int triangles = 1 + below(6);
    for (int t = 0; t < 3 * triangles; ++t) {
      all.push_back(pool[std::size_t(below(count))]);
    }
    addOccluder(all);
  }
}

inline void HostileSceneMaker::city() {
  const int count = 3 + below(12);
  for (int i = 0; i < count; ++i) {
    Triangles all;
    const Vec3d low(in(-6, 6), -1, -in(1, 14));
    box(all, low, low + Vec3d(in(0.3, 3), in(0.5, 4), in(0.3, 3)));
    addOccluder(all);
  }
}

// The eye is inside a room whose walls have a slit.
inline void HostileSceneMaker::room() {
  Triangles all;
  const Vec3d low(-in(1, 4), -in(1, 2), -in(2, 6)), high(in(1, 4), in(1, 2), in(1, 3));
  const int open = below(6);
  box(all, low, high, true, open);
  if (chance(2)) {
    addOccluder(all);
    all.clear();
  }
  const double gap = tinyOrNone();
  grid(all, {low.x, low.y, low.z}, Vec3d(-low.x + gap, 0, 0), Vec3d(0, high.y - low.y, 0), 1, 1, 0.0, 0);
  grid(all, {0, low.y, low.z - tinyOrNone()}, Vec3d(high.x, 0, 0), Vec3d(0, high.y - low.y, 0), 1, 1, 0.0, 0);
  addOccluder(all);
}

// Walls close behind each other.
inline void HostileSceneMaker::stack() {
  double depth = -in(2, 6);
  const int count = 2 + below(4);
  for (int i = 0; i < count; ++i) {
    Triangles all;
    const double size = in(1, 6);
    grid(all, {-size, -size + tinyOrNone(), depth}, Vec3d(2 * size, 0, chance(3) ? tinyOrNone() : 0),
         Vec3d(0, 2 * size, 0), 1 + below(2), 1 + below(2), 0.0, 0);
    addOccluder(all);
    depth -= chance(3) ? 0.0 : tiny() * 4;
  }
}

// Three walls that meet in a corner, of which two have no mesh edge in common, seen nearly level.
inline void HostileSceneMaker::junction() {
  const double x = in(0.5, 2), y = -in(0.5, 2), depth = -in(1.5, 4), left = -in(0.5, 3), top = in(0.5, 2),
               front = -in(0.1, 1);
  const double tilt = sign() * std::exp2(-in(12, 26)), part = in(0.2, 0.8);
  const auto at = [&](double px, double py, double pz) { return Vec3d(px, py + tilt * px, pz); };
  const Vec3d corner = at(x, y, depth),
              middle = at(left + part * (x - left), y, depth) + Vec3d(0, tinyOrNone() * 1e-3, 0);
  Triangles back{at(left, y, depth),
                 middle,
                 at(left, top, depth),
                 middle,
                 corner,
                 at(x, top, depth),
                 middle,
                 at(x, top, depth),
                 at(left, top, depth)};
  Triangles walls;
  quad(walls, corner, at(x, y, front), at(x, top, front), at(x, top, depth));
  quad(walls, at(left, y, depth), at(left, y, front), at(x, y, front), corner);
  walls.insert(walls.end(), back.begin(), back.end());
  addOccluder(walls);
  for (int i = 0; i < 8; ++i) {
    const double size = length(corner) * std::exp2(-in(10, 30));
    const Vec3d towards = corner + (middle - corner) * (chance(2) ? 0.0 : tiny()) +
                          Vec3d(in(-1, 1), in(-1, 1), 0) * (chance(2) ? 0.0 : size);
    const Vec3d behind = towards * in(1.05, 6);
    targets_.push_back(
        {behind + Vec3d(-size, -size, 0), behind + Vec3d(size, -size, 0), behind + Vec3d(0, size, 0)});
  }
}

// Rows of panels whose corners lie on the edges of other rows, on a slab, with boxes that stand on it, stand
// against the panels or are pushed through them. No mesh edge is shared, but for scales and turns all
// contacts are exact; or one corner is off by a unit in the last place, which is a crack.
inline void HostileSceneMaker::contacts() {
  const auto eighths = [&](int low, int high) { return (low + below(high - low + 1)) / 8.0; };
  const double depth = -eighths(24, 64), left = -eighths(8, 32), bottom = -eighths(8, 16);
  const int rows = 2 + below(3), moved = chance(2) ? -1 : below(4 * rows);
  int number = 0;
  double y = bottom;
  for (int row = 0; row < rows; ++row) {
    const double top = y + eighths(4, 16);
    double x = left - eighths(0, 4);
    while (x < -left) {
      const double next = x + eighths(4, 20);
      std::array corners{Vec3d(x, y, depth), Vec3d(next, y, depth), Vec3d(next, top, depth),
                         Vec3d(x, top, depth)};
      if (number++ == moved) {
        Vec3d& corner = corners[std::size_t(below(4))];
        double& coordinate = chance(3) ? corner.z : chance(2) ? corner.y : corner.x;
        coordinate = std::nextafterf(static_cast<float>(coordinate), chance(2) ? 1e9f : -1e9f);
        critical_.push_back(corner);
      } else if (chance(3)) {
        critical_.push_back(corners[std::size_t(below(4))]);
      }
      Triangles panel;
      quad(panel, corners[0], corners[1], corners[2], corners[3]);
      addOccluder(panel);
      x = next;
    }
    y = top;
  }
  Triangles slab;
  const double front = -eighths(1, 16);
  quad(slab, {left - 1, bottom, front}, {-left + 1, bottom, front}, {-left + 1, bottom, depth - 1},
       {left - 1, bottom, depth - 1});
  addOccluder(slab);
  const int boxes = below(4);
  for (int i = 0; i < boxes; ++i) {
    const double x = left + eighths(0, 32), size = eighths(2, 8), reach = eighths(0, 1) * 4;
    Triangles all;  // against the panels or through them
    box(all, {x, bottom, depth - size}, {x + size, bottom + size, depth + reach});
    addOccluder(all);
    critical_.emplace_back(x, bottom + size, depth);
  }
}

inline const std::vector<HostileSceneMaker::Family>& HostileSceneMaker::families() {
  static const std::vector<Family> kAll = {
      {"slit", &HostileSceneMaker::slit},       {"wedge", &HostileSceneMaker::wedge},
      {"corner", &HostileSceneMaker::corner},   {"bricks", &HostileSceneMaker::bricks},
      {"lattice", &HostileSceneMaker::lattice}, {"patchwork", &HostileSceneMaker::patchwork},
      {"fan", &HostileSceneMaker::fan},         {"bodies", &HostileSceneMaker::bodies},
      {"grazing", &HostileSceneMaker::grazing}, {"soup", &HostileSceneMaker::soup},
      {"city", &HostileSceneMaker::city},       {"room", &HostileSceneMaker::room},
      {"stack", &HostileSceneMaker::stack},     {"junction", &HostileSceneMaker::junction},
  };
  return kAll;
}

// A point beside an edge of an occluder, at a distance of any size, or within a triangle.
inline Vec3d HostileSceneMaker::pointNearAnEdge() {
  if (!critical_.empty() && chance(2)) {
    const Vec3d& point = critical_[std::size_t(below(int(critical_.size())))];
    return point + Vec3d(in(-1, 1), in(-1, 1), in(-0.1, 0.1)) * (length(point) * std::exp2(-in(6, 40)));
  }
  const Triangles& triangles = occluders_[std::size_t(below(int(occluders_.size())))];
  if (triangles.empty()) {
    return {in(-1, 1), in(-1, 1), -3};
  }
  const std::size_t first = 3 * std::size_t(below(int(triangles.size() / 3)));
  const std::size_t i = std::size_t(below(3));
  const Vec3d &a = triangles[first + i], &b = triangles[first + (i + 1) % 3],
              &c = triangles[first + (i + 2) % 3];
  const double along = chance(4) ? (chance(2) ? tiny() : 1 - tiny()) : chance(4) ? below(2) : in(0, 1);
  const Vec3d point = a + (b - a) * along;
  const double beside = chance(6) ? 0.0 : sign() * tiny();
  return point + (chance(2) ? (c - point) * beside : Vec3d(in(-1, 1), in(-1, 1), in(-1, 1)) * beside);
}

// Small objects behind, on and just behind points near edges, and some anywhere.
inline void HostileSceneMaker::addTargets() {
  const int count = 16 + below(17);
  for (int i = 0; i < count; ++i) {
    const Vec3d near = pointNearAnEdge();
    const int kind = below(8);
    const double further = kind == 0   ? 1.0
                           : kind <= 2 ? 1.0 + tiny()
                           : kind == 3 ? 1.0 + around(-32)
                                       : in(1.05, 6);
    const Vec3d middle = kind == 7 ? Vec3d(in(-4, 4), in(-4, 4), -in(1, 20)) : near * further;
    const double size = length(middle) * (chance(3) ? in(0.01, 0.2) : tiny());
    Triangles target;
    switch (below(4)) {
      case 0:
        box(target, middle - Vec3d(size, size, size), middle + Vec3d(size, size, size));
        break;
      case 1:  // across the line of sight
        target = {middle + Vec3d(-size, -size, 0), middle + Vec3d(size, -size, 0),
                  middle + Vec3d(0, size, 0)};
        break;
      case 2: {  // a corner on the line of sight, the rest behind it
        const Vec3d back = middle * (0.1 * in(0, 1));
        target = {middle, middle + back + Vec3d(size, -size, 0), middle + back + Vec3d(size, size, 0)};
        break;
      }
      default:
        for (int corner = 0; corner < 3; ++corner) {
          target.push_back(middle + Vec3d(in(-size, size), in(-size, size), in(-size, size)));
        }
    }
    targets_.push_back(target);
  }
}

// Rounds all to single precision in scene space and makes objects of it.
inline void HostileSceneMaker::place(HostileScene& made) {
  Scene& scene = made.scene;
  for (const Opacity opacity : {Opacity::kOpaque, Opacity::kBlended}) {
    for (const bool double_sided : {true, false}) {
      scene.materials.push_back({"", opacity, double_sided, {}});
    }
  }
  const auto add = [&](const Triangles& triangles, std::uint32_t material) {
    Object object;
    object.first_index = static_cast<std::uint32_t>(scene.indices.size());
    object.index_count = static_cast<std::uint32_t>(triangles.size());
    object.material = MaterialId(material);
    for (const Vec3d& p : triangles) {
      scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
      scene.positions.emplace_back((right_ * p.x + up_ * p.y + back_ * p.z) * scale_ + offset_);
    }
    scene.objects.push_back(object);
    scene.object_names.push_back("object " + std::to_string(scene.objects.size() - 1));
  };
  const bool double_sided = chance(2);
  for (const Triangles& triangles : occluders_) {
    if (chance(4)) {
      made.may_move.emplace_back(scene.objects.size());
    }
    add(triangles, chance(16) ? 2u : double_sided ? 0u : 1u);
  }
  made.first_target = static_cast<std::uint32_t>(scene.objects.size());
  for (const Triangles& triangles : targets_) {
    add(triangles, chance(8) ? 2u : 0u);
  }
  weldPositions(scene);
  updateBounds(scene);
}

inline void HostileSceneMaker::addViews(HostileScene& made) {
  View view;
  view.eye = offset_;
  view.right = right_;
  view.up = up_;
  view.forward = -back_;
  view.orthographic = chance(4);
  view.tan_half_fovy = chance(4) ? in(0.05, 3) : 1.0;
  view.ortho_height = scale_ * in(2, 20);
  view.aspect = chance(2) ? 1.0 : in(0.3, 3);
  view.z_near = scale_ * (chance(3) ? in(0.001, 0.1) : 0.1);
  view.z_far =
      chance(4) ? std::numeric_limits<double>::infinity() : scale_ * (chance(3) ? in(4, 20) : in(20, 1000));
  const auto depthOf = [&](const Vec3f& p) { return dot(Vec3d(p) - view.eye, view.forward); };
  if (!made.scene.positions.empty() && chance(3)) {
    const double depth = depthOf(made.scene.positions[std::size_t(below(int(made.scene.positions.size())))]);
    if (depth > 1e-3 * scale_ && depth < 8 * scale_) {
      view.z_near = depth * (1 + tinyOrNone());
      view.z_far = std::max(view.z_far, 2 * view.z_near);
    }
  }
  made.views.push_back(view);
  for (int i = 0; i < 2; ++i) {
    const double step = chance(2) ? tiny() : in(0, 0.5);
    view.eye = view.eye + (right_ * in(-1, 1) + up_ * in(-1, 1) + back_ * in(-1, 1)) * (step * scale_);
    made.views.push_back(view);
  }
  // In the plane of a triangle or at a vertex, up to rounding.
  if (!made.scene.indices.empty()) {
    const auto corner = [&](std::size_t i) { return Vec3d(made.scene.positions[made.scene.indices[i]]); };
    const std::size_t first = 3 * std::size_t(below(int(made.scene.indices.size() / 3)));
    const Vec3d a = corner(first), b = corner(first + 1), c = corner(first + 2);
    const double s = chance(3) ? 0.0 : in(-2, 2), t = chance(3) ? 0.0 : in(-2, 2);
    view.eye = a + (b - a) * s + (c - a) * t + back_ * (scale_ * (chance(2) ? 0.0 : tiny()));
    made.views.push_back(view);
  }
  shiftViews(made);
}

// Makes some views off-centre: a little, as between the samples of a pixel, or so far that the forward axis
// is outside of the picture. Most objects stay in view.
inline void HostileSceneMaker::shiftViews(HostileScene& made) {
  if (!chance(3)) {
    return;
  }
  const auto shift = [&] { return chance(3) ? tinyOrNone() : chance(12) ? in(-30, 30) : in(-1.5, 1.5); };
  const double x = shift(), y = shift();
  const bool each = chance(3);  // as the tiles of a picture
  for (View& view : made.views) {
    view.shift_x = each ? shift() : x;
    view.shift_y = each ? shift() : y;
  }
}

inline HostileScene HostileSceneMaker::make() {
  HostileScene made;
  static constexpr Family kContacts{"contacts", &HostileSceneMaker::contacts};
  const Family& family = of_contacts_ ? kContacts : families()[std::size_t(below(int(families().size())))];
  made.family = family.name;
  (this->*family.build)();
  if (chance(6)) {
    const Family& more = families()[std::size_t(below(int(families().size())))];
    made.family += std::string(" and ") + more.name;
    (this->*more.build)();
  }
  addTargets();
  constexpr double kScales[] = {1.0, 1.0, 1.0, 0.0078125, 1e-4, 1e3, 1e6};
  scale_ = kScales[below(7)];
  right_ = {1, 0, 0};
  up_ = {0, 1, 0};
  if (chance(2)) {
    View turned;
    setOrientation(turned, {in(-1, 1), in(-1, 1), in(-1, 1)}, {in(-1, 1), 1, in(-1, 1)});
    right_ = turned.right;
    up_ = turned.up;
  }
  back_ = cross(right_, up_);
  const double away = scale_ * (chance(2) ? 0.0 : chance(2) ? 100.0 : 1e4);
  offset_ = Vec3d(in(-1, 1), in(-1, 1), in(-1, 1)) * away;
  place(made);
  addViews(made);
  return made;
}

}  // namespace sightline::test
