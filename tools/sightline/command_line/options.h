#pragma once

// Options that several commands share, except those of culling methods (method_options.h).

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/scene/camera.h"

namespace CLI {
class App;
class Option;
class Validator;
}  // namespace CLI

namespace sightline::tool {

// Refuses an empty word, such as an unset variable of a script.
CLI::Validator isNotEmpty();

// Adds options of finite numbers from min to max.
void addDecimalOption(CLI::App& command, const std::string& name, double& value, double min, double max,
                      const std::string& help);
void addDecimalOption(CLI::App& command, const std::string& name, std::optional<double>& value, double min,
                      double max, const std::string& help);

// Makes all options of numbers that were added read decimals alone. CLI11 would read 010 as 8, and 0x10.
void readDecimalsAlone(CLI::App& app);

// The types of values, as --help, the manual and the completion name them.
inline constexpr const char *kFileType = "FILE", *kFolderType = "DIR";

// Refuses everything but these words; with list, but several of them separated by commas.
CLI::Validator isOneOf(const std::vector<std::string>& words, bool list = false);
// The words of the option's isOneOf validator; empty if it has none.
struct OptionWords {
  std::vector<std::string> words{};
  bool list = false;
};
OptionWords wordsOf(const CLI::Option& option);

// Options of every command.
struct OutputOptions {
  std::string json;  // a file, "-" for stdout, empty for none

  bool textOnStdout() const { return json != "-"; }
};
void addOutputOptions(CLI::App& command, OutputOptions& options);

// Options of commands that work on one scene.
struct SceneOptions : OutputOptions {
  std::string scene;
};
void addSceneOptions(CLI::App& command, SceneOptions& options);

void addThreadsOption(CLI::App& command, std::uint32_t& threads);

// Options of commands that work on one scene with several threads.
struct CommonOptions : SceneOptions {
  std::uint32_t threads = 1;
};
void addCommonOptions(CLI::App& command, CommonOptions& options);

// The name of the camera path through all cells of a baked file (cellPath).
inline constexpr const char* kCellsPath = "cells";

// Options of commands that follow a camera path.
struct PathOptions {
  std::string path;    // a file, the name of one of the scene's walks, or kCellsPath; empty: the default
  std::string frames;  // A:B[:STEP]; empty: all
};
void addPathOptions(CLI::App& command, PathOptions& options);

// The width in metres below which cracks count as closed (closeCracks); 0: all stay open.
void addCrackWidthOption(CLI::App& command, double& width);
// --prepared: see PreparedFile.
void addPreparedOption(CLI::App& command, std::string& file);
// Several of them, separated by commas.
void addCrackWidthsOption(CLI::App& command, std::vector<double>& widths);

// Options of commands that draw pictures.
struct PictureOptions {
  std::uint32_t width = 0, height = 0;  // pixels; 0: the camera path's
};
void addPictureOptions(CLI::App& command, PictureOptions& options);
// The options with the camera path's size in place of 0.
PictureOptions pictureSize(const PictureOptions& options, const CameraPath& path);

// The frames, of `count`, that `text` (A:B[:STEP] or one number) chooses.
Result<std::vector<std::uint32_t>> chooseFrames(const std::string& text, std::size_t count);

}  // namespace sightline::tool
