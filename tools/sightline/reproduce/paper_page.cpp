#include "tools/sightline/reproduce/paper_page.h"

#include <fmt/format.h>

#include "tools/sightline/report/markup.h"
#include "tools/sightline/report/report.h"

namespace sightline::tool {
namespace {

std::string linkTo(const PageLink& link) {
  return "<a href=\"" + relativeLink(link.file) + "\">" + escapeMarkup(link.title) + "</a>";
}

std::string cellOf(const Json& row, const Column& column) {
  if (!row.contains(column.key) || row[column.key].is_null()) {
    return "–";
  }
  return column.decimals < 0 ? escapeMarkup(row[column.key].get<std::string>())
                             : groupedNumber(row[column.key].get<double>(), column.decimals);
}

void addTable(std::string& out, const Experiment& experiment) {
  out += "<h2>" + escapeMarkup(experiment.title) + "</h2>\n";
  if (!experiment.claim.empty()) {
    out += "<p>The paper: " + escapeMarkup(experiment.claim) + "</p>\n";
  }
  out += "<div class=\"scroll\"><table>\n<thead><tr>";
  for (const Column& column : experiment.columns) {
    out += "<th>" + escapeMarkup(column.head) + "</th>";
  }
  out += "</tr></thead>\n<tbody>\n";
  for (const Json& row : experiment.rows) {
    out += "<tr>";
    for (const Column& column : experiment.columns) {
      out += "<td>" + cellOf(row, column) + "</td>";
    }
    out += "</tr>\n";
  }
  out += "</tbody></table></div>\n<p class=\"hint\">" +
         linkTo({experiment.key + ".csv", experiment.key + ".csv"}) + "</p>\n";
}

void addFindings(std::string& out, const std::vector<Finding>& findings) {
  if (findings.empty()) {
    return;
  }
  out += "<ul>\n";
  for (const Finding& finding : findings) {
    out += fmt::format("<li><span class=\"{}\">{}</span>: {}. <i>Here: {}.</i></li>\n",
                       finding.agrees ? "good" : "bad", finding.agrees ? "agrees" : "differs",
                       escapeMarkup(finding.claim), escapeMarkup(finding.text));
  }
  out += "</ul>\n";
}

void addNotes(std::string& out, const std::vector<std::string>& notes) {
  for (const std::string& note : notes) {
    out += "<p>" + escapeMarkup(note) + "</p>\n";
  }
}

void addCommand(std::string& out, const std::string& command) {
  out += "<h2>Made by</h2>\n<pre>" + escapeMarkup(command) + "</pre>\n";
}

}  // namespace

std::string paperPage(const std::string& title, const std::string& command,
                      const std::vector<PageLink>& reports, const Reproduction& result) {
  std::string out =
      "<p class=\"summary\">The paper's experiments, on the scenes and the machine of today.</p>\n";
  if (!result.findings.empty()) {
    out += "<h2>The paper's statements</h2>\n";
    addFindings(out, result.findings);
  }
  out += "<h2>Pictures and plots</h2>\n<ul>\n";
  for (const PageLink& link : reports) {
    out += "<li>" + linkTo(link) + "</li>\n";
  }
  out += "</ul>\n";
  for (const Experiment& experiment : result.experiments) {
    addTable(out, experiment);
  }
  if (!result.notes.empty()) {
    out += "<h2>Notes</h2>\n";
    addNotes(out, result.notes);
  }
  addCommand(out, command);
  return htmlPage(title, out);
}

std::string papersPage(const std::string& command, const std::vector<PaperSummary>& papers) {
  std::string out =
      "<p class=\"summary\">The experiments of all papers, their published figures beside ours.</p>\n";
  for (const PaperSummary& paper : papers) {
    out += "<h2>" + linkTo(paper.page) + "</h2>\n";
    addFindings(out, paper.findings);
    out += "<p class=\"hint\">";
    const char* separator = "Tables: ";
    for (const std::string& table : paper.tables) {
      out += separator + escapeMarkup(table);
      separator = " · ";
    }
    out += "</p>\n";
    addNotes(out, paper.notes);
    out += "<pre>sightline " + escapeMarkup(paper.measured_by) + "</pre>\n";
  }
  addCommand(out, command);
  return htmlPage("All papers", out);
}

}  // namespace sightline::tool
