// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "picture/backdrop/backdrop.h"

namespace airtruth::backdrop {

// What open_backdrop() calls in its library. Throws Error where no EGL device can be opened.
std::unique_ptr<Backdrop> make_osg_backdrop(int width, int height, const Options& options);

}  // namespace airtruth::backdrop
