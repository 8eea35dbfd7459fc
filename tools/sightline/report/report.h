#pragma once

// The report of a walk: one HTML page that needs nothing outside its folder, without scripts.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "tools/sightline/report/plot.h"

namespace sightline::tool {

struct ReportFact {
  std::string name{}, value{};  // "triangles", "1,104,233"
};

// One method's row in the summary table; all numbers are means over all frames.
struct ReportRow {
  std::string method{}, options{};  // "occlusion-tree", "FME, 32 occluders"
  double triangles = 0.0;           // triangles drawn
  double triangles_share = 1.0;     // relative to those that view-frustum culling draws
  double objects = 0.0;             // objects drawn
  double cull_ms = 0.0, draw_ms = 0.0, frame_ms = 0.0;
  double speed_up = 1.0;      // frame time of view-frustum culling / this one's
  double nodes_tested = 0.0;  // nodes tested by the occlusion structure
  double occluders = 0.0;
  std::optional<std::uint64_t> frames_differing{};  // frames with a wrong picture; empty: not compared
  std::uint64_t frames_tied = 0;  // other frames, which differ by ties of the depth buffer only
};

// A picture of the report. Those of one frame stand side by side, frames in ascending order.
struct ReportPicture {
  std::string file{};  // a name inside the report's folder
  std::string caption{};
  std::uint32_t frame = 0;
  bool plan = false;      // a plan view, the colours of which are explained above all pictures
  std::string heading{};  // of a frame's first picture: stands over the frame in place of its number
  bool coverage = false;  // a coverage map, the colours of which are explained above all pictures
};

struct Report {
  std::string title{};    // the scene's name
  std::string summary{};  // one sentence under the title; may be empty
  std::string command{};  // the command line that made it
  bool drawn = true;      // false: the rows have no times of drawing, and no pictures were compared
  std::vector<ReportFact> facts{};
  std::vector<ReportRow> rows{};  // view-frustum culling is the first
  std::vector<Plot> plots{};
  std::vector<ReportPicture> pictures{};
  std::vector<std::string> notes{};
};

// A page with the style of reports: the title, which is escaped, and below it `body`, which is HTML.
std::string htmlPage(const std::string& title, const std::string& body);

// The page as HTML. All text is treated as untrusted and escaped.
std::string toHtml(const Report& report);

// Writes directory/index.html. The directory must exist; the caller puts the pictures into it.
Status writeReport(const Report& report, const std::string& directory);

}  // namespace sightline::tool
