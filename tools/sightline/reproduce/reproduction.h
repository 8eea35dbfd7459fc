#pragma once

// What reproducing a paper yields, whichever paper it is.

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sightline/io/image.h"
#include "tools/sightline/input/load.h"
#include "tools/sightline/report/report.h"

namespace sightline::tool {

struct ReproduceOptions {
  std::string paper;
  OutputOptions output;
  std::uint32_t threads = 1;
  PathOptions path;
  PictureOptions picture;
  std::vector<std::string> scenes;
  bool fewer_frames = false;
  std::string folder;  // of the reports; empty: none
  // Of papers that bake; 0: chosen.
  std::uint32_t depth = 0;
  std::uint64_t triangle_budget = 0;
  std::string command_line;
};

// One frame in ten where the options ask for few and do not say which; otherwise all.
std::vector<std::uint32_t> fewerFrames(const ReproduceOptions& options,
                                       const std::vector<std::uint32_t>& frames);

// The scene's walks of these names, in this order; the walk that was asked for where the user names one or
// the scene has none of them. At least one.
Result<std::vector<Walk>> namedWalks(const SceneAndWalk& input, const ReproduceOptions& options,
                                     std::span<const char* const> names);

// How one value of the rows is printed.
struct Column {
  std::string key;
  std::string head;
  int decimals = -1;  // -1: words
};

// One table. Its rows are JSON objects, as they are written; a value that a row lacks is printed as "-".
struct Experiment {
  std::string key;  // in JSON
  std::string title;
  std::string claim;  // what the paper says, in words: the digits of its tables did not come down to us
  std::vector<Column> columns;
  std::vector<Json> rows{};
};

std::string toText(const Experiment& experiment);
Json toJson(const Experiment& experiment);

// A file beside a report's page: a picture or, where that is empty, text.
struct ReportFile {
  std::string name;
  Image picture{};  // as .png
  std::string text{};
};

struct Reproduction {
  std::vector<Experiment> experiments{};
  std::vector<std::string> notes{};
  std::vector<Report> reports{};    // one a scene; one in all where the paper makes its own
  std::vector<ReportFile> files{};  // of the first report
};

}  // namespace sightline::tool
