#pragma once

// Small scenes of a few polygons, made on purpose or at random, that the tests of occlusion structures share.

#include <random>
#include <span>
#include <string>
#include <vector>

#include "sightline/occluders/occluder_set.h"
#include "sightline/occlusion/occlusion_tree.h"
#include "tests/support/random_numbers.h"
#include "tests/support/visibility_oracle.h"

namespace sightline::test {

inline View viewFrom(const Vec3d& eye, const Vec3d& forward) {
  View view;
  view.eye = eye;
  setOrientation(view, forward, {0, 1, 0});
  view.z_near = 0.01;
  view.z_far = 1e4;
  view.tan_half_fovy = 1.0;
  view.aspect = 1.0;
  return view;
}

inline OccluderSet setOf(std::span<const OraclePolygon> polygons) {
  std::vector<OccluderPolygon> input;
  for (const OraclePolygon& polygon : polygons) {
    input.push_back({polygon.vertices, polygon.double_sided, ObjectId(0u)});
  }
  return makeOccluders(input);
}

inline std::vector<OccluderId> all(const OccluderSet& set) {
  std::vector<OccluderId> ids;
  for (std::size_t i = 0; i < set.occluders.size(); ++i) {
    ids.push_back(OccluderId(i));
  }
  return ids;
}

// Returns a wall that faces +z, with corners at the given z, from x0 to x1 and from y0 to y1.
inline OraclePolygon wall(float x0, float x1, float y0, float y1, float z) {
  return {{{x0, y0, z}, {x1, y0, z}, {x1, y1, z}, {x0, y1, z}}, false};
}

inline constexpr OcclusionTreeVariant kTreeVariants[] = {
    OcclusionTreeVariant::kFSE, OcclusionTreeVariant::kFSC, OcclusionTreeVariant::kFME,
    OcclusionTreeVariant::kFMC};

inline const View kLookingBack = viewFrom({0, 0, 0}, {0, 0, -1});

// Two walls with a gap that grows from a thousandth of a pixel to three (640 pixels high, 90 degrees: a pixel
// is 2 / 640 at unit distance), at many angles and offsets, and a box that is seen through it by
// kLookingBack. look(walls, box, what)
template <typename Look>
void forEachGap(Look&& look) {
  std::mt19937_64 random(7);
  for (const double pixels : {0.001, 0.3, 0.6, 0.9, 3.0}) {
    for (int turn = 0; turn < 60; ++turn) {
      const double angle = 0.11 * turn;
      const double gap = pixels * 2.0 / 640.0 * 5.0;
      const double offset = 0.003 * static_cast<double>(random() % 1000);
      const auto at = [&](double u, double v) {
        return Vec3f(static_cast<float>(std::cos(angle) * u - std::sin(angle) * v),
                     static_cast<float>(std::sin(angle) * u + std::cos(angle) * v), -5.0f);
      };
      const std::vector<OraclePolygon> walls{
          {{at(-40, -40), at(offset, -40), at(offset, 40), at(-40, 40)}, false},
          {{at(offset + gap, -40), at(40, -40), at(40, 40), at(offset + gap, 40)}, false}};
      const Vec3d middle = Vec3d(at(offset + 0.5 * gap, 0.0)) * 2.0;
      const Box box{Vec3f(middle - Vec3d(0.5, 0.5, 0.5)), Vec3f(middle + Vec3d(0.5, 0.5, 0.5))};
      look(walls, box, std::to_string(pixels) + " pixels, turn " + std::to_string(turn));
    }
  }
}

// Random scenes of families that are hard for floating point.
struct Family {
  const char* name;
  double scale;       // metres
  double far_offset;  // metres from the origin
  bool slivers;
};

inline OraclePolygon randomPolygon(Random& random, const Family& family, const Vec3d& around) {
  const Vec3d center = around + random.point(6.0) * family.scale;
  const Vec3d normal = normalized(random.point(1.0));
  const Vec3d u = normalized(cross(normal, Vec3d(0.3, 0.5, 0.8)));
  const Vec3d v = cross(normal, u);
  const int n = 3 + static_cast<int>(random.bits() % 4);
  const double a = random.in(0.5, 4.0) * family.scale;
  const double b =
      family.slivers && random.bits() % 2 ? a * random.in(1e-6, 1e-2) : random.in(0.5, 4.0) * family.scale;
  OraclePolygon polygon;
  const double start = random.in(0.0, 6.0);
  for (int i = 0; i < n; ++i) {
    const double t = start + 6.283185307179586 * i / n;
    polygon.vertices.push_back(Vec3f(center + u * (a * std::cos(t)) + v * (b * std::sin(t))));
  }
  polygon.double_sided = random.bits() % 2 == 0;
  return polygon;
}

// A fan of triangles or a row of walls, connected by shared vertices.
inline void addConnected(Random& random, const Family& family, const Vec3d& around,
                         std::vector<OraclePolygon>& polygons) {
  const Vec3d up(0, random.in(1, 4) * family.scale, 0);
  Vec3d at = around + random.point(4.0) * family.scale;
  const bool double_sided = random.bits() % 2 == 0;
  for (int i = 0; i < 5; ++i) {
    const Vec3d next = at + Vec3d(random.in(-2, 2), 0, random.in(-2, 2)) * family.scale;
    polygons.push_back({{Vec3f(at - up), Vec3f(next - up), Vec3f(next + up), Vec3f(at + up)}, double_sided});
    at = next;
  }
}

// Every structure is tested with these families.
inline const Family kFamilies[] = {{"metres", 1.0, 0.0, false},
                                   {"slivers", 1.0, 0.0, true},
                                   {"micrometres", 1e-6, 0.0, false},
                                   {"megametres", 1e6, 0.0, false},
                                   {"metres far from the origin", 1.0, 1e5, false},
                                   {"slivers far from the origin", 1.0, 1e6, true}};

// One view of a random scene: eight polygons of their own, five connected ones.
struct RandomScene {
  RandomScene(const Family& family, std::uint64_t seed) : random(seed) {
    origin = Vec3d(family.far_offset, 0.5 * family.far_offset, -family.far_offset);
    for (int i = 0; i < 8; ++i) {
      polygons.push_back(randomPolygon(random, family, origin));
    }
    addConnected(random, family, origin, polygons);
    view = viewFrom(origin + random.point(8.0) * family.scale, random.point(1.0));
    if (seed % 4 == 0) {
      // The eye on a vertex's coordinates: planes through it, edges through the eye's pixel.
      view.eye = Vec3d(polygons[0].vertices[0]) + Vec3d(0, 0, 1) * family.scale;
    }
    view.z_near = 0.01 * family.scale;
    view.z_far = 1e3 * family.scale;
    view.orthographic = seed % 3 == 0;
    view.ortho_height = 12.0 * family.scale;
    scale = family.scale;
  }
  Box randomBox() {
    const Vec3d c = origin + random.point(10.0) * scale;
    const Vec3d h = abs(random.point(random.in(0.01, 2.0))) * scale;
    return {Vec3f(c - h), Vec3f(c + h)};
  }

  Random random;
  Vec3d origin;
  double scale = 1.0;
  std::vector<OraclePolygon> polygons;
  View view;
};

}  // namespace sightline::test
