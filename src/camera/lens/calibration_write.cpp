// SPDX-License-Identifier: Apache-2.0
#include "camera/lens/calibration_write.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace airtruth::lens {
namespace {

struct Numbers {
  Pixel focal_px;
  Pixel principal_point_px;
  std::vector<double> distortion;
};

Numbers numbers_of(const Lens& lens) {
  return std::visit(
      [](const auto& model) {
        Numbers numbers{model.focal_px, model.principal_point_px, {}};
        if constexpr (requires { model.distortion; }) numbers.distortion = model.distortion;
        return numbers;
      },
      lens.model());
}

// Writes 1 as "1.0", because YAML and TOML distinguish whole numbers from other numbers.
std::string text_of(double value) {
  const std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}

std::string list_of(const std::vector<double>& values) {
  std::vector<std::string> texts;
  for (const double value : values) texts.push_back(text_of(value));
  return fmt::format("{}", fmt::join(texts, ", "));
}

std::string matrix_of(int rows, int columns, const std::vector<double>& values) {
  return fmt::format("!!opencv-matrix\n   rows: {}\n   cols: {}\n   dt: d\n   data: [ {} ]\n",
                     rows,
                     columns,
                     list_of(values));
}

}  // namespace

Lens cropped(const Lens& lens, ImageSize size) {
  const ImageSize from = lens.size();
  const double scale = std::max(static_cast<double>(size.width) / from.width,
                                static_cast<double>(size.height) / from.height);
  const Pixel middle(from.width / 2.0, from.height / 2.0);
  const Pixel new_middle(size.width / 2.0, size.height / 2.0);
  Model model = lens.model();
  std::visit(
      [&](auto& m) {
        m.focal_px *= scale;
        m.principal_point_px = new_middle + scale * (m.principal_point_px - middle);
      },
      model);
  return Lens(model, size);
}

std::string opencv_calibration(const Lens& lens, const std::string& note) {
  const Numbers n = numbers_of(lens);
  std::vector<double> distortion = n.distortion;
  if (distortion.empty()) distortion.assign(4, 0.0);
  const bool fisheye = std::holds_alternative<Fisheye>(lens.model());
  std::string line = note;
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  // OpenCV's (0, 0) is the centre of the first pixel; airtruth's is its corner.
  const std::vector<double> matrix = {n.focal_px.x(),
                                      0,
                                      n.principal_point_px.x() - 0.5,
                                      0,
                                      n.focal_px.y(),
                                      n.principal_point_px.y() - 0.5,
                                      0,
                                      0,
                                      1};
  return fmt::format(
      "%YAML:1.0\n---\n# {}\nimage_width: {}\nimage_height: {}\nfisheye_model: "
      "{}\ncamera_matrix: {}distortion_coefficients: {}",
      line,
      lens.size().width,
      lens.size().height,
      fisheye ? 1 : 0,
      matrix_of(3, 3, matrix),
      matrix_of(static_cast<int>(distortion.size()), 1, distortion));
}

std::string scene_table(const Lens& lens) {
  const Numbers n = numbers_of(lens);
  std::string text =
      fmt::format("[lens]\nmodel = \"{}\"\nfocal_px = [{}]\nprincipal_point_px = [{}]\n",
                  lens.name(),
                  list_of({n.focal_px.x(), n.focal_px.y()}),
                  list_of({n.principal_point_px.x(), n.principal_point_px.y()}));
  const bool any =
      std::any_of(n.distortion.begin(), n.distortion.end(), [](double k) { return k != 0; });
  if (any) text += fmt::format("distortion = [{}]\n", list_of(n.distortion));
  return text;
}

}  // namespace airtruth::lens
