// Writes the seed corpus for fuzzing .sight files: small files of each kind, and sets.
//
//   sight_seeds FOLDER

#include <cstdio>
#include <fstream>
#include <string>

#include "src/pvs/bake/encode_sight.h"
#include "src/pvs/format/set_code.h"
#include "tests/support/made_visibility.h"

namespace {

using namespace sightline;

bool write(const std::string& file, const std::vector<std::byte>& bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) {
    std::fprintf(stderr, "%s cannot be written\n", file.c_str());
  }
  return static_cast<bool>(stream);
}

bool writeFile(const std::string& file, const made::Visibility& settings) {
  const auto bytes = pvs::encodeSight(made::visibility(settings));
  return bytes && write(file, *bytes);
}

bool writeSet(const std::string& file, const std::vector<std::uint32_t>& nodes) {
  std::vector<BoxNode> leaves(nodes.empty() ? 0 : nodes.back() + 1);
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    leaves[i].end = i + 1;
  }
  std::vector<std::byte> bytes;
  pvs::appendSet(bytes, nodes, leaves);
  return write(file, bytes);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: sight_seeds FOLDER\n", stderr);
    return 2;
  }
  const std::string folder = std::string(argv[1]) + "/";
  const bool written =
      writeFile(folder + "one_cell",
                {.objects = 1, .leaves = 1, .depth = 0, .sets = 2, .database_bytes = {}}) &&
      writeFile(folder + "planes",
                {.objects = 5, .leaves = 8, .sets = 4, .plane_every = 1, .database_bytes = {}}) &&
      writeFile(folder + "deep",
                {.objects = 9, .leaves = 30, .depth = 9, .sets = 10, .database_bytes = {}}) &&
      writeFile(folder + "databases",
                {.objects = 3, .leaves = 8, .sets = 3, .database_bytes = {50, 0, 400}}) &&
      // Several chunks of sets.
      writeFile(folder + "chunks", {.objects = 60, .leaves = 8, .sets = 500, .set_nodes = 20}) &&
      writeSet(folder + "empty_set", {}) && writeSet(folder + "set", {1, 4, 8, 9, 10, 13, 200, 300});
  return written ? 0 : 1;
}
