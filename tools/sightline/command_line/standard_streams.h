#pragma once

namespace sightline::tool {

// Opens /dev/null in the place of each standard stream that the process was started without. Otherwise the
// first files that it opens would take these places, and notes would be written into them. Standard output
// stays one that cannot be written to, so that a result is not lost unnoticed.
void openStandardStreams();

}  // namespace sightline::tool
