// scripts/setup on machines of every kind, played by programs that stand before the real ones in PATH.

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdio>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "tests/repository/source_tree.h"
#include "tests/support/temporary_folder.h"

namespace sightline::repository {
namespace {

namespace fs = std::filesystem;

class Machine {
 public:
  // dpkg_query: what that program does with its arguments, in bash.
  explicit Machine(const std::string& dpkg_query) {
    write("dpkg-query", "printf '%s\\n' \"$*\" >> '" + file("queried") + "'\n" + dpkg_query);
    write("apt-get", "printf '%s\\n' \"$*\" >> '" + file("apt") + "'\n");
    // For whoever is not root: runs the command after its own options.
    write("sudo", "while [[ \"$1\" == -* ]]; do shift; done\nexec \"$@\"\n");
  }

  // The exit code of scripts/setup.
  int setUp() const {
    const std::string command = "env -u SIGHTLINE_NO_SETUP PATH='" + folder_.path().string() +
                                "':\"$PATH\" '" + (sourceRoot() / "scripts/setup").string() + "' > '" +
                                file("output") + "' 2>&1 < /dev/null";
    const int status = pclose(popen(command.c_str(), "r"));
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string output() const { return read("output"); }
  // The packages that were asked about.
  std::vector<std::string> queried() const { return packagesIn(read("queried")); }
  bool aptGetWasCalled() const { return fs::exists(file("apt")); }
  // The packages of `apt-get install`.
  std::vector<std::string> installed() const {
    std::istringstream lines(read("apt"));
    for (std::string line; std::getline(lines, line);) {
      const std::size_t install = line.find(" install ");
      if (install != std::string::npos) {
        return packagesIn(line.substr(install + std::string(" install ").size()));
      }
    }
    return {};
  }

 private:
  std::string file(const std::string& name) const { return folder_.file(name); }
  std::string read(const std::string& name) const { return test::contents(file(name)); }
  void write(const std::string& name, const std::string& script) const {
    fs::permissions(folder_.write(name, "#!/usr/bin/env bash\n" + script), fs::perms::owner_all);
  }
  // Words that are no options, nor parts of the query's format.
  static std::vector<std::string> packagesIn(const std::string& text) {
    std::vector<std::string> packages;
    std::istringstream words(text);
    for (std::string word; words >> word;) {
      if (word[0] != '-' && word.find('$') == std::string::npos) {
        packages.push_back(word);
      }
    }
    return packages;
  }

  const test::TemporaryFolder folder_;
};

const char* const kKnowsNone = "echo \"dpkg-query: no packages found matching $3\" >&2\nexit 1\n";
const char* const kAllInstalled =
    "for package in \"$@\"; do [[ $package == -* ]] || echo \"installed $package\"; done\n";

TEST(Setup, InstallsAllWhereNoPackageWasEverKnown) {
  const Machine machine(kKnowsNone);
  EXPECT_EQ(machine.setUp(), 0) << machine.output();
  EXPECT_GT(machine.queried().size(), 10u);
  EXPECT_EQ(machine.installed(), machine.queried()) << machine.output();
}

TEST(Setup, CallsNoAptGetWhereAllIsInstalled) {
  const Machine machine(kAllInstalled);
  EXPECT_EQ(machine.setUp(), 0) << machine.output();
  EXPECT_GT(machine.queried().size(), 10u);
  EXPECT_FALSE(machine.aptGetWasCalled()) << machine.output();
}

TEST(Setup, InstallsOnlyWhatIsMissingOrWasRemoved) {
  const Machine machine(
      "for package in \"$@\"; do\n"
      "  case $package in\n"
      "    -* | cmake) ;;\n"
      "    ccache) echo \"not-installed $package\" ;;\n"
      "    *) echo \"installed $package\" ;;\n"
      "  esac\n"
      "done\n"
      "exit 1\n");
  EXPECT_EQ(machine.setUp(), 0) << machine.output();
  EXPECT_EQ(machine.installed(), (std::vector<std::string>{"cmake", "ccache"})) << machine.output();
}

}  // namespace
}  // namespace sightline::repository
