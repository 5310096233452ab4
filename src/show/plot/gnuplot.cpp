// SPDX-License-Identifier: Apache-2.0
#include "show/plot/gnuplot.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include <fmt/format.h>
#include <sys/wait.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"
#include "foundation/run_files/memory_place.h"
#include "picture/video/still.h"

namespace airtruth::plot {
namespace {

// Text in gnuplot's single quotes. A line end would end the command, and a quote the text: gnuplot
// 5.4 does not read a doubled quote at its beginning. A typographic apostrophe stands for it.
std::string quoted(const std::string& text, const char* apostrophe = "\u2019") {
  std::string result = "'";
  for (const char c : text)
    if (c == '\'')
      result += apostrophe;
    else
      result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  return result + "'";
}

// A path, or a file name that this project chooses, in gnuplot's single quotes. It does not begin
// with a quote, so that quotes can be doubled. gnuplot does not find a path with a line end.
std::string quoted_path(const std::string& path) { return quoted(path, "''"); }

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "NaN";
}

// Letters are smaller where several plots share the page.
std::string terminal(Format format, double height, bool is_shared) {
  switch (format) {
    case Format::kPng:
      return fmt::format("pngcairo size 1600,{:.0f} font 'sans,{}' linewidth 2",
                         100 * height,
                         is_shared ? 16 : 22);
    case Format::kPdf:
      return fmt::format("pdfcairo size 16cm,{:.1f}cm font 'sans,11' linewidth 1.5", height);
    case Format::kSvg:
      return fmt::format("svg size 800,{:.0f} font 'sans,12' linewidth 1.5", 50 * height);
  }
  return {};
}

// The file of the picture in place of a plot.
std::string picture_file(const std::string& name, std::size_t plot) {
  return fmt::format("{}-{}.png", name, plot);
}

bool has_data(const Plot& plot) {
  return std::ranges::any_of(plot.series, [](const Series& series) {
    return std::ranges::any_of(series.y, [](double y) { return std::isfinite(y); });
  });
}

// The range of an axis; places with names have a margin of half a place. gnuplot finds no range of
// its own without data, so an axis without them goes from 0 to 1.
std::string range_of(const char* axis, const Axis& a, bool has_data) {
  if (!a.names.empty())
    return fmt::format("set {}range [-0.5:{}]\n", axis, double(a.names.size()) - 0.5);
  const auto end = [&](const std::optional<double>& given, const char* otherwise) {
    return given ? number(*given) : has_data ? "*" : otherwise;
  };
  return fmt::format("set {}range [{}:{}]\n", axis, end(a.min, "0"), end(a.max, "1"));
}

std::string scale_of(const char* axis, const Axis& a) {
  return fmt::format("{} logscale {}\n", a.is_logarithmic ? "set" : "unset", axis);
}

// The label of a tic is a format of its number.
std::string quoted_label(const std::string& name) {
  std::string label;
  for (const char c : quoted(name)) label += c == '%' ? "%%" : std::string(1, c);
  return label;
}

std::string tics_of(const char* axis, const Axis& a) {
  if (a.names.empty()) return fmt::format("set {}tics auto norotate\n", axis);
  std::string places;
  for (std::size_t i = 0; i < a.names.size(); ++i)
    places += fmt::format("{}{} {}", i > 0 ? ", " : "", quoted_label(a.names[i]), i);
  // The plot holds some 60 letters in a row, gaps included.
  constexpr std::size_t kMostLetters = 60;
  std::size_t longest = 0;
  for (const std::string& name : a.names) longest = std::max(longest, name.size());
  const bool is_crowded = *axis == 'x' && a.names.size() * (longest + 1) > kMostLetters;
  return fmt::format("set {}tics {} ({})\n", axis, is_crowded ? "rotate" : "norotate", places);
}

// Of dots and rings, in gnuplot's units.
constexpr double kDotSize = 1.2;

std::string hex(const Colour& c) { return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]); }

// A band about a line.
bool has_band(const Series& series) {
  return !series.low.empty() && (series.mark == Mark::kLine || series.mark == Mark::kLineAndPoints);
}

// Several such series stand side by side.
bool is_beside_others(const Series& series) {
  return series.mark == Mark::kBars || series.mark == Mark::kDots;
}

bool has_whiskers(const Series& series) { return !series.low.empty() && is_beside_others(series); }

// Whiskers are grey on bars, and in the colour of dots.
std::string whiskers_of(const Series& series) {
  // gnuplot's yerrorbars have a white gap in the middle.
  return fmt::format(
      "using 1:3:(0):($4-$3) with vectors heads size graph 0.006,90 lw 1 lc rgb '{}'",
      series.mark == Mark::kDots ? hex(series.style.colour) : "#333333");
}

// The part of a plot command after the data, which have the columns x, y, low and high.
std::string drawn_as(const Series& series) {
  const std::string colour = fmt::format("lc rgb '{}'", hex(series.style.colour));
  const int dash = series.style.dash == Dash::kSolid ? 1 : series.style.dash == Dash::kLong ? 2 : 3;
  const std::string line = fmt::format("lw {} dt {} {}", series.style.width, dash, colour);
  switch (series.mark) {
    case Mark::kLine:
      return "using 1:2 with lines " + line;
    case Mark::kPoints:
      return "using 1:2 with points pt 7 ps 0.8 " + colour;
    case Mark::kLineAndPoints:
      return "using 1:2 with linespoints pt 7 ps 0.6 " + line;
    case Mark::kBars:
      return "using 1:2 with boxes " + colour;
    case Mark::kDots:
      return fmt::format(
          "using 1:2 with points pt {} ps {} {}", series.is_hollow ? 6 : 7, kDotSize, colour);
    case Mark::kIntervals:
      return "using 1:2:3:4 with xerrorbars pt 7 ps 1 " + colour;
    case Mark::kAbove:
      return "using 1:2 with points pt 9 ps 1 " + colour;
    case Mark::kBelow:
      return "using 1:2 with points pt 11 ps 1 " + colour;
  }
  return {};
}

// Bars and dots of several series stand side by side, each of this width.
double bar_width(const Plot& plot) {
  const auto bars = std::ranges::count_if(plot.series, is_beside_others);
  return 0.8 / static_cast<double>(std::max<std::ptrdiff_t>(1, bars));
}

// A script in two parts: the data blocks, and the commands that draw them.
class Script {
 public:
  void add_plot(const Plot& plot, bool has_legend, const std::string& picture) {
    if (plot.picture) return add_picture(plot, picture);
    commands_ += "set title " + quoted(plot.title) + "\nset xlabel " + quoted(plot.x.label) +
                 "\nset ylabel " + quoted(plot.y.label) + "\n";
    commands_ += scale_of("x", plot.x) + scale_of("y", plot.y);
    commands_ += range_of("x", plot.x, has_data(plot)) + range_of("y", plot.y, has_data(plot));
    commands_ += tics_of("x", plot.x) + tics_of("y", plot.y);
    commands_ += has_legend ? "set key\n" : "unset key\n";
    add_bands(plot);
    const double width = bar_width(plot);
    commands_ += fmt::format("set boxwidth {}\n", width);
    std::string parts;
    double bar = -0.4 + width / 2;
    for (const Series& series : plot.series) {
      const double shift = is_beside_others(series) ? bar : 0;
      if (is_beside_others(series)) bar += width;
      const std::string block = block_of(series, shift);
      const auto add = [&](const std::string& how, const std::string& title) {
        parts += fmt::format("{}{} {} {}", parts.empty() ? "" : ", \\\n     ", block, how, title);
      };
      if (has_band(series))
        add(fmt::format("using 1:3:4 with filledcurves fs transparent solid 0.15 noborder fc rgb "
                        "'{}'",
                        hex(series.style.colour)),
            "notitle");
      // Whiskers lie on bars and below dots.
      if (has_whiskers(series) && series.mark == Mark::kDots) add(whiskers_of(series), "notitle");
      // White below a ring, so that its whisker does not cross it.
      if (series.is_hollow)
        add(fmt::format("using 1:2 with points pt 7 ps {} lc rgb '#ffffff'", kDotSize), "notitle");
      add(drawn_as(series), series.name.empty() ? "notitle" : "title " + quoted(series.name));
      if (has_whiskers(series) && series.mark == Mark::kBars) add(whiskers_of(series), "notitle");
    }
    // Axes without data are drawn too.
    commands_ += "plot " + (parts.empty() ? "NaN notitle" : parts) + "\nunset object\n";
  }

  std::string text() const { return data_ + commands_; }
  void command(const std::string& line) { commands_ += line + "\n"; }

 private:
  // Adds the data of a series and returns the name of their block.
  std::string block_of(const Series& series, double shift) {
    const std::string name = fmt::format("$d{}", blocks_++);
    data_ += name + " << EOD\n";
    for (std::size_t i = 0; i < series.x.size(); ++i) {
      data_ += number(series.x[i] + shift) + " " + number(series.y[i]);
      if (!series.low.empty()) data_ += " " + number(series.low[i]) + " " + number(series.high[i]);
      data_ += "\n";
    }
    if (series.x.empty()) data_ += "NaN NaN NaN NaN\n";
    data_ += "EOD\n";
    return name;
  }

  void add_bands(const Plot& plot) {
    int object = 1;
    for (const Band& band : plot.bands)
      commands_ += fmt::format(
          "set object {} rectangle from {}, graph 0 to {}, graph 1 fc rgb '{}' fs solid noborder "
          "behind\n",
          object++,
          number(band.from),
          number(band.to),
          hex(band.colour));
  }

  void add_picture(const Plot& plot, const std::string& picture) {
    commands_ += "set title " + quoted(plot.title) +
                 "\nunset key\nunset xlabel\nunset ylabel\nunset xtics\nunset ytics\nunset border\n"
                 "set xrange [*:*] noextend\nset yrange [*:*] noextend\nset size ratio -1\nplot " +
                 quoted_path(picture) +
                 " binary filetype=png with rgbimage\nset size noratio\nset border\n";
  }

  std::string data_, commands_;
  int blocks_ = 0;
};

// Runs the script, with `folder` as the working directory.
void run(const fs::path& folder, const fs::path& script) {
  FILE* gnuplot = ::popen("gnuplot - 2> /dev/null", "w");
  if (gnuplot == nullptr) throw Error("cannot start gnuplot");
  std::fprintf(gnuplot,
               "cd %s\nload %s\n",
               quoted_path(folder.string()).c_str(),
               quoted_path(script.filename().string()).c_str());
  const int status = ::pclose(gnuplot);
  if (status != 0)
    throw Error(fmt::format("gnuplot failed (status {}) on it", WEXITSTATUS(status)),
                {script.string()});
}

// How a whole file of the format ends, but for line ends.
std::string_view end_of(Format format) {
  switch (format) {
    case Format::kPng:
      return "IEND\xae\x42\x60\x82";
    case Format::kPdf:
      return "%%EOF";
    case Format::kSvg:
      return "</svg>";
  }
  return {};
}

// Room for the longest name of the legend and the mark beside it, in letters. Longer names than the
// most lie over the plot.
std::size_t legend_letters(const Sheet& sheet) {
  constexpr std::size_t kMark = 4;
  constexpr std::size_t kLeast = 26;
  constexpr std::size_t kMost = 50;
  std::size_t longest = 0;
  if (!sheet.plots.empty())
    for (const Series& series : sheet.plots.front().series)
      longest = std::max(longest, series.name.size());
  return std::clamp(longest + kMark, kLeast, kMost);
}

// The script that draws the sheet as NAME.png, NAME.pdf or NAME.svg. It contains all data but
// pictures, which it reads from NAME-0.png, NAME-1.png and so on.
std::string gnuplot_script(const Sheet& sheet, Format format, const std::string& name) {
  Script script;
  script.command("set terminal " + terminal(format, sheet.height, sheet.plots.size() > 1) +
                 " noenhanced");
  script.command("set output " + quoted_path(name + "." + enum_name(format)));
  script.command("set grid lc rgb '#dddddd'\nset border lc rgb '#555555'\nset style fill solid");
  if (sheet.legend == Legend::kBeside)
    script.command(
        "set key at screen 0.99, screen 0.98 right top vertical maxrows 60 samplen 2 spacing 0.9\n"
        "set rmargin " +
        std::to_string(legend_letters(sheet)));
  if (sheet.legend == Legend::kAbove)
    script.command("set key outside above center horizontal samplen 2");
  const auto rows = (static_cast<int>(sheet.plots.size()) + sheet.columns - 1) / sheet.columns;
  const bool is_multiple = sheet.plots.size() > 1;
  if (is_multiple)
    script.command(fmt::format("set multiplot layout {},{}\nset lmargin 11", rows, sheet.columns));
  for (std::size_t i = 0; i < sheet.plots.size(); ++i)
    script.add_plot(sheet.plots[i],
                    sheet.legend == Legend::kAbove || (sheet.legend == Legend::kBeside && i == 0),
                    picture_file(name, i));
  if (is_multiple) script.command("unset multiplot");
  return script.text();
}

}  // namespace

void check_gnuplot(const std::string& option) {
  if (std::system("command -v gnuplot > /dev/null 2>&1") != 0)
    throw Error(option + " needs the program gnuplot (Debian package gnuplot-nox)");
}

void draw(const Sheet& sheet, const fs::path& folder, const std::string& name, Format format) {
  const fs::path script = folder / (name + ".gnuplot");
  write_file(script, gnuplot_script(sheet, format, name), Flush::kLater);
  for (std::size_t i = 0; i < sheet.plots.size(); ++i)
    if (const image::Rgb8* picture = sheet.plots[i].picture)
      video::write_still(folder / picture_file(name, i), *picture, Flush::kLater);
  run(folder, script);
  // gnuplot says nothing of a full disk.
  const fs::path file = folder / (name + "." + enum_name(format));
  if (!fs::exists(file) || !trimmed(read_file(file)).ends_with(end_of(format)))
    throw Error("cannot be written: is the disk full?", {file.string()});
}

image::Rgb8 picture_of(const Sheet& sheet) {
  const MemoryPlace folder(PlaceKind::kFolder, "a plot's files");
  draw(sheet, folder.path(), "plot", Format::kPng);
  return video::read_still(folder.path() / "plot.png");
}

}  // namespace airtruth::plot
