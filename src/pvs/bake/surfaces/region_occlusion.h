#pragma once

// Whether a box is hidden from a whole region: one question to the surfaces, and where it does not decide,
// questions about less. docs/conservative.md, "Sets from regions", says why that is safe.

#include <cstdint>

#include "sightline/pvs/format/witness.h"
#include "src/pvs/bake/surfaces/fused_occlusion.h"

namespace sightline::pvs {

// What is done where one question does not decide.
struct RegionEffort {
  std::uint32_t narrowings = 0;  // how often all boxes of a passage are narrowed
  // How often the region or the target, whichever is larger, is halved; or, of a passage that was narrowed,
  // the widest of the region, the window and the target.
  std::uint32_t divisions = 0;
};

// Use by one thread at a time.
class RegionOcclusion {
 public:
  // near_distance: what is closer to a viewer, in metres, hides nothing. magnitude: an upper bound of the
  // absolute coordinates of all regions and boxes that are asked about. most_repeats: see FusedOcclusion. The
  // panels must outlive this.
  RegionOcclusion(const Panels& panels, double near_distance, double magnitude,
                  std::uint32_t most_repeats = FusedOcclusion::kMostRepeats);

  // True only if no point of the target can be seen from any point of the region.
  bool hides(const CellBox& region, const FusedTarget& target, const RegionEffort& effort);
  // What decided the last question that hides() answered with true: kSurfaces, kNarrowed or kDivided.
  WitnessKind decidedBy() const { return decided_by_; }
  // If it was kSurfaces.
  const FusedOcclusion::Proof& proof() const { return fused_.proof(); }
  // A box around all panels that decided what hides() answered since the last call, besides those that lines
  // of sight from FusedOcclusion::startOf the region met; all of space where it narrowed or divided.
  Box takeFollowed();
  // True if the line of sight between the points surely meets the front of no sheet.
  bool isClear(const Vec3d& from, const Vec3d& to) { return fused_.isClear(from, to); }

 private:
  using Answer = FusedOcclusion::Answer;
  // Lines of sight from the region through a window to the target. The window is a rectangle that lies
  // between them, at right angles to an axis. Whatever line is not known to be blocked begins, passes and
  // ends in these boxes.
  struct Passage {
    CellBox region, window, target;
    int axis = 0;
    std::uint32_t object = kNoObject;  // FusedTarget::object
  };
  enum class Part { kTarget, kWindow, kRegion };

  Answer decide(CellBox region, FusedTarget target, const RegionEffort& effort);
  // Halves the region or the target.
  Answer decideHalves(CellBox region, FusedTarget target, const RegionEffort& effort);
  // Narrows the region and the target to the ends of the lines through a window halfway between them, for
  // each axis along which they are far enough apart, the one with the widest gap first. Then divides the
  // longest of these passages.
  Answer decideThroughWindows(CellBox region, CellBox target, std::uint32_t object,
                              const RegionEffort& effort);
  // Tells that most of what is asked from now on is about lines of sight from the passage's region to its
  // window, and from there to its target.
  void focusOn(const Passage& passage);
  // Halves the widest part of a passage that has been narrowed, and narrows both passages that this gives.
  // All lines of each have to be blocked. A half of which narrowing cuts nothing off is given up: dividing it
  // again costs as much as before and rarely decides.
  Answer dividePassage(const Passage& passage, const RegionEffort& effort);
  // Where lines of sight end: in the target, or on the surface of the box that has to be hidden. That box is
  // a little wider: where a surface that touches the target hides all else of it, only its surface is seen.
  enum class LineEnds : std::uint8_t { kInside, kOnSurface };
  // True if one of so many random lines from the region to the target is clear, but for what is too near to
  // hide anything. Then no division can show that the target is hidden: some part of it holds the line.
  bool hasClearLine(const CellBox& region, const FusedTarget& target, LineEnds where, int lines);
  // Narrows all boxes of a passage, so many times at the most. cut: set to true if one gets smaller.
  Answer narrowPassage(Passage& passage, std::uint32_t times, bool& cut);
  // Cuts off what can be cut off all ends of a part, and asks about the whole passage again if that is
  // something. cut: set to true if it is.
  Answer narrowPart(Passage& passage, Part part, bool& cut);
  // Cuts off one end of a part, half of it at a time. cut: set to true if it does.
  Answer cutOff(Passage& passage, Part part, int axis, bool high, bool& cut);
  // Asks about what is known to have no clear line, or hardly one.
  Answer askOnce(const CellBox& region, const CellBox& box, std::uint32_t object, double near_distance) {
    return fused_.ask(region, {box, object}, near_distance, false);
  }
  // Whether the lines of the passage through a piece of one part are blocked. kClear means that some line of
  // sight from the region to the target is clear.
  Answer answerThrough(const Passage& passage, Part part, const CellBox& piece);
  // Narrows each part to where lines through both others pass. False: there are none.
  bool tighten(Passage& passage) const;

  FusedOcclusion fused_;
  double near_distance_;
  WitnessKind decided_by_ = WitnessKind::kSurfaces;
  bool narrowed_or_divided_ = false;  // since the last call of takeFollowed()
};

}  // namespace sightline::pvs
