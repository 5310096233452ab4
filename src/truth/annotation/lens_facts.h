// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "camera/lens/lens.h"
#include "truth/annotation/truth.h"

// A lens as each line of truth.jsonl states it, and back. The round trip keeps every number:
// lens_of(facts_of(lens)) maps each ray to the same pixel as lens does.
namespace airtruth::annotation {

LensFacts facts_of(const lens::Lens& lens);

// facts.model is "pinhole", "brown_conrady" or "fisheye", as the reader of truth.jsonl has checked.
lens::Lens lens_of(const LensFacts& facts);

}  // namespace airtruth::annotation
