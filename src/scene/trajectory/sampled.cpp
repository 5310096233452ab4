// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <memory>

#include "scene/trajectory/path_impl.h"
#include "scene/trajectory/spline.h"

namespace airtruth::trajectory {
namespace {

double unwrapped(double angle_deg, double before_deg) {
  return angle_deg + 360.0 * std::round((before_deg - angle_deg) / 360.0);
}

// The angles of all samples, without turns by 360 degrees from one to the next in yaw and roll.
std::vector<Vector3> unwrapped_angles(const Samples& samples) {
  std::vector<Vector3> angles = samples.angles_deg;
  angles.resize(samples.times_s.size(), Vector3::Zero());
  for (std::size_t i = 1; i < angles.size(); ++i)
    for (const int axis : {0, 2}) angles[i][axis] = unwrapped(angles[i][axis], angles[i - 1][axis]);
  return angles;
}

// Position and its derivatives follow the samples. Angles follow the samples where they state them
// and the path elsewhere.
class Sampled : public Path::Impl {
 public:
  Sampled(const Samples& samples, const AttitudeOverride& stated)
      : along_(path_through(samples.times_s, samples.positions_ned_m, stated)),
        angles_(samples.times_s, unwrapped_angles(samples)),
        has_angle_(samples.has_angle),
        stated_(stated) {}
  double start_s() const override { return angles_.begin(); }
  double end_s() const override { return angles_.end(); }
  State at(double t) const override {
    State state = along_->at(t);
    YawPitchRoll attitude = yaw_pitch_roll(state.world_from_body);
    const Vector3 angle = angles_.at(t, 0);
    if (has_angle_[0] && !stated_.yaw_deg) attitude.yaw_deg = angle[0];
    if (has_angle_[1] && !stated_.pitch_deg) attitude.pitch_deg = angle[1];
    if (has_angle_[2] && !stated_.roll_deg) attitude.roll_deg = angle[2];
    state.world_from_body = world_from_body(attitude);
    return state;
  }

 private:
  std::shared_ptr<const Path::Impl> along_;
  CubicSpline<Vector3> angles_;
  std::array<bool, 3> has_angle_;
  AttitudeOverride stated_;
};

}  // namespace

Path path_through_samples(const Samples& samples, const AttitudeOverride& attitude) {
  return Path(std::make_shared<Sampled>(samples, attitude));
}

}  // namespace airtruth::trajectory
