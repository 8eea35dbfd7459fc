#include "src/io/gltf/gltf_buffers.h"

#include <array>
#include <filesystem>
#include <map>
#include <optional>

#include "sightline/io/file.h"
#include "src/io/failure.h"
#include "src/io/gltf/gltf_uris.h"

namespace sightline::io {
namespace {

namespace fs = std::filesystem;

std::optional<std::string> decodeBase64(std::string_view text) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  while (!text.empty() && text.back() == '=') {
    text.remove_suffix(1);
  }
  std::array<int, 256> value_of;
  value_of.fill(-1);
  for (std::size_t i = 0; i < kDigits.size(); ++i) {
    value_of[static_cast<unsigned char>(kDigits[i])] = static_cast<int>(i);
  }
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  unsigned gathered = 0;
  int bits = 0;
  for (const char c : text) {
    const int value = value_of[static_cast<unsigned char>(c)];
    if (value < 0) {
      return std::nullopt;
    }
    gathered = (gathered << 6 | static_cast<unsigned>(value)) & 0xffffu;
    bits += 6;
    if (bits >= 8) {
      bits -= 8;
      bytes.push_back(static_cast<char>(gathered >> bits & 0xffu));
    }
  }
  return bytes;
}

Result<std::string> decodeDataUri(std::string_view uri, const std::string& where) {
  const std::size_t comma = uri.find(',');
  const std::string_view header = uri.substr(0, comma);
  if (comma == std::string_view::npos || header.size() < 7 || header.substr(header.size() - 7) != ";base64") {
    return failure("{}: its data URI is not base64", where);
  }
  std::optional<std::string> bytes = decodeBase64(uri.substr(comma + 1));
  if (!bytes) {
    return failure("{}: its data URI has characters that are not base64", where);
  }
  return std::move(*bytes);
}

// The file that a relative URI means, made sure to lie under base_dir, links resolved.
Result<fs::path> resolve(const std::string& uri, const std::string& base_dir, const std::string& where) {
  const std::optional<std::string> relative = decodePercent(uri);
  if (!relative || relative->empty() || relative->find('\0') != std::string::npos) {
    return failure("{}: its URI is malformed", where);
  }
  if (base_dir.empty()) {
    return failure("{}: is in another file, \"{}\", which is not read here", where, *relative);
  }
  if (relative->find(':') != std::string::npos || fs::path(*relative).is_absolute() ||
      relative->find('\\') != std::string::npos) {
    return failure("{}: \"{}\" is not a path relative to the scene's folder", where, *relative);
  }
  std::error_code code;
  const fs::path base = fs::weakly_canonical(base_dir, code);
  const fs::path target = code ? fs::path() : fs::weakly_canonical(base / *relative, code);
  if (code) {
    return failure("{}: \"{}\" cannot be found: {}", where, *relative, code.message());
  }
  const fs::path inside = target.lexically_relative(base);
  if (inside.empty() || *inside.begin() == "..") {
    return failure("{}: \"{}\" lies outside the scene's folder", where, *relative);
  }
  return target;
}

class BufferLoader {
 public:
  explicit BufferLoader(const std::string& base_dir) : base_dir_(base_dir) {}

  // The bytes behind a URI, decoded or read; each file once, however many buffers name it.
  Result<std::string_view> load(const std::string& uri, const std::string& where) {
    if (uri.compare(0, 5, "data:") == 0) {
      Result<std::string> decoded = decodeDataUri(uri, where);
      return decoded ? Result<std::string_view>(keep(std::move(*decoded))) : decoded.error();
    }
    const Result<fs::path> file = resolve(uri, base_dir_, where);
    if (!file) {
      return file.error();
    }
    const auto found = read_files_.find(file->string());
    if (found != read_files_.end()) {
      return found->second;
    }
    Result<std::string> read = readFile(file->string());
    if (!read) {
      return failure("{}: {}", where, read.error().message);
    }
    return read_files_.emplace(file->string(), keep(std::move(*read))).first->second;
  }

  std::vector<std::unique_ptr<const std::string>> takeOwned() { return std::move(owned_); }

 private:
  std::string_view keep(std::string bytes) {
    return *owned_.emplace_back(std::make_unique<const std::string>(std::move(bytes)));
  }

  const std::string& base_dir_;
  std::map<std::string, std::string_view> read_files_;
  std::vector<std::unique_ptr<const std::string>> owned_;
};

}  // namespace

Result<Buffers> loadBuffers(const std::vector<BufferSource>& sources, const Container& container,
                            const std::string& base_dir, const std::string& name) {
  BufferLoader loader(base_dir);
  Buffers buffers;
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const BufferSource& source = sources[i];
    const std::string where = fmt::format("{}: buffer {}", name, i);
    std::string_view bytes;
    if (source.uri) {
      const Result<std::string_view> loaded = loader.load(*source.uri, where);
      if (!loaded) {
        return loaded.error();
      }
      bytes = *loaded;
    } else if (i == 0 && container.binary_chunk) {
      bytes = *container.binary_chunk;
    } else {
      // No bytes anywhere: a place-holder of an extension. Whoever uses it gets an error.
      buffers.bytes.push_back({});
      continue;
    }
    if (source.byte_length > bytes.size()) {
      return failure("{}: states {} bytes, but has only {}", where, source.byte_length, bytes.size());
    }
    buffers.bytes.push_back(bytes.substr(0, source.byte_length));
  }
  buffers.owned = loader.takeOwned();
  return buffers;
}

}  // namespace sightline::io
