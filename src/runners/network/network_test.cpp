// SPDX-License-Identifier: Apache-2.0
// Networks in the child process airtruth-network-runner.
#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "runners/network/network_detector.h"
#include "runners/network/network_input.h"
#include "support/error_of.h"
#include "support/onnx_bytes.h"

namespace airtruth::network {
namespace {

using testing::AllOf;
using testing::AnyOf;
namespace onnx = test_support::onnx;
using testing::HasSubstr;
using testing::Not;

const image::Colour kGrey{
    image::Chroma::kNone, image::Matrix::kBt601, image::Range::kFull, image::Siting::kLeft};

image::Picture black(int width, int height) {
  image::Picture picture = image::make_picture(width, height, kGrey);
  for (int y = 0; y < height; ++y) std::fill_n(picture.planes[0].row(y), width, std::uint8_t{0});
  return picture;
}

const std::string kHeatOutput =
    R"({"kind": "heat_map", "heat": "heat", "offset": "offset", "size": "size", "size_scale": "log"})";

std::string description(const std::string& input,
                        const std::string& output,
                        const std::string& more = "") {
  return R"({"format": "airtruth detector model 1", "classes": ["aircraft"], "input": )" + input +
         ", \"output\": " + output + more + "}";
}

const std::string kWholeFrame = R"({"layout": "grey", "scale": 0.00392156862745098, "fit": "frame",
                                   "multiple_px": 8})";

class Networks : public testing::Test {
 protected:
  Networks()
      : folder_(fs::temp_directory_path() / ("airtruth_networks_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~Networks() override { fs::remove_all(folder_); }

  std::unique_ptr<detector::Detector> make(const std::string& onnx,
                                           const std::string& json,
                                           int threads = 2) {
    write_file(folder_ / "a.onnx", onnx);
    write_file(folder_ / "a.json", json);
    return make_network_detector(folder_ / "a.onnx", {.threads = threads});
  }
  std::string fault(const std::string& onnx, const std::string& json) {
    return test_support::error_of([&] { make(onnx, json, 1); });
  }
  static std::vector<results::Detection> detect(detector::Detector& detector,
                                                const image::Picture& picture) {
    detector::FrameInput frame;
    frame.picture = &picture;
    return detector.detect(frame);
  }
  fs::path folder_;
};

// A bright pixel at (43, 22) lies in the cell of column 10 and row 5 of 4 px. Its centre is
// (10.25 * 4, 5.5 * 4) = (41, 22) and its side exp(2) = 7.389 px.
TEST_F(Networks, AHeatMapIsReadFromTheWholeFrame) {
  const auto detector = make(onnx::brightness_model(2), description(kWholeFrame, kHeatOutput));
  image::Picture picture = black(93, 61);  // both sides are rounded up to a multiple of 8
  picture.planes[0].row(22)[43] = 204;
  const auto found = detect(*detector, picture);
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].score, 0.8, 1e-6);
  EXPECT_EQ(found[0].category, "aircraft");
  EXPECT_NEAR(found[0].box_px.width, std::exp(2.0), 1e-5);
  EXPECT_NEAR(found[0].box_px.x + found[0].box_px.width / 2, 41, 1e-5);
  EXPECT_NEAR(found[0].box_px.y + found[0].box_px.height / 2, 22, 1e-5);
  // Another frame size runs through the same network.
  image::Picture larger = black(320, 240);
  larger.planes[0].row(200)[300] = 255;
  EXPECT_EQ(detect(*detector, larger).size(), 1u);
  EXPECT_EQ(detect(*detector, picture).size(), 1u);
}

TEST_F(Networks, TheNumberOfThreadsChangesNothing) {
  image::Picture picture = black(640, 480);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      picture.planes[0].row(y)[x] = static_cast<std::uint8_t>((x * 37 + y * 101) % 251);
    }
  }
  const auto found = [&](int threads) {
    const auto detector =
        make(onnx::brightness_model(2), description(kWholeFrame, kHeatOutput), threads);
    return detect(*detector, picture);
  };
  EXPECT_FALSE(found(1).empty());
  EXPECT_EQ(found(1), found(4));
}

TEST_F(Networks, TilesFindEachPointOnce) {
  const auto detector = make(onnx::brightness_model(2),
                             description(R"({"layout": "grey", "scale": 0.00392156862745098,
                                            "fit": "tiles", "width": 64, "height": 64,
                                            "overlap_px": 16})",
                                         kHeatOutput));
  image::Picture picture = black(200, 150);
  const std::vector<std::pair<int, int>> points = {
      {3, 3}, {50, 40}, {57, 57}, {101, 60}, {146, 90}, {197, 147}};
  for (const auto& [x, y] : points) picture.planes[0].row(y)[x] = 250;
  const auto found = detect(*detector, picture);
  EXPECT_EQ(found.size(), points.size());
  for (const auto& [x, y] : points) {
    EXPECT_TRUE(std::ranges::any_of(found,
                                    [&, x = x, y = y](const results::Detection& d) {
                                      // A tile's cells begin at its own corner: the centre is
                                      // within a cell of the point.
                                      return std::abs(d.box_px.x + d.box_px.width / 2 - x) <= 4 &&
                                             std::abs(d.box_px.y + d.box_px.height / 2 - y) <= 4;
                                    }))
        << x << ", " << y;
  }
}

// The frame of 64 x 32 fits into 32 x 32 at half size, 8 px below the top. The row's box about
// (16, 16) of 8 x 4 px is about (32, 16) of 16 x 8 px in the frame.
TEST_F(Networks, Yolov5ThroughALetterbox) {
  const auto detector =
      make(onnx::constant_yolo_model(32, {16, 16, 8, 4, 0.9f, 0.5f, 0.25f}),
           R"({"format": "airtruth detector model 1", "classes": ["aircraft", "bird"],
          "input": {"layout": "rgb", "fit": "letterbox", "width": 32, "height": 32},
          "output": {"kind": "yolov5", "boxes": "output"}, "score_threshold": 0.4})");
  const auto found = detect(*detector, black(64, 32));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_NEAR(found[0].score, 0.45, 1e-6);
  EXPECT_EQ(found[0].category, "aircraft");
  EXPECT_EQ(found[0].box_px, (Box{24, 12, 16, 8}));
}

// The row's box about (33, 20) of 8 x 16 px is 58 to 74 and 8 to 40 in the frame of 64 x 32. In the
// second, all of it lies to the right of the frame.
TEST_F(Networks, BoxesOfALetterboxEndAtTheFramesEdges) {
  const char* json = R"({"format": "airtruth detector model 1", "classes": ["aircraft", "bird"],
          "input": {"layout": "rgb", "fit": "letterbox", "width": 32, "height": 32},
          "output": {"kind": "yolov5", "boxes": "output"}, "score_threshold": 0.4})";
  const auto found =
      detect(*make(onnx::constant_yolo_model(32, {33, 20, 8, 16, 0.9f, 0.5f, 0.25f}), json),
             black(64, 32));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(found[0].box_px, (Box{58, 8, 6, 24}));
  EXPECT_TRUE(detect(*make(onnx::constant_yolo_model(32, {40, 20, 8, 16, 0.9f, 0.5f, 0.25f}), json),
                     black(64, 32))
                  .empty());
}

// Columns of 0 0 255 255 scaled to a third: the mean of three and the sample in their middle
// differ.
TEST_F(Networks, ALetterboxIsResizedAsItsDescriptionSays) {
  image::Picture picture = black(96, 96);
  for (int y = 0; y < 96; ++y)
    for (int x = 0; x < 96; ++x) picture.planes[0].row(y)[x] = x % 4 < 2 ? 0 : 255;
  NetworkInput input;
  input.fit = NetworkInput::Fit::kLetterbox;
  input.width = input.height = 32;
  const auto samples = [&](NetworkInput::Resize resize) {
    input.resize = resize;
    return pieces_of(picture, input)[0].samples;
  };
  // Columns 3 to 5 of the frame hold 255, 0, 0.
  EXPECT_EQ(samples(NetworkInput::Resize::kArea).at<std::uint8_t>(0, 1), 85);
  EXPECT_EQ(samples(NetworkInput::Resize::kLinear).at<std::uint8_t>(0, 1), 0);
}

TEST_F(Networks, AFileThatIsNoNetworkIsOneLine) {
  const std::string json = description(kWholeFrame, kHeatOutput);
  EXPECT_THAT(fault("", json), HasSubstr("a.onnx: is empty"));
  const std::string whole = onnx::brightness_model(2);
  for (const std::string& bytes : {std::string("PK\x03\x04 a picture, not a network"),
                                   std::string(5000, '\xff'),
                                   whole.substr(0, whole.size() / 2)}) {
    EXPECT_THAT(
        fault(bytes, json),
        AllOf(HasSubstr("a.onnx: cannot be loaded as an ONNX network: "), Not(HasSubstr("\n"))));
  }
}

// Whatever a stranger's file does to the reader, the program only says so.
TEST_F(Networks, CutAndChangedFilesNeverDoMoreThanFail) {
  const std::string json = description(kWholeFrame, kHeatOutput);
  const std::string whole = onnx::brightness_model(2);
  std::uint32_t state = 1;
  const auto next = [&] { return (state = state * 1664525u + 1013904223u) >> 8; };
  for (int trial = 0; trial < 16; ++trial) {
    std::string bytes = whole;
    for (int change = 0; change < 3; ++change) {
      bytes[next() % bytes.size()] = static_cast<char>(next());
    }
    if (trial % 4 == 0) bytes.resize(next() % bytes.size() + 1);
    EXPECT_THAT(fault(bytes, json), Not(HasSubstr("\n")));
  }
}

TEST_F(Networks, OutputsUnlikeTheDescriptionAreOneLine) {
  const std::string whole = onnx::brightness_model(2);
  EXPECT_THAT(
      fault(whole,
            description(kWholeFrame,
                        R"({"kind": "heat_map", "heat": "hm", "offset": "offset",
                                    "size": "size"})")),
      AllOf(
          HasSubstr("a.onnx: cannot be loaded"), HasSubstr("no output 'hm'"), HasSubstr("'heat'")));
  EXPECT_THAT(
      fault(whole,
            description(kWholeFrame,
                        R"({"kind": "heat_map", "heat": "offset", "offset": "offset",
                                    "size": "size"})")),
      HasSubstr("a.onnx: its output 'offset' has the shape 1 x 2 x 64 x 64; expected 1 x 1 x "
                "rows x columns"));
  EXPECT_THAT(fault(whole, description(kWholeFrame, R"({"kind": "yolov5", "boxes": "heat"})")),
              HasSubstr("expected 1 x boxes x 6"));
  EXPECT_THAT(
      fault(whole,
            description(R"({"layout": "rgb", "fit": "frame", "multiple_px": 8})", kHeatOutput)),
      AllOf(HasSubstr("a.onnx: cannot be run on an input of 256 x 256 px"),
            // OpenCV's dnn offers another way; onnxruntime says what it is.
            AnyOf(HasSubstr("exec:"), HasSubstr("invalid dimensions"))));
}

TEST_F(Networks, NumbersThatAreNoneAreOneLine) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::string json =
      R"({"format": "airtruth detector model 1", "classes": ["aircraft"],
          "input": {"layout": "rgb", "fit": "letterbox", "width": 32, "height": 32},
          "output": {"kind": "yolov5", "boxes": "output"}})";
  EXPECT_THAT(fault(onnx::constant_yolo_model(32, {16, 16, 8, 4, nan, 0.5f}), json),
              HasSubstr("a.onnx: gives a score that is not finite (nan), in row 0 of 'output'"));
  EXPECT_THAT(fault(onnx::constant_yolo_model(32, {16, 1e30f, 8, 4, 1, 0.5f}), json),
              HasSubstr("a.onnx: gives a box of 8 x 4 px at (16, 1e+30)"));
}

// A tensor of onnx.proto whose data_location (14) is EXTERNAL and whose external_data (13) names a
// file.
TEST_F(Networks, WeightsInASecondFileAreNamed) {
  onnx::Graph graph;
  const std::string entry = onnx::message(1, "location") + onnx::message(2, "a.onnx.data");
  graph.tensors = {onnx::number(1, 4) + onnx::number(2, 1) + onnx::message(8, "w") +
                   onnx::message(13, entry) + onnx::number(14, 1)};
  graph.inputs = {onnx::value("images", {1, 3, 32, 32})};
  EXPECT_THAT(fault(onnx::model(graph), description(kWholeFrame, kHeatOutput)),
              HasSubstr("a.onnx: cannot be loaded as an ONNX network: its weights lie in a second "
                        "file, 'a.onnx.data'"));
}

TEST_F(Networks, AMissingDescriptionIsNamed) {
  write_file(folder_ / "b.onnx", "x");
  EXPECT_THAT([&] { make_network_detector(folder_ / "b.onnx"); },
              testing::ThrowsMessage<Error>(HasSubstr("b.onnx: has no description beside it; "
                                                      "expected b.json")));
}

TEST(NetworkInput, TilesCoverTheFrame) {
  EXPECT_EQ(tile_starts(1280, 640, 64), (std::vector<int>{0, 320, 640}));
  EXPECT_EQ(tile_starts(640, 640, 64), std::vector<int>{0});
  EXPECT_EQ(tile_starts(100, 640, 64), std::vector<int>{0});
  for (int length = 65; length < 500; length += 7) {
    const auto starts = tile_starts(length, 64, 20);
    EXPECT_EQ(starts.front(), 0);
    EXPECT_EQ(starts.back(), length - 64);
    for (std::size_t i = 1; i < starts.size(); ++i) EXPECT_LE(starts[i] - starts[i - 1], 44);
  }
}

TEST(NetworkInput, GreyIsLumaInFullRange) {
  image::Colour colour = kGrey;
  colour.range = image::Range::kLimited;
  image::Picture picture = image::make_picture(4, 1, colour);
  const std::uint8_t coded[] = {16, 235, 126, 3};
  std::copy_n(coded, 4, picture.planes[0].row(0));
  const std::vector<std::uint8_t> samples = samples_of(picture, NetworkInput::Layout::kGrey);
  EXPECT_EQ(samples, (std::vector<std::uint8_t>{0, 255, 128, 0}));
}

TEST(NetworkInput, GreyOfRedGreenAndBlueIsTheirLuma) {
  image::Picture picture =
      image::make_picture(2, 1, {image::Chroma::k444, image::Matrix::kRgb, image::Range::kFull});
  const std::uint8_t green_blue_red[][2] = {{100, 255}, {50, 255}, {200, 255}};
  for (std::size_t p = 0; p < 3; ++p) std::copy_n(green_blue_red[p], 2, picture.planes[p].row(0));
  const std::vector<std::uint8_t> samples = samples_of(picture, NetworkInput::Layout::kGrey);
  EXPECT_EQ(samples, (std::vector<std::uint8_t>{124, 255}));
}

}  // namespace
}  // namespace airtruth::network
