// SPDX-License-Identifier: Apache-2.0
// AC3D models, and the arrays that the model reader hands back: anything but an Error is a finding.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "aircraft/ac3d/ac_file.h"
#include "aircraft/ac3d/ac_mesh.h"
#include "aircraft/confined/protocol.h"
#include "foundation/base/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace airtruth;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  try {
    const ac3d::AcFile file = ac3d::parse_ac(text, "a.ac");
    for (std::size_t i = 0; i < file.objects.size(); ++i) {
      (void)ac3d::names_of(file, i);
      (void)ac3d::batches_of(file, file.objects[i]);
    }
  } catch (const airtruth::Error&) {
  }
  try {
    model::check_model(confined::model_from_bytes(text));
  } catch (const airtruth::Error&) {
  }
  return 0;
}
