#include "tools/sightline/json_output.h"

#include <fmt/format.h>

#include <cstdio>
#include <filesystem>

#include "sightline/io/file.h"

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

Status checkOutput(const std::string& target, const std::string& input) {
  if (target.empty() || target == "-") {
    return Success{};
  }
  std::error_code ignored;
  const std::filesystem::path path(target);
  if (std::filesystem::is_directory(path, ignored)) {
    return Error{fmt::format("{}: is a folder; give the name of a file", target)};
  }
  if (!input.empty() && std::filesystem::equivalent(path, input, ignored)) {
    return Error{fmt::format("{}: is the input itself; name another output", target)};
  }
  const std::filesystem::path folder =
      path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  if (!std::filesystem::is_directory(folder, ignored)) {
    return Error{fmt::format("{}: there is no folder {}; make it first", target, folder.string())};
  }
  return Success{};
}

Status makeFolder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!std::filesystem::is_directory(folder)) {
    return Error{
        fmt::format("{}: cannot make this folder: {}", folder, error ? error.message() : "a file is there")};
  }
  return Success{};
}

Status writeOutput(const std::string& target, const std::string& text) {
  if (target.empty()) {
    return Success{};
  }
  if (target != "-") {
    return writeFile(target, text + "\n");
  }
  if (std::fputs((text + "\n").c_str(), stdout) < 0 || std::fflush(stdout) != 0) {
    return Error{"cannot write to standard output"};
  }
  return Success{};
}

}  // namespace sightline::tool
