#include "tools/sightline/command_line/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <optional>

#include "tools/sightline/command_line/declarations.h"
#include "tools/sightline/command_line/parse_text.h"
#include "tools/sightline/command_line/suggest.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kMaxThreads = 256;
constexpr std::uint32_t kMaxPixels = 16384;
constexpr double kMaxCrackWidth = 1.0;  // metres

// Accepts finite numbers from min to max. CLI::Range would accept "nan".
CLI::Validator decimal(double min, double max) {
  return CLI::Validator(
      [min, max](const std::string& text) {
        const std::optional<double> value = parseDecimal(text);
        return value && *value >= min && *value <= max
                   ? std::string()
                   : fmt::format("'{}' is not a number from {} to {}", text, min, max);
      },
      fmt::format("[{} - {}]", min, max));
}

}  // namespace

void addDecimalOption(CLI::App& command, const std::string& name, double& value, double min, double max,
                      const std::string& help) {
  command.add_option(name, value, help)->check(decimal(min, max))->capture_default_str();
}

void addDecimalOption(CLI::App& command, const std::string& name, std::optional<double>& value, double min,
                      double max, const std::string& help) {
  command.add_option(name, value, help)->check(decimal(min, max));
}

void readDecimalsAlone(CLI::App& app) {
  const CLI::Validator whole(
      [](std::string& word) {
        if (word.empty() || word.find_first_not_of("0123456789") != std::string::npos) {
          return fmt::format("'{}' is not a whole number", word);
        }
        word.erase(0, std::min(word.find_first_not_of('0'), word.size() - 1));
        return std::string();
      },
      "");
  const CLI::Validator number(
      [](std::string& word) {
        return parseDecimal(word) ? std::string() : fmt::format("'{}' is not a number", word);
      },
      "");
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) {
    for (CLI::Option* option : command->get_options()) {
      if (const std::string type = typeOf(*option); type == "UINT" || type == "FLOAT") {
        option->transform(type == "UINT" ? whole : number);
      }
    }
  }
}

CLI::Validator isNotEmpty() {
  return {[](std::string& word) { return std::string(word.empty() ? "is empty" : ""); }, ""};
}

namespace {

// The names by which wordsOf() finds an option's validators.
constexpr const char *kOneWord = "one word", *kListOfWords = "list of words";

}  // namespace

CLI::Validator isOneOf(const std::vector<std::string>& words, bool list) {
  const auto check = [words, list](const std::string& text) {
    for (const std::string& word : list ? splitAt(text, ',') : std::vector{text}) {
      if (std::find(words.begin(), words.end(), word) == words.end()) {
        return fmt::format("'{}' is not one of: {}{}", word, fmt::join(words, ", "), didYouMean(word, words));
      }
    }
    return std::string();
  };
  return CLI::Validator(check, fmt::format("{{{}}}", fmt::join(words, ",")), list ? kListOfWords : kOneWord);
}

OptionWords wordsOf(const CLI::Option& option) {
  for (const bool list : {false, true}) {
    try {
      // CLI11 has no such look-up for options that do not change.
      const CLI::Validator* validator =
          const_cast<CLI::Option&>(option).get_validator(list ? kListOfWords : kOneWord);
      const std::string braced = validator->get_description();
      return {splitAt(braced.substr(1, braced.size() - 2), ','), list};
    } catch (const CLI::OptionNotFound&) {
    }
  }
  return {};
}

void addSceneOptions(CLI::App& command, SceneOptions& options) {
  command
      .add_option("SCENE", options.scene, "a file (.glb .gltf .obj .ply .stl ...) or demo:NAME?key=value&...")
      ->required()
      ->type_name(kFileType)
      ->check(isNotEmpty());
  addOutputOptions(command, options);
}

void addCommonOptions(CLI::App& command, CommonOptions& options) {
  addSceneOptions(command, options);
  addThreadsOption(command, options.threads);
}

void addOutputOptions(CLI::App& command, OutputOptions& options) {
  command.add_option("--json", options.json, "write the result as JSON to this file; - is standard output")
      ->type_name(kFileType);
}

void addThreadsOption(CLI::App& command, std::uint32_t& threads) {
  command.add_option("--threads", threads, "threads to use")
      ->check(CLI::Range(1u, kMaxThreads))
      ->capture_default_str();
}

void addPathOptions(CLI::App& command, PathOptions& options) {
  command
      .add_option(
          "--path", options.path,
          "camera path: a JSON file or the name of a walk of the scene (default: walk.path.json beside the "
          "scene's file, or else the scene's first walk or camera)")
      ->type_name(kFileType);
  command.add_option("--frames", options.frames,
                     "only frames A, A+STEP, ... before B, as A:B[:STEP]; or one frame's number");
}

void addCrackWidthOption(CLI::App& command, double& width) {
  addDecimalOption(command, "--crack-width", width, 0.0, kMaxCrackWidth,
                   "cracks between surfaces that are narrower, in metres, count as closed: what shows only "
                   "through them, or within twice this width beside an edge, may be culled");
}

void addPreparedOption(CLI::App& command, std::string& file) {
  command
      .add_option("--prepared", file,
                  "a file for what is found in the scene once: surfaces, occluders, objects' boxes, "
                  "hierarchies; read as far as it has them, and written if not")
      ->type_name(kFileType);
}

void addCrackWidthsOption(CLI::App& command, std::vector<double>& widths) {
  command
      .add_option(
          "--crack-width", widths,
          "says what closing cracks narrower than this, in metres, hides on the scene's walk; several "
          "widths with commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(decimal(0.0, kMaxCrackWidth));
}

void addPictureOptions(CLI::App& command, PictureOptions& options) {
  command.add_option("--width", options.width, "width of the pictures, pixels (default: the path's)")
      ->check(CLI::Range(1u, kMaxPixels));
  command.add_option("--height", options.height, "height of the pictures, pixels (default: the path's)")
      ->check(CLI::Range(1u, kMaxPixels));
}

PictureOptions pictureSize(const PictureOptions& options, const CameraPath& path) {
  return {options.width > 0 ? options.width : path.width, options.height > 0 ? options.height : path.height};
}

Result<std::vector<std::uint32_t>> chooseFrames(const std::string& text, std::size_t count) {
  const std::string form = fmt::format(
      "--frames: '{}' is not A:B, A:B:STEP or one number with A < B and STEP > 0; the path has {} frames",
      text, count);
  std::uint64_t numbers[3] = {0, count, 1};
  if (!text.empty()) {
    const std::vector<std::string> parts = splitAt(text, ':');
    if (parts.size() > 3) {
      return Error{form};
    }
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::optional<std::uint32_t> value = parseWhole(parts[i]);
      if (!value) {
        return Error{form};
      }
      numbers[i] = *value;
    }
    if (parts.size() == 1) {
      numbers[1] = numbers[0] + 1;
    }
  }
  const auto [begin, end, step] = numbers;
  if (begin >= end || step == 0) {
    return Error{form};
  }
  if (begin >= count) {
    return Error{count == 1
                     ? fmt::format("--frames: '{}' begins beyond the path, whose only frame is 0", text)
                     : fmt::format("--frames: '{}' begins beyond the path, which has {} frames, 0 to {}",
                                   text, count, count - 1)};
  }
  std::vector<std::uint32_t> frames;
  for (std::uint64_t frame = begin; frame < std::min<std::uint64_t>(end, count); frame += step) {
    frames.push_back(static_cast<std::uint32_t>(frame));
  }
  return frames;
}

}  // namespace sightline::tool
