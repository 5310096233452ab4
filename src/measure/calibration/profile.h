// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <vector>

#include "foundation/base/error.h"
#include "measure/calibration/calibration.h"

// What cameras that were measured before do to light (data/camera-profiles/README.md): a prior for
// what a clip cannot tell, as a clip of sky alone cannot tell its sharpness.
//
// A clip's value v +- s and a profile's p +- q make (v / s^2 + p / q^2) / (1 / s^2 + 1 / q^2), with
// the error 1 / sqrt(1 / s^2 + 1 / q^2): a value whose error is so large that it says nothing gives
// way to the profile, a sure one stays. Example: 0.91 +- 0.45 px under a profile of 0.42 +- 0.10 px
// becomes 0.44 +- 0.10 px.
namespace airtruth::calibration {

struct CameraProfile {
  std::string name;    // "gopro-karma"; empty: of no one camera
  std::string camera;  // which camera that is
  int width = 0;       // of the clips that it was measured on, px; 0: of several sizes
  int height = 0;
  int clips = 0;
  // By key, as Calibration::values: value and error. The error is that for one more clip of the
  // camera: what the clips differ by is in it. A readout upwards is negative.
  std::map<std::string, Estimate> values;

  std::string words() const;  // "the profile gopro-karma", "the median over 3 cameras"
};

// The library, by name.
std::span<const CameraProfile> camera_profiles();

// The name of the profile that says nothing: a clip's values stay its own.
inline constexpr const char* kNoProfile = "none";

// Error, with the nearest name, where there is none of that name.
const CameraProfile& camera_profile(const std::string& name, const Where& where = {});

// What stands for a camera of which nothing is known: the optics' medians over the library's
// cameras, with the spread from camera to camera as errors.
CameraProfile usual_camera();

// One file of the library: lines of a key and its cells (data/camera-profiles/README.md).
CameraProfile parse_camera_profile(std::string_view text, const std::string& name);

// Error where the profile was measured on pictures of another size: a spread in pixels is of a
// size.
void check_size(const CameraProfile& profile, int width, int height, const Where& where = {});

// The calibration with the profile's word on it. Where a value comes from stands in its `sources`.
// Error as check_size().
Calibration with_profile(Calibration measured, const CameraProfile& profile);

// A value and its prior by their inverse variances; an error of 0 is a value that is known.
Estimate combined(const Estimate& a, const Estimate& b);

}  // namespace airtruth::calibration
