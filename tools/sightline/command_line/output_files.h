#pragma once

// Which files a command reads and which it writes, compared before the work: no output may be an input or
// another output. And writing them, each whole or not at all.

#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/io/image.h"

namespace sightline::tool {

// A file and the option that names it.
struct NamedFile {
  std::string option;  // as errors name it: "--json", or "SCENE"
  std::string file;    // empty or "-": none
  // The ending that an output's name must have (".png"); empty: any.
  std::string extension{};
};

// A folder that a command makes, and the files that it always writes there.
struct NamedFolder {
  std::string option, folder;  // folder empty: none
  std::vector<std::string> files;
};

struct CommandFiles {
  std::vector<std::string> scenes{};  // files or demo:NAME; the files beside them are inputs as well
  std::vector<NamedFile> inputs{};    // what is no file (a walk's name, a point) is passed over
  std::vector<NamedFile> outputs{};
  NamedFolder folder{};
};

// An error where an output is the same file as an input or as another output, by whatever name or link it is
// reached; where its name has the wrong ending; where it is a folder, or lies in none. Changes nothing.
Status checkFiles(const CommandFiles& files);

// Makes the folder, and those above it, where there is none. Those that it made are removed again if the
// process is told to end while they are empty.
Status makeFolder(const std::string& folder);

// As writeFile and writePng. Told to end meanwhile, the process ends when the file is whole.
Status saveFile(const std::string& file, std::string_view bytes);
Status savePicture(const Image& image, const std::string& file);

}  // namespace sightline::tool
