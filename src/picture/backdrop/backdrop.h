// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "aircraft/model/mesh.h"
#include "camera/lens/lens.h"
#include "foundation/geometry/transform.h"
#include "foundation/image/picture.h"
#include "picture/shade/light.h"

// The virtual image of the E-Vision paper (section II.B), rendered by OpenSceneGraph in OpenGL on
// EGL without a screen: the intruders over a chroma key green backdrop, with averaged normals,
// antialiasing, anisotropic filtering and one directional light. The camera is a pinhole for every
// lens of the scene, because OpenGL and the paper have no other.
namespace airtruth::backdrop {

struct Instance {
  const model::Mesh* mesh = nullptr;
  Rigid world_from_body;
  double time_s = 0;
};

struct Options {
  // Index of the EGL device; empty: the first GPU if there is one, else llvmpipe.
  std::optional<int> gpu;
  // True: llvmpipe (--gpu none).
  bool software = false;
};

// One OpenGL context. One thread uses it at a time. A mesh that it has drawn stays on the device;
// it must outlive the Backdrop unchanged.
class Backdrop {
 public:
  Backdrop() = default;
  virtual ~Backdrop() = default;
  Backdrop(const Backdrop&) = delete;
  Backdrop& operator=(const Backdrop&) = delete;

  // The virtual image: sRGB over pure green. The light is that of sun, sky and ground alone.
  virtual image::Rgb8 render(const lens::Pinhole& lens,
                             const Rigid& cam_from_world,
                             const shade::Light& light,
                             const std::vector<Instance>& instances) = 0;

  // The same picture, drawn `supersampling` times larger in each direction over transparent black
  // and averaged: linear premultiplied colour and alpha. It is the independent result with which
  // tests compare render's layer.
  virtual std::vector<std::array<float, 4>> render_alpha(const lens::Pinhole& lens,
                                                         const Rigid& cam_from_world,
                                                         const shade::Light& light,
                                                         const std::vector<Instance>& instances,
                                                         int supersampling) = 0;

  // For example "llvmpipe (LLVM 15.0.6, 256 bits)", or the GPU's name.
  virtual std::string device_name() const = 0;
};

// OpenSceneGraph and OpenGL are in a library that is loaded at the first call
// (foundation/lazy_library/lazy_library.h). Throws Error where it is not installed, and where no
// EGL device can be opened.
std::unique_ptr<Backdrop> open_backdrop(int width, int height, const Options& options);

// The library holds a BackdropOpener of this name (lazy_library::of_build()).
using BackdropOpener = std::unique_ptr<Backdrop> (*)(int width, int height, const Options& options);
constexpr const char* kBackdropSymbol = "airtruth_open_backdrop";
// What that opener is. Throws Error where no EGL device can be opened.
std::unique_ptr<Backdrop> make_osg_backdrop(int width, int height, const Options& options);

}  // namespace airtruth::backdrop
