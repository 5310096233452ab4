// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/truth.h"

#include <utility>

#include <airtruth/truth.h>

#include "camera/lens/lens.h"
#include "library/records/public_forms.h"

namespace airtruth {

SequenceTruth public_truth(annotation::Truth truth) {
  return {public_lens(lens::lens_of(truth.lens)), std::move(truth.frames)};
}

SequenceTruth read_truth(const std::filesystem::path& file) {
  return public_truth(annotation::read_truth(file));
}

std::string truth_line(const FrameTruth& truth, const Lens& lens) {
  return annotation::jsonl_line(truth, lens::facts_of(lens.state().lens));
}

}  // namespace airtruth
