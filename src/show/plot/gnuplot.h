// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "foundation/base/names.h"
#include "foundation/image/picture.h"
#include "show/plot/plot.h"

// Draws plots as files with the program gnuplot.
namespace airtruth::plot {

enum class Legend {
  kNone,
  kAbove,   // in one line above each plot
  kBeside,  // to the right of the first plot, in one column however many names there are
};

// Plots on one page, row by row from the top left.
struct Sheet {
  std::vector<Plot> plots;
  int columns = 1;
  // The height of the page for a width of 16.
  double height = 9;
  Legend legend = Legend::kBeside;
};

// The format of a file.
enum class Format { kPng, kPdf, kSvg };
constexpr auto enum_names(Format) {
  return std::to_array<EnumName<Format>>(
      {{Format::kPng, "png"}, {Format::kPdf, "pdf"}, {Format::kSvg, "svg"}});
}

// Throws Error, which names `option`, if the program gnuplot cannot be found.
void check_gnuplot(const std::string& option);

// Writes folder/NAME.gnuplot and draws the file beside it. Throws Error if gnuplot fails.
void draw(const Sheet& sheet,
          const std::filesystem::path& folder,
          const std::string& name,
          Format format);

// The sheet as a picture, 1600 px wide. Throws Error if gnuplot fails.
image::Rgb8 picture_of(const Sheet& sheet);

}  // namespace airtruth::plot
