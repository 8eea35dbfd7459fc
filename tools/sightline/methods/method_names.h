#pragma once

// The values that options of methods may have, and their names on the command line and in JSON.

#include <array>
#include <cstdint>

#include "sightline/comparison/centre_coverage.h"
#include "sightline/comparison/kept_planes.h"
#include "sightline/hierarchy/hierarchy.h"
#include "sightline/occluders/choose_occluders.h"
#include "sightline/occlusion/occlusion_tree.h"
#include "sightline/occlusion/opacity_map.h"
#include "sightline/occlusion/rasteriser.h"
#include "tools/sightline/command_line/names.h"

namespace sightline::tool {

// Where the occluders of a frame come from.
enum class OccluderChoice : std::uint8_t {
  kAreaAngle,  // ranked anew in every frame, among the objects that the last frame kept
  kDatabase,   // the list of an OccluderDatabase, ranked for the view
  // The list of a ViewpointDatabase that was built by this criterion, in its order.
  kMinimumSets,
  kFirstHit,
  kProjectedSize,
};

// How a method uses whole surfaces; kAutomatic: as its default is.
enum class SurfaceOption : std::uint8_t { kAutomatic, kNone, kAlone, kWithOccluders };

// Which planes --method supporting-planes compares boxes with.
enum class PlaneForm : std::uint8_t { kThroughEye, kThroughBox };

inline constexpr std::array<Name<OcclusionTreeVariant>, 4> kVariants{{
    {"FSE", OcclusionTreeVariant::kFSE},
    {"FSC", OcclusionTreeVariant::kFSC},
    {"FME", OcclusionTreeVariant::kFME},
    {"FMC", OcclusionTreeVariant::kFMC},
}};
inline constexpr std::array<Name<HierarchyKind>, 2> kHierarchies{{
    {"kd", HierarchyKind::kKdTree},
    {"bvh", HierarchyKind::kBvh},
}};
inline constexpr std::array<Name<AreaAngleDirection>, 2> kAreaAngleDirections{{
    {"occluder", AreaAngleDirection::kOccluder},
    {"view", AreaAngleDirection::kView},
}};
inline constexpr std::array<Name<TangentSearch>, 2> kTangentSearches{{
    {"tables", TangentSearch::kTables},
    {"all-vertices", TangentSearch::kAllVertices},
}};
inline const std::array<Name<const CoverageRule*>, 2> kCoverages{{
    {"inner", nullptr},
    {"centre", centreCoverage()},
}};
inline constexpr std::array<Name<DepthComparison>, 3> kDepthComparisons{{
    {"sparse", DepthComparison::kSparse},
    {"pixelwise", DepthComparison::kPixelwise},
    {"sparse-always", DepthComparison::kSparseAlways},
}};
inline constexpr std::array<Name<OccluderChoice>, 5> kOccluderChoices{{
    {"area-angle", OccluderChoice::kAreaAngle},
    {"database", OccluderChoice::kDatabase},
    {"minimum-sets", OccluderChoice::kMinimumSets},
    {"projected-size", OccluderChoice::kProjectedSize},
    {"first-hit", OccluderChoice::kFirstHit},
}};
inline constexpr std::array<Name<SurfaceOption>, 4> kSurfaceOptions{{
    {"auto", SurfaceOption::kAutomatic},
    {"none", SurfaceOption::kNone},
    {"alone", SurfaceOption::kAlone},
    {"with-occluders", SurfaceOption::kWithOccluders},
}};
inline constexpr std::array<Name<PlaneForm>, 2> kPlaneForms{{
    {"through-eye", PlaneForm::kThroughEye},
    {"through-box", PlaneForm::kThroughBox},
}};

}  // namespace sightline::tool
