// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <span>
#include <string>
#include <string_view>

#include <airtruth/calibration.h>

#include "calibration/camera_file/calibration.h"
#include "foundation/base/error.h"

// Camera profiles: the camera models of cameras that were measured before
// (data/camera-profiles/README.md). A profile is a prior for quantities that a clip does not show;
// a clip of sky alone, for example, does not show its sharpness.
//
// A clip's value v +- s and a profile's value p +- q combine to
// (v / s^2 + p / q^2) / (1 / s^2 + 1 / q^2) with the error 1 / sqrt(1 / s^2 + 1 / q^2). A value
// with a large error moves to the profile; a value with a small error hardly changes. Example: a
// sharpening of 0.46 +- 0.12 under a profile of 0 +- 0.11 becomes 0.21 +- 0.08.
//
// A point spread above the profile's is an upper bound, since edges of the world are softer than
// steps: the profile's is taken. Where no profile is named, a value that contradicts the median of
// the cameras by more than three common errors stays: it is of another kind of camera.
namespace airtruth::camera_file {

// The name is empty if the profile does not describe one single camera, and the size is 0 if the
// measured clips have several.
struct CameraProfile : airtruth::CameraProfile {
  // The tags by which its files are known, and how their values begin; empty: by none.
  std::map<std::string, std::string> tags;
  // Values and errors by the names of kQuantityKeys. An error is that of one further clip of the
  // camera, so it includes the differences between clips. The readout time is negative if the
  // sensor is read upwards.
  std::map<std::string, Estimate> values;

  // The profile in words: "the profile gopro-karma", "the median over 3 cameras".
  std::string words() const;
};

// The text of all data/camera-profiles/*.csv, embedded when the program is built. A line
// "profile,NAME" precedes the text of each file.
std::string_view profile_table();

// All profiles of the library, in the order of profile_table().
std::span<const CameraProfile> camera_profiles();

// The name that stands for no profile: the values of the clip stay unchanged.
inline constexpr const char* kNoProfile = "none";

// The profile with the given name; for kNoProfile, one without values. Throws Error with the
// nearest existing name if there is none.
const CameraProfile& camera_profile(const std::string& name, const Where& where = {});

// The profile of the camera whose files have this size and these tags (video::read_tags()); null
// where none is known by them.
//
// Example: a clip of 854 x 480 px whose tag firmware is "HD5.02.02.00.00" is of gopro-karma.
const CameraProfile* recognised_profile(int width,
                                        int height,
                                        const std::map<std::string, std::string>& tags);

// The profile for an unknown camera: the medians of the optical values over the cameras of the
// library, with the spread between cameras as errors.
CameraProfile usual_camera();

// Parses one file of the library: each line has a key and its cells
// (data/camera-profiles/README.md).
CameraProfile parse_camera_profile(std::string_view text, const std::string& name);

// Throws Error if the profile was measured on pictures of another size, since a spread in pixels
// holds for one picture size.
void check_size(const CameraProfile& profile, int width, int height, const Where& where = {});

// Combines a calibration with a profile. The `source` of a quantity states the origin of the
// combined values. Throws as check_size() does.
Calibration with_profile(Calibration measured, const CameraProfile& profile);

// The mean of two estimates weighted by inverse variance. An error of 0 means that the value is
// known exactly.
Estimate combined(const Estimate& a, const Estimate& b);

}  // namespace airtruth::camera_file
