// SPDX-License-Identifier: Apache-2.0
#include "runners/results/vot_regions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include <fmt/format.h>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/geometry/box.h"
#include "runners/results/detections.h"

namespace airtruth::results {
namespace {

using evaluation::Mark;

constexpr std::size_t kMaskHead = 4;     // x, y, width, height
constexpr double kMaxMaskSide = 65'535;  // px; that of a picture in any format

Region marked(double code) {
  if (code == 1) return {{Mark::kBegun, {}}};
  if (code == 2) return {{Mark::kFailed, {}}};
  return {{Mark::kUnknown, {}}};
}

// A box without area is an answer without a box.
Region answer(const std::optional<Box>& box) {
  return {{Mark::kAnswer, box && is_sound(*box) ? box : std::nullopt}};
}

// Of x, y, width, height.
Region rectangle(const std::vector<double>& n, int origin_px) {
  Region region = answer(Box{n[0] - origin_px, n[1] - origin_px, n[2], n[3]});
  region.has_negative_side = n[2] < 0 || n[3] < 0;
  return region;
}

// Little-endian numbers of a file's bytes, one after another.
class Bytes {
 public:
  explicit Bytes(const std::filesystem::path& file) : file_(file), bytes_(read_file(file)) {}

  template <typename T>
  T next() {
    static_assert(std::endian::native == std::endian::little);
    if (left() < sizeof(T)) fail("ends within a region");
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  template <typename T>
  std::vector<double> next(std::size_t count) {
    if (left() / sizeof(T) < count) fail("ends within a region");
    std::vector<double> values(count);
    for (double& value : values) value = static_cast<double>(next<T>());
    return values;
  }
  std::size_t left() const { return bytes_.size() - at_; }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("{} (byte {}); expected a binary trajectory of VOT", what, at_),
                {file_.string()});
  }

 private:
  const std::filesystem::path& file_;
  std::string bytes_;
  std::size_t at_ = 0;
};

Region next_region(Bytes& bytes, int origin_px) {
  switch (const auto type = bytes.next<std::uint8_t>()) {
    case 0:
      return marked(bytes.next<std::uint32_t>());
    case 1:
      return rectangle(bytes.next<float>(4), origin_px);
    case 2: {
      const auto points = bytes.next<std::uint16_t>();
      return answer(bounds_of_polygon(bytes.next<float>(std::size_t{2} * points), origin_px));
    }
    case 3: {
      std::vector<double> n = bytes.next<std::int16_t>(2);
      const std::vector<double> size = bytes.next<std::uint16_t>(3);
      const auto runs = bytes.next<std::uint16_t>(static_cast<std::size_t>(size[2]));
      n.insert(n.end(), size.begin(), size.begin() + 2);
      n.insert(n.end(), runs.begin(), runs.end());
      if (const auto fault = fault_of_mask(n)) bytes.fail("what ends here " + *fault);
      return answer(exchange::bounds_of_mask(n, origin_px));
    }
    default:
      bytes.fail(fmt::format("has a region of type {}", type));
  }
}

}  // namespace

std::optional<Box> bounds_of_polygon(const std::vector<double>& n, int origin_px) {
  BoxBounds bounds;
  for (std::size_t i = 0; i + 1 < n.size(); i += 2) {
    if (!std::isfinite(n[i] + n[i + 1])) return std::nullopt;
    bounds.add({n[i] - origin_px, n[i + 1] - origin_px});
  }
  return bounds.box();
}

std::optional<std::string> fault_of_mask(const std::vector<double>& n) {
  if (n.size() < kMaskHead) return "is a mask of fewer than four numbers";
  for (const double value : n)
    if (value != std::floor(value) || !(std::abs(value) <= kMaxMaskSide * kMaxMaskSide))
      return "is a mask with what is no whole number";
  const bool has_size = n[2] >= 0 && n[3] >= 0 && n[2] <= kMaxMaskSide && n[3] <= kMaxMaskSide;
  if (!has_size) return "is a mask of a size out of all bounds";
  double pixels = 0;
  for (std::size_t i = kMaskHead; i < n.size(); ++i) {
    if (n[i] < 0) return "is a mask with a negative run length";
    pixels += n[i];
  }
  if (pixels > n[2] * n[3]) return "is a mask whose runs are longer than the mask";
  return std::nullopt;
}

Region region_of(const exchange::Line& line, const std::filesystem::path& file, int origin_px) {
  if (line.text.starts_with('m')) {
    const std::vector<double> n = exchange::numbers_of({line.number, line.text.substr(1)}, file);
    if (const auto fault = fault_of_mask(n)) throw Error(*fault, {file.string(), line.number});
    return answer(exchange::bounds_of_mask(n, origin_px));
  }
  const std::vector<double> n = exchange::numbers_of(line, file);
  if (n.size() == 1) return marked(n[0]);
  if (n.size() != 4 && (n.size() < 6 || n.size() % 2 != 0))
    throw Error(fmt::format("has {} numbers; expected x,y,width,height", n.size()),
                {file.string(), line.number});
  if (std::any_of(n.begin(), n.end(), [](double value) { return std::isnan(value); }))
    return marked(0);
  if (n.size() == 4) return rectangle(n, origin_px);
  return answer(bounds_of_polygon(n, origin_px));
}

std::vector<Region> read_binary_regions(const std::filesystem::path& file, int origin_px) {
  Bytes bytes(file);
  if (const auto version = bytes.next<std::int16_t>(); version != 1)
    bytes.fail(fmt::format("has version {}", version));
  const auto count = bytes.next<std::uint32_t>();
  std::vector<Region> regions;
  for (std::uint32_t i = 0; i < count; ++i) regions.push_back(next_region(bytes, origin_px));
  if (bytes.left() > 0) bytes.fail(fmt::format("has more than its {} regions", count));
  return regions;
}

}  // namespace airtruth::results
