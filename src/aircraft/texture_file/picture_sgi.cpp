// SPDX-License-Identifier: Apache-2.0
#include <string>
#include <utility>

#include "aircraft/texture_file/picture_formats.h"
#include "foundation/base/error.h"

// The SGI Image File Format 0.97 (Paul Haeberli): big-endian, channels one after another, rows from
// the bottom up.
namespace airtruth::texture_file {
namespace {

// Length of the header.
constexpr std::size_t kSgiHeaderBytes = 512;

class SgiReader {
 public:
  SgiReader(std::string_view bytes, const PictureLimits& limits) : bytes_(bytes) {
    if (bytes.size() < kSgiHeaderBytes) fail("ends inside its header");
    run_length_ = byte(2) == 1;
    bytes_per_sample_ = byte(3);
    if (byte(2) > 1 || bytes_per_sample_ < 1 || bytes_per_sample_ > 2)
      fail("has an unknown storage or sample size");
    const std::uint32_t dimensions = word(4);
    const std::uint32_t height = dimensions >= 2 ? word(8) : 1;
    channels_ = dimensions >= 3 ? word(10) : 1;
    if (dimensions < 1 || dimensions > 3 || channels_ < 1 || channels_ > 4 || long_word(104) != 0)
      fail("has no 1 to 4 plain channels");
    picture_ = blank_picture(word(6), height, limits);
  }

  Picture read() {
    for (std::uint32_t channel = 0; channel < channels_; ++channel)
      for (int y = 0; y < picture_.height; ++y)
        run_length_ ? read_runs(channel, y) : read_verbatim(channel, y);
    spread_channels();
    return std::move(picture_);
  }

 private:
  [[noreturn]] static void fail(const std::string& what) {
    throw Error("is an SGI picture with a fault: it " + what);
  }
  std::uint32_t byte(std::size_t at) const {
    if (at >= bytes_.size()) fail("ends inside its pixels");
    return static_cast<unsigned char>(bytes_[at]);
  }
  std::uint32_t word(std::size_t at) const { return byte(at) << 8 | byte(at + 1); }
  std::uint32_t long_word(std::size_t at) const { return word(at) << 16 | word(at + 2); }

  // The upper byte of a sample of 16 bits.
  std::uint8_t sample(std::size_t at) const {
    if (bytes_per_sample_ == 2) (void)byte(at + 1);
    return static_cast<std::uint8_t>(byte(at));
  }
  std::size_t row_number(std::uint32_t channel, int y) const {
    return std::size_t{channel} * static_cast<std::size_t>(picture_.height) +
           static_cast<std::size_t>(y);
  }
  std::uint8_t& pixel(std::uint32_t channel, int x, int y) {
    return picture_
        .rgba[4 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(picture_.width) +
                   static_cast<std::size_t>(x)) +
              channel];
  }

  void read_verbatim(std::uint32_t channel, int y) {
    std::size_t at = kSgiHeaderBytes + row_number(channel, y) *
                                           static_cast<std::size_t>(picture_.width) *
                                           bytes_per_sample_;
    for (int x = 0; x < picture_.width; ++x, at += bytes_per_sample_)
      pixel(channel, x, y) = sample(at);
  }

  // Runs of one row: the low 7 bits count, the 8th says that the samples follow one by one.
  void read_runs(std::uint32_t channel, int y) {
    const std::size_t row = row_number(channel, y);
    std::size_t at = long_word(kSgiHeaderBytes + 4 * row);
    int x = 0;
    while (x < picture_.width) {
      const std::uint32_t control = bytes_per_sample_ == 2 ? word(at) : byte(at);
      at += bytes_per_sample_;
      const int count = static_cast<int>(control & 0x7f);
      if (count == 0) fail("has a row that ends early");
      if (count > picture_.width - x) fail("has a row that is too long");
      const bool literal = (control & 0x80) != 0;
      for (int i = 0; i < count; ++i) {
        pixel(channel, x++, y) = sample(at);
        if (literal) at += bytes_per_sample_;
      }
      if (!literal) at += bytes_per_sample_;
    }
  }

  // One channel is gray, two are gray and alpha.
  void spread_channels() {
    for (std::size_t i = 0; i < picture_.rgba.size(); i += 4) {
      std::uint8_t* p = &picture_.rgba[i];
      if (channels_ != 2 && channels_ != 4) p[3] = 255;
      if (channels_ == 2) p[3] = p[1];
      if (channels_ <= 2) p[1] = p[2] = p[0];
    }
  }

  std::string_view bytes_;
  bool run_length_ = false;
  std::uint32_t bytes_per_sample_ = 1;
  std::uint32_t channels_ = 1;
  Picture picture_;
};

}  // namespace

Picture read_sgi(std::string_view bytes, const PictureLimits& limits) {
  return SgiReader(bytes, limits).read();
}

}  // namespace airtruth::texture_file
