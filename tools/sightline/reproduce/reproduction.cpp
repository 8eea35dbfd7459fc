#include "tools/sightline/reproduce/reproduction.h"

#include <fmt/format.h>

#include "tools/sightline/command_line/text_table.h"

namespace sightline::tool {
namespace {

constexpr std::size_t kFewerFrames = 10;  // --short takes one frame in so many

std::string cellText(const Json& row, const Column& column) {
  if (!row.contains(column.key) || row[column.key].is_null()) {
    return "-";
  }
  const Json& value = row[column.key];
  return column.decimals < 0 ? value.get<std::string>()
                             : fmt::format("{:.{}f}", value.get<double>(), column.decimals);
}

}  // namespace

std::vector<std::uint32_t> fewerFrames(const ReproduceOptions& options,
                                       const std::vector<std::uint32_t>& frames) {
  if (!options.fewer_frames || !options.path.frames.empty()) {
    return frames;
  }
  std::vector<std::uint32_t> fewer;
  for (std::size_t i = 0; i < frames.size(); i += kFewerFrames) {
    fewer.push_back(frames[i]);
  }
  return fewer;
}

Result<std::vector<Walk>> namedWalks(const SceneAndWalk& input, const ReproduceOptions& options,
                                     std::span<const char* const> names) {
  std::vector<Walk> walks;
  for (const char* name : names) {
    for (const CameraPath& path : input.scene.paths) {
      if (path.name == name && options.path.path.empty()) {
        const Result<std::vector<std::uint32_t>> frames =
            chooseFrames(options.path.frames, path.frames.size());
        if (!frames) {
          return Error{fmt::format("route {}: {}", name, frames.error().message)};
        }
        walks.push_back({path, fewerFrames(options, *frames)});
      }
    }
  }
  if (walks.empty()) {
    walks.push_back(input.walk);
  }
  return walks;
}

std::string toText(const Experiment& experiment) {
  TextTable table;
  table.left = 0;
  for (const Column& column : experiment.columns) {
    table.head.push_back(column.head);
    table.left += column.decimals < 0 ? 1 : 0;
  }
  for (const Json& row : experiment.rows) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    for (const Column& column : experiment.columns) {
      cells.push_back(cellText(row, column));
    }
  }
  const std::string claim = experiment.claim.empty() ? "" : "The paper: " + experiment.claim + "\n";
  return experiment.title + "\n" + claim + toText(table);
}

std::string toCsv(const Experiment& experiment) {
  std::string text;
  for (const Column& column : experiment.columns) {
    text += (text.empty() ? "" : ",") + csvText(column.key);
  }
  text += "\n";
  for (const Json& row : experiment.rows) {
    const char* separator = "";
    for (const Column& column : experiment.columns) {
      text += separator;
      if (row.contains(column.key) && !row[column.key].is_null()) {
        const Json& value = row[column.key];
        text += value.is_string() ? csvText(value.get<std::string>()) : value.dump();
      }
      separator = ",";
    }
    text += "\n";
  }
  return text;
}

std::string toText(const Finding& finding) {
  return fmt::format("{}: {}\n  Here: {}\n", finding.agrees ? "agrees" : "DIFFERS", finding.claim,
                     finding.text);
}

Json toJson(const Finding& finding) {
  return {{"claim", finding.claim}, {"agrees", finding.agrees}, {"text", finding.text}};
}

Json toJson(const Experiment& experiment) {
  return {{"title", experiment.title}, {"claim", experiment.claim}, {"rows", experiment.rows}};
}

}  // namespace sightline::tool
