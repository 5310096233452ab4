// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens/lens.h"
#include "truth/annotation/truth.h"

namespace airtruth::annotation {

// Does the intruder's reference point lie in the picture, by its position through the stated lens
// and motion alone? No pixel and no box is looked at.
bool is_in_view(const Frame& frame, const Intruder& intruder, const lens::Lens& lens);

// It is in view, nothing hides it, and no box says where.
bool lacks_box(const Frame& frame, const Intruder& intruder, const lens::Lens& lens);

}  // namespace airtruth::annotation
