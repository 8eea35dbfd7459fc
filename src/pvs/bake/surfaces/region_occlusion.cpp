#include "src/pvs/bake/surfaces/region_occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <utility>

#include "src/math/infinite_box.h"
#include "src/math/longest_axis.h"

namespace sightline::pvs {
namespace {

// A place on a line is computed from two others on it. This bounds its error in metres, for each metre of
// their coordinates and each time that it is as far away from them as they are from each other.
constexpr double kPlaceRounding = 0x1p-44;
constexpr int kMaxHalves = 2;  // so many are cut off one end of a part in a row, at most
// Random lines of sight that are tried before narrowing, also to the target's surface, and before each
// division of a passage.
constexpr int kLinesBefore = 32, kLinesToSurface = 64, kLinesOfPassage = 16;
// A window is of little use across an axis along which the gap is shorter than this part of the longest one.
constexpr double kLeastGap = 0.25;

// Numbers that are the same for each question.
class RandomNumbers {
 public:
  std::uint32_t next() { return state_ = state_ * 1664525u + 1013904223u; }
  Vec3d pointIn(const CellBox& box) {
    Vec3d point = box.min;
    for (int axis = 0; axis < 3; ++axis) {
      point[axis] += (box.max[axis] - box.min[axis]) * (static_cast<double>(next() >> 8) * 0x1p-24);
    }
    return point;
  }

 private:
  std::uint32_t state_ = 1;
};

struct Interval {
  double low, high;
};

Interval along(const CellBox& box, int axis) {
  return {box.min[axis], box.max[axis]};
}

// Where, along one axis, a line is that passes through places a and b of it, `share` of the way from a to b.
Interval between(const Interval& a, const Interval& b, double share, double rounding) {
  const double from = 1.0 - share, margin = rounding * (std::abs(from) + std::abs(share));
  return {(from >= 0.0 ? a.low : a.high) * from + (share >= 0.0 ? b.low : b.high) * share - margin,
          (from >= 0.0 ? a.high : a.low) * from + (share >= 0.0 ? b.high : b.low) * share + margin};
}

// Narrows a box, across an axis, to where lines are that pass through two others. The three do not overlap
// along the axis. False if nothing is left.
bool narrowToLines(CellBox& box, const CellBox& first, const CellBox& second, int axis, double rounding) {
  const Interval own = along(box, axis), one = along(first, axis), other = along(second, axis);
  for (int across = 0; across < 3; ++across) {
    if (across == axis) {
      continue;
    }
    Interval reach{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
    for (const double at : {own.low, own.high}) {
      for (const double a : {one.low, one.high}) {
        for (const double b : {other.low, other.high}) {
          const Interval place =
              between(along(first, across), along(second, across), (at - a) / (b - a), rounding);
          reach = {std::min(reach.low, place.low), std::max(reach.high, place.high)};
        }
      }
    }
    box.min[across] = std::max(box.min[across], reach.low);
    box.max[across] = std::min(box.max[across], reach.high);
    if (!(box.min[across] <= box.max[across])) {
      return false;
    }
  }
  return true;
}

}  // namespace

RegionOcclusion::RegionOcclusion(const Panels& panels, double near_distance, double magnitude,
                                 std::uint32_t most_repeats)
    : fused_(panels, magnitude, most_repeats), near_distance_(near_distance) {}

bool RegionOcclusion::hides(const CellBox& region, const FusedTarget& target, const RegionEffort& effort) {
  fused_.startSearch();
  return decide(region, target, effort) == Answer::kHidden;
}

Box RegionOcclusion::takeFollowed() {
  const Box followed = fused_.takeFollowed();
  return std::exchange(narrowed_or_divided_, false) ? math::infiniteBox() : followed;
}

RegionOcclusion::Answer RegionOcclusion::decide(CellBox region, FusedTarget target,
                                                const RegionEffort& effort) {
  decided_by_ = WitnessKind::kSurfaces;
  Answer answer = fused_.ask(region, target, near_distance_);
  if (answer != Answer::kUndecided) {
    return answer;
  }
  if (effort.narrowings == 0 && effort.divisions == 0) {
    return answer;
  }
  narrowed_or_divided_ = true;
  fused_.focus(FusedOcclusion::kAll, region, target.box);
  if (hasClearLine(region, target, LineEnds::kInside, kLinesBefore) ||
      hasClearLine(region, target, LineEnds::kOnSurface, kLinesToSurface)) {
    return Answer::kClear;
  }
  if (effort.narrowings == 0) {
    return decideHalves(region, target, effort);
  }
  decided_by_ = WitnessKind::kNarrowed;
  return decideThroughWindows(region, target.box, target.object, effort);
}

RegionOcclusion::Answer RegionOcclusion::decideHalves(CellBox region, FusedTarget target,
                                                      const RegionEffort& effort) {
  const RegionEffort less{effort.narrowings, effort.divisions - 1};
  CellBox& larger = maxComponent(region.extent()) >= maxComponent(target.box.extent()) ? region : target.box;
  const int axis = math::longestAxis(larger.extent());
  const double middle = larger.centre()[axis], end = larger.max[axis];
  larger.max[axis] = middle;
  Answer answer = decide(region, target, less);
  if (answer != Answer::kHidden) {
    return answer;
  }
  larger.min[axis] = middle;
  larger.max[axis] = end;
  answer = decide(region, target, less);
  decided_by_ = WitnessKind::kDivided;
  return answer;
}

RegionOcclusion::Answer RegionOcclusion::decideThroughWindows(CellBox region, CellBox target,
                                                              std::uint32_t object,
                                                              const RegionEffort& effort) {
  std::array<int, 3> axes{0, 1, 2};
  std::ranges::stable_sort(axes, std::ranges::greater(), [&region, &target](int axis) {
    return std::max(target.min[axis] - region.max[axis], region.min[axis] - target.max[axis]);
  });
  std::optional<Passage> longest;
  double length = 0.0;
  for (const int axis : axes) {
    const bool before = region.max[axis] < target.min[axis];
    if (!before && !(target.max[axis] < region.min[axis])) {
      continue;
    }
    const Interval gap =
        before ? Interval{region.max[axis], target.min[axis]} : Interval{target.max[axis], region.min[axis]};
    const double middle = 0.5 * (gap.low + gap.high);
    // No near plane clips what hides the target from the window.
    if (!(0.5 * (gap.high - gap.low) > near_distance_ + fused_.nearMargin()) ||
        gap.high - gap.low < kLeastGap * length) {
      continue;
    }
    const double far = fused_.magnitude();
    Passage passage{region, {{-far, -far, -far}, {far, far, far}}, target, axis, object};
    passage.window.min[axis] = passage.window.max[axis] = middle;
    if (!tighten(passage)) {
      return Answer::kHidden;
    }
    focusOn(passage);
    bool cut = false;
    const Answer answer = narrowPassage(passage, effort.narrowings, cut);
    if (answer != Answer::kUndecided) {
      return answer;
    }
    region = passage.region;
    target = passage.target;
    if (gap.high - gap.low > length) {
      length = gap.high - gap.low;
      longest = passage;
    }
  }
  if (!longest || effort.divisions == 0) {
    return Answer::kUndecided;
  }
  // What was narrowed after it holds for it as well.
  longest->region = region;
  longest->target = target;
  if (!tighten(*longest)) {
    return Answer::kHidden;
  }
  focusOn(*longest);
  const Answer answer = dividePassage(*longest, effort);
  decided_by_ = WitnessKind::kDivided;
  return answer;
}

void RegionOcclusion::focusOn(const Passage& passage) {
  fused_.focus(FusedOcclusion::kBeforeWindow, passage.region, passage.window);
  fused_.focus(FusedOcclusion::kBehindWindow, passage.window, passage.target);
}

RegionOcclusion::Answer RegionOcclusion::dividePassage(const Passage& passage, const RegionEffort& effort) {
  if (hasClearLine(passage.region, {passage.target, passage.object}, LineEnds::kInside, kLinesOfPassage)) {
    return Answer::kClear;
  }
  if (effort.divisions == 0) {
    return Answer::kUndecided;
  }
  CellBox Passage::*widest = &Passage::target;
  for (CellBox Passage::*part : {&Passage::window, &Passage::region}) {
    if (maxComponent((passage.*part).extent()) > maxComponent((passage.*widest).extent())) {
      widest = part;
    }
  }
  const int across = math::longestAxis((passage.*widest).extent());
  const double middle = (passage.*widest).centre()[across];
  for (const bool high : {false, true}) {
    Passage half = passage;
    CellBox& box = half.*widest;
    (high ? box.min : box.max)[across] = middle;
    if (!tighten(half)) {
      continue;
    }
    bool cut = false;
    Answer answer = narrowPassage(half, effort.narrowings, cut);
    if (answer == Answer::kUndecided && cut) {
      answer = dividePassage(half, {effort.narrowings, effort.divisions - 1});
    }
    if (answer != Answer::kHidden) {
      return answer;
    }
  }
  return Answer::kHidden;
}

bool RegionOcclusion::hasClearLine(const CellBox& region, const FusedTarget& target, LineEnds where,
                                   int lines) {
  const bool on_surface = where == LineEnds::kOnSurface;
  const CellBox ends = on_surface ? fused_.endsIn(target.box) : target.box;
  RandomNumbers random;
  for (int line = 0; line < lines; ++line) {
    const Vec3d from = random.pointIn(region);
    Vec3d to = random.pointIn(ends);
    if (on_surface) {
      const int axis = line % 3;
      to[axis] = from[axis] < to[axis] ? ends.min[axis] : ends.max[axis];
    }
    if (fused_.isClear(from, to, target.object, near_distance_)) {
      return true;
    }
  }
  return false;
}

RegionOcclusion::Answer RegionOcclusion::narrowPassage(Passage& passage, std::uint32_t times, bool& cut) {
  if (!tighten(passage)) {
    return Answer::kHidden;
  }
  bool cut_now = true;
  for (std::uint32_t time = 0; time < times && cut_now; ++time) {
    cut_now = false;
    for (const Part part : {Part::kTarget, Part::kWindow, Part::kRegion}) {
      const Answer answer = narrowPart(passage, part, cut_now);
      if (answer != Answer::kUndecided) {
        return answer;
      }
    }
    cut = cut || cut_now;
  }
  return Answer::kUndecided;
}

RegionOcclusion::Answer RegionOcclusion::narrowPart(Passage& passage, Part part, bool& cut) {
  bool smaller = false;
  for (int axis = 0; axis < 3; ++axis) {
    for (const bool high : {false, true}) {
      if (part == Part::kWindow && axis == passage.axis) {
        continue;
      }
      const Answer answer = cutOff(passage, part, axis, high, smaller);
      if (answer != Answer::kUndecided) {
        return answer;
      }
    }
  }
  cut = cut || smaller;
  return smaller ? askOnce(passage.region, passage.target, passage.object, near_distance_)
                 : Answer::kUndecided;
}

RegionOcclusion::Answer RegionOcclusion::cutOff(Passage& passage, Part part, int axis, bool high, bool& cut) {
  CellBox& box = part == Part::kTarget   ? passage.target
                 : part == Part::kWindow ? passage.window
                                         : passage.region;
  for (int halves = 0; halves < kMaxHalves; ++halves) {
    const double middle = box.centre()[axis];
    if (!(middle > box.min[axis] && middle < box.max[axis])) {
      return Answer::kUndecided;  // it is flat
    }
    CellBox half = box;
    (high ? half.min : half.max)[axis] = middle;
    const Answer answer = answerThrough(passage, part, half);
    if (answer != Answer::kHidden) {
      return answer;
    }
    (high ? box.max : box.min)[axis] = middle;
    cut = true;
    if (!tighten(passage)) {
      return Answer::kHidden;
    }
  }
  return Answer::kUndecided;
}

RegionOcclusion::Answer RegionOcclusion::answerThrough(const Passage& passage, Part part,
                                                       const CellBox& piece) {
  if (part == Part::kTarget) {
    return askOnce(passage.region, piece, passage.object, near_distance_);
  }
  if (part == Part::kRegion) {
    return askOnce(piece, passage.target, passage.object, near_distance_);
  }
  // Those that are clear only as far as the window, or only from there on, say nothing.
  const bool hidden = askOnce(passage.region, piece, passage.object, near_distance_) == Answer::kHidden ||
                      askOnce(piece, passage.target, passage.object, 0.0) == Answer::kHidden;
  return hidden ? Answer::kHidden : Answer::kUndecided;
}

bool RegionOcclusion::tighten(Passage& passage) const {
  const double rounding = kPlaceRounding * fused_.magnitude();
  const int axis = passage.axis;
  return narrowToLines(passage.window, passage.region, passage.target, axis, rounding) &&
         narrowToLines(passage.region, passage.window, passage.target, axis, rounding) &&
         narrowToLines(passage.target, passage.region, passage.window, axis, rounding);
}

}  // namespace sightline::pvs
