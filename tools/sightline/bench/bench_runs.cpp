#include "tools/sightline/bench/bench_runs.h"

#include <algorithm>
#include <array>
#include <span>

#include "src/base/stopwatch.h"
#include "tools/sightline/bench/machine.h"

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

namespace sightline::tool {
namespace {

// The costs of hierarchies by HierarchyKind, each built when the first setting needs it.
class HierarchyCosts {
 public:
  PartCost of(HierarchyKind kind, CullingData& data) {
    std::optional<PartCost>& cost = costs_[static_cast<std::size_t>(kind)];
    if (!cost) {
      base::Stopwatch watch;
      const Hierarchy& hierarchy = data.hierarchy(kind);
      cost = PartCost{watch.lap(), hierarchy.nodes.size() * sizeof(HierarchyNode) +
                                       hierarchy.objects.size() * sizeof(ObjectId)};
    }
    return *cost;
  }

 private:
  std::array<std::optional<PartCost>, 2> costs_;
};

// The costs of occluders and of surfaces, each found when the first setting needs them.
class OccluderCosts {
 public:
  PartCost of(const Setting& setting, CullingData& data) {
    PartCost sum;
    if (setting.choosesOccluders() || setting.testsDetailObjects()) {
      add(
          occluders_, [&] { data.occluders(); }, sum);
    }
    if (setting.surfaces() != SurfaceUse::kNone) {
      add(
          surfaces_, [&] { data.surfaces(); }, sum);
    }
    return sum;
  }

 private:
  template <typename Make>
  static void add(std::optional<PartCost>& cost, Make&& make, PartCost& sum) {
    if (!cost) {
      const HeapGrowth growth;
      base::Stopwatch watch;
      make();
      cost = PartCost{watch.lap(), growth.bytes()};
    }
    sum.us += cost->us;
    sum.bytes = sum.bytes && cost->bytes ? std::optional(*sum.bytes + *cost->bytes) : std::nullopt;
  }

  std::optional<PartCost> occluders_, surfaces_;
};

// The costs of the databases that the setting uses. Precondition: they are prepared.
PartCost databaseCost(const Setting& setting, const CullingData& data) {
  PartCost sum;
  const auto add = [&sum](const auto* timed) {
    if (timed != nullptr) {
      sum.us += timed->build_us;
      *sum.bytes += timed->database.bytes();
    }
  };
  if (setting.usesDatabase()) {
    add(data.database());
  }
  if (setting.testsDetailObjects()) {
    add(data.detailDatabase());
  }
  if (setting.usesViewpoints()) {
    add(data.viewpoints(setting.viewpoints.criterion));
  }
  return sum;
}

// Calls measure(run, frame) for every run and view, in the order that measureCulling() describes.
template <typename Measure>
void interleave(std::vector<BenchRun>& runs, std::size_t frames, std::size_t rounds, const Done& done,
                Measure&& measure) {
  for (std::size_t round = 0; round < rounds; ++round) {
    for (std::size_t frame = 0; frame < frames; ++frame) {
      for (std::size_t k = 0; k < runs.size(); ++k) {
        const std::size_t place = (round + frame + k) % runs.size();
        measure(runs[round % 2 == 0 ? place : runs.size() - 1 - place], frame);
      }
      done(static_cast<double>(round * frames + frame + 1) / static_cast<double>(rounds * frames));
    }
  }
}

void cullMeasured(BenchRun& run, const View& view) {
  const double cpu_start = threadTimeUs();
  base::Stopwatch watch;
  run.culler.cull(view);
  run.cull_us.push_back(watch.lap());
  run.cpu_us.push_back(threadTimeUs() - cpu_start);
}

// How many of the objects are not in `kept`. Both ascend.
std::uint64_t countMissing(std::span<const ObjectId> objects, std::span<const ObjectId> kept) {
  return static_cast<std::uint64_t>(std::count_if(objects.begin(), objects.end(), [&](ObjectId object) {
    return !std::binary_search(kept.begin(), kept.end(), object);
  }));
}

void addAnswer(pvs::Checksum& answers, std::span<const ObjectId> kept) {
  answers.addValue(static_cast<std::uint64_t>(kept.size()));
  for (const ObjectId object : kept) {
    answers.addValue(object.value);
  }
}

}  // namespace

std::vector<BenchRun> makeBenchRuns(const std::vector<Setting>& settings, CullingData& data) {
  std::vector<BenchRun> runs;
  HierarchyCosts hierarchies;
  OccluderCosts occluders;
  for (const Setting& setting : settings) {
    const MethodTraits& traits = setting.method->traits;
    Preparation preparation;
    const PartCost hierarchy = hierarchies.of(setting.hierarchy, data);
    preparation.hierarchy = traits.hierarchy ? hierarchy : PartCost{};
    preparation.occluders = occluders.of(setting, data);
    data.prepare(setting);
    preparation.databases = databaseCost(setting, data);
    const HeapGrowth growth;
    base::Stopwatch watch;
    Culler culler = data.makeCuller(setting);
    preparation.method = {watch.lap(), growth.bytes()};
    culler.setParallelFor(serialFor);
    SettingRecord record{.setting = setting, .preparation = preparation};
    runs.push_back({std::move(record), std::move(culler)});
  }
  return runs;
}

void warmUp(std::vector<BenchRun>& runs, const std::vector<View>& views,
            const std::vector<ExactObjects>& exact) {
  for (BenchRun& run : runs) {
    SettingRecord& record = run.record;
    pvs::Checksum answers;
    const HeapGrowth growth;
    for (std::size_t frame = 0; frame < views.size(); ++frame) {
      run.culler.cull(views[frame]);
      const std::span<const ObjectId> kept = run.culler.visible();
      record.kept += kept.size();
      record.missed += countMissing(exact[frame].witnessed, kept);
      addAnswer(answers, kept);
    }
    record.answers = answers.value();
    std::optional<std::size_t>& bytes = record.preparation.method.bytes;
    const std::optional<std::size_t> grown = growth.bytes();
    bytes = bytes && grown ? std::optional(*bytes + *grown) : std::nullopt;
  }
}

void measureCulling(std::vector<BenchRun>& runs, const std::vector<View>& views, std::size_t rounds,
                    const Done& done) {
  for (BenchRun& run : runs) {
    run.cull_us.reserve(views.size() * rounds);
    run.cpu_us.reserve(views.size() * rounds);
  }
  interleave(runs, views.size(), rounds, done,
             [&](BenchRun& run, std::size_t frame) { cullMeasured(run, views[frame]); });
  for (BenchRun& run : runs) {
    run.record.cull = frameTimesOf(run.cull_us, rounds);
    run.record.cpu = frameTimesOf(run.cpu_us, rounds);
  }
}

void measureDrawing(std::vector<BenchRun>& runs, const std::vector<View>& views, std::size_t rounds,
                    Renderer& renderer, const Done& done) {
  renderer.time(views.front(), runs.front().culler.visible());  // warms up
  interleave(runs, views.size(), rounds, done, [&](BenchRun& run, std::size_t frame) {
    run.culler.cull(views[frame]);
    run.draw_us.push_back(renderer.time(views[frame], run.culler.visible()).draw_us);
  });
  for (BenchRun& run : runs) {
    run.record.draw = frameTimesOf(run.draw_us, rounds);
  }
}

}  // namespace sightline::tool
