// Depth buffers of surfaces for all viewers of a region, against segments from these viewers through every
// triangle, by arithmetic of this test's own.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "sightline/occluders/surface_set.h"
#include "sightline/occlusion/rasteriser.h"
#include "tests/occlusion/random_views.h"

namespace sightline {
namespace {

using test::ViewRandom;

struct SeenTriangle {
  Vec3f corners[3];
  bool double_sided = false;
};

// A few triangles around a viewer and the region in which he may be.
class RandomCase {
 public:
  explicit RandomCase(std::uint64_t seed) : random_(seed), kind_(static_cast<std::uint32_t>(seed % 10)) {
    makeView();
    makeRegion();
    if (seed % 4 == 3) {
      makeSpace();
    }
    whole_ = random_.below(2) == 0 ? 0.25 : 0.0;
    double_sided_ = random_.below(4);
    constexpr void (RandomCase::*kKinds[])() = {
        &RandomCase::addBoxes, &RandomCase::addSheet,  &RandomCase::addTerrain,   &RandomCase::addRoom,
        &RandomCase::addSoup,  &RandomCase::addLayers, &RandomCase::addSmallMesh, &RandomCase::addNearWall,
        &RandomCase::addFloor, &RandomCase::addFolded};
    (this->*kKinds[kind_])();
    if (random_.below(3) == 0) {
      (this->*kKinds[random_.below(10)])();
    }
  }

  const View& view() const { return view_; }
  const ViewerRegion& viewers() const { return viewers_; }
  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  // In a space of their own, see MovingSurfaces; in most cases that of the scene.
  const std::vector<SeenTriangle>& triangles() const { return triangles_; }
  bool moved() const { return moved_; }
  const Mat4& sceneFromSpace() const { return scene_from_space_; }
  Vec3d toSpace(const Vec3d& point) const {
    if (!moved_) {
      return point;
    }
    const Mat4& m = scene_from_space_;
    const Vec3d x(m(0, 0), m(1, 0), m(2, 0)), y(m(0, 1), m(1, 1), m(2, 1)), z(m(0, 2), m(1, 2), m(2, 2)),
        p = point - Vec3d(m(0, 3), m(1, 3), m(2, 3));
    return Vec3d(dot(cross(y, z), p), dot(cross(z, x), p), dot(cross(x, y), p)) / determinant3(m);
  }

  Scene scene() const {
    Scene scene;
    for (const bool both : {false, true}) {
      Object object;
      object.first_index = static_cast<std::uint32_t>(scene.indices.size());
      object.material = MaterialId(scene.materials.size());
      scene.materials.push_back({"", Opacity::kOpaque, both, {}});
      for (const SeenTriangle& triangle : triangles_) {
        if (triangle.double_sided == both) {
          for (const Vec3f& corner : triangle.corners) {
            scene.indices.push_back(static_cast<std::uint32_t>(scene.positions.size()));
            scene.positions.push_back(corner);
          }
        }
      }
      object.index_count = static_cast<std::uint32_t>(scene.indices.size()) - object.first_index;
      scene.objects.push_back(object);
    }
    updateBounds(scene);
    return scene;
  }

  std::string describe(std::uint64_t seed) const {
    std::ostringstream text;
    text.precision(9);
    const auto point = [&](const auto& p) { text << " (" << p.x << " " << p.y << " " << p.z << ")"; };
    text << "seed " << seed << ", kind " << kind_ << ", " << width_ << " x " << height_ << ", eye";
    point(view_.eye);
    text << " forward";
    point(view_.forward);
    text << " near " << view_.z_near << ", offsets";
    point(viewers_.offsets[0]);
    point(viewers_.offsets[1]);
    text << (moved_ ? ", in a space of its own" : "") << ", radius " << viewers_.radius << ", near distance "
         << viewers_.near_distance << ", " << triangles_.size() << " triangles\n";
    for (std::size_t i = 0; i < triangles_.size() && triangles_.size() <= 12; ++i) {
      text << (triangles_[i].double_sided ? "  both" : "  front");
      for (const Vec3f& corner : triangles_[i].corners) {
        point(corner);
      }
      text << "\n";
    }
    return text.str();
  }

 private:
  void makeView() {
    constexpr std::uint32_t kSizes[][2] = {{16, 9},  {8, 8},   {33, 17},  {64, 36}, {2, 40},
                                           {64, 64}, {96, 20}, {160, 90}, {1, 1},   {320, 180}};
    const std::uint32_t(&size)[2] = kSizes[random_.below(10)];
    width_ = size[0];
    height_ = size[1];
    turned_ = random_.below(2) == 0;
    view_.eye = turned_ ? random_.point(20.0) : Vec3d();
    setOrientation(view_, turned_ ? random_.point(1.0) : Vec3d(0, 0, -1), {0, 1, 0});
    view_.tan_half_fovy = random_.below(2) == 0 ? 0.5 : random_.sized(0.2, 2.0);
    view_.aspect = random_.below(2) == 0 ? 1.0 : random_.sized(0.5, 2.0);
    view_.z_near = random_.sized(0.01, 0.4);
    if (random_.below(4) == 0) {
      view_.shift_x = random_.in(-1.5, 1.5);
      view_.shift_y = random_.in(-1.5, 1.5);
    }
  }
  // Some regions are a point, a line or a ball; in some, all viewers are on one of the view's axes.
  void makeRegion() {
    const double reach = random_.sized(1e-3, 2.0);
    for (Vec3d& offset : viewers_.offsets) {
      const Vec3d axes[] = {view_.right, view_.up, view_.forward};
      const std::uint32_t kind = random_.below(8);
      offset = kind == 0  ? Vec3d()
               : kind < 5 ? axes[random_.below(3)] * random_.in(-reach, reach)
                          : view_.right * random_.in(-reach, reach) + view_.up * random_.in(-reach, reach) +
                                view_.forward * random_.in(-reach, reach);
    }
    viewers_.radius = random_.below(2) == 0 ? 0.0 : reach * random_.sized(1e-3, 1.0);
    constexpr double kNearest = 1e-6;  // or it may be the region of one viewer, who needs no distance
    viewers_.near_distance = std::array{kNearest, nearDistance(view_), 0.5}[random_.below(3)];
  }

  // A space that is turned, stretched, sheared, and mirrored once in two.
  void makeSpace() {
    View axes;
    setOrientation(axes, random_.point(1.0), random_.point(1.0));
    const double size = random_.sized(0.1, 10.0);
    const Vec3d columns[] = {
        axes.right * (size * random_.in(0.5, 2.0)) + axes.up * (size * random_.in(-0.3, 0.3)),
        axes.up * (size * (random_.below(2) == 0 ? 1.0 : -1.0)), axes.forward * -size,
        view_.eye + random_.point(10.0)};
    for (int column = 0; column < 4; ++column) {
      for (int row = 0; row < 3; ++row) {
        scene_from_space_(row, column) = columns[column][row];
      }
    }
    moved_ = true;
  }

  // x to the right, y up, z forwards from the eye.
  Vec3f place(Vec3d p) const {
    if (whole_ > 0.0) {
      p = Vec3d(std::round(p.x / whole_), std::round(p.y / whole_), std::round(p.z / whole_)) * whole_;
    }
    return Vec3f(toSpace(view_.eye + view_.right * p.x + view_.up * p.y + view_.forward * p.z));
  }
  void add(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const bool both = double_sided_ == 0 || (double_sided_ == 1 && random_.below(4) == 0);
    // What is mirrored keeps its fronts.
    const bool mirrored = moved_ && determinant3(scene_from_space_) < 0.0;
    triangles_.push_back({{place(a), place(mirrored ? c : b), place(mirrored ? b : c)}, both});
  }
  // Its front is turned to an eye that sees its corners counter-clockwise. Seen from its other side, right
  // and left change.
  void addQuad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
    add(a, b, c);
    add(a, c, d);
  }
  // Columns and rows of quads between a corner and those beside it; some cells are left out.
  template <typename Place>
  void addGrid(std::uint32_t columns, std::uint32_t rows, std::uint32_t holes, Place&& at) {
    for (std::uint32_t y = 0; y < rows; ++y) {
      for (std::uint32_t x = 0; x < columns; ++x) {
        if (holes == 0 || random_.below(holes) != 0) {
          addQuad(at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1));
        }
      }
    }
  }
  double distance() { return random_.sized(0.3, 30.0); }
  double slope() const { return view_.tan_half_fovy; }
  // In view, in most cases.
  Vec3d somewhere(double z) {
    return {(random_.in(-1, 1) + view_.shift_x) * slope() * view_.aspect * z,
            (random_.in(-1, 1) + view_.shift_y) * slope() * z, z};
  }

  void addBox(const Vec3d& low, const Vec3d& high) {
    const auto at = [&](int corner) {
      return Vec3d((corner & 1) != 0 ? high.x : low.x, (corner & 2) != 0 ? high.y : low.y,
                   (corner & 4) != 0 ? high.z : low.z);
    };
    // z is forwards: the axes of place() are left-handed.
    constexpr int kFaces[6][4] = {{0, 2, 6, 4}, {1, 5, 7, 3}, {0, 4, 5, 1},
                                  {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 6, 7, 5}};
    for (const int(&f)[4] : kFaces) {
      addQuad(at(f[0]), at(f[1]), at(f[2]), at(f[3]));
    }
  }
  void addBoxes() {
    for (std::uint32_t i = 1 + random_.below(5); i > 0; --i) {
      const Vec3d middle = somewhere(distance());
      const double size = middle.z * slope() * random_.sized(0.05, 1.0);
      const Vec3d half = Vec3d(random_.in(0.2, 1.0), random_.in(0.2, 1.0), random_.in(0.2, 1.0)) * size;
      addBox(middle - half, middle + half);
    }
  }
  void addSheet() {
    const double z = distance(), step = z * slope() * random_.sized(0.1, 1.0),
                 rough = random_.below(2) == 0 ? 0.0 : step * random_.in(0.0, 0.5);
    const Vec3d corner = somewhere(z) - Vec3d(2.5, 2.5, 0.0) * step;
    std::array<double, 49> depth{};
    for (double& d : depth) {
      d = rough * random_.in(-1.0, 1.0);
    }
    addGrid(5, 5, random_.below(2) == 0 ? 0 : 6, [&](std::uint32_t x, std::uint32_t y) {
      return corner + Vec3d(x * step, y * step, depth[7 * y + x]);
    });
  }
  void addTerrain() {
    const double low = -random_.sized(0.3, 4.0), step = -low * random_.sized(0.5, 3.0), rough = -low * 0.8;
    std::array<double, 121> height{};
    for (double& h : height) {
      h = low + rough * random_.in(-1.0, 1.0);
    }
    addGrid(8, 8, random_.below(3) == 0 ? 12 : 0, [&](std::uint32_t x, std::uint32_t y) {
      return Vec3d((x - 4.0) * step, height[11 * y + x], (y - 1.0) * step);
    });
  }
  // Rooms in a row, the first one around the viewer, with doors between them.
  void addRoom() {
    const double left = -random_.in(0.6, 3.0), right = random_.in(0.6, 3.0), low = -random_.in(0.6, 2.0),
                 high = random_.in(0.6, 2.0);
    double z = -random_.in(0.6, 3.0);
    addQuad({right, low, z}, {left, low, z}, {left, high, z}, {right, high, z});
    for (std::uint32_t i = 1 + random_.below(3); i > 0; --i) {
      const double end = z + random_.in(2.5, 6.0);
      addQuad({left, low, z}, {right, low, z}, {right, low, end}, {left, low, end});
      addQuad({left, high, end}, {right, high, end}, {right, high, z}, {left, high, z});
      addQuad({left, low, z}, {left, low, end}, {left, high, end}, {left, high, z});
      addQuad({right, low, end}, {right, low, z}, {right, high, z}, {right, high, end});
      const double door = random_.in(left, 0.5 * right), door_end = random_.in(door, right),
                   top = random_.in(low, high);
      addQuad({left, low, end}, {door, low, end}, {door, high, end}, {left, high, end});
      addQuad({door_end, low, end}, {right, low, end}, {right, high, end}, {door_end, high, end});
      addQuad({door, top, end}, {door_end, top, end}, {door_end, high, end}, {door, high, end});
      z = end;
    }
  }
  // Triangles between the same few points: edges of any number of them, and of both directions.
  void addSoup() {
    std::vector<Vec3d> points;
    const double z = distance();
    for (std::uint32_t i = 5 + random_.below(4); i > 0; --i) {
      points.push_back(somewhere(z * random_.in(0.2, 2.0)) * random_.in(0.5, 1.5));
    }
    const auto any = [&] { return points[random_.below(static_cast<std::uint32_t>(points.size()))]; };
    for (std::uint32_t i = 4 + random_.below(20); i > 0; --i) {
      add(any(), any(), any());
    }
  }
  // Sheets one behind the other that hang together at a side, so that lines of sight meet several of them.
  void addLayers() {
    const double z = distance(), size = z * slope() * random_.sized(0.3, 2.0);
    const Vec3d corner = somewhere(z) - Vec3d(0.5, 0.5, 0.0) * size;
    Vec3d at = corner;
    bool back = false;
    for (std::uint32_t i = 2 + random_.below(4); i > 0; --i) {
      const Vec3d end = corner + Vec3d(back ? 0.0 : size, 0.0, at.z - corner.z + size * random_.in(0.0, 0.4)),
                  up(0.0, size * random_.in(0.5, 1.0), 0.0);
      if (random_.below(3) == 0) {
        addQuad(end, at, at + up, end + up);
      } else {
        addQuad(at, end, end + up, at + up);
      }
      at = end;
      back = !back;
    }
  }
  // Triangles of about a pixel.
  void addSmallMesh() {
    const double z = distance(), pixel = 2.0 * slope() * z / height_, step = pixel * random_.sized(0.2, 3.0);
    const Vec3d corner = somewhere(z) * 0.5;
    std::array<Vec3d, 121> shift;
    for (Vec3d& s : shift) {
      s = random_.point(0.4 * step);
    }
    addGrid(8, 8, random_.below(2) == 0 ? 0 : 10, [&](std::uint32_t x, std::uint32_t y) {
      return corner + Vec3d((x - 4.0) * step, (y - 4.0) * step, z - corner.z) + shift[11 * y + x];
    });
  }
  void addNearWall() {
    const double z = random_.sized(0.05, 2.0), left = random_.in(-4, 0) * z, right = random_.in(0, 4) * z,
                 low = random_.in(-4, 0) * z, high = random_.in(0, 4) * z;
    const double turn = random_.in(-1.0, 1.0) * z;
    addQuad({left, low, z - turn}, {right, low, z + turn}, {right, high, z + turn}, {left, high, z - turn});
  }
  // A floor from below the viewer, or from behind him, into the distance; and a wall at its side.
  void addFloor() {
    const double low = -random_.sized(0.2, 3.0), left = random_.in(-20, 0), right = random_.in(0, 20),
                 begin = random_.in(-3.0, 3.0), end = random_.sized(4.0, 300.0);
    addQuad({left, low, begin}, {right, low, begin}, {right, low, end}, {left, low, end});
    if (random_.below(2) == 0) {
      addQuad({left, low, begin}, {left, low, end}, {left, 2.0, end}, {left, 2.0, begin});
    }
    if (random_.below(2) == 0) {
      addQuad({left, low, end}, {right, low, end}, {right, 2.0, end}, {left, 2.0, end});
    }
  }
  // Upright quads in a row that turns back over itself.
  void addFolded() {
    const double z = distance(), step = z * slope() * random_.sized(0.1, 0.6);
    Vec3d at = somewhere(z) - Vec3d(2.0 * step, step, 0.0);
    const Vec3d up(0.0, step * random_.in(0.5, 4.0), 0.0);
    for (std::uint32_t i = 3 + random_.below(7); i > 0; --i) {
      const Vec3d next = at + Vec3d(random_.in(-0.8, 1.5), 0.0, random_.in(-1.0, 1.0)) * step;
      addQuad(at, next, next + up, at + up);
      at = next;
    }
  }

  ViewRandom random_;
  std::uint32_t kind_;
  View view_;
  ViewerRegion viewers_;
  std::uint32_t width_ = 0, height_ = 0;
  bool turned_ = false;
  double whole_ = 0.0;  // coordinates are multiples of it, unless it is 0
  std::uint32_t double_sided_ = 0;
  bool moved_ = false;
  Mat4 scene_from_space_;
  std::vector<SeenTriangle> triangles_;
};

// Whether a triangle blocks a segment, from a part of it on, which a viewer's near plane may clip. Segments
// that pass an edge within 1e-9 of the triangle's size count as blocked: those through an edge of two
// triangles pass by both of them where rounding decides so. What this test looks for is larger: an edge that
// is swept too little, or a pixel that an edge meets.
bool blocks(const SeenTriangle& triangle, const Vec3d& from, const Vec3d& to, double clipped) {
  constexpr double kRounding = 1e-9;
  const Vec3d a = Vec3d(triangle.corners[0]) - from, b = Vec3d(triangle.corners[1]) - from,
              c = Vec3d(triangle.corners[2]) - from, d = to - from;
  const Vec3d normal = cross(b - a, c - a);
  const double facing = -dot(normal, d);
  if (facing == 0.0 || (!triangle.double_sided && facing < 0.0)) {
    return false;
  }
  // The volumes with the sides are all positive where a triangle is seen from its front.
  const double side = facing > 0.0 ? 1.0 : -1.0;
  const double u = -side * dot(d, cross(b, c)), v = -side * dot(d, cross(c, a)),
               w = -side * dot(d, cross(a, b));
  const double least = -kRounding * (std::abs(u) + std::abs(v) + std::abs(w));
  if (u < least || v < least || w < least) {
    return false;
  }
  const double t = dot(normal, a) / dot(normal, d);
  return t <= 1.0 && t >= clipped * (1.0 - kRounding);
}

bool isBlocked(const RandomCase& made, const Vec3d& viewer, const Vec3d& point) {
  const Vec3d from = made.toSpace(viewer), to = made.toSpace(point);
  const double clipped = made.viewers().near_distance / length(point - viewer);
  return std::ranges::any_of(
      made.triangles(), [&](const SeenTriangle& triangle) { return blocks(triangle, from, to, clipped); });
}

DepthBufferView draw(Rasteriser& rasteriser, const RandomCase& made, std::uint64_t seed,
                     SurfaceSet& surfaces) {
  ViewRandom random(~seed);
  constexpr std::uint32_t kPieces[] = {1, 3, 16, 1024};
  const auto piece = [&] { return kPieces[random.below(4)]; };
  const Scene scene = made.scene();
  surfaces = findSurfaces(scene.view(), {.part_triangles = piece(),
                                         .patch_triangles = piece(),
                                         .cluster_triangles = piece(),
                                         .max_angle_deg = random.below(2) == 0 ? 10.0 : 180.0,
                                         .join_edges = random.below(2) == 0});
  rasteriser = Rasteriser({made.width(), made.height()});
  rasteriser.begin(made.view(), made.viewers());
  const SurfaceDrawing all{
      .limits = {.min_pixels = 0.0, .min_patch_pixels = 0.0, .pixels_per_edge = 0.0, .budget = ~0u}};
  if (made.moved()) {
    rasteriser.draw(MovingSurfaces{&surfaces, made.sceneFromSpace()}, surfaces.objects, all);
  } else {
    rasteriser.draw(surfaces, surfaces.objects, all);
  }
  return rasteriser.depthBuffer();
}

// A viewer of a region: often one of its corners, or as far from them as there are any.
Vec3d viewerOf(ViewRandom& random, const View& view, const ViewerRegion& viewers) {
  double first = 0.0, second = 0.0;
  const std::uint32_t kind = random.below(5);
  if (kind < 3) {
    first = kind == 1 ? 1.0 : 0.0;
    second = kind == 2 ? 1.0 : 0.0;
  } else {
    first = random.in(0.0, 1.0);
    second = kind == 3 ? 1.0 - first : random.in(0.0, 1.0 - first);
  }
  Vec3d around = random.point(1.0);
  const double size = length(around);
  around = size > 0.0 ? around / size : Vec3d();
  constexpr double kInside = 1.0 - 1e-12;
  return view.eye + viewers.offsets[0] * first + viewers.offsets[1] * second +
         around * (kInside * viewers.radius * (random.below(3) == 0 ? random.in(0.0, 1.0) : 1.0));
}

struct ViewerCounts {
  // These are sums, over the cases, of the share of pixels that is covered. Cases in a space of their own are
  // counted apart.
  double share = 0.0, moved_share = 0.0;
  std::size_t next_to_open = 0, segments = 0, failures = 0;
};

// Looks at some covered pixels of a case from some viewers.
void judge(std::uint64_t seed, std::uint32_t pixels, std::uint32_t viewers, ViewerCounts& counts) {
  const RandomCase made(seed);
  Rasteriser rasteriser;
  SurfaceSet surfaces;
  const DepthBufferView buffer = draw(rasteriser, made, seed, surfaces);
  ViewRandom random(seed + 1);
  // Half of the pixels that are looked at are next to one that is not covered.
  using Pixels = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  Pixels covered, beside;
  for (std::uint32_t y = 0; y < buffer.height; ++y) {
    for (std::uint32_t x = 0; x < buffer.width; ++x) {
      if (!buffer.covered(x, y)) {
        continue;
      }
      covered.emplace_back(x, y);
      if ((x > 0 && !buffer.covered(x - 1, y)) || (x + 1 < buffer.width && !buffer.covered(x + 1, y)) ||
          (y > 0 && !buffer.covered(x, y - 1)) || (y + 1 < buffer.height && !buffer.covered(x, y + 1))) {
        beside.emplace_back(x, y);
      }
    }
  }
  const double share = static_cast<double>(covered.size()) / (buffer.width * buffer.height);
  (made.moved() ? counts.moved_share : counts.share) += share;
  counts.next_to_open += beside.size();
  const View& view = made.view();
  // Where in the pixel: its corners and sides more often than its inside.
  const auto within = [&] {
    const std::uint32_t kind = random.below(4);
    return kind == 0 ? 0.0 : kind == 1 ? 1.0 : random.in(0.0, 1.0);
  };
  for (std::uint32_t i = 0; i < pixels && !covered.empty(); ++i) {
    const Pixels& from = i % 2 == 0 || beside.empty() ? covered : beside;
    const auto [x, y] = from[random.below(static_cast<std::uint32_t>(from.size()))];
    const double slope_y = view.tan_half_fovy * (2.0 * (y + within()) / buffer.height - 1.0 + view.shift_y),
                 slope_x = view.tan_half_fovy * view.aspect *
                           (2.0 * (x + within()) / buffer.width - 1.0 + view.shift_x);
    const Vec3d direction = view.forward + view.right * slope_x + view.up * slope_y;
    // Behind the stored depth, and behind the near plane, by more than rounding.
    const double nearest = std::max(1.0 / static_cast<double>(buffer.at(x, y)), view.z_near);
    for (std::uint32_t k = 0; k < viewers; ++k) {
      const Vec3d point = view.eye + direction * (nearest * (1.0 + random.sized(1e-6, 1e3))),
                  viewer = viewerOf(random, view, made.viewers());
      ++counts.segments;
      if (!isBlocked(made, viewer, point)) {
        ++counts.failures;
        ADD_FAILURE() << "pixel " << x << " " << y << " is covered, but its point (" << point.x << " "
                      << point.y << " " << point.z << ") is seen from (" << viewer.x << " " << viewer.y << " "
                      << viewer.z << ")\n"
                      << made.describe(seed);
        return;
      }
    }
  }
}

TEST(SeveralViewers, WhatIsCoveredIsHiddenFromAllOfThem) {
  constexpr std::uint64_t kFirst = 0, kSeeds = 3000;
  ViewerCounts counts;
  for (std::uint64_t seed = kFirst; seed < kFirst + kSeeds && counts.failures < 5; ++seed) {
    judge(seed, 24, 12, counts);
  }
  EXPECT_GT(counts.share, 0.1 * kSeeds);
  EXPECT_GT(counts.moved_share, 0.03 * kSeeds);
  EXPECT_GT(counts.next_to_open, 10u * kSeeds);
  EXPECT_GT(counts.segments, 100u * kSeeds);
}

}  // namespace
}  // namespace sightline
