// SPDX-License-Identifier: Apache-2.0
#include "truth/annotation/in_view.h"

namespace airtruth::annotation {

lens::Lens lens_from(const LensFacts& facts) {
  const Pixel focal(facts.focal_px[0], facts.focal_px[1]);
  const Pixel principal(facts.principal_point_px[0], facts.principal_point_px[1]);
  const lens::ImageSize size{facts.width, facts.height};
  if (facts.model == "fisheye")
    return lens::Lens(lens::Fisheye{focal, principal, facts.distortion}, size);
  if (facts.model == "brown_conrady")
    return lens::Lens(lens::BrownConrady{focal, principal, facts.distortion}, size);
  return lens::Lens(lens::Pinhole{focal, principal}, size);
}

bool is_in_view(const Frame& frame, const Intruder& intruder, const lens::Lens& lens) {
  if (!intruder.position_in_cam_m) return false;
  const auto nominal = lens.pixel_from_cam(*intruder.position_in_cam_m);
  if (!nominal) return false;
  const Vector3 h = frame.shake.frame_from_reference * Vector3(nominal->x(), nominal->y(), 1);
  if (!(h.z() > 0)) return false;
  const Pixel pixel = h.head<2>() / h.z();
  return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < lens.size().width &&
         pixel.y() < lens.size().height;
}

bool lacks_box(const Frame& frame, const Intruder& intruder, const lens::Lens& lens) {
  return !intruder.visible_box_px && intruder.state != State::kHidden &&
         is_in_view(frame, intruder, lens);
}

}  // namespace airtruth::annotation
