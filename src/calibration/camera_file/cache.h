// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "calibration/camera_file/calibration.h"

namespace airtruth::calibration {

// The key of a cached calibration: everything that the measured values depend on. The version of
// the methods is part of the file name too. A cache file that is incomplete or fails its checksum
// is ignored.
struct CacheKey {
  // SHA-256 of the video; "" if the video has no checksum, and then nothing is cached.
  std::string video_sha256;
  // SHA-256 of the mask of the own aircraft; "" without a mask.
  std::string mask_sha256;
  // A description of the lens that contains every parameter, so that different lenses differ in it.
  std::string lens;
  std::optional<double> altitude_m;
  image::ToneCurve tone;

  // A hash of all fields, with the extension ".json".
  std::string file_name() const;
};

// Reads a calibration from the cache in `folder`. The result has the picture size, the number of
// frames, the quantities with their notes, and `yaw_from_first_deg`. Empty if the cache has no
// valid file for the key.
std::optional<Calibration> cached(const fs::path& folder, const CacheKey& key);
// Writes a calibration into the cache in `folder`.
void store(const fs::path& folder, const CacheKey& key, const Calibration& calibration);

// Returns the calibration of the whole clip, from the cache if it is there; otherwise measures it
// and stores it. If several threads or processes ask for the same calibration at once, one of them
// measures and the others wait for its result. A cache that cannot be written is no error: the next
// run measures again. `options` must agree with `key`, and its first frame and its heading must
// be 0. An empty `folder` means that there is no cache. Throws as calibrate() does, and Interrupted
// when options.stop is requested.
Calibration calibrate_once(const fs::path& video,
                           const Options& options,
                           const fs::path& folder,
                           const CacheKey& key);

}  // namespace airtruth::calibration
