// Buildings of the city: shells, roofs, arcades, and the details on their fronts. Details are added on top of
// a wall and never cut it, so that the shell's walls stay large.

#include <algorithm>
#include <cmath>

#include "scenes/city_parts.h"

namespace sightline::scenes {
namespace {

constexpr double kPaneWidth = 1.3, kPaneHeight = 1.5, kSillHeight = 0.85;
constexpr double kShortFront = 13.0;  // metres

struct Detail {
  MeshBuilder& mesh;
  const CityBuilding& building;
  const Mass& mass;
  double spacing;
  std::string name;
};

// The windows of one storey of a front, by their centres along it.
struct WindowRow {
  double bay = 0.0;
  std::uint32_t count = 0;
  double width = 0.0;
  double middle(std::uint32_t i) const { return (i + 0.5) * bay; }
};

WindowRow windowRow(const Front& front, double spacing) {
  const double along = length(front.b - front.a);
  WindowRow row;
  row.count = static_cast<std::uint32_t>(std::max(1.0, std::floor(along / spacing + 0.5)));
  row.bay = along / row.count;
  row.width = std::clamp(row.bay * 0.42, 0.7, kPaneWidth + (row.bay - 3.0) * 0.25);
  return row;
}

Rectangle paneOf(const WindowRow& row, std::uint32_t i, double inset) {
  const double half = row.width * 0.5 - inset;
  return {{row.middle(i) - half, kSillHeight + inset},
          {row.middle(i) + half, kSillHeight + kPaneHeight - inset}};
}

void addRibbonFrame(MeshBuilder& mesh, double along) {
  mesh.box({0.4, 0.75, 0.0}, {along - 0.4, 2.55, 0.08}, kNoBottom);
  mesh.box({0.3, 0.6, 0.0}, {along - 0.3, 0.75, 0.22}, kNoBottom);
}

void addWindowFrame(MeshBuilder& mesh, WindowStyle style, const WindowRow& row, std::uint32_t i) {
  const Rectangle pane = paneOf(row, i, 0.0);
  if (style == WindowStyle::kFramed) {
    mesh.ring(corners({pane.min - Point2{0.12, 0.12}, pane.max + Point2{0.12, 0.12}}), corners(pane), 0.0,
              0.11, kSides | kTop);
    return;
  }
  mesh.box({pane.min.x, pane.min.y, 0.0}, {pane.max.x, pane.max.y, 0.05}, kNoBottom);
  if (style == WindowStyle::kSill) {
    mesh.box({pane.min.x - 0.12, pane.min.y - 0.1, 0.0}, {pane.max.x + 0.12, pane.min.y, 0.16}, kNoBottom);
  }
}

// Adds frames and sills, as one object per storey; on short fronts as one for all storeys.
void addFrames(const Detail& detail, const Front& front, std::uint32_t storey) {
  const Mass& mass = detail.mass;
  const bool ribbon = detail.building.style == WindowStyle::kRibbon;
  detail.mesh.place(
      detail.building.placement.onWall(front.a, front.b, mass.base + storey * mass.storey_height));
  if (storey == 0 || length(front.b - front.a) > kShortFront) {
    detail.mesh.startObject(detail.name + " storey " + std::to_string(storey) + " frames",
                            id(ribbon ? CityMaterial::kDarkTrim : CityMaterial::kTrim));
  }
  if (ribbon) {
    addRibbonFrame(detail.mesh, length(front.b - front.a));
    return;
  }
  const WindowRow row = windowRow(front, detail.spacing);
  for (std::uint32_t i = 0; i < row.count; ++i) {
    addWindowFrame(detail.mesh, detail.building.style, row, i);
  }
}

// Adds panes, as one object for the whole front of the mass.
void addPanes(const Detail& detail, const Front& front) {
  const Mass& mass = detail.mass;
  const WindowStyle style = detail.building.style;
  detail.mesh.startObject(detail.name + " panes",
                          id(detail.building.clear_glass ? CityMaterial::kGlass : CityMaterial::kWindow));
  const double depth = style == WindowStyle::kFramed ? 0.03 : style == WindowStyle::kRibbon ? 0.1 : 0.07;
  const WindowRow row = windowRow(front, detail.spacing);
  for (std::uint32_t storey = 0; storey < mass.storeys; ++storey) {
    detail.mesh.place(
        detail.building.placement.onWall(front.a, front.b, mass.base + storey * mass.storey_height));
    const std::uint32_t count = style == WindowStyle::kRibbon ? 1 : row.count;
    for (std::uint32_t i = 0; i < count; ++i) {
      const Rectangle pane = style == WindowStyle::kRibbon
                                 ? Rectangle{{0.5, 0.85}, {length(front.b - front.a) - 0.5, 2.45}}
                                 : paneOf(row, i, style == WindowStyle::kFramed ? 0.0 : 0.07);
      detail.mesh.quad({pane.min.x, pane.min.y, depth}, {pane.max.x, pane.min.y, depth},
                       {pane.max.x, pane.max.y, depth}, {pane.min.x, pane.max.y, depth});
    }
  }
}

void addBalcony(const Detail& detail, const Front& front, std::uint32_t storey, double along) {
  const Mass& mass = detail.mass;
  detail.mesh.place(
      detail.building.placement.onWall(front.a, front.b, mass.base + storey * mass.storey_height));
  detail.mesh.startObject(detail.name + " balcony " + std::to_string(storey), id(CityMaterial::kStone));
  const double low = along - 1.3, high = along + 1.3;
  detail.mesh.box({low, -0.15, 0.0}, {high, 0.03, 1.2});
  detail.mesh.box({low, 0.03, 1.1}, {high, 0.95, 1.2}, kAllFaces & ~kSouth);
  detail.mesh.box({low, 0.03, 0.0}, {low + 0.08, 0.95, 1.1}, kWest | kEast | kNorth);
  detail.mesh.box({high - 0.08, 0.03, 0.0}, {high, 0.95, 1.1}, kWest | kEast | kNorth);
}

void addDoor(const Detail& detail, const Front& front) {
  const double middle = length(front.b - front.a) * 0.5 + detail.spacing * 0.5;
  detail.mesh.place(detail.building.placement.onWall(front.a, front.b, detail.mass.base));
  detail.mesh.startObject(detail.name + " door", id(CityMaterial::kDoor));
  detail.mesh.box({middle - 0.6, 0.0, 0.0}, {middle + 0.6, 2.3, 0.1}, kNoBottom);
  detail.mesh.box({middle - 0.9, 2.4, 0.0}, {middle + 0.9, 2.55, 0.7}, kNoBottom);
  detail.mesh.box({middle - 0.8, 0.0, 0.1}, {middle + 0.8, 0.12, 0.6}, kNoBottom);
}

void addFront(const Detail& detail, const Front& front, Random& random) {
  for (std::uint32_t storey = 0; storey < detail.mass.storeys; ++storey) {
    addFrames(detail, front, storey);
  }
  addPanes(detail, front);
  const WindowRow row = windowRow(front, detail.spacing);
  const bool balconies = detail.building.style != WindowStyle::kRibbon && random.chance(0.12);
  const double along = row.middle(random.below(row.count));
  for (std::uint32_t storey = 1; balconies && storey < detail.mass.storeys; ++storey) {
    addBalcony(detail, front, storey, std::clamp(along, 1.5, length(front.b - front.a) - 1.5));
  }
}

Rectangle boundsOf(const std::vector<Point2>& footprint) {
  Rectangle bounds{footprint.front(), footprint.front()};
  for (const Point2 p : footprint) {
    bounds.min = {std::min(bounds.min.x, p.x), std::min(bounds.min.y, p.y)};
    bounds.max = {std::max(bounds.max.x, p.x), std::max(bounds.max.y, p.y)};
  }
  return bounds;
}

void addRoof(MeshBuilder& mesh, const CityBuilding& building, const Mass& mass, Random& random,
             const std::string& name) {
  const double top = mass.top();
  mesh.startObject(name + " roof", id(building.roof));
  if (mass.roof == RoofShape::kFlat) {
    const std::vector<Point2> inner = outset(mass.footprint, -0.3);
    mesh.prism(inner, top, top + 0.1);
    mesh.startObject(name + " parapet", id(CityMaterial::kStone));
    mesh.ring(outset(mass.footprint, 0.18), inner, top - 0.1, top + 0.75);
    return;
  }
  Rectangle area = boundsOf(mass.footprint);
  const double depth = std::min(area.max.x - area.min.x, area.max.y - area.min.y);
  const double hip = mass.roof == RoofShape::kHip ? depth * 0.45 : 0.0;
  const double overhang = mass.roof == RoofShape::kHip ? 0.4 : 0.0;
  area = {area.min - Point2{overhang, overhang}, area.max + Point2{overhang, overhang}};
  mesh.ridgeRoof(area, top, depth * random.range(0.32, 0.45), hip);
  mesh.startObject(name + " chimney", id(CityMaterial::kBrick));
  const Point2 at = area.min + (area.max - area.min) * 0.35;
  mesh.box({at.x, at.y, top}, {at.x + 0.9, at.y + 0.6, top + depth * 0.5}, kNoBottom);
}

void addArcade(MeshBuilder& mesh, const CityBuilding& building, const Arcade& arcade,
               const std::string& name) {
  const double along = length(arcade.b - arcade.a), bay = along / arcade.openings;
  std::vector<Rectangle> openings;
  for (std::uint32_t row = 0; row < arcade.rows; ++row) {
    const double foot = row * arcade.height;
    for (std::uint32_t i = 0; i < arcade.openings; ++i) {
      openings.push_back(
          {{i * bay + 0.5, foot + arcade.parapet}, {(i + 1) * bay - 0.5, foot + arcade.height - 0.7}});
    }
  }
  mesh.place(building.placement.onWall(arcade.a, arcade.b, 0.0));
  mesh.startObject(name, id(building.wall));
  mesh.plate({{0.0, 0.0}, {along, arcade.rows * arcade.height}}, -0.5, 0.0, openings);
}

}  // namespace

std::vector<Front> frontsOf(const std::vector<Point2>& footprint, std::uint32_t without_edges) {
  std::vector<Front> fronts;
  for (std::size_t i = 0; i < footprint.size(); ++i) {
    if (!(without_edges >> i & 1)) {
      fronts.push_back({footprint[i], footprint[(i + 1) % footprint.size()]});
    }
  }
  return fronts;
}

double windowCost(const CityBuilding& building) {
  double along = 0.0;
  for (const Mass& mass : building.masses) {
    for (const Front& front : mass.fronts) {
      along += length(front.b - front.a) * mass.storeys;
    }
  }
  switch (building.style) {
    case WindowStyle::kPlain:
      return along * 12.0;
    case WindowStyle::kSill:
      return along * 22.0;
    case WindowStyle::kFramed:
      return along * 26.0;
    default:
      return 0.0;
  }
}

double fixedCost(const CityBuilding& building) {
  constexpr double kBand = 22.0;  // triangles per window: frame, sill, pane
  double cost = 0.0;
  for (const Mass& mass : building.masses) {
    const double bands = static_cast<double>(mass.fronts.size()) * mass.storeys;
    cost += building.style == WindowStyle::kRibbon ? bands * kBand : 0.0;
  }
  for (const Arcade& arcade : building.arcades) {
    const double n = arcade.openings, rows = arcade.rows;
    cost += 4.0 * ((2 * n + 1) * (2 * rows + 1) - n * rows) + 8.0 * n * rows;
  }
  return cost;
}

void addBuilding(MeshBuilder& mesh, const CityBuilding& building, double spacing, Random random,
                 const std::string& name) {
  for (std::size_t m = 0; m < building.masses.size(); ++m) {
    const Mass& mass = building.masses[m];
    const std::string mass_name = name + " body " + std::to_string(m);
    mesh.place(building.placement);
    mesh.startObject(mass_name + " shell", id(building.wall));
    mesh.prism(mass.footprint, mass.base, mass.top());
    if (mass.roof != RoofShape::kNone) {
      addRoof(mesh, building, mass, random, mass_name);
    }
    for (std::size_t f = 0; f < mass.fronts.size(); ++f) {
      const Detail detail{mesh, building, mass, spacing, mass_name + " front " + std::to_string(f)};
      addFront(detail, mass.fronts[f], random);
    }
    if (mass.has_door) {
      addDoor({mesh, building, mass, spacing, mass_name}, mass.fronts.front());
    }
  }
  for (std::size_t a = 0; a < building.arcades.size(); ++a) {
    addArcade(mesh, building, building.arcades[a], name + " arcade " + std::to_string(a));
  }
}

}  // namespace sightline::scenes
