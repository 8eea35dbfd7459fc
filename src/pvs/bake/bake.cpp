#include "sightline/pvs/bake/bake.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "src/base/byte_stream.h"
#include "src/pvs/bake/bake_data.h"
#include "src/pvs/bake/bake_settings.h"
#include "src/pvs/bake/cell_tree.h"
#include "src/pvs/bake/file/packed_bytes.h"
#include "src/pvs/bake/file/part_code.h"
#include "src/pvs/bake/file/run_code.h"
#include "src/pvs/bake/update/earlier_bake.h"
#include "src/pvs/bake/update/recall.h"
#include "src/pvs/format/witness_code.h"

namespace sightline {

using namespace pvs;

namespace {

// Limits of a part that is more than one cell: how many cells may be below its own, and about how much work
// (CellOutcome::work) they may be, some 40 milliseconds. So an interrupted bake loses little, many processes
// end at about the same time, and yet most samples of a part are shared within it.
constexpr std::uint64_t kPartCells = 72, kPartWork = 200'000;

// How many cells may come to be below this one; counted up to `most`.
std::uint64_t cellsBelow(const BakeScene& scene, const OctreeCell& cell, std::uint64_t most) {
  if (!scene.mayDivide(cell)) {
    return 0;
  }
  std::uint64_t count = 8;
  for (std::uint32_t i = 0; i < 8 && count <= most; ++i) {
    count += cellsBelow(scene, cell.child(i), most - count);
  }
  return count;
}

// Whether a cell that is divided stays one part with all that is below it. Cells see no more than those
// around them, so each of them is expected to have at most as much work as this one, and surfaces of doors to
// take as much again for each group. The answer does not depend on what is known from an earlier bake or kept
// in memory, so that the parts are the same in each run.
bool staysOnePart(const BakeScene& scene, const OctreeCell& cell, const CellOutcome& outcome) {
  const std::uint64_t groups =
      scene.settings.occlusion == BakeOcclusion::kFused ? scene.doors.groups.size() : 0;
  const std::uint64_t work = std::max<std::uint64_t>(outcome.work, 1) * (1 + groups);
  const std::uint64_t affordable = std::min(kPartCells, kPartWork / work);
  return cellsBelow(scene, cell, affordable) <= affordable;
}

// An eighth of the scene's diagonal spans a few rooms or a few streets. Many objects are searched by lines of
// sight, for which occluders that are far away take no time until something is behind them. But it depends on
// the number of objects alone, so that the sets are the same where samples are kept.
double firstSearchDistance(const BakeScene& scene) {
  if (scene.settings.search_distance > 0.0) {
    return scene.settings.search_distance;
  }
  return scene.hasManyObjects() ? scene.diagonal : 0.125 * scene.diagonal;
}

// The fraction of the region that lies in the cell. Axes along which the region has no extent do not count.
double shareOfRegion(const BakeScene& scene, const OctreeCell& cell) {
  const CellBox box = scene.boxOf(cell);
  const Vec3d common = min(box.max, scene.region.max) - max(box.min, scene.region.min);
  const Vec3d all = scene.region.extent();
  double share = 1.0;
  for (int axis = 0; axis < 3; ++axis) {
    share *= all[axis] > 0.0 ? std::clamp(common[axis] / all[axis], 0.0, 1.0) : 1.0;
  }
  return share;
}

}  // namespace

double Bake::Data::shareOf(const OctreeCell& cell) const {
  return max_cells ? static_cast<double>(scene.mostLeaves(cell, kMaxCounted)) /
                         static_cast<double>(std::max<std::uint64_t>(*max_cells, 1))
                   : shareOfRegion(scene, cell);
}

Result<Bake> Bake::plan(const SceneView& scene, const OccluderSet& occluders, const BakeSettings& settings,
                        const ParallelFor& parallel_for) {
  if (const std::string problem = problemWith(settings); !problem.empty()) {
    return Error{"bake: " + problem};
  }
  if (const std::string problem = problemWithDoors(scene, settings.doors); !problem.empty()) {
    return Error{"bake: " + problem};
  }
  if (scene.objects.empty()) {
    return Error{"bake: the scene has no object, so there is nothing to see"};
  }
  BakeSettings complete = settings;
  if (complete.viewers.empty()) {
    complete.viewers = {sceneBounds(scene)};
    complete.whole_cells = true;
    if (complete.viewers[0].empty()) {
      return Error{"bake: the scene has no object with a finite box, so there is nothing to see"};
    }
  }
  for (const Occluder& occluder : occluders.occluders) {
    if (occluder.object.value >= scene.objects.size()) {
      const std::string owner =
          occluder.object.valid() ? "object " + std::to_string(occluder.object.value) : "no object";
      return Error{"bake: an occluder belongs to " + owner + ", but the scene has " +
                   std::to_string(scene.objects.size()) +
                   " objects; give the occluders that findOccluders finds in it"};
    }
  }
  const auto data = std::make_shared<Data>(scene, occluders, complete, parallel_for);
  data->hash = planHash(data->scene_id, occluders, data->scene.settings, data->scene.baseDepth());
  Bake bake;
  bake.data_ = data;
  return bake;
}

const BakeSettings& Bake::settings() const {
  return data_->scene.settings;
}
std::uint32_t Bake::baseDepth() const {
  return data_->scene.baseDepth();
}
const OccluderCounts& Bake::occluders() const {
  return data_->scene.counts;
}
std::optional<std::uint64_t> Bake::maxCells() const {
  return data_->max_cells;
}
std::uint64_t Bake::hash() const {
  return data_->hash;
}

struct Bake::Earlier {
  Earlier(EarlierBake earlier, std::shared_ptr<const Data> d, const SceneMarks& marks)
      : data(std::move(d)), recall(std::move(earlier), data->scene, marks) {}

  std::shared_ptr<const Data> data;
  Recall recall;
};

Result<Bake::TakenOver> Bake::takeOver(std::vector<std::byte> answers) {
  if (data_->scene.settings.witnesses) {
    return Error{"bake: answers that are taken over have no witnesses; bake in full for those"};
  }
  earlier_.reset();
  Result<EarlierBake> earlier = readEarlierBake(std::move(answers));
  if (!earlier) {
    return earlier.error();
  }
  TakenOver taken{.scene = earlier->scene};
  const SceneMarks marks = marksOf(data_->scene);
  if (marks.settings != earlier->marks.settings) {
    taken.difference = "other settings";
  } else if (marks.space != earlier->marks.space) {
    taken.difference =
        "other bounds of the scene or of where viewers are, or another precision of its surfaces";
  }
  if (!taken.difference.empty()) {
    return taken;
  }
  const auto made = std::make_shared<const Earlier>(std::move(*earlier), data_, marks);

  taken.gone = made->recall.objectsGone();
  taken.come = made->recall.objectsCome();
  taken.same = static_cast<std::uint32_t>(marks.objects.size()) - taken.come;
  earlier_ = made;
  return taken;
}

PartTask Bake::firstPart() const {
  return {kRootPart, firstSearchDistance(data_->scene)};
}

void add(BakeStats& sum, const BakeStats& stats) {
  sum.samples += stats.samples;
  sum.shadows += stats.shadows;
  sum.forgotten += stats.forgotten;
  sum.max_sample_bytes += stats.max_sample_bytes;
  sum.questions += stats.questions;
  sum.asked += stats.asked;
}

struct Bake::Worker::Impl {
  Impl(std::shared_ptr<const Data> d, std::shared_ptr<const Earlier> e)
      : data(std::move(d)), earlier(std::move(e)), baker(data->scene, earlier ? &earlier->recall : nullptr) {}

  // Adds what was recorded since the last call.
  void addRecords(base::ByteWriter& bytes) {
    if (data->scene.settings.witnesses) {
      base::ByteWriter witnesses;
      write(baker.takeWitnesses(), witnesses);
      addBlock(pack(witnesses.take()), bytes);
    }
    if (data->scene.settings.answers) {
      addBlock(encodeAnswers(baker.takeAnswers()), bytes);
    }
  }

  std::shared_ptr<const Data> data;
  std::shared_ptr<const Earlier> earlier;
  CellBaker baker;
};

Bake::Worker::Worker(const Bake& bake) : impl_(std::make_unique<Impl>(bake.data_, bake.earlier_)) {}
Bake::Worker::~Worker() = default;
Bake::Worker::Worker(Worker&&) noexcept = default;

namespace {

// Adds the number of the cell's leaves, and the triangles that their sets keep, to the sums.
void summarize(const BakeScene& scene, const BakedCell& cell, std::uint32_t& leaves, double& triangles) {
  for (const BakedCell& child : cell.children) {
    summarize(scene, child, leaves, triangles);
  }
  if (cell.leaf()) {
    leaves += 1;
    triangles += static_cast<double>(scene.triangles.of(cell.sets.whole));
  }
}

// What PartTask::seen holds. Empty, which stands for all objects, if it is not runs of so many.
Runs runsOf(std::span<const std::byte> seen, std::uint32_t object_count) {
  const std::optional<std::vector<std::byte>> plain = unpack(seen);
  base::ByteReader bytes(plain ? *plain : std::span<const std::byte>());
  Runs runs;
  return readRuns(bytes, object_count, runs) && bytes.atEnd() ? runs : Runs();
}

}  // namespace

BakedPart Bake::Worker::bake(const PartTask& part) {
  const BakeScene& scene = impl_->data->scene;
  const auto objects = static_cast<std::uint32_t>(scene.boxes.objects.size());
  const CellTask task{cellOfNumber(part.id), part.search_distance, runsOf(part.seen, objects)};
  PartHead head{.plan = impl_->data->hash, .id = part.id, .summary = {}};
  base::ByteWriter main;
  CellOutcome outcome = decide(impl_->baker, scene, task);
  if (outcome.leaf || staysOnePart(scene, task.cell, outcome)) {
    const BakedCell cell = bakeBelow(impl_->baker, scene, task.cell, std::move(outcome));
    double triangles = 0.0;
    summarize(scene, cell, head.summary.leaves, triangles);
    head.summary.mean_triangles = triangles / head.summary.leaves;
    head.summary.share = impl_->data->shareOf(task.cell);
    write(cell, main);
  } else {
    impl_->baker.forgetOldest();
    head.search_distance = outcome.search_distance;
    addRuns(outcome.seen, main);
  }
  base::ByteWriter bytes;
  write(head, bytes);
  addBlock(pack(main.take()), bytes);
  impl_->addRecords(bytes);
  return bytes.take();
}

BakeStats Bake::Worker::stats() const {
  return impl_->baker.stats();
}

PartSummary Bake::summaryOf(std::span<const std::byte> part) const {
  base::ByteReader bytes(part);
  return readHead(bytes).summary;
}

std::vector<PartTask> Bake::partsBelow(std::span<const std::byte> part) const {
  const std::optional<PartContent> content = contentOf(data_->scene.settings, part);
  std::vector<PartTask> below;
  if (content && content->head.summary.leaves == 0) {
    for (std::uint64_t i = 0; i < 8; ++i) {
      below.push_back({8 * content->head.id + i,
                       content->head.search_distance,
                       {content->main.begin(), content->main.end()}});
    }
  }
  return below;
}

bool Bake::isPart(std::uint64_t id, std::span<const std::byte> part) const {
  const std::optional<PartContent> content = contentOf(data_->scene.settings, part);
  if (!content) {
    return false;
  }
  // A part that says that its cell was divided must be of one that can be.
  const PartHead& head = content->head;
  return head.magic == kPartMagic && head.plan == data_->hash && head.id == id &&
         (head.summary.leaves > 0 || data_->scene.mayDivide(cellOfNumber(id)));
}

BakedParts Bake::bakeAll(const ParallelFor& parallel_for, const Progress& progress, BakeStats* stats) const {
  BakedParts parts;
  std::mutex mutex;
  std::vector<std::unique_ptr<Worker>> resting;  // at most one per thread that baked at the same time
  double share = 0.0;
  const auto bakeRange = [&](std::span<const PartTask> tasks) {
    std::unique_ptr<Worker> worker;
    {
      const std::lock_guard lock(mutex);
      if (!resting.empty()) {
        worker = std::move(resting.back());
        resting.pop_back();
      }
    }
    if (!worker) {
      worker = std::make_unique<Worker>(*this);
    }
    for (const PartTask& task : tasks) {
      BakedPart part = worker->bake(task);
      const std::lock_guard lock(mutex);
      share += summaryOf(part).share;
      parts.emplace(task.id, std::move(part));
    }
    const std::lock_guard lock(mutex);
    resting.push_back(std::move(worker));
  };
  // Breadth first: all parts of one level, then the parts that they were divided into.
  for (std::vector<PartTask> level{firstPart()}; !level.empty();) {
    parallel_for(static_cast<std::uint32_t>(level.size()), [&](std::uint32_t begin, std::uint32_t end) {
      bakeRange(std::span(level).subspan(begin, end - begin));
    });
    std::vector<PartTask> next;
    for (const PartTask& task : level) {
      const std::vector<PartTask> below = partsBelow(parts.at(task.id));
      next.insert(next.end(), below.begin(), below.end());
    }
    level = std::move(next);
    if (progress) {
      progress(std::min(share, 1.0));
    }
  }
  for (const std::unique_ptr<Worker>& worker : resting) {
    if (stats != nullptr) {
      add(*stats, worker->stats());
    }
  }
  return parts;
}

bool Bake::beginsAsAnswers(std::span<const std::byte> bytes) {
  return pvs::beginsAsAnswers(bytes);
}

Result<BakedVisibility> bakeVisibility(const SceneView& scene, const OccluderSet& occluders,
                                       const BakeSettings& settings, const ParallelFor& parallel_for) {
  const Result<Bake> bake = Bake::plan(scene, occluders, settings, parallel_for);
  if (!bake) {
    return bake.error();
  }
  return bake->assemble(bake->bakeAll(parallel_for));
}

}  // namespace sightline
