// SPDX-License-Identifier: Apache-2.0
#include "aircraft/fleet/scale.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include "aircraft/shapes/airframes.h"
#include "foundation/base/error.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"

namespace airtruth::fleet {
namespace {

// Relative tolerances, as shares, chosen by judgement. The span differs between variants of a type,
// and models are coarse.
constexpr double kSpanTolerance = 0.03;
// A smaller error of the length confirms no error of scale.
constexpr double kLengthTolerance = 0.01;

double metres(const std::string& text) {
  const auto value = number_from_text<double>(text);
  check(value && *value > 0, "the table of published sizes holds metres");
  return *value;
}

PublishedSize size_from(const std::string& line) {
  const std::vector<std::string> cells = cells_of(line);
  check(cells.size() == 6 || cells.size() == 2, "a row of published sizes has six cells");
  PublishedSize size;
  size.names = cells_of(cells[0], '|');
  size.type = cells[1];
  if (cells.size() == 2) return size;
  size.span_m = metres(cells[2]);
  size.length_m = metres(cells[3]);
  size.height_m = metres(cells[4]);
  size.source = cells[5];
  return size;
}

}  // namespace

std::vector<std::string> rows_of(std::string_view table) {
  std::vector<std::string> rows = cells_of(table, '\n');
  rows.erase(rows.begin());
  std::erase_if(rows,
                [](const std::string& row) { return row.find_first_not_of(',') == row.npos; });
  return rows;
}

std::span<const PublishedSize> published_sizes() {
  static const std::vector<PublishedSize> sizes = [] {
    std::vector<PublishedSize> all;
    for (std::string& row : rows_of(size_table())) {
      row.erase(row.find_last_not_of(',') + 1);
      all.push_back(size_from(row));
    }
    for (const shapes::Airframe& made : shapes::airframes())
      all.push_back({{std::string(made.name) + "/*"}, std::string(made.size)});
    return all;
  }();
  return sizes;
}

const PublishedSize* published_size(const std::string& catalogue_name) {
  for (const PublishedSize& size : published_sizes())
    for (const std::string& pattern : size.names)
      if (matches(pattern, catalogue_name)) return &size;
  return nullptr;
}

SizeError size_error(const model::Extents& model, const PublishedSize& published) {
  check(published.is_known(), "a published size");
  return {model.span_m() / published.span_m - 1, model.length_m() / published.length_m - 1};
}

double scale_to_published(const model::Extents& model, const PublishedSize& published) {
  const SizeError error = size_error(model, published);
  const bool is_off = std::abs(error.span) > kSpanTolerance &&
                      std::abs(error.length) > kLengthTolerance && error.span * error.length > 0;
  return is_off ? published.span_m / model.span_m() : 1;
}

void scale_mesh(model::Mesh& mesh, double factor) {
  check(std::isfinite(factor) && factor > 0, "a scale is above 0");
  const auto scale = static_cast<float>(factor);
  for (Eigen::Vector3f& position : mesh.positions) position *= scale;
  for (model::Part& part : mesh.parts) part.centre_in_body *= scale;
}

std::string size_words(const model::Extents& loaded, double scale, const PublishedSize* published) {
  if (published == nullptr) return "no published size is known: its scale is not checked";
  if (!published->is_known()) return published->type;
  const SizeError error = size_error(loaded, *published);
  const std::string off = fmt::format(
      "span {:+.1f} %, length {:+.1f} % of the published {:.2f} and "
      "{:.2f} m ({})",
      100 * error.span,
      100 * error.length,
      published->span_m,
      published->length_m,
      published->source);
  const bool is_to_scale = std::max(std::abs(error.span), std::abs(error.length)) <= kSpanTolerance;
  return fmt::format("{}: {}{}{}",
                     published->type,
                     scale == 1 ? "" : fmt::format("scaled by {:.3f}; ", scale),
                     is_to_scale ? "" : "not to scale: ",
                     off);
}

}  // namespace airtruth::fleet
