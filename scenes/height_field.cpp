#include "scenes/height_field.h"

#include <algorithm>
#include <cmath>

namespace sightline::scenes {

HeightField::HeightField(const Rectangle& area, std::uint32_t quads_per_side,
                         const std::function<double(Point2)>& height)
    : area_(area), quads_(quads_per_side), heights_(std::size_t{quads_ + 1} * (quads_ + 1)) {
  for (std::uint32_t row = 0; row <= quads_; ++row) {
    for (std::uint32_t column = 0; column <= quads_; ++column) {
      heights_[index(column, row)] = height(place(column, row));
    }
  }
}

Point2 HeightField::place(std::uint32_t column, std::uint32_t row) const {
  const Point2 size = area_.max - area_.min;
  return {area_.min.x + size.x * column / quads_, area_.min.y + size.y * row / quads_};
}

bool HeightField::cutsNorthEast(std::uint32_t column, std::uint32_t row) const {
  const double sw = heights_[index(column, row)], se = heights_[index(column + 1, row)];
  const double nw = heights_[index(column, row + 1)], ne = heights_[index(column + 1, row + 1)];
  return std::abs(sw - ne) <= std::abs(se - nw);
}

double HeightField::height(Point2 p) const {
  const Point2 size = area_.max - area_.min;
  const double x = std::clamp((p.x - area_.min.x) / size.x, 0.0, 1.0) * quads_;
  const double y = std::clamp((p.y - area_.min.y) / size.y, 0.0, 1.0) * quads_;
  const std::uint32_t column = std::min(static_cast<std::uint32_t>(x), quads_ - 1);
  const std::uint32_t row = std::min(static_cast<std::uint32_t>(y), quads_ - 1);
  const double u = x - column, v = y - row;
  const double sw = heights_[index(column, row)], se = heights_[index(column + 1, row)];
  const double nw = heights_[index(column, row + 1)], ne = heights_[index(column + 1, row + 1)];
  if (cutsNorthEast(column, row)) {
    return u >= v ? sw + (se - sw) * u + (ne - se) * v : sw + (ne - nw) * u + (nw - sw) * v;
  }
  return u + v <= 1.0 ? sw + (se - sw) * u + (nw - sw) * v
                      : ne + (nw - ne) * (1.0 - u) + (se - ne) * (1.0 - v);
}

double HeightField::lowest(Point2 p, double radius) const {
  double low = height(p);
  for (int i = 0; i < 8; ++i) {
    low = std::min(low, height(p + unitVector(i / 8.0) * radius));
  }
  return low;
}

double HeightField::highest(Point2 p, double radius) const {
  double high = height(p);
  for (int i = 0; i < 8; ++i) {
    high = std::max(high, height(p + unitVector(i / 8.0) * radius));
  }
  return high;
}

double HeightField::slope(Point2 p, double distance) const {
  const double x = height(p + Point2{distance, 0.0}) - height(p - Point2{distance, 0.0});
  const double y = height(p + Point2{0.0, distance}) - height(p - Point2{0.0, distance});
  return length(Point2{x, y}) / (2.0 * distance);
}

void HeightField::addTile(MeshBuilder& mesh, std::uint32_t column0, std::uint32_t row0, std::uint32_t column1,
                          std::uint32_t row1) const {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> indices;
  for (std::uint32_t row = row0; row <= row1; ++row) {
    for (std::uint32_t column = column0; column <= column1; ++column) {
      const Point2 p = place(column, row);
      points.emplace_back(p.x, p.y, heights_[index(column, row)]);
    }
  }
  const std::uint32_t width = column1 - column0 + 1;
  for (std::uint32_t row = row0; row < row1; ++row) {
    for (std::uint32_t column = column0; column < column1; ++column) {
      const std::uint32_t sw = (row - row0) * width + column - column0, se = sw + 1, nw = sw + width,
                          ne = nw + 1;
      if (cutsNorthEast(column, row)) {
        indices.insert(indices.end(), {sw, se, ne, sw, ne, nw});
      } else {
        indices.insert(indices.end(), {sw, se, nw, se, ne, nw});
      }
    }
  }
  mesh.mesh(points, indices);
}

void HeightField::addTiles(MeshBuilder& mesh, std::uint32_t tiles_per_side, const std::string& name,
                           const std::function<MaterialId(Point2)>& material) const {
  mesh.place({});
  const auto start = [&](std::uint32_t tile) { return quads_ * tile / tiles_per_side; };
  for (std::uint32_t y = 0; y < tiles_per_side; ++y) {
    for (std::uint32_t x = 0; x < tiles_per_side; ++x) {
      const Point2 middle = (place(start(x), start(y)) + place(start(x + 1), start(y + 1))) * 0.5;
      mesh.startObject(name + " " + std::to_string(x) + " " + std::to_string(y), material(middle));
      addTile(mesh, start(x), start(y), start(x + 1), start(y + 1));
    }
  }
}

std::vector<Vec3d> overGround(const HeightField& ground, std::span<const Vec3d> line, double eye_height) {
  constexpr double kStep = 0.5;
  std::vector<Vec3d> over;
  const auto add = [&](Point2 p) { over.emplace_back(p.x, p.y, ground.height(p) + eye_height); };
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Point2 a{line[i].x, line[i].y}, b{line[i + 1].x, line[i + 1].y};
    const auto pieces = static_cast<int>(length(b - a) / kStep) + 1;
    for (int k = 0; k < pieces; ++k) {
      add(a + (b - a) * (static_cast<double>(k) / pieces));
    }
  }
  add({line.back().x, line.back().y});
  return over;
}

}  // namespace sightline::scenes
