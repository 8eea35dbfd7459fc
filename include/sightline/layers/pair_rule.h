#pragma once

// What a program may know about two parts that their convex hulls do not show.

#include <cstdint>

#include "sightline/math/plane.h"
#include "sightline/math/vec3.h"
#include "sightline/scene/camera.h"

namespace sightline {

// Which of two parts may occlude the other for some eye. If both may, they must be drawn together.
struct PairOrder {
  bool first_may_occlude = true;
  bool second_may_occlude = true;

  friend bool operator==(const PairOrder&, const PairOrder&) = default;
};

// A plane with the first part in front of it and the second behind, given in the first part's space and
// moving with it. A part may reach through the plane only where both parts show the same. The normal has any
// length > 0.
struct PairPlane {
  Plane plane{};
};

// A cylinder whose end cap's rim lies on a sphere, as an upper arm on a shoulder, and which reaches at least
// to where the sphere ends. The first part is the sphere, the second the cylinder; all is in the first part's
// space. The eye must be in neither. Source: Snyder, Lengyel. MSR-TR-97-11, appendix C, with its l corrected:
// (s^2 - h^2) / h + h = s^2 / h.
struct SphereCylinderJoint {
  Vec3d centre{};  // of the sphere
  double sphere_radius = 1.0;
  Vec3d axis{0, 1, 0};           // of the cylinder, pointing away from the sphere; any length > 0
  double cylinder_radius = 1.0;  // > 0, at most sphere_radius
};

// A function of the caller's. update() calls it at most once per frame and pair, with the view in world
// space. Its answer must not change within a frame. It may exclude both occlusions only where no ray hits
// both parts.
struct PairCallback {
  PairOrder (*order)(void* user, const View& view) = nullptr;
  void* user = nullptr;
};

// Returns which part may occlude the other under a rule. Of the view only the eye counts or, if it is
// orthographic, the forward direction (any length > 0). Conservative: both may occlude within 1e-12 of a
// boundary (relative to the coordinates), for an eye in the sphere of a joint, and for input that is invalid
// or not finite.
PairOrder orderOf(const PairPlane& known, const View& view_in_first);
PairOrder orderOf(const SphereCylinderJoint& joint, const View& view_in_first);

}  // namespace sightline
