// SPDX-License-Identifier: Apache-2.0
#include "camera/lens/calibration_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/names.h"
#include "support/error_of.h"
#include "support/shared_folder.h"

namespace airtruth::lens {
namespace {

const ImageSize kProfileSize{1280, 960};

std::string error_of(std::string_view text, const char* name, ImageSize size = kProfileSize) {
  return test_support::error_of([&] { parse_calibration(text, name, size); });
}

std::string profile(const std::string& extra = "") {
  return "{\"calib_dimension\": {\"w\": 1280, \"h\": 960},\n" + extra +
         "\"fisheye_params\": {\"camera_matrix\": [[560,0,639.5],[0,561,479.5],[0,0,1]],\n"
         "\"distortion_coeffs\": [0.06, 0.01, -0.01, 0.004]}}";
}

TEST(Gyroflow, BecomesAFisheyeInOurPixels) {
  const Lens lens = parse_calibration(profile(), "a.json", kProfileSize);
  const auto& fisheye = std::get<Fisheye>(lens.model());
  EXPECT_EQ(fisheye.focal_px, Pixel(560, 561));
  EXPECT_EQ(fisheye.principal_point_px, Pixel(640, 480));
  EXPECT_EQ(fisheye.distortion, (std::vector<double>{0.06, 0.01, -0.01, 0.004}));
}

TEST(Gyroflow, ScalesToAnotherSizeOfTheSameShapeAlone) {
  const Lens lens = parse_calibration(profile(), "a.json", {640, 480});
  EXPECT_EQ(std::get<Fisheye>(lens.model()).focal_px, Pixel(280, 280.5));
  EXPECT_EQ(std::get<Fisheye>(lens.model()).principal_point_px, Pixel(320, 240));
  EXPECT_THAT(error_of(profile(), "a.json", {1280, 720}),
              testing::HasSubstr("another aspect ratio"));
}

// A camera crops 1280x720 from the middle of its 1280x960 picture: a ray moves up by 120 rows.
TEST(Calibration, CroppedKeepsTheDirectionOfEveryPixelThatIsLeft) {
  const Lens whole = parse_calibration(profile(), "a.json", kProfileSize);
  const Lens wide = cropped(whole, {1280, 720});
  const Lens small = cropped(whole, {640, 360});
  const Lens narrow = cropped(whole, {720, 960});
  for (const Pixel& p : {Pixel(640, 480), Pixel(300.5, 200.25), Pixel(900, 800)}) {
    const Vector3 ray = whole.ray_from_pixel(p).value();
    EXPECT_TRUE(wide.pixel_from_cam(ray)->isApprox(Pixel(p.x(), p.y() - 120), 1e-9));
    EXPECT_TRUE(small.pixel_from_cam(ray)->isApprox(Pixel(p.x(), p.y() - 120) / 2, 1e-9));
    EXPECT_TRUE(narrow.pixel_from_cam(ray)->isApprox(Pixel(p.x() - 280, p.y()), 1e-9));
  }
}

TEST(Calibration, WhatIsWrittenIsReadAsTheSameLens) {
  const Lens fisheye = parse_calibration(profile(), "a.json", {640, 480});
  const Lens brown(BrownConrady{{900.25, 905}, {641, 479}, {-0.28, 0.09, 1e-3, -5e-4, 0.02}},
                   kProfileSize);
  const Lens pinhole(Pinhole{{1000, 1000}, {640, 480}}, kProfileSize);
  for (const Lens& lens : {fisheye, brown, pinhole}) {
    const Lens read = parse_calibration(opencv_calibration(lens, "a\nb"), "a.yml", lens.size());
    EXPECT_STREQ(read.name(), lens.name());
    const Vector3 ray(0.3, -0.2, 1);
    EXPECT_TRUE(read.pixel_from_cam(ray)->isApprox(*lens.pixel_from_cam(ray), 1e-12));
  }
  // OpenCV itself can read the file.
  cv::FileStorage storage(opencv_calibration(brown, "a note"),
                          cv::FileStorage::READ | cv::FileStorage::MEMORY);
  cv::Mat matrix;
  storage["camera_matrix"] >> matrix;
  EXPECT_EQ(matrix.at<double>(0, 2), 640.5);  // OpenCV's pixels have integer centres
}

TEST(Calibration, ARefusedShapeNamesTheCameraWhatFitsAndHowToCrop) {
  const fs::path folder =
      fs::temp_directory_path() / ("airtruth_profiles_" + std::to_string(::getpid()));
  fs::create_directories(folder);
  const auto write = [&](const char* name, const std::string& model, const std::string& size) {
    std::string text =
        profile("\"camera_brand\": \"GoPro\", \"camera_model\": \"" + model + "\",\n");
    text.replace(text.find("{\"w\": 1280, \"h\": 960}"), 21, size);
    write_file(folder / name, text);
  };
  write("4by3.json", "Hero", "{\"w\": 1280, \"h\": 960}");
  write("16by9.json", "Hero", "{\"w\": 1920, \"h\": 1080}");
  write("other.json", "Max", "{\"w\": 1280, \"h\": 720}");
  write_file(folder / "broken.json", "{");
  std::string message;
  try {
    read_calibration(folder / "4by3.json", {1280, 720});
  } catch (const Error& error) {
    message = error.what();
  }
  fs::remove_all(folder);
  EXPECT_THAT(
      message,
      testing::HasSubstr("was made for 1280x960 of a GoPro Hero, but the video is 1280x720"));
  EXPECT_THAT(message, testing::HasSubstr("video's aspect ratio: 16by9.json (1920x1080);"));
  EXPECT_THAT(message, testing::HasSubstr("airtruth lens crop"));
  EXPECT_THAT(message, testing::Not(testing::HasSubstr("other.json")));
}

TEST(Gyroflow, NamesTheFieldItCannotHonour) {
  EXPECT_THAT(error_of(profile("\"input_horizontal_stretch\": 1.33,\n"), "a.json"),
              testing::StartsWith("a.json:2: input_horizontal_stretch is 1.33; expected 1"));
  EXPECT_THAT(error_of(profile("\"digital_lens\": \"gopro_superview\",\n"), "a.json"),
              testing::HasSubstr("digital_lens"));
  EXPECT_THAT(error_of(profile("\"distortion_model\": \"insta360\",\n"), "a.json"),
              testing::HasSubstr("distortion_model"));
  EXPECT_THAT(error_of(profile("\"interpolations\": {\"24\": {}},\n"), "a.json"),
              testing::HasSubstr("interpolations is an object; expected none"));
  EXPECT_THAT(error_of(profile("\"use_opencv_standard\": true,\n"), "a.json"),
              testing::HasSubstr("use_opencv_standard"));
  EXPECT_THAT(error_of("{\"calib_dimension\": 1e999}", "a.json"), testing::HasSubstr("too large"));
  EXPECT_THAT(error_of("{\"calib_dimension\": ", "a.json"), testing::HasSubstr("is not JSON"));
  EXPECT_THAT(error_of("{}", "a.json"), testing::HasSubstr("fisheye_params"));
}

TEST(Gyroflow, EndsAtItsStatedRadius) {
  std::string text = profile();
  text.replace(text.find("\"distortion_coeffs\""), 0, "\"radial_distortion_limit\": 1.0, ");
  const Lens lens = parse_calibration(text, "a.JSON", kProfileSize);
  EXPECT_NEAR(lens.max_angle_rad(), radians(45), 1e-12);
  EXPECT_EQ(lens_of(facts_of(lens)).max_angle_rad(), lens.max_angle_rad());
}

TEST(Gyroflow, ReadsARealProfile) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is unset";
  const Lens lens = read_calibration(
      std::filesystem::path(shared) / "lens/gopro_hero3plus_1280x960.gyroflow.json", kProfileSize);
  EXPECT_STREQ(lens.name(), "fisheye");
  EXPECT_NEAR(lens.horizontal_fov_deg(), 120, 5);  // as stated where the profile was published
}

// Both kinds of files as OpenCV's own writer makes them.
TEST(OpenCv, ReadsWhatFileStorageWrites) {
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << 900.25, 0, 639.5, 0, 905, 479.5, 0, 0, 1);
  const cv::Mat distortion = (cv::Mat_<double>(1, 5) << -0.28, 0.09, 1e-3, -5e-4, 0.02);
  for (const char* name : {"a.yml", "a.xml", "A.XML"}) {
    cv::FileStorage storage(lower_case(name), cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
    storage << "image_width" << 1280 << "image_height" << 960 << "camera_matrix" << matrix
            << "distortion_coefficients" << distortion;
    const Lens lens = parse_calibration(storage.releaseAndGetString(), name, kProfileSize);
    const auto& model = std::get<BrownConrady>(lens.model());
    EXPECT_EQ(model.focal_px, Pixel(900.25, 905)) << name;
    EXPECT_EQ(model.principal_point_px, Pixel(640, 480)) << name;
    EXPECT_EQ(model.distortion, (std::vector<double>{-0.28, 0.09, 1e-3, -5e-4, 0.02})) << name;
  }
}

TEST(OpenCv, FisheyeWhereTheFileSaysSo) {
  const std::string text =
      "%YAML:1.0\n---\nimage_width: 1280\nimage_height: 960\nfisheye_model: 1\n"
      "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: [ 560., 0., "
      "639.5, 0., 561., 479.5,\n"
      "       0., 0., 1. ]\ndistortion_coefficients: !!opencv-matrix\n   rows: 4\n   cols: 1\n   "
      "dt: d\n"
      "   data: [ 0.06, 0.01, -0.01, 0.004 ]\n";
  EXPECT_STREQ(parse_calibration(text, "a.yml", kProfileSize).name(), "fisheye");
}

TEST(OpenCv, ReadsAMatrixOfRowsOverSeveralLines) {
  const Lens lens = parse_calibration(
      "K: [[900, 0, 639.5],\n    [0, 905, 479.5],\n    [0, 0, 1]]\nD: [0, 0, 0, 0]\n",
      "a.yml",
      kProfileSize);
  EXPECT_EQ(std::get<Pinhole>(lens.model()).focal_px, Pixel(900, 905));
}

// ROS's camera_info as PyYAML writes it by default: lists with dashes and quoted words.
TEST(OpenCv, ReadsListsByDashesAndQuotedWords) {
  const std::string text =
      "image_width: 1280\nimage_height: 960  # pixels\ndistortion_model: \"plumb_bob\"\n"
      "camera_matrix:\n  rows: 3\n  cols: 3\n  data:\n  - 900\n  - 0\n  - 639.5\n  - 0\n  - 905\n"
      "  - 479.5\n  - 0\n  - 0\n  - 1\ndistortion_coefficients:\n  data: [-0.28, 0.09, 0, 0, 0]\n";
  const Lens lens = parse_calibration(text, "a.yaml", kProfileSize);
  EXPECT_EQ(std::get<BrownConrady>(lens.model()).focal_px, Pixel(900, 905));
}

// A hostile file (nesting, aliases of aliases, size) fails to load without further harm.
TEST(OpenCv, HostileYamlFailsToLoad) {
  const auto repeated = [](const std::string& part, std::size_t times) {
    std::string text;
    for (std::size_t i = 0; i < times; ++i) text += part;
    return text;
  };
  EXPECT_THAT(error_of("K: " + repeated("[", 100'000), "a.yml"),
              testing::StartsWith("a.yml:1: is not YAML"));
  EXPECT_THAT(error_of("a: 1\nK: [1,\n b: {\n", "a.yml"), testing::StartsWith("a.yml:4: is not"));
  EXPECT_THAT(
      error_of("a: &a [" + repeated("1,", 10'000) + "1]\nK: [" + repeated("*a,", 10'000) + "*a]\n",
               "a.yml"),
      testing::StartsWith("a.yml:2: K holds too many numbers"));
  EXPECT_THAT(error_of("a: &a [*a, *a]\nK: *a\n", "a.yml"), testing::HasSubstr("a.yml"));
  EXPECT_THAT(error_of(repeated("# note\n", 200'000), "a.yml"),
              testing::HasSubstr("larger than 1 MiB"));
}

// The four lines of an OpenCV calibration, with keys of one's own beside them.
std::string opencv(const std::string& more) {
  return "camera_matrix: [900, 0, 639.5, 0, 905, 479.5, 0, 0, 1]\n" + more;
}

TEST(OpenCv, ReadsBothSidesFromOneKey) {
  for (const char* size : {"image_size: [640, 480]",
                           "image_size: {rows: 2, cols: 1, dt: i, data: [640, 480]}",
                           "resolution: [640, 480]"}) {
    const Lens lens = parse_calibration(opencv(size), "a.yml", kProfileSize);
    EXPECT_EQ(std::get<Pinhole>(lens.model()).focal_px, Pixel(1800, 1810)) << size;
  }
  EXPECT_THAT(error_of(opencv("image_size: [640]"), "a.yml"), testing::HasSubstr("image_size is"));
}

// Two calibrations in one file are not one lens; a key that says the same again is no fault.
TEST(OpenCv, AFileThatSaysTwoThingsIsRefused) {
  const std::string same = "K: [[900., 0, 639.5], [0, 905.0, 479.5], [0, 0, 1]]\n";
  const std::string other = "K: [450, 0, 319.5, 0, 452.5, 239.5, 0, 0, 1]\n";
  const Lens lens = parse_calibration(opencv(same + same), "a.yml", kProfileSize);
  EXPECT_EQ(std::get<Pinhole>(lens.model()).focal_px, Pixel(900, 905));
  EXPECT_EQ(error_of(opencv(other), "a.yml"),
            "a.yml:2: K differs from camera_matrix in line 1; expected one lens");
  EXPECT_EQ(error_of(other + same, "a.yml"),
            "a.yml:2: K differs from K in line 1; expected one lens");
  const std::string xml = "<opencv_storage>\n<K>900 0 640 0 900 480 0 0 1</K>\n";
  EXPECT_EQ(error_of(xml + "<K>600 0 640 0 600 480 0 0 1</K>\n</opencv_storage>", "a.xml"),
            "a.xml:3: K differs from K in line 2; expected one lens");
  const std::string agisoft = "<calibration><projection>frame</projection><width>1280</width>\n";
  EXPECT_EQ(error_of(agisoft + "<height>960</height><f>900</f>\n<f>600</f></calibration>", "a.xml"),
            "a.xml:3: <f> is there twice; expected one");
  const std::string sides = "image_width: 1280\nimage_height: 960\n";
  EXPECT_EQ(error_of(opencv(sides + "image_size: [640, 480]"), "a.yml"),
            "a.yml:4: image_size differs from 1280x960 of two keys; expected one size");
  std::vector<std::string> warnings;
  parse_calibration(opencv("---\n" + other), "a.yml", kProfileSize, [&](const std::string& text) {
    warnings.push_back(text);
  });
  EXPECT_THAT(warnings, testing::ElementsAre("a.yml:2: '---' is not read"));
  warnings.clear();
  parse_calibration(opencv("...\n" + other), "a.yml", kProfileSize, [&](const std::string& text) {
    warnings.push_back(text);
  });
  EXPECT_THAT(warnings, testing::ElementsAre("a.yml:3: '---' is not read"));
}

TEST(OpenCv, AKeyOfDashesBeginsNoDocument) {
  const std::string distortion = "distortion_coefficients: [-0.28, 0.09, 0.001, -0.0005, 0.02]\n";
  const auto distortion_of = [](const std::string& text) {
    return std::get<BrownConrady>(parse_calibration(text, "a.yml", kProfileSize).model())
        .distortion;
  };
  EXPECT_EQ(distortion_of(opencv("---x: 1\n" + distortion)), distortion_of(opencv(distortion)));
}

// yaml-cpp reads what follows the brace as documents without end.
TEST(OpenCv, ACommaAfterAWholeDocumentEnds) {
  EXPECT_EQ(error_of("{\"a\": 1},", "a.yml"), error_of("{\"a\": 1}", "a.yml"));
}

TEST(OpenCv, ReadsItsJson) {
  cv::FileStorage storage(".json", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  const cv::Mat matrix = (cv::Mat_<double>(3, 3) << 900.25, 0, 639.5, 0, 905, 479.5, 0, 0, 1);
  const cv::Mat distortion = (cv::Mat_<double>(1, 5) << -0.28, 0.09, 1e-3, -5e-4, 0.02);
  storage << "camera_matrix" << matrix << "distortion_coefficients" << distortion;
  std::string text = storage.releaseAndGetString();
  std::string key = "camera_matrix";
  for (const char* spelling : {"camera_matrix", "cameraMatrix", "K"}) {
    text.replace(text.find(key), key.size(), spelling);
    key = spelling;
    const Lens lens = parse_calibration(text, "a.json", kProfileSize);
    EXPECT_EQ(std::get<BrownConrady>(lens.model()).focal_px, Pixel(900.25, 905)) << spelling;
  }
}

// The same four numbers are two lenses that differ by many pixels.
TEST(OpenCv, FourCoefficientsOfNoModelAreAQuestion) {
  const std::string four = "distortion_coefficients: [0.05, 0.01, -0.003, 0.0005]\n";
  EXPECT_THAT(error_of(opencv(four), "a.yml"),
              testing::StartsWith("a.yml:2: distortion_coefficients holds four numbers"));
  const auto model = [&](const std::string& more) {
    return std::string(parse_calibration(opencv(four + more), "a.yml", kProfileSize).name());
  };
  EXPECT_EQ(model("fisheye_model: 1"), "fisheye");
  EXPECT_EQ(model("fisheye_model: 0"), "brown_conrady");
  EXPECT_EQ(model("distortion_model: plumb_bob"), "brown_conrady");
}

// COLMAP's, nerfstudio's, Kalibr's, ROS's and RealSense's names, in any case.
TEST(OpenCv, NamesOfModelsAreReadByTheirWords) {
  const std::string four = opencv("distortion_coefficients: [0.1, 0.01, 0, 0]\nmodel: ");
  const auto model = [&](const std::string& name) {
    return std::string(parse_calibration(four + name, "a.yml", kProfileSize).name());
  };
  for (const char* name : {"OPENCV_FISHEYE", "Kannala Brandt4", "KannalaBrandt8", "pinhole-equi"})
    EXPECT_EQ(model(name), "fisheye") << name;
  for (const char* name : {"FULL_OPENCV", "Brown Conrady", "PINHOLE", "rational_polynomial"})
    EXPECT_EQ(model(name), "brown_conrady") << name;
  for (const char* name : {"opencv_omnidir",
                           "omni-radtan",
                           "Inverse Brown Conrady",
                           "THIN_PRISM_FISHEYE",
                           "Pinhole Hero",
                           "camera"})
    EXPECT_THAT(error_of(four + name, "a.yml"),
                testing::StartsWith("a.yml:3: model is '" + std::string(name) + "', a lens model"));
}

TEST(OpenCv, KeysThatAreNotKnownAreSaid) {
  EXPECT_THAT(error_of(opencv("Distortion_Coefficient: [-0.3, 0.1, 0, 0, 0]"), "a.yml"),
              testing::StartsWith("a.yml:2: has 'Distortion_Coefficient', which is no key"));
  EXPECT_THAT(error_of(opencv("camera_model: omni\ndistortion_model: radtan\nxi: 0.8"), "a.yml"),
              testing::HasSubstr("a lens model that cannot be honoured"));
  std::vector<std::string> warnings;
  parse_calibration(opencv("roi: [1, 2]\nframe: c\nR: [1]\ncalibration_time: now\n"),
                    "a.yml",
                    kProfileSize,
                    [&](const std::string& text) { warnings.push_back(text); });
  EXPECT_THAT(warnings,
              testing::ElementsAre("a.yml:3: 'frame' is not read", "a.yml:2: 'roi' is not read"));
}

TEST(Kalibr, ReadsTheOneCamera) {
  const std::string camera =
      "  camera_model: pinhole\n  distortion_model: equidistant\n"
      "  distortion_coeffs: [-0.00165, 0.02437, -0.03583, 0.01986]\n"
      "  intrinsics: [461.487, 460.111, 356.391, 231.157]\n  resolution: [752, 480]\n"
      "  rostopic: /cam0/image_raw\n";
  const Lens lens = parse_calibration("cam0:\n" + camera, "a.yaml", {752, 480});
  const auto& fisheye = std::get<Fisheye>(lens.model());
  EXPECT_EQ(fisheye.focal_px, Pixel(461.487, 460.111));
  EXPECT_EQ(fisheye.principal_point_px, Pixel(356.891, 231.657));
  EXPECT_THAT(error_of("cam0:\n" + camera + "cam1:\n" + camera, "a.yaml", {752, 480}),
              testing::HasSubstr("several cameras"));
}

// The models of colmap/src/colmap/sensor/models.h, whose first pixel has its centre at 0.5.
TEST(Colmap, ReadsTheOneCamera) {
  const auto model = [](const std::string& line) {
    return parse_calibration("# Camera list\n" + line + "\n", "cameras.txt", kProfileSize).model();
  };
  EXPECT_EQ(std::get<Pinhole>(model("1 SIMPLE_PINHOLE 1280 960 900 640 480")).focal_px,
            Pixel(900, 900));
  EXPECT_EQ(std::get<Pinhole>(model("1 PINHOLE 1280 960 900 905 640 480")).principal_point_px,
            Pixel(640, 480));
  const auto opencv = std::get<BrownConrady>(
      model("1 FULL_OPENCV 1280 960 900 905 640 480 -0.2 0.05 1e-3 2e-3 0.01 0.02 0.03 0.04"));
  EXPECT_EQ(opencv.distortion,
            (std::vector<double>{-0.2, 0.05, 1e-3, 2e-3, 0.01, 0.02, 0.03, 0.04}));
  const auto fisheye =
      std::get<Fisheye>(model("1 SIMPLE_RADIAL_FISHEYE 1280 960 560 640 480 0.05"));
  EXPECT_EQ(fisheye.distortion, (std::vector<double>{0.05, 0, 0, 0}));
  EXPECT_THAT(error_of("1 FOV 1280 960 900 905 640 480 0.9\n", "cameras.txt"),
              testing::StartsWith("cameras.txt:1: has the model 'FOV'"));
}

// Metashape's manual, appendix D: x' = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 x^2) + 2 p2 x
// y, y' likewise, u = w/2 + cx + x' f + x' b1, v = h/2 + cy + y' f.
TEST(Agisoft, ProjectsAsItsManualStates) {
  const std::string text =
      "<?xml version=\"1.0\"?>\n<calibration><projection>frame</projection><width>1280</width>"
      "<height>960</height><f>900</f><cx>3</cx><cy>-2</cy><b1>1.5</b1><k1>-0.2</k1><k2>0.05</k2>"
      "<k3>-0.01</k3><p1>0.001</p1><p2>-0.002</p2><date>today</date></calibration>\n";
  const Lens lens = parse_calibration(text, "a.xml", kProfileSize);
  const double x = 0.31, y = -0.22, r2 = x * x + y * y;
  const double radial = 1 - 0.2 * r2 + 0.05 * r2 * r2 - 0.01 * r2 * r2 * r2;
  const double distorted_x = x * radial + 0.001 * (r2 + 2 * x * x) - 0.004 * x * y;
  const double distorted_y = y * radial - 0.002 * (r2 + 2 * y * y) + 0.002 * x * y;
  const Pixel expected(640 + 3 + distorted_x * (900 + 1.5), 480 - 2 + distorted_y * 900);
  EXPECT_TRUE(lens.pixel_from_cam({x, y, 1})->isApprox(expected, 1e-12));
}

TEST(Calibration, ATurnedPictureIsNotToBeCropped) {
  const std::string text = opencv("image_size: [1280, 960]");
  EXPECT_THAT(error_of(text, "a.yml", {960, 1280}), testing::HasSubstr("another aspect ratio"));
}

// Long lenses have large coefficients of small angles.
TEST(Gyroflow, LargeCoefficientsAreJudgedByTheirMap) {
  std::string text = profile();
  text.replace(text.find("[[560,0,639.5],[0,561,479.5]"), 28, "[[62702,0,639.5],[0,70821,479.5]");
  text.replace(
      text.find("[0.06, 0.01, -0.01, 0.004]"), 26, "[-8.1, 6379.9, -2604221.5, 482071933.4]");
  EXPECT_STREQ(parse_calibration(text, "a.json", kProfileSize).name(), "fisheye");
}

TEST(OpenCv, RefusesSkewPrismAndGarbage) {
  const auto yml = [](const std::string& matrix, const std::string& distortion) {
    return "camera_matrix: [" + matrix + "]\ndistortion_coefficients: [" + distortion + "]\n";
  };
  EXPECT_THAT(error_of(yml("900,2,640,0,900,480,0,0,1", "0"), "a.yml"), testing::HasSubstr("skew"));
  EXPECT_THAT(error_of(yml("900,0,640,0,900,480,0,0,1", "0,0,0,0,0,0,0,0,0.1"), "a.yml"),
              testing::HasSubstr("thin prism"));
  EXPECT_THAT(error_of(yml("900,0,640,0,x,480,0,0,1", "0"), "a.yml"),
              testing::StartsWith("a.yml:1: camera_matrix holds 'x'"));
  EXPECT_THAT(error_of(yml("-900,0,640,0,900,480,0,0,1", "0"), "a.yml"),
              testing::HasSubstr("focal length of -900; expected 1 to 1e6 pixels"));
  EXPECT_THAT(error_of(yml("900,0,640,0,900,480,0,0,1", "0") + "image_width: 1280\n", "a.yml"),
              testing::HasSubstr("only one of image_width"));
  EXPECT_THAT(error_of(yml("900,0,640,0,900,480,0,0,1", "0") + "fisheye_model: maybe\n", "a.yml"),
              testing::StartsWith("a.yml:3: fisheye_model is 'maybe'"));
  EXPECT_THAT(error_of("<a", "a.xml"), testing::HasSubstr("is not XML"));
  EXPECT_THAT(error_of("", "a.yml"), testing::HasSubstr("no camera_matrix"));
  EXPECT_THAT(error_of("", "a.csv"), testing::HasSubstr("is no calibration file"));
}

}  // namespace
}  // namespace airtruth::lens
