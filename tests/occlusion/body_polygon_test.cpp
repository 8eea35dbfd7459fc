// Depth buffers of convex bodies that are drawn as one, judged ray by ray in extended precision.

#include <gtest/gtest.h>
#include <hwy/targets.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <optional>
#include <string>

#include "sightline/occlusion/depth_pyramid.h"
#include "sightline/occlusion/rasteriser.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/instruction_sets.h"
#include "tests/support/rounds.h"
#include "tests/support/solids.h"

namespace sightline {
namespace {

using namespace test;
using Real = long double;

struct Vector {
  Real x = 0, y = 0, z = 0;
};
Real dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Vector operator-(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}

// The judge: triangles in camera space (x to the right, y upwards, z the depth), and rays through points of
// the buffer. A ray that barely misses counts as a hit, so that the judge never fails a correct answer.
class Judge {
 public:
  Judge(const View& view, const RasterSettings& settings) : view_(view) {
    const Real half = view.orthographic ? Real{0.5} * view.ortho_height : Real{view.tan_half_fovy};
    step_x_ = 2 * half * view.aspect / settings.width;
    step_y_ = 2 * half / settings.height;
    middle_x_ = Real{0.5} * settings.width;
    middle_y_ = Real{0.5} * settings.height;
  }
  // Adds all sides as fans of triangles. A point of the buffer is hidden by a front beyond the near plane.
  void add(const Solid& solid) {
    for (const std::vector<std::uint32_t>& face : solid.faces) {
      for (std::size_t i = 1; i + 1 < face.size(); ++i) {
        const Vector a = toCamera(solid.points[face[0]]), b = toCamera(solid.points[face[i]]),
                     c = toCamera(solid.points[face[i + 1]]);
        triangles_.push_back({a, b, c, cross(b - a, c - a)});
      }
    }
  }
  // Returns the greatest reciprocal depth among the fronts that cover this point of the buffer; nothing if
  // none does.
  std::optional<Real> reciprocalDepthAt(Real x, Real y) const {
    const Vector across{(x - middle_x_) * step_x_, (y - middle_y_) * step_y_, 0};
    const Vector from = view_.orthographic ? across : Vector{};
    const Vector along = view_.orthographic ? Vector{0, 0, 1} : Vector{across.x, across.y, 1};
    std::optional<Real> best;
    for (const Triangle& t : triangles_) {
      const Real facing = dot(t.normal, along);  // camera space is left-handed
      if (!(facing > 0) || !passes(t, from, along)) {
        continue;
      }
      const Real depth = dot(t.normal, t.a - from) / facing;
      if (depth >= view_.z_near * (1 - Real{1e-14})) {
        const Real reciprocal_depth = view_.orthographic ? -depth : 1 / depth;
        best = std::max(best.value_or(reciprocal_depth), reciprocal_depth);
      }
    }
    return best;
  }
  // Whether all of a square is in the image: the image is convex.
  bool contains(Real x, Real y, Real grown) const {
    return reciprocalDepthAt(x - grown, y - grown) && reciprocalDepthAt(x + 1 + grown, y - grown) &&
           reciprocalDepthAt(x - grown, y + 1 + grown) && reciprocalDepthAt(x + 1 + grown, y + 1 + grown);
  }

 private:
  struct Triangle {
    Vector a, b, c, normal;
  };

  Vector toCamera(const Vec3f& p) const {
    const Vector r{Real{p.x} - view_.eye.x, Real{p.y} - view_.eye.y, Real{p.z} - view_.eye.z};
    const auto along = [&](const Vec3d& axis) { return r.x * axis.x + r.y * axis.y + r.z * axis.z; };
    return {along(view_.right), along(view_.up), along(view_.forward)};
  }
  static bool passes(const Triangle& t, const Vector& from, const Vector& along) {
    const Vector a = t.a - from, b = t.b - from, c = t.c - from;
    const auto side = [&](const Vector& p, const Vector& q) {
      const Real value = dot(cross(p, q), along);
      return value >= 0 || value >= -Real{1e-17} * std::sqrt(dot(p, p) * dot(q, q) * dot(along, along));
    };
    return side(a, b) && side(b, c) && side(c, a);
  }

  View view_;
  Real step_x_ = 0, step_y_ = 0, middle_x_ = 0, middle_y_ = 0;
  std::vector<Triangle> triangles_;
};

OccluderSet setOfSolids(std::span<const Solid> solids) {
  std::vector<std::vector<Vec3f>> vertices;
  std::vector<OccluderPolygon> polygons;
  for (const Solid& solid : solids) {
    for (std::size_t face = 0; face < solid.faces.size(); ++face) {
      vertices.push_back(solid.polygon(face));
    }
  }
  for (const std::vector<Vec3f>& polygon : vertices) {
    polygons.push_back({polygon, false, ObjectId(0u)});
  }
  return makeOccluders(polygons);
}

constexpr std::pair<std::uint32_t, std::uint32_t> kBodySizes[] = {{1, 1}, {16, 16}, {64, 36}, {320, 180}};

enum class Place {
  kBefore,          // wholly in view, or nearly
  kHalfOff,         // about a border of the buffer
  kAcrossNear,      // the near plane runs through it
  kAroundEye,       // the eye is inside
  kInFacePlane,     // the eye lies exactly in the plane of a side
  kAlongTheAxes,    // sides exactly edge-on to an orthographic view, or at right angles to the view
  kOnPixelCorners,  // edges run through corners of pixels, but for rounding
};
constexpr Place kPlaces[] = {Place::kBefore,        Place::kHalfOff,     Place::kAcrossNear,
                             Place::kAroundEye,     Place::kInFacePlane, Place::kAlongTheAxes,
                             Place::kOnPixelCorners};

Solid anyShape(Random& random) {
  switch (random.bits() % 4) {
    case 0:
      return octahedron();
    case 1:
      return prism(static_cast<std::uint32_t>(3 + random.bits() % 6));
    case 2:
      return tetrahedron();
    default:
      return block({-1, -1, -1}, {1, 1, 1});
  }
}

// Makes solids of any proportions, with slabs and slivers among them.
Vec3d anyScale(Random& random, bool& thin) {
  Vec3d scale(random.in(0.5, 3.0), random.in(0.5, 3.0), random.in(0.5, 3.0));
  const std::uint64_t kind = random.bits() % 6;
  thin = kind < 2;
  if (kind == 0) {
    scale.z *= random.in(1e-4, 1e-2);
  } else if (kind == 1) {
    scale.y *= random.in(1e-5, 1e-2);
    scale.z *= random.in(1e-5, 1e-2);
  }
  return scale;
}

struct BodyScene {
  std::vector<Solid> solids;
  View view;
  RasterSettings settings;
  bool thin = false;
  std::string what;

  BodyScene(Place place, std::uint64_t seed) {
    Random random(seed * 16 + static_cast<std::uint64_t>(place));
    what = "place " + std::to_string(static_cast<int>(place)) + ", seed " + std::to_string(seed);
    const auto& [width, height] = kBodySizes[seed % 4];
    settings = {width, height};
    const double far_away = seed % 5 == 4 ? 1e4 : 0.0;
    view = viewFrom(Vec3d(far_away, -far_away, 0.5 * far_away), random.point(1.0));
    // From within, parallel rays may still intersect a front.
    view.orthographic = seed / 4 % 3 == 2 && place != Place::kAroundEye;
    view.ortho_height = random.in(2.0, 12.0);
    view.aspect = random.in(0.5, 2.0);
    view.tan_half_fovy = settings.width == 1 ? random.in(0.02, 0.1) : random.in(0.1, 1.5);
    if (place == Place::kInFacePlane || place == Place::kAlongTheAxes) {
      addAxisAligned(random, place);
    } else if (place == Place::kOnPixelCorners) {
      addOnPixelCorners(random);
    } else {
      addTurned(random, place);
    }
  }

 private:
  void addTurned(Random& random, Place place) {
    const Vec3d normal = normalized(random.point(1.0));
    const Vec3d x = normalized(sightline::cross(normal, random.point(1.0)));
    double depth = random.in(5.0, 12.0);
    if (place == Place::kAcrossNear) {
      view.z_near = depth + random.in(-1.0, 1.0);
    } else if (place == Place::kAroundEye) {
      depth = 0.0;
    }
    const double reach = view.orthographic ? 0.5 * view.ortho_height : depth * view.tan_half_fovy;
    const double aside = place == Place::kHalfOff ? 1.0 : 0.2;
    const double right = (random.bits() % 2 == 0 ? aside : random.in(-aside, aside)) * reach * view.aspect;
    const Vec3d middle =
        view.eye + view.forward * depth + view.right * right + view.up * (random.in(-aside, aside) * reach);
    solids.push_back(
        placed(anyShape(random), middle, x, sightline::cross(normal, x), anyScale(random, thin)));
  }
  // A tetrahedron with three corners about those of pixels, and so are the middles of its edges.
  void addOnPixelCorners(Random& random) {
    thin = true;
    view.eye = {};
    setOrientation(view, {0, 0, -1}, {0, 1, 0});
    const double half = view.orthographic ? 0.5 * view.ortho_height : view.tan_half_fovy;
    Solid solid;
    Vec3d middle;
    double deepest = 0.0;
    for (int i = 0; i < 3; ++i) {
      const double depth = random.in(5.0, 9.0), reach = view.orthographic ? half : half * depth;
      const auto border = [&](std::uint32_t size) {
        const auto last = std::max(size / 8 * 8, 1u);
        return 2.0 * static_cast<double>(random.bits() % (last + 1) / 8 * 8) / size - 1.0;
      };
      const Vec3d point(reach * view.aspect * border(settings.width), reach * border(settings.height),
                        -depth);
      solid.points.push_back(Vec3f(point));
      middle += point / 3.0;
      deepest = std::max(deepest, depth);
    }
    solid.points.push_back(Vec3f(middle * (view.orthographic ? 1.0 : 1.4) - Vec3d(0, 0, deepest)));
    solid.faces = {{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}};
    const auto at = [&](int i) { return Vec3d(solid.points[static_cast<std::size_t>(i)]); };
    if (sightline::dot(sightline::cross(at(1) - at(0), at(2) - at(0)), at(3) - at(0)) > 0.0) {
      for (std::vector<std::uint32_t>& face : solid.faces) {
        std::ranges::reverse(face);
      }
    }
    solids.push_back(solid);
  }
  // Coordinates are small integers, so that the eye lies in planes exactly.
  void addAxisAligned(Random& random, Place place) {
    const auto whole = [&](int low, int high) {
      return static_cast<float>(low +
                                static_cast<int>(random.bits() % static_cast<unsigned>(high - low + 1)));
    };
    const Vec3f low(whole(-4, 0), whole(-4, 0), whole(-12, -8)),
        high(whole(1, 4), whole(1, 4), whole(-7, -5));
    view.eye = {whole(-3, 3), whole(-3, 3), 0};
    if (place == Place::kInFacePlane) {
      view.eye.x = high.x;
      if (random.bits() % 3 == 0) {
        view.eye.y = low.y;
      }
    }
    const Vec3d middle = (Vec3d(low) + Vec3d(high)) * 0.5;
    setOrientation(view, place == Place::kAlongTheAxes ? Vec3d(0, 0, -1) : middle - view.eye, {0, 1, 0});
    solids.push_back(block(low, high));
  }
};

struct Counts {
  std::size_t covered = 0, should = 0, of_those_covered = 0, as_one = 0;
};

// Returns what is wrong with a covered pixel, empty for nothing: by its corners, where reciprocal depth,
// which is concave over the image, is least, and by some points between them.
std::string whatIsWrong(const Judge& judge, std::uint32_t x, std::uint32_t y, float stored, Random& random) {
  for (int i = 0; i < 6; ++i) {
    const Real at_x = x + (i < 4 ? Real(i & 1) : Real{random.in(0.0, 1.0)});
    const Real at_y = y + (i < 4 ? Real(i >> 1) : Real{random.in(0.0, 1.0)});
    const std::optional<Real> exact = judge.reciprocalDepthAt(at_x, at_y);
    if (!exact || Real{stored} > *exact + 1e-15L * std::abs(*exact)) {
      return "pixel " + std::to_string(x) + " " + std::to_string(y) + " has " + std::to_string(stored) +
             " but at " + std::to_string(at_x) + " " + std::to_string(at_y) + " there is " +
             (exact ? std::to_string(*exact) : "nothing that hides");
    }
  }
  return "";
}

// Whether a covered pixel lies at a border of what is covered, or of the buffer.
bool isAtABorder(const DepthBufferView& buffer, std::uint32_t x, std::uint32_t y) {
  return x == 0 || y == 0 || x + 1 == buffer.width || y + 1 == buffer.height || !buffer.covered(x - 1, y) ||
         !buffer.covered(x + 1, y) || !buffer.covered(x, y - 1) || !buffer.covered(x, y + 1);
}

// In a large buffer, one pixel in seven is judged, and all at a border: what is covered too far shows there.
void judge(const BodyScene& scene, Counts& counts) {
  const OccluderSet set = setOfSolids(scene.solids);
  Rasteriser rasteriser(scene.settings);
  rasteriser.begin(scene.view);
  rasteriser.draw(set, all(set));
  counts.as_one += !set.bodies.empty() && rasteriser.occluders().size() == set.bodies.size() ? 1 : 0;
  Judge judge(scene.view, scene.settings);
  for (const Solid& solid : scene.solids) {
    judge.add(solid);
  }
  Random random(1);
  const DepthBufferView buffer = rasteriser.depthBuffer();
  int failures = 0;
  for (std::uint32_t y = 0; y < buffer.height && failures < 3; ++y) {
    for (std::uint32_t x = 0; x < buffer.width && failures < 3; ++x) {
      const bool covered = buffer.covered(x, y);
      const bool chosen = buffer.width < 100 || (x + y) % 7 == 0;
      if (!scene.thin && chosen && judge.contains(x, y, Real{0.2})) {
        ++counts.should;
        counts.of_those_covered += covered ? 1 : 0;
      }
      counts.covered += covered ? 1 : 0;
      if (covered && (chosen || isAtABorder(buffer, x, y))) {
        const std::string wrong = whatIsWrong(judge, x, y, buffer.at(x, y), random);
        failures += wrong.empty() ? 0 : 1;
        EXPECT_EQ(wrong, "") << scene.what << ", buffer " << buffer.width << " x " << buffer.height;
      }
    }
  }
}

class BodyPolygonsAt : public testing::TestWithParam<Place> {};

TEST_P(BodyPolygonsAt, NothingIsCoveredThatTheBodyDoesNotHideWithItsDepth) {
  Counts counts;
  // Across the near plane little is covered, so that all scenes are needed to show it.
  const auto part = [](std::uint64_t all) {
    return GetParam() == Place::kAcrossNear ? all : test::rounds(all);
  };
  for (std::uint64_t seed = 0; seed < part(GetParam() == Place::kOnPixelCorners ? 800 : 96); ++seed) {
    if (GetParam() == Place::kOnPixelCorners && seed % 4 == 3 && seed > 40) {
      continue;  // large buffers take long
    }
    judge(BodyScene(GetParam(), seed), counts);
  }
  if (GetParam() == Place::kAroundEye) {
    EXPECT_EQ(counts.covered, 0u) << "only backs are seen";
    return;
  }
  EXPECT_GT(counts.covered, part(20'000));
  if (GetParam() == Place::kBefore || GetParam() == Place::kHalfOff) {
    EXPECT_GT(counts.as_one, test::rounds(50u));
    EXPECT_GT(static_cast<double>(counts.of_those_covered), 0.95 * static_cast<double>(counts.should));
  } else if (GetParam() == Place::kInFacePlane || GetParam() == Place::kAlongTheAxes) {
    EXPECT_GT(static_cast<double>(counts.of_those_covered), 0.9 * static_cast<double>(counts.should));
  }
}
INSTANTIATE_TEST_SUITE_P(Places, BodyPolygonsAt, testing::ValuesIn(kPlaces));

TEST(BodyPolygons, NothingIsCoveredThatSeveralBodiesDoNotHide) {
  Counts counts;
  for (std::uint64_t seed = 0; seed < (test::sanitized() ? 8 : 16); ++seed) {
    BodyScene scene(Place::kBefore, seed);
    for (std::uint64_t more = 1; more < 5; ++more) {
      BodyScene other(more % 2 == 0 ? Place::kBefore : Place::kHalfOff, seed + 240 * more);
      // Apart from the projection, this view sees the solid as the other view sees its own.
      for (Vec3f& p : other.solids[0].points) {
        const Vec3d r = Vec3d(p) - other.view.eye;
        p = Vec3f(scene.view.eye + scene.view.right * sightline::dot(other.view.right, r) +
                  scene.view.up * sightline::dot(other.view.up, r) +
                  scene.view.forward * sightline::dot(other.view.forward, r));
      }
      scene.solids.push_back(other.solids[0]);
    }
    scene.thin = true;  // together they are not convex
    judge(scene, counts);
  }
  EXPECT_GT(counts.covered, test::rounds(40'000u));
}

// A flat sheet is no solid, and its outline has a notch.
TEST(BodyPolygons, ANotchInAFlatSheetStaysOpen) {
  Counts counts;
  for (std::uint64_t seed = 0; seed < test::rounds(32u); ++seed) {
    BodyScene scene(Place::kBefore, seed);
    Random random(seed);
    const double turn = random.in(0.0, 6.28);
    const Vec3d x = scene.view.right * std::cos(turn) + scene.view.up * std::sin(turn);
    const Vec3d y = scene.view.up * std::cos(turn) - scene.view.right * std::sin(turn);
    const Vec3d tilted = normalized(y + scene.view.forward * random.in(-0.5, 0.5));
    scene.solids = {
        placed(notchedSheet(), scene.view.eye + scene.view.forward * random.in(2.0, 9.0), x, tilted)};
    scene.thin = true;
    judge(scene, counts);
  }
  EXPECT_GT(counts.covered, test::rounds(20'000u));
}

// Two blocks side by side and the eye in the middle plane between them, turned about the viewing direction.
struct GapScene {
  static constexpr std::uint32_t kSize = 64;  // of the buffer; 90 degrees
  double offset, half_gap;
  std::vector<Solid> blocks;
  View view;

  GapScene(double pixels, int turn, double at)
      : offset(static_cast<float>(at)), half_gap(pixels * (2.0 / kSize) * 5.0 / 2.0) {
    const auto left = static_cast<float>(offset - half_gap), right = static_cast<float>(offset + half_gap);
    blocks = {block({left - 30, -30, -7}, {left, 30, -5}), block({right, -30, -7}, {right + 30, 30, -5})};
    view = viewFrom({0.5 * (double{left} + double{right}), 0, 0}, {0, 0, -1});
    const double angle = 0.11 * turn;
    setOrientation(view, {0.05 * (turn % 3 - 1), 0.1, -1}, {std::cos(angle), std::sin(angle), 0});
  }
};

TEST(BodyPolygons, WhatShowsThroughAGapBetweenBodiesIsNotCovered) {
  std::size_t covered = 0, looked = 0;
  for (const double pixels : {0.001, 0.3, 0.9}) {
    for (int turn = 0; turn < 60; ++turn) {
      const GapScene scene(pixels, turn, 0.0137 * turn);
      const std::string what = std::to_string(pixels) + " pixels, turn " + std::to_string(turn);
      const RasterSettings settings{GapScene::kSize, GapScene::kSize};
      const OccluderSet set = setOfSolids(scene.blocks);
      ASSERT_EQ(set.bodies.size(), 2u);
      DepthPyramid pyramid({settings});
      pyramid.build(scene.view, set, all(set));
      const DepthBufferView buffer = pyramid.depthBuffer();
      for (std::uint32_t y = 0; y < buffer.height; ++y) {
        for (std::uint32_t x = 0; x < buffer.width; ++x) {
          covered += buffer.covered(x, y) ? 1 : 0;
        }
      }
      for (int i = 0; i < 200; ++i) {
        const Vec3d point(scene.view.eye.x, 0.06 * (i - 100), -6.0);
        const Vec3d r = point - scene.view.eye;
        const double depth = sightline::dot(scene.view.forward, r);
        const double x = 32.0 * (1.0 + sightline::dot(scene.view.right, r) / depth);
        const double y = 32.0 * (1.0 + sightline::dot(scene.view.up, r) / depth);
        if (x > 0.01 && x < 63.99 && y > 0.01 && y < 63.99) {
          ++looked;
          EXPECT_FALSE(buffer.covered(static_cast<std::uint32_t>(x), static_cast<std::uint32_t>(y))) << what;
        }
      }
      const Vec3d behind(scene.view.eye.x, 0.0, -20.0);
      EXPECT_NE(pyramid.classify({Vec3f(behind - Vec3d(1, 1, 1)), Vec3f(behind + Vec3d(1, 1, 1))}),
                Visibility::kHidden)
          << what;
    }
  }
  EXPECT_GT(looked, 10'000u);
  EXPECT_GT(covered, 180u * 3500u) << "all but what is about the gap";
}

std::vector<std::uint32_t> bitsOf(const BodyScene& scene, const OccluderSet& set,
                                  std::span<const OccluderId> chosen, const ParallelFor& parallel_for) {
  Rasteriser rasteriser(scene.settings);
  rasteriser.begin(scene.view);
  rasteriser.draw(set, chosen, parallel_for);
  std::vector<std::uint32_t> bits;
  for (std::uint32_t y = 0; y < scene.settings.height; ++y) {
    for (const float reciprocal_depth : rasteriser.depthBuffer().row(y)) {
      bits.push_back(std::bit_cast<std::uint32_t>(reciprocal_depth));
    }
  }
  return bits;
}

// Calls the body for uneven ranges, the last one first.
void inPieces(std::uint32_t count, const RangeBody& body) {
  for (std::uint32_t end = count; end > 0;) {
    const std::uint32_t begin = end - std::min(end, 1 + end % 3);
    body(begin, end);
    end = begin;
  }
}

TEST(BodyPolygons, HasTheSameBitsWithEveryInstructionSetHoweverTheWorkIsCutAndInAnyOrder) {
  const std::vector<std::int64_t> targets = hwy::SupportedAndGeneratedTargets();
  ASSERT_GE(targets.size(), test::kMinInstructionSets);
  std::mt19937_64 shuffler(3);
  std::size_t covered = 0;
  for (const Place place : kPlaces) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
      BodyScene scene(place, seed);
      scene.solids.push_back(BodyScene(place, seed + 240).solids[0]);
      const OccluderSet set = setOfSolids(scene.solids);
      std::vector<OccluderId> chosen = all(set);
      const std::vector<std::uint32_t> first = bitsOf(scene, set, chosen, serialFor);
      for (const std::uint32_t bits : first) {
        covered += std::bit_cast<float>(bits) > kUncovered ? 1 : 0;
      }
      for (const std::int64_t target : targets) {
        const test::ForcedInstructionSet forced(target);
        const std::vector<std::uint32_t> other = bitsOf(scene, set, chosen, serialFor);
        EXPECT_TRUE(other == first) << scene.what << ", " << hwy::TargetName(target);
      }
      EXPECT_TRUE(bitsOf(scene, set, chosen, inPieces) == first) << scene.what << ", in pieces";
      std::ranges::shuffle(chosen, shuffler);
      EXPECT_TRUE(bitsOf(scene, set, chosen, serialFor) == first) << scene.what << ", shuffled";
    }
  }
  EXPECT_GT(covered, 100'000u);
}

TEST(BodyPolygons, OneFaceThatIsChosenDrawsTheWholeBody) {
  const OccluderSet set = setOfSolids(std::vector{block({-2, -1, -9}, {1, 3, -5})});
  const BodyScene any(Place::kAlongTheAxes, 2);
  BodyScene scene = any;
  scene.view = viewFrom({4, 5, 0}, {-0.6, -0.6, -1});
  const std::vector<OccluderId> ids = all(set);
  const std::vector<std::uint32_t> whole = bitsOf(scene, set, ids, serialFor);
  EXPECT_GT(std::ranges::count_if(whole,
                                  [](std::uint32_t bits) { return std::bit_cast<float>(bits) > kUncovered; }),
            50);
  for (const OccluderId id : ids) {
    EXPECT_TRUE(bitsOf(scene, set, std::span(&id, 1), serialFor) == whole) << id.value;
  }
}

TEST(BodyPolygons, ViewsThatAreNotFiniteLeaveTheMapEmpty) {
  const OccluderSet set = setOfSolids(std::vector{block({-2, -1, -9}, {1, 3, -5})});
  const std::vector<OccluderId> ids = all(set);
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(),
                   kInf = std::numeric_limits<double>::infinity();
  for (const double bad : {kNan, kInf, -kInf}) {
    for (int what = 0; what < 7; ++what) {
      View view = viewFrom({4, 5, 0}, {-0.6, -0.6, -1});
      double* const fields[] = {&view.aspect, &view.right.x, &view.up.y,         &view.forward.z,
                                &view.eye.x,  &view.z_near,  &view.tan_half_fovy};
      *fields[what] = bad;
      Rasteriser rasteriser({.width = 32, .height = 32});
      rasteriser.begin(view);
      rasteriser.draw(set, ids);
      const DepthBufferView buffer = rasteriser.depthBuffer();
      for (std::uint32_t y = 0; y < buffer.height; ++y) {
        for (std::uint32_t x = 0; x < buffer.width; ++x) {
          ASSERT_FALSE(buffer.covered(x, y)) << "field " << what << " " << bad;
        }
      }
      EXPECT_EQ(rasteriser.stats().occluders, 0u);
    }
  }
}

TEST(BodyPolygons, ABodyCountsAsOneOccluder) {
  const OccluderSet set =
      setOfSolids(std::vector{block({-2, -1, -9}, {1, 3, -5}), block({-3, -2, -30}, {2, 4, -20}),
                              block({-0.5f, -0.5f, -1}, {0.5f, 0.5f, 1})});
  Rasteriser rasteriser({.width = 32, .height = 32});
  rasteriser.begin(viewFrom({0.25, 0.25, 0}, {0, 0, -1}));  // within the last one
  rasteriser.draw(set, all(set));
  EXPECT_EQ(rasteriser.stats().occluders, 2u);
  EXPECT_EQ(rasteriser.stats().unusable, 1u);
  EXPECT_EQ(rasteriser.stats().hidden, 1u);
  EXPECT_EQ(rasteriser.occluders().size(), 2u);
}

}  // namespace
}  // namespace sightline
