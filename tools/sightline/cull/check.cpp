// sightline check: whether what a baked file calls hidden is hidden, by what the bake recorded and by rays.

#include <fmt/format.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <string_view>

#include "oracle/region_proof.h"
#include "oracle/region_search.h"
#include "sightline/io/file.h"
#include "src/io/point_json.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/command_line/options.h"
#include "tools/sightline/command_line/output_files.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/commands.h"
#include "tools/sightline/cull/check_claims.h"
#include "tools/sightline/input/load.h"

namespace sightline::tool {
namespace {

constexpr std::uint32_t kAtOnce = 4096;  // claims between two steps of the progress bar
constexpr std::size_t kMaxListed = 20;   // on the terminal; JSON has all
// One row for each kind of witness, then claims that were witnessed of cells below, those about
// parts of cells that hold no eye, and those without.
constexpr std::size_t kOfCellsBelow = kWitnessKinds, kNoEyes = kWitnessKinds + 1,
                      kWithout = kWitnessKinds + 2, kRows = kWitnessKinds + 3;
constexpr std::array<std::string_view, kRows> kRowNames{"convex",  "surfaces",    "boxes",   "narrowed",
                                                        "divided", "cells below", "no eyes", "without"};

struct CheckOptions {
  CommonOptions common;
  std::string file, witnesses;
  double crack_width = 0.0;
  std::uint32_t rays = 16, seed = 1;
};

struct Claim {
  std::uint32_t leaf = 0, position = 0;
  CellPart part = CellPart::kWhole;
  std::uint64_t first_use = 0;  // into the uses of all claims
  std::uint32_t use_count = 0;
  bool no_eyes = false;
};

enum class Verdict : std::uint8_t { kProved, kSurvived, kContradicted };

struct Row {
  std::uint64_t claims = 0, proved = 0, survived = 0, contradicted = 0;
};

struct CheckReport {
  std::array<Row, kRows> rows{};
  std::uint64_t inherited = 0;  // claims whose witness is of a cell around theirs
  struct False {
    Claim claim;
    RegionAnswer answer;
  };
  std::vector<False> contradicted;

  Row sum() const {
    Row sum;
    for (const Row& row : rows) {
      sum.claims += row.claims;
      sum.proved += row.proved;
      sum.survived += row.survived;
      sum.contradicted += row.contradicted;
    }
    return sum;
  }
};

class Checker {
 public:
  Checker(const CheckOptions& options, const Scene& scene, const SightFile& baked, const Witnesses& witnesses)
      : options_(options),
        scene_(scene),
        baked_(baked),
        octree_(baked.octree()),
        witnesses_(witnesses.all),
        proof_(scene.view()),
        search_(scene.view()),
        threads_(options.common.threads) {
    cells_.resize(octree_.leaves.size());
    forEachLeaf(octree_, [&](std::uint32_t leaf, const OctreeCell& cell) { cells_[leaf] = cell; });
  }

  Result<CheckReport> run() {
    if (const Status ok = checkNames(); !ok) {
      return ok.error();
    }
    if (const Status ok = listClaims(); !ok) {
      return ok.error();
    }
    if (const Status ok = proveUses(); !ok) {
      return ok.error();
    }
    return decideClaims();
  }

 private:
  // Everything that a witness names must be there.
  Status checkNames() const {
    for (std::size_t i = 0; i < witnesses_.size(); ++i) {
      const HidingWitness& w = witnesses_[i];
      const bool names_object = w.kind == WitnessKind::kConvex || w.kind == WitnessKind::kSurfaces;
      if (w.hidden.back().end > baked_.boxes().objects.size() ||
          (names_object && w.object.value >= scene_.objects.size())) {
        return refusal(i, "names an object that the scene does not have");
      }
    }
    return Success{};
  }

  Error refusal(std::size_t witness, const std::string& why) const {
    return Error{fmt::format("{}: witness {} is false: it {}; bake again", options_.witnesses, witness, why)};
  }

  Status listClaims() {
    const WitnessIndex index(witnesses_);
    std::vector<WitnessUse> uses;
    return forEachHidden(baked_, [&](std::uint32_t leaf, const OctreeCell& cell, CellPart part,
                                     const std::vector<std::uint32_t>& hidden) {
      const std::uint64_t number = cellNumber(cell);
      const std::uint32_t plane = octree_.leaves[leaf].plane;
      const auto isEmpty = [&](std::uint64_t below) {
        return plane != OctreeLeaf::kNoPlane &&
               RegionProof::isEmpty(regionOf(octree_, cellOfNumber(below), leaf, part));
      };
      const bool no_eyes = isEmpty(number);
      for (const std::uint32_t position : hidden) {
        uses.clear();
        index.find(number, part, position, isEmpty, uses);
        claims_.push_back(
            {leaf, position, part, uses_.size(), static_cast<std::uint32_t>(uses.size()), no_eyes});
        uses_.insert(uses_.end(), uses.begin(), uses.end());
      }
    });
  }

  ObjectId objectAt(std::uint32_t position) const { return baked_.boxes().objects[position]; }

  RegionClaim claimOf(const EyeRegion& region, std::uint32_t position, ObjectId by) const {
    return {region, objectAt(position), by, baked_.record().near_distance};
  }

  // The region of a witness; nothing for the side of a plane that the file does not have.
  EyeRegion regionOfWitness(const HidingWitness& witness, const CellPlane* plane) const {
    const OctreeCell cell = cellOfNumber(witness.cell);
    EyeRegion region{cellMin(octree_.min, octree_.max, cell), cellMax(octree_.min, octree_.max, cell), {}};
    if (plane != nullptr && witness.part == WitnessPart::kFront) {
      region.sides = {{plane->normal, plane->front}};
    } else if (plane != nullptr && witness.part == WitnessPart::kBack) {
      region.sides = {{-plane->normal, -plane->back}};
    }
    return region;
  }

  // What a witness says of an object, each once. The sides of a cell's plane are of the plane of the leaf
  // that it serves, which is one leaf only.
  Status proveUses() {
    struct Job {
      WitnessUse use;
      std::uint32_t leaf = 0;
    };
    std::vector<Job> jobs;
    jobs.reserve(uses_.size());
    for (const Claim& claim : claims_) {
      for (std::uint64_t i = claim.first_use; i < claim.first_use + claim.use_count; ++i) {
        jobs.push_back({uses_[i], claim.leaf});
      }
    }
    std::sort(jobs.begin(), jobs.end(), [](const Job& a, const Job& b) { return a.use < b.use; });
    jobs.erase(
        std::unique(jobs.begin(), jobs.end(), [](const Job& a, const Job& b) { return a.use == b.use; }),
        jobs.end());
    std::vector<std::uint8_t> is_proved(jobs.size(), 0), is_false(jobs.size(), 0);
    forAll("checking witnesses", jobs.size(), [&](std::size_t i) {
      const HidingWitness& witness = witnesses_[jobs[i].use.witness];
      const std::uint32_t plane = octree_.leaves[jobs[i].leaf].plane;
      const CellPlane* divides = plane == OctreeLeaf::kNoPlane ? nullptr : &octree_.planes[plane];
      const RegionClaim claim = claimOf(regionOfWitness(witness, divides), jobs[i].use.position,
                                        witness.kind == WitnessKind::kConvex ? witness.object : ObjectId());
      is_proved[i] = proof_.proves(claim) ? 1 : 0;
      const bool first = i == 0 || jobs[i - 1].use.witness != jobs[i].use.witness;
      is_false[i] =
          (first && hasFalseLine(witness, claim.region)) || (is_proved[i] == 0 && refuted(witness, claim));
    });
    for (std::size_t i = 0; i < jobs.size(); ++i) {
      if (is_false[i] != 0) {
        return refusal(jobs[i].use.witness,
                       "says that object " + std::to_string(witnesses_[jobs[i].use.witness].object.value) +
                           " hides object " + std::to_string(objectAt(jobs[i].use.position).value) +
                           ", but a line of sight between misses it");
      }
      if (is_proved[i] != 0) {
        proved_.push_back(jobs[i].use);
      }
    }
    return Success{};
  }

  bool hasFalseLine(const HidingWitness& witness, const EyeRegion& region) const {
    return witness.kind == WitnessKind::kSurfaces &&
           (!region.contains(witness.from) || proof_.misses(witness.from, witness.to, witness.object));
  }

  bool refuted(const HidingWitness& witness, const RegionClaim& claim) const {
    return witness.kind == WitnessKind::kConvex && proof_.refutesObject(claim);
  }

  std::size_t rowOf(const Claim& claim) const {
    return claim.use_count == 0  ? (claim.no_eyes ? kNoEyes : kWithout)
           : claim.use_count > 1 ? kOfCellsBelow
                                 : static_cast<std::size_t>(witnesses_[uses_[claim.first_use].witness].kind);
  }

  Result<CheckReport> decideClaims() {
    std::vector<Verdict> verdicts(claims_.size(), Verdict::kProved);
    std::vector<std::uint32_t> open;
    for (std::uint32_t i = 0; i < claims_.size(); ++i) {
      const Claim& claim = claims_[i];
      const auto first = uses_.begin() + static_cast<std::ptrdiff_t>(claim.first_use);
      const bool proved =
          claim.use_count > 0 && std::all_of(first, first + claim.use_count, [&](const WitnessUse& use) {
            return std::binary_search(proved_.begin(), proved_.end(), use);
          });
      if (!proved) {
        open.push_back(i);
      }
    }
    std::vector<RegionAnswer> answers(open.size());
    RegionSearchSettings settings;
    settings.near_distance = baked_.record().near_distance;
    settings.lines = options_.rays;
    settings.planes = settings.eyes = 0;
    forAll("checking claims", open.size(), [&](std::size_t i) {
      const Claim& claim = claims_[open[i]];
      const EyeRegion region = regionOf(octree_, cells_[claim.leaf], claim.leaf, claim.part);
      if (proof_.proves(claimOf(region, claim.position, {}))) {
        return;
      }
      verdicts[open[i]] = Verdict::kSurvived;
      const std::uint64_t seed = std::uint64_t{open[i]} << 32 | options_.seed;
      answers[i] = search_.contradict(region, objectAt(claim.position), settings, seed);
      if (answers[i].found) {
        verdicts[open[i]] = Verdict::kContradicted;
      }
    });
    CheckReport report;
    for (std::size_t i = 0; i < claims_.size(); ++i) {
      Row& row = report.rows[rowOf(claims_[i])];
      row.claims += 1;
      row.proved += verdicts[i] == Verdict::kProved ? 1 : 0;
      row.survived += verdicts[i] == Verdict::kSurvived ? 1 : 0;
      row.contradicted += verdicts[i] == Verdict::kContradicted ? 1 : 0;
      report.inherited += claims_[i].use_count == 1 && witnesses_[uses_[claims_[i].first_use].witness].cell <
                                                           cellNumber(cells_[claims_[i].leaf])
                              ? 1
                              : 0;
    }
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (answers[i].found) {
        report.contradicted.push_back({claims_[open[i]], answers[i]});
      }
    }
    return report;
  }

  template <typename Do>
  void forAll(const char* what, std::size_t count, Do&& work) {
    ProgressBar progress(what);
    for (std::size_t first = 0; first < count; first += kAtOnce) {
      const auto size = static_cast<std::uint32_t>(std::min<std::size_t>(kAtOnce, count - first));
      threads_.parallelFor()(size, [&](std::uint32_t begin, std::uint32_t end) {
        for (std::size_t i = first + begin; i < first + end; ++i) {
          work(i);
        }
      });
      progress.update(static_cast<double>(first + size) / static_cast<double>(count));
    }
  }

  const CheckOptions& options_;
  const Scene& scene_;
  const SightFile& baked_;
  const OctreeView octree_;
  const std::vector<HidingWitness>& witnesses_;
  const RegionProof proof_;
  const RegionSearch search_;
  const Threads threads_;
  std::vector<OctreeCell> cells_;
  std::vector<Claim> claims_;
  std::vector<WitnessUse> uses_, proved_;  // proved_: ascending
};

Result<Witnesses> loadWitnesses(const std::string& file, const SightFile& baked) {
  if (file.empty()) {
    return Witnesses{};
  }
  const Result<std::string> text = readFile(file);
  if (!text) {
    return text.error();
  }
  Result<Witnesses> witnesses = readWitnesses(std::as_bytes(std::span(*text)), file);
  const OctreeView octree = baked.octree();
  if (witnesses && (witnesses->scene != baked.scene() || witnesses->root_min != octree.min ||
                    witnesses->root_max != octree.max)) {
    return Error{file + ": is of another bake; give the witnesses that were written with the baked file"};
  }
  return witnesses;
}

Json rowJson(const Row& row) {
  return {{"claims", row.claims},
          {"proved", row.proved},
          {"survived", row.survived},
          {"contradicted", row.contradicted}};
}

std::string toJson(const CheckReport& report, const Scene& scene, const CrackClosing& closing,
                   const CheckOptions& options) {
  Json kinds = Json::object();
  for (std::size_t i = 0; i < kRows; ++i) {
    kinds[std::string(kRowNames[i])] = rowJson(report.rows[i]);
  }
  Json contradicted = Json::array();
  for (const CheckReport::False& one : report.contradicted) {
    const Vec3d eye = one.answer.eye + scene.origin, point = one.answer.witness.point + scene.origin;
    contradicted.push_back({{"cell", one.claim.leaf},
                            {"object", one.answer.witness.object.value},
                            {"eye", io::pointJson(eye)},
                            {"point", io::pointJson(point)}});
  }
  Json json = rowJson(report.sum());
  json["scene"] = sceneJson(scene, closing);
  json["seed"] = options.seed;
  json["rays"] = options.rays;
  json["inherited"] = report.inherited;
  json["kinds"] = kinds;
  json["contradictions"] = contradicted;
  return dump(json);
}

void print(const CheckReport& report, const Scene& scene) {
  for (std::size_t i = 0; i < std::min(report.contradicted.size(), kMaxListed); ++i) {
    const CheckReport::False& one = report.contradicted[i];
    const Vec3d eye = one.answer.eye + scene.origin, point = one.answer.witness.point + scene.origin;
    const std::uint32_t object = one.answer.witness.object.value;
    fmt::print(
        "contradicted: object {} '{}' is not in the set of cell {}, but from {:.9f} {:.9f} {:.9f} it is seen "
        "at "
        "{:.9f} {:.9f} {:.9f}\n",
        object, scene.object_names[object], one.claim.leaf, eye.x, eye.y, eye.z, point.x, point.y, point.z);
  }
  if (report.contradicted.size() > kMaxListed) {
    fmt::print("... and {} more; --json lists all\n", report.contradicted.size() - kMaxListed);
  }
  fmt::print("{:<12} {:>10} {:>10} {:>14} {:>12}\n", "witness", "claims", "proved", "only survived",
             "contradicted");
  for (std::size_t i = 0; i < kRows; ++i) {
    const Row& row = report.rows[i];
    if (row.claims > 0) {
      fmt::print("{:<12} {:>10} {:>10} {:>14} {:>12}\n", kRowNames[i], row.claims, row.proved, row.survived,
                 row.contradicted);
    }
  }
  const Row sum = report.sum();
  fmt::print(
      "{} claims that an object is hidden from a cell: {} proved, {} only survived rays, {} contradicted\n",
      sum.claims, sum.proved, sum.survived, sum.contradicted);
  if (report.inherited > 0) {
    fmt::print("{} of them rest on the claim of a cell around theirs\n", report.inherited);
  }
}

Result<ExitCode> runCheck(const CheckOptions& options) {
  if (const Status ok = checkFiles({.scenes = {options.common.scene},
                                    .inputs = {{"FILE", options.file}, {"--witnesses", options.witnesses}},
                                    .outputs = {{"--json", options.common.json}}});
      !ok) {
    return ok.error();
  }
  Result<Scene> scene = loadScene(options.common.scene);
  if (!scene) {
    return scene.error();
  }
  const CrackClosing closing = closeCracksOf(*scene, options.crack_width);
  const Result<std::optional<SightFile>> baked = loadBaked(options.file, *scene);
  if (!baked) {
    return baked.error();
  }
  const Result<Witnesses> witnesses = loadWitnesses(options.witnesses, **baked);
  if (!witnesses) {
    return witnesses.error();
  }
  const Result<CheckReport> report = Checker(options, *scene, **baked, *witnesses).run();
  if (!report) {
    return report.error();
  }
  if (const Status ok = writeOutput(
          options.common.json, options.common.json.empty() ? "" : toJson(*report, *scene, closing, options));
      !ok) {
    return ok.error();
  }
  if (options.common.textOnStdout()) {
    print(*report, *scene);
  }
  return report->contradicted.empty() ? kOk : kCheckFailed;
}

}  // namespace

void addCheck(CLI::App& app, Command& chosen) {
  CLI::App* command =
      app.add_subcommand("check", "whether what a baked file calls hidden from its cells is hidden");
  const auto options = std::make_shared<CheckOptions>();
  command->add_option("FILE", options->file, "what `sightline bake` wrote, F.sight")
      ->required()
      ->type_name(kFileType);
  addCommonOptions(*command, options->common);
  command
      ->add_option("--witnesses", options->witnesses,
                   "what `sightline bake --witnesses` wrote with it (default: proofs are found without)")
      ->type_name(kFileType);
  addCrackWidthOption(*command, options->crack_width);
  command
      ->add_option("--rays", options->rays,
                   "random lines of sight that try to contradict each claim that is not proved, at most")
      ->check(CLI::Range(0u, 1000000u))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "seed of the lines")
      ->check(CLI::Range(0u, 4294967295u))
      ->capture_default_str();
  command->footer(
      "Every pair of a cell and an object that is not in its set is a claim. It is proved by the scene's "
      "triangles "
      "alone: one closed convex body or one surface hides the object's box. Proofs share no code with the "
      "bake. What "
      "is not proved is tried by lines of sight, which prove nothing. Exit code 1: a claim is contradicted; "
      "2: a "
      "witness is false, or a file is damaged or of another scene.\n"
      "Examples:\n"
      "  sightline bake city.glb -o city.sight --witnesses city.witnesses\n"
      "  sightline check city.sight city.glb --witnesses city.witnesses --threads 8");
  command->callback([options, &chosen] { chosen = [options] { return runCheck(*options); }; });
}

}  // namespace sightline::tool
