// SPDX-License-Identifier: Apache-2.0
// PX4 ULog, version 1. Source: PX4 Autopilot User Guide, "ULog File Format"; the topics are PX4's
// uORB messages vehicle_global_position, vehicle_gps_position, sensor_gps, vehicle_local_position,
// vehicle_attitude, vehicle_angular_velocity and sensor_combined.
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/text.h"
#include "scene/flight_log/formats.h"

namespace airtruth::flight_log {
namespace {

constexpr std::string_view kMagic("ULog\x01\x12\x35", 7);
// The types of messages, and the whole of a synchronisation message: its length, type and magic.
constexpr std::string_view kTypes = "BFIMPQADRLCSO";
constexpr std::string_view kSync("\x08\x00S\x2f\x73\x13\x20\x25\x0c\xbb\x12", 11);
// Lengths of the header of a file and of a message's.
constexpr std::size_t kHeaderBytes = 16;
constexpr std::size_t kMessageHeadBytes = 3;
// How far from 1 the norm of an attitude's quaternion may be, which is written as floats.
constexpr double kUnitTolerance = 0.1;
constexpr int kMaxNesting = 8;  // formats of PX4 nest once
// The largest array of one field, and a length that no message has: PX4's largest has fewer bytes.
constexpr std::size_t kMaxCount = 4096;

struct Field {
  std::string type;
  std::size_t count = 1;
  std::string name;
};
struct Definition {
  std::vector<Field> fields;
  std::optional<std::size_t> size;  // in bytes; once it was asked for
};
using Formats = std::map<std::string, Definition, std::less<>>;

std::size_t size_of_type(std::string_view type) {
  static const std::map<std::string_view, std::size_t> kSizes = {{"int8_t", 1},
                                                                 {"uint8_t", 1},
                                                                 {"int16_t", 2},
                                                                 {"uint16_t", 2},
                                                                 {"int32_t", 4},
                                                                 {"uint32_t", 4},
                                                                 {"int64_t", 8},
                                                                 {"uint64_t", 8},
                                                                 {"float", 4},
                                                                 {"double", 8},
                                                                 {"bool", 1},
                                                                 {"char", 1}};
  const auto found = kSizes.find(type);
  return found == kSizes.end() ? 0 : found->second;
}

// "float[4] q" or "double lat"; empty where the text is neither.
std::optional<Field> field_of(std::string_view text) {
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos || blank == 0) return std::nullopt;
  std::string_view type = text.substr(0, blank);
  Field field;
  field.name = text.substr(blank + 1);
  if (const std::size_t open = type.find('['); open != std::string_view::npos) {
    const char* end = type.data() + type.size() - 1;
    const auto [rest, failed] = std::from_chars(type.data() + open + 1, end, field.count);
    if (failed != std::errc() || rest != end || *end != ']' || field.count == 0 ||
        field.count > kMaxCount)
      return std::nullopt;
    type = type.substr(0, open);
  }
  field.type = type;
  return field;
}

// Where a field of a topic stands in its message, in bytes.
struct Place {
  std::size_t at = 0;
  std::string type;
  std::size_t count = 1;
};
using Topic = std::map<std::string, Place, std::less<>>;

struct Subscription {
  std::string name;
  int instance = 0;
  Topic topic;
};

class UlogReader {
 public:
  UlogReader(std::string_view bytes, std::string file) : bytes_(bytes), file_(std::move(file)) {
    log_.format = Format::kUlog;
  }

  FlightLog read() {
    if (bytes_.size() < kHeaderBytes) fail("is cut off within its header; expected 16 bytes", 0);
    std::size_t at = kHeaderBytes;
    // A log whose aircraft lost power ends within a message, of which it holds a true head. All
    // messages before count.
    while (bytes_.size() - at >= kMessageHeadBytes) {
      const std::size_t size = little_endian<std::uint16_t>(bytes_, at);
      const char type = bytes_[at + 2];
      const bool is_whole = bytes_.size() - at - kMessageHeadBytes >= size;
      const bool is_known = kTypes.find(type) != std::string_view::npos;
      if (is_whole && is_known) {
        message(type, bytes_.substr(at + kMessageHeadBytes, size), at);
        at += kMessageHeadBytes + size;
        continue;
      }
      // What is damaged ends at the next synchronisation message.
      const std::size_t next = bytes_.find(kSync, at + 1);
      if (next == std::string_view::npos) {
        if (!is_known || size >= kMaxCount)
          leave_out(log_, fmt::format("is damaged from byte {} to its end", at), {file_});
        break;
      }
      leave_out(
          log_, fmt::format("is damaged from byte {}; it goes on at byte {}", at, next), {file_});
      at = next;
    }
    choose_positions();
    return from_first_record(std::move(log_));
  }

 private:
  [[noreturn]] void fail(const std::string& message, std::size_t at) const {
    throw Error(at > 0 ? fmt::format("{} (byte {})", message, at) : message, {file_});
  }

  void message(char type, std::string_view body, std::size_t at) {
    if (type == 'F') add_format(body, at);
    if (type == 'A') subscribe(body, at);
    if (type == 'D') data(body, at);
  }

  void add_format(std::string_view body, std::size_t at) {
    const std::size_t colon = body.find(':');
    if (colon == std::string_view::npos) fail("a format has no name", at);
    std::vector<Field> fields;
    std::string_view rest = body.substr(colon + 1);
    while (!rest.empty()) {
      const std::size_t end = std::min(rest.find(';'), rest.size());
      if (end > 0) {
        const auto field = field_of(rest.substr(0, end));
        if (!field) fail("a format has a field that is no type and name", at);
        fields.push_back(*field);
      }
      rest.remove_prefix(std::min(end + 1, rest.size()));
    }
    formats_[std::string(body.substr(0, colon))] = {std::move(fields), std::nullopt};
  }

  // Each definition is walked once, however many fields are of it.
  std::size_t size_of(const Field& field, int depth, std::size_t at) {
    if (const std::size_t size = size_of_type(field.type)) return size * field.count;
    const auto format = formats_.find(field.type);
    if (format == formats_.end() || depth > kMaxNesting)
      fail(fmt::format("a field has the unknown type '{}'", printable(field.type)), at);
    auto& [fields, known_size] = format->second;
    if (known_size) return *known_size * field.count;
    std::size_t size = 0;
    for (const Field& part : fields) size += size_of(part, depth + 1, at);
    if (size > kMaxCount * 8) fail("a format is too large", at);
    known_size = size;
    return size * field.count;
  }

  void subscribe(std::string_view body, std::size_t at) {
    if (body.size() < 4) fail("a subscription is cut off", at);
    const std::string name(body.substr(3));
    const auto format = formats_.find(name);
    if (format == formats_.end())
      fail(fmt::format("subscribes '{}' before its format", printable(name)), at);
    Topic topic;
    std::size_t place = 0;
    for (const Field& field : format->second.fields) {
      topic[field.name] = {place, field.type, field.count};
      place += size_of(field, 0, at);
    }
    const auto instance = static_cast<std::uint8_t>(body[0]);
    topics_[little_endian<std::uint16_t>(body, 1)] = {name, instance, std::move(topic)};
  }

  // The number in a field; empty where the topic or the message lacks it.
  static std::optional<double> number(const Topic& topic,
                                      std::string_view body,
                                      std::string_view name,
                                      std::size_t index = 0) {
    const auto found = topic.find(name);
    if (found == topic.end() || index >= found->second.count) return std::nullopt;
    const std::string& type = found->second.type;
    const std::size_t size = size_of_type(type);
    const std::size_t at = found->second.at + index * size;
    if (size == 0 || at + size > body.size()) return std::nullopt;
    if (type == "double") return little_endian<double>(body, at);
    if (type == "float") return little_endian<float>(body, at);
    if (type == "int32_t") return little_endian<std::int32_t>(body, at);
    if (type == "uint32_t") return little_endian<std::uint32_t>(body, at);
    if (type == "uint64_t") return static_cast<double>(little_endian<std::uint64_t>(body, at));
    if (type == "uint8_t" || type == "bool") return static_cast<std::uint8_t>(body[at]);
    return std::nullopt;
  }

  void data(std::string_view body, std::size_t at) {
    if (body.size() < 2) fail("a data message is cut off", at);
    const auto found = topics_.find(little_endian<std::uint16_t>(body, 0));
    if (found == topics_.end()) return;
    const auto& [name, instance, topic] = found->second;
    const std::string_view values = body.substr(2);
    const auto microseconds = number(topic, values, "timestamp");
    if (!microseconds) return;
    const double time_s = *microseconds * 1e-6;
    if (name == "vehicle_gps_position" || name == "sensor_gps")
      add_position(receivers_[instance], topic, values, time_s, at);
    // Other topics beyond the first instance come from spare sensors and estimators.
    if (instance != 0) return;
    if (name == "vehicle_global_position") add_position(global_, topic, values, time_s, at);
    if (name == "vehicle_local_position") keep_height(topic, values);
    if (name == "vehicle_attitude") add_quaternion(topic, values, time_s, at);
    if (name == "vehicle_angular_velocity") add_rate(angular_, topic, values, "xyz", time_s, at);
    if (name == "sensor_combined") add_rate(combined_, topic, values, "gyro_rad", time_s, at);
  }

  // Degrees and metres in the newer topics; 1e-7 degrees and millimetres in the older ones.
  void add_position(
      FlightLog& log, const Topic& topic, std::string_view body, double time_s, std::size_t at) {
    // fix_type of a position in three dimensions.
    constexpr double kFix3d = 3;
    const auto fix_type = number(topic, body, "fix_type");
    if (fix_type && *fix_type < kFix3d) return void(++log.left_out);
    Fix fix;
    fix.time_s = time_s;
    fix.height_m = height_m_;
    if (const auto latitude = number(topic, body, "latitude_deg")) {
      fix.latitude_deg = *latitude;
      fix.longitude_deg = number(topic, body, "longitude_deg").value_or(NAN);
      fix.altitude_m = number(topic, body, "altitude_msl_m").value_or(NAN);
    } else {
      const auto lat = number(topic, body, "lat"), lon = number(topic, body, "lon");
      const auto alt = number(topic, body, "alt");
      if (!lat || !lon || !alt) return;
      const bool is_whole = topic.find("lat")->second.type == "int32_t";
      fix.latitude_deg = is_whole ? *lat * 1e-7 : *lat;
      fix.longitude_deg = is_whole ? *lon * 1e-7 : *lon;
      fix.altitude_m = is_whole ? *alt * 1e-3 : *alt;
    }
    add_record(log, fix, {fmt::format("{} (byte {})", file_, at)});
  }

  // z of the local position counts down from the place of the first fix, which is that of take-off.
  void keep_height(const Topic& topic, std::string_view body) {
    if (const auto z = number(topic, body, "z"); z && std::isfinite(*z)) height_m_ = -*z;
  }

  void add_quaternion(const Topic& topic, std::string_view body, double time_s, std::size_t at) {
    std::array<double, 4> q{};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto value = number(topic, body, "q", i);
      if (!value) return;
      q[i] = *value;
    }
    const Quaternion world_from_body(q[0], q[1], q[2], q[3]);
    if (!(std::abs(world_from_body.norm() - 1) < kUnitTolerance))
      return leave_out(
          log_, "an attitude is no unit quaternion", {fmt::format("{} (byte {})", file_, at)});
    add_record(log_, Attitude{time_s, yaw_pitch_roll(world_from_body.normalized())}, {file_});
  }

  void add_rate(FlightLog& log,
                const Topic& topic,
                std::string_view body,
                std::string_view field,
                double time_s,
                std::size_t at) {
    Vector3 rate;
    for (int i = 0; i < 3; ++i) {
      const auto value = number(topic, body, field, static_cast<std::size_t>(i));
      if (!value) return;
      rate[i] = *value;
    }
    add_record(log, Rates{time_s, rate}, {fmt::format("{} (byte {})", file_, at)});
  }

  // The estimator's positions and rates, else those of the sensors.
  void choose_positions() {
    take_positions(log_, global_.fixes.size() >= 2 ? global_ : first_with_fix(receivers_));
    const FlightLog& rates = angular_.rates.empty() ? combined_ : angular_;
    log_.rates = rates.rates;
    log_.left_out += rates.left_out;
  }

  std::string_view bytes_;
  std::string file_;
  Formats formats_;
  std::map<std::uint16_t, Subscription> topics_;
  FlightLog log_, global_, angular_, combined_;
  std::map<int, FlightLog> receivers_;  // by instance
  std::optional<double> height_m_;
};

}  // namespace

bool is_ulog(std::string_view content) { return content.substr(0, kMagic.size()) == kMagic; }

FlightLog from_ulog(std::string_view bytes, const std::string& file) {
  return UlogReader(bytes, file).read();
}

}  // namespace airtruth::flight_log
