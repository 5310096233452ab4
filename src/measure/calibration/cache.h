// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "measure/calibration/calibration.h"

namespace airtruth::calibration {

// Calibrations are cached by content: everything that their numbers depend on, and the version of
// the methods. A file of the cache that is not whole or not ours is ignored, never trusted.
struct CacheKey {
  std::string video_sha256;  // "" where the video has no checksum: nothing is kept
  std::string mask_sha256;   // "" without a mask
  std::string lens;          // words that tell lenses apart by every number
  std::optional<double> altitude_m;
  image::ToneCurve tone;

  std::string file_name() const;  // a hash of all of it, ".json"
};

// What was kept: values, missing, notes and yaw_from_first_deg, with the size and the number of
// frames. Empty where nothing is kept under the key.
std::optional<Calibration> cached(const fs::path& folder, const CacheKey& key);
void store(const fs::path& folder, const CacheKey& key, const Calibration& calibration);

// The calibration of the whole clip, from the cache or measured and kept there. Of several threads
// and processes that ask for the same at once, one measures and the others wait for its result; a
// cache that cannot be written costs the measurement again and is no error. `options` states what
// `key` states; its first frame is 0 and its heading is 0. An empty folder: no cache. Throws as
// calibrate(), and Interrupted on options.stop.
Calibration calibrate_once(const fs::path& video,
                           const Options& options,
                           const fs::path& folder,
                           const CacheKey& key);

}  // namespace airtruth::calibration
