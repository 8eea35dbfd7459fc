#include "sightline/io/camera_path_json.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>

#include "sightline/io/file.h"
#include "src/io/failure.h"
#include "src/io/point_json.h"

namespace sightline {

using namespace io;

namespace {

using nlohmann::json;

constexpr double kLargestSide = 65536.0;  // pixels

constexpr std::array<std::string_view, 9> kPathKeys{"name",  "fovy_deg", "ortho_height", "width", "height",
                                                    "shift", "near",     "far",          "frames"};
constexpr std::array<std::string_view, 3> kFrameKeys{"eye", "forward", "up"};

constexpr std::size_t kMaxUnknownKeys = 20;

void noteUnknownKeys(const json& object, std::span<const std::string_view> known,
                     std::optional<std::size_t> frame, std::vector<UnknownKey>& unknown) {
  for (const auto& item : object.items()) {
    const std::string& key = item.key();
    if (std::find(known.begin(), known.end(), key) != known.end()) {
      continue;
    }
    const auto noted = std::find_if(unknown.begin(), unknown.end(), [&](const UnknownKey& other) {
      return other.key == key && other.frame.has_value() == frame.has_value();
    });
    if (noted == unknown.end() && unknown.size() == kMaxUnknownKeys) {
      continue;
    }
    if (noted == unknown.end()) {
      unknown.push_back({key, frame, frame ? std::size_t{1} : 0, known});
    } else {
      noted->frames += 1;
    }
  }
}

void noteUnknownKeys(const json& document, std::vector<UnknownKey>& unknown) {
  if (!document.is_object()) {
    return;
  }
  noteUnknownKeys(document, kPathKeys, std::nullopt, unknown);
  const auto frames = document.find("frames");
  for (std::size_t i = 0; frames != document.end() && frames->is_array() && i < frames->size(); ++i) {
    if ((*frames)[i].is_object()) {
      noteUnknownKeys((*frames)[i], kFrameKeys, i, unknown);
    }
  }
}

Error missing(const std::string& where, const char* key, const char* wanted) {
  return failure("{}: \"{}\" must be {}", where, key, wanted);
}

// Replaces value when the key is there.
Status readNumber(const json& object, const char* key, const std::string& where, double& value) {
  const auto found = object.find(key);
  if (found == object.end()) {
    return Success{};
  }
  if (!found->is_number() || !std::isfinite(found->get<double>())) {
    return missing(where, key, "a finite number");
  }
  value = found->get<double>();
  return Success{};
}

Status readSide(const json& object, const char* key, const std::string& where, std::uint32_t& value) {
  double number = value;
  const Status status = readNumber(object, key, where, number);
  if (!status) {
    return status;
  }
  if (!(number >= 1.0 && number <= kLargestSide && number == std::floor(number))) {
    return missing(where, key, "a whole number of pixels from 1 to 65536");
  }
  value = static_cast<std::uint32_t>(number);
  return Success{};
}

// Replaces both values when the key is there.
Status readShift(const json& object, const char* key, const std::string& where, CameraPath& path) {
  const auto found = object.find(key);
  if (found == object.end()) {
    return Success{};
  }
  const auto inRange = [](const json& value) {
    return value.is_number() && std::abs(value.get<double>()) <= View::kMaxShift;
  };
  if (!(found->is_array() && found->size() == 2 && inRange((*found)[0]) && inRange((*found)[1]))) {
    return missing(where, key, "two numbers from -1000 to 1000");
  }
  path.shift_x = (*found)[0].get<double>();
  path.shift_y = (*found)[1].get<double>();
  return Success{};
}

Result<Vec3d> readVector(const json& object, const char* key, const std::string& where) {
  const auto found = object.find(key);
  if (found == object.end()) {
    return failure("{}: \"{}\" is missing", where, key);
  }
  const std::optional<Vec3d> vector = pointOf(*found);
  if (!vector) {
    return missing(where, key, "three finite numbers");
  }
  return *vector;
}

Result<CameraFrame> readFrame(const json& object, const std::string& where) {
  if (!object.is_object()) {
    return failure("{}: must be an object with \"eye\", \"forward\" and \"up\"", where);
  }
  const Result<Vec3d> eye = readVector(object, "eye", where);
  const Result<Vec3d> forward = readVector(object, "forward", where);
  const Result<Vec3d> up =
      object.contains("up") ? readVector(object, "up", where) : Result<Vec3d>(Vec3d(0, 1, 0));
  for (const Result<Vec3d>* vector : {&eye, &forward, &up}) {
    if (!*vector) {
      return vector->error();
    }
  }
  for (const auto& [key, direction] : {std::pair("forward", *forward), std::pair("up", *up)}) {
    // The square must neither vanish nor overflow, else the direction cannot be normalised.
    const double square = dot(direction, direction);
    if (!(square > 1e-200 && square < 1e200)) {
      return missing(where, key, "a direction, but is zero or of an unusable length");
    }
  }
  return CameraFrame{*eye, *forward, *up};
}

Status readProjection(const json& document, const std::string& name, CameraPath& path) {
  Status status = readNumber(document, "fovy_deg", name, path.fovy_deg);
  for (const auto& [key, value] : {std::pair("ortho_height", &path.ortho_height),
                                   std::pair("near", &path.z_near), std::pair("far", &path.z_far)}) {
    if (status) {
      status = readNumber(document, key, name, *value);
    }
  }
  for (const auto& [key, value] : {std::pair("width", &path.width), std::pair("height", &path.height)}) {
    if (status) {
      status = readSide(document, key, name, *value);
    }
  }
  if (status) {
    status = readShift(document, "shift", name, path);
  }
  if (!status) {
    return status;
  }
  if (!(path.fovy_deg > 0.0 && path.fovy_deg < 180.0)) {
    return missing(name, "fovy_deg", "between 0 and 180");
  }
  if (document.contains("ortho_height") && !(path.ortho_height > 0.0)) {
    return missing(name, "ortho_height", "greater than 0");
  }
  if (!(path.z_near > 0.0)) {
    return missing(name, "near", "greater than 0");
  }
  if (!(path.z_far > path.z_near)) {
    return missing(name, "far", "greater than \"near\"");
  }
  return Success{};
}

Result<CameraPath> readPath(const json& document, const std::string& name) {
  if (!document.is_object()) {
    return failure("{}: must be a JSON object with \"frames\"", name);
  }
  CameraPath path;
  path.name = std::filesystem::path(name).stem().string();
  if (document.contains("name") && document["name"].is_string()) {
    path.name = document["name"].get<std::string>();
  }
  const Status status = readProjection(document, name, path);
  if (!status) {
    return status.error();
  }
  const auto frames = document.find("frames");
  if (frames == document.end() || !frames->is_array() || frames->empty()) {
    return missing(name, "frames", "an array of at least one frame");
  }
  for (std::size_t i = 0; i < frames->size(); ++i) {
    const Result<CameraFrame> frame = readFrame((*frames)[i], fmt::format("{}: frame {}", name, i));
    if (!frame) {
      return frame.error();
    }
    path.frames.push_back(*frame);
  }
  return path;
}

}  // namespace

Result<CameraPath> parseCameraPath(std::string_view text, const std::string& name_in_errors,
                                   std::vector<UnknownKey>* unknown_keys) {
  try {
    const json document = json::parse(text);
    if (unknown_keys != nullptr) {
      noteUnknownKeys(document, *unknown_keys);
    }
    return readPath(document, name_in_errors);
  } catch (const std::exception& exception) {
    return failure("{}: is not valid JSON: {}", name_in_errors, jsonFault(exception));
  }
}

Result<CameraPath> readCameraPath(const std::string& file) {
  const Result<std::string> text = readFile(file);
  return text ? parseCameraPath(*text, file) : Result<CameraPath>(text.error());
}

std::string toJson(const CameraPath& path) {
  nlohmann::ordered_json document;
  document["name"] = path.name;
  if (path.ortho_height > 0.0) {
    document["ortho_height"] = path.ortho_height;
  } else {
    document["fovy_deg"] = path.fovy_deg;
  }
  document["width"] = path.width;
  document["height"] = path.height;
  if (path.shift_x != 0.0 || path.shift_y != 0.0) {
    document["shift"] = json::array({path.shift_x, path.shift_y});
  }
  document["near"] = path.z_near;
  document["far"] = path.z_far;
  document["frames"] = json::array();
  for (const CameraFrame& frame : path.frames) {
    document["frames"].push_back(
        {{"eye", pointJson(frame.eye)}, {"forward", pointJson(frame.forward)}, {"up", pointJson(frame.up)}});
  }
  // Invalid UTF-8 in a name must not throw.
  return document.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
}

}  // namespace sightline
