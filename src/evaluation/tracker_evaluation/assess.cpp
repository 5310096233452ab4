// SPDX-License-Identifier: Apache-2.0
#include "evaluation/tracker_evaluation/assess.h"

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <span>

#include <fmt/format.h>

#include "evaluation/measures/score_measures.h"
#include "evaluation/report/tables.h"
#include "evaluation/statistics/bins.h"
#include "foundation/base/error.h"
#include "foundation/base/in_parallel.h"
#include "foundation/json/json_object.h"
#include "foundation/json/settings_record.h"
#include "runners/results/trajectories.h"

namespace airtruth::tracker_evaluation {
namespace {

using evaluation::FramePair;
using evaluation::Score;

// Stills of all sequences together: about 20 KB each on the page.
constexpr std::size_t kMaxStills = 1500;
constexpr std::size_t kMaxStillsOfOne = 150;  // some 3 MB
constexpr std::size_t kMinStillsOfOne = 4;

// Edges of bins: the longer side of a box, and the contrast in levels of 255.
const std::vector<double> kSizeEdges_px = {0, 5, 10, 15, 20, 30, 40, 60, 80, 120, 200, 400};
const std::vector<double> kContrastEdges = {0, 4, 8, 12, 16, 24, 32, 48, 64, 96};

// Returns the score of a run. The first run's answers are those of the sequence.
Score add_one_pass(const TruthClip& truth,
                   const results::TrackerResults::OnePass& run,
                   bool until_loss,
                   ScoredSequence& scored) {
  std::vector<FramePair> pairs;
  for (std::size_t i = 0; i < run.frames.size(); ++i)
    pairs.push_back({truth.box(i), run.frames[i].box, run.seconds[i]});
  const auto lost = evaluation::first_loss(pairs);
  if (until_loss && lost)
    for (std::size_t i = *lost; i < pairs.size(); ++i) pairs[i].seconds = 0;
  std::ranges::copy(measures::outcomes(pairs, truth.lens ? &*truth.lens : nullptr),
                    std::back_inserter(scored.outcomes));
  if (scored.answers.empty()) {
    for (const FramePair& pair : pairs) scored.answers.push_back(pair.answer);
    if (lost) {
      const exchange::LabelledFrame& frame = truth.clip.frames[*lost];
      scored.loss = {frame.frame, truth.clip.time_s_of(frame), truth.range_m(*lost)};
    }
  }
  return evaluation::score(pairs, truth.clip.width, truth.clip.height);
}

// Of several runs the mean, in which GOT-10k's measures are over the frames of all.
void add_one_passes(const TruthClip& truth,
                    const results::TrackerResults& results,
                    bool until_loss,
                    ScoredSequence& scored) {
  if (!results.one_pass) return;
  std::vector<Score> scores = {add_one_pass(truth, *results.one_pass, until_loss, scored)};
  for (const auto& run : results.further_passes)
    scores.push_back(add_one_pass(truth, run, until_loss, scored));
  scored.score = scores.size() == 1 ? scores.front() : evaluation::mean_of(scores);
}

// The names of the truths of which any run was made of other content.
std::vector<std::string> of_other_content(const std::vector<TruthClip>& truths,
                                          const std::vector<results::TrackerResults>& results) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < truths.size(); ++i)
    if (std::ranges::any_of(results[i].sources_sha256,
                            [&](const std::string& sha256) { return sha256 != truths[i].sha256; }))
      names.push_back(truths[i].clip.name);
  return names;
}

// Reads the results of a folder for each truth. Throws Error where there are none. Warns of results
// for aircraft that the set lacks, of those of other content, of runs that were broken off, and of
// aircraft without results.
std::vector<results::TrackerResults> results_in(const fs::path& folder,
                                                const std::vector<TruthClip>& truths,
                                                const AssessOptions& options) {
  if (!fs::is_directory(folder)) throw Error("is no folder of results", {folder.string()});
  check_record(folder / "tracker.json");
  std::vector<results::TrackerResults> results;
  std::size_t missing = 0;
  std::int64_t negative = 0;
  Where first_negative;
  std::vector<std::string> doubts;
  std::set<std::string> known;
  for (const TruthClip& truth : truths) {
    results.push_back(
        results::read_results(folder, truth.clip, options.origin_px, truth.first_place));
    const results::TrackerResults& read = results.back();
    missing += read.empty() ? 1 : 0;
    if (negative == 0) first_negative = read.first_negative;
    negative += read.negative_boxes;
    if (!read.doubt.empty()) doubts.push_back(read.doubt);
    known.insert(truth.clip.name);
  }
  std::vector<std::string> unknown = results::tracked_sequences_in(folder);
  std::erase_if(unknown, [&](const std::string& name) { return known.contains(name); });
  const std::vector<std::string> broken = results::broken_runs_in(folder);
  const std::string broken_off =
      broken.empty()
          ? ""
          : fmt::format(
                "{} runs were broken off (logs/{}.log says how)", broken.size(), broken.front());
  if (missing == truths.size())
    throw Error("holds no result for any aircraft of the data set; expected " +
                    (truths.empty() ? "SEQUENCE" : truths.front().clip.name) + ".txt" +
                    (!unknown.empty() ? " (found one for '" + unknown.front() +
                                            "'; tracks of several aircraft take --detections)"
                     : !broken.empty() ? "; " + broken_off
                                       : ""),
                {folder.string()});
  if (!broken.empty())
    airtruth::warn(options.warn,
                   fmt::format("{}: {}, and have no results; `airtruth track` tries them again",
                               folder.string(),
                               broken_off));
  if (!unknown.empty())
    airtruth::warn(options.warn,
                   fmt::format("{}: {} results are for no aircraft of the data set (the first: {})",
                               folder.string(),
                               unknown.size(),
                               unknown.front()));
  if (negative > 0)
    airtruth::warn(options.warn,
                   fmt::format("{}: has a width or height below 0, as {} boxes of these results "
                               "have, and counts as no answer; expected x,y,width,height",
                               to_string(first_negative),
                               negative));
  report::warn_of_other_content(folder, of_other_content(truths, results), "track", options.warn);
  if (!doubts.empty())
    airtruth::warn(options.warn,
                   fmt::format("{} ({} of these results fit both)", doubts.front(), doubts.size()));
  if (missing > 0)
    airtruth::warn(options.warn,
                   fmt::format("{}: has results for {} of {} aircraft; its score is of those",
                               folder.string(),
                               truths.size() - missing,
                               truths.size()));
  return results;
}

void break_down(const std::vector<TruthClip>& truths, ScoredTracker& tracker) {
  std::vector<measures::Outcome> all;
  std::map<std::string, std::vector<std::optional<statistics::Place>>> places;
  for (const ScoredSequence& sequence : tracker.sequences) {
    const TruthClip& truth = truths[sequence.truth];
    for (const measures::Outcome& outcome : sequence.outcomes) {
      all.push_back(outcome);
      const auto add = [&](const std::string& key,
                           const std::optional<double>& value,
                           std::span<const double> edges) {
        places[key].push_back(statistics::place_of(value, edges));
      };
      add("range_m", truth.range_m(outcome.frame), statistics::kRangeEdges_m);
      add("size_px", truth.size_px(outcome.frame), kSizeEdges_px);
      add("contrast", truth.contrast[outcome.frame], kContrastEdges);
      places[kBackground].push_back(statistics::Place{.name = truth.background});
      for (const auto& [key, edges] : statistics::kWeatherEdges) {
        const auto fact = truth.weather.find(key);
        add(key, fact == truth.weather.end() ? std::nullopt : std::optional(fact->second), edges);
      }
    }
  }
  tracker.angle_mrad = measures::mean_of(all).angle_mrad;
  // Those of the weather are there where the set states it.
  for (const char* key : {"range_m", "size_px", "contrast", kBackground})
    tracker.bins.try_emplace(key);
  for (const auto& [key, of_key] : places)
    if (auto bins = measures::breakdown(all, of_key); !bins.empty())
      tracker.bins[key] = std::move(bins);
}

void summarise(const std::vector<TruthClip>& truths, ScoredTracker& tracker) {
  std::vector<Score> scores;
  for (const ScoredSequence& sequence : tracker.sequences) {
    if (!sequence.score) continue;
    scores.push_back(*sequence.score);
    tracker.lost += sequence.loss ? 1 : 0;
  }
  if (scores.empty()) return;
  tracker.overall = evaluation::mean_of(scores);
  for (const measures::ScoreMeasure& measure : measures::kScoreMeasures) {
    std::vector<double> values;
    std::vector<double> weights;
    for (const Score& score : scores) {
      if (!(score.*measure.value)) continue;
      values.push_back(*(score.*measure.value));
      weights.push_back(measure.weight_of(score));
    }
    tracker.intervals[measure.name] = evaluation::bootstrap_mean(values, weights);
  }
  break_down(truths, tracker);
}

// `about` states the truths, the range and the frames that count; found[i] belongs to its i-th
// truth.
ScoredTracker scored_tracker(const Assessment& about,
                             const std::string& name,
                             const std::vector<results::TrackerResults>& found) {
  ScoredTracker tracker;
  tracker.name = name;
  std::vector<evaluation::RestartRuns> restarts;
  std::vector<evaluation::MultiStartRuns> multistarts;
  for (std::size_t i = 0; i < about.truths.size(); ++i) {
    const TruthClip& truth = about.truths[i];
    const results::TrackerResults& results = found[i];
    if (results.empty()) continue;
    ScoredSequence scored;
    scored.truth = i;
    scored.name = truth.clip.name;
    add_one_passes(truth, results, about.until_loss, scored);
    if (!results.restart.empty()) {
      restarts.push_back({results::vot_truth(truth.clip), results.restart});
      scored.restart = evaluation::restart_score({&restarts.back(), 1}, about.eao_range);
    }
    if (!results.multistart.empty()) {
      multistarts.push_back({results::vot_truth(truth.clip), results.multistart});
      scored.multistart = evaluation::multistart_score({&multistarts.back(), 1}, about.eao_range);
    }
    tracker.sequences.push_back(std::move(scored));
  }
  if (!restarts.empty()) tracker.restart = evaluation::restart_score(restarts, about.eao_range);
  if (!multistarts.empty())
    tracker.multistart = evaluation::multistart_score(multistarts, about.eao_range);
  summarise(about.truths, tracker);
  return tracker;
}

TrackerPair compared(const ScoredTracker& a, const ScoredTracker& b) {
  TrackerPair comparison{a.name, b.name, 0, {}};
  std::vector<double> of_a;
  std::vector<double> of_b;
  for (const ScoredSequence& mine : a.sequences)
    for (const ScoredSequence& other : b.sequences)
      if (mine.truth == other.truth && mine.score && other.score) {
        of_a.push_back(*mine.score->auc);
        of_b.push_back(*other.score->auc);
      }
  comparison.sequences = std::ssize(of_a);
  comparison.auc = evaluation::paired(of_a, of_b);
  return comparison;
}

std::pair<int, int> range_of(const std::vector<TruthClip>& truths) {
  std::vector<std::int64_t> lengths;
  for (const TruthClip& truth : truths) lengths.push_back(std::ssize(truth.clip.frames));
  const std::int64_t longest =
      lengths.empty() ? 0 : *std::max_element(lengths.begin(), lengths.end());
  return evaluation::within_curves(evaluation::eao_range(lengths), longest);
}

// Takes the results away for sequences of which nothing was asked.
void leave_out_others(const fs::path& folder,
                      const std::vector<TruthClip>& truths,
                      const std::vector<sequences::Condition>& where,
                      std::vector<results::TrackerResults>& results) {
  bool any = false;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    if (!sequences::hold(where, truths[i].weather)) results[i] = {};
    any = any || !results[i].empty();
  }
  if (!any)
    throw Error("holds no result for any aircraft for which --where holds", {folder.string()});
}

// Where a curve ends before the range over which its mean is taken.
void warn_of_short_curves(const Assessment& assessment, const Warn& warn) {
  const int first = assessment.eao_range.first;
  const int end_of_range = assessment.eao_range.second;
  // `last`: the range's last index.
  const auto look_at = [&](const ScoredTracker& tracker,
                           const char* protocol,
                           const std::vector<double>& curve,
                           int last) {
    const int end = static_cast<int>(curve.size()) - 1;
    if (first <= std::min(end, last) && last <= end) return;
    airtruth::warn(
        warn,
        fmt::format("{}: the EAO curve of its {} runs ends at {}; of the range {} to {} {}",
                    tracker.name,
                    protocol,
                    end,
                    first,
                    last,
                    first <= end && first <= last ? "the part up to there counts"
                                                  : "nothing is there, so it has no EAO"));
  };
  for (const ScoredTracker& tracker : assessment.trackers) {
    if (tracker.restart) look_at(tracker, "restart", tracker.restart->eao_curve, end_of_range);
    if (tracker.multistart)
      look_at(tracker, "multistart", tracker.multistart->eao_curve, end_of_range - 1);
  }
}

// By name, each tracker's results for each truth.
using AllResults = std::map<std::string, std::vector<results::TrackerResults>>;

// Videos of sequences without results are not read.
void add_films(std::vector<TruthClip>& truths,
               const AllResults& found,
               const AssessOptions& options) {
  std::vector<std::size_t> wanted;
  for (std::size_t i = 0; i < truths.size(); ++i)
    if (std::ranges::any_of(found, [&](const auto& one) { return !one.second[i].empty(); }))
      wanted.push_back(i);
  const std::size_t each = std::clamp(
      kMaxStills / std::max<std::size_t>(1, wanted.size()), kMinStillsOfOne, kMaxStillsOfOne);
  in_parallel(wanted.size(), options, [&](std::size_t i) {
    add_film(truths[wanted[i]], each, options.stop);
  });
}

}  // namespace

Assessment assess(const fs::path& set,
                  const std::vector<fs::path>& results,
                  const AssessOptions& options) {
  Assessment assessment;
  assessment.set = report::name_of_results(set);
  assessment.until_loss = options.until_loss;
  for (const sequences::Condition& one : options.where) assessment.where.push_back(one.text);
  assessment.truths = truths_of(labelled::LabelledSet(set));
  assessment.eao_range = options.eao_range.value_or(range_of(assessment.truths));
  // Results are read first, so that their faults are reported before minutes of video are read.
  AllResults found;
  for (const fs::path& folder : results) {
    const std::string name = report::name_of_results(folder);
    if (found.contains(name))
      throw Error("is the second folder of results called '" + name + "'", {folder.string()});
    found[name] = results_in(folder, assessment.truths, options);
    leave_out_others(folder, assessment.truths, options.where, found[name]);
  }
  if (options.with_film) add_films(assessment.truths, found, options);
  for (const fs::path& folder : results) {
    const std::string name = report::name_of_results(folder);
    assessment.trackers.push_back(scored_tracker(assessment, name, found[name]));
  }
  warn_of_short_curves(assessment, options.warn);
  std::ranges::stable_sort(assessment.trackers, std::greater(), [](const ScoredTracker& one) {
    return one.overall ? one.overall->auc : std::nullopt;
  });
  for (std::size_t i = 0; i < assessment.trackers.size(); ++i)
    for (std::size_t j = i + 1; j < assessment.trackers.size(); ++j)
      if (assessment.trackers[i].overall && assessment.trackers[j].overall)
        assessment.comparisons.push_back(compared(assessment.trackers[i], assessment.trackers[j]));
  return assessment;
}

void check_evaluation(const fs::path& file) { agreement({}, file); }

Agreement agreement(const Assessment& assessment, const fs::path& other) {
  Agreement result;
  std::vector<double> mine;
  std::vector<double> theirs;
  const JsonDocument record(other);
  const std::vector<JsonObject> trackers = record.objects("trackers");
  for (const ScoredTracker& tracker : assessment.trackers)
    for (const JsonObject& that : trackers)
      if (tracker.overall && that.text("name") == tracker.name && that.has("overall")) {
        result.trackers.push_back(tracker.name);
        mine.push_back(*tracker.overall->auc);
        theirs.push_back(that.object("overall").number("auc"));
      }
  result.tau = evaluation::kendall_tau(mine, theirs);
  return result;
}

}  // namespace airtruth::tracker_evaluation
