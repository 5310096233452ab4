// SPDX-License-Identifier: Apache-2.0
#include "labels/annotation/in_view.h"

namespace airtruth::annotation {

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
