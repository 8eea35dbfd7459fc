#include "oracle/image_figures.h"

#include <utility>

namespace sightline {
namespace {

constexpr double kLargestError = 0x1p-40;  // relative, of a corner's direction
constexpr double kUnderflow = 1e-290;      // far more than what results below the normal numbers lose

// Each coordinate is the difference of two products: an error of each factor, and three roundings.
RoundedVec cross(const RoundedVec& a, const RoundedVec& b) {
  const double x = maxNorm(a.value), y = maxNorm(b.value);
  return {cross(a.value, b.value),
          2.0 * (x * b.error + y * a.error + a.error * b.error) + 8.0 * kRounding * x * y + kUnderflow};
}

struct RoundedNumber {
  double value = 0.0, error = 0.0;
};

RoundedNumber dot(const RoundedVec& a, const RoundedVec& b) {
  const double x = maxNorm(a.value), y = maxNorm(b.value);
  return {dot(a.value, b.value),
          3.0 * (x * b.error + y * a.error + a.error * b.error) + 12.0 * kRounding * x * y + kUnderflow};
}

RoundedVec scaled(const RoundedVec& v, const RoundedNumber& factor) {
  const double x = maxNorm(v.value), y = std::abs(factor.value);
  return {v.value * factor.value,
          x * factor.error + y * v.error + v.error * factor.error + 2.0 * kRounding * x * y + kUnderflow};
}

RoundedVec sum(const RoundedVec& a, const RoundedVec& b) {
  const Vec3d value = a.value + b.value;
  return {value, a.error + b.error + 2.0 * kRounding * maxNorm(value)};
}

RoundedVec negated(const RoundedVec& v) {
  return {-v.value, v.error};
}

// The sign if it is beyond doubt. Not if anything has overflowed.
constexpr int kUnknown = 2;
int signOf(const RoundedNumber& number) {
  const double bound = 1.001 * number.error;
  return number.value > bound ? 1 : number.value < -bound ? -1 : kUnknown;
}

int signOf(const Whole& number) {
  return number.sign();
}

// A positive multiple of the vector, by a power of two, whose largest coordinate is about 1; the vector
// itself if it is zero or has overflowed.
RoundedVec normalised(const RoundedVec& v) {
  const double norm = maxNorm(v.value);
  if (!(norm > 1e-280 && norm < 1e280)) {
    return v;
  }
  int exponent = 0;
  std::frexp(norm, &exponent);
  const double factor = std::ldexp(1.0, -exponent);
  return {v.value * factor, v.error * factor + kUnderflow};
}

unsigned bits(const WholeVec& v) {
  const Whole largest = std::max({Whole(abs(v.x)), Whole(abs(v.y)), Whole(abs(v.z))});
  return largest.is_zero() ? 0u : static_cast<unsigned>(msb(largest)) + 1u;
}

// A positive multiple of the vector whose largest coordinate is about 1. Exact where the vector is zero.
RoundedVec rounded(const WholeVec& v) {
  const unsigned size = bits(v), dropped = size > 60 ? size - 60 : 0;
  const auto coordinate = [&](const Whole& c) {
    return std::ldexp(leadingPart(c, dropped), static_cast<int>(dropped) - static_cast<int>(size));
  };
  return {{coordinate(v.x), coordinate(v.y), coordinate(v.z)}, size > 0 ? 4.0 * kRounding : 0.0};
}

}  // namespace

void ImageFigures::clear() {
  lines_.clear();
  corners_.clear();
  depths_.clear();
  exact_.clear();
}

ImageFigures::Line ImageFigures::addLine(const LineData& line) {
  lines_.push_back(line);
  lines_.back().n = normalised(line.n);
  return static_cast<Line>(lines_.size() - 1);
}

ImageFigures::Corner ImageFigures::addCorner(const CornerData& corner) {
  corners_.push_back(corner);
  corners_.back().d = normalised(corner.d);
  return static_cast<Corner>(corners_.size() - 1);
}

std::uint32_t ImageFigures::keep(WholeVec value) {
  exact_.push_back(std::move(value));
  return static_cast<std::uint32_t>(exact_.size() - 1);
}

ImageFigures::Line ImageFigures::lineGiven(const Vec3d& n) {
  LineData line;
  line.n = {n, 0.0};
  return addLine(line);
}

ImageFigures::Line ImageFigures::lineThrough(std::uint32_t from, std::uint32_t to, bool other_side) {
  LineData line;
  line.kind = LineKind::kThroughPositions;
  line.first = from;
  line.second = to;
  line.other_side = other_side;
  // The difference of both is shorter than either, so that this rounds less than the cross product of both.
  line.n = cross(space_->direction(from), space_->difference(from, to));
  if (other_side) {
    line.n = negated(line.n);
  }
  return addLine(line);
}

ImageFigures::Depth ImageFigures::depthGiven(double depth) {
  DepthData data;
  data.is_given = true;
  data.given = depth;
  if (space_->view().orthographic) {
    data.n = {{0.0, 0.0, -depth * space_->forward().z}, 0.0};
    data.c = 1.0;
  } else {
    data.n = {space_->forward(), 0.0};
    data.c = depth;
  }
  depths_.push_back(data);
  return static_cast<Depth>(depths_.size() - 1);
}

ImageFigures::Depth ImageFigures::depthOf(const ImageTriangle& t) {
  DepthData data;
  data.triangle = t;
  const RoundedVec a = space_->direction(t.a), ab = space_->difference(t.a, t.b),
                   ac = space_->difference(t.a, t.c);
  const RoundedVec normal = cross(ab, ac);
  if (space_->view().orthographic) {
    const RoundedVec b = space_->direction(t.b), c = space_->direction(t.c);
    const auto weight = [&](std::uint32_t position) {
      return RoundedNumber{space_->weight(position), space_->weightError(position)};
    };
    data.n = sum(sum(scaled(cross(b, c), weight(t.a)), scaled(cross(c, a), weight(t.b))),
                 scaled(cross(a, b), weight(t.c)));
  } else {
    data.n = normal;
  }
  const RoundedNumber c = dot(a, normal);
  data.c = c.value;
  data.c_error = c.error;
  data.c_sign = orientation(t);
  depths_.push_back(data);
  return static_cast<Depth>(depths_.size() - 1);
}

ImageSpace::ExactNearness ImageFigures::exactNearness(const DepthData& depth) const {
  if (depth.is_given) {
    return space_->exactNearnessAt(depth.given);
  }
  const ImageTriangle& t = depth.triangle;
  const WholeVec a = space_->exactDirection(t.a), b = space_->exactDirection(t.b),
                 c = space_->exactDirection(t.c);
  if (!space_->view().orthographic) {
    const WholeVec n = cross(b - a, c - a);
    return {n, dot(n, a)};
  }
  const WholeVec bc = cross(b, c);
  const WholeVec n_a = bc * space_->exactWeight(t.a), n_b = cross(c, a) * space_->exactWeight(t.b),
                 n_c = cross(a, b) * space_->exactWeight(t.c);
  return {n_a + n_b + n_c, dot(a, bc)};
}

// near.n / near.c - far.n / far.c, times the positive |near.c far.c|.
ImageFigures::Line ImageFigures::lineWhereNearer(Depth near, Depth far) {
  LineData line;
  line.kind = LineKind::kWhereNearer;
  line.first = near;
  line.second = far;
  const DepthData &p = depths_[near], &q = depths_[far];
  line.n = sum(scaled(p.n, {q.c, q.c_error}), negated(scaled(q.n, {p.c, p.c_error})));
  if (p.c_sign * q.c_sign < 0) {
    line.n = negated(line.n);
  }
  return addLine(line);
}

const WholeVec& ImageFigures::exactNormal(Line index) {
  if (lines_[index].exact == kNone) {
    const LineData& line = lines_[index];
    WholeVec n;
    if (line.kind == LineKind::kThroughPositions) {
      n = cross(space_->exactDirection(line.first), space_->exactDirection(line.second));
      n = line.other_side ? -n : n;
    } else if (line.kind == LineKind::kGiven) {
      n = wholeMultipleOf(line.n.value);
    } else {
      const DepthData &near = depths_[line.first], &far = depths_[line.second];
      const ImageSpace::ExactNearness p = exactNearness(near), q = exactNearness(far);
      n = p.n * q.c - q.n * p.c;
      n = near.c_sign * far.c_sign < 0 ? -n : n;
    }
    lines_[index].n = rounded(n);
    lines_[index].exact = keep(std::move(n));
  }
  return exact_[lines_[index].exact];
}

const WholeVec& ImageFigures::exactDirection(Corner index) {
  if (corners_[index].exact == kNone) {
    const std::uint32_t position = corners_[index].position;
    WholeVec d;
    if (position != kNone) {
      d = space_->exactDirection(position);
    } else {
      const WholeVec n = exactNormal(corners_[index].line_a);  // a copy: the next call may move it
      d = cross(n, exactNormal(corners_[index].line_b));
    }
    d = corners_[index].opposite ? -d : d;
    corners_[index].d = rounded(d);
    corners_[index].exact = keep(std::move(d));
  }
  return exact_[corners_[index].exact];
}

bool ImageFigures::sameLine(Line a, Line b) const {
  if (a == b) {
    return true;
  }
  const LineData &p = lines_[a], &q = lines_[b];
  return p.kind == LineKind::kThroughPositions && q.kind == LineKind::kThroughPositions &&
         ((p.first == q.first && p.second == q.second) || (p.first == q.second && p.second == q.first));
}

ImageFigures::Corner ImageFigures::intersection(Line a, Line b) {
  const LineData &p = lines_[a], &q = lines_[b];
  CornerData corner;
  corner.line_a = a;
  corner.line_b = b;
  if (p.kind == LineKind::kThroughPositions && q.kind == LineKind::kThroughPositions) {
    corner.position = p.first == q.first || p.first == q.second     ? p.first
                      : p.second == q.first || p.second == q.second ? p.second
                                                                    : kNone;
  }
  corner.d = corner.position != kNone ? space_->direction(corner.position) : cross(p.n, q.n);
  const Corner index = addCorner(corner);
  turnBeforeTheEye(index);
  // Where the lines are nearly parallel, their rounded cross product is worth nothing.
  const RoundedVec& d = corners_[index].d;
  if (!(d.error <= kLargestError * maxNorm(d.value))) {
    exactDirection(index);
  }
  return index;
}

void ImageFigures::turnBeforeTheEye(Corner index) {
  int sign = signOf(dot({space_->forward(), 0.0}, corners_[index].d));
  if (sign == kUnknown) {
    sign = signOf(dot(wholeMultipleOf(space_->forward()), exactDirection(index)));
  }
  if (sign < 0) {
    corners_[index].opposite = true;
    corners_[index].d = negated(corners_[index].d);
    corners_[index].exact = kNone;
  }
}

ImageFigures::Corner ImageFigures::cornerGiven(const Vec3d& direction) {
  CornerData corner;
  corner.d = {direction, 0.0};
  corner.exact = keep(wholeMultipleOf(direction));
  return addCorner(corner);
}

ImageFigures::Corner ImageFigures::cornerOf(const Vec3d& point) {
  CornerData corner;
  corner.d.value = space_->directionOf(point);
  corner.d.error = 8.0 * kRounding * (maxNorm(point) + maxNorm(space_->view().eye));
  corner.exact = keep(space_->exactDirectionOf(point));
  return addCorner(corner);
}

ImageFigures::Corner ImageFigures::cornerBetween(std::span<const Corner> corners) {
  // All to the length of the longest, so that none is lost beside it.
  unsigned longest = 0;
  for (const Corner corner : corners) {
    longest = std::max(longest, bits(exactDirection(corner)));
  }
  WholeVec total;
  for (const Corner corner : corners) {
    const WholeVec& d = exactDirection(corner);
    total = total + d * (Whole(1) << (longest - bits(d)));
  }
  CornerData between;
  between.d = rounded(total);
  between.exact = keep(std::move(total));
  return addCorner(between);
}

bool ImageFigures::isOn(const LineData& line, const CornerData& corner) const {
  return corner.position != kNone && line.kind == LineKind::kThroughPositions &&
         (line.first == corner.position || line.second == corner.position);
}

bool ImageFigures::dividesNothing(Line line) {
  if (maxNorm(lines_[line].n.value) > 1.001 * lines_[line].n.error) {
    return false;
  }
  const WholeVec& n = exactNormal(line);
  return n.x.is_zero() && n.y.is_zero() && n.z.is_zero();
}

bool ImageFigures::isBeforeTheEye(Corner corner) {
  const int sign = signOf(dot({space_->forward(), 0.0}, corners_[corner].d));
  return sign != kUnknown ? sign > 0
                          : signOf(dot(wholeMultipleOf(space_->forward()), exactDirection(corner))) > 0;
}

int ImageFigures::side(Line line, Corner corner) {
  const LineData& l = lines_[line];
  const CornerData& c = corners_[corner];
  if (isOn(l, c) || (c.line_a != kNone && (sameLine(line, c.line_a) || sameLine(line, c.line_b)))) {
    return 0;
  }
  const int sign = signOf(dot(l.n, c.d));
  if (sign != kUnknown) {
    return sign;
  }
  const WholeVec n = exactNormal(line);
  return signOf(dot(n, exactDirection(corner)));
}

int ImageFigures::orientation(const ImageTriangle& t) const {
  const RoundedVec normal = cross(space_->difference(t.a, t.b), space_->difference(t.a, t.c));
  const int sign = signOf(dot(space_->direction(t.a), normal));
  if (sign != kUnknown) {
    return sign;
  }
  return signOf(
      dot(space_->exactDirection(t.a), cross(space_->exactDirection(t.b), space_->exactDirection(t.c))));
}

}  // namespace sightline
