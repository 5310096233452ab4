// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "labels/annotation/evision.h"

namespace airtruth::annotation {
namespace {

// Formats a double as OpenCV's FileStorage does: "150." for a whole number, else 17 digits and an
// exponent, which has three digits as in the published files.
std::string number(double value) {
  check(std::isfinite(value), "an annotation holds finite numbers");
  if (std::abs(value) < 2147483648.0 && value == std::nearbyint(value))
    return fmt::format("{}.", static_cast<std::int64_t>(value));
  std::string text = fmt::format("{:.16e}", value);
  const std::size_t exponent = text.find('e') + 2;
  if (text.size() - exponent < 3) text.insert(exponent, 3 - (text.size() - exponent), '0');
  return text;
}

std::string point(const char* tag, const Vector3& p) {
  return fmt::format("  <{0}>\n    <x>{1}</x>\n    <y>{2}</y>\n    <z>{3}</z></{0}>\n",
                     tag,
                     number(p.x()),
                     number(p.y()),
                     number(p.z()));
}

std::string rectangle(const PixelBox& box) {
  return fmt::format(
      "  <IntruderRect_pix>\n    <x>{}</x>\n    <y>{}</y>\n    <width>{}</width>\n"
      "    <height>{}</height></IntruderRect_pix>",
      box.x,
      box.y,
      box.width,
      box.height);
}

}  // namespace

std::string evision_xml(const std::vector<std::optional<EvisionFrame>>& frames,
                        const std::vector<Vector3>& camera_ned_m) {
  check(frames.size() == camera_ned_m.size(), "a camera position for each frame");
  std::string xml = "<?xml version=\"1.0\"?>\n<opencv_storage>\n";
  int last = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    last = frames[i] ? frames[i]->number : last + 1;
    xml += fmt::format("<frame_{}>\n", last) + point("CameraPos_m", camera_ned_m[i]);
    if (frames[i]) {
      xml += point("IntruderPos_m", frames[i]->intruder_ned_m);
      xml += fmt::format("  <Distance_m>{}</Distance_m>\n", number(frames[i]->distance_m));
    }
    xml +=
        rectangle(frames[i] ? frames[i]->rect_px : PixelBox{}) + fmt::format("</frame_{}>\n", last);
  }
  return xml + "</opencv_storage>\n";
}

}  // namespace airtruth::annotation
