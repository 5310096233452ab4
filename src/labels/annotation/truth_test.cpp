// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/truth.h"

#include <cmath>
#include <functional>
#include <limits>
#include <set>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "support/error_of.h"
#include "support/source_folder.h"

namespace airtruth::annotation {
namespace {

using Json = nlohmann::json;

const lens::Facts kLens{"fisheye", {480, 480.5}, {640, 480}, {0.1, 0, 0, 0}, 1280, 960};

Intruder visible_intruder() {
  Intruder intruder;
  intruder.id = "b737";
  intruder.aircraft = "738/738-Ryanair";
  intruder.state = State::kVisible;
  intruder.position_ned_m = {700, -900, -350.1};
  intruder.velocity_ned_mps = {1, 140, 0};
  intruder.attitude_yaw_pitch_roll_deg = {90, 1.0 / 3.0, -2};
  intruder.position_in_cam_m = {-900, -200, 700};
  intruder.range_m = 1157.6;
  intruder.range_rate_mps = -120.5;
  intruder.azimuth_deg = -52.1;
  intruder.elevation_deg = 9.9;
  intruder.exact_box_px = Box{10.25, 339.5, 30.125, 9};
  intruder.nominal_azimuth_deg = -53;
  intruder.nominal_elevation_deg = 10.1;
  intruder.covered_box_px = PixelBox{10, 340, 30, 9};
  intruder.covered_area_px = 170;
  intruder.visible_box_px = PixelBox{10, 339, 31, 10};
  intruder.visible_area_px = 120;
  intruder.alpha_sum_px = 77.5;
  intruder.hidden_by_own_aircraft = 0.25;
  EncounterTruth& encounter = intruder.encounter.emplace();
  encounter.horizontal_m = 790;
  encounter.above_m = 20.5;
  encounter.closing_speed_mps = -3.5;
  encounter.bearing_deg = 359.5;
  encounter.bearing_rate_dps = -0.25;
  encounter.relative_bearing_deg = -1.5;
  encounter.line_of_sight_rate_dps = 0.5;
  encounter.tcpa_s = 12;
  encounter.dcpa_m = 30;
  encounter.hmd_m = 30;
  encounter.vmd_m = 20;
  encounter.tau_mod_s = 11;
  encounter.tcoa_s = 40;
  encounter.volumes = {{"nmac", false, std::nullopt}, {"own", true, 0.0}};
  return intruder;
}

Frame frame_of_two() {
  Frame frame;
  frame.frame = 12;
  frame.time_s = 0.4;
  frame.damaged = true;
  frame.camera_position_ned_m = {16, 0, -150};
  frame.camera_attitude_yaw_pitch_roll_deg = {1, 2, 3};
  frame.frame_from_reference = {1, 0.01, 3, -0.01, 1, 4.5, 1e-7, 0, 1};
  frame.motion_state = "bridged";
  frame.intruders.push_back(visible_intruder());
  Intruder ended;
  ended.id = "gone";
  ended.aircraft = "c172/g-boix";
  frame.intruders.push_back(ended);
  return frame;
}

TEST(Truth, ALineHoldsWhatTheFrameHolds) {
  const Json json = Json::parse(jsonl_line(frame_of_two(), kLens));
  EXPECT_EQ(json["frame"], 12);
  EXPECT_EQ(json["time_s"], 0.4);
  EXPECT_EQ(json["motion"]["frame_from_reference"][1][2], 4.5);
  EXPECT_EQ(json["lens"]["focal_px"], Json::parse("[480, 480.5]"));
  EXPECT_EQ(json["intruders"][0]["state"], "visible");
  EXPECT_EQ(json["intruders"][0]["exact_box_px"], Json::parse("[10.25, 339.5, 30.125, 9]"));
  EXPECT_EQ(json["intruders"][0]["visible_box_px"], Json::parse("[10, 339, 31, 10]"));
  EXPECT_TRUE(json["intruders"][1].at("range_m").is_null());
}

TEST(Truth, ALineBeginsAsDocumentedAndHasNoNewline) {
  const std::string line = jsonl_line(frame_of_two(), kLens);
  EXPECT_EQ(line.substr(0, 44), R"({"frame":12,"time_s":0.4,"damaged":true,"len)");
  EXPECT_EQ(line.find('\n'), std::string::npos);
}

TEST(Truth, ALineReadsBackTheSame) {
  const std::string line = jsonl_line(frame_of_two(), kLens);
  const Frame again = parse_jsonl_line(line, "truth.jsonl", 1);
  EXPECT_EQ(jsonl_line(again, kLens), line);
  EXPECT_EQ(again.frame_from_reference, frame_of_two().frame_from_reference);
  EXPECT_EQ(again.intruders[0].attitude_yaw_pitch_roll_deg->at(1), 1.0 / 3.0);
  EXPECT_EQ(again.intruders[0].visible_box_px, (PixelBox{10, 339, 31, 10}));
  EXPECT_EQ(again.intruders[0].encounter->tau_mod_s, 11.0);
  EXPECT_FALSE(again.intruders[0].encounter->volumes.at(0).to_violation_s);
  EXPECT_TRUE(again.intruders[0].encounter->volumes.at(1).inside);
  EXPECT_EQ(again.intruders[1].state, State::kEnded);
  EXPECT_FALSE(again.intruders[1].position_ned_m);
}

TEST(Truth, InconsistentTruthIsOurMistake) {
  const auto refused = [](const std::function<void(Frame&)>& spoil) {
    Frame frame = frame_of_two();
    spoil(frame);
    EXPECT_THROW(jsonl_line(frame, kLens), std::logic_error);
  };
  refused([](Frame& f) { f.time_s = std::nan(""); });
  refused([](Frame& f) { f.frame_from_reference[0] = std::numeric_limits<double>::infinity(); });
  refused([](Frame& f) { f.intruders[0].visible_box_px.reset(); });
  refused([](Frame& f) { f.intruders[0].state = State::kHidden; });
  refused([](Frame& f) { f.intruders[0].range_m.reset(); });
  refused([](Frame& f) { f.intruders[0].exact_box_px->x = std::nan(""); });
  refused([](Frame& f) { f.intruders[1].range_m = 3; });
  refused([](Frame& f) { f.intruders[1].encounter.emplace(); });
  refused([](Frame& f) { f.intruders[0].encounter->hmd_m = std::nan(""); });
  refused([](Frame& f) { f.intruders[0].encounter->hmd_m = 791; });
  refused([](Frame& f) { f.intruders[0].encounter->tcpa_s.reset(); });
  refused([](Frame& f) { f.intruders[0].encounter->tcoa_s = -1; });
  refused([](Frame& f) { f.intruders[0].encounter->volumes[1].to_violation_s = 3; });
  refused([](Frame& f) { f.intruders[1].nominal_azimuth_deg = 3; });
  refused([](Frame& f) { f.intruders[0].elevation_deg.reset(); });
  refused([](Frame& f) { f.intruders[0].nominal_elevation_deg.reset(); });
  refused([](Frame& f) { f.intruders[0].covered_box_px->width = 0; });
  refused([](Frame& f) { f.intruders[0].covered_area_px = 0; });
  refused([](Frame& f) {
    f.intruders[0].state = State::kHidden;
    f.intruders[0].visible_box_px.reset();
  });
  refused([](Frame& f) { f.intruders[0].cut_by_frame = 1.01; });
  refused([](Frame& f) { f.intruders[0].alpha_sum_px = -1; });
}

std::string line_message(const std::string& line) {
  return test_support::error_of([&] { parse_jsonl_line(line, "truth.jsonl", 7); });
}

std::string with(const std::function<void(Json&)>& spoil) {
  Json json = Json::parse(jsonl_line(frame_of_two(), kLens));
  spoil(json);
  return line_message(json.dump());
}

TEST(Truth, FaultsHaveTheirFileAndLine) {
  EXPECT_EQ(line_message("{"), "truth.jsonl:7: is not JSON");
  EXPECT_EQ(line_message("[]"), "truth.jsonl:7: is a list; expected an object");
  EXPECT_EQ(line_message("{}"), "truth.jsonl:7: has no frame; expected a whole number");
  EXPECT_EQ(with([](Json& j) { j["frame"] = 1.5; }),
            "truth.jsonl:7: frame is 1.5; expected a whole number from -9007199254740992 to "
            "9007199254740992");
  EXPECT_EQ(
      with([](Json& j) { j["intruders"][0]["state"] = "seen"; }),
      "truth.jsonl:7: intruders[0].state is \"seen\"; expected visible, hidden, outside, behind "
      "or ended");
  EXPECT_EQ(with([](Json& j) { j["intruders"][0].erase("nominal_azimuth_deg"); }),
            "truth.jsonl:7: intruders[0] has no nominal_azimuth_deg");
  EXPECT_EQ(with([](Json& j) { j["motion"].erase("rotation"); }),
            "truth.jsonl:7: motion has no rotation");
  EXPECT_EQ(with([](Json& j) { j["intruders"][0]["visible_box_px"] = nullptr; }),
            "truth.jsonl:7: intruder 'b737' is visible and has no visible_box_px");
  EXPECT_EQ(with([](Json& j) {
              j["intruders"][0]["exact_box_px"] = {1, 2, 3};
            }),
            "truth.jsonl:7: intruders[0].exact_box_px is a list; expected a list of 4 numbers");
  EXPECT_EQ(with([](Json& j) {
              j["motion"]["frame_from_reference"] = {1, 2, 3};
            }),
            "truth.jsonl:7: motion.frame_from_reference is a list; expected 3 lists of 3 numbers");
  EXPECT_EQ(with([](Json& j) { j["lens"]["model"] = "Fisheye"; }),
            "truth.jsonl:7: lens.model is \"Fisheye\"; expected pinhole, brown_conrady or fisheye");
  EXPECT_EQ(with([](Json& j) { j["intruders"][0]["visible_box_px"][2] = 4'000'000'000; }),
            "truth.jsonl:7: intruders[0].visible_box_px[2] is 4000000000; expected a whole number "
            "from -536870912 to 536870912");
}

TEST(Truth, ALineCutAnywhereIsAnError) {
  const std::string line = jsonl_line(frame_of_two(), kLens);
  for (std::size_t size = 0; size < line.size(); ++size)
    EXPECT_NE(line_message(line.substr(0, size)), "no error");
}

TEST(Truth, DeeplyNestedJsonDoesNotExhaustTheStack) {
  EXPECT_NE(line_message(std::string(200'000, '[')), "no error");
  EXPECT_NE(line_message(std::string(200'000, '[') + std::string(200'000, ']')), "no error");
}

TEST(Truth, AFileReadsBackWithItsLens) {
  const auto file = std::filesystem::path(testing::TempDir()) / "airtruth_truth_test.jsonl";
  const std::string line = jsonl_line(frame_of_two(), kLens);
  const Json json = Json::parse(line);
  const auto lines = [&](const std::vector<int>& frames) {
    std::string text;
    for (const int frame : frames) {
      Json one = json;
      one["frame"] = frame;
      text += one.dump() + "\n";
    }
    return text;
  };
  write_file(file, lines({0, 1}));
  const Truth truth = read_truth(file);
  EXPECT_EQ(truth.frames.size(), 2u);
  EXPECT_EQ(truth.lens.model, "fisheye");
  EXPECT_EQ(truth.lens.width, 1280);
  EXPECT_EQ(truth.lens.focal_px[1], 480.5);
  EXPECT_EQ(truth.lens.distortion, kLens.distortion);
  for (const std::vector<int>& frames :
       std::vector<std::vector<int>>{{0, 1, 1}, {0, 1, 3}, {0, 1, 0}}) {
    write_file(file, lines(frames));
    EXPECT_EQ(test_support::error_of([&] { read_truth(file); }),
              file.string() + ":3: frame is " + std::to_string(frames[2]) +
                  "; expected 2: the lines are the video's frames in order");
  }
  write_file(file, lines({1, 0}));
  EXPECT_THROW(read_truth(file), Error);
  write_file(file, "");
  EXPECT_THROW(read_truth(file), Error);
  std::filesystem::remove(file);
}

// Implements a part of JSON Schema: type, enum, properties, required, additionalProperties, items,
// sizes, bounds, $ref.
class Schema {
 public:
  explicit Schema(Json root) : root_(std::move(root)) {}
  std::string fault(const Json& value) const { return fault(root_, value, "line"); }

 private:
  static bool has_type(const Json& value, const std::string& type) {
    if (type == "object") return value.is_object();
    if (type == "array") return value.is_array();
    if (type == "string") return value.is_string();
    if (type == "boolean") return value.is_boolean();
    if (type == "integer") return value.is_number_integer();
    if (type == "null") return value.is_null();
    return type == "number" && value.is_number();
  }
  static bool has_any_type(const Json& value, const Json& types) {
    if (types.is_string()) return has_type(value, types);
    return std::any_of(
        types.begin(), types.end(), [&](const Json& type) { return has_type(value, type); });
  }
  std::string fault(const Json& schema, const Json& value, const std::string& at) const {
    if (schema.contains("$ref")) {
      const std::string pointer = schema["$ref"].get<std::string>().substr(1);
      return fault(root_.at(Json::json_pointer(pointer)), value, at);
    }
    if (schema.contains("type") && !has_any_type(value, schema["type"])) return at + ": type";
    if (value.is_null()) return "";
    if (schema.contains("enum") && schema["enum"].get<std::set<Json>>().count(value) == 0)
      return at + ": enum";
    if (schema.contains("minimum") && value < schema["minimum"]) return at + ": minimum";
    if (schema.contains("maximum") && value > schema["maximum"]) return at + ": maximum";
    if (schema.contains("minItems") && value.size() < schema["minItems"]) return at + ": minItems";
    if (schema.contains("maxItems") && value.size() > schema["maxItems"]) return at + ": maxItems";
    if (schema.contains("items"))
      for (const Json& item : value)
        if (auto found = fault(schema["items"], item, at + "[]"); !found.empty()) return found;
    for (const Json& key : schema.value("required", Json::array()))
      if (!value.contains(key.get<std::string>())) return at + ": no " + key.get<std::string>();
    if (!schema.contains("properties")) return "";
    for (const auto& [key, inner] : value.items()) {
      if (!schema["properties"].contains(key)) return at + ": unknown " + key;
      if (auto found = fault(schema["properties"][key], inner, at + "." + key); !found.empty())
        return found;
    }
    return "";
  }

  Json root_;
};

Schema published_schema() {
  return Schema(
      Json::parse(read_file(test_support::source_folder() / "docs/formats/truth.schema.json")));
}

TEST(TruthSchema, HoldsWhatIsWritten) {
  EXPECT_EQ(published_schema().fault(Json::parse(jsonl_line(frame_of_two(), kLens))), "");
}

TEST(Truth, ALensThatEndsEarlyIsReadBackTheSame) {
  lens::Facts early = kLens;
  early.max_angle_rad = 0.75;
  const std::string line = jsonl_line(frame_of_two(), early);
  EXPECT_EQ(published_schema().fault(Json::parse(line)), "");
  const auto file = std::filesystem::temp_directory_path() / "airtruth_early_lens.jsonl";
  Json first = Json::parse(line);
  first["frame"] = 0;
  write_file(file, first.dump() + "\n");
  EXPECT_EQ(read_truth(file).lens.max_angle_rad, 0.75);
  std::filesystem::remove(file);
  EXPECT_FALSE(Json::parse(jsonl_line(frame_of_two(), kLens))["lens"].contains("max_angle_rad"));
}

// A frame with dirt on the lens, which has boxes and no place.
Frame frame_with_dirt() {
  Frame frame = frame_of_two();
  Intruder dirt;
  dirt.id = dirt.aircraft = dirt.object_class = "dirt";
  dirt.state = State::kVisible;
  dirt.exact_box_px = Box{100, 50, 40, 30};
  dirt.visible_box_px = PixelBox{98, 48, 44, 34};
  dirt.visible_area_px = 900;
  frame.intruders.push_back(dirt);
  return frame;
}

TEST(Truth, TheClassOfAnAircraftIsNotWrittenAndThatOfAnotherIs) {
  Frame frame = frame_with_dirt();
  frame.intruders[0].object_class = "bird";
  const Json json = Json::parse(jsonl_line(frame, kLens));
  EXPECT_EQ(json["intruders"][0]["class"], "bird");
  EXPECT_FALSE(json["intruders"][1].contains("class"));
  EXPECT_EQ(json["intruders"][2]["class"], "dirt");
  const Frame again = parse_jsonl_line(json.dump(), "truth.jsonl", 1);
  EXPECT_EQ(again.intruders[0].object_class, "bird");
  EXPECT_EQ(again.intruders[1].object_class, "aircraft");
  EXPECT_EQ(again.intruders[2].object_class, "dirt");
}

TEST(Truth, WhatIsOnTheLensHasNoPlaceAndEverythingElseHasOne) {
  const auto fault_of = [](const std::function<void(Intruder&)>& spoil) {
    Frame frame = frame_with_dirt();
    spoil(frame.intruders[2]);
    return fault(frame).value_or("");
  };
  EXPECT_EQ(fault_of([](Intruder&) {}), "");
  EXPECT_EQ(fault_of([](Intruder& i) { i.range_m = 3; }),
            "intruder 'dirt' is a dirt and has a place in the world");
  EXPECT_EQ(fault_of([](Intruder& i) {
              i.state = State::kBehind;
              i.visible_box_px.reset();
            }),
            "intruder 'dirt' is a dirt and behind");
  EXPECT_EQ(fault_of([](Intruder& i) { i.object_class = "balloon"; }),
            "intruder 'dirt' is visible and lacks its place");
  EXPECT_EQ(fault_of([](Intruder& i) {
              i.state = State::kEnded;
              i.visible_box_px.reset();
            }),
            "intruder 'dirt' is ended and has a place");
  EXPECT_EQ(fault_of([](Intruder& i) { i.object_class = "ufo"; }),
            "intruder 'dirt' is of the class 'ufo'; expected aircraft, bird, multirotor, balloon, "
            "glint, dirt or insect");
}

TEST(TruthSchema, HoldsDistractors) {
  EXPECT_EQ(published_schema().fault(Json::parse(jsonl_line(frame_with_dirt(), kLens))), "");
}

TEST(TruthSchema, RefusesWhatIsNot) {
  const Json good = Json::parse(jsonl_line(frame_of_two(), kLens));
  const auto refused = [&](const std::function<void(Json&)>& spoil) {
    Json json = good;
    spoil(json);
    return published_schema().fault(json);
  };
  EXPECT_EQ(refused([](Json& j) { j.erase("time_s"); }), "line: no time_s");
  EXPECT_EQ(refused([](Json& j) { j["more"] = 1; }), "line: unknown more");
  EXPECT_EQ(refused([](Json& j) { j["intruders"][0]["state"] = "seen"; }),
            "line.intruders[].state: enum");
  EXPECT_EQ(refused([](Json& j) { j["intruders"][0]["visible_box_px"][0] = 0.5; }),
            "line.intruders[].visible_box_px[]: type");
  EXPECT_EQ(refused([](Json& j) { j["intruders"][0]["encounter"]["tcpa_s"] = -2; }),
            "line.intruders[].encounter.tcpa_s: minimum");
  EXPECT_EQ(refused([](Json& j) { j["intruders"][0]["encounter"]["volumes"][0].erase("inside"); }),
            "line.intruders[].encounter.volumes[]: no inside");
  EXPECT_EQ(refused([](Json& j) { j["intruders"][0]["cut_by_frame"] = 2; }),
            "line.intruders[].cut_by_frame: maximum");
}

TEST(TruthSchema, EveryKeyIsInTheManual) {
  const std::filesystem::path formats = test_support::source_folder() / "docs/formats";
  const std::string manual = read_file(formats / "truth.md");
  const Json line = Json::parse(jsonl_line(frame_of_two(), kLens));
  for (const Json& object : {line,
                             line["lens"],
                             line["camera"],
                             line["motion"],
                             line["intruders"][0],
                             line["intruders"][0]["encounter"],
                             line["intruders"][0]["encounter"]["volumes"][1]})
    for (const auto& [key, value] : object.items())
      EXPECT_NE(manual.find("`" + key + "`"), std::string::npos) << key;
}

}  // namespace
}  // namespace airtruth::annotation
