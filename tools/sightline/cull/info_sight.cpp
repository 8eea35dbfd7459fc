#include "tools/sightline/cull/info_sight.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>

#include "src/io/point_json.h"
#include "tools/sightline/bake/bake_warning.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/text_table.h"
#include "tools/sightline/input/crack_note.h"
#include "tools/sightline/input/doors.h"
#include "tools/sightline/input/points_file.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kMaxGroups = 20;          // of doors, in text; JSON has all
constexpr std::string_view kIdentifier = "SGHT";  // at byte 4 of the file
constexpr std::array<const char*, kStopReasons> kReasonKeys{"budget_met", "nothing_gained", "max_depth",
                                                            "merged", "outside"};
constexpr std::array<const char*, kStopReasons> kReasonTexts{
    "few enough triangles", "neither smaller cells nor farther occluders would hide more",
    "as deep as allowed", "eight with like sets made one", "no viewers are there"};

struct SetSize {
  double objects = 0.0, triangles = 0.0;
};

// While these doors are closed.
Result<std::vector<SetSize>> sizesOfSets(const SightFile& file, std::span<const ObjectId> closed) {
  const BoxTreeView boxes = file.boxes();
  std::vector<SetSize> sizes(file.setCount());
  const Status whole = file.forEachSet([&](std::uint32_t set, std::span<const std::uint32_t> nodes) {
    for (const std::uint32_t node : nodes) {
      sizes[set].objects += boxes.nodes[node].object_count;
      sizes[set].triangles += boxes.nodes[node].triangles;
    }
  });
  if (!whole) {
    return whole.error();
  }
  std::vector<std::uint8_t> is_seen;
  for (std::uint32_t set = 0; set < sizes.size() && !closed.empty(); ++set) {
    if (file.doors().hiddenOf(set).empty()) {
      continue;
    }
    if (const Status ok = readSeen(file, set, closed, is_seen); !ok) {
      return ok.error();
    }
    sizes[set] = {};
    for (std::uint32_t n = 0; n < boxes.nodes.size(); ++n) {
      if (boxes.leaf(n) && is_seen[boxes.nodes[n].first_object] != 0) {
        sizes[set].objects += 1.0;
        sizes[set].triangles += boxes.nodes[n].triangles;
      }
    }
  }
  return sizes;
}

// The numbers of objects and triangles that a SetSizes summarises.
struct Sizes {
  std::vector<double> objects{}, triangles{};

  void add(const SetSize& size) {
    objects.push_back(size.objects);
    triangles.push_back(size.triangles);
  }
  SetSizes facts(double all_triangles) const {
    SetSizes facts{spreadOf(objects), spreadOf(triangles), {}};
    for (const double t : triangles) {
      const double share = all_triangles > 0.0 ? t / all_triangles : 0.0;
      facts.histogram[std::min(static_cast<std::size_t>(share * kShares), kShares - 1)] += 1;
    }
    return facts;
  }
};

Json spreadJson(const Spread& spread) {
  return {{"mean", spread.mean}, {"deviation", spread.deviation}, {"min", spread.min}, {"max", spread.max}};
}

Json sizesJson(const SetSizes& sizes) {
  return {{"count", sizes.objects.count},
          {"objects", spreadJson(sizes.objects)},
          {"triangles", spreadJson(sizes.triangles)},
          {"histogram", sizes.histogram}};
}

std::string levelsText(const SightFacts& facts) {
  TextTable table{{"level", "cells", "objects", "deviation", "triangles", "deviation", "min", "max",
                   "sets by tenths of the scene's triangles"},
                  {},
                  0};
  const auto add = [&](const std::string& name, std::uint64_t cells, const SetSizes& sizes) {
    std::string bars;
    for (const std::uint64_t bar : sizes.histogram) {
      bars += (bars.empty() ? "" : " ") + std::to_string(bar);
    }
    const auto whole = [](double x) { return fmt::format("{:.0f}", x); };
    table.rows.push_back({name, std::to_string(cells), fmt::format("{:.1f}", sizes.objects.mean),
                          fmt::format("{:.1f}", sizes.objects.deviation), whole(sizes.triangles.mean),
                          whole(sizes.triangles.deviation), whole(sizes.triangles.min),
                          whole(sizes.triangles.max), bars});
  };
  for (std::size_t level = 0; level < facts.level_cells.size(); ++level) {
    if (facts.level_cells[level] > 0) {
      add(std::to_string(level), facts.level_cells[level], facts.level_sizes[level]);
    }
  }
  add("all", facts.cells, facts.sizes);
  return toText(table);
}

// The recorded settings; an empty object if they are not JSON.
Json recordedSettings(const BakeRecord& record) {
  Json settings = Json::parse(record.settings, nullptr, false);
  return settings.is_object() ? settings : Json::object();
}

// For each group of doors, of how many sets it hides something.
std::vector<std::uint64_t> setsOfGroups(const DoorsView& doors) {
  std::vector<std::uint64_t> sets(doors.groupCount(), 0);
  for (const DoorSet& hidden : doors.hidden) {
    sets[hidden.group] += 1;
  }
  return sets;
}

Json doorsJson(const SightFile& file) {
  const DoorsView doors = file.doors();
  const std::vector<std::uint64_t> sets = setsOfGroups(doors);
  Json groups = Json::array();
  for (std::uint32_t group = 0; group < doors.groupCount(); ++group) {
    std::vector<std::uint32_t> objects;
    for (const ObjectId door : doors.doorsOf(group)) {
      objects.push_back(door.value);
    }
    groups.push_back({{"objects", objects}, {"of_sets", sets[group]}});
  }
  return groups;
}

Json recordJson(const SightFile& file) {
  const BakeRecord& record = file.record();
  return {{"triangle_budget", record.triangle_budget},
          {"depth", record.max_depth},
          {"near_distance", record.near_distance},
          {"all", recordedSettings(record)}};
}

void print(const std::string& name, const SightFile& file, const SightFacts& facts) {
  const SceneId& scene = file.scene();
  const BakeRecord& record = file.record();
  const Vec3d min = file.octree().min + originOf(record), max = file.octree().max + originOf(record);
  fmt::print("file          {} ({} bytes)\n", name, file.fileBytes());
  fmt::print("scene         {:016x}, {} objects, {} triangles\n", scene.hash, scene.objects, scene.triangles);
  fmt::print("{}", cracksText(file));
  fmt::print("octree        from {:.3f} {:.3f} {:.3f}\n", min.x, min.y, min.z);
  fmt::print("              to   {:.3f} {:.3f} {:.3f}\n", max.x, max.y, max.z);
  fmt::print("              for viewers whose near plane clips nothing beyond {} m of the eye\n",
             record.near_distance);
  fmt::print("settings      {}\n", dump(recordedSettings(record)));
  fmt::print("{}", factsText(facts));
  if (const std::string warning = bakeWarning(file, facts); !warning.empty()) {
    fmt::print("warning       {}\n", warning);
  }
  fmt::print("sets          {} different ones, of a tree of {} boxes\n", file.setCount(),
             file.boxes().nodes.size());
  fmt::print("{}", doorsText(file));
  for (const SightFile::Section& section : file.sections()) {
    fmt::print("section       {:<24}{:12} bytes, {:12} before compression\n", section.name, section.bytes,
               section.raw_bytes);
  }
  const std::vector<std::string> databases = file.databaseNames();
  for (const std::string& database : databases) {
    fmt::print("database      {}\n", database);
  }
  if (databases.empty()) {
    fmt::print("databases     none\n");
  }
}

}  // namespace

Spread spreadOf(const std::vector<double>& values) {
  Spread spread;
  spread.count = values.size();
  if (values.empty()) {
    return spread;
  }
  const double n = static_cast<double>(values.size());
  for (const double value : values) {
    spread.mean += value / n;
  }
  for (const double value : values) {
    spread.deviation += (value - spread.mean) * (value - spread.mean) / n;
  }
  spread.deviation = std::sqrt(spread.deviation);
  spread.min = *std::min_element(values.begin(), values.end());
  spread.max = *std::max_element(values.begin(), values.end());
  return spread;
}

Result<SightFacts> factsOf(const SightFile& file, std::span<const ObjectId> closed) {
  const Result<std::vector<SetSize>> sets = sizesOfSets(file, closed);
  if (!sets) {
    return sets.error();
  }
  const OctreeView octree = file.octree();
  SightFacts facts;
  Sizes all;
  std::vector<Sizes> levels(kMaxOctreeDepth + 1);
  facts.level_cells.resize(levels.size());
  double volume = 0.0;  // of cells where viewers are, as a share of the root's
  forEachLeaf(octree, [&](std::uint32_t index, const OctreeCell& cell) {
    facts.cells += 1;
    facts.level_cells[cell.level] += 1;
    facts.deepest = std::max(facts.deepest, cell.level);
    facts.reasons[std::min<std::size_t>(octree.reasons[index], kStopReasons - 1)] += 1;
    if (static_cast<StopReason>(octree.reasons[index]) == StopReason::kOutside) {
      return;
    }
    const OctreeLeaf& leaf = octree.leaves[index];
    const bool divided = leaf.plane != OctreeLeaf::kNoPlane;
    std::vector<std::uint32_t> sides{leaf.set};
    if (divided) {
      sides = {leaf.front_set, leaf.back_set};
      // A side with an empty set has no viewers.
      std::erase_if(sides, [&](std::uint32_t set) { return (*sets)[set].objects == 0.0; });
    }
    double triangles = 0.0;
    for (const std::uint32_t set : sides) {
      levels[cell.level].add((*sets)[set]);
      all.add((*sets)[set]);
      triangles += (*sets)[set].triangles / static_cast<double>(sides.size());
    }
    const double part = std::ldexp(volumeOf(octree.viewersOf(index)), -3 * static_cast<int>(cell.level));
    facts.mean_triangles_by_volume += triangles * part;
    facts.reason_volumes[std::min<std::size_t>(octree.reasons[index], kStopReasons - 1)] += part;
    volume += part;
    facts.cells_with_plane += divided ? 1 : 0;
    facts.partial_cells += octree.viewersOf(index) != ViewerBounds{} ? 1 : 0;
  });
  facts.mean_triangles_by_volume /= volume > 0.0 ? volume : 1.0;
  for (double& part : facts.reason_volumes) {
    part /= volume > 0.0 ? volume : 1.0;
  }
  facts.level_cells.resize(facts.deepest + 1);
  const double all_triangles = static_cast<double>(file.scene().triangles);
  for (std::uint32_t level = 0; level <= facts.deepest; ++level) {
    facts.level_sizes.push_back(levels[level].facts(all_triangles));
  }
  facts.sizes = all.facts(all_triangles);
  facts.grid_cells = facts.cells > 0 ? std::uint64_t{1} << (3 * facts.deepest) : 0;
  return facts;
}

Json factsJson(const SightFacts& facts) {
  Json levels = Json::array(), reasons;
  for (std::size_t level = 0; level < facts.level_cells.size(); ++level) {
    levels.push_back({{"level", level},
                      {"cells", facts.level_cells[level]},
                      {"sets", sizesJson(facts.level_sizes[level])}});
  }
  for (std::size_t reason = 0; reason < kStopReasons; ++reason) {
    reasons[kReasonKeys[reason]] = facts.reasons[reason];
  }
  return {{"cells", facts.cells},
          {"deepest_level", facts.deepest},
          {"grid_cells", facts.grid_cells},
          {"stop_reasons", reasons},
          {"cells_with_plane", facts.cells_with_plane},
          {"partial_cells", facts.partial_cells},
          {"sets", sizesJson(facts.sizes)},
          {"mean_triangles_by_volume", facts.mean_triangles_by_volume},
          {"levels", levels}};
}

std::string factsText(const SightFacts& facts) {
  std::string text = fmt::format("cells         {}; a uniform grid of the smallest would have {}\n",
                                 facts.cells, facts.grid_cells);
  for (std::size_t reason = 0; reason < kStopReasons; ++reason) {
    if (facts.reasons[reason] > 0) {
      text += fmt::format("              {:10} not divided further: {}\n", facts.reasons[reason],
                          kReasonTexts[reason]);
    }
  }
  text +=
      fmt::format("              {:10} divided by a plane: a set on either side\n", facts.cells_with_plane);
  if (facts.partial_cells > 0) {
    text +=
        fmt::format("              {:10} with viewers in a part: a set there, and all objects elsewhere\n",
                    facts.partial_cells);
  }
  text += fmt::format("from anywhere {:10.0f} triangles, mean over the viewers' space\n",
                      facts.mean_triangles_by_volume);
  return text + levelsText(facts);
}

Vec3d originOf(const BakeRecord& record) {
  const Json settings = recordedSettings(record);
  return settings.contains("origin") ? io::pointOf(settings["origin"]).value_or(Vec3d()) : Vec3d();
}

std::optional<OccluderFacts> occludersOf(const BakeRecord& record) {
  const Json settings = recordedSettings(record);
  const auto numberIn = [](const Json& json, const char* key) {
    return json.contains(key) && json[key].is_number() ? std::optional(json[key].get<double>())
                                                       : std::nullopt;
  };
  if (!settings.contains("occluders") || !settings["occluders"].is_object()) {
    return std::nullopt;
  }
  const Json& occluders = settings["occluders"];
  const auto inner = numberIn(occluders, "inner"), of_use = numberIn(occluders, "of_use"),
             area = numberIn(occluders, "largest_area"), size = numberIn(settings, "occluder_size");
  if (!inner || !of_use || !area || !size) {
    return std::nullopt;
  }
  return OccluderFacts{.none = *inner < 1.0,
                       .none_of_use = *of_use < 1.0,
                       .largest_area = *area,
                       .size = *size,
                       .alone = settings.value("occlusion", Json()) != "fused"};
}

std::string cracksText(const SightFile& file) {
  const CrackNote cracks = cracksOf(file.record());
  return cracks.width > 0.0 ? fmt::format("cracks        closed by{}\n", crackText(cracks)) : "";
}

std::string doorsText(const SightFile& file) {
  const DoorsView doors = file.doors();
  const std::vector<std::uint64_t> sets = setsOfGroups(doors);
  std::string text;
  for (std::uint32_t group = 0; group < doors.groupCount() && group < kMaxGroups; ++group) {
    std::string objects;
    for (const ObjectId door : doors.doorsOf(group)) {
      objects += (objects.empty() ? "" : " ") + std::to_string(door.value);
    }
    text += fmt::format("doors         {} hide{} something of {} sets\n", objects,
                        doors.doorsOf(group).size() > 1 ? " together" : "s", sets[group]);
  }
  if (doors.groupCount() > kMaxGroups) {
    text += fmt::format("              and {} more groups of doors; --json lists all\n",
                        doors.groupCount() - kMaxGroups);
  }
  return text;
}

Json bakedSceneJson(const SightFile& file) {
  Json json = {{"objects", file.scene().objects}, {"triangles", file.scene().triangles}};
  addCracks(json, cracksOf(file.record()));
  return json;
}

Json sightJson(const SightFile& file, const SightFacts& facts) {
  Json sections = Json::array();
  for (const SightFile::Section& section : file.sections()) {
    sections.push_back({{"name", section.name}, {"bytes", section.bytes}, {"raw_bytes", section.raw_bytes}});
  }
  const OctreeView octree = file.octree();
  const Vec3d min = octree.min + originOf(file.record()), max = octree.max + originOf(file.record());
  Json of_scene = bakedSceneJson(file);
  of_scene["hash"] = fmt::format("{:016x}", file.scene().hash);
  Json json = {{"scene", of_scene},
               {"bytes", file.fileBytes()},
               {"settings", recordJson(file)},
               {"min", io::pointJson(min)},
               {"max", io::pointJson(max)},
               {"different_sets", file.setCount()},
               {"boxes", file.boxes().nodes.size()},
               {"planes", octree.planes.size()}};
  json.update(factsJson(facts));
  const std::string warning = bakeWarning(file, facts);
  json["warning"] = warning.empty() ? Json() : Json(warning);
  if (const Json doors = doorsJson(file); !doors.empty()) {
    json["doors"] = doors;
  }
  json["sections"] = sections;
  json["databases"] = file.databaseNames();
  return json;
}

bool beginsAsSightFile(const std::string& name) {
  std::array<char, 8> start{};
  std::ifstream stream(name, std::ios::binary);
  return stream.read(start.data(), start.size()) &&
         std::string_view(start.data() + 4, kIdentifier.size()) == kIdentifier;
}

bool isSightFile(const std::string& name) {
  return name.ends_with(".sight") || beginsAsSightFile(name);
}

Status informOnSight(const std::string& name, const std::string& closed, const std::string& json_target) {
  const Result<SightFile> file = SightFile::open(name);
  if (!file) {
    return file.error();
  }
  if (const Status whole = file->verifyAll(); !whole) {
    return whole;
  }
  const Result<std::vector<ObjectId>> doors = closedDoors(closed, *file, name);
  if (!doors) {
    return doors.error();
  }
  const Result<SightFacts> facts = factsOf(*file, *doors);
  if (!facts) {
    return facts.error();
  }
  if (!json_target.empty()) {
    if (const Status ok = writeOutput(json_target, dump(sightJson(*file, *facts))); !ok) {
      return ok;
    }
  }
  if (json_target != "-") {
    print(name, *file, *facts);
  }
  return Success{};
}

}  // namespace sightline::tool
