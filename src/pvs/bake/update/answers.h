#pragma once

// What a bake asked about each cell, and the answers: kept beside the baked file, so that a bake of the scene
// after a change asks again only what depends on the change (recall.h).

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <unordered_map>
#include <vector>

#include "src/pvs/bake/cell_region.h"
#include "src/pvs/bake/runs.h"

namespace sightline::pvs {

enum class AnswerKind : std::uint8_t {
  kConvex,  // which objects single convex occluders hide from a region
  kFused,   // which objects and nodes of the box tree surfaces hide from a region
  kPoint,   // how many triangles a point sees past single convex occluders
};
inline constexpr std::uint32_t kAnswerKinds = 3;

// A box that is not smaller than another one, in 255ths of a frame: the lower and the upper ends along the
// axes. What reaches an end of the frame may reach beyond it, without limit. Empty if a lower end is above an
// upper one.
using CoarseBox = std::array<std::uint8_t, 6>;
CoarseBox coarse(const Box& box, const Box& frame);
Box boxOf(const CoarseBox& coarse, const Box& frame);
inline constexpr CoarseBox kWholeFrame{0, 0, 0, 255, 255, 255};

// Objects are given by their places in the box tree of the bake's own scene, nodes by their numbers there.
struct Answer {
  AnswerKind kind = AnswerKind::kConvex;
  std::uint64_t question = 0;                 // see questionOf; with the kind and the cell it is unique
  Runs asked{};                               // kConvex: the objects that were asked about
  Runs seen{};                                // kConvex, kFused: those that may be seen
  std::vector<std::uint32_t> hidden_nodes{};  // kFused: what was found hidden as a whole; ascending
  // kFused: of each node that was asked about, in ascending order, a box around all panels that decided it
  // besides those that lines of sight from FusedOcclusion::startOf the region met. Asked about were those of
  // hidden_nodes, and those above what is hidden or seen.
  std::vector<CoarseBox> followed{};
  std::uint64_t least = 0, most = 0;  // kPoint: bounds of the triangles that are seen
};

// The answers about each cell, by cellNumber.
using CellAnswers = std::unordered_map<std::uint64_t, std::vector<Answer>>;

// A number for a question about a region: of its points, of how far occluders are searched, and the like.
std::uint64_t questionOf(std::span<const Vec3d> points, std::span<const double> numbers);

// The answers about some cells, packed. Empty if they are too many to be kept.
std::vector<std::byte> encodeAnswers(const CellAnswers& answers);
// Nothing if the bytes are not answers about so many objects and nodes.
std::optional<CellAnswers> decodeAnswers(std::span<const std::byte> bytes, std::uint32_t object_count,
                                         std::uint32_t node_count);

}  // namespace sightline::pvs
