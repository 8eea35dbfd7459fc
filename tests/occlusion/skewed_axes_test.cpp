// Orthographic views whose axes are not quite perpendicular, as single precision makes them: right and up
// decide what lies on one line of sight, whatever forward is.

#include <gtest/gtest.h>

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <functional>
#include <string>
#include <vector>

#include "sightline/comparison/kept_planes.h"
#include "sightline/occlusion/depth_pyramid.h"
#include "sightline/occlusion/occlusion_tree.h"
#include "sightline/occlusion/opacity_map.h"
#include "sightline/occlusion/supporting_planes.h"
#include "tests/occlusion/small_scenes.h"
#include "tests/support/rounds.h"

namespace sightline {
namespace {

using namespace test;
using Rational = boost::multiprecision::cpp_rational;

struct PicturePlace {
  Rational x, y;
};

// Where a point is in the picture, exactly, in metres.
PicturePlace placeOf(const View& view, const Vec3f& point) {
  const auto along = [&](const Vec3d& axis) {
    Rational sum = 0;
    for (int i = 0; i < 3; ++i) {
      sum += Rational(axis[i]) * (Rational(static_cast<double>(point[i])) - Rational(view.eye[i]));
    }
    return sum;
  };
  return {along(view.right), along(view.up)};
}

// Whether the point is behind the triangle in the picture. It is farther away than all of the triangle.
bool isBehind(const View& view, const std::array<Vec3f, 3>& triangle, const Vec3f& point) {
  const PicturePlace p = placeOf(view, point);
  for (std::size_t i = 0; i < 3; ++i) {
    const PicturePlace a = placeOf(view, triangle[i]), b = placeOf(view, triangle[(i + 1) % 3]);
    if ((b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x) < 0) {
      return false;
    }
  }
  return true;
}

// A triangle near the eye, and a point far behind one of its edges. Between the lines of sight and lines
// along forward lie some millimetres there.
struct EdgeAndPoint {
  explicit EdgeAndPoint(std::uint64_t seed) : random(seed) {
    setOrientation(view, random.point(1.0), random.point(1.0));
    view.orthographic = true;
    view.aspect = 1.0;
    view.z_near = 0.0;
    view.z_far = 1e6;
    const View straight = view;
    if (seed % 3 == 0) {
      for (Vec3d* axis : {&view.right, &view.up, &view.forward}) {
        *axis = Vec3d(Vec3f(*axis));
      }
    } else {
      view.right = normalized(view.right + view.forward * random.in(-9e-7, 9e-7) + view.up * 4e-7);
      view.up = normalized(view.up + view.forward * random.in(-9e-7, 9e-7) + straight.right * 4e-7);
    }
    const auto at = [&](double x, double y, double depth) {
      return straight.right * x + straight.up * y + straight.forward * depth;
    };
    const double slant = random.in(-1.0, 1.0);
    triangle = {Vec3f(at(0, -1, 3)), Vec3f(at(0, 1, 3)), Vec3f(at(-2, 0, 4 + slant))};
    view.eye = (Vec3d(triangle[0]) + Vec3d(triangle[1])) * 0.5 - straight.forward * 3.0;
    const double depth = random.in(2e3, 2e4);
    view.ortho_height = 1e-5 * depth;
    const Vec3d across = cross(view.right, view.up);
    const Vec3d sight = across / dot(across, view.forward);
    point =
        Vec3f(view.eye + sight * depth +
              (straight.right * random.in(-2.0, 2.0) + straight.up * random.in(-2.0, 2.0)) * (1e-6 * depth));
  }

  Random random;
  View view;
  std::array<Vec3f, 3> triangle;
  Vec3f point;
};

struct AskedMethod {
  std::string name;
  std::function<Visibility(const View&, const OccluderSet&, const Box&)> classify;
};

template <typename Structure>
AskedMethod methodOf(const std::string& name, std::function<Structure()> make) {
  return {name, [make](const View& view, const OccluderSet& set, const Box& box) {
            Structure structure = make();
            structure.build(view, set, all(set));
            return structure.classify(box);
          }};
}

std::vector<AskedMethod> allMethods() {
  std::vector<AskedMethod> methods{
      methodOf<SupportingPlanes>("supporting planes", [] { return SupportingPlanes(); }),
      methodOf<KeptPlanes>("kept planes", [] { return KeptPlanes(); }),
      methodOf<OpacityMap>("opacity map", [] { return OpacityMap(); }),
      methodOf<DepthPyramid>("depth pyramid", [] { return DepthPyramid(); })};
  for (const OcclusionTreeVariant variant : kTreeVariants) {
    methods.push_back(methodOf<OcclusionTree>("tree " + std::to_string(static_cast<int>(variant)),
                                              [variant] { return OcclusionTree({.variant = variant}); }));
  }
  return methods;
}

TEST(SkewedAxes, EveryMethodLooksAlongTheLinesOfSightOfThePicture) {
  const std::vector<AskedMethod> methods = allMethods();
  std::vector<int> found(methods.size());
  int hidden = 0, visible = 0;
  const std::uint64_t rounds = test::rounds(1200u);
  for (std::uint64_t seed = 1; seed <= rounds; ++seed) {
    const EdgeAndPoint scene(seed);
    ASSERT_TRUE(validate(scene.view)) << seed;
    const OccluderSet set =
        setOf(std::vector<OraclePolygon>{{{scene.triangle.begin(), scene.triangle.end()}, seed % 2 == 0}});
    ASSERT_EQ(set.occluders.size(), 1u) << seed;
    const bool behind = isBehind(scene.view, scene.triangle, scene.point);
    (behind ? hidden : visible) += 1;
    for (std::size_t i = 0; i < methods.size(); ++i) {
      const bool is_hidden =
          methods[i].classify(scene.view, set, {scene.point, scene.point}) == Visibility::kHidden;
      EXPECT_TRUE(behind || !is_hidden) << methods[i].name << ", seed " << seed;
      found[i] += is_hidden ? 1 : 0;
    }
  }
  EXPECT_GT(visible, 0.3 * static_cast<double>(rounds));
  // What lies behind is found. The map keeps what is closer to the edge than some pixels.
  for (std::size_t i = 0; i < methods.size(); ++i) {
    EXPECT_GT(found[i], (methods[i].name == "opacity map" ? 0.3 : 0.9) * hidden) << methods[i].name;
  }
}

}  // namespace
}  // namespace sightline
