#include "tools/sightline/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "tools/sightline/names.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kMaxThreads = 256;
constexpr std::uint32_t kMaxOccluders = 65535;
constexpr const char* kOccluderChoice = "area-angle";

std::vector<std::string> splitAt(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  for (std::size_t end; (end = text.find(separator, begin)) != std::string::npos; begin = end + 1) {
    parts.push_back(text.substr(begin, end - begin));
  }
  parts.push_back(text.substr(begin));
  return parts;
}

std::optional<std::uint32_t> parseNumber(const std::string& text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && !text.empty() ? std::optional(value)
                                                                                   : std::nullopt;
}

template <typename T, std::size_t N>
Result<std::vector<T>> parseNames(const char* option, const std::array<Name<T>, N>& names,
                                  const std::string& text) {
  std::vector<T> values;
  for (const std::string& part : splitAt(text, ',')) {
    const auto found =
        std::find_if(names.begin(), names.end(), [&](const auto& name) { return name.text == part; });
    if (found == names.end()) {
      return Error{fmt::format("{}: there is no '{}'; choose from: {}", option, part, listNames(names))};
    }
    values.push_back(found->value);
  }
  return values;
}

Result<std::vector<std::uint32_t>> parseCounts(const char* option, const std::string& text) {
  std::vector<std::uint32_t> values;
  for (const std::string& part : splitAt(text, ',')) {
    const std::optional<std::uint32_t> value = parseNumber(part);
    if (!value || *value < 1 || *value > kMaxOccluders) {
      return Error{fmt::format("{}: '{}' is not a whole number from 1 to {}", option, part, kMaxOccluders)};
    }
    values.push_back(*value);
  }
  return values;
}

// The values of all lists, parsed.
struct Lists {
  std::vector<CullMethod> methods;
  std::vector<OcclusionTreeVariant> variants;
  std::vector<std::uint32_t> counts;
  std::vector<HierarchyKind> hierarchies;
  std::vector<bool> coherences;
};

template <typename T>
std::optional<Error> take(Result<std::vector<T>> parsed, std::vector<T>& values) {
  if (!parsed) {
    return parsed.error();
  }
  values = std::move(*parsed);
  return std::nullopt;
}

Result<Lists> parseLists(const MethodOptions& options) {
  Lists lists;
  for (const std::optional<Error>& error :
       {take(parseNames("--method", kMethods, options.method), lists.methods),
        take(parseNames("--variant", kVariants, options.variant), lists.variants),
        take(parseCounts("--occluder-count", options.occluder_count), lists.counts),
        take(parseNames("--hierarchy", kHierarchies, options.hierarchy), lists.hierarchies),
        take(parseNames("--coherence", kSwitch, options.coherence), lists.coherences)}) {
    if (error) {
      return *error;
    }
  }
  if (options.occluders != kOccluderChoice) {
    return Error{
        fmt::format("--occluders: there is no '{}'; choose from: {}", options.occluders, kOccluderChoice)};
  }
  if (!std::isfinite(options.lambda_steps) || options.lambda_steps < 0.0) {
    return Error{"--lambda-steps: must be a finite number, 0 or greater"};
  }
  return lists;
}

// What is the same in all settings.
Result<CullerSettings> parseCommon(const MethodOptions& options) {
  const auto directions = parseNames("--area-angle", kAreaAngleDirections, options.area_angle);
  const auto test_objects = parseNames("--test-objects", kSwitch, options.test_objects);
  if (!directions || !test_objects) {
    return directions ? test_objects.error() : directions.error();
  }
  if (directions->size() != 1 || test_objects->size() != 1) {
    return Error{"--area-angle and --test-objects take one value"};
  }
  CullerSettings settings;
  settings.area_angle_direction = directions->front();
  settings.test_objects = test_objects->front();
  settings.min_node_cost = options.min_node_cost;
  settings.lambda_steps = options.lambda_steps;
  return settings;
}

void appendOcclusionTrees(const Lists& lists, const Setting& base, std::vector<Setting>& settings) {
  Setting setting = base;
  for (const OcclusionTreeVariant variant : lists.variants) {
    for (const std::uint32_t count : lists.counts) {
      for (const bool coherence : lists.coherences) {
        setting.culler.variant = variant;
        setting.culler.occluder_count = count;
        setting.culler.temporal_coherence = coherence;
        settings.push_back(setting);
      }
    }
  }
}

}  // namespace

void addCommonOptions(CLI::App& command, CommonOptions& options) {
  command
      .add_option("SCENE", options.scene, "a file (.glb .gltf .obj .ply .stl ...) or demo:NAME?key=value&...")
      ->required();
  command.add_option("--json", options.json, "write the result as JSON to this file; - is standard output");
  command.add_option("--threads", options.threads, "threads to use")
      ->check(CLI::Range(1u, kMaxThreads))
      ->capture_default_str();
}

void addPathOptions(CLI::App& command, PathOptions& options) {
  command.add_option(
      "--path", options.path,
      "camera path: a JSON file or the name of a walk of the scene (default: walk.path.json beside the "
      "scene's file, or else the scene's first walk or camera)");
  command.add_option("--frames", options.frames,
                     "only frames A, A+STEP, ... before B, as A:B[:STEP]; or one frame's number");
}

Result<std::vector<std::uint32_t>> chooseFrames(const std::string& text, std::size_t count) {
  const std::string form = fmt::format(
      "--frames: '{}' is not A:B, A:B:STEP or one number with A < B and STEP > 0; the path has {} frames",
      text, count);
  std::uint32_t numbers[3] = {0, static_cast<std::uint32_t>(count), 1};
  if (!text.empty()) {
    const std::vector<std::string> parts = splitAt(text, ':');
    if (parts.size() > 3) {
      return Error{form};
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::optional<std::uint32_t> value = parseNumber(parts[i]);
      if (!value) {
        return Error{form};
      }
      numbers[i] = *value;
    }
    if (parts.size() == 1) {
      numbers[1] = numbers[0] < count ? numbers[0] + 1 : numbers[0];
    }
  }
  const auto [begin, end, step] = numbers;
  if (begin >= end || step == 0 || begin >= count) {
    return Error{form};
  }
  std::vector<std::uint32_t> frames;
  for (std::uint64_t frame = begin; frame < std::min<std::uint64_t>(end, count); frame += step) {
    frames.push_back(static_cast<std::uint32_t>(frame));
  }
  return frames;
}

MethodOptions::MethodOptions() {
  const CullerSettings defaults;
  method = nameOf(kMethods, defaults.method);
  variant = nameOf(kVariants, defaults.variant);
  occluder_count = std::to_string(defaults.occluder_count);
  hierarchy = nameOf(kHierarchies, HierarchySettings{}.kind);
  coherence = nameOf(kSwitch, defaults.temporal_coherence);
  occluders = kOccluderChoice;
  area_angle = nameOf(kAreaAngleDirections, defaults.area_angle_direction);
  test_objects = nameOf(kSwitch, defaults.test_objects);
  min_node_cost = defaults.min_node_cost;
  lambda_steps = defaults.lambda_steps;
}

void addMethodOptions(CLI::App& command, MethodOptions& options, bool lists) {
  const std::string several = lists ? " (several: a,b,c)" : "";
  const auto add = [&](const char* name, std::string& value, const std::string& text) {
    command.add_option(name, value, text + several)->capture_default_str();
  };
  add("--method", options.method, listNames(kMethods));
  add("--variant", options.variant, "of the occlusion tree: " + listNames(kVariants));
  add("--occluder-count", options.occluder_count, "most occluders in a frame");
  add("--hierarchy", options.hierarchy, listNames(kHierarchies));
  add("--coherence", options.coherence, "temporal coherence: " + listNames(kSwitch));
  command
      .add_option("--occluders", options.occluders,
                  fmt::format("how occluders are chosen: {}", kOccluderChoice))
      ->capture_default_str();
  command.add_option("--min-node-cost", options.min_node_cost, "nodes with fewer triangles are not tested")
      ->check(CLI::Range(0u, 1'000'000'000u))
      ->capture_default_str();
  command
      .add_option("--lambda-steps", options.lambda_steps,
                  "occluders are looked for within so many steps of the observer; 0: everywhere")
      ->capture_default_str();
  command
      .add_option("--area-angle", options.area_angle,
                  "direction that ranks occluders: " + listNames(kAreaAngleDirections))
      ->capture_default_str();
  command
      .add_option("--test-objects", options.test_objects,
                  "objects of partly visible leaves are tested one by one: " + listNames(kSwitch))
      ->capture_default_str();
}

Result<std::vector<Setting>> settingsOf(const MethodOptions& options) {
  const Result<Lists> lists = parseLists(options);
  if (!lists) {
    return lists.error();
  }
  const Result<CullerSettings> common = parseCommon(options);
  if (!common) {
    return common.error();
  }
  std::vector<Setting> settings;
  for (const CullMethod method : lists->methods) {
    for (const HierarchyKind hierarchy : lists->hierarchies) {
      Setting setting{hierarchy, *common};
      setting.culler.method = method;
      if (method == CullMethod::kOcclusionTree) {
        appendOcclusionTrees(*lists, setting, settings);
      } else {
        settings.push_back(setting);
      }
    }
  }
  return settings;
}

std::string methodName(const Setting& setting) {
  return nameOf(kMethods, setting.culler.method);
}

std::string optionsText(const Setting& setting) {
  const std::string hierarchy = nameOf(kHierarchies, setting.hierarchy);
  if (setting.culler.method != CullMethod::kOcclusionTree) {
    return hierarchy;
  }
  return fmt::format("{}, {} occluders, {}, coherence {}", nameOf(kVariants, setting.culler.variant),
                     setting.culler.occluder_count, hierarchy,
                     nameOf(kSwitch, setting.culler.temporal_coherence));
}

Json optionsJson(const Setting& setting) {
  Json json = {{"hierarchy", nameOf(kHierarchies, setting.hierarchy)}};
  if (setting.culler.method == CullMethod::kOcclusionTree) {
    json["variant"] = nameOf(kVariants, setting.culler.variant);
    json["occluders"] = kOccluderChoice;
    json["occluder_count"] = setting.culler.occluder_count;
    json["coherence"] = nameOf(kSwitch, setting.culler.temporal_coherence);
    json["lambda_steps"] = setting.culler.lambda_steps;
    json["min_node_cost"] = setting.culler.min_node_cost;
    json["area_angle"] = nameOf(kAreaAngleDirections, setting.culler.area_angle_direction);
    json["test_objects"] = nameOf(kSwitch, setting.culler.test_objects);
  }
  return json;
}

}  // namespace sightline::tool
