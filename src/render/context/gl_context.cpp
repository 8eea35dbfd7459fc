#include "src/render/context/gl_context.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <utility>
#include <vector>

namespace sightline::render {
namespace {

// Whether an OpenGL library is installed. libepoxy ends the process if there is none, so this is asked first.
bool openGlLibraryExists() {
  for (const char* name : {"libOpenGL.so.0", "libGL.so.1"}) {
    if (void* handle = dlopen(name, RTLD_LAZY | RTLD_LOCAL)) {
      dlclose(handle);
      return true;
    }
  }
  return false;
}

bool isSoftware(EGLDeviceEXT device) {
  const char* extensions = eglQueryDeviceStringEXT(device, EGL_EXTENSIONS);
  return !extensions ||
         std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos;
}

// Displays that need no window system: those of hardware first, then Mesa's choice, then the default display.
std::vector<EGLDisplay> candidateDisplays() {
  std::vector<EGLDisplay> displays;
  const auto has = [](const char* name) { return epoxy_has_egl_extension(EGL_NO_DISPLAY, name); };
  if (has("EGL_EXT_platform_base")) {
    if (has("EGL_EXT_platform_device") && (has("EGL_EXT_device_base") || has("EGL_EXT_device_enumeration"))) {
      std::array<EGLDeviceEXT, 16> devices{};
      EGLint count = 0;
      eglQueryDevicesEXT(static_cast<EGLint>(devices.size()), devices.data(), &count);
      for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
        if (!isSoftware(devices[i])) {
          displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_DEVICE_EXT, devices[i], nullptr));
        }
      }
    }
    if (has("EGL_MESA_platform_surfaceless")) {
      displays.push_back(eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA,
                                                  reinterpret_cast<void*>(EGL_DEFAULT_DISPLAY), nullptr));
    }
  }
  displays.push_back(eglGetDisplay(EGL_DEFAULT_DISPLAY));
  return displays;
}

EGLContext newContext(EGLDisplay display, EGLint minor) {
  const std::array<EGLint, 7> attributes{EGL_CONTEXT_MAJOR_VERSION,
                                         4,
                                         EGL_CONTEXT_MINOR_VERSION,
                                         minor,
                                         EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                         EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                         EGL_NONE};
  return eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, attributes.data());
}

const char* text(GLenum name) {
  const GLubyte* bytes = glGetString(name);
  return bytes ? reinterpret_cast<const char*>(bytes) : "unknown";
}

Result<GLuint> compileShader(std::string_view name, GLenum stage, const char* source) {
  const GLuint shader = glCreateShader(stage);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint compiled = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &compiled);
  if (compiled == GL_TRUE) {
    return shader;
  }
  std::array<char, 1024> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  glDeleteShader(shader);
  return Error{fmt::format("{}: a shader does not compile with the driver {}: {}", name, text(GL_VERSION),
                           log.data())};
}

}  // namespace

Result<GlContext> GlContext::create() {
  if (!openGlLibraryExists()) {
    return Error{"no OpenGL library is installed; install libopengl0 or libgl1 with Mesa's drivers"};
  }
  std::string reasons;
  for (EGLDisplay display : candidateDisplays()) {
    Result<GlContext> context = createOn(display);
    if (context) {
      return context;
    }
    reasons += (reasons.empty() ? "" : "; ") + context.error().message;
  }
  return Error{"no OpenGL context without a window: " + reasons +
               "; install Mesa's EGL and OpenGL drivers (libegl-mesa0, libgl1-mesa-dri) or those of the "
               "graphics card"};
}

// The display is never terminated: all users of EGL in the process share it.
Result<GlContext> GlContext::createOn(EGLDisplay display) {
  if (display == EGL_NO_DISPLAY || !eglInitialize(display, nullptr, nullptr)) {
    return Error{"an EGL display does not open"};
  }
  if (!epoxy_has_egl_extension(display, "EGL_KHR_surfaceless_context") ||
      !epoxy_has_egl_extension(display, "EGL_KHR_create_context")) {
    return Error{"EGL offers no context without a surface"};
  }
  const EGLenum previous_api = eglQueryAPI();
  eglBindAPI(EGL_OPENGL_API);
  EGLContext handle = newContext(display, 5);
  if (handle == EGL_NO_CONTEXT) {
    handle = newContext(display, 3);
  }
  eglBindAPI(previous_api);
  if (handle == EGL_NO_CONTEXT) {
    return Error{"the driver offers no OpenGL 4.3 core profile"};
  }
  GlContext context(display, handle);
  const Current current(context);
  if (eglGetCurrentContext() != handle) {
    return Error{"the driver's OpenGL context cannot be used without a surface"};
  }
  context.device_ = fmt::format("{}, OpenGL {}", text(GL_RENDERER), text(GL_VERSION));
  if (!epoxy_has_gl_extension("GL_ARB_clip_control") && epoxy_gl_version() < 45) {
    return Error{fmt::format("{} lacks GL_ARB_clip_control", context.device_)};
  }
  return context;
}

GlContext::~GlContext() {
  if (context_ != EGL_NO_CONTEXT) {
    eglDestroyContext(display_, context_);
  }
}

GlContext::GlContext(GlContext&& other) noexcept
    : display_(other.display_),
      context_(std::exchange(other.context_, EGL_NO_CONTEXT)),
      device_(std::move(other.device_)) {}

GlContext& GlContext::operator=(GlContext&& other) noexcept {
  std::swap(display_, other.display_);
  std::swap(context_, other.context_);
  std::swap(device_, other.device_);
  return *this;
}

GlContext::Current::Current(const GlContext& context)
    : own_display_(context.display_),
      previous_display_(eglGetCurrentDisplay()),
      previous_context_(eglGetCurrentContext()),
      previous_draw_(eglGetCurrentSurface(EGL_DRAW)),
      previous_read_(eglGetCurrentSurface(EGL_READ)),
      previous_api_(eglQueryAPI()) {
  eglBindAPI(EGL_OPENGL_API);
  eglMakeCurrent(own_display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_);
}

GlContext::Current::~Current() {
  if (previous_context_ == EGL_NO_CONTEXT) {
    eglMakeCurrent(own_display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    eglBindAPI(previous_api_);
  } else {
    eglBindAPI(previous_api_);
    eglMakeCurrent(previous_display_, previous_draw_, previous_read_, previous_context_);
  }
}

Result<GLuint> makeProgram(std::string_view name, const char* vertex, const char* fragment,
                           const char* geometry) {
  const GLuint program = glCreateProgram();
  const std::array<std::pair<GLenum, const char*>, 3> stages{
      {{GL_VERTEX_SHADER, vertex}, {GL_FRAGMENT_SHADER, fragment}, {GL_GEOMETRY_SHADER, geometry}}};
  for (const auto& [stage, source] : stages) {
    if (!source) {
      continue;
    }
    const Result<GLuint> shader = compileShader(name, stage, source);
    if (!shader) {
      return shader.error();
    }
    glAttachShader(program, *shader);
    glDeleteShader(*shader);
  }
  glLinkProgram(program);
  GLint linked = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked != GL_TRUE) {
    return Error{fmt::format("{}: the shaders do not link with the driver {}", name, text(GL_VERSION))};
  }
  return program;
}

Result<Framebuffer> makeFramebuffer(std::uint32_t width, std::uint32_t height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE, &largest);
  if (width == 0 || height == 0 || width > static_cast<std::uint32_t>(largest) ||
      height > static_cast<std::uint32_t>(largest)) {
    return Error{
        fmt::format("no picture of {} x {} pixels: each side must be 1 to {}", width, height, largest)};
  }
  Framebuffer f{.width = width, .height = height};
  const auto w = static_cast<GLsizei>(width);
  const auto h = static_cast<GLsizei>(height);
  glGenFramebuffers(1, &f.id);
  glGenRenderbuffers(1, &f.color);
  glGenRenderbuffers(1, &f.depth);
  glBindRenderbuffer(GL_RENDERBUFFER, f.color);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_RGBA8, w, h);
  glBindRenderbuffer(GL_RENDERBUFFER, f.depth);
  glRenderbufferStorage(GL_RENDERBUFFER, GL_DEPTH_COMPONENT32F, w, h);
  glBindFramebuffer(GL_FRAMEBUFFER, f.id);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, f.color);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, f.depth);
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    destroy(f);
    return Error{fmt::format("the driver makes no picture of {} x {} pixels", width, height)};
  }
  return f;
}

void destroy(Framebuffer& framebuffer) {
  glDeleteFramebuffers(1, &framebuffer.id);
  glDeleteRenderbuffers(1, &framebuffer.color);
  glDeleteRenderbuffers(1, &framebuffer.depth);
  framebuffer = {};
}

}  // namespace sightline::render
