#include "sightline/drawing/feature_edges.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <random>
#include <set>
#include <tuple>
#include <utility>
#include <vector>

#include "tests/support/random_numbers.h"

namespace sightline {
namespace {

using Triangle = std::array<Vec3f, 3>;
using Triangles = std::vector<Triangle>;
// The ends of a line, the smaller one first.
using Ends = std::pair<std::array<float, 3>, std::array<float, 3>>;
using Lines = std::map<Ends, LineKind>;

std::array<float, 3> key(const Vec3f& p) {
  return {p.x, p.y, p.z};
}
Ends ends(const Vec3f& a, const Vec3f& b) {
  return std::minmax(key(a), key(b));
}

// A scene of one object. Unless welded, every triangle has corners of its own.
Scene sceneOf(const Triangles& triangles, bool double_sided, bool welded = false) {
  Scene scene;
  for (const Triangle& triangle : triangles) {
    for (const Vec3f& corner : triangle) {
      scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
      scene.positions.push_back(corner);
    }
  }
  scene.materials.push_back({.name = "", .double_sided = double_sided});
  Object object;
  object.index_count = static_cast<std::uint32_t>(scene.indices.size());
  object.material = MaterialId(0u);
  scene.objects.push_back(object);
  updateBounds(scene);
  if (welded) {
    weldPositions(scene);
  }
  return scene;
}

View viewFrom(const Vec3d& eye, const Vec3d& at = {}) {
  View view;
  view.eye = eye;
  setOrientation(view, at - eye, {0.1, 1, 0.2});
  return view;
}

Lines linesOf(const Scene& scene, const View& view, const FeatureSettings& settings = {}) {
  std::vector<FeatureLine> found{{7, 9, LineKind::kCrease}};
  const SceneView scene_view = scene.view();
  FeatureEdges(scene_view).select(scene_view, ObjectId(0u), view, settings, found);
  Lines lines;
  for (const FeatureLine& line : found) {
    EXPECT_LT(line.a, line.b);
    lines[ends(scene.positions[line.a], scene.positions[line.b])] = line.kind;
  }
  EXPECT_EQ(lines.size(), found.size());
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end(), [](const FeatureLine& x, const FeatureLine& y) {
    return std::tie(x.a, x.b) < std::tie(y.a, y.b);
  }));
  return lines;
}

std::size_t count(const Lines& lines, LineKind kind) {
  return static_cast<std::size_t>(
      std::count_if(lines.begin(), lines.end(), [&](const auto& line) { return line.second == kind; }));
}

void addQuad(Triangles& triangles, const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d) {
  triangles.push_back({a, b, c});
  triangles.push_back({a, c, d});
}

// A cube from 0 to 1 in each axis with its fronts outwards.
Triangles cube() {
  Triangles t;
  addQuad(t, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1});
  addQuad(t, {0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 0, 0});
  addQuad(t, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}, {1, 0, 1});
  addQuad(t, {0, 0, 0}, {0, 0, 1}, {0, 1, 1}, {0, 1, 0});
  addQuad(t, {0, 1, 0}, {0, 1, 1}, {1, 1, 1}, {1, 1, 0});
  addQuad(t, {0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1});
  return t;
}

TEST(FeatureEdges, OfACubeAreItsEdgesWhetherWeldedOrNot) {
  for (const bool welded : {false, true}) {
    const Lines single = linesOf(sceneOf(cube(), false, welded), viewFrom({4, 5, 6}));
    EXPECT_EQ(single.size(), 9u);
    EXPECT_EQ(count(single, LineKind::kSilhouette), 6u);
    EXPECT_EQ(count(single, LineKind::kCrease), 3u);
    EXPECT_EQ(single.at(ends({1, 1, 1}, {1, 1, 0})), LineKind::kCrease);
    EXPECT_EQ(single.at(ends({0, 1, 1}, {0, 1, 0})), LineKind::kSilhouette);
    EXPECT_EQ(single.count(ends({0, 0, 0}, {0, 0, 1})), 0u);  // of backs alone
    const Lines both = linesOf(sceneOf(cube(), true, welded), viewFrom({4, 5, 6}));
    EXPECT_EQ(both.size(), 12u);
    EXPECT_EQ(count(both, LineKind::kSilhouette), 6u);
    EXPECT_EQ(both.at(ends({0, 0, 0}, {0, 0, 1})), LineKind::kCrease);
  }
}

TEST(FeatureEdges, OfOneKindAreLeftOutWhereItIsNotAskedFor) {
  const Scene scene = sceneOf(cube(), false);
  const View view = viewFrom({4, 5, 6});
  EXPECT_EQ(linesOf(scene, view, {.creases = false}).size(), 6u);
  const Lines creases = linesOf(scene, view, {.silhouettes = false});
  EXPECT_EQ(count(creases, LineKind::kCrease), 9u);  // silhouettes are folds too
  EXPECT_TRUE(linesOf(scene, view, {.creases = false, .silhouettes = false}).empty());
  const Scene sheet = sceneOf({{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}}, true);
  EXPECT_EQ(linesOf(sheet, view).size(), 3u);
  EXPECT_TRUE(linesOf(sheet, view, {.boundaries = false}).empty());
}

TEST(FeatureEdges, AnEyeInAFacesPlaneTakesTheFaceAsShowingNothing) {
  // In the plane of the top: the front's upper border is a silhouette, the back's is not drawn.
  const Lines lines = linesOf(sceneOf(cube(), false), viewFrom({0.25, 1, 6}, {0.25, 1, 0}));
  EXPECT_EQ(lines.size(), 4u);
  EXPECT_EQ(count(lines, LineKind::kSilhouette), 4u);
  EXPECT_EQ(lines.count(ends({0, 1, 1}, {1, 1, 1})), 1u);
  // A sheet that is seen edge on shows nothing at all.
  const Scene sheet = sceneOf({{{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}}}, true);
  EXPECT_TRUE(linesOf(sheet, viewFrom({5, 0, 3})).empty());
}

TEST(FeatureEdges, ASheetAlongASlantedSightShowsNothing) {
  const Scene sheet = sceneOf({{{{0, 0, 0}, {3, -1, 0}, {0, 0, 1}}}}, true);
  for (int k = 1; k < 40; ++k) {
    View view = viewFrom({0, 0, 0}, {3, -1, k * 0.3});  // off the sheet's plane by its rounding
    view.orthographic = true;
    EXPECT_TRUE(linesOf(sheet, view).empty()) << k;
    const Vec3d beside = view.forward + Vec3d(1e-6, 0, 0);
    view.forward = beside;
    EXPECT_TRUE(linesOf(sheet, view).empty()) << "right and up decide; " << k;
    setOrientation(view, beside, {0, 1, 0});
    EXPECT_EQ(linesOf(sheet, view).size(), 3u) << k;
  }
}

TEST(FeatureEdges, ParallelViewsLookAlongForwardWhereverTheEyeIs) {
  View view = viewFrom({4, 5, 6});
  view.orthographic = true;
  const Scene scene = sceneOf(cube(), false);
  const Lines from_outside = linesOf(scene, view);
  EXPECT_EQ(from_outside.size(), 9u);
  view.eye = {0.5, 0.5, 0.5};
  EXPECT_EQ(linesOf(scene, view), from_outside);
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  EXPECT_EQ(linesOf(scene, view).size(), 4u);
}

TEST(FeatureEdges, AnOpenSheetHasNoneFromBehindUnlessItIsDoubleSided) {
  Triangles quad;
  addQuad(quad, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  const View front = viewFrom({0.3, 0.4, 5});
  const View back = viewFrom({0.3, 0.4, -5});
  EXPECT_EQ(count(linesOf(sceneOf(quad, false), front), LineKind::kBoundary), 4u);
  EXPECT_TRUE(linesOf(sceneOf(quad, false), back).empty());
  EXPECT_EQ(linesOf(sceneOf(quad, true), back).size(), 4u);
}

TEST(FeatureEdges, ABoundaryOfAFaceThatIsNotDrawnIsNoLine) {
  Triangles open = cube();
  open.resize(10);  // without the bottom
  const Lines lines = linesOf(sceneOf(open, false), viewFrom({4, 5, 6}));
  EXPECT_EQ(lines.size(), 9u);
  EXPECT_EQ(count(lines, LineKind::kBoundary), 2u);
  EXPECT_EQ(lines.at(ends({0, 0, 1}, {1, 0, 1})), LineKind::kBoundary);
  EXPECT_EQ(lines.count(ends({0, 0, 0}, {0, 0, 1})), 0u);
}

TEST(FeatureEdges, FlatSharedEdgesAreNoLinesWithReversedFacesEither) {
  for (const bool double_sided : {false, true}) {
    for (const double y : {0.0, 0.3, 3.0}) {  // also from within the wall's plane and nearly so
      Triangles quad;
      addQuad(quad, {0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1});
      std::swap(quad[1][0], quad[1][1]);
      const Lines lines = linesOf(sceneOf(quad, double_sided), viewFrom({2, y, 4}), {.crease_deg = 0.0});
      EXPECT_EQ(lines.count(ends({0, 0, 0}, {1, 0, 1})), 0u);
      EXPECT_EQ(lines.size(), y == 0.0 ? 0u : double_sided ? 4u : 2u);
    }
  }
}

// Walls at any angle, whose corners are rounded: coplanar in the file is not quite coplanar in floats.
TEST(FeatureEdges, RoundedWallsHaveNoLinesWithinFromAnyEye) {
  for (std::uint32_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto number = test::numbersFrom<double>(random);
    const double turn = number(0, 6);
    const Vec3d at(number(-200, 200), number(-200, 200), number(-200, 200));
    const auto point = [&](int i, int j) {
      return Vec3f(at + Vec3d(std::cos(turn), 0, std::sin(turn)) * (i * 0.7) + Vec3d(0, j * 0.6, 0));
    };
    Triangles wall;
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 5; ++j) {
        addQuad(wall, point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
        std::swap(wall.back()[0], wall.back()[static_cast<std::size_t>(random() % 3)]);
      }
    }
    const Vec3d eyes[] = {at + Vec3d(number(-9, 9), number(-9, 9), number(-9, 9)),
                          at + Vec3d(std::cos(turn), 0.1, std::sin(turn)) * 9.0};
    for (const Vec3d& eye : eyes) {
      for (const auto& [line, kind] : linesOf(sceneOf(wall, true), viewFrom(eye, at), {.crease_deg = 0})) {
        EXPECT_EQ(kind, LineKind::kBoundary);
      }
      EXPECT_LE(linesOf(sceneOf(wall, true), viewFrom(eye, at), {.crease_deg = 0}).size(), 20u);
    }
  }
}

TEST(FeatureEdges, AreCutAndJoinedAtTJunctions) {
  // A long face below, two short ones above, whose common corner lies on the long one's edge; at a slant, so
  // that it does only up to rounding.
  const auto at = [](double x, double y) {
    return Vec3f(Vec3d(30, 7, 20) + Vec3d(0.6, 0.1, 0.77) * x + Vec3d(0.3, 1, 0) * y);
  };
  Triangles wall{{at(0, 0), at(0.5, -1), at(1, 0)}};
  wall.push_back({at(0, 0), at(0.3, 0), at(0.1, 1)});
  wall.push_back({at(0.3, 0), at(1, 0), at(0.5, 1)});
  for (const bool sliver : {false, true}) {
    if (sliver) {
      wall.push_back({at(0, 0), at(1, 0), at(0.3, 0)});
    }
    const Lines lines = linesOf(sceneOf(wall, true), viewFrom({0, 0, 0}, Vec3d(at(0, 0))));
    EXPECT_EQ(lines.size(), 6u);
    EXPECT_EQ(count(lines, LineKind::kBoundary), 6u);
    EXPECT_EQ(lines.count(ends(at(0, 0), at(0.3, 0))), 0u);
    EXPECT_EQ(lines.count(ends(at(0, 0), at(1, 0))), 0u);
  }
  // Folded there, the two parts are creases, each once.
  wall.resize(1);
  const Vec3f up(0, 0, 3);
  wall.push_back({at(0, 0), at(0.3, 0), at(0.1, 0) + up});
  wall.push_back({at(0.3, 0), at(1, 0), at(0.5, 0) + up});
  const Lines folded = linesOf(sceneOf(wall, true), viewFrom({0, 0, 0}, Vec3d(at(0, 0))));
  EXPECT_NE(folded.at(ends(at(0, 0), at(0.3, 0))), LineKind::kBoundary);
  EXPECT_NE(folded.at(ends(at(0.3, 0), at(1, 0))), LineKind::kBoundary);
  EXPECT_EQ(folded.size(), 8u);
}

TEST(FeatureEdges, AreCutAtEachOfManyCorners) {
  // One long face below, many squares above it, at a slant in whole numbers.
  constexpr int kSquares = 200;
  const auto at = [](int x, int y) {
    return Vec3f(static_cast<float>(2 * x - y), static_cast<float>(x + 2 * y), static_cast<float>(2 * x));
  };
  Triangles wall;
  addQuad(wall, at(0, -1), at(kSquares, -1), at(kSquares, 0), at(0, 0));
  for (int i = 0; i < kSquares; ++i) {
    const int x = i * 77 % kSquares;
    addQuad(wall, at(x, 0), at(x + 1, 0), at(x + 1, 1), at(x, 1));
  }
  const Lines lines = linesOf(sceneOf(wall, true), viewFrom({0, 50, 900}));
  // The upper border in so many parts, the lower one, and two at each end; none within.
  EXPECT_EQ(lines.size(), kSquares + 5u);
  EXPECT_EQ(count(lines, LineKind::kBoundary), kSquares + 5u);
  EXPECT_EQ(lines.count(ends(at(3, 0), at(4, 0))), 0u);
}

// Corners in whole numbers, so that many have equal coordinates and many lie on edges of others.
TEST(FeatureEdges, OfTrianglesOnALatticeHaveNoCornerOnThem) {
  std::size_t cuts = 0;
  for (std::uint32_t seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    const auto corner = [&] {
      const auto whole = [&] { return static_cast<float>(random() % 9); };
      const float x = whole(), y = whole();
      return Vec3f(x, y, static_cast<float>(random() % 3));
    };
    Triangles triangles;
    std::set<std::array<float, 3>> corners;
    std::map<Ends, int> sides;
    while (triangles.size() < 60) {
      const Triangle t{corner(), corner(), corner()};
      if (const Vec3d normal = cross(Vec3d(t[1]) - Vec3d(t[0]), Vec3d(t[2]) - Vec3d(t[0]));
          normal == Vec3d()) {
        continue;
      }
      triangles.push_back(t);
      for (std::size_t k = 0; k < 3; ++k) {
        corners.insert(key(t[k]));
        ++sides[ends(t[k], t[(k + 1) % 3])];
      }
    }
    const Lines lines = linesOf(sceneOf(triangles, true), viewFrom({40.3, 50.7, 60.1}));
    EXPECT_GT(lines.size(), 150u);
    for (const auto& [line, kind] : lines) {
      const Vec3d a(line.first[0], line.first[1], line.first[2]);
      const Vec3d b(line.second[0], line.second[1], line.second[2]);
      const auto side = sides.find(line);
      cuts += side == sides.end() ? 1 : 0;
      if (side != sides.end() && side->second > 1) {
        continue;  // edges of several faces are not cut
      }
      for (const std::array<float, 3>& place : corners) {
        const Vec3d p(place[0], place[1], place[2]);
        EXPECT_FALSE(cross(p - a, b - a) == Vec3d() && dot(p - a, p - b) < 0.0) << "seed " << seed;
      }
    }
  }
  EXPECT_GT(cuts, 200u);
}

TEST(FeatureEdges, FacesThatLieOnOneAnotherCountAsOne) {
  Triangles doubled = cube();
  const Triangles once = doubled;
  doubled.insert(doubled.end(), once.begin(), once.end());
  const View view = viewFrom({4, 5, 6});
  EXPECT_EQ(linesOf(sceneOf(doubled, false), view), linesOf(sceneOf(once, false), view));
  // Back to back: drawn from both sides, like a double-sided one.
  for (Triangle triangle : once) {
    std::swap(triangle[0], triangle[1]);
    doubled.push_back(triangle);
  }
  EXPECT_EQ(linesOf(sceneOf(doubled, false), view), linesOf(sceneOf(once, true), view));
  // Cut along the other diagonal.
  Triangles crossed;
  addQuad(crossed, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0});
  addQuad(crossed, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 0});
  const Lines lines = linesOf(sceneOf(crossed, false), view);
  EXPECT_EQ(lines.count(ends({0, 0, 0}, {1, 0, 0})), 1u);
}

TEST(FeatureEdges, OfMoreThanTwoFacesAreBoundaries) {
  Triangles wings;
  for (const Vec3f tip : {Vec3f(1, 0, 0), Vec3f(-1, 0, 0), Vec3f(0, 0, 1)}) {
    wings.push_back({Vec3f(0, 0, 0), Vec3f(0, 1, 0), tip});
  }
  const View view = viewFrom({1, 2, 5});
  const Ends shared = ends({0, 0, 0}, {0, 1, 0});
  EXPECT_EQ(linesOf(sceneOf(wings, true), view).at(shared), LineKind::kBoundary);
  const Lines folds = linesOf(sceneOf(wings, true), view, {.boundaries = false});
  EXPECT_EQ(folds.at(shared), LineKind::kCrease);
  EXPECT_EQ(folds.size(), 1u);
}

TEST(FeatureEdges, ACreaseIsAsSharpAsTheAngleSays) {
  for (const int angle_deg : {5, 29, 31, 90, 150}) {
    const double angle = angle_deg * 3.14159265358979 / 180.0;
    const Vec3f tip(static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0);
    const Triangles fold{{{{0, 0, 0}, {0, 0, 1}, {-1, 0, 0}}}, {{{0, 0, 1}, {0, 0, 0}, tip}}};
    for (const double asked : {angle_deg - 0.01, angle_deg + 0.01}) {
      const Lines lines = linesOf(sceneOf(fold, true), viewFrom({-0.1, 7, 0.5}),
                                  {.silhouettes = false, .boundaries = false, .crease_deg = asked});
      EXPECT_EQ(lines.size(), asked < angle_deg ? 1u : 0u) << angle_deg;
    }
  }
  EXPECT_EQ(
      linesOf(sceneOf(cube(), true), viewFrom({4, 5, 6}), {.silhouettes = false, .crease_deg = 90}).size(),
      12u);
}

TEST(FeatureEdges, LeaveOutDegenerateTrianglesAndWhatIsNotFinite) {
  Triangles triangles = cube();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinity = std::numeric_limits<float>::infinity();
  triangles.push_back({Vec3f(0, 0, 0), Vec3f(0, 0, 0), Vec3f(3, 4, 5)});
  triangles.push_back({Vec3f(0, 0, 0), Vec3f(1, 1, 1), Vec3f(2, 2, 2)});
  triangles.push_back({Vec3f(9, 9, 9), Vec3f(9, 9, 9), Vec3f(9, 9, 9)});
  triangles.push_back({Vec3f(0, 0, 0), Vec3f(1, nan, 1), Vec3f(2, 0, 0)});
  triangles.push_back({Vec3f(0, 0, 0), Vec3f(1, infinity, 1), Vec3f(2, 0, 0)});
  const View view = viewFrom({4, 5, 6});
  EXPECT_EQ(linesOf(sceneOf(triangles, false), view), linesOf(sceneOf(cube(), false), view));
  EXPECT_TRUE(linesOf(sceneOf({}, false), view).empty());
  View lost = view;
  lost.eye.x = nan;
  EXPECT_TRUE(linesOf(sceneOf(triangles, true), lost).empty());
}

TEST(FeatureEdges, AreOfTheirObjectAlone) {
  Scene scene = sceneOf(cube(), false, true);
  Object half = scene.objects[0];
  scene.objects[0].index_count = 6;  // the front
  half.first_index = 6;
  half.index_count -= 6;
  scene.objects.push_back(half);
  const SceneView view = scene.view();
  const FeatureEdges edges(view);
  std::vector<FeatureLine> lines;
  edges.select(view, ObjectId(0u), viewFrom({4, 5, 6}), {}, lines);
  EXPECT_EQ(lines.size(), 4u);
  for (const FeatureLine& line : lines) {
    EXPECT_EQ(line.kind, LineKind::kBoundary);
  }
  edges.select(view, ObjectId(1u), viewFrom({4, 5, 6}), {}, lines);
  EXPECT_EQ(lines.size(), 7u);
}

TEST(FeatureEdges, FollowObjectsThatMove) {
  Scene scene = sceneOf(cube(), false, true);
  const SceneView view = scene.view();
  const FeatureEdges edges(view);
  std::vector<FeatureLine> still, moved;
  edges.select(view, ObjectId(0u), viewFrom({4, 5, 6}), {}, still);
  for (Vec3f& p : scene.positions) {
    p = Vec3f(1 - p.x, p.y, 1 - p.z);  // half a turn
  }
  edges.select(view, ObjectId(0u), viewFrom({-3, 5, -5}), {}, moved);
  EXPECT_EQ(still, moved);
  edges.select(view, ObjectId(0u), viewFrom({4, 5, 6}), {}, moved);
  EXPECT_NE(still, moved);
}

// A landscape over a grid of integers, with some triangles missing.
Triangles randomLandscape(const std::function<int(int)>& below) {
  constexpr int kSize = 6;
  int height[kSize + 1][kSize + 1];
  for (auto& row : height) {
    for (int& h : row) {
      h = below(3);
    }
  }
  const auto point = [&](int i, int j) {
    return Vec3f(static_cast<float>(i), static_cast<float>(height[i][j]), static_cast<float>(j));
  };
  Triangles land;
  for (int i = 0; i < kSize; ++i) {
    for (int j = 0; j < kSize; ++j) {
      addQuad(land, point(i, j), point(i, j + 1), point(i + 1, j + 1), point(i + 1, j));
    }
  }
  std::erase_if(land, [&](const Triangle&) { return below(8) == 0; });
  return land;
}

// The normal of a triangle of integers, exact in double precision.
Vec3d exactNormal(const Triangle& t) {
  return cross(Vec3d(t[1]) - Vec3d(t[0]), Vec3d(t[2]) - Vec3d(t[0]));
}

// The kind of the line between the faces of an edge, with creases from 40 degrees on; none if it is not a
// line.
std::optional<LineKind> exactKind(const Triangles& faces, const Vec3d& eye, bool double_sided) {
  std::vector<int> side;
  for (const Triangle& face : faces) {
    const double value = dot(exactNormal(face), eye - Vec3d(face[0]));
    side.push_back(value > 0 ? 1 : value < 0 ? -1 : 0);
  }
  const auto drawn = [&](int s) { return s > 0 || (s < 0 && double_sided); };
  if (std::none_of(side.begin(), side.end(), drawn)) {
    return std::nullopt;
  }
  if (faces.size() == 1) {
    return LineKind::kBoundary;
  }
  const Vec3d n = exactNormal(faces[0]), m = exactNormal(faces[1]);
  const double across = dot(cross(n, m), cross(n, m));
  if (across == 0) {
    return std::nullopt;
  }
  if (side[0] != side[1]) {
    return LineKind::kSilhouette;
  }
  // The squared tangent of 40 degrees is 0.70409; normals of landscapes are less than 180 degrees apart.
  const bool sharp = dot(n, m) <= 0 || across >= 0.70408778 * dot(n, m) * dot(n, m);
  return sharp ? std::optional(LineKind::kCrease) : std::nullopt;
}

TEST(FeatureEdges, AgreeWithExactArithmeticOnLandscapes) {
  for (std::uint32_t seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
    const Triangles land = randomLandscape(below);
    const bool double_sided = below(2) == 0;
    const Vec3d eye(below(13) - 3, below(7) - 2, below(13) - 3);
    std::map<Ends, Triangles> faces;
    for (const Triangle& face : land) {
      for (std::size_t k = 0; k < 3; ++k) {
        faces[ends(face[k], face[(k + 1) % 3])].push_back(face);
      }
    }
    Lines expected;
    for (const auto& [line, of] : faces) {
      if (const std::optional<LineKind> kind = exactKind(of, eye, double_sided)) {
        expected[line] = *kind;
      }
    }
    EXPECT_EQ(linesOf(sceneOf(land, double_sided, below(2) == 0), viewFrom(eye, {3.1, 0.2, 3.3}),
                      {.crease_deg = 40}),
              expected);
  }
}

// The winding of double-sided faces does not matter.
TEST(FeatureEdges, OfDoubleSidedSurfacesDoNotDependOnTheWinding) {
  for (std::uint32_t seed = 1; seed <= 30; ++seed) {
    SCOPED_TRACE(seed);
    std::mt19937 random(seed);
    Triangles turned = cube();
    for (Triangle& triangle : turned) {
      if (random() % 2 == 0) {
        std::swap(triangle[1], triangle[2]);
      }
    }
    const View view = viewFrom({4, 5, 6});
    EXPECT_EQ(linesOf(sceneOf(turned, true), view), linesOf(sceneOf(cube(), true), view));
  }
}

}  // namespace
}  // namespace sightline
