// One main thread a process, which alone speaks to other processes and to the checkpoint, and its baking
// threads, which know the queue only. The main thread sleeps between its looks, so that it costs no core.

#include "tools/sightline/bake_run.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "tools/sightline/part_queue.h"
#include "tools/sightline/progress_bar.h"

namespace sightline::tool {
namespace {

constexpr std::chrono::milliseconds kLook{1};        // between looks for messages
constexpr std::chrono::milliseconds kPatience{100};  // without other processes
constexpr std::chrono::seconds kSayHowToGoOn{2};

// Messages between processes; from the first to the others: kGo, kParts.
enum Tag : int {
  kReady,   // number, error: how the process fares
  kGo,      // number: 1, or 0 to give up
  kWant,    // number: so many threads have nothing to do
  kParts,   // their numbers; fewer than wanted: there are no more
  kDone,    // number of the part, its bytes
  kTotals,  // stats and peak memory, when all is done
  kFailed,  // text: why
};

volatile std::sig_atomic_t told_to_end = 0;
extern "C" void noteSignal(int signal) {
  told_to_end = signal;
}

// While it lives, SIGINT and SIGTERM are noted, but for what the process was started to ignore.
class SignalGuard {
 public:
  SignalGuard() {
    struct sigaction action {};
    action.sa_handler = noteSignal;
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      sigaction(kSignals[i], nullptr, &old_[i]);
      if (old_[i].sa_handler != SIG_IGN) {
        sigaction(kSignals[i], &action, nullptr);
      }
    }
  }
  ~SignalGuard() {
    for (std::size_t i = 0; i < kSignals.size(); ++i) {
      sigaction(kSignals[i], &old_[i], nullptr);
    }
  }

 private:
  static constexpr std::array<int, 2> kSignals{SIGINT, SIGTERM};
  std::array<struct sigaction, 2> old_;
};

// The baking threads of this process.
class BakeThreads {
 public:
  BakeThreads(const Bake& bake, PartQueue& queue, std::uint32_t count) : queue_(queue), stats_(count) {
    for (std::uint32_t i = 0; i < count; ++i) {
      threads_.emplace_back([this, &bake, i] { work(bake, stats_[i]); });
    }
  }
  // Parts that are being baked are finished.
  ~BakeThreads() {
    queue_.clear();
    join();
  }
  BakeThreads(const BakeThreads&) = delete;
  BakeThreads& operator=(const BakeThreads&) = delete;

  // Once the queue is closed.
  BakeStats join() {
    BakeStats sum;
    for (std::thread& thread : threads_) {
      thread.join();
    }
    threads_.clear();
    for (const BakeStats& stats : stats_) {
      add(sum, stats);
    }
    return sum;
  }

 private:
  void work(const Bake& bake, BakeStats& stats) {
    try {
      Bake::Worker worker(bake);
      while (const std::optional<std::uint32_t> part = queue_.take()) {
        queue_.finish({*part, worker.bake(*part)});
        stats = worker.stats();
      }
    } catch (const std::exception& error) {
      queue_.fail(
          fmt::format("a thread of the bake failed: {}; try a smaller --sample-memory, or fewer "
                      "--threads, with --resume",
                      error.what()));
    }
  }

  PartQueue& queue_;
  std::vector<BakeStats> stats_;
  std::vector<std::thread> threads_;
};

// The first process's.
class FirstBaker {
 public:
  FirstBaker(const Bake& bake, MpiWorld& world, std::uint32_t threads, Checkpoint& checkpoint,
             std::vector<std::optional<BakedPart>> parts, BakeEffort& effort)
      : bake_(bake),
        world_(world),
        threads_(threads),
        checkpoint_(checkpoint),
        parts_(std::move(parts)),
        effort_(effort) {}

  Result<std::vector<BakedPart>> run() {
    begin();
    const SignalGuard guard;
    ProgressBar bar("baking", fraction());
    BakeThreads threads(bake_, queue_, threads_);
    const auto start = std::chrono::steady_clock::now();
    while (done_ < parts_.size() || totals_ + 1 < world_.size()) {
      if (const Status ok = look(); !ok) {
        fail(ok.error());
        return ok.error();
      }
      if (told_to_end != 0) {
        endEarly(bar);
      }
      if (!said_ && done_ < parts_.size() && std::chrono::steady_clock::now() - start > kSayHowToGoOn) {
        bar.say("should this be interrupted, the same command with --resume goes on");
        said_ = true;
      }
      bar.update(fraction(), note());
    }
    add(effort_.stats, threads.join());
    return taken();
  }

 private:
  void begin() {
    std::vector<std::uint32_t> missing;
    for (std::uint32_t p = 0; p < parts_.size(); ++p) {
      if (parts_[p]) {
        count(*parts_[p]);
      } else {
        missing.push_back(p);
      }
    }
    effort_.processes = static_cast<std::uint32_t>(world_.size());
    effort_.threads = threads_;
    effort_.parts_before = done_;
    queue_.add(missing);
    queue_.close();
  }

  // At what threads and other processes have done meanwhile.
  Status look() {
    for (FinishedPart& finished : queue_.finished(world_.size() > 1 ? kLook : kPatience)) {
      if (const Status ok = keep(std::move(finished)); !ok) {
        return ok;
      }
    }
    if (const std::optional<std::string> failure = queue_.failure()) {
      return Error{*failure};
    }
    while (const std::optional<MpiWorld::Message> message = world_.receive()) {
      if (const Status ok = answer(*message); !ok) {
        return ok;
      }
    }
    return Success{};
  }

  Status answer(const MpiWorld::Message& message) {
    MessageReader reader(message.bytes);
    if (message.tag == kFailed) {
      return Error{reader.text()};
    }
    if (message.tag == kDone) {
      const auto part = static_cast<std::uint32_t>(reader.number());
      return keep({part, BakedPart(reader.rest().begin(), reader.rest().end())});
    }
    if (message.tag == kWant) {
      MessageWriter parts;
      for (const std::uint32_t part : queue_.takeNow(reader.number())) {
        parts.number(part);
      }
      // So short that MPI does not wait for the receiver, who may be sending as well.
      world_.send(message.from, kParts, parts.bytes());
    }
    if (message.tag == kTotals) {
      BakeStats stats;
      stats.samples = reader.number();
      stats.shadows = reader.number();
      stats.forgotten = reader.number();
      stats.most_sample_bytes = reader.number();
      const std::uint64_t peak = reader.number();
      add(effort_.stats, stats);
      effort_.peak_bytes = std::max(effort_.peak_bytes, peak);
      effort_.all_peak_bytes += peak;
      totals_ += 1;
    }
    return Success{};
  }

  Status keep(FinishedPart finished) {
    if (finished.part >= parts_.size() || parts_[finished.part]) {
      return Success{};  // nobody was given such a part
    }
    if (const Status ok = checkpoint_.append(finished.part, finished.bytes); !ok) {
      return ok;
    }
    count(finished.bytes);
    parts_[finished.part] = std::move(finished.bytes);
    return Success{};
  }

  void count(const BakedPart& part) {
    const PartSummary summary = Bake::summaryOf(part);
    done_ += 1;
    leaves_ += summary.leaves;
    triangles_ += summary.mean_triangles * summary.leaves;
  }

  double fraction() const {
    return parts_.empty() ? 1.0 : static_cast<double>(done_) / static_cast<double>(parts_.size());
  }
  std::string note() const {
    return leaves_ == 0 ? std::string()
                        : fmt::format("{} cells, {:.0f} triangles a set", leaves_,
                                      triangles_ / static_cast<double>(leaves_));
  }

  // Other processes may be in the middle of a message: there is no other way to end them.
  void fail(const Error& error) {
    if (world_.size() > 1) {
      fmt::print(stderr, "sightline: {}\n", error.message);
      world_.abort(2);
    }
  }

  [[noreturn]] void endEarly(ProgressBar& bar) {
    const bool kept = checkpoint_.flush().has_value();
    bar.say(fmt::format("interrupted; {} of {} parts are {}; the same command with --resume goes on", done_,
                        parts_.size(), kept ? "kept" : "kept, as far as they could be written"));
    std::fflush(stderr);
    std::_Exit(128 + told_to_end);  // threads are in the middle of parts
  }

  std::vector<BakedPart> taken() {
    std::vector<BakedPart> parts;
    for (std::optional<BakedPart>& part : parts_) {
      parts.push_back(std::move(*part));
    }
    return parts;
  }

  const Bake& bake_;
  MpiWorld& world_;
  std::uint32_t threads_;
  Checkpoint& checkpoint_;
  std::vector<std::optional<BakedPart>> parts_;
  BakeEffort& effort_;
  PartQueue queue_;
  std::uint32_t done_ = 0;
  std::uint64_t leaves_ = 0;
  double triangles_ = 0.0;  // of all sets
  int totals_ = 0;          // processes that are through
  bool said_ = false;
};

}  // namespace

Status agree(MpiWorld& world, const Status& own, std::uint64_t number) {
  if (!world.first()) {
    MessageWriter ready;
    world.send(0, kReady, ready.number(number).text(own ? "" : own.error().message).bytes());
    const MpiWorld::Message go = world.wait();
    return MessageReader(go.bytes).number() == 1 ? Status(Success{}) : Error{"another process failed"};
  }
  Status all = own;
  for (int others = 1; others < world.size(); ++others) {
    const MpiWorld::Message ready = world.wait();
    MessageReader reader(ready.bytes);
    const std::uint64_t its = reader.number();
    const std::string error = reader.text();
    if (all && !error.empty()) {
      all = Error{fmt::format("{} (process {})", error, ready.from)};
    } else if (all && its != number) {
      all = Error{fmt::format("processes 0 and {} have another scene or another program; give all the same",
                              ready.from)};
    }
  }
  for (int other = 1; other < world.size(); ++other) {
    world.send(other, kGo, MessageWriter().number(all ? 1 : 0).bytes());
  }
  return all;
}

Result<std::vector<BakedPart>> bakeAsFirst(const Bake& bake, MpiWorld& world, std::uint32_t threads,
                                           Checkpoint& checkpoint,
                                           std::vector<std::optional<BakedPart>> parts, BakeEffort& effort) {
  return FirstBaker(bake, world, threads, checkpoint, std::move(parts), effort).run();
}

void bakeAsOther(const Bake& bake, MpiWorld& world, std::uint32_t threads) {
  PartQueue queue;
  BakeThreads bakers(bake, queue, threads);
  std::uint32_t out = 0;    // parts that this process has and has not sent back
  std::uint32_t asked = 0;  // for so many, not yet answered
  bool more = true;
  while (more || out > 0) {
    for (const FinishedPart& finished : queue.finished(kLook)) {
      MessageWriter done;
      if (!world.send(0, kDone, done.number(finished.part).rest(finished.bytes).bytes())) {
        queue.fail("a part takes more than 2 GiB; bake with a larger --depth or in one process");
      }
      out -= 1;
    }
    if (const std::optional<std::string> failure = queue.failure()) {
      world.send(0, kFailed, MessageWriter().text(*failure).bytes());
      world.wait();  // for the first to end all
    }
    if (more && asked == 0 && out < threads) {
      asked = threads - out;
      world.send(0, kWant, MessageWriter().number(asked).bytes());
    }
    while (const std::optional<MpiWorld::Message> message = world.receive()) {
      const std::size_t given = message->bytes.size() / sizeof(std::uint64_t);
      MessageReader reader(message->bytes);
      more = given >= asked;
      for (std::size_t i = 0; i < given; ++i) {
        const auto part = static_cast<std::uint32_t>(reader.number());
        queue.add(std::span(&part, 1));
      }
      out += static_cast<std::uint32_t>(given);
      asked = 0;
    }
  }
  queue.close();
  const BakeStats stats = bakers.join();
  MessageWriter totals;
  totals.number(stats.samples).number(stats.shadows).number(stats.forgotten).number(stats.most_sample_bytes);
  world.send(0, kTotals, totals.number(peakBytes()).bytes());
}

void add(BakeStats& sum, const BakeStats& stats) {
  sum.samples += stats.samples;
  sum.shadows += stats.shadows;
  sum.forgotten += stats.forgotten;
  sum.most_sample_bytes += stats.most_sample_bytes;
}

std::uint64_t peakBytes() {
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace sightline::tool
