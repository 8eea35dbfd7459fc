#pragma once

#include <string>
#include <vector>

#include "sightline/base/result.h"
#include "tools/sightline/methods/method_options.h"

namespace sightline::tool {

// One line, keys in the order of insertion; text that is no UTF-8 is replaced, not refused.
std::string dump(const Json& json);

// The object `head` with one more key, a list of items that are JSON already, one a line. Long lists are put
// together so, as text, to need a tenth of the memory.
std::string dumpWithList(const Json& head, const std::string& key, const std::vector<std::string>& items);

// To the file, or to standard output for "-"; nothing for "". Told to end meanwhile, the process writes all
// of it and goes on.
Status writeOutput(const std::string& target, const std::string& text);

}  // namespace sightline::tool
