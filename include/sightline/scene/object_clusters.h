#pragma once

// Objects in clusters of their triangles. A terrain or a facade that is one object is visible nearly always;
// most of its triangles are not.

#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/ids.h"
#include "sightline/base/parallel_for.h"
#include "sightline/scene/scene.h"

namespace sightline {

// Made by findObjectClusters(). A cluster is an object like any other, with a box of its own: build the
// hierarchy of the clusters, find occluders, surfaces and boxes in view(), and a Culler answers by clusters.
// An object is visible where any of its clusters is.
struct ObjectClusters {
  // Those of the scene, in another order within each object: those of a cluster together, and in each
  // cluster in the order that they had.
  std::vector<std::uint32_t> indices{};
  std::vector<Object> clusters{};      // by object; material and mark are those of the object
  std::vector<std::uint32_t> first{};  // by ObjectId: its first cluster; and one more entry
  std::vector<ObjectId> object_of{};   // by cluster: the object that it is a part of

  // given: the scene. The view lives no longer than it and this.
  SceneView view(const SceneView& given) const {
    return {given.positions, indices, clusters, given.materials};
  }
  // Sets `objects` to those that have one of these clusters, ascending. visible: ascending, as
  // Culler::visible() is.
  void objectsOf(std::span<const ObjectId> visible, std::vector<ObjectId>& objects) const;
};

struct ObjectClustersSettings {
  std::uint32_t max_triangles = 1024;  // of a cluster; an object with no more is its own only cluster
  // Metres by which Object::bounds are wider than the triangles, and those of clusters then are as well: see
  // ClosedScene::margin().
  double margin = 0.0;
};

// Divides large objects in halves, by the middles of their triangles along the longest axis, until each part
// is small enough. Objects without triangles, with coordinates that are not finite, and with bounds that are
// not those of their triangles (and the margin) stay whole. The result does not depend on parallel_for.
ObjectClusters findObjectClusters(const SceneView& scene, const ObjectClustersSettings& settings = {},
                                  const ParallelFor& parallel_for = serialFor);

}  // namespace sightline
