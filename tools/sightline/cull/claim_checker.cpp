#include "tools/sightline/cull/claim_checker.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <span>
#include <unordered_map>

#include "oracle/region_proof.h"
#include "oracle/region_search.h"
#include "oracle/split_mix.h"
#include "tools/sightline/command_line/progress_bar.h"
#include "tools/sightline/command_line/threads.h"
#include "tools/sightline/cull/hidden_pairs.h"
#include "tools/sightline/cull/witness_index.h"

namespace sightline::tool {
namespace {

// Claims that are decided together, or a leaf if it has more: enough for all threads.
constexpr std::size_t kClaimsAtOnce = 1 << 14;
// Claims that are judged between two updates of the progress bar.
constexpr std::size_t kJudgedAtOnce = 1 << 10;

struct Claim {
  std::uint32_t leaf = 0, position = 0;  // position: in BoxTree::objects
  CellPart part = CellPart::kWhole;
  bool no_eyes = false;
  FoundWitnesses witnesses{};
};

// What a witness says of an object, judged.
struct JudgedUse {
  WitnessUse use;
  std::uint32_t leaf = 0;  // that asks first
  bool proved = false, refuted = false;
};

bool before(const JudgedUse& a, const JudgedUse& b) {
  return a.use < b.use;
}

enum class ClaimVerdict : std::uint8_t { kProved, kSurvived, kContradicted };

// Whether one object or surface hides all that the witness is about, from all of its region.
bool namesObject(const HidingWitness& witness) {
  return witness.kind == WitnessKind::kConvex || witness.kind == WitnessKind::kSurfaces;
}

CellPart partOf(const HidingWitness& witness) {
  return witness.part == WitnessPart::kFront  ? CellPart::kFront
         : witness.part == WitnessPart::kBack ? CellPart::kBack
                                              : CellPart::kWhole;
}

// A stretch of the progress, 0 to 1, that some work takes.
struct Stretch {
  double from = 0.0, to = 1.0;
};

class Checker {
 public:
  Checker(const SightFile& baked, const Scene& scene, const std::vector<HidingWitness>& witnesses,
          const std::string& witness_file, const ClaimCheckSettings& settings)
      : baked_(baked),
        octree_(baked.octree()),
        scene_(scene),
        witnesses_(witnesses),
        witness_file_(witness_file),
        settings_(settings),
        index_(witnesses),
        proof_(scene.view()),
        search_(scene.view()),
        threads_(settings.threads) {}

  Result<CheckReport> run() {
    if (const Status ok = checkNames(); !ok) {
      return ok.error();
    }
    cells_.resize(octree_.leaves.size());
    std::vector<std::uint32_t> order;
    forEachLeaf(octree_, [&](std::uint32_t leaf, const OctreeCell& cell) {
      cells_[leaf] = cell;
      order.push_back(leaf);
      addViewers(leaf);
    });
    double done = 0.0;
    for (std::size_t i = 0; i < order.size(); ++i) {
      if (const Status ok = addLeaf(order[i]); !ok) {
        return ok.error();
      }
      if (claims_.size() < kClaimsAtOnce && i + 1 < order.size()) {
        continue;
      }
      const double next = static_cast<double>(i + 1) / static_cast<double>(order.size());
      const double middle = 0.5 * (done + next);
      if (const Status ok = judgeUses({done, middle}); !ok) {
        return ok.error();
      }
      decideClaims({middle, next});
      forgetUses(cellNumber(cells_[order[i]]));
      claims_.clear(), uses_.clear();
      done = next;
    }
    return std::move(report_);
  }

 private:
  // Everything that a witness names must be there.
  Status checkNames() const {
    for (std::size_t i = 0; i < witnesses_.size(); ++i) {
      const HidingWitness& w = witnesses_[i];
      if (w.hidden.back().end > baked_.boxes().objects.size() ||
          (namesObject(w) && w.object.value >= scene_.objects.size())) {
        return refusal(i, "names an object that the scene does not have");
      }
    }
    return Success{};
  }

  Error refusal(std::size_t witness, const std::string& why) const {
    return Error{fmt::format("{}: witness {} is false: it {}; bake again", witness_file_, witness, why)};
  }

  // Adds the leaf's viewers to those of the cells around it.
  void addViewers(std::uint32_t leaf) {
    if (octree_.viewers.empty() || octree_.reasons[leaf] == static_cast<std::uint8_t>(StopReason::kOutside)) {
      return;
    }
    const EyeRegion own = regionOf(octree_, cells_[leaf], leaf, CellPart::kWhole);
    for (std::uint64_t cell = cellNumber(cells_[leaf]) / 8; cell > 0; cell /= 8) {
      EyeRegion& around = viewers_.try_emplace(cell, own).first->second;
      around.min = min(around.min, own.min);
      around.max = max(around.max, own.max);
    }
  }

  // The eyes in a cell that a claim about a part of the leaf is about: the leaf's own cell, one below it, or,
  // for what leaves share, one around it.
  EyeRegion eyesIn(std::uint64_t cell, std::uint32_t leaf, CellPart part) const {
    const auto around = viewers_.find(cell);
    if (around == viewers_.end()) {
      return regionOf(octree_, cellOfNumber(cell), leaf, part);
    }
    EyeRegion region = around->second;
    addSide(octree_, leaf, part, region);
    return region;
  }

  Status addLeaf(std::uint32_t leaf) {
    if (octree_.leaves[leaf].plane == OctreeLeaf::kNoPlane) {
      return addPart(leaf, CellPart::kWhole);
    }
    for (const CellPart part : {CellPart::kFront, CellPart::kBetween, CellPart::kBack}) {
      if (const Status ok = addPart(leaf, part); !ok) {
        return ok;
      }
    }
    return Success{};
  }

  Status addPart(std::uint32_t leaf, CellPart part) {
    if (const Status ok = readVisible(baked_, leaf, part, settings_.closed, is_visible_); !ok) {
      return ok;
    }
    hidden_.clear();
    for (std::uint32_t position = 0; position < is_visible_.size(); ++position) {
      if (is_visible_[position] == 0) {
        hidden_.push_back(position);
      }
    }
    // Eyes in a face of a cell alone are also in its neighbour, which has witnesses for them.
    const auto isEmpty = [&](std::uint64_t cell) {
      const EyeRegion region = eyesIn(cell, leaf, part);
      const Vec3d extent = region.max - region.min;
      return std::min({extent.x, extent.y, extent.z}) <= 0.0 ||
             (part != CellPart::kWhole && RegionProof::isEmpty(region));
    };
    const std::uint64_t cell = cellNumber(cells_[leaf]);
    const bool no_eyes = isEmpty(cell);
    index_.find(cell, part, hidden_, isEmpty, uses_, found_);
    for (std::size_t i = 0; i < hidden_.size(); ++i) {
      claims_.push_back({leaf, hidden_[i], part, no_eyes, found_[i]});
    }
    return Success{};
  }

  std::span<const WitnessUse> usesOf(const Claim& claim) const {
    return std::span(uses_).subspan(claim.witnesses.first_use, claim.witnesses.use_count);
  }

  ObjectId objectAt(std::uint32_t position) const { return baked_.boxes().objects[position]; }

  RegionClaim regionClaim(const EyeRegion& region, std::uint32_t position, ObjectId by) const {
    return {region, objectAt(position), by, baked_.record().near_distance};
  }

  // The region of a witness of a leaf's cell, or of one around or below it. A side is that of the leaf's
  // plane; without a plane, no claim rests on a witness of a side.
  EyeRegion regionOfWitness(const HidingWitness& witness, std::uint32_t leaf) const {
    return eyesIn(witness.cell, leaf, partOf(witness));
  }

  // Judges what the claims rest on, each once.
  Status judgeUses(const Stretch& stretch) {
    std::vector<JudgedUse> asked;
    for (const Claim& claim : claims_) {
      for (const WitnessUse& use : usesOf(claim)) {
        asked.push_back({use, claim.leaf});
      }
    }
    std::stable_sort(asked.begin(), asked.end(), before);
    asked.erase(std::unique(asked.begin(), asked.end(),
                            [](const JudgedUse& a, const JudgedUse& b) { return a.use == b.use; }),
                asked.end());
    std::vector<JudgedUse> fresh;
    std::set_difference(asked.begin(), asked.end(), judged_.begin(), judged_.end(), std::back_inserter(fresh),
                        before);
    forAll(fresh.size(), stretch, [&](std::size_t i) {
      judge(fresh[i], i == 0 || fresh[i - 1].use.witness != fresh[i].use.witness);
    });
    const auto false_one =
        std::find_if(fresh.begin(), fresh.end(), [](const JudgedUse& one) { return one.refuted; });
    if (false_one != fresh.end()) {
      const std::uint32_t witness = false_one->use.witness;
      return refusal(witness,
                     fmt::format("says that object {} hides object {}, but a line of sight between "
                                 "misses it",
                                 witnesses_[witness].object.value, objectAt(false_one->use.position).value));
    }
    const auto old = static_cast<std::ptrdiff_t>(judged_.size());
    judged_.insert(judged_.end(), fresh.begin(), fresh.end());
    std::inplace_merge(judged_.begin(), judged_.begin() + old, judged_.end(), before);
    return Success{};
  }

  // with_line: the witness's own line of sight is tried too, which is the same for all that it hides.
  void judge(JudgedUse& one, bool with_line) const {
    const HidingWitness& witness = witnesses_[one.use.witness];
    const RegionClaim claim = regionClaim(regionOfWitness(witness, one.leaf), one.use.position,
                                          witness.kind == WitnessKind::kConvex ? witness.object : ObjectId());
    one.proved = proof_.provesInParts(claim, namesObject(witness) ? 0 : settings_.divisions);
    one.refuted = (with_line && hasFalseLine(witness)) ||
                  (!one.proved && witness.kind == WitnessKind::kConvex && proof_.refutesObject(claim));
  }

  // The line of a side may begin on the other side of the plane: a bake asks about the box around a side. And
  // in a cell around leaves, where none of them expects viewers: there the bake's box may be a little wider.
  bool hasFalseLine(const HidingWitness& witness) const {
    const OctreeCell of = cellOfNumber(witness.cell);
    const EyeRegion cell{cellMin(octree_.min, octree_.max, of), cellMax(octree_.min, octree_.max, of), {}};
    return witness.kind == WitnessKind::kSurfaces &&
           (!cell.contains(witness.from) || proof_.misses(witness.from, witness.to, witness.object));
  }

  bool isProved(const Claim& claim) const {
    const std::span<const WitnessUse> uses = usesOf(claim);
    return !uses.empty() && std::all_of(uses.begin(), uses.end(), [&](const WitnessUse& use) {
      return std::lower_bound(judged_.begin(), judged_.end(), JudgedUse{use}, before)->proved;
    });
  }

  std::size_t rowOf(const Claim& claim) const {
    switch (claim.witnesses.place) {
      case WitnessPlace::kNone:
        return claim.no_eyes ? kNoEyes : kWithout;
      case WitnessPlace::kBelow:
        return kOfCellsBelow;
      default:
        return static_cast<std::size_t>(witnesses_[usesOf(claim).front().witness].kind);
    }
  }

  void decideClaims(const Stretch& stretch) {
    std::vector<ClaimVerdict> verdicts(claims_.size(), ClaimVerdict::kProved);
    std::vector<std::size_t> open;
    for (std::size_t i = 0; i < claims_.size(); ++i) {
      if (!isProved(claims_[i])) {
        open.push_back(i);
      }
    }
    std::vector<ContradictedClaim> found(open.size());
    forAll(open.size(), stretch,
           [&](std::size_t i) { verdicts[open[i]] = decide(claims_[open[i]], found[i]); });
    for (std::size_t i = 0; i < claims_.size(); ++i) {
      CheckRow& row = report_.rows[rowOf(claims_[i])];
      row.claims += 1;
      row.proved += verdicts[i] == ClaimVerdict::kProved ? 1 : 0;
      row.survived += verdicts[i] == ClaimVerdict::kSurvived ? 1 : 0;
      row.contradicted += verdicts[i] == ClaimVerdict::kContradicted ? 1 : 0;
      report_.inherited += claims_[i].witnesses.place == WitnessPlace::kAround ? 1 : 0;
    }
    for (std::size_t i = 0; i < open.size(); ++i) {
      if (verdicts[open[i]] == ClaimVerdict::kContradicted) {
        report_.contradicted.push_back(found[i]);
      }
    }
  }

  // Whether judging what the claim rests on was to ask all that there is to ask about the claim itself.
  bool wasAsked(const Claim& claim) const {
    if (claim.witnesses.place != WitnessPlace::kHere) {
      return false;
    }
    const HidingWitness& witness = witnesses_[usesOf(claim).front().witness];
    return !namesObject(witness) && partOf(witness) == claim.part;
  }

  ClaimVerdict decide(const Claim& claim, ContradictedClaim& found) const {
    const EyeRegion region = regionOf(octree_, cells_[claim.leaf], claim.leaf, claim.part);
    if (!wasAsked(claim) &&
        proof_.provesInParts(regionClaim(region, claim.position, {}), settings_.divisions)) {
      return ClaimVerdict::kProved;
    }
    RegionSearchSettings search;
    search.near_distance = baked_.record().near_distance;
    search.lines = settings_.rays;
    search.planes = search.eyes = 0;
    const ObjectId object = objectAt(claim.position);
    const RegionAnswer answer = search_.contradict(region, object, search, seedOf(claim, object));
    if (!answer.found) {
      return ClaimVerdict::kSurvived;
    }
    found = {claim.leaf, object, answer.eye, answer.witness.point};
    return ClaimVerdict::kContradicted;
  }

  std::uint64_t seedOf(const Claim& claim, ObjectId object) const {
    SplitMix mix{settings_.seed};
    mix.state = mix.next() ^ (std::uint64_t{claim.leaf} * 4 + static_cast<std::uint64_t>(claim.part));
    mix.state = mix.next() ^ object.value;
    return mix.next();
  }

  // Leaves come depth first: of what was judged, only the cells around the last leaf's may be asked about
  // again.
  void forgetUses(std::uint64_t last_cell) {
    std::erase_if(judged_, [&](const JudgedUse& one) {
      const std::uint64_t cell = witnesses_[one.use.witness].cell;
      std::uint64_t around = last_cell / 8;
      while (around > cell) {
        around /= 8;
      }
      return around != cell;
    });
  }

  template <typename Do>
  void forAll(std::size_t count, const Stretch& stretch, Do&& work) {
    for (std::size_t first = 0; first < count; first += kJudgedAtOnce) {
      const std::size_t size = std::min(kJudgedAtOnce, count - first);
      threads_.parallelFor()(static_cast<std::uint32_t>(size), [&](std::uint32_t begin, std::uint32_t end) {
        for (std::size_t i = first + begin; i < first + end; ++i) {
          work(i);
        }
      });
      progress_.update(stretch.from + (stretch.to - stretch.from) * static_cast<double>(first + size) /
                                          static_cast<double>(count));
    }
    progress_.update(stretch.to);
  }

  const SightFile& baked_;
  const OctreeView octree_;
  const Scene& scene_;
  const std::vector<HidingWitness>& witnesses_;
  const std::string& witness_file_;
  const ClaimCheckSettings& settings_;
  const WitnessIndex index_;
  const RegionProof proof_;
  const RegionSearch search_;
  const Threads threads_;
  ProgressBar progress_{"checking claims"};
  std::vector<OctreeCell> cells_;  // of all leaves
  // The box around the viewers of all leaves in a cell, by its number; none if the file says of no cell where
  // viewers are.
  std::unordered_map<std::uint64_t, EyeRegion> viewers_;
  CheckReport report_;

  // The claims that are decided together, what they rest on, and what was judged of that, now or before, and
  // may be asked again.
  std::vector<Claim> claims_;
  std::vector<WitnessUse> uses_;
  std::vector<JudgedUse> judged_;  // ascending

  // Scratch for the part that is added.
  std::vector<std::uint8_t> is_visible_;
  std::vector<std::uint32_t> hidden_;
  std::vector<FoundWitnesses> found_;
};

}  // namespace

CheckRow CheckReport::sum() const {
  CheckRow sum;
  for (const CheckRow& row : rows) {
    sum.claims += row.claims;
    sum.proved += row.proved;
    sum.survived += row.survived;
    sum.contradicted += row.contradicted;
  }
  return sum;
}

Result<CheckReport> checkClaims(const SightFile& baked, const Scene& scene,
                                const std::vector<HidingWitness>& witnesses, const std::string& witness_file,
                                const ClaimCheckSettings& settings) {
  return Checker(baked, scene, witnesses, witness_file, settings).run();
}

}  // namespace sightline::tool
