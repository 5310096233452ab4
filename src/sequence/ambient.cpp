// SPDX-License-Identifier: Apache-2.0
#include "sequence/ambient.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/median.h"
#include "image/colour.h"

namespace airtruth::sequence {
namespace {

using image::Rgb;

constexpr int kGrid = 48;  // blocks along the longer side
constexpr float kSmoothing =
    0.1f;  // share of a new frame; about a third of a second at 30 frames/s
constexpr Rgb kSunColour = {
    1.0f, 0.965f, 0.91f};  // direct sun at middle elevations against its own sky

// A white surface square to the sun over a blue sky: about 30,000 cd/m2 over 4,000 to 8,000. Under
// an even cloud next to nothing comes from one direction.
constexpr float kSunlitOverSky = 3.5f;
constexpr float kVeiledSun = 0.12f;
constexpr float kBrightestSun = 2.5f;

struct Block {
  Rgb linear{};
  float brightness = 0;
  float weight = 1;
};

float brightness(const Rgb& linear) {
  return 0.2126f * linear[0] + 0.7152f * linear[1] + 0.0722f * linear[2];
}

std::vector<Block> blocks_of(const image::Picture& picture,
                             const image::ToneCurve& tone,
                             const image::Mask* own_aircraft,
                             const std::optional<PixelBox>& near) {
  const image::ColourCode code(picture.colour);
  const int step = std::max(1, std::max(picture.width, picture.height) / kGrid);
  std::optional<PixelBox> around;
  if (near) {
    const int margin = std::max(2 * step, 2 * std::max(near->width, near->height));
    around = PixelBox{
        near->x - margin, near->y - margin, near->width + 2 * margin, near->height + 2 * margin};
  }
  std::vector<Block> blocks;
  for (int y = step / 2; y < picture.height; y += step) {
    for (int x = step / 2; x < picture.width; x += step) {
      if (own_aircraft != nullptr && !own_aircraft->is_free(x, y)) continue;
      Block block;
      block.linear = image::linear_at(picture, code, x, y, tone);
      block.brightness = brightness(block.linear);
      block.weight = around && around->contains(x, y) ? 4.0f : 1.0f;
      blocks.push_back(block);
    }
  }
  return blocks;
}

void sort_by_brightness(std::vector<Block>& blocks) {
  std::stable_sort(blocks.begin(), blocks.end(), [](const Block& a, const Block& b) {
    return a.brightness < b.brightness;
  });
}

// The middle of what the blocks become, by channel; 1 where there are too few that are neither dark
// nor near white.
Rgb exposure_change(const std::vector<Rgb>& before, const std::vector<Rgb>& now) {
  constexpr float kDarkest = 0.02F;
  constexpr float kBrightest = 0.8F;
  constexpr std::size_t kFewest = 20;
  Rgb change = {1, 1, 1};
  if (before.size() != now.size()) return change;
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float> ratios;
    for (std::size_t i = 0; i < now.size(); ++i)
      if (before[i][c] > kDarkest && before[i][c] < kBrightest && now[i][c] > kDarkest &&
          now[i][c] < kBrightest)
        ratios.push_back(now[i][c] / before[i][c]);
    if (ratios.size() < kFewest) continue;
    change[c] = median(std::move(ratios));
  }
  return change;
}

// Weighted mean of the blocks whose share of the total weight lies in [from, to).
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
  for (float& c : sum) c = weight > 0 ? c / weight : 0.0f;
  return sum;
}

// Does the sun shine? 1 where some of the brighter half is blue, 0 where all of it is grey.
float clearness(const std::vector<Block>& blocks) {
  std::vector<float> blueness;
  for (std::size_t i = blocks.size() / 2; i < blocks.size(); ++i) {
    const Rgb& rgb = blocks[i].linear;
    if (rgb[2] > 0.04f && rgb[2] < 0.95f) blueness.push_back(1 - rgb[0] / rgb[2]);
  }
  if (blueness.size() < 8) return 0;
  const auto high = blueness.begin() + static_cast<std::ptrdiff_t>(blueness.size() * 9 / 10);
  std::nth_element(blueness.begin(), high, blueness.end());
  constexpr float kGrey = 0.12f;
  constexpr float kBlue = 0.35f;
  const float t = std::clamp((*high - kGrey) / (kBlue - kGrey), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

Ambient measure(const std::vector<Block>& blocks) {
  Ambient ambient;
  ambient.sky = mean(blocks, 0.5f, 1.01f);
  ambient.ground = mean(blocks, 0.0f, 0.25f);
  std::vector<Block> around;
  for (const Block& block : blocks)
    if (block.weight > 1) around.push_back(block);
  ambient.airlight = around.empty() ? ambient.sky : mean(around, 0.3f, 1.01f);
  const std::size_t last = blocks.empty() ? 0 : blocks.size() * 98 / 100;
  const float white =
      blocks.empty() ? 0.7f
                     : std::clamp(blocks[std::min(last, blocks.size() - 1)].brightness, 0.1f, 1.0f);
  const float clear = clearness(blocks);
  const float sunlit = std::max(white, kSunlitOverSky * brightness(ambient.sky));
  const float direct = std::min(clear * sunlit + (1 - clear) * kVeiledSun * white, kBrightestSun);
  for (std::size_t c = 0; c < 3; ++c) ambient.sun[c] = direct * kSunColour[c];
  return ambient;
}

void blend(std::array<float, 3>& into, const std::array<float, 3>& from) {
  for (std::size_t c = 0; c < 3; ++c) into[c] += kSmoothing * (from[c] - into[c]);
}

std::array<float, 3> floats(const std::array<double, 3>& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace

Ambient AmbientEstimator::next(const image::Picture& picture, const std::optional<PixelBox>& near) {
  const bool all_stated = light_.exposure && light_.sky_colour && light_.ground_colour;
  if (all_stated) return with_scene({});
  std::vector<Block> blocks = blocks_of(picture, tone_, own_aircraft_, near);
  std::vector<Rgb> colours;
  for (const Block& block : blocks) colours.push_back(block.linear);
  follow_exposure(colours);
  sort_by_brightness(blocks);
  const Ambient now = measure(blocks);
  if (!smooth_) smooth_ = now;
  blend(smooth_->sun, now.sun);
  blend(smooth_->sky, now.sky);
  blend(smooth_->ground, now.ground);
  blend(smooth_->airlight, now.airlight);
  return with_scene(*smooth_);
}

void AmbientEstimator::follow_exposure(const std::vector<Rgb>& blocks) {
  constexpr float kJump = 0.04F;  // less is what moves through the picture
  const Rgb change = exposure_change(blocks_before_, blocks);
  blocks_before_ = blocks;
  if (!smooth_) return;
  for (std::size_t c = 0; c < 3; ++c) {
    if (std::abs(std::log(change[c])) < kJump) continue;
    for (auto* light : {&smooth_->sun, &smooth_->sky, &smooth_->ground, &smooth_->airlight})
      (*light)[c] *= change[c];
  }
}

Ambient AmbientEstimator::with_scene(Ambient measured) const {
  if (light_.exposure) {
    for (std::size_t c = 0; c < 3; ++c)
      measured.sun[c] = static_cast<float>(*light_.exposure) * kSunColour[c];
  }
  if (light_.sky_colour) measured.sky = floats(*light_.sky_colour);
  if (light_.ground_colour) measured.ground = floats(*light_.ground_colour);
  return measured;
}

}  // namespace airtruth::sequence
