// SPDX-License-Identifier: BSD-3-Clause
//
// OpenGL's functions as a context gives them: nothing is linked.
#pragma once

#include <stdexcept>
#include <string>

#include <GL/glcorearb.h>

#include "fcl_artic/visibility/offscreen.h"

namespace fcl_artic {
namespace visibility {

/// One context's functions, under their names without "gl".
struct GlFunctions {
// clang-format off
#define FCL_ARTIC_GL_FUNCTIONS(X)                                                                                   \
  X(ActiveTexture, ACTIVETEXTURE) X(AttachShader, ATTACHSHADER) X(BindBuffer, BINDBUFFER)                           \
  X(BindBufferBase, BINDBUFFERBASE) X(BindFramebuffer, BINDFRAMEBUFFER) X(BindTexture, BINDTEXTURE)                 \
  X(BindVertexArray, BINDVERTEXARRAY) X(BlendEquation, BLENDEQUATION) X(BlendFunc, BLENDFUNC)                       \
  X(BlitFramebuffer, BLITFRAMEBUFFER) X(BufferData, BUFFERDATA) X(CheckFramebufferStatus, CHECKFRAMEBUFFERSTATUS)   \
  X(Clear, CLEAR) X(ClearBufferfv, CLEARBUFFERFV) X(ClearColor, CLEARCOLOR) X(ColorMask, COLORMASK)                 \
  X(CompileShader, COMPILESHADER) X(CreateProgram, CREATEPROGRAM) X(CreateShader, CREATESHADER)                     \
  X(DeleteBuffers, DELETEBUFFERS) X(DeleteFramebuffers, DELETEFRAMEBUFFERS) X(DeleteProgram, DELETEPROGRAM)         \
  X(DeleteShader, DELETESHADER) X(DeleteTextures, DELETETEXTURES) X(DeleteVertexArrays, DELETEVERTEXARRAYS)         \
  X(DepthFunc, DEPTHFUNC) X(DepthMask, DEPTHMASK) X(Disable, DISABLE) X(DrawArrays, DRAWARRAYS)                     \
  X(DrawArraysInstanced, DRAWARRAYSINSTANCED) X(DrawBuffer, DRAWBUFFER) X(Enable, ENABLE)                           \
  X(EnableVertexAttribArray, ENABLEVERTEXATTRIBARRAY) X(FramebufferTexture2D, FRAMEBUFFERTEXTURE2D)                 \
  X(GenBuffers, GENBUFFERS) X(GenFramebuffers, GENFRAMEBUFFERS) X(GenTextures, GENTEXTURES)                         \
  X(GenVertexArrays, GENVERTEXARRAYS) X(GetBufferSubData, GETBUFFERSUBDATA) X(GetError, GETERROR)                   \
  X(GetIntegerv, GETINTEGERV) X(GetProgramInfoLog, GETPROGRAMINFOLOG) X(GetProgramiv, GETPROGRAMIV)                 \
  X(GetShaderInfoLog, GETSHADERINFOLOG) X(GetShaderiv, GETSHADERIV) X(GetUniformLocation, GETUNIFORMLOCATION)       \
  X(LinkProgram, LINKPROGRAM) X(PixelStorei, PIXELSTOREI) X(ReadBuffer, READBUFFER) X(ReadPixels, READPIXELS)       \
  X(Scissor, SCISSOR) X(ShaderSource, SHADERSOURCE) X(TexImage2D, TEXIMAGE2D) X(TexParameteri, TEXPARAMETERI)       \
  X(Uniform1f, UNIFORM1F) X(Uniform1i, UNIFORM1I) X(Uniform2f, UNIFORM2F) X(Uniform3fv, UNIFORM3FV)                 \
  X(UniformMatrix4fv, UNIFORMMATRIX4FV) X(UseProgram, USEPROGRAM) X(VertexAttribPointer, VERTEXATTRIBPOINTER)       \
  X(Viewport, VIEWPORT)
// clang-format on
#define FCL_ARTIC_GL_DECLARE(name, NAME) PFNGL##NAME##PROC name = nullptr;
  FCL_ARTIC_GL_FUNCTIONS(FCL_ARTIC_GL_DECLARE)
#undef FCL_ARTIC_GL_DECLARE
  // Null, where a context of an older version has none: of OpenGL 4.2, 4.3 and 4.5.
  PFNGLMEMORYBARRIERPROC MemoryBarrier = nullptr;
  PFNGLFRAMEBUFFERPARAMETERIPROC FramebufferParameteri = nullptr;
  PFNGLGETGRAPHICSRESETSTATUSPROC GetGraphicsResetStatus = nullptr;

  /// @param context  is current.
  /// @throws std::runtime_error naming a function that is missing.
  explicit GlFunctions(const OffscreenContext& context) {
// NOLINTBEGIN(bugprone-macro-parentheses): the name of a member
#define FCL_ARTIC_GL_LOAD(name, NAME)                                       \
  name = reinterpret_cast<PFNGL##NAME##PROC>(context.function("gl" #name)); \
  if (!name) throw std::runtime_error("the driver lacks gl" #name);
    // NOLINTEND(bugprone-macro-parentheses)
    FCL_ARTIC_GL_FUNCTIONS(FCL_ARTIC_GL_LOAD)
#undef FCL_ARTIC_GL_LOAD
    MemoryBarrier = reinterpret_cast<PFNGLMEMORYBARRIERPROC>(context.function("glMemoryBarrier"));
    FramebufferParameteri =
        reinterpret_cast<PFNGLFRAMEBUFFERPARAMETERIPROC>(context.function("glFramebufferParameteri"));
    GetGraphicsResetStatus =
        reinterpret_cast<PFNGLGETGRAPHICSRESETSTATUSPROC>(context.function("glGetGraphicsResetStatus"));
  }
#undef FCL_ARTIC_GL_FUNCTIONS

  /// Compiles and links.
  /// @throws std::runtime_error with the driver's words.
  GLuint program(const char* vertex, const char* fragment) const {
    const GLuint id = CreateProgram(), v = shader(GL_VERTEX_SHADER, vertex), f = shader(GL_FRAGMENT_SHADER, fragment);
    AttachShader(id, v);
    AttachShader(id, f);
    LinkProgram(id);
    DeleteShader(v);
    DeleteShader(f);
    GLint good = 0;
    GetProgramiv(id, GL_LINK_STATUS, &good);
    if (good) return id;
    char log[2048] = "";
    GetProgramInfoLog(id, sizeof log, nullptr, log);
    throw std::runtime_error(std::string("can't link a shader: ") + log);
  }

 private:
  GLuint shader(GLenum kind, const char* source) const {
    const GLuint id = CreateShader(kind);
    ShaderSource(id, 1, &source, nullptr);
    CompileShader(id);
    GLint good = 0;
    GetShaderiv(id, GL_COMPILE_STATUS, &good);
    if (good) return id;
    char log[2048] = "";
    GetShaderInfoLog(id, sizeof log, nullptr, log);
    throw std::runtime_error(std::string("can't compile a shader: ") + log);
  }
};

}  // namespace visibility
}  // namespace fcl_artic
