#pragma once

// Objects that are answered by clusters of their triangles, as --clusters asks.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightline/scene/object_clusters.h"
#include "tools/sightline/command_line/json_output.h"

namespace CLI {
class App;
}

namespace sightline::tool {

// Nothing, if max_triangles is 0.
struct Clustering {
  std::uint32_t max_triangles = 0;
  std::size_t objects = 0;    // of the scene before
  ObjectClusters clusters{};  // without indices and clusters, which the scene has

  bool on() const { return max_triangles > 0; }
};

void addClustersOption(CLI::App& command, std::uint32_t& max_triangles);

// Makes the clusters the scene's objects: what is found, culled and exactly visible is so of them. margin:
// see ObjectClustersSettings. Says on stderr how many there are.
Clustering divideIntoClusters(Scene& scene, std::uint32_t max_triangles, double margin);

// For each cluster its object, triangles and box in world space.
Json clustersJson(const Clustering& clustering, const Scene& scene);
// The numbers of the objects that have one of these clusters, ascending.
std::vector<std::uint32_t> objectsWith(const Clustering& clustering, std::span<const ObjectId> visible);
// " --clusters 1024", after the scene's name; empty if there are none.
std::string clustersText(const Clustering& clustering);

}  // namespace sightline::tool
