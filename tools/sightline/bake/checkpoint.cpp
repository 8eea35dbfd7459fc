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
#include "src/pvs/format/checksum.h"

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
  return pvs::checksumOf(std::as_bytes(std::span(&head, 1)).first(offsetof(RecordHead, head_checksum)));
}

std::uint64_t checksumOf(const BakedPart& bytes) {
  return pvs::checksumOf(std::as_bytes(std::span(bytes)));
}

RecordHead headOf(std::uint64_t part, const BakedPart& bytes) {
  RecordHead head{{}, part, bytes.size(), checksumOf(bytes), 0};
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

// Reads `count` bytes of the file from `offset` on. False if there are fewer, or none can be read.
bool readAt(int descriptor, std::uint64_t offset, void* bytes, std::size_t count) {
  char* next = static_cast<char*>(bytes);
  while (count > 0) {
    const ssize_t read = ::pread(descriptor, next, count, static_cast<off_t>(offset));
    if (read == 0 || (read < 0 && errno != EINTR)) {
      return false;
    }
    if (read > 0) {
      next += read;
      offset += static_cast<std::uint64_t>(read);
      count -= static_cast<std::size_t>(read);
    }
  }
  return true;
}

// The first mark of a record in [begin, end) of the file, or end. Nothing if the file cannot be read.
std::optional<std::uint64_t> findMark(int descriptor, std::uint64_t begin, std::uint64_t end) {
  constexpr std::uint64_t kStep = 1u << 20;
  std::string step;
  for (std::uint64_t at = begin; at < end; at += kStep) {
    step.resize(static_cast<std::size_t>(std::min(end - at, kStep + kMark.size() - 1)));
    if (!readAt(descriptor, at, step.data(), step.size())) {
      return std::nullopt;
    }
    if (const std::size_t found = step.find(kMark); found != std::string::npos) {
      return at + found;
    }
  }
  return end;
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
      places_(std::move(other.places_)),
      size_(other.size_),
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
  KeptParts kept;
  Header wanted{};
  std::memcpy(wanted.magic, kMagic, sizeof(kMagic));
  wanted.plan = plan;
  std::uint64_t whole = 0;
  if (use_ == CheckpointUse::kResume) {
    struct stat facts {};
    Header start{};
    if (::fstat(descriptor_, &facts) != 0) {
      return failure("cannot be read");
    }
    const auto size = static_cast<std::uint64_t>(facts.st_size);
    const auto length = static_cast<std::size_t>(std::min<std::uint64_t>(size, sizeof(start)));
    if (!readAt(descriptor_, 0, &start, length)) {
      return failure("cannot be read");
    }
    if (length == sizeof(start)) {
      if (std::memcmp(&start, &wanted, sizeof(start)) != 0) {
        return Error{fmt::format(
            "{}: is of another scene or other settings; go on with those, or begin anew with --restart",
            file_)};
      }
      const Result<std::uint64_t> end = gather(size, kept);
      if (!end) {
        return end.error();
      }
      whole = *end;
    }
    kept.no_header = length > 0 && whole == 0;
  }
  if (::ftruncate(descriptor_, static_cast<off_t>(whole)) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0) {
    return failure("cannot be written");
  }
  size_ = whole;
  if (whole == 0) {
    if (const Status ok = writeAll(&wanted, sizeof(wanted)); !ok) {
      return ok.error();
    }
  }
  for (const auto& [part, place] : places_) {
    kept.parts.push_back(part);
  }
  return kept;
}

// A record that is moved is in memory while it is written, so it may overlap the place where it was.
Result<std::uint64_t> Checkpoint::gather(std::uint64_t size, KeptParts& kept) {
  std::uint64_t end = sizeof(Header);  // of what is kept
  BakedPart bytes;
  for (std::uint64_t at = sizeof(Header); at < size;) {
    char start[sizeof(RecordHead)];
    const std::uint64_t left = size - at;
    const std::string_view text(start,
                                static_cast<std::size_t>(std::min<std::uint64_t>(left, sizeof(start))));
    if (!readAt(descriptor_, at, start, text.size())) {
      return failure("cannot be read");
    }
    const std::optional<RecordHead> head = readHead(text);
    if (!head) {
      const bool cut =
          left < sizeof(RecordHead) && text.substr(0, kMark.size()) == kMark.substr(0, text.size());
      kept.unreadable += 1;
      kept.damaged |= !cut;
      const std::optional<std::uint64_t> mark = findMark(descriptor_, at + 1, size);
      if (!mark) {
        return failure("cannot be read");
      }
      at = *mark;
      continue;
    }
    if (head->length > left - sizeof(*head)) {
      kept.unreadable += 1;
      break;
    }
    bytes.resize(static_cast<std::size_t>(head->length));
    if (!readAt(descriptor_, at + sizeof(*head), bytes.data(), bytes.size())) {
      return failure("cannot be read");
    }
    const std::uint64_t record = sizeof(*head) + head->length;
    if (checksumOf(bytes) != head->bytes_checksum) {
      kept.unreadable += 1;
      kept.damaged = true;
    } else {
      if (end < at) {
        if (::lseek(descriptor_, static_cast<off_t>(end), SEEK_SET) < 0) {
          return failure("cannot be written");
        }
        if (const Status ok = writeRecord(head->part, bytes); !ok) {
          return ok.error();
        }
      }
      places_.insert_or_assign(head->part, Place{end, head->length});
      end += record;
    }
    at += record;
  }
  // What was moved must be on the disk before what lies behind it is cut off.
  if (end < size && ::fdatasync(descriptor_) != 0) {
    return failure("cannot be written");
  }
  return end;
}

std::optional<BakedPart> Checkpoint::read(std::uint64_t part) const {
  const auto place = places_.find(part);
  char start[sizeof(RecordHead)];
  if (place == places_.end() || !readAt(descriptor_, place->second.offset, start, sizeof(start))) {
    return std::nullopt;
  }
  const std::optional<RecordHead> head = readHead({start, sizeof(start)});
  if (!head || head->part != part || head->length != place->second.length) {
    return std::nullopt;
  }
  BakedPart bytes(static_cast<std::size_t>(head->length));
  const bool whole = readAt(descriptor_, place->second.offset + sizeof(*head), bytes.data(), bytes.size()) &&
                     checksumOf(bytes) == head->bytes_checksum;
  return whole ? std::optional(std::move(bytes)) : std::nullopt;
}

Status Checkpoint::append(std::uint64_t part, const BakedPart& bytes) {
  const Place place{size_, bytes.size()};
  if (const Status ok = writeRecord(part, bytes); !ok) {
    return ok;
  }
  places_.insert_or_assign(part, place);
  return std::chrono::steady_clock::now() - flushed_ < kFlushEvery ? Status(Success{}) : flush();
}

Status Checkpoint::flush() {
  flushed_ = std::chrono::steady_clock::now();
  return ::fdatasync(descriptor_) == 0 ? Status(Success{}) : failure("cannot be written to the disk");
}

Status Checkpoint::remove() {
  return ::unlink(file_.c_str()) == 0 ? Status(Success{}) : failure("cannot be removed");
}

Status Checkpoint::writeRecord(std::uint64_t part, const BakedPart& bytes) {
  const RecordHead head = headOf(part, bytes);
  const Status ok = writeAll(&head, sizeof(head));
  return ok ? writeAll(bytes.data(), bytes.size()) : ok;
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
      size_ += static_cast<std::uint64_t>(written);
    }
  }
  return Success{};
}

Error Checkpoint::failure(const std::string& what) const {
  return Error{fmt::format("{}: {}: {}", file_, what, std::strerror(errno))};
}

}  // namespace sightline::tool
