// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <airtruth/metrics.h>
#include <airtruth/statistics.h>
#include <airtruth/vot.h>
#include <pybind11/stl.h>

#include "bindings.h"
#include "calls.h"
#include "values.h"

namespace airtruth::python {
namespace {

using namespace evaluation;
using namespace py::literals;

using TwoWhole = std::pair<py::object, py::object>;
using Size = std::optional<TwoWhole>;

// Width and height of a picture; (0, 0): unknown.
std::pair<int, int> picture_size(const Size& size) {
  if (!size) return {0, 0};
  return {size_of(size->first, "width"), size_of(size->second, "height")};
}

std::vector<FramePair> pairs_of(const py::object& truth, const py::object& answers) {
  const auto truths = boxes_of(truth, "truth");
  const auto boxes = boxes_of(answers, "answers");
  expect_equal(truths.size(), boxes.size(), "truth and answers");
  std::vector<FramePair> pairs;
  for (std::size_t i = 0; i < truths.size(); ++i) pairs.push_back({truths[i], boxes[i], 0});
  return pairs;
}

template <typename Visit>
void each_field(const Visit& visit) {
  visit("frames", &Score::frames);
  visit("counted", &Score::counted);
  visit("x_mean_px", &Score::x_mean_px);
  visit("x_rmse_px", &Score::x_rmse_px);
  visit("x_most_px", &Score::x_most_px);
  visit("y_mean_px", &Score::y_mean_px);
  visit("y_rmse_px", &Score::y_rmse_px);
  visit("y_most_px", &Score::y_most_px);
  visit("centre_mean_px", &Score::centre_mean_px);
  visit("success", &Score::success);
  visit("precision", &Score::precision);
  visit("auc", &Score::auc);
  visit("precision_20px", &Score::precision_20px);
  visit("normalised", &Score::normalised);
  visit("normalised_auc", &Score::normalised_auc);
  visit("average_overlap", &Score::average_overlap);
  visit("success_50", &Score::success_50);
  visit("success_75", &Score::success_75);
  visit("frames_per_second", &Score::frames_per_second);
  visit("frames_per_second_median", &Score::frames_per_second_median);
  visit("counted_after_first", &Score::counted_after_first);
}

py::dict score_dict(const Score& score) {
  py::dict dict;
  each_field([&](const char* name, auto field) { dict[name] = python_of(score.*field); });
  return dict;
}

// From an airtruth.evaluate.Score.
Score score_from(const py::handle& fields) {
  Score score;
  each_field([&](const char* name, auto field) {
    score.*field = fields.attr(name).cast<std::remove_reference_t<decltype(score.*field)>>();
  });
  return score;
}

py::dict score_of(const py::object& truth,
                  const py::object& answers,
                  const py::object& seconds,
                  const Size& size) {
  std::vector<FramePair> pairs = pairs_of(truth, answers);
  if (!seconds.is_none()) {
    const std::vector<double> times = list_of(seconds, "seconds");
    expect_equal(pairs.size(), times.size(), "truth and seconds");
    for (std::size_t i = 0; i < times.size(); ++i) pairs[i].seconds = times[i];
  }
  const auto [width, height] = picture_size(size);
  return score_dict(score(pairs, width, height));
}

py::dict mean(const py::list& scores) {
  std::vector<Score> values;
  for (const py::handle& one : scores) values.push_back(score_from(one));
  return score_dict(mean_of(values));
}

py::object overlaps(const py::object& a, const py::object& b) {
  const auto first = boxes_of(a, "a");
  const auto second = boxes_of(b, "b");
  expect_equal(first.size(), second.size(), "a and b");
  std::vector<double> values;
  for (std::size_t i = 0; i < first.size(); ++i)
    values.push_back(first[i] && second[i] ? overlap(*first[i], *second[i]) : 0);
  return python_of(std::move(values));
}

py::object bootstrap(const py::object& values, const py::object& weights) {
  const std::vector<double> numbers = finite_list_of(values, "values");
  if (weights.is_none()) return python_of(left_alone([=] { return bootstrap_mean(numbers); }));
  const std::vector<double> shares = finite_list_of(weights, "weights");
  expect_equal(numbers.size(), shares.size(), "values and weights");
  for (const double share : shares)
    if (share <= 0) throw py::value_error("weights holds a number that is not above 0");
  return python_of(left_alone([=] { return bootstrap_mean(numbers, shares); }));
}

py::dict paired_dict(const py::object& a, const py::object& b) {
  const std::vector<double> first = finite_list_of(a, "a");
  const std::vector<double> second = finite_list_of(b, "b");
  expect_equal(first.size(), second.size(), "a and b");
  const Paired result = left_alone([=] { return paired(first, second); });
  return py::dict("difference"_a = first.empty() ? std::nullopt : std::optional(result.difference),
                  "interval"_a = python_of(result.interval),
                  "p_value"_a = result.p_value,
                  "wins"_a = result.wins,
                  "losses"_a = result.losses,
                  "ties"_a = result.ties);
}

std::optional<double> tau(const py::object& a, const py::object& b) {
  const std::vector<double> first = finite_list_of(a, "a");
  const std::vector<double> second = finite_list_of(b, "b");
  expect_equal(first.size(), second.size(), "a and b");
  return left_alone([=] { return kendall_tau(first, second); });
}

VotTruth vot_truth(const py::object& truth, const Size& size) {
  const auto [width, height] = picture_size(size);
  return {boxes_of(truth, "truth"), width, height};
}

Mark mark_of(double number) {
  if (number == 0) return Mark::kUnknown;
  if (number == 1) return Mark::kBegun;
  if (number == 2) return Mark::kFailed;
  if (number == 3) return Mark::kAnswer;
  throw py::value_error("marks holds another number than 0, 1, 2 and 3");
}

Trajectory trajectory_of(const py::object& boxes, const py::object& marks) {
  const auto answers = boxes_of(boxes, "boxes");
  const std::vector<double> numbers = list_of(marks, "marks");
  expect_equal(answers.size(), numbers.size(), "boxes and marks");
  Trajectory trajectory;
  for (std::size_t i = 0; i < answers.size(); ++i)
    trajectory.push_back({mark_of(numbers[i]), answers[i]});
  return trajectory;
}

// (truth, size, runs) with runs (boxes, marks).
std::vector<RestartRuns> restart_runs(const py::iterable& sequences) {
  std::vector<RestartRuns> result;
  for (const py::handle& item : sequences) {
    const auto [truth, size, runs] = item.cast<std::tuple<py::object, Size, py::list>>();
    RestartRuns& sequence = result.emplace_back();
    sequence.truth = vot_truth(truth, size);
    for (const py::handle& run : runs) {
      const auto [boxes, marks] = run.cast<std::tuple<py::object, py::object>>();
      sequence.runs.push_back(trajectory_of(boxes, marks));
      expect_equal(sequence.truth.boxes.size(), sequence.runs.back().size(), "truth and a run");
    }
  }
  return result;
}

// (truth, size, runs) with runs (anchor, is_backward, boxes, marks).
std::vector<MultiStartRuns> multistart_runs(const py::iterable& sequences) {
  std::vector<MultiStartRuns> result;
  for (const py::handle& item : sequences) {
    const auto [truth, size, runs] = item.cast<std::tuple<py::object, Size, py::list>>();
    MultiStartRuns& sequence = result.emplace_back();
    sequence.truth = vot_truth(truth, size);
    const std::int64_t frames = std::ssize(sequence.truth.boxes);
    for (const py::handle& run : runs) {
      const auto [anchor, is_backward, boxes, marks] =
          run.cast<std::tuple<std::int64_t, bool, py::object, py::object>>();
      if (anchor < 0 || anchor >= frames) throw py::value_error("an anchor is not in its sequence");
      sequence.runs.push_back({anchor, is_backward, trajectory_of(boxes, marks)});
      expect_equal(static_cast<std::size_t>(is_backward ? anchor + 1 : frames - anchor),
                   sequence.runs.back().frames.size(),
                   "the sequence from an anchor and its run");
    }
  }
  return result;
}

std::pair<int, int> range_of(const TwoWhole& range) {
  constexpr int kMost = 1'000'000;
  const int low = whole_of<int>(range.first, "eao_range[0]", 0, kMost);
  return {low, whole_of<int>(range.second, "eao_range[1]", low, kMost)};
}

// A measure over the runs of all sequences; empty where there is none.
template <typename Runs>
std::optional<double> over(const std::vector<Runs>& sequences, double measure) {
  const bool is_empty =
      std::ranges::all_of(sequences, [](const Runs& s) { return s.runs.empty(); });
  return is_empty ? std::nullopt : std::optional(measure);
}

py::dict restart_dict(const py::iterable& sequences, const TwoWhole& range) {
  const std::vector<RestartRuns> runs = restart_runs(sequences);
  const Restart result =
      left_alone([runs, to = range_of(range)] { return restart_score(runs, to); });
  return py::dict("accuracy"_a = over(runs, result.accuracy),
                  "failures"_a = over(runs, result.failures),
                  "reliability"_a = over(runs, result.reliability),
                  "eao"_a = result.eao,
                  "eao_curve"_a = python_of(result.eao_curve));
}

py::dict multistart_dict(const py::iterable& sequences, const TwoWhole& range) {
  const std::vector<MultiStartRuns> runs = multistart_runs(sequences);
  const MultiStart result =
      left_alone([runs, to = range_of(range)] { return multistart_score(runs, to); });
  return py::dict("accuracy"_a = over(runs, result.accuracy),
                  "robustness"_a = over(runs, result.robustness),
                  "eao"_a = result.eao,
                  "eao_curve"_a = python_of(result.eao_curve));
}

py::list anchors(const py::object& truth, const py::object& step) {
  const int frames = whole_of<int>(step, "step", 1, 1'000'000);
  py::list result;
  for (const Anchor& anchor : anchors_of(vot_truth(truth, {}), frames))
    result.append(py::make_tuple(anchor.frame, anchor.is_backward));
  return result;
}

std::pair<int, int> lengths_range(const py::sequence& lengths) {
  std::vector<std::int64_t> frames;
  for (const py::handle& length : lengths)
    frames.push_back(whole_of<int>(length, "a length", 1, 1'000'000));
  return eao_range(frames);
}

}  // namespace

void bind_evaluate(py::module_& core) {
  core.def("score", named(&score_of, "truth", "answers", "seconds", "size"));
  core.def("mean_of", named(&mean, "scores"));
  core.def("first_loss", [](const py::object& truth, const py::object& answers) {
    return first_loss(pairs_of(truth, answers));
  });
  core.def("overlap", &overlaps);
  core.def("bootstrap_mean", &bootstrap);
  core.def("paired", &paired_dict);
  core.def("kendall_tau", &tau);
  core.def("restart_score", named(&restart_dict, "sequences", "eao_range"));
  core.def("multistart_score", named(&multistart_dict, "sequences", "eao_range"));
  core.def("anchors_of", &anchors);
  core.def("eao_range", named(&lengths_range, "lengths"));
}

}  // namespace airtruth::python
