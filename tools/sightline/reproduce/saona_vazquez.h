#pragma once

// What the experiments of Saona-Vazquez, Navazo and Brunet measure, and the tables and plots made of it.

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sightline/pvs/bake/bake.h"
#include "tools/sightline/cull/info_sight.h"
#include "tools/sightline/reproduce/reproduction.h"
#include "tools/sightline/walk/walk_record.h"

namespace sightline::tool::saona_vazquez {

// What it took to bake a scene.
struct Effort {
  std::uint32_t occluders = 0;
  double plan_s = 0.0, bake_s = 0.0;
  BakeStats stats{};             // max_sample_bytes: of all threads together
  std::uint64_t peak_bytes = 0;  // of the process so far
};

struct Baked {
  SightFile file;
  Effort effort;
};

// Of leaves where viewers are.
struct Leaves {
  std::vector<double> depths{};
  std::vector<std::array<std::uint64_t, kStopReasons>> reasons{};  // by level
};

// One of the navigations, with view-frustum culling and with the octree.
struct Navigation {
  Walk walk;
  WalkRecord record{};
  double first_find_us = 0.0, find_ns = 0.0;  // means of a look-up
};

// All of one scene.
struct Measured {
  const std::string& name;
  const Scene& scene;
  Baked baked;
  SightFacts facts;
  Leaves leaves;
  CullingData data;
  std::vector<Navigation> navigations{};

  bool drawn() const { return !navigations.front().record.device.empty(); }
};

// All experiments, some rows for each scene.
std::vector<Experiment> tablesOf(const std::vector<Measured>& scenes);
// experiments: for what the paper says about them.
Report reportOf(const Measured& measured, const std::vector<Experiment>& experiments,
                const ReproduceOptions& options);

}  // namespace sightline::tool::saona_vazquez
