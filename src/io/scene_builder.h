#pragma once

// Collects world-space triangles in double precision and turns them into a Scene: the last step of every
// importer.

#include <cstdint>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"

namespace sightline::io {

// What one file may grow to, so that a small hostile file cannot ask for all memory.
struct ImportLimits {
  std::uint64_t triangles = 100'000'000;  // of the scene, all instances counted
  std::uint64_t vertices = 200'000'000;   // likewise, of a glTF file
  std::uint64_t objects = 16'000'000;     // of the scene
  std::uint64_t name_bytes = 1 << 30;     // of all objects' names
  std::uint64_t elements = 1 << 21;       // nodes, meshes, accessors, ... each
  // Accessors without bytes behind them (zeros by definition): elements of each, and vertices in them, all
  // instances counted.
  std::uint64_t implied_elements = 1 << 22;
  std::uint64_t implied_vertices = 1 << 22;
  std::uint64_t sparse_elements = 1 << 26;  // replaced ones, of all accessors together
  std::uint64_t camera_work = 1'000'000;  // of all animated cameras: frames times nodes above them, plus keys
};

// Largest magnitude of a world coordinate: extents and sums of two stay finite in single precision.
inline constexpr double kLargestCoordinate = 0x1p125;

class SceneBuilder {
 public:
  explicit SceneBuilder(const ImportLimits& limits) : limits_(limits) {}

  MaterialId addMaterial(Material material);
  const Material& material(MaterialId id) const { return scene_.materials[id.value]; }

  // Whether this many more triangles stay within the limits. Ask before adding.
  bool fits(std::uint64_t triangles) const {
    return triangles <= limits_.triangles && triangleCount() <= limits_.triangles - triangles;
  }

  void beginObject(std::string name, MaterialId material, OccluderMark mark);
  // Returns the vertex's number for addTriangle. Precondition: inRange(position).
  std::uint32_t addVertex(const Vec3d& position_world);
  // certain: false for a triangle that may cover what the file does not show. Those of an object become
  // another one after it, NAME/uncertain, which hides nothing.
  void addTriangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, bool certain = true);

  static bool inRange(const Vec3d& position_world) {
    return maxComponent(abs(position_world)) <= kLargestCoordinate && isFinite(position_world);
  }

  void addNote(std::string note) { scene_.notes.push_back(std::move(note)); }

  // Path with far == 0: "as far as the scene reaches".
  void addPath(CameraPath path) { scene_.paths.push_back(std::move(path)); }

  // Recentres, rounds to single precision, welds. The builder is empty afterwards.
  Scene finish();

 private:
  std::uint64_t triangleCount() const { return (scene_.indices.size() + uncertain_.size()) / 3; }
  void addUncertain();

  ImportLimits limits_;
  Scene scene_;
  std::vector<Vec3d> positions_world_;
  std::vector<std::uint32_t> uncertain_;  // corners of triangles of the last object
};

}  // namespace sightline::io
