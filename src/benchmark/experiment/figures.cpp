// SPDX-License-Identifier: Apache-2.0
#include "benchmark/experiment/figures.h"

#include <algorithm>

#include <fmt/format.h>

#include "benchmark/experiment/evaluation_plots.h"
#include "foundation/base/error.h"
#include "picture/video/still.h"
#include "show/drawing/boxed.h"
#include "show/drawing/tiles.h"
#include "show/plot/gnuplot.h"

namespace airtruth::experiment {
namespace {

// Truth on pictures is white with a dark rim.
constexpr plot::Colour kTruthOnPictures = {255, 255, 255};
// Pictures of a sequence, spread over it, and how many of them stand side by side.
constexpr std::size_t kFilmPictures = 6;
constexpr int kFilmColumns = 3;
// Heights of figures for a width of 16: of one plot, of a sequence's three, and of the ranking.
constexpr double kPlotHeight = 9, kSequenceHeight = 14;
constexpr double kRankingHeight = 2.5, kRankingHeightOfOne = 0.7;

plot::Format format_named(const std::string& name) {
  if (name == "png") return plot::Format::kPng;
  if (name == "pdf") return plot::Format::kPdf;
  if (name == "svg") return plot::Format::kSvg;
  throw Error("--figures is '" + name + "'; expected png, pdf or svg");
}

// Pictures of a sequence with the boxes of truth and trackers.
void write_film(const Assessment& assessment, std::size_t index, const fs::path& folder) {
  const TruthClip& truth = assessment.truths[index];
  if (truth.stills.empty()) return;
  std::vector<drawing::NamedPicture> pictures;
  const std::size_t count = std::min(kFilmPictures, truth.stills.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t at = count > 1 ? k * (truth.stills.size() - 1) / (count - 1) : 0;
    const TruthClip::Still& still = truth.stills[at];
    std::vector<drawing::ColouredBox> boxes;
    if (const auto box = truth.box(still.index)) boxes.push_back({*box, kTruthOnPictures});
    for (std::size_t t = 0; t < assessment.trackers.size(); ++t)
      if (const ScoredSequence* sequence = scored_sequence(assessment, t, index))
        if (const auto& box = sequence->answers[still.index])
          boxes.push_back({*box, plot::style_of(t).colour});
    const double scale =
        std::min(1.0, static_cast<double>(TruthClip::kWholeWidth) / std::max(1, still.width));
    pictures.push_back({fmt::format("frame {}", truth.clip.frames[still.index].frame),
                        drawing::boxed(still.whole, scale, boxes)});
  }
  video::write_still(folder / ("frames-" + truth.clip.name + ".png"),
                     drawing::tiled(truth.clip.name, std::move(pictures), kFilmColumns));
}

}  // namespace

void check_figures(const std::string& format) {
  format_named(format);
  plot::check_gnuplot("--figures");
}

void write_figures(const Assessment& assessment, const fs::path& out, const std::string& format) {
  const fs::path folder = fs::absolute(out / "figures");
  fs::create_directories(folder);
  const plot::Format file = format_named(format);
  for (const auto& [name, plot] : evaluation_plots(assessment))
    plot::draw({.plots = {plot}, .height = kPlotHeight}, folder, name, file);
  const plot::Plot ranking = ranking_plot(assessment);
  if (!ranking.series.empty())
    plot::draw({.plots = {ranking},
                .height = kRankingHeight +
                          kRankingHeightOfOne * static_cast<double>(ranking.y.names.size()),
                .legend = plot::Legend::kNone},
               folder,
               "ranking",
               file);
  for (std::size_t i = 0; i < assessment.truths.size(); ++i) {
    plot::draw({.plots = sequence_plots(assessment, i), .height = kSequenceHeight},
               folder,
               "xy-" + assessment.truths[i].clip.name,
               file);
    write_film(assessment, i, folder);
  }
}

}  // namespace airtruth::experiment
