#pragma once

// The tables of `reproduce poon-wang`, the published figures in them, and what they say.

#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sightline/culling/culler.h"
#include "sightline/render/renderer.h"
#include "tools/sightline/reproduce/reproduction.h"
#include "tools/sightline/walk/walk_record.h"

namespace sightline::tool::poon_wang {

// Cullings as the tables name them.
inline constexpr const char *kFrustum = "VF", *kOpacityMap = "OM", *kPixelwise = "PC",
                            *kPeaksAlways = "OM, peaks always";

// Without rows. picture: the size of the pictures, for titles.
struct Tables {
  Experiment occluder_counts, routes, depth_comparison, criteria, picture_sizes;
};
Tables emptyTables(const std::string& picture);

// Adds the paper's figures to the rows that it has figures for. Picture sizes are in the paper's order.
void addPublished(Tables& tables);

std::vector<Finding> findingsOf(const Tables& tables);

// Figures 7 and 11 of one scene.
struct Pictures {
  std::vector<ReportPicture> pictures{};
  std::vector<ReportFile> files{};  // of the pictures
  // By criterion: its name, and the objects in the frustum that are hidden at figure 7's viewpoint.
  std::vector<std::pair<std::string, std::size_t>> hidden{};
  std::size_t in_frustum = 0;
};
// The scene from above, as each criterion, with its name, culls this view. frustum: culls by the frustum.
void addTopViews(const Scene& scene, CullingData& data, const View& view, Culler& frustum,
                 std::span<const std::pair<std::string, Setting>> criteria, Renderer& renderer,
                 Pictures& pictures);
// All of the scene from above and aside. path: whose camera it is.
void addBirdsEyeView(const Scene& scene, CameraPath path, Renderer& renderer, Pictures& pictures);
// Precondition: the top views are among the pictures.
Finding topViewFinding(const std::string& scene, const Pictures& pictures);

}  // namespace sightline::tool::poon_wang
