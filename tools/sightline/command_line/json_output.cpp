#include "tools/sightline/command_line/json_output.h"

#include <fmt/format.h>

#include <cstdio>

#include "sightline/io/file.h"
#include "tools/sightline/command_line/signals.h"

namespace sightline::tool {

std::string dump(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string dumpWithList(const Json& head, const std::string& key, const std::vector<std::string>& items) {
  std::string text = dump(head);
  text.pop_back();  // the closing brace
  text += fmt::format("{}\"{}\":[", head.empty() ? "" : ",", key);
  for (std::size_t i = 0; i < items.size(); ++i) {
    text += (i == 0 ? "\n" : ",\n") + items[i];
  }
  return text + "]}";
}

Status writeOutput(const std::string& target, const std::string& text) {
  if (target.empty()) {
    return Success{};
  }
  const SignalGuard guard;
  if (target != "-") {
    const Status written = writeFile(target, text + "\n");
    if (written) {
      noteWritten(target);
    }
    return written;
  }
  if (std::fputs((text + "\n").c_str(), stdout) < 0 || std::fflush(stdout) != 0) {
    return Error{"cannot write to standard output"};
  }
  noteWritten("standard output");
  return Success{};
}

}  // namespace sightline::tool
