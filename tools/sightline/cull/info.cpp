// sightline info: describes a scene and its occluders and hierarchies, or a baked file.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <memory>
#include <span>

#include "src/io/point_json.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/names.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/cull/info_cracks.h"
#include "tools/sightline/cull/info_sight.h"
#include "tools/sightline/input/doors.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {
namespace {

struct InfoOptions {
  CommonOptions common;
  PathOptions path;
  std::vector<double> crack_widths;
  std::string closed;  // doors of a baked file
  std::string prepared;
};

Vec3d toWorld(const Vec3f& p, const Scene& scene) {
  return Vec3d(p) + scene.origin;
}

const char* opacityName(Opacity opacity) {
  switch (opacity) {
    case Opacity::kOpaque:
      return "opaque";
    case Opacity::kBlended:
      return "blended";
    case Opacity::kAlphaTested:
      return "alpha-tested";
  }
  return "?";
}

// Triangles and objects by properties of their material.
struct MaterialUse {
  std::vector<std::uint64_t> triangles, objects;  // one for each material
};

MaterialUse useOf(const Scene& scene) {
  MaterialUse use{std::vector<std::uint64_t>(scene.materials.size()),
                  std::vector<std::uint64_t>(scene.materials.size())};
  for (const Object& object : scene.objects) {
    use.triangles[object.material.value] += object.triangleCount();
    use.objects[object.material.value] += 1;
  }
  return use;
}

// Why triangles are in an occluder or not; one table for text and JSON.
struct Reason {
  const char* key;
  const char* text;
  std::uint64_t triangles;
};

std::vector<Reason> reasonsOf(const OccluderReport& report) {
  return {{"used", "are in occluders", report.used},
          {"see_through", "cannot: blended or alpha-tested", report.see_through},
          {"marked_never", "cannot: marked so by the scene's author", report.marked_never},
          {"degenerate", "cannot: no area, doubled, or thinner than rounding", report.degenerate},
          {"too_small", "are left out: small, even merged with their neighbours", report.too_small}};
}

Json occludersJson(const OccluderSet& set) {
  Json why;
  for (const Reason& reason : reasonsOf(set.report)) {
    why[reason.key] = reason.triangles;
  }
  return {{"count", set.occluders.size()}, {"area", set.area}, {"triangles", why}};
}

struct HierarchyFacts {
  std::size_t nodes = 0, leaves = 0;
  std::uint32_t depth = 0, duplicates = 0;
  double bytes_per_node = 0.0, bytes_per_object = 0.0;
};

HierarchyFacts factsOf(const Hierarchy& hierarchy) {
  HierarchyFacts facts;
  facts.nodes = hierarchy.nodes.size();
  for (const HierarchyNode& node : hierarchy.nodes) {
    facts.leaves += node.leaf() ? 1 : 0;
  }
  facts.depth = hierarchy.depth;
  facts.duplicates = hierarchy.duplicates();
  facts.bytes_per_node = sizeof(HierarchyNode);
  // The bytes of objects' boxes and of leaves' entries; nodes are counted separately.
  const double entries = static_cast<double>(hierarchy.objects.size() * sizeof(ObjectId));
  facts.bytes_per_object = hierarchy.object_count > 0 ? sizeof(Box) + entries / hierarchy.object_count : 0.0;
  return facts;
}

Json hierarchyJson(const HierarchyFacts& facts) {
  return {{"nodes", facts.nodes},
          {"leaves", facts.leaves},
          {"depth", facts.depth},
          {"duplicates", facts.duplicates},
          {"bytes_per_node", facts.bytes_per_node},
          {"bytes_per_object", facts.bytes_per_object}};
}

// Objects of several boxes, and all of their boxes.
struct BoxFacts {
  std::size_t objects = 0, boxes = 0;
};

BoxFacts boxFactsOf(const Scene& scene, CullingData& data) {
  const ObjectBoxes& boxes = data.objectBoxes(kMaxObjectBoxes);
  BoxFacts facts{.boxes = boxes.boxes.size()};
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    facts.objects += boxes.of(ObjectId(o)).empty() ? 0 : 1;
  }
  return facts;
}

Json surfacesJson(const SurfaceSet& surfaces) {
  return {{"triangles", surfaces.triangles.size() / 3},
          {"parts", surfaces.parts.size()},
          {"patches", surfaces.patches.size()},
          {"clusters", surfaces.clusters.size()},
          {"chains", surfaces.chains.size()}};
}

Json stagesJson(const CullingData& data) {
  Json stages = Json::array();
  for (const CullingData::Stage& stage : data.stages()) {
    stages.push_back({{"stage", stage.name}, {"us", stage.us}});
  }
  return stages;
}

Json headJson(const Scene& scene, CullingData& data, const CrackFacts& cracks) {
  const Box bounds = sceneBounds(scene.view());
  const MaterialUse use = useOf(scene);
  Json materials = Json::array(), paths = Json::array(), hierarchies;
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    materials.push_back({{"name", material.name},
                         {"opacity", opacityName(material.opacity)},
                         {"double_sided", material.double_sided},
                         {"objects", use.objects[m]},
                         {"triangles", use.triangles[m]}});
  }
  for (const CameraPath& path : scene.paths) {
    paths.push_back({{"name", path.name}, {"frames", path.frames.size()}});
  }
  for (const auto& name : kHierarchies) {
    hierarchies[std::string(name.text)] = hierarchyJson(factsOf(data.hierarchy(name.value)));
  }
  const BoxFacts boxes = boxFactsOf(scene, data);
  Json json = {{"scene", sceneJson(scene)},
               {"triangles", scene.triangleCount()},
               {"vertices", scene.positions.size()},
               {"origin", io::pointJson(scene.origin)},
               {"min", io::pointJson(toWorld(bounds.min, scene))},
               {"max", io::pointJson(toWorld(bounds.max, scene))},
               {"materials", materials},
               {"paths", paths},
               {"occluders", occludersJson(data.occluders())},
               {"surfaces", surfacesJson(data.surfaces())},
               {"object_boxes", {{"objects", boxes.objects}, {"boxes", boxes.boxes}}},
               {"cracks", cracksJson(cracks, scene)},
               {"hierarchies", hierarchies}};
  json["preparation"] = stagesJson(data);  // all has been made by now
  return json;
}

std::string toJson(const Scene& scene, CullingData& data, const CrackFacts& cracks) {
  std::vector<std::string> objects;
  for (std::size_t o = 0; o < scene.objects.size(); ++o) {
    const Object& object = scene.objects[o];
    objects.push_back(dump({{"id", o},
                            {"name", scene.object_names[o]},
                            {"triangles", object.triangleCount()},
                            {"material", object.material.value},
                            {"min", io::pointJson(toWorld(object.bounds.min, scene))},
                            {"max", io::pointJson(toWorld(object.bounds.max, scene))}}));
  }
  return dumpWithList(headJson(scene, data, cracks), "objects", objects);
}

void printMaterials(const Scene& scene) {
  const MaterialUse use = useOf(scene);
  std::uint64_t triangles[3][2] = {}, materials[3][2] = {};
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    triangles[static_cast<int>(material.opacity)][material.double_sided] += use.triangles[m];
    materials[static_cast<int>(material.opacity)][material.double_sided] += 1;
  }
  fmt::print("materials     {}\n", scene.materials.size());
  for (int opacity = 0; opacity < 3; ++opacity) {
    for (int sides = 0; sides < 2; ++sides) {
      if (materials[opacity][sides] > 0) {
        fmt::print("              {:4} {}, {}: {} triangles\n", materials[opacity][sides],
                   opacityName(static_cast<Opacity>(opacity)), sides == 1 ? "double-sided" : "single-sided",
                   triangles[opacity][sides]);
      }
    }
  }
}

void printOccluders(const Scene& scene, const OccluderSet& set) {
  fmt::print("occluders     {} polygons, {:.1f} m2; of the scene's triangles\n", set.occluders.size(),
             set.area);
  const double all = static_cast<double>(std::max<std::uint64_t>(scene.triangleCount(), 1));
  for (const Reason& reason : reasonsOf(set.report)) {
    if (reason.triangles > 0) {
      fmt::print("              {:10} ({:4.1f} %) {}\n", reason.triangles,
                 100.0 * static_cast<double>(reason.triangles) / all, reason.text);
    }
  }
}

void print(const InfoOptions& options, const Scene& scene, CullingData& data, const CrackFacts& cracks) {
  const Box bounds = sceneBounds(scene.view());
  const Vec3d low = toWorld(bounds.min, scene), high = toWorld(bounds.max, scene), extent = high - low;
  fmt::print("scene         {}\n", options.common.scene);
  fmt::print("objects       {}\n", scene.objects.size());
  fmt::print("triangles     {}\n", scene.triangleCount());
  fmt::print("vertices      {}\n", scene.positions.size());
  fmt::print("from          {:.3f} {:.3f} {:.3f}\n", low.x, low.y, low.z);
  fmt::print("to            {:.3f} {:.3f} {:.3f}   ({:.1f} x {:.1f} x {:.1f} m)\n", high.x, high.y, high.z,
             extent.x, extent.y, extent.z);
  printMaterials(scene);
  printOccluders(scene, data.occluders());
  const SurfaceSet& surfaces = data.surfaces();
  fmt::print("surfaces      {} parts of {} patches of {} clusters, {} triangles\n", surfaces.parts.size(),
             surfaces.patches.size(), surfaces.clusters.size(), surfaces.triangles.size() / 3);
  printCracks(cracks, scene);
  const BoxFacts boxes = boxFactsOf(scene, data);
  fmt::print("boxes         {} objects have several, {} in all\n", boxes.objects, boxes.boxes);
  for (const auto& name : kHierarchies) {
    const HierarchyFacts facts = factsOf(data.hierarchy(name.value));
    fmt::print(
        "hierarchy     {:4} {} nodes, {} leaves, {} levels, {} duplicates, {} bytes a node, {:.1f} an "
        "object\n",
        name.text, facts.nodes, facts.leaves, facts.depth, facts.duplicates, facts.bytes_per_node,
        facts.bytes_per_object);
  }
  fmt::print("prepared in  ");
  for (const CullingData::Stage& stage : data.stages()) {
    fmt::print(" {} {:.2f} s{}", stage.name, 1e-6 * stage.us, &stage == &data.stages().back() ? "\n" : ",");
  }
  fmt::print("walks         {}\n", scene.paths.empty() ? "none" : "");
  for (const CameraPath& path : scene.paths) {
    fmt::print("              {}: {} frames\n", path.name, path.frames.size());
  }
}

// widths: of the cracks to close, none of them 0.
Result<ExitCode> informOnBaked(const InfoOptions& options, std::span<const double> widths) {
  if (options.common.threads > 1) {
    return Error{fmt::format("--threads {}: a baked file is read with one thread; leave it out",
                             options.common.threads)};
  }
  if (!widths.empty() || !options.path.path.empty() || !options.path.frames.empty()) {
    return Error{
        "--crack-width, --path, --frames: a baked file has no surfaces to walk past; leave them out"};
  }
  if (!options.prepared.empty()) {
    return Error{"--prepared: nothing is prepared for a baked file; leave it out"};
  }
  const Status ok = informOnSight(options.common.scene, options.closed, options.common.json);
  return ok ? Result<ExitCode>(kOk) : ok.error();
}

Result<ExitCode> informOnScene(const InfoOptions& options, std::span<const double> widths) {
  if (!options.closed.empty()) {
    return Error{
        "--closed: it names doors of a baked file; leave it out, or give F.sight in place of the scene"};
  }
  if (widths.empty() && !(options.path.path.empty() && options.path.frames.empty())) {
    return Error{"--path, --frames: a walk shows what closing cracks hides; give --crack-width as well"};
  }
  Result<Scene> loaded = loadScene(options.common.scene);
  if (!loaded) {
    return loaded.error();
  }
  SceneAndWalk input{std::move(*loaded)};
  const Scene& scene = input.scene;
  const Threads threads(options.common.threads);
  CrackFacts cracks = crackFactsOf(scene, threads.parallelFor());
  if (!widths.empty()) {
    Result<Walk> walk = loadWalk(options.path, options.common.scene, scene);
    if (!walk) {
      return walk.error();
    }
    input.walk = std::move(*walk);
    cracks.effect = effectOfClosing(input, widths, threads.parallelFor());
  }
  Result<PreparedFile> prepared = PreparedFile::open(options.prepared, scene.view(), 0.0);
  if (!prepared) {
    return prepared.error();
  }
  input.prepared = std::move(*prepared);
  CullingData data(input, threads.parallelFor());
  if (!options.common.json.empty()) {
    if (const Status written = writeOutput(options.common.json, toJson(scene, data, cracks)); !written) {
      return written.error();
    }
  }
  if (options.common.textOnStdout()) {
    print(options, scene, data, cracks);
  }
  data.keepPrepared();
  return kOk;
}

Result<ExitCode> runInfo(const InfoOptions& options) {
  if (const Status ok =
          checkFiles({.scenes = {options.common.scene},
                      .inputs = walkInputs(options.common.scene, options.path),
                      .outputs = {{"--json", options.common.json}, {"--prepared", options.prepared}}});
      !ok) {
    return ok.error();
  }
  std::vector<double> widths = options.crack_widths;
  std::erase(widths, 0.0);  // that is the scene as it is
  return isSightFile(options.common.scene) ? informOnBaked(options, widths) : informOnScene(options, widths);
}

}  // namespace

void addInfo(CLI::App& app, Command& chosen) {
  CLI::App* command = app.add_subcommand(
      "info",
      "counts, bounds, materials, what can occlude and why the rest cannot, hierarchies; of a baked file "
      "(F.sight in place of SCENE) its cells and sets");
  const auto options = std::make_shared<InfoOptions>();
  addCommonOptions(*command, options->common);
  addPathOptions(*command, options->path);
  addCrackWidthsOption(*command, options->crack_widths);
  addPreparedOption(*command, options->prepared);
  addClosedOption(*command, options->closed);
  command->footer(
      "Examples:\n"
      "  sightline info city.glb\n"
      "  sightline info \"demo:city?copies=30&seed=1\" --json city.json\n"
      "  sightline info city.glb --crack-width 0.001,0.01    what closing cracks hides on the scene's walk\n"
      "  sightline info city.sight");
  command->callback([options, &chosen] { chosen = [options] { return runInfo(*options); }; });
}

}  // namespace sightline::tool
