#include "src/pvs/bake/file/write_parts.h"

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "src/pvs/bake/file/encode_sight.h"
#include "src/pvs/bake/file/unfinished_file.h"
#include "src/pvs/format/structure.h"

namespace sightline::pvs {
namespace {

// The payload comes before the structure is known, which lies before it in the file. So it is kept in a
// nameless file beside the target.
class PayloadOnDisk final : public Payload {
 public:
  explicit PayloadOnDisk(const std::string& target) : file_(target) { file_.makeNameless(); }

  bool append(std::span<const std::byte> bytes) override {
    size_ += bytes.size();
    return file_.write(bytes);
  }
  bool read(std::uint64_t offset, std::span<std::byte> bytes) override { return file_.read(offset, bytes); }
  std::uint64_t size() const { return size_; }
  Status status() const { return file_.status(); }

  // Moves all of it to the end of the other file. What was moved gives its space back now and then, so that
  // the disk does not hold it twice.
  void moveTo(UnfinishedFile& other) {
    constexpr std::uint64_t kStep = 1u << 22, kDrop = 1u << 28;
    std::vector<std::byte> step;
    for (std::uint64_t at = 0; at < size_; at += step.size()) {
      step.resize(static_cast<std::size_t>(std::min(kStep, size_ - at)));
      if (!file_.read(at, step) || !other.write(step)) {
        return;
      }
      if ((at + kStep) % kDrop == 0) {
        file_.dropFirst(at + kStep);
      }
    }
  }

 private:
  UnfinishedFile file_;
  std::uint64_t size_ = 0;
};

}  // namespace

Status writeParts(const std::string& file, const BakeScene& scene, const ReadCell& read,
                  BakedVisibility& baked, std::uint64_t& broken) {
  const auto notSound = [&](const Error& error) {
    return Error{file + " cannot be written: the data is not sound: " + error.message};
  };
  if (const Status sound = checkBoxTree(baked.boxes.view()); !sound) {
    return notSound(sound.error());
  }
  PayloadOnDisk payload(file);
  EncodedChunks encoded;
  SetWriter sets(baked.boxes.nodes, payload, encoded);
  Flattener flattener(scene, baked.octree, baked.doors, sets);
  // Once the payload cannot be kept, no more parts need be read.
  const ReadCell read_while_kept = [&](std::uint64_t id) {
    return payload.status() ? read(id) : std::optional<PartCell>();
  };
  broken = flattenParts(scene, read_while_kept, flattener);
  if (const Status kept = payload.status(); !kept) {
    broken = 0;
    return kept;
  }
  if (broken != 0) {
    return Error{"a part cannot be read"};
  }
  sets.finish();
  encodeDatabases(baked.databases, payload, encoded);
  if (const Status kept = payload.status(); !kept) {
    return kept;
  }
  SightView view = viewOf(baked, encoded);
  view.payload_elsewhere = payload.size();
  if (const Status fits = sets.sound() ? checkView(view) : Status(Error{"a set is not ascending"}); !fits) {
    return notSound(fits.error());
  }
  const Result<std::vector<std::byte>> structure = structureBytes(view);
  if (!structure) {
    return Error{file + " cannot be written: " + structure.error().message};
  }
  UnfinishedFile unfinished(file);
  unfinished.write(*structure);
  payload.moveTo(unfinished);
  if (const Status moved = payload.status(); !moved) {
    return moved;
  }
  unfinished.finish();
  return unfinished.status();
}

}  // namespace sightline::pvs
