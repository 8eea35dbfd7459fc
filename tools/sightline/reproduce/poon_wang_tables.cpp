#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <string>

#include "tools/sightline/reproduce/poon_wang.h"
#include "tools/sightline/reproduce/range.h"

namespace sightline::tool::poon_wang {
namespace {

// The columns of a table of cullings: the scene, then `first`, then what all have, then `last`.
std::vector<Column> columnsWith(std::vector<Column> first, const std::vector<Column>& last) {
  first.insert(first.begin(), {"scene", "scene"});
  first.insert(first.end(), {{"culling", "culling"},
                             {"triangles", "triangles", 0},
                             {"culled_percent", "% culled", 2},
                             {"cull_ms", "cull ms", 3},
                             {"frame_ms", "frame ms", 3},
                             {"fps", "frames/s", 1},
                             {"speed_up", "speed-up", 2}});
  first.insert(first.end(), last.begin(), last.end());
  return first;
}

const Column kPublishedFps{"published_fps", "the paper's", 1};
const Column kPublishedSpeedUp{"published_speed_up", "the paper's", 1};

// A published figure for the rows in which two keys have these values.
struct Published {
  const char *key, *value, *culling;
  double fps = 0.0, speed_up = 0.0;  // 0: not published
};
constexpr Published kRoutes[] = {
    {"route", "best", kOpacityMap, 25.5, 14.6}, {"route", "average", kOpacityMap, 26.7, 4.4},
    {"route", "worst", kOpacityMap, 34.6, 0.7}, {"route", "best", kPixelwise, 17.7},
    {"route", "average", kPixelwise, 19.4},     {"route", "worst", kPixelwise, 28.8}};
constexpr Published kCriteria[] = {{"route", "best", "minimum-sets", 25.5},
                                   {"route", "best", "first-hit", 24.5},
                                   {"route", "best", "projected-size", 5.4}};
// These are listed by picture size, in the order of the rows.
constexpr std::array<std::array<double, 2>, 3> kPictureSizes{{{25.6, 14.6}, {20.1, 9.8}, {16.7, 11.6}}};
struct PublishedCount {
  const char* culling;
  std::uint32_t occluders;
  double culled_percent;
};
constexpr PublishedCount kCounts[] = {
    {"minimum-sets", 192, 94.0}, {"first-hit", 384, 94.0}, {"projected-size", 512, 93.0}};

void addFigures(double fps, double speed_up, Json& row) {
  if (fps > 0.0) {
    row[kPublishedFps.key] = fps;
  }
  if (speed_up > 0.0) {
    row[kPublishedSpeedUp.key] = speed_up;
  }
}

template <std::size_t N>
void addPublishedTo(Experiment& experiment, const Published (&figures)[N]) {
  for (Json& row : experiment.rows) {
    for (const Published& figure : figures) {
      if (row["culling"] == figure.culling && row[figure.key] == figure.value) {
        addFigures(figure.fps, figure.speed_up, row);
      }
    }
  }
}

// Calls use(row) for the rows of a culling.
template <typename Use>
void forRows(const Experiment& experiment, const std::string& culling, Use&& use) {
  for (const Json& row : experiment.rows) {
    if (row["culling"] == culling) {
      use(row);
    }
  }
}

// The most that a criterion culls with any number of occluders, percent.
double mostCulled(const Experiment& counts, const std::string& criterion) {
  double most = 0.0;
  forRows(counts, criterion,
          [&](const Json& row) { most = std::max(most, row["culled_percent"].get<double>()); });
  return most;
}

// The smallest number of occluders with which a criterion culls nearly so much; 0: none.
std::uint32_t occludersFor(const Experiment& counts, const std::string& criterion, double percent) {
  constexpr double kNearly = 0.5;
  std::uint32_t needed = 0;
  forRows(counts, criterion, [&](const Json& row) {
    const bool enough = row["culled_percent"].get<double>() >= percent - kNearly;
    needed = needed == 0 && enough ? row["occluders"].get<std::uint32_t>() : needed;
  });
  return needed;
}

Finding countFinding(const Tables& tables) {
  const Experiment& counts = tables.occluder_counts;
  const double sets_most = mostCulled(counts, "minimum-sets"), first_most = mostCulled(counts, "first-hit");
  const double size_most = mostCulled(counts, "projected-size");
  const double all_reach = std::min({sets_most, first_most, size_most});
  const std::uint32_t sets = occludersFor(counts, "minimum-sets", all_reach);
  const std::uint32_t first_hit = occludersFor(counts, "first-hit", all_reach);
  const std::uint32_t size = occludersFor(counts, "projected-size", all_reach);
  return {
      "figure 6: minimum sets cull as much as first-hit with half as many occluders; projected size needs "
      "the most",
      2 * sets <= first_hit && sets < size,
      fmt::format(
          "to cull {:.1f} %, as all criteria do in the end, minimum sets need {}, first-hit {}, "
          "projected size {}. With the most occluders they cull {:.1f}, {:.1f} and {:.1f} %: lists that "
          "are made for a grid point miss what is seen only from beside it",
          all_reach, sets, first_hit, size, sets_most, first_most, size_most)};
}

Finding routeFinding(const Tables& tables) {
  std::vector<double> speed_ups;
  std::string text;
  forRows(tables.routes, kOpacityMap, [&](const Json& row) {
    if (row.contains("speed_up")) {
      speed_ups.push_back(row["speed_up"].get<double>());
      text += fmt::format("{}{:.2f} on {}", text.empty() ? "" : ", ", speed_ups.back(),
                          row["route"].get<std::string>());
    }
  });
  return {"figure 8: the speed-up falls with the depth complexity of the route: 14.6, 4.4, 0.7",
          !speed_ups.empty() && std::is_sorted(speed_ups.rbegin(), speed_ups.rend()),
          text.empty()
              ? "nothing was drawn"
              : text +
                    ". The order is the paper's where depth complexities are; gains are smaller because a "
                    "software renderer spends much of a frame on pixels"};
}

Finding depthFinding(const Tables& tables) {
  Range share, against_pixels;
  std::vector<double> pixelwise_ms, pixels;
  forRows(tables.depth_comparison, kPixelwise, [&](const Json& row) {
    pixelwise_ms.push_back(row["cull_ms"].get<double>());
    pixels.push_back(row["depths_compared"].get<double>());
  });
  std::size_t i = 0;
  forRows(tables.depth_comparison, kPeaksAlways, [&](const Json& row) {
    share.add(100.0 * row["depths_compared"].get<double>() / std::max(1.0, pixels[i]));
    against_pixels.add(row["cull_ms"].get<double>() / pixelwise_ms[i]);
    ++i;
  });
  return {
      "comparing at peaks is faster than at every pixel: 25.5 against 17.7 frames/s",
      !against_pixels.empty() && against_pixels.high < 1.0,
      share.empty()
          ? "there is no route"
          : fmt::format(
                "peaks are {} % of the pixels, but culling takes {} times as long: vector code compares a "
                "row faster than its peaks are found. So rows are looked at for peaks only after they were "
                "compared eight times over, which in a map of 128 x 128 hardly happens",
                share.text(0), against_pixels.text(2))};
}

Finding criteriaFinding(const Tables& tables) {
  std::map<std::string, double> culled, fps;
  std::string text;
  for (const char* criterion : {"minimum-sets", "first-hit", "projected-size"}) {
    forRows(tables.criteria, criterion, [&](const Json& row) {
      culled[criterion] = row["culled_percent"].get<double>();
      fps[criterion] = row.value("fps", 0.0);
      text += fmt::format("{}{:.2f} % ({:.1f} frames/s) with {}", text.empty() ? "" : ", ", culled[criterion],
                          fps[criterion], criterion);
    });
  }
  return {
      "figure 9: on the best route minimum sets and first-hit are close, and much faster than projected "
      "size",
      fps["minimum-sets"] > 2.0 * fps["projected-size"] && fps["first-hit"] > 2.0 * fps["projected-size"],
      text + " are culled: on this route the 64 largest occluders are enough"};
}

Finding sizeFinding(const Tables& tables) {
  Range culled;
  forRows(tables.picture_sizes, kOpacityMap,
          [&](const Json& row) { culled.add(row["culled_percent"].get<double>()); });
  return {"figure 10: what is culled does not depend on the size of the picture",
          !culled.empty() && culled.high - culled.low < 0.01,
          fmt::format("{} %: the map has the same size for all", culled.text(2))};
}

}  // namespace

Tables emptyTables(const std::string& picture) {
  return {
      {"occluder_counts", "Figure 6. Frame rate and triangles culled by the number of occluders",
       "minimum sets reach the best culling, 94 %, with 192 occluders, first-hit with 384; projected size "
       "reaches 93 % with 512.",
       columnsWith({{"occluders", "occluders", 0}}, {{"published_culled_percent", "the paper's %", 0}})},
      {"routes", "Figure 8. Routes of three depth complexities, 64 occluders, " + picture,
       "speed-ups over view-frustum culling (VF) of 14.6, 4.4 and 0.7; pixelwise comparison (PC) 17.7, 19.4 "
       "and 28.8 frames/s against 25.5, 26.7 and 34.6 of the opacity map (OM).",
       columnsWith({{"route", "route"}}, {kPublishedFps, kPublishedSpeedUp})},
      {"depth_comparison",
       "Section 5.3. Depths compared in a frame: at every pixel (PC), at peaks where that takes less time "
       "(OM), "
       "and always at peaks",
       "depth comparison at peaks needs a few of a row's pixels.",
       {{"scene", "scene"},
        {"route", "route"},
        {"culling", "culling"},
        {"depth_tests", "depth tests", 1},
        {"depths_compared", "depths compared", 0},
        {"percent_of_pixelwise", "% of PC's", 1},
        {"sparse_rows", "rows at peaks", 1},
        {"cull_ms", "cull ms", 3}}},
      {"criteria", "Figure 9. Criteria of choosing occluders, best route, 64 occluders",
       "25.5 frames/s with minimum sets, 24.5 with first-hit, 5.4 with projected size.",
       columnsWith({{"route", "route"}}, {kPublishedFps})},
      {"picture_sizes", "Figure 10. Picture sizes, best route",
       "25.6, 20.1 and 16.7 frames/s; what is culled does not depend on the size.",
       columnsWith({{"picture", "picture"}}, {kPublishedFps, kPublishedSpeedUp})}};
}

void addPublished(Tables& tables) {
  addPublishedTo(tables.routes, kRoutes);
  addPublishedTo(tables.criteria, kCriteria);
  for (Json& row : tables.occluder_counts.rows) {
    for (const PublishedCount& figure : kCounts) {
      if (row["culling"] == figure.culling && row["occluders"] == figure.occluders) {
        row["published_culled_percent"] = figure.culled_percent;
      }
    }
  }
  std::size_t size = 0;
  for (Json& row : tables.picture_sizes.rows) {
    if (row["culling"] == kOpacityMap) {
      const auto& [fps, speed_up] = kPictureSizes[size++ % kPictureSizes.size()];
      addFigures(fps, speed_up, row);
    }
  }
}

std::vector<Finding> findingsOf(const Tables& tables) {
  return {countFinding(tables), routeFinding(tables), depthFinding(tables), criteriaFinding(tables),
          sizeFinding(tables)};
}

}  // namespace sightline::tool::poon_wang
