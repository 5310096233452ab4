// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens/lens.h"
#include "labels/annotation/truth.h"

// Conversion between a lens and its form in truth.jsonl. The round trip keeps every number:
// lens_of(facts_of(lens)) maps each ray to the same pixel as the lens does.
namespace airtruth::annotation {

LensFacts facts_of(const lens::Lens& lens);

// facts.model is "pinhole", "brown_conrady" or "fisheye"; the reader of truth.jsonl has checked it.
lens::Lens lens_of(const LensFacts& facts);

// True where the intruder's reference point lies in the picture. The answer follows from its
// position through the stated lens and motion alone, without any pixel or box.
bool is_in_view(const Frame& frame, const Intruder& intruder, const lens::Lens& lens);

// True where the intruder is in view, nothing hides it, and the truth holds no box for it.
bool lacks_box(const Frame& frame, const Intruder& intruder, const lens::Lens& lens);

}  // namespace airtruth::annotation
