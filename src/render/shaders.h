#pragma once

// All shaders of the reference renderer, GLSL 4.30.
//
// Precision: positions are floats in scene space; the eye comes as two floats a coordinate (high + low), so
// that what is near the eye keeps the stored precision wherever the scene lies. Depth runs from 1 at the near
// plane to 0 at the far one, which spends a float's precision evenly over distance.

namespace sightline::shaders {

// One vertex a corner of an object. Colours come from a buffer, one an object, as square roots (which spends
// eight bits better); the plan view puts states in their place.
inline constexpr const char* kSceneVertex = R"(#version 430 core
layout(location = 0) in vec3 position;
layout(location = 1) in uint object;
uniform mat4 clip_from_relative;
uniform vec3 eye_high, eye_low;
uniform samplerBuffer colors;
uniform float depth_scale;  // 1 in pictures; less pushes everything away a little
out vec3 relative;
flat out vec4 color;
invariant gl_Position;
void main() {
  relative = (position - eye_high) - eye_low;
  color = texelFetch(colors, int(object));
  gl_Position = clip_from_relative * vec4(relative, 1.0);
  gl_Position.z *= depth_scale;
}
)";

// Sun, sky and a little difference between walls on flat faces; haze with distance.
#define SIGHTLINE_SHADE                                                                                  \
  "in vec3 relative;\n"                                                                                  \
  "flat in vec4 color;\n"                                                                                \
  "uniform float haze;\n"                                                                                \
  "out vec4 result;\n"                                                                                   \
  "vec4 shade() {\n"                                                                                     \
  "  vec3 n = cross(dFdx(relative), dFdy(relative));\n"                                                  \
  "  n *= inversesqrt(max(dot(n, n), 1e-36));\n"                                                         \
  "  float sun = max(dot(n, vec3(0.4286, 0.7845, 0.4482)), 0.0);\n"                                      \
  "  float sky = dot(n, vec3(0.035, 0.09, -0.02)) + 0.33;\n"                                             \
  "  vec3 lit = color.rgb * color.rgb * (sky * vec3(0.95, 1.0, 1.08) + sun * vec3(0.52, 0.49, 0.43));\n" \
  "  float fog = dot(relative, relative) * haze;\n"                                                      \
  "  fog = 0.75 * fog / (1.0 + fog);\n"                                                                  \
  "  return vec4(sqrt(mix(lit, vec3(0.66, 0.73, 0.80), fog)), color.a);\n"                               \
  "}\n"

inline constexpr const char* kSceneFragment =
    "#version 430 core\n" SIGHTLINE_SHADE "void main() { result = shade(); }\n";

// Foliage and fences: holes in a checkerboard of pixels, so that half of what is behind shows.
inline constexpr const char* kAlphaTestedFragment = "#version 430 core\n" SIGHTLINE_SHADE
                                                    "void main() {\n"
                                                    "  ivec2 p = ivec2(gl_FragCoord.xy);\n"
                                                    "  if (((p.x + p.y) & 1) != 0) discard;\n"
                                                    "  result = shade();\n"
                                                    "}\n";

#undef SIGHTLINE_SHADE

// Background: a gradient by elevation.
inline constexpr const char* kSkyVertex = R"(#version 430 core
uniform vec3 forward, right, up;
out vec3 direction;
void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  direction = forward + p.x * right + p.y * up;
  gl_Position = vec4(p, 0.0, 1.0);
}
)";
inline constexpr const char* kSkyFragment = R"(#version 430 core
in vec3 direction;
out vec4 result;
void main() {
  float h = normalize(direction).y;
  vec3 above = mix(vec3(0.81, 0.86, 0.90), vec3(0.36, 0.56, 0.80), sqrt(clamp(h, 0.0, 1.0)));
  vec3 below = mix(vec3(0.81, 0.86, 0.90), vec3(0.55, 0.53, 0.50), sqrt(clamp(-4.0 * h, 0.0, 1.0)));
  result = vec4(h >= 0.0 ? above : below, 1.0);
}
)";

// Plan: state colours, a little light on slopes; what the cut lays open (backs of faces) is darker.
inline constexpr const char* kPlanFragment = R"(#version 430 core
in vec3 relative;
flat in vec4 color;
out vec4 result;
void main() {
  vec3 n = cross(dFdx(relative), dFdy(relative));
  float n2 = dot(n, n);
  float up = n2 > 0.0 ? abs(n.y) * inversesqrt(n2) : 1.0;
  float light = (gl_FrontFacing ? 1.0 : 0.75) * (0.70 + 0.30 * up);
  result = vec4(color.rgb * light, 1.0);
}
)";

// Walls seen from above have no area: draws each steep triangle as a line of some width (its longest side,
// seen from above, covers the others).
inline constexpr const char* kPlanWallGeometry = R"(#version 430 core
layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;
in vec3 relative[];
flat in vec4 color[];
flat out vec4 wall_color;
uniform float half_width;  // clip space
void corner(vec4 end, vec2 offset) {
  wall_color = color[0];
  gl_Position = end + vec4(offset, 0.0, 0.0);
  EmitVertex();
}
void main() {
  vec3 n = cross(relative[1] - relative[0], relative[2] - relative[0]);
  if (n.y * n.y > 0.01 * dot(n, n)) return;
  vec4 a, b;
  float longest = 0.0;
  for (int i = 0; i < 3; ++i) {
    vec4 p = gl_in[i].gl_Position, q = gl_in[(i + 1) % 3].gl_Position;
    float side = distance(p.xy, q.xy);
    if (side > longest) {
      longest = side;
      a = p;
      b = q;
    }
  }
  if (longest == 0.0) return;
  vec2 along = (b.xy - a.xy) * (half_width / longest);
  vec2 across = vec2(-along.y, along.x);
  corner(a, across - along);
  corner(a, -across - along);
  corner(b, across + along);
  corner(b, -across + along);
  EndPrimitive();
}
)";
inline constexpr const char* kPlanWallFragment = R"(#version 430 core
flat in vec4 wall_color;
out vec4 result;
void main() { result = vec4(wall_color.rgb * 0.62, 1.0); }
)";

// Lines and polygons drawn over a plan, given in clip space.
inline constexpr const char* kOverlayVertex = R"(#version 430 core
layout(location = 0) in vec2 position;
layout(location = 1) in vec4 vertex_color;
out vec4 color;
void main() {
  color = vertex_color;
  gl_Position = vec4(position, 0.0, 1.0);
}
)";
inline constexpr const char* kOverlayFragment = R"(#version 430 core
in vec4 color;
out vec4 result;
void main() { result = color; }
)";

}  // namespace sightline::shaders
