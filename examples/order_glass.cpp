// Draws see-through parts in OpenGL in the order that a LayerSorter finds, and beside it in the order of
// their distances, by depth peeling and by weighted blending: how long each takes, and how far it is from
// right.
//
//   order_glass [FRAMES]
//
// The loop to copy is drawInOrder(). Needs OpenGL 4.3 without a window, through EGL and libepoxy. Depth
// peeling of everything is the reference: it is right for each pixel, whatever the order of the parts.
// Based on: Everitt. Interactive Order-Independent Transparency. 2001 (from the back to the front here);
// McGuire, Bavoil. Weighted Blended Order-Independent Transparency. JCGT 2013.

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <numeric>
#include <random>
#include <vector>

#include "sightline/layers/layer_sorter.h"

using namespace sightline;

namespace {

constexpr int kWidth = 640, kHeight = 360;
constexpr float kNear = 0.1f, kFar = 50.0f;

struct Glass {
  Vec3d centre, half;
  Vec3d axis{0, 1, 0};
  bool turns = false;  // about the axis, through the centre
  std::array<float, 4> color{};
  Mat4 world_from_part;
};

Mat4 turned(const Glass& glass, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  const Vec3d& a = glass.axis;
  Mat4 m;
  for (int column = 0; column < 3; ++column) {
    Vec3d unit;
    unit[column] = glass.half[column];
    const Vec3d to = unit * c + cross(a, unit) * s + a * (dot(a, unit) * (1.0 - c));
    for (int row = 0; row < 3; ++row) {
      m(row, column) = to[row];
    }
  }
  for (int row = 0; row < 3; ++row) {
    m(row, 3) = glass.centre[row];
  }
  return m;
}

std::vector<Glass> makeRoom() {
  std::mt19937 random(1);
  const auto number = [&](double from, double to) {
    return from + (to - from) * (static_cast<double>(random()) / 4294967296.0);
  };
  std::vector<Glass> room;
  for (int i = 0; i < 64; ++i) {
    Glass glass;
    glass.centre = Vec3d(i % 4 - 1.5, i / 4 % 4 - 1.5, i / 16 - 1.5) * 1.5;
    glass.half = i % 5 == 0 ? Vec3d(0.3, 0.3, 0.3) : Vec3d(number(0.3, 0.45), number(0.2, 0.3), 0.02);
    glass.axis = normalized(Vec3d(number(-1, 1), number(-1, 1), number(-1, 1)));
    glass.turns = true;
    room.push_back(glass);
  }
  // Long panes between them, whose distances say little, and two that cross.
  for (int i = 0; i < 12; ++i) {
    room.push_back({Vec3d(0, i % 4 - 1.5, i / 4 - 1.0) * 1.5, {3.0, 0.35, 0.02}});
  }
  room.push_back({{0, 3.2, 0}, {1.0, 0.3, 0.02}});
  room.push_back({{0, 3.2, 0}, {0.02, 0.3, 1.0}});
  for (Glass& glass : room) {
    glass.color = {static_cast<float>(number(0, 1)), static_cast<float>(number(0, 1)),
                   static_cast<float>(number(0, 1)), static_cast<float>(number(0.3, 0.7))};
  }
  return room;
}

View viewOf(int frame) {
  const double angle = 0.02 * frame;
  View view;
  view.eye = {8.0 * std::sin(angle), 2.0, 8.0 * std::cos(angle)};
  setOrientation(view, -view.eye, {0, 1, 0});
  view.aspect = static_cast<double>(kWidth) / kHeight;
  return view;
}

// clip_from_world * world_from_part, as OpenGL takes it.
std::array<float, 16> clipFromPart(const View& view, const Mat4& world_from_part) {
  std::array<float, 16> clip{};
  const double near = double{kNear}, far = double{kFar};
  for (int column = 0; column < 4; ++column) {
    Vec3d v(world_from_part(0, column), world_from_part(1, column), world_from_part(2, column));
    v = column == 3 ? v - view.eye : v;
    const double depth = dot(v, view.forward);
    const double values[] = {
        dot(v, view.right) / (view.tan_half_fovy * view.aspect), dot(v, view.up) / view.tan_half_fovy,
        (depth * (far + near) - (column == 3 ? 2.0 * far * near : 0.0)) / (far - near), depth};
    for (int row = 0; row < 4; ++row) {
      clip[static_cast<std::size_t>(4 * column + row)] = static_cast<float>(values[row]);
    }
  }
  return clip;
}

bool makeContext() {
  EGLDisplay display = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, EGL_DEFAULT_DISPLAY, nullptr);
  if (display == EGL_NO_DISPLAY || eglInitialize(display, nullptr, nullptr) == EGL_FALSE ||
      eglBindAPI(EGL_OPENGL_API) == EGL_FALSE) {
    return false;
  }
  const EGLint wanted[] = {EGL_CONTEXT_MAJOR_VERSION, 4, EGL_CONTEXT_MINOR_VERSION, 3, EGL_NONE};
  const EGLContext context = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, wanted);
  return context != EGL_NO_CONTEXT &&
         eglMakeCurrent(display, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
}

GLuint makeProgram(const char* vertex, const char* fragment) {
  const GLuint program = glCreateProgram();
  for (const auto& [kind, text] : {std::pair(GL_VERTEX_SHADER, vertex), {GL_FRAGMENT_SHADER, fragment}}) {
    const GLuint shader = glCreateShader(static_cast<GLenum>(kind));
    glShaderSource(shader, 1, &text, nullptr);
    glCompileShader(shader);
    glAttachShader(program, shader);
  }
  glLinkProgram(program);
  GLint linked = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == GL_FALSE) {
    char log[1000] = "";
    glGetProgramInfoLog(program, sizeof log, nullptr, log);
    std::fprintf(stderr, "order_glass: %s\n", log);
    std::exit(1);
  }
  return program;
}

GLuint makeTexture(GLenum format) {
  GLuint texture = 0;
  glGenTextures(1, &texture);
  glBindTexture(GL_TEXTURE_2D, texture);
  glTexStorage2D(GL_TEXTURE_2D, 1, format, kWidth, kHeight);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  return texture;
}

GLuint makeTarget(std::initializer_list<GLuint> colors, GLuint depth) {
  GLuint target = 0;
  glGenFramebuffers(1, &target);
  glBindFramebuffer(GL_FRAMEBUFFER, target);
  std::vector<GLenum> buffers;
  for (const GLuint color : colors) {
    buffers.push_back(GL_COLOR_ATTACHMENT0 + static_cast<GLenum>(buffers.size()));
    glFramebufferTexture(GL_FRAMEBUFFER, buffers.back(), color, 0);
  }
  glDrawBuffers(static_cast<GLsizei>(buffers.size()), buffers.data());
  glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, depth, 0);
  return target;
}

// The corners of a cube's triangles come from their numbers, so there is no buffer of vertices.
constexpr const char* kVertex = R"(#version 430
uniform mat4 clip_from_part;
invariant gl_Position;
const int corners[36] = int[36](0,2,1, 1,2,3, 4,5,6, 5,7,6, 0,1,4, 1,5,4,
                                2,6,3, 3,6,7, 0,4,2, 2,4,6, 1,3,5, 3,7,5);
void main() {
  int c = corners[gl_VertexID];
  gl_Position = clip_from_part * vec4(vec3(c & 1, c >> 1 & 1, c >> 2) * 2.0 - 1.0, 1.0);
})";
// Discards what is not nearer than the last peel; that of a picture without peels is infinitely far.
constexpr const char* kFragment = R"(#version 430
uniform vec4 color;
uniform bool peel;
layout(binding = 0) uniform sampler2D behind;
layout(location = 0) out vec4 result;
void main() {
  if (peel && gl_FragCoord.z >= texelFetch(behind, ivec2(gl_FragCoord.xy), 0).r) discard;
  result = vec4(color.rgb * color.a, color.a);
})";
constexpr const char* kWeightedFragment = R"(#version 430
uniform vec4 color;
layout(location = 0) out vec4 sum;
layout(location = 1) out float through;
void main() {
  float weight = clamp(0.03 / (1e-5 + pow(1.0 / gl_FragCoord.w / 20.0, 4.0)), 0.01, 3000.0);
  sum = vec4(color.rgb * color.a, color.a) * weight;
  through = color.a;
})";
constexpr const char* kWholeVertex = R"(#version 430
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3 : -1, gl_VertexID == 2 ? 3 : -1, 0, 1); })";
constexpr const char* kResolveFragment = R"(#version 430
layout(binding = 0) uniform sampler2D sum;
layout(binding = 1) uniform sampler2D through;
layout(location = 0) out vec4 result;
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy);
  vec4 s = texelFetch(sum, at, 0);
  float opacity = 1.0 - texelFetch(through, at, 0).r;
  result = vec4(s.rgb / max(s.a, 1e-5) * opacity, opacity);
})";

class Loop {
 public:
  Loop() : room_(makeRoom()) {
    color_ = makeTexture(GL_RGBA16F), depth_ = makeTexture(GL_DEPTH_COMPONENT32F);
    peels_[0] = makeTexture(GL_DEPTH_COMPONENT32F), peels_[1] = makeTexture(GL_DEPTH_COMPONENT32F);
    sum_ = makeTexture(GL_RGBA16F), through_ = makeTexture(GL_R16F);
    picture_ = makeTarget({color_}, depth_), weighted_ = makeTarget({sum_, through_}, depth_);
    for (int i = 0; i < 2; ++i) {
      peel_targets_[i] = makeTarget({color_}, peels_[i]);
    }
    plain_ = makeProgram(kVertex, kFragment), weighing_ = makeProgram(kVertex, kWeightedFragment);
    resolve_ = makeProgram(kWholeVertex, kResolveFragment);
    glGenVertexArrays(1, &vertices_);
    glBindVertexArray(vertices_);
    glGenQueries(1, &query_);
    glViewport(0, 0, kWidth, kHeight);
    glEnable(GL_DEPTH_TEST);

    std::vector<Vec3d> corners;
    for (int i = 0; i < 8; ++i) {
      corners.emplace_back(i & 1 ? 1.0 : -1.0, i & 2 ? 1.0 : -1.0, i & 4 ? 1.0 : -1.0);
    }
    const HullId cube = sorter_.addHull(buildHull(corners).value());
    for (std::size_t i = 0; i < room_.size(); ++i) {
      sorter_.addPart({&cube, 1});
      all_.push_back(static_cast<std::uint32_t>(i));
    }
  }

  void beginFrame(int frame) {
    view_ = viewOf(frame);
    for (std::size_t i = 0; i < room_.size(); ++i) {
      room_[i].world_from_part =
          turned(room_[i], room_[i].turns ? 0.03 * frame + static_cast<double>(i) : 0.0);
    }
  }

  // The opaque things, which a depth buffer takes care of: a cross of two beams.
  void drawOpaque() {
    glBindFramebuffer(GL_FRAMEBUFFER, picture_);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LESS);
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    const float sky[] = {0.8f, 0.85f, 0.9f, 1.0f}, far = 1.0f;
    glClearBufferfv(GL_COLOR, 0, sky);
    glClearBufferfv(GL_DEPTH, 0, &far);
    use(plain_, false);
    for (const Vec3d& half : {Vec3d(3, 0.05, 0.05), Vec3d(0.05, 3, 0.05)}) {
      drawPart(plain_, turned({{0, 0, 0.75}, half}, 0.0), {0.2f, 0.2f, 0.2f, 1.0f});
    }
    glDepthMask(GL_FALSE);
  }

  // Sorts, then draws from the back to the front: of each part the far side, then the near side. Parts
  // without an order are peeled, which costs as much as they do and no more.
  void drawInOrder() {
    for (std::size_t i = 0; i < room_.size(); ++i) {
      sorter_.setTransform(PartId(i), room_[i].world_from_part);
    }
    const LayerOrder& order = sorter_.update(view_);
    startBlending();
    for (std::size_t g = order.groups(); g-- > 0;) {
      if (order.group(g).size() == 1) {
        drawConvex(order.group(g)[0].value);
        continue;
      }
      std::vector<std::uint32_t> parts;
      for (const PartId part : order.group(g)) {
        parts.push_back(part.value);
      }
      peel(parts);
      startBlending();
      peeled_ += parts.size();
    }
  }

  void drawByDistance() {
    std::vector<std::uint32_t> order = all_;
    const auto distance = [&](std::uint32_t i) { return length(room_[i].centre - view_.eye); };
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return distance(a) > distance(b); });
    startBlending();
    for (const std::uint32_t part : order) {
      drawConvex(part);
    }
  }

  void drawPeeled() { peel(all_); }

  void drawWeighted() {
    glBindFramebuffer(GL_FRAMEBUFFER, weighted_);
    const float zero[] = {0, 0, 0, 0}, one[] = {1, 1, 1, 1};
    glClearBufferfv(GL_COLOR, 0, zero);
    glClearBufferfv(GL_COLOR, 1, one);
    glDepthFunc(GL_LESS);
    glDisable(GL_CULL_FACE);
    glEnable(GL_BLEND);
    glBlendFunci(0, GL_ONE, GL_ONE);
    glBlendFunci(1, GL_ZERO, GL_ONE_MINUS_SRC_COLOR);
    use(weighing_, false);
    for (const std::uint32_t part : all_) {
      drawPart(weighing_, room_[part].world_from_part, room_[part].color);
    }
    glBindFramebuffer(GL_FRAMEBUFFER, picture_);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glDepthFunc(GL_ALWAYS);
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(GL_TEXTURE_2D, through_);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, sum_);
    glUseProgram(resolve_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
  }

  std::vector<float> readPicture() const {
    std::vector<float> pixels(std::size_t{4} * kWidth * kHeight);
    glBindFramebuffer(GL_FRAMEBUFFER, picture_);
    glReadPixels(0, 0, kWidth, kHeight, GL_RGBA, GL_FLOAT, pixels.data());
    return pixels;
  }
  std::size_t parts() const { return room_.size(); }
  std::size_t peeledParts() const { return peeled_; }

 private:
  void use(GLuint program, bool peel) const {
    glUseProgram(program);
    if (program == plain_) {
      glUniform1i(glGetUniformLocation(program, "peel"), peel ? 1 : 0);
    }
  }
  void drawPart(GLuint program, const Mat4& world_from_part, const std::array<float, 4>& color) const {
    glUniformMatrix4fv(glGetUniformLocation(program, "clip_from_part"), 1, GL_FALSE,
                       clipFromPart(view_, world_from_part).data());
    glUniform4fv(glGetUniformLocation(program, "color"), 1, color.data());
    glDrawArrays(GL_TRIANGLES, 0, 36);
  }
  void startBlending() const {
    glBindFramebuffer(GL_FRAMEBUFFER, picture_);
    glDepthFunc(GL_LESS);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
    glEnable(GL_CULL_FACE);
    use(plain_, false);
  }
  void drawConvex(std::uint32_t part) const {
    for (const GLenum hidden_side : {GL_FRONT, GL_BACK}) {
      glCullFace(hidden_side);
      drawPart(plain_, room_[part].world_from_part, room_[part].color);
    }
  }

  // Blends the farthest surfaces of these parts that are not in the picture yet, until there are none.
  void peel(const std::vector<std::uint32_t>& parts) const {
    const auto drawAll = [&] {
      for (const std::uint32_t part : parts) {
        drawPart(plain_, room_[part].world_from_part, room_[part].color);
      }
    };
    glDisable(GL_CULL_FACE);
    use(plain_, true);
    GLuint behind = depth_;
    for (std::size_t i = 0; i < 12 * parts.size(); ++i) {
      const std::size_t now = i % 2;
      glBindTexture(GL_TEXTURE_2D, behind);
      glBindFramebuffer(GL_FRAMEBUFFER, peel_targets_[now]);
      const float near = 0.0f;
      glDepthMask(GL_TRUE);
      glClearBufferfv(GL_DEPTH, 0, &near);
      glDepthFunc(GL_GREATER);
      glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
      glBeginQuery(GL_ANY_SAMPLES_PASSED, query_);
      drawAll();
      glEndQuery(GL_ANY_SAMPLES_PASSED);
      glDepthMask(GL_FALSE);
      glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
      GLuint any = 0;
      glGetQueryObjectuiv(query_, GL_QUERY_RESULT, &any);
      if (any == 0) {
        return;
      }
      glDepthFunc(GL_EQUAL);
      glEnable(GL_BLEND);
      glBlendFunc(GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
      drawAll();
      behind = peels_[now];
    }
  }

  std::vector<Glass> room_;
  std::vector<std::uint32_t> all_;
  LayerSorter sorter_;
  View view_;
  std::size_t peeled_ = 0;
  GLuint color_ = 0, depth_ = 0, peels_[2] = {0, 0}, sum_ = 0, through_ = 0;
  GLuint picture_ = 0, weighted_ = 0, peel_targets_[2] = {0, 0};
  GLuint plain_ = 0, weighing_ = 0, resolve_ = 0, vertices_ = 0, query_ = 0;
};

struct Method {
  const char* name;
  std::function<void()> draw;
  double ms = 0.0, sum = 0.0, largest = 0.0;
  std::size_t wrong = 0;  // pixels that differ from the reference by more than 4 of 255
};

void compare(const std::vector<float>& reference, const std::vector<float>& picture, Method& method) {
  for (std::size_t i = 0; i < reference.size(); i += 4) {
    double worst = 0.0;
    for (std::size_t c = i; c < i + 3; ++c) {
      worst = std::max(worst, 255.0 * std::abs(double{reference[c]} - double{picture[c]}));
      method.sum += 255.0 * std::abs(double{reference[c]} - double{picture[c]});
    }
    method.largest = std::max(method.largest, worst);
    method.wrong += worst > 4.0 ? 1 : 0;
  }
}

}  // namespace

int main(int count, char** arguments) {
  const int frames = count > 1 ? std::clamp(std::atoi(arguments[1]), 1, 10000) : 50;
  if (!makeContext()) {
    std::fprintf(stderr, "order_glass: no OpenGL 4.3 without a window\n");
    return 77;
  }
  Loop loop;
  Method methods[] = {{"depth peeling", [&] { loop.drawPeeled(); }},
                      {"sorted", [&] { loop.drawInOrder(); }},
                      {"by distance", [&] { loop.drawByDistance(); }},
                      {"weighted blending", [&] { loop.drawWeighted(); }}};
  std::vector<float> reference;
  for (int frame = 0; frame < frames; ++frame) {
    loop.beginFrame(frame);
    for (Method& method : methods) {
      loop.drawOpaque();
      glFinish();
      const auto start = std::chrono::steady_clock::now();
      method.draw();
      glFinish();
      method.ms +=
          std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
      const std::vector<float> picture = loop.readPicture();
      reference = &method == methods ? picture : reference;
      compare(reference, picture, method);
    }
  }
  const double pixels = static_cast<double>(frames) * kWidth * kHeight;
  std::printf("%-20s%12s%14s%14s%22s\n", "", "ms a frame", "mean of 255", "largest", "pixels beyond 4, %");
  for (const Method& method : methods) {
    std::printf("%-20s%12.2f%14.4f%14.1f%22.3f\n", method.name, method.ms / frames,
                method.sum / (3.0 * pixels), method.largest,
                100.0 * static_cast<double>(method.wrong) / pixels);
  }
  std::printf("%.1f of %zu parts a frame have no order and were peeled\n",
              static_cast<double>(loop.peeledParts()) / frames, loop.parts());
  return methods[1].wrong == 0 ? 0 : 1;  // sorted parts look as peeled ones do
}
