#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "sightline/base/result.h"

namespace sightline::tool {

using Json = nlohmann::ordered_json;

// The JSON on one line, keys in the order of insertion. Text that is not UTF-8 is replaced, not refused.
std::string dump(const Json& json);

// The object `head` with one more key: a list of items that are JSON texts, one on each line. Joining long
// lists as text needs a tenth of the memory.
std::string dumpWithList(const Json& head, const std::string& key, const std::vector<std::string>& items);

// Writes the text to the file, to standard output if target is "-", or nowhere if it is "". If the process is
// told to end meanwhile, it still writes everything.
Status writeOutput(const std::string& target, const std::string& text);

}  // namespace sightline::tool
