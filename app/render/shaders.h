// SPDX-License-Identifier: BSD-3-Clause
// GLSL 3.30 sources of the renderer; those without a version line are put together after kVersion. Colours are linear
// until kResolveFragment.
#pragma once

namespace fcl_artic::render::shaders {

/// Bodies: world position and normal for all passes that draw them.
constexpr const char* kBodyVertex = R"(#version 330 core
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
uniform mat4 model, view_projection;
invariant gl_Position;  // the passes test against each other's depth
out vec3 world, world_normal;
void main() {
  vec4 p = model * vec4(position, 1.0);
  world = p.xyz;
  world_normal = mat3(model) * normal;
  gl_Position = view_projection * p;
})";

constexpr const char* kVersion = "#version 330 core\n";

/// Depth only (the light's view).
constexpr const char* kEmptyFragment = R"(#version 330 core
void main() {})";

/// Number of the body's group, as a colour (to count what a camera sees).
constexpr const char* kGroupFragment = R"(#version 330 core
uniform vec3 color;
out vec4 pixel;
void main() { pixel = vec4(color, 1.0); })";

/// The normal on the viewer's side. The triangle decides which that is, since an interpolated normal may lean away
/// from the viewer at a silhouette, and a mesh may be wound inside out.
constexpr const char* kFacing = R"(
vec3 facing_normal(vec3 p, vec3 n, vec3 view) {
  vec3 flat_normal = cross(dFdx(p), dFdy(p));
  if (dot(flat_normal, view) < 0.0) flat_normal = -flat_normal;
  return dot(n, flat_normal) < 0.0 ? -normalize(n) : normalize(n);
}
)";

/// Normals for the ambient occlusion; alpha says whether ghosts keep clear of the body.
constexpr const char* kNormalFragment = R"(
uniform vec3 eye;
uniform float clear_of_ghosts;
in vec3 world, world_normal;
out vec4 pixel;
void main() {
  pixel = vec4(facing_normal(world, world_normal, eye - world), clear_of_ghosts);
})";

/// Light shared by bodies and ground: sun with a soft shadow, sky and ground light with ambient occlusion.
constexpr const char* kLight = R"(
uniform vec3 eye, sun;
uniform mat4 shadow_matrix;
uniform sampler2DShadow shadow_map;
uniform sampler2D occlusion_map;
uniform vec2 pixel_size;
in vec3 world, world_normal;
out vec4 pixel;

float sunlight(vec3 p, vec3 n) {
  if (dot(n, sun) <= 0.0) return 0.0;
  vec4 at = shadow_matrix * vec4(p, 1.0);
  vec3 uvz = at.xyz * 0.5 + 0.5;
  if (any(lessThan(uvz, vec3(0.0))) || any(greaterThan(uvz, vec3(1.0)))) return 1.0;
  float bias = 0.0006 + 0.0022 * (1.0 - clamp(dot(n, sun), 0.0, 1.0));
  vec2 texel = 1.6 / vec2(textureSize(shadow_map, 0));
  uvz.z -= bias;
  // Away from a shadow's edge the corners agree, and so does what lies between.
  float lit = 0.0;
  for (int i = -2; i <= 2; i += 4)
    for (int j = -2; j <= 2; j += 4) lit += texture(shadow_map, vec3(uvz.xy + vec2(i, j) * texel, uvz.z));
  if (lit <= 0.0 || lit >= 4.0) return lit / 4.0;
  lit = 0.0;
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j) lit += texture(shadow_map, vec3(uvz.xy + vec2(i, j) * texel, uvz.z));
  return lit / 25.0;
}

float openness() { return texture(occlusion_map, gl_FragCoord.xy * pixel_size).r; }
)";

/// A shaded body. `highlight` mixes in another colour around a point.
constexpr const char* kBodyFragment = R"(
uniform vec3 color, highlight, highlight_center;
uniform float highlight_radius, highlight_floor, opacity, rim, glow;
uniform bool use_occlusion;
void main() {
  vec3 v = normalize(eye - world);
  vec3 n = facing_normal(world, world_normal, v);
  float away = distance(world, highlight_center) / highlight_radius;
  float near = exp(-away * away);
  vec3 base = mix(color, highlight, max(near, highlight_floor));
  float open = use_occlusion ? openness() : 1.0;
  float lit = sunlight(world, n);
  float up = 0.5 + 0.5 * n.z;
  vec3 ambient = mix(vec3(0.34, 0.32, 0.31), vec3(0.60, 0.64, 0.70), up) * open;
  vec3 key = vec3(1.02, 0.98, 0.92) * max(dot(n, sun), 0.0) * lit;
  vec3 fill = vec3(0.14) * max(dot(n, v), 0.0) * open;
  float facing = clamp(dot(n, v), 0.0, 1.0);
  vec3 shaded = base * (ambient + key + fill);
  shaded += 0.16 * pow(max(dot(n, normalize(v + sun)), 0.0), 48.0) * lit;
  float aside = (1.0 - facing) * (1.0 - facing);
  shaded += 0.10 * aside * aside * up * open;
  shaded = mix(shaded, base, glow);
  float alpha = opacity * mix(1.0, 0.45 + 0.9 * pow(1.0 - facing, 1.6), rim);
  pixel = vec4(shaded, clamp(alpha, 0.0, 1.0));
})";

/// Ground with a grid of fine and coarse lines that fades out with the distance.
constexpr const char* kGroundFragment = R"(
uniform vec3 focus;
uniform float fade_radius, cell;
float lines(vec2 p, float width) {
  vec2 slope = fwidth(p);
  vec2 gap = abs(fract(p - 0.5) - 0.5);
  vec2 cover = clamp(0.5 + (width * slope - gap) / slope, 0.0, 1.0);
  cover *= clamp(1.4 - 2.5 * slope, 0.0, 1.0);
  return max(cover.x, cover.y);
}
void main() {
  vec3 n = vec3(0.0, 0.0, 1.0);
  float lit = sunlight(world, n);
  float fine = lines(world.xy / cell, 0.6), coarse = lines(world.xy / (5.0 * cell), 0.9);
  vec3 base = mix(vec3(0.83, 0.85, 0.875), vec3(0.50, 0.55, 0.62), max(0.45 * fine, 0.95 * coarse));
  float shade = mix(0.62, 1.0, lit) * mix(0.55, 1.0, openness());
  float r = distance(world.xy, focus.xy) / fade_radius;
  pixel = vec4(base * shade, 1.0 - smoothstep(0.35, 1.0, r));
})";

/// One triangle that covers the target.
constexpr const char* kScreenVertex = R"(#version 330 core
out vec2 uv;
void main() {
  uv = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2);
  gl_Position = vec4(uv * 2.0 - 1.0, 0.0, 1.0);
})";

constexpr const char* kBackgroundFragment = R"(#version 330 core
in vec2 uv;
out vec4 pixel;
void main() {
  vec3 low = vec3(0.90, 0.915, 0.93), high = vec3(0.70, 0.765, 0.83);
  pixel = vec4(mix(low, high, smoothstep(0.25, 1.05, uv.y)), 1.0);
})";

/// Ambient occlusion from depth and normals: the share of a half ball around a surface point that is open.
constexpr const char* kOcclusionFragment = R"(#version 330 core
uniform sampler2D depth_map, normal_map;
uniform mat4 view_projection, inverse_view_projection;
uniform vec3 eye;
uniform float radius;
uniform vec2 depth_law;  // m22 and m23 of the projection
in vec2 uv;
out vec4 pixel;
vec3 unproject(vec2 at, float depth) {
  vec4 p = inverse_view_projection * vec4(vec3(at, depth) * 2.0 - 1.0, 1.0);
  return p.xyz / p.w;
}
void main() {
  float depth = texture(depth_map, uv).r;
  if (depth >= 1.0) { pixel = vec4(1.0); return; }
  vec3 n = normalize(texture(normal_map, uv).xyz);
  vec3 p = unproject(uv, depth) + n * radius * 0.02;
  vec3 side = normalize(abs(n.z) < 0.9 ? cross(n, vec3(0, 0, 1)) : cross(n, vec3(1, 0, 0)));
  vec3 other = cross(n, side);
  // interleaved gradient noise turns the sample pattern from pixel to pixel; the blur takes it out
  float turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
  vec2 around = vec2(cos(turn), sin(turn));
  const vec2 kGoldenTurn = vec2(-0.73736887, 0.67549029);  // cosine and sine of 2.3999632
  const int kSamples = 12;
  float hidden = 0.0;
  for (int i = 0; i < kSamples; ++i) {
    float f = (float(i) + 0.5) / float(kSamples);
    vec3 d = (around.x * side + around.y * other) * sqrt(f) + sqrt(1.0 - f) * n;
    around = around.x * kGoldenTurn + around.y * vec2(-kGoldenTurn.y, kGoldenTurn.x);
    float reach = radius * (0.15 + 0.85 * fract(f * 7.0 + 0.37));
    vec4 q = view_projection * vec4(p + d * reach, 1.0);
    vec3 s = q.xyz / q.w * 0.5 + 0.5;
    float d_there = texture(depth_map, s.xy).r;
    if (d_there < s.z) {
      // Both points are on one ray from the eye: their distances from it are as their depths, q.w and the other's.
      float w_there = depth_law.y / (2.0 * d_there - 1.0 + depth_law.x);
      float gap = distance(eye, p + d * reach) * (1.0 - w_there / q.w);
      hidden += 1.0 - smoothstep(0.8 * radius, 2.0 * radius, gap);
    }
  }
  pixel = vec4(1.0 - hidden / float(kSamples));
})";

/// Takes the noise out of the occlusion, within surfaces: along rows, and then along columns.
constexpr const char* kBlurFragment = R"(#version 330 core
uniform sampler2D source, normal_map;
uniform vec2 next_pixel;
in vec2 uv;
out vec4 pixel;
void main() {
  vec3 n = texture(normal_map, uv).xyz;
  float sum = 0.0, weights = 0.0;
  for (int i = -3; i <= 3; ++i) {
    vec2 at = uv + float(i) * next_pixel;
    float alike = max(dot(n, texture(normal_map, at).xyz), 0.0);
    float w = alike * alike * alike * alike + 1e-3;
    sum += w * texture(source, at).r;
    weights += w;
  }
  pixel = vec4(sum / weights);
})";

/// Lays a layer over the picture, paler where it would cover what ghosts keep clear of. `outline` > 0: all of it, with
/// a light rim of `outline` pixels around what the layer holds.
constexpr const char* kLayerFragment = R"(#version 330 core
uniform sampler2D layer, normal_map;
uniform vec2 pixel_size;
uniform int outline;
in vec2 uv;
out vec4 pixel;
void main() {
  vec4 c = texture(layer, uv);
  if (outline > 0 && c.a < 0.5) {
    float best = 0.0;
    for (int i = -outline; i <= outline; ++i)
      for (int j = -outline; j <= outline; ++j)
        if (i * i + j * j <= outline * outline) best = max(best, texture(layer, uv + vec2(i, j) * pixel_size).a);
    c = vec4(vec3(0.97), 0.92 * best);
  }
  if (outline == 0) c.a *= mix(1.0, 0.3, texture(normal_map, uv).a);
  pixel = c;
})";

/// Linear light to sRGB, and the average of the 2 x 2 samples of a pixel.
constexpr const char* kResolveFragment = R"(#version 330 core
uniform sampler2D source;
out vec4 pixel;
vec3 display(vec3 c) {
  c = c / (1.0 + 0.18 * c * c);  // rolls bright spots off
  return mix(12.92 * c, 1.055 * pow(max(c, vec3(0.0)), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
void main() {
  ivec2 at = 2 * ivec2(gl_FragCoord.xy);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) sum += display(texelFetch(source, at + ivec2(i, j), 0).rgb);
  pixel = vec4(sum / 4.0, 1.0);
})";

}  // namespace fcl_artic::render::shaders
