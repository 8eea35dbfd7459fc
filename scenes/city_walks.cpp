// The camera paths of the city.

#include "scenes/city_parts.h"
#include "scenes/walk.h"

namespace sightline::scenes {
namespace {

constexpr double kEyeHeight = 1.7;
constexpr double kBesideMiddle = 2.0;  // metres from a street's centre line, clear of parked cars
constexpr double kStreet = kQuarter - kBesideMiddle;
constexpr double kLane = kQuarter / 2;

// Converts corners relative to the central quarter.
std::vector<Vec3d> inMiddleQuarter(const CityPlan& plan, std::vector<Vec3d> corners) {
  const Vec3d origin((plan.columns - 1) / 2 * kQuarter, (plan.rows - 1) / 2 * kQuarter, 0.0);
  for (Vec3d& corner : corners) {
    corner += origin;
  }
  return corners;
}

CameraPath smoothWalk(const CityPlan& plan) {
  const std::vector<Vec3d> route = inMiddleQuarter(plan, {{kLane, kBesideMiddle, kEyeHeight},
                                                          {kLane, kLane, kEyeHeight},
                                                          {kStreet, kLane, kEyeHeight},
                                                          {kStreet, kStreet, kEyeHeight},
                                                          {kStreet - 15.0, kStreet, kEyeHeight}});
  WalkOptions options{
      .name = "smooth", .look_ahead = 4.0, .glance = 0.35, .glance_turns = 5, .far = plan.far};
  return walkAlong(roundedRoute(route, 5.0), options);
}

// The walk goes around the centre of a closed court.
CameraPath bestWalk(const CityPlan& plan) {
  const auto at = [&](double x, double y) {
    return Vec3d(plan.courtyard.x + x, plan.courtyard.y + y, kEyeHeight + kKerb);
  };
  const Vec3d route[] = {at(-3, -3), at(3, -3), at(3, 3), at(-3, 3), at(-3, -2)};
  WalkOptions options{.name = "best", .frames = 100, .look_ahead = 2.0, .far = plan.far};
  return walkAlong(roundedRoute(route, 2.5), options);
}

// The walk is at the height of a fourth floor's balcony, above a street.
CameraPath averageWalk(const CityPlan& plan) {
  const std::vector<Vec3d> route = inMiddleQuarter(plan, {{kStreet, 20.0, 11.5}, {kStreet, 55.0, 11.5}});
  WalkOptions options{.name = "average", .frames = 100, .glance = 0.5, .glance_turns = 1, .far = plan.far};
  return walkAlong(route, options);
}

// High above all roofs, from the south-west corner towards the centre.
CameraPath worstWalk(const CityPlan& plan) {
  constexpr double kHeight = 60.0;
  const Vec3d corner(0.0, 0.0, kHeight);
  const Vec3d across(plan.columns * kQuarter, plan.rows * kQuarter, 0.0);
  const Vec3d route[] = {corner, corner + normalized(across) * 60.0};
  WalkOptions options{.name = "worst", .frames = 100, .look_ahead = 10.0, .tilt = -0.3, .far = plan.far};
  return walkAlong(route, options);
}

}  // namespace

std::vector<CameraPath> cityWalks(const CityPlan& plan) {
  return {smoothWalk(plan), bestWalk(plan), averageWalk(plan), worstWalk(plan)};
}

}  // namespace sightline::scenes
