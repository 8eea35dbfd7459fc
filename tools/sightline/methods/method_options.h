#pragma once

// The command line's options of culling methods, as text.

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "sightline/base/result.h"
#include "tools/sightline/command_line/json_output.h"
#include "tools/sightline/methods/setting.h"

namespace CLI {
class App;
}

namespace sightline::tool {

struct MethodChoice;

// The options as text, one element per option; several values are separated by commas.
struct MethodOptions {
  MethodOptions();  // the library's defaults

  // Changes the default of an option; name: without "--". Precondition: there is such an option.
  void setDefault(std::string_view name, const std::string& text);

  std::vector<std::string> texts;
  std::vector<std::string> defaults;  // texts that the user has not given
  std::vector<bool> given;            // whether the user has, be it the default
  std::string baked;                  // a .sight file; empty: none
  std::string closed;                 // closed doors of the baked file (closedDoors); empty: none
  std::string prepared;               // a PreparedFile; empty: none
  double crack_width = 0.0;           // metres
  std::uint32_t clusters = 0;         // triangles of a cluster (addClustersOption); 0: objects stay whole
};
void addMethodOptions(CLI::App& command, MethodOptions& options, bool lists);

// Returns all combinations of the options' values, in the order of the lists. A method is combined only with
// the options that it has. Names on stderr the given options that no method has. Returns an error if a
// combination needs a baked file and there is none. --method auto stands for what was chosen; what the user
// gave wins over it. Before there is a choice, null only checks the options: auto stands for some method.
Result<std::vector<Setting>> settingsOf(const MethodOptions& options,
                                        const std::shared_ptr<const MethodChoice>& choice = nullptr);
// Whether --method auto is among the methods.
bool asksForChoice(const MethodOptions& options);

// Returns a text for people: "FME, 64 occluders, bvh, coherence on", followed by what differs from the
// defaults.
std::string optionsText(const Setting& setting);
Json optionsJson(const Setting& setting);

}  // namespace sightline::tool
