// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calibration/camera_file/calibrate.h"
#include "foundation/disk_cache/disk_cache.h"

namespace airtruth::camera_file {

// The key of a cached calibration: everything that the measured values depend on.
struct CacheKey {
  // SHA-256 of the video; "" if the video has no checksum, and then nothing is cached.
  std::string video_sha256;
  // SHA-256 of the mask of the own aircraft; "" without a mask.
  std::string mask_sha256;
  // A description of the lens that contains every parameter, so that different lenses differ in it.
  std::string lens;
  std::optional<double> altitude_m;
  image::ToneCurve tone;
  // Of numbered pictures; empty for a video.
  std::optional<double> picture_rate_hz;

  disk_cache::Key entry() const;
};

// A calibration in the cache. It has the picture size, the number of frames, the quantities with
// their notes, and `yaw_from_first_deg`.
std::optional<Calibration> cached(const disk_cache::Cache& cache, const CacheKey& key);
void store(const disk_cache::Cache& cache, const CacheKey& key, const Calibration& calibration);

// Returns the calibration of the clip, from the cache if it is there; otherwise measures it and
// stores it. If several threads or processes ask for the same calibration at once, one of them
// measures and the others wait for its result. `options` must agree with `key`, and its heading
// must be 0. Throws as calibrate() does, and Interrupted when options.stop is requested.
Calibration calibrate_once(const fs::path& video,
                           const Options& options,
                           const disk_cache::Cache& cache,
                           const CacheKey& key);

}  // namespace airtruth::camera_file
