// Depth buffers of whole surfaces against exact arithmetic, on meshes with small integer coordinates: corners
// on corners and centres of pixels, edges through them, and edges that coincide without being shared.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <sstream>

#include "sightline/occluders/surface_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "tests/occlusion/exact_coverage.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using exact::Point;
using exact::WholeNumbers;
using Triangle = std::array<Point, 3>;

// What is drawn, in camera space.
struct SurfaceCase {
  std::string kind;
  exact::Camera camera;
  std::vector<Triangle> single, both;  // single-sided and double-sided
};

// Adds a triangle, turned over once in so many times; never if that is 0.
void add(SurfaceCase& made, WholeNumbers& random, Triangle triangle, std::int64_t turned) {
  if (turned > 0 && random.once(turned)) {
    std::swap(triangle[1], triangle[2]);
  }
  (random.once(6) ? made.both : made.single).push_back(triangle);
}

// A quad whose front is turned to the eye if its corners go round counter-clockwise as the eye sees them.
void addQuad(SurfaceCase& made, WholeNumbers& random, const std::array<Point, 4>& q, std::int64_t turned) {
  add(made, random, {q[0], q[1], q[2]}, turned);
  add(made, random, {q[0], q[2], q[3]}, turned);
}

// A wall of small triangles, some of them left out or turned over. On the plane z = 16, in maps of 16 pixels
// and more, its corners are corners and centres of pixels.
void addGrid(SurfaceCase& made, WholeNumbers& random) {
  made.kind += " grid";
  const std::int64_t n = random.in(2, 6), step = random.in(1, 6), z = random.once(3) ? random.in(8, 24) : 16,
                     rough = random.once(2) ? 0 : random.in(1, 3), x0 = random.in(-12, 2),
                     y0 = random.in(-12, 2), holes = random.once(2) ? 0 : random.in(6, 20),
                     turned = random.once(2) ? 0 : random.in(6, 20);
  std::vector<Point> points;
  for (std::int64_t i = 0; i < (n + 1) * (n + 1); ++i) {
    points.push_back(
        {x0 + (i % (n + 1)) * step, y0 + (i / (n + 1)) * step, z + (rough > 0 ? random.in(0, rough) : 0)});
  }
  for (std::int64_t i = 0; i < n * n; ++i) {
    const auto corner = [&](std::int64_t x, std::int64_t y) {
      return points[static_cast<std::size_t>((i / n + y) * (n + 1) + i % n + x)];
    };
    if (holes == 0 || !random.once(holes)) {
      addQuad(made, random, {corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)}, turned);
    }
  }
}

// Upright quads in a row that turns back over itself.
void addFoldedStrip(SurfaceCase& made, WholeNumbers& random) {
  made.kind += " folded strip";
  Point at{random.in(-16, -4), random.in(-14, -2), random.in(8, 20)};
  const std::int64_t height = random.in(4, 24), turned = random.once(3) ? 8 : 0;
  for (std::int64_t i = random.in(3, 9); i > 0; --i) {
    const Point next{at.x + random.in(random.once(3) ? -8 : 1, 9), at.y, random.in(8, 20)};
    if (!(next == at)) {
      addQuad(made, random,
              {at, next, Point{next.x, next.y + height, next.z}, Point{at.x, at.y + height, at.z}}, turned);
    }
    at = next;
  }
}

// Two to five triangles at one edge.
void addSheetsAtEdge(SurfaceCase& made, WholeNumbers& random) {
  made.kind += " sheets at an edge";
  const auto point = [&] { return Point{random.in(-24, 24), random.in(-24, 24), random.in(6, 30)}; };
  const Point low = point(), high = random.once(2) ? Point{low.x, low.y + 20, low.z} : point();
  for (std::int64_t i = random.in(2, 5); i > 0; --i) {
    add(made, random, {low, high, point()}, 2);
  }
}

// Triangles between the same few points: edges of any number of them, and of both directions.
void addTangle(SurfaceCase& made, WholeNumbers& random) {
  made.kind += " tangle";
  std::vector<Point> points;
  for (std::int64_t i = random.in(5, 8); i > 0; --i) {
    points.push_back({random.in(-20, 20), random.in(-20, 20), random.once(2) ? 16 : random.in(-4, 30)});
  }
  const auto last = static_cast<std::int64_t>(points.size()) - 1;
  for (std::int64_t i = random.in(4, 16); i > 0; --i) {
    const auto a = random.in(0, last), b = random.in(0, last), c = random.in(0, last);
    if (a != b && b != c && c != a) {
      add(made, random,
          {points[static_cast<std::size_t>(a)], points[static_cast<std::size_t>(b)],
           points[static_cast<std::size_t>(c)]},
          0);
    }
  }
}

// Two walls of which the second one's edge, or its image, lies on the first one's but has other vertices.
void addTouchingWalls(SurfaceCase& made, WholeNumbers& random) {
  made.kind += " touching walls";
  const std::int64_t x = random.in(-6, 6), y = random.in(-20, -4), z = 8 * random.in(1, 2),
                     size = random.in(4, 20), far = random.once(2) ? 1 : 2;
  addQuad(made, random,
          {Point{x - size, y, z}, Point{x, y, z}, Point{x, y + size, z}, Point{x - size, y + size, z}}, 0);
  const std::int64_t middle = random.in(1, size);
  for (const auto& [from, to] : {std::pair(std::int64_t{0}, middle), {middle, size}}) {
    const std::int64_t low = far * (y + from), high = far * (y + to), near_x = far * x,
                       right = far * (x + size);
    addQuad(made, random,
            {Point{near_x, low, far * z}, Point{right, low, far * z}, Point{right, high, far * z},
             Point{near_x, high, far * z}},
            0);
  }
}

// A floor under the eye and walls beside it that the near plane may cut anywhere.
void addRoom(SurfaceCase& made, WholeNumbers& random) {
  made.kind += " room";
  made.camera.near = random.in(1, 9);
  const std::int64_t left = -random.in(2, 12), right = random.in(2, 12), low = -random.in(2, 8),
                     high = random.in(2, 8), back = random.in(-4, 8), end = random.in(9, 30);
  addQuad(made, random, {Point{left, low, back}, {right, low, back}, {right, low, end}, {left, low, end}}, 0);
  addQuad(made, random, {Point{left, low, end}, {right, low, end}, {right, high, end}, {left, high, end}}, 0);
  addQuad(made, random, {Point{left, low, back}, {left, low, end}, {left, high, end}, {left, high, back}}, 0);
  if (random.once(2)) {
    addQuad(made, random,
            {Point{right, low, end}, {right, low, back}, {right, high, back}, {right, high, end}}, 0);
  }
}

SurfaceCase randomCase(std::uint64_t seed) {
  WholeNumbers random(seed);
  SurfaceCase made;
  constexpr std::int64_t kSizes[] = {8, 12, 16, 24, 32};
  made.camera.width = kSizes[random.in(0, 4)];
  made.camera.height = kSizes[random.in(0, 2)];
  made.camera.orthographic = random.once(3);
  made.camera.gx = made.camera.gy = made.camera.orthographic ? 16 : 1;
  made.camera.near = random.once(3) ? random.in(10, 18) : 1;
  constexpr void (*kKinds[])(SurfaceCase&, WholeNumbers&) = {addGrid,   addFoldedStrip,   addSheetsAtEdge,
                                                             addTangle, addTouchingWalls, addRoom};
  kKinds[seed % std::size(kKinds)](made, random);
  if (random.once(3)) {
    kKinds[random.in(0, 4)](made, random);
  }
  return made;
}

std::string describe(const SurfaceCase& made, std::uint64_t seed) {
  std::ostringstream text;
  const exact::Camera& c = made.camera;
  text << "seed " << seed << "," << made.kind << (c.orthographic ? ", orthographic" : "") << ", " << c.width
       << " x " << c.height << ", near " << c.near << "\n";
  for (const std::vector<Triangle>* triangles : {&made.single, &made.both}) {
    for (const Triangle& triangle : *triangles) {
      text << (triangles == &made.both ? "  both" : "  front");
      for (const Point& p : triangle) {
        text << " (" << p.x << " " << p.y << " " << p.z << ")";
      }
      text << "\n";
    }
  }
  return text.str();
}

class DrawnCase {
 public:
  // one_part: no seams between parts, beside which large pixels may stay open.
  DrawnCase(const SurfaceCase& made, std::uint64_t seed, bool one_part) {
    WholeNumbers random(~seed);
    const Vec3d forward = random.once(2) ? Vec3d(0, 0, -1) : Vec3d(1, 0, 0),
                eye = random.once(2) ? Vec3d(0, 0, 0) : Vec3d(10, -20, 30);
    view_ = exact::viewOf(made.camera, eye, forward, Vec3d(0, 1, 0));
    const exact::Camera& c = made.camera;
    addObject(made.single, false);
    addObject(made.both, true);
    updateBounds(scene_);
    constexpr std::uint32_t kPieces[] = {1, 3, 16, 1024};
    const auto piece = [&] { return kPieces[random.in(0, 3)]; };
    surfaces_ = findSurfaces(scene_.view(), {.part_triangles = one_part ? 1024u : piece(),
                                             .patch_triangles = piece(),
                                             .cluster_triangles = piece(),
                                             .max_angle_deg = random.once(2) ? 10.0 : 180.0});
    rasteriser_ = Rasteriser({static_cast<std::uint32_t>(c.width), static_cast<std::uint32_t>(c.height)});
    rasteriser_.begin(view_);
    rasteriser_.draw(surfaces_, surfaces_.objects,
                     {.limits = {.min_pixels = 0.0, .min_patch_pixels = 0.0, .pixels_per_edge = 0.0}});
  }
  DepthBufferView buffer() const { return rasteriser_.depthBuffer(); }

 private:
  void addObject(std::span<const Triangle> triangles, bool double_sided) {
    Object object;
    object.first_index = static_cast<std::uint32_t>(scene_.indices.size());
    object.index_count = static_cast<std::uint32_t>(3 * triangles.size());
    object.material = MaterialId(scene_.materials.size());
    scene_.materials.push_back({"", Opacity::kOpaque, double_sided, {}});
    for (const Triangle& triangle : triangles) {
      for (const Point& p : triangle) {
        scene_.indices.push_back(static_cast<std::uint32_t>(scene_.positions.size()));
        scene_.positions.push_back(exact::inScene(view_, p));
      }
    }
    scene_.objects.push_back(object);
  }

  View view_;
  Scene scene_;
  SurfaceSet surfaces_;
  Rasteriser rasteriser_;
};

// All triangles as one surface, since any set of them may hide a pixel together.
exact::Surface allImages(const SurfaceCase& made) {
  exact::Surface all{.images = {}, .sheet = false};
  for (const std::vector<Triangle>* triangles : {&made.single, &made.both}) {
    for (const Triangle& t : *triangles) {
      if (auto image = exact::imageOf(made.camera, {{t.begin(), t.end()}, triangles == &made.both})) {
        all.images.push_back(std::move(*image));
      }
    }
  }
  return all;
}

// Keeps the images of a surface that a pixel touches.
exact::Surface within(const exact::Surface& all, const exact::Part& pixel) {
  exact::Surface some{.images = {}, .sheet = false};
  for (const exact::Image& image : all.images) {
    if (!exact::intersection(pixel, image.part).empty()) {
      some.images.push_back(image);
    }
  }
  return some;
}

TEST(SurfacesExact, CoverOnlyPixelsOfWhichEveryPointIsHidden) {
  std::size_t covered = 0, across = 0, failures = 0;
  for (std::uint64_t seed = 0; seed < test::rounds(3000u) && failures < 5; ++seed) {
    const SurfaceCase made = randomCase(seed);
    const exact::Surface all = allImages(made);
    const DrawnCase drawn(made, seed, false);
    const DepthBufferView buffer = drawn.buffer();
    for (std::uint32_t y = 0; y < buffer.height; ++y) {
      for (std::uint32_t x = 0; x < buffer.width && failures < 5; ++x) {
        if (!buffer.covered(x, y)) {
          continue;
        }
        ++covered;
        const exact::Part pixel = exact::pixel(x, y);
        const exact::Surface touching = within(all, pixel);
        const auto contains = [&](const exact::Image& image) { return exact::contains(image.part, pixel); };
        across += std::ranges::none_of(touching.images, contains) ? 1 : 0;
        if (!exact::hides(touching, pixel, static_cast<double>(buffer.at(x, y)))) {
          ++failures;
          ADD_FAILURE() << "pixel " << x << " " << y << " stored " << buffer.at(x, y) << "\n"
                        << describe(made, seed);
        }
      }
    }
  }
  EXPECT_GT(covered, test::rounds(50'000u));
  EXPECT_GT(across, test::rounds(10'000u));  // hidden by several triangles together
}

// A rectangle of small triangles leaves no pixel open that lies inside it, whatever its edges coincide with.
TEST(SurfacesExact, CoverAllPixelsInsideARectangleOfTriangles) {
  std::size_t inside = 0;
  for (std::uint64_t seed = 0; seed < 600; ++seed) {
    WholeNumbers random(seed);
    SurfaceCase made = randomCase(seed);
    made.single.clear();
    made.both.clear();
    made.camera.near = 1;
    const std::int64_t x0 = random.in(-20, 0), y0 = random.in(-20, 0), n = random.in(1, 6),
                       step = random.in(1, 7);
    for (std::int64_t i = 0; i < n * n; ++i) {
      const std::int64_t x = x0 + (i % n) * step, y = y0 + (i / n) * step;
      const Point a{x, y, 16}, b{x + step, y, 16}, c{x + step, y + step, 16}, d{x, y + step, 16};
      made.single.insert(made.single.end(), {Triangle{a, b, c}, Triangle{a, c, d}});
    }
    const std::int64_t x1 = x0 + n * step, y1 = y0 + n * step;
    const exact::Part outline =
        exact::imageOf(made.camera, {{{x0, y0, 16}, {x1, y0, 16}, {x1, y1, 16}, {x0, y1, 16}}, false})->part;
    const DrawnCase drawn(made, seed, true);
    const DepthBufferView buffer = drawn.buffer();
    for (std::uint32_t y = 0; y < buffer.height; ++y) {
      for (std::uint32_t x = 0; x < buffer.width; ++x) {
        const bool inner = exact::contains(outline, exact::pixel(x, y, 32));  // by 1/32 pixel
        inside += inner ? 1 : 0;
        EXPECT_TRUE(buffer.covered(x, y) || !inner) << "seed " << seed << ", pixel " << x << " " << y;
      }
    }
  }
  EXPECT_GT(inside, 15'000u);
}

}  // namespace
}  // namespace sightline
