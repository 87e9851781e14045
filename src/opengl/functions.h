// SPDX-License-Identifier: BSD-3-Clause
//
// OpenGL's functions as a context gives them, for stage 2 and for pictures: nothing is linked.
#pragma once

#include <initializer_list>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#define GL_GLEXT_PROTOTYPES  // their types
#include <GL/glcorearb.h>

#include "fcl_artic/visibility/offscreen.h"

namespace fcl_artic {
namespace opengl {

/// Held while an OpenGL context is made, used or destroyed: one of the library's contexts is at work at a time. (Mesa's
/// software rasteriser reads, without a lock, what other contexts of a display are drawing; doc/VISIBILITY.md,
/// "Contexts".)
std::mutex& turns();

/// One context's functions, under their names without "gl".
struct Functions {
// clang-format off
#define FCL_ARTIC_GL_FUNCTIONS(X)                                                                                     \
  X(ActiveTexture) X(AttachShader) X(BindBuffer) X(BindBufferBase) X(BindFramebuffer) X(BindTexture)                  \
  X(BindVertexArray) X(BlendEquation) X(BlendFunc) X(BlitFramebuffer) X(BufferData) X(CheckFramebufferStatus)         \
  X(Clear) X(ClearBufferfv) X(ClearColor) X(ColorMask) X(CompileShader) X(CreateProgram) X(CreateShader)              \
  X(DeleteBuffers) X(DeleteFramebuffers) X(DeleteShader) X(DeleteTextures) X(DeleteVertexArrays) X(DepthFunc)         \
  X(DepthMask) X(Disable) X(DrawArrays) X(DrawArraysInstanced) X(DrawBuffer) X(Enable) X(EnableVertexAttribArray)     \
  X(FramebufferParameteri) X(FramebufferTexture2D) X(GenBuffers) X(GenFramebuffers) X(GenTextures) X(GenVertexArrays) \
  X(GetBufferSubData) X(GetError) X(GetIntegerv) X(GetProgramInfoLog) X(GetProgramiv) X(GetShaderInfoLog)             \
  X(GetShaderiv) X(GetUniformLocation) X(LinkProgram) X(MemoryBarrier) X(PixelStorei) X(ReadBuffer) X(ReadPixels)     \
  X(Scissor) X(ShaderSource) X(TexImage2D) X(TexParameteri) X(Uniform1f) X(Uniform1i) X(Uniform2f) X(Uniform3fv)      \
  X(UniformMatrix4fv) X(UseProgram) X(VertexAttribPointer) X(Viewport)
// clang-format on
#define FCL_ARTIC_GL_DECLARE(name) decltype(&::gl##name) name = nullptr;  // NOLINT: a member's name
  FCL_ARTIC_GL_FUNCTIONS(FCL_ARTIC_GL_DECLARE)
#undef FCL_ARTIC_GL_DECLARE

  /// @param context  is current.
  /// @throws std::runtime_error naming a function that is missing.
  explicit Functions(const OffscreenContext& context) {
// NOLINTBEGIN(bugprone-macro-parentheses): the name of a member
#define FCL_ARTIC_GL_LOAD(name)                                          \
  name = reinterpret_cast<decltype(name)>(context.function("gl" #name)); \
  if (!name) throw std::runtime_error("the driver lacks gl" #name);
    // NOLINTEND(bugprone-macro-parentheses)
    FCL_ARTIC_GL_FUNCTIONS(FCL_ARTIC_GL_LOAD)
#undef FCL_ARTIC_GL_LOAD
  }
#undef FCL_ARTIC_GL_FUNCTIONS

  /// Compiles and links.
  /// @throws std::runtime_error with the driver's words.
  GLuint program(const char* vertex, const char* fragment) const {
    const GLuint id = CreateProgram();
    char log[2048] = "";
    GLint good = 0;
    for (const auto& [kind, source] : {std::pair(GL_VERTEX_SHADER, vertex), std::pair(GL_FRAGMENT_SHADER, fragment)}) {
      const GLuint shader = CreateShader(static_cast<GLenum>(kind));
      ShaderSource(shader, 1, &source, nullptr);
      CompileShader(shader);
      GetShaderiv(shader, GL_COMPILE_STATUS, &good);
      GetShaderInfoLog(shader, sizeof log, nullptr, log);
      if (!good) throw std::runtime_error(std::string("can't compile a shader: ") + log);
      AttachShader(id, shader);
      DeleteShader(shader);
    }
    LinkProgram(id);
    GetProgramiv(id, GL_LINK_STATUS, &good);
    GetProgramInfoLog(id, sizeof log, nullptr, log);
    if (!good) throw std::runtime_error(std::string("can't link a shader: ") + log);
    return id;
  }
};

}  // namespace opengl
}  // namespace fcl_artic
