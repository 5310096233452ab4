// SPDX-License-Identifier: Apache-2.0
#include "camera/gyro/gyro.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "camera/gyro/gpmf.h"
#include "camera/motion/rotation_fit.h"
#include "foundation/geometry/within_frame.h"

namespace airtruth::gyro {
namespace {

// The number of index `at`, big-endian. The types 's' and 'l' of GPMF have 16 and 32 bits.
double number_at(const GpmfElement& e, std::size_t at) {
  const std::size_t width = e.type == 's' ? 2 : 4;
  const std::uint32_t value = big_endian(e.data, at * width, width);
  if (e.type == 's') return static_cast<std::int16_t>(value);
  return static_cast<std::int32_t>(value);
}

bool holds_numbers(const GpmfElement& e, std::size_t each) {
  const std::size_t width = e.type == 's' ? 2 : e.type == 'l' ? 4 : 0;
  return width > 0 && e.size == each * width && e.count > 0;
}

std::vector<Vector3> rates_of(std::span<const std::uint8_t> stream) {
  double scale = 0;
  std::vector<Vector3> rates;
  each_gpmf_element(stream, [&](const GpmfElement& e) {
    if (e.key == "SCAL" && holds_numbers(e, 1)) scale = number_at(e, 0);
    if (e.key != "GYRO" || !holds_numbers(e, 3)) return;
    for (std::size_t i = 0; i < e.count; ++i)
      rates.emplace_back(number_at(e, 3 * i), number_at(e, 3 * i + 1), number_at(e, 3 * i + 2));
  });
  if (!(scale > 0)) return {};
  for (Vector3& r : rates) r /= scale;
  return rates;
}

// The mean rate of the gyroscope over a span of time; empty where it has no samples there.
std::optional<Vector3> mean_rate(const std::vector<GyroSample>& gyro,
                                 double begin_s,
                                 double end_s) {
  const auto first = std::ranges::lower_bound(gyro, begin_s, {}, &GyroSample::time_s);
  Vector3 sum = Vector3::Zero();
  int count = 0;
  for (auto it = first; it != gyro.end() && it->time_s < end_s; ++it)
    sum += it->rate_radps, ++count;
  if (count == 0) return std::nullopt;
  return Vector3(sum / count);
}

struct Step {
  double begin_s, end_s;
  Vector3 rate;  // in cam
};

std::vector<Step> steps_of(const std::vector<motion::FrameMotion>& motion) {
  std::vector<Step> steps;
  for (std::size_t k = 1; k < motion.size(); ++k) {
    if (!motion[k].rotation || motion[k].begins_anew || !is_known(motion[k].state) ||
        !is_known(motion[k - 1].state))
      continue;
    const double dt = motion[k].time_s - motion[k - 1].time_s;
    if (!(dt > 0)) continue;
    // A rotation of the scene in the camera is the inverse of the camera's own rotation.
    const Vector3 turned =
        vector_from_rotation(*motion[k].rotation * motion[k - 1].rotation->conjugate());
    steps.push_back({motion[k - 1].time_s, motion[k].time_s, -turned / dt});
  }
  return steps;
}

std::optional<GyroFit> fit_at(const std::vector<GyroSample>& gyro,
                              const std::vector<Step>& steps,
                              double offset_s) {
  std::vector<motion::Bearings> pairs;
  Vector3 mean_gyro = Vector3::Zero(), mean_cam = Vector3::Zero();
  for (const Step& s : steps) {
    const auto rate = mean_rate(gyro, s.begin_s + offset_s, s.end_s + offset_s);
    if (!rate) continue;
    pairs.push_back({*rate, s.rate});
    mean_gyro += *rate, mean_cam += s.rate;
  }
  constexpr std::size_t kMinSteps = 40;  // chosen by judgement: a second and a third at 30 frames/s
  if (pairs.size() < kMinSteps) return std::nullopt;
  mean_gyro /= double(pairs.size());
  mean_cam /= double(pairs.size());
  for (motion::Bearings& b : pairs) b.in_reference -= mean_gyro, b.in_cam -= mean_cam;
  GyroFit fit;
  fit.offset_s = offset_s;
  fit.cam_from_gyro = motion::best_rotation(pairs, std::vector<double>(pairs.size(), 1.0));
  fit.bias_radps = mean_cam - fit.cam_from_gyro * mean_gyro;
  double dot = 0, a = 0, b = 0, rest = 0;
  for (const motion::Bearings& p : pairs) {
    const Vector3 turned = fit.cam_from_gyro * p.in_reference;
    dot += turned.dot(p.in_cam), a += turned.squaredNorm(), b += p.in_cam.squaredNorm();
    rest += (turned - p.in_cam).squaredNorm();
  }
  if (!(a > 0) || !(b > 0)) return std::nullopt;
  fit.correlation = dot / std::sqrt(a * b);
  fit.rms_radps = std::sqrt(rest / double(pairs.size()) / 3);
  return fit;
}

// The standard error of the offset. The model's rate changes by its derivative times the error of
// the offset, so that sigma^2 = residual^2 / sum of derivative^2 over steps and axes. The residuals
// of neighbouring steps are not independent, since a measured rotation enters two steps: they count
// as half as many.
double sigma_of_offset(const std::vector<GyroSample>& gyro,
                       const std::vector<Step>& steps,
                       const GyroFit& fit) {
  double change = 0;
  for (const Step& s : steps) {
    const double half_s = 0.5 * (s.end_s - s.begin_s);
    const auto before =
        mean_rate(gyro, s.begin_s + fit.offset_s - half_s, s.end_s + fit.offset_s - half_s);
    const auto after =
        mean_rate(gyro, s.begin_s + fit.offset_s + half_s, s.end_s + fit.offset_s + half_s);
    if (before && after) change += ((*after - *before) / (2 * half_s)).squaredNorm();
  }
  if (!(change > 0)) return std::numeric_limits<double>::infinity();
  return fit.rms_radps * std::sqrt(2 / change);
}

// The best fit at offsets from a coarse grid, and around it from a fine one. Offsets for which
// `is_wanted` is false are passed over.
template <typename IsWanted>
std::optional<GyroFit> best_fit(const std::vector<GyroSample>& gyro,
                                const std::vector<Step>& steps,
                                const OffsetRange& range,
                                const IsWanted& is_wanted) {
  // Spacing of the offsets that are tried, s: the coarse one is below a quarter of a period of a
  // shake of 10 Hz, 0.025 s, and the fine one is the resolution of the result.
  constexpr double kCoarseS = 0.01, kFineS = 0.001;
  std::optional<GyroFit> best;
  const auto look = [&](const std::vector<Step>& at, double offset_s) {
    if (!is_wanted(offset_s)) return;
    const auto fit = fit_at(gyro, at, offset_s);
    if (fit && (!best || fit->correlation > best->correlation)) best = fit;
  };
  // Over a whole log the coarse grid has some hundred thousand offsets: it takes 300 of the steps.
  constexpr std::size_t kMaxCoarseSteps = 300;
  const std::size_t stride = 1 + steps.size() / kMaxCoarseSteps;
  std::vector<Step> some;
  for (std::size_t i = 0; i < steps.size(); i += stride) some.push_back(steps[i]);
  const auto count = static_cast<int>(std::floor((range.to_s - range.from_s) / kCoarseS + 0.5));
  for (int i = 0; i <= count; ++i) look(some, range.from_s + kCoarseS * i);
  if (!best) return std::nullopt;
  const double middle_s = best->offset_s;
  best.reset();
  for (int i = -10; i <= 10; ++i) look(steps, middle_s + kFineS * i);
  if (best) best->offset_sigma_s = sigma_of_offset(gyro, steps, *best);
  return best;
}

}  // namespace

std::vector<GyroSample> gyro_from_gpmf(std::span<const std::uint8_t> packet,
                                       double begin_s,
                                       double end_s) {
  std::vector<Vector3> rates;
  each_gpmf_stream(packet, [&](std::span<const std::uint8_t> stream) {
    const std::vector<Vector3> found = rates_of(stream);
    rates.insert(rates.end(), found.begin(), found.end());
  });
  std::vector<GyroSample> samples;
  for (std::size_t i = 0; i < rates.size(); ++i)
    samples.push_back(
        {begin_s + (double(i) + 0.5) * (end_s - begin_s) / double(rates.size()), rates[i]});
  return samples;
}

std::optional<GyroFit> fit_gyro(const std::vector<GyroSample>& gyro,
                                const std::vector<motion::FrameMotion>& motion,
                                const OffsetRange& range) {
  constexpr double kMinCorrelation = 0.5;  // chosen by judgement: half of the turning is explained
  const auto best = best_fit(gyro, steps_of(motion), range, [](double) { return true; });
  return best && best->correlation >= kMinCorrelation ? best : std::nullopt;
}

std::optional<GyroFit> other_fit(const std::vector<GyroSample>& gyro,
                                 const std::vector<motion::FrameMotion>& motion,
                                 const OffsetRange& range,
                                 const GyroFit& best,
                                 double apart_s) {
  return best_fit(gyro, steps_of(motion), range, [&](double offset_s) {
    return std::abs(offset_s - best.offset_s) >= apart_s;
  });
}

std::vector<motion::FrameMotion> bridged_by_gyro(const std::vector<motion::FrameMotion>& motion,
                                                 const std::vector<GyroSample>& gyro,
                                                 const GyroFit& fit) {
  std::vector<motion::FrameMotion> result = motion;
  // The estimator measures a frame against frames before a gap, unless it has begun anew since: the
  // rotation is then one against that frame. So it is linked to the latest of either kind.
  std::size_t linked = 0;
  for (std::size_t k = 1; k < motion.size(); ++k) {
    const bool is_linked = motion[k].state == motion::State::kMeasured && !motion[k].begins_anew;
    const auto rate =
        is_linked
            ? std::nullopt
            : mean_rate(gyro, motion[k - 1].time_s + fit.offset_s, motion[k].time_s + fit.offset_s);
    if (rate) {
      const Vector3 in_cam = fit.cam_from_gyro * *rate + fit.bias_radps;
      const double dt = motion[k].time_s - motion[k - 1].time_s;
      result[k].rotation =
          (rotation_from_vector(-dt * in_cam) * *result[k - 1].rotation).normalized();
    } else {
      result[k].rotation =
          (*motion[k].rotation * motion[linked].rotation->conjugate() * *result[linked].rotation)
              .normalized();
    }
    if (is_linked || motion[k].begins_anew) linked = k;
  }
  return result;
}

}  // namespace airtruth::gyro
