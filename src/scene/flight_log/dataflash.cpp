// SPDX-License-Identifier: Apache-2.0
// ArduPilot DataFlash logs (.bin). Source: ArduPilot developer documentation, "Log File Format" and
// the list of log messages: FMT describes every other message; POS, GPS, ATT, IMU are read.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "scene/flight_log/formats.h"

namespace airtruth::flight_log {
namespace {

// The two bytes with which each message begins, the type of FMT, and the length of the head.
constexpr char kHead1 = '\xa3', kHead2 = '\x95';
constexpr std::uint8_t kFormatType = 128;
constexpr std::size_t kHeadBytes = 3;
constexpr std::size_t kFormatBytes = 89;  // head, type, length, name[4], format[16], labels[64]
constexpr double kStatusFix3d = 3;        // GPS.Status

// A letter of a format: the bytes of its values and, of numbers, how one is read.
struct Letter {
  char letter;
  std::size_t size;
  double scale = 1;
  double (*number)(std::string_view bytes, std::size_t at) = nullptr;
};

template <typename T>
constexpr Letter letter_of_numbers(char letter, double scale = 1) {
  return {letter, sizeof(T), scale, [](std::string_view bytes, std::size_t at) {
            return static_cast<double>(little_endian<T>(bytes, at));
          }};
}

constexpr auto kLetters = std::to_array<Letter>({letter_of_numbers<std::int8_t>('b'),
                                                 letter_of_numbers<std::uint8_t>('B'),
                                                 letter_of_numbers<std::uint8_t>('M'),
                                                 letter_of_numbers<std::int16_t>('h'),
                                                 letter_of_numbers<std::uint16_t>('H'),
                                                 letter_of_numbers<std::int16_t>('c', 0.01),
                                                 letter_of_numbers<std::uint16_t>('C', 0.01),
                                                 letter_of_numbers<std::int32_t>('i'),
                                                 letter_of_numbers<std::uint32_t>('I'),
                                                 letter_of_numbers<std::int32_t>('e', 0.01),
                                                 letter_of_numbers<std::uint32_t>('E', 0.01),
                                                 letter_of_numbers<std::int32_t>('L', 1e-7),
                                                 letter_of_numbers<std::int64_t>('q'),
                                                 letter_of_numbers<std::uint64_t>('Q'),
                                                 letter_of_numbers<float>('f'),
                                                 letter_of_numbers<double>('d'),
                                                 {'g', 2},
                                                 {'n', 4},
                                                 {'N', 16},
                                                 {'Z', 64},
                                                 {'a', 64}});

struct MessageColumn {
  const Letter* letter = nullptr;
  std::size_t at = 0;
};
struct Kind {
  std::string name;
  std::size_t length = 0;  // of the whole message
  std::map<std::string, MessageColumn, std::less<>> columns;
};

std::string_view until_zero(std::string_view text) { return text.substr(0, text.find('\0')); }

// The kind of message that an FMT message describes; empty where its letters and labels disagree
// with its length.
std::optional<Kind> kind_of(std::string_view body) {
  Kind kind;
  kind.length = static_cast<std::uint8_t>(body[1]);
  kind.name = until_zero(body.substr(2, 4));
  const std::string_view letters = until_zero(body.substr(6, 16));
  std::string_view labels = until_zero(body.substr(22, 64));
  std::size_t at = kHeadBytes;
  for (const char c : letters) {
    const auto letter = std::ranges::find(kLetters, c, &Letter::letter);
    if (letter == kLetters.end() || labels.empty()) return std::nullopt;
    const std::size_t comma = std::min(labels.find(','), labels.size());
    kind.columns[std::string(labels.substr(0, comma))] = {letter, at};
    labels.remove_prefix(std::min(comma + 1, labels.size()));
    at += letter->size;
  }
  return at == kind.length ? std::optional(kind) : std::nullopt;
}

class DataFlashReader {
 public:
  DataFlashReader(std::string_view bytes, std::string file)
      : bytes_(bytes), file_(std::move(file)) {
    log_.format = Format::kDataFlash;
  }

  FlightLog read() {
    std::size_t at = 0;
    while (bytes_.size() - at >= kHeadBytes) {
      const std::size_t length = length_at(at);
      if (length == 0) {
        // A logger that lost a block of memory goes on with the next message.
        ++at;
        continue;
      }
      if (bytes_.size() - at < length) break;  // the log ends where the battery was taken out
      message(bytes_.substr(at, length), at);
      at += length;
    }
    // The estimator's positions, else those of the first receiver that has a fix.
    take_positions(log_, position_.fixes.size() >= 2 ? position_ : first_with_fix(receivers_));
    return from_first_record(std::move(log_));
  }

 private:
  // The length of the message at a byte; 0 where there is none, or its type is not known.
  std::size_t length_at(std::size_t at) const {
    if (bytes_[at] != kHead1 || bytes_[at + 1] != kHead2) return 0;
    const auto type = static_cast<std::uint8_t>(bytes_[at + 2]);
    if (type == kFormatType) return kFormatBytes;
    const auto kind = kinds_.find(type);
    return kind == kinds_.end() ? 0 : kind->second.length;
  }

  void message(std::string_view bytes, std::size_t at) {
    const auto type = static_cast<std::uint8_t>(bytes[2]);
    if (type == kFormatType) {
      const auto kind = kind_of(bytes.substr(kHeadBytes));
      if (kind) kinds_[static_cast<std::uint8_t>(bytes[kHeadBytes])] = *kind;
      return;
    }
    const Kind& kind = kinds_.find(type)->second;
    const auto number = [&](std::string_view label) -> std::optional<double> {
      const auto column = kind.columns.find(label);
      if (column == kind.columns.end()) return std::nullopt;
      const auto& [letter, begin] = column->second;
      return letter->number != nullptr ? letter->scale * letter->number(bytes, begin) : NAN;
    };
    const auto microseconds = number("TimeUS");
    if (!microseconds) return;
    // Messages of a second GPS or inertial unit have an instance above 0.
    const double instance = number("I").value_or(0);
    if (instance != 0 && kind.name != "GPS") return;
    const Where where{fmt::format("{} (byte {})", file_, at)};
    const double time_s = *microseconds * 1e-6;
    const auto three = [&](const char* a, const char* b, const char* c) -> std::optional<Vector3> {
      const auto x = number(a), y = number(b), z = number(c);
      return x && y && z ? std::optional(Vector3(*x, *y, *z)) : std::nullopt;
    };
    if (kind.name == "POS" || kind.name == "GPS") {
      FlightLog& log = kind.name == "POS" ? position_ : receivers_[instance];
      if (kind.name == "GPS" && number("Status").value_or(0) < kStatusFix3d)
        ++log.left_out;
      else if (const auto p = three("Lat", "Lng", "Alt"))
        add_record(log, Fix{time_s, p->x(), p->y(), p->z(), number("RelHomeAlt")}, where);
    }
    if (kind.name == "ATT")
      if (const auto a = three("Yaw", "Pitch", "Roll"))
        add_record(log_, Attitude{time_s, {a->x(), a->y(), a->z()}}, where);
    if (kind.name == "IMU")
      if (const auto rates = three("GyrX", "GyrY", "GyrZ"))
        add_record(log_, Rates{time_s, *rates}, where);
  }

  std::string_view bytes_;
  std::string file_;
  std::map<std::uint8_t, Kind> kinds_;
  FlightLog log_, position_;
  std::map<double, FlightLog> receivers_;  // by instance
};

}  // namespace

bool is_dataflash(std::string_view content) {
  return content.size() >= kHeadBytes && content[0] == kHead1 && content[1] == kHead2 &&
         static_cast<std::uint8_t>(content[2]) == kFormatType;
}

FlightLog from_dataflash(std::string_view bytes, const std::string& file) {
  return DataFlashReader(bytes, file).read();
}

}  // namespace airtruth::flight_log
