#include "src/occlusion/tree/front_to_back.h"

#include <algorithm>

namespace sightline::occlusion {

bool cutFragment(const Fragment& fragment, const Plane& plane, VolumeBuilder& volumes, PolygonStack& stack,
                 Fragment& front, Fragment& back) {
  const PlaneRef cut_plane = volumes.addPlane(plane);  // until the cut has its shadow plane
  const std::size_t stack_size = stack.corners.size();
  // A copy is split: if the split is not used, the fragment must not keep edges that were marked by it.
  const Piece copy{static_cast<std::uint32_t>(stack_size), fragment.piece.count};
  for (std::uint32_t i = 0; i < copy.count; ++i) {
    const Corner corner = stack.corners[fragment.piece.first + i];
    stack.corners.push_back(corner);
  }
  const SplitResult parts = stack.split(copy, plane, cut_plane, volumes.volumes[fragment.volume].reach);
  const auto cutEdges = [&](Piece piece) {
    const auto corners = stack.of(piece);
    return std::count_if(corners.begin(), corners.end(),
                         [&](const Corner& corner) { return corner.edge.samePlane(cut_plane); });
  };
  if (parts.side == Side::kBoth && parts.front.count >= 3 && parts.back.count >= 3 &&
      cutEdges(parts.front) == 1 && cutEdges(parts.back) == 1) {
    // The front part's new edge runs from p to q, counter-clockwise seen from the eye.
    const auto corners = stack.of(parts.front);
    std::size_t at = 0;
    while (!corners[at].edge.samePlane(cut_plane)) {
      ++at;
    }
    double sine = 0.0;
    const Plane shadow =
        volumes.eye.shadowPlane(corners[at].position, corners[(at + 1) % corners.size()].position, sine);
    if (sine > 0x1p-12) {
      // split() takes the front part to lie in front of the named plane, i.e. behind its other side.
      volumes.planes.back() = shadow.flipped();
      for (const Piece& piece : {parts.front, parts.back}) {
        for (Corner& corner : stack.of(piece)) {
          corner.embedded = false;  // there is no tree yet whose planes edges could lie in
        }
      }
      front = {parts.front, fragment.volume, fragment.outline};
      back = {parts.back, fragment.volume, fragment.outline};
      return true;
    }
  }
  volumes.planes.pop_back();
  volumes.tolerances.pop_back();
  stack.corners.resize(stack_size);
  return false;
}

Side FrontToBack::sideOf(std::uint32_t fragment, std::uint32_t splitter) const {
  const OcclusionVolume& by = volumes_->volumes[all_[splitter].volume];
  const OcclusionVolume& of = volumes_->volumes[all_[fragment].volume];
  const double tolerance = by.depth_slack + of.depth_slack + kDepthMargin * (by.reach + of.reach);
  bool front = false, back = false;
  for (const Corner& corner : stack_->of(all_[fragment].piece)) {
    const double d = by.support.evaluate(corner.position);
    front |= d > tolerance;
    back |= d < -tolerance;
  }
  return front && back ? Side::kBoth : front ? Side::kFront : back ? Side::kBack : Side::kOnPlane;
}

// Returns, of a few candidates, the one whose plane cuts the fewest others.
std::uint32_t FrontToBack::chooseSplitter(std::size_t begin, std::size_t end) const {
  constexpr std::size_t kCandidates = 5;
  const std::size_t count = end - begin;
  const std::size_t tries = std::min(count, kCandidates);
  std::uint32_t best = work_[begin];
  std::size_t best_cuts = count;
  for (std::size_t t = 0; t < tries && best_cuts > 0; ++t) {
    const std::uint32_t candidate = work_[begin + t * count / tries];
    std::size_t cuts = 0;
    for (std::size_t i = begin; i < end && cuts < best_cuts; ++i) {
      cuts += work_[i] != candidate && sideOf(work_[i], candidate) == Side::kBoth ? 1 : 0;
    }
    if (cuts < best_cuts) {
      best_cuts = cuts;
      best = candidate;
    }
  }
  return best;
}

void FrontToBack::visit(const Range& range) {
  const auto [begin, end, depth, before, work_needed] = range;
  work_.resize(work_needed);
  if (before != kNone) {
    ordered_.push_back(before);
  }
  if (depth > kMaxDepth) {
    ordered_.insert(ordered_.end(), work_.begin() + static_cast<std::ptrdiff_t>(begin),
                    work_.begin() + static_cast<std::ptrdiff_t>(end));
    return;
  }
  if (begin == end) {
    return;
  }
  const std::uint32_t splitter = chooseSplitter(begin, end);
  const std::size_t front_begin = work_.size();
  std::size_t back_count = 0;
  // Fragments behind the splitter are collected at the start of this range, those in front on top of the
  // stack.
  for (std::size_t i = begin; i < end; ++i) {
    const std::uint32_t fragment = work_[i];
    if (fragment == splitter) {
      continue;
    }
    Fragment front, back;
    Side side = sideOf(fragment, splitter);
    if (side == Side::kBoth) {
      const Plane& plane = volumes_->volumes[all_[splitter].volume].support;
      if (cutFragment(all_[fragment], plane, *volumes_, *stack_, front, back)) {
        all_.push_back(front);
        work_.push_back(static_cast<std::uint32_t>(all_.size() - 1));
        all_.push_back(back);
        work_[begin + back_count++] = static_cast<std::uint32_t>(all_.size() - 1);
        continue;
      }
      const OcclusionVolume& volume = volumes_->volumes[all_[fragment].volume];
      side = volumes_->volumes[all_[splitter].volume].support.evaluate(volume.centroid) > 0.0 ? Side::kFront
                                                                                              : Side::kBack;
    }
    if (side == Side::kFront) {
      work_.push_back(fragment);
    } else {
      work_[begin + back_count++] = fragment;
    }
  }
  ranges_.push_back({begin, begin + back_count, depth + 1, splitter, front_begin});
  ranges_.push_back({front_begin, work_.size(), depth + 1, kNone, work_.size()});
}

void FrontToBack::order(VolumeBuilder& volumes, PolygonStack& stack, std::vector<Fragment>& fragments) {
  volumes_ = &volumes;
  stack_ = &stack;
  all_.assign(fragments.begin(), fragments.end());
  work_.clear();
  ordered_.clear();
  for (std::uint32_t i = 0; i < all_.size(); ++i) {
    work_.push_back(i);
  }
  ranges_.clear();
  ranges_.push_back({0, work_.size(), 0, kNone, work_.size()});
  while (!ranges_.empty()) {
    const Range range = ranges_.back();
    ranges_.pop_back();
    visit(range);
  }
  fragments.clear();
  for (const std::uint32_t i : ordered_) {
    fragments.push_back(all_[i]);
  }
}

}  // namespace sightline::occlusion
