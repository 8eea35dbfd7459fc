#pragma once

// Baking: computes the potentially visible set of every cell of space, once per scene, in parts that any
// thread or machine may bake.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sightline/base/parallel_for.h"
#include "sightline/base/progress.h"
#include "sightline/base/result.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/pvs/format/baked_visibility.h"
#include "sightline/pvs/format/witness.h"
#include "sightline/scene/object_boxes.h"
#include "sightline/scene/scene.h"

namespace sightline {

// What hides objects from a cell.
enum class BakeOcclusion : std::uint8_t {
  kConvex,  // each convex occluder by itself, as in the paper
  kFused,   // and surfaces of any number of triangles together
};

struct BakeSettings {
  // Scenes of more objects are searched by lines of sight, and occluders are looked for at any distance,
  // unless the settings say otherwise.
  static constexpr std::size_t kManyObjects = 20'000;

  // Fused sets are smaller, and take some fifty times as long to bake.
  BakeOcclusion occlusion = BakeOcclusion::kConvex;
  std::uint64_t triangle_budget = 0;  // a cell whose set has at most this many triangles is not divided
  // Maximum number of bytes of the file, without its settings and occluder databases; 0: any. Of the cells
  // that were baked, those are joined that gain viewers least. The parts are the same with any.
  std::uint64_t byte_budget = 0;
  // Maximum number of times a cell of the octree is halved, which determines memory: at most kMaxOctreeDepth,
  // or kChooseDepth to choose a depth that suits the sizes of the region and of the occluders. With kFused,
  // fewer cells are chosen.
  static constexpr std::uint32_t kChooseDepth = 0xffffffffu;
  std::uint32_t max_depth = kChooseDepth;
  // Maximum distance in metres from a viewer's eye to what its near plane clips (nearDistance). Occluders
  // closer to a cell than this do not count. Viewers with a greater distance get all objects as their set.
  double near_distance = 0.25;
  // Viewers are in these boxes, in scene space (see viewer_space.h); if there are none, in the bounds of the
  // scene. Cells that meet none of them are not baked and hold all objects. The octree's root is a cube
  // around all of them, the viewing region.
  std::vector<Box> viewers{};
  // A cell's sets hold for the box around what of the viewers' boxes lies in it (ViewerBounds). With this, or
  // without boxes of viewers, they hold for all of each cell that meets viewers.
  bool whole_cells = false;
  // Doors: objects that hide only while they are closed. The sets hold while all of them are open, and always
  // contain the doors themselves, for an open one may be anywhere. Beside them is stored what each door hides
  // while it is closed; what the doors of each of these groups hide together, such as two side by side that
  // lead into one room; and what all of them hide together. A group of one is a door by itself. Surfaces of
  // doors take memory for each group (BakeOcclusion::kFused).
  std::vector<std::vector<ObjectId>> doors{};
  // Occluders are searched within this distance of a viewpoint at first, in metres. It is doubled where that
  // helps. 0: an eighth of the scene's diagonal, or all of it with more than kManyObjects objects.
  double search_distance = 0.0;
  // An occluder is useful to a cell if its area is at least this many times that of the cell's smallest face,
  // or its volume at least this many times the cell's.
  double occluder_size = 1.0;
  // Dividing a cell helps if some point sees less than the cell by this fraction of the cell's triangles. The
  // points are the cell's corners and centre and its children's centres.
  double similarity = 0.1;
  double min_gain = 0.02;  // doubling the search box helped if it hid this fraction of the triangles
  // Siblings are merged if their union sees at most this fraction more than each of them.
  double merge_tolerance = 0.05;
  // Where surfaces do not surely hide an object from a whole cell, the widest of the cell, the object's box
  // and, with narrowings, the window is halved up to this many times, 0 to 16, and each half is tested.
  std::uint32_t divisions = 0;
  // Done first, up to this many times, 0 to 8: a window is laid between the cell and the object's box, and of
  // all three only what lines of sight may pass is kept.
  std::uint32_t narrowings = 0;
  // With surfaces, an object is hidden if each of so many boxes around its triangles is, at most
  // kMaxObjectBoxes; 1: its own box alone. box_margin: ObjectBoxesSettings::margin, metres.
  std::uint32_t object_boxes = kMaxObjectBoxes;
  double box_margin = 0.0;
  // Maximum bytes of samples per worker, checked between cells; discarded samples are computed again. 0: none
  // are kept, and what may hide a box is found by lines of sight, which takes little memory, and less time
  // where objects are many or cells small. None given: 256 MiB, or 0 with more than kManyObjects objects. The
  // sets are the same.
  std::optional<std::size_t> sample_bytes{};
  bool witnesses = false;  // records what hides objects; see Bake::witnesses. The sets stay the same
  bool answers = false;    // records what was asked; see Bake::answers. The sets stay the same
};

// A cell of the octree that one thread bakes, or divides into eight such parts. The list of parts emerges
// during the bake.
struct PartTask {
  std::uint64_t id = 1;          // 1: the root; 8 * id + i: child number i of it
  double search_distance = 0.0;  // metres; set by the parent part
  // The objects that the parent sees, as the parent part wrote them; none: all.
  std::vector<std::byte> seen{};
  friend bool operator==(const PartTask&, const PartTask&) = default;
};

// The result of one part as plain bytes, the same wherever it was baked.
using BakedPart = std::vector<std::byte>;
using BakedParts = std::map<std::uint64_t, BakedPart>;  // by PartTask::id
// Reads a part from where it is kept, such as a file; nothing if it is not there.
using ReadPart = std::function<std::optional<BakedPart>(std::uint64_t id)>;

// What is in a .sight file beside what is baked.
struct SightExtras {
  std::string settings{};  // BakeRecord::settings
  std::vector<DatabaseBlob> databases{};
};

struct PartSummary {
  std::uint32_t leaves = 0;     // 0 if the part was divided into parts
  double mean_triangles = 0.0;  // mean over the leaves' sets
  double share = 0.0;           // how much of the bake the leaves are, 0 to 1; see Bake::maxCells
};

struct BakeStats {
  std::uint64_t samples = 0;    // viewpoints for which something was computed
  std::uint64_t shadows = 0;    // pairs of an occluder and a viewpoint
  std::uint64_t forgotten = 0;  // samples discarded because memory ran out
  // Peak memory of samples, bytes; after add(), the sum of the workers' peaks.
  std::size_t max_sample_bytes = 0;
  // Questions: is something hidden from a region, or how much does a point see. Asked are those whose answers
  // were computed; the others were answered by what takeOver() had read of an earlier bake.
  std::uint64_t questions = 0, asked = 0;
  friend bool operator==(const BakeStats&, const BakeStats&) = default;
};

void add(BakeStats& sum, const BakeStats& stats);  // sums the workers' statistics

// Counts of potential occluders: convex bodies and convex polygons.
struct OccluderCounts {
  std::uint32_t all = 0;
  std::uint32_t inner = 0;    // those that are not the region's floor, ceiling or outer wall
  std::uint32_t of_use = 0;   // the inner ones that are large enough for the smallest cells
  double largest_area = 0.0;  // area of the largest face of the inner ones, square metres
};

// The plan of a bake: everything that its parts share. Immutable; any number of threads may bake parts.
//
//   std::vector<PartTask> open{bake.firstPart()};   // until it is empty: take one, bake it, add partsBelow
//   BakedParts parts;                               // then assemble, or writeSight
class Bake {
 public:
  // scene and occluders need not outlive the plan. occluders: all that are to be considered; area_fraction =
  // 1 omits none. Returns an error if settings are out of range, if the scene has no object, or none with a
  // finite box where no box of viewers is given, if an occluder belongs to no object of the scene, or if a
  // door is no object of the scene or hides nothing when it is closed, because of its material or its mark.
  static Result<Bake> plan(const SceneView& scene, const OccluderSet& occluders,
                           const BakeSettings& settings = {}, const ParallelFor& parallel_for = serialFor);

  const BakeSettings& settings() const;  // including the chosen depth and boxes of viewers
  // Any cell may be divided down to this level. Below it, down to settings().max_depth, only cells near
  // occluders are divided.
  std::uint32_t baseDepth() const;
  const OccluderCounts& occluders() const;
  // How many cells hold viewers if all are divided that may be: the most that can be baked. Nothing if they
  // are more than kMaxCounted. PartSummary::share is the part of these cells that leaves are or, if they are
  // not counted, the part of the viewing region.
  static constexpr std::uint64_t kMaxCounted = 1u << 21;
  std::optional<std::uint64_t> maxCells() const;
  // Identifies the plan: parts and checkpoints of one plan cannot be used with another.
  std::uint64_t hash() const;

  // What was taken over of an earlier bake.
  struct TakenOver {
    SceneId scene{};  // of that bake
    // Why all is asked anew: what holds for all cells differs, and how. Empty if it does not.
    std::string difference{};
    // Objects that are the same in both scenes, only in the earlier one, and only in this one. One that was
    // moved or altered is gone and has come.
    std::uint32_t same = 0, gone = 0, come = 0;
  };
  // Takes over answers of an earlier bake, of this scene before a change: workers that are made from now on
  // ask only what depends on the change. The parts are the same as without. answers: of Bake::answers; an
  // error tells that they are damaged, or of another version, or that BakeSettings::witnesses is set. They
  // are trusted as the program is: whoever makes their checksum anew can hide what is visible.
  Result<TakenOver> takeOver(std::vector<std::byte> answers);

  PartTask firstPart() const;
  // The parts that a baked part was divided into: eight or none.
  std::vector<PartTask> partsBelow(std::span<const std::byte> part) const;
  PartSummary summaryOf(std::span<const std::byte> part) const;
  // True if these bytes claim to be this part of this plan, and have all blocks of one.
  bool isPart(std::uint64_t id, std::span<const std::byte> part) const;

  // Bakes parts one after the other and keeps the samples they share. For use by one thread at a time.
  class Worker {
   public:
    explicit Worker(const Bake& bake);  // keeps the plan's data alive
    ~Worker();
    Worker(Worker&&) noexcept;
    // part: the first one, or one of partsBelow(). The result depends only on the plan and the part.
    BakedPart bake(const PartTask& part);
    BakeStats stats() const;

   private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
  };

  // Bakes all parts in the threads of parallel_for. stats: summed over all workers, if not null.
  BakedParts bakeAll(const ParallelFor& parallel_for = serialFor, const Progress& progress = {},
                     BakeStats* stats = nullptr) const;

  // parts: all parts of the plan. The result is the same whoever baked them. Returns an error if a part is
  // missing or its bytes are not of this plan, or if no cells are few enough for the byte budget.
  Result<BakedVisibility> assemble(const BakedParts& parts) const;
  Result<BakedVisibility> assemble(const ReadPart& read) const;
  // Assembles and writes the file, with the bytes that sightline::writeSight() gives it, but has no more than
  // a part and the octree without its sets in memory; with a byte budget, all sets are. Each part is read
  // once. Payload that is not in its place yet is in a nameless file beside the target.
  Result<void> writeSight(const std::string& file, const ReadPart& read,
                          const SightExtras& extras = {}) const;
  // What hides the objects that are not in the sets, if BakeSettings::witnesses is set: for each claim of a
  // leaf, a witness of its cell, of a cell around it, or of each of the cells that it was merged from. Parts
  // as for assemble(), which must have succeeded with them.
  Witnesses witnesses(const BakedParts& parts) const;
  Result<Witnesses> witnesses(const ReadPart& read) const;  // an error if a part cannot be read
  // The answers to all that was asked, as bytes of a file, if BakeSettings::answers is set: for takeOver() of
  // a bake of the scene after a change. Parts as for assemble(), which must have succeeded with them.
  std::vector<std::byte> answers(const BakedParts& parts) const;
  Result<std::vector<std::byte>> answers(const ReadPart& read) const;  // likewise
  // True if the bytes, eight at least, begin as those of answers() do.
  static bool beginsAsAnswers(std::span<const std::byte> bytes);

 private:
  struct Data;
  struct Earlier;
  std::shared_ptr<const Data> data_;
  std::shared_ptr<const Earlier> earlier_;  // null: none
};

// Plans, bakes and assembles in one call, in the threads of parallel_for.
Result<BakedVisibility> bakeVisibility(const SceneView& scene, const OccluderSet& occluders,
                                       const BakeSettings& settings = {},
                                       const ParallelFor& parallel_for = serialFor);

}  // namespace sightline
