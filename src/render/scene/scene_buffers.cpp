#include "src/render/scene/scene_buffers.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

namespace sightline::render {
namespace {

struct Vertex {
  Vec3f position;
  std::uint32_t object;
};
static_assert(sizeof(Vertex) == 16);

constexpr std::uint32_t kLargestRange = 0x7ffffff8u / 3u * 3u;  // whole triangles that a signed count holds

Pass passOf(const Material& material) {
  switch (material.opacity) {
    case Opacity::kOpaque:
      return material.double_sided ? Pass::kOpaqueDoubleSided : Pass::kOpaque;
    case Opacity::kAlphaTested:
      return material.double_sided ? Pass::kAlphaTestedDoubleSided : Pass::kAlphaTested;
    case Opacity::kBlended:
      return Pass::kBlended;
  }
  return Pass::kOpaque;
}

// A factor a little above or below 1 that depends on the object's index.
float tintOf(std::uint32_t object) {
  const std::uint32_t hash = (object * 2654435761u) >> 16;
  return 0.88f + 0.24f * static_cast<float>(hash & 0xffu) / 255.0f;
}

// The square root of the linear colour, made lighter or darker by the tint.
std::array<std::uint8_t, 4> colorOf(const Material& material, float tint) {
  std::array<std::uint8_t, 4> color{};
  for (std::size_t i = 0; i < 4; ++i) {
    const float linear = material.base_color[i];
    const float value =
        i < 3 ? std::sqrt(std::clamp(linear * tint, 0.0f, 1.0f)) : std::clamp(linear, 0.0f, 1.0f);
    color[i] = static_cast<std::uint8_t>(std::isfinite(value) ? value * 255.0f + 0.5f : 255.0f);
  }
  return color;
}

// Makes one vertex of each corner of an object, however many triangles share it.
class VertexBuilder {
 public:
  explicit VertexBuilder(const SceneView& scene) : scene_(scene), latest_(scene.positions.size()) {
    vertices_.reserve(scene.positions.size());
  }

  void add(std::uint32_t object, std::vector<std::uint32_t>& indices) {
    for (const std::uint32_t index : scene_.indicesOf(scene_.objects[object])) {
      Latest& latest = latest_[index];
      if (latest.object != object) {
        latest = {object, static_cast<std::uint32_t>(vertices_.size())};
        vertices_.push_back({scene_.positions[index], object});
      }
      indices.push_back(latest.vertex);
    }
  }
  std::span<const Vertex> vertices() const { return vertices_; }

 private:
  struct Latest {
    std::uint32_t object = std::numeric_limits<std::uint32_t>::max();
    std::uint32_t vertex = 0;
  };
  SceneView scene_;
  std::vector<Latest> latest_;  // one for each position: the last object that used it, and its vertex
  std::vector<Vertex> vertices_;
};

void uploadTriangles(std::span<const Vertex> vertices, std::span<const std::uint32_t> indices) {
  std::array<GLuint, 2> buffers{};
  glGenBuffers(2, buffers.data());
  glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size_bytes()), vertices.data(),
               GL_STATIC_DRAW);
  glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex), nullptr);
  glVertexAttribIPointer(1, 1, GL_UNSIGNED_INT, sizeof(Vertex),
                         reinterpret_cast<const void*>(offsetof(Vertex, object)));
  glEnableVertexAttribArray(0);
  glEnableVertexAttribArray(1);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size_bytes()), indices.data(),
               GL_STATIC_DRAW);
}

// Makes a buffer of RGBA8 colours and a texture by which shaders read it.
std::array<GLuint, 2> makeColorTexture() {
  std::array<GLuint, 2> buffer_texture{};
  glGenBuffers(1, &buffer_texture[0]);
  glGenTextures(1, &buffer_texture[1]);
  glBindBuffer(GL_TEXTURE_BUFFER, buffer_texture[0]);
  glBufferData(GL_TEXTURE_BUFFER, 4, nullptr, GL_DYNAMIC_DRAW);
  glBindTexture(GL_TEXTURE_BUFFER, buffer_texture[1]);
  glTexBuffer(GL_TEXTURE_BUFFER, GL_RGBA8, buffer_texture[0]);
  return buffer_texture;
}

void uploadColors(GLuint buffer, std::span<const std::array<std::uint8_t, 4>> colors) {
  glBindBuffer(GL_TEXTURE_BUFFER, buffer);
  glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(std::max<std::size_t>(colors.size_bytes(), 4)),
               nullptr, GL_DYNAMIC_DRAW);
  glBufferSubData(GL_TEXTURE_BUFFER, 0, static_cast<GLsizeiptr>(colors.size_bytes()), colors.data());
}

Status checkSize(const SceneView& scene) {
  std::uint64_t count = 0;
  for (const Object& object : scene.objects) {
    count += object.index_count;
  }
  GLint max_objects = 0;
  glGetIntegerv(GL_MAX_TEXTURE_BUFFER_SIZE, &max_objects);
  if (scene.objects.size() > static_cast<std::size_t>(max_objects)) {
    return Error{fmt::format("the scene's {} objects are more than the {} that the OpenGL driver can draw",
                             scene.objects.size(), max_objects)};
  }
  if (count >= std::numeric_limits<std::uint32_t>::max()) {
    return Error{fmt::format("the scene's {} triangles are more than can be drawn", count / 3)};
  }
  return Success{};
}

}  // namespace

void RangeList::clear() {
  counts_.clear();
  offsets_.clear();
  end_ = 0;
}

void RangeList::add(std::uint32_t first, std::uint32_t count) {
  if (!counts_.empty() && end_ == first &&
      static_cast<std::uint32_t>(counts_.back()) + count <= kLargestRange) {
    counts_.back() += static_cast<GLsizei>(count);
  } else {
    counts_.push_back(static_cast<GLsizei>(count));
    offsets_.push_back(
        reinterpret_cast<const void*>(static_cast<std::uintptr_t>(first) * sizeof(std::uint32_t)));
  }
  end_ = static_cast<std::uint64_t>(first) + count;
}

void RangeList::draw() const {
  if (!counts_.empty()) {
    glMultiDrawElements(GL_TRIANGLES, counts_.data(), GL_UNSIGNED_INT, offsets_.data(),
                        static_cast<GLsizei>(counts_.size()));
  }
}

Result<SceneBuffers> SceneBuffers::create(const SceneView& scene, bool tints) {
  if (Status fits = checkSize(scene); !fits) {
    return fits.error();
  }
  SceneBuffers b;
  b.ranges_.resize(scene.objects.size());
  VertexBuilder builder(scene);
  std::vector<std::uint32_t> indices;
  indices.reserve(scene.indices.size());
  std::vector<std::array<std::uint8_t, 4>> colors(scene.objects.size());
  for (std::size_t pass = 0; pass < kPassCount; ++pass) {
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i) {
      const Material& material = scene.materialOf(scene.objects[i]);
      if (static_cast<std::size_t>(passOf(material)) != pass) {
        continue;
      }
      b.ranges_[i] = {static_cast<std::uint32_t>(indices.size()), scene.objects[i].index_count,
                      passOf(material), material.double_sided};
      builder.add(i, indices);
      colors[i] = colorOf(material, tints ? tintOf(i) : 1.0f);
    }
  }
  b.index_count_ = static_cast<std::uint32_t>(indices.size());
  glGenVertexArrays(1, &b.vertex_array_);
  glBindVertexArray(b.vertex_array_);
  uploadTriangles(builder.vertices(), indices);
  const auto [color_buffer, color_texture] = makeColorTexture();
  uploadColors(color_buffer, colors);
  const auto [state_buffer, state_texture] = makeColorTexture();
  b.color_buffer_ = color_buffer;
  b.color_texture_ = color_texture;
  b.state_buffer_ = state_buffer;
  b.state_texture_ = state_texture;
  if (glGetError() == GL_OUT_OF_MEMORY) {
    return Error{fmt::format("the scene's {} triangles do not fit into OpenGL's memory", b.index_count_ / 3)};
  }
  return b;
}

SceneBuffers::Drawn SceneBuffers::select(std::span<const ObjectId> objects,
                                         std::span<const std::uint8_t> mirrored) {
  for (std::array<RangeList, kPassCount>* lists : {&selected_, &mirrored_}) {
    for (RangeList& ranges : *lists) {
      ranges.clear();
    }
  }
  blended_count_ = 0;
  blended_triangles_ = 0;
  Drawn drawn;
  for (const ObjectId id : objects) {
    const ObjectRange& range = ranges_[id.value];
    const bool mirror = !mirrored.empty() && mirrored[id.value] != 0;
    drawn.triangles += range.count / 3;
    if (range.pass == Pass::kBlended) {
      blended_triangles_ += range.count / 3;
      addBlended(range, range.double_sided ? Cull::kNothing : mirror ? Cull::kFronts : Cull::kBacks);
    } else {
      (mirror ? mirrored_ : selected_)[static_cast<std::size_t>(range.pass)].add(range.first, range.count);
    }
  }
  for (std::size_t pass = 0; pass < kPassCount; ++pass) {
    drawn.ranges += selected_[pass].size() + mirrored_[pass].size();
  }
  for (std::size_t i = 0; i < blended_count_; ++i) {
    drawn.ranges += blended_[i].ranges.size();
  }
  return drawn;
}

void SceneBuffers::addBlended(const ObjectRange& range, Cull cull) {
  if (blended_count_ == 0 || blended_[blended_count_ - 1].cull != cull) {
    if (blended_count_ == blended_.size()) {
      blended_.emplace_back();
    }
    blended_[blended_count_].ranges.clear();
    blended_[blended_count_].cull = cull;
    ++blended_count_;
  }
  blended_[blended_count_ - 1].ranges.add(range.first, range.count);
}

void SceneBuffers::use(Cull cull) {
  if (cull == Cull::kNothing) {
    glDisable(GL_CULL_FACE);
    return;
  }
  glEnable(GL_CULL_FACE);
  glCullFace(cull == Cull::kBacks ? GL_BACK : GL_FRONT);
}

void SceneBuffers::drawPass(Pass pass) const {
  if (pass == Pass::kBlended) {
    for (std::size_t i = 0; i < blended_count_; ++i) {
      use(blended_[i].cull);
      blended_[i].ranges.draw();
    }
    return;
  }
  const bool one_sided = pass == Pass::kOpaque || pass == Pass::kAlphaTested;
  use(one_sided ? Cull::kBacks : Cull::kNothing);
  selected_[static_cast<std::size_t>(pass)].draw();
  use(one_sided ? Cull::kFronts : Cull::kNothing);
  mirrored_[static_cast<std::size_t>(pass)].draw();
}

void SceneBuffers::drawAll() const {
  RangeList all;
  for (std::uint32_t first = 0; first < index_count_;
       first += std::min(kLargestRange, index_count_ - first)) {
    all.add(first, std::min(kLargestRange, index_count_ - first));
  }
  all.draw();
}

void SceneBuffers::bind() const {
  glBindVertexArray(vertex_array_);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_BUFFER, color_texture_);
}

void SceneBuffers::bindStateColors(std::span<const std::array<std::uint8_t, 4>> colors) const {
  bind();
  uploadColors(state_buffer_, colors);
  glBindTexture(GL_TEXTURE_BUFFER, state_texture_);
}

}  // namespace sightline::render
