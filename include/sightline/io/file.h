#pragma once

#include <span>
#include <string>
#include <string_view>

#include "sightline/base/result.h"

namespace sightline {

// Reads a whole regular file, or the one that a symbolic link leads to; devices, pipes and folders are
// refused. An error names the file and the reason.
Result<std::string> readFile(const std::string& file);

// Writes a file under a temporary name beside the target and renames it, so that half a file never has the
// final name, unless the machine itself fails: nothing waits for the disk. The file is a new one, with a new
// file's permissions; what had the name before is replaced, a symbolic link itself and not the file to which
// it leads. A device or a pipe is written to in place. An error names the file and the reason.
Result<void> writeFile(const std::string& file, std::string_view bytes);
// The same of bytes that lie in several places, one after the other.
Result<void> writeFile(const std::string& file, std::span<const std::string_view> pieces);

}  // namespace sightline
