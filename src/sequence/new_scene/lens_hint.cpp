// SPDX-License-Identifier: Apache-2.0
#include "sequence/new_scene/lens_hint.h"

#include <bit>
#include <charconv>
#include <cmath>

#include "camera/gyro/gpmf.h"

namespace airtruth::new_scene {
namespace {

constexpr double kFilmDiagonalMm = 43.27;  // of 36 x 24 mm
// Focal lengths of cameras on aircraft and phones for 35 mm film; others are a fault of the file.
constexpr double kMinEquivalentMm = 5, kMaxEquivalentMm = 2000;
// Diagonal fields of view of such cameras; others are a fault of the file too.
constexpr double kMinViewDeg = 5, kMaxViewDeg = 200;

std::optional<double> number_in(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" :"), text.size()));
  double value = 0;
  const auto [rest, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  return failed == std::errc() ? std::optional(value) : std::nullopt;
}

std::optional<double> plausible(std::optional<double> mm) {
  return mm && *mm >= kMinEquivalentMm && *mm <= kMaxEquivalentMm ? mm : std::nullopt;
}

double half_diagonal_px(lens::ImageSize size) { return 0.5 * std::hypot(size.width, size.height); }

}  // namespace

std::optional<double> equivalent_mm_in_subtitles(std::string_view text) {
  constexpr std::string_view kKey = "focal_len";
  const std::size_t at = text.find(kKey);
  if (at == std::string_view::npos) return std::nullopt;
  const auto value = number_in(text.substr(at + kKey.size()));
  if (!value) return std::nullopt;
  return plausible(*value > 100 ? *value / 10 : *value);
}

std::optional<double> diagonal_view_deg(std::span<const std::uint8_t> packet) {
  std::optional<double> view;
  gyro::each_gpmf_stream(packet, [&](std::span<const std::uint8_t> stream) {
    gyro::each_gpmf_element(stream, [&](const gyro::GpmfElement& e) {
      if (e.key != "ZFOV" || e.type != 'f' || e.size != 4 || e.count == 0) return;
      const float degrees = std::bit_cast<float>(gyro::big_endian(e.data, 0, 4));
      if (degrees >= kMinViewDeg && degrees <= kMaxViewDeg) view = degrees;
    });
  });
  return view;
}

std::optional<double> equivalent_mm_in_tags(const std::map<std::string, std::string>& tags) {
  for (const auto& [key, value] : tags)
    if (key.find("focal") != std::string::npos && key.find("35mm") != std::string::npos)
      if (const auto mm = plausible(number_in(value))) return mm;
  return std::nullopt;
}

lens::Lens pinhole_from_equivalent(double equivalent_mm, lens::ImageSize size) {
  const double focal_px = equivalent_mm / kFilmDiagonalMm * 2 * half_diagonal_px(size);
  return lens::undistorted(false, focal_px, size);
}

lens::Lens fisheye_from_diagonal(double view_deg, lens::ImageSize size) {
  return lens::undistorted(true, half_diagonal_px(size) / radians(view_deg / 2), size);
}

}  // namespace airtruth::new_scene
