#pragma once

// Scenes whose narrow cracks count as closed. Modelled maps have corners that lie beside an edge by a
// rounding or by a millimetre. Each is a crack that can be seen through, so it keeps what lies behind it.

#include <cstdint>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/parallel_for.h"
#include "sightline/scene/scene.h"

namespace sightline {

// A scene whose occluders have no cracks narrower than a width. Find occluders, surfaces and boxes in view(),
// take objects' bounds from it too, and draw the scene that was given.
struct ClosedScene {
  // Into the positions of the scene that was given. Triangles that have collapsed are among them, with equal
  // corners: they hide nothing, and boxes are to hold them.
  std::vector<std::uint32_t> indices{};
  std::vector<Object> objects{};  // by the same ObjectId; their bounds are wider by margin()
  // No point of the given triangles is farther than this from where it is now, metres; at most twice the
  // width, but for rounding.
  double slack = 0.0;
  std::uint64_t merged = 0;  // vertices in whose place another one is used
  std::uint64_t bent = 0;    // places at which an edge is led through a vertex

  // given: the scene that was given. Lives no longer than it and this.
  SceneView view(const SceneView& given) const {
    return {given.positions, indices, objects, given.materials};
  }
  // How much wider all boxes must be than the triangles here, metres (ObjectBoxesSettings::margin): once the
  // slack to hold the given triangles, and once more to be as far as that from what hides them.
  double margin() const { return 2.0 * slack; }
};

// Closes the cracks between opaque triangles of a scene that are narrower than `width` metres: of vertices at
// edges where triangles do not cancel, those that nearly meet become one of them, and such edges are led
// through such vertices beside them. No vertex moves, and what is connected stays so. Objects must not move
// apart.
//
// A culler with such a scene hides nothing that is visible among its triangles. Of the given triangles it may
// hide what is seen only along lines of sight that pass within `slack` of an edge of one of them, begin
// within `slack` of one, or end within `slack` of one of another object (docs/conservative.md, "Contacts").
// With a width below 2^-149, by which numbers of single precision differ at least, or one that is not finite,
// nothing changes. The result does not depend on the threads.
ClosedScene closeCracks(const SceneView& scene, double width, const ParallelFor& parallel_for = serialFor);

// A vertex that nearly meets an edge, where the triangles at neither of them cancel.
struct Crack {
  Vec3f at{};                  // the vertex, scene space
  double width = 0.0;          // its distance from the edge, metres
  ObjectId object{}, other{};  // that have the vertex, and the edge
};

// The cracks up to a width, in metres, one for each such vertex: to the nearest edge that is neither its own
// nor next to one of its own. Vertices that lie on such an edge exactly are none. In order of the vertices'
// places.
std::vector<Crack> findCracks(const SceneView& scene, double width,
                              const ParallelFor& parallel_for = serialFor);

}  // namespace sightline
