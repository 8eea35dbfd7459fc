#pragma once

// What surfaces of any number of triangles hide from a whole region together. docs/conservative.md, "Sets
// from regions", says why it is safe.

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "src/pvs/bake/shaft.h"
#include "src/pvs/bake/surfaces/panels.h"

namespace sightline::pvs {

// What may be hidden.
struct FusedTarget {
  CellBox box;
  std::uint32_t object = kNoObject;  // the only one that is asked about, or kNoObject
};

// Use by one thread at a time.
class FusedOcclusion {
 public:
  // kHidden: every line of sight from the region to the target meets the front of a sheet. kClear: one of
  // them surely does not.
  enum class Answer { kHidden, kClear, kUndecided };

  // magnitude: an upper bound of the absolute coordinates of all regions and boxes that are asked about.
  // most_repeats: how often a question is asked again without the objects that keep a surface from hiding
  // anything, mostly the floor below the region and what is joined with it. The panels must outlive this.
  FusedOcclusion(const Panels& panels, double magnitude, std::uint32_t most_repeats = kMostRepeats);
  static constexpr std::uint32_t kMostRepeats = 4;
  static constexpr std::uint32_t kEndCount = 9;  // of lines of sight that ask() tries at most

  // near_distance: what is closer to the region, in metres, hides nothing. look_for_lines: whether more lines
  // of sight are tried before the question is asked again, which spares that where one of them is clear.
  Answer ask(const CellBox& region, const FusedTarget& target, double near_distance,
             bool look_for_lines = true);
  // Begins a search: questions that are asked from now on follow no line of sight of those before. Within a
  // search, a question begins with the last line of an earlier one that leads from its region to its target,
  // and follows a new one only where there is none.
  void startSearch() { kept_count_ = 0; }
  // The line of sight that showed it, and the object of a sheet that the line crosses. Of the last question
  // that was answered kHidden.
  struct Proof {
    Vec3d from, to;
    std::uint32_t object = kNoObject;
  };
  const Proof& proof() const { return proof_; }
  // True if the line of sight between the points surely meets the front of no sheet. object: whose sheets do
  // not count, or kNoObject. near_distance: nor do those that it meets closer to where it begins, metres.
  bool isClear(const Vec3d& from, const Vec3d& to, std::uint32_t object = kNoObject,
               double near_distance = 0.0);
  // Finds the panels that any line from one box to the other may meet, once for many questions: a line that
  // begins in the one and ends in the other is compared with no others. The answers are the same without.
  // Each focus holds until it is set again.
  enum Focus : std::uint8_t { kAll, kBeforeWindow, kBehindWindow };
  void focus(Focus on, const CellBox& from, const CellBox& to);
  double magnitude() const { return magnitude_; }  // of all coordinates, metres
  // The box where lines of sight to a target may end.
  CellBox endsIn(const CellBox& target) const;
  // Where lines of sight from a region begin that ask() tries: all those of the first question of a search,
  // and most of the others that it follows.
  static Vec3d startOf(const CellBox& region);
  // A box around all panels that were followed, or found next to those, since the last call.
  Box takeFollowed() { return std::exchange(followed_, {}); }
  // How much farther than the near distance, for sure, something has to be.
  double nearMargin() const { return error_ + 0x1p-40 * magnitude_; }

 private:
  // How the line of sight meets a panel.
  struct Crossing {
    std::uint32_t panel = 0;
    std::int32_t sum = 0;   // of crossings from the front, less those from the back
    bool front = false;     // some are from the front
    bool in_doubt = false;  // rounding does not tell
    bool blocks() const { return front || in_doubt; }
  };
  // Panels that are joined within the shaft.
  struct Component {
    bool closed = false;  // no part of its boundary is in the shaft, and nothing of it too near
    std::uint32_t first = 0, count = 0;  // into members_
    // It would be gathered just so without any objects but those of its members.
    bool own = true;
    bool counted = false;        // what follows is known
    std::int32_t crossings = 0;  // of the line of sight
    bool in_doubt = false;
  };

  // Answers without the objects of left_out_, once the question is started.
  Answer askWithout();
  bool seesAnyEnd();
  void leaveOut(std::uint32_t object);  // and nothing else
  void startQuestion();
  // Starts the question again without more objects. What was gathered stays where nothing of it is left out.
  void startRepeat();
  bool isLeftOut(std::uint32_t panel) const {
    return left_out_in_[panels_.panels[panel].object] == question_;
  }
  // Notes that its object keeps a surface from hiding anything.
  void addSpoiler(std::uint32_t panel);
  void findCrossingsTo(std::uint32_t end);
  // Sets lines_[0] and crossings_ to those that the question begins with.
  void findFirstCrossings();
  bool hiddenBehind(const Vec3d& from, const Vec3d& to);
  bool isCrossedOften(std::uint32_t component, const Vec3d& end);
  void findCrossings(const Vec3d& from, const Vec3d& to);
  bool isFree(const Vec3d& from, const Vec3d& to, double near_distance = 0.0);
  // True if test(panel) holds for one of the panels of which the line of sight meets the bounds. Asks them in
  // any order, and stops at the first.
  template <typename Test>
  bool anyPanelOn(const Vec3d& from, const Vec3d& to, const Test& test);
  void crossPanel(std::uint32_t panel, const Vec3d& from, const Vec3d& to);
  bool clear() const;
  bool isMember(std::uint32_t panel, std::uint32_t component) const {
    return places_[panel].question == question_ && places_[panel].component == component;
  }
  std::uint32_t componentOf(std::uint32_t panel);
  bool gather(std::uint32_t component);
  bool misses(const PanelEdge& edge);
  std::uint32_t sidesBeyond(std::uint32_t vertex);
  bool tooNear(std::uint32_t panel) const;
  bool maySpare(const Component& component, const Vec3d& end) const;

  const Panels& panels_;
  double magnitude_;
  std::uint32_t most_repeats_;
  double error_;         // of a coordinate relative to another point, metres
  double sheet_margin_;  // around the corners of a sheet in single precision, metres

  // These describe the last question.
  CellBox region_, target_;
  double near_distance_ = 0.0;
  // Objects whose sheets count for nothing: the target's own first, if it is the only one, then spoilers.
  std::vector<std::uint32_t> left_out_;
  // Objects of panels that are too near, or have an edge in the shaft at which nothing else ends.
  std::vector<std::uint32_t> spoilers_;
  std::uint32_t most_members_ = 0;  // of a component
  Shaft shaft_;
  Proof proof_;
  std::vector<Crossing> crossings_;
  struct Line {
    Vec3d from, to;
  };
  // A line of sight that a question began with, and its crossings with all but the target's own object.
  struct KeptLine {
    Line line;
    std::vector<Crossing> crossings;
  };
  static constexpr std::uint32_t kMostKeptLines = 32;
  // These are the last lines of this search: line i is at i % kMostKeptLines.
  std::array<KeptLine, kMostKeptLines> kept_lines_;
  std::uint32_t kept_count_ = 0;
  std::uint32_t kept_without_ = kNoObject;  // FusedTarget::object of their questions
  // By end: the line of sight that is followed, and its crossings with all that are not left out when it is
  // first followed.
  std::array<Line, kEndCount> lines_;
  std::array<std::vector<Crossing>, kEndCount> traced_;
  std::uint32_t traced_count_ = 0;
  static bool isIn(const CellBox& box, const Vec3d& point) {
    return min(point, box.min) == box.min && max(point, box.max) == box.max;
  }
  // The panels that lines of sight from one box to the other may meet.
  struct InFocus {
    CellBox from{}, to{};
    bool set = false;
    BoxLanes panels{};

    bool holds(const Vec3d& a, const Vec3d& b) const { return set && isIn(from, a) && isIn(to, b); }
  };
  std::array<InFocus, 3> foci_;
  std::vector<std::uint32_t> found_;     // places in one of these, or in the tree of panels
  std::vector<std::uint32_t> blockers_;  // panels that blocked lines of sight, the last one first
  std::vector<Component> components_;
  std::vector<std::uint32_t> members_;        // panels, by component
  std::vector<Component> components_before_;  // those of the question that is asked again
  std::vector<std::uint32_t> members_before_;
  // Members whose edges have not been looked at, by PanelRank::steps; none has fewer steps than nearest_.
  std::array<std::vector<std::uint32_t>, kMostSteps + 1> ahead_;
  std::uint32_t nearest_ = 0;
  struct Place {
    std::uint32_t question = 0, component = 0;
  };
  std::vector<Place> places_;               // by panel: the component that it was found in
  std::vector<std::uint32_t> left_out_in_;  // by object: the last question that left it out
  struct Beyond {
    std::uint32_t shaft = 0, sides = 0;
  };
  std::vector<Beyond> beyond_;  // by vertex: the sides of the shaft that it is beyond
  std::uint32_t question_ = 0, shaft_number_ = 0;
  Box followed_;
};

}  // namespace sightline::pvs
