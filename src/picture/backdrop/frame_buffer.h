// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include <osg/GL>
#include <osg/GLExtensions>

namespace airtruth::backdrop {

// A render target of colour and depth, multisampled where samples > 1. Every call needs the context
// to be current.
//
// It uses plain OpenGL: OpenSceneGraph's own multisampled camera requests NVIDIA's coverage samples
// from Mesa and silently draws without antialiasing.
class FrameBuffer {
 public:
  FrameBuffer(osg::GLExtensions& gl, int width, int height, GLenum colour_format, int samples);
  ~FrameBuffer();
  FrameBuffer(const FrameBuffer&) = delete;
  FrameBuffer& operator=(const FrameBuffer&) = delete;

  int width() const { return width_; }
  int height() const { return height_; }
  GLuint id() const { return drawn_.frame; }

  // Reads the pixels after resolving the samples, bottom row first, as OpenGL stores them.
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
  // Unused without multisampling.
  Buffers resolved_;
};

}  // namespace airtruth::backdrop
