#include "src/world/read_mesh.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>
#include <utility>

#include "src/scene/weld.h"

namespace sightline::world {
namespace {

Vec3f positionOf(const MeshView& mesh, std::uint32_t vertex) {
  float at[3];
  std::memcpy(at, static_cast<const std::byte*>(mesh.positions) + vertex * mesh.position_stride, sizeof(at));
  return {at[0], at[1], at[2]};
}

std::uint32_t indexAt(const MeshView& mesh, std::size_t i) {
  if (mesh.indices == nullptr) {
    return static_cast<std::uint32_t>(i);
  }
  const std::byte* const at = static_cast<const std::byte*>(mesh.indices) + i * mesh.index_bytes;
  if (mesh.index_bytes == 2) {
    std::uint16_t index;
    std::memcpy(&index, at, sizeof(index));
    return index;
  }
  std::uint32_t index;
  std::memcpy(&index, at, sizeof(index));
  return index;
}

std::string faultOf(const MeshView& mesh, std::size_t corners) {
  if (mesh.vertex_count > 0 && mesh.positions == nullptr) {
    return "the mesh has vertices and no positions; set MeshView::positions";
  }
  if (mesh.position_stride < 3 * sizeof(float)) {
    return "position_stride is " + std::to_string(mesh.position_stride) + "; it must be at least 12 bytes";
  }
  if (mesh.indices != nullptr && mesh.index_bytes != 2 && mesh.index_bytes != 4) {
    return "index_bytes is " + std::to_string(mesh.index_bytes) + "; it must be 2 or 4";
  }
  if (mesh.indices == nullptr && mesh.index_count > 0) {
    return "the mesh has an index_count and no indices; set MeshView::indices";
  }
  if (corners % 3 != 0 || corners / 3 > 0xffffffffu / 3) {
    return "the mesh has " + std::to_string(corners) +
           (mesh.indices != nullptr ? " indices" : " vertices without indices") +
           "; it must be three a triangle, fewer than 2^32";
  }
  return {};
}

// Reads those vertices that triangles name, in the order of the buffer, and numbers them anew.
void readNamed(const MeshView& mesh, ReadMesh& read) {
  std::vector<std::uint32_t> named = read.indices;
  std::sort(named.begin(), named.end());
  named.erase(std::unique(named.begin(), named.end()), named.end());
  read.positions.reserve(named.size());
  for (const std::uint32_t vertex : named) {
    read.positions.push_back(positionOf(mesh, vertex));
  }
  for (std::uint32_t& vertex : read.indices) {
    const auto found = std::lower_bound(named.begin(), named.end(), vertex);
    vertex = static_cast<std::uint32_t>(found - named.begin());
  }
}

}  // namespace

Result<ReadMesh> readMesh(const MeshView& mesh) {
  const std::size_t corners = mesh.indices != nullptr ? mesh.index_count : mesh.vertex_count;
  if (std::string fault = faultOf(mesh, corners); !fault.empty()) {
    return Error{std::move(fault)};
  }
  ReadMesh read;
  // What is clockwise in a picture of a left-handed space is not in one of the same coordinates in a
  // right-handed space, which is its mirror image.
  const bool turned = mesh.clockwise != mesh.left_handed;
  read.indices.resize(corners);
  for (std::size_t i = 0; i < corners; ++i) {
    // The second and third corners of a triangle change places if it is turned.
    const std::size_t from = !turned || i % 3 == 0 ? i : i % 3 == 1 ? i + 1 : i - 1;
    read.indices[i] = indexAt(mesh, from);
    if (read.indices[i] >= mesh.vertex_count) {
      return Error{"index " + std::to_string(from) + " is " + std::to_string(read.indices[i]) +
                   ", but the mesh has " + std::to_string(mesh.vertex_count) + " vertices"};
    }
  }
  if (mesh.vertex_count <= corners) {
    read.positions.resize(mesh.vertex_count);
    for (const std::uint32_t vertex : read.indices) {
      read.positions[vertex] = positionOf(mesh, vertex);
    }
  } else {
    readNamed(mesh, read);
  }
  for (const std::uint32_t vertex : read.indices) {
    read.finite = read.finite && isFinite(read.positions[vertex]);
  }
  return read;
}

WeldedMesh weldMesh(const ReadMesh& mesh) {
  WeldedMesh welded;
  scene::PositionNumbers numbers(mesh.positions.size());
  std::vector<bool> used(mesh.positions.size(), false);
  std::vector<std::pair<std::uint64_t, int>> edges;  // lower end, upper end; 1 or -1: the way it is run along
  const auto edge = [&](std::uint32_t from, std::uint32_t to) {
    edges.emplace_back(std::uint64_t{std::min(from, to)} << 32 | std::max(from, to), from < to ? 1 : -1);
  };
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    std::uint32_t corner[3];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint32_t vertex = mesh.indices[i + c];
      welded.vertices += used[vertex] ? 0 : 1;
      used[vertex] = true;
      corner[c] = numbers.numberOf(mesh.positions[vertex]);
    }
    if (corner[0] != corner[1] && corner[1] != corner[2] && corner[2] != corner[0]) {
      welded.indices.insert(welded.indices.end(), corner, corner + 3);
      edge(corner[0], corner[1]);
      edge(corner[1], corner[2]);
      edge(corner[2], corner[0]);
    }
  }
  const LargeVector<Vec3f> positions = std::move(numbers).take();
  welded.positions.assign(positions.begin(), positions.end());
  std::sort(edges.begin(), edges.end());
  for (std::size_t i = 0; i < edges.size();) {
    int sum = 0;
    const std::uint64_t key = edges[i].first;
    for (; i < edges.size() && edges[i].first == key; ++i) {
      sum += edges[i].second;
    }
    welded.open_edges += sum != 0 ? 1 : 0;
  }
  return welded;
}

}  // namespace sightline::world
