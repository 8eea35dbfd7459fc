// The theorem is in docs/conservative.md, "Sets from regions". In short: a set of sheets whose boundary is
// outside the shaft is crossed by all lines of sight as often as by one of them, fronts counted 1 and backs
// -1, but for what the ends of the lines pass through. So one line decides for all.

#include "src/pvs/bake/surfaces/fused_occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "sightline/geometry/tolerance.h"
#include "src/pvs/bake/segment.h"
#include "src/pvs/bake/surfaces/sheet_crossings.h"

namespace sightline::pvs {
namespace {

// A component of more panels is taken for open, which bounds the time. A box of several objects is rarely
// hidden as a whole.
constexpr std::uint32_t kMostMembers = 512, kMostMembersOfNodes = 64;
constexpr std::size_t kMostBlockers = 8;
// More panels than this are found in their tree rather than one after the other.
constexpr std::size_t kMostInFocus = 2048;
// Boxes are widened by this fraction of the magnitude, so that lines may end beside what is flat.
constexpr double kWidening = 0x1p-18;

// Places of ends of lines in a box, in fractions of it. They are no round numbers, because those of edges
// are.
constexpr Vec3d kStart{0.5127, 0.4861, 0.5073};
constexpr std::array<Vec3d, FusedOcclusion::kEndCount> kEnds{
    Vec3d{0.4893, 0.5131, 0.4937}, Vec3d{0.0213, 0.9791, 0.0237}, Vec3d{0.9763, 0.9817, 0.0251},
    Vec3d{0.0229, 0.9773, 0.9759}, Vec3d{0.9781, 0.9807, 0.9743}, Vec3d{0.0241, 0.0197, 0.0219},
    Vec3d{0.9777, 0.0221, 0.0203}, Vec3d{0.0217, 0.0233, 0.9769}, Vec3d{0.9787, 0.0239, 0.9771}};

Vec3d pointIn(const CellBox& box, const Vec3d& part) {
  const Vec3d extent = box.extent();
  return {box.min.x + extent.x * part.x, box.min.y + extent.y * part.y, box.min.z + extent.z * part.z};
}

Vec3d mirrored(const Vec3d& part) {
  return Vec3d{1.0, 1.0, 1.0} - part;
}

// A number with an unknown error of at most `doubt`.
struct Determinant {
  double value = 0.0, doubt = 0.0;
  bool positive() const { return value > doubt; }
  bool negative() const { return value < -doubt; }
};

struct Sheet {
  Vec3d a, b, c;

  // Positive where the point is in front.
  Determinant sideOf(const Vec3d& point, double error) const {
    const Vec3d pa = a - point, pb = b - point, pc = c - point;
    return {dot(pc, cross(pb, pa)),
            doubtOf(l1Norm(pa) + error, l1Norm(pb) + error, l1Norm(pc) + error, error)};
  }
  Box bounds(double margin) const {
    Box box;
    for (const Vec3d& corner : {a, b, c}) {
      box.extend(Vec3f(corner));
    }
    return widened(box, margin);
  }
};

// Calls visit(sheet) for those of the panel until it returns true; returns whether it did.
template <typename Visit>
bool anySheet(const Panels& panels, std::uint32_t number, Visit&& visit) {
  const std::span<const std::uint32_t> corners = panels.sheetsOf(panels.panels[number]);
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    if (visit(Sheet{panels.vertices[corners[i]], panels.vertices[corners[i + 1]],
                    panels.vertices[corners[i + 2]]})) {
      return true;
    }
  }
  return false;
}

}  // namespace

FusedOcclusion::FusedOcclusion(const Panels& panels, double magnitude, std::uint32_t most_repeats)
    : panels_(panels),
      magnitude_(magnitude),
      most_repeats_(most_repeats),
      places_(panels.panels.size()),
      beyond_(panels.vertices.size()) {
  for (const Vec3d& vertex : panels.vertices) {
    magnitude_ = std::max(magnitude_, maxComponent(abs(vertex)));
  }
  magnitude_ *= 1.0 + 2.0 * kWidening;
  for (const Panel& panel : panels.panels) {
    left_out_in_.resize(std::max<std::size_t>(left_out_in_.size(), std::size_t{panel.object} + 1));
  }
  error_ = 0x1p-51 * magnitude_ + panels.slack;
  sheet_margin_ = 0x1p-24 * magnitude_ + panels.slack;
}

bool FusedOcclusion::isClear(const Vec3d& from, const Vec3d& to, std::uint32_t object, double near_distance) {
  leaveOut(object);
  startQuestion();
  return isFree(from, to, near_distance);
}

CellBox FusedOcclusion::endsIn(const CellBox& target) const {
  return grown(target, kWidening * magnitude_);
}

Vec3d FusedOcclusion::startOf(const CellBox& region) {
  return pointIn(region, kStart);
}

FusedOcclusion::Answer FusedOcclusion::ask(const CellBox& region, const FusedTarget& target,
                                           double near_distance, bool look_for_lines) {
  region_ = region;
  target_ = endsIn(target.box);
  if (target.object != kept_without_) {
    startSearch();
    kept_without_ = target.object;
  }
  near_distance_ = near_distance;
  leaveOut(target.object);
  most_members_ = target.object == kNoObject ? kMostMembersOfNodes : kMostMembers;
  shaft_ = Shaft(region_, target_, magnitude_, panels_.slack);
  if (++shaft_number_ == 0) {
    std::fill(beyond_.begin(), beyond_.end(), Beyond{});
    shaft_number_ = 1;
  }
  spoilers_.clear();
  traced_count_ = 0;
  startQuestion();
  Answer answer = askWithout();
  if (answer != Answer::kUndecided || spoilers_.empty() || most_repeats_ == 0) {
    return answer;
  }
  if (look_for_lines && seesAnyEnd()) {
    return Answer::kClear;
  }
  for (std::uint32_t repeat = 0; repeat < most_repeats_ && answer != Answer::kHidden && !spoilers_.empty();
       ++repeat) {
    left_out_.insert(left_out_.end(), spoilers_.begin(), spoilers_.end());
    spoilers_.clear();
    startRepeat();
    answer = askWithout();
  }
  // What is left out may block a line that is clear without it.
  return answer == Answer::kHidden ? answer : Answer::kUndecided;
}

// Whether one of the lines of sight that askWithout() may try is clear. Those that it has tried are not.
bool FusedOcclusion::seesAnyEnd() {
  const Vec3d from = startOf(region_);
  return std::any_of(kEnds.begin() + traced_count_, kEnds.end(),
                     [&](const Vec3d& end) { return isFree(from, pointIn(target_, end)); });
}

// Sets crossings_ to those of the line of sight to an end. A repeat leaves out more than the questions before
// it, so it need not follow again the lines that they followed.
void FusedOcclusion::findCrossingsTo(std::uint32_t end) {
  if (end == traced_count_) {
    if (end == 0) {
      findFirstCrossings();
    } else {
      lines_[end] = {startOf(region_), pointIn(target_, kEnds[end])};
      findCrossings(lines_[end].from, lines_[end].to);
    }
    traced_[traced_count_++] = crossings_;
    return;
  }
  crossings_.clear();
  std::copy_if(traced_[end].begin(), traced_[end].end(), std::back_inserter(crossings_),
               [this](const Crossing& crossing) { return !isLeftOut(crossing.panel); });
}

// Any line of sight from the region to the target decides for all, so one that is known serves as well. Most
// questions about less are about boxes that hold the line of one of the last questions.
void FusedOcclusion::findFirstCrossings() {
  for (std::uint32_t i = kept_count_; i > 0 && i + kMostKeptLines > kept_count_; --i) {
    const KeptLine& kept = kept_lines_[(i - 1) % kMostKeptLines];
    if (isIn(region_, kept.line.from) && isIn(target_, kept.line.to)) {
      lines_[0] = kept.line;
      crossings_ = kept.crossings;
      return;
    }
  }
  // Along each axis, every second line begins and ends in the other halves of its boxes than those between
  // them. So two lines serve questions about all halves.
  lines_[0] = kept_count_ % 2 == 0
                  ? Line{startOf(region_), pointIn(target_, kEnds[0])}
                  : Line{pointIn(region_, mirrored(kStart)), pointIn(target_, mirrored(kEnds[0]))};
  findCrossings(lines_[0].from, lines_[0].to);
  KeptLine& kept = kept_lines_[kept_count_++ % kMostKeptLines];
  kept.line = lines_[0];
  kept.crossings = crossings_;
}

void FusedOcclusion::leaveOut(std::uint32_t object) {
  left_out_.clear();
  if (object < left_out_in_.size()) {
    left_out_.push_back(object);
  }
}

void FusedOcclusion::startQuestion() {
  components_.clear();
  members_.clear();
  if (++question_ == 0) {
    std::fill(places_.begin(), places_.end(), Place{});
    std::fill(left_out_in_.begin(), left_out_in_.end(), 0);
    question_ = 1;
  }
  for (const std::uint32_t object : left_out_) {
    left_out_in_[object] = question_;
  }
}

void FusedOcclusion::startRepeat() {
  components_before_.swap(components_);
  members_before_.swap(members_);
  startQuestion();
  for (Component component : components_before_) {
    const auto members = std::span(members_before_).subspan(component.first, component.count);
    if (!component.own ||
        std::ranges::any_of(members, [this](std::uint32_t panel) { return isLeftOut(panel); })) {
      continue;
    }
    component.first = static_cast<std::uint32_t>(members_.size());
    for (const std::uint32_t panel : members) {
      places_[panel] = {question_, static_cast<std::uint32_t>(components_.size())};
    }
    members_.insert(members_.end(), members.begin(), members.end());
    components_.push_back(component);
  }
}

void FusedOcclusion::addSpoiler(std::uint32_t panel) {
  const std::uint32_t object = panels_.panels[panel].object;
  if (std::find(spoilers_.begin(), spoilers_.end(), object) == spoilers_.end()) {
    spoilers_.push_back(object);
  }
}

FusedOcclusion::Answer FusedOcclusion::askWithout() {
  for (std::uint32_t end = 0; end < kEnds.size(); ++end) {
    findCrossingsTo(end);
    if (clear()) {
      return Answer::kClear;
    }
    if (hiddenBehind(lines_[end].from, lines_[end].to)) {
      return Answer::kHidden;
    }
    // Another end of the line helps only if this one is all that is wrong.
    if (std::none_of(components_.begin(), components_.end(),
                     [](const Component& c) { return c.closed && (c.crossings > 0 || c.in_doubt); })) {
      break;
    }
  }
  return Answer::kUndecided;
}

// Whether the line of sight that was crossed last shows that the target is hidden. Sets proof_ if it does.
bool FusedOcclusion::hiddenBehind(const Vec3d& from, const Vec3d& to) {
  for (Component& component : components_) {
    component.counted = false;
  }
  const auto proves = [&](std::uint32_t number) {
    if (components_[number].counted || !isCrossedOften(number, to)) {
      return false;
    }
    // The component may have been gathered from a panel of another object, which an earlier line crossed.
    const auto crossed = std::ranges::find_if(crossings_, [&](const Crossing& crossing) {
      return crossing.sum > 0 && isMember(crossing.panel, number);
    });
    proof_ = {from, to, panels_.panels[crossed->panel].object};
    return true;
  };
  // What no front was crossed of cannot hide. Those of earlier lines are counted at the end.
  for (const Crossing& crossing : crossings_) {
    if (crossing.front && proves(componentOf(crossing.panel))) {
      return true;
    }
  }
  for (std::uint32_t number = 0; number < components_.size(); ++number) {
    if (proves(number)) {
      return true;
    }
  }
  return false;
}

// Counts how often the line of sight that was crossed last crosses the component. True if no end of a line in
// the target can make up for that: the component hides the target.
bool FusedOcclusion::isCrossedOften(std::uint32_t number, const Vec3d& end) {
  Component& component = components_[number];
  component.counted = true;
  component.crossings = 0;
  component.in_doubt = false;
  for (const Crossing& crossing : crossings_) {
    if (isMember(crossing.panel, number)) {
      component.crossings += crossing.sum;
      component.in_doubt = component.in_doubt || crossing.in_doubt;
    }
  }
  return component.closed && !component.in_doubt && component.crossings > 0 && !maySpare(component, end);
}

// A window's corners need not be in the shaft of region and target, so what lines to and from a window may
// meet is found for themselves.
void FusedOcclusion::focus(Focus on, const CellBox& from, const CellBox& to) {
  InFocus& focus = foci_[on];
  // The box from which lines begin is the end of others.
  focus.from = endsIn(from);
  focus.to = endsIn(to);
  const Cone lines(focus.from, focus.to, error_, magnitude_);
  focus.panels.clear();
  focus.set = panels_.tree.find(std::span(&lines, 1), kMostInFocus, found_);
  if (focus.set) {
    focus.panels.add(panels_.tree.boxes(), found_);
    focus.panels.pad();
  }
}

template <typename Test>
bool FusedOcclusion::anyPanelOn(const Vec3d& from, const Vec3d& to, const Test& test) {
  const Cone line(from, {to, to}, error_, magnitude_);
  const auto focus =
      std::ranges::find_if(foci_, [&](const InFocus& in_focus) { return in_focus.holds(from, to); });
  const BoxLanes& boxes = focus != foci_.end() ? focus->panels : panels_.tree.boxes();
  if (focus != foci_.end()) {
    placesMet(boxes, std::span(&line, 1), found_);
  } else {
    panels_.tree.find(std::span(&line, 1), panels_.panels.size(), found_);
  }
  const SegmentTest segment(from, to, error_);
  return std::ranges::any_of(found_, [&](std::uint32_t place) {
    const std::uint32_t panel = boxes.number[place];
    return !segment.misses(panels_.bounds[panel]) && test(panel);
  });
}

// Sets crossings_ to all those of a line of sight, in the order of their panels' ranks.
void FusedOcclusion::findCrossings(const Vec3d& from, const Vec3d& to) {
  crossings_.clear();
  anyPanelOn(from, to, [&](std::uint32_t panel) {
    crossPanel(panel, from, to);
    return false;
  });
  std::sort(crossings_.begin(), crossings_.end(),
            [this](const Crossing& a, const Crossing& b) { return panels_.before(a.panel, b.panel); });
}

// Whether no panel blocks the line of sight. What blocked other lines is asked first: it often blocks this
// one.
bool FusedOcclusion::isFree(const Vec3d& from, const Vec3d& to, double near_distance) {
  const double length = sightline::length(to - from);
  const Vec3d begin = from + (to - from) * (near_distance < length ? near_distance / length : 1.0);
  const auto blocks = [&](std::uint32_t panel) {
    crossings_.clear();
    crossPanel(panel, begin, to);
    return !clear();
  };
  const SegmentTest segment(from, to, error_);
  const auto known = std::ranges::find_if(blockers_, [&](std::uint32_t panel) {
    return !segment.misses(panels_.bounds[panel]) && blocks(panel);
  });
  if (known != blockers_.end()) {
    std::rotate(blockers_.begin(), known, known + 1);
    return false;
  }
  return !anyPanelOn(from, to, [&](std::uint32_t panel) {
    if (!blocks(panel)) {
      return false;
    }
    if (blockers_.size() == kMostBlockers) {
      blockers_.pop_back();
    }
    blockers_.insert(blockers_.begin(), panel);
    return true;
  });
}

void FusedOcclusion::crossPanel(std::uint32_t number, const Vec3d& from, const Vec3d& to) {
  if (isLeftOut(number)) {
    return;
  }
  const Box& bounds = panels_.bounds[number];
  const double far = l1Norm(max(abs(Vec3d(bounds.min) - from), abs(Vec3d(bounds.max) - from))) + error_;
  const SheetCrossings crossings =
      crossSheets(panels_.vertices, panels_.sheetsOf(panels_.panels[number]), {from, to, error_}, far);
  if (crossings.any()) {
    crossings_.push_back({number, crossings.sum, crossings.front, crossings.in_doubt});
  }
}

bool FusedOcclusion::clear() const {
  return std::none_of(crossings_.begin(), crossings_.end(), [](const Crossing& c) { return c.blocks(); });
}

// The number of the panel's component, which is gathered if it is not known.
std::uint32_t FusedOcclusion::componentOf(std::uint32_t panel) {
  Place& place = places_[panel];
  if (place.question != question_) {
    const auto number = static_cast<std::uint32_t>(components_.size());
    const auto first = static_cast<std::uint32_t>(members_.size());
    components_.push_back({.first = first});
    place = {question_, number};
    members_.push_back(panel);
    components_[number].closed = gather(number);
    components_[number].count = static_cast<std::uint32_t>(members_.size()) - first;
  }
  return place.component;
}

// Adds all panels that are joined with the component's first one within the shaft. False as soon as it is not
// closed; some may be missing then. Most are not, so the way is towards the border of the surface first;
// among panels that are equally far from it, it goes on from the last one, which is often still in the cache.
bool FusedOcclusion::gather(std::uint32_t component) {
  const auto lookAtLater = [this](std::uint32_t panel) {
    const std::uint32_t steps = panels_.ranks[panel].steps;
    ahead_[steps].push_back(panel);
    nearest_ = std::min(nearest_, steps);
    followed_.extend(panels_.bounds[panel]);
  };
  for (std::vector<std::uint32_t>& panels : ahead_) {
    panels.clear();
  }
  nearest_ = kMostSteps;
  lookAtLater(members_.back());
  for (std::uint32_t looked_at = 0;; ++looked_at) {
    while (ahead_[nearest_].empty()) {
      if (nearest_ == kMostSteps) {
        return true;
      }
      ++nearest_;
    }
    const std::uint32_t panel = ahead_[nearest_].back();
    ahead_[nearest_].pop_back();
    if (looked_at == most_members_) {
      return false;
    }
    if (tooNear(panel)) {
      addSpoiler(panel);
      return false;
    }
    for (const PanelEdge& edge : panels_.edgesOf(panels_.panels[panel])) {
      std::uint32_t beyond = edge.beyond;
      const auto isMember = [&] {
        return beyond != kNoPanel && places_[beyond].question == question_ &&
               places_[beyond].component == component;
      };
      // A member is not left out.
      if (isMember() || misses(edge)) {
        continue;
      }
      if (beyond == kNoPanel ? !left_out_.empty() : isLeftOut(beyond)) {
        components_[component].own = false;
        beyond = panels_.joinedWithout(edge, [this](std::uint32_t other) { return isLeftOut(other); });
        if (isMember()) {
          continue;
        }
      }
      if (beyond == kNoPanel) {
        addSpoiler(panel);
        return false;  // the boundary
      }
      if (places_[beyond].question == question_) {
        components_[component].own = false;
        return false;  // a component that was not closed
      }
      places_[beyond] = {question_, component};
      members_.push_back(beyond);
      lookAtLater(beyond);
    }
  }
}

// Whether the edge is outside the shaft.
bool FusedOcclusion::misses(const PanelEdge& edge) {
  const std::uint32_t from = sidesBeyond(edge.from), to = sidesBeyond(edge.to);
  if ((from & to) != 0 || from == 0 || to == 0) {
    return (from & to) != 0;
  }
  return shaft_.misses(panels_.vertices[edge.from], panels_.vertices[edge.to]);
}

// A bit for each side of the shaft that a vertex is beyond; computed once a question, since several edges end
// at each vertex.
std::uint32_t FusedOcclusion::sidesBeyond(std::uint32_t vertex) {
  Beyond& known = beyond_[vertex];
  if (known.shaft != shaft_number_) {
    known = {shaft_number_, shaft_.sidesBeyond(panels_.vertices[vertex])};
  }
  return known.sides;
}

// Whether some sheet in the shaft is too near to hide anything, and its front may be seen.
bool FusedOcclusion::tooNear(std::uint32_t number) const {
  const double near = near_distance_ + nearMargin();
  const auto isFar = [&](const Box& box) {
    const Vec3d gap = gapBetween(region_, box);
    return dot(gap, gap) > near * near;
  };
  if (isFar(panels_.bounds[number])) {
    return false;
  }
  return anySheet(panels_, number, [&](const Sheet& sheet) {
    const Box bounds = sheet.bounds(sheet_margin_);
    if (isFar(bounds) || shaft_.misses(bounds)) {
      return false;
    }
    for (std::uint32_t corner = 0; corner < 8; ++corner) {
      if (!sheet.sideOf(region_.corner(corner), error_).negative()) {
        return true;
      }
    }
    return false;
  });
}

// Whether a line that ends elsewhere in the target may be spared all crossings with the component: so many of
// its sheets may lie between that end and the one of the line of sight, which is on their backs.
bool FusedOcclusion::maySpare(const Component& component, const Vec3d& end) const {
  std::int32_t left = component.crossings;
  for (std::uint32_t i = component.first; i < component.first + component.count; ++i) {
    if (!intersects(target_, panels_.bounds[members_[i]])) {
      continue;
    }
    const bool spared = anySheet(panels_, members_[i], [&](const Sheet& sheet) {
      if (!intersects(target_, sheet.bounds(sheet_margin_)) || sheet.sideOf(end, error_).positive()) {
        return false;
      }
      // With all of the target on one side of its plane, it does not meet the target.
      std::uint32_t before = 0, after = 0;
      for (std::uint32_t corner = 0; corner < 8; ++corner) {
        const Determinant side = sheet.sideOf(target_.corner(corner), error_);
        before += side.positive() ? 1 : 0;
        after += side.negative() ? 1 : 0;
        if (before > 0 && after > 0) {
          break;
        }
      }
      left -= before == 8 || after == 8 ? 0 : 1;
      return left <= 0;
    });
    if (spared) {
      return true;
    }
  }
  return false;
}

}  // namespace sightline::pvs
