// The camera path through the building: along the corridors, into rooms and out again, up the stairs.

#include "scenes/building_parts.h"
#include "scenes/walk.h"

namespace sightline::scenes {
namespace {

constexpr double kEyeHeight = 1.7;

class Route {
 public:
  explicit Route(const BuildingPlan& plan) : plan_(plan) {}

  void to(double x, double y) { corners_.push_back({x, y, z_ + kEyeHeight}); }
  // Goes along the room's corridor to its door, once around in the room, and back into the corridor.
  void visit(const Visit& visit) {
    const Room room = roomAt(plan_, visit.floor, visit.bay, visit.row);
    const double x = doorOf(plan_, visit.bay, visit.row),
                 y = corridor(room.north ? visit.row - 1 : visit.row + 1);
    const auto inside = [&](double local_x, double local_y) {
      const Vec3d p = room.placement.point({local_x, local_y, 0});
      to(p.x, p.y);
    };
    to(x, y);
    const double near = room.loopStart(), reach = room.loopReach();
    inside(room.door, near);
    inside(room.door - reach, near + reach);
    inside(room.door, near + 2 * reach);
    inside(room.door + reach, near + reach);
    inside(room.door, near);
    to(x, y);
  }
  void cross(std::uint32_t from_row, std::uint32_t to_row) {
    const double x = (plan_.xs[kHallBay] + plan_.xs[kHallBay + 1]) * 0.5;
    to(x, corridor(from_row));
    to(x, corridor(to_row));
  }
  void climb() {
    const Rectangle well = plan_.cell(kStairBay, 0);
    const double up = well.min.x + 1.25, on = well.max.x - 1.25, foot = well.max.y - 0.6;
    to(up, corridor(kCorridorA));
    to(up, foot);
    z_ += kStorey / 2;
    to(up, well.min.y + 0.95);
    to(on, well.min.y + 0.95);
    z_ += kStorey / 2;
    to(on, foot);
    to(on, corridor(kCorridorA));
  }
  double corridor(std::uint32_t row) const { return (plan_.ys[row] + plan_.ys[row + 1]) * 0.5; }
  const std::vector<Vec3d>& corners() const { return corners_; }

 private:
  const BuildingPlan& plan_;
  double z_ = 0.0;
  std::vector<Vec3d> corners_;
};

}  // namespace

CameraPath buildingWalk(const BuildingPlan& plan) {
  const std::vector<Visit>& rooms = visits();
  Route route(plan);
  route.to(1.0, route.corridor(kCorridorA));
  route.visit(rooms[0]);
  route.visit(rooms[1]);
  route.cross(kCorridorA, kCorridorB);
  route.visit(rooms[2]);
  route.cross(kCorridorB, kCorridorA);
  if (plan.floors > 1) {
    route.climb();
    route.visit(rooms[4]);
    route.visit(rooms[5]);
    route.to(2.0, route.corridor(kCorridorA));
  } else {
    route.visit(rooms[3]);
  }
  const WalkOptions options{.name = "smooth", .look_ahead = 1.2, .calm = 2, .max_turn = 0.04, .far = 200.0};
  return walkAlong(roundedRoute(route.corners(), 0.6), options);
}

}  // namespace sightline::scenes
