#include "src/io/gltf/gltf_json.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "src/io/failure.h"
#include "src/io/gltf/gltf_parts.h"
#include "src/io/gltf/gltf_schema.h"

namespace sightline::io {
namespace {

using nlohmann::json;

constexpr int kMaxNesting = 128;
constexpr double kLargestIndex = 0x1p31 - 1;
constexpr double kLargestSize = 0x1p53;

// Where a value stands, for errors: "mesh 3 primitive 0".
struct Where {
  const Where* parent = nullptr;
  const char* name = nullptr;
  std::ptrdiff_t number = -1;

  std::string text() const {
    const std::string before = parent == nullptr ? std::string() : parent->text();
    if (name == nullptr) {
      return before;
    }
    const std::string self = number < 0 ? std::string(name) : fmt::format("{} {}", name, number);
    return before.empty() ? self : fmt::format("{} {}", before, self);
  }
};

class Checker {
 public:
  Checker(const ImportLimits& limits, const std::string& name) : limits_(limits), name_(name) {}

  // Moves the known fields of an object from input to output. False: see error().
  bool object(json& input, std::span<const Field> fields, const Where& where, json& output) {
    if (!input.is_object()) {
      return fail(where, "must be an object, but is {}", input.type_name());
    }
    output = json::object();
    for (const Field& field : fields) {
      if (field.kind == Kind::kSets) {
        if (!sets(input, field, where, output[field.key])) {
          return false;
        }
        continue;
      }
      const auto found = input.find(field.key);
      if (found == input.end()) {
        if (field.required) {
          return fail(where, "\"{}\" is missing", field.key);
        }
        continue;
      }
      json checked;
      if (!value(*found, field, where, checked)) {
        return false;
      }
      if (!checked.is_null()) {
        output.emplace(field.key, std::move(checked));
      }
    }
    return true;
  }

  const Error& error() const { return error_; }

 private:
  bool value(json& input, const Field& field, const Where& where, json& output) {
    switch (field.kind) {
      case Kind::kIndex:
        return integer(input, field, kLargestIndex, where, output);
      case Kind::kSize:
        return integer(input, field, kLargestSize, where, output);
      case Kind::kNumber:
        return keep(input.is_number(), input, field, "a number", where, output);
      case Kind::kText:
        return keep(input.is_string(), input, field, "a string", where, output);
      case Kind::kFlag:
        return keep(input.is_boolean(), input, field, "true or false", where, output);
      case Kind::kNumbers:
        return keep(
            isArrayOf(input, &json::is_number) && (field.count == 0 || input.size() == field.count), input,
            field,
            field.count == 0 ? "an array of numbers" : fmt::format("an array of {} numbers", field.count),
            where, output);
      case Kind::kStride:
        return integer(input, field, 252, where, output) &&
               keep(output.get<int>() % 4 == 0, input, field, "a multiple of 4", where, output);
      case Kind::kElementType:
        return keep(isElementType(input), input, field, "SCALAR, VEC2, VEC3, VEC4, MAT2, MAT3 or MAT4", where,
                    output);
      case Kind::kTexts:
        return keep(isArrayOf(input, &json::is_string), input, field, "an array of strings", where, output);
      case Kind::kIndices:
        return indices(input, field, where, output);
      case Kind::kMark:
        return mark(input, where, output);
      case Kind::kObject: {
        const Where inside{&where, field.key};
        return object(input, field.fields, inside, output);
      }
      case Kind::kObjects:
        return objects(input, field, where, output);
      case Kind::kSets:
        break;  // has no key of its own: see object()
    }
    return false;
  }

  static bool isArrayOf(const json& input, bool (json::*is)() const noexcept) {
    return input.is_array() &&
           std::all_of(input.begin(), input.end(), [is](const json& item) { return (item.*is)(); });
  }

  static bool isElementType(const json& input) {
    constexpr std::array<const char*, 7> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4", "MAT2", "MAT3", "MAT4"};
    return input.is_string() && std::find(kTypes.begin(), kTypes.end(), input) != kTypes.end();
  }

  bool keep(bool valid, json& input, const Field& field, std::string_view wanted, const Where& where,
            json& output) {
    if (!valid) {
      return fail(where, "\"{}\" must be {}", field.key, wanted);
    }
    output = std::move(input);
    return true;
  }

  bool integer(const json& input, const Field& field, double largest, const Where& where, json& output) {
    const double number = input.is_number() ? input.get<double>() : -1.0;
    if (!(number >= 0.0 && number <= largest && number == std::floor(number))) {
      return fail(where, "\"{}\" must be an integer from 0 to {:.0f}, but is {}", field.key, largest,
                  input.is_number() ? input.dump() : input.type_name());
    }
    output = static_cast<std::uint64_t>(number);
    return true;
  }

  bool indices(const json& input, const Field& field, const Where& where, json& output) {
    if (!isArrayOf(input, &json::is_number)) {
      return fail(where, "\"{}\" must be an array of integers", field.key);
    }
    output = json::array();
    for (const json& item : input) {
      json checked;
      if (!integer(item, field, kLargestIndex, where, checked)) {
        return false;
      }
      output.push_back(std::move(checked));
    }
    return true;
  }

  bool sets(const json& input, const Field& field, const Where& where, json& output) {
    output = json::array();
    for (std::size_t i = 0;; ++i) {
      const std::string key = fmt::format("{}{}", field.key, i);
      const auto found = input.find(key);
      if (found == input.end()) {
        return true;
      }
      if (i == kMostSets) {
        return fail(where, "has more than {} sets {}n", kMostSets, field.key);
      }
      json checked;
      if (!integer(*found, {.key = key.c_str(), .kind = Kind::kIndex}, kLargestIndex, where, checked)) {
        return false;
      }
      output.push_back(std::move(checked));
    }
  }

  // Extras belong to everybody: only a key "occluder" in an object is ours, and must then be understood.
  bool mark(const json& input, const Where& where, json& output) {
    if (!input.is_object() || !input.contains("occluder")) {
      return true;
    }
    const json& occluder = input["occluder"];
    const bool truth = occluder == json(true) || occluder == json(1);
    if (!truth && occluder != json(false) && occluder != json(0)) {
      return fail(where, "extras: \"occluder\" must be true or false");
    }
    output = json{{"occluder", truth}};
    return true;
  }

  bool objects(json& input, const Field& field, const Where& where, json& output) {
    if (!input.is_array()) {
      return fail(where, "\"{}\" must be an array, but is {}", field.key, input.type_name());
    }
    const std::uint64_t most = field.few ? std::min<std::uint64_t>(kFew, limits_.elements) : limits_.elements;
    if (input.size() > most) {
      return fail(where, "\"{}\" has {} elements; at most {} are read", field.key, input.size(), most);
    }
    output = json::array();
    for (std::size_t i = 0; i < input.size(); ++i) {
      json checked;
      const Where item{&where, field.element, static_cast<std::ptrdiff_t>(i)};
      if (!object(input[i], field.fields, item, checked)) {
        return false;
      }
      output.push_back(std::move(checked));
    }
    return true;
  }

  template <typename... Args>
  bool fail(const Where& where, fmt::format_string<Args...> text, Args&&... args) {
    const std::string place = where.text();
    const std::string what = fmt::format(text, std::forward<Args>(args)...);
    error_ = place.empty() ? failure("{}: {}", name_, what) : failure("{}: {}: {}", name_, place, what);
    return false;
  }

  const ImportLimits& limits_;
  const std::string& name_;
  Error error_;
};

// Deepest nesting of arrays and objects, by a look at the brackets outside strings.
int nestingOf(std::string_view text) {
  int depth = 0;
  int deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      i += c == '\\' ? 1 : 0;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '[' || c == '{') {
      deepest = std::max(deepest, ++depth);
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return deepest;
}

Result<json> parseJson(std::string_view text, const std::string& name) {
  if (text.size() > 0x3fffffff) {
    return failure("{}: its JSON has {} bytes; at most 1 GiB is read", name, text.size());
  }
  if (nestingOf(text) > kMaxNesting) {
    return failure("{}: its JSON is nested more than {} levels deep", name, kMaxNesting);
  }
  try {
    return json::parse(text);
  } catch (const json::exception& exception) {
    return failure("{}: is not valid JSON: {}", name, jsonFault(exception));
  }
}

}  // namespace

Result<CheckedJson> checkJson(std::string_view text, const ImportLimits& limits, const std::string& name) {
  Result<json> parsed = parseJson(text, name);
  if (!parsed) {
    return parsed.error();
  }
  Checker checker(limits, name);
  json document;
  if (!checker.object(*parsed, documentSchema(), Where{}, document)) {
    return checker.error();
  }
  const std::string version = document["asset"]["version"];
  if (version.substr(0, 2) != "2.") {
    return failure("{}: is glTF version \"{}\"; only version 2 is supported", name, version);
  }
  CheckedJson checked;
  if (document.contains("extensionsUsed")) {
    checked.extensions_used = document["extensionsUsed"].get<std::vector<std::string>>();
  }
  if (document.contains("extensionsRequired")) {
    checked.extensions_required = document["extensionsRequired"].get<std::vector<std::string>>();
  }
  if (document.contains("buffers")) {
    for (const json& buffer : document["buffers"]) {
      BufferSource& source = checked.buffers.emplace_back();
      source.byte_length = buffer["byteLength"].get<std::uint64_t>();
      if (buffer.contains("uri")) {
        source.uri = buffer["uri"].get<std::string>();
      }
    }
  }
  checked.file = partsOf(document);
  return checked;
}

}  // namespace sightline::io
