// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <string_view>

// The ranges of the numbers in TOML files; docs/formats/scene.md states each. Every range is
// bounded on both sides, far beyond what a flight needs, and keeps the squares and quotients of
// floats and doubles far from overflow and underflow. This header is not installed.
namespace airtruth::scene {

// The range of a number, and the words that an error message uses for it. NaN and infinity lie
// outside every range. The bounds belong to the range unless without_low or without_high is set;
// `expected` then says so.
struct Limits {
  std::string_view expected;
  double low = 0;
  double high = 0;
  bool without_low = false;
  bool without_high = false;

  bool holds(double value) const {
    if (!std::isfinite(value) || value < low || value > high) return false;
    return !(without_low && value == low) && !(without_high && value == high);
  }
};

// Angles.
inline constexpr Limits kTurn{.expected = "degrees from -360 to 360", .low = -360, .high = 360};
inline constexpr Limits kPitch{.expected = "degrees from -90 to 90", .low = -90, .high = 90};
inline constexpr Limits kFisheyeView{
    .expected = "degrees from 0.01 to 360", .low = 0.01, .high = 360};
inline constexpr Limits kPinholeView{
    .expected = "degrees from 0.01, below 180 (a fisheye reaches further)",
    .low = 0.01,
    .high = 180,
    .without_high = true};

// Positions, times and speeds. The bound 1e9 is also that of path files (trajectory/path_file.cpp).
inline constexpr Limits kPosition{.expected = "metres from -1e9 to 1e9", .low = -1e9, .high = 1e9};
inline constexpr Limits kTime{.expected = "seconds from -1e9 to 1e9", .low = -1e9, .high = 1e9};
inline constexpr Limits kWeight{.expected = "a number from 1e-9 to 1e9", .low = 1e-9, .high = 1e9};
inline constexpr Limits kFrameRate_hz{
    .expected = "frames a second from 0.001 to 1e6", .low = 0.001, .high = 1e6};
inline constexpr Limits kVelocity{
    .expected = "metres a second from -1e4 to 1e4", .low = -1e4, .high = 1e4};
inline constexpr Limits kSpeed{
    .expected = "metres a second from 0.001 to 1e4", .low = 0.001, .high = 1e4};
// A miss distance: beyond it two aircraft do not meet.
inline constexpr Limits kMiss{.expected = "metres from -1e5 to 1e5", .low = -1e5, .high = 1e5};
inline constexpr Limits kClimb{
    .expected = "metres a second from -1000 to 1000", .low = -1000, .high = 1000};
inline constexpr Limits kThreshold{.expected = "metres from 0 to 1e5", .low = 0, .high = 1e5};
inline constexpr Limits kThresholdTime{
    .expected = "seconds from 0 to 3600", .low = 0, .high = 3600};
inline constexpr Limits kKeyframeSpacing{
    .expected = "seconds from 0.001 to 60", .low = 0.001, .high = 60};
inline constexpr Limits kLookahead{.expected = "seconds from 1 to 3600", .low = 1, .high = 3600};
inline constexpr Limits kTurnRate{
    .expected = "degrees a second from -90 to 90", .low = -90, .high = 90};
inline constexpr Limits kSmoothing{
    .expected = "seconds from 0.001 to 1e4", .low = 0.001, .high = 1e4};
inline constexpr Limits kModelScale{
    .expected = "a number from 1e-6 to 1e6", .low = 1e-6, .high = 1e6};

// The lens.
inline constexpr Limits kFocal{.expected = "pixels from 1 to 1e6", .low = 1, .high = 1e6};
inline constexpr Limits kPrincipalPoint{
    .expected = "pixels from -1e6 to 1e6", .low = -1e6, .high = 1e6};
inline constexpr Limits kDistortion{
    .expected = "a number from -1e12 to 1e12", .low = -1e12, .high = 1e12};

// A place in the picture; it may lie outside the image.
inline constexpr Limits kPixel{.expected = "pixels from -1e5 to 1e5", .low = -1e5, .high = 1e5};

// Light, air, optics and sensor.
inline constexpr Limits kExposureFactor{
    .expected = "a number from 1e-6 to 1e4", .low = 1e-6, .high = 1e4};
inline constexpr Limits kAlbedo{.expected = "a number from 0 to 1", .low = 0, .high = 1};
inline constexpr Limits kLinearLight{// Linear light; 1 is white.
                                     .expected = "a number from 0 to 1e4",
                                     .low = 0,
                                     .high = 1e4};
inline constexpr Limits kExtinction{
    // Extinction in 1/km. At the upper bound the range of sight is 0.4 m.
    .expected = "a number from 0 to 1e4",
    .low = 0,
    .high = 1e4};
inline constexpr Limits kGamma{.expected = "a number from 1.2 to 3", .low = 1.2, .high = 3};
inline constexpr Limits kShutterAngle{.expected = "degrees from 0 to 360", .low = 0, .high = 360};
inline constexpr Limits kExposureTime{.expected = "seconds from 0 to 1", .low = 0, .high = 1};
inline constexpr Limits kSpread{.expected = "pixels from 0 to 10", .low = 0, .high = 10};
inline constexpr Limits kSharpening{.expected = "a number from 0 to 3", .low = 0, .high = 3};
inline constexpr Limits kVariance{.expected = "a variance from 0 to 0.1", .low = 0, .high = 0.1};
inline constexpr Limits kCodecStep{.expected = "code values from 0 to 128", .low = 0, .high = 128};

// Weather: factors on what the clip shows.
inline constexpr Limits kExposureChange{
    .expected = "a factor from 1/16 to 16", .low = 0.0625, .high = 16};
inline constexpr Limits kWhiteBalanceChange{
    .expected = "a factor from 0.25 to 4", .low = 0.25, .high = 4};
inline constexpr Limits kBlurChange{.expected = "a factor from 0 to 10", .low = 0, .high = 10};
inline constexpr Limits kVisibility{.expected = "metres from 1 to 1e6", .low = 1, .high = 1e6};

// Catalogues.
inline constexpr Limits kShare{.expected = "a number from 0 to 1", .low = 0, .high = 1};
inline constexpr Limits kOwnSpeed{
    .expected = "metres a second from 0 to 1000", .low = 0, .high = 1000};
inline constexpr Limits kAltitude{.expected = "metres from 1 to 20000", .low = 1, .high = 20000};
inline constexpr Limits kRangeToAircraft{
    .expected = "metres from 0.1 to 1e6", .low = 0.1, .high = 1e6};

inline constexpr Limits kApparentSize{
    .expected = "pixels from 0.1 to 1e5", .low = 0.1, .high = 1e5};

}  // namespace airtruth::scene
