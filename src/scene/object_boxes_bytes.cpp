#include <algorithm>

#include "sightline/scene/object_boxes.h"
#include "src/base/array_bytes.h"

namespace sightline {
namespace {

// The last two letters: raise them with every change of findObjectBoxes().
constexpr base::ArraysHead kBoxesHead{{'S', 'L', 'b', 'o', 'x', 'e', '0', '3'}, sizeof(Box)};

bool areSound(const ObjectBoxes& boxes, std::uint32_t objects) {
  if (!base::areRowStarts(boxes.first, objects, boxes.boxes.size())) {
    return false;
  }
  for (std::uint32_t object = 0; object < objects; ++object) {
    if (boxes.of(ObjectId(object)).size() > kMaxObjectBoxes) {
      return false;
    }
  }
  return std::all_of(boxes.boxes.begin(), boxes.boxes.end(), [](const Box& box) { return box.wellFormed(); });
}

}  // namespace

LargeVector<std::byte> objectBoxesBytes(const ObjectBoxes& boxes) {
  return base::arrayBytes(kBoxesHead, [&](auto&& visit) {
    visit(boxes.first);
    visit(boxes.boxes);
  });
}

Result<ObjectBoxes> objectBoxesFrom(std::span<const std::byte> bytes, std::uint32_t object_count) {
  ObjectBoxes boxes;
  const Status read = base::readArrays({bytes}, kBoxesHead, "objects' boxes", [&](auto&& visit) {
    visit(boxes.first);
    visit(boxes.boxes);
  });
  if (!read) {
    return read.error();
  }
  if (!areSound(boxes, object_count)) {
    return base::unsoundArrays("objects' boxes", "some are not well formed or not of an object");
  }
  return boxes;
}

}  // namespace sightline
