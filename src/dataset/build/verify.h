// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "dataset/catalogue/folder.h"

namespace airtruth::dataset {

// Where a data set stands, from its folder alone.
struct Status {
  std::string name;
  std::int64_t sequences = 0;  // of the catalogue
  std::int64_t whole = 0;
  std::vector<std::string> missing;  // the first hundred
  std::int64_t half = 0;  // left by runs that were killed; the next build clears them away
  bool at_work = false;   // a build is running now
  bool complete = false;  // dataset.json is there
};
Status status(const fs::path& root);

struct VerifyOptions {
  std::int64_t deep_every =
      0;  // draw every n-th frame anew and compare (sequence/sequence/recompose.h)
  std::function<void(std::int64_t done, std::int64_t total)> progress;
  std::stop_token stop;
};

// Every file against its checksum; every line of truth read back, boxes within the frame; as many
// frames in the video as lines of truth; the manifest against the sequences. Each fault is one
// line.
struct VerifyResult {
  std::int64_t sequences = 0;
  std::int64_t frames = 0;
  std::int64_t recomposed = 0;  // frames that were drawn anew
  // By geometry alone (its position through the stated lens and motion, no pixel looked at): how
  // often an intruder's reference point lies in the picture, and how often no box says so although
  // nothing hides it. The second is a fault.
  std::int64_t in_view = 0;
  std::int64_t in_view_without_box = 0;
  std::vector<std::string> faults;
};
VerifyResult verify(const fs::path& root, const VerifyOptions& options);

}  // namespace airtruth::dataset
