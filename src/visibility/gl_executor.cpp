// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/gl_executor.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "visibility/offscreen_context.h"
#include "visibility/shaders.h"

namespace fcl_artic {
namespace visibility {
namespace {

constexpr int kLargestAtlas = 4096;
constexpr float kNothing = 3e38f;

}  // namespace

struct GlExecutor::Current {
  explicit Current(OffscreenContext& context) : context_(context) { context_.makeCurrent(); }
  ~Current() { context_.release(); }
  Current(const Current&) = delete;
  Current& operator=(const Current&) = delete;
  const std::lock_guard<std::mutex> turn_{openGlMutex()};
  OffscreenContext& context_;
};

GlExecutor::GlExecutor(std::unique_ptr<OffscreenContext> context) : context_(std::move(context)) {
  const Current current(*context_);
  gl_ = std::make_unique<GlFunctions>(*context_);
  const GlFunctions& gl = *gl_;
  if (!gl.MemoryBarrier || !gl.FramebufferParameteri) throw std::runtime_error("the driver lacks OpenGL 4.3");
  swept_program_ = gl.program(shaders::kVertex, shaders::kSweptFragment);
  object_program_ = gl.program(shaders::kVertex, shaders::kObjectFragment);
  gl.GenVertexArrays(1, &array_);
  GLuint ids[2];
  gl.GenBuffers(2, ids);
  footprints_ = ids[0];
  flags_ = ids[1];
  gl.GenFramebuffers(2, ids);
  target_ = ids[0];
  empty_target_ = ids[1];
  requireNoError("set-up");
}

GlExecutor::~GlExecutor() = default;  // with the context all of its objects go

void GlExecutor::requireNoError(const char* what) const {
  const GLenum error = gl_->GetError();
  if (error != GL_NO_ERROR) throw std::runtime_error("OpenGL error " + std::to_string(error) + " at " + what);
  if (gl_->GetGraphicsResetStatus && gl_->GetGraphicsResetStatus() != GL_NO_ERROR) {
    throw std::runtime_error("the OpenGL context is lost");
  }
}

/// Makes room for that many tiles: an interval of depth per pixel.
void GlExecutor::resizeAtlas(int tiles, int resolution) {
  columns_ = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(tiles))));
  const int width = columns_ * resolution, height = (tiles + columns_ - 1) / columns_ * resolution;
  if (width <= width_ && height <= height_) return;
  const GlFunctions& gl = *gl_;
  width_ = std::max(width_, width);
  height_ = std::max(height_, height);
  gl.DeleteTextures(1, &intervals_);
  gl.GenTextures(1, &intervals_);
  gl.BindTexture(GL_TEXTURE_2D, intervals_);
  gl.TexImage2D(GL_TEXTURE_2D, 0, GL_RG32F, width_, height_, 0, GL_RG, GL_FLOAT, nullptr);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  gl.BindFramebuffer(GL_FRAMEBUFFER, empty_target_);
  gl.FramebufferParameteri(GL_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_WIDTH, width_);
  gl.FramebufferParameteri(GL_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_HEIGHT, height_);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target_);
  gl.FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, intervals_, 0);
  if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("OpenGL can't draw to a texture of " + std::to_string(width_) + " x " +
                             std::to_string(height_));
  }
  for (const GLuint program : {swept_program_, object_program_}) {
    gl.UseProgram(program);
    gl.Uniform2f(gl.GetUniformLocation(program, "scale"), 2.0f / static_cast<float>(width_),
                 2.0f / static_cast<float>(height_));
  }
  requireNoError("atlas");
}

/// Adds the volume's footprints, those of views in which it may cover pixels.
/// @return whether it could be projected.
bool GlExecutor::add(const Batch& batch, const Volume& volume, std::int32_t window, std::int32_t first_window,
                     std::vector<Record>& to) {
  for (int view = 0; view < kViews; ++view) {
    const auto outcome = projector_.project(batch, volume, batch.windowOf(window), view, footprint_);
    if (outcome == Projector::Outcome::unusable) return false;
    if (outcome == Projector::Outcome::misses) continue;
    const Footprint& f = footprint_;
    const int tile = kViews * (window - first_window) + view;
    Record& r = to.emplace_back();
    const int box[4] = {f.x0, f.y0, f.x1 + 1, f.y1 + 1},
              place[4] = {tile % columns_ * batch.resolution, tile / columns_ * batch.resolution, f.num_sides,
                          f.num_bounds};
    std::copy(box, box + 4, r.box);
    std::copy(place, place + 4, r.tile);
    for (int i = 0; i < f.num_sides; ++i) {
      const double side[4] = {f.sides[i].a, f.sides[i].b, f.sides[i].c, 0};
      std::transform(side, side + 4, r.sides[i], [](double x) { return static_cast<float>(x); });
    }
    for (int i = 0; i < f.num_bounds; ++i) {
      const DepthBounds& b = f.bounds[i];
      const float bound[4] = {b.a, b.b, b.lower, b.upper};
      std::copy(bound, bound + 4, r.bounds[i]);
    }
  }
  return true;
}

void GlExecutor::draw(GLuint program, const std::vector<Record>& records) const {
  const GlFunctions& gl = *gl_;
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, footprints_);
  gl.BufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(records.size() * sizeof(Record)), records.data(),
                GL_STREAM_DRAW);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, footprints_);
  gl.UseProgram(program);
  gl.DrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(records.size()));
}

/// Draws swept volumes, then objects.
/// @param[out] flags  one per record of an object: 1 if some fragment counts.
void GlExecutor::readFlags(std::vector<std::uint32_t>& flags) const {
  const GlFunctions& gl = *gl_;
  const GLfloat nothing[4] = {kNothing, kNothing, 0, 0};
  gl.BindVertexArray(array_);
  gl.Viewport(0, 0, width_, height_);
  gl.Disable(GL_DEPTH_TEST);
  gl.BindFramebuffer(GL_FRAMEBUFFER, target_);
  gl.ClearBufferfv(GL_COLOR, 0, nothing);
  gl.Enable(GL_BLEND);
  gl.BlendEquation(GL_MIN);
  if (!swept_.empty()) draw(swept_program_, swept_);
  gl.Disable(GL_BLEND);
  gl.BindFramebuffer(GL_FRAMEBUFFER, empty_target_);
  flags.assign(objects_.size(), 0);
  const auto bytes = static_cast<GLsizeiptr>(flags.size() * sizeof flags[0]);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, flags_);
  gl.BufferData(GL_SHADER_STORAGE_BUFFER, bytes, flags.data(), GL_STREAM_READ);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, flags_);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, intervals_);
  draw(object_program_, objects_);
  gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, flags_);
  gl.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, bytes, flags.data());
  requireNoError("drawing");
}

void GlExecutor::runWindows(const Batch& batch, std::int32_t begin, std::int32_t end, std::vector<std::uint8_t>& may) {
  resizeAtlas(kViews * (end - begin), batch.resolution);
  swept_.clear();
  objects_.clear();
  group_of_.clear();
  std::vector<std::uint8_t> unusable(static_cast<std::size_t>(end - begin), 0);
  const auto within = [&](std::int32_t window) { return begin <= window && window < end; };
  for (const Batch::SweptVolume& s : batch.swept) {
    if (!within(s.window) || add(batch, s.volume, s.window, begin, swept_)) continue;
    unusable[static_cast<std::size_t>(s.window - begin)] = 1;
  }
  for (const Batch::Object& object : batch.objects) {
    std::uint8_t& group = may[static_cast<std::size_t>(object.group)];
    if (!within(object.window) || group) continue;
    const std::size_t first = objects_.size();
    group = unusable[static_cast<std::size_t>(object.window - begin)] ||
            !add(batch, object.volume, object.window, begin, objects_);
    if (!group && objects_.size() == first + kViews) {
      group_of_.push_back(object.group);
    } else {
      objects_.resize(first);  // it stays, or some view does not show it at all
    }
  }
  if (objects_.empty()) return;
  std::vector<std::uint32_t> flags;
  readFlags(flags);
  for (std::size_t i = 0; i < group_of_.size(); ++i) {
    if (flags[3 * i] && flags[3 * i + 1] && flags[3 * i + 2]) may[static_cast<std::size_t>(group_of_[i])] = 1;
  }
}

void GlExecutor::run(const Batch& batch, std::vector<std::uint8_t>& may) {
  may.clear();
  if (batch.objects.empty()) return;
  const Current current(*context_);
  projector_.setGrowth(batch.growth);
  std::vector<std::uint8_t> answer(static_cast<std::size_t>(batch.num_groups), 0);
  const int side = kLargestAtlas / batch.resolution, at_once = side * (side - 1) / kViews;
  const auto windows = static_cast<std::int32_t>(batch.windows.size());
  for (std::int32_t begin = 0; begin < windows; begin += at_once) {
    runWindows(batch, begin, std::min(windows, begin + at_once), answer);
  }
  may = std::move(answer);
}

}  // namespace visibility
}  // namespace fcl_artic
