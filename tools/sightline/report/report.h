#pragma once

// The report of a walk: one HTML page that stands alone in its folder, without scripts and without requests
// elsewhere.

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

// One method's line of the summary table; means over all frames.
struct ReportRow {
  std::string method{}, options{};  // "occlusion-tree", "FME, 32 occluders"
  double triangles = 0.0;           // drawn
  double triangles_share = 1.0;     // of those that view-frustum culling draws
  double objects = 0.0;             // drawn
  double cull_ms = 0.0, draw_ms = 0.0, frame_ms = 0.0;
  double speed_up = 1.0;      // frame time of view-frustum culling / this one's
  double nodes_tested = 0.0;  // asked of the occlusion structure
  double occluders = 0.0;
  std::optional<std::uint64_t> frames_differing{};  // from the picture without culling; empty: not compared
  std::uint64_t frames_tied = 0;                    // besides those: differ by ties of the depth buffer only
};

// Pictures of one frame stand side by side, frames in ascending order.
struct ReportPicture {
  std::string file{};  // a name inside the report's folder
  std::string caption{};
  std::uint32_t frame = 0;
  bool plan = false;      // a plan view: the legend of its colours is shown
  std::string heading{};  // of the frame's first picture: over the frame, in place of its number
};

struct Report {
  std::string title{};    // the scene's name
  std::string summary{};  // one sentence under the title; may be empty
  std::string command{};  // the command line that made it
  std::vector<ReportFact> facts{};
  std::vector<ReportRow> rows{};  // view-frustum culling first
  std::vector<Plot> plots{};
  std::vector<ReportPicture> pictures{};
  std::vector<std::string> notes{};
};

// Any text is taken as untrusted and escaped.
std::string toHtml(const Report& report);

// Writes directory/index.html; the directory exists and the caller puts the pictures beside it.
Status writeReport(const Report& report, const std::string& directory);

}  // namespace sightline::tool
