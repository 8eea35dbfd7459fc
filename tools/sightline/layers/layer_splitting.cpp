#include "tools/sightline/layers/layer_splitting.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <set>

namespace sightline::tool {
namespace {

// A plane of a part's space in scene space. Parts move rigidly.
Plane placed(const Plane& plane, const Mat4& scene_from_part) {
  const Vec3d normal = transformDirection(scene_from_part, plane.normal);
  const Vec3d origin(scene_from_part(0, 3), scene_from_part(1, 3), scene_from_part(2, 3));
  return {normal, plane.offset - dot(normal, origin)};
}

void addTriangles(const Scene& scene, PartId part, std::vector<std::array<Vec3d, 3>>& triangles) {
  const SceneView view = scene.view();
  const std::span<const std::uint32_t> indices = view.indicesOf(view.objects[part.value]);
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3) {
    triangles.push_back({Vec3d(view.positions[indices[i]]), Vec3d(view.positions[indices[i + 1]]),
                         Vec3d(view.positions[indices[i + 2]])});
  }
}

CycleSplitSettings splitSettings(const LayerInput& input, std::uint32_t max_pieces, bool triangles) {
  CycleSplitSettings settings{.max_pieces = max_pieces};
  if (triangles) {
    settings.triangles = [&scene = input.moving.scene](PartId part,
                                                       std::vector<std::array<Vec3d, 3>>& found) {
      addTriangles(scene, part, found);
    };
  }
  return settings;
}

std::size_t largestOf(const LayerOrder& order) {
  std::size_t largest = 0;
  for (std::size_t i = order.first_sorted; i < order.sorted_end; ++i) {
    largest = std::max(largest, order.group(i).size());
  }
  return largest;
}

// The most parts of which something is in one group.
std::size_t mostPartsOf(const LayerOrder& order, const CycleSplitter& splitter) {
  std::size_t most = 0;
  std::set<PartId> parts;
  for (std::size_t i = order.first_sorted; i < order.sorted_end; ++i) {
    parts.clear();
    for (const PartId part : order.group(i)) {
      parts.insert(splitter.partOf(part));
    }
    most = std::max(most, parts.size());
  }
  return most;
}

// Parts or pieces in groups of several.
std::size_t groupedOf(const LayerOrder& order) {
  std::size_t grouped = 0;
  for (std::size_t i = order.first_sorted; i < order.sorted_end; ++i) {
    grouped += order.group(i).size() > 1 ? order.group(i).size() : 0;
  }
  return grouped;
}

Json pieceJson(const PartPiece& piece) {
  Json sides = Json::array();
  for (const PieceSide& side : piece.sides) {
    const Plane& plane = side.plane;
    sides.push_back({{"plane", {plane.normal.x, plane.normal.y, plane.normal.z, plane.offset}},
                     {"in_front", side.in_front}});
  }
  return {{"piece", piece.piece.value}, {"part", piece.part.value}, {"sides", sides}};
}

}  // namespace

std::vector<ObjectPiece> objectPieces(std::span<const PartPiece> pieces,
                                      std::span<const Mat4> scene_from_part) {
  std::vector<ObjectPiece> placed_pieces;
  for (const PartPiece& piece : pieces) {
    ObjectPiece& made = placed_pieces.emplace_back();
    made.piece = ObjectId(piece.piece.value);
    made.object = ObjectId(piece.part.value);
    for (const PieceSide& side : piece.sides) {
      const bool moves = piece.part.value < scene_from_part.size();
      made.sides.push_back(
          {moves ? placed(side.plane, scene_from_part[piece.part.value]) : side.plane, side.in_front});
    }
  }
  return placed_pieces;
}

CycleWalk::CycleWalk(const LayerEyeOptions& eyes, const LayerLensOptions& lens, const LayerInput& input,
                     const LayerSettings& settings, std::uint32_t max_pieces,
                     const std::vector<std::uint32_t>& fixed, bool triangles)
    : sorter_(eyes, lens, input, settings),
      splitter_(sorter_.sorter(), splitSettings(input, max_pieces, triangles)) {
  for (const std::uint32_t part : fixed) {
    splitter_.setMayDivide(PartId(part), false);
  }
}

Json CycleWalk::figures(const LayerOrder& whole, const LayerOrder& divided, double split_us) {
  const CycleSplitStats& stats = splitter_.stats();
  frames_.push_back({.largest_whole = static_cast<double>(largestOf(whole)),
                     .largest = static_cast<double>(largestOf(divided)),
                     .most_parts = static_cast<double>(mostPartsOf(divided, splitter_)),
                     .grouped_whole = static_cast<double>(groupedOf(whole)),
                     .grouped = static_cast<double>(groupedOf(divided)),
                     .divided = static_cast<double>(stats.divided),
                     .pieces = static_cast<double>(stats.pieces),
                     .cuts = static_cast<double>(stats.cuts),
                     .joins = static_cast<double>(stats.joins),
                     .trials = static_cast<double>(stats.trials),
                     .split_us = split_us});
  Json pieces = Json::array();
  for (const PartPiece& piece : splitter_.pieces()) {
    pieces.push_back(pieceJson(piece));
  }
  return {{"largest_group_whole", largestOf(whole)},
          {"largest_group", largestOf(divided)},
          {"largest_group_parts", mostPartsOf(divided, splitter_)},
          {"divided_parts", stats.divided},
          {"cuts", stats.cuts},
          {"joins", stats.joins},
          {"trials", stats.trials},
          {"split_us", split_us},
          {"pieces", pieces}};
}

double CycleWalk::mean(double Frame::*value) const {
  double sum = 0.0;
  for (const Frame& frame : frames_) {
    sum += frame.*value;
  }
  return frames_.empty() ? 0.0 : sum / static_cast<double>(frames_.size());
}

void CycleWalk::print() const {
  const auto line = [&](const char* what, double value) { fmt::print("  {:<38}{:12.1f}\n", what, value); };
  fmt::print("parts in cycles divided, means of a frame:\n");
  line("largest group of whole parts", mean(&Frame::largest_whole));
  line("largest group, pieces counted each", mean(&Frame::largest));
  line("parts in the largest group", mean(&Frame::most_parts));
  line("whole parts in groups", mean(&Frame::grouped_whole));
  line("parts and pieces in groups", mean(&Frame::grouped));
  line("divided parts", mean(&Frame::divided));
  line("pieces", mean(&Frame::pieces));
  line("divisions made", mean(&Frame::cuts));
  line("divisions taken back", mean(&Frame::joins));
  line("planes tried", mean(&Frame::trials));
  line("time of sort and divisions, us", mean(&Frame::split_us));
  double largest = 0.0;
  for (const Frame& frame : frames_) {
    largest = std::max(largest, frame.split_us);
  }
  line("the same, largest, us", largest);
}

}  // namespace sightline::tool
