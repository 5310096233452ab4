// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <stop_token>
#include <string>

#include "dataset/labelled/labelled_set.h"
#include "dataset/labelled/split.h"
#include "foundation/base/log.h"
#include "labels/exchange/exchange.h"

namespace airtruth::labelled {

enum class Images { kJpg, kPng, kNone };

constexpr auto enum_names(Images) {
  return std::to_array<EnumName<Images>>(
      {{Images::kJpg, "jpg"}, {Images::kPng, "png"}, {Images::kNone, "none"}});
}

struct ExportOptions {
  exchange::Format format = exchange::Format::kCoco;
  // Empty: JPEG, but PNG for AOT, whose reader opens no other kind, and none for a table.
  std::optional<Images> images;
  std::int64_t every = 1;  // the export holds the frames 0, n, 2n, ...
  Split split = Split::kByBackground;
  // Shares of train, val and test (split.h).
  std::array<double, 3> shares{0.8, 0.1, 0.1};
  std::uint64_t seed = 1;
  dataset::Boxes boxes = dataset::Boxes::kCovered;
  // A box whose contrast to noise or whose longer side is below one of these is marked as one that
  // counts neither way, where the format can say so, else dropped. A box whose contrast nobody can
  // measure, since it fills the picture, stays.
  double min_contrast = 0;
  double min_size_px = 0;
  // True: it is dropped in every format.
  bool drop_faint = false;
  // Every label has the class "aircraft"; otherwise its class is the aircraft's type.
  bool one_class = false;
  // For MOT only: classes are numbered from 1. Otherwise every aircraft has class 1.
  bool mot_classes = false;
  // For WebDataset only: the size at which a shard ends, in 10^6 bytes; empty: 500.
  std::optional<std::int64_t> shard_mb;
  // Number of sequences that are exported at the same time; 0 means one per core.
  int jobs = 0;
  Warn warn;
  // Counts sequences.
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  std::stop_token stop;
};

struct ExportSummary {
  // Written ones: formats of a single object have one for each aircraft, and its frames alone.
  std::int64_t sequences = 0;
  std::int64_t frames = 0;
  std::int64_t images = 0;  // pictures that this run wrote
  std::int64_t faint = 0;   // boxes that are marked or dropped
  std::int64_t masks = 0;   // labels that hold the object's pixels
  std::map<std::string, std::int64_t> frames_of_part;
  // True where an earlier run had already finished the export.
  bool was_there = false;
};

// Writes a data set in another format into the folder `out`: the labels, the pictures, LOSS.md
// (what the format cannot hold) and, last, export.json. A call with the same options continues an
// export that was stopped and keeps the pictures that are already whole. A table has encounters.csv
// beside its frames. Throws Error where `out` holds anything else, where the format's reader does
// not open the requested pictures, and where mot_classes or shard_mb is set for another format.
ExportSummary export_set(const fs::path& set, const fs::path& out, const ExportOptions& options);

}  // namespace airtruth::labelled
