#include "src/io/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <mutex>
#include <new>

#include "src/base/new_file.h"
#include "src/io/failure.h"

namespace sightline::io {
namespace {

using std::chrono::steady_clock;

constexpr int kThrew = 3, kOutOfMemory = 4;  // exit codes of the child
constexpr std::uint64_t kMebibyte = 1024 * 1024;

// The address space that this process has, in bytes; 0 if unknown.
std::uint64_t addressSpace() {
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE));
}

void limit(__rlimit_resource resource, std::uint64_t most) {
  struct rlimit known {};
  ::getrlimit(resource, &known);
  const rlim_t wanted = std::min<rlim_t>(most, known.rlim_max);
  const struct rlimit limits { wanted, wanted };
  ::setrlimit(resource, &limits);
}

void limitChild(const ChildLimits& limits, std::uint64_t address_space) {
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, limits.seconds);
  limit(RLIMIT_AS, address_space + limits.memory_bytes);
}

// No handler of this process may run in the child. What is ignored stays so.
void resetHandlers() {
  for (int signal = 1; signal < NSIG; ++signal) {
    struct sigaction known {};
    if (::sigaction(signal, nullptr, &known) == 0 && known.sa_handler != SIG_IGN) {
      std::signal(signal, SIG_DFL);
    }
  }
}

// The child has no output, is ended by signals as any program is, and ends with its parent.
void detachChild(pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) {
    ::_exit(kThrew);
  }
  resetHandlers();
  const int nothing = ::open("/dev/null", O_RDWR);
  for (const int descriptor : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    ::dup2(nothing, descriptor);
  }
}

[[noreturn]] void runChild(const std::function<std::vector<std::byte>()>& work, int descriptor) {
  try {
    if (!base::writeAll(descriptor, work())) {
      ::_exit(kThrew);
    }
  } catch (const std::bad_alloc&) {
    ::_exit(kOutOfMemory);
  } catch (...) {
    ::_exit(kThrew);
  }
  ::_exit(0);
}

// Reads until the child closes its end. Returns false if the time is over before.
bool readAll(int descriptor, steady_clock::time_point until, std::vector<std::byte>& bytes) {
  std::array<std::byte, 65536> chunk{};
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(until - steady_clock::now());
    struct pollfd ready {
      descriptor, POLLIN, 0
    };
    const int events =
        ::poll(&ready, 1, static_cast<int>(std::clamp<std::int64_t>(left.count(), 0, 1'000'000)));
    // One poll waits for 1000 s at most, which may be less than what is left.
    if ((events < 0 && errno == EINTR) || (events == 0 && steady_clock::now() < until)) {
      continue;
    }
    if (events <= 0) {
      return false;
    }
    const ssize_t count = ::read(descriptor, chunk.data(), chunk.size());
    if (count > 0) {
      bytes.insert(bytes.end(), chunk.begin(), chunk.begin() + count);
    } else if (count == 0 || errno != EINTR) {
      return true;
    }
  }
}

// A child that is killed and waited for at the end, unless it was waited for before.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  ~Child() {
    if (id_ > 0) {
      kill();
      wait();
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  void kill() const { ::kill(id_, SIGKILL); }
  // Returns how it ended.
  int wait() {
    int status = 0;
    while (::waitpid(id_, &status, 0) < 0 && errno == EINTR) {
    }
    id_ = 0;
    return status;
  }

 private:
  pid_t id_;
};

// A pipe whose ends are closed at the end.
class Pipe {
 public:
  Pipe() = default;
  ~Pipe() {
    closeReadEnd();
    closeWriteEnd();
  }
  Pipe(const Pipe&) = delete;
  Pipe& operator=(const Pipe&) = delete;

  // Returns false, and sets errno, if there is none.
  bool open() {
    return ::pipe2(ends_.data(), O_CLOEXEC) == 0 && moveFromStandard(ends_[0]) && moveFromStandard(ends_[1]);
  }
  int readEnd() const { return ends_[0]; }
  int writeEnd() const { return ends_[1]; }
  void closeReadEnd() { close(ends_[0]); }
  void closeWriteEnd() { close(ends_[1]); }

 private:
  // Where this process has closed its standard descriptors, a pipe gets their numbers, which the child needs.
  static bool moveFromStandard(int& end) {
    if (end <= STDERR_FILENO) {
      const int moved = ::fcntl(end, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
      if (moved < 0) {
        return false;
      }
      ::close(end);
      end = moved;
    }
    return true;
  }
  static void close(int& end) {
    if (end >= 0) {
      ::close(end);
      end = -1;
    }
  }

  std::array<int, 2> ends_{-1, -1};
};

// Held while a pipe's write end is open here. A child made by another thread meanwhile would have that end
// too, and what is read from the pipe would not end before that child does.
std::mutex& startMutex() {
  static std::mutex mutex;
  return mutex;
}

// What went wrong in a child that ended in this way.
Error endingOf(int status, bool in_time, const ChildLimits& limits) {
  const std::uint64_t mebibytes = limits.memory_bytes / kMebibyte;
  // Some systems kill where the time is over, others signal it; where memory is short, all kill.
  if (!in_time || (WIFSIGNALED(status) && (WTERMSIG(status) == SIGXCPU || WTERMSIG(status) == SIGKILL))) {
    return failure("its reader was ended: it took more than {} s, or more memory than there is",
                   limits.seconds);
  }
  if (WIFSIGNALED(status)) {
    return failure("its reader crashed ({}); the file is damaged, or needs more than {} MiB",
                   ::strsignal(WTERMSIG(status)), mebibytes);
  }
  if (WEXITSTATUS(status) == kOutOfMemory) {
    return failure("its reader needs more than {} MiB", mebibytes);
  }
  return failure("its reader failed");
}

}  // namespace

Result<std::vector<std::byte>> runInChild(const ChildLimits& limits,
                                          const std::function<std::vector<std::byte>()>& work) {
  const pid_t parent = ::getpid();
  const std::uint64_t address_space = addressSpace();
  Pipe pipe;
  std::unique_lock<std::mutex> start(startMutex());
  if (!pipe.open()) {
    return failure("its reader could not be started: {}", std::strerror(errno));
  }
  // Signals wait until the child has reset their handlers.
  sigset_t all, before;
  sigfillset(&all);
  ::pthread_sigmask(SIG_SETMASK, &all, &before);
  const pid_t id = ::fork();
  if (id == 0) {
    start.unlock();
    detachChild(parent);
    ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
    limitChild(limits, address_space);
    runChild(work, pipe.writeEnd());
  }
  const int reason = errno;
  ::pthread_sigmask(SIG_SETMASK, &before, nullptr);
  pipe.closeWriteEnd();
  start.unlock();
  if (id < 0) {
    return failure("its reader could not be started: {}", std::strerror(reason));
  }
  Child child(id);
  std::vector<std::byte> bytes;
  const auto until = steady_clock::now() + std::chrono::seconds(10ull * limits.seconds);
  const bool in_time = readAll(pipe.readEnd(), until, bytes);
  if (!in_time) {
    child.kill();
  }
  pipe.closeReadEnd();
  const int status = child.wait();
  if (!in_time || !WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    return endingOf(status, in_time, limits);
  }
  return bytes;
}

}  // namespace sightline::io
