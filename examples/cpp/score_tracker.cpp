// SPDX-License-Identifier: Apache-2.0
// Scores a tracker's boxes against a data set, as `airtruth evaluate` does. Needs
// airtruth::evaluation alone: no pictures are decoded.
//
//   score_tracker SET RESULTS       RESULTS/SEQUENCE.txt holds a line "x,y,width,height" a frame
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include <airtruth/dataset.h>
#include <airtruth/error.h>
#include <airtruth/metrics.h>

namespace {

// A tracker would fill this from its own output; "nan" means that it saw nothing.
std::vector<std::optional<airtruth::Box>> read_boxes(const std::filesystem::path& file) {
  std::ifstream text(file);
  if (!text) throw airtruth::Error("cannot be read", {file.string()});
  std::vector<std::optional<airtruth::Box>> boxes;
  for (std::string line; std::getline(text, line);) {
    airtruth::Box box;
    const bool is_box =
        std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf", &box.x, &box.y, &box.width, &box.height) ==
            4 &&
        box.width > 0 && box.height > 0;
    boxes.push_back(is_box ? std::optional(box) : std::nullopt);
  }
  return boxes;
}

// A measure that nothing defines prints as "nan".
double number(const std::optional<double>& measure) {
  return measure.value_or(std::numeric_limits<double>::quiet_NaN());
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) throw airtruth::Error("expected SET RESULTS");
  const airtruth::DataSet set(argv[1]);
  std::vector<airtruth::evaluation::Score> scores;
  for (const std::string& name : set.names()) {
    // A tracker follows one object: a sequence with two intruders becomes two clips.
    const auto labels = set.sequence(name).labels;
    for (const auto& clip : arranged(airtruth::exchange::Format::kOtb, labels)) {
      const auto answers = read_boxes(std::filesystem::path(argv[2]) / (clip.name + ".txt"));
      std::vector<airtruth::evaluation::FramePair> pairs;
      for (std::size_t i = 0; i < clip.frames.size(); ++i) {
        const auto& shown = clip.frames[i].labels;
        const auto truth = shown.empty() ? std::nullopt : std::optional(shown.front().box_px);
        pairs.push_back({truth, answers.at(i)});
      }
      scores.push_back(airtruth::evaluation::score(pairs, clip.width, clip.height));
      std::printf("%s: AUC %.17g, AO %.17g, centre %.17g px\n",
                  clip.name.c_str(),
                  number(scores.back().auc),
                  number(scores.back().average_overlap),
                  number(scores.back().centre_mean_px));
    }
  }
  const auto overall = airtruth::evaluation::mean_of(scores);
  std::printf("overall: AUC %.17g, AO %.17g, centre %.17g px\n",
              number(overall.auc),
              number(overall.average_overlap),
              number(overall.centre_mean_px));
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
