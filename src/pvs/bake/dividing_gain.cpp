// Based on: Saona-Vazquez, Navazo, Brunet. The Visibility Octree. Computers & Graphics 1999, section 3.2.
// Differs from the paper in: points within the cell are asked about too, because the sets of a large cell's
// corners say little about what its parts will see.

#include "src/pvs/bake/dividing_gain.h"

#include <algorithm>
#include <array>

namespace sightline::pvs {
namespace {

constexpr std::uint64_t kLineWork = 5;  // units of BakeCounts::work, to ask whether a line of sight is clear

}  // namespace

std::uint64_t DividingGain::trianglesSeenFrom(const Vec3d& eye) {
  hidden_.reset(static_cast<std::uint32_t>(scene_.boxes.objects.size()));
  Sample& sample = samples_.at(eye);
  for (const std::uint32_t i : occluders_.ranked()) {
    const ConvexOccluder& occluder = scene_.occluders[i];
    if (!hidden_.contains(scene_.position_of_occluder[i]) &&
        separated(scene_.occluders, occluder, std::span(&eye, 1), scene_.settings.near_distance)) {
      hidden_.add(samples_.hidden(sample, i));
    }
  }
  hidden_.complement(seen_);
  return scene_.triangles.of(seen_);
}

bool DividingGain::seesFewer(const Vec3d& eye, double triangles) {
  const CellOccluders::Choice& choice = occluders_.choice();
  const std::array numbers{choice.distance, static_cast<double>(choice.level)};
  Answer answer{.kind = AnswerKind::kPoint, .question = questionOf(std::span(&eye, 1), numbers)};
  ++counts_.questions;
  counts_.work += scene_.boxes.objects.size();
  if (recall_.boundTriangles(eye, answer)) {
    const bool fewer = static_cast<double>(answer.most) < triangles;
    if (fewer || !(static_cast<double>(answer.least) < triangles)) {
      recall_.keep(std::move(answer));
      return fewer;
    }
  }
  ++counts_.asked;
  if (scene_.sampleBytes() > 0) {
    answer.least = answer.most = trianglesSeenFrom(eye);
  } else {
    const ConvexSearch::Bounds seen = search_.trianglesSeenFrom(eye, choice, triangles);
    answer.least = seen.least;
    answer.most = seen.most;
  }
  const bool fewer = static_cast<double>(answer.most) < triangles;
  recall_.keep(std::move(answer));
  return fewer;
}

double DividingGain::shareSeenFrom(const Vec3d& point, const Runs& seen) {
  constexpr std::uint64_t kObjects = 128;  // that are asked about
  constexpr int kLines = 3;                // to each
  std::uint64_t at = 0;
  const std::uint64_t step = countOf(seen) / kObjects + 1;
  double all = 0.0, clear = 0.0;
  std::uint32_t random = 1;
  for (const ObjectRun& run : seen) {
    for (std::uint64_t i = (step - at % step) % step; i < run.end - run.begin; i += step) {
      const auto position = static_cast<std::uint32_t>(run.begin + i);
      const BoxNode& leaf = scene_.leafOf(position);
      all += leaf.triangles;
      for (int line = 0; line < kLines; ++line) {
        counts_.work += kLineWork;
        Vec3d to(leaf.bounds.min);
        for (int axis = 0; axis < 3; ++axis) {
          random = random * 1664525u + 1013904223u;
          to[axis] += double{leaf.bounds.max[axis] - leaf.bounds.min[axis]} * (random >> 8) * 0x1p-24;
        }
        if (surfaces_.isClear(point, to)) {
          clear += leaf.triangles;
          break;
        }
      }
    }
    at += run.end - run.begin;
  }
  return all > 0.0 ? clear / all : 1.0;
}

bool DividingGain::helps(const OctreeCell& cell, double search_distance, const CellSets& sets) {
  const CellBox box = scene_.regionOf(cell);
  occluders_.choose(cell, search_distance, scene_.settings.max_depth);
  std::vector<Vec3d> points{box.centre()};
  for (std::uint32_t i = 0; i < 8; ++i) {
    if (scene_.settings.whole_cells || scene_.holdsViewers(scene_.boxOf(cell.child(i)))) {
      points.push_back(scene_.regionOf(cell.child(i)).centre());
    }
  }
  const std::vector<Vec3d> corners = cornersOf(box);
  points.insert(points.end(), corners.begin(), corners.end());
  return std::any_of(points.begin(), points.end(), [&](const Vec3d& point) {
    const Runs* side = &sets.whole;
    if (sets.plane) {
      const CellSide at = sideOf(*sets.plane, point);
      side = at == CellSide::kFront ? &sets.front : at == CellSide::kBack ? &sets.back : nullptr;
    }
    if (side == nullptr) {
      return false;
    }
    if (scene_.settings.occlusion == BakeOcclusion::kFused) {
      return shareSeenFrom(point, *side) < 1.0 - scene_.settings.similarity;
    }
    const double cell_triangles = static_cast<double>(scene_.triangles.of(*side));
    return seesFewer(point, (1.0 - scene_.settings.similarity) * cell_triangles);
  });
}

}  // namespace sightline::pvs
