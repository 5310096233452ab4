// SPDX-License-Identifier: Apache-2.0
#include "picture/backdrop/backdrop.h"

#include "foundation/lazy_library/lazy_library.h"

namespace airtruth::backdrop {

std::unique_ptr<Backdrop> open_backdrop(int width, int height, const Options& options) {
  static const auto open = *static_cast<const BackdropOpener*>(
      lazy_library::symbol_of({"airtruth-late-backdrop.so",
                               "AIRTRUTH_LATE_BACKDROP",
                               "the part with OpenGL for the method chroma-key"},
                              lazy_library::of_build(kBackdropSymbol)));
  return open(width, height, options);
}

}  // namespace airtruth::backdrop
