// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <set>

#include <airtruth/aot.h>
#include <airtruth/average_precision.h>
#include <airtruth/froc.h>
#include <airtruth/track_measures.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

using namespace evaluation;
using namespace py::literals;

// ValueError for a distance that is negative or not finite.
void checked_centre(double centre_px) {
  if (!(centre_px >= 0) || std::isinf(centre_px))
    throw py::value_error("centre_px is no finite number of 0 or more");
}

// A number for each of `count` boxes.
std::vector<double> beside(const py::handle& value, const char* what, std::size_t count) {
  std::vector<double> numbers = list_of(value, what);
  expect_equal(count, numbers.size(), what);
  return numbers;
}

// Calls add(box, i) for each row that is a box.
template <typename Add>
void each_box(const std::vector<std::optional<Box>>& boxes, const Add& add) {
  for (std::size_t i = 0; i < boxes.size(); ++i)
    if (boxes[i]) add(*boxes[i], i);
}

// Truths as flagged in `ignored`, and after them the regions.
std::vector<LabelledBox> labelled_boxes(const std::vector<std::optional<Box>>& truths,
                                        const py::handle& ignored,
                                        const py::handle& regions) {
  const std::vector<double> flags = beside(ignored, "truth and ignored", truths.size());
  std::vector<LabelledBox> labelled;
  each_box(truths, [&](const Box& box, std::size_t i) {
    labelled.push_back({.box_px = box, .is_ignored = flags[i] != 0});
  });
  each_box(boxes_of(regions, "regions"), [&](const Box& box, std::size_t) {
    labelled.push_back({.box_px = box, .is_region = true});
  });
  return labelled;
}

// An image from (truth n x 4, ignored n, regions k x 4, detections m x 4, scores m).
ScoredImage scored_image_of(const py::handle& item) {
  const auto [truth, ignored, regions, detections, scores] =
      item.cast<std::tuple<py::object, py::object, py::object, py::object, py::object>>();
  ScoredImage image{labelled_boxes(boxes_of(truth, "truth"), ignored, regions), {}};
  const auto boxes = boxes_of(detections, "detections");
  const std::vector<double> numbers = finite_list_of(scores, "scores");
  expect_equal(boxes.size(), numbers.size(), "detections and scores");
  each_box(boxes, [&](const Box& box, std::size_t i) {
    image.detections.push_back({box, numbers[i]});
  });
  return image;
}

// The images of each sequence, as image_of() reads one of them; signals are seen.
template <typename Image>
auto sequences_of(const py::list& sequences, const Image& image_of) {
  std::vector<std::vector<decltype(image_of(py::handle()))>> result;
  for (const py::handle& sequence : sequences) {
    result.emplace_back();
    for (const py::handle& image : sequence.cast<py::list>()) {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      result.back().push_back(image_of(image));
    }
  }
  return result;
}

py::object curve_dict(const std::optional<PrecisionCurve>& curve) {
  if (!curve) return py::none();
  return py::dict("precision"_a = python_of(curve->precision),
                  "score"_a = python_of(curve->score),
                  "average_precision"_a = curve->average_precision,
                  "recall"_a = curve->recall,
                  "truths"_a = curve->truths);
}

// `sequences`: the images of each.
py::dict precision_dict(const py::list& sequences, double centre_px) {
  checked_centre(centre_px);
  const AveragePrecision ap =
      left_alone([images = sequences_of(sequences, &scored_image_of), centre_px] {
        return average_precision(images, centre_px);
      });
  return py::dict("ap"_a = ap.ap,
                  "ap_50"_a = ap.ap_50,
                  "ap_75"_a = ap.ap_75,
                  "ap_small"_a = ap.ap_small,
                  "ap_medium"_a = ap.ap_medium,
                  "ap_large"_a = ap.ap_large,
                  "ar_1"_a = ap.ar_1,
                  "ar_10"_a = ap.ar_10,
                  "ar_100"_a = ap.ar_100,
                  "ar_small"_a = ap.ar_small,
                  "ar_medium"_a = ap.ar_medium,
                  "ar_large"_a = ap.ar_large,
                  "ap_centre"_a = ap.ap_centre,
                  "ap_50_interval"_a = python_of(ap.ap_50_interval),
                  "ap_centre_interval"_a = python_of(ap.ap_centre_interval),
                  "curve_50"_a = curve_dict(ap.curve_50),
                  "curve_centre"_a = curve_dict(ap.curve_centre));
}

// The number of a track; empty for NaN.
std::optional<std::int64_t> track_of(double number, const char* what) {
  constexpr double kMost = 9e15;
  if (std::isnan(number)) return std::nullopt;
  if (!(std::abs(number) <= kMost) || number != std::floor(number))
    throw py::value_error(std::string(what) + " holds a number that is not whole");
  return static_cast<std::int64_t>(number);
}

// Of an image the truths and detections that count; the others are no boxes.
struct Counting {
  std::vector<std::optional<Box>> truths, detections;

  // truth n x 4, ignored n, regions k x 4, detections m x 4.
  Counting(const py::handle& truth,
           const py::handle& ignored,
           const py::handle& regions,
           const py::handle& found,
           double centre_px)
      : truths(boxes_of(truth, "truth")), detections(boxes_of(found, "detections")) {
    ScoredImage image{labelled_boxes(truths, ignored, regions), {}};
    each_box(detections, [&](const Box& box, std::size_t) {
      image.detections.push_back({box, 0});
    });
    const std::vector<bool> neither = counts_neither_way(image, centre_px);
    std::size_t next = 0;
    for (auto& truth_box : truths)
      if (truth_box && image.truths[next++].is_ignored) truth_box.reset();
    next = 0;
    for (auto& detection : detections)
      if (detection && neither[next++]) detection.reset();
  }
};

// Seconds of a sequence; 0: unknown.
double duration_s(std::size_t images, std::optional<double> rate_hz) {
  return rate_hz ? static_cast<double>(images) / *rate_hz : 0;
}

void checked_rate(std::optional<double> rate_hz) {
  if (rate_hz && !(*rate_hz > 0 && std::isfinite(*rate_hz)))
    throw py::value_error("rate_hz is no finite number above 0");
}

py::dict froc_dict(const py::list& sequences, std::optional<double> rate_hz, double centre_px) {
  const auto images = sequences_of(sequences, &scored_image_of);
  checked_centre(centre_px);
  checked_rate(rate_hz);
  const Froc froc = left_alone([=] {
    std::vector<FrocSequence> matched;
    for (const auto& sequence : images)
      matched.push_back(froc_sequence(sequence, duration_s(sequence.size(), rate_hz), centre_px));
    return froc_of(matched);
  });
  const std::vector<FrocPoint>& points = froc.points;
  const auto share = [&](double Proportion::*of) {
    return froc.aircraft == 0
               ? py::none()
               : column(points, [&](const FrocPoint& point) { return point.detection.*of; });
  };
  return py::dict("score"_a = column(points, &FrocPoint::score),
                  "detection"_a = share(&Proportion::value),
                  "detection_low"_a = share(&Proportion::low),
                  "detection_high"_a = share(&Proportion::high),
                  "false_alarms_per_image"_a = column(points, &FrocPoint::false_alarms_per_image),
                  "false_alarms_per_hour"_a =
                      rate_hz ? column(points, &FrocPoint::false_alarms_per_hour) : py::none(),
                  "false_alarms_per_flight"_a = column(points, &FrocPoint::false_alarms_per_flight),
                  "images"_a = froc.images,
                  "flights"_a = froc.flights,
                  "hours"_a = rate_hz ? std::optional(froc.hours) : std::nullopt,
                  "aircraft"_a = froc.aircraft);
}

// Boxes with the numbers of their tracks; those without one are left out.
std::vector<TrackBox> track_boxes(const std::vector<std::optional<Box>>& rows,
                                  const py::handle& tracks,
                                  const char* what_tracks) {
  const std::vector<double> numbers = beside(tracks, what_tracks, rows.size());
  std::vector<TrackBox> result;
  std::set<std::int64_t> seen;
  each_box(rows, [&](const Box& box, std::size_t i) {
    const auto track = track_of(numbers[i], what_tracks);
    if (!track) return;
    if (!seen.insert(*track).second)
      throw py::value_error(std::string(what_tracks) + " holds the track " +
                            std::to_string(*track) + " twice in one image");
    result.push_back({*track, box});
  });
  return result;
}

// (truth n x 4, ignored n, regions k x 4, truth_tracks n, detections m x 4, tracks m).
TrackFrame track_frame_of(const py::handle& item, double centre_px) {
  using Object = py::object;
  const auto [truth, ignored, regions, truth_tracks, detections, tracks] =
      item.cast<std::tuple<Object, Object, Object, Object, Object, Object>>();
  const Counting counting(truth, ignored, regions, detections, centre_px);
  return {track_boxes(counting.truths, truth_tracks, "truth_tracks"),
          track_boxes(counting.detections, tracks, "tracks")};
}

py::dict hota_dict(const py::list& sequences, double centre_px) {
  checked_centre(centre_px);
  const auto frame_of = [&](const py::handle& item) { return track_frame_of(item, centre_px); };
  const Hota hota = left_alone([frames = sequences_of(sequences, frame_of)] {
    std::vector<Hota> each;
    for (const TrackFrames& sequence : frames) each.push_back(hota_of(sequence));
    return combined(each);
  });
  py::dict means;
  py::dict curves;
  const auto add = [&](const char* name, const Hota::Curve& curve) {
    means[name] = Hota::mean(curve);
    curves[name] = python_of(curve);
  };
  add("hota", hota.hota);
  add("det_a", hota.det_a);
  add("ass_a", hota.ass_a);
  add("det_re", hota.det_re);
  add("det_pr", hota.det_pr);
  add("ass_re", hota.ass_re);
  add("ass_pr", hota.ass_pr);
  add("loc_a", hota.loc_a);
  means["at_overlaps"] = curves;
  return means;
}

// (truth n x 4, ignored n, regions k x 4, truth_tracks n, ranges_m n, above_horizon n,
// detections m x 4, scores m, tracks m).
AotFrame aot_frame_of(const py::handle& item, double centre_px) {
  using Object = py::object;
  const auto [truth,
              ignored,
              regions,
              truth_tracks,
              ranges_m,
              above_horizon,
              detections,
              scores,
              tracks] =
      item.cast<
          std::tuple<Object, Object, Object, Object, Object, Object, Object, Object, Object>>();
  AotFrame frame;
  const auto [truths, boxes] = Counting(truth, ignored, regions, detections, centre_px);
  const std::vector<double> ids = beside(truth_tracks, "truth_tracks", truths.size());
  const std::vector<double> ranges = beside(ranges_m, "ranges_m", truths.size());
  const std::vector<double> above = beside(above_horizon, "above_horizon", truths.size());
  each_box(truths, [&](const Box& box, std::size_t i) {
    const auto id = track_of(ids[i], "truth_tracks");
    if (!id) throw py::value_error("truth_tracks holds a NaN");
    if (above[i] != -1 && above[i] != 0 && above[i] != 1)
      throw py::value_error("above_horizon holds another number than -1, 0 and 1");
    const std::optional<double> range_m =
        std::isnan(ranges[i]) ? std::nullopt : std::optional(ranges[i]);
    frame.objects.push_back({*id, box, range_m, static_cast<int>(above[i])});
  });
  const std::vector<double> numbers = beside(scores, "scores", boxes.size());
  const std::vector<double> of_tracks = beside(tracks, "tracks", boxes.size());
  each_box(boxes, [&](const Box& box, std::size_t i) {
    expect_finite(numbers, i, "scores");
    frame.detections.push_back({box, numbers[i], track_of(of_tracks[i], "tracks")});
  });
  return frame;
}

py::tuple rate_tuple(const AotRate& rate) {
  return py::make_tuple(
      rate.detected, rate.total, rate.total > 0 ? std::optional(rate.rate()) : std::nullopt);
}

py::dict aot_dict(const AotScore& score, bool has_images, bool has_rate) {
  return py::dict("score"_a = score.score,
                  "edr"_a = rate_tuple(score.edr_all),
                  "edr_below_horizon"_a = rate_tuple(score.edr_below),
                  "edr_mixed"_a = rate_tuple(score.edr_mixed),
                  "edr_above_horizon"_a = rate_tuple(score.edr_above),
                  "edr_by_frames"_a = rate_tuple(score.edr_frames_all),
                  "afdr"_a = rate_tuple(score.afdr),
                  "max_range_m"_a = score.max_range_m,
                  "hfar"_a = has_images && has_rate ? std::optional(score.hfar) : std::nullopt,
                  "fppi"_a = has_images ? std::optional(score.fppi) : std::nullopt);
}

struct AotInputs {
  std::vector<AotFlight> flights;
  double hours = 0;
};

AotInputs aot_inputs(const py::list& sequences, std::optional<double> rate_hz, double centre_px) {
  checked_rate(rate_hz);
  checked_centre(centre_px);
  const auto frame_of = [&](const py::handle& item) { return aot_frame_of(item, centre_px); };
  AotInputs inputs;
  for (std::vector<AotFrame>& frames : sequences_of(sequences, frame_of)) {
    for (std::size_t i = 0; i < frames.size(); ++i) frames[i].frame = static_cast<std::int64_t>(i);
    inputs.hours += duration_s(frames.size(), rate_hz) / kSecondsPerHour;
    inputs.flights.push_back({std::move(frames)});
  }
  return inputs;
}

py::dict aot(const py::list& sequences,
             std::optional<double> rate_hz,
             double centre_px,
             std::optional<double> min_score,
             int min_track_frames) {
  const AotScore score =
      left_alone([in = aot_inputs(sequences, rate_hz, centre_px), min_score, min_track_frames] {
        return aot_score(in.flights, {min_score, in.hours, min_track_frames});
      });
  return aot_dict(score, !sequences.empty(), rate_hz.has_value());
}

// (by hfar, by fppi).
py::tuple ranks(const py::list& sequences, std::optional<double> rate_hz, double centre_px) {
  const AotRanks found = left_alone(
      [in = aot_inputs(sequences, rate_hz, centre_px)] { return aot_ranks(in.flights, in.hours); });
  const auto one = [&](const std::optional<AotScore>& score) -> py::object {
    if (!score) return py::none();
    return aot_dict(*score, !sequences.empty(), rate_hz.has_value());
  };
  return py::make_tuple(rate_hz ? one(found.by_hfar) : py::none(), one(found.by_fppi));
}

}  // namespace

void bind_detectors(py::module_& core) {
  core.def("average_precision", named(&precision_dict, "sequences", "centre_px"));
  core.def("froc", named(&froc_dict, "sequences", "rate_hz", "centre_px"));
  core.def("claims_aircraft",
           [](const std::string& category) { return claims_aircraft(category); });
  core.def("hota", named(&hota_dict, "sequences", "centre_px"));
  core.def("aot",
           named(&aot, "sequences", "rate_hz", "centre_px", "min_score", "min_track_frames"));
  core.def("aot_ranks", named(&ranks, "sequences", "rate_hz", "centre_px"));
}

}  // namespace airtruth::python
