// SPDX-License-Identifier: BSD-3-Clause
#include "renderer.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <unordered_map>

#include "opengl/functions.h"
#include "shaders.h"

namespace fcl_artic::render {
namespace {

using Eigen::Matrix4f;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kSupersampling = 2;  // kResolveFragment averages 2 x 2
constexpr int kShadowSize = 4096;
constexpr float kCreaseCosine = 0.77f;  // edges sharper than 40 degrees stay sharp
constexpr float kSeeThrough = 0.38f;    // of the robot behind obstacles

/// OpenGL of the renderer at work on this thread.
thread_local const opengl::Functions* bound = nullptr;
const opengl::Functions& api() {
  return *bound;
}

/// OSMesa's, or, where there is none, EGL's.
std::unique_ptr<OffscreenContext> openContext() {
  std::string reasons;
  for (const OffscreenBackend backend : {OffscreenBackend::osmesa, OffscreenBackend::egl}) {
    try {
      return OffscreenContext::create(backend, 3, 3);
    } catch (const std::runtime_error& e) {
      reasons += (reasons.empty() ? "" : "; ") + std::string(e.what());
    }
  }
  throw std::runtime_error("no OpenGL without a window: " + reasons);
}

class Program {
 public:
  Program(const std::string& vertex, const std::string& fragment)
      : id_(api().program(vertex.c_str(), fragment.c_str())) {}
  void use() const { api().UseProgram(id_); }
  void set(const char* name, float x) const { api().Uniform1f(at(name), x); }
  void set(const char* name, int x) const { api().Uniform1i(at(name), x); }
  void set(const char* name, const Vector3f& v) const { api().Uniform3fv(at(name), 1, v.data()); }
  void set(const char* name, float x, float y) const { api().Uniform2f(at(name), x, y); }
  void set(const char* name, const Matrix4f& m) const { api().UniformMatrix4fv(at(name), 1, GL_FALSE, m.data()); }

 private:
  GLint at(const char* name) const { return api().GetUniformLocation(id_, name); }
  GLuint id_;
};

class Texture {
 public:
  Texture(int width, int height, GLint internal, GLenum format, GLenum type, GLint filter) {
    api().GenTextures(1, &id);
    api().BindTexture(GL_TEXTURE_2D, id);
    api().TexImage2D(GL_TEXTURE_2D, 0, internal, width, height, 0, format, type, nullptr);
    api().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, filter);
    api().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, filter);
    api().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
    api().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
  }
  ~Texture() { api().DeleteTextures(1, &id); }
  Texture(const Texture&) = delete;
  Texture& operator=(const Texture&) = delete;
  void bind(int unit) const {
    api().ActiveTexture(static_cast<GLenum>(GL_TEXTURE0 + unit));
    api().BindTexture(GL_TEXTURE_2D, id);
  }
  GLuint id = 0;
};

Texture colorTexture(int w, int h, GLint filter = GL_LINEAR) {
  return {w, h, GL_RGBA16F, GL_RGBA, GL_FLOAT, filter};
}
Texture depthTexture(int w, int h, GLint filter) {
  return {w, h, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT, GL_FLOAT, filter};
}

/// Where a pass draws to.
class Target {
 public:
  Target(int width, int height, const Texture* color, const Texture* depth) : width_(width), height_(height) {
    api().GenFramebuffers(1, &id);
    api().BindFramebuffer(GL_FRAMEBUFFER, id);
    if (color) api().FramebufferTexture2D(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_TEXTURE_2D, color->id, 0);
    if (depth) api().FramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, depth->id, 0);
    api().DrawBuffer(color ? GL_COLOR_ATTACHMENT0 : GL_NONE);
    api().ReadBuffer(color ? GL_COLOR_ATTACHMENT0 : GL_NONE);
    if (api().CheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
      throw std::runtime_error("OpenGL can't draw to a buffer of " + std::to_string(width) + "x" +
                               std::to_string(height) + " pixels");
    }
  }
  ~Target() { api().DeleteFramebuffers(1, &id); }
  Target(const Target&) = delete;
  Target& operator=(const Target&) = delete;
  void begin() const {
    api().BindFramebuffer(GL_FRAMEBUFFER, id);
    api().Viewport(0, 0, width_, height_);
  }
  GLuint id = 0;

 private:
  int width_, height_;
};

/// A surface in OpenGL's memory.
struct Buffers {
  GLuint array = 0, data[2] = {0, 0};
  GLsizei corners = 0;
  explicit Buffers(const Surface& surface) : corners(static_cast<GLsizei>(surface.corners.size())) {
    api().GenVertexArrays(1, &array);
    api().GenBuffers(2, data);
    api().BindVertexArray(array);
    const std::vector<Vector3f>* sources[2] = {&surface.corners, &surface.normals};
    for (GLuint i = 0; i < 2; ++i) {
      api().BindBuffer(GL_ARRAY_BUFFER, data[i]);
      api().BufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(sources[i]->size() * sizeof(Vector3f)),
                       sources[i]->data(), GL_STATIC_DRAW);
      api().VertexAttribPointer(i, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
      api().EnableVertexAttribArray(i);
    }
  }
  ~Buffers() {
    api().DeleteVertexArrays(1, &array);
    api().DeleteBuffers(2, data);
  }
  Buffers(const Buffers&) = delete;
  Buffers& operator=(const Buffers&) = delete;
};

Matrix4f lookAt(const Vector3d& eye, const Vector3d& target) {
  const Vector3d back = (eye - target).normalized();
  const Vector3d up = std::abs(back.z()) > 0.9999 ? Vector3d::UnitY() : Vector3d::UnitZ();
  Eigen::Matrix3d rotation;
  rotation.row(0) = up.cross(back).normalized();
  rotation.row(2) = back;
  rotation.row(1) = back.cross(Vector3d(rotation.row(0)));
  Eigen::Matrix4d view = Eigen::Matrix4d::Identity();
  view.topLeftCorner<3, 3>() = rotation;
  view.topRightCorner<3, 1>() = -rotation * eye;
  return view.cast<float>();
}

Matrix4f perspective(double aspect, double near, double far) {
  const double f = 1 / std::tan(kFieldOfView / 2);
  Matrix4f m = Matrix4f::Zero();
  m(0, 0) = static_cast<float>(f / aspect);
  m(1, 1) = static_cast<float>(f);
  m(2, 2) = static_cast<float>((far + near) / (near - far));
  m(2, 3) = static_cast<float>(2 * far * near / (near - far));
  m(3, 2) = -1;
  return m;
}

Matrix4f orthographic(double half_width, double near, double far) {
  Matrix4f m = Matrix4f::Identity();
  m(0, 0) = m(1, 1) = static_cast<float>(1 / half_width);
  m(2, 2) = static_cast<float>(-2 / (far - near));
  m(2, 3) = static_cast<float>(-(far + near) / (far - near));
  return m;
}

/// Direction to the sun: high, over the viewer's right shoulder, so that visible sides are lit.
Vector3d sunFor(const Camera& camera) {
  const Vector3d back = camera.eye - camera.target;
  const Vector3d level = std::hypot(back.x(), back.y()) > 1e-6 * std::abs(back.z())
                             ? Vector3d(back.x(), back.y(), 0).normalized()
                             : -Vector3d::UnitY();
  constexpr double kTurn = 0.75;  // rad
  return (Eigen::AngleAxisd(kTurn, Vector3d::UnitZ()) * level + 1.45 * Vector3d::UnitZ()).normalized();
}

/// A square around `center` in a horizontal plane.
Surface groundSurface(const Vector3d& center, double z, double half_width) {
  Surface out;
  for (const auto& [x, y] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, -1}, {1, 1}, {-1, 1}}) {
    out.corners.push_back(Vector3d(center.x() + x * half_width, center.y() + y * half_width, z).cast<float>());
    out.normals.push_back(Vector3f::UnitZ());
    out.box.extend(out.corners.back());
  }
  return out;
}

/// A part of a view, pixels.
struct Part {
  int x = 0, y = 0, width, height;
};

/// The part of a view in which bodies are, and `around` pixels beyond. If a body reaches behind the eye, all of the
/// view.
Part partOf(const std::vector<Body>& bodies, const Matrix4f& view_projection, int width, int height, int around) {
  Eigen::AlignedBox2f box;
  for (const Body& body : bodies) {
    if (body.surface->box.isEmpty()) continue;
    const Matrix4f projection = view_projection * body.M_0.matrix().cast<float>();
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector4f p =
          projection * body.surface->box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)).homogeneous();
      if (!(p.w() > 0)) return {0, 0, width, height};
      box.extend(Eigen::Vector2f(p.head<2>() / p.w()));
    }
  }
  const auto pixel = [&](float x, int size, int beyond) {
    return static_cast<int>(std::clamp((x + 1) / 2 * static_cast<float>(size) + static_cast<float>(beyond), 0.0f,
                                       static_cast<float>(size)));
  };
  if (box.isEmpty()) return {0, 0, 0, 0};
  const int x = pixel(box.min().x(), width, -around), y = pixel(box.min().y(), height, -around);
  return {x, y, pixel(box.max().x(), width, around + 1) - x, pixel(box.max().y(), height, around + 1) - y};
}

/// 1, 2 or 5 times a power of ten, at most x.
double roundStep(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double step : {5.0, 2.0}) {
    if (step * power <= x) return step * power;
  }
  return power;
}

}  // namespace

std::shared_ptr<const Surface> makeSurface(const Triangles& triangles) {
  const std::size_t faces = triangles.faces.size();
  // Vertices at one place are one vertex, whatever the mesh's numbering says (an STL shares none).
  struct Hash {
    std::size_t operator()(const Vector3d& v) const {
      std::size_t h = 0;
      for (int i = 0; i < 3; ++i) h = h * 1099511628211u ^ std::hash<double>()(v[i] + 0.0);  // + 0.0: -0 is 0
      return h;
    }
  };
  std::unordered_map<Vector3d, int, Hash> places;
  places.reserve(triangles.vertices.size());
  std::vector<int> place(triangles.vertices.size());
  for (std::size_t i = 0; i < place.size(); ++i) {
    place[i] = places.emplace(triangles.vertices[i], static_cast<int>(places.size())).first->second;
  }
  std::vector<Vector3f> area_normal(faces);
  std::vector<std::vector<int>> around(places.size());
  for (std::size_t f = 0; f < faces; ++f) {
    const auto& [a, b, c] = triangles.faces[f];
    const auto& v = triangles.vertices;
    const auto at = [&](int i) -> const Vector3d& { return v[static_cast<std::size_t>(i)]; };
    area_normal[f] = (at(b) - at(a)).cross(at(c) - at(a)).cast<float>();
    for (const int i : triangles.faces[f]) {
      around[static_cast<std::size_t>(place[static_cast<std::size_t>(i)])].push_back(static_cast<int>(f));
    }
  }
  auto surface = std::make_shared<Surface>();
  surface->corners.reserve(3 * faces);
  surface->normals.reserve(3 * faces);
  for (std::size_t f = 0; f < faces; ++f) {
    const float size = area_normal[f].norm();
    for (const int i : triangles.faces[f]) {
      Vector3f normal = area_normal[f];
      for (const int other : around[static_cast<std::size_t>(place[static_cast<std::size_t>(i)])]) {
        const Vector3f& n = area_normal[static_cast<std::size_t>(other)];
        if (static_cast<std::size_t>(other) != f && n.dot(area_normal[f]) > kCreaseCosine * n.norm() * size)
          normal += n;
      }
      surface->corners.push_back(triangles.vertices[static_cast<std::size_t>(i)].cast<float>());
      surface->normals.push_back(size > 0 ? normal.normalized() : Vector3f::UnitZ());
      surface->box.extend(surface->corners.back());
    }
  }
  return surface;
}

struct Renderer::Impl {
  std::unique_ptr<OffscreenContext> context = openContext();
  std::unique_ptr<opengl::Functions> functions;

  struct Programs {
    Program depth{shaders::kBodyVertex, shaders::kEmptyFragment};
    Program group{shaders::kBodyVertex, shaders::kGroupFragment};
    Program normal{shaders::kBodyVertex, std::string(shaders::kVersion) + shaders::kFacing + shaders::kNormalFragment};
    Program body{shaders::kBodyVertex,
                 std::string(shaders::kVersion) + shaders::kFacing + shaders::kLight + shaders::kBodyFragment};
    Program ground{shaders::kBodyVertex, std::string(shaders::kVersion) + shaders::kLight + shaders::kGroundFragment};
    Program background{shaders::kScreenVertex, shaders::kBackgroundFragment};
    Program occlusion{shaders::kScreenVertex, shaders::kOcclusionFragment};
    Program blur{shaders::kScreenVertex, shaders::kBlurFragment};
    Program layer{shaders::kScreenVertex, shaders::kLayerFragment};
    Program resolve{shaders::kScreenVertex, shaders::kResolveFragment};
  };
  std::unique_ptr<Programs> programs;
  GLuint empty_array = 0;
  // Kept with their surfaces, so that an address is not used again for another one.
  std::map<std::shared_ptr<const Surface>, std::unique_ptr<Buffers>> buffers;

  Impl() {
    context->makeCurrent();
    try {
      functions = std::make_unique<opengl::Functions>(*context);
      bound = functions.get();
      api().GenVertexArrays(1, &empty_array);
      api().PixelStorei(GL_PACK_ALIGNMENT, 1);
      programs = std::make_unique<Programs>();
    } catch (...) {
      leave();
      throw;
    }
  }
  ~Impl() {
    buffers.clear();
    leave();
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
  void leave() {
    context->release();
    bound = nullptr;
  }

  const Buffers& buffersOf(const std::shared_ptr<const Surface>& surface) {
    auto& slot = buffers[surface];
    if (!slot) slot = std::make_unique<Buffers>(*surface);
    return *slot;
  }
  void drawBody(const Program& program, const Body& body) {
    const Buffers& b = buffersOf(body.surface);
    program.set("model", Matrix4f(body.M_0.matrix().cast<float>()));
    api().BindVertexArray(b.array);
    api().DrawArrays(GL_TRIANGLES, 0, b.corners);
  }
  void drawMaterial(const Body& body) {
    const Program& p = programs->body;
    p.set("color", body.color);
    p.set("highlight", body.highlight);
    p.set("highlight_radius", std::max(body.highlight_radius, 1e-6f));
    p.set("highlight_floor", body.highlight_floor);
    p.set("glow", body.glow);
    drawBody(p, body);
  }
  void drawScreen() {
    api().BindVertexArray(empty_array);
    api().DrawArrays(GL_TRIANGLES, 0, 3);
  }
};

Renderer::Renderer() : impl_(std::make_unique<Impl>()) {}
Renderer::~Renderer() = default;

std::vector<int> Renderer::visiblePixels(const std::vector<Body>& bodies, const std::vector<int>& groups,
                                         const Camera& camera, int width, int height) {
  const Texture color(width, height, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_NEAREST);
  const Texture depth = depthTexture(width, height, GL_NEAREST);
  const Target target(width, height, &color, &depth);
  target.begin();
  api().Disable(GL_BLEND);
  api().Enable(GL_DEPTH_TEST);
  api().DepthFunc(GL_LESS);
  api().DepthMask(GL_TRUE);
  api().ClearColor(1, 1, 1, 1);
  api().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  const Program& program = impl_->programs->group;
  program.use();
  program.set("view_projection", Matrix4f(perspective(static_cast<double>(width) / height, camera.near, camera.far) *
                                          lookAt(camera.eye, camera.target)));
  int top = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    top = std::max(top, groups[i]);
    program.set("color", Vector3f(static_cast<float>(groups[i]) / 255, 0, 0));
    impl_->drawBody(program, bodies[i]);
  }
  std::vector<std::uint8_t> pixels(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 4);
  api().ReadPixels(0, 0, width, height, GL_RGBA, GL_UNSIGNED_BYTE, pixels.data());
  std::vector<int> count(static_cast<std::size_t>(top) + 1);
  for (std::size_t i = 0; i < pixels.size(); i += 4) {
    if (pixels[i] < count.size()) ++count[pixels[i]];
  }
  return count;
}

Image Renderer::draw(const Stage& stage, const Camera& camera, int width, int height) {
  Impl& gl = *impl_;
  const Impl::Programs& programs = *gl.programs;
  const int w = kSupersampling * width, h = kSupersampling * height;
  GLint limit = 0;
  api().GetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  if (w > limit || h > limit) {
    throw std::runtime_error("a picture has at most " + std::to_string(limit / kSupersampling) + " pixels a side");
  }

  const Matrix4f projection = perspective(static_cast<double>(width) / height, camera.near, camera.far),
                 view_projection = projection * lookAt(camera.eye, camera.target);
  const Vector3d sun = sunFor(camera);
  const double shadow_radius = 1.8 * stage.radius, sun_distance = 20 * stage.radius;
  const Matrix4f shadow_matrix =
      orthographic(shadow_radius, 0, 2 * sun_distance) * lookAt(stage.focus + sun_distance * sun, stage.focus);
  const Vector3f eye = camera.eye.cast<float>();

  Body ground;
  const double fade_radius = 4.5 * stage.radius;
  ground.surface = std::make_shared<Surface>(groundSurface(stage.focus, stage.ground_z, fade_radius));
  const bool ground_seen = camera.eye.z() > stage.ground_z;

  const Texture color = colorTexture(w, h), layer = colorTexture(w, h);
  const Texture normal = colorTexture(w, h, GL_NEAREST);  // a mean of two surfaces' normals is none's
  const Texture depth = depthTexture(w, h, GL_NEAREST), layer_depth = depthTexture(w, h, GL_NEAREST);
  const Texture occlusion(width, height, GL_R16F, GL_RED, GL_FLOAT, GL_LINEAR),
      blurred(width, height, GL_R16F, GL_RED, GL_FLOAT, GL_LINEAR);
  const Texture shadow = depthTexture(kShadowSize, kShadowSize, GL_LINEAR);
  api().TexParameteri(GL_TEXTURE_2D, GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE);

  // Depth as the sun sees it.
  api().Disable(GL_BLEND);
  api().Enable(GL_DEPTH_TEST);
  api().DepthFunc(GL_LEQUAL);
  api().DepthMask(GL_TRUE);
  const Target shadow_target(kShadowSize, kShadowSize, nullptr, &shadow);
  shadow_target.begin();
  api().Clear(GL_DEPTH_BUFFER_BIT);
  programs.depth.use();
  programs.depth.set("view_projection", shadow_matrix);
  for (const Body& body : stage.solid) {
    if (body.throws_shadow) gl.drawBody(programs.depth, body);
  }

  // Depth and normals as the camera sees them, and how open each point is.
  const Target normal_target(w, h, &normal, &depth);
  normal_target.begin();
  api().ClearColor(0, 0, 0, 0);
  api().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  programs.normal.use();
  programs.normal.set("view_projection", view_projection);
  programs.normal.set("eye", eye);
  for (const Body& body : stage.solid) {
    programs.normal.set("clear_of_ghosts", body.clear_of_ghosts ? 1.0f : 0.0f);
    gl.drawBody(programs.normal, body);
  }
  programs.normal.set("clear_of_ghosts", 0.0f);
  if (ground_seen) gl.drawBody(programs.normal, ground);

  api().Disable(GL_DEPTH_TEST);
  const Target occlusion_target(width, height, &occlusion, nullptr);
  occlusion_target.begin();
  programs.occlusion.use();
  depth.bind(0);
  normal.bind(1);
  programs.occlusion.set("depth_map", 0);
  programs.occlusion.set("normal_map", 1);
  programs.occlusion.set("view_projection", view_projection);
  programs.occlusion.set("inverse_view_projection", Matrix4f(view_projection.inverse()));
  programs.occlusion.set("eye", eye);
  programs.occlusion.set("radius", static_cast<float>(0.13 * stage.radius));
  programs.occlusion.set("depth_law", projection(2, 2), projection(2, 3));
  gl.drawScreen();
  programs.blur.use();
  programs.blur.set("source", 0);
  programs.blur.set("normal_map", 1);
  const Target blur_target(width, height, &blurred, nullptr);
  const auto blur = [&](const Texture& from, const Target& to, float x, float y) {
    to.begin();
    from.bind(0);
    programs.blur.set("next_pixel", x / static_cast<float>(width), y / static_cast<float>(height));
    gl.drawScreen();
  };
  blur(occlusion, blur_target, 1, 0);
  blur(blurred, occlusion_target, 0, 1);

  // The solid world.
  const Target main_target(w, h, &color, &depth);
  main_target.begin();
  programs.background.use();
  gl.drawScreen();
  const auto light = [&](const Program& p) {
    p.use();
    shadow.bind(0);
    occlusion.bind(1);
    p.set("shadow_map", 0);
    p.set("occlusion_map", 1);
    p.set("view_projection", view_projection);
    p.set("shadow_matrix", shadow_matrix);
    p.set("eye", eye);
    p.set("sun", Vector3f(sun.cast<float>()));
    p.set("pixel_size", 1.0f / static_cast<float>(w), 1.0f / static_cast<float>(h));
  };
  api().Enable(GL_DEPTH_TEST);
  api().BlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  if (ground_seen) {
    api().Enable(GL_BLEND);
    light(programs.ground);
    programs.ground.set("focus", Vector3f(stage.focus.cast<float>()));
    programs.ground.set("fade_radius", static_cast<float>(fade_radius));
    programs.ground.set("cell", static_cast<float>(roundStep(0.2 * stage.radius)));
    gl.drawBody(programs.ground, ground);
    api().Disable(GL_BLEND);
  }
  const Program& body_program = programs.body;
  light(body_program);
  body_program.set("highlight_center", Vector3f(stage.highlight_center.cast<float>()));
  body_program.set("opacity", 1.0f);
  body_program.set("rim", 0.0f);
  body_program.set("use_occlusion", 1);
  for (const Body& body : stage.solid) gl.drawMaterial(body);

  // Translucent layers: each is drawn by itself against the solid depth, so that it shows its nearest surface only.
  const Target layer_target(w, h, &layer, &layer_depth);
  struct Lay {
    float opacity = 1, rim = 0;  // rim: how much more of it shows at silhouettes
    bool over_all = false;       // not hidden by anything
    int outline = 0;             // pixels of light rim
  };
  const auto lay = [&](const std::vector<Body>& bodies, const Lay& how) {
    layer_target.begin();
    api().ClearColor(0, 0, 0, 0);
    // The rim looks beyond the part that is drawn.
    if (how.over_all) api().Clear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
    const Part part = partOf(bodies, view_projection, w, h, how.outline);
    api().Enable(GL_SCISSOR_TEST);
    api().Scissor(part.x, part.y, part.width, part.height);
    if (!how.over_all) {
      api().Clear(GL_COLOR_BUFFER_BIT);
      api().BindFramebuffer(GL_READ_FRAMEBUFFER, main_target.id);
      api().BlitFramebuffer(0, 0, w, h, 0, 0, w, h, GL_DEPTH_BUFFER_BIT, GL_NEAREST);
    }
    // Depth first, so that what is hidden is not shaded.
    api().ColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    programs.depth.use();
    programs.depth.set("view_projection", view_projection);
    for (const Body& body : bodies) gl.drawBody(programs.depth, body);
    api().ColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    light(body_program);
    body_program.set("opacity", how.opacity);
    body_program.set("rim", how.rim);
    body_program.set("use_occlusion", 0);
    for (const Body& body : bodies) gl.drawMaterial(body);
    main_target.begin();
    api().Disable(GL_DEPTH_TEST);
    api().Enable(GL_BLEND);
    programs.layer.use();
    layer.bind(0);
    normal.bind(1);
    programs.layer.set("layer", 0);
    programs.layer.set("normal_map", 1);
    programs.layer.set("outline", how.outline);
    programs.layer.set("pixel_size", 1.0f / static_cast<float>(w), 1.0f / static_cast<float>(h));
    gl.drawScreen();
    api().Disable(GL_BLEND);
    api().Disable(GL_SCISSOR_TEST);
    api().Enable(GL_DEPTH_TEST);
  };
  std::vector<Body> important;
  for (const Body& body : stage.solid) {
    if (body.clear_of_ghosts) important.push_back(body);
  }
  lay(important, {kSeeThrough, 0.3f, true, 0});
  for (const Ghost& ghost : stage.ghosts) lay(ghost.bodies, {ghost.opacity, 1, false, 0});
  if (!stage.annotations.empty()) lay(stage.annotations, {1, 0, true, 3 * kSupersampling / 2});

  // Down to the picture's size.
  const Texture final_color(width, height, GL_RGBA8, GL_RGBA, GL_UNSIGNED_BYTE, GL_NEAREST);
  const Target final_target(width, height, &final_color, nullptr);
  final_target.begin();
  api().Disable(GL_DEPTH_TEST);
  programs.resolve.use();
  color.bind(0);
  programs.resolve.set("source", 0);
  gl.drawScreen();
  Image image{width, height, {}};
  const std::size_t row = 3 * static_cast<std::size_t>(width);
  std::vector<std::uint8_t> flipped(row * static_cast<std::size_t>(height));
  api().ReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, flipped.data());
  if (const GLenum error = api().GetError()) throw std::runtime_error("OpenGL error " + std::to_string(error));
  image.rgb.reserve(flipped.size());
  for (int y = height - 1; y >= 0; --y) {
    const auto first = flipped.begin() + static_cast<std::ptrdiff_t>(row * static_cast<std::size_t>(y));
    image.rgb.insert(image.rgb.end(), first, first + static_cast<std::ptrdiff_t>(row));
  }
  return image;
}

}  // namespace fcl_artic::render
