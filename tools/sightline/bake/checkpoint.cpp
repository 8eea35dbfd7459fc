// The file: a header, then records, each of a RecordHead and the part's bytes. Little-endian.
// A head has a checksum of its own, so the next record is found also if the bytes of this one are altered.
// Where a head is altered, the next record is where the next mark is.

#include "tools/sightline/bake/checkpoint.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include "sightline/io/file.h"

namespace sightline::tool {
namespace {

constexpr char kMagic[8] = {'S', 'L', 'p', 'a', 'r', 't', 's', '3'};
constexpr std::chrono::seconds kFlushEvery{1};

struct Header {
  char magic[8];
  std::uint64_t plan;
};
static_assert(sizeof(Header) == 16);

constexpr std::string_view kMark = "SLrecord";

struct RecordHead {
  char mark[8];
  std::uint64_t part;
  std::uint64_t length;
  std::uint64_t bytes_checksum;
  std::uint64_t head_checksum;  // of everything above
};
static_assert(sizeof(RecordHead) == 40);

std::uint64_t checksumOf(const RecordHead& head) {
  return XXH3_64bits(&head, offsetof(RecordHead, head_checksum));
}

RecordHead headOf(std::uint64_t part, const BakedPart& bytes) {
  RecordHead head{{}, part, bytes.size(), XXH3_64bits(bytes.data(), bytes.size()), 0};
  std::memcpy(head.mark, kMark.data(), sizeof(head.mark));
  head.head_checksum = checksumOf(head);
  return head;
}

// The head at the beginning of `bytes`, unless it is incomplete or altered.
std::optional<RecordHead> readHead(std::string_view bytes) {
  RecordHead head;
  if (bytes.size() < sizeof(head)) {
    return std::nullopt;
  }
  std::memcpy(&head, bytes.data(), sizeof(head));
  const bool whole =
      std::string_view(head.mark, sizeof(head.mark)) == kMark && checksumOf(head) == head.head_checksum;
  return whole ? std::optional(head) : std::nullopt;
}

struct Records {
  KeptParts kept;
  std::size_t whole = 0;  // bytes of the records before the first that could not be read
  std::string after;      // the other records that could be read
};

Records readRecords(std::string_view bytes) {
  Records records;
  KeptParts& kept = records.kept;
  while (!bytes.empty()) {
    const std::optional<RecordHead> head = readHead(bytes);
    if (!head) {
      const bool cut =
          bytes.size() < sizeof(RecordHead) && bytes.substr(0, kMark.size()) == kMark.substr(0, bytes.size());
      kept.unreadable += 1;
      kept.damaged |= !cut;
      bytes.remove_prefix(std::min(bytes.find(kMark, 1), bytes.size()));
      continue;
    }
    if (head->length > bytes.size() - sizeof(*head)) {
      kept.unreadable += 1;
      break;
    }
    const std::string_view record = bytes.substr(0, sizeof(*head) + head->length);
    bytes.remove_prefix(record.size());
    const std::span part = std::as_bytes(std::span(record.substr(sizeof(*head))));
    if (XXH3_64bits(part.data(), part.size()) != head->bytes_checksum) {
      kept.unreadable += 1;
      kept.damaged = true;
      continue;
    }
    kept.parts.insert_or_assign(head->part, BakedPart(part.begin(), part.end()));
    if (kept.unreadable == 0) {
      records.whole += record.size();
    } else {
      records.after += record;
    }
  }
  return records;
}

}  // namespace

std::string lossText(const std::string& file, const KeptParts& kept) {
  if (kept.no_header) {
    return fmt::format("{}: is cut off before its first part; all parts are baked", file);
  }
  if (kept.unreadable == 0) {
    return {};
  }
  return fmt::format("{}: {}: {} of {} parts could not be read and {} baked again", file,
                     kept.damaged ? "is damaged" : "its end is cut off, as after a kill", kept.unreadable,
                     kept.parts.size() + kept.unreadable, kept.unreadable == 1 ? "is" : "are");
}

Result<Checkpoint> Checkpoint::open(const std::string& file, CheckpointUse use) {
  const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644);
  Checkpoint checkpoint(file, descriptor, use);
  struct stat facts {};
  if (descriptor < 0 || ::fstat(descriptor, &facts) != 0) {
    return checkpoint.failure("cannot be written");
  }
  if (!S_ISREG(facts.st_mode)) {
    return Error{fmt::format("{}: is not a file; the parts of an unfinished bake go there", file)};
  }
  // Where files cannot be locked, nothing prevents two bakes of one output.
  if (::flock(descriptor, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(std::exchange(checkpoint.descriptor_,
                          -1));  // the file belongs to the other bake, even if it is empty
    return Error{fmt::format("{}: another bake to the same file is running; wait for it or end it", file)};
  }
  char magic[sizeof(kMagic)] = {};
  const ssize_t read = ::pread(descriptor, magic, sizeof(magic), 0);
  if (read > 0 && std::memcmp(magic, kMagic, static_cast<std::size_t>(read)) != 0) {
    return Error{fmt::format("{}: is not what a bake leaves; remove it, or name another output", file)};
  }
  // A file that is no more than a header was left by a bake that had finished nothing.
  if (use == CheckpointUse::kNew && facts.st_size > static_cast<off_t>(sizeof(Header))) {
    return Error{fmt::format(
        "{}: an unfinished bake left its parts here; go on with --resume, or begin anew with --restart",
        file)};
  }
  return checkpoint;
}

Checkpoint::Checkpoint(Checkpoint&& other) noexcept
    : file_(std::move(other.file_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      use_(other.use_),
      flushed_(other.flushed_) {}

Checkpoint::~Checkpoint() {
  struct stat facts {};
  if (descriptor_ >= 0 && ::fstat(descriptor_, &facts) == 0 && S_ISREG(facts.st_mode) && facts.st_size == 0) {
    ::unlink(file_.c_str());
  }
  if (descriptor_ >= 0) {
    ::close(descriptor_);
  }
}

Result<KeptParts> Checkpoint::begin(std::uint64_t plan) {
  Records records;
  Header header{};
  std::memcpy(header.magic, kMagic, sizeof(kMagic));
  header.plan = plan;
  const std::string_view wanted(reinterpret_cast<const char*>(&header), sizeof(header));
  std::size_t whole = 0;
  if (use_ == CheckpointUse::kResume) {
    const Result<std::string> bytes = readFile(file_);
    if (!bytes) {
      return bytes.error();
    }
    const std::string_view start = std::string_view(*bytes).substr(0, sizeof(header));
    if (start.size() == sizeof(header)) {
      if (start != wanted) {
        return Error{fmt::format(
            "{}: is of another scene or other settings; go on with those, or begin anew with --restart",
            file_)};
      }
      records = readRecords(std::string_view(*bytes).substr(sizeof(header)));
      whole = sizeof(header) + records.whole;
    }
    records.kept.no_header = !start.empty() && whole == 0;
  }
  if (::ftruncate(descriptor_, static_cast<off_t>(whole)) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0) {
    return failure("cannot be written");
  }
  const std::string_view missing = whole == 0 ? wanted : std::string_view(records.after);
  if (const Status ok = writeAll(missing.data(), missing.size()); !ok) {
    return ok.error();
  }
  return std::move(records.kept);
}

Status Checkpoint::append(std::uint64_t part, const BakedPart& bytes) {
  const RecordHead head = headOf(part, bytes);
  if (const Status ok = writeAll(&head, sizeof(head)); !ok) {
    return ok;
  }
  if (const Status ok = writeAll(bytes.data(), bytes.size()); !ok) {
    return ok;
  }
  return std::chrono::steady_clock::now() - flushed_ < kFlushEvery ? Status(Success{}) : flush();
}

Status Checkpoint::flush() {
  flushed_ = std::chrono::steady_clock::now();
  return ::fdatasync(descriptor_) == 0 ? Status(Success{}) : failure("cannot be written to the disk");
}

Status Checkpoint::remove() {
  return ::unlink(file_.c_str()) == 0 ? Status(Success{}) : failure("cannot be removed");
}

Status Checkpoint::writeAll(const void* bytes, std::size_t count) {
  const char* next = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = ::write(descriptor_, next, count);
    if (written < 0 && errno != EINTR) {
      return failure("cannot be written");
    }
    if (written > 0) {
      next += written;
      count -= static_cast<std::size_t>(written);
    }
  }
  return Success{};
}

Error Checkpoint::failure(const std::string& what) const {
  return Error{fmt::format("{}: {}: {}", file_, what, std::strerror(errno))};
}

}  // namespace sightline::tool
