// SPDX-License-Identifier: Apache-2.0
#include "picture/video/writer.h"

#include <filesystem>
#include <memory>
#include <string>
#include <utility>

#include <gtest/gtest.h>
#include <unistd.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/seed.h"

namespace airtruth::video {
namespace {

class WriterFile : public testing::Test {
 protected:
  WriterFile()
      : folder_(fs::temp_directory_path() / ("airtruth_writer_" + std::to_string(::getpid()))) {
    fs::create_directories(folder_);
  }
  ~WriterFile() override { fs::remove_all(folder_); }
  fs::path folder_;
};

constexpr int kWidth = 70, kHeight = 38;  // neither a multiple of 16 nor of 32

Frame noise(std::int64_t index, const image::Colour& colour) {
  Frame frame;
  frame.index = frame.pts = index;
  frame.picture = image::make_picture(kWidth, kHeight, colour);
  Random random(static_cast<std::uint64_t>(index));
  for (int i = 0; i < frame.picture.plane_count; ++i) {
    image::Plane& plane = frame.picture.planes[static_cast<std::size_t>(i)];
    for (int y = 0; y < plane.height; ++y)
      for (int x = 0; x < plane.width; ++x)
        plane.row(y)[x] = static_cast<std::uint8_t>(random() % 256);
  }
  return frame;
}

StreamInfo stream_of(const image::Colour& colour) {
  StreamInfo info;
  info.width = kWidth;
  info.height = kHeight;
  info.colour = colour;
  return info;
}

TEST_F(WriterFile, LentFramesGiveTheBytesOfCopiedOnes) {
  for (const Format format : {Format::kMp4, Format::kMkv, Format::kAvi}) {
    for (const image::Chroma chroma :
         {image::Chroma::k420, image::Chroma::k422, image::Chroma::k444}) {
      image::Colour colour;
      colour.chroma = chroma;
      const fs::path copied = folder_ / ("copied" + std::string(extension(format)));
      const fs::path lent = folder_ / ("lent" + std::string(extension(format)));
      Writer copies(copied, stream_of(colour), {.format = format});
      Writer lends(lent, stream_of(colour), {.format = format});
      for (std::int64_t k = 0; k < 30; ++k) {
        const auto frame = std::make_shared<const Frame>(noise(k, colour));
        copies.write(*frame);
        lends.write(frame);
      }
      copies.finish();
      lends.finish();
      EXPECT_EQ(sha256_of_file(copied), sha256_of_file(lent)) << extension(format);
      EXPECT_GT(fs::file_size(lent), 30u * kWidth * kHeight / 4);  // noise does not shrink
    }
  }
}

TEST_F(WriterFile, KeepsNoLentFrameAfterItsEnd) {
  std::weak_ptr<const Frame> last;
  {
    const auto frame = std::make_shared<const Frame>(noise(0, {}));
    last = frame;
    Writer writer(folder_ / "short.mkv", stream_of({}), {.format = Format::kMkv});
    writer.write(frame);
    writer.finish();
  }
  EXPECT_TRUE(last.expired());
}

fs::path written(const fs::path& file, const WriterOptions& options, std::string* encoder) {
  Writer writer(file, stream_of({}), options);
  for (std::int64_t k = 0; k < 20; ++k) writer.write(noise(k, {}));
  writer.finish();
  *encoder = writer.encoder();
  return file;
}

TEST_F(WriterFile, AutoIsX264WithItsBytesWhereNoHardwareEncodes) {
  std::string encoder;
  const fs::path x264 = written(folder_ / "x264.mp4", {}, &encoder);
  EXPECT_EQ(encoder, "libx264");
  const fs::path any = written(folder_ / "auto.mp4", {.encoder = Encoder::kAuto}, &encoder);
  EXPECT_GT(fs::file_size(any), 1000u);
  if (encoder != "libx264") GTEST_SKIP() << "this machine encodes by " << encoder;
  EXPECT_EQ(sha256_of_file(any), sha256_of_file(x264));
}

TEST_F(WriterFile, AMissingEncoderIsAnErrorAtItsPlace) {
  image::Colour colour;
  colour.chroma = image::Chroma::k444;  // none of them takes it, whatever the machine has
  for (const auto& [encoder, name] : {std::pair(Encoder::kNvenc, "h264_nvenc"),
                                      std::pair(Encoder::kVaapi, "h264_vaapi"),
                                      std::pair(Encoder::kQsv, "h264_qsv")}) {
    const WriterOptions options{.encoder = encoder, .encoder_where = {"s.toml", 12, 11}};
    const fs::path file = folder_ / "hardware.mp4";
    try {
      const Writer writer(file, stream_of(colour), options);
      ADD_FAILURE() << name << " took 4:4:4";
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find("s.toml:12:11: encoder " + std::string(name)), 0u)
          << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos);
    }
    EXPECT_TRUE(fs::is_empty(folder_));
  }
}

}  // namespace
}  // namespace airtruth::video
