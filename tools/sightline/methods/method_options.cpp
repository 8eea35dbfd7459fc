// One table of options says everything about each: its name, what it belongs to, its values and its place in
// the library's settings.

#include "tools/sightline/methods/method_options.h"

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/command_line/parse_text.h"
#include "tools/sightline/input/doors.h"
#include "tools/sightline/methods/method_choice.h"
#include "tools/sightline/methods/method_names.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kMaxOccluders = 65535;
constexpr std::uint32_t kMaxDirections = 4096;
constexpr std::uint32_t kMaxTriangles = 1'000'000'000;
constexpr double kMaxMebibytes = 65536.0;
constexpr double kMebibyte = 1024.0 * 1024.0;

// Converts an option's value from text to the setting and back.
struct Value {
  std::string help;                                                    // after the option's own
  std::string expected;                                                // "a whole number from 1 to 9"
  std::function<bool(const std::string& text, Setting& setting)> set;  // false: not what was expected
  std::function<Json(Setting setting)> get;
  std::vector<std::string> words{};  // the allowed values; empty: it is a number
};

template <typename T>
using Field = T& (*)(Setting&);

template <typename T, std::size_t N>
Value oneOf(const std::array<Name<T>, N>& names, Field<T> field) {
  const auto set = [&names, field](const std::string& text, Setting& setting) {
    const auto found =
        std::find_if(names.begin(), names.end(), [&](const auto& name) { return name.text == text; });
    if (found != names.end()) {
      field(setting) = found->value;
    }
    return found != names.end();
  };
  return {"", "one of: " + listNames(names), set,
          [&names, field](Setting setting) { return Json(nameOf(names, field(setting))); }, textsOf(names)};
}

Value methodName() {
  std::vector<std::string> names;
  std::string list;
  for (const Method& method : allMethods()) {
    names.emplace_back(method.name);
    list += (list.empty() ? "" : ", ") + names.back();
  }
  const auto set = [names](const std::string& text, Setting& setting) {
    const bool known = std::find(names.begin(), names.end(), text) != names.end();
    setting.method = known ? &methodNamed(text) : setting.method;
    return known;
  };
  names.emplace_back(kAutomaticMethod);
  return {"; auto: chosen for the scene, and said which and why", "one of: " + list + ", " + kAutomaticMethod,
          [set](const std::string& text, Setting& setting) {
            return text == kAutomaticMethod || set(text, setting);
          },
          [](const Setting& setting) { return Json(setting.method->name); }, names};
}

Value whole(std::uint32_t min, std::uint32_t max, Field<std::uint32_t> field) {
  const auto set = [=](const std::string& text, Setting& setting) {
    const std::optional<std::uint32_t> value = parseWhole(text);
    if (!value || *value < min || *value > max) {
      return false;
    }
    field(setting) = *value;
    return true;
  };
  return {"", fmt::format("a whole number from {} to {}", min, max), set,
          [field](Setting setting) { return Json(field(setting)); }};
}

// Parses a number from 0 to `max`. Returns false for any other text.
bool parseUpTo(double max, const std::string& text, double& value) {
  const std::optional<double> parsed = parseDecimal(text);
  if (!parsed || std::signbit(*parsed) || *parsed > max) {
    return false;
  }
  value = *parsed;
  return true;
}

Value decimal(Field<double> field) {
  const auto set = [field](const std::string& text, Setting& setting) {
    return parseUpTo(std::numeric_limits<double>::max(), text, field(setting));
  };
  return {"", "a finite number, 0 or greater", set,
          [field](Setting setting) { return Json(field(setting)); }};
}

Value resolution(Field<RasterSettings> field) {
  const auto set = [field](const std::string& text, Setting& setting) {
    const std::vector<std::string> parts = splitAt(text, 'x');
    const auto size = [](const std::string& part) {
      const std::optional<std::uint32_t> pixels = parseWhole(part);
      return pixels && *pixels >= 1 && *pixels <= kMaxBufferSize ? pixels : std::nullopt;
    };
    const auto width = size(parts.front()), height = size(parts.back());
    if (parts.size() != 2 || !width || !height) {
      return false;
    }
    field(setting).width = *width;
    field(setting).height = *height;
    return true;
  };
  return {": WIDTHxHEIGHT", fmt::format("a size in pixels like 320x180, each from 1 to {}", kMaxBufferSize),
          set, [field](Setting setting) {
            return Json(fmt::format("{}x{}", field(setting).width, field(setting).height));
          }};
}

Value mebibytes(Field<std::size_t> bytes) {
  const auto set = [bytes](const std::string& text, Setting& setting) {
    double value = 0.0;
    if (!parseUpTo(kMaxMebibytes, text, value)) {
      return false;
    }
    bytes(setting) = static_cast<std::size_t>(value * kMebibyte);
    return true;
  };
  return {"", fmt::format("a number of MiB from 0 to {:.0f}", kMaxMebibytes), set,
          [bytes](Setting setting) { return Json(static_cast<double>(bytes(setting)) / kMebibyte); }};
}

// Conditions under which an option has a meaning, in addition to its method having it.
bool always(const Setting&) {
  return true;
}
bool usesOccluders(const Setting& setting) {
  return setting.usesOccluders();
}
bool choosesOccluders(const Setting& setting) {
  return setting.choosesOccluders();
}
bool drawsSurfaces(const Setting& setting) {
  return setting.surfaces() != SurfaceUse::kNone;
}
bool mayUseSets(const Setting& setting) {
  return setting.baked && setting.method->traits.sets == SetUse::kIfAsked;
}
bool keepsPlanes(const Setting& setting) {
  return setting.plane_form == PlaneForm::kThroughBox;
}
bool keepsRelations(const Setting& setting) {
  return keepsPlanes(setting) && setting.temporal_coherence;
}
bool hasCoherence(const Setting& setting) {
  return setting.method->name != "supporting-planes" || keepsPlanes(setting);
}
bool mayFocus(const Setting& setting) {
  return setting.raster.coverage == nullptr;
}
bool focuses(const Setting& setting) {
  return mayFocus(setting) && setting.focus.magnification > 1.0;
}
bool focusesOccluders(const Setting& setting) {
  return focuses(setting) && setting.choosesOccluders();
}
bool usesViewpoints(const Setting& setting) {
  return setting.usesViewpoints();
}
bool usesMinimumSets(const Setting& setting) {
  return setting.usesViewpoints() && setting.occluders == OccluderChoice::kMinimumSets;
}
bool ranksByAreaAngle(const Setting& setting) {
  return setting.choosesOccluders() && !setting.usesViewpoints();
}
bool usesAreaAngle(const Setting& setting) {
  return ranksByAreaAngle(setting) && !setting.usesDatabase();
}
bool testsDetail(const Setting& setting) {
  return setting.testsDetailObjects();
}
bool testsObjects(const Setting& setting) {
  return setting.culler.test_objects;
}
bool usesDatabase(const Setting& setting) {
  return setting.usesDatabase() || setting.testsDetailObjects();
}

struct Option {
  std::string name;  // "occluder-count": --occluder-count, and occluder_count in JSON
  bool of_methods;   // only methods that name it in their rows have it
  bool (*when)(const Setting&);
  bool list;      // takes several values, if the command does
  bool headline;  // optionsText always includes it, in words of its own
  std::string help;
  Value value;

  // Whether the option has a meaning for a setting in which the options above it are set. If not, it is
  // neither set nor shown, and its list of values does not multiply the setting.
  bool belongs(const Setting& setting) const {
    return (!of_methods || setting.method->has(name)) && when(setting);
  }
};

constexpr bool kAny = false, kOwn = true;
constexpr bool kList = true, kOne = false, kHeadline = true, kWhenChanged = false;

// Each option comes after those that decide whether it has a meaning.
const std::vector<Option>& allOptions() {
  static const std::vector<Option> kOptions{
      {"method", kAny, always, kList, kHeadline, "how to cull", methodName()},
      {"hierarchy", kAny, always, kList, kHeadline, "over the objects",
       oneOf(
           kHierarchies, +[](Setting& s) -> HierarchyKind& { return s.hierarchy; })},
      {"visible-sets", kAny, mayUseSets, kList, kWhenChanged,
       "before the method, all that is not in the baked set of the viewpoint's cell is left out",
       oneOf(
           kSwitch, +[](Setting& s) -> bool& { return s.culler.visible_sets; })},
      {"views-at-once", kOwn, always, kList, kWhenChanged,
       "cull for so many frames at once, those that the camera is expected to have next; 1: each by itself",
       whole(
           1, 16, +[](Setting& s) -> std::uint32_t& { return s.culler.views_at_once; })},
      {"variant", kOwn, always, kList, kHeadline, "of the occlusion tree",
       oneOf(
           kVariants, +[](Setting& s) -> OcclusionTreeVariant& { return s.variant; })},
      {"resolution", kOwn, always, kList, kHeadline, "of the depth buffer of occluders",
       resolution(+[](Setting& s) -> RasterSettings& { return s.raster; })},
      {"coverage", kOwn, always, kList, kWhenChanged,
       "pixels that occluders cover wholly, or at their centres, which culls what can be seen",
       oneOf(
           kCoverages, +[](Setting& s) -> const CoverageRule*& { return s.raster.coverage; })},
      {"focus", kOwn, mayFocus, kList, kWhenChanged,
       "depth pyramid: magnification of finer depth buffers where the first one leaves objects in doubt; 0: "
       "none",
       decimal(+[](Setting& s) -> double& { return s.focus.magnification; })},
      {"focus-resolution", kOwn, focuses, kOne, kWhenChanged, "of each finer depth buffer",
       resolution(+[](Setting& s) -> RasterSettings& { return s.focus.raster; })},
      {"focus-windows", kOwn, focuses, kList, kWhenChanged, "maximum number of finer depth buffers per frame",
       whole(
           0, kMaxFocusWindows, +[](Setting& s) -> std::uint32_t& { return s.focus.windows; })},
      {"focus-worth", kOwn, focuses, kList, kWhenChanged,
       "a finer depth buffer may cost so many times what the frame costs for each object that it takes away",
       decimal(+[](Setting& s) -> double& { return s.focus.worth; })},
      {"tolerance", kOwn, always, kList, kWhenChanged,
       "opacity map: pixels of an object that may be uncovered; more than 0 culls what can be seen",
       whole(
           0, kMaxBufferSize * kMaxBufferSize,
           +[](Setting& s) -> std::uint32_t& { return s.opacity_map.map.tolerance; })},
      {"coverage-ratio", kOwn, always, kList, kWhenChanged,
       "opacity map: what is covered by less than this part counts as visible with all in it",
       decimal(+[](Setting& s) -> double& { return s.opacity_map.map.coverage_ratio; })},
      {"depth-comparison", kOwn, always, kList, kWhenChanged,
       "opacity map: at peaks where that takes less time, everywhere, or always at peaks",
       oneOf(
           kDepthComparisons, +[](Setting& s) -> DepthComparison& { return s.opacity_map.map.depth; })},
      {"triangle-us", kOwn, always, kOne, kWhenChanged,
       "opacity map: microseconds to draw a triangle; the coverage ratio follows measured times; 0: off",
       decimal(+[](Setting& s) -> double& { return s.opacity_map.triangle_us; })},
      {"occluders", kAny, usesOccluders, kList, kWhenChanged, "how occluders are chosen",
       oneOf(
           kOccluderChoices, +[](Setting& s) -> OccluderChoice& { return s.occluders; })},
      {"surfaces", kOwn, mayFocus, kList, kWhenChanged,
       "whole surfaces as occluders; auto: alone by the depth pyramid, unless --occluders is given",
       oneOf(
           kSurfaceOptions, +[](Setting& s) -> SurfaceOption& { return s.surface_option; })},
      {"surface-pixels", kOwn, drawsSurfaces, kList, kWhenChanged,
       "surfaces whose rectangle has fewer pixels are not drawn",
       decimal(+[](Setting& s) -> double& { return s.surface_drawing.min_pixels; })},
      {"surface-budget", kOwn, drawsSurfaces, kList, kWhenChanged,
       "surfaces are drawn until they have cost so much: 1 for an edge, 1 for a tile of 256 pixels, 8 for a "
       "group",
       whole(
           0, kMaxTriangles, +[](Setting& s) -> std::uint32_t& { return s.surface_drawing.budget; })},
      {"budget-us", kOwn, drawsSurfaces, kList, kWhenChanged,
       "surfaces are drawn as far as a frame takes about so many microseconds; what is kept then depends on "
       "measured times; 0: off",
       decimal(+[](Setting& s) -> double& { return s.budget_us; })},
      {"occluder-count", kAny, choosesOccluders, kList, kHeadline, "maximum number of occluders per frame",
       whole(
           1, kMaxOccluders, +[](Setting& s) -> std::uint32_t& { return s.culler.occluders.count; })},
      {"focus-occluder-count", kOwn, focusesOccluders, kOne, kWhenChanged,
       "maximum number of occluders that only a finer depth buffer has",
       whole(
           0, kMaxOccluders, +[](Setting& s) -> std::uint32_t& { return s.focus.occluder_count; })},
      {"planes", kOwn, always, kList, kWhenChanged,
       "supporting planes: made for each occluder, or for each occluder and box, to be kept",
       oneOf(
           kPlaneForms, +[](Setting& s) -> PlaneForm& { return s.plane_form; })},
      {"coherence", kOwn, hasCoherence, kList, kHeadline,
       "temporal coherence; supporting planes: kept relations",
       oneOf(
           kSwitch, +[](Setting& s) -> bool& { return s.temporal_coherence; })},
      {"lambda-steps", kAny, usesAreaAngle, kOne, kWhenChanged,
       "occluders are looked for within so many steps of the observer; 0: everywhere",
       decimal(+[](Setting& s) -> double& { return s.culler.occluders.lambda_steps; })},
      {"min-node-cost", kAny, usesOccluders, kOne, kWhenChanged, "nodes with fewer triangles are not tested",
       whole(
           0, kMaxTriangles, +[](Setting& s) -> std::uint32_t& { return s.culler.min_node_cost; })},
      {"area-angle", kAny, ranksByAreaAngle, kOne, kWhenChanged, "direction that ranks occluders",
       oneOf(
           kAreaAngleDirections,
           +[](Setting& s) -> AreaAngleDirection& { return s.culler.occluders.area_angle_direction; })},
      {"test-objects", kAny, usesOccluders, kOne, kWhenChanged,
       "objects of partly visible leaves are tested one by one",
       oneOf(
           kSwitch, +[](Setting& s) -> bool& { return s.culler.test_objects; })},
      {"object-boxes", kAny, testsObjects, kList, kWhenChanged,
       "maximum number of boxes per object, by which what was kept is tested again; 0: 8 with the depth "
       "pyramid, else 1",
       whole(
           0, kMaxObjectBoxes, +[](Setting& s) -> std::uint32_t& { return s.object_box_option; })},
      {"joint", kOwn, always, kList, kWhenChanged,
       "supporting planes: occluders that share edges hide together",
       oneOf(
           kSwitch, +[](Setting& s) -> bool& { return s.kept_planes.joint_occlusion; })},
      {"relation-mib", kOwn, keepsRelations, kOne, kWhenChanged,
       "supporting planes: maximum memory of kept relations",
       mebibytes(+[](Setting& s) -> std::size_t& { return s.kept_planes.relation_bytes; })},
      {"tangents", kOwn, keepsPlanes, kOne, kWhenChanged, "supporting planes: how their vertices are found",
       oneOf(
           kTangentSearches, +[](Setting& s) -> TangentSearch& { return s.kept_planes.tangent_search; })},
      {"detail-objects", kAny, usesOccluders, kList, kWhenChanged,
       "what was kept is tested again, with a database's occluders near itself",
       oneOf(
           kSwitch, +[](Setting& s) -> bool& { return s.detail_objects; })},
      {"detail-occluder-count", kAny, testsDetail, kOne, kWhenChanged,
       "maximum number of occluders in that second test",
       whole(
           1, kMaxOccluders, +[](Setting& s) -> std::uint32_t& { return s.detail.occluder_count; })},
      {"draw-object-us", kAny, usesOccluders, kOne, kWhenChanged,
       "microseconds that the renderer takes for an object; where culling takes longer than it saves, frames "
       "are culled by the frustum alone; 0: off",
       decimal(+[](Setting& s) -> double& { return s.renderer.object_us; })},
      {"draw-triangle-us", kAny, usesOccluders, kOne, kWhenChanged,
       "the same for each of its triangles; 0: off",
       decimal(+[](Setting& s) -> double& { return s.renderer.triangle_us; })},
      {"database-directions", kAny, usesDatabase, kOne, kWhenChanged,
       "occluder database: directions of a cell",
       whole(
           1, kMaxDirections, +[](Setting& s) -> std::uint32_t& { return s.database.directions; })},
      {"database-occluder-count", kAny, usesDatabase, kOne, kWhenChanged,
       "occluder database: maximum number of occluders per cell and direction",
       whole(
           1, kMaxOccluders, +[](Setting& s) -> std::uint32_t& { return s.database.occluder_count; })},
      {"database-mib", kAny, usesDatabase, kOne, kWhenChanged,
       "occluder database: maximum memory of its lists",
       mebibytes(+[](Setting& s) -> std::size_t& { return s.database.max_bytes; })},
      {"viewpoint-spacing", kAny, usesViewpoints, kOne, kWhenChanged,
       "viewpoint database: metres between grid points; 0: chosen",
       decimal(+[](Setting& s) -> double& { return s.viewpoints.spacing; })},
      {"viewpoint-directions", kAny, usesViewpoints, kOne, kWhenChanged,
       "viewpoint database: directions at a grid point",
       whole(
           1, kMaxDirections, +[](Setting& s) -> std::uint32_t& { return s.viewpoints.directions; })},
      {"viewpoint-pixels", kAny, usesViewpoints, kOne, kWhenChanged,
       "viewpoint database: pixels along the edge of a picture",
       whole(
           8, 512, +[](Setting& s) -> std::uint32_t& { return s.viewpoints.resolution; })},
      {"set-gain", kAny, usesMinimumSets, kOne, kWhenChanged, "minimum sets: weight of what a set hides",
       decimal(+[](Setting& s) -> double& { return s.viewpoints.weights.gain; })},
      {"set-count", kAny, usesMinimumSets, kOne, kWhenChanged,
       "minimum sets: weight of the number of occluders",
       decimal(+[](Setting& s) -> double& { return s.viewpoints.weights.count; })},
      {"set-area", kAny, usesMinimumSets, kOne, kWhenChanged,
       "minimum sets: weight of the pixels of occluders",
       decimal(+[](Setting& s) -> double& { return s.viewpoints.weights.area; })},
      {"set-rest", kAny, usesMinimumSets, kOne, kWhenChanged,
       "minimum sets: where they end, lists go on by first hit",
       oneOf(
           kSwitch, +[](Setting& s) -> bool& { return s.viewpoints.first_hit_after_sets; })},
  };
  return kOptions;
}

const Option& optionNamed(std::string_view name) {
  return *std::find_if(allOptions().begin(), allOptions().end(),
                       [&](const Option& option) { return option.name == name; });
}

std::size_t indexOf(std::string_view name) {
  return static_cast<std::size_t>(&optionNamed(name) - allOptions().data());
}

// Returns a JSON value as text; strings have no quotes.
std::string plainText(const Json& value) {
  return value.is_string() ? value.get<std::string>() : value.dump();
}

std::string jsonKey(std::string name) {
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

// Returns the values of one option, or an error if one of them is not allowed.
Result<std::vector<std::string>> valuesOf(const Option& option, const std::string& text) {
  std::vector<std::string> values = splitAt(text, ',');
  if (values.size() > 1 && !option.list) {
    return Error{fmt::format("--{} takes one value, not '{}'", option.name, text)};
  }
  for (const std::string& value : values) {
    Setting ignored;
    if (!option.value.set(value, ignored)) {
      return Error{fmt::format("--{}: '{}' is not {}", option.name, value, option.value.expected)};
    }
  }
  return values;
}

// Returns an error if a setting needs a baked file and none is given.
Status checkBaked(const MethodOptions& options, const std::vector<Setting>& settings) {
  constexpr const char* kRemedy =
      "give the baked file with --baked F.sight; make one with: sightline bake SCENE -o F.sight";
  if (!options.baked.empty()) {
    return Success{};
  }
  for (const Setting& setting : settings) {
    if (setting.method->traits.sets == SetUse::kAlways) {
      return Error{fmt::format("--method {}: {}", methodName(setting), kRemedy)};
    }
  }
  for (std::size_t i = 0; i < allOptions().size(); ++i) {
    if (allOptions()[i].when == mayUseSets && options.texts[i] != options.defaults[i]) {
      return Error{fmt::format("--{} {}: {}", allOptions()[i].name, options.texts[i], kRemedy)};
    }
  }
  return Success{};
}

std::vector<Setting> multiply(const std::vector<Setting>& settings, const Option& option,
                              const std::vector<std::string>& values) {
  std::vector<Setting> all;
  for (const Setting& setting : settings) {
    if (!option.belongs(setting)) {
      all.push_back(setting);
      continue;
    }
    for (const std::string& value : values) {
      all.push_back(setting);
      option.value.set(value, all.back());
    }
  }
  return all;
}

// All combinations of the options' values.
Result<std::vector<Setting>> combinationsOf(const MethodOptions& options) {
  Setting usual;
  usual.baked = !options.baked.empty();
  std::vector<Setting> settings{usual};
  for (std::size_t i = 0; i < allOptions().size(); ++i) {
    const Option& option = allOptions()[i];
    const Result<std::vector<std::string>> values = valuesOf(option, options.texts[i]);
    if (!values) {
      return values.error();
    }
    settings = multiply(settings, option, *values);
  }
  return settings;
}

// The options with what was chosen in place of the defaults.
MethodOptions withChoice(MethodOptions options, const MethodChoice& choice) {
  for (const auto& [name, text] : choice.options) {
    if (!options.given[indexOf(name)]) {
      options.setDefault(name, text);
    }
  }
  return options;
}

// Why a given option has no meaning for any of the settings.
std::string uselessBecause(const Option& option, const std::vector<Setting>& settings) {
  const bool is_in_use = std::any_of(settings.begin(), settings.end(), [&](const Setting& setting) {
    return setting.method->has(option.name);
  });
  if (!option.of_methods || is_in_use) {
    return "it has no meaning beside the other options";
  }
  std::string methods;
  for (const Method& method : allMethods()) {
    if (method.has(option.name)) {
      methods += (methods.empty() ? "" : ",") + std::string(method.name);
    }
  }
  return "it belongs to --method " + methods;
}

// Names on stderr the given options that no method has.
void noteUseless(const MethodOptions& options, const std::vector<Setting>& settings) {
  for (std::size_t i = 0; i < allOptions().size(); ++i) {
    const Option& option = allOptions()[i];
    const bool given = options.texts[i] != options.defaults[i];
    if (given && std::none_of(settings.begin(), settings.end(),
                              [&](const Setting& setting) { return option.belongs(setting); })) {
      printNote("--{} changes nothing here: {}", option.name, uselessBecause(option, settings));
    }
  }
}

}  // namespace

MethodOptions::MethodOptions() {
  for (const Option& option : allOptions()) {
    texts.push_back(plainText(option.value.get(Setting{})));
  }
  defaults = texts;
  given.resize(texts.size());
}

void MethodOptions::setDefault(std::string_view name, const std::string& text) {
  texts[indexOf(name)] = defaults[indexOf(name)] = text;
}

void addMethodOptions(CLI::App& command, MethodOptions& options, bool lists) {
  for (std::size_t i = 0; i < allOptions().size(); ++i) {
    const Option& option = allOptions()[i];
    const std::string help =
        option.help + option.value.help + (lists && option.list ? " (several: a,b,c)" : "");
    CLI::Option* added = command.add_option("--" + option.name, options.texts[i], help);
    added->capture_default_str();
    added->each([&options, i](const std::string&) { options.given[i] = true; });
    if (!option.value.words.empty()) {
      added->check(isOneOf(option.value.words, option.list));
    }
  }
  command
      .add_option("--baked", options.baked,
                  "a .sight file of the scene: its visible sets, and its occluder databases in place of "
                  "those that would be built")
      ->type_name(kFileType)
      ->check(isNotEmpty());
  addClosedOption(command, options.closed);
  addPreparedOption(command, options.prepared);
  addCrackWidthOption(command, options.crack_width);
  if (CLI::Option* path = command.get_option_no_throw("--path")) {
    path->description(path->get_description() +
                      "; cells: a view from each cell of the --baked file, most of them from the cell's "
                      "borders");
  }
}

bool asksForChoice(const MethodOptions& options) {
  const std::vector<std::string> methods = splitAt(options.texts[indexOf("method")], ',');
  return std::find(methods.begin(), methods.end(), kAutomaticMethod) != methods.end();
}

Result<std::vector<Setting>> settingsOf(const MethodOptions& options,
                                        const std::shared_ptr<const MethodChoice>& choice) {
  std::vector<Setting> settings;
  for (const std::string& method : splitAt(options.texts[indexOf("method")], ',')) {
    const bool chosen = method == kAutomaticMethod && choice != nullptr;
    MethodOptions one = chosen ? withChoice(options, *choice) : options;
    one.texts[indexOf("method")] = chosen ? choice->method : method;
    Result<std::vector<Setting>> of_method = combinationsOf(one);
    if (!of_method) {
      return of_method.error();
    }
    for (Setting& setting : *of_method) {
      setting.choice = chosen ? choice : nullptr;
      settings.push_back(std::move(setting));
    }
  }
  if (const Status served = checkBaked(options, settings); !served) {
    return served.error();
  }
  if (choice != nullptr || !asksForChoice(options)) {
    noteUseless(options, settings);
  }
  for (Setting& setting : settings) {
    setting.database.area_angle_direction = setting.culler.occluders.area_angle_direction;
    setting.viewpoints.criterion = criterionOf(setting.occluders);
  }
  return settings;
}

std::string optionsText(const Setting& setting) {
  std::string text = nameOf(kHierarchies, setting.hierarchy);
  if (setting.surfaces() != SurfaceUse::kNone) {
    text = "surfaces, " + text;
  }
  if (setting.choosesOccluders()) {
    text = fmt::format("{} occluders, {}", setting.culler.occluders.count, text);
  }
  const auto shows = [&](std::string_view name) { return optionNamed(name).belongs(setting); };
  if (shows("coherence")) {
    text += ", coherence " + nameOf(kSwitch, setting.temporal_coherence);
  }
  if (shows("variant")) {
    text = nameOf(kVariants, setting.variant) + ", " + text;
  }
  if (shows("resolution")) {
    text = fmt::format("{}x{}, {}", setting.raster.width, setting.raster.height, text);
  }
  if (setting.approximate()) {
    text = "APPROXIMATE, " + text;
  }
  for (const Option& option : allOptions()) {
    const Json value = option.value.get(setting);
    if (!option.headline && option.belongs(setting) && value != option.value.get(Setting{})) {
      text += fmt::format(", {} {}", option.name, plainText(value));
    }
  }
  return text;
}

Json optionsJson(const Setting& setting) {
  Json json;
  for (const Option& option : allOptions()) {
    if (option.name != "method" && option.belongs(setting)) {
      json[jsonKey(option.name)] = option.value.get(setting);
    }
  }
  if (setting.usesDepthBuffer()) {
    json["approximate"] = setting.approximate();
  }
  return json;
}

}  // namespace sightline::tool
