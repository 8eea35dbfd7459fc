#pragma once

#include <span>
#include <string>
#include <vector>

namespace sightline::io {

struct ObjLibraries {
  std::vector<std::string> files;    // that are there, each once, in the order of the statements
  std::vector<std::string> missing;  // names of which there is no file
};

// The .mtl files that mtllib statements with these values name, in the folder of the .obj file. A statement
// may name several files, and names may have spaces in them, quotes around them, and a comment behind them.
ObjLibraries findObjLibraries(std::span<const std::string> values, const std::string& folder);

// The path of a file that is named so in an .obj or .mtl file.
std::string fileNamedInObj(std::string name, const std::string& folder);

}  // namespace sightline::io
