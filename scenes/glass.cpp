#include "scenes/glass.h"

#include <algorithm>
#include <string>
#include <vector>

#include "scenes/mesh_builder.h"
#include "scenes/random.h"

namespace sightline {
namespace scenes {
namespace {

constexpr double kAbove = 0.004;  // gap below each object, metres, so that nothing touches
constexpr double kPaneThickness = 0.03;
constexpr std::uint32_t kGroveRows = 4;
constexpr double kGroveCell = 1.5;                      // side of a cell, metres; one object per cell
constexpr double kGroveWest = 7.5, kGroveSouth = -2.6;  // its south-west corner
constexpr double kHallWest = -10.5, kHallDepth = 5.0;   // the back wall is at y = kHallDepth
constexpr std::uint32_t kTints = 6;

// Indices into Scene::materials.
enum Surface : std::uint32_t { kFloor, kWall, kColumn, kFilm, kFirstTint };

std::vector<Material> materials() {
  const auto glass = [](const char* name, float red, float green, float blue, float alpha) {
    return Material{.name = name, .opacity = Opacity::kBlended, .base_color = {red, green, blue, alpha}};
  };
  std::vector<Material> list{{.name = "floor", .base_color = {0.55f, 0.52f, 0.48f, 1.0f}},
                             {.name = "wall", .base_color = {0.8f, 0.78f, 0.72f, 1.0f}},
                             {.name = "column", .base_color = {0.2f, 0.2f, 0.24f, 1.0f}},
                             glass("film", 0.95f, 0.9f, 0.6f, 0.35f),
                             glass("red glass", 0.8f, 0.1f, 0.08f, 0.55f),
                             glass("green glass", 0.1f, 0.55f, 0.2f, 0.5f),
                             glass("blue glass", 0.08f, 0.2f, 0.75f, 0.55f),
                             glass("amber glass", 0.85f, 0.5f, 0.05f, 0.5f),
                             glass("violet glass", 0.45f, 0.1f, 0.6f, 0.5f),
                             glass("clear glass", 0.7f, 0.85f, 0.85f, 0.3f)};
  list[kFilm].double_sided = true;
  return list;
}

class Hall {
 public:
  Hall(Scene& scene, const GlassOptions& options)
      : options_(options), mesh_(scene), random_(options.seed, 11) {}

  void build() {
    structure();
    ring();
    meetings();
    slantwise();
    grove();
    mesh_.finishObject();
  }
  double east() const { return kGroveWest + kGroveCell * groveColumns() + 1.5; }

 private:
  std::uint32_t groveThings() const { return options_.panes + options_.bottles; }
  // One cell in five has a column.
  std::uint32_t groveColumns() const {
    const std::uint32_t cells = groveThings() + groveThings() / 4 + 1;
    return (cells + kGroveRows - 1) / kGroveRows;
  }

  void start(const std::string& name, std::uint32_t surface, const Placement& at) {
    mesh_.startObject(name, MaterialId{surface});
    mesh_.place(at);
  }
  std::uint32_t anyTint() { return kFirstTint + random_.below(kTints); }

  void structure() {
    start("floor", kFloor, {});
    mesh_.box({kHallWest, -9.0, -0.3}, {east(), kHallDepth, 0.0});
    start("back wall", kWall, {});
    mesh_.box({kHallWest, kHallDepth + kAbove, -0.3}, {east(), kHallDepth + 0.3, 4.0});
    std::uint32_t i = 0;
    for (double x = kHallWest + 1.5; x < east() - 1.0; x += 3.0) {
      start("pillar " + std::to_string(i++), kColumn, Placement{{x, kHallDepth - 0.6, kAbove}});
      mesh_.box({-0.25, -0.25, 0.0}, {0.25, 0.25, 3.2});
    }
  }

  void pane(const std::string& name, std::uint32_t tint, const Placement& foot, double width, double height) {
    start(name, tint, foot);
    mesh_.box({-0.5 * width, -0.5 * kPaneThickness, 0.0}, {0.5 * width, 0.5 * kPaneThickness, height});
  }
  void film(const std::string& name, const Placement& foot, double width, double height) {
    start(name, kFilm, foot);
    mesh_.quad({-0.5 * width, 0.0, 0.0}, {0.5 * width, 0.0, 0.0}, {0.5 * width, 0.0, height},
               {-0.5 * width, 0.0, height});
  }
  void bottle(const std::string& name, std::uint32_t tint, const Placement& foot, double scale) {
    const double s = scale;
    const Point2 profile[] = {{0.0, 0.0},           {0.16 * s, 0.0},      {0.17 * s, 0.04 * s},
                              {0.17 * s, 0.55 * s}, {0.14 * s, 0.66 * s}, {0.06 * s, 0.78 * s},
                              {0.05 * s, 1.0 * s},  {0.07 * s, 1.02 * s}, {0.07 * s, 1.06 * s},
                              {0.0, 1.06 * s}};
    start(name, tint, foot);
    mesh_.lathe(profile, 20);
  }
  void ball(const std::string& name, std::uint32_t tint, const Placement& middle, double radius) {
    std::vector<Point2> profile{{0.0, -radius}};
    for (int i = 1; i < 12; ++i) {
      const Point2 d = unitVector(0.5 * i / 12.0);
      profile.push_back({radius * d.y, -radius * d.x});
    }
    profile.push_back({0.0, radius});
    start(name, tint, middle);
    mesh_.lathe(profile, 24);
  }

  // Six bars along the sides of an upright hexagon. Each is tilted, so that its end is in front of the start
  // of the next; none touches another.
  void ring() {
    constexpr std::uint32_t kBars = 6;
    constexpr double kInner = 1.0, kHalfLength = 1.0, kHalfWidth = 0.19, kTilt = 0.16;
    const Vec3d middle{-8.0, 0.0, 1.6};
    for (std::uint32_t i = 0; i < kBars; ++i) {
      const Point2 out = unitVector(static_cast<double>(i) / kBars);
      const Vec3d outwards{out.x, 0.0, out.y};
      const Vec3d along = normalized(Vec3d{-out.y, -kTilt, out.x});
      start("ring " + std::to_string(i), kFirstTint + i,
            {middle + outwards * kInner, outwards, along, cross(outwards, along)});
      mesh_.box({-kHalfWidth, -kHalfLength, -0.01}, {kHalfWidth, kHalfLength, 0.01});
    }
  }

  void meetings() {
    const Placement crossing{{-4.6, 0.4, kAbove}};
    pane("crossing 0", kFirstTint, crossing.turned(0.09), 1.7, 2.2);
    pane("crossing 1", kFirstTint + 2, crossing.turned(-0.1), 1.7, 2.0);

    const Placement target{{-2.3, 0.0, kAbove}};
    pane("pierced pane", kFirstTint + 1, target.turned(0.06), 1.5, 2.2);
    ball("piercing ball", kFirstTint + 3, target.moved({0.1, 0.05, 1.2}), 0.45);

    const Placement cabinet{{-0.4, 0.9, kAbove}};
    start("cabinet", kFirstTint + 5, cabinet.turned(0.03));
    mesh_.box({-0.6, -0.45, 0.0}, {0.6, 0.45, 2.0});
    bottle("bottle in the cabinet", kFirstTint + 4, cabinet.moved({-0.15, 0.1, 0.1}), 1.4);
    start("block in the cabinet", kColumn, cabinet.moved({0.25, -0.1, 0.1}));
    mesh_.box({-0.15, -0.15, 0.0}, {0.15, 0.15, 0.8});
  }

  // Bottles in front of the far half of the long pane are farther away than the pane's centre, and those
  // behind its near half are nearer.
  void slantwise() {
    const Placement foot = Placement{{3.8, 0.4, kAbove}}.turned(0.09);
    pane("long pane", kFirstTint + 2, foot, 6.4, 2.0);
    const double places[] = {-2.6, -1.7, -0.8, 0.8, 1.7, 2.6};
    std::uint32_t i = 0;
    for (const double x : places) {
      for (const double side : {-1.0, 1.0}) {
        const double at = x + random_.range(-0.15, 0.15);
        const double off = side * random_.range(0.45, 0.65);
        const double scale = random_.range(1.0, 1.6);
        bottle("bottle by the long pane " + std::to_string(i++), anyTint(), foot.moved({at, off, 0.0}),
               scale);
      }
    }
  }

  // A balustrade runs along the front; many objects behind it are nearer than its centre.
  void grove() {
    const double length = kGroveCell * groveColumns();
    pane("balustrade", kFirstTint + 5, {{kGroveWest + 0.5 * length, kGroveSouth - 0.3, kAbove}}, length, 1.1);
    std::vector<Point2> cells;
    for (std::uint32_t c = 0; c < groveColumns() * kGroveRows; ++c) {
      cells.push_back({kGroveWest + kGroveCell * (c / kGroveRows + 0.5),
                       kGroveSouth + kGroveCell * (c % kGroveRows + 0.5)});
    }
    for (std::size_t i = cells.size(); i > 1; --i) {
      std::swap(cells[i - 1], cells[random_.below(static_cast<std::uint32_t>(i))]);
    }
    std::size_t next = 0;
    const auto place = [&] {
      const Point2 at = cells[next++];
      const double turns = random_.uniform();
      return Placement{{at.x, at.y, kAbove}}.turned(turns);
    };
    for (std::uint32_t i = 0; i < options_.panes; ++i) {
      const Placement foot = place();
      const double width = random_.range(0.8, 1.35), height = random_.range(1.2, 2.4);
      if (i % 3 == 2) {
        film("film " + std::to_string(i), foot, width, height);
      } else {
        pane("pane " + std::to_string(i), anyTint(), foot, width, height);
      }
    }
    for (std::uint32_t i = 0; i < options_.bottles; ++i) {
      const Placement foot = place();
      const double scale = random_.range(1.2, 2.0);
      bottle("bottle " + std::to_string(i), anyTint(), foot, scale);
    }
    for (std::uint32_t i = 0; next < cells.size(); ++i) {
      start("column " + std::to_string(i), kColumn, place());
      mesh_.box({-0.15, -0.15, 0.0}, {0.15, 0.15, random_.range(1.0, 2.6)});
    }
  }

  const GlassOptions& options_;
  MeshBuilder mesh_;
  Random random_;
};

// Goes past everything from west to east, looking ahead and to the side, at varying distance and height.
CameraPath walkAlongHall(double east) {
  constexpr std::uint32_t kFrames = 240;
  CameraPath path;
  path.name = "along";
  path.fovy_deg = 50.0;
  path.z_far = 200.0;
  const double west = kHallWest + 1.0;
  for (std::uint32_t f = 0; f < kFrames; ++f) {
    const double t = static_cast<double>(f) / (kFrames - 1);
    const Point2 sway = unitVector(2.0 * t);
    const double x = west + (east - 2.0 - west) * t;
    const Vec3d eye{x, -6.2 + sway.y, 1.9 + 0.5 * sway.x};
    const Vec3d target{x + 1.6 - 2.6 * t, 0.0, 1.1};
    path.frames.push_back({worldFromPlan(eye), worldFromPlan(normalized(target - eye)), {0.0, 1.0, 0.0}});
  }
  return path;
}

}  // namespace
}  // namespace scenes

Scene makeGlass(const GlassOptions& options) {
  Scene scene;
  scene.materials = scenes::materials();
  double east = 0.0;
  {
    scenes::Hall hall(scene, options);
    hall.build();
    east = hall.east();
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = {scenes::walkAlongHall(east)};
  return scene;
}

}  // namespace sightline
