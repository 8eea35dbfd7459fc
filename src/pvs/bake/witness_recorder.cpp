#include "src/pvs/bake/witness_recorder.h"

#include <algorithm>

namespace sightline::pvs {

void WitnessRecorder::addConvex(std::uint32_t occluder, std::span<const ObjectRun> objects,
                                const ObjectMask& known) {
  const ConvexOccluder& convex = scene_.occluders[occluder];
  add({.kind = WitnessKind::kConvex, .occluder = convex.id.value, .object = convex.object}, objects, known);
}

void WitnessRecorder::addFound(std::span<const ConvexSearch::Found> found, const ObjectMask& known) {
  if (!scene_.settings.witnesses) {
    return;
  }
  std::vector<ConvexSearch::Found> sorted(found.begin(), found.end());
  std::ranges::sort(sorted, {}, [](const auto& f) { return std::pair(f.occluder, f.objects.begin); });
  std::vector<ObjectRun> of_one;
  for (std::size_t i = 0; i < sorted.size();) {
    of_one.clear();
    const std::uint32_t occluder = sorted[i].occluder;
    for (; i < sorted.size() && sorted[i].occluder == occluder; ++i) {
      of_one.push_back(sorted[i].objects);
    }
    addConvex(occluder, of_one, known);
  }
}

void WitnessRecorder::addSurfaces(NodeOcclusion& surfaces, const ObjectRun& objects,
                                  const ObjectMask& known) {
  HidingWitness witness{.kind = surfaces.decidedBy()};
  if (witness.kind == WitnessKind::kSurfaces) {
    const FusedOcclusion::Proof& proof = surfaces.questions().proof();
    witness.object = ObjectId(proof.object);
    witness.from = proof.from;
    witness.to = proof.to;
  }
  add(std::move(witness), std::span(&objects, 1), known);
}

void WitnessRecorder::add(HidingWitness witness, std::span<const ObjectRun> objects,
                          const ObjectMask& known) {
  if (!scene_.settings.witnesses) {
    return;
  }
  witness.cell = cell_;
  witness.part = part_;
  for (const ObjectRun& run : objects) {
    for (std::uint32_t i = run.begin; i < run.end; ++i) {
      if (known.contains(i)) {
        continue;
      }
      if (!witness.hidden.empty() && witness.hidden.back().end == i) {
        witness.hidden.back().end = i + 1;
      } else {
        witness.hidden.push_back({i, i + 1});
      }
    }
  }
  if (!witness.hidden.empty()) {
    witnesses_.push_back(std::move(witness));
  }
}

void WitnessRecorder::forgetSides() {
  const auto other = std::find_if(witnesses_.rbegin(), witnesses_.rend(),
                                  [this](const HidingWitness& witness) { return witness.cell != cell_; });
  witnesses_.erase(
      std::remove_if(other.base(), witnesses_.end(),
                     [](const HidingWitness& witness) { return witness.part != WitnessPart::kWhole; }),
      witnesses_.end());
}

}  // namespace sightline::pvs
