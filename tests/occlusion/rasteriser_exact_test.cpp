// Depth buffers of the rasteriser against exact arithmetic, on scenes with small integer coordinates: many
// ties.

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "sightline/comparison/centre_coverage.h"
#include "sightline/occlusion/rasteriser.h"
#include "tests/occlusion/exact_coverage.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using exact::Point;
using exact::Polygon;
using exact::WholeNumbers;

struct LatticeScene {
  std::string kind;
  exact::Camera camera;
  std::vector<Polygon> polygons;
  bool mesh = false;  // triangles, from which findOccluders makes the set
};

// Mostly in view of a perspective camera of 90 degrees.
Point anyPoint(WholeNumbers& random) {
  const std::int64_t x = random.in(-24, 24), y = random.in(-24, 24);
  return {x, y, random.in(6, 30)};
}

Point operator+(const Point& a, const Point& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
Point operator-(const Point& a, const Point& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
Point operator*(const Point& a, std::int64_t s) {
  return {a.x * s, a.y * s, a.z * s};
}

// Returns a polygon that mostly faces the camera.
Polygon facing(const exact::Camera& camera, WholeNumbers& random, std::vector<Point> vertices) {
  Polygon polygon{std::move(vertices), random.once(3)};
  if (!exact::imageOf(camera, {polygon.vertices, false}) && !random.once(10)) {
    std::reverse(polygon.vertices.begin(), polygon.vertices.end());
  }
  return polygon;
}

// A convex polygon on the lattice of two random vectors.
std::vector<Point> latticePolygon(WholeNumbers& random) {
  static const std::vector<std::vector<std::pair<int, int>>> kShapes = {
      {{0, 0}, {1, 0}, {0, 1}},
      {{0, 0}, {2, 0}, {2, 2}, {0, 2}},
      {{0, 0}, {2, 0}, {2, 1}, {1, 2}, {0, 2}},
      {{1, 0}, {2, 0}, {3, 1}, {3, 2}, {2, 3}, {1, 3}, {0, 2}, {0, 1}},
      {{0, 0}, {3, 1}, {2, 2}, {0, 1}}};
  const auto& shape = kShapes[static_cast<std::size_t>(random.in(0, 4))];
  const Point at{random.in(-20, 4), random.in(-20, 4), random.in(8, 24)};
  const Point u{random.in(2, 14), random.in(-6, 6), random.in(-3, 3)};
  const Point v{random.in(-6, 6), random.in(2, 14), random.in(-3, 3)};
  std::vector<Point> vertices;
  for (const auto& [i, j] : shape) {
    vertices.push_back(at + u * i + v * j);
  }
  return vertices;
}

void addPolygons(LatticeScene& scene, WholeNumbers& random) {
  scene.kind = "polygons";
  for (std::int64_t i = random.in(1, 4); i > 0; --i) {
    scene.polygons.push_back(
        facing(scene.camera, random,
               random.once(3) ? std::vector<Point>{anyPoint(random), anyPoint(random), anyPoint(random)}
                              : latticePolygon(random)));
  }
}

// Two or three triangles with a common edge: about half of them fold over, and lie on one side of it.
void addPair(LatticeScene& scene, WholeNumbers& random) {
  scene.kind = "pair";
  const Point p = anyPoint(random), q = anyPoint(random);
  for (std::int64_t i = random.once(3) ? 3 : 2; i > 0; --i) {
    scene.polygons.push_back(facing(scene.camera, random, {p, q, anyPoint(random)}));
  }
}

// Two triangles whose images share an edge that they do not share themselves: a gap.
void addTouching(LatticeScene& scene, WholeNumbers& random) {
  scene.kind = "touching";
  const Point p = anyPoint(random), q = anyPoint(random), behind{0, 0, random.in(1, 9)};
  const auto farther = [&](const Point& a) { return scene.camera.orthographic ? a + behind : a * 2; };
  scene.polygons.push_back(facing(scene.camera, random, {p, q, anyPoint(random)}));
  scene.polygons.push_back(facing(scene.camera, random, {farther(p), farther(q), farther(anyPoint(random))}));
}

constexpr std::pair<int, int> kDirections[] = {{8, 0},  {6, 5},   {0, 8},  {-5, 6},
                                               {-8, 1}, {-6, -6}, {1, -8}, {5, -5}};

// Triangles around a vertex, all around it or with some left out.
void addFan(LatticeScene& scene, WholeNumbers& random) {
  scene.kind = "fan";
  const Point middle{random.in(-5, 5), random.in(-5, 5), random.in(8, 20)};
  std::vector<Point> ring;
  for (const auto& [x, y] : kDirections) {
    const std::int64_t size = random.in(1, 4);
    ring.push_back({middle.x + x * size / 2, middle.y + y * size / 2, random.in(8, 20)});
  }
  const std::size_t missing = static_cast<std::size_t>(random.in(0, 15));
  for (std::size_t i = 0; i < 8; ++i) {
    if (i != missing) {
      scene.polygons.push_back(facing(scene.camera, random, {middle, ring[i], ring[(i + 1) % 8]}));
    }
  }
}

// A row of upright walls that overlap each other where the row turns back.
void addStrip(LatticeScene& scene, WholeNumbers& random) {
  scene.kind = "strip";
  Point at{-20, -10, random.in(8, 20)};
  for (int i = 0; i < 5; ++i) {
    const Point next{at.x + random.in(random.once(3) ? -5 : 2, 12), at.y, random.in(8, 20)};
    const Point up{0, 20, 0};
    if (!(next == at)) {
      scene.polygons.push_back(facing(scene.camera, random, {at, next, next + up, at + up}));
    }
    at = next;
  }
}

// A wall of triangles over a grid with random depths.
void addGrid(LatticeScene& scene, WholeNumbers& random) {
  scene.kind = "grid";
  const std::int64_t n = random.in(2, 4), step = random.in(4, 9), rough = random.in(0, 3);
  std::vector<Point> points;
  for (std::int64_t i = 0; i < (n + 1) * (n + 1); ++i) {
    points.push_back({(i % (n + 1) - n / 2) * step, (i / (n + 1) - n / 2) * step, 16 + random.in(0, rough)});
  }
  for (std::int64_t y = 0; y < n; ++y) {
    for (std::int64_t x = 0; x < n; ++x) {
      const auto at = [&](std::int64_t i, std::int64_t j) {
        return points[static_cast<std::size_t>((y + j) * (n + 1) + x + i)];
      };
      scene.polygons.push_back({{at(0, 0), at(1, 0), at(1, 1)}, false});
      scene.polygons.push_back({{at(0, 0), at(1, 1), at(0, 1)}, false});
    }
  }
}

// A wall with two or three other walls on its long upper edge, which lean towards or away from each other.
void addTJunction(LatticeScene& scene, WholeNumbers& random) {
  scene.kind = "T-junction";
  scene.mesh = true;
  const std::int64_t parts = random.in(2, 3);
  const Point a{random.in(-22, -10), random.in(-6, 6), random.in(8, 20)};
  const Point step{random.in(6, 12), random.in(-3, 3), random.in(-1, 1)};
  const Point down{random.in(-3, 3), random.in(-12, -4), random.in(-2, 2)};
  std::vector<Point> edge;
  for (std::int64_t i = 0; i <= parts; ++i) {
    edge.push_back(a + step * i);
  }
  const auto add = [&](const Point& p, const Point& q, const Point& r) {
    scene.polygons.push_back({{p, q, r}, false});
  };
  for (std::size_t i = 0; i + 1 < edge.size(); ++i) {
    add(edge.front() + down, edge[i + 1], edge[i]);
    const Point lean{random.in(-6, 6), random.in(random.once(6) ? -6 : 2, 14), random.in(-6, 6)};
    if (random.once(8)) {
      continue;  // open here
    }
    add(edge[i], edge[i + 1], edge[i] + lean);
    if (random.once(2)) {
      add(edge[i + 1], edge[i + 1] + lean, edge[i] + lean);
    }
  }
  add(edge.front() + down, edge.back() + down, edge.back());
}

// Polygons of any kind with corners on both sides of the near plane, on it, and behind the eye.
void addNear(LatticeScene& scene, WholeNumbers& random) {
  scene.kind = "near plane";
  scene.camera.near = random.in(1, 4);
  const auto point = [&] { return Point{random.in(-12, 12), random.in(-12, 12), random.in(-8, 12)}; };
  const Point p = point(), q = point();
  scene.polygons.push_back(facing(scene.camera, random, {p, q, point()}));
  scene.polygons.push_back(facing(scene.camera, random, {p, q, point()}));
  const Point floor{-20, random.in(-6, -1), random.in(-6, 6)};
  scene.polygons.push_back(
      facing(scene.camera, random,
             {floor, floor + Point{40, 0, 0}, floor + Point{40, 0, 30}, floor + Point{0, 0, 30}}));
}

LatticeScene randomScene(std::uint64_t seed) {
  WholeNumbers random(seed);
  LatticeScene scene;
  scene.camera.width = random.once(8) ? 1 : random.in(1, 16);
  scene.camera.height = random.once(8) ? 1 : random.in(1, 12);
  scene.camera.orthographic = random.once(3);
  const std::int64_t g = std::int64_t{1} << random.in(0, 1);
  scene.camera.gx = scene.camera.orthographic ? 16 * g : g;
  scene.camera.gy = scene.camera.orthographic ? 16 : 1;
  constexpr void (*kKinds[])(LatticeScene&, WholeNumbers&) = {
      addPolygons, addPair, addTouching, addFan, addStrip, addGrid, addNear, addTJunction};
  kKinds[seed % std::size(kKinds)](scene, random);
  return scene;
}

std::string describe(const LatticeScene& scene, std::uint64_t seed) {
  std::ostringstream text;
  const exact::Camera& c = scene.camera;
  text << "seed " << seed << ", " << scene.kind << (c.orthographic ? ", orthographic" : "") << ", " << c.width
       << " x " << c.height << ", g " << c.gx << " " << c.gy << ", near " << c.near << "\n";
  for (const Polygon& polygon : scene.polygons) {
    text << (polygon.double_sided ? "  both" : "  front");
    for (const Point& p : polygon.vertices) {
      text << " (" << p.x << " " << p.y << " " << p.z << ")";
    }
    text << "\n";
  }
  return text.str();
}

// An axis-aligned camera at a random place, with a scene in front of it.
struct Placed {
  Placed(const LatticeScene& scene, std::uint64_t seed) {
    constexpr int kForward[] = {-3, 1, -2};  // along -z, x, -y
    const int way = kForward[seed % 3];
    const Vec3d forward = way == -3 ? Vec3d(0, 0, -1) : way == 1 ? Vec3d(1, 0, 0) : Vec3d(0, -1, 0);
    view = exact::viewOf(scene.camera, seed % 2 == 0 ? Vec3d(0, 0, 0) : Vec3d(10, -20, 30), forward,
                         way == -2 ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0));
    std::vector<OccluderPolygon> input;
    std::vector<std::vector<Vec3f>> vertices;
    for (const Polygon& polygon : scene.polygons) {
      vertices.emplace_back();
      for (const Point& p : polygon.vertices) {
        vertices.back().push_back(exact::inScene(view, p));
      }
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      input.push_back({vertices[i], scene.polygons[i].double_sided, ObjectId(0u)});
    }
    set = scene.mesh ? exact::setOfMesh(vertices) : makeOccluders(input);
    for (std::size_t i = 0; i < set.occluders.size(); ++i) {
      chosen.push_back(OccluderId(i));
    }
  }
  DepthBufferView draw(const exact::Camera& camera, const CoverageRule* coverage) {
    rasteriser = Rasteriser(
        {static_cast<std::uint32_t>(camera.width), static_cast<std::uint32_t>(camera.height), coverage});
    rasteriser.begin(view);
    rasteriser.draw(set, chosen);
    return rasteriser.depthBuffer();
  }

  View view;
  OccluderSet set;
  std::vector<OccluderId> chosen;
  Rasteriser rasteriser;
};

// Calls look(x, y, stored) for all pixels; stored is kUncovered or the reciprocal depth.
template <typename Look>
void forEachPixel(const DepthBufferView& buffer, Look&& look) {
  for (std::uint32_t y = 0; y < buffer.height; ++y) {
    for (std::uint32_t x = 0; x < buffer.width; ++x) {
      look(std::int64_t{x}, std::int64_t{y}, buffer.at(x, y));
    }
  }
}

TEST(ExactCoverage, TellsSurfacesGapsAndDepthsApart) {
  // Pixels are four metres wide at depth 8.
  const exact::Camera camera{.width = 4, .height = 4};
  const auto quad = [](std::int64_t x0, std::int64_t x1, std::int64_t z0, std::int64_t z1) {
    return Polygon{{{x0, -500, z0}, {x1, -500, z1}, {x1, 500, z1}, {x0, 500, z0}}, false};
  };
  const auto hides = [&](const std::vector<Polygon>& polygons, double reciprocal_depth) {
    bool any = false;
    for (const exact::Surface& surface : exact::surfacesOf(camera, polygons)) {
      any |= exact::hides(surface, exact::pixel(2, 1), reciprocal_depth);
    }
    return any;
  };
  EXPECT_TRUE(hides({quad(0, 4, 8, 8)}, 0.125));
  EXPECT_FALSE(hides({quad(0, 4, 8, 8)}, std::nextafter(0.125, 1.0)));
  EXPECT_FALSE(hides({quad(0, 3, 8, 8)}, 0.0));
  EXPECT_TRUE(hides({quad(0, 2, 8, 8), quad(2, 9, 8, 8)}, 0.125));
  EXPECT_FALSE(hides({quad(0, 200, 800, 800), quad(201, 900, 800, 800)}, 0.0));  // a gap
  EXPECT_FALSE(hides({quad(0, 2, 8, 8), quad(4, 9, 16, 16)}, 0.0));              // not connected
  EXPECT_TRUE(hides({quad(0, 2, 8, 6), quad(2, 12, 6, 12)}, 1.0 / 8.0 - 1e-9));
  EXPECT_FALSE(hides({quad(0, 2, 8, 6), quad(2, 12, 6, 12)}, 1.0 / 8.0 + 1e-9));
  // Folded: the nearer of two that overlap is only so near where it is.
  EXPECT_FALSE(hides({quad(0, 30, 8, 8), quad(0, 1, 8, 4)}, 0.15));
  EXPECT_TRUE(hides({quad(0, 30, 8, 8), quad(0, 1, 8, 4)}, 0.124));
  EXPECT_FALSE(hides({{{{0, -500, 8}, {0, 500, 8}, {4, 500, 8}, {4, -500, 8}}, false}}, 0.0));  // a back
}

const std::uint64_t kScenes = test::rounds<std::uint64_t>(14000);

// Whether the rasteriser is expected to use a polygon in full: no sharp corner, not seen at a grazing angle,
// not in the near plane itself.
bool isWellShaped(const exact::Camera& camera, const Polygon& polygon) {
  const auto toVec = [](const Point& p) {
    return Vec3d(static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z));
  };
  if (std::ranges::all_of(polygon.vertices, [&](const Point& p) { return p.z <= camera.near; })) {
    return false;
  }
  const std::size_t n = polygon.vertices.size();
  Vec3d normal;
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3d u = normalized(toVec(polygon.vertices[(i + 1) % n] - polygon.vertices[i]));
    const Vec3d v = normalized(toVec(polygon.vertices[(i + n - 1) % n] - polygon.vertices[i]));
    if (length(cross(u, v)) < 0.1) {
      return false;
    }
    normal = normalized(cross(u, v));
  }
  for (const Point& p : polygon.vertices) {
    const Vec3d line = camera.orthographic ? Vec3d(0, 0, 1) : normalized(toVec(p));
    if (std::abs(dot(normal, line)) < 0.02) {
      return false;
    }
  }
  return true;
}

// Whether the stored depth is at most one hundredth farther than that of an exact buffer.
bool isNear(float stored, double exact) {
  return stored > kUncovered && static_cast<double>(stored) >= exact - 0.01 * std::abs(exact);
}

// A scene with its exact surfaces, and its buffer.
struct DrawnScene {
  explicit DrawnScene(std::uint64_t s)
      : seed(s),
        scene(randomScene(seed)),
        surfaces(exact::surfacesOf(scene.camera, scene.polygons)),
        placed(scene, seed),
        buffer(placed.draw(scene.camera, nullptr)) {
    for (const Polygon& polygon : scene.polygons) {
      well_shaped.push_back(isWellShaped(scene.camera, polygon));
    }
  }

  std::uint64_t seed;
  LatticeScene scene;
  std::vector<exact::Surface> surfaces;
  std::vector<bool> well_shaped;  // by polygon
  Placed placed;
  DepthBufferView buffer;
};

// The pixels that one promise is about, over all scenes, and how many of them break it.
struct Promise {
  int pixels = 0, failures = 0;

  void fail(const DrawnScene& drawn, std::int64_t x, std::int64_t y, float stored, const std::string& what) {
    if (failures++ < 5) {
      ADD_FAILURE() << "pixel " << x << " " << y << " stored " << stored << ", " << what << "\n"
                    << describe(drawn.scene, drawn.seed);
    }
  }
};

// A covered pixel is hidden wholly by one surface, no nearer than it is. across: pixels that several polygons
// hide together.
void checkHidden(const DrawnScene& drawn, Promise& promise, int& across) {
  forEachPixel(drawn.buffer, [&](std::int64_t x, std::int64_t y, float stored) {
    if (!(stored > kUncovered)) {
      return;
    }
    ++promise.pixels;
    const exact::Part pixel = exact::pixel(x, y);
    bool hidden = false, by_one = false;
    for (const exact::Surface& surface : drawn.surfaces) {
      hidden |= exact::hides(surface, pixel, static_cast<double>(stored));
      for (const exact::Image& image : surface.images) {
        by_one |= exact::contains(image.part, pixel);
      }
    }
    across += by_one ? 0 : 1;
    if (!hidden) {
      promise.fail(drawn, x, y, stored, "not hidden");
    }
  });
}

// A pixel within a polygon is covered, with nearly its depth.
void checkWithinOne(const DrawnScene& drawn, Promise& promise) {
  for (const exact::Surface& surface : drawn.surfaces) {
    for (const exact::Image& image : surface.images) {
      if (!drawn.well_shaped[image.polygon]) {
        continue;
      }
      forEachPixel(drawn.buffer, [&](std::int64_t x, std::int64_t y, float stored) {
        if (!exact::contains(image.part, exact::pixel(x, y, 10))) {
          return;
        }
        ++promise.pixels;
        const double reciprocal_depth = image.minReciprocalDepth(exact::pixel(x, y));
        if (!isNear(stored, reciprocal_depth)) {
          promise.fail(drawn, x, y, stored,
                       "within polygon " + std::to_string(image.polygon) + ", exact " +
                           std::to_string(reciprocal_depth));
        }
      });
    }
  }
}

// A pixel within several polygons that share edges is covered: there are no open pixels along shared edges.
void checkWithinSeveral(const DrawnScene& drawn, Promise& promise) {
  for (const exact::Surface& surface : drawn.surfaces) {
    const bool well_shaped = std::ranges::all_of(
        surface.images, [&](const exact::Image& image) { return drawn.well_shaped[image.polygon]; });
    if (!surface.sheet || surface.tie || surface.images.size() < 2 || !well_shaped) {
      continue;
    }
    forEachPixel(drawn.buffer, [&](std::int64_t x, std::int64_t y, float stored) {
      if (!exact::covers(surface, exact::pixel(x, y, 4))) {
        return;
      }
      ++promise.pixels;
      const double reciprocal_depth = exact::minReciprocalDepthOfPlanes(surface, x, y);
      if (!isNear(stored, reciprocal_depth)) {
        promise.fail(drawn, x, y, stored,
                     "within several polygons, exact " + std::to_string(reciprocal_depth));
      }
    });
  }
}

TEST(RasteriserExact, CoversOnlyWhatOneSurfaceHidesAndAllThatLiesWithinItsPolygons) {
  Promise hidden, within_one, within_several;
  int across = 0;
  for (std::uint64_t seed = 0; seed < kScenes; ++seed) {
    const DrawnScene drawn(seed);
    checkHidden(drawn, hidden, across);
    checkWithinOne(drawn, within_one);
    checkWithinSeveral(drawn, within_several);
  }
  EXPECT_GT(hidden.pixels, test::rounds(20000));
  EXPECT_GT(across, test::rounds(2000));
  EXPECT_GT(within_one.pixels, test::rounds(20000));
  EXPECT_GT(within_several.pixels, test::rounds(5000));
}

// The rule for centres is there for a comparison alone, so that a quarter of the scenes is enough for it.
TEST(RasteriserExact, CentresAreCoveredWhereAPolygonContainsThemWithItsDepthThere) {
  int covered = 0, failures = 0;
  for (std::uint64_t seed = 0; seed < kScenes / 4 && failures < 5; ++seed) {
    const LatticeScene scene = randomScene(seed);
    const std::vector<exact::Surface> surfaces = exact::surfacesOf(scene.camera, scene.polygons);
    const bool well_shaped = std::ranges::all_of(
        scene.polygons, [&](const Polygon& polygon) { return isWellShaped(scene.camera, polygon); });
    Placed placed(scene, seed);
    forEachPixel(placed.draw(scene.camera, centreCoverage()), [&](std::int64_t x, std::int64_t y,
                                                                  float stored) {
      const exact::Triple centre{2 * x + 1, 2 * y + 1, 2};
      double nearest = -INFINITY;
      for (const exact::Surface& surface : surfaces) {
        for (const exact::Image& image : surface.images) {
          bool inside = true;
          for (const exact::Triple& line : image.part) {
            const exact::Wide value = dot(line, centre);
            if (value == 0) {
              return;  // a tie
            }
            inside &= value > 0;
          }
          nearest = inside ? std::max(nearest, image.reciprocalDepthAt(centre)) : nearest;
        }
      }
      const bool is_covered = stored > kUncovered, should = nearest > -INFINITY;
      // Badly shaped polygons may be left out, but no pixel may be covered without one.
      const bool right_depth = std::abs(static_cast<double>(stored) - nearest) <= 1e-5 * std::abs(nearest);
      const bool wrong =
          well_shaped ? is_covered != should || (should && !right_depth) : is_covered && !should;
      covered += is_covered ? 1 : 0;
      if (wrong && failures++ < 5) {
        ADD_FAILURE() << "pixel " << x << " " << y << " stored " << stored << " exact " << nearest << "\n"
                      << describe(scene, seed);
      }
    });
  }
  EXPECT_GT(covered, test::rounds(12500));
}

}  // namespace
}  // namespace sightline
