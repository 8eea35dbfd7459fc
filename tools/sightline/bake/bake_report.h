#pragma once

// Reports the result of a bake and its cost.

#include <optional>
#include <string>
#include <vector>

#include "sightline/pvs/query/sight_file.h"
#include "tools/sightline/bake/bake_run.h"
#include "tools/sightline/cull/info_sight.h"

namespace sightline::tool {

struct BakeTimes {  // microseconds
  double load = 0.0, plan = 0.0, bake = 0.0, databases = 0.0, write = 0.0;
};

struct BakeReport {
  std::uint64_t plan = 0;  // Bake::hash
  std::uint64_t parts = 0;
  std::uint32_t occluders = 0;
  bool budget_chosen = false;  // the triangle budget was chosen, not given by the user
  bool depth_chosen = false;
  std::optional<Bake::TakenOver> update{};  // with --update
  BakeTimes times{};
  BakeEffort effort{};
};

Json bakeJson(const BakeReport& report, const SightFile& file, const SightFacts& facts);
std::string bakeText(const BakeReport& report, const std::string& name, const SightFile& file,
                     const SightFacts& facts);

}  // namespace sightline::tool
