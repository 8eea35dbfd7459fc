#include "scenes/walk.h"

#include <algorithm>

namespace sightline::scenes {
namespace {

// Points of a polyline by the distance along it.
class MeasuredLine {
 public:
  explicit MeasuredLine(std::span<const Vec3d> line) : line_(line), distance_(line.size(), 0.0) {
    for (std::size_t i = 1; i < line.size(); ++i) {
      distance_[i] = distance_[i - 1] + length(line[i] - line[i - 1]);
    }
  }
  double total() const { return distance_.back(); }
  // Beyond either end, the line continues straight.
  Vec3d at(double distance) const {
    const auto after = std::upper_bound(distance_.begin() + 1, distance_.end() - 1, distance);
    const auto i = static_cast<std::size_t>(after - distance_.begin());
    const double t = (distance - distance_[i - 1]) / (distance_[i] - distance_[i - 1]);
    return line_[i - 1] + (line_[i] - line_[i - 1]) * t;
  }

 private:
  std::span<const Vec3d> line_;
  std::vector<double> distance_;
};

void appendCorner(std::vector<Vec3d>& line, const Vec3d& from, const Vec3d& corner, const Vec3d& to) {
  constexpr int kPieces = 24;
  for (int i = 0; i <= kPieces; ++i) {
    const double t = static_cast<double>(i) / kPieces;
    line.push_back(from * ((1 - t) * (1 - t)) + corner * (2 * t * (1 - t)) + to * (t * t));
  }
}

// Replaces each viewing direction by the mean of its neighbours'.
void calmLooks(std::vector<CameraFrame>& frames, std::size_t reach) {
  const std::vector<CameraFrame> before = frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const std::size_t low = i < reach ? 0 : i - reach, high = std::min(i + reach, frames.size() - 1);
    Vec3d sum;
    for (std::size_t k = low; k <= high; ++k) {
      sum += before[k].forward;
    }
    frames[i].forward = normalized(sum);
  }
}

// Limits the turn from each viewing direction to the next to max_turn, as a fraction of a full turn.
void limitTurns(std::vector<CameraFrame>& frames, double max_turn) {
  const Point2 most = unitVector(max_turn);
  for (std::size_t i = 1; i < frames.size(); ++i) {
    const Vec3d before = frames[i - 1].forward;
    Vec3d& look = frames[i].forward;
    const double cosine = dot(before, look);
    if (cosine < most.x) {
      look = before * most.x + normalized(look - before * cosine) * most.y;
    }
  }
}

}  // namespace

std::vector<Vec3d> roundedRoute(std::span<const Vec3d> corners, double radius) {
  std::vector<Vec3d> line{corners.front()};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    const Vec3d back = corners[i - 1] - corners[i], on = corners[i + 1] - corners[i];
    const double reach = std::min({radius, length(back) * 0.499, length(on) * 0.499});
    appendCorner(line, corners[i] + normalized(back) * reach, corners[i],
                 corners[i] + normalized(on) * reach);
  }
  line.push_back(corners.back());
  return line;
}

CameraPath walkAlong(std::span<const Vec3d> line, const WalkOptions& options) {
  const MeasuredLine measured(line);
  CameraPath path;
  path.name = options.name;
  path.z_far = options.far;
  path.frames.reserve(options.frames);
  for (std::uint32_t i = 0; i < options.frames; ++i) {
    const double part = options.frames > 1 ? static_cast<double>(i) / (options.frames - 1) : 0.0;
    const double walked = part * measured.total();
    const Vec3d eye = measured.at(walked);
    Vec3d forward = normalized(measured.at(walked + options.look_ahead) - eye);
    const double swing = options.glance * unitVector(part * options.glance_turns).y;
    forward += normalized(Vec3d(forward.y, -forward.x, 0.0)) * swing;
    forward.z += options.tilt;
    path.frames.push_back({worldFromPlan(eye), normalized(worldFromPlan(forward)), {0.0, 1.0, 0.0}});
  }
  for (int pass = 0; pass < 2 && options.calm > 0; ++pass) {
    calmLooks(path.frames, options.calm);
  }
  limitTurns(path.frames, options.max_turn);
  return path;
}

}  // namespace sightline::scenes
