// SPDX-License-Identifier: Apache-2.0
#include "scene/flight_log/log_rates.h"

#include <cmath>

#include <fmt/format.h>

#include "foundation/geometry/within_frame.h"

namespace airtruth::flight_log {
namespace {

// A frame of 30 a second lasts 0.033 s: beyond three of them an intruder at 30 m/s is 3 m off.
constexpr double kMaxSigmaS = 0.1;
// Another offset fits nearly as well where it leaves a share of the turning unexplained that is
// less than twice that of the best. Chosen by judgement.
constexpr double kMinUnexplainedRatio = 2;

// How far a clip may reach beyond the rates of its log, s: of a log that begins or ends with it the
// rates lack half a record and the last interpolated sample (0.06 s at 10 Hz), and a frame is
// added.
constexpr double kBeyondS = 0.2;
// The least correlation there: where the true offset is further off, another peak of the vibration
// is found, at some 0.5. Chosen by judgement.
constexpr double kMinBeyondCorrelation = 0.9;

constexpr double kMinRateHz = 100;  // three samples in a frame of 30 a second

std::vector<gyro::GyroSample> stated_or_implied(const FlightLog& log) {
  std::vector<gyro::GyroSample> samples;
  for (const Rates& rates : log.rates) samples.push_back({rates.time_s, rates.in_body_radps});
  if (!samples.empty()) return samples;
  for (std::size_t i = 1; i < log.attitudes.size(); ++i) {
    const Attitude &a = log.attitudes[i - 1], &b = log.attitudes[i];
    const Quaternion body_a_from_body_b =
        world_from_body(a.angles).conjugate() * world_from_body(b.angles);
    samples.push_back({0.5 * (a.time_s + b.time_s),
                       vector_from_rotation(body_a_from_body_b) / (b.time_s - a.time_s)});
  }
  return samples;
}

std::vector<gyro::GyroSample> interpolated(const std::vector<gyro::GyroSample>& samples) {
  const double first_s = samples.front().time_s;
  const auto count =
      static_cast<std::size_t>(std::floor((samples.back().time_s - first_s) * kMinRateHz)) + 1;
  std::vector<gyro::GyroSample> result;
  std::size_t next = 1;
  for (std::size_t i = 0; i < count; ++i) {
    const double time_s = first_s + static_cast<double>(i) / kMinRateHz;
    while (next + 1 < samples.size() && samples[next].time_s < time_s) ++next;
    const gyro::GyroSample &a = samples[next - 1], &b = samples[next];
    const double share = (time_s - a.time_s) / (b.time_s - a.time_s);
    result.push_back({time_s, a.rate_radps + share * (b.rate_radps - a.rate_radps)});
  }
  return result;
}

bool is_in_range(const gyro::OffsetRange& range, double offset_s) {
  return offset_s >= range.from_s && offset_s <= range.to_s;
}

// The best fit among the offsets for which the log covers the clip, and those a little beyond.
std::optional<gyro::GyroFit> best_fit(const std::vector<gyro::GyroSample>& rates,
                                      const std::vector<motion::FrameMotion>& motion,
                                      const gyro::OffsetRange& of_log) {
  auto best = gyro::fit_gyro(rates, motion, of_log);
  for (const gyro::OffsetRange& end : {gyro::OffsetRange{of_log.from_s - kBeyondS, of_log.from_s},
                                       gyro::OffsetRange{of_log.to_s, of_log.to_s + kBeyondS}}) {
    const auto fit = gyro::fit_gyro(rates, motion, end);
    if (fit && (!best || fit->correlation > best->correlation)) best = fit;
  }
  return best;
}

// False for a fit at the very end of the search, which is no peak, and for a poor one for which the
// clip reaches beyond the log.
bool is_covered(const gyro::GyroFit& fit, const gyro::OffsetRange& of_log) {
  constexpr double kPeakS = 0.01;  // the coarse step of gyro::fit_gyro()
  constexpr double kInsideS = kBeyondS - kPeakS;
  return is_in_range({of_log.from_s - kInsideS, of_log.to_s + kInsideS}, fit.offset_s) &&
         (is_in_range(of_log, fit.offset_s) || fit.correlation >= kMinBeyondCorrelation);
}

}  // namespace

std::vector<gyro::GyroSample> gyro_samples(const FlightLog& log) {
  const auto samples = stated_or_implied(log);
  if (samples.size() < 2) return samples;
  const double span_s = samples.back().time_s - samples.front().time_s;
  return static_cast<double>(samples.size()) < kMinRateHz * span_s ? interpolated(samples)
                                                                   : samples;
}

Alignment aligned(const std::vector<gyro::GyroSample>& rates,
                  const std::vector<motion::FrameMotion>& motion) {
  Alignment result;
  const gyro::OffsetRange range{rates.front().time_s - motion.front().time_s,
                                rates.back().time_s - motion.back().time_s};
  if (!(range.to_s - range.from_s > -2 * kBeyondS)) {
    result.why =
        fmt::format("it lasts {:.1f} s and the clip {:.1f} s; expected a log of the whole clip",
                    rates.back().time_s - rates.front().time_s,
                    motion.back().time_s - motion.front().time_s);
    return result;
  }
  const auto best = best_fit(rates, motion, range);
  if (!best) {
    result.why =
        "its turn rates and the clip's measured rotation agree at no offset; expected a log "
        "of the same flight, and a clip that turns";
    return result;
  }
  if (!is_covered(*best, range)) {
    result.why = fmt::format(
        "it fits best at {:.2f} s (correlation {:.2f}), where it does not cover the clip; expected "
        "a log of the whole clip",
        best->offset_s,
        best->correlation);
    return result;
  }
  if (const auto other = gyro::other_fit(rates, motion, range, *best, kApartS)) {
    result.other_correlation = other->correlation;
    const auto unexplained = [](const gyro::GyroFit& fit) { return 1 - fit.correlation; };
    if (unexplained(*other) < kMinUnexplainedRatio * unexplained(*best)) {
      result.why = fmt::format(
          "it fits at {:.2f} s (correlation {:.2f}) and at {:.2f} s ({:.2f}); "
          "expected a clip with turns that occur once",
          best->offset_s,
          best->correlation,
          other->offset_s,
          other->correlation);
      return result;
    }
  }
  if (!(best->offset_sigma_s <= kMaxSigmaS)) {
    result.why =
        fmt::format("the clip turns too little: the offset {:.2f} s is uncertain by {:.2f} s",
                    best->offset_s,
                    best->offset_sigma_s);
    return result;
  }
  result.fit = best;
  return result;
}

}  // namespace airtruth::flight_log
