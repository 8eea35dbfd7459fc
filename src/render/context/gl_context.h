#pragma once

// An OpenGL core context without a window or a display server.

#include <epoxy/egl.h>
#include <epoxy/gl.h>

#include <string>
#include <string_view>

#include "sightline/base/result.h"

namespace sightline::render {

// Owns an OpenGL context. All OpenGL objects made in it are freed with it.
class GlContext {
 public:
  static Result<GlContext> create();
  ~GlContext();
  GlContext(GlContext&& other) noexcept;
  GlContext& operator=(GlContext&& other) noexcept;

  std::string device() const { return device_; }

  // Makes a context current for the life of this object, then restores the one that was current before.
  class Current {
   public:
    explicit Current(const GlContext& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    EGLDisplay own_display_;
    EGLDisplay previous_display_;
    EGLContext previous_context_;
    EGLSurface previous_draw_, previous_read_;
    EGLenum previous_api_;
  };

 private:
  GlContext(EGLDisplay display, EGLContext context) : display_(display), context_(context) {}
  static Result<GlContext> createOn(EGLDisplay display);

  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
  std::string device_;
};

// Compiles and links a program; geometry may be null. The error carries the compiler's log. Precondition: a
// context is current.
Result<GLuint> makeProgram(std::string_view name, const char* vertex, const char* fragment,
                           const char* geometry = nullptr);

// A frame buffer of RGBA8 colour and 32-bit float depth.
struct Framebuffer {
  GLuint id = 0, color = 0, depth = 0;
  std::uint32_t width = 0, height = 0;
};
Result<Framebuffer> makeFramebuffer(std::uint32_t width, std::uint32_t height);
void destroy(Framebuffer& framebuffer);

}  // namespace sightline::render
