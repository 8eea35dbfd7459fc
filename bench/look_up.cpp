// What does a look-up in a baked file cost? An octree of depth 6 with 20,000 cells and 5,000 different sets
// of about 300 nodes over 20,000 objects, all made up; or a file. In the same run, on the same viewpoints:
//
//   find      SetQuery, from the cell of the last viewpoint on
//   closed    the same with all doors of the file closed
//   descent   from the root down for each viewpoint, comparing with the same grid lines
//   bits      what sets of the usual kind cost: a bit for each object, uncompressed; beside for its size, and
//             for the time to gather the objects' numbers from the bits
//
//   look_up [FILE.sight]

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "bench/measuring.h"
#include "sightline/pvs/bake/write_sight.h"
#include "sightline/pvs/query/set_query.h"
#include "tests/support/made_visibility.h"

namespace {

using namespace sightline;
using namespace sightline::bench;
namespace fs = std::filesystem;

constexpr std::size_t kEyes = 200'000;

// Viewpoints one step apart, turning a little with each, reflected at the borders of [min, max].
std::vector<Vec3d> walk(const Vec3d& min, const Vec3d& max, double step) {
  made::Random random(5);
  std::vector<Vec3d> eyes;
  Vec3d eye = (min + max) * 0.5, direction{1, 0, 0};
  while (eyes.size() < kEyes) {
    direction = normalized(direction + made::point(random, {-0.2, -0.2, -0.2}, {0.2, 0.2, 0.2}));
    eye += direction * step;
    for (int axis = 0; axis < 3; ++axis) {
      if (eye[axis] < min[axis] || eye[axis] > max[axis]) {
        direction[axis] = -direction[axis];
        eye[axis] = std::clamp(eye[axis], min[axis], max[axis]);
      }
    }
    eyes.push_back(eye);
  }
  return eyes;
}

std::vector<Vec3d> jumps(const Vec3d& min, const Vec3d& max) {
  made::Random random(6);
  std::vector<Vec3d> eyes(kEyes);
  std::generate(eyes.begin(), eyes.end(), [&] { return made::point(random, min, max); });
  return eyes;
}

// The alternative to starting from the last cell.
std::uint32_t descend(const OctreeView& octree, const Vec3d& eye) {
  OctreeCell cell;
  OctreeLink link = octree.nodes[0];
  while ((link & kOctreeLeaf) == 0) {
    std::uint32_t child = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint32_t middle = cell.at[static_cast<std::size_t>(axis)] * 2 + 1;
      const double line = gridLine(octree.min[axis], octree.max[axis], cell.level + 1, middle);
      child |= (eye[axis] >= line ? 1u : 0u) << axis;
    }
    cell = cell.child(child);
    link = octree.nodes[link + child];
  }
  return link & ~kOctreeLeaf;
}

// The fastest of some rounds over all viewpoints, nanoseconds each.
double nanoseconds(std::size_t count, const auto& round) {
  double best = 1e300;
  for (int i = 0; i < 7; ++i) {
    best = std::min(best, microseconds(round) * 1000.0 / static_cast<double>(count));
  }
  return best;
}

void measureFinds(const SightFile& file, const char* name, const std::vector<Vec3d>& eyes) {
  SetQuery query(file, {.cache_bytes = std::size_t{1} << 30});  // all sets stay decoded
  const OctreeView octree = file.octree();
  const double near = file.record().near_distance;
  std::uint64_t sum = 0;
  const auto findAll = [&] {
    for (const Vec3d& eye : eyes) {
      sum += query.find(eye, near).nodes.size();
    }
  };
  findAll();
  const SetQueryStats before = query.stats();
  findAll();
  const double same =
      static_cast<double>(query.stats().same_cell - before.same_cell) / static_cast<double>(eyes.size());
  const double find_ns = nanoseconds(eyes.size(), findAll);
  const double locate_ns = nanoseconds(eyes.size(), [&] {
    for (const Vec3d& eye : eyes) {
      sum += query.locate(eye).leaf;
    }
  });
  const double descent_ns = nanoseconds(eyes.size(), [&] {
    for (const Vec3d& eye : eyes) {
      sum += descend(octree, eye);
    }
  });
  const std::vector<ObjectId> doors = allDoors(file.doors());
  query.setClosedDoors(doors);
  findAll();
  const std::string closed = doors.empty() ? "-" : fmt::format("{:.1f}", nanoseconds(eyes.size(), findAll));
  fmt::print("{:<24} {:>10.1f} {:>9.1f} {:>9} {:>9.1f} {:>9.1f} {:>12}\n", name, 100.0 * (1.0 - same),
             find_ns, closed, locate_ns, descent_ns, sum % 10);
}

void measureFinds(const SightFile& file) {
  const OctreeView octree = file.octree();
  const Vec3d extent = octree.max - octree.min;
  const double cell = maxComponent(extent) / 64.0;
  const Vec3d middle = (octree.min + octree.max) * 0.5;
  // One cell: the smallest at the middle of the scene.
  SetQuery query(file);
  const OctreeCell place = query.locate(middle).cell;
  fmt::print("{:<24} {:>10} {:>9} {:>9} {:>9} {:>9} {:>12}\n", "viewpoints", "new cell %", "find ns",
             "closed", "cell ns", "descent", "(checksum)");
  const Vec3d min = cellMin(octree.min, octree.max, place), max = cellMax(octree.min, octree.max, place);
  measureFinds(file, "within a cell", walk(min, max - (max - min) * 0.01, cell / 50));
  measureFinds(file, "a walk, 1/50 of a cell", walk(octree.min, octree.max, cell / 50));
  measureFinds(file, "a run, 1/4 of a cell", walk(octree.min, octree.max, cell / 4));
  measureFinds(file, "jumps", jumps(octree.min, octree.max));
}

// Each set once, in an order in which none finds its chunk decompressed.
void measureDecoding(const SightFile& file) {
  std::vector<std::uint32_t> leaves(file.octree().leaves.size());
  std::vector<Vec3d> eyes(leaves.size());
  forEachLeaf(file.octree(), [&](std::uint32_t leaf, const OctreeCell& cell) {
    const OctreeView octree = file.octree();
    leaves[leaf] = leaf;
    eyes[leaf] = (cellMin(octree.min, octree.max, cell) + cellMax(octree.min, octree.max, cell)) * 0.5;
  });
  std::shuffle(leaves.begin(), leaves.end(), std::mt19937(3));
  SetQuery query(file);
  std::vector<double> times;
  double nodes = 0.0;
  for (const std::uint32_t leaf : leaves) {
    const std::uint64_t decoded = query.stats().decoded;
    VisibleSet set;
    const double us = microseconds([&] { set = query.find(eyes[leaf], file.record().near_distance); });
    if (query.stats().decoded != decoded) {
      times.push_back(us);
      nodes += static_cast<double>(set.nodes.size());
    }
  }
  std::sort(times.begin(), times.end());
  fmt::print("decoding a set: median {:.2f} us, 99% below {:.2f} us ({} sets of {:.0f} nodes)\n",
             medianOf(times), times[times.size() * 99 / 100], times.size(),
             nodes / static_cast<double>(times.size()));
}

// A bit for each object, and the numbers of the objects from it.
void measureBits(const SightFile& file) {
  const std::size_t words = (file.boxes().objects.size() + 63) / 64;
  const std::uint32_t sets = std::min(file.setCount(), 2000u);
  std::vector<std::uint64_t> bits(words * sets);
  SetQuery query(file);
  for (std::uint32_t set = 0; set < sets; ++set) {
    std::vector<std::uint32_t> nodes;
    if (!file.readSet(set, nodes)) {
      return;
    }
    for (const std::uint32_t node : nodes) {
      for (const ObjectId object : file.boxes().objectsBelow(node)) {
        bits[set * words + object.value / 64] |= std::uint64_t{1} << object.value % 64;
      }
    }
  }
  std::vector<std::uint32_t> objects;
  std::size_t sum = 0;
  const double ns = nanoseconds(sets, [&] {
    for (std::uint32_t set = 0; set < sets; ++set) {
      objects.clear();
      for (std::size_t word = 0; word < words; ++word) {
        for (std::uint64_t rest = bits[set * words + word]; rest != 0; rest &= rest - 1) {
          objects.push_back(static_cast<std::uint32_t>(word * 64) +
                            static_cast<std::uint32_t>(std::countr_zero(rest)));
        }
      }
      sum += objects.size();
    }
  });
  fmt::print("bits: {:.0f} bytes a set, {:.2f} us to gather its {:.0f} objects\n",
             static_cast<double>(words * 8), ns * 1e-3, static_cast<double>(sum) / 7.0 / sets);
}

void printSections(const SightFile& file) {
  fmt::print("{:<24} {:>12} {:>12}\n", "section", "bytes", "raw");
  for (const SightFile::Section& section : file.sections()) {
    fmt::print("{:<24} {:>12} {:>12}\n", section.name, section.bytes, section.raw_bytes);
  }
  fmt::print("{:<24} {:>12}; {:.0f} bytes a set\n", "file", file.fileBytes(),
             static_cast<double>(file.sections()[3].bytes) / file.setCount());
}

int measure(const std::string& name) {
  const Result<SightFile> file = SightFile::open(name);
  if (!file) {
    fmt::print(stderr, "{}\n", file.error().message);
    return 2;
  }
  std::vector<double> opening;
  for (int i = 0; i < 20; ++i) {
    opening.push_back(microseconds([&] { (void)SightFile::open(name); }));
  }
  fmt::print("opening {:.1f} MB: {:.2f} ms\n", static_cast<double>(file->fileBytes()) * 1e-6,
             medianOf(opening) * 1e-3);
  printSections(*file);
  measureFinds(*file);
  measureDecoding(*file);
  measureBits(*file);
  return 0;
}

// Where made-up files are written; gone in the end.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / fmt::format("sightline-look-up-{}", std::random_device()())) {
    fs::create_directories(path_);
  }
  ~Folder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string file(const char* name) const { return (path_ / name).string(); }

 private:
  fs::path path_;
};

int writeAndMeasure(const Folder& folder, const char* name, const made::Visibility& settings,
                    const auto& look) {
  const BakedVisibility baked = made::visibility(settings);
  Status written = Success{};
  const double us = microseconds([&] { written = writeSight(folder.file(name), baked); });
  if (!written) {
    fmt::print(stderr, "{}\n", written.error().message);
    return 2;
  }
  fmt::print("{}: {} objects, {} cells, {} sets; written in {:.1f} s\n", name, settings.objects,
             baked.octree.leaves.size(), settings.sets, us * 1e-6);
  return look(folder.file(name));
}

int measureOpening(const std::string& name) {
  std::vector<double> times;
  double megabytes = 0.0;
  for (int i = 0; i < 20; ++i) {
    times.push_back(microseconds([&] {
      const Result<SightFile> file = SightFile::open(name);
      megabytes = file ? static_cast<double>(file->fileBytes()) * 1e-6 : 0.0;
    }));
  }
  fmt::print("opening {:.1f} MB: {:.2f} ms\n", megabytes, medianOf(times) * 1e-3);
  return megabytes > 0.0 ? 0 : 2;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments arguments = argumentsOf(argc, argv);
  if (!arguments.words.empty()) {
    return measure(arguments.words[0]);
  }
  const Folder folder;
  const int made = writeAndMeasure(folder, "made.sight",
                                   {.objects = 20'000,
                                    .leaves = 20'000,
                                    .depth = 6,
                                    .sets = 5'000,
                                    .set_nodes = 300,
                                    .plane_every = 10,
                                    .database_bytes = {}},
                                   measure);
  if (made != 0 || arguments.brief) {
    return made;
  }
  return writeAndMeasure(folder, "large.sight",
                         {.objects = 100'000,
                          .leaves = 200'000,
                          .depth = 8,
                          .sets = 60'000,
                          .set_nodes = 1'000,
                          .plane_every = 10,
                          .database_bytes = {80'000'000}},
                         measureOpening);
}
