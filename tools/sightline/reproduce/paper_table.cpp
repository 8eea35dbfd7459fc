#include "tools/sightline/reproduce/paper_table.h"

#include <algorithm>

#include "tools/sightline/reproduce/papers.h"

namespace sightline::tool {

const std::vector<std::pair<std::string, Paper>>& papers() {
  static const std::vector<std::pair<std::string, Paper>> kPapers{
      {"bittner",
       {"Bittner, Havran, Slavik. Hierarchical Visibility Culling with Occlusion Trees. CGI 1998.",
        {"demo:building?plants=100", "demo:city?copies=30"},
        reproduceBittner}},
      {"coorg-teller",
       {"Coorg, Teller. Real-Time Occlusion Culling for Models with Large Occluders. I3D 1997.",
        {"demo:building?plants=100", "demo:city"},
        reproduceCoorgTeller}},
      {"poon-wang",
       {"Poon, Wang. Occlusion Culling Using Minimum Occluder Set and Opacity Map. IV 1999.",
        {"demo:city"},
        reproducePoonWang}},
      {"saona-vazquez",
       {"Saona-Vazquez, Navazo, Brunet. The Visibility Octree: A Data Structure for 3D Navigation. "
        "Computers & Graphics 1999.",
        {"demo:ship"},
        reproduceSaonaVazquez,
        true,
        {"demo:ship?decks=3&rooms=4&machinery=8"}}},
      {"snyder-lengyel",
       {"Snyder, Lengyel. Visibility Sorting and Compositing for Image-Based Rendering. MSR-TR-97-11, 1997.",
        {},
        reproduceSnyderLengyel}},
  };
  return kPapers;
}

std::vector<std::string> paperNames() {
  std::vector<std::string> names;
  for (const auto& [name, paper] : papers()) {
    names.push_back(name);
  }
  return names;
}

const Paper& findPaper(const std::string& name) {
  return std::ranges::find(papers(), name, &std::pair<std::string, Paper>::first)->second;
}

}  // namespace sightline::tool
