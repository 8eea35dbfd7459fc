#include "sightline/layers/pair_rule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <vector>

#include "src/layers/pairs/pair_eye.h"
#include "tests/support/layer_shapes.h"
#include "tests/support/not_finite.h"

namespace sightline {
namespace {

using shapes::Random;

constexpr PairOrder kFirstOnly{true, false};
constexpr PairOrder kSecondOnly{false, true};
constexpr PairOrder kBoth{true, true};
using test::kInfinity;
using test::kNan;

View eyeAt(const Vec3d& eye) {
  View view;
  view.eye = eye;
  setOrientation(view, {0, 0, -1}, {0, 1, 0});
  return view;
}

View eyeFarTowards(const Vec3d& towards_eye) {
  View view;
  setOrientation(view, -towards_eye, {0, 1, 0});
  view.orthographic = true;
  return view;
}

// Planes.

TEST(PairPlane, ThePartOnTheEyesSideMayOcclude) {
  const PairPlane known{{{0, 2, 0}, -2}};  // y = 1
  EXPECT_EQ(orderOf(known, eyeAt({5, 1.001, -3})), kFirstOnly);
  EXPECT_EQ(orderOf(known, eyeAt({5, 0.999, -3})), kSecondOnly);
  EXPECT_EQ(orderOf(known, eyeFarTowards({3, 0.001, 1})), kFirstOnly);
  EXPECT_EQ(orderOf(known, eyeFarTowards({3, -0.001, 1})), kSecondOnly);
}

TEST(PairPlane, AnEyeInThePlaneLeavesBoth) {
  const PairPlane known{{{1, 1, 1}, -1e6}};
  EXPECT_EQ(orderOf(known, eyeAt({1e6, 5, -5})), kBoth);
  EXPECT_EQ(orderOf(known, eyeAt({1e6, 5, -5 + 1e-7})), kBoth) << "within 1e-12 of the coordinates";
  EXPECT_EQ(orderOf(known, eyeAt({1e6, 5, -5 + 1e-4})), kFirstOnly);
  EXPECT_EQ(orderOf(known, eyeFarTowards({1, 1, -2})), kBoth);
}

TEST(PairPlane, LengthOfTheNormalDoesNotMatter) {
  Random random(7);
  for (const double scale : {1e-90, 1e-3, 1e5, 1e90}) {
    for (int i = 0; i < 50; ++i) {
      const Vec3d n = random.direction();
      const double offset = random.number(-2, 2);
      const View view = eyeAt(random.direction() * 3.0);
      EXPECT_EQ(orderOf(PairPlane{{n * scale, offset * scale}}, view), orderOf(PairPlane{{n, offset}}, view))
          << scale;
    }
  }
}

TEST(PairPlane, NonsenseLeavesBoth) {
  const View view = eyeAt({1, 2, 3});
  EXPECT_EQ(orderOf(PairPlane{{{0, 0, 0}, 5}}, view), kBoth);
  EXPECT_EQ(orderOf(PairPlane{{{0, kNan, 0}, 5}}, view), kBoth);
  EXPECT_EQ(orderOf(PairPlane{{{0, kInfinity, 0}, 5}}, view), kBoth);
  EXPECT_EQ(orderOf(PairPlane{{{0, 1, 0}, kNan}}, view), kBoth);
  EXPECT_EQ(orderOf(PairPlane{{{0, 1, 0}, kInfinity}}, view), kBoth);
  EXPECT_EQ(orderOf(PairPlane{{{0, 1, 0}, 5}}, eyeAt({1, kNan, 3})), kBoth);
  EXPECT_EQ(orderOf(PairPlane{{{0, 1, 0}, 5}}, eyeAt({kInfinity, 0, 3})), kBoth);
  View nowhere = eyeFarTowards({0, 1, 0});
  nowhere.forward = {0, 0, 0};
  EXPECT_EQ(orderOf(PairPlane{{{0, 1, 0}, 5}}, nowhere), kBoth);
  EXPECT_EQ(orderOf(PairPlane{{{0, 1e300, 0}, 5}}, eyeAt({1, 1e300, 3})), kBoth);
}

// Placements of whole numbers, so that the eye's position in the part's space is known exactly.
TEST(PairPlane, GoesWithAPartThatIsPlacedAnyhow) {
  const layers::Placement sheared{{1, 2, 0}, {0, 1, 3}, {1, 0, 1}, {100, -50, 7}};
  const layers::Placement mirrored{{-2, 0, 0}, {0, 1, 0}, {0, 0, 4}, {1, 2, 3}};
  const layers::Placement turned{{0, 1, 0}, {-1, 0, 0}, {0, 0, 1}, {-3, 0, 9}};
  Random random(3);
  for (const layers::Placement& placement : {sheared, mirrored, turned}) {
    for (int i = 0; i < 300; ++i) {
      const Vec3d n = shapes::randomGrid(random, 1, 5)[0];
      const Vec3d e = shapes::randomGrid(random, 1, 9)[0];
      const double offset = random.whole(-9, 9);
      const double height = dot(n, e) + offset;
      const PairOrder expected = n == Vec3d() || height == 0 ? kBoth : height > 0 ? kFirstOnly : kSecondOnly;
      const PairPlane known{{n, offset}};
      EXPECT_EQ(orderOf(known, layers::pairEye(eyeAt(placement.point(e)), placement)), expected) << i;
      View far = eyeFarTowards({0, 1, 0});
      far.forward = placement.origin - placement.point(e);
      const double slope = dot(n, e);
      const PairOrder expected_far = n == Vec3d() || slope == 0 ? kBoth
                                     : slope > 0                ? kFirstOnly
                                                                : kSecondOnly;
      EXPECT_EQ(orderOf(known, layers::pairEye(far, placement)), expected_far) << i;
    }
  }
}

TEST(PairPlane, AFlatPlacementLeavesBoth) {
  const layers::Placement flat{{1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 0, 0}};
  EXPECT_EQ(orderOf(PairPlane{{{0, 1, 0}, 5}}, layers::pairEye(eyeAt({1, 2, 3}), flat)), kBoth);
}

TEST(PairPlane, FarFromTheOriginWhatRoundingOfTheEyeMayHideLeavesBoth) {
  layers::Placement there;
  there.origin = {1e9, 1e9, 1e9};
  const PairPlane known{{{0, 1, 0}, 0}};
  EXPECT_EQ(orderOf(known, layers::pairEye(eyeAt({1e9, 1e9 + 1e-6, 1e9}), there)), kBoth);
  EXPECT_EQ(orderOf(known, layers::pairEye(eyeAt({1e9, 1e9 + 1, 1e9}), there)), kFirstOnly);
}

// Joints: s = 5, r = 3, so the rim's plane is at h = 4 and the cone's apex at l = 25 / 4.

SphereCylinderJoint threeFourFive() {
  SphereCylinderJoint joint;
  joint.sphere_radius = 5;
  joint.cylinder_radius = 3;
  return joint;
}

TEST(SphereCylinderJoint, BeforeTheRimsPlaneTheCylinderOccludes) {
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({10, 4.001, 0})), kSecondOnly);
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({0, 100, 0})), kSecondOnly);
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({0, 6, 0})), kSecondOnly) << "within the cone, at its apex";
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({10, 4, 0})), kBoth);
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({10, 3.999, 0})), kBoth);
}

TEST(SphereCylinderJoint, InTheConeBehindTheSphereItOccludes) {
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({0, -6, 0})), kFirstOnly);
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({14.999, -5, 0})), kFirstOnly);
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({15, -5, 0})), kBoth) << "4 a + 3 rho = 25";
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({15.001, -5, 0})), kBoth);
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({0, -5, 14.999})), kFirstOnly);
}

TEST(SphereCylinderJoint, FromAfarTheConeIsThatOfItsDirections) {
  EXPECT_EQ(orderOf(threeFourFive(), eyeFarTowards({1, 0.001, 0})), kSecondOnly);
  EXPECT_EQ(orderOf(threeFourFive(), eyeFarTowards({1, 0, 0})), kBoth);
  EXPECT_EQ(orderOf(threeFourFive(), eyeFarTowards({4, -3, 0})), kBoth) << "along the cone: 4 a + 3 rho = 0";
  EXPECT_EQ(orderOf(threeFourFive(), eyeFarTowards({3.999, -3, 0})), kFirstOnly);
  EXPECT_EQ(orderOf(threeFourFive(), eyeFarTowards({4.001, -3, 0})), kBoth);
  EXPECT_EQ(orderOf(threeFourFive(), eyeFarTowards({0, -1, 0})), kFirstOnly);
}

TEST(SphereCylinderJoint, OfEqualRadiiTheConeIsACylinder) {
  SphereCylinderJoint joint;  // both radii are 1
  EXPECT_EQ(orderOf(joint, eyeAt({0.999, -30, 0})), kFirstOnly);
  EXPECT_EQ(orderOf(joint, eyeAt({1, -30, 0})), kBoth);
  EXPECT_EQ(orderOf(joint, eyeAt({1.001, -30, 0})), kBoth);
  EXPECT_EQ(orderOf(joint, eyeAt({1.5, 0.001, 0})), kSecondOnly);
  EXPECT_EQ(orderOf(joint, eyeFarTowards({0, -1, 0})), kBoth);
  EXPECT_EQ(orderOf(joint, eyeFarTowards({0.1, 1, 0})), kSecondOnly);
}

TEST(SphereCylinderJoint, AnEyeInTheSphereLeavesBoth) {
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({0, -4, 0})), kBoth);
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({0, -5, 0})), kBoth);
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({0, 4.5, 0})), kBoth);
}

TEST(SphereCylinderJoint, LengthOfTheAxisDoesNotMatter) {
  for (const double scale : {1e-250, 1e-3, 1e3, 1e250}) {
    SphereCylinderJoint joint = threeFourFive();
    joint.axis = {0, scale, 0};
    EXPECT_EQ(orderOf(joint, eyeAt({10, 4.001, 0})), kSecondOnly);
    EXPECT_EQ(orderOf(joint, eyeAt({14.999, -5, 0})), kFirstOnly);
    EXPECT_EQ(orderOf(joint, eyeAt({15.001, -5, 0})), kBoth);
  }
}

TEST(SphereCylinderJoint, NonsenseLeavesBoth) {
  const View view = eyeAt({0, -10, 0});  // the eye sees the sphere alone
  ASSERT_EQ(orderOf(threeFourFive(), view), kFirstOnly);
  const auto with = [](auto change) {
    SphereCylinderJoint joint = threeFourFive();
    change(joint);
    return joint;
  };
  for (const double radius : {0.0, -3.0, 5.001, kNan, kInfinity}) {
    EXPECT_EQ(orderOf(with([&](auto& joint) { joint.cylinder_radius = radius; }), view), kBoth) << radius;
  }
  for (const double radius : {0.0, -5.0, 2.0, kNan, kInfinity}) {
    EXPECT_EQ(orderOf(with([&](auto& joint) { joint.sphere_radius = radius; }), view), kBoth) << radius;
  }
  EXPECT_EQ(orderOf(with([](auto& joint) { joint.axis = {0, 0, 0}; }), view), kBoth);
  EXPECT_EQ(orderOf(with([](auto& joint) { joint.axis = {kNan, 1, 0}; }), view), kBoth);
  EXPECT_EQ(orderOf(with([](auto& joint) { joint.axis = {0, kInfinity, 0}; }), view), kBoth);
  EXPECT_EQ(orderOf(with([](auto& joint) { joint.centre = {0, kNan, 0}; }), view), kBoth);
  EXPECT_EQ(orderOf(threeFourFive(), eyeAt({0, -kInfinity, 0})), kBoth);
}

// A random joint, and functions that test rays and points of the rim. The cylinder reaches from the rim's
// plane to `end`.
struct MadeJoint {
  SphereCylinderJoint joint;
  shapes::Axes axes;  // y is the cylinder's axis
  double rim = 0.0, end = 0.0;

  explicit MadeJoint(Random& random) : axes(shapes::randomAxes(random)) {
    joint.centre = random.point({-5, -5, -5}, {5, 5, 5});
    joint.sphere_radius = random.number(0.5, 3.0);
    joint.cylinder_radius =
        random.below(5) == 0 ? joint.sphere_radius : joint.sphere_radius * random.number(0.05, 1.0);
    joint.axis = axes.y * random.number(0.1, 10.0);
    rim =
        std::sqrt(joint.sphere_radius * joint.sphere_radius - joint.cylinder_radius * joint.cylinder_radius);
    end = joint.sphere_radius * random.number(1.0, 4.0);
  }

  Vec3d local(const Vec3d& d) const { return {dot(d, axes.x), dot(d, axes.y), dot(d, axes.z)}; }
  bool holds(const Vec3d& point) const {
    const Vec3d p = local(point - joint.centre);
    return length(p) <= joint.sphere_radius ||
           (p.y >= rim && p.y <= end && std::hypot(p.x, p.z) <= joint.cylinder_radius);
  }

  // Returns the t at which the ray origin + t direction enters.
  std::optional<double> hitSphere(const Vec3d& origin, const Vec3d& direction) const {
    const Vec3d o = origin - joint.centre;
    return firstRoot(dot(direction, direction), dot(o, direction),
                     dot(o, o) - joint.sphere_radius * joint.sphere_radius);
  }
  std::optional<double> hitCylinder(const Vec3d& origin, const Vec3d& direction) const {
    const Vec3d o = local(origin - joint.centre), d = local(direction);
    double enter = -kInfinity, leave = kInfinity;
    const double a = d.x * d.x + d.z * d.z, b = o.x * d.x + o.z * d.z;
    const double c = o.x * o.x + o.z * o.z - joint.cylinder_radius * joint.cylinder_radius;
    if (b * b < a * c) {
      return std::nullopt;
    }
    const double root = std::sqrt(b * b - a * c);
    enter = (-b - root) / a;
    leave = (-b + root) / a;
    const double at_rim = (rim - o.y) / d.y, at_end = (end - o.y) / d.y;
    enter = std::max(enter, std::min(at_rim, at_end));
    leave = std::min(leave, std::max(at_rim, at_end));
    return enter <= leave ? std::optional(enter) : std::nullopt;
  }
  static std::optional<double> firstRoot(double a, double b, double c) {
    return b * b < a * c ? std::nullopt : std::optional((-b - std::sqrt(b * b - a * c)) / a);
  }

  Vec3d rimPoint(double angle) const {
    return joint.centre + axes.y * rim +
           (axes.x * std::cos(angle) + axes.z * std::sin(angle)) * joint.cylinder_radius;
  }
  // Returns a point near the sphere or the cylinder.
  Vec3d target(Random& random) const {
    const double r = joint.sphere_radius;
    const Vec3d p = random.point({-r, -r, -r}, {r, std::max(r, end), r});
    return joint.centre + axes.turn(p);
  }
};

void checkRays(const MadeJoint& made, const View& view, const PairOrder& order, Random& random) {
  constexpr int kRays = 400;
  const double tie = 1e-9;
  for (int ray = 0; ray < kRays; ++ray) {
    const Vec3d target = ray % 4 == 0 ? made.rimPoint(random.number(0, 6.3)) +
                                            random.direction() * (0.02 * made.joint.cylinder_radius)
                                      : made.target(random);
    const Vec3d origin = view.orthographic ? target - view.forward * 100.0 : view.eye;
    const Vec3d direction = normalized(target - origin);
    const std::optional<double> sphere = made.hitSphere(origin, direction);
    const std::optional<double> cylinder = made.hitCylinder(origin, direction);
    if (!sphere || !cylinder || *sphere < 0 || *cylinder < 0) {
      continue;
    }
    ASSERT_TRUE(order.first_may_occlude || *sphere > *cylinder - tie) << "ray " << ray;
    ASSERT_TRUE(order.second_may_occlude || *cylinder > *sphere - tie) << "ray " << ray;
  }
}

TEST(SphereCylinderJoint, NoRayContradictsTheOrder) {
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const MadeJoint made(random);
    Vec3d eye = made.joint.centre;
    while (made.holds(eye)) {
      eye = made.joint.centre +
            random.direction() * (made.joint.sphere_radius * (1.0 + 6.0 * random.number(0, 1)));
    }
    const View near = eyeAt(eye);
    checkRays(made, near, orderOf(made.joint, near), random);
    const View far = eyeFarTowards(random.direction());
    checkRays(made, far, orderOf(made.joint, far), random);
    if (HasFatalFailure()) {
      return;
    }
  }
}

// For an eye behind the rim's plane, the two occlude each other only if the eye sees a point of the rim.
TEST(SphereCylinderJoint, BothOnlyWhereTheRimIsSeenFromBehind) {
  int both = 0;
  for (std::uint64_t seed = 1; seed <= 1500; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const MadeJoint made(random);
    const Vec3d eye =
        made.joint.centre + random.direction() * (made.joint.sphere_radius * random.number(1.01, 8.0));
    const Vec3d e = made.local(eye - made.joint.centre);
    double seen =
        -kInfinity;  // greatest height of the eye above the sphere's tangent plane at a point of the rim
    for (int i = 0; i < 720; ++i) {
      const Vec3d p = made.rimPoint(i * (6.283185307179586 / 720));
      seen = std::max(seen, dot(eye - p, p - made.joint.centre));
    }
    const PairOrder order = orderOf(made.joint, eyeAt(eye));
    const double scale = made.joint.sphere_radius * length(e);
    if (e.y > made.rim + 1e-9) {
      EXPECT_EQ(order, kSecondOnly);
    } else if (seen > 1e-9) {
      EXPECT_EQ(order, kBoth);
      ++both;
    } else if (seen < -1e-4 * scale) {  // the margin allows for sampling the rim
      EXPECT_EQ(order, kFirstOnly);
    }
  }
  EXPECT_GT(both, 100);
}

// The share of directions behind the plane and outside the cone is r / 2s: by the areas of caps of the sphere
// of directions it is 1 / 2 - (1 - r / s) / 2.
TEST(SphereCylinderJoint, OneArcIsFoundFromAsManyDirectionsAsTheSphereOfDirectionsSays) {
  for (const double ratio : {0.1, 0.5, 0.9, 1.0}) {
    SphereCylinderJoint joint;
    joint.sphere_radius = 2;
    joint.cylinder_radius = 2 * ratio;
    joint.axis = {1, 2, -3};
    Random random(11);
    int both = 0;
    constexpr int kDirections = 20000;
    for (int i = 0; i < kDirections; ++i) {
      both += orderOf(joint, eyeFarTowards(random.direction())) == kBoth ? 1 : 0;
    }
    EXPECT_NEAR(static_cast<double>(both) / kDirections, ratio / 2, 0.015) << ratio;
  }
}

}  // namespace
}  // namespace sightline
