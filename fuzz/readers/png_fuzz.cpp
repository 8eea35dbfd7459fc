// Feeds bytes to the reader of pictures, which replace layers.

#include "fuzz/readers/fuzz_input.h"
#include "sightline/io/image.h"

using namespace sightline;
using namespace sightline::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const Result<Image> image = readPng(folder().write("fuzz.png", textOf(data, size)));
  if (!image) {
    requireOneLine(image.error());
    return 0;
  }
  require(image->width > 0 && image->height > 0);
  require(image->rgba.size() == std::size_t{4} * image->width * image->height);
  return 0;
}
