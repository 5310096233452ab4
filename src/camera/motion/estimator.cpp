// SPDX-License-Identifier: Apache-2.0
#include "camera/motion/estimator.h"

#include "camera/horizon/horizon.h"
#include "camera/motion/corners.h"
#include "camera/motion/follower.h"
#include "foundation/base/error.h"
#include "foundation/image/mats.h"

namespace airtruth::motion {
namespace {

// Detects the horizon every half a second, and more often while the rotation is uncertain.
class HorizonWatch {
 public:
  HorizonWatch(const lens::Lens& lens, const image::Mask* own_aircraft)
      : finder_(lens, own_aircraft) {}

  // Returns the up direction in the reference of the measured rotation; empty where it is unknown.
  std::optional<Vector3> hold(FrameMotion& motion,
                              const image::Picture& picture,
                              double stray_rad) {
    const Quaternion measured = *motion.rotation;
    hold_.stray(stray_rad);
    const bool known = motion.state != State::kBridged || stray_rad > 0;
    const double pause_s = hold_.uncertainty_rad() > kLostRad ? kPauseWhenLost_s : kPause_s;
    if (known && (stray_rad > kLostRad || !last_s_ || motion.time_s >= *last_s_ + pause_s)) {
      last_s_ = motion.time_s;
      const Quaternion before = hold_.held(*motion.rotation);
      const auto found = look(picture, *motion.rotation);
      const bool was_lost = hold_.uncertainty_rad() > kLostRad;
      if (found && found->is_sharp()) hold_.see(*motion.rotation, found->up_in_cam);
      // After a correction of this size the frame does not continue the frame before it.
      if (hold_.held(*motion.rotation).angularDistance(before) > kLostRad)
        motion.state = State::kCut;
      const bool is_found_again = was_lost && hold_.uncertainty_rad() <= kLostRad;
      if (motion.state == State::kCut || is_found_again) motion.begins_anew = true;
    }
    motion.rotation = hold_.held(*motion.rotation);
    const auto up_in_cam = hold_.expected_up(measured);
    if (!up_in_cam || hold_.uncertainty_rad() > kLostRad) return std::nullopt;
    return measured.conjugate() * *up_in_cam;
  }

 private:
  std::optional<horizon::HorizonEdge> look(const image::Picture& picture,
                                           const Quaternion& cam_from_reference) const {
    const auto expected = hold_.expected_up(cam_from_reference);
    if (expected && hold_.uncertainty_rad() < kLostRad) return finder_.follow(picture, *expected);
    return finder_.find(picture);
  }

  // The time between two detections of the horizon, s. Chosen by judgement: the error of a
  // detection is nearly the same within half a second (horizon.cpp), so that more would tell
  // little. While the rotation is uncertain, the pause is a third of it.
  static constexpr double kPause_s = 0.5;
  static constexpr double kPauseWhenLost_s = 0.15;
  // The error of the rotation beyond which it is uncertain, rad: 1.1 degrees, since follow() looks
  // for a horizon within 1.5 degrees. Doubled, follow() would miss horizons that find() finds.
  static constexpr double kLostRad = 0.02;
  horizon::HorizonFinder finder_;
  horizon::HorizonHold hold_;
  std::optional<double> last_s_;
};

}  // namespace

struct Estimator::Impl {
  int width;
  int height;
  std::unique_ptr<Follower> follower;
  std::optional<HorizonWatch> horizon;  // of the model rotation
};

Estimator::Estimator(int width, int height, const image::Mask* own_aircraft)
    : impl_(std::make_unique<Impl>(
          Impl{width, height, planar_follower(allowed_area(width, height, own_aircraft)), {}})) {}

Estimator::Estimator(const lens::Lens& lens,
                     const Options& options,
                     const image::Mask* own_aircraft) {
  const auto [width, height] = lens.size();
  impl_ = std::make_unique<Impl>(
      Impl{width,
           height,
           spherical_follower(lens, allowed_area(width, height, own_aircraft), options.seed),
           HorizonWatch(lens, own_aircraft)});
}

Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;

FrameMotion Estimator::next(const image::Picture& picture,
                            double time_s,
                            bool damaged,
                            bool begins_shot) {
  check(picture.width == impl_->width && picture.height == impl_->height, "frames keep their size");
  FrameMotion motion = impl_->follower->next(image::luma_of(picture), damaged, begins_shot);
  motion.time_s = time_s;
  if (impl_->horizon)
    impl_->follower->set_up(impl_->horizon->hold(motion, picture, impl_->follower->stray_rad()));
  return motion;
}

}  // namespace airtruth::motion
