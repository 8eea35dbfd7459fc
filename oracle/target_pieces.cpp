#include "oracle/target_pieces.h"

#include <algorithm>

namespace sightline {
namespace {

// A corner on a plane that cuts an edge is off by less than this part of the greatest coordinate of the
// triangles, however often pieces were cut before.
constexpr double kCutRounding = 0x1p-44;

}  // namespace

TargetPieces::TargetPieces(const SceneView& scene, ObjectId object) {
  for (const std::uint32_t index : scene.indicesOf(scene.objects[object.value])) {
    corners_.emplace_back(scene.positions[index]);
    margin_ = std::max(margin_, kCutRounding * maxComponent(abs(corners_.back())));
    if (corners_.size() % 3 == 0) {
      ends_.push_back(static_cast<std::uint32_t>(corners_.size()));
    }
  }
}

DoubleBox TargetPieces::bounds() const {
  DoubleBox box{corners_[0], corners_[0]};
  for (const Vec3d& corner : corners_) {
    box = {min(box.min, corner), max(box.max, corner)};
  }
  const Vec3d wider{margin_, margin_, margin_};
  return {box.min - wider, box.max + wider};
}

TargetPieces TargetPieces::half(int axis, double level, bool above) const {
  TargetPieces pieces(margin_);
  std::uint32_t begin = 0;
  for (const std::uint32_t end : ends_) {
    addCut(begin, end, axis, level, above, pieces);
    begin = end;
  }
  return pieces;
}

// Cuts one polygon (Sutherland, Hodgman 1974).
void TargetPieces::addCut(std::uint32_t begin, std::uint32_t end, int axis, double level, bool above,
                          TargetPieces& pieces) const {
  const std::size_t before = pieces.corners_.size();
  const auto depth = [&](const Vec3d& p) { return above ? p[axis] - level : level - p[axis]; };
  for (std::uint32_t i = begin; i < end; ++i) {
    const Vec3d &from = corners_[i], &to = corners_[i + 1 == end ? begin : i + 1];
    const double from_depth = depth(from), to_depth = depth(to);
    if (from_depth >= 0.0) {
      pieces.corners_.push_back(from);
    }
    if ((from_depth > 0.0 && to_depth < 0.0) || (from_depth < 0.0 && to_depth > 0.0)) {
      const double share = from_depth / (from_depth - to_depth);
      Vec3d corner = from * (1.0 - share) + to * share;
      corner[axis] = level;
      pieces.corners_.push_back(corner);
    }
  }
  if (pieces.corners_.size() > before) {
    pieces.ends_.push_back(static_cast<std::uint32_t>(pieces.corners_.size()));
  }
}

}  // namespace sightline
