// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "foundation/image/picture.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/ambient.h"
#include "sequence/pipeline/frame_maker.h"
#include "sequence/pipeline/options.h"
#include "sequence/pipeline/resolved_scene.h"
#include "sequence/setup/motion_source.h"
#include "studio/session/clip.h"

// A scene set up to be looked at, again and again while it changes. What a change does not touch
// stays open: the clip with its decoded frames, the camera's motion, the calibration, the
// aircraft's models. It never makes a pass over the clip: what that would measure it is told.
// Of one thread.
namespace airtruth::session {

// What can be measured only in a pass over the clip.
struct Measured {
  // The motion of every frame, and the motion_key() of its scene.
  std::shared_ptr<const setup::MotionSource> motion;
  std::string motion_key;
  // The calibration_key() of the calibrations that are in the cache.
  std::set<std::string> calibrated;
};

// Text that is the same for two scenes exactly where the measurement is.
std::string motion_key(const scene::Scene& scene);
std::string calibration_key(const scene::Scene& scene);

class Stage {
 public:
  explicit Stage(pipeline::Options options);
  ~Stage();

  // Sets the scene up; nothing is done where the revision and what is measured are as before.
  // Throws Error as pipeline::open_scene() does, and the stage is then empty.
  void set(std::int64_t revision, const scene::Scene& scene, const Measured& measured);
  // Opens the scene's clip alone.
  Clip& clip(const scene::Background& background);

  // Of set().
  const setup::World& world() const { return maker_->resolved().world; }
  const scene::Scene& scene() const { return maker_->resolved().scene; }
  Shake shake_at(std::int64_t frame) const;
  // How the camera sees in frame k; empty where its path does not reach that time.
  std::optional<projection::Sight> sight_at(std::int64_t frame) const;
  // The time of frame k: its own where that is known, else by the rate.
  double time_s(std::int64_t frame) const;
  double duration_s() const;
  std::int64_t frame_near(double time_s) const { return clip_->frame_near(time_s); }
  std::int64_t frame_count() const { return clip_->frame_count(); }
  // The moments of [[intruder.seen]] as the scene states them, before they are placed.
  const std::vector<scene::Seen>& stated_seen(std::size_t actor) const { return seen_.at(actor); }
  // How the attitude of the first frame was found by the horizon; "" where it was not looked for.
  const std::string& attitude_words() const { return attitude_words_; }
  // True where the camera's motion is measured, or the scene has none.
  bool has_motion() const { return has_motion_; }
  // True where all is known that render() would measure.
  bool is_complete() const { return is_complete_; }
  // Warnings of the last set() that had anything to do.
  const std::vector<std::string>& warnings() const { return warnings_; }

  struct Picture {
    std::shared_ptr<const video::Frame> plain;  // the clip's, where nothing is put into it
    image::Picture made;                        // else
    // True where the samples are those that render() writes, without the mark of a codec.
    bool exact = false;
    setup::Moment moment;

    const image::Picture& picture() const { return plain ? plain->picture : made; }
  };
  // Frame k with the scene's aircraft in it. The light in a frame follows from the frames before
  // it as well. Unless `exact`, those need not be read, and the light is the one that was found
  // last for it, or that of this frame and of those that were asked for just before it. `leave`:
  // true where the work is to be left; the result is then empty.
  std::optional<Picture> picture(std::int64_t frame,
                                 bool exact,
                                 const std::function<bool()>& leave = {});

 private:
  struct Lit {
    insertion::Ambient ambient;
    bool exact = false;
  };

  void open(const scene::Scene& scene, const Measured& measured);
  scene::Scene with_attitude(const scene::Scene& scene);
  bool take_camera(pipeline::OpenedScene& opened, bool is_calibrated);
  setup::Moment moment(std::int64_t frame);
  std::optional<Lit> light(std::int64_t frame,
                           const setup::Moment& moment,
                           bool exact,
                           const std::function<bool()>& leave);
  insertion::Ambient next_light(std::int64_t frame, const setup::Moment& moment);

  pipeline::Options options_;
  std::int64_t revision_ = -1;
  std::string measured_as_;  // what was measured when the scene was set up
  std::unique_ptr<Clip> clip_;
  std::string clip_key_;
  std::string attitude_key_;
  scene::Camera camera_;  // with its attitude
  std::string attitude_words_;
  std::shared_ptr<const setup::MotionSource> motion_;
  bool has_motion_ = false;
  bool is_complete_ = false;  // nothing is left to measure
  std::unique_ptr<pipeline::FrameMaker> maker_;
  std::vector<std::vector<scene::Seen>> seen_;  // by intruder
  std::vector<std::string> warnings_;
  image::ToneCurve tone_;
  // The light estimated from frame to frame, from light_first_ up to light_frame_.
  std::optional<insertion::AmbientEstimator> estimator_;
  std::int64_t light_first_ = 0;
  std::int64_t light_frame_ = -1;
  // The last exact light of a frame, of this or of an earlier scene under the same light.
  std::string light_key_;
  std::map<std::int64_t, insertion::Ambient> last_light_;
};

}  // namespace airtruth::session
