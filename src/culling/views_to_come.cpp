#include "src/culling/views_to_come.h"

#include <algorithm>
#include <array>
#include <limits>
#include <span>

#include "src/scene/usable_view.h"

namespace sightline::culling {
namespace {

constexpr std::uint32_t kMostViews = 16;
// Views are planned for until what is at the middle of the depths in view has moved so many pixels of the
// buffer. With 4, three walks at 4 metres a second take 1.5 times as long, and keep up to a tenth less.
constexpr double kMostDrift = 8.0;
// The camera is followed as long as its eye strays from the line between the first and the last expected one
// by no more than kStray of what it walks meanwhile, and its picture to no side by more than kStrayTurn of
// what it turns, and kLeastTurn radians.
constexpr double kStray = 0.01, kStrayTurn = 0.25, kLeastTurn = 0.005;
// No picture is wider to one side than this slope. A camera that turns faster than this sine is not followed.
constexpr double kWidest = 2.5, kFastest = 0.5;
constexpr double kRounding = 1e-6;
// Slopes of a frustum's edges, and depths along them, are off by less than this where a view's axes are
// orthonormal to single precision.
constexpr double kSkew = 1e-4;

// The rotation by which the axes of one view became those of the next.
class Turn {
 public:
  Turn(const View& from, const View& to) : from_(from), to_(to) {}

  Vec3d operator()(const Vec3d& v) const {
    return to_.right * dot(from_.right, v) + to_.up * dot(from_.up, v) + to_.forward * dot(from_.forward, v);
  }
  // The sine of its angle; of more than a right angle, 1.
  double sine() const {
    const double cosine =
        0.5 * (dot(from_.right, to_.right) + dot(from_.up, to_.up) + dot(from_.forward, to_.forward) - 1.0);
    const Vec3d twice =
        cross(from_.right, to_.right) + cross(from_.up, to_.up) + cross(from_.forward, to_.forward);
    return cosine > 0.0 ? 0.5 * length(twice) : 1.0;
  }

 private:
  const View &from_, &to_;
};

double distanceToLine(const Vec3d& point, const Vec3d& from, const Vec3d& to) {
  const Vec3d along = to - from, v = point - from;
  const double size = dot(along, along);
  const double t = size > 0.0 ? std::clamp(dot(along, v) / size, 0.0, 1.0) : 0.0;
  return length(v - along * t);
}

}  // namespace

ViewsToCome::ViewsToCome(std::uint32_t most) : most_(std::min(most, kMostViews)) {}

void ViewsToCome::see(const View& view) {
  last_ = view_;
  view_ = view;
  seen_ = std::min(seen_ + 1, 2u);
}

bool ViewsToCome::takeHeld() {
  if (left_ == 0 || !contain(view_)) {
    left_ = 0;
    return false;
  }
  --left_;
  return true;
}

void ViewsToCome::forget() {
  seen_ = 0;
  end();
}

void ViewsToCome::measure(const View& view, const DepthBufferView& buffer) {
  if (most_ <= 1 || view.orthographic) {
    return;
  }
  constexpr std::uint32_t kEvery = 8;
  double sum = 0.0;
  std::uint32_t covered = 0;
  for (std::uint32_t y = kEvery / 2; y < buffer.height; y += kEvery) {
    for (std::uint32_t x = kEvery / 2; x < buffer.width; x += kEvery) {
      sum += buffer.covered(x, y) ? buffer.at(x, y) : 0.0;
      covered += buffer.covered(x, y) ? 1 : 0;
    }
  }
  const double pixels = 0.5 * buffer.height / view.tan_half_fovy;  // to a slope of 1
  pixels_a_metre_ = covered > 0 ? pixels * sum / covered : 0.0;
}

// How many views are worth planning for.
std::uint32_t ViewsToCome::count() const {
  const double drift = length(view_.eye - last_.eye) * pixels_a_metre_;
  return static_cast<std::uint32_t>(1.0 +
                                    std::min(most_ - 1.0, drift > 0.0 ? kMostDrift / drift : kMostViews));
}

void ViewsToCome::Extent::join(const Extent& other) {
  low_x = std::min(low_x, other.low_x);
  high_x = std::max(high_x, other.high_x);
  low_y = std::min(low_y, other.low_y);
  high_y = std::max(high_y, other.high_y);
  low_z = std::min(low_z, other.low_z);
  high_z = std::max(high_z, other.high_z);
  in_front = in_front && other.in_front;
}

ViewsToCome::Extent ViewsToCome::extentOf(const View& view) const {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  Extent extent{kNone, -kNone, kNone, -kNone, kNone, -kNone, true};
  for (const double side_x : {-1.0, 1.0}) {
    for (const double side_y : {-1.0, 1.0}) {
      const double x = (view.shift_x + side_x) * view.tan_half_fovy * view.aspect,
                   y = (view.shift_y + side_y) * view.tan_half_fovy;
      const Vec3d d = toWide(view.forward + view.right * x + view.up * y);
      extent.join({d.x / d.z, d.x / d.z, d.y / d.z, d.y / d.z, d.z, d.z, d.z > kRounding});
    }
  }
  return extent;
}

bool ViewsToCome::plan() {
  left_ = 0;
  const std::uint32_t views = seen_ == 2 && !view_.orthographic && !last_.orthographic ? count() : 1;
  const Turn turn(last_, view_);
  const double turned = turn.sine();
  if (views <= 1 || !(turned < kFastest)) {
    return false;
  }
  // Where the camera is expected.
  std::array<View, kMostViews> expected;
  expected[0] = view_;
  Vec3d step = view_.eye - last_.eye;
  const double stray = kStray * (views - 1) * length(step);
  for (std::uint32_t i = 1; i < views; ++i) {
    expected[i] = expected[i - 1];
    step = turn(step);
    expected[i].eye = expected[i].eye + step;
    expected[i].right = turn(expected[i].right);
    expected[i].up = turn(expected[i].up);
    expected[i].forward = turn(expected[i].forward);
  }
  const std::span<const View> all = std::span(expected).first(views);
  first_ = all.front().eye;
  end_ = all.back().eye;
  double bend = 0.0;
  for (const View& view : all) {
    bend = std::max(bend, distanceToLine(view.eye, first_, end_));
  }
  spread_ = stray + bend;

  wide_ = view_;
  setOrientation(wide_, all.front().forward + all.back().forward, all.front().up + all.back().up);
  shown_ = extentOf(all.front());
  for (const View& view : all.subspan(1)) {
    shown_.join(extentOf(view));
  }
  if (!widen(kLeastTurn + kStrayTurn * turned * (views - 1))) {
    return false;
  }
  const double back = std::max({0.0, backFor(first_), backFor(end_)});
  wide_.eye = view_.eye - wide_.forward * back;
  const double along = toWide(end_ - first_).z;
  wide_.z_near = 0.9 * (back + std::min(along, 0.0) - spread_ + view_.z_near * shown_.low_z);
  wide_.z_far = (back + std::max(along, 0.0) + spread_ + view_.z_far * shown_.high_z) * (1.0 + kRounding);
  viewers_.offsets = {first_ - wide_.eye, end_ - wide_.eye};
  viewers_.radius = spread_ * (1.0 + kRounding) + 0x1p-40 * maxComponent(abs(view_.eye));
  viewers_.near_distance = nearDistance(view_) * (1.0 + kRounding);
  left_ = views;
  return scene::makeUsable(wide_) == nullptr && takeHeld();
}

// Widens what is shown by an angle to all sides, and makes it the picture of wide_. False: it is too wide.
bool ViewsToCome::widen(double by) {
  const auto wider = [by](double slope) { return by * (1.0 + slope * slope); };
  shown_.low_x -= wider(shown_.low_x);
  shown_.high_x += wider(shown_.high_x);
  shown_.low_y -= wider(shown_.low_y);
  shown_.high_y += wider(shown_.high_y);
  shown_.low_z *= 1.0 - 2.0 * by;
  shown_.high_z *= 1.0 + 2.0 * by;
  const auto fits = [](double low, double high) {
    return low < 0.0 && high > 0.0 && -low < kWidest && high < kWidest;
  };
  if (!shown_.in_front || !fits(shown_.low_x, shown_.high_x) || !fits(shown_.low_y, shown_.high_y)) {
    return false;
  }
  const double width = shown_.high_x - shown_.low_x, height = shown_.high_y - shown_.low_y;
  wide_.tan_half_fovy = 0.5 * height;
  wide_.aspect = width / height;
  wide_.shift_x = (shown_.high_x + shown_.low_x) / width;
  wide_.shift_y = (shown_.high_y + shown_.low_y) / height;
  return true;
}

// How far the eye of wide_ has to be moved back, from that of the frame, so that another eye and all within
// spread_ of it lie in the infinite pyramid of its picture: low_x * z <= x <= high_x * z, and so for y.
double ViewsToCome::backFor(const Vec3d& eye) const {
  const Vec3d at = toWide(eye - view_.eye);
  const double around = spread_ * (1.0 + kWidest) * (1.0 + kRounding);
  return std::max({around, (at.x + around) / shown_.high_x, (at.x - around) / shown_.low_x,
                   (at.y + around) / shown_.high_y, (at.y - around) / shown_.low_y}) -
         at.z;
}

bool ViewsToCome::contain(const View& view) const {
  if (view.orthographic || !(nearDistance(view) <= viewers_.near_distance) ||
      !(distanceToLine(view.eye, first_, end_) <= spread_)) {
    return false;
  }
  const Extent extent = extentOf(view);
  const Vec3d at = toWide(view.eye - wide_.eye);
  const auto within = [](double low, double high, double outer_low, double outer_high) {
    return low > outer_low + kSkew && high < outer_high - kSkew;
  };
  return extent.in_front && within(extent.low_x, extent.high_x, shown_.low_x, shown_.high_x) &&
         within(extent.low_y, extent.high_y, shown_.low_y, shown_.high_y) && at.x >= shown_.low_x * at.z &&
         at.x <= shown_.high_x * at.z && at.y >= shown_.low_y * at.z && at.y <= shown_.high_y * at.z &&
         at.z + view.z_near * extent.low_z * (1.0 - kSkew) >= wide_.z_near &&
         at.z + view.z_far * extent.high_z * (1.0 + kSkew) <= wide_.z_far;
}

}  // namespace sightline::culling
