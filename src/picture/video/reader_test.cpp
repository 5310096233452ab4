// SPDX-License-Identifier: Apache-2.0
#include "picture/video/reader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/seed.h"
#include "foundation/image/colour.h"
#include "picture/video/libav.h"
#include "picture/video/numbered_images.h"
#include "picture/video/still.h"
#include "picture/video/writer.h"
#include "support/error_of.h"
#include "support/shared_folder.h"
#include "support/video_folder.h"

namespace airtruth::video {
namespace {

// Every decoded sample is compared with the output of the ffmpeg program for the same file.

TEST_F(Video, DecodesEveryCodecAsFfmpegDoes) {
  struct Case {
    const char* file;
    const char* settings;
    const char* pixel_format;
  };
  const std::vector<Case> cases = {
      {"h264.mp4", "-c:v libx264 -pix_fmt yuv420p", "yuv420p"},
      {"h264_422.mov", "-c:v libx264 -pix_fmt yuv422p", "yuv422p"},
      {"h264_444.mkv", "-c:v libx264 -pix_fmt yuv444p", "yuv444p"},
      {"hevc.mp4", "-c:v libx265 -x265-params log-level=none -pix_fmt yuv420p", "yuv420p"},
      {"mjpeg.avi", "-c:v mjpeg -pix_fmt yuvj422p", "yuvj422p"},
      {"mpeg4.avi", "-c:v mpeg4", "yuv420p"},
      {"vp9.webm", "-c:v libvpx-vp9 -deadline realtime -cpu-used 8", "yuv420p"},
      {"ffv1.mkv", "-c:v ffv1 -pix_fmt yuv444p", "yuv444p"},
      {"grey.mkv", "-c:v ffv1 -pix_fmt gray", "gray"}};
  for (const Case& c : cases) {
    ffmpeg(std::string("-f lavfi -i testsrc2=s=66x50:r=25:d=0.3 ") + c.settings + " " + c.file);
    if (HasFatalFailure()) return;
    std::string warnings;
    Reader reader(folder_ / c.file, {}, [&](const std::string& words) { warnings += words; });
    EXPECT_EQ(reader.info().pixel_format, c.pixel_format) << c.file;
    EXPECT_TRUE(all_planes(reader) == raw(c.file, c.pixel_format)) << c.file;
    EXPECT_EQ(warnings, "") << c.file;
  }
}

TEST_F(Video, ProResIsRoundedToEightBits) {
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=0.2 -c:v prores_ks pro.mov");
  std::string warning;
  Reader reader(folder_ / "pro.mov", {}, [&](const std::string& message) { warning = message; });
  EXPECT_THAT(warning, testing::HasSubstr("10 bits"));
  const std::string ours = all_planes(reader);
  const std::string deep = raw("pro.mov", "yuv422p10le");
  ASSERT_EQ(deep.size(), 2 * ours.size());
  for (std::size_t i = 0; i < ours.size(); ++i) {
    const int value =
        static_cast<unsigned char>(deep[2 * i]) + 256 * static_cast<unsigned char>(deep[2 * i + 1]);
    ASSERT_EQ(static_cast<unsigned char>(ours[i]), std::min(255, (value + 2) / 4));
  }
}

// x264 counts its -qp from the finest step of the depth: 12 more for two bits more.
TEST_F(Video, TheQuantiserOfDeeperSamplesIsThatOfEightBits) {
  for (const char* how : {"-qp 30 -pix_fmt yuv420p", "-qp 42 -pix_fmt yuv420p10le"}) {
    ffmpeg(std::string("-f lavfi -i testsrc2=s=64x48:r=25:d=0.2 -c:v libx264 -bf 0 ") + how +
           " coded.mkv");
    Reader reader(folder_ / "coded.mkv", {.threads = 1, .with_quantiser = true});
    ASSERT_TRUE(reader.next());  // a key frame, which x264 codes finer
    while (const auto frame = reader.next()) EXPECT_EQ(frame->quantiser, 30) << how;
  }
}

TEST_F(Video, OddSizesAndNumberedImages) {
  ffmpeg(
      "-f lavfi -i testsrc=s=67x51:r=25:d=0.2 -vf format=rgb24,format=yuv420p -c:v ffv1 odd.mkv");
  Reader odd(folder_ / "odd.mkv");
  EXPECT_TRUE(all_planes(odd) == raw("odd.mkv", "yuv420p"));
  fs::create_directories(folder_ / "frames");
  ffmpeg("-i odd.mkv -start_number 7 frames/img_%04d.png");
  ffmpeg("-start_number 7 -i frames/img_%04d.png -f rawvideo -pix_fmt gbrp raw.bin");
  const std::string expected = read_file(folder_ / "raw.bin");
  for (const fs::path& path : {folder_ / "frames", folder_ / "frames/img_%04d.png"}) {
    Reader images(path);
    int frames = 0;
    EXPECT_TRUE(all_planes(images, &frames) == expected) << path;
    EXPECT_EQ(frames, 5);
  }
}

// Ten frames with two seconds of sound.
TEST_F(Video, ANumberOfFramesThatFollowsFromTheLengthIsNotStated) {
  for (const char* file : {"sound.mkv", "sound.mov"}) {
    ffmpeg(std::string("-f lavfi -i testsrc2=s=64x48:r=25:d=0.4 -f lavfi -i sine=d=2 -c:v mjpeg "
                       "-c:a pcm_s16le ") +
           file);
    const StreamInfo info = Reader(folder_ / file).info();
    EXPECT_EQ(info.is_frame_count_stated, info.frame_count_estimate == 10) << file;
    EXPECT_EQ(info.is_frame_count_stated, file == std::string("sound.mov"));
  }
}

TEST_F(Video, AClipIsNamedByItsFileOrItsFolder) {
  const auto name_of = [&](const char* video) { return clip_name(folder_ / video); };
  EXPECT_EQ(name_of("clip.mp4"), "clip");
  EXPECT_EQ(name_of("pics"), "pics");
  EXPECT_EQ(name_of("pics/"), "pics");
  EXPECT_EQ(name_of("pics/."), "pics");
  EXPECT_EQ(name_of("pics/%05d.png"), "pics");
  EXPECT_EQ(name_of("pics/img_%d.png"), "pics");
  EXPECT_EQ(name_of("50% of it.mp4"), "50% of it");
  write_file(folder_ / "%05d.mkv", "a file, not a pattern");
  EXPECT_EQ(name_of("%05d.mkv"), "%05d");
  EXPECT_EQ(clip_name("/"), "video");
}

// COCO's names have 12 digits and gaps between them; Airborne Object Tracking's are a time in
// nanoseconds and the flight, which may end in a digit.
TEST_F(Video, PicturesAreReadInTheOrderOfTheirNamesWithGapsAndLongNumbers) {
  const std::vector<std::vector<std::string>> names = {
      {"000000000139.png", "000000000285.png", "000000581929.png"},
      {"9.png", "10.png", "111.png"},
      {"9000000000000000000a1b-737.png",
       "9000000000033333333a1b-737.png",
       "10000000000000000000a1b-737.png"}};
  for (std::size_t set = 0; set < names.size(); ++set) {
    const fs::path folder = folder_ / ("set" + std::to_string(set));
    fs::create_directories(folder);
    for (std::size_t i = 0; i < 3; ++i)
      ffmpeg("-f lavfi -i color=gray:s=16x16 -vf format=gray,geq=" + std::to_string(50 * (i + 1)) +
             " -frames:v 1 -update 1 " + (folder / names[set][i]).string());
    std::string warning;
    Reader reader(folder, {}, [&](const std::string& message) { warning = message; });
    EXPECT_EQ(reader.info().frame_count_estimate, 3);
    for (int i = 0; i < 3; ++i) {
      const auto frame = reader.next();
      ASSERT_TRUE(frame) << folder;
      EXPECT_EQ(frame->index, i);
      EXPECT_NEAR(frame->time_s, i / 25.0, 1e-12);
      EXPECT_NEAR(frame->picture.planes[0].row(0)[0], 50 * (i + 1), 1) << folder;
    }
    EXPECT_FALSE(reader.next());
    EXPECT_THAT(warning, testing::Not(testing::HasSubstr("ends early")));
    EXPECT_EQ(warning.find("gaps between the numbers of its 3") != std::string::npos, set < 2);
  }
}

// Two pictures of anything are a clip of two frames, with a warning.
TEST_F(Video, PicturesWithoutANumberInTheirNamesAreNamed) {
  const fs::path folder = folder_ / "anything";
  fs::create_directories(folder);
  for (const char* name : {"cat.png", "dog.png"})
    ffmpeg("-f lavfi -i color=gray:s=16x16 -frames:v 1 -update 1 " + (folder / name).string());
  std::string warning;
  const Reader reader(folder, {}, [&](const std::string& message) { warning = message; });
  EXPECT_EQ(warning,
            folder.string() +
                ": has no number in the names of some of its 2 pictures; they are taken as "
                "consecutive frames");
}

// A picture that is passed over would give those after it the labels of those before them.
TEST_F(Video, APictureThatCannotBeDecodedIsAnError) {
  fs::create_directories(folder_ / "frames");
  for (const std::string extension : {".png", ".jpg"}) {
    ffmpeg("-f lavfi -i testsrc2=s=160x120:r=25:d=0.2 frames/%d" + extension);
    const fs::path third = folder_ / "frames" / ("3" + extension);
    const std::string whole = read_file(third);
    for (const std::string& damaged :
         {std::string(), std::string("no picture"), whole.substr(0, whole.size() / 2)}) {
      write_file(third, damaged);
      Reader reader(folder_ / ("frames/%d" + extension));
      const std::string error = test_support::error_of([&] { all_planes(reader); });
      EXPECT_EQ(error, third.string() + ": cannot be decoded as a picture") << damaged.size();
    }
    write_file(third, whole);
    Reader later(folder_ / ("frames/%d" + extension), {.first_frame = 3});
    int frames = 0;
    all_planes(later, &frames);
    EXPECT_EQ(frames, 2);
  }
}

TEST_F(Video, TiffPicturesWithTagsThatLibavDoesNotKnowAreRead) {
  fs::create_directories(folder_ / "frames");
  ffmpeg("-f lavfi -i testsrc2=s=160x120:r=25:d=0.2 -pix_fmt rgb24 frames/%d.tif");
  Reader reader(folder_ / "frames/%d.tif");
  int frames = 0;
  all_planes(reader, &frames);
  EXPECT_EQ(frames, 5);
}

// A grey sample of a still is a code value of full range, whatever the file's format.
TEST_F(Video, GreyPicturesAreOfFullRange) {
  const std::string ramp("\x00\x08\x20\x80\xf0\xff", 6);
  fs::create_directories(folder_ / "pgm");
  write_file(folder_ / "pgm/1.pgm", "P5\n6 1\n255\n" + ramp);
  for (const std::string kind : {"tif", "png", "bmp"}) {
    fs::create_directories(folder_ / kind);
    ffmpeg("-i pgm/1.pgm -update 1 " + kind + "/1." + kind);
  }
  std::string expected;
  for (const char sample : ramp) expected += std::string(3, sample);
  for (const std::string kind : {"pgm", "tif", "png", "bmp"}) {
    Reader series(folder_ / kind);
    EXPECT_EQ(series.info().colour.range, image::Range::kFull) << kind;
    for (const image::Rgb8& rgb : {image::rgb8_from_picture(series.next()->picture),
                                   read_still(folder_ / kind / ("1." + kind))})
      EXPECT_EQ(rgb.bytes(), expected) << kind;
  }
}

// The bytes of an mp4 with one track, which is shown turned clockwise: the track header's matrix
// (ISO/IEC 14496-12, 8.3.2) has 16.16 fixed point numbers, highest byte first.
std::string turned_clockwise(std::string mp4, int rotation_deg) {
  constexpr std::size_t kMatrixAfterName = 44;
  const std::size_t matrix = mp4.find("tkhd") + kMatrixAfterName;
  const auto put = [&](std::size_t place, int value) {
    for (std::size_t i = 0; i < 2; ++i)
      mp4[matrix + 4 * place + i] = static_cast<char>(value < 0 ? 0xff : i * value);
  };
  const int cosine = rotation_deg == 180 ? -1 : 0;
  const int sine = rotation_deg == 180 ? 0 : rotation_deg == 90 ? 1 : -1;
  put(0, cosine), put(1, sine), put(3, -sine), put(4, cosine);
  return mp4;
}

TEST_F(Video, RotationIsAppliedWithEverySampleKept) {
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=0.2 -c:v libx264 -pix_fmt yuv420p plain.mp4");
  const std::string plain = read_file(folder_ / "plain.mp4");
  for (int rotation : {90, 180, 270}) {
    write_file(folder_ / "turned.mp4", turned_clockwise(plain, rotation));
    Reader reader(folder_ / "turned.mp4");
    EXPECT_NE(reader.info().rotation_deg, 0);
    EXPECT_EQ(reader.info().width, rotation == 180 ? 64 : 48);
    EXPECT_TRUE(all_planes(reader) == raw("turned.mp4", "yuv420p"))
        << rotation;  // The ffmpeg program rotates the picture itself.
  }
}

// mp4 and Matroska state the shape of pixels themselves; of the other files only the codec does.
TEST_F(Video, PixelsThatAreNotSquareAreSoInEveryContainer) {
  const std::string source = "-f lavfi -i testsrc2=s=64x48:r=25:d=0.2 -vf setsar=4/3 ";
  for (const char* output : {"-c:v libx264 a.mp4",
                             "-c:v libx264 a.mkv",
                             "-c:v libx264 a.ts",
                             "-c:v libx264 a.h264",
                             "-c:v mpeg2video -aspect 16:9 a.mpg",
                             "-c:v mpeg2video -aspect 16:9 b.ts"}) {
    ffmpeg(source + output);
    const fs::path file = folder_ / std::string(output).substr(std::string(output).rfind(' ') + 1);
    EXPECT_NEAR(Reader(file).info().sample_aspect.value(), 4.0 / 3, 1e-9) << output;
  }
}

TEST_F(Video, VariableFrameRateKeepsItsTimes) {
  ffmpeg(
      "-f lavfi -i testsrc2=s=64x48:r=25:d=0.6 -vf \"select='not(eq(n,3)+eq(n,4)+eq(n,9))'\" "
      "-fps_mode vfr -c:v libx264 vfr.mp4");
  Reader reader(folder_ / "vfr.mp4");
  std::vector<double> times;
  while (const auto frame = reader.next()) times.push_back(frame->time_s);
  ASSERT_EQ(times.size(), 12u);
  EXPECT_EQ(reader.times_s(100), times);
  EXPECT_EQ(reader.times_s(5), std::vector(times.begin(), times.begin() + 5));
  EXPECT_NEAR(times[2], 0.08, 1e-9);
  EXPECT_NEAR(times[3], 0.20, 1e-9);
  EXPECT_NEAR(time_of_first_frame_s(folder_ / "vfr.mp4", {.first_frame = 3}), 0.20, 1e-9);
  StreamInfo info = reader.info();
  Reader again(folder_ / "vfr.mp4");
  Writer writer(folder_ / "copy.mp4", info, {});
  while (const auto frame = again.next()) writer.write(*frame);
  writer.finish();
  Reader copy(folder_ / "copy.mp4");
  for (double time : times) EXPECT_NEAR(copy.next()->time_s, time, 1e-6);
}

// Segments of a recorder, each with time stamps from the same number on, in one file: 50 frames of
// 25 a second.
TEST_F(Video, FramesAfterAResetOfTheTimeStampsFollowThoseBefore) {
  ffmpeg(
      "-f lavfi -i testsrc2=s=64x48:r=25:d=2 -c:v libx264 -g 25 -f segment -segment_time 1 "
      "-reset_timestamps 1 part%d.ts");
  write_file(folder_ / "all.ts", read_file(folder_ / "part0.ts") + read_file(folder_ / "part1.ts"));
  std::string warning;
  Reader reader(folder_ / "all.ts", {}, [&](const std::string& text) { warning += text; });
  int frames = 0;
  while (const auto frame = reader.next()) EXPECT_NEAR(frame->time_s, frames++ / 25.0, 1e-4);
  EXPECT_EQ(frames, 50);
  EXPECT_THAT(warning, testing::HasSubstr("its time stamps go back by 0.96 s at frame 25;"));
  EXPECT_NEAR(time_of_first_frame_s(folder_ / "all.ts", {.first_frame = 30}), 1.2, 1e-4);
}

// libav seeks to any packet of such a stream, not to a key frame alone.
TEST_F(Video, AFrameOfATransportStreamIsFoundByItsTime) {
  ffmpeg(
      "-f lavfi -i testsrc2=s=64x48:r=25:d=2 -c:v libx264 -g 5 -f segment -segment_time 1 "
      "-reset_timestamps 1 part%d.ts");
  write_file(folder_ / "all.ts", read_file(folder_ / "part0.ts") + read_file(folder_ / "part1.ts"));
  for (const auto& [file, count] : {std::pair("part1.ts", 25u), std::pair("all.ts", 50u)}) {
    Reader through(folder_ / file);
    std::vector<std::string> pictures;
    while (const auto frame = through.next()) pictures.push_back(planes_of(frame->picture));
    ASSERT_EQ(pictures.size(), count);
    int warnings = 0;
    Reader reader(folder_ / file, {}, [&](const std::string&) { ++warnings; });
    for (const std::size_t k : {count - 1, 7u, count / 2 + 5, count / 2, 0u}) {
      const auto frame = reader.at(static_cast<double>(k) / 25);
      ASSERT_TRUE(frame) << k;
      EXPECT_TRUE(planes_of(frame->picture) == pictures[k]) << file << " at frame " << k;
      EXPECT_EQ(frame->index, static_cast<std::int64_t>(k));
    }
    EXPECT_EQ(warnings, count == 50u ? 1 : 0) << file;
  }
}

// A clip of two shots and a slow change. Only the frame that begins the second shot is marked, and
// every frame equals the one that a reader without cuts returns.
TEST_F(Video, CutsAreFoundWhereTheyAreAskedFor) {
  ffmpeg(
      "-f lavfi -i color=0x404040:s=64x48:r=25:d=0.4 -f lavfi -i testsrc=s=64x48:r=25:d=0.4 "
      "-filter_complex [0][1]concat=n=2,format=yuv420p -c:v ffv1 cut.mkv");
  Reader plain(folder_ / "cut.mkv");
  Reader reader(folder_ / "cut.mkv", {.with_cuts = true});
  std::vector<std::int64_t> cuts;
  std::int64_t frames = 0;
  while (const auto frame = reader.next()) {
    EXPECT_EQ(frame->index, frames++);
    const auto same = plain.next();
    ASSERT_TRUE(same);
    EXPECT_FALSE(same->begins_shot);
    EXPECT_EQ(planes_of(frame->picture), planes_of(same->picture));
    if (frame->begins_shot) cuts.push_back(frame->index);
  }
  EXPECT_FALSE(plain.next());
  EXPECT_EQ(frames, 20);
  EXPECT_EQ(cuts, std::vector<std::int64_t>{10});
  // Reads from a later frame on, and up to the last one before the cut.
  Reader later(folder_ / "cut.mkv", {.first_frame = 7, .with_cuts = true});
  for (int k = 0; k < 5; ++k) EXPECT_EQ(later.next()->begins_shot, k == 3) << k;
  Reader first(folder_ / "cut.mkv", {.frame_count = 10, .with_cuts = true});
  int count = 0;
  while (const auto frame = first.next()) {
    EXPECT_FALSE(frame->begins_shot);
    ++count;
  }
  EXPECT_EQ(count, 10);
}

TEST_F(Video, TagsComeThrough) {
  ffmpeg(
      "-f lavfi -i testsrc2=s=64x48:r=25:d=0.2 -vf format=yuv420p,setparams="
      "range=pc:colorspace=bt709:color_primaries=bt709:color_trc=bt709 -c:v libx264 -colorspace "
      "bt709 -color_primaries bt709 -color_trc bt709 -color_range pc tagged.mp4");
  Reader reader(folder_ / "tagged.mp4");
  EXPECT_EQ(reader.info().colour.matrix, image::Matrix::kBt709);
  EXPECT_EQ(reader.info().colour.range, image::Range::kFull);
  Writer writer(folder_ / "out.mp4", reader.info(), {});
  while (const auto frame = reader.next()) writer.write(*frame);
  writer.finish();
  EXPECT_THAT(probe("out.mp4", "stream=color_range,color_space,color_transfer,color_primaries"),
              testing::HasSubstr("pc,bt709,bt709,bt709"));
}

TEST_F(Video, DecodesTheRealClipsAsFfmpegDoes) {
  const char* shared = test_support::shared_folder();
  if (shared == nullptr) GTEST_SKIP() << "AIRTRUTH_SHARED is unset";
  for (const char* clip :
       {"fixed-wing/cumulus_a4.mp4", "fixed-wing/overcast_b4.mp4", "gopro-karma/karma.mp4"}) {
    const fs::path path = fs::path(shared) / "footage" / clip;
    ffmpeg("-i '" + path.string() + "' -frames:v 20 -f rawvideo -fps_mode passthrough real.bin");
    Reader reader(path, {.frame_count = 20});
    EXPECT_TRUE(all_planes(reader) == read_file(folder_ / "real.bin")) << clip;
  }
}

// The images of the unit vectors under the matrix determine the positions of the picture's corners.
TEST(Orientation, ShowsAPictureAsItsDisplayMatrixSays) {
  for (const double degrees : {0.0, 90.0, 180.0, 270.0}) {
    for (const bool flip : {false, true}) {
      std::array<std::int32_t, 9> matrix{};
      av_display_rotation_set(matrix.data(), degrees);
      av_display_matrix_flip(matrix.data(), flip ? 1 : 0, 0);
      image::Picture picture = image::make_picture(3, 2, {image::Chroma::kNone});
      for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x)
          picture.planes[0].row(y)[x] = static_cast<std::uint8_t>(10 * y + x);
      const image::Picture shown = oriented(picture.clone(), orientation_of(matrix.data()));
      const bool turned = matrix[0] == 0;
      ASSERT_EQ(shown.width, turned ? 2 : 3);
      // A step along the image of x (y) in the shown picture is a step along x (y) in the stored
      // one.
      const auto sign = [](std::int32_t v) { return v > 0 ? 1 : v < 0 ? -1 : 0; };
      const int ax = sign(matrix[0]), ay = sign(matrix[1]), cx = sign(matrix[3]),
                cy = sign(matrix[4]);
      const int x0 = (ax < 0 || cx < 0) ? shown.width - 1 : 0;
      const int y0 = (ay < 0 || cy < 0) ? shown.height - 1 : 0;
      for (int y = 0; y < 2; ++y)
        for (int x = 0; x < 3; ++x)
          EXPECT_EQ(shown.planes[0].row(y0 + ay * x + cy * y)[x0 + ax * x + cx * y], 10 * y + x)
              << degrees << (flip ? " flipped" : "");
    }
  }
}

// Files that are cut, damaged or none at all.

TEST_F(Video, SaysWhatIsWrongWithAFile) {
  EXPECT_THAT(error_of(folder_ / "none.mp4"), testing::HasSubstr("none.mp4: does not exist"));
  write_file(folder_ / "empty.mp4", "");
  EXPECT_THAT(error_of(folder_ / "empty.mp4"), testing::HasSubstr("is empty"));
  write_file(folder_ / "text.mp4", "this is no video, but it is long enough to be looked at");
  EXPECT_THAT(error_of(folder_ / "text.mp4"), testing::HasSubstr("cannot be read as a video"));
  ffmpeg(
      "-f lavfi -i testsrc2=size=64x48:duration=0.1 -c:v libx264 "
      "-bsf:v h264_metadata=matrix_coefficients=8 ycgco.mp4");
  EXPECT_THAT(error_of(folder_ / "ycgco.mp4"),
              testing::HasSubstr("has the colour matrix ycgco; expected bt709"));
  EXPECT_THAT(error_of(folder_), testing::HasSubstr("folder"));
  ffmpeg("-f lavfi -i sine=d=0.3 sound.m4a");
  EXPECT_THAT(error_of(folder_ / "sound.m4a"), testing::HasSubstr("no video stream"));
  ffmpeg("-f lavfi -i testsrc2=s=64x48:r=25:d=0.4 -c:v libx264 whole.mp4");
  const std::string whole = read_file(folder_ / "whole.mp4");
  write_file(folder_ / "cut.mp4", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(error_of(folder_ / "cut.mp4"), testing::HasSubstr("cut.mp4: "));
  EXPECT_THAT(error_of(folder_ / "whole.mp4", {.first_frame = 10}),
              testing::HasSubstr("whole.mp4: holds 10 frames"));
  EXPECT_THAT(error_of(folder_ / "whole.mp4", {.first_frame = 10, .where = {"s.toml", 2, 1}}),
              testing::HasSubstr("whole.mp4 holds 10 frames; first_frame = 10 is past its end"));
}

TEST_F(Video, CorruptPacketsAreFlaggedAndTheRestGoesOn) {
  ffmpeg("-f lavfi -i testsrc2=s=160x120:r=25:d=2 -c:v libx264 -g 10 -bf 0 whole.mkv");
  std::string bytes = read_file(folder_ / "whole.mkv");
  Random random(5);
  const std::size_t middle = bytes.size() / 2;
  for (std::size_t i = 0; i < 400; ++i) bytes[middle + i] = static_cast<char>(random());
  write_file(folder_ / "bad.mkv", bytes);
  Reader reader(folder_ / "bad.mkv");
  int frames = 0;
  int damaged = 0;
  bool last_damaged = true;
  while (const auto frame = reader.next()) {
    ++frames;
    damaged += frame->damaged ? 1 : 0;
    last_damaged = frame->damaged;
  }
  EXPECT_GT(frames, 35);
  EXPECT_GT(damaged + (50 - frames), 0);
  EXPECT_LT(damaged, 30);
  EXPECT_FALSE(last_damaged);
}

// What a reader of the whole video warns of.
std::vector<std::string> warnings_of(const fs::path& video, int* frames = nullptr) {
  std::vector<std::string> warnings;
  Reader reader(video, {}, [&](const std::string& words) { warnings.push_back(words); });
  all_planes(reader, frames);
  EXPECT_FALSE(reader.next());  // it says so once
  return warnings;
}

TEST_F(Video, TruncatedStreamEndsEarly) {
  ffmpeg("-f lavfi -i testsrc2=s=160x120:r=25:d=2 -c:v libx264 -movflags +faststart whole.mp4");
  const std::string bytes = read_file(folder_ / "whole.mp4");
  write_file(folder_ / "cut.mp4", bytes.substr(0, bytes.size() * 2 / 3));
  int frames = 0;
  const auto warnings = warnings_of(folder_ / "cut.mp4", &frames);
  EXPECT_GT(frames, 5);
  EXPECT_LT(frames, 50);
  ASSERT_FALSE(warnings.empty());
  EXPECT_THAT(warnings.back(),
              testing::HasSubstr("cut.mp4: ends early, after " + std::to_string(frames)));
}

// Which frames are damaged, in order.
std::vector<bool> damaged_frames(const fs::path& video, int threads) {
  Reader reader(video, {.threads = threads});
  std::vector<bool> damaged;
  while (const auto frame = reader.next()) damaged.push_back(frame->damaged);
  return damaged;
}

// The decoder tells a fault of the last packets as soon as it knows it, which depends on its
// threads.
TEST_F(Video, TheSameFramesOfATruncatedStreamAreDamagedForAnyNumberOfThreads) {
  ffmpeg("-f lavfi -i testsrc2=s=320x240:r=25:d=3 -c:v libx264 -movflags +faststart whole.mp4");
  const std::string bytes = read_file(folder_ / "whole.mp4");
  write_file(folder_ / "cut.mp4", bytes.substr(0, bytes.size() * 2 / 3));
  const std::vector<bool> one = damaged_frames(folder_ / "cut.mp4", 1);
  EXPECT_THAT(one, testing::Contains(true));
  for (int threads = 2; threads <= 5; ++threads)
    EXPECT_EQ(damaged_frames(folder_ / "cut.mp4", threads), one) << threads;
}

// Bytes within pictures are changed, and a packet of the transport stream is lost. The ffmpeg
// program says what one thread makes of it.
TEST_F(Video, ADamagedVideoHasTheSameFramesForAnyNumberOfThreads) {
  for (const std::string file : {"bad.mp4", "bad.ts"}) {
    ffmpeg(
        "-f lavfi -i testsrc2=s=160x120:r=25:d=4 -vf noise=alls=8:allf=t:all_seed=1 "
        "-filter_threads 1 -threads 1 -pix_fmt yuv420p -c:v libx264 -g 12 " +
        file);
    std::string bytes = read_file(folder_ / file);
    constexpr std::size_t kTsPacketBytes = 188;
    const std::size_t middle = bytes.size() / 2 / kTsPacketBytes * kTsPacketBytes;
    for (std::size_t at = middle + 60; at < bytes.size() / 4 * 3; at += 20 * kTsPacketBytes)
      for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<char>(bytes[at + i] ^ 0x5a);
    if (file == "bad.ts") bytes.erase(middle + 20 * kTsPacketBytes, kTsPacketBytes);
    write_file(folder_ / file, bytes);
    ffmpeg("-v fatal -threads 1 -i " + file +
           " -f rawvideo -fps_mode passthrough -pix_fmt yuv420p raw.bin");
    const std::string expected = read_file(folder_ / "raw.bin");
    const std::vector<bool> damaged = damaged_frames(folder_ / file, 1);
    EXPECT_THAT(damaged, testing::AllOf(testing::Contains(true), testing::Contains(false)));
    Reader alone(folder_ / file, {.threads = 1});
    for (const int threads : {1, 2, 5}) {
      Reader reader(folder_ / file, {.threads = threads, .with_cuts = true});
      EXPECT_TRUE(all_planes(reader) == expected) << file << ", " << threads << " threads";
      EXPECT_EQ(damaged_frames(folder_ / file, threads), damaged) << file << ", " << threads;
      Reader sought(folder_ / file, {.threads = threads});
      for (const double time_s : {0.2, 2.2, 3.6, 0.4}) {
        const auto frame = sought.at(time_s), same = alone.at(time_s);
        ASSERT_TRUE(frame && same);
        EXPECT_TRUE(planes_of(frame->picture) == planes_of(same->picture)) << file << time_s;
        EXPECT_EQ(frame->damaged, same->damaged) << file << time_s;
      }
    }
  }
}

TEST_F(Video, TruncatedMatroskaEndsEarlyToo) {
  ffmpeg("-f lavfi -i testsrc2=s=160x120:r=25:d=4 -c:v libx264 -g 5 whole.mkv");
  const std::string bytes = read_file(folder_ / "whole.mkv");
  write_file(folder_ / "cut.mkv", bytes.substr(0, bytes.size() / 2));
  ffmpeg("-i whole.mkv -c copy -copyts -output_ts_offset 1.7 later.mkv");
  EXPECT_THAT(warnings_of(folder_ / "cut.mkv"),
              testing::Contains(testing::HasSubstr("ends early")));
  EXPECT_THAT(warnings_of(folder_ / "whole.mkv"), testing::IsEmpty());
  // Its first frame is shown at 1.7 s.
  EXPECT_THAT(warnings_of(folder_ / "later.mkv"), testing::IsEmpty());
}

}  // namespace
}  // namespace airtruth::video
