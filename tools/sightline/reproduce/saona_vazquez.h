#pragma once

// The results of the experiments of Saona-Vazquez, Navazo and Brunet, and the tables and plots made of them.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sightline/pvs/bake/bake.h"
#include "tools/sightline/cull/info_sight.h"
#include "tools/sightline/reproduce/reproduction.h"
#include "tools/sightline/walk/walk_record.h"

namespace sightline::tool::saona_vazquez {

inline constexpr double kMebibyte = 1024.0 * 1024.0;

// The cost of baking a scene.
struct Effort {
  std::uint32_t occluders = 0;
  double plan_s = 0.0, bake_s = 0.0;
  BakeStats stats{};             // max_sample_bytes is the sum over all threads
  std::uint64_t peak_bytes = 0;  // the process's peak memory so far
  // The same bake in pieces, each by itself: of each, the time and the memory of samples; and of all.
  Spread part_ms{}, part_mib{};
  double whole_s = 0.0, apart_s = 0.0;  // baking alone
  std::uint64_t apart_samples = 0;
};

struct Baked {
  SightFile file;
  Effort effort;
};

// Facts about the leaves where viewers are.
struct Leaves {
  std::vector<double> depths{};
  std::vector<std::array<std::uint64_t, kStopReasons>> reasons{};  // by level
};

// The results of one navigation, with view-frustum culling and with the octree.
struct Navigation {
  Walk walk;
  WalkRecord record{};
  double first_find_us = 0.0, find_ns = 0.0;  // mean time of a look-up: while sets must be decoded, and later
};

// The leaves of an octree of the same depth with another budget.
struct BudgetResult {
  double percent = 0.0;         // of the scene's triangles
  std::uint64_t triangles = 0;  // the budget
  double bake_s = 0.0;
  std::vector<double> depths{};  // of leaves where viewers are
  std::uint64_t met = 0;         // of those: leaves that meet the budget
  double mean_triangles = 0.0;   // that may be seen from a leaf
  std::uint64_t file_bytes = 0;
};

// All results of one scene.
struct Measured {
  const std::string& name;
  const Scene& scene;
  Baked baked;
  SightFacts facts;
  Leaves leaves;
  CullingData data;
  std::vector<Navigation> navigations{};
  std::vector<BudgetResult> budgets{};

  bool drawn() const { return !navigations.front().record.device.empty(); }
};

// The number of voxels of a uniform grid over the scene's box with voxels of the smallest cell's size.
double voxelsInBox(const Measured& measured);
// The share of the leaves that meet the budget.
double metPercent(const BudgetResult& result);

// The tables of all experiments, with some rows for each scene.
std::vector<Experiment> tablesOf(const std::vector<Measured>& scenes);
std::vector<Finding> findingsOf(const std::vector<Measured>& scenes);
// The report of one scene. The paper's claims are taken from `experiments`.
Report reportOf(const Measured& measured, const std::vector<Experiment>& experiments,
                const ReproduceOptions& options);

}  // namespace sightline::tool::saona_vazquez
