// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "calibration/camera_file/calibration.h"
#include "camera/lens/lens.h"
#include "foundation/base/log.h"
#include "foundation/image/layer.h"
#include "picture/video/reader.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/paint.h"
#include "sequence/pipeline/options.h"
#include "sequence/setup/motion_source.h"
#include "sequence/setup/shared_inputs.h"
#include "sequence/setup/world.h"

namespace airtruth::pipeline {

// A scene combined with its camera file; a shutter angle is converted to seconds. Keys with the
// value "auto" are listed separately, so that all others can be checked before the clip is
// measured.
struct StatedScene {
  scene::Scene scene;  // no [realism] and no "auto" left
  // As the scene states it, with the profile by which the clip's camera is recognised.
  scene::Realism realism;
  // Camera keys ("shutter.exposure_s") that must be measured on the clip.
  std::vector<std::string> to_measure;
  bool sun_is_known = false;  // stated in the scene or in the camera file
};

// Reads no frame. Throws Error where a file that the scene names beside its video does not exist,
// where the camera file cannot be read or is for another size or lens, and where the method does
// not support a camera model.
StatedScene stated(const scene::Scene& scene, const video::StreamInfo& info);

// Returns the scene with its camera model complete, as sequence.json records it and as rendering a
// frame again requires it. Measures the clip where a key is still unknown, which takes long. Throws
// Error where a key cannot be measured and [realism] fallback does not allow leaving it out.
scene::Scene with_measured_camera(StatedScene stated,
                                  const lens::ImageSize& size,
                                  const image::Mask* mask,
                                  setup::SharedInputs& inputs,
                                  const Options& options);

// What a scene names, opened and checked.
struct SceneInputs {
  // The scene's part of it; empty where the caller has its frames (open_over()).
  std::optional<video::Reader> background;
  video::StreamInfo info;                   // with the number of frames that this scene makes of it
  std::shared_ptr<const image::Mask> mask;  // of the own aircraft; null: none
  insertion::Occluders occluders;           // it and the others
  std::shared_ptr<setup::SharedInputs> inputs;  // of the process, else of this run
  setup::World world;
  std::unique_ptr<backdrop::Backdrop> backdrop;  // of the chroma-key method
  // For the user, a line each: from where the camera's attitude and profile were taken that the
  // scene does not state.
  std::vector<std::string> notes;
};

// A scene whose files are all opened and checked, before the clip is measured: faults of the user's
// input are found here. Of its frames only the first few are read, where the camera's attitude is
// not stated.
struct OpenedScene : SceneInputs {
  StatedScene stated;
};
OpenedScene open_scene(const scene::Scene& scene, const Options& options);
// The same without a reader: the caller has the frames. `info` is that of the scene's whole video.
OpenedScene open_over(const video::StreamInfo& info,
                      const scene::Scene& scene,
                      const Options& options);
// Throws Error where the scene states no rate of numbered pictures, or one of a video.
void check_rate(const scene::Background& background, const video::StreamInfo& info);
// A reader of the scene's part of its background. Throws Error as video::Reader and check_rate()
// do.
video::Reader open_background(const scene::Scene& scene, const Options& options);

// A scene with all that must be known of the whole clip before its first frame: frames are made
// from it alone. It is complete: what sequence.json records and what a frame is made from again.
struct ResolvedScene : SceneInputs {
  scene::Scene scene;
  std::string video_sha256;
  // Empty for a finished sequence, whose truth holds the motion.
  std::optional<setup::MotionSource> motion;
};

// The scene of a finished sequence, which leaves nothing to measure.
ResolvedScene resolved_by_truth(OpenedScene opened);

// Measures the values of [realism] that the scene leaves to the clip, which completes the scene but
// for the intruders of [[intruder.seen]]. Decodes the whole clip where they are not in the cache.
void measure_camera(OpenedScene& opened, const Options& options);

// Measures what the scene leaves to the clip: the exposure, noise and other values of [realism],
// and the motion where it is needed ahead. Decodes the whole clip where these are not in the cache.
ResolvedScene resolve(OpenedScene opened, const Options& options);

// Places the intruders of [[intruder.seen]] by a motion that is known for every frame. Throws Error
// where the clip has no frame within a frame's time of a moment.
void place_seen(OpenedScene& opened,
                const setup::MotionSource& motion,
                const std::stop_token& stop);

// What the motion of the opened scene's frames depends on.
setup::MotionInputs motion_inputs(const OpenedScene& opened,
                                  const std::string& video_sha256,
                                  const Options& options);

// Throws Error for every fault of a scene that can be found before a frame of its clip is read: in
// the rate, the mask, the lens, the camera file, the paths of camera and intruders, the aircraft's
// names, and where the method cannot render through this lens with this camera model. `info`
// describes the background, or the one that will be made.
void check_scene(const scene::Scene& scene, const video::StreamInfo& info);

// The motion of every frame of the scene's background: from the cache, else by a pass over the clip
// that keeps it there. Errors as of stated(), and Interrupted after options.stop.
setup::MotionSource motion_ahead(const scene::Scene& scene, const Options& options);

// The same for a later run alone. Does nothing where the scene measures no motion.
void measure_ahead(const scene::Scene& scene, const Options& options);

// True where the scene asks for camera values that neither the scene nor its camera file states.
// They are measured on the whole clip, whatever part of it the scene uses.
bool needs_calibration(const scene::Scene& scene);

// The calibration of the scene's background, whatever the scene states: from the cache, else
// measured on the whole clip, which takes long.
camera_file::Calibration calibration_of(const scene::Scene& scene, const Options& options);

// The folder of the cache for one kind of result: "motion", "calibration" or "ambient_occlusion";
// empty: none.
fs::path cache_folder(const Options& options, const char* kind);

// The aircraft and hashes of the process, else new ones for one run.
std::shared_ptr<setup::SharedInputs> inputs_of(const Options& options);

}  // namespace airtruth::pipeline
