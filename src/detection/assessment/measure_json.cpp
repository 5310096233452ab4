// SPDX-License-Identifier: Apache-2.0
#include "detection/assessment/measure_json.h"

#include <cmath>

#include <nlohmann/json.hpp>

#include "detection/assessment/or_null.h"

namespace airtruth::detection {
namespace {

using Json = nlohmann::ordered_json;

Json json_of(const std::optional<evaluation::Interval>& interval) {
  return interval ? Json{interval->low, interval->high} : Json();
}

Json json_of(const std::optional<PrecisionCurve>& curve, const std::optional<PrecisionBand>& band) {
  if (!curve) return {};
  Json json = {{"precision", curve->precision},
               {"score", curve->score},
               {"recall", curve->recall},
               {"truths", curve->truths}};
  if (band) {
    json["low_95"] = band->low;
    json["high_95"] = band->high;
  }
  return json;
}

Json json_of(const Spread& spread) {
  Json json = {{"mean", spread.mean},
               {"deviation", spread.deviation},
               {"rms", spread.rms},
               {"within_95", spread.within_95},
               {"count", spread.count}};
  const auto& intervals = spread.intervals;
  const auto bounds = [&](evaluation::Interval Spread::Intervals::*of) {
    return intervals ? Json{((*intervals).*of).low, ((*intervals).*of).high} : Json();
  };
  json["mean_interval_95"] = bounds(&Spread::Intervals::mean);
  json["deviation_interval_95"] = bounds(&Spread::Intervals::deviation);
  json["rms_interval_95"] = bounds(&Spread::Intervals::rms);
  json["within_95_interval_95"] = bounds(&Spread::Intervals::within_95);
  return json;
}

Json json_of(const AotRate& rate) {
  return {{"rate", rate.total > 0 ? Json(rate.rate()) : Json()},
          {"detected", rate.detected},
          {"total", rate.total}};
}

}  // namespace

Json json_of(const Share& share) {
  if (!(share.trials > 0)) return {};
  return {{"share", share.value},
          {"interval_95", {share.low, share.high}},
          {"successes", share.successes},
          {"trials", share.trials},
          {"sequences", share.clusters},
          {"effective_sequences", share.effective_clusters}};
}

Json json_of(const std::optional<MeanOf>& mean) {
  if (!mean) return {};
  return {{"mean", mean->mean}, {"interval_95", json_of(mean->interval)}, {"count", mean->count}};
}

Json json_of(const AveragePrecision& ap) {
  return {{"ap", or_null(ap.ap)},
          {"ap_50", or_null(ap.ap_50)},
          {"ap_50_interval_95", json_of(ap.ap_50_interval)},
          {"ap_75", or_null(ap.ap_75)},
          {"ap_small", or_null(ap.ap_small)},
          {"ap_medium", or_null(ap.ap_medium)},
          {"ap_large", or_null(ap.ap_large)},
          {"ar_1", or_null(ap.ar_1)},
          {"ar_10", or_null(ap.ar_10)},
          {"ar_100", or_null(ap.ar_100)},
          {"ar_small", or_null(ap.ar_small)},
          {"ar_medium", or_null(ap.ar_medium)},
          {"ar_large", or_null(ap.ar_large)},
          {"ap_centre", or_null(ap.ap_centre)},
          {"ap_centre_interval_95", json_of(ap.ap_centre_interval)},
          {"curve_50", json_of(ap.curve_50, ap.band_50)},
          {"curve_centre", json_of(ap.curve_centre, ap.band_centre)}};
}

Json json_of(const FrocPoint& point, bool has_hours) {
  return {{"score", point.score},
          {"detection", json_of(point.detection)},
          {"false_alarms_per_image", point.false_alarms_per_image},
          {"false_alarms_per_hour", has_hours ? Json(point.false_alarms_per_hour) : Json()},
          {"false_alarms_per_flight", point.false_alarms_per_flight}};
}

Json json_of(const Froc& froc) {
  Json json = {{"images", froc.images},
               {"flights", froc.flights},
               {"hours", froc.hours > 0 ? Json(froc.hours) : Json()},
               {"aircraft_in_images", froc.aircraft},
               {"points", Json::array()}};
  for (const FrocPoint& point : froc.points)
    json["points"].push_back(json_of(point, froc.hours > 0));
  return json;
}

Json json_of(const DetectionBin& bin) {
  Json json = Json::object();
  if (bin.name.empty()) {
    json["from"] = bin.from;
    json["to"] = std::isfinite(bin.to) ? Json(bin.to) : Json();
  } else {
    json["name"] = bin.name;
  }
  json.update(json_of(bin.detection));
  if (bin.weighted) json["weighted"] = json_of(*bin.weighted);
  return json;
}

Json json_of(const std::optional<BearingError>& error) {
  if (!error) return {};
  const auto rate = [](const std::optional<Spread>& spread) {
    return spread ? json_of(*spread) : Json();
  };
  return {{"azimuth_mrad", json_of(error->azimuth)},
          {"elevation_mrad", json_of(error->elevation)},
          {"azimuth_rate_mradps", rate(error->azimuth_rate)},
          {"elevation_rate_mradps", rate(error->elevation_rate)},
          {"sc228_bearing_deviation_mrad", kSc228Bearing_mrad},
          {"sc228_rate_deviation_mradps", kSc228Rate_mradps}};
}

Json json_of(const AotScore& aot, bool has_hours) {
  return {{"score", aot.score},
          {"edr", json_of(aot.edr_all)},
          {"edr_below_horizon", json_of(aot.edr_below)},
          {"edr_mixed", json_of(aot.edr_mixed)},
          {"edr_above_horizon", json_of(aot.edr_above)},
          {"edr_by_frames", json_of(aot.edr_frames_all)},
          {"afdr", json_of(aot.afdr)},
          {"max_range_m", or_null(aot.max_range_m)},
          {"hfar", has_hours ? Json(aot.hfar) : Json()},
          {"fppi", aot.fppi}};
}

}  // namespace airtruth::detection
