// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include <fmt/format.h>
#include <sys/wait.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "show/plot/plot.h"
#include "show/plot/style.h"

namespace airtruth::plot {
namespace {

namespace fs = std::filesystem;

constexpr double kBarsWidth = 0.8;  // of all bars at one name, where the names are 1 apart

// The size of the terminal in its own unit, for a height on a width of 16.
struct Terminal {
  std::string text;
  double per_height;
};
const std::map<std::string, Terminal>& terminals() {
  static const std::map<std::string, Terminal> all = {
      {"png", {"pngcairo size 1600,{:.0f} font 'sans,22' linewidth 2", 100}},
      {"pdf", {"pdfcairo size 16cm,{:.1f}cm font 'sans,11' linewidth 1.5", 1}},
      {"svg", {"svg size 800,{:.0f} font 'sans,12' linewidth 1.5", 50}}};
  return all;
}

// In gnuplot's plain quotes, within which only the quote itself is special; a line end would end
// the command.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return result + "'";
}

std::string number(double value) {
  return std::isfinite(value) ? fmt::format("{:.6g}", value) : "NaN";
}

std::string head(const std::vector<Plot>& panels,
                 const std::string& name,
                 const std::string& format,
                 double height) {
  const Terminal& terminal = terminals().at(format);
  const bool legend =
      std::any_of(panels.begin(), panels.end(), [](const Plot& plot) { return plot.legend; });
  return "set encoding utf8\nset terminal " +
         fmt::format(fmt::runtime(terminal.text), height * terminal.per_height) +
         " noenhanced\nset output " + quoted(name + "." + format) +
         "\nset grid lc rgb '#dddddd'\nset border lc rgb '#555555'\n"
         // One column, beside the plot however many series there are.
         "set key at screen 0.99, screen 0.98 right top vertical maxrows 60 samplen 2 spacing "
         "0.9\n" +
         fmt::format("set rmargin {}\n", legend ? 26 : 4) +
         (panels.size() > 1 ? "set lmargin 9\n" : "");
}

std::string axis_commands(const char* axis, const Axis& is) {
  const double margin = axis[0] == 'x' ? 0.5 : 0.7;
  const auto limit = [](const std::optional<double>& value) {
    return value ? number(*value) : std::string("*");
  };
  std::string text = fmt::format("set {}label {}\n", axis, quoted(is.label));
  if (is.names.empty())
    return text + fmt::format("set {}range [{}:{}]\n", axis, limit(is.low), limit(is.high));
  text += fmt::format("set {}tics (", axis);
  for (std::size_t k = 0; k < is.names.size(); ++k)
    text += fmt::format("{}{} {}", k > 0 ? ", " : "", quoted(is.names[k]), k);
  text += axis[0] == 'x' ? ") rotate by 30 right\n" : ")\n";
  return text + fmt::format("set {}range [{}:{}]\n",
                            axis,
                            -margin,
                            static_cast<double>(is.names.size()) - 1 + margin);
}

// Lines "x y" or "x y x_low x_high". Bars stand beside each other: `shift` is theirs.
std::string data_lines(const Series& series, double shift) {
  std::string lines;
  for (std::size_t i = 0; i < series.x.size(); ++i) {
    lines += number(series.x[i] + shift) + " " + number(series.y[i]);
    if (!series.x_low.empty())
      lines += " " + number(series.x_low[i]) + " " + number(series.x_high[i]);
    lines += "\n";
  }
  return lines;
}

std::string drawn_as(const Series& series) {
  const Dash dash = kDashes.at(series.dash);
  const std::string line =
      fmt::format("lw {} dt {}",
                  series.width,
                  dash.on > 0 ? fmt::format("({},{})", dash.on, dash.off) : std::string("solid"));
  const std::string colour =
      fmt::format(" lc rgb '{}'", hex(series.colour ? colour_of(*series.colour) : kTruthColour));
  switch (series.kind) {
    case Kind::kLine:
      return "using 1:2 with lines " + line + colour;
    case Kind::kLineWithPoints:
      return "using 1:2 with linespoints pt 7 ps 0.6 " + line + colour;
    case Kind::kBars:
      return "using 1:2 with boxes fs solid" + colour;
    case Kind::kPoints:
      break;
  }
  return (series.x_low.empty() ? "using 1:2 with points pt 7 ps 1"
                               : "using 1:2:3:4 with xerrorbars pt 7 ps 1") +
         colour;
}

// Data blocks, then the commands that draw them.
std::string panel_text(const Plot& plot, std::size_t panel) {
  const auto bars = static_cast<double>(
      std::count_if(plot.series.begin(), plot.series.end(), [](const Series& s) {
        return s.kind == Kind::kBars;
      }));
  std::string data;
  std::string parts;
  double bar = 0;
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const Series& series = plot.series[k];
    double shift = 0;
    if (series.kind == Kind::kBars) shift = (bar++ - (bars - 1) / 2) * kBarsWidth / bars;
    const std::string block = fmt::format("$d{}_{}", panel, k);
    data += block + " << EOD\n" + data_lines(series, shift) + "EOD\n";
    parts += fmt::format("{}{} {} title {}",
                         k > 0 ? ", \\\n     " : "",
                         block,
                         drawn_as(series),
                         quoted(series.name));
  }
  return data + axis_commands("x", plot.x) + axis_commands("y", plot.y) +
         (bars > 0 ? fmt::format("set boxwidth {:.4g}\n", kBarsWidth / bars) : "") +
         (plot.legend ? "" : "unset key\n") + "plot " + parts + "\n";
}

}  // namespace

void check_gnuplot(const std::string& format) {
  if (!terminals().contains(format))
    throw Error("--figures is '" + format + "'; expected png, pdf or svg");
  if (std::system("command -v gnuplot > /dev/null 2>&1") != 0)
    throw Error("--figures needs the program gnuplot (Debian package gnuplot-nox)");
}

std::string gnuplot_script(const std::vector<Plot>& panels,
                           const std::string& name,
                           const std::string& format,
                           double height) {
  std::string script = head(panels, name, format, height);
  if (panels.size() > 1) script += fmt::format("set multiplot layout {},1\n", panels.size());
  for (std::size_t k = 0; k < panels.size(); ++k) script += panel_text(panels[k], k);
  if (panels.size() > 1) script += "unset multiplot\n";
  return script;
}

void draw(const std::vector<Plot>& panels,
          const fs::path& folder,
          const std::string& name,
          const std::string& format,
          double height) {
  const fs::path script = folder / (name + ".gnuplot");
  write_file(script, gnuplot_script(panels, name, format, height), Flush::kLater);
  FILE* run = ::popen("gnuplot - 2> /dev/null", "w");
  if (run == nullptr) throw Error("cannot start gnuplot");
  std::fprintf(run,
               "cd %s\nload %s\n",
               quoted(fs::absolute(folder).string()).c_str(),
               quoted(script.filename().string()).c_str());
  const int status = ::pclose(run);
  if (status != 0)
    throw Error(fmt::format("gnuplot failed (status {}) on it", WEXITSTATUS(status)),
                {script.string()});
}

}  // namespace airtruth::plot
