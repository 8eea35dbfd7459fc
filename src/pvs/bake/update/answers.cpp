// The bytes are packed (packed_bytes.h): the answers one after the other, by cell. Little-endian.

#include "src/pvs/bake/update/answers.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "src/base/byte_stream.h"
#include "src/pvs/bake/file/packed_bytes.h"
#include "src/pvs/bake/file/run_code.h"
#include "src/pvs/bake/update/number_hash.h"

namespace sightline::pvs {
namespace {

constexpr std::uint64_t kMaxRawBytes = 1ull << 30;  // of the answers of one part

// Each node as its distance from the one before.
void addNodes(std::span<const std::uint32_t> nodes, base::ByteWriter& bytes) {
  addCount(nodes.size(), bytes);
  std::uint32_t before = 0;
  for (const std::uint32_t node : nodes) {
    addCount(node - before, bytes);
    before = node;
  }
}

bool readNodes(base::ByteReader& bytes, std::uint32_t node_count, std::vector<std::uint32_t>& nodes) {
  const std::uint64_t count = readCount(bytes);
  if (count > node_count || count > bytes.remaining()) {
    return false;
  }
  std::uint64_t node = 0;
  nodes.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t distance = readCount(bytes);
    if (distance >= node_count || node + distance >= node_count) {
      return false;
    }
    node += distance;
    nodes.push_back(static_cast<std::uint32_t>(node));
  }
  return true;
}

bool readBoxes(base::ByteReader& bytes, std::uint32_t node_count, std::vector<CoarseBox>& boxes) {
  const std::uint64_t count = readCount(bytes);
  if (count > node_count || count > bytes.remaining() / std::tuple_size_v<CoarseBox>) {
    return false;
  }
  boxes.reserve(static_cast<std::size_t>(count));
  for (std::uint64_t i = 0; i < count; ++i) {
    for (std::uint8_t& end : boxes.emplace_back()) {
      end = bytes.read<std::uint8_t>();
    }
  }
  return bytes.ok();
}

void add(const Answer& answer, base::ByteWriter& bytes) {
  bytes.add(static_cast<std::uint8_t>(answer.kind));
  bytes.add(answer.question);
  if (answer.kind == AnswerKind::kPoint) {
    bytes.add(answer.least);
    bytes.add(answer.most);
    return;
  }
  addRuns(answer.seen, bytes);
  if (answer.kind == AnswerKind::kConvex) {
    addRuns(answer.asked, bytes);
  } else {
    addNodes(answer.hidden_nodes, bytes);
    addCount(answer.followed.size(), bytes);
    for (const CoarseBox& box : answer.followed) {
      bytes.addAll(std::span<const std::uint8_t>(box));
    }
  }
}

bool read(base::ByteReader& bytes, std::uint32_t object_count, std::uint32_t node_count, Answer& answer) {
  const auto kind = bytes.read<std::uint8_t>();
  answer.question = bytes.read<std::uint64_t>();
  if (!bytes.ok() || kind >= kAnswerKinds) {
    return false;
  }
  answer.kind = static_cast<AnswerKind>(kind);
  if (answer.kind == AnswerKind::kPoint) {
    answer.least = bytes.read<std::uint64_t>();
    answer.most = bytes.read<std::uint64_t>();
    return bytes.ok();
  }
  if (!readRuns(bytes, object_count, answer.seen)) {
    return false;
  }
  if (answer.kind == AnswerKind::kConvex) {
    return readRuns(bytes, object_count, answer.asked);
  }
  return readNodes(bytes, node_count, answer.hidden_nodes) && readBoxes(bytes, node_count, answer.followed);
}

}  // namespace

CoarseBox coarse(const Box& box, const Box& frame) {
  if (box.empty()) {
    return {255, 255, 255, 0, 0, 0};
  }
  CoarseBox ends{};
  for (int axis = 0; axis < 3; ++axis) {
    const double first = frame.min[axis], step = (double{frame.max[axis]} - first) / 255.0;
    const auto end = [&](double at) { return static_cast<std::uint8_t>(std::clamp(at, 0.0, 255.0)); };
    const auto i = static_cast<std::size_t>(axis);
    ends[i] = end(std::floor((double{box.min[axis]} - first) / step));
    ends[i + 3] = end(std::ceil((double{box.max[axis]} - first) / step));
  }
  return ends;
}

Box boxOf(const CoarseBox& coarse, const Box& frame) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Box box;
  for (int axis = 0; axis < 3; ++axis) {
    const double first = frame.min[axis], step = (double{frame.max[axis]} - first) / 255.0;
    const auto i = static_cast<std::size_t>(axis);
    box.min[axis] = coarse[i] == 0 ? -kInfinity : static_cast<float>(first + step * coarse[i]);
    box.max[axis] = coarse[i + 3] == 255 ? kInfinity : static_cast<float>(first + step * coarse[i + 3]);
  }
  return box;
}

std::uint64_t questionOf(std::span<const Vec3d> points, std::span<const double> numbers) {
  NumberHash hash;
  for (const Vec3d& point : points) {
    hash.add(point);
  }
  for (const double number : numbers) {
    hash.add(number);
  }
  return hash.value();
}

std::vector<std::byte> encodeAnswers(const CellAnswers& answers) {
  // By cell, so that the same answers are the same bytes.
  std::vector<std::uint64_t> cells;
  for (const auto& [cell, of_cell] : answers) {
    cells.push_back(cell);
  }
  std::sort(cells.begin(), cells.end());
  base::ByteWriter raw;
  for (const std::uint64_t cell : cells) {
    const std::vector<Answer>& of_cell = answers.at(cell);
    raw.add(cell);
    addCount(of_cell.size(), raw);
    for (const Answer& answer : of_cell) {
      add(answer, raw);
    }
  }
  const std::vector<std::byte> plain = raw.take();
  return plain.size() > kMaxRawBytes ? std::vector<std::byte>() : pack(plain);
}

std::optional<CellAnswers> decodeAnswers(std::span<const std::byte> bytes, std::uint32_t object_count,
                                         std::uint32_t node_count) {
  const std::optional<std::vector<std::byte>> plain = unpack(bytes);
  if (!plain || plain->size() > kMaxRawBytes) {
    return std::nullopt;
  }
  CellAnswers answers;
  base::ByteReader raw(*plain);
  while (raw.remaining() > 0) {
    const auto cell = raw.read<std::uint64_t>();
    const std::uint64_t count = readCount(raw);
    if (!raw.ok() || count > raw.remaining()) {
      return std::nullopt;
    }
    std::vector<Answer>& of_cell = answers[cell];
    for (std::uint64_t i = 0; i < count; ++i) {
      if (!read(raw, object_count, node_count, of_cell.emplace_back())) {
        return std::nullopt;
      }
    }
  }
  return answers;
}

}  // namespace sightline::pvs
