// An aircraft of six parts. The numbers of polygons of the parts and of their hulls are about the paper's.
// Adjacent parts are a millimetre apart, so that rounding of their positions does not reach across the planes
// between them; their hulls are slightly larger and overlap.

#include <array>
#include <cmath>
#include <iterator>
#include <span>

#include "scenes/canyon_parts.h"
#include "scenes/moving_parts.h"

namespace sightline::scenes::canyon {
namespace {

constexpr double kUnderBody = -1.0005, kOverBody = 1.0005;  // heights of planes, metres
constexpr double kWingMiddle = -1.1472, kUnderWing = -1.2939;
constexpr double kBehindTail = -5.001;  // forward of the aircraft's origin
constexpr double kHingeRadius = 0.12, kHingeX = -5.122, kHingeHeight = 1.75;
constexpr double kBehindHinge = -0.121;  // in the rudder's space

// A lathe's profile with `between` additional rings between any two of its points. The rings are slightly
// closer to the axis than the straight line, so that the hull does not include them. The end bands are not
// divided if they are poles.
std::vector<Point2> grooved(std::span<const Point2> profile, std::uint32_t between) {
  std::vector<Point2> fine{profile.front()};
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const Point2 a = profile[i - 1], b = profile[i];
    for (std::uint32_t k = 1; k <= between && a.x > 0.0 && b.x > 0.0; ++k) {
      const Point2 p = a + (b - a) * (static_cast<double>(k) / (between + 1));
      fine.push_back({p.x * (k % 2 == 0 ? 0.97 : 0.96), p.y});
    }
    fine.push_back(b);
  }
  return fine;
}

// The placement of a lathe whose axis is along x, at this height.
Placement alongX(double height) {
  return {{0.0, 0.0, height}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
}

using Section = std::vector<Vec3d>;

// Adds the solid between consecutive sections with equal numbers of corners, each convex and
// counter-clockwise as seen from the far end.
void addLoft(MeshBuilder& mesh, std::span<const Section> sections) {
  const std::size_t corners = sections.front().size();
  for (std::size_t s = 1; s < sections.size(); ++s) {
    for (std::size_t k = 0; k < corners; ++k) {
      const std::size_t next = (k + 1) % corners;
      mesh.quad(sections[s - 1][k], sections[s - 1][next], sections[s][next], sections[s][k]);
    }
  }
  const Section &first = sections.front(), &last = sections.back();
  for (std::size_t k = 1; k + 1 < corners; ++k) {
    mesh.triangle(first[0], first[k + 1], first[k]);
    mesh.triangle(last[0], last[k], last[k + 1]);
  }
}

void buildBody(MeshBuilder& mesh) {
  constexpr Point2 kProfile[] = {{0.0, -6.0}, {0.35, -5.9}, {0.65, -5.2}, {0.88, -4.0}, {0.99, -2.0},
                                 {1.0, 1.5},  {0.8, 4.0},   {0.45, 5.4},  {0.15, 5.9},  {0.0, 6.0}};
  mesh.place(alongX(0.0));
  mesh.lathe(grooved(kProfile, 8), 12);
}

void buildEngine(MeshBuilder& mesh) {
  // The profile runs from the inside of the nozzle around its rim to the front.
  constexpr Point2 kInside[] = {{0.0, -3.8}, {0.3, -4.0}, {0.42, -4.6}};
  constexpr Point2 kOutside[] = {{0.55, -4.8}, {0.68, -4.0}, {0.7, -2.5},
                                 {0.62, -1.0}, {0.4, -0.6},  {0.0, -0.4}};
  std::vector<Point2> profile(std::begin(kInside), std::end(kInside));
  const std::vector<Point2> outside = grooved(kOutside, 5);
  profile.insert(profile.end(), outside.begin(), outside.end());
  mesh.place(alongX(kUnderWing - 0.0005 - 0.7));
  mesh.lathe(profile, 23);
}

void buildWing(MeshBuilder& mesh) {
  constexpr int kSections = 51;
  constexpr std::uint32_t kCorners = 14;
  std::vector<Section> sections;
  for (int s = 0; s < kSections; ++s) {
    const double y = 10.0 * s / (kSections - 1) - 5.0, out = std::abs(y) / 5.0;
    const bool in_hull = s == 0 || s == kSections / 2 || s + 1 == kSections;
    const double shrink = in_hull ? 1.0 : 0.97;
    const double half_chord = (1.2 - 0.7 * out) * shrink, half_height = (0.15 - 0.09 * out) * shrink;
    Section section;
    for (std::uint32_t k = 0; k < kCorners; ++k) {
      const Point2 d = unitVector(-static_cast<double>(k) / kCorners);
      section.emplace_back(-0.3 - 0.6 * out + half_chord * d.x, y, kWingMiddle + half_height * d.y);
    }
    sections.push_back(section);
  }
  addLoft(mesh, sections);
}

// A lens-shaped section along x, symmetric about y = 0, at a height.
Section lens(double rear, double front, double half_width, double height, std::uint32_t corners) {
  Section section;
  for (std::uint32_t k = 0; k < corners; ++k) {
    const Point2 d = unitVector(static_cast<double>(k) / corners);
    section.emplace_back((front + rear) * 0.5 + (front - rear) * 0.5 * d.x, half_width * d.y, height);
  }
  return section;
}

void buildTail(MeshBuilder& mesh) {
  const Section foot = lens(kBehindTail + 0.001, -2.4, 0.12, kOverBody + 0.0005, 6);
  const Section top = lens(kBehindTail + 0.001, -4.0, 0.06, 2.6, 6);
  for (std::size_t k = 0; k < 6; ++k) {
    const std::size_t next = (k + 1) % 6;
    mesh.quad(foot[k], foot[next], top[next], top[k]);
    mesh.triangle(top[k], top[next], {-4.5, 0.0, 2.65});
  }
  for (std::size_t k = 1; k + 1 < 6; ++k) {
    mesh.triangle(foot[0], foot[k + 1], foot[k]);
  }
}

void buildRudder(MeshBuilder& mesh) {
  const double front = kBehindHinge - 0.001;
  const Section sections[] = {lens(-1.0, front, 0.08, -0.6, 8), lens(-0.9, front - 0.05, 0.06, 0.0, 8),
                              lens(-0.8, front, 0.06, 0.6, 8)};
  addLoft(mesh, sections);
}

void buildHinge(MeshBuilder& mesh) {
  constexpr Point2 kProfile[] = {{0.0, -0.65}, {0.1, -0.6}, {kHingeRadius, 0.0},
                                 {0.08, 0.3},  {0.1, 0.6},  {0.0, 0.65}};
  mesh.lathe(kProfile, 8);
}

}  // namespace

std::array<const char*, kAircraftParts> partNames() {
  return {"body", "wing", "engine", "tail", "rudder", "hinge"};
}

Scene aircraftMesh(AircraftPart part) {
  constexpr std::array<void (*)(MeshBuilder&), kAircraftParts> kBuild{buildBody, buildWing,   buildEngine,
                                                                      buildTail, buildRudder, buildHinge};
  return buildPartMesh(kBuild[part]);
}

std::vector<MovingPlane> aircraftPlanes() {
  const auto above = [](double height) { return PairPlane{{{0, 1, 0}, -height}}; };
  const auto before = [](double x) { return PairPlane{{{1, 0, 0}, -x}}; };
  return {{kBody, kWing, above(kUnderBody)},     {kWing, kEngine, above(kUnderWing)},
          {kTail, kBody, above(kOverBody)},      {kTail, kHinge, before(kBehindTail)},
          {kTail, kRudder, before(kBehindTail)}, {kRudder, kHinge, {before(kBehindHinge).plane.flipped()}}};
}

Vec3d hingePoint() {
  return worldFromPlan({kHingeX, 0.0, kHingeHeight});
}

}  // namespace sightline::scenes::canyon
