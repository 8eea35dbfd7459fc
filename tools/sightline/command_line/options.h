#pragma once

// Options that commands share; for how to cull see method_options.h.

#include <cstdint>
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

// Refuses an empty word, as of a variable that a script has not set.
CLI::Validator isNotEmpty();

// What an option takes, as --help, the manual and the shells' completion tell it.
inline constexpr const char *kFileType = "FILE", *kFolderType = "DIR";

// Refuses what is none of these words. list: several of them, separated by commas.
CLI::Validator isOneOf(const std::vector<std::string>& words, bool list = false);
// The words of the option's isOneOf; none where it has no such validator.
struct OptionWords {
  std::vector<std::string> words{};
  bool list = false;
};
OptionWords wordsOf(const CLI::Option& option);

// What every command takes.
struct OutputOptions {
  std::string json;  // a file, "-" for stdout, empty for none

  bool textOnStdout() const { return json != "-"; }
};
void addOutputOptions(CLI::App& command, OutputOptions& options);

// What commands take that work on one scene.
struct SceneOptions : OutputOptions {
  std::string scene;
};
void addSceneOptions(CLI::App& command, SceneOptions& options);

void addThreadsOption(CLI::App& command, std::uint32_t& threads);

// What commands take that work on one scene with several threads.
struct CommonOptions : SceneOptions {
  std::uint32_t threads = 1;
};
void addCommonOptions(CLI::App& command, CommonOptions& options);

// The path through all cells of a baked file, see cellPath.
inline constexpr const char* kCellsPath = "cells";

// What commands take that walk a path.
struct PathOptions {
  std::string path;    // a file, the name of one of the scene's walks, or kCellsPath; empty: the default
  std::string frames;  // A:B[:STEP]; empty: all
};
void addPathOptions(CLI::App& command, PathOptions& options);

// Of the pictures that a command draws.
struct PictureOptions {
  std::uint32_t width = 0, height = 0;  // pixels; 0: the path's
};
void addPictureOptions(CLI::App& command, PictureOptions& options);
// With the path's size where none was given.
PictureOptions pictureSize(const PictureOptions& options, const CameraPath& path);

// The numbers of the frames that `text` (A:B[:STEP], or one number) chooses of `count`.
Result<std::vector<std::uint32_t>> chooseFrames(const std::string& text, std::size_t count);

}  // namespace sightline::tool
