#include "sightline/pvs/query/sight_file.h"

#include <algorithm>
#include <cstring>

#include "src/pvs/query/chunk_decoder.h"
#include "src/pvs/query/sight_data.h"

namespace sightline {
namespace {

using namespace pvs;

// Replaces control characters in a name, because an error is a single line.
std::string oneLine(std::string text) {
  for (char& c : text) {
    const auto code = static_cast<unsigned char>(c);
    c = code < 0x20 || code == 0x7f ? ' ' : c;
  }
  return text;
}

std::string withCommas(std::uint64_t number) {
  std::string text = std::to_string(number);
  for (std::size_t place = text.size(); place > 3;) {
    place -= 3;
    text.insert(place, ",");
  }
  return text;
}

std::string counted(std::uint64_t number, const char* noun) {
  return withCommas(number) + " " + noun + (number == 1 ? "" : "s");
}

std::string countsOf(const SceneId& scene) {
  return counted(scene.objects, "object") + " and " + counted(scene.triangles, "triangle");
}

Error brokenSet(const std::string& file, std::uint32_t set) {
  return Error{file + " is altered: set " + std::to_string(set) + " is broken: bake it again"};
}

const DatabaseEntry* findDatabase(const SightView& view, const std::string& name) {
  const auto found = std::find_if(view.databases.begin(), view.databases.end(),
                                  [&](const DatabaseEntry& entry) { return entry.name == name; });
  return found == view.databases.end() ? nullptr : &*found;
}

bool readDatabaseBytes(const SightView& view, const DatabaseEntry& entry, ChunkDecoder& decoder,
                       std::vector<std::byte>& bytes) {
  // Limit of memory reserved before any chunk has proved to be as long as it claims.
  constexpr std::uint64_t kUnseen = 64u << 20;
  bytes.reserve(std::min(entry.raw_bytes, kUnseen));
  const auto chunks = view.chunks.subspan(entry.first_chunk, entry.chunk_count);
  return std::all_of(chunks.begin(), chunks.end(),
                     [&](const Chunk& chunk) { return decoder.decompress(view, chunk, bytes); });
}

SightFile::Section sectionOf(const std::string& name, std::span<const Chunk> chunks) {
  SightFile::Section section{name, 0, 0};
  for (const Chunk& chunk : chunks) {
    section.bytes += chunk.bytes;
    section.raw_bytes += chunk.raw_bytes;
  }
  return section;
}

}  // namespace

SightFile::SightFile(std::shared_ptr<const Data> data) : data_(std::move(data)) {}

Result<SightFile> SightFile::read(std::shared_ptr<Data> data) {
  Result<SightView> view = viewOf(data->bytes);
  if (!view) {
    return Error{oneLine(data->name + " " + view.error().message)};
  }
  data->view = std::move(*view);
  data->record = {data->view.near_distance, data->view.triangle_budget, data->view.max_depth,
                  std::string(data->view.settings)};
  return SightFile(std::move(data));
}

Result<SightFile> SightFile::open(const std::string& file) {
  auto data = std::make_shared<Data>();
  data->name = oneLine(file);
  Result<MappedFile> mapped = MappedFile::open(file, MappedFile::Pages::kReadOnly);
  if (!mapped) {
    return Error{data->name + " " + mapped.error().message};
  }
  data->mapped = std::move(*mapped);
  data->bytes = data->mapped.bytes();
  return read(std::move(data));
}

Result<SightFile> SightFile::fromBytes(std::span<const std::byte> bytes, const std::string& name) {
  auto data = std::make_shared<Data>();
  data->name = oneLine(name);
  data->bytes = bytes;
  if (reinterpret_cast<std::uintptr_t>(bytes.data()) % alignof(std::uint64_t) != 0) {
    data->copied.resize((bytes.size() + 7) / 8);
    std::memcpy(data->copied.data(), bytes.data(), bytes.size());
    data->bytes = std::as_bytes(std::span(data->copied)).first(bytes.size());
  }
  return read(std::move(data));
}

const SceneId& SightFile::scene() const {
  return data_->view.scene;
}

const BakeRecord& SightFile::record() const {
  return data_->record;
}

BoxTreeView SightFile::boxes() const {
  return data_->view.boxes;
}

OctreeView SightFile::octree() const {
  return data_->view.octree;
}

std::uint32_t SightFile::setCount() const {
  return static_cast<std::uint32_t>(data_->view.sets.size());
}

DoorsView SightFile::doors() const {
  return data_->view.doors;
}

Status SightFile::matches(const SceneId& other) const {
  const SceneId& own = scene();
  if (own == other) {
    return Success{};
  }
  const bool counts_differ = own.objects != other.objects || own.triangles != other.triangles;
  return Error{data_->name + " was baked from another scene: it had " + countsOf(own) + ", this one has " +
               (counts_differ ? countsOf(other) : std::string("as many, but not the same")) +
               ": bake it again"};
}

Status SightFile::readSet(std::uint32_t set, std::vector<std::uint32_t>& nodes) const {
  if (!ChunkDecoder().readSet(data_->view, set, nodes)) {
    return brokenSet(data_->name, set);
  }
  return Success{};
}

Status SightFile::forEachSet(
    const std::function<void(std::uint32_t, std::span<const std::uint32_t>)>& visit) const {
  // So many bytes of a mapped payload are read before they are given back.
  constexpr std::uint64_t kKept = 16u << 20;
  const SightView& view = data_->view;
  ChunkDecoder decoder;
  std::vector<std::uint32_t> nodes;
  std::uint64_t released = 0;
  for (std::uint32_t set = 0; set < setCount(); ++set) {
    nodes.clear();
    if (!decoder.readSet(view, set, nodes)) {
      return brokenSet(data_->name, set);
    }
    visit(set, nodes);
    const std::uint64_t at = view.chunks[view.sets[set].chunk].offset;
    if (at - released > kKept && !data_->mapped.bytes().empty()) {
      data_->mapped.release(view.payload.subspan(released, at - released));
      released = at;
    }
  }
  return Success{};
}

Status SightFile::verifyAll() const {
  if (const Status whole = forEachSet([](std::uint32_t, std::span<const std::uint32_t>) {}); !whole) {
    return whole;
  }
  for (const DatabaseEntry& entry : data_->view.databases) {
    const Result<DatabaseBlob> database = readDatabase(std::string(entry.name));
    if (!database) {
      return database.error();
    }
  }
  return Success{};
}

std::vector<std::string> SightFile::databaseNames() const {
  std::vector<std::string> names;
  for (const DatabaseEntry& entry : data_->view.databases) {
    names.emplace_back(entry.name);
  }
  return names;
}

Result<DatabaseBlob> SightFile::readDatabase(const std::string& name) const {
  const DatabaseEntry* entry = findDatabase(data_->view, name);
  if (entry == nullptr) {
    return Error{
        oneLine(data_->name + " holds no occluder database '" + name + "': bake it again with that one")};
  }
  DatabaseBlob blob{name, entry->occluders, {}};
  ChunkDecoder decoder;
  if (!readDatabaseBytes(data_->view, *entry, decoder, blob.bytes)) {
    return Error{
        oneLine(data_->name + " is altered: its occluder database '" + name + "' is broken: bake it again")};
  }
  return blob;
}

std::vector<SightFile::Section> SightFile::sections() const {
  const SightView& view = data_->view;
  const auto inPlace = [](const std::string& name, std::uint64_t bytes) {
    return Section{name, bytes, bytes};
  };
  std::vector<Section> sections{
      inPlace("hierarchy", view.boxes.nodes.size_bytes() + view.boxes.objects.size_bytes()),
      inPlace("octree", view.octree.nodes.size_bytes() + view.octree.leaves.size_bytes() +
                            view.octree.depths.size_bytes() + view.octree.reasons.size_bytes() +
                            view.octree.planes.size_bytes() + view.octree.viewers.size_bytes()),
      inPlace("index of sets", view.sets.size_bytes() + view.chunks.size_bytes()),
      sectionOf("sets", view.chunks.first(view.set_chunks))};
  if (const DoorsView& doors = view.doors; doors.groupCount() > 0) {
    sections.push_back(inPlace("doors", doors.doors.size_bytes() + doors.group_ends.size_bytes() +
                                            doors.hidden.size_bytes() + doors.hidden_ends.size_bytes()));
  }
  for (const DatabaseEntry& entry : view.databases) {
    sections.push_back(
        sectionOf(std::string(entry.name), view.chunks.subspan(entry.first_chunk, entry.chunk_count)));
  }
  return sections;
}

std::uint64_t SightFile::fileBytes() const {
  return data_->bytes.size();
}

}  // namespace sightline
