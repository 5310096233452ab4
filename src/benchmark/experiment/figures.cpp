// SPDX-License-Identifier: Apache-2.0
#include "benchmark/experiment/figures.h"

#include <algorithm>

#include <fmt/format.h>

#include "benchmark/experiment/evaluation_plots.h"
#include "picture/video/still.h"
#include "show/drawing/boxed.h"
#include "show/drawing/tiles.h"
#include "show/plot/plot.h"
#include "show/plot/style.h"

namespace airtruth::experiment {
namespace {

constexpr plot::Colour kTruthOnPictures = {255, 255, 255};  // with a dark rim
constexpr std::size_t kFilmPictures = 6;
constexpr int kFilmColumns = 3;
// For a width of 16 (plot::gnuplot_script).
constexpr double kHeight = 9;
constexpr double kPanelsHeight = 14;

class Figures {
 public:
  Figures(const Assessment& assessment, fs::path folder, std::string format)
      : assessment_(assessment), folder_(std::move(folder)), format_(std::move(format)) {}

  void write() const {
    for (const auto& [name, plot] : evaluation_plots(assessment_))
      plot::draw({plot}, folder_, name, format_, kHeight);
    if (const auto plot = ranking_plot(assessment_))
      plot::draw({*plot},
                 folder_,
                 "ranking",
                 format_,
                 2.5 + 0.7 * static_cast<double>(plot->y.names.size()));
    for (std::size_t i = 0; i < assessment_.truths.size(); ++i) {
      plot::draw(sequence_plots(assessment_, i),
                 folder_,
                 "xy-" + assessment_.truths[i].clip.name,
                 format_,
                 kPanelsHeight);
      film(i);
    }
  }

 private:
  void film(std::size_t index) const {
    const TruthClip& truth = assessment_.truths[index];
    if (truth.stills.empty()) return;
    std::vector<drawing::NamedPicture> pictures;
    const std::size_t count = std::min(kFilmPictures, truth.stills.size());
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t at = count > 1 ? k * (truth.stills.size() - 1) / (count - 1) : 0;
      const TruthClip::Still& still = truth.stills[at];
      std::vector<drawing::ColouredBox> boxes;
      if (const auto box = truth.box(still.index)) boxes.push_back({*box, kTruthOnPictures});
      for (std::size_t t = 0; t < assessment_.trackers.size(); ++t)
        if (const ScoredSequence* sequence = scored(assessment_, t, index))
          if (const auto& box = sequence->answers[still.index])
            boxes.push_back({*box, plot::colour_of(t)});
      const double scale =
          std::min(1.0, static_cast<double>(TruthClip::kWholeWidth) / std::max(1, still.width));
      pictures.push_back({fmt::format("frame {}", truth.clip.frames[still.index].frame),
                          drawing::boxed(still.whole, scale, boxes)});
    }
    video::write_still(folder_ / ("frames-" + truth.clip.name + ".png"),
                       drawing::tiled(truth.clip.name, std::move(pictures), kFilmColumns));
  }

  const Assessment& assessment_;
  fs::path folder_;
  std::string format_;
};

}  // namespace

void write_figures(const Assessment& assessment, const fs::path& out, const std::string& format) {
  const fs::path folder = fs::absolute(out / "figures");
  fs::create_directories(folder);
  Figures(assessment, folder, format).write();
}

}  // namespace airtruth::experiment
