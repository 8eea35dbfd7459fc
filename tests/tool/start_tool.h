#pragma once

// Starts the built tool beside the test: alone or in several processes, to be killed at any moment.

#include <fcntl.h>
#include <signal.h>

#include <cstdlib>
#include <optional>

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {

// A program that runs until it ends, is killed, or this is destroyed.
class Started {
 public:
  explicit Started(const std::vector<std::string>& words) {
    std::vector<char*> argv;
    for (const std::string& word : words) {
      argv.push_back(const_cast<char*>(word.c_str()));
    }
    argv.push_back(nullptr);
    const std::string out = folder_.file("out"), err = folder_.file("err");
    pid_ = fork();
    if (pid_ == 0) {
      // A shell starts what runs in the background with SIGINT ignored, tests too, and the tool keeps to
      // that.
      ::signal(SIGINT, SIG_DFL);
      dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
      dup2(open(out.c_str(), O_WRONLY | O_CREAT, 0600), STDOUT_FILENO);
      dup2(open(err.c_str(), O_WRONLY | O_CREAT, 0600), STDERR_FILENO);
      execvp(argv[0], argv.data());
      _exit(127);
    }
  }
  ~Started() {
    if (running()) {
      ::kill(pid_, SIGKILL);
      waitpid(pid_, &status_, 0);
    }
  }
  Started(const Started&) = delete;
  Started& operator=(const Started&) = delete;

  pid_t pid() const { return pid_; }
  bool running() {
    if (!ended_ && waitpid(pid_, &status_, WNOHANG) == pid_) {
      ended_ = true;
    }
    return !ended_;
  }
  void kill(int signal) {
    if (running()) {
      ::kill(pid_, signal);
    }
  }
  // Waits for the end. The code is -1 if a signal ended the program.
  Outcome wait() {
    if (!ended_) {
      waitpid(pid_, &status_, 0);
      ended_ = true;
    }
    return {WIFEXITED(status_) ? WEXITSTATUS(status_) : -1, contents(folder_.file("out")),
            contents(folder_.file("err"))};
  }
  // The processes that the program started.
  std::vector<pid_t> children() const {
    std::vector<pid_t> found;
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
      const std::string name = entry.path().filename().string();
      if (name.find_first_not_of("0123456789") != std::string::npos) {
        continue;
      }
      // The line is "pid (name) state parent ...", where the name may contain anything.
      const std::string stat = contents(entry.path().string() + "/stat");
      const std::size_t after = stat.rfind(')');
      char state = 0;
      int parent = 0;
      if (after != std::string::npos && std::sscanf(stat.c_str() + after, ") %c %d", &state, &parent) == 2 &&
          parent == pid_ && state != 'Z') {
        found.push_back(std::stoi(name));
      }
    }
    return found;
  }

 private:
  TemporaryFolder folder_;
  pid_t pid_ = -1;
  int status_ = 0;
  bool ended_ = false;
};

// The words that start the tool with this number of processes, followed by its arguments; 0: without mpirun.
inline std::vector<std::string> toolWords(int processes, const std::vector<std::string>& arguments) {
  std::vector<std::string> words;
  if (processes > 0) {
    // mpirun must also work as root, with fewer cores, and where processes may not read each other's memory.
    setenv("OMPI_ALLOW_RUN_AS_ROOT", "1", 1);
    setenv("OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "1", 1);
    setenv("OMPI_MCA_rmaps_base_oversubscribe", "1", 1);
    setenv("OMPI_MCA_btl_vader_single_copy_mechanism", "none", 1);
    setenv("ASAN_OPTIONS", "detect_leaks=0", 1);  // the MPI library leaks
    words = {"mpirun", "-n", std::to_string(processes), "--bind-to", "none"};
  }
  words.push_back(toolFile());
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

// scripts/setup installs it. Who sets SIGHTLINE_NO_SETUP may have built against an MPI whose launcher is not
// at hand; there is then nothing to start several processes with.
inline constexpr const char* kNoMpirun = "mpirun cannot be run (scripts/setup installs openmpi-bin)";

inline bool haveMpirun() {
  return Started({"mpirun", "--version"}).wait().code == 0;
}

}  // namespace sightline::tool_test
