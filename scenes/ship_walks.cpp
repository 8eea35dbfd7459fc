// Camera paths of the ship: from a corridor down to the engine room, and random views.

#include <algorithm>

#include "scenes/ship_parts.h"
#include "scenes/walk.h"

namespace sightline::scenes::ship {
namespace {

constexpr double kFar = 400.0;
// Minimum distance in metres between a random eye and the bounds of any object.
constexpr double kElbowRoom = 0.3;

class Route {
 public:
  explicit Route(double floor) : floor_(floor) {}

  void to(double x, double y) { corners_.push_back({x, y, floor_ + kEyeHeight}); }
  // Goes from the corridor into the room, once around in it, and back.
  void visit(const Room& room) {
    const auto inside = [&](double x, double y) {
      const Vec3d p = room.placement.point({x, y, 0.0});
      to(p.x, p.y);
    };
    const double corridor = -kRoomStart;
    inside(kDoorMiddle, corridor);
    inside(kDoorMiddle + 0.05, 1.0);
    inside(kDoorMiddle, 3.6);
    inside(kDoorMiddle + 0.4, 4.6);
    inside(kDoorMiddle + 0.75, 3.6);
    inside(kDoorMiddle + 0.05, 1.0);
    inside(kDoorMiddle, corridor);
  }
  // Goes down one storey of the stairwell that begins at x, from door to door.
  void descend(double x) {
    const double door = (kRoomStart + kStairFoot) * 0.5, landing = (kStairLanding + kBlockHalf) * 0.5;
    to(x + kStairOn, door);
    to(x + kStairOn, kStairFoot);
    floor_ -= kStorey * 0.5;
    to(x + kStairOn, kStairLanding);
    to(x + kStairOn, landing);
    to(x + kStairUp, landing);
    to(x + kStairUp, kStairLanding);
    floor_ -= kStorey * 0.5;
    to(x + kStairUp, kStairFoot);
    to(x + kStairUp, door);
  }
  const std::vector<Vec3d>& corners() const { return corners_; }

 private:
  double floor_;
  std::vector<Vec3d> corners_;
};

// A random standing place: three in five are in rooms, one in corridors, one on deck above the holds.
Vec3d randomEye(const Plan& plan, Random& random) {
  const std::uint32_t kind = random.below(5), deck = random.below(plan.decks);
  const std::uint32_t bay = random.below(plan.bays());
  const bool port = random.chance(0.5);
  const double along = random.uniform(), across = random.uniform();
  if (kind == 0) {
    const double x = kBlockStart + along * (plan.blockEnd() - kBlockStart);
    return {x, (2.0 * across - 1.0) * kCorridorHalf, deckHeight(deck) + kEyeHeight};
  }
  if (kind == 1) {
    const double x = plan.holdStart(0) + along * (kHoldsEnd - plan.holdStart(0));
    return {x, (2.0 * across - 1.0) * halfBreadthInShell(x, kMainDeck), kMainDeck + kEyeHeight};
  }
  const Room room = roomAt(plan, deck, bay, port);
  return room.placement.point({along * room.width, across * room.depth, kEyeHeight});
}

bool isClear(const Scene& scene, const Vec3d& eye_plan) {
  const Vec3d eye = worldFromPlan(eye_plan);
  return std::none_of(scene.objects.begin(), scene.objects.end(), [&](const Object& object) {
    bool near = true;
    for (int axis = 0; axis < 3; ++axis) {
      near = near && object.bounds.min[axis] - kElbowRoom < eye[axis] &&
             eye[axis] < object.bounds.max[axis] + kElbowRoom;
    }
    return near;
  });
}

}  // namespace

CameraPath walk(const Plan& plan) {
  const double stairs = plan.bayStart(plan.stairBay());
  const std::array<Room, 2> rooms = roomsOnWalk(plan);
  Route route(deckHeight(kMainDeckNumber));
  route.to(kBlockStart + 1.0, 0.0);
  route.visit(rooms[0]);
  route.visit(rooms[1]);
  route.to(stairs + kStairOn, 0.0);
  for (std::uint32_t storey = 0; storey < kMainDeckNumber + kEngineStoreys; ++storey) {
    route.descend(stairs);
  }
  route.to(stairs + kStairUp, 0.0);
  route.to(kBlockStart + 1.5, 0.0);
  const WalkOptions options{.name = "walk", .look_ahead = 1.5, .calm = 2, .max_turn = 0.06, .far = kFar};
  return walkAlong(roundedRoute(route.corners(), 0.5), options);
}

CameraPath randomViews(const Plan& plan, const Scene& scene, Random random) {
  constexpr std::size_t kFrames = 200;
  CameraPath path;
  path.name = "random";
  path.z_far = kFar;
  while (path.frames.size() < kFrames) {
    const Vec3d eye = randomEye(plan, random);
    const Point2 look = unitVector(random.uniform());
    const double up = random.range(-0.3, 0.3);
    if (isClear(scene, eye)) {
      path.frames.push_back(
          {worldFromPlan(eye), normalized(worldFromPlan({look.x, look.y, up})), {0.0, 1.0, 0.0}});
    }
  }
  return path;
}

}  // namespace sightline::scenes::ship
