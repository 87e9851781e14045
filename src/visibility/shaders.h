// SPDX-License-Identifier: BSD-3-Clause
// GLSL 4.30 sources of the executors osmesa and egl. Bounds of depth come as flat attributes and are evaluated at the
// pixel's centre, relative to its tile: the rasteriser interpolates nothing, and all numbers are those that footprint.h
// bounds.
#pragma once

namespace fcl_artic {
namespace visibility {
namespace shaders {

constexpr const char* kVertex = R"(#version 430 core
layout(location = 0) in vec2 position;  // pixels of the atlas
layout(location = 1) in vec2 corner;    // of the tile
layout(location = 2) in vec4 plane;     // a, b, lower, upper
layout(location = 3) in vec2 flat_bounds;
layout(location = 4) in uint id;
uniform vec2 scale;
flat out vec2 tile;
flat out vec4 q;
flat out vec2 z;
flat out uint object;
void main() {
  tile = corner;
  q = plane;
  z = flat_bounds;
  object = id;
  gl_Position = vec4(position * scale - 1.0, 0.0, 1.0);
})";

/// Depth of the volume in this pixel: from depths().x to depths().y.
#define FCL_ARTIC_DEPTHS                                   \
  "#version 430 core\n"                                    \
  "flat in vec2 tile;\n"                                   \
  "flat in vec4 q;\n"                                      \
  "flat in vec2 z;\n"                                      \
  "flat in uint object;\n"                                 \
  "vec2 depths() {\n"                                      \
  "  vec2 p = gl_FragCoord.xy - tile;\n"                   \
  "  float t = q.x * p.x + q.y * p.y;\n"                   \
  "  return vec2(max(z.x, t + q.z), min(z.y, t + q.w));\n" \
  "}\n"

/// Swept volumes: blending keeps the least of each channel.
constexpr const char* kSweptFragment = FCL_ARTIC_DEPTHS R"(
layout(location = 0) out vec2 interval;
void main() {
  vec2 d = depths();
  interval = vec2(d.x, -d.y);
})";

/// Objects: a fragment neither in front of the swept volumes nor behind them sets its object's flag.
constexpr const char* kObjectFragment = FCL_ARTIC_DEPTHS R"(
layout(std430, binding = 0) writeonly buffer Flags { uint flags[]; };
uniform sampler2D swept;
void main() {
  vec2 d = depths();
  vec2 s = texelFetch(swept, ivec2(gl_FragCoord.xy), 0).xy;
  if (d.y >= s.x && d.x <= -s.y) flags[object] = 1u;
})";

/// Depth for occlusion queries: the near bound of swept volumes and the far one of objects, or the other way round.
/// Into [0.1, 0.9], monotone, so that nothing equals a cleared pixel.
constexpr const char* kNearDepthFragment = FCL_ARTIC_DEPTHS R"(
void main() { gl_FragDepth = clamp(0.25 + 0.5 * depths().x, 0.1, 0.9); })";
constexpr const char* kFarDepthFragment = FCL_ARTIC_DEPTHS R"(
void main() { gl_FragDepth = clamp(0.25 + 0.5 * depths().y, 0.1, 0.9); })";

#undef FCL_ARTIC_DEPTHS

}  // namespace shaders
}  // namespace visibility
}  // namespace fcl_artic
