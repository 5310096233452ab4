// SPDX-License-Identifier: Apache-2.0
// The subtitles that DJI's aircraft write beside a video: SubRip blocks whose text states where the
// aircraft was. Three generations of that text are read. The first has keys:
//   [latitude: 47.1] [longitude: 8.5] [rel_alt: 30.3 abs_alt: 500.1] [gb_yaw: 10 gb_pitch: -5 ...]
// The second:
//   F/2.8, SS 200, ISO 100, EV 0, GPS (8.5, 47.1, 16), D 26.5m, H 6.00m, H.S 2.1m/s, V.S 0.0m/s
// The third:
//   HOME(8.5,47.1) 2017.08.05 14:11:51 GPS(8.5,47.1,16) BAROMETER:91.2
//
// The third number of GPS is the count of satellites, and longitude comes first; where it is a
// height, as in GPS(47.1,8.5,12.0M), latitude comes first. G.PRY (-27.3, 0.0, -76.0) states the
// gimbal's pitch, roll and yaw. Some firmware states no height: the path is then level.
#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <optional>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "scene/flight_log/formats.h"

namespace airtruth::flight_log {
namespace {

constexpr std::size_t kTypeHeadBytes = 4096;  // in which a file shows what it is
constexpr std::size_t kMaxNumberBytes = 64;   // of a number and what stands before it

std::optional<double> number_at_start(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(" :\t(,"), text.size()));
  if (!text.empty() && text[0] == '+') text.remove_prefix(1);
  double value = 0;
  const auto [rest, failed] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (failed != std::errc()) return std::nullopt;
  return value;
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.'; }

// The text behind a word that stands alone; empty where the text lacks it.
std::optional<std::string_view> behind(std::string_view text, std::string_view word) {
  for (std::size_t at = text.find(word); at != std::string_view::npos;
       at = text.find(word, at + 1)) {
    const std::size_t end = at + word.size();
    if ((at == 0 || !is_word(text[at - 1])) && (end == text.size() || !is_word(text[end])))
      return text.substr(end);
  }
  return std::nullopt;
}

bool is_digit_at(std::string_view text, std::size_t at) {
  return at < text.size() && std::isdigit(static_cast<unsigned char>(text[at])) != 0;
}

// The number behind a word. A comma between digits is a decimal one, which some devices write by
// their language: "latitude: 47,000100".
std::optional<double> value_of(std::string_view text, std::string_view word) {
  const auto rest = behind(text, word);
  if (!rest) return std::nullopt;
  std::string number(rest->substr(0, kMaxNumberBytes));
  const std::size_t first = std::min(number.find_first_of("0123456789"), number.size());
  const std::size_t end = std::min(number.find_first_not_of("0123456789", first), number.size());
  if (end > first && end < number.size() && number[end] == ',' && is_digit_at(number, end + 1))
    number[end] = '.';
  return number_at_start(number);
}

std::optional<double> first_of(std::string_view text,
                               std::initializer_list<std::string_view> words) {
  for (const std::string_view word : words)
    if (const auto value = value_of(text, word)) return value;
  return std::nullopt;
}

// "00:01:02,033" in seconds. A fraction of other than three digits has no sure meaning.
std::optional<double> time_of(std::string_view text) {
  constexpr std::ptrdiff_t kFractionDigits = 3;
  int parts[4] = {};
  const char* at = text.data();
  const char* end = at + text.size();
  for (int& part : parts) {
    const auto [rest, failed] = std::from_chars(at, end, part);
    if (failed != std::errc() || part < 0) return std::nullopt;
    if (&part == &parts[3] && rest - at != kFractionDigits) return std::nullopt;
    at = rest < end ? rest + 1 : end;
  }
  return 3600.0 * parts[0] + 60.0 * parts[1] + parts[2] + 0.001 * parts[3];
}

// The text with points for the commas between digits in the brackets at its beginning, where two
// others are left between three numbers: "(8,5400, 47,0012, 16)", and not "(8.54,47.0012,16)".
std::string with_decimal_points(std::string_view text) {
  std::string changed(text);
  std::size_t others = 0;
  const std::size_t end = std::min(text.find(')'), text.size());
  for (std::size_t at = 0; at < end; ++at) {
    if (text[at] != ',') continue;
    if (at > 0 && is_digit_at(text, at - 1) && is_digit_at(text, at + 1))
      changed[at] = '.';
    else
      ++others;
  }
  return others == 2 ? changed : std::string(text);
}

// The numbers in the brackets that follow; empty where there are not three.
std::optional<std::array<double, 3>> three_numbers(std::string_view after_word) {
  const std::string changed = with_decimal_points(after_word);
  std::string_view text = changed;
  std::array<double, 3> numbers{};
  for (double& number : numbers) {
    const auto value = number_at_start(text);
    if (!value) return std::nullopt;
    number = *value;
    text.remove_prefix(std::min(text.find(',') + 1, text.size()));
  }
  return numbers;
}

// Position of the older texts: GPS (longitude, latitude, satellites), or (latitude, longitude,
// height).
std::optional<Fix> fix_of_gps(std::string_view text) {
  const auto rest = behind(text, "GPS");
  const auto numbers = rest ? three_numbers(*rest) : std::nullopt;
  if (!numbers) return std::nullopt;
  const bool states_height = rest->substr(0, rest->find(')')).ends_with('M');
  Fix fix;
  fix.latitude_deg = (*numbers)[states_height ? 0 : 1];
  fix.longitude_deg = (*numbers)[states_height ? 1 : 0];
  fix.height_m = first_of(text, {"H", "BAROMETER", "Hb"});
  fix.altitude_m = fix.height_m.value_or(0);
  return fix;
}

// The attitude of the gimbal in either text.
std::optional<YawPitchRoll> gimbal_of(std::string_view text) {
  const auto yaw = value_of(text, "gb_yaw"), pitch = value_of(text, "gb_pitch");
  const auto roll = value_of(text, "gb_roll");
  if (yaw && pitch && roll) return YawPitchRoll{*yaw, *pitch, *roll};
  const auto rest = behind(text, "G.PRY");
  const auto angles = rest ? three_numbers(*rest) : std::nullopt;
  if (!angles) return std::nullopt;
  return YawPitchRoll{(*angles)[2], (*angles)[0], (*angles)[1]};
}

std::optional<Fix> fix_of_keys(std::string_view text) {
  const auto latitude = value_of(text, "latitude");
  const auto longitude =
      first_of(text, {"longitude", "longtitude"});  // early firmware misspells it
  if (!latitude || !longitude) return std::nullopt;
  Fix fix;
  fix.latitude_deg = *latitude;
  fix.longitude_deg = *longitude;
  fix.height_m = value_of(text, "rel_alt");
  fix.altitude_m = first_of(text, {"abs_alt", "altitude"}).value_or(fix.height_m.value_or(0));
  return fix;
}

void add_block(FlightLog& log, std::string_view block, double time_s, const Where& where) {
  auto fix = fix_of_keys(block);
  if (!fix) fix = fix_of_gps(block);
  // 0, 0 is what these aircraft write while no satellites are seen.
  if (!fix || (fix->latitude_deg == 0 && fix->longitude_deg == 0)) return void(++log.left_out);
  fix->time_s = time_s;
  add_record(log, *fix, where);
  if (const auto gimbal = gimbal_of(block)) add_record(log, Attitude{time_s, *gimbal}, where);
}

// The number with which a block begins.
bool is_counter(std::string_view line) {
  line = trimmed(line);
  return !line.empty() && line.find_first_not_of("0123456789") == std::string_view::npos;
}

}  // namespace

bool is_dji_subtitles(std::string_view content) {
  const std::string_view head = content.substr(0, kTypeHeadBytes);
  return head.find("-->") != std::string_view::npos;
}

void add_dji_subtitle(FlightLog& log,
                      std::string_view text,
                      double time_s,
                      const std::string& file) {
  add_block(log, text, time_s, {file});
}

FlightLog from_dji_subtitles(std::string_view text, const std::string& file) {
  FlightLog log;
  log.format = Format::kDjiSubtitles;
  log.is_on_video_clock = true;
  std::string block;
  std::optional<double> time_s;
  int line_of_block = 0;
  const auto begin_block = [&](int line) {
    const Where where{file, line_of_block};
    if (time_s)
      add_block(log, block, *time_s, where);
    else if (fix_of_keys(block) || fix_of_gps(block))
      leave_out(log, "the block has no line with -->, which states its time", where);
    block.clear();
    time_s.reset();
    line_of_block = line;
  };
  for (int number = 1; !text.empty(); ++number) {
    const std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(line.size() + 1, text.size()));
    if (const std::size_t arrow = line.find("-->"); arrow != std::string_view::npos) {
      begin_block(number);
      time_s = time_of(line.substr(0, arrow));
      if (!time_s)
        throw Error(fmt::format("time is '{}'; expected one such as 00:01:02,033",
                                printable(line.substr(0, arrow))),
                    {file, number});
    } else if (is_counter(line)) {
      begin_block(number);
    } else {
      block.append(line).push_back(' ');
    }
  }
  begin_block(0);
  return log;
}

}  // namespace airtruth::flight_log
