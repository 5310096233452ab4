// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <osg/GL>
#include <osg/GLExtensions>

namespace airtruth::backdrop {

// Colour and depth to draw into, multisampled where samples > 1. All calls need the context to be
// current.
//
// It is made with plain OpenGL: OpenSceneGraph's own multisampled camera asks Mesa for NVIDIA's
// coverage samples and silently draws without antialiasing.
class FrameBuffer {
 public:
  FrameBuffer(osg::GLExtensions& gl, int width, int height, GLenum colour_format, int samples);
  ~FrameBuffer();
  FrameBuffer(const FrameBuffer&) = delete;
  FrameBuffer& operator=(const FrameBuffer&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  GLuint id() const { return drawn_.frame; }

  // The pixels after resolving the samples, bottom row first, as OpenGL has them.
  void read(GLenum format, GLenum type, void* pixels);

 private:
  struct Buffers {
    GLuint frame = 0;
    GLuint colour = 0;
    GLuint depth = 0;
  };
  Buffers make(GLenum colour_format, int samples, bool with_depth);
  GLuint make_renderbuffer(GLenum format, int samples);
  void remove(const Buffers& buffers);

  osg::GLExtensions& gl_;
  int width_;
  int height_;
  Buffers drawn_;
  Buffers resolved_;  // none without multisampling
};

}  // namespace airtruth::backdrop
