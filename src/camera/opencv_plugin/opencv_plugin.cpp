// SPDX-License-Identifier: Apache-2.0
#include "camera/opencv_plugin/opencv_plugin.h"

#include "foundation/lazy_library/lazy_library.h"

namespace airtruth::opencv_plugin {

const Functions& functions() {
  static const auto& loaded = *static_cast<const Functions*>(
      lazy_library::symbol_of({"airtruth-late-opencv.so",
                               "AIRTRUTH_LATE_OPENCV",
                               "the part that follows corners and objects"},
                              lazy_library::of_build(kSymbol)));
  return loaded;
}

}  // namespace airtruth::opencv_plugin
