// A frame loop over a world that changes, with OpenGL: two eyes in one call, the sun's shadows in three
// cascades, things that move, come and go. Draws without a window, and compares each frame with one in which
// everything is drawn: the pictures must be the same.
//
//   draw_world [FRAMES [PICTURE.ppm]]

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sightline/scene/camera.h"
#include "sightline/world/shadow_casters.h"
#include "sightline/world/world.h"
#include "sightline/world/world_culler.h"

using namespace sightline;

namespace {

constexpr int kWidth = 640, kHeight = 480;  // of an eye's picture
constexpr int kMap = 2048, kCascades = 3;   // texels of a side of a shadow map
constexpr std::array<double, kCascades + 1> kSplits{0.1, 18.0, 60.0, 220.0};  // metres
const Vec3d kSun = normalized(Vec3d(-0.5, -0.8, 0.35));                       // where its light goes

// What a program keeps of an instance.
struct Thing {
  InstanceId id;
  Mat4 world_from_mesh;
  std::array<float, 4> color;
};

// ---------------------------------------------------------------- OpenGL

bool makeContext() {
  const EGLDisplay display =
      eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  const std::array<EGLint, 7> wanted{EGL_CONTEXT_MAJOR_VERSION,
                                     4,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     3,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_NONE};
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE ||
      eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) {
    return false;
  }
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted.data());
  return context != EGL_NO_CONTEXT &&
         eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
}

// An instance is drawn by its id: `drawn` has those that the culler kept.
constexpr const char* kInstances = R"(#version 430
layout(location = 0) in vec3 position;
struct Instance { mat4 world_from_mesh; vec4 color; };
layout(std430, binding = 0) readonly buffer Instances { Instance instances[]; };
layout(std430, binding = 1) readonly buffer Drawn { uint drawn[]; };
uniform mat4 clip_from_world;
)";
constexpr const char* kDepthVertex = R"(
void main() { gl_Position = clip_from_world * (instances[drawn[gl_InstanceID]].world_from_mesh * vec4(position, 1)); }
)";
constexpr const char* kDepthFragment = "#version 430\nvoid main() {}\n";
constexpr const char* kVertex = R"(
out vec3 world;
flat out vec4 color;
void main() {
  Instance instance = instances[drawn[gl_InstanceID]];
  vec4 at = instance.world_from_mesh * vec4(position, 1);
  world = at.xyz;
  color = instance.color;
  gl_Position = clip_from_world * at;
}
)";
constexpr const char* kFragment = R"(#version 430
in vec3 world;
flat in vec4 color;
out vec4 shown;
uniform mat4 map_from_world[3];
uniform vec3 to_sun;
uniform vec3 eye;
uniform sampler2DArray maps;
void main() {
  vec3 normal = normalize(cross(dFdx(world), dFdy(world)));
  float light = max(dot(normal, to_sun), 0.0);
  for (int i = 0; i < 3; ++i) {
    vec3 at = (map_from_world[i] * vec4(world + 0.06 * normal, 1)).xyz * 0.5 + 0.5;
    if (all(greaterThan(at, vec3(0.0))) && all(lessThan(at, vec3(1.0)))) {
      light *= texture(maps, vec3(at.xy, i)).r < at.z - 0.0005 ? 0.0 : 1.0;
      break;
    }
  }
  float haze = 1.0 - exp(-distance(world, eye) / 260.0);
  vec3 lit = color.rgb * (0.35 + 0.12 * normal.y + 0.65 * light);
  shown = vec4(mix(lit, vec3(0.75, 0.82, 0.9), haze), 1);
}
)";

GLuint makeShader(GLenum stage, const std::string& text) {
  const GLuint shader = glCreateShader(stage);
  const char* const source = text.c_str();
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  if (log[0] != 0) {
    std::fprintf(stderr, "%s\n", log.data());
  }
  return shader;
}

GLuint makeProgram(const char* vertex, const char* fragment) {
  const GLuint program = glCreateProgram();
  glAttachShader(program, makeShader(GL_VERTEX_SHADER, std::string(kInstances) + vertex));
  glAttachShader(program, makeShader(GL_FRAGMENT_SHADER, fragment));
  glLinkProgram(program);
  return program;
}

// Transforms are made in double precision and uploaded in single precision.
void setMatrix(GLuint program, const char* name, const Mat4& m) {
  std::array<float, 16> values;
  for (std::size_t i = 0; i < 16; ++i) {
    values[i] = static_cast<float>(m.m[i]);
  }
  glProgramUniformMatrix4fv(program, glGetUniformLocation(program, name), 1, GL_FALSE, values.data());
}

void setVector(GLuint program, const char* name, const Vec3d& v) {
  glProgramUniform3f(program, glGetUniformLocation(program, name), static_cast<float>(v.x),
                     static_cast<float>(v.y), static_cast<float>(v.z));
}

class Painter {
 public:
  Painter(const std::vector<float>& positions, const std::vector<std::uint16_t>& indices)
      : index_count_(static_cast<GLsizei>(indices.size())) {
    color_program_ = makeProgram(kVertex, kFragment);
    depth_program_ = makeProgram(kDepthVertex, kDepthFragment);
    std::array<GLuint, 4> buffers;
    glGenBuffers(4, buffers.data());
    instances_ = buffers[2], drawn_ = buffers[3];
    GLuint vertices = 0;
    glGenVertexArrays(1, &vertices);
    glBindVertexArray(vertices);
    glBindBuffer(GL_ARRAY_BUFFER, buffers[0]);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(positions.size() * sizeof(float)), positions.data(),
                 GL_STATIC_DRAW);
    glVertexAttribPointer(0, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
    glEnableVertexAttribArray(0);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, buffers[1]);
    glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(indices.size() * sizeof(std::uint16_t)),
                 indices.data(), GL_STATIC_DRAW);
    std::array<GLuint, 2> textures;
    glGenTextures(2, textures.data());
    maps_ = textures[0];
    glBindTexture(GL_TEXTURE_2D_ARRAY, maps_);
    glTexStorage3D(GL_TEXTURE_2D_ARRAY, 1, GL_DEPTH_COMPONENT32F, kMap, kMap, kCascades);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(GL_TEXTURE_2D_ARRAY, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    std::array<GLuint, 2> targets;
    glGenFramebuffers(2, targets.data());
    map_target_ = targets[0], target_ = targets[1];
    glBindFramebuffer(GL_FRAMEBUFFER, target_);
    std::array<GLuint, 2> storage;
    glGenRenderbuffers(2, storage.data());
    glBindRenderbuffer(GL_RENDERBUFFER, storage[0]);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, 2 * kWidth, kHeight);
    glBindRenderbuffer(GL_RENDERBUFFER, storage[1]);
    glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, 2 * kWidth, kHeight);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, storage[0]);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, storage[1]);
    glEnable(GL_DEPTH_TEST);
    glEnable(GL_CULL_FACE);
    glClearColor(0.75f, 0.82f, 0.9f, 1.0f);
    setVector(color_program_, "to_sun", -kSun);
  }

  // things: by InstanceId.
  void upload(const std::vector<Thing>& things) {
    std::vector<float> values;
    for (const Thing& thing : things) {
      for (const double element : thing.world_from_mesh.m) {
        values.push_back(static_cast<float>(element));
      }
      values.insert(values.end(), thing.color.begin(), thing.color.end());
    }
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, instances_);
    glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof(float)),
                 values.data(), GL_STREAM_DRAW);
  }
  void drawMap(int cascade, const View& light, std::span<const InstanceId> casters) {
    glBindFramebuffer(GL_FRAMEBUFFER, map_target_);
    glFramebufferTextureLayer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, maps_, 0, cascade);
    glViewport(0, 0, kMap, kMap);
    glClear(GL_DEPTH_BUFFER_BIT);
    const Mat4 map_from_world = clipFromScene(light);
    setMatrix(depth_program_, "clip_from_world", map_from_world);
    setMatrix(color_program_, ("map_from_world[" + std::to_string(cascade) + "]").c_str(), map_from_world);
    draw(depth_program_, casters);
  }
  void drawEyes(std::span<const View, 2> eyes, std::span<const InstanceId> visible) {
    glBindFramebuffer(GL_FRAMEBUFFER, target_);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    for (int eye = 0; eye < 2; ++eye) {
      glViewport(eye * kWidth, 0, kWidth, kHeight);
      const View& view = eyes[static_cast<std::size_t>(eye)];
      setMatrix(color_program_, "clip_from_world", clipFromScene(view));
      setVector(color_program_, "eye", view.eye);
      draw(color_program_, visible);
    }
  }
  std::vector<std::uint8_t> picture() {
    std::vector<std::uint8_t> rgb(std::size_t{2 * kWidth} * kHeight * 3);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, target_);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, 2 * kWidth, kHeight, GL_RGB, GL_UNSIGNED_BYTE, rgb.data());
    return rgb;
  }

 private:
  void draw(GLuint program, std::span<const InstanceId> ids) {
    glUseProgram(program);
    glBindTexture(GL_TEXTURE_2D_ARRAY, program == color_program_ ? maps_ : 0);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, drawn_);
    // An InstanceId is a 32-bit number, so the answer is uploaded as it is.
    glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(ids.size_bytes()), ids.data(),
                 GL_STREAM_DRAW);
    glDrawElementsInstanced(GL_TRIANGLES, index_count_, GL_UNSIGNED_SHORT, nullptr,
                            static_cast<GLsizei>(ids.size()));
  }

  GLsizei index_count_;
  GLuint color_program_ = 0, depth_program_ = 0, instances_ = 0, drawn_ = 0, maps_ = 0, map_target_ = 0,
         target_ = 0;
};

// ---------------------------------------------------------------- the world

Mat4 placed(const Vec3d& at, const Vec3d& size, double turn = 0.0) {
  const double c = std::cos(turn), s = std::sin(turn);
  Mat4 m;
  m(0, 0) = c * size.x, m(0, 2) = s * size.z, m(1, 1) = size.y, m(2, 0) = -s * size.x, m(2, 2) = c * size.z;
  for (int axis = 0; axis < 3; ++axis) {
    m(axis, 3) = at[axis];
  }
  return m;
}

class Town {
 public:
  Town() {
    for (int i = 0; i < 8; ++i) {
      positions_.insert(positions_.end(), {(i & 1) != 0 ? 0.5f : -0.5f, (i & 2) != 0 ? 1.0f : 0.0f,
                                           (i & 4) != 0 ? 0.5f : -0.5f});
    }
    indices_ = {0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6, 0, 1, 5, 0, 5, 4,
                2, 6, 7, 2, 7, 3, 0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5};
    Result<WorldMesh> mesh = makeMesh({.positions = positions_.data(),
                                       .vertex_count = 8,
                                       .indices = indices_.data(),
                                       .index_bytes = 2,
                                       .index_count = indices_.size()});
    if (!mesh) {
      std::fprintf(stderr, "draw_world: %s\n", mesh.error().message.c_str());
      std::exit(1);
    }
    box_ = world_.addMesh(std::move(*mesh));
    build();
  }

  // Cars drive, crates come and go, and a house is pulled down.
  void change(int frame) {
    for (std::size_t i = 0; i < cars_.size(); ++i) {
      const double lane = i % 2 == 0 ? -2.2 : 2.2, speed = i % 2 == 0 ? 0.25 : -0.25;
      const double z = std::fmod(400.0 + 14.0 * static_cast<double>(i) + speed * frame, 240.0) - 120.0;
      move(cars_[i], placed({lane + 30.0 * static_cast<double>(i % 3) - 30.0, 0.0, z}, {1.8, 1.5, 4.2}));
    }
    for (int i = 0; i < 4; ++i) {
      const std::size_t which = static_cast<std::size_t>(frame * 4 + i) % crates_.size();
      world_.remove(crates_[which]);
      crates_[which] = add(anywhereOnAStreet(), {0.8f, 0.55f, 0.25f, 1.0f});
    }
    if (frame == 60) {
      world_.remove(pulled_down_);
    }
    world_.tidy();
  }

  const World& world() const { return world_; }
  const std::vector<Thing>& things() const { return things_; }
  const std::vector<float>& positions() const { return positions_; }
  const std::vector<std::uint16_t>& indices() const { return indices_; }
  // All ids that are there, as a program without culling draws them.
  std::vector<InstanceId> all() const {
    std::vector<InstanceId> ids;
    for (const Thing& thing : things_) {
      if (world_.has(thing.id)) {
        ids.push_back(thing.id);
      }
    }
    return ids;
  }

 private:
  InstanceId add(const Mat4& m, const std::array<float, 4>& color) {
    const InstanceId id = world_.add({.mesh = box_, .world_from_mesh = m});
    things_.resize(world_.idBound());
    things_[id.value] = {id, m, color};
    return id;
  }
  void move(InstanceId id, const Mat4& m) {
    world_.setTransform(id, m);
    things_[id.value].world_from_mesh = m;
  }
  double chance() {
    seed_ = seed_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(seed_ >> 40) * 0x1p-24;
  }
  Mat4 anywhereOnAStreet() {
    const double size = 0.5 + chance();
    const double along = 240.0 * chance() - 120.0, across = 30.0 * std::floor(7.0 * chance()) - 90.0;
    const double beside = across + (chance() < 0.5 ? -4.6 : 4.6);
    return placed(chance() < 0.5 ? Vec3d(beside, 0, along) : Vec3d(along, 0, beside), {size, size, size},
                  3.0 * chance());
  }
  void build() {
    add(placed({0, -1, 0}, {300, 1, 300}), {0.42f, 0.43f, 0.42f, 1.0f});
    for (int x = -4; x < 4; ++x) {
      for (int z = -4; z < 4; ++z) {
        const Vec3d at(30.0 * x + 15.0, 0.0, 30.0 * z + 15.0);
        const float shade = 0.55f + 0.35f * static_cast<float>(chance());
        const InstanceId house = add(placed(at, {18, 5.0 + 22.0 * chance() * chance(), 18}),
                                     {shade, 0.9f * shade, 0.75f * shade, 1.0f});
        pulled_down_ = x == -1 && z == -3 ? house : pulled_down_;
        for (int i = 0; i < 12; ++i) {  // what is in its yard
          const double size = 0.4 + 1.2 * chance(), angle = 6.28 * chance();
          add(placed(at + Vec3d(10.2 * std::cos(angle), 0, 10.2 * std::sin(angle)), {size, 2 * size, size},
                     angle),
              {0.25f, 0.5f + 0.2f * static_cast<float>(chance()), 0.25f, 1.0f});
        }
      }
    }
    for (int i = 0; i < 60; ++i) {
      cars_.push_back(add(placed({0, 0, 0}, {1, 1, 1}), {i % 2 == 0 ? 0.75f : 0.2f, 0.2f, 0.55f, 1.0f}));
    }
    for (int i = 0; i < 300; ++i) {
      crates_.push_back(add(anywhereOnAStreet(), {0.8f, 0.55f, 0.25f, 1.0f}));
    }
  }

  World world_;
  MeshId box_;
  std::vector<float> positions_;
  std::vector<std::uint16_t> indices_;
  std::vector<Thing> things_;  // by InstanceId
  std::vector<InstanceId> cars_, crates_;
  InstanceId pulled_down_;
  std::uint64_t seed_ = 7;
};

// ---------------------------------------------------------------- views

View cameraAt(int frame) {
  View view;
  view.eye = {0.0, 1.7, 100.0 - 0.5 * frame};
  setOrientation(view, {0.35 * std::sin(0.03 * frame), 0.02, -1}, {0, 1, 0});
  view.aspect = double{kWidth} / kHeight;
  view.z_near = kSplits[0];
  view.z_far = kSplits[kCascades];
  return view;
}

// The sun's view of the sphere around what the camera has between two depths; in steps of whole texels, so
// that shadows do not swim.
View cascade(const View& view, int i) {
  const double near = kSplits[static_cast<std::size_t>(i)], far = kSplits[static_cast<std::size_t>(i) + 1];
  const double wide = std::hypot(view.tan_half_fovy, view.tan_half_fovy * view.aspect);
  const double middle = std::min(0.5 * (near + far) * (1.0 + wide * wide), far);
  const double radius = std::hypot(far - middle, far * wide) + 0.1;
  View light;
  light.orthographic = true;
  light.ortho_height = 2.0 * radius;
  light.aspect = 1.0;
  setOrientation(light, kSun, {0, 1, 0});
  const Vec3d at = view.eye + view.forward * middle;
  const double texel = light.ortho_height / kMap;
  const Vec3d snapped = light.right * (std::floor(dot(light.right, at) / texel) * texel) +
                        light.up * (std::floor(dot(light.up, at) / texel) * texel) +
                        light.forward * dot(light.forward, at);
  light.z_near = 0.0;
  light.z_far = 2.0 * radius + 200.0;
  light.eye = snapped - light.forward * (radius + 200.0);  // 200 m: what may stand before the cascade
  return light;
}

bool writePicture(const std::vector<std::uint8_t>& rgb, const char* file) {
  std::FILE* const out = std::fopen(file, "wb");
  if (out == nullptr) {
    return false;
  }
  std::fprintf(out, "P6\n%d %d\n255\n", 2 * kWidth, kHeight);
  for (std::size_t row = kHeight; row-- > 0;) {
    std::fwrite(rgb.data() + row * 2 * kWidth * 3, 1, std::size_t{2 * kWidth} * 3, out);
  }
  return std::fclose(out) == 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int frames = argc > 1 ? std::atoi(argv[1]) : 120;
  if (!makeContext()) {
    std::fprintf(stderr, "there is no OpenGL 4.3 without a window here\n");
    return 77;
  }
  Town town;
  Painter painter(town.positions(), town.indices());
  WorldCuller culler;
  std::array<ShadowCasters, kCascades> suns;
  for (int i = 0; i < kCascades; ++i) {
    const double texel = cascade(cameraAt(0), i).ortho_height / kMap;
    suns[static_cast<std::size_t>(i)] = ShadowCasters({.filter = 2.0 * texel + 0.06});
  }
  std::size_t drawn = 0, cast = 0, all_drawn = 0, different = 0;
  for (int frame = 0; frame < frames; ++frame) {
    town.change(frame);
    painter.upload(town.things());
    const View camera = cameraAt(frame);
    std::array<View, 2> eyes{camera, camera};
    eyes[0].eye = camera.eye - camera.right * 0.032;
    eyes[1].eye = camera.eye + camera.right * 0.032;
    culler.cull(town.world(), eyes);  // what either eye sees
    for (int i = 0; i < kCascades; ++i) {
      ShadowCasters& sun = suns[static_cast<std::size_t>(i)];
      const View light = cascade(camera, i);
      sun.cull(town.world(), light, culler);
      painter.drawMap(i, light, sun.casters());
      cast += sun.casters().size();
    }
    painter.drawEyes(eyes, culler.visible());
    drawn += culler.visible().size();
    const std::vector<std::uint8_t> culled = painter.picture();
    if (frame + 1 == frames && argc > 2 && !writePicture(culled, argv[2])) {
      std::fprintf(stderr, "cannot write %s\n", argv[2]);
      return 1;
    }

    // The same without culling.
    const std::vector<InstanceId> all = town.all();
    for (int i = 0; i < kCascades; ++i) {
      painter.drawMap(i, cascade(camera, i), all);
    }
    painter.drawEyes(eyes, all);
    all_drawn += all.size();
    different += culled == painter.picture() ? 0 : 1;
  }
  const auto count = static_cast<double>(std::max(frames, 1));
  std::printf("%d frames with %s\n", frames, reinterpret_cast<const char*>(glGetString(GL_RENDERER)));
  std::printf("instances there: %.0f; drawn for both eyes: %.0f, into three shadow maps: %.0f\n",
              static_cast<double>(all_drawn) / count, static_cast<double>(drawn) / count,
              static_cast<double>(cast) / count);
  std::printf("frames that differ from those with everything drawn: %zu\n", different);
  return different == 0 ? 0 : 1;
}
