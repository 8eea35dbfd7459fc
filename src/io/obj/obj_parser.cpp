#include <array>
#include <charconv>
#include <limits>
#include <map>
#include <optional>

#include "src/io/failure.h"
#include "src/io/obj/obj_file.h"
#include "src/io/obj/obj_lines.h"
#include "src/io/scene_builder.h"

namespace sightline::io {
namespace {

class ObjParser {
 public:
  ObjParser(std::string_view bytes, const std::string& name) : statements_(bytes), name_(name) {}

  Result<ObjFile> parse() {
    while (statements_.next()) {
      const Status status = readStatement();
      if (!status) {
        return status.error();
      }
    }
    closePart();
    const auto face_count = static_cast<std::uint32_t>(file_.faces.size());
    file_.faces.push_back({static_cast<std::uint32_t>(file_.corners.size()), 0});
    file_.parts.push_back({0, ObjFile::kNoMaterial, face_count});
    if (const Status status = checkCorners(); !status) {
      return status.error();
    }
    return std::move(file_);
  }

 private:
  template <typename... Args>
  Error failureHere(fmt::format_string<Args...> text, Args&&... args) const {
    return failure("{}: line {}: {}", name_, statements_.line(),
                   fmt::format(text, std::forward<Args>(args)...));
  }

  Status readStatement() {
    const std::string_view keyword = statements_.keyword();
    if (isKeyword(keyword, "v")) {
      return readVertex();
    }
    if (isKeyword(keyword, "f") || isKeyword(keyword, "fo")) {  // fo: what f was called in old files
      return readFace();
    }
    if (isKeyword(keyword, "usemtl")) {
      useMaterial();
    } else if (isKeyword(keyword, "o")) {
      beginObject(nameWithoutComment(statements_.value()));
    } else if (isKeyword(keyword, "g")) {
      // A group is an object, unless it goes on.
      const std::string_view group = nameWithoutComment(statements_.value());
      if (group != group_) {
        group_ = group;
        beginObject(group.empty() ? "default" : group, true);  // as the format calls that group
      }
    } else if (isKeyword(keyword, "mtllib")) {
      file_.libraries.emplace_back(statements_.value());
    }
    return Success{};  // normals, texture coordinates, points, lines, curves, smoothing and the like
  }

  // x y z, and then nothing, a weight, a colour of three or four numbers, or both.
  Status readVertex() {
    std::string_view value = withoutComment(statements_.value());
    std::array<double, 8> numbers{};
    std::size_t count = 0;
    for (std::string_view word = takeWord(value); !word.empty(); word = takeWord(value)) {
      const std::optional<double> number = numberOf(word);
      if (!number) {
        return failureHere("\"{}\" is not a number", excerpt(word));
      }
      if (count == numbers.size()) {
        return failureHere("a vertex has more than {} numbers; give x, y and z", numbers.size());
      }
      numbers[count++] = *number;
    }
    if (count < 3) {
      return failureHere("a vertex has {} numbers; give x, y and z", count);
    }
    const Vec3d position(numbers[0], numbers[1], numbers[2]);
    if (!SceneBuilder::inRange(position)) {
      return failureHere("a coordinate is not finite or exceeds single precision");
    }
    // Which of them a face may use is known at the end.
    if ((count == 4 || count == 8) && numbers[3] != 1.0) {
      weighted_.try_emplace(static_cast<std::uint32_t>(file_.vertices.size()), statements_.line());
    }
    // The last one of seven may be the opacity, or the blue of a colour that follows a weight.
    if (count >= 7 && numbers[count - 1] < 1.0) {
      file_.see_through.push_back(static_cast<std::uint32_t>(file_.vertices.size()));
    }
    if (file_.vertices.size() >= kMost) {
      return failureHere("the file has more than {} vertices", kMost);
    }
    file_.vertices.push_back(position);
    return Success{};
  }

  Status readFace() {
    std::string_view value = withoutComment(statements_.value());
    const std::size_t first = file_.corners.size();
    for (std::string_view word = takeWord(value); !word.empty(); word = takeWord(value)) {
      const std::optional<std::int64_t> number = vertexOf(word);
      if (!number) {
        return failureHere("\"{}\" is not a corner of a face; give v, v/vt, v//vn or v/vt/vn", excerpt(word));
      }
      // Counted from the first one, or back from the last one up to here.
      const auto count = static_cast<std::int64_t>(file_.vertices.size());
      const std::int64_t index = *number > 0 ? *number - 1 : count + *number;
      if (*number == 0 || index < 0) {
        return failureHere("the face has the vertex {}, and {} are there so far", *number, count);
      }
      if (static_cast<std::uint64_t>(index) >= kMost) {
        return failureHere("the face has the vertex {}; at most {} are read", *number, kMost);
      }
      file_.corners.push_back(static_cast<std::uint32_t>(index));
    }
    if (file_.corners.size() - first < 3) {
      file_.corners.resize(first);
      return Success{};  // a point or a line
    }
    if (file_.corners.size() > kMost) {
      return failureHere("the file's faces have more than {} corners", kMost);
    }
    if (file_.objects.empty()) {
      beginObject("defaultobject");
    }
    file_.faces.push_back({static_cast<std::uint32_t>(first), statements_.line()});
    return Success{};
  }

  // The number before the first slash; nothing if the word is not of the form of a corner.
  static std::optional<std::int64_t> vertexOf(std::string_view word) {
    std::int64_t number = 0;
    const char* const end = word.data() + word.size();
    const auto [after, error] = std::from_chars(word.data(), end, number);
    const std::string_view rest(after, static_cast<std::size_t>(end - after));
    if (error != std::errc{} || (!rest.empty() && rest.front() != '/') ||
        rest.find_first_not_of("/-0123456789") != std::string_view::npos) {
      return std::nullopt;
    }
    return number;
  }

  void useMaterial() {
    const std::string value(statements_.value());
    std::uint32_t material = ObjFile::kNoMaterial;
    if (!value.empty()) {
      const auto [found, added] =
          numbers_.try_emplace(value, static_cast<std::uint32_t>(file_.materials.size()));
      if (added) {
        file_.materials.push_back(value);
      }
      material = found->second;
    }
    if (material != part_.material) {
      closePart();
      part_.material = material;
    }
  }

  void beginObject(std::string_view name, bool always = false) {
    if (!always && !file_.objects.empty() && file_.objects.back() == name) {
      return;
    }
    closePart();
    // Names of objects without faces are not kept.
    if (file_.parts.empty() || file_.parts.back().object + 1 != file_.objects.size()) {
      if (!file_.objects.empty()) {
        file_.objects.pop_back();
      }
    }
    file_.objects.emplace_back(name);
    part_.object = static_cast<std::uint32_t>(file_.objects.size() - 1);
  }

  void closePart() {
    if (part_.first_face < file_.faces.size()) {
      file_.parts.push_back(part_);
      part_.first_face = static_cast<std::uint32_t>(file_.faces.size());
    }
  }

  // Vertices may follow the faces that have them.
  Status checkCorners() const {
    for (std::size_t face = 0; face + 1 < file_.faces.size(); ++face) {
      for (std::uint32_t i = file_.faces[face].first_corner; i < file_.faces[face + 1].first_corner; ++i) {
        const std::uint32_t vertex = file_.corners[i];
        if (vertex >= file_.vertices.size()) {
          return failure("{}: line {}: the face has the vertex {}, and the file has {}", name_,
                         file_.faces[face].line, vertex + 1, file_.vertices.size());
        }
        if (weighted_.empty()) {
          continue;
        }
        if (const auto found = weighted_.find(vertex); found != weighted_.end()) {
          return failure(
              "{}: line {}: the vertex has a weight other than 1, which means nothing to the face in line "
              "{}; "
              "leave the weight out",
              name_, found->second, file_.faces[face].line);
        }
      }
    }
    return Success{};
  }

  static constexpr std::size_t kMost = 0xfffffff0u;  // of vertices, and of all faces' corners

  ObjStatements statements_;
  const std::string& name_;
  ObjFile file_;
  ObjFile::Part part_;
  std::string group_;
  std::map<std::string, std::uint32_t> numbers_;     // of materials
  std::map<std::uint32_t, std::uint32_t> weighted_;  // vertices with weights, and their lines
};

}  // namespace

Result<ObjFile> parseObj(std::string_view bytes, const std::string& name) {
  return ObjParser(bytes, name).parse();
}

std::vector<std::string> librariesOfObj(std::string_view bytes) {
  std::vector<std::string> values;
  for (ObjStatements statements(bytes); statements.next();) {
    if (isKeyword(statements.keyword(), "mtllib")) {
      values.emplace_back(statements.value());
    }
  }
  return values;
}

}  // namespace sightline::io
