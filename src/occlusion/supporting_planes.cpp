// Based on: Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997, sections 3
// and 4. Differs from the paper in: planes go through the eye instead of the box, so that they serve for all
// boxes of a view, see docs/algorithms/supporting-planes.md.

#include "sightline/occlusion/supporting_planes.h"

#include <algorithm>
#include <vector>

#include "src/occlusion/planes/active_occluders.h"
#include "src/occlusion/planes/list_classifier.h"

namespace sightline {

struct SupportingPlanes::Impl {
  explicit Impl(const SupportingPlanesSettings& settings) : classifier(active, settings.joint_occlusion) {}

  void build(const View& view, std::span<const ChosenOccluders> sets) {
    active.build(view, sets);
    classifier.begin();
  }

  Visibility classify(const Box& box, OccluderList among, OccluderList& touching) {
    if (!box.wellFormed()) {
      touching = {active.endOfLists(), 0};
      return Visibility::kVisible;
    }
    tests.resize(std::max<std::size_t>(tests.size(), among.count));
    const std::uint32_t tested = active.testEach(among, box, tests);
    return classifier.classify(box, among, tested, touching, [this](std::uint32_t i) { return tests[i]; });
  }

  occlusion::ActiveOccluders active;
  occlusion::ListClassifier classifier;
  std::vector<occlusion::EyePlaneTest> tests;  // scratch for one classify() call
};

SupportingPlanes::SupportingPlanes(const SupportingPlanesSettings& settings)
    : impl_(std::make_unique<Impl>(settings)) {}
SupportingPlanes::~SupportingPlanes() = default;
SupportingPlanes::SupportingPlanes(SupportingPlanes&&) noexcept = default;
SupportingPlanes& SupportingPlanes::operator=(SupportingPlanes&&) noexcept = default;

void SupportingPlanes::build(const View& view, const OccluderSet& set, std::span<const OccluderId> chosen) {
  const ChosenOccluders only{&set, chosen};
  impl_->build(view, {&only, 1});
}

void SupportingPlanes::build(const View& view, std::span<const ChosenOccluders> sets) {
  impl_->build(view, sets);
}

OccluderList SupportingPlanes::add(std::span<const OccluderId> more) {
  return impl_->active.hasSets() ? impl_->active.add(0, more) : OccluderList{};
}

OccluderList SupportingPlanes::all() const {
  return impl_->active.all();
}

Visibility SupportingPlanes::classify(const Box& box) {
  OccluderList touching;
  const Visibility visibility = impl_->classify(box, impl_->active.all(), touching);
  impl_->active.truncate(touching.first);
  return visibility;
}

Visibility SupportingPlanes::classify(const Box& box, Item, OccluderList among, OccluderList& touching) {
  return impl_->classify(box, among, touching);
}

SupportingPlanesStats SupportingPlanes::stats() const {
  return impl_->active.stats();
}

std::span<const OccluderId> SupportingPlanes::occluders() const {
  return impl_->active.used();
}

}  // namespace sightline
