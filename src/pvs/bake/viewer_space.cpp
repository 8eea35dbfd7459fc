#include "sightline/pvs/bake/viewer_space.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <map>
#include <string>
#include <utility>

namespace sightline {
namespace {

using Place = std::array<int, 3>;  // a voxel, x, y and z

// A range of voxels.
struct Block {
  Place min{}, max{};  // max is one past the last
};

// Calls visit(word, mask) for the words of a row that hold its bits from first up to and with last.
template <typename Visit>
void forEachWord(std::size_t first, std::size_t last, Visit&& visit) {
  for (std::size_t word = first / 64; word <= last / 64; ++word) {
    const std::uint64_t from = ~std::uint64_t{0} << (word == first / 64 ? first % 64 : 0);
    const std::uint64_t to = ~std::uint64_t{0} >> (word == last / 64 ? 63 - last % 64 : 0);
    visit(word, from & to);
  }
}

// The first bit from this one on that is set, or that is clear; past the row's words where there is none.
std::size_t nextBit(std::span<const std::uint64_t> row, std::size_t from, bool set) {
  while (from < 64 * row.size()) {
    const std::uint64_t word = (set ? row[from / 64] : ~row[from / 64]) >> (from % 64);
    if (word != 0) {
      return from + static_cast<std::size_t>(std::countr_zero(word));
    }
    from = 64 * (from / 64 + 1);
  }
  return 64 * row.size();
}

// The first bit of the run of set bits that ends before this one; `before` itself where there is none.
std::size_t runBefore(std::span<const std::uint64_t> row, std::size_t before) {
  while (before > 0) {
    const std::size_t word = (before - 1) / 64;
    const std::uint64_t clear = ~row[word] << (63 - (before - 1) % 64);
    if (clear != 0) {
      return before - static_cast<std::size_t>(std::countl_zero(clear));
    }
    before = 64 * word;
  }
  return 0;
}

void orInto(std::span<std::uint64_t> row, std::span<const std::uint64_t> other) {
  for (std::size_t word = 0; word < row.size(); ++word) {
    row[word] |= other[word];
  }
}

// A bit for each voxel of a grid, in rows along x.
class VoxelBits {
 public:
  explicit VoxelBits(const Place& size)
      : size_(size),
        row_words_((static_cast<std::size_t>(size[0]) + 63) / 64),
        words_(row_words_ * static_cast<std::size_t>(size[1]) * static_cast<std::size_t>(size[2])) {}

  const Place& size() const { return size_; }
  bool holds(const Place& p) const {
    return p[0] >= 0 && p[1] >= 0 && p[2] >= 0 && p[0] < size_[0] && p[1] < size_[1] && p[2] < size_[2];
  }
  bool at(const Place& p) const { return (row(p[1], p[2])[wordOf(p)] & bitOf(p)) != 0; }
  void set(const Place& p) { row(p[1], p[2])[wordOf(p)] |= bitOf(p); }
  // Does what set() does; several threads may call it at a time.
  void setTogether(const Place& p) { orTogether(row(p[1], p[2])[wordOf(p)], bitOf(p)); }
  // Sets a row of voxels along an axis, up to and with the last one; several threads may call it at a time.
  void setRowTogether(const Place& first, const Place& last, std::size_t axis) {
    if (axis == 0) {
      const std::span<std::uint64_t> words = row(first[1], first[2]);
      forEachWord(static_cast<std::size_t>(first[0]), static_cast<std::size_t>(last[0]),
                  [&](std::size_t word, std::uint64_t mask) { orTogether(words[word], mask); });
      return;
    }
    for (Place p = first; p[axis] <= last[axis]; ++p[axis]) {
      setTogether(p);
    }
  }
  void invert() {
    const std::uint64_t past_end = ~std::uint64_t{0} >> (size_[0] % 64 == 0 ? 0 : 64 - size_[0] % 64);
    for (std::size_t i = 0; i < words_.size(); ++i) {
      words_[i] = ~words_[i] & ((i + 1) % row_words_ == 0 ? past_end : ~std::uint64_t{0});
    }
  }
  std::span<std::uint64_t> row(int y, int z) {
    return std::span(words_).subspan(row_words_ * rowIndex(y, z), row_words_);
  }
  std::span<const std::uint64_t> row(int y, int z) const {
    return std::span(words_).subspan(row_words_ * rowIndex(y, z), row_words_);
  }

 private:
  static std::size_t wordOf(const Place& p) { return static_cast<std::size_t>(p[0]) / 64; }
  static void orTogether(std::uint64_t& word, std::uint64_t bits) {
    std::atomic_ref<std::uint64_t>(word).fetch_or(bits, std::memory_order_relaxed);
  }
  static std::uint64_t bitOf(const Place& p) { return std::uint64_t{1} << (p[0] % 64); }
  std::size_t rowIndex(int y, int z) const {
    return static_cast<std::size_t>(z) * static_cast<std::size_t>(size_[1]) + static_cast<std::size_t>(y);
  }

  Place size_;
  std::size_t row_words_;
  std::vector<std::uint64_t> words_;
};

// The voxels of the region; those at its maximum may reach beyond it.
struct Grid {
  Vec3d min;
  double voxel = 0.0;
  Place size{};

  Grid(const Box& region, double edge) : min(region.min), voxel(edge) {
    const Vec3d extent = Vec3d(region.max) - min;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      size[axis] = 1 + static_cast<int>(extent[static_cast<int>(axis)] / voxel);
    }
  }
  double border(int axis, int at) const { return min[axis] + voxel * at; }
  // Beyond the grid where the point is.
  Place placeOf(const Vec3d& p) const { return {placeAlong(0, p.x), placeAlong(1, p.y), placeAlong(2, p.z)}; }
  // The first and the last voxel along an axis that something from low to high touches. What lies in the
  // border of two voxels touches both.
  std::pair<int, int> touched(int axis, double low, double high) const {
    const int first = placeAlong(axis, low), last = placeAlong(axis, high);
    return {border(axis, first) >= low ? first - 1 : first, border(axis, last + 1) <= high ? last + 1 : last};
  }
  Box boxOf(const Block& block) const {
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<std::size_t>(axis);
      box.min[axis] = static_cast<float>(border(axis, block.min[i]));
      box.max[axis] = static_cast<float>(border(axis, block.max[i]));
    }
    return box;
  }

 private:
  int placeAlong(int axis, double at) const {
    return static_cast<int>(std::clamp(std::floor((at - min[axis]) / voxel), -1e9, 1e9));
  }
};

double voxelsOf(const Vec3d& extent, double edge) {
  return (1.0 + std::floor(extent.x / edge)) * (1.0 + std::floor(extent.y / edge)) *
         (1.0 + std::floor(extent.z / edge));
}

// A triangle, or what is left of it in a block of voxels.
struct Polygon {
  static constexpr std::size_t kMost = 12;  // clipping a triangle at six planes gives nine vertices
  std::array<Vec3d, kMost> vertices;
  std::size_t count = 0;

  void add(const Vec3d& vertex) {
    if (count < kMost) {
      vertices[count++] = vertex;
    }
  }
};

// The part of the polygon on one side of a plane across an axis.
Polygon clip(const Polygon& polygon, int axis, double at, bool upper) {
  Polygon part;
  for (std::size_t i = 0; i < polygon.count; ++i) {
    const Vec3d& a = polygon.vertices[i];
    const Vec3d& b = polygon.vertices[(i + 1) % polygon.count];
    const double from_a = upper ? a[axis] - at : at - a[axis], from_b = upper ? b[axis] - at : at - b[axis];
    if (from_a >= 0.0) {
      part.add(a);
    }
    if ((from_a > 0.0 && from_b < 0.0) || (from_a < 0.0 && from_b > 0.0)) {
      Vec3d crossing = a + (b - a) * (from_a / (from_a - from_b));
      crossing[axis] = at;
      part.add(crossing);
    }
  }
  return part;
}

// Sets the voxels that the polygon touches of a block that is one row along this axis.
void markRow(const Grid& grid, const Polygon& polygon, const Block& row, std::size_t along, VoxelBits& bits) {
  const int axis = static_cast<int>(along);
  double low = polygon.vertices[0][axis], high = low;
  for (std::size_t i = 1; i < polygon.count; ++i) {
    low = std::min(low, polygon.vertices[i][axis]);
    high = std::max(high, polygon.vertices[i][axis]);
  }
  const auto [touched_first, touched_last] = grid.touched(axis, low, high);
  Place first = row.min, last = row.min;
  first[along] = std::clamp(touched_first, row.min[along], row.max[along] - 1);
  last[along] = std::clamp(touched_last, first[along], row.max[along] - 1);
  bits.setRowTogether(first, last, along);
}

// Sets the voxels of the block that the polygon touches. The block is halved down to rows along this axis.
void mark(const Grid& grid, const Polygon& polygon, const Block& block, std::size_t along, VoxelBits& bits) {
  if (polygon.count == 0) {
    return;
  }
  const std::size_t u = (along + 1) % 3, v = (along + 2) % 3;
  const std::size_t longer = block.max[u] - block.min[u] >= block.max[v] - block.min[v] ? u : v;
  const int middle = (block.min[longer] + block.max[longer]) / 2;
  if (middle == block.min[longer]) {
    markRow(grid, polygon, block, along, bits);
    return;
  }
  const int axis = static_cast<int>(longer);
  for (const bool upper : {false, true}) {
    Block half = block;
    (upper ? half.min : half.max)[longer] = middle;
    mark(grid, clip(polygon, axis, grid.border(axis, middle), upper), half, along, bits);
  }
}

void markTriangle(const Grid& grid, const std::array<Vec3d, 3>& triangle, VoxelBits& bits) {
  Polygon polygon;
  for (const Vec3d& vertex : triangle) {
    if (!isFinite(vertex)) {
      return;
    }
    polygon.add(vertex);
  }
  const Vec3d low = min(min(triangle[0], triangle[1]), triangle[2]);
  const Vec3d high = max(max(triangle[0], triangle[1]), triangle[2]);
  Block block;
  std::size_t longest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const int axis = static_cast<int>(i);
    const auto [first, last] = grid.touched(axis, low[axis], high[axis]);
    block.min[i] = first;
    block.max[i] = last + 1;
    if (block.min[i] < 0) {
      block.min[i] = 0;
      polygon = clip(polygon, axis, grid.border(axis, 0), true);
    }
    if (block.max[i] > grid.size[i]) {
      block.max[i] = grid.size[i];
      polygon = clip(polygon, axis, grid.border(axis, grid.size[i]), false);
    }
    if (block.min[i] >= block.max[i]) {
      return;
    }
    if (block.max[i] - block.min[i] > block.max[longest] - block.min[longest]) {
      longest = i;
    }
  }
  mark(grid, polygon, block, longest, bits);
}

VoxelBits touchedByOpaque(const SceneView& scene, const Grid& grid, const ParallelFor& parallel_for) {
  VoxelBits bits(grid.size);
  parallel_for(static_cast<std::uint32_t>(scene.objects.size()), [&](std::uint32_t begin, std::uint32_t end) {
    for (const Object& object : scene.objects.subspan(begin, end - begin)) {
      const std::span<const std::uint32_t> indices =
          scene.materialOf(object).opaque() ? scene.indicesOf(object) : std::span<const std::uint32_t>{};
      for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
        markTriangle(grid,
                     {Vec3d(scene.positions[indices[i]]), Vec3d(scene.positions[indices[i + 1]]),
                      Vec3d(scene.positions[indices[i + 2]])},
                     bits);
      }
    }
  });
  return bits;
}

// Moves all voxels that are connected by their faces with this one from `open` to `reached`.
void flood(const Place& start, VoxelBits& open, VoxelBits& reached) {
  std::vector<Place> seeds{start};
  while (!seeds.empty()) {
    const auto [x, y, z] = seeds.back();
    seeds.pop_back();
    if (!open.at({x, y, z})) {
      continue;
    }
    // The run of open voxels along x, and one seed for each run beside it.
    const std::span<std::uint64_t> row = open.row(y, z), reached_row = reached.row(y, z);
    const std::size_t first = runBefore(row, static_cast<std::size_t>(x));
    const std::size_t last = nextBit(row, static_cast<std::size_t>(x), false) - 1;
    forEachWord(first, last, [&](std::size_t word, std::uint64_t mask) {
      row[word] &= ~mask;
      reached_row[word] |= mask;
    });
    for (const Place& beside : {Place{x, y - 1, z}, {x, y + 1, z}, {x, y, z - 1}, {x, y, z + 1}}) {
      if (!open.holds(beside)) {
        continue;
      }
      const std::span<const std::uint64_t> other = open.row(beside[1], beside[2]);
      std::uint64_t before = 0;  // whether the last bit of the word before is open
      forEachWord(first, last, [&](std::size_t word, std::uint64_t mask) {
        const std::uint64_t runs = other[word] & mask;
        for (std::uint64_t starts = runs & ~(runs << 1 | before); starts != 0; starts &= starts - 1) {
          const std::size_t at = 64 * word + static_cast<std::size_t>(std::countr_zero(starts));
          seeds.push_back({static_cast<int>(at), beside[1], beside[2]});
        }
        before = runs >> 63;
      });
    }
  }
}

// Calls visit(place, ring) for the voxels at most this many away on each axis, the closest first; ring is how
// many the voxel is away on the axis where it is farthest.
template <typename Visit>
void forEachNear(const Place& centre, int distance, Visit&& visit) {
  for (int ring = 0; ring <= distance; ++ring) {
    for (int z = -ring; z <= ring; ++z) {
      for (int y = -ring; y <= ring; ++y) {
        for (int x = -ring; x <= ring; ++x) {
          if (std::max({std::abs(x), std::abs(y), std::abs(z)}) == ring) {
            visit(Place{centre[0] + x, centre[1] + y, centre[2] + z}, ring);
          }
        }
      }
    }
  }
}

// Removes the voxels that are higher than this above a blocked one, or above none.
void cutAbove(const VoxelBits& blocked, double voxels, VoxelBits& reached) {
  const Place size = blocked.size();
  // A voxel is kept if one of so many layers below it is blocked.
  const int below = 1 + static_cast<int>(std::min<double>(voxels, size[1]));
  std::vector<std::uint64_t> above_ground(blocked.row(0, 0).size());
  for (int z = 0; z < size[2]; ++z) {
    for (int y = 0; y < size[1]; ++y) {
      std::fill(above_ground.begin(), above_ground.end(), 0);
      for (int ground = std::max(y - below, 0); ground < y; ++ground) {
        orInto(above_ground, blocked.row(ground, z));
      }
      const std::span<std::uint64_t> row = reached.row(y, z);
      for (std::size_t word = 0; word < row.size(); ++word) {
        row[word] &= above_ground[word];
      }
    }
  }
}

// Adds the 26 neighbours of all voxels that are set.
void widen(VoxelBits& bits) {
  const Place size = bits.size();
  // Along x, within a row.
  for (int z = 0; z < size[2]; ++z) {
    for (int y = 0; y < size[1]; ++y) {
      const std::span<std::uint64_t> row = bits.row(y, z);
      std::uint64_t before = 0;
      for (std::size_t w = 0; w < row.size(); ++w) {
        const std::uint64_t own = row[w], after = w + 1 < row.size() ? row[w + 1] : 0;
        row[w] = own | own << 1 | own >> 1 | before >> 63 | after << 63;
        before = own;
      }
      if (size[0] % 64 != 0) {
        row.back() &= (std::uint64_t{1} << (size[0] % 64)) - 1;
      }
    }
  }
  // Along y and z, by whole rows.
  const VoxelBits along_x = bits;
  for (int z = 0; z < size[2]; ++z) {
    for (int y = 0; y < size[1]; ++y) {
      const std::span<std::uint64_t> row = bits.row(y, z);
      for (int dz = -1; dz <= 1; ++dz) {
        for (int dy = -1; dy <= 1; ++dy) {
          if (!bits.holds({0, y + dy, z + dz})) {
            continue;
          }
          orInto(row, along_x.row(y + dy, z + dz));
        }
      }
    }
  }
}

// Calls visit(begin, end) for the runs of voxels that are set in a row.
template <typename Visit>
void forEachRun(std::span<const std::uint64_t> row, Visit&& visit) {
  for (std::size_t begin = nextBit(row, 0, true); begin < 64 * row.size();) {
    const std::size_t end = nextBit(row, begin, false);
    visit(static_cast<int>(begin), static_cast<int>(end));
    begin = nextBit(row, end, true);
  }
}

// Blocks that are the voxels that are set, each once: runs along x, joined along y and then along z where
// they are the same.
std::vector<Block> blocksOf(const VoxelBits& bits) {
  const Place size = bits.size();
  std::vector<Block> blocks;
  using Range = std::pair<int, int>;
  std::map<std::pair<Range, Range>, int> slabs;  // those that end at this z: the ranges of x and y, first z
  const auto endSlab = [&](const auto& slab, int z) {
    const auto& [ranges, first_z] = slab;
    const auto& [x, y] = ranges;
    blocks.push_back({{x.first, y.first, first_z}, {x.second, y.second, z}});
  };
  for (int z = 0; z <= size[2]; ++z) {
    std::map<std::pair<Range, Range>, int> here;
    std::map<Range, int> plates;  // those that end at this y: the range of x, first y
    for (int y = 0; z < size[2] && y <= size[1]; ++y) {
      std::map<Range, int> runs;
      if (y < size[1]) {
        forEachRun(bits.row(y, z), [&](int begin, int end) {
          const auto before = plates.find({begin, end});
          runs[{begin, end}] = before != plates.end() ? before->second : y;
        });
      }
      for (const auto& [x, first_y] : plates) {
        if (!runs.contains(x)) {
          const std::pair<Range, Range> ranges{x, {first_y, y}};
          const auto before = slabs.find(ranges);
          here[ranges] = before != slabs.end() ? before->second : z;
        }
      }
      plates = std::move(runs);
    }
    for (const auto& slab : slabs) {
      if (!here.contains(slab.first)) {
        endSlab(slab, z);
      }
    }
    slabs = std::move(here);
  }
  return blocks;
}

std::string problemWith(const FreeSpaceSettings& s, const Box& region) {
  if (!region.wellFormed()) {
    return "there is no region to search: the scene has no object with a finite box";
  }
  if (!(s.voxel >= 0.0) || !std::isfinite(s.voxel) || !(s.max_height >= 0.0)) {
    return "voxel and max_height are metres, 0 or greater";
  }
  const Vec3d extent = Vec3d(region.max) - Vec3d(region.min);
  if (s.voxel > 0.0 && voxelsOf(extent, s.voxel) > static_cast<double>(FreeSpaceSettings::kMaxVoxels)) {
    return "voxels of " + std::to_string(s.voxel) + " m would be more than " +
           std::to_string(FreeSpaceSettings::kMaxVoxels) + "; give larger ones or a smaller region";
  }
  return {};
}

double chosenVoxel(const Vec3d& extent) {
  double edge = FreeSpaceSettings::kUsualVoxel;
  while (voxelsOf(extent, edge) > static_cast<double>(FreeSpaceSettings::kMaxVoxels)) {
    edge *= 1.1;
  }
  return edge;
}

}  // namespace

std::vector<Box> boxesAlong(std::span<const Vec3d> eyes, double reach) {
  std::vector<Box> boxes;
  const auto add = [&](const Vec3d& a, const Vec3d& b) {
    Box box{Vec3f(a), Vec3f(a)};
    box.extend(Vec3f(b));
    // The reach, and what rounding to single precision moved.
    const double rounding = 0x1p-23 * maxComponent(max(abs(a), abs(b)));
    boxes.push_back(widened(box, std::max(reach, 0.0) + rounding));
  };
  const Vec3d* before = nullptr;
  for (const Vec3d& eye : eyes) {
    if (!isFinite(Vec3f(eye))) {
      continue;
    }
    if (before == nullptr) {
      add(eye, eye);
    } else {
      // Long lines in pieces, whose boxes together are smaller.
      constexpr double kMostPieces = 4096.0;
      const double far = maxComponent(abs(eye - *before));
      const double pieces = reach > 0.0 ? std::clamp(std::ceil(far / reach), 1.0, kMostPieces) : 1.0;
      for (double i = 0.0; i < pieces; ++i) {
        add(*before + (eye - *before) * (i / pieces), *before + (eye - *before) * ((i + 1.0) / pieces));
      }
    }
    before = &eye;
  }
  return boxes;
}

Result<FreeSpace> findFreeSpace(const SceneView& scene, std::span<const Vec3d> from,
                                const FreeSpaceSettings& settings, const ParallelFor& parallel_for) {
  const Box region = settings.region.empty() ? sceneBounds(scene) : settings.region;
  if (const std::string problem = problemWith(settings, region); !problem.empty()) {
    return Error{"free space: " + problem};
  }
  const double voxel =
      settings.voxel > 0.0 ? settings.voxel : chosenVoxel(Vec3d(region.max) - Vec3d(region.min));
  const Grid grid(region, voxel);
  const VoxelBits blocked = touchedByOpaque(scene, grid, parallel_for);
  VoxelBits open = blocked;
  open.invert();
  VoxelBits reached(grid.size);
  constexpr int kStartReach = 2;  // voxels
  bool any = false;
  for (const Vec3d& start : from) {
    const Place place = isFinite(start) ? grid.placeOf(start) : Place{-1, -1, -1};
    int first_ring = kStartReach;  // the first one with a free voxel
    forEachNear(place, blocked.holds(place) ? kStartReach : -1, [&](const Place& near, int ring) {
      // All of the closest free voxels, since a wall through the start's own one may have some on either
      // side.
      if (ring <= first_ring && blocked.holds(near) && !blocked.at(near)) {
        flood(near, open, reached);
        first_ring = ring;
        any = true;
      }
    });
  }
  if (!any) {
    return Error{
        "free space: no start is near a place of the region that no triangle touches; give points "
        "in the open, or smaller voxels"};
  }
  if (std::isfinite(settings.max_height)) {
    cutAbove(blocked, settings.max_height / voxel, reached);
  }
  for (const Vec3d& start : from) {
    if (isFinite(start) && reached.holds(grid.placeOf(start))) {
      reached.set(grid.placeOf(start));
    }
  }
  widen(reached);
  FreeSpace space{.boxes = {}, .voxel = voxel};
  for (const Block& block : blocksOf(reached)) {
    if (const Box box = intersection(grid.boxOf(block), region); !box.empty()) {
      space.boxes.push_back(box);
    }
  }
  return space;
}

}  // namespace sightline
