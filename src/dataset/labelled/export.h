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
#include "truth/exchange/exchange.h"

namespace airtruth::dataset {

enum class Images { kJpg, kPng, kNone };

struct ExportOptions {
  exchange::Format format = exchange::Format::kCoco;
  std::optional<Images> images;  // default: JPEG; PNG for AOT, whose reader opens no other
  std::int64_t every = 1;        // frames 0, n, 2n, ...
  Split split = Split::kByBackground;
  std::array<double, 3> shares{0.8, 0.1, 0.1};
  std::uint64_t seed = 1;
  Boxes boxes = Boxes::kCovered;
  bool one_class = false;    // "aircraft", in place of the aircraft's types
  bool mot_classes = false;  // MOT: classes numbered from 1, in place of 1 for every aircraft
  int jobs = 0;              // sequences at a time; 0: one per core
  Warn warn;
  std::function<void(std::int64_t done, std::int64_t total)> progress;  // sequences
  std::stop_token stop;
};

struct ExportSummary {
  std::int64_t sequences = 0;
  std::int64_t frames = 0;
  std::int64_t images = 0;  // written by this run
  std::int64_t masks = 0;   // labels that hold the object's pixels
  std::map<std::string, std::int64_t> frames_of_part;
  bool was_there = false;  // an earlier run had finished it
};

// Writes a data set in another format into a new folder, with its pictures, LOSS.md and, last,
// export.json. An export that was stopped goes on when it is called again with the same options:
// pictures that are whole are not made again. Error where the folder holds anything else, for
// pictures that the format's reader does not open, and for mot_classes with another format.
ExportSummary export_set(const fs::path& set, const fs::path& out, const ExportOptions& options);

}  // namespace airtruth::dataset
