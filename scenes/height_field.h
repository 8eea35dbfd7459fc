#pragma once

// Ground: heights on a grid, drawn as one connected sheet of triangles that is cut into tiles.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"

namespace sightline::scenes {

class HeightField {
 public:
  // A grid of quads_per_side squared quads over the rectangle; `height` is asked once for each of its points.
  HeightField(const Rectangle& area, std::uint32_t quads_per_side,
              const std::function<double(Point2)>& height);

  const Rectangle& area() const { return area_; }
  // Height of the sheet of triangles at a place; outside of the area, that of the nearest place inside.
  double height(Point2 p) const;
  Vec3d point(Point2 p) const { return {p.x, p.y, height(p)}; }
  // Minimum and maximum height on a circle around the place.
  double lowest(Point2 p, double radius) const;
  double highest(Point2 p, double radius) const;
  // Rise per metre, about the place, over the distance.
  double slope(Point2 p, double distance = 2.0) const;

  // One object for each of tiles_per_side squared tiles, with shared positions along their borders.
  // `material` is asked with each tile's middle.
  void addTiles(MeshBuilder& mesh, std::uint32_t tiles_per_side, const std::string& name,
                const std::function<MaterialId(Point2)>& material) const;

 private:
  std::size_t index(std::uint32_t column, std::uint32_t row) const {
    return std::size_t{row} * (quads_ + 1) + column;
  }
  Point2 place(std::uint32_t column, std::uint32_t row) const;
  // True if the quad is cut from its south-west to its north-east corner: the diagonal that bends less.
  bool cutsNorthEast(std::uint32_t column, std::uint32_t row) const;
  void addTile(MeshBuilder& mesh, std::uint32_t column0, std::uint32_t row0, std::uint32_t column1,
               std::uint32_t row1) const;

  Rectangle area_;
  std::uint32_t quads_;
  std::vector<double> heights_;
};

// The line at eye height above the ground, in steps of at most half a metre. Heights of the line itself are
// ignored.
std::vector<Vec3d> overGround(const HeightField& ground, std::span<const Vec3d> line, double eye_height);

}  // namespace sightline::scenes
