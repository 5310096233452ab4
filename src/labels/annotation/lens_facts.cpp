// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/lens_facts.h"

#include <variant>

#include "camera/lens/model_kind.h"

namespace airtruth::annotation {

LensFacts facts_of(const lens::Lens& lens) {
  LensFacts facts;
  facts.model = lens.name();
  facts.width = lens.size().width;
  facts.height = lens.size().height;
  std::visit(
      [&](const auto& model) {
        facts.focal_px = {model.focal_px.x(), model.focal_px.y()};
        facts.principal_point_px = {model.principal_point_px.x(), model.principal_point_px.y()};
        if constexpr (requires { model.distortion; }) facts.distortion = model.distortion;
      },
      lens.model());
  return facts;
}

lens::Lens lens_of(const LensFacts& facts) {
  const Pixel focal(facts.focal_px[0], facts.focal_px[1]);
  const Pixel principal(facts.principal_point_px[0], facts.principal_point_px[1]);
  const lens::ImageSize size{facts.width, facts.height};
  const auto kind = enum_named<lens::ModelKind>(facts.model);
  if (kind == lens::ModelKind::kFisheye)
    return lens::Lens(lens::Fisheye{focal, principal, facts.distortion}, size);
  if (kind == lens::ModelKind::kBrownConrady)
    return lens::Lens(lens::BrownConrady{focal, principal, facts.distortion}, size);
  return lens::Lens(lens::Pinhole{focal, principal}, size);
}

}  // namespace airtruth::annotation
