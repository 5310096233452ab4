// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/occluders.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "camera/horizon/horizon.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/geometry/box.h"
#include "foundation/geometry/horizon_dip.h"
#include "picture/video/numbered_images.h"
#include "picture/video/still.h"

namespace airtruth::insertion {
namespace {

using GreyPtr = std::shared_ptr<const video::Grey>;

GreyPtr grey_mask(const fs::path& file, const lens::ImageSize& size) {
  video::Grey grey = video::read_grey(file);
  if (grey.width != size.width || grey.height != size.height)
    throw Error(fmt::format("is {}x{}; expected the video's {}x{}",
                            grey.width,
                            grey.height,
                            size.width,
                            size.height),
                {file.string()});
  return std::make_shared<const video::Grey>(std::move(grey));
}

// The mask that is read before the work, with a warning where its black is a video's.
GreyPtr first_mask(const fs::path& file, const lens::ImageSize& size, const Warn& to_warn) {
  constexpr int kVideoBlack = 16;  // of limited range
  GreyPtr mask = grey_mask(file, size);
  const int darkest = std::ranges::min(mask->samples);
  if (darkest > 0 && darkest <= kVideoBlack)
    warn(to_warn,
         fmt::format("{}: is nowhere darker than {} of 255, and so hides {:.0f} % everywhere; "
                     "expected 0 where it hides nothing",
                     file.string(),
                     darkest,
                     100 * darkest / 255.0));
  return mask;
}

std::function<float(int, int)> cover_of(GreyPtr mask) {
  return [mask = std::move(mask)](int x, int y) {
    return static_cast<float>(mask->samples[index_in(mask->width, x, y)]) / 255.0F;
  };
}

// One [[occluder]], with what it has read.
struct Stated {
  double range_m = 0;
  GreyPtr still;
  std::vector<fs::path> series;  // by the number of the clip's frame
  // Neither: what is below the horizon.
};

Stated stated_occluder(const scene::Occluder& occluder,
                       const lens::ImageSize& size,
                       std::int64_t end_frame,
                       const Warn& to_warn) {
  Stated stated{occluder.range_m, nullptr, {}};
  if (!occluder.mask) return stated;
  const auto images = video::numbered_images(*occluder.mask);
  if (!images) {
    stated.still = first_mask(*occluder.mask, size, to_warn);
    if (std::ranges::max(stated.still->samples) == 0)
      throw Error("is black all over: it would hide nothing; expected white where it hides",
                  {occluder.mask->string()});
    return stated;
  }
  stated.series = images->files;
  if (std::ssize(stated.series) < end_frame)
    throw Error(fmt::format("mask has {} pictures, and the scene goes to frame {} of its clip; "
                            "expected one picture for each frame of the clip",
                            stated.series.size(),
                            end_frame - 1),
                occluder.where);
  first_mask(stated.series.front(), size, to_warn);
  return stated;
}

struct Horizon {
  Vector3 up_in_cam;
  Homography nominal_from_frame = Homography::Identity();
  bool is_assumed = false;
};

// The horizon beside the one that the camera's attitude and measured motion give, else the sharpest
// of the picture, else the one that the attitude gives.
Horizon horizon_in(const horizon::HorizonFinder& finder,
                   const image::Picture& picture,
                   const projection::Sight& sight,
                   double height_m) {
  const Vector3 expected = horizon::seen_from_up(sight.cam_from_world.rotation * Vector3(0, 0, -1),
                                                 horizon_dip_rad(height_m));
  if (const auto near = finder.follow(picture, expected); near.is_sharp()) return {near.up_in_cam};
  if (const auto found = finder.find(picture); found && found->is_sharp())
    return {found->up_in_cam};
  return {expected, sight.frame_from_nominal.inverse(), true};
}

}  // namespace

struct Occluders::Impl {
  const image::Mask* own = nullptr;
  std::optional<lens::Lens> lens;
  std::int64_t first_frame = 0;
  std::vector<Stated> stated;
  std::optional<horizon::HorizonFinder> finder;  // where something is below the horizon

  std::function<float(int, int)> cover(const Stated& one, std::int64_t frame) const {
    if (one.still) return cover_of(one.still);
    const auto k = static_cast<std::size_t>(first_frame + frame);
    if (k >= one.series.size())
      throw Error(fmt::format("is the last of {} masks; expected one for frame {} of the clip",
                              one.series.size(),
                              k),
                  {one.series.back().string()});
    return cover_of(grey_mask(one.series[k], lens->size()));
  }
};

Occluders::Occluders(const image::Mask* own_aircraft)
    : impl_(std::make_shared<const Impl>(Impl{own_aircraft, {}, 0, {}, {}})) {}

Occluders::Occluders(const scene::Scene& scene,
                     const lens::Lens& lens,
                     const image::Mask* own_aircraft,
                     std::int64_t frames,
                     const Warn& to_warn) {
  Impl impl{own_aircraft, lens, scene.background.first_frame, {}, {}};
  const std::int64_t end_frame = frames > 0 ? impl.first_frame + frames : 0;
  for (const scene::Occluder& occluder : scene.occluders) {
    impl.stated.push_back(stated_occluder(occluder, lens.size(), end_frame, to_warn));
    if (occluder.beyond_horizon && !impl.finder) impl.finder.emplace(lens, own_aircraft);
  }
  impl_ = std::make_shared<const Impl>(std::move(impl));
}

Occluders::InFrame Occluders::in_frame(const setup::Moment& moment,
                                       const image::Picture& picture) const {
  InFrame result;
  auto& [occluders, ranges_m] = result.occlusion;
  double farthest_m = 0;  // of the intruders in view
  for (std::size_t i = 0; i < moment.states.size(); ++i) {
    const auto& state = moment.states[i];
    ranges_m.push_back(state ? (state->position_in_world - moment.camera.position_in_world).norm()
                             : 0);
    if (moment.search[i]) farthest_m = std::max(farthest_m, ranges_m.back());
  }
  if (impl_->own != nullptr) occluders.push_back(composite::own_aircraft(*impl_->own));
  std::optional<Horizon> horizon;
  for (const Stated& one : impl_->stated) {
    if (!(one.range_m < farthest_m)) continue;
    if (one.still || !one.series.empty()) {
      occluders.push_back({one.range_m, impl_->cover(one, moment.frame)});
      continue;
    }
    if (!horizon)
      horizon =
          horizon_in(*impl_->finder, picture, moment.sight, -moment.camera.position_in_world.z());
    occluders.push_back({one.range_m, [line = *horizon, lens = *impl_->lens](int x, int y) {
                           return horizon::share_below(
                               lens, line.up_in_cam, line.nominal_from_frame, x, y);
                         }});
  }
  result.horizon_is_assumed = horizon && horizon->is_assumed;
  return result;
}

const image::Mask* Occluders::own_aircraft() const { return impl_->own; }
bool Occluders::has_others() const { return !impl_->stated.empty(); }

}  // namespace airtruth::insertion
