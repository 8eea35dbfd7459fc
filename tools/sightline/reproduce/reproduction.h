#pragma once

// The options and the results of reproducing a paper, common to all papers.

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
  std::string folder;  // for the reports; empty: none are written
  // For papers that bake; 0: chosen by the program.
  std::uint32_t depth = 0;
  std::uint64_t triangle_budget = 0;
  std::string command_line;
};

// One frame in ten if the options ask for few frames without naming them; otherwise all.
std::vector<std::uint32_t> fewerFrames(const ReproduceOptions& options,
                                       const std::vector<std::uint32_t>& frames);

// The scene's walks of these names, in this order, or the chosen walk if the user names one or the scene has
// none of these names. Returns at least one.
Result<std::vector<Walk>> namedWalks(const SceneAndWalk& input, const ReproduceOptions& options,
                                     std::span<const char* const> names);

// How one value of the rows is printed in a table.
struct Column {
  std::string key;
  std::string head;
  int decimals = -1;  // -1 if the values are words
};

// One table. Its rows are JSON objects as they are written to the output; a value that a row lacks is printed
// as "-".
struct Experiment {
  std::string key;  // the table's key in JSON
  std::string title;
  std::string claim;  // the paper's result in words
  std::vector<Column> columns;
  std::vector<Json> rows{};
};

std::string toText(const Experiment& experiment);
Json toJson(const Experiment& experiment);
// Comma-separated values: a line of keys, then the rows; what a row lacks is empty.
std::string toCsv(const Experiment& experiment);

// Whether a statement of the paper holds here.
struct Finding {
  std::string claim;  // the paper's statement
  bool agrees = false;
  std::string text;  // what was measured, and why it is so
};

std::string toText(const Finding& finding);
Json toJson(const Finding& finding);

// A file beside a report's page: a picture or, if that is empty, a text.
struct ReportFile {
  std::string name;
  Image picture{};  // written as PNG
  std::string text{};
  std::size_t report = 0;  // index of the report
};

struct Reproduction {
  std::vector<Experiment> experiments{};
  std::vector<Finding> findings{};
  std::vector<std::string> notes{};
  std::vector<Report> reports{};  // one for each scene, or a single one if the paper makes its own scenes
  std::vector<ReportFile> files{};
};

}  // namespace sightline::tool
