#pragma once

// Random convex occluders, trees of boxes and exact results, to test what the bake hides.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "sightline/hierarchy/box_tree.h"
#include "src/pvs/bake/convex/convex_occluder.h"
#include "src/pvs/bake/convex/shadow.h"
#include "src/pvs/bake/convex/shadow_tree.h"
#include "tests/occluders/flat_mesh.h"
#include "tests/support/solids.h"
#include "tests/support/wide_ray.h"

namespace sightline::test {

using flat_mesh::Random;
using pvs::ConvexOccluder;
using pvs::ConvexOccluders;
using pvs::ObjectRun;
using pvs::Shadow;
using pvs::ShadowTree;

// A polygon, or the faces of a closed body.
struct Shape {
  Solid solid;  // a polygon: one face
  bool double_sided = false;

  bool body() const { return solid.faces.size() > 1; }
};

inline OccluderSet setOf(std::span<const Shape> shapes) {
  std::vector<std::vector<Vec3f>> corners;
  std::vector<OccluderPolygon> polygons;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    for (std::size_t face = 0; face < shapes[i].solid.faces.size(); ++face) {
      corners.push_back(shapes[i].solid.polygon(face));
      polygons.push_back({{}, shapes[i].double_sided, ObjectId(i)});
    }
  }
  for (std::size_t i = 0; i < corners.size(); ++i) {
    polygons[i].vertices = corners[i];
  }
  return makeOccluders(polygons);
}

// True if the open segment from the eye to x hits a front face. Computed in 113-bit arithmetic.
inline bool blocks(const Shape& shape, const Vec3d& eye, const Vec3d& x) {
  const WideRay ray = WideRay::towards(eye, x);
  for (const std::vector<std::uint32_t>& face : shape.solid.faces) {
    for (std::size_t i = 1; i + 1 < face.size(); ++i) {
      const std::vector<Vec3f>& p = shape.solid.points;
      const std::optional<Wide> at =
          ray.intersect(p[face[0]], p[face[i]], p[face[i + 1]], shape.double_sided);
      if (at && *at > 0 && *at < 1) {
        return true;
      }
    }
  }
  return false;
}

inline Vec3d randomDirection(Random& random) {
  for (;;) {
    const Vec3d d = random.point(1.0);
    if (dot(d, d) > 0.01 && dot(d, d) < 1.0) {
      return normalized(d);
    }
  }
}

// Two perpendicular unit vectors.
inline void randomAxes(Random& random, bool upright, Vec3d& x, Vec3d& y) {
  if (upright) {
    x = {1, 0, 0};
    y = random.below(2) == 0 ? Vec3d(0, 1, 0) : Vec3d(0, 0, 1);
    return;
  }
  x = randomDirection(random);
  y = normalized(cross(x, randomDirection(random)));
}

// A polygon within `scale` of `origin`, or slightly beyond.
inline Shape randomPolygon(Random& random, const Vec3d& origin, double scale, bool sliver = false) {
  Shape shape;
  shape.double_sided = random.below(3) == 0;
  Vec3d x, y;
  randomAxes(random, random.below(4) == 0, x, y);
  const std::uint32_t count = 3 + random.below(random.below(4) == 0 ? 14 : 4);
  const double high = sliver ? 1e-4 : random.in(0.3, 1.0), turn = random.in(0.0, 6.0);
  shape.solid.faces.emplace_back();
  for (std::uint32_t i = 0; i < count; ++i) {
    const double t = turn + 6.283185307179586 * (i + random.in(-0.3, 0.3)) / count;
    shape.solid.points.emplace_back(origin + (x * std::cos(t) + y * (high * std::sin(t))) * scale);
    shape.solid.faces[0].push_back(i);
  }
  return shape;
}

inline Shape randomBody(Random& random, const Vec3d& origin, double scale, bool sliver = false) {
  Solid solid;
  switch (random.below(4)) {
    case 0:
      solid = tetrahedron();
      break;
    case 1:
      solid = octahedron();
      break;
    case 2:
      solid = prism(3 + random.below(10));
      break;
    default:
      solid = block({-1, -1, -1}, {1, 1, 1});
  }
  Vec3d x, y;
  randomAxes(random, random.below(4) == 0, x, y);
  const double thin = sliver ? 1e-3 : random.in(0.3, 1.0);
  return {placed(solid, origin, x, y, Vec3d(1.0, random.in(0.4, 1.0), thin) * (0.6 * scale)), false};
}

// A convex combination of the corners; if even, away from the border.
inline Vec3d pointWithin(const Shape& shape, Random& random, bool even = false) {
  Vec3d sum;
  double weights = 0.0;
  for (const Vec3f& p : shape.solid.points) {
    const double weight = even ? random.in(0.8, 1.0) : random.in(0.0, 1.0);
    sum += Vec3d(p) * weight;
    weights += weight;
  }
  return sum / weights;
}

inline Box boxOf(const Vec3d& low, const Vec3d& high) {
  return {Vec3f(min(low, high)), Vec3f(max(low, high))};
}
inline Box boxAround(const Vec3d& centre, const Vec3d& half) {
  return boxOf(centre - half, centre + half);
}

inline std::vector<Vec3d> cornersOf(const Box& box) {
  std::vector<Vec3d> corners;
  for (int i = 0; i < 8; ++i) {
    corners.emplace_back((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                         (i & 4) != 0 ? box.max.z : box.min.z);
  }
  return corners;
}
inline Vec3d pointIn(const Box& box, Random& random) {
  const Vec3d low(box.min), high(box.max);
  const Vec3d p(random.in(low.x, high.x), random.in(low.y, high.y), random.in(low.z, high.z));
  return max(low, min(high, p));
}

// Maximum distance from the eye to any finite box, and to the boxes around them.
inline double reachOf(std::span<const Box> boxes, const Vec3d& eye) {
  Box all;
  for (const Box& box : boxes) {
    if (box.wellFormed()) {
      all.extend(box);
    }
  }
  double reach = 0.0;
  for (const Vec3d& corner : cornersOf(all)) {
    reach = std::max(reach, length(corner - eye));
  }
  return reach * (1.0 + 1e-12);
}

// Halves the objects along an axis repeatedly, until a node has at most `width` leaves.
inline void appendHalves(std::span<const Box> boxes, std::vector<ObjectId> ids, std::uint32_t width,
                         BoxTree& tree) {
  const std::size_t node = tree.nodes.size();
  tree.nodes.emplace_back();
  tree.nodes[node].first_object = static_cast<std::uint32_t>(tree.objects.size());
  tree.nodes[node].object_count = static_cast<std::uint32_t>(ids.size());
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const ObjectId id : ids) {
    const Box& box = boxes[id.value];
    tree.nodes[node].bounds.extend(
        box.wellFormed() ? box
                         : Box{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}});
  }
  if (ids.size() == 1) {
    tree.objects.push_back(ids[0]);
  } else if (ids.size() <= width) {
    for (const ObjectId id : ids) {
      appendHalves(boxes, {id}, width, tree);
    }
  } else {
    const int axis = static_cast<int>(ids.size() % 3);
    std::stable_sort(ids.begin(), ids.end(), [&](ObjectId a, ObjectId b) {
      return boxes[a.value].min[axis] < boxes[b.value].min[axis];
    });
    const auto middle = ids.begin() + static_cast<std::ptrdiff_t>(ids.size() / 2);
    appendHalves(boxes, {ids.begin(), middle}, width, tree);
    appendHalves(boxes, {middle, ids.end()}, width, tree);
  }
  tree.nodes[node].end = static_cast<std::uint32_t>(tree.nodes.size());
}

inline BoxTree halvedTree(std::span<const Box> boxes, std::uint32_t width = 3) {
  BoxTree tree;
  std::vector<ObjectId> ids;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    ids.emplace_back(i);
  }
  if (!ids.empty()) {
    appendHalves(boxes, ids, width, tree);
  }
  return tree;
}

inline std::set<std::uint32_t> idsOf(const BoxTree& tree, std::span<const ObjectRun> runs) {
  std::set<std::uint32_t> ids;
  for (const ObjectRun& run : runs) {
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      ids.insert(tree.objects[i].value);
    }
  }
  return ids;
}

// Indices of the boxes that the shadow of one occluder hides.
inline std::set<std::uint32_t> hiddenBoxes(const ConvexOccluders& all, const ConvexOccluder& occluder,
                                           const Vec3d& eye, std::span<const Box> boxes) {
  Shadow shadow;
  std::vector<ObjectRun> runs;
  const BoxTree tree = halvedTree(boxes);
  if (makeShadow(all, occluder, eye, reachOf(boxes, eye), shadow)) {
    ShadowTree(tree.view()).hiddenBy(shadow, runs);
  }
  return idsOf(tree, runs);
}

}  // namespace sightline::test
