#include "tools/sightline/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "sightline/io/file.h"
#include "sightline/render/plan_view.h"
#include "tools/sightline/report/depth_colors.h"
#include "tools/sightline/report/markup.h"
#include "tools/sightline/report/report_style.h"

namespace sightline::tool {
namespace {

std::string percent(double share) {
  return groupedNumber(100.0 * share, share < 0.0995 ? 1 : 0) + " %";
}

// The time with three or four digits, whatever its size.
std::string milliseconds(double ms) {
  return groupedNumber(ms, ms < 1.0 ? 3 : ms < 100.0 ? 2 : 0);
}

std::string factor(double f) {
  return groupedNumber(f, f < 100.0 ? 2 : 0) + " ×";
}

std::string tile(const std::string& number, const std::string& text) {
  return "<div class=\"tile\"><b>" + number + "</b><span>" + escapeMarkup(text) + "</span></div>\n";
}

// Adds the headline: the fastest method's gain over view-frustum culling, and whether all pictures are
// correct.
void addTiles(std::string& out, const Report& report) {
  if (report.rows.size() < 2 || !report.drawn) {
    return;
  }
  const auto best =
      std::max_element(report.rows.begin() + 1, report.rows.end(),
                       [](const ReportRow& a, const ReportRow& b) { return a.speed_up < b.speed_up; });
  out += "<div class=\"tiles\">\n";
  const std::string name = best->method + (best->options.empty() ? "" : " (" + best->options + ")");
  out += tile(factor(best->speed_up), "the frame rate of view-frustum culling, with " + name);
  out += tile(percent(best->triangles_share), "of its triangles drawn, by the same method");
  std::uint64_t differing = 0, tied = 0;
  bool compared = false;
  for (const ReportRow& row : report.rows) {
    differing += row.frames_differing.value_or(0);
    tied += row.frames_tied;
    compared = compared || row.frames_differing.has_value();
  }
  if (compared) {
    out += differing == 0
               ? tile("<span class=\"good\">equal</span>",
                      tied == 0 ? "pictures with and without culling, every pixel"
                                : "pictures with and without culling, but for ties of the depth buffer in " +
                                      groupedNumber(static_cast<double>(tied), 0))
               : tile("<span class=\"bad\">" + groupedNumber(static_cast<double>(differing), 0) + "</span>",
                      "pictures differ from those without culling");
  }
  out += "</div>\n";
}

void addFacts(std::string& out, const Report& report) {
  if (report.facts.empty()) {
    return;
  }
  out += "<h2>Scene</h2>\n<dl class=\"facts\">\n";
  for (const ReportFact& fact : report.facts) {
    out += "<div><dt>" + escapeMarkup(fact.name) + "</dt><dd>" + escapeMarkup(fact.value) + "</dd></div>\n";
  }
  out += "</dl>\n";
}

std::string picturesCell(const ReportRow& row) {
  if (!row.frames_differing) {
    return "<td>–</td>";
  }
  const std::string ties =
      row.frames_tied == 0 ? "" : fmt::format("<small>ties in {}</small>", row.frames_tied);
  return *row.frames_differing == 0
             ? "<td class=\"good\">equal" + ties + "</td>"
             : fmt::format("<td class=\"bad\">{} differ{}</td>", *row.frames_differing, ties);
}

void addRow(std::string& out, const ReportRow& row, bool drawn) {
  const double share = std::isfinite(row.triangles_share) ? std::clamp(row.triangles_share, 0.0, 1.0) : 0.0;
  out += "<tr><td>" + escapeMarkup(row.method) + "<small>" + escapeMarkup(row.options) + "</small></td>";
  out += "<td>" + groupedNumber(row.triangles, 0) + "</td>";
  out += fmt::format("<td class=\"share\" style=\"--share: {:.1f}%\">{}</td>", 100.0 * share,
                     percent(row.triangles_share));
  const auto ofDrawing = [drawn](const std::string& cell) { return drawn ? cell : "–"; };
  for (const std::string& cell :
       {groupedNumber(row.objects, 1), milliseconds(row.cull_ms), ofDrawing(milliseconds(row.draw_ms)),
        ofDrawing(milliseconds(row.frame_ms)), ofDrawing(factor(row.speed_up)),
        groupedNumber(row.nodes_tested, 1), groupedNumber(row.occluders, 1)}) {
    out += "<td>" + cell + "</td>";
  }
  out += picturesCell(row) + "</tr>\n";
}

void addTable(std::string& out, const Report& report) {
  if (report.rows.empty()) {
    return;
  }
  out +=
      "<h2>Methods</h2>\n<div class=\"scroll\"><table>\n<thead><tr><th>method</th><th>triangles<br>drawn</th>"
      "<th>of "
      "frustum’s</th><th>objects<br>drawn</th><th>cull<br>ms</th><th>draw<br>ms</th><th>frame<br>ms</th>"
      "<th>speed-up</th><th>nodes<br>tested</th><th>occluders</th><th>pictures</th></tr></thead>\n<tbody>\n";
  for (const ReportRow& row : report.rows) {
    addRow(out, row, report.drawn);
  }
  out +=
      "</tbody></table></div>\n<p class=\"hint\">Means over all frames. Frame is cull plus draw; speed-up is "
      "against "
      "view-frustum culling. Nodes tested: those of the hierarchy asked whether occluders hide them. "
      "Pictures: compared "
      "pixel by pixel with those drawn without occlusion culling.</p>\n";
}

void addPlots(std::string& out, const Report& report) {
  if (report.plots.empty()) {
    return;
  }
  out += "<h2>Frame by frame</h2>\n";
  for (const Plot& plot : report.plots) {
    out += "<div class=\"plot\">\n" + toSvg(plot) + "</div>\n";
  }
}

void addPlanLegend(std::string& out) {
  const auto item = [&out](const PlanColor& c, const char* text) {
    out += fmt::format("<li><i style=\"background: rgb({}, {}, {})\"></i>{}</li>\n", c[0], c[1], c[2], text);
  };
  out += "<ul class=\"legend\">\n";
  item(kPlanKept, "kept: drawn");
  item(kPlanHidden, "hidden: culled by occluders");
  item(kPlanOutside, "outside the view frustum");
  item(paleOf(kPlanKept), "pale: larger than half the picture");
  item(kPlanOccluder, "occluders used");
  item(kPlanCamera, "camera and its frustum");
  out += "</ul>\n";
}

std::string gradientOf(std::span<const DepthColor> ramp) {
  std::string colors;
  for (const DepthColor& c : ramp) {
    colors += fmt::format(", rgb({}, {}, {})", c[0], c[1], c[2]);
  }
  return "linear-gradient(to right" + colors + ")";
}

void addCoverageLegend(std::string& out) {
  const auto item = [&out](const std::string& background, const char* text) {
    out += "<li><i class=\"wide\" style=\"background: " + background + "\"></i>" + text + "</li>\n";
  };
  const DepthColor& none = kUncoveredColor;
  out += "<ul class=\"legend\">\n";
  item(gradientOf(greenRamp()), "covered by whole surfaces, from near to far");
  item(gradientOf(redRamp()), "covered by chosen occluders");
  item(fmt::format("rgb({}, {}, {})", none[0], none[1], none[2]), "not covered: hides nothing");
  out += "</ul>\n";
}

void addPictures(std::string& out, const Report& report) {
  if (report.pictures.empty()) {
    return;
  }
  out += "<h2>Pictures</h2>\n";
  const auto any = [&](bool ReportPicture::*is) {
    return std::any_of(report.pictures.begin(), report.pictures.end(),
                       [is](const ReportPicture& picture) { return picture.*is; });
  };
  if (any(&ReportPicture::plan)) {
    addPlanLegend(out);
  }
  if (any(&ReportPicture::coverage)) {
    addCoverageLegend(out);
  }
  std::map<std::uint32_t, std::vector<const ReportPicture*>> by_frame;
  for (const ReportPicture& picture : report.pictures) {
    by_frame[picture.frame].push_back(&picture);
  }
  for (const auto& [frame, pictures] : by_frame) {
    const std::string& heading = pictures.front()->heading;
    out += fmt::format("<h3>{}</h3>\n<div class=\"frame\">\n",
                       heading.empty() ? fmt::format("Frame {}", frame) : escapeMarkup(heading));
    for (const ReportPicture* picture : pictures) {
      const std::string link = relativeLink(picture->file);
      const std::string caption = escapeMarkup(picture->caption);
      out += "<figure><a href=\"" + link + "\"><img src=\"" + link + "\" alt=\"" + caption +
             "\" loading=\"lazy\"></a><figcaption>" + caption + "</figcaption></figure>\n";
    }
    out += "</div>\n";
  }
}

void addNotes(std::string& out, const Report& report) {
  if (!report.notes.empty()) {
    out += "<h2>Notes</h2>\n<ul>\n";
    for (const std::string& note : report.notes) {
      out += "<li>" + escapeMarkup(note) + "</li>\n";
    }
    out += "</ul>\n";
  }
  if (!report.command.empty()) {
    out += "<h2>Made by</h2>\n<pre>" + escapeMarkup(report.command) + "</pre>\n";
  }
}

}  // namespace

std::string htmlPage(const std::string& title, const std::string& body) {
  const std::string escaped = escapeMarkup(title);
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>" +
         escaped + " – Sightline</title>\n<style>" + kReportStyle +
         "</style>\n</head>\n<body>\n<main>\n<h1>" + escaped + "</h1>\n" + body +
         "</main>\n</body>\n</html>\n";
}

std::string toHtml(const Report& report) {
  std::string out;
  if (!report.summary.empty()) {
    out += "<p class=\"summary\">" + escapeMarkup(report.summary) + "</p>\n";
  }
  addTiles(out, report);
  addTable(out, report);
  addPlots(out, report);
  addPictures(out, report);
  addFacts(out, report);
  addNotes(out, report);
  return htmlPage(report.title, out);
}

Status writeReport(const Report& report, const std::string& directory) {
  return writeFile(directory + "/index.html", toHtml(report));
}

}  // namespace sightline::tool
