// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/lens_facts.h"

#include "camera/lens/lens.h"

namespace airtruth::annotation {

LensFacts facts_of(const lens::Lens& lens) {
  LensFacts facts;
  facts.model = lens.name();
  facts.width = lens.size().width;
  facts.height = lens.size().height;
  const lens::Numbers numbers = lens::numbers_of(lens);
  facts.focal_px = {numbers.focal_px.x(), numbers.focal_px.y()};
  facts.principal_point_px = {numbers.principal_point_px.x(), numbers.principal_point_px.y()};
  facts.distortion = numbers.distortion;
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

bool is_in_view(const Frame& frame, const Intruder& intruder, const lens::Lens& lens) {
  if (!intruder.position_in_cam_m) return false;
  const auto nominal = lens.pixel_from_cam(vector_of(*intruder.position_in_cam_m));
  if (!nominal) return false;
  const Vector3 h = shake_of(frame).frame_from_reference * Vector3(nominal->x(), nominal->y(), 1);
  if (!(h.z() > 0)) return false;
  return lens.size().holds(h.head<2>() / h.z());
}

bool lacks_box(const Frame& frame, const Intruder& intruder, const lens::Lens& lens) {
  return !intruder.visible_box_px && intruder.state != State::kHidden &&
         is_in_view(frame, intruder, lens);
}

}  // namespace airtruth::annotation
