// What the repository promises its readers: nothing unfinished, nothing huge, and documents that are true.

#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/repository/source_tree.h"

namespace sightline::repository {
namespace {

std::vector<std::string> documents() {
  std::vector<std::string> files;
  for (const std::string& file : projectFiles()) {
    if (std::filesystem::path(file).extension() == ".md") {
      files.push_back(file);
    }
  }
  return files;
}

std::vector<std::smatch> allMatches(const std::string& text, const std::regex& pattern) {
  return {std::sregex_iterator(text.begin(), text.end(), pattern), std::sregex_iterator()};
}

TEST(Repository, NoFileHoldsAMarkOfUnfinishedWork) {
  // The text is in two parts, so that this file does not contain it.
  const std::vector<std::string> marks{std::string("TO") + "DO", std::string("FIX") + "ME"};
  for (const std::string& file : projectFiles()) {
    const std::string text = contentOf(file);
    for (const std::string& mark : marks) {
      EXPECT_EQ(text.find(mark), std::string::npos) << file << " holds " << mark;
    }
  }
}

// clang-tidy looks for them only in sources that are compiled alone, which most are not.
TEST(Repository, EveryUsingDeclarationAndNamespaceAliasOfASourceIsUsed) {
  const std::regex declaration(R"(using [\w:]+::(\w+);|namespace (\w+) = [\w:]+;)");
  int declarations = 0;
  for (const std::string& file : projectFiles()) {
    if (std::filesystem::path(file).extension() != ".cpp") {
      continue;
    }
    const std::string text = contentOf(file);
    for (const std::smatch& found : allMatches(text, declaration)) {
      ++declarations;
      const std::string name = found[1].matched ? found[1] : found[2];
      const std::regex use("\\b" + name + "\\b");
      EXPECT_TRUE(std::regex_search(text.cbegin(), found[0].first, use) ||
                  std::regex_search(found[0].second, text.cend(), use))
          << file << ": " << found[0];
    }
  }
  EXPECT_GT(declarations, 50);
}

TEST(Repository, NoFileIsLargerThanTwoMebibytes) {
  for (const std::string& file : projectFiles()) {
    EXPECT_LE(std::filesystem::file_size(sourceRoot() / file), 2u << 20) << file;
  }
}

// A server may have no descriptor left, and a changed root directory has no devices: what computes works
// there. The rooms of files share a header.
TEST(Repository, NoRoomButThoseOfFilesOpensOne) {
  const std::regex room_of_files(R"(src/(io|pvs)/.*|src/base/new_file\.h)");
  const std::regex opens(R"(\b(fopen|freopen|tmpfile|mkstemp) *\(|[^\w]::open *\(|<(fstream|fcntl\.h)>|)"
                         R"("src/base/new_file\.h")");
  // Windows has no stream in memory, and its null device is always there.
  const std::regex null_of_windows(R"(fopen\("NUL")");
  int files = 0;
  for (const std::string& file : projectFiles()) {
    if (file.rfind("src/", 0) != 0 || std::regex_match(file, room_of_files)) {
      continue;
    }
    ++files;
    std::istringstream text(contentOf(file));
    for (std::string line; std::getline(text, line);) {
      EXPECT_TRUE(!std::regex_search(line, opens) || std::regex_search(line, null_of_windows))
          << file << " opens a file: " << line;
    }
  }
  EXPECT_GT(files, 100);
}

// Engines replace operator new to see all memory, and are built without exceptions and run-time types.
TEST(Repository, TheRuntimeTakesMemoryFromOperatorNewAloneAndNeedsNoExceptions) {
  const std::regex runtime(
      "(include/sightline|src)/(base|math|scene|geometry|hierarchy|occluders|occlusion|culling|world)/.*");
  const std::regex other(R"(\b(malloc|calloc|realloc|mmap|aligned_alloc|posix_memalign|AllocateAligned) *\(|)"
                         R"(\b(throw|dynamic_cast|typeid)\b|\btry *\{|\bcatch *\()");
  int files = 0;
  for (const std::string& file : projectFiles()) {
    if (!std::regex_match(file, runtime)) {
      continue;
    }
    ++files;
    std::istringstream text(contentOf(file));
    for (std::string line; std::getline(text, line);) {
      const std::string code = line.substr(0, line.find("//"));
      EXPECT_FALSE(std::regex_search(code, other)) << file << ": " << line;
    }
  }
  EXPECT_GT(files, 150);
}

TEST(Repository, EveryMakeCommandInTheDocumentsIsATarget) {
  std::set<std::string> targets;
  const std::string makefile = contentOf("Makefile");
  for (const std::smatch& match : allMatches(makefile, std::regex(R"((?:^|\n)([a-z][a-z-]*):)"))) {
    targets.insert(match[1]);
  }
  ASSERT_TRUE(targets.contains("demo") && targets.contains("test"));
  // In `code`, or at the beginning of a line of a code block.
  const std::regex command(R"((?:`|\n)(?:\$ )?make ([a-z][a-z-]*))");
  for (const std::string& file : documents()) {
    const std::string text = contentOf(file);
    for (const std::smatch& match : allMatches(text, command)) {
      EXPECT_TRUE(targets.contains(match[1]))
          << file << " says make " << match[1] << ", the Makefile has no such target";
    }
  }
}

// What of a document is not in code blocks, in which "[](" begins a lambda.
std::string proseOf(const std::string& file) {
  std::istringstream text(contentOf(file));
  std::string prose;
  bool in_block = false;
  for (std::string line; std::getline(text, line);) {
    in_block ^= line.starts_with("```");
    if (!in_block) {
      prose += line + '\n';
    }
  }
  return prose;
}

TEST(Repository, EveryLinkInTheDocumentsLeadsToAFile) {
  const std::regex link(R"(\]\(([^)#\s]+)[^)]*\))");
  for (const std::string& file : documents()) {
    const std::string text = proseOf(file);
    for (const std::smatch& match : allMatches(text, link)) {
      const std::string target = match[1];
      if (target.find("://") != std::string::npos || target.rfind("mailto:", 0) == 0) {
        continue;
      }
      const std::filesystem::path folder = std::filesystem::path(file).parent_path();
      EXPECT_TRUE(std::filesystem::exists(sourceRoot() / folder / target)) << file << " links to " << target;
    }
  }
}

TEST(Repository, TheReadmesCodeIsPartOfTheExampleThatIsCompiled) {
  const std::string readme = contentOf("README.md");
  const std::string fence = "```cpp\n";
  const std::size_t begin = readme.find(fence);
  ASSERT_NE(begin, std::string::npos) << "README.md shows no C++";
  const std::size_t end = readme.find("```", begin + fence.size());
  ASSERT_NE(end, std::string::npos);
  const std::string code = readme.substr(begin + fence.size(), end - begin - fence.size());
  EXPECT_NE(contentOf("examples/cull_a_frame.cpp").find(code), std::string::npos)
      << "these lines are not in examples/cull_a_frame.cpp as they stand:\n"
      << code;
}

// The members of a header's structs that have no default, as "Struct: type name".
std::vector<std::string> membersWithoutDefault(const std::string& header) {
  const std::string text = std::regex_replace(header, std::regex("//[^\n]*"), "");
  const std::regex no_member(
      R"(^\s*$|^\s*(using|friend|static|enum|struct|class|union|template)\b|\(|&\s*\w+$)");
  std::vector<std::string> members;
  for (const std::smatch& match : allMatches(text, std::regex(R"(\bstruct (\w+)[^;{()]*\{)"))) {
    int depth = 1;
    std::string statement;  // what it holds in braces left out
    for (auto at = static_cast<std::size_t>(match.position() + match.length()); depth > 0; ++at) {
      const char c = text.at(at);
      depth += c == '{' ? 1 : c == '}' ? -1 : 0;
      if (c == '}' && depth == 1) {
        statement += "{}";
        const char next = text.at(text.find_first_not_of(" \n", at + 1));
        if (next != ';' && next != ',') {
          statement.clear();  // of a function
        }
      } else if (c == ':' && std::regex_match(statement, std::regex(R"(\s*(public|private|protected))"))) {
        statement.clear();
      } else if (depth == 1 && c != ';') {
        statement += c;
      } else if (depth == 1) {
        const bool is_member = !std::regex_search(statement, no_member);
        // Commas of template arguments separate nothing.
        for (std::string last; last != statement;) {
          last = statement;
          statement = std::regex_replace(statement, std::regex("<[^<>]*>"), "");
        }
        std::string::size_type begin = 0;
        while (is_member && begin <= statement.size()) {
          const std::size_t end = std::min(statement.find(',', begin), statement.size());
          const std::string declarator = statement.substr(begin, end - begin);
          if (declarator.find_first_of("={") == std::string::npos) {
            members.push_back(match[1].str() + ": " +
                              std::regex_replace(declarator, std::regex(R"(^\s+|\s+$)"), ""));
          }
          begin = end + 1;
        }
        statement.clear();
      }
    }
  }
  return members;
}

TEST(Repository, MembersWithoutDefaultAreFound) {
  const std::string header =
      "struct A : B {\n  int a, b = 2;  // of c;\n  std::map<int, int> d{1, 2}, e;\n  int f() const { return "
      "a; }\n"
      "  struct C {\n    int g = 1;\n  };\n  C h{};\n  static int s;\n\n private:\n  int i;\n};\n";
  EXPECT_EQ(membersWithoutDefault(header), (std::vector<std::string>{"A: int a", "A: e", "A: int i"}));
}

// So that designated initialisers may leave any of them out, without a warning in anybody's project.
TEST(Repository, EveryMemberOfAPublicStructHasADefault) {
  for (const std::string& file : projectFiles()) {
    if (file.rfind("include/", 0) == 0) {
      EXPECT_EQ(membersWithoutDefault(contentOf(file)), std::vector<std::string>()) << file;
    }
  }
}

// What comes behind the parameters of each lambda of a text, up to its body.
std::vector<std::string> lambdaSpecifiers(const std::string& text) {
  std::vector<std::string> specifiers;
  // A subscript follows a name or a bracket, a capture list does not.
  for (const std::smatch& match : allMatches(text, std::regex(R"([\s(,={&|]\[[^\[\]]*\]\s*(?=[({]))"))) {
    auto at = static_cast<std::size_t>(match.position() + match.length());
    int depth = 0;
    do {
      depth += text[at] == '(' ? 1 : text[at] == ')' ? -1 : 0;
      at += text[at] == '{' && depth == 0 ? 0 : 1;
    } while (depth > 0 && at < text.size());
    specifiers.push_back(text.substr(at, text.find('{', at) - at));
  }
  return specifiers;
}

TEST(Repository, LambdaSpecifiersAreFoundWhateverTheParametersHold) {
  EXPECT_EQ(lambdaSpecifiers("f(a[i], [&](int v[2], auto (*g)(int)) KIND -> int { return v[0]; });\n"
                             "const auto h = [this, x] { return x[1](y); };\nint k[] = {1};"),
            (std::vector<std::string>{" KIND -> int ", ""}));
}

// A lambda does not inherit the instruction set of the function around it.
TEST(Repository, EveryLambdaInAHighwayKernelIsCompiledForTheKernelsInstructionSet) {
  std::size_t kernels = 0;
  for (const std::string& file : projectFiles()) {
    const std::string extension = std::filesystem::path(file).extension();
    const std::string text = extension == ".cpp" || extension == ".h" ? contentOf(file) : "";
    const std::string begin_mark = "\nHWY_BEFORE_NAMESPACE();";
    const std::size_t begin = text.find(begin_mark);
    if (begin == std::string::npos) {
      continue;
    }
    ++kernels;
    const std::string kernel = text.substr(begin, text.find("\nHWY_AFTER_NAMESPACE();") - begin);
    for (const std::string& specifiers : lambdaSpecifiers(kernel)) {
      EXPECT_NE(specifiers.find("HWY_ATTR"), std::string::npos)
          << file << ": a lambda between HWY_BEFORE_NAMESPACE and HWY_AFTER_NAMESPACE lacks HWY_ATTR";
    }
  }
  EXPECT_GT(kernels, 5u);
}

}  // namespace
}  // namespace sightline::repository
