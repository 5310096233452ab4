// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "aircraft/model/mesh.h"

// The sizes of real aircraft, and the scale that brings a catalogue's model to them
// (data/aircraft-sizes/README.md).
namespace airtruth::fleet {

struct PublishedSize {
  std::vector<std::string> names;  // patterns over catalogue names
  std::string type;                // "Cessna 172P"; a description where no size is published
  double span_m = 0;               // 0: no size is published
  double length_m = 0;
  double height_m = 0;
  std::string source = {};

  bool is_known() const { return span_m > 0; }
};

// The table, in the order of its file, and a row in words for each type that is made in code.
std::span<const PublishedSize> published_sizes();

// The row of a catalogue name; null where there is none.
const PublishedSize* published_size(const std::string& catalogue_name);

// The relative size error of a model: model / published - 1.
struct SizeError {
  double span = 0;
  double length = 0;
};
SizeError size_error(const model::Extents& model, const PublishedSize& published);

// The factor from a model's span to the published span where the scale of the model is wrong, else
// 1. The scale counts as wrong where span and length err in the same direction, the span by more
// than 3 % and the length by more than 1 %.
double scale_to_published(const model::Extents& model, const PublishedSize& published);

// Scales a mesh by one factor about the origin of the body: its positions and the centres of its
// spinning parts. Normals, directions and textures do not change.
void scale_mesh(model::Mesh& mesh, double factor);

// One line about a loaded catalogue model and the factor by which it was scaled, for example
// "Cessna 172P: scaled by 1.142 to the published span of 11.00 m; the length is +7.2 % off (8.28
// m)".
std::string size_words(const model::Extents& loaded, double scale, const PublishedSize* published);

// The content of data/aircraft-sizes/sizes.csv, which the build embeds in the program.
// published_sizes() parses it; data/aircraft-sizes/README.md describes the columns and
// the sources.
std::string_view size_table();

// The rows of an embedded table, a line each, without its heading and without lines that hold
// commas alone.
std::vector<std::string> rows_of(std::string_view table);

}  // namespace airtruth::fleet
