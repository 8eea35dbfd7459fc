#include "src/io/obj/obj_libraries.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>
#include <string_view>

#include "src/io/obj/obj_lines.h"

namespace sightline::io {
namespace {

namespace fs = std::filesystem;

std::string_view withoutQuotes(std::string_view name) {
  return name.size() >= 2 && name.front() == '"' && name.back() == '"' ? name.substr(1, name.size() - 2)
                                                                       : name;
}

class Finder {
 public:
  explicit Finder(const std::string& folder) : folder_(folder) {}

  void addStatement(std::string_view value) {
    // The longest first: a name may have anything in it.
    for (const std::string_view whole : {value, nameWithoutComment(value)}) {
      if (addIfThere(whole)) {
        return;
      }
    }
    addNames(nameWithoutComment(value));
  }

  ObjLibraries take() { return std::move(found_); }

 private:
  // Each name up to a word that ends like one; failing that, each word.
  void addNames(std::string_view names) {
    while (!names.empty()) {
      std::string_view rest = names;
      std::string_view word;
      do {
        word = takeWord(rest);
      } while (!word.empty() && !endsLikeName(word));
      const std::string_view name = trimmed(names.substr(0, names.size() - rest.size()));
      if (!name.empty() && !addIfThere(name)) {
        addWords(name);
      }
      names = rest;
    }
  }

  void addWords(std::string_view name) {
    bool any = false;
    std::string_view rest = name;
    for (std::string_view word = takeWord(rest); !word.empty(); word = takeWord(rest)) {
      any = addIfThere(word) || any;
    }
    if (!any && missing_.emplace(withoutQuotes(name)).second) {
      found_.missing.emplace_back(withoutQuotes(name));
    }
  }

  static bool endsLikeName(std::string_view word) {
    constexpr std::string_view kEnd = ".mtl";
    word = word.ends_with('"') ? word.substr(0, word.size() - 1) : word;
    return word.size() >= kEnd.size() && isKeyword(word.substr(word.size() - kEnd.size()), kEnd);
  }

  // Devices and pipes, which might never end, are no files here.
  bool addIfThere(std::string_view name) {
    const std::string file = fileNamedInObj(std::string(withoutQuotes(name)), folder_);
    const auto before = names_.find(file);
    if (before != names_.end() || names_.size() >= kMostNames) {
      return before != names_.end() && before->second;
    }
    const auto known = names_.emplace(file, false).first;
    std::error_code code;
    known->second = name.find('\0') == std::string_view::npos && fs::is_regular_file(file, code);
    if (known->second && files_.insert(fs::weakly_canonical(file, code)).second) {
      found_.files.push_back(file);
    }
    return known->second;
  }

  static constexpr std::size_t kMostNames = 10'000;  // that are looked up; others count as missing

  const std::string& folder_;
  std::map<std::string, bool> names_;  // whether there is such a file
  std::set<fs::path> files_;
  std::set<std::string, std::less<>> missing_;
  ObjLibraries found_;
};

}  // namespace

ObjLibraries findObjLibraries(std::span<const std::string> values, const std::string& folder) {
  Finder finder(folder);
  for (const std::string& value : values) {
    finder.addStatement(value);
  }
  return finder.take();
}

std::string fileNamedInObj(std::string name, const std::string& folder) {
  std::replace(name.begin(), name.end(), '\\', '/');
  return (fs::path(folder) / name).string();
}

}  // namespace sightline::io
