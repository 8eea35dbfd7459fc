#pragma once

// What reproducing a paper leaves behind: a text, JSON, and a folder with a page of all tables, a report for
// each scene, and the tables as CSV.

#include <string>

#include "tools/sightline/reproduce/paper_table.h"

namespace sightline::tool {

// Files in the folder of a paper.
inline constexpr const char *kPage = "index.html", *kTables = "tables.txt", *kJson = "reproduce.json";

// The options that decide what is measured, as on the command line: "reproduce poon-wang --short". Two runs
// with the same text measure the same.
std::string measuredBy(const ReproduceOptions& options);

std::string paperText(const Paper& paper, const Reproduction& result);
std::string paperJson(const ReproduceOptions& options, const Paper& paper, const Reproduction& result);

// Error if an output would be an input or another output.
Status checkFilesOf(const ReproduceOptions& options);
// Writes the folder, reproduce.json last: where that is, the rest is. Error if one of the tables' files is an
// input.
Status writeFolder(const ReproduceOptions& options, const Paper& paper, const Reproduction& result);

}  // namespace sightline::tool
