#pragma once

// Compares JSON that the tool wrote with docs/formats.md: every key must be named where its form is
// described.

#include <gtest/gtest.h>

#include <initializer_list>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>

#include "tests/tool/run_tool.h"

namespace sightline::tool_test {

// The words in `backticks` below a heading, down to the next heading of its level. Fails if there is no such
// heading.
inline std::set<std::string> wordsOfSection(const std::string& heading) {
  const std::string page = "\n" + contents(SIGHTLINE_SOURCE_DIR "/docs/formats.md") + "\n## ";
  const std::size_t begin = page.find("\n" + heading + "\n");
  if (begin == std::string::npos) {
    ADD_FAILURE() << "docs/formats.md has no heading '" << heading << "'";
    return {};
  }
  const std::string mark = "\n" + heading.substr(0, heading.find(' ') + 1);
  const std::size_t end = std::min(page.find(mark, begin + 1), page.find("\n## ", begin + 1));
  const std::string section = page.substr(begin, end - begin);
  std::set<std::string> words;
  const std::regex code("`([^`\n]+)`");
  for (std::sregex_iterator match(section.begin(), section.end(), code); match != std::sregex_iterator();
       ++match) {
    words.insert((*match)[1]);
  }
  return words;
}

// Objects that several forms have, and where their keys are described.
inline const std::map<std::string, std::string>& sharedObjects() {
  static const std::map<std::string, std::string> kShared{{"scene", "### scene"},
                                                          {"options", "### options of a method"},
                                                          {"chosen", "### what auto chose"},
                                                          {"sets", "### statistics of a method"},
                                                          {"map", "### statistics of a method"},
                                                          {"relations", "### statistics of a method"},
                                                          {"surfaces", "### statistics of a method"},
                                                          {"detail", "### statistics of a method"},
                                                          {"renderer", "### statistics of a method"},
                                                          {"database", "### databases"},
                                                          {"detail_database", "### databases"},
                                                          {"viewpoints", "### databases"},
                                                          {"difference", "### difference"}};
  return kShared;
}

inline void expectDocumented(const nlohmann::json& json, const std::set<std::string>& words,
                             const std::string& where) {
  if (json.is_array()) {
    for (const nlohmann::json& item : json) {
      expectDocumented(item, words, where);
    }
  }
  if (!json.is_object()) {
    return;
  }
  for (const auto& [key, value] : json.items()) {
    const auto shared = sharedObjects().find(key);
    std::set<std::string> below = words;
    if (shared != sharedObjects().end() && value.is_object()) {
      below.merge(wordsOfSection(shared->second));
    }
    EXPECT_TRUE(below.contains(key)) << "docs/formats.md does not describe " << where << "." << key;
    expectDocumented(value, below, where + "." + key);
  }
}

// Expects that every key is described below these headings (given without "## "), which describe the form
// together.
inline void expectDocumented(const nlohmann::json& json, std::initializer_list<std::string> headings) {
  ASSERT_TRUE(json.is_object());
  std::set<std::string> words;
  std::string where;
  for (const std::string& heading : headings) {
    words.merge(wordsOfSection("## " + heading));
    where += (where.empty() ? "" : " + ") + heading;
  }
  expectDocumented(json, words, where);
}

}  // namespace sightline::tool_test
