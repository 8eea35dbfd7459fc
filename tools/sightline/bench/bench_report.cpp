#include "tools/sightline/bench/bench_report.h"

#include <fmt/format.h>

#include <algorithm>

#include "tools/sightline/bench/bench_text.h"
#include "tools/sightline/report/markup.h"
#include "tools/sightline/report/report.h"
#include "tools/sightline/report/scatter_plot.h"

namespace sightline::tool {
namespace {

ScatterPlot frontOf(const BenchRecord& record) {
  ScatterPlot plot{.title = "Time against tightness",
                   .x_label = "processor time for culling a mean frame (ms)",
                   .y_label = "kept / exactly visible objects"};
  for (std::size_t r = 0; r < record.runs.size(); ++r) {
    const SettingRecord& run = record.runs[r];
    const std::optional<Interval> tightness = record.overestimate(run);
    const std::string method = methodName(run.setting);
    auto group = std::find(plot.groups.begin(), plot.groups.end(), method);
    if (group == plot.groups.end()) {
      group = plot.groups.insert(group, method);
    }
    const Interval y = tightness.value_or(Interval{});
    plot.points.push_back({.name = fmt::format("{} ({}): {} ms, {}", method, optionsText(run.setting),
                                               milliseconds(run.cullingUs()), intervalText(tightness)),
                           .x = run.cullingUs() * 1e-3,
                           .y_low = y.low,
                           .y_high = y.high,
                           .group = static_cast<std::size_t>(group - plot.groups.begin()),
                           .on_front = run.on_front,
                           .chosen = r == record.advice.run});
  }
  return plot;
}

std::string cell(const std::string& text) {
  return "<td>" + escapeMarkup(text) + "</td>";
}

std::string timeCells(const FrameTimes& times) {
  std::string cells;
  for (const RoundSpread& spread : {times.median, times.mean, times.p99}) {
    cells += fmt::format("<td>{}<small>{} to {}</small></td>", milliseconds(spread.value),
                         milliseconds(spread.low), milliseconds(spread.high));
  }
  return cells;
}

std::string partText(const PartCost& part) {
  const std::string bytes =
      part.bytes ? groupedNumber(static_cast<double>(*part.bytes) / 1024.0, 0) + " KiB" : "–";
  return milliseconds(part.us) + " ms, " + bytes;
}

std::string tableRow(const SettingRecord& run, const BenchRecord& record) {
  const Preparation& parts = run.preparation;
  std::string row = fmt::format("<tr><td>{}<small>{}</small></td>", escapeMarkup(methodName(run.setting)),
                                escapeMarkup(optionsText(run.setting)));
  row += cell(&run == &record.runs[record.advice.run] ? "advised" : run.on_front ? "front" : "");
  row += cell(intervalText(record.overestimate(run)));
  row += run.missed > 0 ? fmt::format("<td class=\"bad\">{}</td>", run.missed) : cell("0");
  row += timeCells(run.cull);
  row += cell(fmt::format("{:.2f} ×", timesBaseline(run.cull.mean, record.baseline().cull.mean)));
  row += cell(milliseconds(run.cpu.mean.value));
  row += cell(run.draw ? milliseconds(run.draw->mean.value) : "–");
  for (const PartCost& part : {parts.hierarchy, parts.occluders, parts.databases, parts.method}) {
    row += cell(partText(part));
  }
  return row + "</tr>\n";
}

std::string tableOf(const BenchRecord& record) {
  std::string out = "<div class=\"scroll\"><table>\n<thead><tr>";
  for (const char* head : {"method", "", "kept /<br>exact", "missed", "cull, ms<br>median", "mean",
                           "99th<br>percentile", "of<br>frustum’s", "processor<br>ms", "draw<br>ms",
                           "hierarchy", "occluders", "databases", "method"}) {
    out += fmt::format("<th>{}</th>", head);
  }
  out += "</tr></thead>\n<tbody>\n";
  for (const SettingRecord& run : record.runs) {
    out += tableRow(run, record);
  }
  return out +
         "</tbody></table></div>\n"
         "<p class=\"hint\">Kept / exact: from all undecided objects being visible to none of them; the line "
         "“boxes” is the least that any test of one bounding box an object can have. Missed: "
         "visible objects that were not kept. Below a time: its least and greatest value in a single round. "
         "Of frustum’s: mean culling time divided by that of view-frustum culling. Processor: mean processor "
         "time of the thread. Hierarchy to method: time to prepare, and memory.</p>\n";
}

}  // namespace

std::string benchReport(const std::vector<BenchRecord>& records, const std::string& command_line) {
  std::string body;
  for (const BenchRecord& record : records) {
    body += "<h2>" + escapeMarkup(record.scene_name) + "</h2>\n<p class=\"summary\">" +
            escapeMarkup(record.advice.sentence) + "</p>\n<div class=\"plot\">\n" + toSvg(frontOf(record)) +
            "</div>\n"
            "<p class=\"hint\">Filled points are on the front: no other one takes less processor time and "
            "keeps no more. The ring marks the setting that is advised.</p>\n" +
            tableOf(record) + "<p class=\"hint\">" + escapeMarkup(benchNotes(record)) + "</p>\n";
  }
  body += "<h2>Made by</h2>\n<pre>" + escapeMarkup(command_line) + "</pre>\n";
  return htmlPage("Benchmark of culling", body);
}

}  // namespace sightline::tool
