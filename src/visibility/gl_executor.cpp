// SPDX-License-Identifier: BSD-3-Clause
#include "visibility/gl_executor.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "visibility/offscreen_context.h"
#include "visibility/shaders.h"

namespace fcl_artic {
namespace visibility {
namespace {

/// Coordinates in an atlas of this side are exact to 2^-12 pixels in float.
constexpr int kLargestAtlas = 4096;
constexpr float kNothing = 3e38f;

const void* offset(std::size_t bytes) {
  return reinterpret_cast<const void*>(bytes);  // NOLINT(performance-no-int-to-ptr): so OpenGL wants its offsets
}

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
  if (!gl.MemoryBarrier) throw std::runtime_error("the driver lacks glMemoryBarrier");
  // Vertices are snapped to 2^-bits pixels, and rounded to float before.
  GLint bits = 0;
  gl.GetIntegerv(GL_SUBPIXEL_BITS, &bits);
  eta_ = std::max(1.0 / 64, 2 * std::ldexp(1.0, -std::max(bits, 4)) + 0x1p-10);

  swept_program_ = gl.program(shaders::kVertex, shaders::kSweptFragment);
  object_program_ = gl.program(shaders::kVertex, shaders::kObjectFragment);
  near_program_ = gl.program(shaders::kVertex, shaders::kNearDepthFragment);
  far_program_ = gl.program(shaders::kVertex, shaders::kFarDepthFragment);
  gl.GenVertexArrays(1, &array_);
  gl.BindVertexArray(array_);
  gl.GenBuffers(1, &vertices_);
  gl.BindBuffer(GL_ARRAY_BUFFER, vertices_);
  const GLsizei stride = sizeof(Vertex);
  gl.VertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(Vertex, position)));
  gl.VertexAttribPointer(1, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(Vertex, corner)));
  gl.VertexAttribPointer(2, 4, GL_FLOAT, GL_FALSE, stride, offset(offsetof(Vertex, plane)));
  gl.VertexAttribPointer(3, 2, GL_FLOAT, GL_FALSE, stride, offset(offsetof(Vertex, flat_bounds)));
  gl.VertexAttribIPointer(4, 1, GL_UNSIGNED_INT, stride, offset(offsetof(Vertex, id)));
  for (GLuint i = 0; i < 5; ++i) gl.EnableVertexAttribArray(i);
  gl.GenBuffers(1, &flags_);
  GLuint targets[3];
  gl.GenFramebuffers(3, targets);
  target_ = targets[0];
  empty_target_ = targets[1];
  depth_target_ = targets[2];
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

/// Makes room for columns * rows tiles: an interval of depth per pixel, a depth buffer, and a colour to have something
/// for objects.
void GlExecutor::resizeAtlas(int columns, int rows, int resolution) {
  columns_ = columns;
  if (columns * resolution <= width_ && rows * resolution <= height_) return;
  const GlFunctions& gl = *gl_;
  width_ = std::max(width_, columns * resolution);
  height_ = std::max(height_, rows * resolution);
  const GLuint old[2] = {intervals_, depths_};
  gl.DeleteTextures(2, old);
  const auto texture = [&](GLint internal, GLenum format) {
    GLuint id = 0;
    gl.GenTextures(1, &id);
    gl.BindTexture(GL_TEXTURE_2D, id);
    gl.TexImage2D(GL_TEXTURE_2D, 0, internal, width_, height_, 0, format, GL_FLOAT, nullptr);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    gl.TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    return id;
  };
  intervals_ = texture(GL_RG32F, GL_RG);
  depths_ = texture(GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT);
  const auto attach = [&](GLuint target, GLenum where, GLuint to, GLenum buffer) {
    gl.BindFramebuffer(GL_FRAMEBUFFER, target);
    gl.FramebufferTexture2D(GL_FRAMEBUFFER, where, GL_TEXTURE_2D, to, 0);
    gl.DrawBuffer(buffer);
    gl.ReadBuffer(buffer);
    if (gl.CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      throw std::runtime_error("OpenGL can't draw to buffers of " + std::to_string(width_) + " x " +
                               std::to_string(height_));
    }
  };
  attach(target_, GL_COLOR_ATTACHMENT0, intervals_, GL_COLOR_ATTACHMENT0);
  // Objects leave flags only; the target gives the size. (Its depth buffer is not used: the test is off.)
  attach(empty_target_, GL_DEPTH_ATTACHMENT, depths_, GL_NONE);
  attach(depth_target_, GL_DEPTH_ATTACHMENT, depths_, GL_NONE);
  for (const GLuint program : {swept_program_, object_program_, near_program_, far_program_}) {
    gl.UseProgram(program);
    gl.Uniform2f(gl.GetUniformLocation(program, "scale"), 2.0f / static_cast<float>(width_),
                 2.0f / static_cast<float>(height_));
  }
  requireNoError("atlas");
}

/// Adds the footprint's polygon as a fan of triangles.
void GlExecutor::place(const Batch& batch, const Footprint& f, int tile, std::uint32_t id,
                       std::vector<Vertex>& vertices) const {
  double polygon[kMaxCorners][2];
  const int n = clipToTile(f, batch.resolution, polygon);
  // Flat bounds and the tightest of the others.
  int best = 0;
  for (int k = 1; k < f.num_bounds; ++k) {
    if (best == 0 || f.bounds[k].upper - f.bounds[k].lower < f.bounds[best].upper - f.bounds[best].lower) best = k;
  }
  const DepthBounds &b = f.bounds[best], &flat = f.bounds[0];
  const int column = tile % columns_, row = tile / columns_;
  const double x0 = column * batch.resolution, y0 = row * batch.resolution;
  const auto add = [&](const double* p) {
    vertices.push_back({{static_cast<float>(x0 + p[0]), static_cast<float>(y0 + p[1])},
                        {static_cast<float>(x0), static_cast<float>(y0)},
                        {b.a, b.b, b.lower, b.upper},
                        {flat.lower, flat.upper},
                        id});
  };
  for (int i = 1; i + 1 < n; ++i) {
    add(polygon[0]);
    add(polygon[i]);
    add(polygon[i + 1]);
  }
}

void GlExecutor::upload(const std::vector<Vertex>& vertices) const {
  gl_->BindBuffer(GL_ARRAY_BUFFER, vertices_);
  gl_->BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)), vertices.data(),
                  GL_STREAM_DRAW);
}

void GlExecutor::draw(GLuint program, const std::vector<Vertex>& vertices) const {
  upload(vertices);
  gl_->UseProgram(program);
  gl_->DrawArrays(GL_TRIANGLES, 0, static_cast<GLsizei>(vertices.size()));
}

/// Sets flags[3 * object + view] to 1 if some fragment counts.
void GlExecutor::markIntervals(std::vector<std::uint32_t>& flags) {
  const GlFunctions& gl = *gl_;
  const GLfloat nothing[4] = {kNothing, kNothing, 0, 0};
  gl.BindFramebuffer(GL_FRAMEBUFFER, target_);
  gl.ClearBufferfv(GL_COLOR, 0, nothing);
  gl.Enable(GL_BLEND);
  gl.BlendEquation(GL_MIN);
  draw(swept_program_, swept_);
  gl.Disable(GL_BLEND);
  gl.BindFramebuffer(GL_FRAMEBUFFER, empty_target_);
  const auto bytes = static_cast<GLsizeiptr>(flags.size() * sizeof flags[0]);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, flags_);
  gl.BufferData(GL_SHADER_STORAGE_BUFFER, bytes, flags.data(), GL_STREAM_READ);
  gl.BindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, flags_);
  gl.ActiveTexture(GL_TEXTURE0);
  gl.BindTexture(GL_TEXTURE_2D, intervals_);
  draw(object_program_, objects_);
  gl.MemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  gl.BindBuffer(GL_SHADER_STORAGE_BUFFER, flags_);
  gl.GetBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, bytes, flags.data());
}

/// Sets flags[3 * group + view] to 1 if the group is seen neither wholly in front of the swept volumes nor wholly after
/// them. Compares are inclusive, quantisation and clamping monotone: so a group that is not in front stays so.
void GlExecutor::askQueries(std::vector<std::uint32_t>& flags) {
  const GlFunctions& gl = *gl_;
  const std::size_t n = ranges_.size();
  if (queries_.size() < 2 * n) {
    const std::size_t had = queries_.size();
    queries_.resize(2 * n);
    gl.GenQueries(static_cast<GLsizei>(2 * n - had), queries_.data() + had);
  }
  gl.BindFramebuffer(GL_FRAMEBUFFER, depth_target_);
  gl.Enable(GL_DEPTH_TEST);
  for (int behind = 0; behind < 2; ++behind) {
    gl.DepthMask(GL_TRUE);
    gl.ClearDepth(behind ? 0 : 1);
    gl.Clear(GL_DEPTH_BUFFER_BIT);
    gl.DepthFunc(behind ? GL_GREATER : GL_LESS);
    draw(behind ? far_program_ : near_program_, swept_);
    gl.DepthMask(GL_FALSE);
    gl.DepthFunc(behind ? GL_LEQUAL : GL_GEQUAL);
    upload(objects_);
    gl.UseProgram(behind ? near_program_ : far_program_);
    for (std::size_t i = 0; i < n; ++i) {
      gl.BeginQuery(GL_ANY_SAMPLES_PASSED, queries_[2 * i + static_cast<std::size_t>(behind)]);
      if (ranges_[i].count) gl.DrawArrays(GL_TRIANGLES, ranges_[i].first, ranges_[i].count);
      gl.EndQuery(GL_ANY_SAMPLES_PASSED);
    }
  }
  gl.Disable(GL_DEPTH_TEST);
  for (std::size_t i = 0; i < n; ++i) {
    GLuint seen[2] = {1, 1};
    for (std::size_t k = 0; k < 2; ++k) gl.GetQueryObjectuiv(queries_[2 * i + k], GL_QUERY_RESULT, &seen[k]);
    flags[i] = seen[0] && seen[1];
  }
}

void GlExecutor::runWindows(const Batch& batch, std::int32_t begin, std::int32_t end, std::vector<std::uint8_t>& may) {
  const int tiles = kViews * (end - begin);
  const int columns = std::min(tiles, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(tiles)))));
  resizeAtlas(columns, (tiles + columns - 1) / columns, batch.resolution);
  swept_.clear();
  objects_.clear();
  ranges_.clear();
  std::vector<std::uint8_t> unusable(static_cast<std::size_t>(end - begin), 0);
  const auto within = [&](std::int32_t window) { return begin <= window && window < end; };
  for (const Batch::SweptVolume& swept : batch.swept) {
    if (!within(swept.window)) continue;
    for (int view = 0; view < kViews; ++view) {
      const auto outcome = projector_.project(batch, swept.volume,
                                              batch.windows[static_cast<std::size_t>(swept.window)], view, footprint_);
      if (outcome == Projector::Outcome::unusable) unusable[static_cast<std::size_t>(swept.window - begin)] = 1;
      if (outcome != Projector::Outcome::mayCover) continue;
      place(batch, footprint_, kViews * (swept.window - begin) + view, 0, swept_);
    }
  }
  // The units that have a flag: objects, or groups of them.
  const bool intervals = batch.rule == VisibilityRule::intervals;
  std::vector<std::size_t> first_object;  // of each unit
  for (std::size_t i = 0; i < batch.objects.size(); ++i) {
    if (!within(batch.objects[i].window)) continue;
    if (intervals || first_object.empty() || batch.objects[first_object.back()].group != batch.objects[i].group) {
      first_object.push_back(i);
    }
  }
  std::vector<std::uint8_t> kept(first_object.size(), 0);
  std::vector<std::uint32_t> flags(kViews * first_object.size(), 0);
  const auto lastOf = [&](std::size_t unit) {
    std::size_t last = first_object[unit];
    const std::int32_t group = batch.objects[last].group;
    if (!intervals) {
      while (last + 1 < batch.objects.size() && batch.objects[last + 1].group == group) ++last;
    }
    return last;
  };
  for (std::size_t unit = 0; unit < first_object.size(); ++unit) {
    const std::size_t first = first_object[unit], last = lastOf(unit);
    const std::int32_t window = batch.objects[first].window;
    kept[unit] = unusable[static_cast<std::size_t>(window - begin)];
    for (int view = 0; view < kViews; ++view) {
      const auto id = static_cast<std::uint32_t>(kViews * unit) + static_cast<std::uint32_t>(view);
      VertexRange range;
      range.first = static_cast<std::int32_t>(objects_.size());
      for (std::size_t i = first; i <= last && !kept[unit]; ++i) {
        const auto outcome = projector_.project(batch, batch.objects[i].volume,
                                                batch.windows[static_cast<std::size_t>(window)], view, footprint_);
        if (outcome == Projector::Outcome::unusable) kept[unit] = 1;
        if (outcome == Projector::Outcome::mayCover)
          place(batch, footprint_, kViews * (window - begin) + view, id, objects_);
      }
      range.count = static_cast<std::int32_t>(objects_.size()) - range.first;
      ranges_.push_back(range);
    }
  }
  gl_->BindVertexArray(array_);
  gl_->Viewport(0, 0, width_, height_);
  gl_->Disable(GL_DEPTH_TEST);
  if (!flags.empty()) intervals ? markIntervals(flags) : askQueries(flags);
  requireNoError("drawing");
  for (std::size_t unit = 0; unit < first_object.size(); ++unit) {
    const bool seen = flags[3 * unit] && flags[3 * unit + 1] && flags[3 * unit + 2];
    for (std::size_t i = first_object[unit]; i <= lastOf(unit); ++i) may[i] = kept[unit] || seen;
  }
}

void GlExecutor::run(const Batch& batch, std::vector<std::uint8_t>& may) {
  const Current current(*context_);
  projector_.setGrowth(batch.growth.orOwn(eta_));
  std::vector<std::uint8_t> answer(batch.objects.size(), 1);
  const int side = kLargestAtlas / batch.resolution, at_once = side * (side - 1) / kViews;
  const auto windows = static_cast<std::int32_t>(batch.windows.size());
  for (std::int32_t begin = 0; begin < windows; begin += at_once) {
    runWindows(batch, begin, std::min(windows, begin + at_once), answer);
  }
  may = std::move(answer);
}

}  // namespace visibility
}  // namespace fcl_artic
