// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aircraft/model/mesh.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"

// The paper's virtual image (section II.B): OpenGL by OpenSceneGraph on EGL without a screen.
// Intruders over a chroma key green backdrop, averaged normals, antialiasing, anisotropic
// filtering, one directional light. A pinhole camera, whatever the scene's lens: OpenGL has no
// other, and nor had the paper.
namespace airtruth::backdrop {

struct Instance {
  const aircraft::Mesh* mesh = nullptr;
  Rigid world_from_body;
  double time_s = 0;
};

struct Light {  // as render::Light
  Vector3 to_sun_in_world{0, 0, -1};
  std::array<float, 3> sun = {1, 1, 1};
  std::array<float, 3> sky = {0.3f, 0.3f, 0.3f};
  std::array<float, 3> ground = {0.1f, 0.1f, 0.1f};
};

struct Options {
  int samples = 4;  // multisamples per pixel
  float anisotropy = 16;
  std::optional<int> gpu;  // EGL device; empty: the first GPU if there is one, else llvmpipe
  bool software = false;   // --gpu none: llvmpipe
};

// One OpenGL context; use it from one thread at a time. A mesh that it has drawn stays on the
// device and must outlive it unchanged.
class Backdrop {
 public:
  // Throws Error where no EGL device can be opened.
  Backdrop(int width, int height, const Options& options);
  ~Backdrop();

  // The virtual image: sRGB over pure green. focal and principal point in airtruth's pixels.
  image::Rgb8 render(const Pixel& focal_px,
                     const Pixel& principal_point_px,
                     const Rigid& cam_from_world,
                     const Light& light,
                     const std::vector<Instance>& instances);

  // The same drawn `supersampling` times larger in each direction over transparent black and
  // averaged: linear premultiplied colour and alpha, the independent answer that render's layer is
  // tested against.
  std::vector<std::array<float, 4>> render_alpha(const Pixel& focal_px,
                                                 const Pixel& principal_point_px,
                                                 const Rigid& cam_from_world,
                                                 const Light& light,
                                                 const std::vector<Instance>& instances,
                                                 int supersampling);

  // "llvmpipe (LLVM 15.0.6, 256 bits)" or the GPU's name.
  std::string device_name() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace airtruth::backdrop
