// SPDX-License-Identifier: Apache-2.0
#include "picture/backdrop/frame_buffer.h"

#include <string>

#include <osg/FrameBufferObject>

#include "foundation/base/error.h"

namespace airtruth::backdrop {

FrameBuffer::FrameBuffer(
    osg::GLExtensions& gl, int width, int height, GLenum colour_format, int samples)
    : gl_(gl), width_(width), height_(height) {
  GLint largest = 0;
  glGetIntegerv(GL_MAX_RENDERBUFFER_SIZE_EXT, &largest);
  if (width > largest || height > largest)
    throw Error("a picture of " + std::to_string(width) + "x" + std::to_string(height) +
                " is more than OpenGL draws here; expected at most " + std::to_string(largest) +
                " either way");
  drawn_ = make(colour_format, samples, true);
  if (samples > 1) resolved_ = make(colour_format, 0, false);
}

FrameBuffer::~FrameBuffer() {
  remove(drawn_);
  remove(resolved_);
}

GLuint FrameBuffer::make_renderbuffer(GLenum format, int samples) {
  GLuint id = 0;
  gl_.glGenRenderbuffers(1, &id);
  gl_.glBindRenderbuffer(GL_RENDERBUFFER_EXT, id);
  if (samples > 1) {
    gl_.glRenderbufferStorageMultisample(GL_RENDERBUFFER_EXT, samples, format, width_, height_);
  } else {
    gl_.glRenderbufferStorage(GL_RENDERBUFFER_EXT, format, width_, height_);
  }
  return id;
}

FrameBuffer::Buffers FrameBuffer::make(GLenum colour_format, int samples, bool with_depth) {
  Buffers buffers;
  gl_.glGenFramebuffers(1, &buffers.frame);
  gl_.glBindFramebuffer(GL_FRAMEBUFFER_EXT, buffers.frame);
  buffers.colour = make_renderbuffer(colour_format, samples);
  gl_.glFramebufferRenderbuffer(
      GL_FRAMEBUFFER_EXT, GL_COLOR_ATTACHMENT0_EXT, GL_RENDERBUFFER_EXT, buffers.colour);
  if (with_depth) {
    buffers.depth = make_renderbuffer(GL_DEPTH_COMPONENT32F, samples);
    gl_.glFramebufferRenderbuffer(
        GL_FRAMEBUFFER_EXT, GL_DEPTH_ATTACHMENT_EXT, GL_RENDERBUFFER_EXT, buffers.depth);
  }
  if (gl_.glCheckFramebufferStatus(GL_FRAMEBUFFER_EXT) != GL_FRAMEBUFFER_COMPLETE_EXT)
    throw Error("OpenGL cannot draw into a " + std::to_string(width_) + "x" +
                std::to_string(height_) + " picture with " + std::to_string(samples) +
                " samples a pixel here");
  return buffers;
}

void FrameBuffer::remove(const Buffers& buffers) {
  if (buffers.frame != 0) gl_.glDeleteFramebuffers(1, &buffers.frame);
  if (buffers.colour != 0) gl_.glDeleteRenderbuffers(1, &buffers.colour);
  if (buffers.depth != 0) gl_.glDeleteRenderbuffers(1, &buffers.depth);
}

void FrameBuffer::read(GLenum format, GLenum type, void* pixels) {
  if (resolved_.frame != 0) {
    gl_.glBindFramebuffer(GL_READ_FRAMEBUFFER_EXT, drawn_.frame);
    gl_.glBindFramebuffer(GL_DRAW_FRAMEBUFFER_EXT, resolved_.frame);
    gl_.glBlitFramebuffer(
        0, 0, width_, height_, 0, 0, width_, height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
  gl_.glBindFramebuffer(GL_FRAMEBUFFER_EXT, resolved_.frame != 0 ? resolved_.frame : drawn_.frame);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, format, type, pixels);
}

}  // namespace airtruth::backdrop
