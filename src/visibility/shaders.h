// SPDX-License-Identifier: BSD-3-Clause
//
// GLSL 4.30 sources of the executors osmesa and egl. Each footprint is drawn as its box of whole pixels. Sides and
// depth bounds are evaluated at the pixels' centres, relative to the tile: the rasteriser snaps and interpolates
// nothing that counts.
#pragma once

namespace fcl_artic {
namespace visibility {
namespace shaders {

#define FCL_ARTIC_FOOTPRINTS                                      \
  "#version 430 core\n"                                           \
  "struct Footprint { vec4 box, tile, sides[20], bounds[7]; };\n" \
  "layout(std430, binding = 0) readonly buffer Footprints { Footprint footprints[]; };\n"

constexpr const char* kVertex = FCL_ARTIC_FOOTPRINTS R"(
uniform vec2 scale;
flat out int index;
void main() {
  index = gl_InstanceID;
  vec4 box = footprints[index].box;  // of the tile
  vec2 pixel = vec2((gl_VertexID & 1) == 0 ? box.x : box.z, gl_VertexID < 2 ? box.y : box.w);
  gl_Position = vec4((pixel + footprints[index].tile.xy) * scale - 1.0, 0.0, 1.0);
})";

/// Depth of the volume in this pixel: from depths().x to depths().y; outside of the footprint nothing is drawn.
#define FCL_ARTIC_DEPTHS                                          \
  FCL_ARTIC_FOOTPRINTS                                            \
  "flat in int index;\n"                                          \
  "vec2 depths() {\n"                                             \
  "  vec4 tile = footprints[index].tile;\n"                       \
  "  vec2 p = gl_FragCoord.xy - tile.xy;\n"                       \
  "  for (int i = 0; i < int(tile.z); ++i) {\n"                   \
  "    vec4 side = footprints[index].sides[i];\n"                 \
  "    if (side.x * p.x + side.y * p.y > side.z) discard;\n"      \
  "  }\n"                                                         \
  "  vec2 d = footprints[index].bounds[0].zw;\n"                  \
  "  for (int i = 1; i < int(tile.w); ++i) {\n"                   \
  "    vec4 bound = footprints[index].bounds[i];\n"               \
  "    float t = bound.x * p.x + bound.y * p.y;\n"                \
  "    d = vec2(max(d.x, t + bound.z), min(d.y, t + bound.w));\n" \
  "  }\n"                                                         \
  "  return d;\n"                                                 \
  "}\n"

/// Swept volumes: blending keeps the least of each channel.
constexpr const char* kSweptFragment = FCL_ARTIC_DEPTHS R"(
layout(location = 0) out vec2 interval;
void main() {
  vec2 d = depths();
  interval = vec2(d.x, -d.y);
})";

/// Objects: a fragment neither in front of the swept volumes nor behind them sets the footprint's flag.
constexpr const char* kObjectFragment = FCL_ARTIC_DEPTHS R"(
layout(std430, binding = 1) writeonly buffer Flags { uint flags[]; };
uniform sampler2D swept;
void main() {
  vec2 d = depths();
  vec2 s = texelFetch(swept, ivec2(gl_FragCoord.xy), 0).xy;
  if (d.y >= s.x && d.x <= -s.y) flags[index] = 1u;
})";

#undef FCL_ARTIC_DEPTHS
#undef FCL_ARTIC_FOOTPRINTS

}  // namespace shaders
}  // namespace visibility
}  // namespace fcl_artic
