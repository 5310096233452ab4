// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <stop_token>
#include <vector>

#include "foundation/image/layer.h"
#include "foundation/image/picture.h"
#include "picture/backdrop/backdrop.h"
#include "picture/composite/matte.h"
#include "picture/video/patch_codec.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/ambient.h"
#include "sequence/insertion/occluders.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"

// Puts the intruders of one moment into a picture, by the method that the scene names.
namespace airtruth::insertion {

// Reproduces the traces of the clip's codec on the inserted pixels, frame after frame.
//
// A video encoder predicts a frame from the previous one as it was decoded. Each part of a frame is
// therefore coded with the last finished frame at the same place as its reference: once with the
// intruder as the codec left it, and once with the background alone. Frames are passed in order.
class FrameCoder final : public composite::PatchCoder {
 public:
  // codec_step: the quantiser's step in code values, as calibration measures it (0.625 * 2^(QP/6),
  // ITU-T H.264, 8.5.9); QP is rounded to a whole number from 1 to 51.
  explicit FrameCoder(double codec_step);

  composite::Coded code(const PixelBox& box,
                        const image::Picture& with_layer,
                        const image::Picture& background) override;

  // Ends a frame: its coded parts are the prediction for the next frame.
  void finish_frame(const image::Picture& painted);

 private:
  // Samples of a frame, within the frame. A frame that is not finished is not painted yet.
  struct Part {
    PixelBox box{};
    image::Picture background;
    image::Picture painted;
  };
  image::Picture reference(const PixelBox& box,
                           const image::Picture& now,
                           image::Picture Part::*samples) const;

  video::PatchCodec codec_;
  std::vector<Part> past_;     // of the last finished frame
  std::vector<Part> windows_;  // of the current frame
};

struct Painted {
  // The ray tracer's layer; for chroma-key, the layer that the ray tracer would draw.
  image::Layer layer;
  // By intruder; empty where none is in view.
  std::vector<composite::Visible> visible;
  // True where the scene has an [[occluder]], and where its horizon is assumed (occluders.h).
  bool has_occluders = false;
  bool horizon_is_assumed = false;
};

class Painter {
 public:
  // `opened`: as open_backdrop() returns it for this scene.
  Painter(const scene::Scene& scene,
          const setup::World& world,
          Occluders occluders,
          std::unique_ptr<backdrop::Backdrop> opened = nullptr,
          std::stop_token stop = {});
  // Renders the layer of a moment. `background`: its picture without intruders. matte: in any
  // thread and order; chroma-key: in one thread.
  Painted draw(const image::Picture& background,
               const setup::Moment& moment,
               const Ambient& ambient) const;
  // Composites the layer into the picture and adds the resulting changes to `painted`.
  void compose(image::Picture& picture,
               const setup::Moment& moment,
               const Ambient& ambient,
               Painted& painted);
  // True where a frame's picture depends on the previous one (a codec's mark). compose() must then
  // receive every frame, one at a time and in order. The value is known once the scene's values
  // are.
  bool is_in_order() const;

  // Draws and composites a single picture.
  Painted paint(image::Picture& picture, const setup::Moment& moment, const Ambient& ambient);

 private:
  void compose_by_key(image::Picture& picture,
                      const setup::Moment& moment,
                      const Ambient& ambient,
                      Painted& painted);

  const scene::Scene& scene_;
  const setup::World& world_;
  Occluders occluders_;
  std::stop_token stop_;
  std::unique_ptr<backdrop::Backdrop> backdrop_;  // of chroma-key alone
  std::optional<FrameCoder> coder_;               // of matte alone
};

// Error where the scene's method cannot draw through the lens, or what the scene has.
void check_method(const scene::Scene& scene, const lens::Lens& lens);
// Error where the scene has a codec_step and H.264 does not have the clip's layout (4:4:0).
void check_codec(const scene::Scene& scene, const image::Colour& colour);

// The OpenGL of the chroma-key method; null for a scene of the matte method. Throws Error where
// check_method() refuses, and where there is no OpenGL.
std::unique_ptr<backdrop::Backdrop> open_backdrop(const scene::Scene& scene,
                                                  const lens::Lens& lens,
                                                  const backdrop::Options& options);

// The scene's mask of the own aircraft, if it has one.
std::optional<image::Mask> read_mask(const scene::Scene& scene, const lens::ImageSize& size);

// Renders the layer of one moment for the matte method, without what the occlusion hides. The layer
// is incomplete once `stop` is requested.
image::Layer render_layer(const scene::Scene& scene,
                          const setup::World& world,
                          const setup::Moment& moment,
                          const Ambient& ambient,
                          const composite::Occlusion& occlusion = {},
                          const std::stop_token& stop = {});

}  // namespace airtruth::insertion
