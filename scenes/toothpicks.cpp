// Ellipsoids that tumble with their centres in a cube with sides of one metre. The frame surrounds the cube
// at the distance of a toothpick's half length, so that their ends bounce off the frame's sides.
//
// Based on: John Snyder, Jed Lengyel. Visibility Sorting and Compositing for Image-Based Rendering.
// Microsoft Research MSR-TR-97-11, 1997, section 12.1.
// Differs from the paper in: sizes, which it does not give. Ours reproduce its shares of groups with more
// than one part, for 200 toothpicks, for 1,600 at the same density, and for 1,600 at the same size.

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scenes/moving_parts.h"
#include "scenes/random.h"

namespace sightline {
namespace scenes {
namespace {

constexpr double kHalfLength = 0.077, kHalfWidth = 0.0084;  // metres, at scale 1
// 41 bands of 8: 312 quads and 16 triangles, 40 rings of 8 vertices and two poles: 322.
constexpr std::uint32_t kBands = 41, kSegments = 8;
constexpr double kEndMovement = 0.00269;  // metres per frame, mean over all ends
constexpr double kSphereRadius = 0.05, kCylinderRadius = 0.004;
// Relative enlargement of the hulls over the meshes. It exceeds the rounding when a mesh is moved to its pose
// and stored in single precision.
constexpr double kHullGrowth = 0x1p-14;

// Newton's method for numbers > 0. Uses only sums and quotients, so it has the same bits everywhere.
double cubeRoot(double a) {
  double x = std::max(a, 1.0);
  for (int i = 0; i < 64; ++i) {
    x = (2.0 * x + a / (x * x)) / 3.0;
  }
  return x;
}

double scaleOf(const ToothpickOptions& options) {
  return options.uniform_density ? cubeRoot(200.0 / std::max(options.count, 1u)) : 1.0;
}

// The position of an object that bounces at both ends of a side of the cube, from its start position and the
// distance travelled.
double bounced(double start, double travelled) {
  const double turns = (start + travelled) / 2.0;
  const double at = (turns - std::floor(turns)) * 2.0;
  return at > 1.0 ? 2.0 - at : at;
}

struct Toothpick {
  Vec3d centre;    // in frame 0
  Vec3d velocity;  // metres per frame, until it bounces
  // The long axis turns in the plane of these two vectors, from the first to the second.
  Vec3d axis, aside;
  double turns = 0.0;  // full turns per frame
};

struct Motion {
  std::vector<Toothpick> toothpicks;
  double velocity = 1.0;

  Mat4 worldFromPart(std::size_t i, double frame) const {
    const Toothpick& t = toothpicks[i];
    const double time = frame * velocity;
    Vec3d centre;
    for (int a = 0; a < 3; ++a) {
      centre[a] = bounced(t.centre[a], t.velocity[a] * time);
    }
    const Point2 d = unitVector(t.turns * time);
    const Vec3d along = t.axis * d.x + t.aside * d.y, across = t.aside * d.x - t.axis * d.y;
    // The long axis is the part's y axis.
    return rigid(across, along, cross(across, along), centre);
  }
};

Vec3d randomDirection(Random& random) {
  for (;;) {
    const double x = random.range(-1.0, 1.0), y = random.range(-1.0, 1.0), z = random.range(-1.0, 1.0);
    const Vec3d v(x, y, z);
    const double squared = dot(v, v);
    if (squared > 0.01 && squared <= 1.0) {
      return normalized(v);
    }
  }
}

// Speeds are relative to each other: that of the centre, and that of the ends due to turning alone.
Toothpick randomToothpick(Random random, double half_length) {
  Toothpick t;
  for (int a = 0; a < 3; ++a) {
    t.centre[a] = random.uniform();
  }
  t.axis = randomDirection(random);
  t.aside = normalized(cross(randomDirection(random), t.axis));
  const Vec3d direction = randomDirection(random);
  t.velocity = direction * random.range(0.5, 1.5);
  t.turns = random.range(0.5, 1.5) / (6.283185307179586 * half_length);
  return t;
}

// Mean speed of all ends over a whole turn, ignoring bounces.
double meanEndSpeed(std::span<const Toothpick> toothpicks, double half_length) {
  constexpr int kSteps = 32;
  double sum = 0.0;
  for (const Toothpick& t : toothpicks) {
    const double end_speed = t.turns * 6.283185307179586 * half_length;
    for (int i = 0; i < kSteps; ++i) {
      const Point2 d = unitVector(static_cast<double>(i) / kSteps);
      sum += length(t.velocity + (t.axis * d.x + t.aside * d.y) * end_speed);
    }
  }
  return sum / (static_cast<double>(toothpicks.size()) * kSteps);
}

Motion makeMotion(const ToothpickOptions& options) {
  const double half_length = kHalfLength * scaleOf(options);
  Motion motion;
  motion.velocity = options.velocity;
  for (std::uint32_t i = 0; i < options.count; ++i) {
    motion.toothpicks.push_back(randomToothpick(Random(options.seed, i), half_length));
  }
  const double factor = kEndMovement / meanEndSpeed(motion.toothpicks, half_length);
  for (Toothpick& t : motion.toothpicks) {
    t.velocity = t.velocity * factor;
    t.turns *= factor;
  }
  return motion;
}

// An ellipsoid from pole to pole about the builder's z axis, which is the part's y axis.
Scene ellipsoid(double half_length, double half_width, std::uint32_t bands, std::uint32_t segments) {
  return buildPartMesh([&](MeshBuilder& mesh) {
    std::vector<Point2> profile{{0.0, -half_length}};
    for (std::uint32_t i = 1; i < bands; ++i) {
      const Point2 d = unitVector(0.5 * i / bands);
      profile.push_back({half_width * d.y, -half_length * d.x});
    }
    profile.push_back({0.0, half_length});
    mesh.lathe(profile, segments);
  });
}

Scene cylinder(double half_length, double radius) {
  const Point2 profile[] = {
      {0.0, -half_length}, {radius, -half_length}, {radius, half_length}, {0.0, half_length}};
  return buildPartMesh([&](MeshBuilder& mesh) { mesh.lathe(profile, 16); });
}

// Height above a sphere's centre of the circle in which a cylinder's end lies on that corner sphere.
double rimHeight() {
  return std::sqrt(kSphereRadius * kSphereRadius - kCylinderRadius * kCylinderRadius);
}

SphereCylinderJoint jointAlong(const Vec3d& axis) {
  return {.sphere_radius = kSphereRadius, .axis = axis, .cylinder_radius = kCylinderRadius};
}

enum Kind : std::uint32_t { kToothpick, kCorner, kEdge };

MovingPart partOf(Kind kind, std::string name) {
  MovingPart part;
  part.name = std::move(name);
  part.hulls = {kind};
  part.class_of = kind;
  part.settings.is_static = kind != kToothpick;
  return part;
}

// margin: distance from the cube. The frame's parts do not move. Returns their poses in the order of the
// parts.
std::vector<Mat4> addFrame(MovingScene& scene, double margin, const Scene& sphere, const Scene& edge) {
  std::vector<Mat4> poses;
  const auto side = [margin](std::uint32_t upper) { return upper != 0 ? 1.0 + margin : -margin; };
  for (std::uint32_t i = 0; i < 8; ++i) {
    poses.push_back(rigid({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {side(i & 1), side(i & 2), side(i & 4)}));
    addMovingPart(scene, partOf(kCorner, "corner " + std::to_string(i)), sphere, poses.back(),
                  MaterialId{kCorner});
  }
  const auto corners = static_cast<std::uint32_t>(scene.parts.size() - 8);
  for (std::uint32_t i = 0; i < 12; ++i) {
    const int axis = static_cast<int>(i / 4);
    Vec3d middle, along, aside;
    middle[axis] = 0.5;
    middle[(axis + 1) % 3] = side(i & 1);
    middle[(axis + 2) % 3] = side(i & 2);
    along[axis] = 1.0;
    aside[(axis + 2) % 3] = 1.0;
    poses.push_back(rigid(aside, along, cross(aside, along), middle));
    addMovingPart(scene, partOf(kEdge, "edge " + std::to_string(i)), edge, poses.back(), MaterialId{kEdge});
    const std::uint32_t from = (i & 1 ? 1u << (axis + 1) % 3 : 0u) | (i & 2 ? 1u << (axis + 2) % 3 : 0u);
    const auto cylinder_part = static_cast<std::uint32_t>(scene.parts.size() - 1);
    for (const std::uint32_t corner : {from, from | 1u << axis}) {
      scene.joints.push_back({corners + corner, cylinder_part, jointAlong(corner == from ? along : -along)});
    }
  }
  return poses;
}

// The camera circles the frame at a distance from which all of it is in view, while moving up and down. side:
// length of the frame's sides.
CameraPath cameraPath(double velocity, double side, std::uint32_t frames) {
  constexpr double kDistance = 2.7, kTurnsAFrame = 1.0 / 3000;
  CameraPath path;
  path.name = "round";
  path.fovy_deg = 45.0;
  path.width = path.height = 800;
  path.z_far = 10.0;
  const Vec3d middle(0.5, 0.5, 0.5);
  for (std::uint32_t f = 0; f < frames; ++f) {
    const double turns = f * velocity * kTurnsAFrame;
    const Point2 round = unitVector(0.085 + turns);
    const double height = 0.25 + 0.1 * unitVector(2.0 * turns).y;
    const Vec3d away = normalized(Vec3d(round.x, height, round.y));
    path.frames.push_back({middle + away * (kDistance * side), -away, {0.0, 1.0, 0.0}});
  }
  return path;
}

}  // namespace
}  // namespace scenes

MovingScene makeToothpicks(const ToothpickOptions& options) {
  using namespace scenes;
  MovingScene scene;
  scene.classes = {"toothpick", "corner", "edge"};
  scene.scene.materials = {{.name = "wood", .base_color = {0.8f, 0.62f, 0.36f, 1.0f}},
                           {.name = "corner", .base_color = {0.25f, 0.35f, 0.6f, 1.0f}},
                           {.name = "edge", .base_color = {0.5f, 0.55f, 0.6f, 1.0f}}};
  const double scale = scaleOf(options);
  const Scene toothpick = ellipsoid(kHalfLength * scale, kHalfWidth * scale, kBands, kSegments);
  const Scene sphere = ellipsoid(kSphereRadius, kSphereRadius, 10, 20);
  const double margin = kHalfLength * scale;
  const Scene edge = cylinder(0.5 + margin - rimHeight(), kCylinderRadius);
  for (const Scene* mesh : {&toothpick, &sphere, &edge}) {
    scene.hulls.push_back(hullOf(*mesh, kHullGrowth));
  }

  const auto motion = std::make_shared<const Motion>(makeMotion(options));
  for (std::uint32_t i = 0; i < options.count; ++i) {
    addMovingPart(scene, partOf(kToothpick, "toothpick " + std::to_string(i)), toothpick,
                  motion->worldFromPart(i, 0.0), MaterialId{kToothpick});
  }
  const std::vector<Mat4> frame_poses = addFrame(scene, margin, sphere, edge);
  scene.pose = [motion, frame_poses](std::uint32_t frame, std::span<Mat4> world_from_part) {
    const std::size_t count = motion->toothpicks.size();
    for (std::size_t i = 0; i < count; ++i) {
      world_from_part[i] = motion->worldFromPart(i, frame);
    }
    std::copy(frame_poses.begin(), frame_poses.end(),
              world_from_part.begin() + static_cast<std::ptrdiff_t>(count));
  };
  weldPositions(scene.scene);
  scene.scene.paths = {cameraPath(options.velocity, 1.0 + 2.0 * margin, scene.frames)};
  return scene;
}

}  // namespace sightline
