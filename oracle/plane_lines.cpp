#include "oracle/plane_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace sightline {
namespace {

constexpr double kSteepest = 30.0;  // slope of the steepest lines that are searched
constexpr double kNarrow = 1e-13;   // width of a piece, of all lines' extent, below which it is rounding
constexpr int kAttempts = 3;        // lines of one free piece that are offered

using Piece = std::vector<PlanePoint>;

// The part of the piece whose lines have the point on their left (or on their right), borders included.
Piece clipped(const Piece& piece, const PlanePoint& point, bool left) {
  Piece kept = clippedWhere(piece, [&](const PlanePoint& line) {
    const double f = PlaneLine{line.x, line.y}.leftOf(point);
    return left ? f : -f;
  });
  if (kept.size() < 3) {
    kept.clear();
  }
  return kept;
}

Piece throughGate(const Piece& piece, const Gate& gate) {
  return clipped(clipped(piece, gate.left, true), gate.right, false);
}

double extentOf(const Piece& piece) {
  double extent = 0.0;
  for (const PlanePoint& p : piece) {
    extent = std::max(extent, std::abs(p.x - piece[0].x) + std::abs(p.y - piece[0].y));
  }
  return extent;
}

double widthOf(const Piece& piece) {
  double twice_area = 0.0;
  for (std::size_t i = 2; i < piece.size(); ++i) {
    twice_area += (piece[i - 1].x - piece[0].x) * (piece[i].y - piece[0].y) -
                  (piece[i - 1].y - piece[0].y) * (piece[i].x - piece[0].x);
  }
  const double extent = extentOf(piece);
  return extent > 0.0 ? std::abs(twice_area) / extent : 0.0;
}

// The middle of the corners; other attempts are nearer to one of them.
PlaneLine lineOf(const Piece& piece, int attempt) {
  PlanePoint sum;
  for (const PlanePoint& p : piece) {
    sum.x += p.x, sum.y += p.y;
  }
  const auto count = static_cast<double>(piece.size());
  PlaneLine line{sum.x / count, sum.y / count};
  if (attempt > 0) {
    const PlanePoint& corner = piece[static_cast<std::size_t>(attempt) % piece.size()];
    line = {0.5 * (line.slope + corner.x), 0.5 * (line.height + corner.y)};
  }
  return line;
}

}  // namespace

double PlaneLine::crossing(const Gate& gate) const {
  const double left = leftOf(gate.left), right = leftOf(gate.right);
  const double s = left > right ? left / (left - right) : 0.5;
  return gate.left.x + s * (gate.right.x - gate.left.x);
}

bool PlaneLines::wide(const Piece& piece) const {
  return piece.size() >= 3 && widthOf(piece) > min_width_;
}

bool PlaneLines::search(const Gate& from, const Gate& to, std::span<const Gate> blockers,
                        std::uint32_t max_steps, const Accept& accept) {
  from_ = from, to_ = to, blockers_ = blockers;
  steps_ = 0;
  best_blocked_ = std::numeric_limits<std::uint32_t>::max();
  double reach = 1.0;
  for (const PlanePoint& p : std::array{from.left, from.right, to.left, to.right}) {
    reach = std::max(reach, std::abs(p.x) * kSteepest + std::abs(p.y));
  }
  const double high = 2.0 * reach;
  Piece all{{-kSteepest, -high}, {kSteepest, -high}, {kSteepest, high}, {-kSteepest, high}};
  all = throughGate(throughGate(all, from), to);
  min_width_ = kNarrow * extentOf(all);
  pieces_.clear();
  if (wide(all)) {
    pieces_.push_back(std::move(all));
  }
  while (!pieces_.empty() && steps_ < max_steps) {
    const Piece piece = std::move(pieces_.back());
    pieces_.pop_back();
    const PlaneLine line = lineOf(piece, 0);
    ++steps_;
    const Gate* blocker = blockerOn(line, piece);
    const bool forwards = line.crossing(to_) > line.crossing(from_);
    if (forwards && blocked_ < best_blocked_) {
      best_ = line;
      best_blocked_ = blocked_;
    }
    if (blocker != nullptr) {
      subtract(piece, *blocker);
      continue;
    }
    for (int attempt = 0; forwards && attempt < kAttempts; ++attempt) {
      if (accept(lineOf(piece, attempt))) {
        return true;
      }
    }
  }
  return false;
}

const Gate* PlaneLines::blockerOn(const PlaneLine& line, const Piece& piece) {
  const double begin = line.crossing(from_), end = line.crossing(to_);
  const Gate* best = nullptr;
  std::ptrdiff_t most = -1;
  blocked_ = 0;
  for (const Gate& gate : blockers_) {
    if (!line.crosses(gate)) {
      continue;
    }
    const double x = line.crossing(gate);
    if (!(x > begin && x < end)) {
      continue;
    }
    ++blocked_;
    const std::ptrdiff_t corners = std::count_if(piece.begin(), piece.end(), [&](const PlanePoint& p) {
      return PlaneLine{p.x, p.y}.crosses(gate);
    });
    if (corners > most) {
      most = corners;
      best = &gate;
    }
  }
  return best;
}

void PlaneLines::subtract(const Piece& piece, const Gate& gate) {
  Piece before = clipped(piece, gate.left, false);
  Piece after = clipped(clipped(piece, gate.left, true), gate.right, true);
  if (wide(before)) {
    pieces_.push_back(std::move(before));
  }
  if (wide(after)) {
    pieces_.push_back(std::move(after));
  }
}

}  // namespace sightline
