// How well do the parts of a bake keep many threads and processes busy? Bakes a scene part by part on one
// thread, measuring the processor time of each, and then hands the same parts to 1 to 1,024 takers of the
// queue that `sightline bake` uses, in simulated time. A table row for each number of takers.
//
//   parts [--depth=D] [--fused] [--narrowings=N] [--budget=TRIANGLES] [--questions] SCENE...
//
// --questions: prints a line for each part instead: id, leaves, questions, microseconds, bytes.

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <queue>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bench/benchmark_scene.h"
#include "bench/measuring.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/pvs/bake/bake.h"
#include "tools/sightline/bake/part_queue.h"

namespace {

using namespace sightline;
using namespace sightline::bench;

// What a process with nothing to do waits for a part, at most: both sides look for messages every
// millisecond.
constexpr double kHandingOut = 2000.0;  // microseconds

struct Options {
  BakeSettings settings{};
  bool questions = false;
  std::vector<std::string> scenes;
};

Options optionsOf(int argc, char** argv) {
  Options options;
  options.settings.max_depth = 6;
  for (int i = 1; i < argc; ++i) {
    const std::string_view word = argv[i];
    const auto is = [&](std::string_view name, auto& number) {
      if (word.rfind(name, 0) != 0) {
        return false;
      }
      number = std::strtoul(argv[i] + name.size(), nullptr, 10);
      return true;
    };
    std::uint64_t depth = 0, narrowings = 0;
    if (is("--depth=", depth)) {
      options.settings.max_depth = static_cast<std::uint32_t>(depth);
    } else if (is("--narrowings=", narrowings)) {
      options.settings.narrowings = static_cast<std::uint32_t>(narrowings);
    } else if (is("--budget=", options.settings.triangle_budget)) {
    } else if (word == "--fused") {
      options.settings.occlusion = BakeOcclusion::kFused;
    } else if (word == "--questions") {
      options.questions = true;
    } else if (word.rfind("--", 0) != 0) {
      options.scenes.emplace_back(word);
    }
  }
  return options;
}

struct MeasuredPart {
  double time = 0.0;  // microseconds of processor time
  std::uint32_t leaves = 0;
  std::uint64_t questions = 0, bytes = 0;
  std::vector<std::uint64_t> below{};
};
using MeasuredParts = std::map<std::uint64_t, MeasuredPart>;

// Bakes all parts in the order in which a single thread of the tool does.
MeasuredParts measure(const Bake& bake) {
  MeasuredParts parts;
  Bake::Worker worker(bake);
  tool::PartQueue queue(1);
  const PartTask first = bake.firstPart();
  queue.add(0, std::span(&first, 1));
  for (;;) {
    const std::vector<PartTask> next = queue.takeNow(0, 1);
    if (next.empty()) {
      return parts;
    }
    const std::uint64_t asked_before = worker.stats().questions;
    const double start = processorMicroseconds();
    const BakedPart bytes = worker.bake(next[0]);
    MeasuredPart& part = parts[next[0].id];
    part.time = processorMicroseconds() - start;
    part.questions = worker.stats().questions - asked_before;
    part.bytes = bytes.size();
    part.leaves = bake.summaryOf(bytes).leaves;
    const std::vector<PartTask> below = bake.partsBelow(bytes);
    queue.add(0, below);
    for (const PartTask& task : below) {
      part.below.push_back(task.id);
    }
  }
}

// Microseconds until so many takers have baked all parts. Taker 0 is the first process, of one thread. The
// others are processes of one thread each that ask it for parts, and get one to begin later as soon as more
// parts are waiting than there are takers (tools/sightline/bake/bake_run.cpp).
class Simulation {
 public:
  Simulation(const MeasuredParts& parts, std::uint32_t takers)
      : parts_(parts), queue_(takers), ahead_(takers, kNone), busy_(takers, false) {
    const PartTask first{.id = 1};
    queue_.add(0, std::span(&first, 1));
  }

  double run() {
    for (handOut(); !running_.empty(); handOut()) {
      const Finish finished = running_.top();
      running_.pop();
      now_ = finished.at;
      std::vector<PartTask> below;
      for (const std::uint64_t id : parts_.at(finished.part).below) {
        below.push_back({.id = id});
      }
      queue_.add(finished.taker, below);
      busy_[finished.taker] = false;
      if (const std::uint64_t next = std::exchange(ahead_[finished.taker], kNone); next != kNone) {
        start(finished.taker, next, 0.0);
      }
    }
    return now_;
  }

 private:
  static constexpr std::uint64_t kNone = 0;
  struct Finish {
    double at;
    std::uint32_t taker;
    std::uint64_t part;
    bool operator>(const Finish& other) const { return at != other.at ? at > other.at : taker > other.taker; }
  };

  void start(std::uint32_t taker, std::uint64_t part, double wait) {
    busy_[taker] = true;
    running_.push({now_ + wait + parts_.at(part).time, taker, part});
  }

  void handOut() {
    const auto count = static_cast<std::uint32_t>(busy_.size());
    std::size_t waiting = queue_.waiting();
    for (std::uint32_t taker = 0; taker < count && waiting > 0; ++taker) {
      if (!busy_[taker]) {
        start(taker, queue_.takeNow(taker, 1)[0].id, taker == 0 ? 0.0 : kHandingOut);
        --waiting;
      }
    }
    for (std::uint32_t taker = 1; taker < count && waiting > count; ++taker) {
      if (ahead_[taker] == kNone) {
        ahead_[taker] = queue_.takeNow(taker, 1)[0].id;
        --waiting;
      }
    }
  }

  const MeasuredParts& parts_;
  tool::PartQueue queue_;
  std::vector<std::uint64_t> ahead_;  // by taker: the part that it begins next
  std::vector<bool> busy_;            // by taker
  std::priority_queue<Finish, std::vector<Finish>, std::greater<>> running_;
  double now_ = 0.0;  // microseconds
};

// The time of the parts from the root down to one of the lowest, where it is longest: with any number of
// processes a bake takes so long.
double longestChain(const MeasuredParts& parts) {
  std::map<std::uint64_t, double> until;
  double longest = 0.0;
  for (const auto& [id, part] : parts) {  // a part has a smaller id than those below it
    const double end = until[id] + part.time;
    longest = std::max(longest, end);
    for (const std::uint64_t below : part.below) {
      until[below] = end;
    }
  }
  return longest;
}

void report(const std::string& name, const Options& options) {
  const Scene scene = loadScene(name, "parts").scene;
  BakeSettings settings = options.settings;
  if (settings.triangle_budget == 0) {
    settings.triangle_budget = std::max<std::uint64_t>(scene.triangleCount() / 50, 100);
  }
  const OccluderSet occluders = findOccluders(scene.view(), {.area_fraction = 1.0});
  const Bake bake = valueOrExit(Bake::plan(scene.view(), occluders, settings), "parts");
  const MeasuredParts parts = measure(bake);
  double sum = 0.0, largest = 0.0;
  std::uint64_t bytes = 0, with_leaves = 0, largest_bytes = 0;
  for (const auto& [id, part] : parts) {
    sum += part.time;
    largest = std::max(largest, part.time);
    bytes += part.bytes;
    largest_bytes = std::max(largest_bytes, part.bytes);
    with_leaves += part.leaves > 0 ? 1 : 0;
    if (options.questions) {
      fmt::print("{} {} {} {:.0f} {}\n", id, part.leaves, part.questions, part.time, part.bytes);
    }
  }
  const double chain = longestChain(parts);
  fmt::print(
      "{}: {} parts, {} of them with leaves; {:.1f} s in all, {:.3f} s a part, {:.3f} s the largest, {:.3f} "
      "s "
      "the longest chain; {} bytes, {} the largest\n",
      name, parts.size(), with_leaves, sum * 1e-6, sum * 1e-6 / static_cast<double>(parts.size()),
      largest * 1e-6, chain * 1e-6, bytes, largest_bytes);
  fmt::print("| takers | s | least possible, s | busy, % |\n|---|---|---|---|\n");
  for (std::uint32_t takers = 1; takers <= 1024; takers *= 2) {
    const double end = Simulation(parts, takers).run(), least = std::max(sum / takers, chain);
    fmt::print("| {} | {:.2f} | {:.2f} | {:.1f} |\n", takers, end * 1e-6, least * 1e-6,
               100.0 * sum / (end * takers));
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = optionsOf(argc, argv);
  if (options.scenes.empty()) {
    std::puts("parts: nothing to do; name scenes: demo:ship, or files");
  }
  for (const std::string& scene : options.scenes) {
    report(scene, options);
  }
  return 0;
}
