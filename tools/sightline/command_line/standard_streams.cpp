#include "tools/sightline/command_line/standard_streams.h"

#include <fcntl.h>
#include <unistd.h>

#include <array>

namespace sightline::tool {

void openStandardStreams() {
  for (const int stream : std::array{STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    if (::fcntl(stream, F_GETFD) < 0) {
      // The system gives the lowest free number, which is this one.
      static_cast<void>(::open("/dev/null", stream == STDOUT_FILENO ? O_RDONLY : O_RDWR));
    }
  }
}

}  // namespace sightline::tool
