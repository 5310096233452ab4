// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/ambient.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "foundation/geometry/box.h"
#include "foundation/image/colour.h"
#include "picture/render/renderer.h"
#include "sequence/setup/from_scene.h"

namespace airtruth::insertion {
namespace {

using image::Rgb;

// Where a constant of this file states no origin, it is a choice (docs/decisions/0014).

constexpr int kGrid = 48;  // blocks along the longer side
// Weight of a new frame in the smoothed light; the time constant is about a third of a second at 30
// frames/s.
constexpr float kSmoothing = 0.1f;
// Colour of the direct sun at medium elevations relative to the sky around it.
constexpr Rgb kSunColour = {1.0f, 0.965f, 0.91f};

// Sun as a share of a cloud's brightness: almost none of the light has a direction.
constexpr float kVeiledSun = 0.12f;
// Sun as a multiple of the brightest sample, for a sky that is nearly black.
constexpr float kBrightestSun = 6.0f;
// Reflectance of the ground for visible light, of luma 0.1: grass 0.06, moist earth 0.07, gravel
// 0.13, macadam 0.18 (IES 2000, "Lighting handbook", reflectances of outside surfaces). The albedo
// of pyranometers, 0.2 for fields and woods, includes the infrared, of which leaves reflect half.
// Its colour, 1.14 : 1 : 0.78, is the median of the ground in nine frames of three onboard clips
// over fields, woods and a coast, relative to the grey of their clouds.
constexpr Rgb kGroundAlbedo = {0.1124f, 0.0986f, 0.0769f};

// Mean linear light below which a picture is black: a third of the darkest code above black.
constexpr float kBlack = 1e-4f;
// Level irradiance over pi of the sky over a black picture: a white surface is half as bright as
// the brightest sample.
constexpr float kAssumedSky = 0.5f;

struct Block {
  Rgb linear{};
  float brightness = 0;
  float weight = 1;
  // In world axes; empty outside the lens's view.
  std::optional<Vector3> direction;

  // Below the horizon, as the camera's pose has it.
  bool is_below() const { return direction && direction->z() > 0; }
};

float brightness(const Rgb& linear) {
  return 0.2126f * linear[0] + 0.7152f * linear[1] + 0.0722f * linear[2];
}

int grid_step(const lens::ImageSize& size) {
  const auto [shorter, longer] = std::minmax(size.width, size.height);
  return std::clamp(longer / kGrid, 1, shorter);
}

// Calls visit(x, y) with the middle of each block.
template <typename Visit>
void each_block(const lens::ImageSize& size, const Visit& visit) {
  const int step = grid_step(size);
  for (int y = step / 2; y < size.height; y += step)
    for (int x = step / 2; x < size.width; x += step) visit(x, y);
}

// The rays of the blocks in the nominal camera.
std::vector<std::optional<Vector3>> rays_of(const lens::ImageSize& size,
                                            const lens::Lens& lens,
                                            const Homography& nominal_from_frame) {
  std::vector<std::optional<Vector3>> rays;
  each_block(size, [&](int x, int y) {
    const Vector3 nominal = nominal_from_frame * Vector3(x + 0.5, y + 0.5, 1);
    rays.push_back(nominal.z() > 0
                       ? lens.ray_from_pixel({nominal.x() / nominal.z(), nominal.y() / nominal.z()})
                       : std::nullopt);
  });
  return rays;
}

// `rays`: as rays_of().
std::vector<Block> blocks_of(const Glance& glance,
                             const image::Mask* own_aircraft,
                             const std::vector<std::optional<Vector3>>& rays,
                             const Quaternion& world_from_cam,
                             const std::optional<PixelBox>& near) {
  std::optional<PixelBox> around;  // where blocks count more
  if (near)
    around = wider(*near, 2 * std::max({grid_step(glance.size), near->width, near->height}));
  std::vector<Block> blocks;
  blocks.reserve(rays.size());
  std::size_t i = 0;
  each_block(glance.size, [&](int x, int y) {
    const std::optional<Vector3>& ray = rays[i];
    const Rgb& linear = glance.linear[i++];
    if (own_aircraft != nullptr && !own_aircraft->is_free(x, y)) return;
    Block block;
    block.linear = linear;
    block.brightness = brightness(block.linear);
    block.weight = !ray ? 0.0f : around && around->contains(x, y) ? 4.0f : 1.0f;
    if (ray) block.direction = (world_from_cam * *ray).normalized();
    blocks.push_back(block);
  });
  return blocks;
}

// The luminance at a block of each kind of sky, for the share of that sky in it. A sky without a
// share needs none, and a block outside the lens's view, whose weight is 0, has none.
float clear_seen(const Block& block, const Skies& skies, float share) {
  if (!(share > 0) || !block.direction) return 1;
  return static_cast<float>(skies.clear_seen(*block.direction));
}
float overcast_seen(const Block& block, const Skies& skies, float share) {
  if (!(share > 0) || !block.direction) return 1;
  return static_cast<float>(skies.overcast_seen(*block.direction));
}

// A smaller change of the light, as the logarithm of a ratio, comes from motion in the picture.
constexpr float kJump = 0.04F;

// The middle of what the blocks become, by channel; 1 where there are too few that are neither dark
// nor near white.
Rgb exposure_change(const std::vector<Rgb>& before, const std::vector<Rgb>& now) {
  // Bounds of dark and near white, linear light, and the least number of blocks between them.
  constexpr float kDarkest = 0.02F;
  constexpr float kBrightest = 0.8F;
  constexpr std::size_t kFewest = 20;
  Rgb change = {1, 1, 1};
  if (before.size() != now.size()) return change;
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float> ratios;
    ratios.reserve(now.size());
    for (std::size_t i = 0; i < now.size(); ++i)
      if (before[i][c] > kDarkest && before[i][c] < kBrightest && now[i][c] > kDarkest &&
          now[i][c] < kBrightest)
        ratios.push_back(now[i][c] / before[i][c]);
    if (ratios.size() < kFewest) continue;
    change[c] = median(std::move(ratios));
  }
  return change;
}

// 0 where there is nothing to divide by.
Rgb divided(Rgb sum, float by) {
  for (float& c : sum) c = by > 0 ? c / by : 0.0f;
  return sum;
}

// Weighted mean of those of the sorted blocks whose share of the total weight lies in [from, to).
Rgb mean(const std::vector<Block>& blocks, float from, float to) {
  float total = 0;
  for (const Block& block : blocks) total += block.weight;
  Rgb sum{};
  float weight = 0;
  float before = 0;
  for (const Block& block : blocks) {
    const float share = (before + block.weight / 2) / total;
    before += block.weight;
    if (share < from || share >= to) continue;
    for (std::size_t c = 0; c < 3; ++c) sum[c] += block.linear[c] * block.weight;
    weight += block.weight;
  }
  return divided(sum, weight);
}

float smoothstep(float low, float high, float value) {
  const float t = std::clamp((value - low) / (high - low), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

// The linear light from which on a channel counts as clipped.
constexpr float kClipped = 0.95f;

bool is_clipped(const Rgb& rgb) { return *std::min_element(rgb.begin(), rgb.end()) >= kClipped; }

// How much less red than blue a block is; empty for clipped and dark ones, 0 for clipped white.
std::optional<float> cast_of(const Rgb& rgb) {
  constexpr float kDarkest = 0.02f;  // the linear light up to which blue is dark
  if (!(rgb[2] > kDarkest)) return std::nullopt;
  if (rgb[2] >= kClipped) return rgb[0] < kClipped ? std::nullopt : std::optional(0.0f);
  return 1 - rgb[0] / rgb[2];
}

// The cast of what is grey: the greyest tenth of the sky, as the camera's white balance has it. A
// clear sky has no grey, so it is at most that of an overcast sky of 7500 K under a white balance
// for 5500 K (CIE's daylight illuminants: linear R/B of 0.81 and 1.34 in sRGB, 1 - 0.81/1.34).
float cast_of_grey(std::vector<float> casts) {
  // 1 - R/B, a ratio: 1 - 0.81/1.34.
  constexpr float kBluestOvercast = 0.4f;
  return std::clamp(nth_smallest(casts, casts.size() / 10), 0.0f, kBluestOvercast);
}

// Blueness: 0 for grey (cloud), 1 for a clear sky.
float blueness(float cast, float grey) {
  // Casts relative to grey, ratios: cloud up to the first, clear sky from the second on. The clear
  // skies of docs/decisions/0014 have 0.4 and more.
  constexpr float kGrey = 0.12f;
  constexpr float kBlue = 0.35f;
  return smoothstep(kGrey, kBlue, 1 - (1 - cast) / (1 - grey));
}

struct Sums {
  Rgb colour{};
  float weight = 0;
  // Luminance here of a sky whose level irradiance is 1.
  float expected = 0;

  void add(const Rgb& linear, float by, float expected_here = 0) {
    for (std::size_t c = 0; c < 3; ++c) colour[c] += by * linear[c];
    weight += by;
    expected += by * expected_here;
  }
  // Of the level irradiance (over pi) of the sky that is seen.
  Rgb level() const { return divided(colour, expected); }
  Rgb mean() const { return divided(colour, weight); }
};

// The visible sky and ground.
struct Seen {
  Sums blue;
  Sums cloud;
  Sums ground;
  float clipped = 0;  // weight of the sky whose channels are all clipped
  // 1 where some of the sky is blue, and the sun therefore shines.
  float clearness = 0;
  float all = 0;  // weight of all blocks
};

Seen seen_in(const std::vector<Block>& blocks, const Skies& skies) {
  // Brightness of ground relative to the sky; every cloud's base is brighter.
  constexpr float kGroundOverSky = 0.6f;
  // Least number of blocks of sky for their upper tenth.
  constexpr std::size_t kFewest = 8;
  Seen seen;
  const float sky = brightness(mean(blocks, 0.5f, 1.01f));
  std::vector<const Block*> above;
  std::vector<float> casts, bright_casts;
  for (const Block& block : blocks) {
    seen.all += block.weight;
    if (block.is_below() && block.brightness < kGroundOverSky * sky) {
      seen.ground.add(block.linear, block.weight);
      continue;
    }
    if (block.brightness < 0.25f * sky) continue;  // an aircraft, a tree, a rim: no sky
    const auto cast = cast_of(block.linear);
    if (!cast) continue;
    above.push_back(&block);
    casts.push_back(*cast);
    if (block.brightness >= kGroundOverSky * sky) bright_casts.push_back(*cast);
  }
  if (bright_casts.empty()) return seen;
  const float grey = cast_of_grey(std::move(bright_casts));
  std::vector<float> clear;
  for (std::size_t i = 0; i < above.size(); ++i) {
    const Block& block = *above[i];
    const float blue = blueness(casts[i], grey);
    const float cloud = 1 - blue;
    seen.blue.add(block.linear, block.weight * blue, clear_seen(block, skies, blue));
    seen.cloud.add(block.linear, block.weight * cloud, overcast_seen(block, skies, cloud));
    if (is_clipped(block.linear)) seen.clipped += block.weight;
    clear.push_back(blue);
  }
  if (clear.size() < kFewest) return seen;
  seen.clearness = nth_smallest(clear, clear.size() * 9 / 10);
  return seen;
}

// The radiance of a level ground under the light's sun and sky.
Rgb ground_of(const Rgb& albedo, double sun_elevation_deg, const Ambient& light) {
  const auto height = static_cast<float>(std::sin(radians(std::max(0.0, sun_elevation_deg))));
  Rgb ground{};
  for (std::size_t c = 0; c < 3; ++c)
    ground[c] = albedo[c] * (height * light.sun[c] + light.sky()[c]);
  return ground;
}

// The factor by which the light is brighter than the sky shows it. A clipped sky is a lower bound;
// the ground, of kGroundAlbedo, shows all of the light that falls on it.
float beyond_clipped(const Seen& seen, double sun_elevation_deg, const Ambient& by_sky) {
  const float sky_weight = seen.blue.weight + seen.cloud.weight;
  if (!(seen.clipped > 0) || !(seen.ground.weight > 0)) return 1;
  const float under_sky = brightness(ground_of(kGroundAlbedo, sun_elevation_deg, by_sky));
  const float by_ground = brightness(seen.ground.mean()) / under_sky;
  return 1 + seen.clipped / sky_weight * std::max(0.0f, by_ground - 1);
}

// Over a black picture: an overcast sky above a level ground.
Ambient assumed(double sun_elevation_deg) {
  Ambient ambient;
  ambient.is_assumed = true;
  ambient.cloud = {kAssumedSky, kAssumedSky, kAssumedSky};
  for (std::size_t c = 0; c < 3; ++c) ambient.sun[c] = kVeiledSun * kAssumedSky * kSunColour[c];
  ambient.ground = ground_of(kGroundAlbedo, sun_elevation_deg, ambient);
  return ambient;
}

// `blocks`: from the darkest to the brightest.
Ambient measure(const std::vector<Block>& blocks, const Skies& skies, double elevation_deg) {
  if (brightness(mean(blocks, 0.5f, 1.01f)) < kBlack) return assumed(elevation_deg);
  const Seen seen = seen_in(blocks, skies);
  Ambient ambient;
  const float sky_weight = seen.blue.weight + seen.cloud.weight;
  const float blue_share = sky_weight > 0 ? seen.blue.weight / sky_weight : 0.0f;
  const Rgb blue = seen.blue.level();
  const Rgb cloud = seen.cloud.level();
  for (std::size_t c = 0; c < 3; ++c) {
    ambient.blue[c] = blue_share * blue[c];
    ambient.cloud[c] = (1 - blue_share) * cloud[c];
  }
  const auto sun_over_sky = static_cast<float>(sun_illuminance_klx(elevation_deg) /
                                               clear_sky_illuminance_klx(elevation_deg));
  const float direct = seen.clearness * sun_over_sky * brightness(blue) +
                       (1 - seen.clearness) * kVeiledSun * brightness(seen.cloud.mean());
  for (std::size_t c = 0; c < 3; ++c)
    ambient.sun[c] = std::min(direct, kBrightestSun) * kSunColour[c];
  // Smallest share of the picture that counts as ground; a smaller part may be anything.
  constexpr float kMinGround = 0.05f;
  const bool is_ground_seen = seen.ground.weight > kMinGround * seen.all;
  if (is_ground_seen) {
    const float brighter = beyond_clipped(seen, elevation_deg, ambient);
    for (auto* light : {&ambient.sun, &ambient.blue, &ambient.cloud})
      for (float& channel : *light) channel *= brighter;
  }
  ambient.ground =
      is_ground_seen ? seen.ground.mean() : ground_of(kGroundAlbedo, elevation_deg, ambient);
  std::vector<Block> around;
  for (const Block& block : blocks)
    if (block.weight > 1) around.push_back(block);
  ambient.airlight = around.empty() ? mean(blocks, 0.5f, 1.01f) : mean(around, 0.3f, 1.01f);
  return ambient;
}

void blend(Rgb& into, const Rgb& from) {
  for (std::size_t c = 0; c < 3; ++c) into[c] += kSmoothing * (from[c] - into[c]);
}

// What is smoothed over time.
constexpr std::array kSmoothed = {
    &Ambient::sun, &Ambient::blue, &Ambient::cloud, &Ambient::ground, &Ambient::airlight};

std::array<float, 3> floats(const std::array<double, 3>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace

AmbientEstimator::AmbientEstimator(const scene::Light& light,
                                   const scene::CameraModel& camera,
                                   const image::Mask* own_aircraft)
    : light_(light),
      tone_(setup::tone_of(camera)),
      has_measured_haze_(camera.extinction_per_km && !camera.airlight),
      own_aircraft_(own_aircraft),
      skies_(skies(setup::to_sun_in_world(light))) {}

Glance glance_at(const image::Picture& picture, const image::ToneCurve& tone) {
  const image::ColourCode code(picture.colour);
  Glance glance{{picture.width, picture.height}, {}};
  each_block(glance.size, [&](int x, int y) {
    glance.linear.push_back(image::linear_at(picture, code, x, y, tone));
  });
  return glance;
}

bool AmbientEstimator::reads_pictures() const {
  return has_measured_haze_ ||
         !(light_.exposure && light_.sky_colour && (light_.ground_colour || light_.ground_albedo));
}

Ambient AmbientEstimator::next(const image::Picture& picture,
                               const projection::Sight& sight,
                               const std::optional<PixelBox>& near,
                               bool begins_shot) {
  if (!reads_pictures()) return with_scene({});
  return next(glance_at(picture, tone_), sight, near, begins_shot);
}

Ambient AmbientEstimator::next(const Glance& glance,
                               const projection::Sight& sight,
                               const std::optional<PixelBox>& near,
                               bool begins_shot) {
  if (!reads_pictures()) return with_scene({});
  follow_rays(glance.size, sight);
  std::vector<Block> blocks =
      blocks_of(glance, own_aircraft_, rays_, sight.cam_from_world.rotation.conjugate(), near);
  std::vector<Rgb> colours;
  colours.reserve(blocks.size());
  for (const Block& block : blocks) colours.push_back(block.linear);
  if (begins_shot) smooth_.reset();
  follow_exposure(colours);
  std::ranges::stable_sort(blocks, {}, &Block::brightness);
  const Ambient now = measure(blocks, skies_, light_.sun_elevation_deg);
  if (!smooth_ || smooth_->is_assumed != now.is_assumed) smooth_ = now;
  for (const auto light : kSmoothed) blend((*smooth_).*light, now.*light);
  return with_scene(*smooth_);
}

void AmbientEstimator::follow_rays(const lens::ImageSize& size, const projection::Sight& sight) {
  const Homography nominal_from_frame = sight.frame_from_nominal.inverse();
  check(rays_.empty() || size == rays_size_, "frames keep their size");
  if (!rays_.empty() && nominal_from_frame == rays_nominal_from_frame_) return;
  rays_ = rays_of(size, *sight.lens, nominal_from_frame);
  rays_nominal_from_frame_ = nominal_from_frame;
  rays_size_ = size;
}

void AmbientEstimator::follow_exposure(const std::vector<Rgb>& blocks) {
  const Rgb change = exposure_change(blocks_before_, blocks);
  blocks_before_ = blocks;
  if (!smooth_) return;
  for (std::size_t c = 0; c < 3; ++c) {
    if (!(std::abs(std::log(change[c])) >= kJump)) continue;
    for (const auto light : kSmoothed) ((*smooth_).*light)[c] *= change[c];
  }
}

// The sun's centre when the last of it sets: half its width and the refraction at the horizon, 16'
// and 34' (Meeus 1998, "Astronomical algorithms", chapter 15).
constexpr double kSunsetDeg = -50.0 / 60;

Ambient AmbientEstimator::with_scene(Ambient measured) const {
  if (light_.exposure) {
    for (std::size_t c = 0; c < 3; ++c)
      measured.sun[c] = static_cast<float>(*light_.exposure) * kSunColour[c];
  }
  if (light_.sun_elevation_deg < kSunsetDeg) measured.sun = {};
  // A stated sky is overcast.
  if (light_.sky_colour) measured.blue = {}, measured.cloud = floats(*light_.sky_colour);
  if (light_.ground_colour) measured.ground = floats(*light_.ground_colour);
  if (light_.ground_albedo) {
    const auto albedo = static_cast<float>(*light_.ground_albedo);
    measured.ground = ground_of({albedo, albedo, albedo}, light_.sun_elevation_deg, measured);
  }
  measured.surroundings = skies_.clear.scaled(measured.blue);
  measured.surroundings += skies_.overcast.scaled(measured.cloud);
  measured.surroundings += skies_.ground.scaled(measured.ground);
  return measured;
}

}  // namespace airtruth::insertion
