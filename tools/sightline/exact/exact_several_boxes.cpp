#include "tools/sightline/exact/exact_several_boxes.h"

#include <algorithm>
#include <span>
#include <vector>

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

namespace sightline::tool {
namespace {

// The scene, and behind its objects one for each box. A box has a triangle along its diagonal, so that it is
// not empty.
Scene withBoxes(const SceneView& scene, std::span<const Box> boxes) {
  Scene boxed;
  boxed.positions.assign(scene.positions.begin(), scene.positions.end());
  boxed.indices.assign(scene.indices.begin(), scene.indices.end());
  boxed.objects.assign(scene.objects.begin(), scene.objects.end());
  boxed.materials.assign(scene.materials.begin(), scene.materials.end());
  const MaterialId see_through{static_cast<std::uint32_t>(boxed.materials.size())};
  boxed.materials.push_back({.name = "see-through", .opacity = Opacity::kBlended});
  for (const Box& box : boxes) {
    const auto first = static_cast<std::uint32_t>(boxed.positions.size());
    boxed.positions.insert(boxed.positions.end(), {box.min, box.max});
    boxed.objects.push_back({.first_index = static_cast<std::uint32_t>(boxed.indices.size()),
                             .index_count = 3,
                             .material = see_through,
                             .bounds = box});
    boxed.indices.insert(boxed.indices.end(), {first, first + 1, first});
  }
  return boxed;
}

}  // namespace

ExactSeveralBoxes::ExactSeveralBoxes(const SceneView& scene, const ObjectBoxes& boxes)
    : boxes_(boxes),
      boxed_(withBoxes(scene, boxes.boxes)),
      first_box_(static_cast<std::uint32_t>(scene.objects.size())),
      oracle_(std::make_unique<ExactVisibility>(boxed_.view())) {}

ExactSeveralBoxes::~ExactSeveralBoxes() = default;

ExactObjects ExactSeveralBoxes::left(const View& view, const ExactObjects& frame,
                                     const ExactSettings& settings, const ParallelFor& parallel_for) const {
  std::vector<ObjectId> asked;
  for (const std::vector<ObjectId>* objects : {&frame.boxes, &frame.undecided_boxes}) {
    for (const ObjectId object : *objects) {
      for (std::uint32_t box = boxes_.first[object.value]; box < boxes_.first[object.value + 1]; ++box) {
        asked.emplace_back(first_box_ + box);
      }
    }
  }
  const std::vector<Decision> decisions = oracle_->decideBoxes(view, asked, settings.steps, parallel_for);
  ExactObjects left;
  std::size_t next = 0;
  for (const bool decided : {true, false}) {
    for (const ObjectId object : decided ? frame.boxes : frame.undecided_boxes) {
      const std::size_t count = boxes_.of(object).size();
      const std::span<const Decision> own = std::span(decisions).subspan(next, count);
      next += count;
      const auto any = [&](Verdict verdict) {
        return std::any_of(own.begin(), own.end(), [&](const Decision& d) { return d.verdict == verdict; });
      };
      // An object of one box is as it was.
      if (own.empty() ? decided : any(Verdict::kVisible)) {
        left.boxes.push_back(object);
      } else if (own.empty() || any(Verdict::kUndecided)) {
        left.undecided_boxes.push_back(object);
      }
    }
  }
  std::sort(left.boxes.begin(), left.boxes.end());
  std::sort(left.undecided_boxes.begin(), left.undecided_boxes.end());
  return left;
}

ExactKey severalBoxesKey(ExactKey key, const ObjectBoxes& boxes) {
  const std::uint64_t sums[] = {pvs::checksumOf(std::as_bytes(std::span(boxes.first))),
                                pvs::checksumOf(std::as_bytes(std::span(boxes.boxes)))};
  const std::span<const std::byte> bytes = std::as_bytes(std::span(sums));
  key.bytes.insert(key.bytes.end(), bytes.begin(), bytes.end());
  return key;
}

}  // namespace sightline::tool
