// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens/lens.h"
#include "labels/annotation/truth.h"

namespace airtruth::annotation {

// True where the intruder's reference point lies in the picture. The answer follows from its
// position through the stated lens and motion alone, without any pixel or box.
bool is_in_view(const Frame& frame, const Intruder& intruder, const lens::Lens& lens);

// True where the intruder is in view, nothing hides it, and the truth holds no box for it.
bool lacks_box(const Frame& frame, const Intruder& intruder, const lens::Lens& lens);

}  // namespace airtruth::annotation
