#include "tools/sightline/reproduce/timed_bake.h"

#include <algorithm>
#include <memory>
#include <mutex>
#include <span>

#include "src/base/stopwatch.h"

namespace sightline::tool {
namespace {

// Workers that wait for work, at most one for each thread; they keep samples from part to part.
class Workers {
 public:
  explicit Workers(const Bake& bake) : bake_(bake) {}

  std::unique_ptr<Bake::Worker> take() {
    const std::lock_guard lock(mutex_);
    if (resting_.empty()) {
      return std::make_unique<Bake::Worker>(bake_);
    }
    std::unique_ptr<Bake::Worker> worker = std::move(resting_.back());
    resting_.pop_back();
    return worker;
  }
  void giveBack(std::unique_ptr<Bake::Worker> worker) {
    const std::lock_guard lock(mutex_);
    resting_.push_back(std::move(worker));
  }
  BakeStats stats() const {
    BakeStats sum;
    for (const std::unique_ptr<Bake::Worker>& worker : resting_) {
      add(sum, worker->stats());
    }
    return sum;
  }

 private:
  const Bake& bake_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Bake::Worker>> resting_;
};

void addApart(TimedBake& done, const BakeStats& part) {
  const std::size_t largest = std::max(done.stats.max_sample_bytes, part.max_sample_bytes);
  add(done.stats, part);
  done.stats.max_sample_bytes = largest;
  done.part_bytes.push_back(static_cast<double>(part.max_sample_bytes));
}

}  // namespace

TimedBake bakeTimed(const Bake& bake, BakedAs as, const ParallelFor& parallel_for, const Progress& progress) {
  TimedBake done;
  Workers workers(bake);
  std::mutex mutex;
  double share = 0.0;
  // Breadth first: all parts of one level, then the parts that they were divided into.
  for (std::vector<PartTask> level{bake.firstPart()}; !level.empty();) {
    parallel_for(static_cast<std::uint32_t>(level.size()), [&](std::uint32_t begin, std::uint32_t end) {
      std::unique_ptr<Bake::Worker> worker = workers.take();
      for (const PartTask& task : std::span(level).subspan(begin, end - begin)) {
        if (as == BakedAs::kApart) {
          worker = std::make_unique<Bake::Worker>(bake);
        }
        base::Stopwatch watch;
        BakedPart part = worker->bake(task);
        const double ms = 1e-3 * watch.lap();
        const std::lock_guard lock(mutex);
        share += bake.summaryOf(part).share;
        done.part_ms.push_back(ms);
        if (as == BakedAs::kApart) {
          addApart(done, worker->stats());
        }
        done.parts.emplace(task.id, std::move(part));
      }
      workers.giveBack(std::move(worker));
    });
    std::vector<PartTask> next;
    for (const PartTask& task : level) {
      const std::vector<PartTask> below = bake.partsBelow(done.parts.at(task.id));
      next.insert(next.end(), below.begin(), below.end());
    }
    level = std::move(next);
    if (progress) {
      progress(std::min(share, 1.0));
    }
  }
  if (as == BakedAs::kWhole) {
    done.stats = workers.stats();
  }
  return done;
}

}  // namespace sightline::tool
