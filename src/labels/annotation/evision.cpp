// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/evision.h"

#include <cerrno>
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/format.h>
#include <pugixml.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/base/text.h"

namespace airtruth::annotation {
namespace {

// Largest pixel coordinate; sums of two such numbers fit an int.
constexpr int kLargestPixel = 1 << 29;

// Names in corrupt files may be long and contain any character.
std::string short_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  return printable(name, 40) + (name.size() > 40 ? "..." : "");
}

class Reader {
 public:
  Reader(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

  Evision read(const pugi::xml_node& storage) {
    Evision result;
    int last = 0;
    for (const pugi::xml_node& node : storage.children()) {
      if (node.type() != pugi::node_element) continue;
      const int number = frame_number(node);
      if (number <= last)
        fail(node,
             fmt::format(
                 "frame_{} comes after frame_{}; expected increasing numbers", number, last));
      last = number;
      result.camera_ned_m.push_back(point(child(node, "CameraPos_m")));
      result.frames.push_back(frame(node, number));
    }
    return result;
  }

 private:
  [[noreturn]] void fail(const pugi::xml_node& node, const std::string& message) {
    throw Error(message, {file_, line_of(text_, node.offset_debug()), 0});
  }

  int frame_number(const pugi::xml_node& node) {
    const std::string_view name = node.name();
    if (name.starts_with("frame_")) {
      const auto number = number_from_text<int>(name.substr(6));
      if (number && *number >= 1 && *number < std::numeric_limits<int>::max()) return *number;
    }
    fail(node, fmt::format("found <{}>; expected <frame_1>, <frame_2>, ...", short_name(node)));
  }

  pugi::xml_node child(const pugi::xml_node& node, const char* name) {
    const pugi::xml_node found = node.child(name);
    if (!found) fail(node, fmt::format("<{}> has no <{}>", short_name(node), name));
    return found;
  }

  double number(const pugi::xml_node& node) {
    const auto value = number_from_text<double>(trimmed(node.text().get()));
    if (!value || !std::isfinite(*value))
      fail(node, fmt::format("<{}> holds no finite number", short_name(node)));
    return *value;
  }

  int pixels(const pugi::xml_node& node) {
    const double value = number(node);
    if (value != std::floor(value) || std::abs(value) > kLargestPixel)
      fail(node, fmt::format("<{}> holds no whole number of pixels", short_name(node)));
    return static_cast<int>(value);
  }

  Vector3 point(const pugi::xml_node& node) {
    return {number(child(node, "x")), number(child(node, "y")), number(child(node, "z"))};
  }

  PixelBox rectangle(const pugi::xml_node& node) {
    const PixelBox box{pixels(child(node, "x")),
                       pixels(child(node, "y")),
                       pixels(child(node, "width")),
                       pixels(child(node, "height"))};
    if (box.width < 0 || box.height < 0) fail(node, "<IntruderRect_pix> has a negative size");
    return box;
  }

  std::optional<EvisionFrame> frame(const pugi::xml_node& node, int number_of_frame) {
    EvisionFrame frame;
    frame.number = number_of_frame;
    frame.rect_px = rectangle(child(node, "IntruderRect_pix"));
    const pugi::xml_node position = node.child("IntruderPos_m");
    if (!position) return std::nullopt;
    frame.intruder_ned_m = point(position);
    frame.distance_m = number(child(node, "Distance_m"));
    return frame;
  }

  std::string_view text_;
  std::string file_;
};

}  // namespace

Evision parse_evision(std::string_view text, const std::filesystem::path& name) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed =
      document.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
  if (!parsed)
    throw Error(std::string("is not XML: ") + parsed.description(),
                {name.string(), line_of(text, parsed.offset), 0});
  const pugi::xml_node storage = document.child("opencv_storage");
  if (!storage)
    throw Error("has no <opencv_storage>; expected an annotation of OpenCV's FileStorage",
                {name.string()});
  return Reader(text, name.string()).read(storage);
}

Evision read_evision(const std::filesystem::path& file) {
  return parse_evision(read_file(file), file);
}

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

EvisionWriter::EvisionWriter(const std::filesystem::path& file)
    : file_(file), out_(file, std::ios::binary) {
  out_ << "<?xml version=\"1.0\"?>\n<opencv_storage>\n";
}

void EvisionWriter::add(const std::optional<EvisionFrame>& frame, const Vector3& camera_ned_m) {
  last_ = frame ? frame->number : last_ + 1;
  std::string xml = fmt::format("<frame_{}>\n", last_) + point("CameraPos_m", camera_ned_m);
  if (frame) {
    xml += point("IntruderPos_m", frame->intruder_ned_m);
    xml += fmt::format("  <Distance_m>{}</Distance_m>\n", number(frame->distance_m));
  }
  xml += rectangle(frame ? frame->rect_px : PixelBox{}) + fmt::format("</frame_{}>\n", last_);
  out_ << xml;
}

void EvisionWriter::finish() {
  out_ << "</opencv_storage>\n";
  out_.close();
  if (!out_) throw Error(std::string("cannot write: ") + std::strerror(errno), {file_.string()});
}

}  // namespace airtruth::annotation
