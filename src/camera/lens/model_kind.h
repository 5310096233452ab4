// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "foundation/base/enum_names.h"

namespace airtruth::lens {

// The models of lens.h, in the order of lens::Model. Scenes and truth.jsonl use these names.
enum class ModelKind { kPinhole, kBrownConrady, kFisheye };

constexpr auto enum_names(ModelKind) {
  return std::to_array<EnumName<ModelKind>>({{ModelKind::kPinhole, "pinhole"},
                                             {ModelKind::kBrownConrady, "brown_conrady"},
                                             {ModelKind::kFisheye, "fisheye"}});
}

}  // namespace airtruth::lens
