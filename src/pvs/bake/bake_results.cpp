// What is made of the parts of a bake: its sets, in memory or as a file, its witnesses and its answers.

#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "sightline/pvs/bake/bake.h"
#include "sightline/pvs/bake/write_sight.h"
#include "src/pvs/bake/bake_data.h"
#include "src/pvs/bake/cell_tree.h"
#include "src/pvs/bake/file/assemble_parts.h"
#include "src/pvs/bake/file/byte_budget.h"
#include "src/pvs/bake/file/flatten.h"
#include "src/pvs/bake/file/part_code.h"
#include "src/pvs/bake/file/write_parts.h"
#include "src/pvs/bake/update/earlier_bake.h"

namespace sightline {

using namespace pvs;

namespace {

// Reads parts from those in memory, which must outlive the result.
ReadPart readerOf(const BakedParts& parts) {
  return [&parts](std::uint64_t id) {
    const auto part = parts.find(id);
    return part == parts.end() ? std::nullopt : std::optional(part->second);
  };
}

Error brokenPart(std::uint64_t id) {
  return Error{"bake: part " + std::to_string(id) + " is missing, broken or of another plan"};
}

// The result without cells and sets.
BakedVisibility withoutCells(const BakeScene& scene, const SceneId& id) {
  BakedVisibility baked;
  baked.scene = id;
  baked.record = {scene.settings.near_distance, scene.settings.triangle_budget, scene.settings.max_depth, {}};
  baked.boxes = scene.boxes;
  baked.octree.min = scene.root.min;
  baked.octree.max = scene.root.max;
  return baked;
}

// Reads parts as cells. The arguments must outlive the result.
ReadCell cellReader(const Bake& bake, const BakeScene& scene, const ReadPart& read) {
  return [&](std::uint64_t id) -> std::optional<PartCell> {
    const std::optional<BakedPart> part = read(id);
    if (!part || !bake.isPart(id, *part)) {
      return std::nullopt;
    }
    const PartContent content = *contentOf(scene.settings, *part);  // which a part has
    if (!witnessesOf(scene.settings, content)) {
      return std::nullopt;
    }
    PartCell cell;
    if (content.head.divided()) {
      return soundlyDivided(scene, content) ? std::optional(std::move(cell)) : std::nullopt;
    }
    cell.cell = cellOf(scene, content);
    return cell.cell ? std::optional(std::move(cell)) : std::nullopt;
  };
}

// Calls visit(id, content) for all parts, by ascending id, up to the first that cannot be read or for which
// visit is false: that one's id is returned, else 0.
template <typename Visit>
std::uint64_t forEachPart(const BakeScene& scene, const ReadPart& read, Visit&& visit) {
  for (std::vector<std::uint64_t> level{kRootPart}; !level.empty();) {
    std::vector<std::uint64_t> next;
    for (const std::uint64_t id : level) {
      const std::optional<BakedPart> part = read(id);
      const std::optional<PartContent> content = part ? contentOf(scene.settings, *part) : std::nullopt;
      if (!content || !visit(id, *content)) {
        return id;
      }
      for (std::uint64_t i = 0; i < 8 && content->head.divided(); ++i) {
        next.push_back(8 * id + i);
      }
    }
    level = std::move(next);
  }
  return 0;
}

}  // namespace

Result<BakedVisibility> Bake::assemble(const BakedParts& parts) const {
  return assemble(readerOf(parts));
}

Result<BakedVisibility> Bake::assemble(const ReadPart& read) const {
  const BakeScene& scene = data_->scene;
  std::uint64_t broken = 0;
  const std::optional<BakedCell> top = cellOfParts(scene, cellReader(*this, scene, read), broken);
  if (!top) {
    return brokenPart(broken);
  }
  BakedVisibility baked = withoutCells(scene, data_->scene_id);
  if (scene.settings.byte_budget == 0) {
    flatten(*top, scene, baked);
  } else if (const Status fits = fitBytes(scene, *top, scene.settings.byte_budget, baked); !fits) {
    return Error{"bake: " + fits.error().message};
  }
  return baked;
}

Status Bake::writeSight(const std::string& file, const ReadPart& read, const SightExtras& extras) const {
  const BakeScene& scene = data_->scene;
  if (scene.settings.byte_budget > 0) {
    Result<BakedVisibility> baked = assemble(read);
    if (!baked) {
      return baked.error();
    }
    baked->record.settings = extras.settings;
    baked->databases = extras.databases;
    return sightline::writeSight(file, *baked);
  }
  BakedVisibility baked = withoutCells(scene, data_->scene_id);
  baked.record.settings = extras.settings;
  baked.databases = extras.databases;
  std::uint64_t broken = 0;
  const Status written = writeParts(file, scene, cellReader(*this, scene, read), baked, broken);
  return broken == 0 ? written : Status(brokenPart(broken));
}

Witnesses Bake::witnesses(const BakedParts& parts) const {
  Result<Witnesses> found = witnesses(readerOf(parts));
  return found ? std::move(*found) : Witnesses{};
}

Result<Witnesses> Bake::witnesses(const ReadPart& read) const {
  const BakeScene& scene = data_->scene;
  Witnesses found{data_->scene_id, scene.root.min, scene.root.max, {}};
  const std::uint64_t broken = forEachPart(scene, read, [&](std::uint64_t, const PartContent& content) {
    std::optional<std::vector<HidingWitness>> own = witnessesOf(scene.settings, content);
    if (own) {
      found.all.insert(found.all.end(), std::make_move_iterator(own->begin()),
                       std::make_move_iterator(own->end()));
    }
    return own.has_value();
  });
  if (broken != 0) {
    return brokenPart(broken);
  }
  return found;
}

std::vector<std::byte> Bake::answers(const BakedParts& parts) const {
  Result<std::vector<std::byte>> bytes = answers(readerOf(parts));
  return bytes ? std::move(*bytes) : std::vector<std::byte>();
}

Result<std::vector<std::byte>> Bake::answers(const ReadPart& read) const {
  const BakeScene& scene = data_->scene;
  std::map<std::uint64_t, std::vector<std::byte>> kept;
  const std::uint64_t broken = forEachPart(scene, read, [&](std::uint64_t id, const PartContent& content) {
    kept.emplace(id, std::vector<std::byte>(content.answers.begin(), content.answers.end()));
    return true;
  });
  if (broken != 0) {
    return brokenPart(broken);
  }
  const std::map<std::uint64_t, std::span<const std::byte>> answers(kept.begin(), kept.end());
  return earlierBakeBytes(data_->scene_id, marksOf(scene), answers);
}

}  // namespace sightline
