// SPDX-License-Identifier: Apache-2.0
// The first byte chooses: the description beside a network, or what a child process that a hostile
// network has taken over may return. The result is a description, detections with finite boxes, or
// an Error.
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "foundation/base/error.h"
#include "runners/network/model_description.h"
#include "runners/network/network_child.h"
#include "runners/network/network_output.h"

namespace {

using namespace airtruth;
using namespace airtruth::network;

ModelDescription description(bool heat_map) {
  ModelDescription description;
  description.classes = {"aircraft", "bird"};
  if (heat_map) {
    description.output = HeatMapOutput{"heat", "offset", "size"};
  } else {
    description.output = YoloOutput{"boxes", YoloOutput::Order::kYolov5};
  }
  return description;
}

void check(const std::vector<results::Detection>& found) {
  if (found.size() > kMostDetections) std::abort();
  for (const results::Detection& one : found) {
    const double sum = one.score + one.box_px.x + one.box_px.y + one.box_px.area();
    if (!std::isfinite(sum) || one.box_px.width <= 0 || one.box_px.height <= 0) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view content(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    if (data[0] % 3 == 0) {
      description_from(content, "a.json");
    } else {
      check(decoded(tensors_from_bytes(content), description(data[0] % 3 == 1), 16, 8));
    }
  } catch (const Error&) {
  }
  return 0;
}
