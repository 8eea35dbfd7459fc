#pragma once

// Meshes that pass through or around each other, and what rays see of them: the oracle of divided parts.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

#include "sightline/layers/cycle_splitter.h"
#include "sightline/layers/layer_sorter.h"
#include "tests/layers/hull_of.h"
#include "tests/support/layer_shapes.h"

namespace sightline::splitting {

using shapes::Points;
using shapes::Random;
using Triangle = std::array<Vec3d, 3>;

struct Thing {
  std::vector<Triangle> triangles;  // in the part's space
  Mat4 world_from_part;
};

inline Points pointsOf(const Thing& thing) {
  Points points;
  for (const Triangle& triangle : thing.triangles) {
    points.insert(points.end(), triangle.begin(), triangle.end());
  }
  return points;
}

// The surface of the convex hull of some points.
inline Thing solid(const Points& points) {
  Thing thing;
  const ConvexHull hull = shapes::hullOf(points);
  for (const auto& [a, b, c] : hull.triangles) {
    thing.triangles.push_back({hull.vertices[a], hull.vertices[b], hull.vertices[c]});
  }
  return thing;
}

inline Thing joined(const std::vector<Thing>& things) {
  Thing all;
  for (const Thing& thing : things) {
    all.triangles.insert(all.triangles.end(), thing.triangles.begin(), thing.triangles.end());
  }
  return all;
}

// A rod of a square section between two points.
inline Thing rod(const Vec3d& from, const Vec3d& to, double half_width) {
  const Vec3d along = normalized(to - from);
  const Vec3d side = normalized(cross(along, std::abs(along.x) < 0.6 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0}));
  const Vec3d other = cross(along, side);
  Points points;
  for (const Vec3d& end : {from, to}) {
    for (const double a : {-half_width, half_width}) {
      for (const double b : {-half_width, half_width}) {
        points.push_back(end + side * a + other * b);
      }
    }
  }
  return solid(points);
}

// A ring of 24 rods in the plane of two unit vectors.
inline Thing ring(const Vec3d& middle, const Vec3d& u, const Vec3d& v, double radius, double half_width) {
  constexpr int kSteps = 24;
  const auto at = [&](int i) {
    const double angle = 2.0 * std::numbers::pi * i / kSteps;
    return middle + u * (radius * std::cos(angle)) + v * (radius * std::sin(angle));
  };
  std::vector<Thing> rods;
  for (int i = 0; i < kSteps; ++i) {
    rods.push_back(rod(at(i), at(i + 1), half_width));
  }
  return joined(rods);
}

// A U of three rods: two arms along `up` from the ends of a base along `across`.
inline Thing uShape(const Vec3d& base_middle, const Vec3d& across, const Vec3d& up, double half_width) {
  const Vec3d left = base_middle - across, right = base_middle + across;
  return joined(
      {rod(left, right, half_width), rod(left, left + up, half_width), rod(right, right + up, half_width)});
}

inline View viewFrom(const Vec3d& eye, const Vec3d& forward) {
  View view;
  view.eye = eye;
  setOrientation(view, forward, {0, 1, 0});
  return view;
}

class ThingSorter {
 public:
  // by_triangles: pieces get hulls of their triangles, else those of the parts' hulls.
  ThingSorter(std::vector<Thing> things, bool by_triangles, CycleSplitSettings split = {},
              LayerSettings settings = {.contact_tolerance = 1e-9})
      : things_(std::move(things)),
        sorter_(with(settings)),
        splitter_(sorter_, withTriangles(split, by_triangles)) {
    for (const Thing& thing : things_) {
      const HullId hull = sorter_.addHull(shapes::hullOf(pointsOf(thing)));
      const PartId part = sorter_.addPart(std::span(&hull, 1));
      sorter_.setTransform(part, thing.world_from_part);
    }
  }
  ThingSorter(const ThingSorter&) = delete;  // the splitter has the address of the sorter and of this

  LayerSorter& sorter() { return sorter_; }
  CycleSplitter& splitter() { return splitter_; }
  const std::vector<Thing>& things() const { return things_; }
  void place(std::uint32_t part, const Mat4& world_from_part) {
    things_[part].world_from_part = world_from_part;
    sorter_.setTransform(PartId(part), world_from_part);
  }
  const LayerOrder& update(const View& view, std::span<const Vec3d> more_eyes = {}) {
    return splitter_.update(view, more_eyes);
  }

 private:
  static LayerSettings with(LayerSettings settings) {
    settings.arcs = LayerArcs::kAll;
    return settings;
  }
  CycleSplitSettings withTriangles(CycleSplitSettings split, bool by_triangles) {
    if (by_triangles) {
      split.triangles = [this](PartId part, std::vector<Triangle>& triangles) {
        triangles = things_[part.value].triangles;
      };
    }
    return split;
  }

  std::vector<Thing> things_;
  LayerSorter sorter_;
  CycleSplitter splitter_;
};

inline std::size_t largestGroup(const LayerOrder& order) {
  std::size_t largest = 0;
  for (std::size_t i = 0; i < order.groups(); ++i) {
    largest = std::max(largest, order.group(i).size());
  }
  return largest;
}

inline std::size_t largestGroupOfWhole(const std::vector<Thing>& things, const View& view,
                                       double contact_tolerance = 1e-9) {
  LayerSorter sorter({.contact_tolerance = contact_tolerance});
  for (const Thing& thing : things) {
    const HullId hull = sorter.addHull(shapes::hullOf(pointsOf(thing)));
    sorter.setTransform(sorter.addPart(std::span(&hull, 1)), thing.world_from_part);
  }
  return largestGroup(sorter.update(view));
}

// A ball around a thing in the world.
struct Ball {
  Vec3d centre;
  double radius = 0.0;
};

inline std::vector<Ball> ballsAround(const std::vector<Thing>& things) {
  std::vector<Ball> balls;
  for (const Thing& thing : things) {
    Points points = pointsOf(thing);
    Ball& ball = balls.emplace_back();
    for (Vec3d& point : points) {
      point = transformPoint(thing.world_from_part, point);
      ball.centre += point / static_cast<double>(points.size());
    }
    for (const Vec3d& point : points) {
      ball.radius = std::max(ball.radius, length(point - ball.centre) * (1.0 + 1e-9));
    }
  }
  return balls;
}

// Where a ray hits a triangle of a thing.
struct Hit {
  double distance = 0.0;
  std::uint32_t part = 0;
  Vec3d in_part;
};

// balls: of the things. direction: of length 1.
inline std::vector<Hit> hitsOf(const std::vector<Thing>& things, std::span<const Ball> balls,
                               const Vec3d& from, const Vec3d& direction) {
  std::vector<Hit> hits;
  for (std::uint32_t part = 0; part < things.size(); ++part) {
    if (length(cross(balls[part].centre - from, direction)) > balls[part].radius) {
      continue;  // the ray misses the ball
    }
    for (const Triangle& t : things[part].triangles) {
      const Mat4& m = things[part].world_from_part;
      const Vec3d a = transformPoint(m, t[0]), ab = transformPoint(m, t[1]) - a,
                  ac = transformPoint(m, t[2]) - a;
      const Vec3d p = cross(direction, ac);
      const double determinant = dot(ab, p);
      if (std::abs(determinant) < 1e-14) {
        continue;
      }
      const Vec3d q = cross(from - a, ab);
      const double u = dot(from - a, p) / determinant, v = dot(direction, q) / determinant;
      const double distance = dot(ac, q) / determinant;
      if (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && distance > 0.0) {
        hits.push_back({distance, part, t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v});
      }
    }
  }
  std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.distance < b.distance; });
  return hits;
}

// The number in the order of what shows a point of a part: the part, or the only piece on whose sides the
// point lies.
inline std::uint32_t shownBy(std::span<const PartPiece> pieces, std::uint32_t part, const Vec3d& point) {
  std::uint32_t shown = part, count = 0, of_part = 0;
  for (const PartPiece& piece : pieces) {
    if (piece.part == PartId(part)) {
      ++of_part;
      if (std::all_of(piece.sides.begin(), piece.sides.end(),
                      [&](const PieceSide& side) { return side.contains(point); })) {
        shown = piece.piece.value;
        ++count;
      }
    }
  }
  EXPECT_EQ(count, of_part > 0 ? 1u : 0u) << "a point of part " << part << " is in " << count << " pieces";
  return shown;
}

inline bool isNearAPlane(std::span<const PartPiece> pieces, std::uint32_t part, const Vec3d& point) {
  return std::any_of(pieces.begin(), pieces.end(), [&](const PartPiece& piece) {
    return piece.part == PartId(part) &&
           std::any_of(piece.sides.begin(), piece.sides.end(),
                       [&](const PieceSide& side) { return std::abs(side.plane.evaluate(point)) < 1e-7; });
  });
}

// Along every ray, what is nearer is in an earlier group or in the same one. Returns how many pairs of
// neighbours along rays are of different groups.
inline std::size_t expectRaysInOrder(const std::vector<Thing>& things, std::span<const PartPiece> pieces,
                                     const LayerOrder& order, const View& view, Random& random, int rays) {
  std::vector<std::size_t> group_of;
  for (std::size_t i = 0; i < order.groups(); ++i) {
    for (const PartId part : order.group(i)) {
      group_of.resize(std::max<std::size_t>(group_of.size(), part.value + 1u), order.groups());
      group_of[part.value] = i;
    }
  }
  const std::vector<Ball> balls = ballsAround(things);
  std::size_t pairs = 0;
  for (int i = 0; i < rays; ++i) {
    // At a point of some thing, so that most rays hit.
    const Thing& thing = things[random.below(static_cast<std::uint32_t>(things.size()))];
    const Triangle& t = thing.triangles[random.below(static_cast<std::uint32_t>(thing.triangles.size()))];
    const double u = random.number(0.0, 1.0), v = random.number(0.0, 1.0 - u);
    const Vec3d at = transformPoint(thing.world_from_part, t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v);
    const Vec3d from = view.orthographic ? at - view.forward * 1000.0 : view.eye;
    const Vec3d direction = normalized(at - from);
    const Hit* before = nullptr;
    const std::vector<Hit> hits = hitsOf(things, balls, from, direction);
    std::size_t last_group = 0;
    for (const Hit& hit : hits) {
      if (isNearAPlane(pieces, hit.part, hit.in_part)) {
        continue;
      }
      const std::uint32_t shown = shownBy(pieces, hit.part, hit.in_part);
      EXPECT_LT(shown, group_of.size());
      const std::size_t group = shown < group_of.size() ? group_of[shown] : order.groups();
      EXPECT_LT(group, order.groups()) << "part or piece " << shown << " is seen and not in the order";
      if (before != nullptr && hit.distance - before->distance > 1e-7) {
        EXPECT_GE(group, last_group) << "part " << hit.part << " is seen behind part " << before->part
                                     << " and drawn over it";
        pairs += group != last_group ? 1 : 0;
      }
      before = &hit;
      last_group = std::max(last_group, group);
    }
    if (::testing::Test::HasFailure()) {
      return pairs;
    }
  }
  return pairs;
}

// Every point of a divided part is in a hull of the piece that shows it.
inline void expectPiecesHoldTheirParts(ThingSorter& sorter, Random& random, int points) {
  const std::span<const PartPiece> pieces = sorter.splitter().pieces();
  for (std::uint32_t part = 0; part < sorter.things().size(); ++part) {
    if (std::none_of(pieces.begin(), pieces.end(),
                     [&](const PartPiece& piece) { return piece.part == PartId(part); })) {
      continue;
    }
    const std::vector<Triangle>& triangles = sorter.things()[part].triangles;
    for (int i = 0; i < points; ++i) {
      const Triangle& t = triangles[random.below(static_cast<std::uint32_t>(triangles.size()))];
      const double u = random.number(0.0, 1.0), v = random.number(0.0, 1.0 - u);
      const Vec3d point = t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v;
      const std::uint32_t piece = shownBy(pieces, part, point);
      bool held = false;
      for (const HullId id : sorter.sorter().hullsOf(PartId(piece))) {
        const ConvexHull& hull = sorter.sorter().hull(id);
        held = held || std::all_of(hull.faces.begin(), hull.faces.end(),
                                   [&](const Plane& face) { return face.evaluate(point) <= 1e-12; });
      }
      EXPECT_TRUE(held) << "a point of part " << part << " sticks out of piece " << piece;
    }
  }
}

}  // namespace sightline::splitting
