// Writes what the targets start from that is binary: made anew, so that it is always of this version.
//
//   fuzz_seeds FOLDER      writes FOLDER/TARGET/NAME; these folders must exist

#include <cstdio>
#include <fstream>
#include <span>
#include <string>
#include <utility>

#include "sightline/hierarchy/hierarchy.h"
#include "sightline/io/image.h"
#include "sightline/occluders/occluder_set.h"
#include "sightline/occluders/surface_set.h"
#include "sightline/scene/object_boxes.h"
#include "src/comparison/occluders/grid_points.h"
#include "src/occluders/database/database_cells.h"
#include "src/occluders/database/direction_lists.h"
#include "src/pvs/bake/file/encode_sight.h"
#include "src/pvs/bake/update/answers.h"
#include "src/pvs/bake/update/earlier_bake.h"
#include "src/pvs/format/set_code.h"
#include "tests/support/made_visibility.h"
#include "tools/sightline/bake/checkpoint.h"
#include "tools/sightline/exact/exact_bytes.h"

namespace {

using namespace sightline;
using Bytes = std::vector<std::byte>;

bool write(const std::string& file, std::span<const std::byte> bytes, const std::string& before = "") {
  std::ofstream stream(file, std::ios::binary);
  stream << before;
  stream.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  stream.close();
  if (!stream) {
    std::fprintf(stderr, "%s cannot be written\n", file.c_str());
  }
  return static_cast<bool>(stream);
}

bool writeFile(const std::string& file, const made::Visibility& settings) {
  const auto bytes = pvs::encodeSight(made::visibility(settings));
  return bytes && write(file, bytes->joined());
}

bool writeSet(const std::string& file, const std::vector<std::uint32_t>& nodes) {
  std::vector<BoxNode> leaves(nodes.empty() ? 0 : nodes.back() + 1);
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    leaves[i].end = i + 1;
  }
  Bytes bytes;
  pvs::appendSet(bytes, nodes, leaves);
  return write(file, bytes);
}

bool writeSightFiles(const std::string& folder) {
  return writeFile(folder + "one_cell",
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
}

// A triangle of one object, see surfaces_fuzz.cpp for the byte before.
bool writeSurfaces(const std::string& file) {
  SurfaceSet set;
  const Box box{{0, 0, 0}, {1, 1, 0}};
  set.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  set.triangles = {0, 1, 2};
  set.clusters = {{.triangle_count = 1, .chain_count = 1}};
  set.patches = {{.cluster_count = 1, .chain_count = 1, .edge_count = 3}};
  set.parts = {{.patch_count = 1, .edge_count = 3}};
  set.cluster_bounds = set.patch_bounds = set.part_bounds = set.object_bounds = {box};
  set.first_adjoining = {0, 0};
  set.first_of_object = {0, 1};
  set.of_object = {0};
  set.sizes_of_object = {1.5f};
  set.objects = {ObjectId(0u)};
  set.chains = {{.vertex_count = 4, .use_count = 1}};
  set.uses = {{.value = 1}};
  set.cluster_chains = {0};
  set.patch_chains = {{.value = 1}};
  set.chain_vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  const LargeVector<std::byte> bytes = surfaceBytes(set);
  return surfacesFrom({bytes}, 1) && write(file, bytes, std::string(1, '\1'));
}

// One object with two boxes, a polygon and a node of its own. See prepared_fuzz.cpp for the byte before.
bool writePrepared(const std::string& folder) {
  const std::string objects(1, '\1');
  const Box box{{0, 0, 0}, {1, 1, 1}}, half{{0, 0, 0}, {1, 1, 0.5f}};
  const Hierarchy hierarchy{.nodes = {{.bounds = box, .cost = 2, .is_leaf = 1}},
                            .objects = {ObjectId(0u)},
                            .object_count = 1,
                            .depth = 1};
  OccluderSet set;
  set.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  set.lines = {{set.vertices[0], set.vertices[1]}};
  set.edges = {{.neighbour_count = 1, .mesh_edge_count = 2}, {}, {}};
  set.neighbours = {{OccluderId(0u), 1}};
  set.edge_vertices = {{0.5f, 0, 0}};
  set.occluders = {{.vertex_count = 3, .object = ObjectId(0u), .area = 0.5f, .plane = {{0, 0, 1}, 0}}};
  set.objects = {ObjectId(0u)};
  set.first_of_object = set.first_unit_of_object = {0, 1};
  set.of_object = set.unit_of_object = {OccluderId(0u)};
  set.bodies = {{.vertex_count = 1, .edge_count = 1, .face_count = 1, .bounds = box}};
  set.body_vertices = {{0, 0, 0}};
  set.body_edges = {{}};
  set.body_faces = {{.plane = {{0, 0, 1}, 0}, .occluder = OccluderId(0u)}};
  set.body_of = {0};
  return write(folder + "occluders", occluderBytes(set), objects) && occludersFrom({occluderBytes(set)}, 1) &&
         write(folder + "hierarchy", hierarchyBytes(hierarchy), objects) &&
         hierarchyFrom(hierarchyBytes(hierarchy), 1) &&
         write(folder + "boxes", objectBoxesBytes({{0, 2}, {half, box}}), objects);
}

template <typename Places>
bool writeLists(const std::string& file, char kind, Places places) {
  constexpr std::uint32_t kDirections = 3, kOccluders = 5;
  const std::uint32_t count = places.count() * kDirections;
  occluders::DirectionLists<Places> lists(kDirections, kOccluders, std::move(places));
  occluders::ListPacker packer(count, 2 * count);
  for (std::uint32_t list = 0; list < count; ++list) {
    packer.add(std::vector<OccluderId>{OccluderId(list % kOccluders), OccluderId((list + 2) % kOccluders)});
  }
  lists.lists = packer.finish();
  // See database_fuzz.cpp for the bytes before.
  return write(file, occluders::saveLists<Places>(&lists), {kind, static_cast<char>(kOccluders)});
}

bool writeDatabases(const std::string& folder) {
  occluders::CellTree cells;
  cells.nodes = {{.plane = 1.0f, .axis = 0, .link = 1}, {.link = 0}, {.link = 1}};
  cells.regions = {{{0, 0, 0}, {1, 2, 2}}, {{1, 0, 0}, {3, 2, 2}}};
  return writeLists(folder + "cells", '\0', cells) &&
         writeLists(folder + "grid", '\1', comparison::GridPoints({{{0, 1, 0}, {2, 1, 0}}, 2.0}));
}

bool writeCheckpoint(const std::string& file) {
  Result<tool::Checkpoint> checkpoint = tool::Checkpoint::open(file, tool::CheckpointUse::kRestart);
  return checkpoint && checkpoint->begin(0x0123456789abcdef) &&
         checkpoint->append(3, Bytes(20, std::byte{7})) && checkpoint->append(5, Bytes(1, std::byte{1}));
}

// A scene of two objects, and one part with an answer of each kind. Without what answers_fuzz.cpp adds:
// magic, version and checksum.
bool writeAnswers(const std::string& file) {
  using namespace pvs;
  const Box box{{0, 0, 0}, {1, 1, 1}};
  const SceneMarks marks{.frame = box,
                         .objects = {{.content = 3, .bounds = box}, {.content = 5, .bounds = box}},
                         .nodes = {{.bounds = box, .end = 3, .object_count = 2},
                                   {.bounds = box, .end = 2, .object_count = 1},
                                   {.bounds = box, .end = 3, .first_object = 1, .object_count = 1}},
                         .panels = {{.content = 7, .bounds = box}}};
  CellAnswers answers;
  answers[9] = {{.kind = AnswerKind::kConvex, .question = 1, .asked = {{0, 2}}, .seen = {{1, 2}}},
                {.kind = AnswerKind::kFused,
                 .question = 2,
                 .seen = {{0, 1}},
                 .hidden_nodes = {2},
                 .followed = {{0, 0, 0, 9, 9, 9}}},
                {.kind = AnswerKind::kPoint, .question = 3, .least = 4, .most = 5}};
  const Bytes encoded = encodeAnswers(answers);
  const Bytes bytes = earlierBakeBytes({.hash = 1, .objects = 2}, marks, {{1, encoded}});
  return write(file, std::span(bytes).subspan(12, bytes.size() - 20));
}

bool writeExact(const std::string& file) {
  const tool::ExactKey key({.hash = 7, .objects = 50, .triangles = 100}, View{}, {});
  const std::string bytes =
      tool::exactBytes(key, {{ObjectId(1u), ObjectId(4u)}, {ObjectId(9u)}, {}, {ObjectId(30u)}});
  // Without its checksum, which the target adds.
  return write(file, std::as_bytes(std::span(bytes)).first(bytes.size() - sizeof(std::uint64_t)));
}

bool writePicture(const std::string& file) {
  Image image{3, 2, {}};
  for (std::uint8_t i = 0; i < 24; ++i) {
    image.rgba.push_back(static_cast<std::uint8_t>(i * 10));
  }
  return writePng(image, file).has_value();
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: fuzz_seeds FOLDER\n", stderr);
    return 2;
  }
  const std::string folder = std::string(argv[1]) + "/";
  const bool written = writeSightFiles(folder + "sight/") && writeSurfaces(folder + "prepared/triangle") &&
                       writePrepared(folder + "prepared/") && writeDatabases(folder + "database/") &&
                       writeCheckpoint(folder + "checkpoint/parts") &&
                       writeAnswers(folder + "answers/part") && writeExact(folder + "exact/frame") &&
                       writePicture(folder + "png/picture.png");
  return written ? 0 : 1;
}
