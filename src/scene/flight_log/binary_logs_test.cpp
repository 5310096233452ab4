// SPDX-License-Identifier: Apache-2.0
// Logs of binary formats, written here byte by byte as their specifications state.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "scene/flight_log/flight_log.h"
#include "support/error_of.h"

namespace airtruth::flight_log {
namespace {

template <typename T>
std::string bytes_of(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

// The text, filled with zeros to a length.
std::string padded(std::string_view text, std::size_t length) {
  std::string result(length, '\0');
  std::copy(text.begin(), text.end(), result.begin());
  return result;
}

std::string joined(std::initializer_list<std::string_view> parts) {
  std::string result;
  for (const std::string_view part : parts) result.append(part);
  return result;
}

std::string byte(std::uint8_t value) { return bytes_of(value); }

// ---------------------------------------------------------------- PX4 ULog

std::string ulog_message(char type, const std::string& body) {
  return joined({bytes_of(static_cast<std::uint16_t>(body.size())), {&type, 1}, body});
}

std::string ulog_header() {
  return std::string("ULog\x01\x12\x35\x01", 8) + bytes_of(std::uint64_t{0});
}

std::string subscription(std::uint16_t id, const std::string& name, std::uint8_t instance = 0) {
  return ulog_message('A', joined({bytes_of(instance), bytes_of(id), name}));
}

std::string data(std::uint16_t id, const std::string& values) {
  return ulog_message('D', bytes_of(id) + values);
}

std::string small_ulog() {
  const float half = std::sqrt(0.5F);
  std::string log = ulog_header() + ulog_message('B', std::string(40, '\0'));
  log += ulog_message(
      'F',
      "vehicle_global_position:uint64_t timestamp;double lat;double lon;float alt;float[2] spare;");
  log += ulog_message(
      'F', "vehicle_attitude:uint64_t timestamp;float[4] q;uint8_t reset;uint8_t[3] _padding0;");
  log += ulog_message('F', "vector:float x;float y;float z;");
  log += ulog_message('F', "sensor_combined:uint64_t timestamp;vector before;float[3] gyro_rad;");
  log += subscription(0, "vehicle_global_position") + subscription(1, "vehicle_attitude") +
         subscription(2, "sensor_combined") + subscription(3, "vehicle_attitude", 1);
  for (int i = 0; i < 3; ++i) {
    const auto time = bytes_of(std::uint64_t(5'000'000 + 100'000 * i));
    log += data(0,
                time + bytes_of(47.0 + 1e-5 * i) + bytes_of(8.5) + bytes_of(500.0F + float(i)) +
                    std::string(8, '\0'));
    // A turn by 90 degrees to the right about the axis down.
    log +=
        data(1, time + bytes_of(half) + bytes_of(0.0F) + bytes_of(0.0F) + bytes_of(half) + byte(0));
    log +=
        data(2, time + std::string(12, '\1') + bytes_of(0.25F) + bytes_of(-0.5F) + bytes_of(1.0F));
    log += data(3, time + std::string(16, '\0') + byte(0));  // a spare estimator, not read
  }
  return log;
}

TEST(Ulog, TopicsOfItsOwnFormatsAreRead) {
  const FlightLog log = parse_flight_log(small_ulog(), "a.ulg");
  EXPECT_EQ(log.format, Format::kUlog);
  EXPECT_FALSE(log.is_on_video_clock);
  ASSERT_EQ(log.fixes.size(), 3u);
  EXPECT_NEAR(log.fixes[2].time_s, 0.2, 1e-9);
  EXPECT_DOUBLE_EQ(log.fixes[2].latitude_deg, 47.00002);
  EXPECT_DOUBLE_EQ(log.fixes[2].altitude_m, 502);
  ASSERT_EQ(log.attitudes.size(), 3u);
  EXPECT_NEAR(log.attitudes[0].angles.yaw_deg, 90, 1e-4);
  ASSERT_EQ(log.rates.size(), 3u);
  EXPECT_TRUE(log.rates[0].in_body_radps.isApprox(Vector3(0.25, -0.5, 1)));
}

TEST(Ulog, OlderSatelliteTopicsAreInWholeNumbers) {
  std::string log = ulog_header();
  log += ulog_message('F',
                      "vehicle_gps_position:uint64_t timestamp;int32_t lat;int32_t lon;int32_t "
                      "alt;uint8_t fix_type;");
  log += subscription(7, "vehicle_gps_position");
  for (int i = 0; i < 3; ++i)
    log += data(7,
                bytes_of(std::uint64_t(1'000'000 * i)) + bytes_of(std::int32_t{-471234567}) +
                    bytes_of(std::int32_t{85000000}) + bytes_of(std::int32_t{512345}) +
                    byte(i == 0 ? 1 : 3));
  const FlightLog read = parse_flight_log(log, "a.ulg");
  ASSERT_EQ(read.fixes.size(), 2u);
  EXPECT_EQ(read.left_out, 1);
  EXPECT_NEAR(read.fixes[0].latitude_deg, -47.1234567, 1e-9);
  EXPECT_NEAR(read.fixes[0].altitude_m, 512.345, 1e-9);
}

// Positions of a satellite receiver: its number in the log, and the kind of fix.
std::string receiver_data(std::uint16_t id, int i, char fix_type) {
  return data(id,
              bytes_of(std::uint64_t(1'000'000 * i)) + bytes_of(std::int32_t{471234567 + i}) +
                  bytes_of(std::int32_t{85000000}) + bytes_of(std::int32_t{512345}) +
                  byte(fix_type));
}

std::string receiver_subscription(std::uint16_t id, char instance) {
  std::string text = subscription(id, "vehicle_gps_position");
  text[3] = instance;  // behind the head of the message
  return text;
}

constexpr const char* kReceiverFormat =
    "vehicle_gps_position:uint64_t timestamp;int32_t lat;int32_t lon;int32_t alt;uint8_t fix_type;";

TEST(Ulog, TheFirstReceiverWithAFixIsRead) {
  std::string log = ulog_header() + ulog_message('F', kReceiverFormat);
  log += receiver_subscription(7, 0) + receiver_subscription(8, 1);
  for (int i = 0; i < 4; ++i) log += receiver_data(7, i, 1) + receiver_data(8, i, 3);
  EXPECT_EQ(parse_flight_log(log, "a.ulg").fixes.size(), 4u);
}

// ULog File Format, "Sync Message": a reader goes on there after damage.
TEST(Ulog, ADamagedPartEndsAtTheNextSynchronisation) {
  const std::string sync = ulog_message('S', "\x2f\x73\x13\x20\x25\x0c\xbb\x12");
  std::string log = ulog_header() + ulog_message('F', kReceiverFormat);
  log += receiver_subscription(7, 0);
  for (int i = 0; i < 4; ++i) log += receiver_data(7, i, 3);
  log += std::string(50, '\xff') + sync;
  for (int i = 4; i < 8; ++i) log += receiver_data(7, i, 3);
  const FlightLog read = parse_flight_log(log, "a.ulg");
  EXPECT_EQ(read.fixes.size(), 8u);
  EXPECT_THAT(read.first_fault, testing::HasSubstr("damaged from byte"));
}

// Record 4 has a wrong type or a wrong length. A record that is cut off is no damage.
TEST(Ulog, DamageToTheEndIsSaid) {
  std::string log =
      ulog_header() + ulog_message('F', kReceiverFormat) + receiver_subscription(7, 0);
  for (int i = 0; i < 4; ++i) log += receiver_data(7, i, 3);
  const std::string record = receiver_data(7, 4, 3);
  const auto fault_with = [&](const std::string& end) {
    const FlightLog read = parse_flight_log(log + end, "a.ulg");
    EXPECT_EQ(read.fixes.size(), 4u);
    return read.first_fault;
  };
  const std::string said =
      "a.ulg: is damaged from byte " + std::to_string(log.size()) + " to its end";
  EXPECT_EQ(fault_with(record.substr(0, 2) + '\xee' + record.substr(3) + record), said);
  EXPECT_EQ(fault_with("\xff\xff" + record.substr(2) + record), said);
  EXPECT_EQ(fault_with(record.substr(0, 20)), "");
}

TEST(Ulog, ALogCutOffAnywhereIsReadUpToThereOrRefused) {
  const std::string whole = small_ulog();
  for (std::size_t n = 0; n < whole.size(); ++n) {
    try {
      const FlightLog log = parse_flight_log(std::string_view(whole).substr(0, n), "a.ulg");
      EXPECT_GE(log.fixes.size(), 2u);
      EXPECT_GT(n, whole.size() / 2);
    } catch (const Error&) {
    }
  }
}

TEST(Ulog, WrongDefinitionsAreErrors) {
  const auto error_of = [](const std::string& messages) {
    return test_support::error_of([&] { parse_flight_log(ulog_header() + messages, "a.ulg"); });
  };
  EXPECT_EQ(error_of(subscription(0, "vehicle_attitude")),
            "a.ulg: subscribes 'vehicle_attitude' before its format (byte 16)");
  EXPECT_EQ(error_of(ulog_message('F', "loop:loop again;") + subscription(0, "loop")),
            "a.ulg: a field has the unknown type 'loop' (byte 35)");
  EXPECT_EQ(error_of(ulog_message('F', "a:float[0] x;")),
            "a.ulg: a format has a field that is no type and name (byte 16)");
}

// Eight formats, each with 200 fields of the one before: 200^8 walks of the first, one a field.
TEST(Ulog, ADefinitionIsWalkedOnceHoweverManyFieldsAreOfIt) {
  std::string log = ulog_header() + ulog_message('F', "A:");
  std::string name = "A";
  for (char next = 'B'; next <= 'I'; ++next) {
    std::string fields(1, next);
    fields += ':';
    for (int i = 0; i < 200; ++i) fields += name + " x;";
    log += ulog_message('F', fields);
    name = std::string(1, next);
  }
  log += subscription(0, name);
  EXPECT_THAT(test_support::error_of([&] { parse_flight_log(log, "a.ulg"); }),
              testing::HasSubstr("holds 0 positions"));
}

// ---------------------------------------------------------------- ArduPilot DataFlash

std::string dataflash_format(std::uint8_t type,
                             std::uint8_t length,
                             const char* name,
                             const char* letters,
                             const char* labels) {
  return joined({"\xa3\x95\x80",
                 byte(type),
                 byte(length),
                 padded(name, 4),
                 padded(letters, 16),
                 padded(labels, 64)});
}

std::string dataflash_message(std::uint8_t type, const std::string& body) {
  return joined({"\xa3\x95", byte(type), body});
}

std::string small_dataflash() {
  std::string log = dataflash_format(128, 89, "FMT", "BBnNZ", "Type,Length,Name,Format,Columns");
  log += dataflash_format(1, 31, "POS", "QLLfff", "TimeUS,Lat,Lng,Alt,RelHomeAlt,RelOriginAlt");
  log += dataflash_format(2, 17, "ATT", "QccC", "TimeUS,Roll,Pitch,Yaw");
  log += dataflash_format(3, 24, "IMU", "QBfff", "TimeUS,I,GyrX,GyrY,GyrZ");
  for (int i = 0; i < 3; ++i) {
    const auto time = bytes_of(std::uint64_t(7'000'000 + 200'000 * i));
    log += dataflash_message(1,
                             time + bytes_of(std::int32_t{471234567}) +
                                 bytes_of(std::int32_t{-85000000}) + bytes_of(600.5F) +
                                 bytes_of(80.25F) + bytes_of(80.0F));
    log += dataflash_message(2,
                             time + bytes_of(std::int16_t{-150}) + bytes_of(std::int16_t{225}) +
                                 bytes_of(std::uint16_t{35950}));
    for (int unit = 0; unit < 2; ++unit)
      log += dataflash_message(3,
                               time + byte(static_cast<std::uint8_t>(unit)) +
                                   bytes_of(0.1F + float(unit)) + bytes_of(0.2F) + bytes_of(0.3F));
    log += "lost";  // a block that the logger could not write
  }
  return log;
}

TEST(DataFlash, MessagesOfItsOwnFormatsAreRead) {
  const FlightLog log = parse_flight_log(small_dataflash(), "a.bin");
  EXPECT_EQ(log.format, Format::kDataFlash);
  ASSERT_EQ(log.fixes.size(), 3u);
  EXPECT_NEAR(log.fixes[1].time_s, 0.2, 1e-9);
  EXPECT_NEAR(log.fixes[0].latitude_deg, 47.1234567, 1e-9);
  EXPECT_NEAR(log.fixes[0].longitude_deg, -8.5, 1e-9);
  EXPECT_DOUBLE_EQ(log.fixes[0].altitude_m, 600.5);
  EXPECT_DOUBLE_EQ(log.fixes[0].height_m.value(), 80.25);
  ASSERT_EQ(log.attitudes.size(), 3u);
  EXPECT_NEAR(log.attitudes[0].angles.roll_deg, -1.5, 1e-9);
  EXPECT_NEAR(log.attitudes[0].angles.yaw_deg, 359.5, 1e-9);
  ASSERT_EQ(log.rates.size(), 3u);
  EXPECT_NEAR(log.rates[0].in_body_radps.x(), 0.1, 1e-6);
}

TEST(DataFlash, ALogCutOffAnywhereIsReadUpToThereOrRefused) {
  const std::string whole = small_dataflash();
  for (std::size_t n = 0; n < whole.size(); ++n) {
    try {
      EXPECT_GE(parse_flight_log(std::string_view(whole).substr(0, n), "a.bin").fixes.size(), 2u);
    } catch (const Error&) {
    }
  }
}

// ---------------------------------------------------------------- GoPro GPMF

using Bytes = std::vector<std::uint8_t>;

void append_big_endian(Bytes& bytes, std::int64_t value, int width) {
  for (int i = width - 1; i >= 0; --i) bytes.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
}

Bytes gpmf_element(
    const char* key, char type, std::uint8_t size, std::uint16_t count, const Bytes& data) {
  Bytes result(key, key + 4);
  result.push_back(static_cast<std::uint8_t>(type));
  result.push_back(size);
  append_big_endian(result, count, 2);
  result.insert(result.end(), data.begin(), data.end());
  while (result.size() % 4 != 0) result.push_back(0);
  return result;
}

Bytes together(std::initializer_list<Bytes> parts) {
  Bytes result;
  for (const Bytes& part : parts) result.insert(result.end(), part.begin(), part.end());
  return result;
}

Bytes numbers(std::initializer_list<std::int64_t> values) {
  Bytes result;
  for (const auto value : values) append_big_endian(result, value, 4);
  return result;
}

Bytes packet_of(const Bytes& stream) {
  const Bytes inner = gpmf_element("STRM", 0, 1, static_cast<std::uint16_t>(stream.size()), stream);
  return gpmf_element("DEVC", 0, 1, static_cast<std::uint16_t>(inner.size()), inner);
}

TEST(GpmfPositions, Gps5IsSpreadOverItsPacket) {
  const Bytes scale =
      gpmf_element("SCAL", 'l', 4, 5, numbers({10000000, 10000000, 1000, 1000, 100}));
  const Bytes positions =
      numbers({331265000, -1173270000, 12500, 0, 0, 331265100, -1173270000, 13500, 0, 0});
  for (const std::int64_t fix : {3, 0}) {
    const Bytes packet = packet_of(together({gpmf_element("GPSF", 'L', 4, 1, numbers({fix})),
                                             scale,
                                             gpmf_element("GPS5", 'l', 20, 2, positions)}));
    FlightLog log;
    add_gpmf_packet(log, packet, 2, 3);
    if (fix == 0) {
      EXPECT_TRUE(log.fixes.empty());
      EXPECT_EQ(log.left_out, 2);
      continue;
    }
    ASSERT_EQ(log.fixes.size(), 2u);
    EXPECT_DOUBLE_EQ(log.fixes[0].time_s, 2.25);
    EXPECT_DOUBLE_EQ(log.fixes[0].latitude_deg, 33.1265);
    EXPECT_DOUBLE_EQ(log.fixes[1].longitude_deg, -117.327);
    EXPECT_DOUBLE_EQ(log.fixes[1].altitude_m, 13.5);
    for (std::size_t n = 0; n < packet.size(); ++n) {
      FlightLog part;
      add_gpmf_packet(part, std::span(packet).first(n), 0, 1);
    }
  }
}

TEST(GpmfPositions, Gps9StatesTheFixOfEachPosition) {
  const auto position = [](std::int64_t latitude, std::int64_t fix) {
    Bytes bytes = numbers({latitude, 85000000, 500000, 0, 0, 8500, 43200000});
    append_big_endian(bytes, 150, 2);
    append_big_endian(bytes, fix, 2);
    return bytes;
  };
  const Bytes packet = packet_of(together(
      {gpmf_element(
           "SCAL", 'l', 4, 9, numbers({10000000, 10000000, 1000, 1000, 100, 1, 1000, 100, 1})),
       gpmf_element(
           "GPS9", '?', 32, 2, together({position(471000000, 2), position(471000100, 3)}))}));
  FlightLog log;
  add_gpmf_packet(log, packet, 0, 1);
  ASSERT_EQ(log.fixes.size(), 1u);
  EXPECT_DOUBLE_EQ(log.fixes[0].time_s, 0.75);
  EXPECT_DOUBLE_EQ(log.fixes[0].latitude_deg, 47.10001);
  EXPECT_EQ(log.left_out, 1);
}

}  // namespace
}  // namespace airtruth::flight_log
