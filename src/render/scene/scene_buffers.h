#pragma once

// The scene's triangles in OpenGL: one vertex buffer, one index buffer, one colour for each object.
//
// Triangles lie in the index buffer by pass, then by object, so that an ascending list of objects becomes few
// contiguous ranges in each pass. Vertices carry the index of their object, so no state changes between
// objects; a position that two objects share is stored twice.

#include <epoxy/gl.h>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sightline/base/result.h"
#include "sightline/scene/scene.h"

namespace sightline::render {

// The passes in the order of drawing. Blended triangles share one pass, single-sided or not, because their
// order matters.
enum class Pass : std::uint8_t {
  kOpaque,
  kOpaqueDoubleSided,
  kAlphaTested,
  kAlphaTestedDoubleSided,
  kBlended
};
inline constexpr std::size_t kPassCount = 5;

// Contiguous ranges of the index buffer in the form that glMultiDrawElements takes.
class RangeList {
 public:
  void clear();
  void add(std::uint32_t first, std::uint32_t count);
  void draw() const;  // with the current program and state

  std::uint32_t size() const { return static_cast<std::uint32_t>(counts_.size()); }

 private:
  std::vector<GLsizei> counts_;
  std::vector<const void*> offsets_;  // bytes
  std::uint64_t end_ = 0;             // index after the last range
};

class SceneBuffers {
 public:
  // Precondition of all functions: the context is current. tints makes each object a little lighter or darker
  // than its material.
  static Result<SceneBuffers> create(const SceneView& scene, bool tints = true);

  struct Drawn {
    std::uint64_t triangles = 0;
    std::uint32_t ranges = 0;
  };
  // Sorts the objects' triangles by pass; drawPass() then draws them. mirrored has one entry for each object
  // of the scene, not 0 if a transform reverses the winding of its triangles; it is empty if none does.
  Drawn select(std::span<const ObjectId> objects, std::span<const std::uint8_t> mirrored = {});
  void drawPass(Pass pass) const;
  void drawAll() const;
  std::uint64_t blendedTriangles() const { return blended_triangles_; }  // among the selected ones

  // Binds the vertices and one of the two colour buffers (texture unit 0).
  void bind() const;
  void bindStateColors(std::span<const std::array<std::uint8_t, 4>> colors) const;

  std::uint32_t objectCount() const { return static_cast<std::uint32_t>(ranges_.size()); }

 private:
  struct ObjectRange {
    std::uint32_t first = 0, count = 0;  // in the index buffer
    Pass pass = Pass::kOpaque;
    bool double_sided = false;
  };
  // Which sides of triangles OpenGL discards, by the stored order of vertices.
  enum class Cull : std::uint8_t { kNothing, kBacks, kFronts };
  struct BlendedRun {
    RangeList ranges;
    Cull cull = Cull::kNothing;
  };
  static void use(Cull cull);
  void addBlended(const ObjectRange& range, Cull cull);

  std::vector<ObjectRange> ranges_;  // one an object
  std::array<RangeList, kPassCount> selected_, mirrored_;
  std::vector<BlendedRun>
      blended_;  // runs of equal culling; more than blended_count_ are kept for their memory
  std::size_t blended_count_ = 0;
  std::uint64_t blended_triangles_ = 0;
  std::uint32_t index_count_ = 0;
  GLuint vertex_array_ = 0, color_buffer_ = 0, color_texture_ = 0, state_buffer_ = 0, state_texture_ = 0;
};

}  // namespace sightline::render
