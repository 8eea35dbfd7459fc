#include "scenes/mesh_builder.h"

#include <algorithm>
#include <utility>

namespace sightline::scenes {
namespace {

bool insideTriangle(Point2 p, Point2 a, Point2 b, Point2 c) {
  return cross(b - a, p - a) >= 0.0 && cross(c - b, p - b) >= 0.0 && cross(a - c, p - c) >= 0.0;
}

bool isEar(std::span<const Point2> outline, std::span<const std::uint32_t> left, std::size_t at) {
  const std::size_t n = left.size();
  const std::uint32_t ia = left[(at + n - 1) % n], ib = left[at], ic = left[(at + 1) % n];
  const Point2 a = outline[ia], b = outline[ib], c = outline[ic];
  if (cross(b - a, c - b) <= 0.0) {
    return false;
  }
  return std::none_of(left.begin(), left.end(), [&](std::uint32_t i) {
    return i != ia && i != ib && i != ic && insideTriangle(outline[i], a, b, c);
  });
}

// The sorted coordinates at which a plate is cut.
std::vector<double> cuts(double low, double high, std::span<const Rectangle> openings, double Point2::*axis) {
  std::vector<double> at{low, high};
  for (const Rectangle& opening : openings) {
    at.push_back(std::clamp(opening.min.*axis, low, high));
    at.push_back(std::clamp(opening.max.*axis, low, high));
  }
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  return at;
}

// Tells which cells of a plate's grid are solid. Cells outside the grid are not.
struct PlateGrid {
  std::vector<double> xs, ys;
  std::vector<bool> solid;

  std::size_t columns() const { return xs.size() - 1; }
  std::size_t rows() const { return ys.size() - 1; }
  bool at(std::size_t column, std::size_t row) const {
    return column < columns() && row < rows() && solid[row * columns() + column];
  }
};

PlateGrid gridOf(const Rectangle& area, std::span<const Rectangle> openings) {
  PlateGrid grid;
  grid.xs = cuts(area.min.x, area.max.x, openings, &Point2::x);
  grid.ys = cuts(area.min.y, area.max.y, openings, &Point2::y);
  grid.solid.resize(grid.columns() * grid.rows());
  for (std::size_t row = 0; row < grid.rows(); ++row) {
    for (std::size_t column = 0; column < grid.columns(); ++column) {
      const Point2 middle{(grid.xs[column] + grid.xs[column + 1]) * 0.5,
                          (grid.ys[row] + grid.ys[row + 1]) * 0.5};
      grid.solid[row * grid.columns() + column] = std::none_of(
          openings.begin(), openings.end(), [&](const Rectangle& hole) { return hole.contains(middle); });
    }
  }
  return grid;
}

}  // namespace

std::vector<Point2> corners(const Rectangle& r) {
  return {r.min, {r.max.x, r.min.y}, r.max, {r.min.x, r.max.y}};
}

std::vector<Point2> outset(std::span<const Point2> outline, double distance) {
  const std::size_t n = outline.size();
  std::vector<Point2> moved(n);
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 before = outline[i] - outline[(i + n - 1) % n], after = outline[(i + 1) % n] - outline[i];
    const Point2 d0 = before / length(before), d1 = after / length(after);
    // The corner moves along the sum of both edges' outward normals.
    const Point2 n0{d0.y, -d0.x}, n1{d1.y, -d1.x};
    moved[i] = outline[i] + (n0 + n1) * (distance / (1.0 + dot(n0, n1)));
  }
  return moved;
}

std::vector<std::uint32_t> triangulate(std::span<const Point2> outline) {
  std::vector<std::uint32_t> left(outline.size()), triangles;
  for (std::uint32_t i = 0; i < left.size(); ++i) {
    left[i] = i;
  }
  while (left.size() > 2) {
    std::size_t ear = 0;
    while (ear + 1 < left.size() && !isEar(outline, left, ear)) {
      ++ear;
    }
    const std::size_t n = left.size();
    triangles.insert(triangles.end(), {left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  return triangles;
}

void MeshBuilder::startObject(std::string name, MaterialId material) {
  finishObject();
  Object object;
  object.first_index = static_cast<std::uint32_t>(scene_.indices.size());
  object.material = material;
  scene_.objects.push_back(object);
  scene_.object_names.push_back(std::move(name));
}

void MeshBuilder::finishObject() {
  if (scene_.objects.empty()) {
    return;
  }
  Object& object = scene_.objects.back();
  object.index_count = static_cast<std::uint32_t>(scene_.indices.size()) - object.first_index;
  if (object.index_count == 0) {
    scene_.objects.pop_back();
    scene_.object_names.pop_back();
  }
}

std::uint32_t MeshBuilder::vertex(const Vec3d& p) {
  scene_.positions.emplace_back(worldFromPlan(placement_.point(p)));
  return static_cast<std::uint32_t>(scene_.positions.size() - 1);
}

void MeshBuilder::face(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  scene_.indices.insert(scene_.indices.end(), {a, b, c});
}

void MeshBuilder::triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const std::uint32_t first = vertex(a);
  vertex(b);
  vertex(c);
  face(first, first + 1, first + 2);
}

void MeshBuilder::quad(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  const std::uint32_t first = vertex(a);
  vertex(b);
  vertex(c);
  vertex(d);
  face(first, first + 1, first + 2);
  face(first, first + 2, first + 3);
}

void MeshBuilder::box(const Vec3d& l, const Vec3d& h, std::uint32_t faces) {
  const std::uint32_t first = vertex(l);  // corner k: bit 0 east, bit 1 north, bit 2 top
  for (std::uint32_t k = 1; k < 8; ++k) {
    vertex({k & 1 ? h.x : l.x, k & 2 ? h.y : l.y, k & 4 ? h.z : l.z});
  }
  struct Side {
    std::uint32_t face, corner[4];
  };
  static constexpr Side kSideCorners[] = {{kWest, {0, 4, 6, 2}},   {kEast, {1, 3, 7, 5}},
                                          {kSouth, {0, 1, 5, 4}},  {kNorth, {2, 6, 7, 3}},
                                          {kBottom, {0, 2, 3, 1}}, {kTop, {4, 5, 7, 6}}};
  for (const Side& side : kSideCorners) {
    if (faces & side.face) {
      face(first + side.corner[0], first + side.corner[1], first + side.corner[2]);
      face(first + side.corner[0], first + side.corner[2], first + side.corner[3]);
    }
  }
}

void MeshBuilder::prism(std::span<const Point2> outline, double z0, double z1, std::uint32_t faces) {
  const auto n = static_cast<std::uint32_t>(outline.size());
  const auto low = static_cast<std::uint32_t>(scene_.positions.size()), high = low + n;
  for (const double z : {z0, z1}) {
    for (const Point2 p : outline) {
      vertex({p.x, p.y, z});
    }
  }
  for (std::uint32_t i = 0; (faces & kSides) && i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    face(low + i, low + j, high + j);
    face(low + i, high + j, high + i);
  }
  const std::vector<std::uint32_t> cap = triangulate(outline);
  for (std::size_t t = 0; t < cap.size(); t += 3) {
    if (faces & kBottom) {
      face(low + cap[t], low + cap[t + 2], low + cap[t + 1]);
    }
    if (faces & kTop) {
      face(high + cap[t], high + cap[t + 1], high + cap[t + 2]);
    }
  }
}

void MeshBuilder::ring(std::span<const Point2> outer, std::span<const Point2> inner, double z0, double z1,
                       std::uint32_t faces) {
  const std::size_t n = outer.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Point2 a = outer[i], b = outer[(i + 1) % n], c = inner[(i + 1) % n], d = inner[i];
    const auto at = [](Point2 p, double z) { return Vec3d(p.x, p.y, z); };
    if (faces & kSides) {
      quad(at(a, z0), at(b, z0), at(b, z1), at(a, z1));
      quad(at(c, z0), at(d, z0), at(d, z1), at(c, z1));
    }
    if (faces & kTop) {
      quad(at(a, z1), at(b, z1), at(c, z1), at(d, z1));
    }
    if (faces & kBottom) {
      quad(at(d, z0), at(c, z0), at(b, z0), at(a, z0));
    }
  }
}

void MeshBuilder::lathe(std::span<const Point2> profile, std::uint32_t segments) {
  const auto first = static_cast<std::uint32_t>(scene_.positions.size());
  for (const Point2 p : profile) {
    for (std::uint32_t s = 0; s < segments; ++s) {
      const Point2 d = unitVector(static_cast<double>(s) / segments) * p.x;
      vertex({d.x, d.y, p.y});
    }
  }
  for (std::uint32_t i = 0; i + 1 < profile.size(); ++i) {
    const std::uint32_t low = first + i * segments, high = low + segments;
    for (std::uint32_t s = 0; s < segments; ++s) {
      const std::uint32_t t = (s + 1) % segments;
      if (profile[i].x > 0.0) {
        face(low + s, low + t, high + t);
      }
      if (profile[i + 1].x > 0.0) {
        face(low + s, high + t, high + s);
      }
    }
  }
}

void MeshBuilder::mesh(std::span<const Vec3d> points, std::span<const std::uint32_t> indices) {
  const auto first = static_cast<std::uint32_t>(scene_.positions.size());
  for (const Vec3d& point : points) {
    vertex(point);
  }
  for (std::size_t i = 0; i < indices.size(); i += 3) {
    face(first + indices[i], first + indices[i + 1], first + indices[i + 2]);
  }
}

void MeshBuilder::tube(std::span<const Vec3d> points, std::uint32_t corners) {
  const auto first = static_cast<std::uint32_t>(scene_.positions.size());
  const auto rings = static_cast<std::uint32_t>(points.size()) / corners;
  const auto centre = [&](std::uint32_t ring) {
    Vec3d sum;
    for (std::uint32_t c = 0; c < corners; ++c) {
      sum += points[ring * corners + c];
    }
    return sum / static_cast<double>(corners);
  };
  for (const Vec3d& point : points) {
    vertex(point);
  }
  const std::uint32_t bottom = vertex(centre(0)), top = vertex(centre(rings - 1));
  for (std::uint32_t c = 0; c < corners; ++c) {
    const std::uint32_t d = (c + 1) % corners, last = first + (rings - 1) * corners;
    face(bottom, first + d, first + c);
    for (std::uint32_t low = first; low < last; low += corners) {
      face(low + c, low + d, low + corners + d);
      face(low + c, low + corners + d, low + corners + c);
    }
    face(top, last + c, last + d);
  }
}

void MeshBuilder::plate(const Rectangle& area, double z0, double z1, std::span<const Rectangle> openings,
                        std::uint32_t faces) {
  const PlateGrid grid = gridOf(area, openings);
  for (std::size_t row = 0; row < grid.rows(); ++row) {
    for (std::size_t column = 0; column < grid.columns(); ++column) {
      if (!grid.at(column, row)) {
        continue;
      }
      // Indices below zero wrap around to a huge index, which is outside too.
      std::uint32_t cell = faces & (kBottom | kTop);
      cell |= grid.at(column - 1, row) ? 0u : faces & kWest;
      cell |= grid.at(column + 1, row) ? 0u : faces & kEast;
      cell |= grid.at(column, row - 1) ? 0u : faces & kSouth;
      cell |= grid.at(column, row + 1) ? 0u : faces & kNorth;
      box({grid.xs[column], grid.ys[row], z0}, {grid.xs[column + 1], grid.ys[row + 1], z1}, cell);
    }
  }
}

void MeshBuilder::ridgeRoof(const Rectangle& area, double z0, double rise, double ridge_inset) {
  const Point2 size = area.max - area.min;
  if (size.x < size.y) {
    // Turned by a quarter turn, so that the longer side is along x.
    const Placement before = placement_;
    placement_ = {before.point({area.max.x, area.min.y, 0}), before.y, before.x * -1.0, before.z};
    ridgeRoof({{0.0, 0.0}, {size.y, size.x}}, z0, rise, ridge_inset);
    placement_ = before;
    return;
  }
  const double middle = (area.min.y + area.max.y) * 0.5;
  const Vec3d a(area.min.x, area.min.y, z0), b(area.max.x, area.min.y, z0), c(area.max.x, area.max.y, z0),
      d(area.min.x, area.max.y, z0);
  const Vec3d west(area.min.x + ridge_inset, middle, z0 + rise),
      east(area.max.x - ridge_inset, middle, z0 + rise);
  quad(a, b, east, west);
  quad(c, d, west, east);
  triangle(b, c, east);
  triangle(d, a, west);
  quad(d, c, b, a);
}

}  // namespace sightline::scenes
