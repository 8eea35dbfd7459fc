#pragma once

// The HTML page of a paper with all of its tables, and the page that leads to those of several papers.

#include <string>
#include <vector>

#include "tools/sightline/reproduce/reproduction.h"

namespace sightline::tool {

struct PageLink {
  std::string title{}, file{};  // file: relative to the page
};

// reports: those with pictures and plots.
std::string paperPage(const std::string& title, const std::string& command,
                      const std::vector<PageLink>& reports, const Reproduction& result);

// A paper on the page of all papers, from its reproduce.json.
struct PaperSummary {
  PageLink page{};
  std::string measured_by{};
  std::vector<std::string> tables{};  // titles
  std::vector<Finding> findings{};
  std::vector<std::string> notes{};
};
std::string papersPage(const std::string& command, const std::vector<PaperSummary>& papers);

}  // namespace sightline::tool
