// SPDX-License-Identifier: Apache-2.0
#include "benchmark/experiment/figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include <fmt/format.h>
#include <sys/wait.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "picture/video/still.h"
#include "show/drawing/boxed.h"
#include "show/drawing/tiles.h"

namespace airtruth::experiment {
namespace {

using Colour = std::array<std::uint8_t, 3>;

// The colours of the page (show/html/assets/common.js): black is for the truth alone, and the first
// six are distinguishable with every kind of colour vision.
constexpr Colour kTruthColour = {0, 0, 0};
constexpr Colour kTruthOnPictures = {255, 255, 255};  // with a dark rim
constexpr std::array<Colour, 12> kColours = {{{0, 114, 178},
                                              {230, 159, 0},
                                              {213, 94, 0},
                                              {86, 180, 233},
                                              {170, 51, 119},
                                              {0, 158, 115},
                                              {93, 58, 155},
                                              {140, 86, 75},
                                              {127, 127, 127},
                                              {184, 176, 0},
                                              {244, 166, 200},
                                              {46, 78, 142}}};
constexpr std::size_t kFilmPictures = 6;
constexpr int kFilmColumns = 3;

const std::map<std::string, std::string>& terminals() {
  static const std::map<std::string, std::string> all = {
      {"png", "pngcairo size 1600,{} font 'sans,22' linewidth 2"},
      {"pdf", "pdfcairo size 16cm,{}cm font 'sans,11' linewidth 1.5"},
      {"svg", "svg size 800,{} font 'sans,12' linewidth 1.5"}};
  return all;
}

std::string hex(const Colour& c) { return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]); }
Colour colour_of(std::size_t tracker) { return kColours[tracker % kColours.size()]; }

// In gnuplot's plain quotes, which know nothing but themselves; line ends would end the command.
std::string plot_quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return result + "'";
}

std::string number(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{:.6g}", *value) : "NaN";
}

// A script: data blocks first, then what draws them.
class Plot {
 public:
  Plot(fs::path folder, std::string name, std::string format, double height)
      : folder_(std::move(folder)), name_(std::move(name)), format_(std::move(format)) {
    // Heights are given for a width of 16.
    const std::string size = format_ == "png"   ? fmt::format("{:.0f}", height * 100)
                             : format_ == "svg" ? fmt::format("{:.0f}", height * 50)
                                                : fmt::format("{:.1f}", height);
    head_ =
        "set terminal " + fmt::format(fmt::runtime(terminals().at(format_)), size) +
        " noenhanced\nset output " + plot_quoted((name_ + "." + format_)) +
        "\nset grid lc rgb '#dddddd'\nset border lc rgb '#555555'\n"
        // One column, beside the plot however many trackers there are.
        "set key at screen 0.99, screen 0.98 right top vertical maxrows 60 samplen 2 spacing 0.9\n"
        "set rmargin 26\n";
  }

  // Names the block.
  std::string data(const std::string& lines) {
    const std::string name = fmt::format("$d{}", blocks_++);
    data_ += name + " << EOD\n" + lines + "EOD\n";
    return name;
  }
  void command(const std::string& line) { commands_ += line + "\n"; }
  void plot(const std::vector<std::string>& parts) {
    commands_ += "plot ";
    for (std::size_t i = 0; i < parts.size(); ++i)
      commands_ += (i > 0 ? ", \\\n     " : "") + parts[i];
    commands_ += "\n";
  }

  void write() const {
    const fs::path script = folder_ / (name_ + ".gnuplot");
    write_file(script, head_ + data_ + commands_, Flush::kLater);
    FILE* run = ::popen("gnuplot - 2> /dev/null", "w");
    if (run == nullptr) throw Error("cannot start gnuplot");
    std::fprintf(run,
                 "cd %s\nload %s\n",
                 plot_quoted(folder_.string()).c_str(),
                 plot_quoted(script.filename().string()).c_str());
    const int status = ::pclose(run);
    if (status != 0)
      throw Error(fmt::format("gnuplot failed (status {}) on it", WEXITSTATUS(status)),
                  {script.string()});
  }

 private:
  fs::path folder_;
  std::string name_;
  std::string format_;
  std::string head_;
  std::string data_;
  std::string commands_;
  int blocks_ = 0;
};

std::string lines_style(const std::string& block,
                        const std::string& title,
                        const Colour& colour,
                        double width = 1,
                        int dash = 1) {
  return fmt::format("{} using 1:2 with lines lw {} dt {} lc rgb '{}' title {}",
                     block,
                     width,
                     dash,
                     hex(colour),
                     plot_quoted(title));
}

class Figures {
 public:
  Figures(const Assessment& assessment, fs::path folder, std::string format)
      : assessment_(assessment), folder_(std::move(folder)), format_(std::move(format)) {}

  void write() const {
    using evaluation::Score;
    curve("success", "overlap", 0.05, [](const Score& s) { return std::span(s.success); });
    curve(
        "precision", "centre error, px", 1, [](const Score& s) { return std::span(s.precision); });
    curve("normalised", "centre error over size", 0.01, [](const Score& s) {
      return std::span(s.normalised);
    });
    eao();
    ranking();
    bins("range_m", "range, m");
    bins("size_px", "box size (longer side), px");
    bins("contrast", "contrast, levels of 255");
    for (std::size_t i = 0; i < assessment_.truths.size(); ++i) {
      time_series(i);
      film(i);
    }
  }

 private:
  Plot begin(const std::string& name, double height = 9) const {
    return {folder_, name, format_, height};
  }

  void curve(const std::string& name, const std::string& x, double step, const auto& of) const {
    Plot plot = begin(name);
    std::vector<std::string> parts;
    for (std::size_t k = 0; k < assessment_.trackers.size(); ++k) {
      const ScoredTracker& tracker = assessment_.trackers[k];
      if (!tracker.overall) continue;
      std::string lines;
      const auto values = of(*tracker.overall);
      for (std::size_t j = 0; j < values.size(); ++j)
        lines += fmt::format("{:.6g} {:.6g}\n", static_cast<double>(j) * step, values[j]);
      parts.push_back(lines_style(plot.data(lines), tracker.name, colour_of(k)));
    }
    if (parts.empty()) return;
    plot.command("set yrange [0:1]\nset xlabel " + plot_quoted(x) +
                 "\nset ylabel 'share of frames'");
    plot.plot(parts);
    plot.write();
  }

  void eao() const {
    Plot plot = begin("eao");
    std::vector<std::string> parts;
    const auto add =
        [&](const std::vector<double>& curve, const std::string& title, std::size_t k, int dash) {
          std::string lines;
          for (std::size_t j = 1; j < curve.size(); ++j)
            lines += fmt::format("{} {:.6g}\n", j, curve[j]);
          if (!lines.empty())
            parts.push_back(lines_style(plot.data(lines), title, colour_of(k), 1, dash));
        };
    for (std::size_t k = 0; k < assessment_.trackers.size(); ++k) {
      const ScoredTracker& tracker = assessment_.trackers[k];
      if (tracker.restart) add(tracker.restart->eao_curve, tracker.name + ", restart", k, 1);
      if (tracker.multistart)
        add(tracker.multistart->eao_curve, tracker.name + ", multi-start", k, 2);
    }
    if (parts.empty()) return;
    plot.command("set yrange [0:1]\nset xlabel 'frames'\nset ylabel 'expected average overlap'");
    plot.plot(parts);
    plot.write();
  }

  // Mean AUC with its interval, the best on top.
  void ranking() const {
    std::string lines;
    std::string names;
    int count = 0;
    for (const ScoredTracker& tracker : assessment_.trackers) {
      if (!tracker.overall) continue;
      const double auc = tracker.overall->auc;
      const auto interval = tracker.intervals.at("auc").value_or(evaluation::Interval{auc, auc});
      lines += fmt::format("{:.6g} {} {:.6g} {:.6g}\n", auc, -count, interval.low, interval.high);
      names += fmt::format("{}{} {}", count > 0 ? ", " : "", plot_quoted(tracker.name), -count);
      ++count;
    }
    if (count == 0) return;
    Plot plot = begin("ranking", 2.5 + 0.7 * count);
    const std::string block = plot.data(lines);
    plot.command(fmt::format(
        "unset key\nset rmargin 4\nset ytics ({})\nset yrange [{}:0.7]\nset xrange [0:*]\n"
        "set xlabel 'AUC, with 95 % interval over sequences'",
        names,
        -count + 0.3));
    plot.plot({block + fmt::format(" using 1:2:3:4 with xerrorbars pt 7 ps 1 lc rgb '{}'",
                                   hex(kColours[0]))});
    plot.write();
  }

  void bins(const std::string& key, const std::string& x) const {
    Plot plot = begin(key);
    std::vector<std::string> parts;
    for (std::size_t k = 0; k < assessment_.trackers.size(); ++k) {
      const ScoredTracker& tracker = assessment_.trackers[k];
      const auto found = tracker.bins.find(key);
      if (found == tracker.bins.end() || found->second.empty()) continue;
      std::string lines;
      // The last bin has no end: it is drawn at its beginning.
      for (const evaluation::Bin& bin : found->second)
        lines += fmt::format("{:.6g} {:.6g}\n",
                             std::isfinite(bin.to) ? (bin.from + bin.to) / 2 : bin.from,
                             bin.overlap);
      parts.push_back(fmt::format("{} using 1:2 with linespoints pt 7 ps 0.6 lc rgb '{}' title {}",
                                  plot.data(lines),
                                  hex(colour_of(k)),
                                  plot_quoted(tracker.name)));
    }
    if (parts.empty()) return;
    plot.command("set yrange [0:*]\nset xlabel " + plot_quoted(x) + "\nset ylabel 'mean overlap'");
    plot.plot(parts);
    plot.write();
  }

  // Answers of a tracker on a sequence; nullptr where it was not run.
  const ScoredSequence* scored(std::size_t tracker, std::size_t truth) const {
    for (const ScoredSequence& sequence : assessment_.trackers[tracker].sequences)
      if (sequence.truth == truth && sequence.score) return &sequence;
    return nullptr;
  }

  void time_series(std::size_t index) const {
    const TruthClip& truth = assessment_.truths[index];
    Plot plot = begin("xy-" + truth.clip.name, 14);
    std::array<std::vector<std::string>, 3> parts;
    const auto add = [&](std::size_t part,
                         const std::string& title,
                         const Colour& colour,
                         double width,
                         const auto& value) {
      std::string lines;
      for (std::size_t i = 0; i < truth.clip.frames.size(); ++i)
        lines += fmt::format("{} {}\n", truth.clip.frames[i].frame, number(value(i)));
      parts[part].push_back(lines_style(plot.data(lines), title, colour, width));
    };
    const auto centre = [](const std::optional<Box>& box, bool is_x) -> std::optional<double> {
      if (!box) return std::nullopt;
      return is_x ? evaluation::centre_of(*box).x() : evaluation::centre_of(*box).y();
    };
    for (const std::size_t part : {0u, 1u})
      add(part, "truth", kTruthColour, 3, [&](std::size_t i) {
        return centre(truth.box(i), part == 0);
      });
    for (std::size_t k = 0; k < assessment_.trackers.size(); ++k) {
      const ScoredSequence* sequence = scored(k, index);
      if (sequence == nullptr) continue;
      const std::string& name = assessment_.trackers[k].name;
      for (const std::size_t part : {0u, 1u})
        add(part, name, colour_of(k), 1, [&](std::size_t i) {
          return centre(sequence->answers[i], part == 0);
        });
      add(2, name, colour_of(k), 1, [&](std::size_t i) -> std::optional<double> {
        if (!truth.box(i) || !sequence->answers[i]) return std::nullopt;
        return (evaluation::centre_of(*truth.box(i)) - evaluation::centre_of(*sequence->answers[i]))
            .norm();
      });
    }
    plot.command(
        fmt::format("set multiplot layout 3,1\nset lmargin 9\n"
                    "set xrange [{}:{}]",
                    truth.clip.frames.front().frame,
                    std::max(truth.clip.frames.back().frame, truth.clip.frames.front().frame + 1)));
    for (std::size_t part = 0; part < 3; ++part) {
      if (parts[part].empty()) continue;
      constexpr std::array<const char*, 3> kLabels = {"X, px", "Y, px", "error, px"};
      plot.command(fmt::format("set ylabel '{}'{}",
                               kLabels[part],
                               part == 2 ? "\nset xlabel 'frame'\nset yrange [0:*]" : ""));
      plot.plot(parts[part]);
      plot.command("unset key");
    }
    plot.command("unset multiplot");
    plot.write();
  }

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
        if (const ScoredSequence* sequence = scored(t, index))
          if (const auto& box = sequence->answers[still.index])
            boxes.push_back({*box, colour_of(t)});
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

void check_figures(const std::string& format) {
  if (!terminals().contains(format))
    throw Error("--figures is '" + format + "'; expected png, pdf or svg");
  if (std::system("command -v gnuplot > /dev/null 2>&1") != 0)
    throw Error("--figures needs the program gnuplot (Debian package gnuplot-nox)");
}

void write_figures(const Assessment& assessment, const fs::path& out, const std::string& format) {
  const fs::path folder = fs::absolute(out / "figures");
  fs::create_directories(folder);
  Figures(assessment, folder, format).write();
}

}  // namespace airtruth::experiment
