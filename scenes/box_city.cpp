// The city of plain boxes: blocks of buildings around a courtyard on a grid of streets, scattered small
// boxes, walls around quarters, and the camera paths. Every building, small box and wall is an object and
// fills its bounds, so the culler alone is responsible for superfluous objects.

#include <algorithm>
#include <array>
#include <string>

#include "scenes/mesh_builder.h"
#include "scenes/procedural.h"
#include "scenes/random.h"
#include "scenes/walk.h"

namespace sightline {
namespace scenes {
namespace {

// Metres. A block's origin is its south-west corner; the streets south and west of it belong to it.
constexpr double kBlockX = 66.0, kBlockY = 56.0;
constexpr double kStreet = 16.0;  // from house front to house front
constexpr double kPavement = 3.0;
constexpr double kLaneHalf = 1.0;  // in the middle of a street, kept free
constexpr double kPitchX = kBlockX + kStreet, kPitchY = kBlockY + kStreet;
constexpr double kDeepest = 15.0, kShallowest = 11.0;  // buildings, from the street to the courtyard
constexpr double kEyeHeight = 1.7;
constexpr std::uint32_t kBuildings = 8;  // per block
// Walls stand beside the lane in the middle of a street, and are higher than every building.
constexpr std::uint32_t kQuarter = 4;  // blocks along each side of a walled quarter
constexpr double kWallHeight = 70.0, kWallHalf = 0.4, kWallAside = 2.0;

enum Palette : std::uint32_t { kGround, kWalls, kMoreWalls, kSmallBoxes };

std::vector<Material> palette() {
  return {{"ground", Opacity::kOpaque, false, {0.20f, 0.21f, 0.20f, 1.0f}},
          {"walls", Opacity::kOpaque, false, {0.56f, 0.43f, 0.27f, 1.0f}},
          {"more walls", Opacity::kOpaque, false, {0.40f, 0.41f, 0.42f, 1.0f}},
          {"small boxes", Opacity::kOpaque, false, {0.45f, 0.10f, 0.06f, 1.0f}}};
}

struct BoxGrid {
  std::uint32_t columns = 1, rows = 1, blocks = 1;

  explicit BoxGrid(std::uint32_t buildings) : blocks((buildings + kBuildings - 1) / kBuildings) {
    while (columns * columns < blocks) {
      ++columns;
    }
    rows = (blocks + columns - 1) / columns;
  }
  Point2 corner(std::uint32_t block) const { return {block % columns * kPitchX, block / columns * kPitchY}; }
  // The centre of the crossing south-west of a block. Fractional arguments lie between crossings.
  static Point2 crossing(double column, double row) {
    return {column * kPitchX - kStreet / 2, row * kPitchY - kStreet / 2};
  }
  double far() const { return length(Point2{columns * kPitchX, rows * kPitchY}) + 300.0; }
};

// The footprints of a row of buildings that fill [0, kBlockX], most of them wall to wall. Depths start at 0.
std::array<Rectangle, 3> planRow(Random& random) {
  std::array<double, 3> width{};
  double sum = 0.0;
  for (double& w : width) {
    w = random.range(0.7, 1.3);
    sum += w;
  }
  std::array<Rectangle, 3> row;
  double x = 0.0;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const double end = i == 2 ? kBlockX : x + width[i] / sum * kBlockX;
    const double alley = i < 2 && random.chance(0.15) ? random.range(1.0, 3.0) : 0.0;
    row[i] = {{x, 0.0}, {end - alley, random.range(kShallowest, kDeepest)}};
    x = end;
  }
  return row;
}

// Footprints of a block's buildings: a row in the south, a row in the north, and between them one building
// each in the west and in the east.
std::array<Rectangle, kBuildings> planBlock(Random& random) {
  std::array<Rectangle, kBuildings> plan;
  const std::array<Rectangle, 3> south = planRow(random), north = planRow(random);
  for (std::size_t i = 0; i < 3; ++i) {
    plan[i] = south[i];
    plan[3 + i] = {{north[i].min.x, kBlockY - north[i].max.y}, {north[i].max.x, kBlockY}};
  }
  const auto alley = [&] { return random.chance(0.15) ? random.range(1.0, 3.0) : 0.0; };
  for (const std::size_t side : {0u, 1u}) {
    const double low = plan[2 * side].max.y + alley();
    const double high = plan[3 + 2 * side].min.y - alley();
    const double depth = random.range(kShallowest, kDeepest);
    plan[6 + side] =
        side == 0 ? Rectangle{{0.0, low}, {depth, high}} : Rectangle{{kBlockX - depth, low}, {kBlockX, high}};
  }
  return plan;
}

// The area in which a small box of a block may stand: on its pavements, on both lanes of its two streets, or
// in its courtyard.
Rectangle placeForSmallBox(Random& random) {
  constexpr double kKerb = -kPavement, kFarKerb = kPavement - kStreet;
  constexpr double kLane = -kStreet / 2 + kLaneHalf, kFarLane = -kStreet / 2 - kLaneHalf;
  static constexpr Rectangle kPavements[] = {{{0, kKerb}, {kBlockX, 0}},
                                             {{0, kBlockY}, {kBlockX, kBlockY + kPavement}},
                                             {{kKerb, 0}, {0, kBlockY}},
                                             {{kBlockX, 0}, {kBlockX + kPavement, kBlockY}}};
  static constexpr Rectangle kRoads[] = {{{0, kLane}, {kBlockX, kKerb}},
                                         {{0, kFarKerb}, {kBlockX, kFarLane}},
                                         {{kLane, 0}, {kKerb, kBlockY}},
                                         {{kFarKerb, 0}, {kFarLane, kBlockY}}};
  static constexpr Rectangle kCourtyard{{kDeepest, kDeepest}, {kBlockX - kDeepest, kBlockY - kDeepest}};
  const double which = random.uniform();
  const std::uint32_t side = random.below(4);
  return which < 0.4 ? kPavements[side] : which < 0.65 ? kRoads[side] : kCourtyard;
}

void addSmallBox(MeshBuilder& mesh, std::uint32_t number, Random& random) {
  const Rectangle place = placeForSmallBox(random);
  const double u = random.uniform();
  const auto side = [&] { return std::max(0.3, (0.3 + 2.7 * u * u) * random.range(0.6, 1.0)); };
  Vec3d size;
  Vec3d low;
  for (int axis = 0; axis < 3; ++axis) {
    size[axis] = side();
  }
  low.x = random.range(place.min.x, place.max.x - size.x);
  low.y = random.range(place.min.y, place.max.y - size.y);
  mesh.startObject("box " + std::to_string(number), MaterialId{kSmallBoxes});
  mesh.box(low, low + size);
}

// Number of items in the blocks before `block` if `count` items are spread evenly over `blocks` blocks.
std::uint32_t before(std::uint32_t block, std::uint32_t blocks, std::uint32_t count) {
  return static_cast<std::uint32_t>(std::uint64_t{count} * block / blocks);
}

void addBuildings(MeshBuilder& mesh, const BoxGrid& grid, const BoxCityOptions& options) {
  for (std::uint32_t block = 0; block < grid.blocks; ++block) {
    Random random(options.seed, 2 * std::uint64_t{block});
    const Point2 corner = grid.corner(block);
    mesh.place({.origin = {corner.x, corner.y, 0.0}});
    const std::array<Rectangle, kBuildings> plan = planBlock(random);
    for (std::uint32_t i = 0; i < kBuildings && block * kBuildings + i < options.buildings; ++i) {
      const double u = random.uniform();
      mesh.startObject("building " + std::to_string(block * kBuildings + i),
                       MaterialId{random.chance(0.5) ? kWalls : kMoreWalls});
      mesh.box({plan[i].min.x, plan[i].min.y, 0.0}, {plan[i].max.x, plan[i].max.y, 8.0 + 52.0 * u * u});
    }
  }
}

void addSmallBoxes(MeshBuilder& mesh, const BoxGrid& grid, const BoxCityOptions& options) {
  for (std::uint32_t block = 0; block < grid.blocks; ++block) {
    Random random(options.seed, 2 * std::uint64_t{block} + 1);
    const Point2 corner = grid.corner(block);
    mesh.place({.origin = {corner.x, corner.y, 0.0}});
    const std::uint32_t end = before(block + 1, grid.blocks, options.boxes);
    for (std::uint32_t i = before(block, grid.blocks, options.boxes); i < end; ++i) {
      addSmallBox(mesh, i, random);
    }
  }
}

// Where the walls between quarters run: before these columns, or rows, of blocks. The crossing in the middle
// of the city is in the middle of a quarter.
std::vector<std::uint32_t> bordersOfQuarters(std::uint32_t count) {
  std::vector<std::uint32_t> borders;
  for (std::uint32_t i = (count / 2 + kQuarter / 2) % kQuarter; i <= count; i += kQuarter) {
    borders.push_back(i);
  }
  return borders;
}

// Adds the walls around quarters, one for each block that they pass.
void addWalls(MeshBuilder& mesh, const BoxGrid& grid) {
  mesh.place({});
  const auto add = [&](const Point2& from, const Point2& to) {
    mesh.startObject("wall", MaterialId{kMoreWalls});
    mesh.box({from.x + kWallAside - kWallHalf, from.y + kWallAside - kWallHalf, 0.0},
             {to.x + kWallAside + kWallHalf, to.y + kWallAside + kWallHalf, kWallHeight});
  };
  for (const std::uint32_t column : bordersOfQuarters(grid.columns)) {
    for (std::uint32_t row = 0; row < grid.rows; ++row) {
      add(BoxGrid::crossing(column, row), BoxGrid::crossing(column, row + 1));
    }
  }
  for (const std::uint32_t row : bordersOfQuarters(grid.rows)) {
    for (std::uint32_t column = 0; column < grid.columns; ++column) {
      add(BoxGrid::crossing(column, row), BoxGrid::crossing(column + 1, row));
    }
  }
}

void addGround(MeshBuilder& mesh, const BoxGrid& grid) {
  constexpr double kMargin = 100.0;
  const double x = grid.columns * kPitchX + kMargin, y = grid.rows * kPitchY + kMargin;
  mesh.place({});
  mesh.startObject("ground", MaterialId{kGround});
  mesh.quad({-kMargin, -kMargin, 0}, {x, -kMargin, 0}, {x, y, 0}, {-kMargin, y, 0});
}

// A route around two corners in the centre of the city.
CameraPath smoothWalk(const BoxGrid& grid) {
  const double column = grid.columns / 2, row = grid.rows / 2;
  std::vector<Vec3d> route;
  for (const Point2 p : {BoxGrid::crossing(column - 0.5, row), BoxGrid::crossing(column, row),
                         BoxGrid::crossing(column, row + 1), BoxGrid::crossing(column + 0.5, row + 1)}) {
    route.emplace_back(p.x, p.y, kEyeHeight);
  }
  const WalkOptions options{
      .name = "smooth", .look_ahead = 4.0, .glance = 0.35, .glance_turns = 5, .far = grid.far()};
  return walkAlong(roundedRoute(route, 5.0), options);
}

// Five by four places all over the city, looking east, north, west and south in turn, slightly to one side.
CameraPath views(const BoxGrid& grid, std::uint32_t seed) {
  constexpr std::uint32_t kAcross = 5, kUp = 4;
  CameraPath path;
  path.name = "views";
  path.z_far = grid.far();
  Random random(seed, ~std::uint64_t{0});
  for (std::uint32_t i = 0; i < kAcross * kUp; ++i) {
    const std::uint32_t column = (2 * (i % kAcross) + 1) * grid.columns / (2 * kAcross);
    const std::uint32_t row = (2 * (i / kAcross) + 1) * grid.rows / (2 * kUp);
    const double along = random.range(0.2, 0.8), aside = random.range(-0.8, 0.8) * kLaneHalf;
    const bool north = i % 2 == 1;
    Point2 eye = north ? BoxGrid::crossing(column, row + along) : BoxGrid::crossing(column + along, row);
    eye = eye + (north ? Point2{aside, 0.0} : Point2{0.0, aside});
    const Point2 look = unitVector((i % 4) * 0.25 + random.range(-0.04, 0.04));
    path.frames.push_back(
        {worldFromPlan({eye.x, eye.y, kEyeHeight}), worldFromPlan({look.x, look.y, 0.0}), {0.0, 1.0, 0.0}});
  }
  return path;
}

}  // namespace
}  // namespace scenes

Scene makeBoxCity(const BoxCityOptions& options) {
  using namespace scenes;
  Scene scene;
  scene.materials = palette();
  const BoxGrid grid(options.buildings);
  const std::size_t boxes = std::size_t{options.buildings} + options.boxes;
  scene.positions.reserve(boxes * 8 + 4);
  scene.indices.reserve(boxes * 36 + 6);
  {
    MeshBuilder mesh(scene);
    addGround(mesh, grid);
    addBuildings(mesh, grid, options);
    addSmallBoxes(mesh, grid, options);
    if (options.walled) {
      addWalls(mesh, grid);
    }
  }
  weldPositions(scene);
  updateBounds(scene);
  scene.paths = {smoothWalk(grid), views(grid, options.seed)};
  return scene;
}

}  // namespace sightline
