// SPDX-License-Identifier: Apache-2.0
#include "base/error.h"
#include "motion/corners.h"
#include "motion/follower.h"
#include "motion/motion.h"

namespace airtruth::motion {

struct Estimator::Impl {
  int width;
  int height;
  std::unique_ptr<Follower> follower;
};

Estimator::Estimator(int width, int height, const Options& options, const image::Mask* own_aircraft)
    : impl_(std::make_unique<Impl>(Impl{
          width, height, planar_follower(allowed_area(width, height, own_aircraft), options)})) {}

Estimator::Estimator(const lens::Lens& lens,
                     const Options& options,
                     const image::Mask* own_aircraft) {
  const auto [width, height] = lens.size();
  impl_ = std::make_unique<Impl>(Impl{
      width, height, spherical_follower(lens, allowed_area(width, height, own_aircraft), options)});
}

Estimator::~Estimator() = default;
Estimator::Estimator(Estimator&&) noexcept = default;

FrameMotion Estimator::next(const image::Picture& picture, double time_s, bool damaged) {
  check(picture.width == impl_->width && picture.height == impl_->height, "frames keep their size");
  FrameMotion motion = impl_->follower->next(luma_of(picture), damaged);
  motion.time_s = time_s;
  return motion;
}

const char* name(State state) {
  switch (state) {
    case State::kReference:
      return "reference";
    case State::kMeasured:
      return "measured";
    case State::kBridged:
      return "bridged";
    case State::kCut:
      return "cut";
  }
  return "";
}

}  // namespace airtruth::motion
