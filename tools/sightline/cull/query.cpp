// sightline query: lists what may be visible from points, by a baked file alone.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <memory>
#include <optional>

#include "sightline/io/file.h"
#include "sightline/pvs/query/set_query.h"
#include "src/io/point_json.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/command_line/parse_text.h"
#include "tools/sightline/command_line/text_table.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/cull/info_sight.h"
#include "tools/sightline/input/doors.h"
#include "tools/sightline/input/points_file.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kMaxRows = 50;  // rows on the terminal; JSON has all

struct QueryOptions {
  std::string file, json, closed;
  std::vector<std::string> points;  // files and points written as text
};

// The answer for one point.
struct PointAnswer {
  Vec3d point;  // world space
  CellPlace place;
  const char* side = nullptr;  // the side of the cell's plane, if the cell has one
  std::uint64_t triangles = 0;
  std::vector<std::uint32_t> visible;  // ascending

  bool outside() const { return place.leaf == CellPlace::kOutside; }
  // False where everything may be seen because no viewers were expected there.
  bool hasSet() const { return !outside() && place.set != VisibleSet::kEverything; }
};

Result<std::vector<Vec3d>> pointsOfFile(const std::string& name) {
  const Result<std::string> text = readFile(name);
  if (!text) {
    return text.error();
  }
  return parsePointsFile(*text, name);
}

Result<std::vector<Vec3d>> allPoints(const std::vector<std::string>& texts) {
  std::vector<Vec3d> points;
  for (const std::string& text : texts) {
    if (const std::optional<Vec3d> point = parsePoint(text)) {
      points.push_back(*point);
      continue;
    }
    // A file's name may contain commas, but a text that names no file is more likely a point.
    const Result<std::vector<Vec3d>> more = pointsOfFile(text);
    if (!more && splitAt(text, ',').size() > 1) {
      return Error{fmt::format("--points {}: is neither a point X,Y,Z in metres nor a file", text)};
    }
    if (!more) {
      return more.error();
    }
    points.insert(points.end(), more->begin(), more->end());
  }
  if (points.empty()) {
    return Error{"--points: there are none; give X,Y,Z, a file of points or a camera path"};
  }
  return points;
}

const char* nameOf(CellSide side) {
  return side == CellSide::kFront ? "front" : side == CellSide::kBack ? "back" : "between";
}

PointAnswer answerOf(const Vec3d& point, const Vec3d& origin, const SightFile& file, SetQuery& query) {
  const Vec3d eye = point - origin;
  PointAnswer answer{point, query.locate(eye)};
  const OctreeView octree = file.octree();
  if (!answer.outside() && octree.leaves[answer.place.leaf].plane != OctreeLeaf::kNoPlane) {
    answer.side = nameOf(sideOf(octree.planes[octree.leaves[answer.place.leaf].plane], eye));
  }
  const BoxTreeView boxes = query.boxes();
  for (const std::uint32_t node : query.find(eye, file.record().near_distance).nodes) {
    answer.triangles += boxes.nodes[node].triangles;
    for (const ObjectId object : boxes.objectsBelow(node)) {
      answer.visible.push_back(object.value);
    }
  }
  std::sort(answer.visible.begin(), answer.visible.end());
  return answer;
}

std::string answerJson(const PointAnswer& answer) {
  const bool inside = !answer.outside();
  return dump({{"point", io::pointJson(answer.point)},
               {"cell", inside ? Json(answer.place.leaf) : Json()},
               {"level", inside ? Json(answer.place.cell.level) : Json()},
               {"side", answer.side != nullptr ? Json(answer.side) : Json()},
               {"set", answer.hasSet() ? Json(answer.place.set) : Json()},
               {"triangles", answer.triangles},
               {"visible", answer.visible}});
}

std::size_t outsideCount(const std::vector<PointAnswer>& answers) {
  return static_cast<std::size_t>(std::count_if(answers.begin(), answers.end(),
                                                [](const PointAnswer& answer) { return answer.outside(); }));
}

std::string toJson(const SightFile& file, const std::vector<PointAnswer>& answers) {
  std::vector<std::string> items;
  for (const PointAnswer& answer : answers) {
    items.push_back(answerJson(answer));
  }
  const Json head = {{"scene", bakedSceneJson(file)}, {"outside", outsideCount(answers)}};
  return dumpWithList(head, "points", items);
}

void print(const SightFile& file, const std::vector<PointAnswer>& answers) {
  TextTable table{{"point", "cell", "level", "side", "objects", "triangles"}, {}, 1};
  std::vector<double> objects, triangles;
  std::vector<std::uint32_t> cells;
  for (const PointAnswer& answer : answers) {
    objects.push_back(static_cast<double>(answer.visible.size()));
    triangles.push_back(static_cast<double>(answer.triangles));
    if (!answer.outside()) {
      cells.push_back(answer.place.leaf);
    }
    if (table.rows.size() < kMaxRows) {
      const Vec3d& p = answer.point;
      table.rows.push_back({fmt::format("{:.3f} {:.3f} {:.3f}", p.x, p.y, p.z),
                            answer.outside() ? "outside" : std::to_string(answer.place.leaf),
                            answer.outside() ? "" : std::to_string(answer.place.cell.level),
                            answer.side != nullptr ? answer.side : "", std::to_string(answer.visible.size()),
                            std::to_string(answer.triangles)});
    }
  }
  fmt::print("{}", toText(table));
  if (answers.size() > kMaxRows) {
    fmt::print("... and {} more points; --json lists all\n", answers.size() - kMaxRows);
  }
  std::sort(cells.begin(), cells.end());
  const auto different = std::unique(cells.begin(), cells.end()) - cells.begin();
  const Spread o = spreadOf(objects), t = spreadOf(triangles);
  fmt::print("{} points in {} cells; of {} objects with {} triangles:\n{}", answers.size(), different,
             file.scene().objects, file.scene().triangles, cracksText(file));
  fmt::print("  objects    mean {:.1f}, deviation {:.1f}, from {:.0f} to {:.0f}\n", o.mean, o.deviation,
             o.min, o.max);
  fmt::print("  triangles  mean {:.1f}, deviation {:.1f}, from {:.0f} to {:.0f}\n", t.mean, t.deviation,
             t.min, t.max);
  if (const std::size_t outside = outsideCount(answers); outside > 0) {
    fmt::print("{} points are outside the baked cells: there, everything may be seen\n", outside);
  }
}

Result<ExitCode> runQuery(const QueryOptions& options) {
  std::vector<NamedFile> inputs{{"FILE", options.file}};
  for (const std::string& points : options.points) {
    inputs.push_back({"--points", points});
  }
  if (const Status ok = checkFiles({.inputs = inputs, .outputs = {{"--json", options.json}}}); !ok) {
    return ok.error();
  }
  const Result<std::vector<Vec3d>> points = allPoints(options.points);
  if (!points) {
    return points.error();
  }
  const Result<SightFile> file = SightFile::open(options.file);
  if (!file) {
    return file.error();
  }
  const Vec3d origin = originOf(file->record());
  const Result<std::vector<ObjectId>> closed = closedDoors(options.closed, *file, options.file);
  if (!closed) {
    return closed.error();
  }
  SetQuery query(*file);
  query.setClosedDoors(*closed);
  std::vector<PointAnswer> answers;
  for (const Vec3d& point : *points) {
    answers.push_back(answerOf(point, origin, *file, query));
  }
  if (query.stats().broken > 0) {
    const Status whole = file->verifyAll();
    return whole ? Error{fmt::format("{}: is damaged; bake it again", options.file)} : whole.error();
  }
  if (const Status ok = writeOutput(options.json, options.json.empty() ? "" : toJson(*file, answers)); !ok) {
    return ok.error();
  }
  if (options.json != "-") {
    print(*file, answers);
  }
  return kOk;
}

}  // namespace

void addQuery(CLI::App& app, Command& chosen) {
  CLI::App* command =
      app.add_subcommand("query", "visible objects from a baked file, from anywhere in the points' cells");
  const auto options = std::make_shared<QueryOptions>();
  command->add_option("FILE", options->file, "what `sightline bake` wrote, F.sight")
      ->required()
      ->type_name(kFileType);
  command
      ->add_option(
          "--points", options->points,
          "a point X,Y,Z in world space, a JSON file {\"points\":[[x,y,z],...]}, or a camera path, of "
          "which the eyes are taken; may be given several times")
      ->required()
      ->type_name(kFileType)
      ->allow_extra_args(false);
  addClosedOption(*command, options->closed);
  command->add_option("--json", options->json, "write the result as JSON to this file; - is standard output")
      ->type_name(kFileType);
  command->footer(
      "A point outside the baked cells is in none: from there, all objects may be seen.\n"
      "Examples:\n"
      "  sightline query city.sight --points walk.json\n"
      "  sightline query city.sight --points 12.5,1.7,-3 --points 13,1.7,-3 --json visible.json\n"
      "  sightline query house.sight --points 12.5,1.7,-3 --closed 14,17");
  command->callback([options, &chosen] { chosen = [options] { return runQuery(*options); }; });
}

}  // namespace sightline::tool
