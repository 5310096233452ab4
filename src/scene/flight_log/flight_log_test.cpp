// SPDX-License-Identifier: Apache-2.0
#include "scene/flight_log/flight_log.h"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "support/error_of.h"

namespace airtruth::flight_log {
namespace {

std::string error_of(std::string_view text, const char* name) {
  return test_support::error_of([&] { parse_flight_log(text, name); });
}

TEST(DjiSubtitles, TheKeysOfTodaysFirmwareAreRead) {
  const FlightLog log = parse_flight_log(
      "1\r\n00:00:00,000 --> 00:00:00,033\r\n<font size=\"28\">FrameCnt: 1, DiffTime: 33ms\r\n"
      "2023-05-06 12:00:00.123\r\n[iso: 100] [shutter: 1/1000.0] [latitude: 47.123456] [longitude: "
      "8.5] "
      "[rel_alt: 30.300 abs_alt: 500.100] [gb_yaw: 12.5 gb_pitch: -10.0 gb_roll: 0.5] "
      "</font>\r\n\r\n"
      "2\r\n00:01:02,040 --> 00:01:02,073\r\n[latitude: 47.123457] [longitude: 8.6] "
      "[rel_alt: 31.0 abs_alt: 501.0] [gb_yaw: 13 gb_pitch: -11 gb_roll: 0]\r\n",
      "a.srt");
  EXPECT_EQ(log.format, Format::kDjiSubtitles);
  EXPECT_TRUE(log.is_on_video_clock);
  ASSERT_EQ(log.fixes.size(), 2u);
  EXPECT_DOUBLE_EQ(log.fixes[0].latitude_deg, 47.123456);
  EXPECT_DOUBLE_EQ(log.fixes[0].altitude_m, 500.1);
  EXPECT_DOUBLE_EQ(log.fixes[0].height_m.value(), 30.3);
  EXPECT_DOUBLE_EQ(log.fixes[1].time_s, 62.04);
  ASSERT_EQ(log.attitudes.size(), 2u);
  EXPECT_DOUBLE_EQ(log.attitudes[0].angles.yaw_deg, 12.5);
  EXPECT_DOUBLE_EQ(log.attitudes[0].angles.pitch_deg, -10);
}

TEST(DjiSubtitles, OlderTextsStateLongitudeFirst) {
  const FlightLog mini = parse_flight_log(
      "1\n00:00:00,000 --> 00:00:01,000\nF/2.8, SS 206.14, ISO 150, EV 0, GPS (-122.1669, 37.4243, "
      "16), "
      "D 26.5m, H 6.00m, H.S 2.10m/s, V.S 0.30m/s\n\n"
      "2\n00:00:01,000 --> 00:00:02,000\nF/2.8, SS 206.14, ISO 150, EV 0, GPS (-122.1670, 37.4244, "
      "16), "
      "D 26.5m, H 7.50m, H.S 2.10m/s, V.S 0.30m/s\n",
      "a.srt");
  ASSERT_EQ(mini.fixes.size(), 2u);
  EXPECT_DOUBLE_EQ(mini.fixes[0].latitude_deg, 37.4243);
  EXPECT_DOUBLE_EQ(mini.fixes[0].longitude_deg, -122.1669);
  EXPECT_DOUBLE_EQ(mini.fixes[1].height_m.value(), 7.5);
  const FlightLog phantom = parse_flight_log(
      "1\n00:00:00,000 --> 00:00:01,000\nHOME(8.1,47.1) 2017.08.05 14:11:51\nGPS(8.2,47.2,16) "
      "BAROMETER:91.2\n"
      "ISO:100 Shutter:60 EV: Fnum:F2.8\n\n"
      "2\n00:00:01,000 --> 00:00:02,000\nHOME(8.1,47.1) 2017.08.05 14:11:52\nGPS(8.201,47.2,16) "
      "BAROMETER:91.4\n",
      "a.srt");
  ASSERT_EQ(phantom.fixes.size(), 2u);
  EXPECT_DOUBLE_EQ(phantom.fixes[1].longitude_deg, 8.201);
  EXPECT_DOUBLE_EQ(phantom.fixes[1].altitude_m, 91.4);
}

// The second block lost the line of its time: it is left out and named, and is not taken for a part
// of the first.
TEST(DjiSubtitles, ABlockWithoutATimeIsLeftOut) {
  const auto block = [](int number, const std::string& time, double latitude) {
    return fmt::format("{}\n{}[latitude: {}] [longitude: 8.5] [rel_alt: 30 abs_alt: 500]\n\n",
                       number,
                       time,
                       latitude);
  };
  const FlightLog log =
      parse_flight_log(block(1, "00:00:00,000 --> 00:00:01,000\n", 47.0) + block(2, "", 47.00001) +
                           block(3, "00:00:02,000 --> 00:00:03,000\n", 47.00002),
                       "a.srt");
  ASSERT_EQ(log.fixes.size(), 2u);
  EXPECT_DOUBLE_EQ(log.fixes[1].latitude_deg, 47.00002);
  EXPECT_EQ(log.left_out, 1);
  EXPECT_EQ(log.first_fault, "a.srt:5: the block has no line with -->, which states its time");
}

TEST(DjiSubtitles, AHeightInBracketsComesWithLatitudeFirstAndTheGimbalAsPitchRollYaw) {
  const FlightLog matrice = parse_flight_log(
      "1\n00:00:00,000 --> 00:00:01,000\n2022.06.21 16:06:17\nGPS(36.6,-6.1,0.0M) "
      "BAROMETER:0.3M\n\n"
      "2\n00:00:01,000 --> 00:00:02,000\n2022.06.21 16:06:18\nGPS(36.601,-6.101,0.0M) "
      "BAROMETER:1.3M\n",
      "a.srt");
  EXPECT_DOUBLE_EQ(matrice.fixes[1].latitude_deg, 36.601);
  EXPECT_DOUBLE_EQ(matrice.fixes[1].height_m.value(), 1.3);
  const FlightLog rtk = parse_flight_log(
      "1\n00:15:04,904 --> 00:15:05,905\nF/5.6, EV +0.7, GPS (-59.409424, -34.650200, 16), HOME "
      "(-59.407880, "
      "-34.650736, 7.60m), D 153.32m, H 17.39m, H.S 1.84m/s, F.PRY (-8.9\xc2\xb0, 2.9\xc2\xb0, "
      "-75.0\xc2\xb0), "
      "G.PRY (-27.3\xc2\xb0, 0.5\xc2\xb0, -76.0\xc2\xb0)\n\n2\n00:15:05,905 --> 00:15:06,906\nGPS "
      "(-59.409447, "
      "-34.650195, 16), H 17.33m\n",
      "a.srt");
  ASSERT_EQ(rtk.attitudes.size(), 1u);
  EXPECT_DOUBLE_EQ(rtk.attitudes[0].angles.yaw_deg, -76);
  EXPECT_DOUBLE_EQ(rtk.attitudes[0].angles.pitch_deg, -27.3);
  EXPECT_DOUBLE_EQ(rtk.attitudes[0].angles.roll_deg, 0.5);
  EXPECT_DOUBLE_EQ(rtk.fixes[0].latitude_deg, -34.6502);
  EXPECT_DOUBLE_EQ(rtk.fixes[0].height_m.value(), 17.39);
}

TEST(DjiSubtitles, FramesWithoutSatellitesAreLeftOutAndBadTimesNamed) {
  EXPECT_EQ(error_of("1\n00:00:00,000 --> 00:00:00,033\n[latitude: 0.0] [longitude: 0.0] [rel_alt: "
                     "1 abs_alt: 1]\n",
                     "a.srt"),
            "a.srt: holds 0 positions (DJI subtitles, 1 records left out); expected at least two");
  EXPECT_EQ(error_of("1\n00:0x --> 00:00:00,033\n", "a.srt"),
            "a.srt:2: time is '00:0x '; expected one such as 00:01:02,033");
  for (const char* time : {"00:00:00,5 ", "00:00:00,5000 "})
    EXPECT_THAT(error_of(std::string("1\n") + time + "--> 00:00:01,000\n", "a.srt"),
                testing::HasSubstr("a.srt:2: time is '00:00:00,5"));
  EXPECT_EQ(
      error_of("1\n00:00:00,000 --> 00:00:00,033\n[latitude: 95] [longitude: 0.0] [rel_alt: 1]\n",
               "a.srt"),
      "a.srt: holds 0 positions (DJI subtitles, 1 records left out, the first: a.srt:2: latitude "
      "is "
      "95; expected -90 to 90 degrees); expected at least two");
}

std::string subtitle(int i, const std::string& text) {
  return fmt::format("{}\n00:00:{:02d},000 --> 00:00:{:02d},500\n{}\n\n", i + 1, i, i, text);
}

TEST(DjiSubtitles, DecimalCommasAreDecimal) {
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += subtitle(i,
                     fmt::format("[latitude: 47,00010{}] [longitude: -8,5] [rel_alt: 30,100 "
                                 "abs_alt: 430,200]",
                                 i));
  const FlightLog log = parse_flight_log(text, "a.srt");
  EXPECT_DOUBLE_EQ(log.fixes.at(2).latitude_deg, 47.000102);
  EXPECT_DOUBLE_EQ(log.fixes.at(2).longitude_deg, -8.5);
  EXPECT_DOUBLE_EQ(log.fixes.at(2).height_m.value(), 30.1);
  EXPECT_DOUBLE_EQ(log.fixes.at(2).altitude_m, 430.2);
}

TEST(DjiSubtitles, DecimalCommasWithinBracketsAreDecimal) {
  std::string text;
  for (int i = 0; i < 3; ++i)
    text += subtitle(
        i, fmt::format("GPS (8,540{}, -47,0012, 16), H 6,5m, G.PRY (-27,3, 0,5, -76,2)", i));
  const FlightLog log = parse_flight_log(text, "a.srt");
  EXPECT_DOUBLE_EQ(log.fixes.at(2).latitude_deg, -47.0012);
  EXPECT_DOUBLE_EQ(log.fixes.at(2).longitude_deg, 8.5402);
  EXPECT_DOUBLE_EQ(log.attitudes.at(2).angles.yaw_deg, -76.2);
  EXPECT_DOUBLE_EQ(log.attitudes.at(2).angles.pitch_deg, -27.3);
  EXPECT_DOUBLE_EQ(log.attitudes.at(2).angles.roll_deg, 0.5);
}

TEST(DjiSubtitles, PositionsOutOfReachAreLeftOutWhereverTheyStand) {
  for (const int wrong : {0, 3, 9}) {
    std::string text;
    for (int i = 0; i < 10; ++i)
      text += subtitle(i,
                       fmt::format("[latitude: {}] [longitude: 8.5] [rel_alt: 30 abs_alt: 430]",
                                   i == wrong ? -12.5 : 47 + 1e-5 * i));
    const FlightLog log = parse_flight_log(text, "a.srt");
    EXPECT_EQ(log.fixes.size(), 9u) << wrong;
    EXPECT_EQ(log.left_out, 1) << wrong;
    EXPECT_THAT(log.first_fault, testing::HasSubstr("-12.5")) << wrong;
  }
}

// One height of 9500 m, or of 0 in a log of one point a second.
TEST(DjiSubtitles, HeightsOutOfReachAreLeftOut) {
  for (const double wrong_m : {9500, 0}) {
    std::string text;
    for (int i = 0; i < 10; ++i)
      text += subtitle(i,
                       fmt::format("[latitude: {}] [longitude: 8.5] [rel_alt: 30 abs_alt: {}]",
                                   47 + 1e-5 * i,
                                   i == 4 ? wrong_m : 700 + 200 * (i % 2)));
    const FlightLog log = parse_flight_log(text, "a.srt");
    EXPECT_EQ(log.fixes.size(), 9u) << wrong_m;
    EXPECT_EQ(log.left_out, 1) << wrong_m;
    EXPECT_THAT(log.first_fault, testing::HasSubstr(fmt::format(", {:.1f} m, is out", wrong_m)));
  }
}

TEST(Gpx, PointsWithTimesOfAnyZoneAreRead) {
  const FlightLog log = parse_flight_log(
      R"(<?xml version="1.0"?>
<gpx version="1.1" xmlns="http://www.topografix.com/GPX/1/1"><trk><trkseg>
<trkpt lat="47.5" lon="8.25"><ele>500.5</ele><time>2024-02-28T23:59:59.500Z</time></trkpt>
<trkpt lat="47.501" lon="8.251"><ele>501</ele><time>2024-02-29T02:00:01+02:00</time></trkpt>
<trkpt lat="47.501" lon="8.251"><ele>501</ele><time>2024-02-29T00:00:01Z</time></trkpt>
</trkseg></trk></gpx>)",
      "a.gpx");
  EXPECT_EQ(log.format, Format::kGpx);
  ASSERT_EQ(log.fixes.size(), 2u);
  EXPECT_DOUBLE_EQ(log.fixes[0].time_s, 0);
  EXPECT_DOUBLE_EQ(log.fixes[1].time_s, 1.5);
  EXPECT_DOUBLE_EQ(log.fixes[1].longitude_deg, 8.251);
  EXPECT_EQ(log.left_out, 1);  // the same time twice
}

TEST(Gpx, APointThatLacksSomethingIsLeftOut) {
  const auto log_with = [](const std::string& bad) {
    std::string text = "<gpx>\n<trk><trkseg>\n" + bad + "\n";
    for (int i = 0; i < 3; ++i)
      text += fmt::format(
          "<trkpt lat=\"47\" lon=\"8\"><ele>1</ele><time>2024-05-17T08:30:0{}Z"
          "</time></trkpt>\n",
          i);
    return parse_flight_log(text + "</trkseg></trk></gpx>", "a.gpx");
  };
  const auto fault = [&](const std::string& bad) {
    const FlightLog log = log_with(bad);
    EXPECT_EQ(log.fixes.size(), 3u) << bad;
    EXPECT_EQ(log.left_out, 1) << bad;
    return log.first_fault;
  };
  EXPECT_EQ(fault("<trkpt lat=\"47\" lon=\"8\"><time>2024-05-17T08:30:05Z</time></trkpt>"),
            "a.gpx:3: <ele> is ''; expected a number");
  EXPECT_EQ(fault("<trkpt lat=\"47\" lon=\"8\"><ele>1</ele><time>noon</time></trkpt>"),
            "a.gpx:3: <time> is 'noon'; expected a time such as 2024-05-17T08:30:05Z");
  EXPECT_EQ(fault("<trkpt lat=\"x\" lon=\"8\"/>"), "a.gpx:3: lat is 'x'; expected a number");
  EXPECT_THAT(error_of("<gpx>\n<trk><trkseg>\n<trkpt", "a.gpx"),
              testing::StartsWith("a.gpx:3: is no XML: "));
}

TEST(Gpx, PointsThatStandNewestFirstAreSaidToBeSo) {
  std::string text = "<gpx>\n<trk><trkseg>\n";
  for (int i = 9; i > 6; --i)
    text += fmt::format(
        "<trkpt lat=\"47\" lon=\"8\"><ele>1</ele><time>2024-05-17T08:30:0{}Z</time></trkpt>\n", i);
  EXPECT_EQ(
      error_of(text + "</trkseg></trk></gpx>", "a.gpx"),
      "a.gpx: holds 1 position (GPX, 2 records left out, the first: a.gpx:4: time is -1.000 s, "
      "before the 0.000 s of an earlier record; expected times that increase); expected at "
      "least two");
}

// Receivers write points before they know their height. The clock begins with them.
TEST(Gpx, TimesCountFromTheFirstPointThatHasOneAlsoWhereItIsLeftOut) {
  const auto point = [](const std::string& height, const char* seconds) {
    return "<trkpt lat=\"47\" lon=\"8\">" + height + "<time>2024-05-17T08:30:" + seconds +
           "Z</time></trkpt>";
  };
  const FlightLog log =
      parse_flight_log("<gpx><trk><trkseg>" + point("", "05") + point("<ele>1</ele>", "10.5") +
                           point("<ele>1</ele>", "11.5") + "</trkseg></trk></gpx>",
                       "a.gpx");
  ASSERT_EQ(log.fixes.size(), 2u);
  EXPECT_DOUBLE_EQ(log.fixes[0].time_s, 5.5);
}

// A day of points is read at once: the lines of all of them are counted in one go through the text.
TEST(Gpx, ALongTrackNamesTheLineOfAFault) {
  constexpr int kPoints = 86'400;
  std::string text = "<gpx>\n<trk><trkseg>\n";
  for (int i = 0; i < kPoints; ++i)
    text += fmt::format(
        "<trkpt lat=\"47\" lon=\"8\"><ele>{}</ele><time>2024-05-17T{:02}:{:02}:{:02}Z"
        "</time></trkpt>\n",
        i + 1 < kPoints ? "1" : "high",
        i / 3600,
        i / 60 % 60,
        i % 60);
  const FlightLog log = parse_flight_log(text + "</trkseg></trk></gpx>", "a.gpx");
  EXPECT_EQ(log.fixes.size(), kPoints - 1u);
  EXPECT_EQ(log.first_fault, "a.gpx:86402: <ele> is 'high'; expected a number");
}

TEST(Gpx, PrefixesOfTheNamespaceAreRead) {
  const FlightLog log = parse_flight_log(
      "<gpx:gpx xmlns:gpx=\"http://www.topografix.com/GPX/1/1\"><gpx:trk><gpx:trkseg>"
      "<gpx:trkpt lat=\"47\" lon=\"8\"><gpx:ele>1</gpx:ele><gpx:time>2024-05-17T08:30:05Z"
      "</gpx:time></gpx:trkpt><gpx:trkpt lat=\"47\" lon=\"8\"><gpx:ele>2</gpx:ele>"
      "<gpx:time>2024-05-17T08:30:06Z</gpx:time></gpx:trkpt></gpx:trkseg></gpx:trk></gpx:gpx>",
      "a.gpx");
  EXPECT_EQ(log.fixes.size(), 2u);
}

TEST(CsvLog, OptionalColumnsComeInGroups) {
  const FlightLog log = parse_flight_log(
      "time_s,altitude_m,latitude_deg,longitude_deg,yaw_deg,pitch_deg,roll_deg,rate_x_radps,rate_y_"
      "radps,rate_z_radps\n"
      "0,500,47,8,359,1,2,0.1,0.2,0.3\n0.5,501,47.001,8.001,1,1,2,0.1,0.2,0.3\n",
      "a.csv");
  EXPECT_EQ(log.format, Format::kCsv);
  ASSERT_EQ(log.fixes.size(), 2u);
  EXPECT_FALSE(log.fixes[0].height_m);
  EXPECT_DOUBLE_EQ(log.attitudes[0].angles.yaw_deg, 359);
  EXPECT_DOUBLE_EQ(log.rates[1].in_body_radps.z(), 0.3);
  const std::string head = "time_s,latitude_deg,longitude_deg,altitude_m";
  EXPECT_EQ(error_of(head + ",yaw_deg\n", "a.csv"), "a.csv:1: has no column pitch_deg");
  EXPECT_EQ(error_of("time_s,lattitude_deg,longitude_deg,altitude_m\n", "a.csv"),
            "a.csv:1: unknown column 'lattitude_deg'; did you mean 'latitude_deg'?");
  EXPECT_EQ(error_of(head + "\n0,47,8,5\n0,47,8,5\n", "a.csv"),
            "a.csv:3: time_s is 0, not after the row before; expected times that increase");
  EXPECT_EQ(error_of(head + "\n0,47,8\n", "a.csv"), "a.csv:2: has no value for altitude_m");
  EXPECT_EQ(error_of(head + "\n0,47,8,500,5\n", "a.csv"),
            "a.csv:2: has 5 cells for 4 columns; expected one each");
  EXPECT_EQ(error_of(head + "\n0,47,8,500\n1,-47,8,500\n2,47,8,500\n", "a.csv"),
            "a.csv:3: -47, 8, 500 m is out of reach of the row before; expected a position that an "
            "aircraft reaches");
  EXPECT_EQ(error_of(head + "\n0,47,8,500\n1,47,8,5000\n", "a.csv"),
            "a.csv:3: 47, 8, 5000 m is out of reach of the row before; expected a position that an "
            "aircraft reaches");
  EXPECT_EQ(error_of(head + "\n0,47,8,5\n", "a.csv"),
            "a.csv: holds 1 position (CSV); expected at least two");
}

TEST(FlightLog, OtherFilesAreRefused) {
  EXPECT_EQ(error_of("", "a.bin"), "a.bin: is empty; expected a flight log");
  EXPECT_THAT(error_of("\x7f"
                       "ELF",
                       "a.bin"),
              testing::StartsWith("a.bin: is no flight log that airtruth reads"));
}

TEST(FlightLog, AClockThatJumpsByMoreThanADayIsAnError) {
  const auto text = [](const char* last_s) {
    return std::string("time_s,latitude_deg,longitude_deg,altitude_m\n0,47,8,500\n1,47,8,501\n") +
           last_s + ",47.001,8,502\n";
  };
  EXPECT_EQ(parse_flight_log(text("86400"), "log.csv").fixes.size(), 3u);
  try {
    parse_flight_log(text("1714500000"), "log.csv");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(
        std::string(error.what()),
        "log.csv: spans 1714500000 s; expected up to 86400 s, a day. Its longest step is from "
        "1.000 to 1714500000.000 s: does its clock jump there?");
  }
}

}  // namespace
}  // namespace airtruth::flight_log
