// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "benchmark/judge/judge.h"

// The verdict as Markdown tables and as JSON.
namespace airtruth::judge {
namespace {

nlohmann::ordered_json json_of_interval(const Interval& interval) {
  return {{"value", interval.value}, {"low", interval.low}, {"high", interval.high}};
}

std::string text_of(const Interval& interval) {
  return fmt::format("{:.3f} ({:.3f} to {:.3f})", interval.value, interval.low, interval.high);
}

std::string table_of_clips(const Verdict& v) {
  std::string text =
      "| clip | pairs | from other clips, not folded | within, folded |\n|---|---:|---:|---:|\n";
  for (const Verdict::Clip& clip : v.clips)
    text += fmt::format(
        "| {} | {} | {:.3f} | {:.3f} |\n", clip.name, clip.pairs, clip.across, clip.within);
  text += "\n| what alone tells | folded area |\n|---|---:|\n";
  for (std::size_t i = 0; i < std::min<std::size_t>(6, v.telling.size()); ++i)
    text += fmt::format("| {} | {:.3f} |\n", v.telling[i].first, v.telling[i].second);
  return text;
}

std::string table_of_gaps(const std::vector<Gap>& gaps) {
  std::string text =
      "\n| medians over clips | clips | real | inserted | inserted - real (95 %) |\n"
      "|---|---:|---:|---:|---|\n";
  for (const Gap& gap : gaps) {
    if (gap.clips == 0) continue;
    text += fmt::format("| {} | {} | {:.3g} | {:.3g} | {:+.3g} ({:+.3g} to {:+.3g}) |\n",
                        gap.name,
                        gap.clips,
                        gap.real,
                        gap.made,
                        gap.difference.value,
                        gap.difference.low,
                        gap.difference.high);
  }
  return text;
}

}  // namespace

std::string text_of(const Verdict& v) {
  std::string text = fmt::format(
      "folded area under the curve, mean of max(A, 1 - A) over {} clips; 0.5 is chance\n"
      "| | mean (95 % interval over clips) |\n|---|---|\n"
      "| trained on the other clips | {} |\n| trained and asked within each clip | {} |\n\n",
      v.clips.size(),
      text_of(v.across),
      text_of(v.within));
  if (v.by_chance)
    text += fmt::format(
        "With the names of the two aircraft drawn for each clip, the mean trained on the other "
        "clips "
        "is {:.3f} ({:.3f} to {:.3f}; {} draws, {} as high as the one found).\n\n",
        v.by_chance->mean,
        v.by_chance->least,
        v.by_chance->most,
        v.by_chance->draws,
        v.by_chance->as_high);
  return text + table_of_clips(v) + table_of_gaps(v.gaps);
}

std::string json_of(const Verdict& v) {
  nlohmann::ordered_json json;
  json["across"] = json_of_interval(v.across);
  json["within"] = json_of_interval(v.within);
  if (v.by_chance)
    json["by_chance"] = {{"draws", v.by_chance->draws},
                         {"mean", v.by_chance->mean},
                         {"least", v.by_chance->least},
                         {"most", v.by_chance->most},
                         {"as_high", v.by_chance->as_high}};
  for (const Verdict::Clip& clip : v.clips)
    json["clips"].push_back({{"name", clip.name},
                             {"pairs", clip.pairs},
                             {"across", clip.across},
                             {"within", clip.within}});
  for (const auto& [name, area] : v.telling)
    json["telling"].push_back({{"name", name}, {"area", area}});
  for (const Gap& gap : v.gaps)
    json["gaps"].push_back({{"name", gap.name},
                            {"clips", gap.clips},
                            {"real", gap.real},
                            {"inserted", gap.made},
                            {"difference", json_of_interval(gap.difference)}});
  return json.dump(1) + "\n";
}

}  // namespace airtruth::judge
