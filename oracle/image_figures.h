#pragma once

// Lines, corners and depths of an image, with exact signs.
//
// Everything is computed in double precision with a bound on its error. Where a sign is within the bound, it
// is computed again in whole numbers, from the positions of the scene and the numbers of the view. Signs that
// follow from the mesh need no arithmetic: a corner of a triangle lies on the lines of its edges.

#include <cstdint>
#include <limits>
#include <vector>

#include "oracle/image_space.h"

namespace sightline {

inline constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// A triangle of the scene: numbers of positions of which equal ones have equal numbers.
struct ImageTriangle {
  std::uint32_t a = 0, b = 0, c = 0;
};

// All figures of one image that an algorithm has made so far. Figures are named by their index.
class ImageFigures {
 public:
  explicit ImageFigures(const ImageSpace& space) : space_(&space) {}

  const ImageSpace& space() const { return *space_; }
  // Forgets all figures.
  void clear();

  // A line of the image divides it into a positive and a negative side.
  using Line = std::uint32_t;
  // A direction that lies before the eye.
  using Corner = std::uint32_t;
  // The nearness of a plane in space, as a function of the direction.
  using Depth = std::uint32_t;

  // The line n . d = 0, exact as it stands.
  Line lineGiven(const Vec3d& n);
  // The line through the images of two positions. Its positive side is that of direction(from) x
  // direction(to), or the other one.
  Line lineThrough(std::uint32_t from, std::uint32_t to, bool other_side);
  // The line where two depths are the same. `near` is the nearer one on the positive side. If they are the
  // same everywhere, no direction is on either side.
  Line lineWhereNearer(Depth near, Depth far);

  Depth depthGiven(double depth);
  // The plane of a triangle that is not seen edge on.
  Depth depthOf(const ImageTriangle& triangle);

  // Where two lines intersect that are not the same.
  Corner intersection(Line a, Line b);
  // A direction in double precision, exact as it stands.
  Corner cornerGiven(const Vec3d& direction);
  // The direction of a point in space, which is before the eye. Exact in both kinds of views.
  Corner cornerOf(const Vec3d& point);
  // A direction strictly between these, which are at least two different ones.
  Corner cornerBetween(std::span<const Corner> corners);

  // True if no direction is on either side: the two depths are the same everywhere.
  bool dividesNothing(Line line);
  // False for the intersection of lines that are the same or meet infinitely far away.
  bool isBeforeTheEye(Corner corner);
  // The side of the line on which the corner lies: 1, -1, or 0 if it is on the line.
  int side(Line line, Corner corner);
  // Sign of the volume of the corners' directions: -1 if the front of the triangle is seen, 1 if its back is,
  // 0 if it is seen edge on.
  int orientation(const ImageTriangle& triangle) const;
  // Rounded; its length is of no meaning.
  Vec3d direction(Corner corner) const { return corners_[corner].d.value; }

 private:
  enum class LineKind : std::uint8_t { kGiven, kThroughPositions, kWhereNearer };
  struct LineData {
    RoundedVec n;
    LineKind kind = LineKind::kGiven;
    bool other_side = false;
    std::uint32_t first = kNone, second = kNone;  // positions or depths
    std::uint32_t exact = kNone;
  };
  struct CornerData {
    RoundedVec d;
    std::uint32_t position = kNone;       // whose image it is
    Line line_a = kNone, line_b = kNone;  // that intersect there
    bool opposite = false;                // to the cross product of the lines, or to the position
    std::uint32_t exact = kNone;
  };
  struct DepthData {
    RoundedVec n;
    double c = 0.0, c_error = 0.0;
    ImageTriangle triangle;
    double given = 0.0;
    bool is_given = false;
    int c_sign = 1;
  };

  Line addLine(const LineData& line);
  Corner addCorner(const CornerData& corner);
  // True if this follows from how the two were made.
  bool isOn(const LineData& line, const CornerData& corner) const;
  bool sameLine(Line a, Line b) const;
  const WholeVec& exactNormal(Line line);
  const WholeVec& exactDirection(Corner corner);
  ImageSpace::ExactNearness exactNearness(const DepthData& depth) const;
  void turnBeforeTheEye(Corner corner);
  std::uint32_t keep(WholeVec value);

  const ImageSpace* space_;
  std::vector<LineData> lines_;
  std::vector<CornerData> corners_;
  std::vector<DepthData> depths_;
  std::vector<WholeVec> exact_;
};

}  // namespace sightline
