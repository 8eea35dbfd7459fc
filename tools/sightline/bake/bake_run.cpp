// Each process has one main thread, which alone communicates with other processes and the checkpoint, and
// baking threads, which use the queue only. The main thread sleeps between polls, so that it costs no core.

#include "tools/sightline/bake/bake_run.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstdlib>
#include <optional>
#include <set>
#include <thread>
#include <vector>

#include "tools/sightline/bake/part_queue.h"
#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/signals.h"

namespace sightline::tool {
namespace {

constexpr std::chrono::milliseconds kLook{1};        // between polls for messages
constexpr std::chrono::milliseconds kPatience{100};  // between polls if there are no other processes
constexpr std::chrono::seconds kSayHowToGoOn{2};

// The messages between processes. The first process sends kGo and kParts, the others send the rest.
enum Tag : int {
  kReady,   // the number and error given to agree()
  kGo,      // a number: 1 to go on, 0 to give up
  kWant,    // two numbers: how many threads have nothing to do, and how many more parts are wanted ahead
  kParts,   // the parts' ids, search distances and what is seen; if there are none, no more will come
  kDone,    // a part's id and its bytes
  kTotals,  // stats and peak memory, sent at the end
  kFailed,  // a text: the reason
};

// The baking threads of this process. With divide, the parts that a part was divided into go to the queue at
// once.
class BakeThreads {
 public:
  BakeThreads(const Bake& bake, PartQueue& queue, std::uint32_t count, bool divide)
      : queue_(queue), divide_(divide), stats_(count) {
    try {
      for (std::uint32_t i = 0; i < count; ++i) {
        threads_.emplace_back([this, &bake, i] { work(bake, i); });
      }
    } catch (...) {
      // The system gives no more threads. Those that run must end before this object does.
      queue_.clear();
      join();
      throw;
    }
  }
  // Waits until the parts that are being baked are finished.
  ~BakeThreads() {
    queue_.clear();
    join();
  }
  BakeThreads(const BakeThreads&) = delete;
  BakeThreads& operator=(const BakeThreads&) = delete;

  // Waits for the threads and returns their stats. Precondition: the queue is closed.
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
  void work(const Bake& bake, std::uint32_t taker) {
    try {
      Bake::Worker worker(bake);
      while (const std::optional<PartTask> part = queue_.take(taker)) {
        BakedPart bytes = worker.bake(*part);
        const std::vector<PartTask> below = divide_ ? bake.partsBelow(bytes) : std::vector<PartTask>{};
        queue_.finish(
            {part->id, std::move(bytes)});  // must precede the finish of the parts that it was divided into
        queue_.add(taker, below);
        stats_[taker] = worker.stats();
      }
    } catch (const std::exception& error) {
      queue_.fail(
          fmt::format("a thread of the bake failed: {}; try a smaller --sample-memory, or fewer "
                      "--threads, with --resume",
                      error.what()));
    }
  }

  PartQueue& queue_;
  bool divide_;
  std::vector<BakeStats> stats_;
  std::vector<std::thread> threads_;
};

// The first process's side of a bake: hands out parts and collects them.
class FirstBaker {
 public:
  FirstBaker(const Bake& bake, MpiWorld& world, std::uint32_t threads, Checkpoint& checkpoint,
             BakeEffort& effort)
      : bake_(bake),
        world_(world),
        threads_(threads),
        checkpoint_(checkpoint),
        effort_(effort),
        takers_(threads + static_cast<std::uint32_t>(world.size()) - 1),
        queue_(takers_),
        wanted_(static_cast<std::size_t>(world.size())) {}

  // Returns the number of parts.
  Result<std::uint64_t> run(std::span<const std::uint64_t> known) {
    begin(known);
    const SignalGuard guard;
    ProgressBar bar("baking", share_);
    BakeThreads threads(bake_, queue_, threads_, !checks_known_);
    const auto start = std::chrono::steady_clock::now();
    while (open_ > 0 || totals_ + 1 < world_.size()) {
      if (const Status ok = look(); !ok) {
        fail(ok.error());
        return ok.error();
      }
      if (toldToEnd() != 0) {
        endEarly(bar);
      }
      if (!said_ && open_ > 0 && std::chrono::steady_clock::now() - start > kSayHowToGoOn) {
        bar.say(
            fmt::format("{}should this be interrupted, the same command with --resume goes on", cellsText()));
        said_ = true;
      }
      bar.update(std::min(share_, 1.0), note());
    }
    queue_.close();
    add(effort_.stats, threads.join());
    return done_;
  }

 private:
  // Takes over the parts that are already baked and queues those that are missing.
  void begin(std::span<const std::uint64_t> known) {
    known_.insert(known.begin(), known.end());
    open_ = 1;
    effort_.processes = static_cast<std::uint32_t>(world_.size());
    effort_.threads = threads_;
    queue_.add(0, missingOf({bake_.firstPart()}));
    checks_known_ = !known_.empty();
  }

  // Takes over those of the parts and of what is below them that are already baked. Returns the missing ones,
  // in order.
  std::vector<PartTask> missingOf(const std::vector<PartTask>& parts) {
    std::vector<PartTask> missing, next(parts.rbegin(), parts.rend());
    while (!next.empty()) {
      const PartTask task = next.back();
      next.pop_back();
      const std::optional<BakedPart> part =
          known_.erase(task.id) > 0 ? checkpoint_.read(task.id) : std::nullopt;
      if (!part || !bake_.isPart(task.id, *part)) {
        missing.push_back(task);
        continue;
      }
      const std::vector<PartTask> below = bake_.partsBelow(*part);
      next.insert(next.end(), below.rbegin(), below.rend());
      count(*part);
      effort_.parts_before += 1;
    }
    return missing;
  }

  // Handles what threads and other processes have done since the last call.
  Status look() {
    for (const FinishedPart& finished : queue_.finished(world_.size() > 1 ? kLook : kPatience)) {
      const std::vector<PartTask> below =
          checks_known_ ? bake_.partsBelow(finished.bytes) : std::vector<PartTask>{};
      if (const Status ok = keep(finished); !ok) {
        return ok;
      }
      queue_.add(0, missingOf(below));
    }
    if (const std::optional<std::string> failure = queue_.failure()) {
      return Error{*failure};
    }
    while (const std::optional<MpiWorld::Message> message = world_.receive()) {
      if (const Status ok = answer(*message); !ok) {
        return ok;
      }
    }
    handOut();
    return Success{};
  }

  // Answers the processes that have asked for parts: with parts, or that no more will come. Parts to begin
  // later are given away only while there are more than everybody could begin now, so that no process keeps
  // one that another is waiting for.
  void handOut() {
    for (int other = 1; other < world_.size(); ++other) {
      give(other, wantedBy(other).now);
    }
    for (int other = 1; other < world_.size(); ++other) {
      Wanted& wanted = wantedBy(other);
      if (wanted.ahead > 0 && queue_.waiting() > takers_) {
        give(other, wanted.ahead);
      }
      if (open_ == 0 && wanted.now + wanted.ahead > 0) {
        world_.send(other, kParts, {});
        wanted = {};
      }
    }
  }

  // Sends up to so many parts, if there are any, and then sets the number to 0: the process asks again.
  void give(int other, std::uint64_t& wanted) {
    const std::vector<PartTask> tasks = queue_.takeNow(takerOf(other), wanted);
    if (tasks.empty()) {
      return;
    }
    MessageWriter message;
    for (const PartTask& task : tasks) {
      message.number(task.id).number(std::bit_cast<std::uint64_t>(task.search_distance));
      message.block(task.seen);
    }
    if (!world_.send(other, kParts, message.bytes())) {
      queue_.fail("what cells see takes more than 2 GiB; bake in one process");
    }
    wanted = 0;
  }

  // Parts to begin at once, and to have ready when one is finished.
  struct Wanted {
    std::uint64_t now = 0, ahead = 0;
  };
  Wanted& wantedBy(int other) { return wanted_[static_cast<std::size_t>(other)]; }

  std::uint32_t takerOf(int other) const { return threads_ + static_cast<std::uint32_t>(other) - 1; }

  Status answer(const MpiWorld::Message& message) {
    MessageReader reader(message.bytes);
    if (message.tag == kFailed) {
      return Error{reader.text()};
    }
    if (message.tag == kDone) {
      const std::uint64_t id = reader.number();
      const FinishedPart part{id, BakedPart(reader.rest().begin(), reader.rest().end())};
      const std::vector<PartTask> below = bake_.partsBelow(part.bytes);
      if (const Status ok = keep(part); !ok) {
        return ok;
      }
      queue_.add(takerOf(message.from), missingOf(below));
    }
    if (message.tag == kWant) {
      Wanted& wanted = wantedBy(message.from);
      wanted.now = reader.number();
      wanted.ahead = reader.number();
    }
    if (message.tag == kTotals) {
      BakeStats stats;
      stats.samples = reader.number();
      stats.shadows = reader.number();
      stats.forgotten = reader.number();
      stats.max_sample_bytes = reader.number();
      stats.questions = reader.number();
      stats.asked = reader.number();
      const std::uint64_t peak = reader.number();
      add(effort_.stats, stats);
      effort_.peak_bytes = std::max(effort_.peak_bytes, peak);
      effort_.all_peak_bytes += peak;
      totals_ += 1;
    }
    return Success{};
  }

  Status keep(const FinishedPart& finished) {
    if (const Status ok = checkpoint_.append(finished.id, finished.bytes); !ok) {
      return ok;
    }
    count(finished.bytes);
    return Success{};
  }

  void count(const BakedPart& part) {
    const PartSummary summary = bake_.summaryOf(part);
    open_ += summary.leaves == 0 ? 8 : 0;  // a part without leaves was divided
    open_ -= 1;
    done_ += 1;
    leaves_ += summary.leaves;
    triangles_ += summary.mean_triangles * summary.leaves;
    share_ += summary.share;
  }

  // How many cells the bake has, as the beginning of a line.
  std::string cellsText() const {
    const std::optional<std::uint64_t> cells = bake_.maxCells();
    return cells ? fmt::format("viewers are in {} cells at most; ", *cells)
                 : fmt::format("viewers may be in more than {} cells; ", Bake::kMaxCounted);
  }

  std::string note() const {
    return leaves_ == 0 ? std::string()
                        : fmt::format("{} cells, {:.0f} triangles a set", leaves_,
                                      triangles_ / static_cast<double>(leaves_));
  }

  // Aborts, since other processes may be in the middle of a message and cannot be ended otherwise.
  void fail(const Error& error) {
    if (world_.size() > 1) {
      printNote("{}", error.message);
      world_.abort(kBadUsage);
    }
  }

  [[noreturn]] void endEarly(ProgressBar& bar) {
    endInterrupted(bar, checkpoint_, done_, done_ + open_,
                   fmt::format(", {:.1f} % of the viewers' space", 100.0 * std::min(share_, 1.0)));
  }

  const Bake& bake_;
  MpiWorld& world_;
  std::uint32_t threads_;
  Checkpoint& checkpoint_;
  std::set<std::uint64_t> known_;  // baked before, and not yet counted: the part above them was lost
  bool checks_known_ = false;      // whether there are such, so that the threads must not queue them
  BakeEffort& effort_;
  std::uint32_t takers_;  // the threads of this process, and the other processes
  PartQueue queue_;
  std::vector<Wanted> wanted_;  // by process
  std::uint64_t done_ = 0;      // parts that are baked, now or before
  std::uint64_t open_ = 0;      // parts that are known and not yet baked
  std::uint64_t leaves_ = 0;
  double triangles_ = 0.0;  // sum over all sets
  double share_ = 0.0;      // the share of the viewers' space that is baked
  int totals_ = 0;          // processes that are done
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

void endInterrupted(ProgressBar& bar, Checkpoint& checkpoint, std::uint64_t done, std::uint64_t known,
                    std::string_view share) {
  const bool kept = checkpoint.flush().has_value();
  bar.say(fmt::format(
      "interrupted; {} of the {} parts known so far are {}{}; the same command with --resume goes on", done,
      known, kept ? "kept" : "kept, as far as they could be written", share));
  std::_Exit(interruptedExitCode());  // threads may be in the middle of parts and cannot be joined
}

Result<std::uint64_t> bakeAsFirst(const Bake& bake, MpiWorld& world, std::uint32_t threads,
                                  Checkpoint& checkpoint, std::span<const std::uint64_t> known,
                                  BakeEffort& effort) {
  return FirstBaker(bake, world, threads, checkpoint, effort).run(known);
}

void bakeAsOther(const Bake& bake, MpiWorld& world, std::uint32_t threads) {
  PartQueue queue(threads);
  BakeThreads bakers(bake, queue, threads, false);
  // Each thread has a part to begin when it has finished one, since asking takes some milliseconds.
  const std::uint32_t wanted = 2 * threads;
  std::uint32_t out = 0;  // parts that this process has received and not sent back
  // How many these were when it asked for more; none since the last answer.
  std::optional<std::uint32_t> told;
  bool more = true;
  while (more || out > 0) {
    for (const FinishedPart& finished : queue.finished(kLook)) {
      MessageWriter done;
      if (!world.send(0, kDone, done.number(finished.id).rest(finished.bytes).bytes())) {
        queue.fail("a part takes more than 2 GiB; bake with a larger --depth or in one process");
      }
      out -= 1;
    }
    if (const std::optional<std::string> failure = queue.failure()) {
      world.send(0, kFailed, MessageWriter().text(*failure).bytes());
      world.wait();  // until the first process ends all
    }
    if (more && out < wanted && told != out) {
      told = out;
      const std::uint32_t now = threads - std::min(threads, out);
      MessageWriter want;
      world.send(0, kWant, want.number(now).number(wanted - out - now).bytes());
    }
    while (const std::optional<MpiWorld::Message> message = world.receive()) {
      MessageReader reader(message->bytes);
      std::uint32_t given = 0;
      for (; !reader.rest().empty(); ++given) {
        PartTask part{.id = reader.number()};
        part.search_distance = std::bit_cast<double>(reader.number());
        const std::span<const std::byte> seen = reader.block();
        part.seen.assign(seen.begin(), seen.end());
        queue.add(given % threads, std::span(&part, 1));
      }
      more = given > 0;
      out += given;
      told.reset();
    }
  }
  queue.close();
  const BakeStats stats = bakers.join();
  MessageWriter totals;
  totals.number(stats.samples).number(stats.shadows).number(stats.forgotten).number(stats.max_sample_bytes);
  totals.number(stats.questions).number(stats.asked);
  world.send(0, kTotals, totals.number(peakBytes()).bytes());
}

std::uint64_t peakBytes() {
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace sightline::tool
