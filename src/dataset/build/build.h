// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <stop_token>
#include <string>
#include <vector>

#include "dataset/catalogue/expand.h"
#include "foundation/base/log.h"

// A data set folder (docs/formats/dataset.md):
//
//   catalogue.toml        the catalogue that it is made of
//   backgrounds/          virtual flights, each with its mask and true camera
//   sequences/<name>/     as `airtruth render` leaves them: whole or not there
//   manifest/00000.jsonl  a line a sequence, 10,000 to a file; dataset.json last, once every
//   sequence is there failed.jsonl          what could not be made, and why
namespace airtruth::dataset {

struct BuildProgress {
  std::int64_t done = 0;   // sequences made or found whole
  std::int64_t total = 0;  // of this run's share
  std::string stage;       // "building"; or, of a background's frames, what is done with them
};

struct BuildOptions {
  int jobs = 0;                            // sequences at a time; 0: one per core
  std::string only = "*";                  // a pattern over names
  std::map<std::string, fs::path> videos;  // in place of the catalogue's: background -> video
  std::int64_t share = 0;  // this one makes the sequences whose number is share modulo shares
  std::int64_t shares = 1;
  std::function<void(const BuildProgress&)> progress;
  Warn warn;
  std::stop_token stop;
};

struct Failure {
  std::string name;
  std::string reason;  // one line
};

struct BuildSummary {
  std::int64_t made = 0;
  std::int64_t kept = 0;    // whole already
  std::int64_t frames = 0;  // of the ones made
  std::vector<Failure> failures;
  bool complete = false;  // every sequence of the catalogue is there: the manifest is written
  double seconds = 0;
};

// Makes what is missing. Killed at any instant and called again, it goes on: a sequence's folder is
// there whole or not at all, and what is whole is not made again. A sequence that fails is listed
// and the others go on. Error: `out` was begun with another catalogue, another build is at work in
// it, a background that no video can be read from, a pattern that nothing fits. Interrupted on
// stop.
BuildSummary build(const Catalogue& catalogue, const fs::path& out, const BuildOptions& options);

// Writes the manifest of a folder that several workers have filled; false where a sequence is
// missing. Error while any of them is at work.
bool finish(const fs::path& root);

}  // namespace airtruth::dataset
