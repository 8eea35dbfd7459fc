#include "sightline/occlusion/supporting_planes.h"

#include <gtest/gtest.h>

#include "sightline/comparison/kept_planes.h"
#include "tests/occlusion/small_scenes.h"

namespace sightline {
namespace {

using namespace test;

template <typename Planes>
Visibility classify(Planes planes, const View& view, const OccluderSet& set, const Box& box) {
  planes.build(view, set, all(set));
  return planes.classify(box);
}

// Classifies by SupportingPlanes and by KeptPlanes, which must agree on what is hidden. The search over all
// vertices may lose planes to rounding, and then hides less.
Visibility askPlanes(const View& view, std::span<const OraclePolygon> polygons, const Box& box,
                     bool joint_occlusion = true) {
  const OccluderSet set = setOf(polygons);
  const Visibility state = classify(SupportingPlanes({joint_occlusion}), view, set, box);
  const Visibility kept = classify(KeptPlanes({.joint_occlusion = joint_occlusion}), view, set, box);
  const Visibility all_vertices = classify(
      KeptPlanes({.joint_occlusion = joint_occlusion, .tangent_search = TangentSearch::kAllVertices}), view,
      set, box);
  EXPECT_EQ(kept == Visibility::kHidden, state == Visibility::kHidden);
  if (state != Visibility::kHidden) {
    EXPECT_NE(all_vertices, Visibility::kHidden);
  }
  return state;
}

TEST(SupportingPlanes, TellHiddenPartialAndVisible) {
  const std::vector<OraclePolygon> walls{wall(-1, 1, -1, 1, -5)};
  {
    EXPECT_EQ(askPlanes(kLookingBack, walls, {{-1, -1, -12}, {1, 1, -10}}), Visibility::kHidden);
    EXPECT_EQ(askPlanes(kLookingBack, walls, {{-1, -1, -4}, {1, 1, -3}}), Visibility::kVisible);
    EXPECT_EQ(askPlanes(kLookingBack, walls, {{-9, -1, -12}, {1, 1, -10}}), Visibility::kPartial);
    EXPECT_EQ(askPlanes(kLookingBack, walls, {{5, -1, -12}, {6, 1, -10}}), Visibility::kVisible);
    // These boxes cross the wall's plane, next to the wall and through it.
    EXPECT_EQ(askPlanes(kLookingBack, walls, {{3, -1, -7}, {4, 1, -4}}), Visibility::kVisible);
    EXPECT_EQ(askPlanes(kLookingBack, walls, {{0, 0, -7}, {4, 1, -4}}), Visibility::kPartial);
  }
}

// Exact arithmetic on integer coordinates up to 1,000: six times the volume of a tetrahedron.
using WholePoint = std::array<std::int64_t, 3>;

std::int64_t orientation(const WholePoint& a, const WholePoint& b, const WholePoint& c, const WholePoint& d) {
  WholePoint u, v, w;
  for (std::size_t i = 0; i < 3; ++i) {
    u[i] = b[i] - a[i];
    v[i] = c[i] - a[i];
    w[i] = d[i] - a[i];
  }
  return (u[1] * v[2] - u[2] * v[1]) * w[0] + (u[2] * v[0] - u[0] * v[2]) * w[1] +
         (u[0] * v[1] - u[1] * v[0]) * w[2];
}

Vec3f toVec(const WholePoint& p) {
  return {static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
}

// Whether a triangle hides a point from the eye, computed with exact signs.
struct ExactHiding {
  bool hidden = false;  // strictly within the triangle's shadow
  bool clear = false;   // hidden by more than rounding and margins: the ray passes a thousandth of the
                        // triangle's size inside it, and the point is as far behind it
};

ExactHiding hides(const std::array<WholePoint, 3>& triangle, const WholePoint& eye, const WholePoint& point) {
  // Doubles hold these integers exactly.
  const auto behind = -orientation(triangle[0], triangle[1], triangle[2], point);
  const auto before = orientation(triangle[0], triangle[1], triangle[2], eye);
  ExactHiding result;
  result.hidden = behind > 0 && before > 0;
  result.clear = result.hidden;
  if (!result.hidden) {
    return result;
  }
  std::int64_t side[3], sum = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    side[i] = -orientation(eye, triangle[i], triangle[(i + 1) % 3], point);
    result.hidden &= side[i] > 0;
    sum += side[i];
  }
  // side / sum are the barycentric coordinates of the point where the ray hits the triangle's plane.
  for (const std::int64_t s : side) {
    result.clear &= result.hidden && static_cast<double>(s) > 1e-3 * static_cast<double>(sum);
  }
  result.clear &= static_cast<double>(behind) > 1e-3 * static_cast<double>(before);
  return result;
}

TEST(SupportingPlanes, HiddenIsExactForASingleOccluder) {
  // Few different coordinates: most cases are ties, corners on shadow planes and in the occluder's plane.
  int hidden = 0, ties = 0;
  for (const std::int64_t range : {3, 6, 30, 1000}) {
    std::mt19937_64 random(static_cast<std::uint64_t>(range));
    const auto coordinate = [&] {
      return static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(2 * range + 1)) - range;
    };
    const auto point = [&] { return WholePoint{coordinate(), coordinate(), coordinate()}; };
    for (int round = 0; round < 20000; ++round) {
      // Most of the time a large triangle between the eye and a small box.
      std::array<WholePoint, 3> triangle{point(), point(), point()};
      WholePoint eye = point(), low = point(), high = point();
      if (round % 4 != 0) {
        eye[2] = 4 * range;
        low[2] -= 3 * range;
        high[2] -= 3 * range;
        for (WholePoint* corner : {&low, &high}) {
          (*corner)[0] /= 2;
          (*corner)[1] /= 2;
        }
      }
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (low[axis] > high[axis]) {
          std::swap(low[axis], high[axis]);
        }
      }
      if (orientation(triangle[0], triangle[1], triangle[2], eye) < 0) {
        std::swap(triangle[1], triangle[2]);
      }
      bool all_hidden = true, all_clear = true, any_clear = false;
      for (unsigned corner = 0; corner < 8; ++corner) {
        const WholePoint x{corner & 1 ? high[0] : low[0], corner & 2 ? high[1] : low[1],
                           corner & 4 ? high[2] : low[2]};
        const ExactHiding answer = hides(triangle, eye, x);
        all_hidden &= answer.hidden;
        all_clear &= answer.clear;
        any_clear |= answer.clear;
      }
      View view = viewFrom(Vec3d(toVec(eye)), {0, 0, -1});
      view.z_near = 1e-6;
      // The near plane must not matter here.
      double depth = 1.0;
      for (const WholePoint& p : triangle) {
        depth = std::min(depth, view.eye.z - static_cast<double>(p[2]));
      }
      if (depth < 0.5) {
        continue;
      }
      const std::vector<OraclePolygon> polygons{
          {{toVec(triangle[0]), toVec(triangle[1]), toVec(triangle[2])}, false}};
      const Visibility state = askPlanes(view, polygons, {toVec(low), toVec(high)});
      if (state == Visibility::kHidden) {
        EXPECT_TRUE(all_hidden) << range << " round " << round;
        ++hidden;
      }
      if (all_clear) {
        EXPECT_EQ(state, Visibility::kHidden) << range << " round " << round;
      } else if (all_hidden) {
        ++ties;
      }
      // Conservative for partial: what hides a corner touches the box.
      if (any_clear) {
        EXPECT_NE(state, Visibility::kVisible) << range << " round " << round;
      }
    }
  }
  EXPECT_GT(hidden, 2000);
  EXPECT_GT(ties, 10);
}

TEST(SupportingPlanes, ABoxThatTouchesTheWallFromBehindIsNotHidden) {
  const std::vector<OraclePolygon> walls{wall(-4, 4, -4, 4, -5)};
  EXPECT_NE(askPlanes(kLookingBack, walls, {{-1, -1, -6}, {1, 1, -5}}), Visibility::kHidden);
  EXPECT_EQ(askPlanes(kLookingBack, walls, {{-1, -1, -6}, {1, 1, -5.001f}}), Visibility::kHidden);
}

TEST(SupportingPlanes, ABoxWhoseShadowTouchesTheOutlineIsNotHidden) {
  // The box's edge at x = 2, z = -10 is exactly behind the wall's edge at x = 1, z = -5.
  const std::vector<OraclePolygon> walls{wall(-1, 1, -1, 1, -5)};
  EXPECT_EQ(askPlanes(kLookingBack, walls, {{-1, -1, -12}, {2, 1, -10}}), Visibility::kPartial);
  EXPECT_EQ(askPlanes(kLookingBack, walls, {{2, -1, -10}, {3, 1, -10}}), Visibility::kVisible);
  EXPECT_EQ(askPlanes(kLookingBack, walls, {{-1, -1, -12}, {1.999f, 1, -10}}), Visibility::kHidden);
}

TEST(SupportingPlanes, AdjoiningWallsHideABoxAcrossTheirSharedEdgeOnlyTogether) {
  const std::vector<OraclePolygon> walls{wall(-4, 0.3f, -4, 4, -5), wall(0.3f, 4, -4, 4, -5)};
  const Box box{{-1, -1, -12}, {1, 1, -10}};
  EXPECT_EQ(askPlanes(kLookingBack, walls, box), Visibility::kHidden);
  EXPECT_EQ(askPlanes(kLookingBack, walls, box, false), Visibility::kPartial);
}

TEST(SupportingPlanes, TheSidesOfACornerHideTogether) {
  // A building's corner towards the eye, and one away from it: there the shared edge is a silhouette of
  // neither.
  for (const float z : {-5.0f, -11.0f}) {
    const std::vector<OraclePolygon> walls{
        {{{-3, -2, -8}, {0, -2, z}, {0, 2, z}, {-3, 2, -8}}, true},
        {{{0, -2, z}, {3, -2, -8}, {3, 2, -8}, {0, 2, z}}, true},
    };
    EXPECT_EQ(askPlanes(kLookingBack, walls, {{-0.5f, -0.5f, -15}, {0.5f, 0.5f, -14}}), Visibility::kHidden)
        << z;
  }
}

TEST(SupportingPlanes, ASharedEdgeThatIsASilhouetteHidesNothingBeyondIt) {
  // The second wall folds back behind the first: both lie on the left of their shared edge.
  const std::vector<OraclePolygon> walls{
      {{{-3, -3, -5}, {0, -3, -5}, {0, 3, -5}, {-3, 3, -5}}, true},
      {{{0, -3, -5}, {-3, -3, -8}, {-3, 3, -8}, {0, 3, -5}}, true},
  };
  EXPECT_NE(askPlanes(kLookingBack, walls, {{-1, -1, -12}, {1, 1, -11}}), Visibility::kHidden);
  EXPECT_EQ(askPlanes(kLookingBack, walls, {{-2, -1, -12}, {-1, 1, -11}}), Visibility::kHidden);
}

TEST(SupportingPlanes, TJunctionsAreClosed) {
  // One wall below, three of different widths above it; the lower one's edge runs through their corners.
  const std::vector<OraclePolygon> walls{
      {{{-4, -4, -5}, {4, -4, -5}, {4, 0, -5}, {1.5f, 0, -5}, {-1, 0, -5}, {-4, 0, -5}}, false},
      wall(-4, -1, 0, 4, -5),
      wall(-1, 1.5f, 0, 4, -5),
      wall(1.5f, 4, 0, 4, -5)};
  EXPECT_EQ(askPlanes(kLookingBack, walls, {{-3, -1, -12}, {5, 1, -10}}), Visibility::kHidden);
  // Without the middle one there is a gap above the lower wall.
  const std::vector<OraclePolygon> gap{walls[0], walls[1], walls[3]};
  EXPECT_EQ(askPlanes(kLookingBack, gap, {{-3, -1, -12}, {5, 1, -10}}), Visibility::kPartial);
  EXPECT_EQ(askPlanes(kLookingBack, gap, {{-3, -2, -12}, {5, -1, -10}}), Visibility::kHidden);
}

TEST(SupportingPlanes, AHoleIsNeverClosed) {
  // Four walls around a square hole, each edge shared with its neighbours.
  const float a = 1, b = 4, z = -5;
  const Vec3f inner[4]{{-a, -a, z}, {a, -a, z}, {a, a, z}, {-a, a, z}};
  const Vec3f outer[4]{{-b, -b, z}, {b, -b, z}, {b, b, z}, {-b, b, z}};
  std::vector<OraclePolygon> ring;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t j = (i + 1) % 4;
    ring.push_back({{outer[i], outer[j], inner[j], inner[i]}, false});
  }
  EXPECT_NE(askPlanes(kLookingBack, ring, {{-4, -4, -12}, {4, 4, -10}}), Visibility::kHidden);
  EXPECT_NE(askPlanes(kLookingBack, ring, {{-0.1f, -0.1f, -12}, {0.1f, 0.1f, -10}}), Visibility::kHidden);
  EXPECT_NE(askPlanes(kLookingBack, ring, {{1.5f, 1.5f, -12}, {3, 3, -10}}), Visibility::kHidden);
  // A box behind the edge that two of them share is hidden by the two together.
  EXPECT_EQ(askPlanes(kLookingBack, ring, {{4, 4, -12}, {5, 5, -10}}), Visibility::kHidden);
  // With the hole filled, everything behind the walls is hidden.
  ring.push_back({{inner[0], inner[1], inner[2], inner[3]}, false});
  EXPECT_EQ(askPlanes(kLookingBack, ring, {{-4, -4, -12}, {4, 4, -10}}), Visibility::kHidden);
}

TEST(SupportingPlanes, AnLShapeHidesWhatLiesBehindItsKernel) {
  // Three squares; the notch is at the upper right.
  const std::vector<OraclePolygon> shape{wall(-3, 0, -3, 0, -5), wall(0, 3, -3, 0, -5),
                                         wall(-3, 0, 0, 3, -5)};
  EXPECT_EQ(askPlanes(kLookingBack, shape, {{-1, -2, -12}, {1, -1, -10}}), Visibility::kHidden);  // lower arm
  EXPECT_EQ(askPlanes(kLookingBack, shape, {{-2, -1, -12}, {-1, 1, -10}}), Visibility::kHidden);  // left arm
  EXPECT_NE(askPlanes(kLookingBack, shape, {{-1, -1, -12}, {1, 1, -10}}),
            Visibility::kHidden);                                                              // in the notch
  EXPECT_NE(askPlanes(kLookingBack, shape, {{1, 1, -12}, {2, 2, -10}}), Visibility::kHidden);  // beside it
}

TEST(SupportingPlanes, DisconnectedWallsDoNotFuse) {
  const std::vector<OraclePolygon> walls{wall(-2, 0.3f, -4, 4, -4), wall(0, 5, -8, 8, -6)};
  EXPECT_EQ(askPlanes(kLookingBack, walls, {{-1, -1, -12}, {1, 1, -10}}), Visibility::kPartial);
}

TEST(SupportingPlanes, NeverHideABoxSeenThroughAGap) {
  forEachGap([](std::span<const OraclePolygon> walls, const Box& box, const std::string& what) {
    EXPECT_NE(askPlanes(kLookingBack, walls, box), Visibility::kHidden) << what;
  });
}

TEST(SupportingPlanes, SingleSidedWallsHideNothingFromBehind) {
  OraclePolygon turned = wall(-4, 4, -4, 4, -5);
  std::reverse(turned.vertices.begin(), turned.vertices.end());
  OraclePolygon both = turned;
  both.double_sided = true;
  const Box behind{{-1, -1, -12}, {1, 1, -10}};
  EXPECT_EQ(askPlanes(kLookingBack, {{turned}}, behind), Visibility::kVisible);
  EXPECT_EQ(askPlanes(kLookingBack, {{both}}, behind), Visibility::kHidden);
}

TEST(SupportingPlanes, WhatTheNearPlaneClipsHidesNothing) {
  View view = kLookingBack;
  view.z_near = 5.5;
  EXPECT_NE(askPlanes(view, {{wall(-9, 9, -9, 9, -5)}}, {{-1, -1, -12}, {1, 1, -10}}), Visibility::kHidden);
  // A wall that crosses the near plane hides with the part beyond it only.
  const OraclePolygon side{{{-1, -4, 0}, {3, -4, -8}, {3, 4, -8}, {-1, 4, 0}}, true};
  std::mt19937_64 random(3);
  int hidden = 0;
  for (int i = 0; i < 2000; ++i) {
    const double x = -6.0 + 0.006 * i;
    const Box box{Vec3f(Vec3d(x, -0.2, -12)), Vec3f(Vec3d(x + 0.05, 0.2, -11.5))};
    if (askPlanes(view, {{side}}, box) == Visibility::kHidden) {
      ++hidden;
      EXPECT_FALSE(lookAt(box, view, {{side}}, 200, random).seen) << "x " << x;
    }
  }
  EXPECT_GT(hidden, 20);
}

TEST(SupportingPlanes, TheEyeInAnOccludersPlaneOrInsideTheBoxHidesNothing) {
  const OraclePolygon edge_on{{{-4, 0, -2}, {4, 0, -2}, {4, 0, -9}, {-4, 0, -9}}, true};
  EXPECT_EQ(askPlanes(kLookingBack, {{edge_on}}, {{-1, -1, -12}, {1, 1, -10}}), Visibility::kVisible);
  EXPECT_NE(askPlanes(kLookingBack, {{wall(-1, 1, -1, 1, -5)}}, {{-3, -3, -3}, {3, 3, 3}}),
            Visibility::kHidden);
}

TEST(SupportingPlanes, BoxesAndEyesThatAreNotFiniteSeeEverything) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
  const std::vector<OraclePolygon> walls{wall(-9, 9, -9, 9, -5)};
  for (const Box& box : {Box{}, Box{{nan, 0, 0}, {1, 1, 1}}, Box{{-1, -1, -inf}, {1, 1, -10}}}) {
    EXPECT_EQ(askPlanes(kLookingBack, walls, box), Visibility::kVisible);
  }
  EXPECT_EQ(askPlanes(viewFrom({nan, 0, 0}, {0, 0, -1}), walls, {{-1, -1, -12}, {1, 1, -10}}),
            Visibility::kVisible);
}

TEST(SupportingPlanes, BeforeBuildNothingIsHidden) {
  SupportingPlanes planes;
  EXPECT_EQ(planes.classify({{-1, -1, -12}, {1, 1, -10}}), Visibility::kVisible);
  EXPECT_EQ(planes.add(std::vector<OccluderId>{OccluderId(0u)}).count, 0u);
}

TEST(SupportingPlanes, CompleteForConvexUnions) {
  // A convex polygon cut by random lines, with T-junctions; what it hides as a whole its parts hide jointly.
  int hidden = 0, joint_only = 0;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    Random random(seed);
    // A grid of columns, each with rows of its own: corners of one column lie on the other's edges, and are
    // vertices of both, as in a mesh without cracks.
    std::vector<float> x{-4};
    while (x.back() < 4) {
      x.push_back(static_cast<float>(std::min(4.0, x.back() + random.in(1.0, 3.0))));
    }
    std::vector<std::vector<float>> rows(x.size() + 1);
    for (std::size_t column = 1; column < x.size(); ++column) {
      rows[column] = {-4};
      while (rows[column].back() < 4) {
        rows[column].push_back(static_cast<float>(std::min(4.0, rows[column].back() + random.in(1.0, 4.0))));
      }
    }
    std::vector<OraclePolygon> parts;
    const float z = -5;
    for (std::size_t column = 1; column < x.size(); ++column) {
      for (std::size_t row = 1; row < rows[column].size(); ++row) {
        const float low = rows[column][row - 1], high = rows[column][row];
        OraclePolygon part;
        part.vertices = {{x[column - 1], low, z}, {x[column], low, z}};
        for (const float y : rows[column + 1]) {
          if (y > low && y < high) {
            part.vertices.push_back({x[column], y, z});
          }
        }
        part.vertices.push_back({x[column], high, z});
        part.vertices.push_back({x[column - 1], high, z});
        for (auto y = rows[column - 1].rbegin(); y != rows[column - 1].rend(); ++y) {
          if (*y > low && *y < high) {
            part.vertices.push_back({x[column - 1], *y, z});
          }
        }
        parts.push_back(part);
      }
    }
    const View view = viewFrom(random.point(2.0), {0, 0, -1});
    const std::vector<OraclePolygon> whole{wall(-4, 4, -4, 4, z)};
    for (int i = 0; i < 20; ++i) {
      const Vec3d c = Vec3d(0, 0, -12) + random.point(5.0);
      const Vec3d h = abs(random.point(2.0));
      const Box box{Vec3f(c - h), Vec3f(c + h)};
      if (askPlanes(view, whole, box) == Visibility::kHidden) {
        ++hidden;
        EXPECT_EQ(askPlanes(view, parts, box), Visibility::kHidden) << "seed " << seed << " box " << i;
        joint_only += askPlanes(view, parts, box, false) != Visibility::kHidden ? 1 : 0;
      }
    }
  }
  EXPECT_GT(hidden, 500);
  EXPECT_GT(joint_only, 300);
}

TEST(SupportingPlanes, AConvexBodysFacesHideWhatTheBodyHides) {
  // A cube's silhouette is convex from everywhere; one, two or three of its faces are seen.
  std::vector<OraclePolygon> cube;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0f, 1.0f}) {
      OraclePolygon face;
      for (int i = 0; i < 4; ++i) {
        const float u = i == 1 || i == 2 ? 1.0f : -1.0f, v = i >= 2 ? 1.0f : -1.0f;
        Vec3f p;
        p[axis] = side;
        p[(axis + 1) % 3] = side > 0 ? u : v;
        p[(axis + 2) % 3] = side > 0 ? v : u;
        face.vertices.push_back(p);
      }
      cube.push_back(face);
    }
  }
  const auto inside = [](const Vec3d& p) {
    return std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 0.999;
  };
  int hidden = 0, joint_only = 0;
  Random random(3);
  for (int i = 0; i < 3000; ++i) {
    const Vec3d direction = normalized(random.point(1.0));
    const View view = viewFrom(direction * random.in(2.0, 9.0), -direction);
    const Vec3d c = -direction * random.in(2.5, 6.0) + random.point(1.0);
    const Vec3d h = abs(random.point(0.5));
    const Box box{Vec3f(c - h), Vec3f(c + h)};
    // The box is clearly hidden: the line from each corner to the eye passes well through the cube.
    bool blocked = true;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Vec3d x(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                    corner & 4 ? box.max.z : box.min.z);
      bool through = false;
      for (int s = 1; s < 400 && !through; ++s) {
        through = inside(view.eye + (x - view.eye) * (s / 400.0));
      }
      blocked &= through;
    }
    const Visibility state = askPlanes(view, cube, box);
    const bool outside_cube =
        c.x - h.x > 1 || c.x + h.x < -1 || c.y - h.y > 1 || c.y + h.y < -1 || c.z - h.z > 1 || c.z + h.z < -1;
    if (blocked && outside_cube && state != Visibility::kHidden) {
      // Legitimate only where a front face's plane runs through the box.
      bool crossed = false;
      for (int axis = 0; axis < 3; ++axis) {
        const double plane = view.eye[axis] > 0 ? 1.0 : -1.0;
        const bool front = std::abs(view.eye[axis]) > 0.99;
        const double nearest = plane > 0 ? box.max[axis] : -box.min[axis];
        crossed |= front && nearest > 0.998;
      }
      EXPECT_TRUE(crossed) << i;
    }
    if (state == Visibility::kHidden) {
      ++hidden;
      joint_only += askPlanes(view, cube, box, false) != Visibility::kHidden ? 1 : 0;
      EXPECT_FALSE(lookAt(box, view, cube, 100, random.engine()).seen) << i;
    }
  }
  EXPECT_GT(hidden, 300);
  EXPECT_GT(joint_only, 100);
}

class SupportingPlanesFamilies : public ::testing::TestWithParam<Family> {};

TEST_P(SupportingPlanesFamilies, NothingThatARayReachesIsHidden) {
  int hidden = 0;
  for (std::uint64_t seed = 1; seed <= 150; ++seed) {
    RandomScene scene(GetParam(), seed);
    const OccluderSet set = setOf(scene.polygons);
    SupportingPlanes planes;
    KeptPlanes by_tables, by_all_vertices({.tangent_search = TangentSearch::kAllVertices});
    planes.build(scene.view, set, all(set));
    by_tables.build(scene.view, set, all(set));
    by_all_vertices.build(scene.view, set, all(set));
    for (int i = 0; i < 100; ++i) {
      const Box box = scene.randomBox();
      const Visibility states[] = {planes.classify(box), by_tables.classify(box),
                                   by_all_vertices.classify(box)};
      if (std::count(std::begin(states), std::end(states), Visibility::kHidden) > 0) {
        ++hidden;
        EXPECT_FALSE(lookAt(box, scene.view, scene.polygons, 400, scene.random.engine()).seen)
            << GetParam().name << " seed " << seed << " box " << i;
      }
    }
  }
  EXPECT_GT(hidden, 50);
}

INSTANTIATE_TEST_SUITE_P(Scales, SupportingPlanesFamilies, ::testing::ValuesIn(kFamilies),
                         [](const auto& param) { return "Family" + std::to_string(param.index); });

TEST(SupportingPlanes, OccludersOfAListAreTheOnlyOnesAsked) {
  const std::vector<OraclePolygon> walls{wall(-1, 1, -1, 1, -5), wall(-2, 2, -2, 2, -8)};
  const OccluderSet set = setOf(walls);
  SupportingPlanes planes;
  planes.build(kLookingBack, set, {});
  const Box box{{-1, -1, -7}, {1, 1, -6}}, far_box{{-1, -1, -12}, {1, 1, -11}};
  EXPECT_EQ(planes.classify(far_box), Visibility::kVisible);
  for (const OccluderId id : all(set)) {
    OccluderList touching;
    const bool behind_both = set[id].centroid.z > -6;
    EXPECT_EQ(planes.classify(box, 0, planes.add({&id, 1}), touching),
              behind_both ? Visibility::kHidden : Visibility::kVisible);
    EXPECT_EQ(planes.classify(far_box, 1, planes.add({&id, 1}), touching), Visibility::kHidden);
  }
}

}  // namespace
}  // namespace sightline
