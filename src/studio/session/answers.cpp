// SPDX-License-Identifier: Apache-2.0
#include "studio/session/answers.h"

#include <memory>
#include <new>

#include <opencv2/imgproc.hpp>
#include <turbojpeg.h>

#include "foundation/base/error.h"
#include "foundation/image/colour.h"
#include "labels/annotation/truth.h"
#include "show/drawing/draw.h"

namespace airtruth::session {
namespace {

using Json = nlohmann::ordered_json;

// Seams of crops cannot be seen from here on: chosen by looking.
constexpr int kQuality = 92;

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
};

}  // namespace

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string ok(std::int64_t id, const Json& result) {
  return text_of({{"id", id}, {"ok", result}});
}

std::string error(std::int64_t id, const std::string& line) {
  return text_of({{"id", id}, {"error", line}});
}

std::string framed(const Json& header, const std::string& jpeg) {
  const std::string text = text_of(header);
  const auto size = static_cast<std::uint32_t>(text.size());
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((size >> shift) & 0xFFU);
  return bytes + text + jpeg;
}

std::string jpeg_of(const image::Rgb8& rgb) {
  const std::unique_ptr<void, Destroy> encoder(tjInitCompress());
  if (!encoder) throw std::bad_alloc();
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(encoder.get(),
                                 rgb.samples.get(),
                                 rgb.width,
                                 0,
                                 rgb.height,
                                 TJPF_RGB,
                                 &bytes,
                                 &size,
                                 TJSAMP_420,
                                 kQuality,
                                 TJFLAG_FASTDCT);
  const std::unique_ptr<unsigned char, void (*)(unsigned char*)> owner(bytes, tjFree);
  check(failed == 0, "a picture can be written as JPEG");
  return {reinterpret_cast<const char*>(bytes), size};
}

std::string jpeg_of(const image::Picture& picture, const PixelBox& part, double scale) {
  const image::Rgb8 rgb = image::rgb8_from_picture(picture, part);
  return scale < 1 ? jpeg_of(drawing::scaled(rgb, scale, cv::INTER_AREA)) : jpeg_of(rgb);
}

Json values_of(const camera_file::Calibration& found) {
  Json values = Json::array();
  for (const camera_file::QuantityKey& key : camera_file::kQuantityKeys) {
    const camera_file::Quantity& quantity = found.quantities.*key.member;
    Json value, spread;
    if (quantity.values.size() == 1) {
      value = quantity.values[0].value;
      spread = quantity.values[0].sigma;
    } else if (!quantity.values.empty()) {
      for (const auto& one : quantity.values) {
        value.push_back(one.value);
        spread.push_back(one.sigma);
      }
    }
    values.push_back(
        {{"key", key.name}, {"value", value}, {"error", spread}, {"missing", quantity.missing}});
  }
  return values;
}

Json boxes_of_film(const std::filesystem::path& truth) {
  Json frames = Json::array();
  for (const annotation::Frame& frame : annotation::read_truth(truth).frames) {
    Json boxes = Json::array();
    for (const annotation::Intruder& intruder : frame.intruders)
      if (intruder.state == annotation::State::kVisible && intruder.exact_box_px) {
        const Box& box = *intruder.exact_box_px;
        boxes.push_back({{"id", intruder.id}, {"box", {box.x, box.y, box.width, box.height}}});
      }
    if (!boxes.empty()) frames.push_back({frame.frame, boxes});
  }
  return frames;
}

}  // namespace airtruth::session
