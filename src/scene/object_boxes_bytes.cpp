#include <algorithm>

#include "sightline/scene/object_boxes.h"
#include "src/base/array_bytes.h"

namespace sightline {
namespace {

// The last two letters: raise them with every change of findObjectBoxes().
constexpr base::ArraysHead kBoxesHead{{'S', 'L', 'b', 'o', 'x', 'e', '0', '1'}, sizeof(Box)};

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
  base::ArrayWriter writer(sizeof(kBoxesHead) + base::ArrayWriter::sizeOf(boxes.first) +
                           base::ArrayWriter::sizeOf(boxes.boxes));
  writer.value(kBoxesHead);
  writer.array(boxes.first);
  writer.array(boxes.boxes);
  return writer.take();
}

Result<ObjectBoxes> objectBoxesFrom(std::span<const std::byte> bytes, std::uint32_t object_count) {
  const SharedBytes shared{bytes};
  base::ArrayReader reader(shared);
  base::ArraysHead head{};
  reader.value(head);
  if (head != kBoxesHead) {
    return Error{"these are no objects' boxes, or those of another version or machine: find them again"};
  }
  ObjectBoxes boxes;
  reader.array(boxes.first);
  reader.array(boxes.boxes);
  if (!reader.complete()) {
    return Error{"the objects' boxes are cut off, or something follows them: find them again"};
  }
  if (!areSound(boxes, object_count)) {
    return Error{"the objects' boxes are not sound: find them again"};
  }
  return boxes;
}

}  // namespace sightline
