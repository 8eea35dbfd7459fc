#pragma once

// All shaders of the reference renderer and of layers, GLSL 4.30.
//
// Precision: positions are floats in scene space. The eye comes as two floats for each coordinate (high +
// low), so that surfaces near the eye keep the stored precision wherever the scene lies. Depth runs from 1 at
// the near plane to 0 at the far plane, which spends a float's precision evenly over distance.

#include "sightline/layers/cycle_splitter.h"

namespace sightline::render {

// Each corner of an object is one vertex. Colours come from a buffer with one entry for each object, as
// square roots (which spends eight bits better). The plan view puts colours of states in their place.
inline constexpr const char* kSceneVertex = R"(#version 430 core
layout(location = 0) in vec3 position;
layout(location = 1) in uint object;
uniform mat4 clip_from_relative;
uniform vec3 eye_high, eye_low;
uniform samplerBuffer colors;
uniform float depth_scale;  // 1 in pictures; less pushes everything away a little
precise out vec3 relative;
flat out vec4 color;
invariant gl_Position;
void main() {
  relative = (position - eye_high) - eye_low;
  color = texelFetch(colors, int(object));
  gl_Position = clip_from_relative * vec4(relative, 1.0);
  gl_Position.z *= depth_scale;
}
)";

// The vertex shader for objects that move. Each object is placed by three rows of scene_from_stored, less the
// eye, applied to positions relative to a pivot, which also comes as two floats for each coordinate. The
// pivot is the eye's place among the stored positions, so that surfaces near the eye keep the stored
// precision.
inline constexpr const char* kMovedSceneVertex = R"(#version 430 core
layout(location = 0) in vec3 position;
layout(location = 1) in uint object;
uniform mat4 clip_from_relative;
uniform vec3 lens_offset;  // from the eye
uniform samplerBuffer colors;
uniform samplerBuffer places;  // five texels an object: three rows, the pivot's high and low part
uniform float depth_scale;
precise out vec3 relative;
flat out vec4 color;
invariant gl_Position;
void main() {
  int place = 5 * int(object);
  vec4 x = texelFetch(places, place);
  vec4 y = texelFetch(places, place + 1);
  vec4 z = texelFetch(places, place + 2);
  vec3 pivot_high = texelFetch(places, place + 3).xyz;
  vec3 pivot_low = texelFetch(places, place + 4).xyz;
  vec3 stored = (position - pivot_high) - pivot_low;
  vec3 turned = vec3(dot(x.xyz, stored), dot(y.xyz, stored), dot(z.xyz, stored));
  relative = (turned + vec3(x.w, y.w, z.w)) - lens_offset;
  color = texelFetch(colors, int(object));
  gl_Position = clip_from_relative * vec4(relative, 1.0);
  gl_Position.z *= depth_scale;
}
)";

// Light and shade of flat faces: sun, sky and a small difference between walls, then haze by distance. In
// linear light; pictures of eight bits hold its square root. The normal of a face is the one towards the eye:
// normal_sign is 1, and -1 where the picture is mirrored.
#define SIGHTLINE_SHADE                                                                                  \
  "in vec3 relative;\n"                                                                                  \
  "flat in vec4 color;\n"                                                                                \
  "uniform float haze;\n"                                                                                \
  "uniform float normal_sign;\n"                                                                         \
  "out vec4 result;\n"                                                                                   \
  "vec3 linearLight() {\n"                                                                               \
  "  vec3 n = cross(dFdx(relative), dFdy(relative));\n"                                                  \
  "  n *= normal_sign * inversesqrt(max(dot(n, n), 1e-36));\n"                                           \
  "  float sun = max(dot(n, vec3(0.4286, 0.7845, 0.4482)), 0.0);\n"                                      \
  "  float sky = dot(n, vec3(0.035, 0.09, -0.02)) + 0.33;\n"                                             \
  "  vec3 lit = color.rgb * color.rgb * (sky * vec3(0.95, 1.0, 1.08) + sun * vec3(0.52, 0.49, 0.43));\n" \
  "  float fog = dot(relative, relative) * haze;\n"                                                      \
  "  fog = 0.75 * fog / (1.0 + fog);\n"                                                                  \
  "  return mix(lit, vec3(0.66, 0.73, 0.80), fog);\n"                                                    \
  "}\n"                                                                                                  \
  "vec4 shade() { return vec4(sqrt(linearLight()), color.a); }\n"

inline constexpr const char* kSceneFragment =
    "#version 430 core\n" SIGHTLINE_SHADE "void main() { result = shade(); }\n";

// Alpha-tested surfaces (foliage, fences): every second pixel, as on a checkerboard, is a hole.
inline constexpr const char* kAlphaTestedFragment = "#version 430 core\n" SIGHTLINE_SHADE
                                                    "void main() {\n"
                                                    "  ivec2 p = ivec2(gl_FragCoord.xy);\n"
                                                    "  if (((p.x + p.y) & 1) != 0) discard;\n"
                                                    "  result = shade();\n"
                                                    "}\n";

// A piece of an object is drawn without what lies beyond one of its sides. Fragments are tested after all
// that needs their neighbours. The pieces on both sides of a plane may be drawn by different programs.
// `precise` makes all of them compute positions and heights by the same operations, so that each fragment is
// in exactly one piece. Positions are relative to the eye.
static_assert(kMaxPieceSides == 16, "the size of cuts[]");
#define SIGHTLINE_CUT                                                    \
  "uniform int cut_count, cut_fronts;\n"                                 \
  "uniform vec4 cuts[16];\n"                                             \
  "bool isCutOff() {\n"                                                  \
  "  for (int i = 0; i < cut_count; ++i) {\n"                            \
  "    precise float height = dot(cuts[i].xyz, relative) + cuts[i].w;\n" \
  "    bool in_front = height >= 0.0;\n"                                 \
  "    if (in_front != (((cut_fronts >> i) & 1) != 0)) return true;\n"   \
  "  }\n"                                                                \
  "  return false;\n"                                                    \
  "}\n"

// Layers are drawn to float pictures in linear light, colour multiplied by opacity.
inline constexpr const char* kLayerOpaqueFragment = "#version 430 core\n" SIGHTLINE_SHADE SIGHTLINE_CUT
                                                    "void main() {\n"
                                                    "  vec3 light = linearLight();\n"
                                                    "  if (isCutOff()) discard;\n"
                                                    "  result = vec4(light, 1.0);\n"
                                                    "}\n";

// A hole is a whole pixel, however many samples the pixel has.
inline constexpr const char* kLayerAlphaTestedFragment =
    "#version 430 core\n" SIGHTLINE_SHADE SIGHTLINE_CUT
    "uniform int samples;\n"
    "void main() {\n"
    "  ivec2 p = ivec2(gl_FragCoord.xy) / samples;\n"
    "  vec3 light = linearLight();\n"
    "  if (((p.x + p.y) & 1) != 0 || isCutOff()) discard;\n"
    "  result = vec4(light, 1.0);\n"
    "}\n";

inline constexpr const char* kLayerBlendedFragment = "#version 430 core\n" SIGHTLINE_SHADE SIGHTLINE_CUT
                                                     "void main() {\n"
                                                     "  vec3 light = linearLight();\n"
                                                     "  if (isCutOff()) discard;\n"
                                                     "  result = vec4(light * color.a, color.a);\n"
                                                     "}\n";

// Depths alone.
inline constexpr const char* kLayerDepthFragment =
    "#version 430 core\nin vec3 relative;\n" SIGHTLINE_CUT "void main() { if (isCutOff()) discard; }\n";

// Depth peeling discards fragments that are not nearer than the depth in `behind`. Greater depths are nearer.
#define SIGHTLINE_BEHIND        \
  "uniform sampler2D behind;\n" \
  "bool peeled() { return !(gl_FragCoord.z > texelFetch(behind, ivec2(gl_FragCoord.xy), 0).r); }\n"

inline constexpr const char* kPeelDepthFragment =
    "#version 430 core\nin vec3 relative;\n" SIGHTLINE_CUT SIGHTLINE_BEHIND
    "void main() { if (peeled() || isCutOff()) discard; }\n";

inline constexpr const char* kPeelColorFragment =
    "#version 430 core\n" SIGHTLINE_SHADE SIGHTLINE_CUT SIGHTLINE_BEHIND
    "void main() {\n"
    "  vec3 light = linearLight();\n"
    "  if (peeled() || isCutOff()) discard;\n"
    "  result = vec4(light * color.a, color.a);\n"
    "}\n";

#undef SIGHTLINE_BEHIND
#undef SIGHTLINE_CUT
#undef SIGHTLINE_SHADE

// Resolves the samples of a pixel: the mean of the colours and the nearest (greatest) depth. The caller puts
// the version and "const int samples = ...;" before this text.
inline constexpr const char* kResolveVertex = R"(#version 430 core
void main() {
  gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0);
}
)";
inline constexpr const char* kResolveFragment = R"(
uniform sampler2D colors, depths;
layout(location = 0) out vec4 color;
layout(location = 1) out float depth;
void main() {
  ivec2 first = ivec2(gl_FragCoord.xy) * samples;
  color = vec4(0.0);
  depth = 0.0;
  for (int y = 0; y < samples; ++y) {
    for (int x = 0; x < samples; ++x) {
      color += texelFetch(colors, first + ivec2(x, y), 0);
      depth = max(depth, texelFetch(depths, first + ivec2(x, y), 0).r);
    }
  }
  color /= float(samples * samples);
}
)";

// The sky is a gradient by elevation.
inline constexpr const char* kSkyVertex = R"(#version 430 core
uniform vec3 forward, right, up;
out vec3 direction;
void main() {
  vec2 p = vec2(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0);
  direction = forward + p.x * right + p.y * up;
  gl_Position = vec4(p, 0.0, 1.0);
}
)";
#define SIGHTLINE_SKY                                                                                      \
  "#version 430 core\n"                                                                                    \
  "in vec3 direction;\n"                                                                                   \
  "out vec4 result;\n"                                                                                     \
  "vec3 sky() {\n"                                                                                         \
  "  float h = normalize(direction).y;\n"                                                                  \
  "  vec3 above = mix(vec3(0.81, 0.86, 0.90), vec3(0.36, 0.56, 0.80), sqrt(clamp(h, 0.0, 1.0)));\n"        \
  "  vec3 below = mix(vec3(0.81, 0.86, 0.90), vec3(0.55, 0.53, 0.50), sqrt(clamp(-4.0 * h, 0.0, 1.0)));\n" \
  "  return h >= 0.0 ? above : below;\n"                                                                   \
  "}\n"
inline constexpr const char* kSkyFragment = SIGHTLINE_SKY "void main() { result = vec4(sky(), 1.0); }\n";
inline constexpr const char* kLinearSkyFragment =
    SIGHTLINE_SKY "void main() { vec3 root = sky(); result = vec4(root * root, 1.0); }\n";
#undef SIGHTLINE_SKY

// Plan views show colours of states with a little light on slopes. Backs of faces, which the cut lays open,
// are darker.
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

// A wall seen from above has no area, so each steep triangle is drawn as a line of some width along its
// longest side, which covers the other two.
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

// Lines and polygons over a plan view, given in clip space.
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

}  // namespace sightline::render
