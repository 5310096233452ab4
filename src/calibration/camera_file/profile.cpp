// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/profile.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/median.h"
#include "foundation/base/names.h"
#include "foundation/base/text.h"

namespace airtruth::camera_file {
namespace {

constexpr const char* kPointSpread = "optics.point_spread_px";
// The keys of the optics, which a clip shows together by its edges or not at all.
constexpr std::array<const char*, 5> kOptics = {kPointSpread,
                                                "optics.vertical_spread_px",
                                                "optics.sharpening",
                                                "optics.sharpening_px",
                                                "sensor.chroma_spread_px"};
// The key of the readout time, whose sign is its direction.
constexpr const char* kReadout = "shutter.readout_s";
// The other keys that a profile may have: values that belong to the camera and not to one flight.
constexpr std::array<const char*, 4> kBesideOptics = {
    "sensor.noise_gain", "sensor.noise_floor", "sensor.noise_correlation_px", kReadout};
// Share of the clip's own weight from which on a value counts as the clip's own; below 1 minus this
// share it counts as the profile's.
constexpr double kOwnShare = 0.95;
// A clip contradicts its profile if they differ by more than this multiple of their common error.
constexpr double kMaxDifferenceInErrors = 3;

std::vector<CameraProfile> read_library(std::string_view text) {
  constexpr std::string_view kHead = "profile,";
  std::vector<CameraProfile> profiles;
  while (text.starts_with(kHead)) {
    const std::size_t line = text.find('\n');
    const std::string name(text.substr(kHead.size(), line - kHead.size()));
    const std::size_t next = text.find("\nprofile,", line);
    profiles.push_back(parse_camera_profile(text.substr(line + 1, next - line - 1), name));
    text = next == text.npos ? std::string_view() : text.substr(next + 1);
  }
  std::ranges::sort(profiles, {}, &CameraProfile::name);
  return profiles;
}

// The value and its error as text, such as "0.42 +- 0.1".
std::string with_error(const Estimate& e) {
  return fmt::format("{:.3g} +- {:.2g}", e.value, e.sigma);
}

void put(Calibration& c, const std::string& key, Estimate value) {
  if (key == kReadout) {
    c.readout_direction = value.value < 0 ? "up" : "down";
    value.value = std::abs(value.value);
  }
  Quantity& quantity = c.quantities.at(key);
  quantity.values = {value};
  quantity.missing.clear();
}

// The share of the clip's own value in its combination with the profile.
double own_share(const Estimate& own, const Estimate& prior) {
  if (!(own.sigma > 0)) return 1;
  if (!(prior.sigma > 0)) return 0;
  const double weight = 1 / (own.sigma * own.sigma);
  return weight / (weight + 1 / (prior.sigma * prior.sigma));
}

void join(Calibration& c,
          const std::string& key,
          const Estimate& prior,
          const CameraProfile& profile) {
  const std::string whose = profile.words();
  Quantity& quantity = c.quantities.at(key);
  if (!quantity.is_measured()) {
    quantity.source = "of " + whose + "; the clip does not show it";
    put(c, key, prior);
    return;
  }
  const Estimate own = to_combine(c, quantity);
  const double share = own_share(own, prior);
  const double off = std::abs(own.value - prior.value);
  const bool contradicts = off > kMaxDifferenceInErrors * std::hypot(own.sigma, prior.sigma);
  if (share == 1 || (contradicts && profile.name.empty())) return;
  if (key == kPointSpread && own.value > prior.value && !contradicts) {
    put(c, key, prior);
    quantity.source =
        fmt::format("of {}; the edges of the clip, {}, are an upper bound", whose, with_error(own));
    return;
  }
  put(c, key, combined(own, prior));
  if (share < kOwnShare)
    quantity.source =
        share > 1 - kOwnShare
            ? fmt::format("of the clip, {}, and {}, {}", with_error(own), whose, with_error(prior))
            : fmt::format("of {}; the clip's {} says next to nothing", whose, with_error(own));
  if (contradicts)
    quantity.doubt =
        fmt::format("the clip has {}, {} {}", with_error(own), whose, with_error(prior));
}

}  // namespace

std::string CameraProfile::words() const {
  return name.empty() ? fmt::format("the median over {} cameras", clips) : "the profile " + name;
}

CameraProfile parse_camera_profile(std::string_view text, const std::string& name) {
  CameraProfile profile;
  profile.name = name;
  text = without_mark(text);
  int number = 0;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::vector<std::string> cells = airtruth::cells_of(text.substr(0, end));
    text = end == text.npos ? std::string_view() : text.substr(end + 1);
    const Where where{name + ".csv", ++number};
    if (cells.empty() || cells[0].starts_with('#') || cells[0] == "key") continue;
    if (cells[0] == "tag" && cells.size() == 3) {
      profile.tags[cells[1]] = cells[2];
      continue;
    }
    const bool known = std::ranges::find(kOptics, cells[0]) != kOptics.end() ||
                       std::ranges::find(kBesideOptics, cells[0]) != kBesideOptics.end();
    if (cells.size() != (known ? 4U : 2U))
      throw Error(fmt::format("has {} cells; expected key,value,error,clips or camera,WORDS, "
                              "width,PX, height,PX, clips,NUMBER, tag,KEY,BEGINNING",
                              cells.size()),
                  where);
    if (cells[0] == "camera")
      profile.camera = cells[1];
    else if (cells[0] == "width")
      profile.width = static_cast<int>(finite_number(cells[1], where));
    else if (cells[0] == "height")
      profile.height = static_cast<int>(finite_number(cells[1], where));
    else if (cells[0] == "clips")
      profile.clips = static_cast<int>(finite_number(cells[1], where));
    else if (known)
      profile.values[cells[0]] = {finite_number(cells[1], where), finite_number(cells[2], where)};
    else
      throw Error("'" + cells[0] + "' is no key of a camera's profile", where);
  }
  return profile;
}

std::span<const CameraProfile> camera_profiles() {
  static const std::vector<CameraProfile> profiles = read_library(profile_table());
  return profiles;
}

const CameraProfile& camera_profile(const std::string& name, const Where& where) {
  static const CameraProfile none{{.name = kNoProfile}, {}, {}};
  if (name == kNoProfile) return none;
  std::vector<std::string> names;
  for (const CameraProfile& profile : camera_profiles()) {
    if (profile.name == name) return profile;
    names.push_back(profile.name);
  }
  throw Error("there is no camera profile '" + name + "'" + did_you_mean(name, names) +
                  " ('airtruth calibrate --list-profiles' lists them)",
              where);
}

const CameraProfile* recognised_profile(int width,
                                        int height,
                                        const std::map<std::string, std::string>& tags) {
  for (const CameraProfile& profile : camera_profiles()) {
    const bool has_tags =
        std::all_of(profile.tags.begin(), profile.tags.end(), [&](const auto& expected) {
          const auto found = tags.find(expected.first);
          return found != tags.end() && found->second.starts_with(expected.second);
        });
    if (has_tags && !profile.tags.empty() && profile.width == width && profile.height == height)
      return &profile;
  }
  return nullptr;
}

CameraProfile usual_camera() {
  CameraProfile usual;
  usual.clips = static_cast<int>(camera_profiles().size());
  for (const char* key : kOptics) {
    std::vector<double> values, errors;
    for (const CameraProfile& profile : camera_profiles()) {
      const auto found = profile.values.find(key);
      if (found == profile.values.end()) continue;
      values.push_back(found->second.value);
      errors.push_back(found->second.sigma);
    }
    // One camera does not show the spread between cameras.
    if (values.size() < 2) continue;
    const double middle = median_between(values);
    double squares = 0;
    for (const double v : values) squares += (v - middle) * (v - middle);
    const double between = std::sqrt(squares / double(values.size() - 1));
    usual.values[key] = {middle, std::hypot(between, median_between(errors))};
  }
  return usual;
}

Estimate combined(const Estimate& a, const Estimate& b) {
  if (!(a.sigma > 0)) return a;
  if (!(b.sigma > 0)) return b;
  const double share = own_share(a, b);
  return {share * a.value + (1 - share) * b.value, 1 / std::hypot(1 / a.sigma, 1 / b.sigma)};
}

void check_size(const CameraProfile& profile, int width, int height, const Where& where) {
  if (profile.width == 0 || (profile.width == width && profile.height == height)) return;
  throw Error(fmt::format("the camera profile '{}' was measured on clips of {} x {} px; the clip "
                          "is {} x {}",
                          profile.name,
                          profile.width,
                          profile.height,
                          width,
                          height),
              where);
}

Calibration with_profile(Calibration measured, const CameraProfile& profile) {
  check_size(profile, measured.width, measured.height);
  for (const auto& [key, prior] : profile.values) join(measured, key, prior, profile);
  return measured;
}

}  // namespace airtruth::camera_file
