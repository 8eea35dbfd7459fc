#include "tools/sightline/bake/viewer_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <utility>

#include "sightline/pvs/bake/viewer_space.h"
#include "src/math/outer_box.h"
#include "tools/sightline/command_line/parse_text.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {
namespace {

constexpr double kMaxReach = 1e6, kMinVoxel = 1e-3;  // metres
constexpr double kUsualReach = 1.0;                  // metres

// The six numbers of a region; none if the text is none.
std::vector<double> parseRegion(const std::string& text) {
  std::vector<double> numbers = parseDecimals(text, 6);
  for (std::size_t axis = 0; axis < 3 && !numbers.empty(); ++axis) {
    if (!(numbers[axis] < numbers[axis + 3])) {
      numbers.clear();
    }
  }
  return numbers;
}

// The box in scene space, rounded outwards.
Box boxOf(const std::vector<double>& region, const Vec3d& origin) {
  return math::outerBox(Vec3d(region[0], region[1], region[2]) - origin,
                        Vec3d(region[3], region[4], region[5]) - origin);
}

std::vector<Box> regionsOf(const ViewerOptions& options, const Vec3d& origin) {
  std::vector<Box> regions;
  for (const std::string& text : options.regions) {
    regions.push_back(boxOf(parseRegion(text), origin));
  }
  return regions;
}

// What the boxes have in common with the regions; the boxes themselves if there are no regions.
std::vector<Box> within(const std::vector<Box>& regions, std::vector<Box> boxes) {
  if (regions.empty()) {
    return boxes;
  }
  std::vector<Box> common;
  for (const Box& region : regions) {
    for (const Box& box : boxes) {
      if (overlaps(region, box)) {
        common.push_back(intersection(region, box));
      }
    }
  }
  return common;
}

Box around(const std::vector<Box>& boxes) {
  Box bounds;
  for (const Box& box : boxes) {
    bounds.extend(box);
  }
  return bounds;
}

// The points that the options name, scene space.
Result<std::vector<Vec3d>> eyesOf(const ViewerOptions& options, const std::string& scene_name,
                                  const Scene& scene) {
  std::vector<Vec3d> eyes;
  for (const std::string& text : options.from) {
    eyes.push_back(*parsePoint(text) - scene.origin);
  }
  if (options.usesPath()) {
    const Result<Walk> walk = loadWalk(options.path, scene_name, scene);
    if (!walk) {
      return walk.error();
    }
    for (const std::uint32_t frame : walk->frames) {
      eyes.push_back(walk->view(frame, scene).eye);
    }
  }
  return eyes;
}

Result<ViewerSpace> freeSpace(const ViewerOptions& options, const std::vector<Box>& regions,
                              const std::vector<Vec3d>& eyes, const Scene& scene,
                              const ParallelFor& parallel_for) {
  FreeSpaceSettings settings{.voxel = options.voxel.value_or(0.0), .region = around(regions)};
  if (options.max_height.value_or(0.0) > 0.0) {
    settings.max_height = *options.max_height;
  }
  Result<FreeSpace> space = findFreeSpace(scene.view(), eyes, settings, parallel_for);
  if (!space) {
    return space.error();
  }
  return ViewerSpace{.boxes = std::move(space->boxes),
                     .facts = {{"voxel", space->voxel}, {"max_height", options.max_height.value_or(0.0)}}};
}

}  // namespace

void addViewerOptions(CLI::App& command, ViewerOptions& options) {
  command
      .add_option("--viewers", options.where,
                  "everywhere: viewers may be anywhere in the region; path: within --reach of the camera "
                  "path; free: where one gets from the camera path, or from the points of --from, without "
                  "going through opaque triangles. Cells elsewhere are not baked: all may be seen from them")
      ->check(isOneOf({"everywhere", "path", "free"}, false))
      ->capture_default_str();
  command
      .add_option("--region", options.regions,
                  "viewers are in this box, world space: MINX,MINY,MINZ,MAXX,MAXY,MAXZ (default: the scene's "
                  "bounds); may be given several times")
      ->allow_extra_args(false);
  addPathOptions(command, options.path);
  command
      .add_option("--from", options.from,
                  "a point X,Y,Z in world space from which --viewers free starts; may be given several times")
      ->allow_extra_args(false);
  addDecimalOption(
      command, "--reach", options.reach, 0.0, kMaxReach,
      fmt::format("metres from the camera path, for --viewers path (default: {:g})", kUsualReach));
  addDecimalOption(command, "--max-height", options.max_height, 0.0, kMaxReach,
                   "metres above the ground, for --viewers free; 0: any (default: 0)");
  addDecimalOption(command, "--voxel", options.voxel, kMinVoxel, kMaxReach,
                   fmt::format("metres: the edge of the grid of --viewers free; gaps narrower than two may "
                               "count as closed (default: {:g}, or more where the region is large)",
                               FreeSpaceSettings::kUsualVoxel));
}

Status checkViewerOptions(const ViewerOptions& options) {
  for (const std::string& text : options.regions) {
    if (parseRegion(text).empty()) {
      return Error{fmt::format(
          "--region {}: give MINX,MINY,MINZ,MAXX,MAXY,MAXZ in metres, each MIN less than its MAX", text)};
    }
  }
  for (const std::string& text : options.from) {
    if (!parsePoint(text)) {
      return Error{fmt::format("--from {}: give X,Y,Z in metres", text)};
    }
  }
  const bool free = options.where == "free";
  const auto misplaced = [](const char* option, const char* where) {
    return Error{fmt::format("{}: has a meaning only with --viewers {}", option, where)};
  };
  if (options.reach && options.where != "path") {
    return misplaced("--reach", "path");
  }
  if (!options.from.empty() && !free) {
    return misplaced("--from", "free");
  }
  if (options.voxel && !free) {
    return misplaced("--voxel", "free");
  }
  if (options.max_height && !free) {
    return misplaced("--max-height", "free");
  }
  const bool has_path = !options.path.path.empty() || !options.path.frames.empty();
  if (has_path && options.where == "everywhere") {
    return misplaced(options.path.path.empty() ? "--frames" : "--path", "path or free");
  }
  if (has_path && !options.usesPath()) {
    return Error{"--from: are the points to start from, and --path has others; give one of them"};
  }
  return Success{};
}

Json ViewerSpace::regionJson(const Vec3d& origin) const {
  if (boxes.empty()) {
    return {};
  }
  const Box box = around(boxes);
  const Vec3d min = Vec3d(box.min) + origin, max = Vec3d(box.max) + origin;
  return {min.x, min.y, min.z, max.x, max.y, max.z};
}

Result<ViewerSpace> findViewers(const ViewerOptions& options, const std::string& scene_name,
                                const Scene& scene, const ParallelFor& parallel_for) {
  const std::vector<Box> regions = regionsOf(options, scene.origin);
  if (options.where == "everywhere" && regions.empty()) {
    return ViewerSpace{};
  }
  ViewerSpace viewers{.boxes = regions, .facts = Json::object()};
  if (options.where != "everywhere") {
    const Result<std::vector<Vec3d>> eyes = eyesOf(options, scene_name, scene);
    if (!eyes) {
      return eyes.error();
    }
    if (options.where == "path") {
      const double reach = options.reach.value_or(kUsualReach);
      viewers = {.boxes = boxesAlong(*eyes, reach), .facts = {{"reach", reach}}};
    } else {
      Result<ViewerSpace> found = freeSpace(options, regions, *eyes, scene, parallel_for);
      if (!found) {
        return found.error();
      }
      viewers = std::move(*found);
    }
    viewers.boxes = within(regions, std::move(viewers.boxes));
    if (viewers.boxes.empty()) {
      return Error{fmt::format("--viewers {}: nothing of that is in the --region", options.where)};
    }
  }
  viewers.facts["where"] = options.where;
  viewers.facts["boxes"] = viewers.boxes.size();
  return viewers;
}

}  // namespace sightline::tool
