// A file: Head, a Row for each section, and the sections, each of which begins at a multiple of 16 bytes.

#include "tools/sightline/input/prepared_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <filesystem>
#include <memory>
#include <span>
#include <string_view>

#include "src/base/array_bytes.h"
#include "src/pvs/query/mapped_file.h"
#include "tools/sightline/command_line/note.h"
#include "tools/sightline/command_line/output_files.h"

#define XXH_INLINE_ALL
#include "src/pvs/format/checksum.h"

namespace sightline::tool {
namespace {

constexpr char kLetters[8] = {'S', 'L', 'p', 'r', 'e', 'p', '0', '3'};  // the last two: the version
constexpr std::size_t kLettersOfAll = 6;                                // versions have the same ones

struct Head {
  char letters[8];
  SceneId scene{};
  std::uint64_t crack_width = 0;  // the bits of a double, metres
  std::uint64_t sections = 0;
  std::uint64_t checksum = 0;  // of all before it, and of the rows
};
struct Row {
  char name[16];  // ends with at least one 0
  std::uint64_t begin = 0, size = 0;
  std::uint64_t checksum = 0;  // of the section
  std::uint64_t unused = 0;
};
static_assert(std::has_unique_object_representations_v<Head> &&
              std::has_unique_object_representations_v<Row>);

std::uint64_t checksumOf(const Head& head, std::span<const Row> rows) {
  pvs::Checksum sum;
  sum.add(std::as_bytes(std::span(&head, 1)).first(offsetof(Head, checksum)));
  sum.add(std::as_bytes(rows));
  return sum.value();
}

}  // namespace

Result<PreparedFile> PreparedFile::open(const std::string& name, const SceneView& scene, double crack_width) {
  if (name.empty()) {
    return PreparedFile();
  }
  PreparedFile file(name, sceneId(scene), crack_width);
  if (const Status mapped = file.map(); !mapped) {
    return mapped.error();
  }
  return file;
}

Status PreparedFile::map() {
  std::error_code ignored;
  if (!std::filesystem::exists(name_, ignored)) {
    return Success{};
  }
  // The vectors of what is read from a section lie in the map, and may be written to.
  using pvs::MappedFile;
  Result<MappedFile> opened = MappedFile::open(name_, MappedFile::Pages::kCopiedWhenWritten);
  if (!opened) {
    return Error{fmt::format("--prepared {}: {}", name_, opened.error().message)};
  }
  const auto mapped = std::make_shared<MappedFile>(std::move(*opened));
  const std::span<const std::byte> bytes = mapped->bytes();
  if (!bytes.empty() &&
      (bytes.size() < kLettersOfAll || std::memcmp(bytes.data(), kLetters, kLettersOfAll) != 0)) {
    return Error{fmt::format("--prepared {}: is there and holds nothing prepared; name another file", name_)};
  }
  if (const std::string reason = read({bytes, mapped}); !reason.empty()) {
    sections_.clear();
    refuse(reason);
  }
  return Success{};
}

std::string PreparedFile::read(const SharedBytes& file) {
  const std::span<const std::byte> bytes = file.bytes;
  Head head;
  if (bytes.size() < sizeof(head)) {
    return "it is cut off";
  }
  std::memcpy(&head, bytes.data(), sizeof(head));
  if (std::memcmp(head.letters, kLetters, sizeof(kLetters)) != 0) {
    return "it is of another version";
  }
  if (head.sections > (bytes.size() - sizeof(head)) / sizeof(Row)) {
    return "it is cut off";
  }
  std::vector<Row> rows(static_cast<std::size_t>(head.sections));
  if (!rows.empty()) {
    std::memcpy(rows.data(), &bytes[sizeof(head)], rows.size() * sizeof(Row));
  }
  if (head.checksum != checksumOf(head, rows)) {
    return "it is damaged";
  }
  if (head.crack_width != std::bit_cast<std::uint64_t>(crack_width_)) {
    return fmt::format("it is of --crack-width {}", std::bit_cast<double>(head.crack_width));
  }
  if (head.scene != scene_) {
    return "it is of another scene";
  }
  for (const Row& row : rows) {
    if (row.name[sizeof(row.name) - 1] != 0) {
      return "it is damaged";
    }
    if (row.begin > bytes.size() || row.size > bytes.size() - row.begin) {
      return "it is cut off";
    }
    sections_.push_back(
        {row.name,
         {bytes.subspan(static_cast<std::size_t>(row.begin), static_cast<std::size_t>(row.size)), file.owner},
         row.checksum});
  }
  return "";
}

std::optional<SharedBytes> PreparedFile::find(const std::string& name) {
  const auto section = std::find_if(sections_.begin(), sections_.end(),
                                    [&](const Section& candidate) { return candidate.name == name; });
  if (section == sections_.end()) {
    return {};
  }
  if (section->checksum && *section->checksum != pvs::checksumOf(section->bytes.bytes)) {
    refuse("it is damaged");
    sections_.erase(section);
    return {};
  }
  section->checksum.reset();
  return section->bytes;
}

void PreparedFile::add(const std::string& name, LargeVector<std::byte> bytes) {
  std::erase_if(sections_, [&](const Section& section) { return section.name == name; });
  const auto owner = std::make_shared<const LargeVector<std::byte>>(std::move(bytes));
  sections_.push_back({name, {*owner, owner}});
  grown_ = true;
}

void PreparedFile::refuse(const std::string& reason) const {
  printNote("{} is written anew: {}", name_, reason);
}

void PreparedFile::keep() {
  if (!std::exchange(grown_, false)) {
    return;
  }
  Head head;
  std::memcpy(head.letters, kLetters, sizeof(kLetters));
  head.scene = scene_;
  head.crack_width = std::bit_cast<std::uint64_t>(crack_width_);
  head.sections = sections_.size();
  std::vector<Row> rows;
  std::vector<std::string_view> pieces;
  static constexpr char kPadding[base::kArrayAlignment] = {};
  std::size_t end = sizeof(head) + sections_.size() * sizeof(Row);
  for (const Section& section : sections_) {
    const std::span<const std::byte> bytes = section.bytes.bytes;
    Row row{};
    section.name.copy(row.name, sizeof(row.name) - 1);
    row.begin = base::paddedSize(end);
    row.size = bytes.size();
    row.checksum = section.checksum ? *section.checksum : pvs::checksumOf(bytes);
    rows.push_back(row);
    pieces.push_back({kPadding, base::paddedSize(end) - end});
    pieces.push_back({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    end = base::paddedSize(end) + bytes.size();
  }
  head.checksum = checksumOf(head, rows);
  pieces.insert(pieces.begin(), {{reinterpret_cast<const char*>(&head), sizeof(head)},
                                 {reinterpret_cast<const char*>(rows.data()), rows.size() * sizeof(Row)}});
  if (const Status kept = saveFile(name_, pieces); !kept) {
    printNote("what was prepared is not kept: {}", kept.error().message);
    return;
  }
  // From now on the sections lie in the file, and not in memory besides.
  PreparedFile written(name_, scene_, crack_width_);
  if (written.map()) {
    *this = std::move(written);
  }
}

}  // namespace sightline::tool
