// SPDX-License-Identifier: Apache-2.0
#include "camera/late_opencv/late_opencv.h"

#include "foundation/lazy_library/lazy_library.h"

namespace airtruth::late {

const OpenCv& opencv() {
  static const auto& functions = *static_cast<const OpenCv*>(
      lazy_library::symbol_of({"airtruth-late-opencv.so",
                               "AIRTRUTH_LATE_OPENCV",
                               "the part that follows corners and objects"},
                              kOpenCvSymbol));
  return functions;
}

}  // namespace airtruth::late
