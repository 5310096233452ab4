// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <utility>
#include <vector>

#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "picture/backdrop/backdrop.h"
#include "picture/composite/matte.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/ambient.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"

// Puts the intruders of one moment into a picture, by the method that the scene names.
namespace airtruth::insertion {

struct Painted {
  // The ray tracer's layer; for chroma-key, the layer that the ray tracer would draw.
  image::Layer layer;
  // By intruder; empty where none is in view.
  std::vector<composite::Visible> visible;
};

class Painter {
 public:
  Painter(const scene::Scene& scene,
          const setup::World& world,
          const image::Mask* mask,
          std::stop_token stop)
      : scene_(scene), world_(world), mask_(mask), stop_(std::move(stop)) {}
  virtual ~Painter() = default;
  // Renders the layer of a moment. matte: in any thread and order; chroma-key: in one thread.
  Painted draw(const setup::Moment& moment, const Ambient& ambient) const;
  // Composites the layer into the picture and adds the resulting changes to `painted`.
  virtual void compose(image::Picture& picture,
                       const setup::Moment& moment,
                       const Ambient& ambient,
                       Painted& painted) = 0;
  // True where a frame's picture depends on the previous one (a codec's mark). compose() must then
  // receive every frame, one at a time and in order. The value is known once the scene's values
  // are.
  virtual bool is_in_order() const { return false; }

  // Draws and composites a single picture.
  Painted paint(image::Picture& picture, const setup::Moment& moment, const Ambient& ambient);

 protected:
  const scene::Scene& scene_;
  const setup::World& world_;
  const image::Mask* mask_;
  std::stop_token stop_;
};

// Error where the scene's method cannot draw through the lens.
void check_method(const scene::Scene& scene, const lens::Lens& lens);
// Error where the scene has a codec_step and H.264 does not have the clip's layout (4:4:0).
void check_codec(const scene::Scene& scene, const image::Colour& colour);

// The OpenGL of the chroma-key method; null for a scene of the matte method. Throws Error where
// check_method() refuses, and where there is no OpenGL.
std::unique_ptr<backdrop::Backdrop> open_backdrop(const scene::Scene& scene,
                                                  const lens::Lens& lens,
                                                  const backdrop::Options& options);

// The painter of the scene's method. `opened`: as open_backdrop() returns it for this scene.
std::unique_ptr<Painter> make_painter(const scene::Scene& scene,
                                      const setup::World& world,
                                      const image::Mask* mask,
                                      std::unique_ptr<backdrop::Backdrop> opened = nullptr,
                                      const std::stop_token& stop = {});

// The scene's mask of the own aircraft, if it has one.
std::optional<image::Mask> read_mask(const scene::Scene& scene, const lens::ImageSize& size);

// Renders the layer of one moment for the matte method. The layer is incomplete once `stop` is
// requested. `own_aircraft`, where present, only reduces the layer's area_free_px.
image::Layer render_layer(const scene::Scene& scene,
                          const setup::World& world,
                          const setup::Moment& moment,
                          const Ambient& ambient,
                          const image::Mask* own_aircraft = nullptr,
                          const std::stop_token& stop = {});

}  // namespace airtruth::insertion
