// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/join.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/median.h"
#include "picture/video/reader.h"

namespace airtruth::camera_file {
namespace {

struct Mean {
  double value = 0, weights = 0, chi_square = 0;
};

// `between`: a variance that is added to that of every measurement.
Mean weighted_mean(const std::vector<Estimate>& all, double between) {
  Mean mean;
  for (const Estimate& e : all) {
    const double weight = 1 / (e.sigma * e.sigma + between);
    mean.weights += weight;
    mean.value += weight * e.value;
  }
  mean.value /= mean.weights;
  for (const Estimate& e : all)
    mean.chi_square +=
        (e.value - mean.value) * (e.value - mean.value) / (e.sigma * e.sigma + between);
  return mean;
}

// That under which chi-square has its expected value (join.h).
double variance_between(const std::vector<Estimate>& all) {
  const double expected = double(all.size()) - 1;
  double low = 0, high = 0;
  for (const Estimate& a : all)
    for (const Estimate& b : all) high = std::max(high, (a.value - b.value) * (a.value - b.value));
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (weighted_mean(all, middle).chi_square > expected ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// Replaces errors of 0, which mean that the error is not known.
void fill_errors(std::vector<Estimate>& all) {
  std::vector<double> known;
  for (const Estimate& e : all)
    if (e.sigma > 0) known.push_back(e.sigma);
  double usual = median_or_0(known);
  if (!(usual > 0)) {
    const auto [least, most] = std::ranges::minmax(all, {}, &Estimate::value);
    usual = most.value - least.value;
  }
  for (Estimate& e : all)
    if (!(e.sigma > 0)) e.sigma = usual;
}

struct ClipValue {
  Estimate value;
  std::string clip;
};

std::string words_of(const ClipValue& of) {
  return fmt::format("{:.3g} +- {:.2g} ({})", of.value.value, of.value.sigma, of.clip);
}

// A message that names the clips farthest below and above `middle`, in units of their errors.
std::string contradiction(const std::vector<ClipValue>& all, double middle) {
  const auto off = [&](const ClipValue& of) {
    return of.value.sigma > 0 ? (of.value.value - middle) / of.value.sigma : 0;
  };
  const auto [least, most] = std::ranges::minmax_element(all, {}, off);
  return fmt::format(
      "{} clips contradict one another by more than their errors, {} and {} most; the error covers "
      "what they differ by",
      all.size(),
      words_of(*least),
      words_of(*most));
}

// The values of the clips that have the quantity; the readout time of an upward readout is
// negative.
std::vector<ClipValue> values_by_clip(const std::vector<Calibration>& clips,
                                      Quantity Quantities::*member) {
  std::vector<ClipValue> all;
  for (const Calibration& clip : clips) {
    const Quantity& quantity = clip.quantities.*member;
    if (!quantity.is_measured()) continue;
    all.push_back({to_combine(clip, quantity), clip.video.filename().string()});
  }
  return all;
}

void put_joined(Calibration& result, Quantity Quantities::*member, Estimate value) {
  if (member == &Quantities::readout) {
    result.downwards_s = value;
    result.readout_direction = value.value < 0 ? "up" : "down";
    value.value = rolls(value) ? std::abs(value.value) : 0;
  }
  (result.quantities.*member).values = {value};
}

void join_quantity(Calibration& result,
                   const std::vector<Calibration>& clips,
                   Quantity Quantities::*member) {
  Quantity& quantity = result.quantities.*member;
  const std::vector<ClipValue> all = values_by_clip(clips, member);
  if (all.empty()) {
    quantity.missing =
        fmt::format("in none of {} clips: {}", clips.size(), (clips[0].quantities.*member).missing);
    return;
  }
  std::vector<Estimate> values;
  for (const ClipValue& one : all) values.push_back(one.value);
  const Pooled together = pooled(values);
  put_joined(result, member, together.value);
  quantity.note = fmt::format("by {} of {} clips", all.size(), clips.size());
  if (!together.agree) quantity.doubt = contradiction(all, together.value.value);
}

}  // namespace

Pooled pooled(std::vector<Estimate> all) {
  check(!all.empty(), "a mean is of something");
  fill_errors(all);
  if (all.size() == 1 || !(all[0].sigma > 0)) return {all[0], true};
  const double freedom = double(all.size()) - 1;
  const Mean mean = weighted_mean(all, 0);
  if (mean.chi_square <= freedom + 3 * std::sqrt(2 * freedom))
    return {{mean.value, 1 / std::sqrt(mean.weights)}, true};
  const double between = variance_between(all);
  const Mean wider = weighted_mean(all, between);
  return {{wider.value, std::sqrt(between + 1 / wider.weights)}, false};
}

void check_joinable(const std::vector<std::filesystem::path>& clips) {
  // Largest relative difference of frame rates that counts as rounding: 29.97 against 30.
  constexpr double kMaxRateDifference = 0.01;
  const auto info_of = [](const std::filesystem::path& clip) {
    return video::Reader(clip, {.threads = 1}).info();
  };
  const video::StreamInfo first = info_of(clips.at(0));
  for (std::size_t i = 1; i < clips.size(); ++i) {
    const video::StreamInfo info = info_of(clips[i]);
    const Where where{clips[i].string()};
    if (info.width != first.width || info.height != first.height)
      throw Error(fmt::format("is {} x {} px, and {} is {} x {}; expected clips of one camera in "
                              "one size",
                              info.width,
                              info.height,
                              clips[0].string(),
                              first.width,
                              first.height),
                  where);
    const double rate = info.frame_rate.value(), other = first.frame_rate.value();
    if (std::abs(rate - other) > kMaxRateDifference * other)
      throw Error(fmt::format("has {:.3f} frames/s, and {} has {:.3f}; expected clips of one "
                              "camera at one rate",
                              rate,
                              clips[0].string(),
                              other),
                  where);
  }
}

Calibration joined(std::vector<Calibration> clips) {
  check(!clips.empty(), "clips to join");
  if (clips.size() == 1) return std::move(clips[0]);
  Calibration result;
  result.width = clips[0].width, result.height = clips[0].height;
  result.frame_rate_hz = clips[0].frame_rate_hz;
  result.lens = clips[0].lens, result.tone = clips[0].tone;
  result.clips = static_cast<int>(clips.size());
  std::string names;
  for (const Calibration& clip : clips) {
    result.frames += clip.frames;
    names += (names.empty() ? "" : ", ") + clip.video.filename().string();
  }
  result.video = names;
  for (const QuantityKey& key : kQuantityKeys) {
    if (key.table() == "air")
      (result.quantities.*key.member).missing = "it is of one flight; measure that clip by itself";
    else if (key.table() != "light")
      join_quantity(result, clips, key.member);
  }
  return result;
}

}  // namespace airtruth::camera_file
