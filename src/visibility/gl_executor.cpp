// SPDX-License-Identifier: BSD-3-Clause
//
// Each footprint is drawn as its box of whole pixels. Sides are evaluated at the pixels' centres, relative to the
// view's tile: the rasteriser snaps and interpolates nothing that counts.
#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "opengl/functions.h"
#include "visibility/executor.h"

namespace fcl_artic {
namespace visibility {
namespace {

constexpr float kNothing = 3e38f;

/// visibility::Footprint: `box` is x0 to y1, `info` view, resolution and the number of sides, `depths` both of them.
#define FCL_ARTIC_FOOTPRINTS                                         \
  "#version 430 core\n"                                              \
  "struct Footprint { ivec4 box, info; vec4 depths, sides[20]; };\n" \
  "layout(std430, binding = 0) readonly buffer Footprints { Footprint footprints[]; };\n"
static_assert(sizeof(Footprint) == sizeof(float[4]) * (3 + 20), "as in the shaders");

/// Each OpenGL 4.3 lets shaders read 2^24 bytes of a buffer (MAX_SHADER_STORAGE_BLOCK_SIZE). Beyond what a driver lets
/// them read they may read anything, so no draw takes more footprints than that, three of each piece.
constexpr std::size_t kMostFootprints = (std::size_t{1} << 24) / sizeof(Footprint) / kViews * kViews;

constexpr const char* kVertex = FCL_ARTIC_FOOTPRINTS R"(
flat out int index;
void main() {
  index = gl_InstanceID;
  ivec4 box = footprints[index].box;
  float side = float(footprints[index].info.y);
  vec2 pixel = vec2((gl_VertexID & 1) == 0 ? box.x : box.z + 1, gl_VertexID < 2 ? box.y : box.w + 1);
  pixel.x += float(footprints[index].info.x) * side;
  gl_Position = vec4(pixel * (2.0 / vec2(3.0 * side, side)) - 1.0, 0.0, 1.0);
})";

/// Depth of the volume in this pixel: from depths().x to depths().y; outside of the footprint nothing is drawn.
#define FCL_ARTIC_DEPTHS                                     \
  FCL_ARTIC_FOOTPRINTS                                       \
  "flat in int index;\n"                                     \
  "vec2 depths() {\n"                                        \
  "  ivec4 info = footprints[index].info;\n"                 \
  "  vec2 p = gl_FragCoord.xy - vec2(info.x * info.y, 0);\n" \
  "  for (int i = 0; i < info.z; ++i) {\n"                   \
  "    vec4 side = footprints[index].sides[i];\n"            \
  "    if (side.x * p.x + side.y * p.y > side.z) discard;\n" \
  "  }\n"                                                    \
  "  return footprints[index].depths.xy;\n"                  \
  "}\n"

/// Swept volumes: blending keeps the least of each channel.
constexpr const char* kSweptFragment = FCL_ARTIC_DEPTHS R"(
layout(location = 0) out vec2 interval;
void main() {
  vec2 d = depths();
  interval = vec2(d.x, -d.y);
})";

/// Pieces: a fragment neither in front of the swept volumes nor behind them sets the footprint's flag.
constexpr const char* kPieceFragment = FCL_ARTIC_DEPTHS R"(
layout(std430, binding = 1) writeonly buffer Flags { uint flags[]; };
uniform sampler2D swept;
void main() {
  vec2 d = depths();
  vec2 s = texelFetch(swept, ivec2(gl_FragCoord.xy), 0).xy;
  if (d.y >= s.x && d.x <= -s.y) flags[index] = 1u;
})";

/// The context is the thread's while this lives.
struct Current {
  explicit Current(OffscreenContext& of) : context(of) { context.makeCurrent(); }
  ~Current() { context.release(); }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;
  const std::lock_guard<std::mutex> turn{opengl::turns()};
  OffscreenContext& context;
};

class GlExecutor : public Executor {
 public:
  explicit GlExecutor(std::unique_ptr<OffscreenContext> context) : context_(std::move(context)) {
    const Current current(*context_);
    gl_ = std::make_unique<opengl::Functions>(*context_);
    swept_program_ = gl_->program(kVertex, kSweptFragment);
    piece_program_ = gl_->program(kVertex, kPieceFragment);
    gl_->GenVertexArrays(1, &array_);
    gl_->GenTextures(1, &intervals_);
    gl_->GenBuffers(2, buffers_);
    gl_->GenFramebuffers(2, targets_);
  }

  void findThatMayOverlap(const Drawing& drawing, std::vector<std::uint8_t>& may) override {
    swept_.clear();
    pieces_.clear();
    groups_.clear();
    for (const Volume& volume : drawing.swept) add(drawing, volume, swept_);
    for (const Drawing::Piece& piece : drawing.pieces) {
      const std::size_t first = pieces_.size();
      add(drawing, piece.volume, pieces_);
      if (pieces_.size() == first + kViews) {
        groups_.push_back(piece.group);
      } else {
        pieces_.resize(first);  // some view does not show it at all
      }
    }
    if (pieces_.empty()) return;
    const std::vector<std::uint32_t> flags = drawAll(drawing.resolution);
    for (std::size_t i = 0; i < groups_.size(); ++i) {
      if (flags[3 * i] && flags[3 * i + 1] && flags[3 * i + 2]) may[static_cast<std::size_t>(groups_[i])] = 1;
    }
  }

  /// Adds the footprints of a volume, one for each view that shows it.
  static void add(const Drawing& drawing, const Volume& volume, std::vector<Footprint>& to) {
    Footprint footprint;
    for (int view = 0; view < kViews; ++view) {
      if (project(drawing, volume, view, footprint)) to.push_back(footprint);
    }
  }

  /// Draws the swept volumes, then the pieces.
  /// @return for each footprint of a piece, 0: no fragment counts.
  std::vector<std::uint32_t> drawAll(int resolution) const {
    const Current current(*context_);
    const opengl::Functions& gl = *gl_;
    const GLfloat nothing[4] = {kNothing, kNothing, 0, 0};
    gl.BindVertexArray(array_);
    gl.Viewport(0, 0, kViews * resolution, resolution);
    gl.ActiveTexture(GL_TEXTURE0);
    gl.BindTexture(GL_TEXTURE_2D, intervals_);
    gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RG32F, kViews * resolution, resolution, 0, GL_RG, GL_FLOAT, nullptr);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    gl.BindFramebuffer(GL_FRAMEBUFFER, targets_[0]);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, intervals_, 0);
    gl.ClearBufferfv(GL_COLOR, 0, nothing);
    gl.Enable(GL_BLEND);
    gl.BlendEquation(GL_MIN);
    drawFootprints(swept_program_, swept_.data(), swept_.size());  // eight volumes
    gl.Disable(GL_BLEND);

    gl.BindFramebuffer(GL_FRAMEBUFFER, targets_[1]);  // it takes no colour: pieces leave flags only
    gl.FramebufferParameteri(GL_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_WIDTH, kViews * resolution);
    gl.FramebufferParameteri(GL_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_HEIGHT, resolution);
    std::vector<std::uint32_t> flags(pieces_.size(), 1);  // should nothing be read
    for (std::size_t first = 0; first < pieces_.size(); first += kMostFootprints) {
      drawPieces(first, std::min(kMostFootprints, pieces_.size() - first), flags.data() + first);
    }
    if (const GLenum error = gl.GetError()) throw std::runtime_error("OpenGL error " + std::to_string(error));
    return flags;
  }
  /// Draws some of the pieces' footprints.
  /// @param[out] flags  of these.
  void drawPieces(std::size_t first, std::size_t count, std::uint32_t* flags) const {
    const opengl::Functions& gl = *gl_;
    const std::vector<std::uint32_t> none(count, 0);
    const auto bytes = static_cast<GLsizeiptr>(count * sizeof flags[0]);
    gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffers_[1]);
    gl.BufferData(GL_SHADER_STORAGE_BUFFER, bytes, none.data(), GL_STREAM_READ);
    drawFootprints(piece_program_, pieces_.data() + first, count);
    gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, buffers_[1]);
    gl.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, bytes, flags);
  }
  void drawFootprints(GLuint program, const Footprint* footprints, std::size_t count) const {
    gl_->BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffers_[0]);
    gl_->BufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(count * sizeof(Footprint)), footprints,
                    GL_STREAM_DRAW);
    gl_->UseProgram(program);
    gl_->DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(count));
  }

  std::unique_ptr<OffscreenContext> context_;  // with it all of its objects go
  std::unique_ptr<opengl::Functions> gl_;
  GLuint swept_program_ = 0, piece_program_ = 0, array_ = 0;
  GLuint intervals_ = 0;                   ///< a texture: the swept interval of each pixel
  GLuint buffers_[2], targets_[2];         ///< footprints and flags; for the intervals, and for no colour
  std::vector<Footprint> swept_, pieces_;  ///< three of a piece, one a view
  std::vector<std::int32_t> groups_;       ///< of each piece
};

}  // namespace

std::unique_ptr<Executor> makeOpenGlExecutor(std::unique_ptr<OffscreenContext> context) {
  return std::make_unique<GlExecutor>(std::move(context));
}

}  // namespace visibility

std::shared_ptr<const VisibilityCuller> makeOffscreenCuller(OffscreenBackend backend,
                                                            const VisibilityOptions& options) {
  const std::string name = backend == OffscreenBackend::osmesa ? "osmesa" : "egl";
  return std::make_shared<VisibilityCuller>(
      options, name, [backend] { return visibility::makeOpenGlExecutor(OffscreenContext::create(backend, 4, 3)); });
}

}  // namespace fcl_artic
