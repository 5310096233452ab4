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
inline constexpr Limits kTurn{"degrees from -360 to 360", -360, 360};
inline constexpr Limits kPitch{"degrees from -90 to 90", -90, 90};
inline constexpr Limits kFisheyeView{"degrees from 0.01 to 360", 0.01, 360};
inline constexpr Limits kPinholeView{
    .expected = "degrees from 0.01, below 180 (a fisheye reaches further)",
    .low = 0.01,
    .high = 180,
    .without_high = true};

// Positions, times and speeds. The bound 1e9 is also that of path files (trajectory/path_file.cpp).
inline constexpr Limits kPosition{"metres from -1e9 to 1e9", -1e9, 1e9};
// Of a log's clock: seconds since 1970 fit.
inline constexpr Limits kLogTime{"seconds from -1e11 to 1e11", -1e11, 1e11};
inline constexpr Limits kTime{"seconds from -1e9 to 1e9", -1e9, 1e9};
inline constexpr Limits kWeight{"a number from 1e-9 to 1e9", 1e-9, 1e9};
inline constexpr Limits kFrameRate_hz{"frames a second from 0.001 to 1e6", 0.001, 1e6};
inline constexpr Limits kVelocity{"metres a second from -1e4 to 1e4", -1e4, 1e4};
inline constexpr Limits kSpeed{"metres a second from 0.001 to 1e4", 0.001, 1e4};
// A miss distance: beyond it two aircraft do not meet.
inline constexpr Limits kMiss{"metres from -1e5 to 1e5", -1e5, 1e5};
inline constexpr Limits kClimb{"metres a second from -1000 to 1000", -1000, 1000};
inline constexpr Limits kThreshold{"metres from 0 to 1e5", 0, 1e5};
inline constexpr Limits kThresholdTime{"seconds from 0 to 3600", 0, 3600};
inline constexpr Limits kKeyframeSpacing{"seconds from 0.001 to 60", 0.001, 60};
inline constexpr Limits kLookahead{"seconds from 1 to 3600", 1, 3600};
inline constexpr Limits kTurnRate{"degrees a second from -90 to 90", -90, 90};
inline constexpr Limits kSmoothing{"seconds from 0.001 to 1e4", 0.001, 1e4};
inline constexpr Limits kModelScale{"a number from 1e-6 to 1e6", 1e-6, 1e6};

// The lens.
inline constexpr Limits kFocal{"pixels from 1 to 1e6", 1, 1e6};
inline constexpr Limits kPrincipalPoint{"pixels from -1e6 to 1e6", -1e6, 1e6};
inline constexpr Limits kDistortion{"a number from -1e12 to 1e12", -1e12, 1e12};

// A place in the picture; it may lie outside the image.
inline constexpr Limits kPixel{"pixels from -1e5 to 1e5", -1e5, 1e5};

// Distractors: their size in the air, the strokes of birds, and their size on the lens.
inline constexpr Limits kDistractorSize{"metres from 0.05 to 20", 0.05, 20};
inline constexpr Limits kStrokeRate{"strokes a second from 0 to 100", 0, 100};
inline constexpr Limits kSpotSize{"pixels from 1 to 5000", 1, 5000};

// Light, air, optics and sensor.
inline constexpr Limits kExposureFactor{"a number from 1e-6 to 1e4", 1e-6, 1e4};
inline constexpr Limits kAlbedo{"a number from 0 to 1", 0, 1};
// Linear light; 1 is white.
inline constexpr Limits kLinearLight{"a number from 0 to 1e4", 0, 1e4};
// Extinction in 1/km. At the upper bound the range of sight is 0.4 m.
inline constexpr Limits kExtinction{"a number from 0 to 1e4", 0, 1e4};
inline constexpr Limits kGamma{"a number from 1.2 to 3", 1.2, 3};
inline constexpr Limits kShutterAngle{"degrees from 0 to 360", 0, 360};
inline constexpr Limits kExposureTime{"seconds from 0 to 1", 0, 1};
inline constexpr Limits kSpread{"pixels from 0 to 10", 0, 10};
inline constexpr Limits kSharpening{"a number from 0 to 3", 0, 3};
inline constexpr Limits kVariance{"a variance from 0 to 0.1", 0, 0.1};
inline constexpr Limits kCodecStep{"code values from 0 to 128", 0, 128};

// Weather: factors on what the clip shows.
inline constexpr Limits kExposureChange{"a factor from 1/16 to 16", 0.0625, 16};
inline constexpr Limits kWhiteBalanceChange{"a factor from 0.25 to 4", 0.25, 4};
inline constexpr Limits kBlurChange{"a factor from 0 to 10", 0, 10};
inline constexpr Limits kVisibility{"metres from 1 to 1e6", 1, 1e6};

// Catalogues.
inline constexpr Limits kShare{"a number from 0 to 1", 0, 1};
inline constexpr Limits kRangeToAircraft{"metres from 0.1 to 1e6", 0.1, 1e6};

// Virtual flights (scene/synthetic/flight.h).
inline constexpr Limits kFlightSpeed{"metres a second from 0 to 400", 0, 400};
inline constexpr Limits kFlightAltitude{"metres from 20 to 900, below the clouds", 20, 900};
inline constexpr Limits kFlightSunElevation{"degrees from 2 to 90", 2, 90};

inline constexpr Limits kApparentSize{"pixels from 0.1 to 1e5", 0.1, 1e5};

}  // namespace airtruth::scene
