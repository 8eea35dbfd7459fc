#include "tools/sightline/command_line/note.h"

#include <cstdio>

namespace sightline::tool {

void printOnStderr(std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fflush(stderr);
}

}  // namespace sightline::tool
