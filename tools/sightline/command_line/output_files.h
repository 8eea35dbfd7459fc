#pragma once

// Checks, before the work starts, that no output file of a command is one of its inputs or another output.
// Writes files whole or not at all.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/io/image.h"

namespace sightline::tool {

// A file and the option that gives its name.
struct NamedFile {
  std::string option;  // as errors name it, such as "--json" or "SCENE"
  std::string file;    // empty or "-": none
  // The extension that an output's name must have, such as ".png"; empty: any.
  std::string extension{};
};

// A folder that a command makes and the files that it always writes there.
struct NamedFolder {
  std::string option, folder;  // folder empty: none
  std::vector<std::string> files;
};

struct CommandFiles {
  std::vector<std::string> scenes{};  // files or demo:NAME; the files that they name are inputs as well
  std::vector<NamedFile> inputs{};    // texts that name no file (a walk's name, a point) are ignored
  std::vector<NamedFile> outputs{};
  NamedFolder folder{};
};

// Error if an output is the same file as an input or another output, by whatever name or link; if its name
// has the wrong extension; or if it is a folder or its folder does not exist. Changes no file.
Status checkFiles(const CommandFiles& files);

// Makes the folder and those above it if they do not exist. Folders that it made are removed again if the
// process is told to end while they are empty.
Status makeFolder(const std::string& folder);

// writeFile and writePng, except that a process that is told to end meanwhile ends only when the file is
// whole.
Status saveFile(const std::string& file, std::string_view bytes);
Status saveFile(const std::string& file, std::span<const std::string_view> pieces);
Status savePicture(const Image& image, const std::string& file);

}  // namespace sightline::tool
