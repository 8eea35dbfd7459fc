#include "tools/sightline/bake/bake_databases.h"

#include <algorithm>

#include "sightline/occluders/occluder_database.h"
#include "sightline/pvs/format/scene_id.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {
namespace {

std::vector<std::byte> buildDatabase(const std::string& name, const DatabaseChoice& choice, CullingData& data,
                                     const ParallelFor& parallel_for) {
  ProgressBar bar("occluder database: " + name);
  const Progress progress = [&](double done) { bar.update(done); };
  if (name == "area-angle" || name == "detail") {
    OccluderDatabaseSettings settings;
    settings.turned_away = name == "detail";
    return OccluderDatabase::build(data.hierarchy(HierarchyKind::kKdTree), data.occluders(), settings,
                                   parallel_for, progress)
        .save();
  }
  ViewpointDatabaseSettings settings = choice.viewpoints;
  const auto occluders = std::ranges::find(kOccluderChoices, name, &Name<OccluderChoice>::text);
  settings.criterion = criterionOf(occluders->value);
  return ViewpointDatabase::build(data.hierarchy(HierarchyKind::kBvh), data.occluders(), choice.places,
                                  settings, parallel_for, progress)
      .save();
}

}  // namespace

std::string listBakedDatabases() {
  std::string list;
  for (const std::string_view name : kBakedDatabases) {
    list.append(list.empty() ? "" : ", ").append(name);
  }
  return list;
}

std::vector<DatabaseBlob> buildDatabases(const Scene& scene, const DatabaseChoice& choice,
                                         const ParallelFor& parallel_for) {
  std::vector<DatabaseBlob> databases;
  if (choice.names.empty()) {
    return databases;
  }
  CullingData data(scene, parallel_for);
  const std::uint64_t occluders = occluderSetHash(data.occluders());
  for (const std::string& name : choice.names) {
    databases.push_back({name, occluders, buildDatabase(name, choice, data, parallel_for)});
  }
  return databases;
}

}  // namespace sightline::tool
