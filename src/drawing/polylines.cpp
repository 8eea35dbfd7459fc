#include "src/drawing/polylines.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <utility>

namespace sightline::drawing {
namespace {

// Piece i has the ends 2 i (from) and 2 i + 1 (to).
constexpr std::uint32_t kNone = 0xffffffffu;
constexpr std::size_t kManyEnds = 16;

struct CornerEnd {
  std::uint32_t corner = 0;  // index into SceneView::positions
  std::uint32_t end = 0;
  double angle = 0.0;  // direction of the piece as it leaves the corner
};

std::vector<CornerEnd> endsAtCorners(std::span<const LinePiece> pieces) {
  std::vector<CornerEnd> ends;
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    const LinePiece& piece = pieces[i];
    const double x = piece.to.x - piece.from.x, y = piece.to.y - piece.from.y;
    if (piece.from_share <= 0.0) {
      ends.push_back({piece.line.a, 2 * i, std::atan2(y, x)});
    }
    if (piece.to_share >= 1.0) {
      ends.push_back({piece.line.b, 2 * i + 1, std::atan2(-y, -x)});
    }
  }
  std::sort(ends.begin(), ends.end(), [](const CornerEnd& s, const CornerEnd& t) {
    return std::pair(s.corner, s.end) < std::pair(t.corner, t.end);
  });
  return ends;
}

// The angle by which a stroke bends from one end of a corner to the other; 0 if it goes straight on.
double bendOf(const CornerEnd& s, const CornerEnd& t) {
  const double between = std::remainder(s.angle - t.angle, 2.0 * std::numbers::pi);
  return std::numbers::pi - std::abs(between);
}

// Pairs all ends of a corner, except one if their number is odd.
void pairEnds(std::span<CornerEnd> ends, std::vector<std::uint32_t>& mates) {
  const auto join = [&](const CornerEnd& s, const CornerEnd& t) {
    mates[s.end] = t.end;
    mates[t.end] = s.end;
  };
  if (ends.size() > kManyEnds) {
    // At the tip of a cone the opposite end is nearly straight, and found quickly.
    std::stable_sort(ends.begin(), ends.end(),
                     [](const CornerEnd& s, const CornerEnd& t) { return s.angle < t.angle; });
    const std::size_t half = ends.size() / 2;
    for (std::size_t i = 0; i < half; ++i) {
      join(ends[i], ends[i + half]);
    }
    return;
  }
  struct Choice {
    double bend;
    std::size_t s, t;
  };
  std::vector<Choice> choices;
  for (std::size_t s = 0; s < ends.size(); ++s) {
    for (std::size_t t = s + 1; t < ends.size(); ++t) {
      choices.push_back({bendOf(ends[s], ends[t]), s, t});
    }
  }
  std::stable_sort(choices.begin(), choices.end(),
                   [](const Choice& c, const Choice& d) { return c.bend < d.bend; });
  for (const Choice& choice : choices) {
    if (mates[ends[choice.s].end] == kNone && mates[ends[choice.t].end] == kNone) {
      join(ends[choice.s], ends[choice.t]);
    }
  }
}

std::vector<std::uint32_t> matesOf(std::span<const LinePiece> pieces) {
  std::vector<std::uint32_t> mates(2 * pieces.size(), kNone);
  std::vector<CornerEnd> ends = endsAtCorners(pieces);
  for (std::size_t first = 0, last = 0; first < ends.size(); first = last) {
    while (last < ends.size() && ends[last].corner == ends[first].corner) {
      ++last;
    }
    pairEnds(std::span(ends).subspan(first, last - first), mates);
  }
  return mates;
}

const PagePoint& pointOf(std::span<const LinePiece> pieces, std::uint32_t end) {
  const LinePiece& piece = pieces[end / 2];
  return end % 2 == 0 ? piece.from : piece.to;
}

// Follows pieces from an end on, from mate to mate, until there is none or the stroke closes.
PagePath follow(std::span<const LinePiece> pieces, const std::vector<std::uint32_t>& mates,
                std::uint32_t start, std::vector<bool>& done) {
  PagePath path{pointOf(pieces, start)};
  std::uint32_t end = start;
  while (true) {
    done[end / 2] = true;
    const std::uint32_t other = end ^ 1u;
    path.push_back(pointOf(pieces, other));
    end = mates[other];
    if (end == kNone) {
      return path;
    }
    if (end == start) {
      path.back() = path.front();
      return path;
    }
  }
}

double distance(const PagePoint& a, const PagePoint& b) {
  return std::hypot(b.x - a.x, b.y - a.y);
}

bool isShorter(const PagePath& path, double length) {
  double sum = 0.0;
  for (std::size_t i = 1; i < path.size() && sum < length; ++i) {
    sum += distance(path[i - 1], path[i]);
  }
  return sum < length;
}

// The directions from an anchor along which a line passes all points so far within the tolerance.
class Sleeve {
 public:
  Sleeve(const PagePoint& anchor, double tolerance) : anchor_(anchor), tolerance_(tolerance) {}

  // False if a line from the anchor to p does not pass all points before p.
  bool add(const PagePoint& p) {
    const double reach = distance(anchor_, p);
    if (reach < farthest_) {
      return false;  // it turns back
    }
    farthest_ = reach;
    if (reach <= tolerance_) {
      return true;
    }
    const double angle = std::atan2(p.y - anchor_.y, p.x - anchor_.x);
    if (!has_direction_) {
      has_direction_ = true;
      zero_ = angle;
    }
    const double turn = std::remainder(angle - zero_, 2.0 * std::numbers::pi);
    if (turn < low_ || turn > high_) {
      return false;
    }
    const double half = std::asin(tolerance_ / reach);
    low_ = std::max(low_, turn - half);
    high_ = std::min(high_, turn + half);
    return true;
  }

 private:
  PagePoint anchor_;
  double tolerance_;
  double farthest_ = 0.0, zero_ = 0.0, low_ = -std::numbers::pi, high_ = std::numbers::pi;
  bool has_direction_ = false;
};

}  // namespace

void simplify(PagePath& line, double tolerance) {
  if (line.size() < 3) {
    return;
  }
  PagePath kept{line[0]};
  Sleeve sleeve(line[0], tolerance);
  for (std::size_t i = 1; i < line.size(); ++i) {
    if (!sleeve.add(line[i])) {
      kept.push_back(line[i - 1]);
      sleeve = Sleeve(line[i - 1], tolerance);
      sleeve.add(line[i]);
    }
  }
  kept.push_back(line.back());
  line = std::move(kept);
}

void joinPieces(std::span<const LinePiece> pieces, double tolerance, std::vector<PagePath>& strokes) {
  strokes.clear();
  const std::vector<std::uint32_t> mates = matesOf(pieces);
  std::vector<bool> done(pieces.size(), false);
  const auto take = [&](std::uint32_t end) {
    PagePath path = follow(pieces, mates, end, done);
    if (!isShorter(path, tolerance)) {
      simplify(path, tolerance);
      strokes.push_back(std::move(path));
    }
  };
  for (std::uint32_t end = 0; end < mates.size(); ++end) {
    if (mates[end] == kNone && !done[end / 2]) {
      take(end);
    }
  }
  // Strokes that are left are closed.
  for (std::uint32_t i = 0; i < pieces.size(); ++i) {
    if (!done[i]) {
      take(2 * i);
    }
  }
}

void DrawnPieces::leaveNew(std::vector<LinePiece>& pieces) {
  const auto steps = [this](double value) {
    return static_cast<std::int64_t>(std::llround(value / tolerance_));
  };
  std::erase_if(pieces, [&](const LinePiece& piece) {
    const std::pair from(steps(piece.from.x), steps(piece.from.y));
    const std::pair to(steps(piece.to.x), steps(piece.to.y));
    const auto& [low, high] = std::minmax(from, to);
    return !drawn_.insert({low.first, low.second, high.first, high.second}).second;
  });
}

}  // namespace sightline::drawing
