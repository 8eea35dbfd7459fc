#pragma once

// What a program knows about two parts and convex hulls do not show.

#include <cstdint>

#include "sightline/math/plane.h"
#include "sightline/math/vec3.h"
#include "sightline/scene/camera.h"

namespace sightline {

// For some eye, of two parts. Both: they must be drawn together.
struct PairOrder {
  bool first_may_occlude = true;   // the second
  bool second_may_occlude = true;  // the first

  friend bool operator==(const PairOrder&, const PairOrder&) = default;
};

// A plane with the first part in front of it and the second behind, in the first part's space: it moves with
// that part. Neither may reach through it, or both show the same where they do. The normal may have any
// length > 0.
struct PairPlane {
  Plane plane{};
};

// A cylinder whose end cap's rim lies on a sphere, as upper arm and shoulder; it reaches to where the sphere
// ends, or farther. First part: the sphere; second: the cylinder. In the first part's space. The eye is in
// neither of them. Source: Snyder, Lengyel. MSR-TR-97-11, appendix C, with its l put right:
// (s^2 - h^2) / h + h = s^2 / h.
struct SphereCylinderJoint {
  Vec3d centre{};  // of the sphere
  double sphere_radius = 1.0;
  Vec3d axis{0, 1, 0};           // of the cylinder, away from the sphere; any length > 0
  double cylinder_radius = 1.0;  // > 0, at most sphere_radius
};

// Anything else: called at most once a frame and pair, from update(), with the view in world space. Must not
// depend on anything that changes within a frame. An order that lets neither occlude is right only where no
// ray meets both.
struct PairCallback {
  PairOrder (*order)(void* user, const View& view) = nullptr;
  void* user = nullptr;
};

// Who may occlude whom for an eye, given what is known. Both where rounding leaves it open: within 1e-12 of a
// boundary, relative to the coordinates involved. Both also for an eye in the sphere of a joint, and for
// parameters or views that are not finite or make no sense. Of the view the eye counts, or, orthographic, the
// forward direction (any length > 0).
PairOrder orderOf(const PairPlane& known, const View& view_in_first);
PairOrder orderOf(const SphereCylinderJoint& joint, const View& view_in_first);

}  // namespace sightline
