#include "oracle/region_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "oracle/plane_section.h"
#include "oracle/ray_scene.h"
#include "oracle/sample_points.h"
#include "oracle/visibility_proof.h"

namespace sightline {
namespace {

constexpr std::size_t kBestLines = 4;       // from which the search goes on
constexpr std::size_t kTargets = 12;        // segments of the object that are searched in a plane
constexpr double kNarrowPicture = 1e-4;     // tangent of half the angle of a view along a line
constexpr double kWidestPicture = 2.0;      // of a view of the whole object
constexpr double kWithinNear = 1.0 - 1e-9;  // allows for the rounding of nearDistance()

constexpr int kCornerAttempts = 16;  // lines whose blockers' corners are tried for one plane
constexpr double kBeyondHit = 1e-4;  // of a line: where the search for the next blocker begins

struct SightLine {
  Vec3d eye, target;
  std::uint32_t blocked = 0;  // surfaces between them
};

Vec3d anyDirection(SplitMix& random) {
  const double z = random.in(-1.0, 1.0), angle = random.in(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(std::max(0.0, 1.0 - z * z));
  return {r * std::cos(angle), r * std::sin(angle), z};
}

// A square picture with its near plane as far away as the bake allows.
View viewAlong(const Vec3d& eye, const Vec3d& forward, double tan_half, double near_distance) {
  View view;
  view.eye = eye;
  setOrientation(view, forward,
                 std::abs(forward.y) < 0.9 * length(forward) ? Vec3d(0, 1, 0) : Vec3d(1, 0, 0));
  view.tan_half_fovy = tan_half;
  view.aspect = 1.0;
  view.z_far = std::numeric_limits<double>::infinity();
  view.z_near = 1.0;
  view.z_near = near_distance / nearDistance(view) * kWithinNear;
  return view;
}

}  // namespace

struct RegionSearch::Impl {
  explicit Impl(const SceneView& scene_) : scene(scene_), rays(scene_), samples(scene_), proofs(scene_) {}

  SceneView scene;
  RayScene rays;
  SamplePoints samples;
  ProofScene proofs;
};

// One search. Its steps return true as soon as the object is seen.
class RegionSearch::Attempt {
 public:
  Attempt(const Impl& impl, const EyeRegion& region, ObjectId object, const RegionSearchSettings& settings,
          std::uint64_t seed)
      : impl_(impl), places_(region), object_(object), settings_(settings), random_{seed} {}

  RegionAnswer run() {
    const bool has_triangles = impl_.proofs.tree.rootOf(object_) != TriangleTree::kNoNode;
    if (has_triangles && !places_.empty()) {
      answer_.found = byLines() || byPlanes() || byEyes();
    }
    return answer_;
  }

 private:
  bool byLines();
  bool byPlanes();
  bool byEyes();

  Vec3d anyTarget(const Vec3d& eye);
  Vec3d across(std::uint32_t turn, const SightLine& line);
  std::optional<SightLine> pastCorners();
  Vec3d cornerOf(const RayHit& hit, std::uint32_t i) const {
    return Vec3d(impl_.scene.positions[impl_.scene.indices[hit.first_index + i % 3]]);
  }
  bool searchPlane(const SightLine& line, const Vec3d& across);
  std::optional<SightLine> advanced(const Vec3d& eye, const Vec3d& target) const;
  bool sees(const Vec3d& eye, const Vec3d& target);
  bool decide(const Vec3d& eye);
  void keep(const SightLine& line);
  RayHit firstHit(const SightLine& line);

  const Impl& impl_;
  const EyePlaces places_;
  const ObjectId object_;
  const RegionSearchSettings settings_;
  SplitMix random_;
  std::uint32_t sample_ = 0;  // of the object's points
  PlaneLines plane_lines_;
  std::vector<SightLine> best_;  // ascending by what blocks them
  std::vector<RayHit> hits_;
  RegionAnswer answer_;
};

// The line with its eye as near to the target as the region and the near distance allow. It sees what any
// other eye on it sees, because less is in its way. Nothing if the target is too near wherever the eye is.
std::optional<SightLine> RegionSearch::Attempt::advanced(const Vec3d& eye, const Vec3d& target) const {
  const Vec3d sight = target - eye;
  const double distance = length(sight);
  double enter = 0.0, leave = 0.0;
  if (!(distance > 0.0) || !places_.interval(eye, sight, enter, leave)) {
    return std::nullopt;
  }
  const double last = 1.0 - settings_.near_distance * (1.0 + 1e-6) / distance;
  const double at = std::min(leave, last);
  if (!(at >= enter) || !(at < 1.0)) {
    return std::nullopt;
  }
  return SightLine{places_.inside(eye + sight * at), target, 0};
}

// Decides whether the eye sees the object at this point.
bool RegionSearch::Attempt::sees(const Vec3d& eye, const Vec3d& target) {
  const View view = viewAlong(eye, target - eye, kNarrowPicture, settings_.near_distance);
  if (!VisibilityProof(impl_.proofs, impl_.rays, view).reaches(target, object_)) {
    return false;
  }
  answer_.eye = eye;
  answer_.view = view;
  answer_.witness = {object_, target};
  return true;
}

Vec3d RegionSearch::Attempt::anyTarget(const Vec3d& eye) {
  View view;
  view.eye = eye;
  return impl_.samples.point(object_, sample_++, view);
}

bool RegionSearch::Attempt::byLines() {
  answer_.by = FoundBy::kLine;
  while (answer_.lines < settings_.lines) {
    RayScene::Batch batch;
    std::array<SightLine, RayScene::kBatch> lines;
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < RayScene::kBatch && answer_.lines < settings_.lines; ++i) {
      ++answer_.lines;
      const Vec3d eye = places_.point(random_), target = anyTarget(eye);
      if (const std::optional<SightLine> line = advanced(eye, target)) {
        const Vec3d sight = line->target - line->eye;
        const double near = settings_.near_distance * kWithinNear / length(sight);
        const Vec3d origin = line->eye + sight * near;
        batch[count] = {Vec3f(origin), Vec3f(line->target - origin), 1.0f + 1e-5f};
        lines[count++] = *line;
      }
    }
    hits_.clear();
    impl_.rays.trace(batch, count, false, hits_);
    for (const RayHit& hit : hits_) {
      if (hit.object == object_ && sees(lines[hit.ray].eye, lines[hit.ray].target)) {
        return true;
      }
    }
  }
  return false;
}

// A direction that spans a plane with the line.
Vec3d RegionSearch::Attempt::across(std::uint32_t turn, const SightLine& line) {
  if (turn % 4 == 0) {
    Vec3d axis{};
    axis[static_cast<int>(random_.below(3))] = 1.0;
    return axis;
  }
  if (turn % 4 == 1) {
    // Across an edge of what blocks the line.
    const RayHit hit = firstHit(line);
    if (hit.object.valid()) {
      const std::uint32_t side = random_.below(3);
      return cross(cornerOf(hit, side + 1) - cornerOf(hit, side), line.target - line.eye);
    }
  }
  return anyDirection(random_);
}

RayHit RegionSearch::Attempt::firstHit(const SightLine& line) {
  RayScene::Batch batch;
  const Vec3d sight = line.target - line.eye;
  const Vec3d origin = line.eye + sight * (settings_.near_distance * kWithinNear / length(sight));
  batch[0] = {Vec3f(origin), Vec3f(line.target - origin), 1.0f};
  hits_.clear();
  impl_.rays.trace(batch, 1, false, hits_);
  const auto opaque = std::find_if(hits_.begin(), hits_.end(), [](const RayHit& hit) { return hit.opaque; });
  return opaque != hits_.end() ? *opaque : RayHit{};
}

// A line through corners of the first two surfaces that block a line: if there are small openings beside both
// corners, planes through it look through both.
std::optional<SightLine> RegionSearch::Attempt::pastCorners() {
  const Box& bounds = impl_.scene.objects[object_.value].bounds;
  const Vec3d middle = center(bounds);
  const double radius = 0.5 * length(Vec3d(bounds.max) - Vec3d(bounds.min));
  for (int attempt = 0; attempt < kCornerAttempts; ++attempt) {
    SightLine line;
    line.eye = places_.point(random_);
    line.target = anyTarget(line.eye);
    const RayHit first = firstHit(line);
    if (!first.object.valid()) {
      continue;
    }
    const Vec3d sight = line.target - line.eye;
    const double near = settings_.near_distance * kWithinNear / length(sight);
    const double beyond = near + (1.0 - near) * (static_cast<double>(first.t) + kBeyondHit);
    const RayHit second = firstHit({line.eye + sight * beyond, line.target, 0});
    if (!second.object.valid() || second.object == object_) {
      continue;
    }
    const Vec3d p = cornerOf(first, random_.below(3)), q = cornerOf(second, random_.below(3));
    const Vec3d d = q - p;
    double enter = 0.0, leave = 0.0;
    if (!(dot(d, sight) > 0.0) || !places_.interval(p, d, enter, leave) || !(leave < 1.0)) {
      continue;
    }
    const Vec3d target = p + d * (dot(middle - p, d) / dot(d, d));
    if (length(target - middle) <= radius && dot(target - q, d) > 0.0) {
      return SightLine{p + d * leave, target, 0};
    }
  }
  return std::nullopt;
}

bool RegionSearch::Attempt::byPlanes() {
  answer_.by = FoundBy::kPlane;
  for (std::uint32_t i = 0; i < settings_.planes; ++i) {
    SightLine line;
    if (const std::optional<SightLine> past = i % 4 == 2 ? pastCorners() : std::nullopt) {
      line = *past;
    } else if (i % 2 == 1 && !best_.empty()) {
      line = best_[random_.below(static_cast<std::uint32_t>(best_.size()))];
    } else {
      line.eye = places_.point(random_);
      line.target = anyTarget(line.eye);
    }
    if (searchPlane(line, across(i / 2, line))) {
      return true;
    }
  }
  return false;
}

bool RegionSearch::Attempt::searchPlane(const SightLine& line, const Vec3d& across) {
  std::optional<PlaneSection> section = PlaneSection::through(line.eye, line.target, across);
  if (!section) {
    return false;
  }
  ++answer_.planes;
  section->cut(impl_.scene, impl_.proofs.tree, places_, object_, settings_.near_distance);
  std::vector<Gate> targets(section->targets().begin(), section->targets().end());
  for (std::size_t i = 0; i < std::min(targets.size(), kTargets); ++i) {
    const auto left = static_cast<std::uint32_t>(targets.size() - i);
    std::swap(targets[i], targets[i + random_.below(left)]);
  }
  targets.resize(std::min(targets.size(), kTargets));
  std::uint32_t steps = 0;
  SightLine best{{}, {}, std::numeric_limits<std::uint32_t>::max()};
  for (const Gate& target : targets) {
    for (const Gate& exit : section->exits()) {
      const auto inSpace = [&](const PlaneLine& found) {
        return SightLine{section->inSpace(found.at(found.crossing(exit))),
                         section->inSpace(found.at(found.crossing(target))), 0};
      };
      const auto accept = [&](const PlaneLine& found) {
        const SightLine free = inSpace(found);
        const std::optional<SightLine> from = advanced(free.eye, free.target);
        return from && sees(from->eye, from->target);
      };
      if (steps >= settings_.plane_steps) {
        break;
      }
      if (plane_lines_.search(exit, target, section->blockers(), settings_.plane_steps - steps, accept)) {
        return true;
      }
      steps += plane_lines_.steps();
      if (plane_lines_.bestBlocked() < best.blocked) {
        best = inSpace(plane_lines_.best());
        best.blocked = plane_lines_.bestBlocked();
      }
    }
  }
  if (best.blocked != std::numeric_limits<std::uint32_t>::max()) {
    keep(best);
  }
  return false;
}

void RegionSearch::Attempt::keep(const SightLine& line) {
  const auto at =
      std::lower_bound(best_.begin(), best_.end(), line,
                       [](const SightLine& a, const SightLine& b) { return a.blocked < b.blocked; });
  best_.insert(at, line);
  best_.resize(std::min(best_.size(), kBestLines));
}

bool RegionSearch::Attempt::byEyes() {
  answer_.by = FoundBy::kEye;
  for (std::uint32_t i = 0; i < settings_.eyes; ++i) {
    SightLine line;
    if (i < best_.size()) {
      line = best_[i];
    } else {
      line.eye = i < best_.size() + 8 ? places_.corner(i - static_cast<std::uint32_t>(best_.size()))
                                      : places_.point(random_);
      line.target = anyTarget(line.eye);
    }
    const std::optional<SightLine> from = advanced(line.eye, line.target);
    if (from && decide(from->eye)) {
      return true;
    }
  }
  return false;
}

// Looks at the object's box, in several pictures if the eye is close to it.
bool RegionSearch::Attempt::decide(const Vec3d& eye) {
  const Box& box = impl_.scene.objects[object_.value].bounds;
  if (!box.wellFormed()) {
    return false;
  }
  const auto corner = [&](int i) {
    return Vec3d((i & 1) != 0 ? box.max.x : box.min.x, (i & 2) != 0 ? box.max.y : box.min.y,
                 (i & 4) != 0 ? box.max.z : box.min.z);
  };
  ++answer_.eyes;
  std::vector<View> views;
  if (length(center(box) - eye) > 0.0) {
    View view = viewAlong(eye, center(box) - eye, 1.0, settings_.near_distance);
    double widest = 0.0;
    for (int i = 0; i < 8; ++i) {
      const Vec3d d = corner(i) - eye;
      const double depth = dot(d, view.forward);
      const double aside = std::max(std::abs(dot(d, view.right)), std::abs(dot(d, view.up)));
      widest = depth > 0.0 ? std::max(widest, aside / depth) : std::numeric_limits<double>::infinity();
    }
    if (widest < kWidestPicture) {
      views.push_back(
          viewAlong(eye, view.forward, std::max(widest * 1.001, kNarrowPicture), settings_.near_distance));
    }
  }
  if (views.empty()) {
    for (int side = 0; side < 6; ++side) {
      Vec3d forward{};
      forward[side / 2] = side % 2 == 0 ? 1.0 : -1.0;
      views.push_back(viewAlong(eye, forward, 1.0, settings_.near_distance));
    }
  }
  for (const View& view : views) {
    const Decision decision =
        VisibilityProof(impl_.proofs, impl_.rays, view).decide(object_, settings_.eye_steps);
    if (decision.verdict == Verdict::kVisible) {
      answer_.eye = eye;
      answer_.view = view;
      answer_.witness = decision.witness;
      return true;
    }
    answer_.hidden_views += decision.verdict == Verdict::kHidden ? 1 : 0;
    answer_.undecided_views += decision.verdict == Verdict::kUndecided ? 1 : 0;
  }
  return false;
}

RegionSearch::RegionSearch(const SceneView& scene) : impl_(std::make_unique<Impl>(scene)) {}
RegionSearch::~RegionSearch() = default;
RegionSearch::RegionSearch(RegionSearch&&) noexcept = default;
RegionSearch& RegionSearch::operator=(RegionSearch&&) noexcept = default;

RegionAnswer RegionSearch::contradict(const EyeRegion& region, ObjectId object,
                                      const RegionSearchSettings& settings, std::uint64_t seed) const {
  return Attempt(*impl_, region, object, settings, seed).run();
}

}  // namespace sightline
