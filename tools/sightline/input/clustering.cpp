#include "tools/sightline/input/clustering.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <utility>

#include "src/io/point_json.h"
#include "tools/sightline/command_line/note.h"

namespace sightline::tool {

void addClustersOption(CLI::App& command, std::uint32_t& max_triangles) {
  command
      .add_option("--clusters", max_triangles,
                  "objects of more triangles than this are answered by clusters of at most so many; 0: all "
                  "objects stay whole")
      ->check(CLI::Range(0u, 1u << 30))
      ->capture_default_str();
}

Clustering divideIntoClusters(Scene& scene, std::uint32_t max_triangles, double margin) {
  Clustering clustering;
  if (max_triangles == 0) {
    return clustering;
  }
  clustering = {max_triangles, scene.objects.size(),
                findObjectClusters(scene.view(), {.max_triangles = max_triangles, .margin = margin})};
  ObjectClusters& found = clustering.clusters;
  std::vector<std::string> names;
  for (std::size_t c = 0; c < found.clusters.size(); ++c) {
    const std::uint32_t object = found.object_of[c].value;
    const std::uint32_t first = found.first[object];
    names.push_back(found.first[object + 1] - first == 1
                        ? scene.object_names[object]
                        : fmt::format("{}, cluster {}", scene.object_names[object], c - first));
  }
  printNote("{} objects are answered by {} clusters", clustering.objects, found.clusters.size());
  scene.object_names = std::move(names);
  scene.indices = std::exchange(found.indices, {});
  scene.objects = std::exchange(found.clusters, {});
  return clustering;
}

Json clustersJson(const Clustering& clustering, const Scene& scene) {
  Json clusters = Json::array();
  const auto point = [&](const Vec3f& p) { return io::pointJson(Vec3d(p) + scene.origin); };
  for (std::size_t c = 0; c < scene.objects.size(); ++c) {
    const Object& cluster = scene.objects[c];
    clusters.push_back({{"object", clustering.clusters.object_of[c].value},
                        {"triangles", cluster.triangleCount()},
                        {"min", point(cluster.bounds.min)},
                        {"max", point(cluster.bounds.max)}});
  }
  return clusters;
}

std::vector<std::uint32_t> objectsWith(const Clustering& clustering, std::span<const ObjectId> visible) {
  std::vector<ObjectId> objects;
  clustering.clusters.objectsOf(visible, objects);
  std::vector<std::uint32_t> numbers;
  for (const ObjectId object : objects) {
    numbers.push_back(object.value);
  }
  return numbers;
}

std::string clustersText(const Clustering& clustering) {
  return clustering.on() ? fmt::format(" --clusters {}", clustering.max_triangles) : "";
}

}  // namespace sightline::tool
