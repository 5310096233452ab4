// SPDX-License-Identifier: Apache-2.0
#include "calibration/camera_file/extinction_quantity.h"

#include <fmt/format.h>

namespace airtruth::calibration {
namespace {

// Koschmieder (1924): extinction = 3.912 / visibility, the range at which 2 % of the contrast
// remain.
constexpr double kKoschmieder = 3.912;
// The visibility beyond which the international visibility code calls the air exceptionally clear
// (extinction.h).
constexpr double kClearKm = kVisibilityClassesKm.back();

Quantity hazy_prior(const Air& air, bool height_known) {
  const double per_km = kKoschmieder / *air.visibility_km;
  const Estimate hazy{per_km, per_km};
  Quantity quantity;
  quantity.values = {hazy, hazy, hazy};
  quantity.note = fmt::format(
      "not measured; a prior by the horizon's look, which is that of {} km of visibility or "
      "less{}: {}",
      *air.visibility_km,
      height_known ? "" : fmt::format(" from {} m above the ground", kAssumedHeightM),
      air.extinction_per_km.why());
  return quantity;
}

Quantity clear_air(const Air& air) {
  const Estimate clear{0, kKoschmieder / kClearKm};
  Quantity quantity;
  quantity.values = {clear, clear, clear};
  quantity.note = fmt::format("not measured, and drawn as clear air{}: {}",
                              air.visibility_km ? ", as the horizon looks" : "",
                              air.extinction_per_km.why());
  return quantity;
}

}  // namespace

Quantity extinction_quantity(const Air& air, bool height_known) {
  if (air.extinction_per_km) {
    Quantity quantity;
    put(quantity, air.extinction_per_km);
    return quantity;
  }
  if (air.visibility_km && *air.visibility_km < kClearKm) return hazy_prior(air, height_known);
  return clear_air(air);
}

}  // namespace airtruth::calibration
