// SPDX-License-Identifier: Apache-2.0
#include <string>

#include <gtest/gtest.h>

#include "foundation/base/files.h"
#include "scene/scene/scene.h"
#include "support/error_of.h"
#include "support/source_folder.h"

namespace airtruth::scene {
namespace {

// A valid scene whose parts each case replaces. The parts start at known lines: the top at 1,
// [background] at 2, [lens] at 4, [[intruder]] at 6.
struct Parts {
  std::string top = "seed = 1\n";
  std::string background = "[background]\nvideo = 'flight.mp4'\n";
  std::string lens = "[lens]\nvertical_fov_deg = 90\n";
  std::string intruder =
      "[[intruder]]\naircraft = '738/738-Ryanair'\nwaypoints_ned_m = [[1, 2, 3], [4, 5, "
      "6]]\nspeed_mps = 140\n";
  std::string rest = "";

  std::string text() const { return top + background + lens + intruder + rest; }
};

std::string message_of(const std::string& text, const std::string& file = "s.toml") {
  return test_support::error_of([&] { parse_scene(text, file); });
}

std::string with_top(const std::string& top) { return message_of(Parts{.top = top}.text()); }
std::string with_background(const std::string& text) {
  return message_of(Parts{.background = "[background]\n" + text + "\n"}.text());
}
std::string with_lens(const std::string& text) {
  return message_of(Parts{.lens = "[lens]\n" + text + "\n"}.text());
}
std::string with_rest(const std::string& text) {
  return message_of(Parts{.rest = text + "\n"}.text());
}
std::string with_intruder(const std::string& text) {
  return message_of(Parts{.intruder = "[[intruder]]\naircraft = 'a/b'\n" + text + "\n"}.text());
}

const std::string kPath = "waypoints_ned_m = [[1, 2, 3], [4, 5, 6]]\n";

TEST(SceneErrors, TheGoodSceneIsGood) { EXPECT_EQ(message_of(Parts{}.text()), "no error"); }

TEST(SceneErrors, WhatIsNotASceneFile) {
  EXPECT_EQ(message_of(""), "s.toml: [background] has no video; expected the path of a video file");
  EXPECT_EQ(
      message_of("a = \n"),
      "s.toml:1:5: is not TOML: Error while parsing key-value pair: expected value, saw '\\n'");
  EXPECT_EQ(message_of("seed = 1\nname = \"\xff\"\n"),
            "s.toml:2: is not UTF-8; expected a text file in UTF-8");
  EXPECT_EQ(message_of(std::string((16u << 20) + 1, '\n')),
            "s.toml: is 16777217 bytes long; expected at most 16 MiB");
  EXPECT_EQ(message_of("seed = 1\na = " + std::string(40, '[')),
            "s.toml:2: is nested too deeply; a scene needs two levels");
  EXPECT_EQ(message_of("a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r = 1"),
            "s.toml:1: is nested too deeply; a scene needs two levels");
}

TEST(SceneErrors, MillionsOfNestedBracketsEndInALine) {
  EXPECT_EQ(message_of("a = " + std::string(4u << 20, '[')),
            "s.toml:1: is nested too deeply; a scene needs two levels");
  std::string dotted = "a";
  for (int i = 0; i < 1 << 20; ++i) dotted += ".a";
  EXPECT_EQ(message_of(dotted + " = 1"),
            "s.toml:1: is nested too deeply; a scene needs two levels");
}

TEST(SceneErrors, BracketsAndDotsInStringsAndCommentsDoNotNest) {
  const std::string many = std::string(50, '[').append("a.b.c.d.e.f.g.h.i.j.k.l.m.n.o.p.q.r.s");
  EXPECT_EQ(message_of(Parts{.background = "[background] # " + many + "\nvideo = '" + many + "'\n" +
                                           "mask = \"\"\"" + many + "\\\"x\"\"\"\n"}
                           .text()),
            "no error");
}

TEST(SceneErrors, UnknownKeysNameTheNearest) {
  EXPECT_EQ(with_top("sed = 1\n"),
            "s.toml:1:1: unknown key 'sed' in a scene; did you mean 'seed'?");
  EXPECT_EQ(with_background("  vidoe = 'a.mp4'"),
            "s.toml:3:3: unknown key 'vidoe' in [background]; did you mean 'video'?");
  EXPECT_EQ(with_intruder("speed_mp = 3"),
            "s.toml:8:1: unknown key 'speed_mp' in [[intruder]]; did you mean 'speed_mps'?");
  EXPECT_EQ(with_rest("[composite]\nzzzzzz = 1"),
            "s.toml:11:1: unknown key 'zzzzzz' in [composite]; expected method");
  EXPECT_EQ(with_rest("[outptu]\nvideo = 'mp4'"),
            "s.toml:10:2: unknown key 'outptu' in a scene; did you mean 'output'?");
}

TEST(SceneErrors, TheFirstOfSeveralUnknownKeysIsNamed) {
  EXPECT_EQ(with_background("video = 'a'\nzeta = 1\nalpha = 2"),
            "s.toml:4:1: unknown key 'zeta' in [background]; expected video, name, mask, "
            "first_frame, frame_count or frame_rate_hz");
}

TEST(SceneErrors, WrongTypes) {
  const std::string string_for_number =
      "s.toml:9:13: speed_mps is a string; expected metres a second from 0.001 to 1e4";
  EXPECT_EQ(with_intruder(kPath + "speed_mps = 'fast'"), string_for_number);
  // The page's example.
  EXPECT_NE(read_file(test_support::source_folder() / "docs/formats/scene.md")
                .find(string_for_number.substr(string_for_number.find(':'))),
            std::string::npos);
  EXPECT_EQ(with_background("video = 3"), "s.toml:3:9: video is an integer; expected a string");
  for (const char* seed : {"seed = 1.5\n", "seed = 7.0\n"})
    EXPECT_EQ(with_top(seed),
              "s.toml:1:8: seed is a number with a fraction; expected a whole number not below 0");
  EXPECT_EQ(with_top("lens = 3\n").substr(0, 30), "s.toml:4:1: is not TOML: Error");
  EXPECT_EQ(with_rest("[[camera]]\n"),
            "s.toml:10:1: camera is an array of tables; expected [camera], with single brackets");
  EXPECT_EQ(with_rest("camera = true").substr(0, 46),
            "s.toml:10:1: unknown key 'camera' in [[intrude");
  EXPECT_EQ(message_of(Parts{.intruder = "[intruder]\naircraft = 'a/b'\n"}.text()),
            "s.toml:6:1: intruder is a table; expected [[intruder]], with double brackets");
  EXPECT_EQ(with_lens("focal_px = 480"),
            "s.toml:5:12: focal_px is an integer; expected an array of 2 numbers");
  EXPECT_EQ(with_lens("focal_px = [480, 1979-05-27]"),
            "s.toml:5:18: focal_px[1] is a date or time; expected pixels from 1 to 1e6");
}

TEST(SceneErrors, OutOfRange) {
  EXPECT_EQ(with_lens("focal_px = [480, -480]"),
            "s.toml:5:18: focal_px[1] is -480; expected pixels from 1 to 1e6");
  EXPECT_EQ(with_lens("vertical_fov_deg = 180"),
            "s.toml:5:20: vertical_fov_deg is 180; expected degrees from 0.01, below 180 (a "
            "fisheye reaches further)");
  EXPECT_EQ(with_lens("model = 'fisheye'\nvertical_fov_deg = 360.5"),
            "s.toml:6:20: vertical_fov_deg is 360.5; expected degrees from 0.01 to 360");
  EXPECT_EQ(with_lens("model = 'fisheye'\nvertical_fov_deg = 360"), "no error");
  EXPECT_EQ(with_rest("[light]\nexposure = 0"),
            "s.toml:11:12: exposure is 0; expected a number from 1e-6 to 1e4");
  EXPECT_EQ(with_rest("[light]\nexposure = 1e39"),
            "s.toml:11:12: exposure is 1e+39; expected a number from 1e-6 to 1e4");
  EXPECT_EQ(with_rest("[light]\nsky_colour = [1, -0.5, 1]"),
            "s.toml:11:18: sky_colour[1] is -0.5; expected a number from 0 to 1e4");
  EXPECT_EQ(with_rest("[camera]\nposition_ned_m = [nan, 0, 0]"),
            "s.toml:11:19: position_ned_m[0] is nan; expected metres from -1e9 to 1e9");
  EXPECT_EQ(with_rest("[output]\nquality = 52"),
            "s.toml:11:11: quality is 52; expected a whole number from 0 to 51");
  EXPECT_EQ(
      with_rest("[output]\nencoder = 'x265'"),
      "s.toml:11:11: encoder is 'x265'; expected x264, auto, nvenc, vaapi or qsv; did you mean "
      "'x264'?");
  EXPECT_EQ(with_rest("[output]\nvideo = 'mkv'\nencoder = 'nvenc'"),
            "s.toml:12:11: encoder is nvenc, which writes H.264; expected video = \"mp4\"");
  EXPECT_EQ(with_rest("[render]\nquality = 0"),
            "s.toml:11:11: quality is 0; expected a whole number from 1 to 5");
  EXPECT_EQ(with_background("video = 'a'\nframe_count = 0"),
            "s.toml:4:15: frame_count is 0; expected a whole number from 1 to 1000000000");
  EXPECT_EQ(with_background("video = ''"), "s.toml:3:9: video is empty; expected a text");
  EXPECT_EQ(with_top("name = 'a/b'\n"),
            "s.toml:1:8: name is 'a/b'; expected a plain file name: no slash, no dot in front, at "
            "most 200 bytes");
  for (const std::string name : {".", "..", ".q"})
    EXPECT_EQ(with_top("name = '" + name + "'\n"),
              "s.toml:1:8: name is '" + name +
                  "'; expected a plain file name: no slash, no dot in front, at most 200 bytes");
}

TEST(SceneErrors, Choices) {
  EXPECT_EQ(with_lens("model = 'pinhol'\nvertical_fov_deg = 90"),
            "s.toml:5:9: model is 'pinhol'; expected pinhole, brown_conrady or fisheye; did you "
            "mean 'pinhole'?");
  EXPECT_EQ(with_rest("[composite]\nmethod = 'paste'"),
            "s.toml:11:10: method is 'paste'; expected matte or chroma-key; did you mean 'matte'?");
  EXPECT_EQ(with_rest("[output]\nvideo = 'webm'"),
            "s.toml:11:9: video is 'webm'; expected mp4, mkv, avi or png");
}

TEST(SceneErrors, LensParametersThatDoNotFit) {
  EXPECT_EQ(with_lens("vertical_fov_deg = 90\nfocal_px = [1, 1]"),
            "s.toml:6:12: vertical_fov_deg and focal_px exclude each other; keep one of them");
  EXPECT_EQ(with_lens("file = 'c.json'\nvertical_fov_deg = 90"),
            "s.toml:6:20: file and vertical_fov_deg exclude each other; keep one of them");
  EXPECT_EQ(with_lens("model = 'pinhole'"),
            "s.toml:4:1: [lens] has no focal length; expected vertical_fov_deg, focal_px or file");
  EXPECT_EQ(with_lens("vertical_fov_deg = 90\ndistortion = [0.1, 0, 0, 0]"),
            "s.toml:6:14: distortion is not for a pinhole; expected model brown_conrady or "
            "fisheye, or no distortion");
  EXPECT_EQ(with_lens("model = 'brown_conrady'\nfocal_px = [1, 1]\ndistortion = [1, 2, 3]"),
            "s.toml:7:14: distortion has 3 numbers; brown_conrady takes 4, 5 or 8");
}

TEST(SceneErrors, Waypoints) {
  EXPECT_EQ(with_intruder("waypoints_ned_m = [[1, 2, 3]]\nspeed_mps = 1"),
            "s.toml:8:19: waypoints_ned_m has 1 point; expected at least two");
  EXPECT_EQ(
      with_intruder("waypoints_ned_m = [\n[1, 2, 3],\n  [1, 2, 3]]\nspeed_mps = 1"),
      "s.toml:10:3: waypoints_ned_m[1] is the same point as the one before; expected another");
  EXPECT_EQ(with_intruder("waypoints_ned_m = [[1, 2, 3],\n [4, 5]]\nspeed_mps = 1"),
            "s.toml:9:2: waypoints_ned_m[1] is an array of 2; expected an array of 3 numbers");
  EXPECT_EQ(with_intruder("waypoints_ned_m = [[1, 2, 3],\n [4, inf, 6]]\nspeed_mps = 1"),
            "s.toml:9:6: waypoints_ned_m[1][1] is inf; expected metres from -1e9 to 1e9");
  EXPECT_EQ(with_intruder("waypoints_ned_m = [1, 2, 3]\nspeed_mps = 1"),
            "s.toml:8:20: waypoints_ned_m[0] is an integer; expected an array of 3 numbers");
}

TEST(SceneErrors, PathsAndTimes) {
  EXPECT_EQ(with_intruder(kPath + "speed_mps = 1\ntimes_s = [0, 1]"),
            "s.toml:10:11: speed_mps and times_s exclude each other; keep one of them");
  EXPECT_EQ(with_intruder(kPath + "path_file = 'p.csv'"),
            "s.toml:8:19: path_file and waypoints_ned_m exclude each other; keep one of them");
  EXPECT_EQ(with_intruder(kPath),
            "s.toml:6:1: [[intruder]] has waypoints_ned_m alone; expected speed_mps or times_s "
            "with them");
  EXPECT_EQ(with_intruder(""),
            "s.toml:6:1: [[intruder]] has no path; expected waypoints_ned_m with speed_mps or "
            "times_s, path_file, encounter or seen");
  EXPECT_EQ(with_intruder(kPath + "times_s = [0]"),
            "s.toml:9:11: times_s has 1 numbers; expected one for each of the 2 waypoints");
  EXPECT_EQ(with_intruder(kPath + "times_s = [2, 1.5]"),
            "s.toml:9:15: times_s[1] is 1.5, not after 2; expected increasing times");
  EXPECT_EQ(with_rest("[camera]\npath_file = 'own.csv'\nposition_ned_m = [0, 0, 0]"),
            "s.toml:12:18: path_file and position_ned_m exclude each other; keep one of them");
}

TEST(SceneErrors, Intruders) {
  EXPECT_EQ(message_of(Parts{.intruder = "[[intruder]]\n" + kPath}.text()),
            "s.toml:6:1: has no aircraft; expected a name (see `airtruth aircraft "
            "list`) or a model file");
  const std::string one = "[[intruder]]\nid = 'a'\naircraft = 'x/y'\nspeed_mps = 1\n" + kPath;
  EXPECT_EQ(message_of(Parts{.intruder = one + one}.text()),
            "s.toml:12:6: id 'a' is taken by the intruder at line 7; expected another");
  EXPECT_EQ(with_intruder(kPath + "speed_mps = 1\nmodel_forward = '-x'\nmodel_up = 'x'"),
            "s.toml:11:12: model_up is 'x', along model_forward '-x'; expected another axis");
}

TEST(SceneErrors, MissingFilesAreErrorsThatNameThem) {
  try {
    read_scene("/nowhere/scene.toml");
    FAIL() << "a scene was read from a file that does not exist";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("/nowhere/scene.toml"), std::string::npos)
        << error.what();
  }
  EXPECT_EQ(message_of(Parts{.top = ""}.text(), "/"),
            "/: has no name, and none can be made from the file's");
}

TEST(SceneErrors, Occluders) {
  EXPECT_EQ(
      with_rest("[[occluder]]\nmask = 'hill.png'"),
      "s.toml:10:1: [[occluder]] has no range_m; expected its distance, beyond which it hides");
  EXPECT_EQ(with_rest("[[occluder]]\nrange_m = 0\nmask = 'hill.png'"),
            "s.toml:11:11: range_m is 0; expected metres from 0.1 to 1e6");
  EXPECT_EQ(with_rest("[[occluder]]\nrange_m = 800"),
            "s.toml:10:1: [[occluder]] has no mask; expected mask, or beyond_horizon = true");
  EXPECT_EQ(with_rest("[[occluder]]\nrange_m = 800\nmask = 'hill.png'\nbeyond_horizon = true"),
            "s.toml:10:1: [[occluder]] has a mask and beyond_horizon; expected one of them");
  std::string many;
  for (int i = 0; i < 33; ++i) many += "[[occluder]]\nrange_m = 800\nbeyond_horizon = true\n";
  EXPECT_EQ(with_rest(many),
            "s.toml:106:1: more than 32 [[occluder]] tables; expected at most so many");
}

}  // namespace
}  // namespace airtruth::scene
