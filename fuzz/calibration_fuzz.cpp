// SPDX-License-Identifier: Apache-2.0
// What users give as calibrations and paths: anything but an Error is a finding.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "camera/lens/calibration_file.h"
#include "foundation/base/error.h"
#include "scene/trajectory/path.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  for (const char* name : {"a.json", "a.yml", "a.xml"}) {
    try {
      const airtruth::lens::Lens lens = airtruth::lens::parse_calibration(text, name, {64, 48});
      (void)lens.ray_from_pixel({10, 10});
    } catch (const airtruth::Error&) {
    }
  }
  try {
    const auto path = airtruth::trajectory::parse_path_csv(text, "a.csv");
    (void)path.at(path.start_s());
  } catch (const airtruth::Error&) {
  }
  return 0;
}
