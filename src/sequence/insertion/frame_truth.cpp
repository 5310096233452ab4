// SPDX-License-Identifier: Apache-2.0
#include "sequence/insertion/frame_truth.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "encounter/passage/passage.h"
#include "encounter/separation/violation.h"
#include "foundation/image/contrast_to_noise.h"
#include "labels/projection/exact_box.h"
#include "labels/projection/spot_box.h"

namespace airtruth::insertion {
namespace {

// True where its reference point is in the picture, whatever the renderer's samples meet: a far
// silhouette is thinner than they are apart.
bool is_point_in_view(const setup::Moment& moment, std::size_t i) {
  const auto pixel =
      projection::pixel_from_world(moment.sight, moment.states[i]->position_in_world);
  return moment.search[i] && pixel && moment.sight.lens->size().holds(*pixel);
}

annotation::State state_of(const setup::Moment& moment,
                           std::size_t i,
                           const Vector3& p_in_cam,
                           const image::Layer& layer,
                           const composite::Visible* visible) {
  using annotation::State;
  if (visible != nullptr && visible->box) return State::kVisible;
  const bool drawn =
      moment.search[i] && i < layer.areas.size() && layer.areas[i].alone_in_frame_px > 0;
  if (drawn || is_point_in_view(moment, i)) return State::kHidden;
  if (!moment.boxes[i].box && p_in_cam.z() <= 0) return State::kBehind;
  return State::kOutside;
}

void add_bearings(annotation::Intruder& truth,
                  const setup::Moment& moment,
                  const trajectory::State& state,
                  const Vector3& offset_in_world) {
  const projection::Bearing nominal = projection::bearing_of(
      cam_from_body() * (moment.camera.world_from_body.conjugate() * offset_in_world));
  truth.nominal_azimuth_deg = nominal.azimuth_deg;
  truth.nominal_elevation_deg = nominal.elevation_deg;
  const auto seen =
      projection::seen_bearing(moment.sight, state.position_in_world, state.velocity_in_world_mps);
  if (!seen) return;
  truth.azimuth_deg = seen->azimuth_deg;
  truth.elevation_deg = seen->elevation_deg;
}

annotation::EncounterTruth encounter_of(const setup::World& world,
                                        const trajectory::State& own_state,
                                        const trajectory::State& state) {
  const separation::Mover own = passage::mover_of(own_state);
  const separation::Mover intruder = passage::mover_of(state);
  annotation::EncounterTruth truth =
      separation::measures(own, intruder, {.lookahead_s = world.lookahead_s});
  for (const auto& [name, volume] : world.volumes) {
    const bool inside = separation::is_inside(volume, own, intruder);
    const auto violated = separation::violation(volume, own, intruder, world.lookahead_s);
    annotation::VolumeTruth& one = truth.volumes.emplace_back();
    one.name = name;
    one.inside = inside;
    // At the volume's very edge rounding may decide the two differently.
    if (inside)
      one.to_violation_s = 0;
    else if (violated)
      one.to_violation_s = violated->begin_s;
  }
  return truth;
}

void add_geometry(annotation::Intruder& truth,
                  const setup::Moment& moment,
                  const trajectory::State& state) {
  const Vector3 offset = state.position_in_world - moment.camera.position_in_world;
  const Vector3 p_in_cam = moment.sight.cam_from_world * state.position_in_world;
  const double range_m = offset.norm();
  truth.position_ned_m = numbers_of(state.position_in_world);
  truth.velocity_ned_mps = numbers_of(state.velocity_in_world_mps);
  truth.attitude_yaw_pitch_roll_deg = numbers_of(yaw_pitch_roll(state.world_from_body));
  truth.position_in_cam_m = numbers_of(p_in_cam);
  truth.range_m = range_m;
  if (range_m > 0) {
    const Vector3 relative = state.velocity_in_world_mps - moment.camera.velocity_in_world_mps;
    truth.range_rate_mps = offset.dot(relative) / range_m;
    add_bearings(truth, moment, state, offset);
  }
}

void add_pixels(annotation::Intruder& truth,
                std::size_t i,
                const image::Layer& layer,
                const composite::Visible& visible) {
  truth.visible_box_px = visible.box;
  if (visible.box && visible.covered) {
    truth.covered_box_px = visible.covered->box;
    truth.covered_area_px = visible.covered->area_px;
  }
  truth.visible_area_px = visible.pixels;
  truth.alpha_sum_px = visible.alpha_sum_px;
  if (const auto& centroid = visible.centroid) truth.centroid_px = {centroid->x(), centroid->y()};
  if (i >= layer.areas.size() || layer.areas[i].alone_px <= 0) return;
  const image::Areas& areas = layer.areas[i];
  const auto fraction = [&](double part) { return std::clamp(part / areas.alone_px, 0.0, 1.0); };
  truth.hidden_by_own_aircraft = fraction(areas.seen_px - areas.free_px);
  double by_occluder = fraction(areas.free_px - areas.clear_px);
  truth.hidden_by_intruder = fraction(areas.alone_in_frame_px - areas.seen_px);
  truth.cut_by_frame = fraction(areas.alone_px - areas.alone_in_frame_px);
  constexpr double kRounding = 1e-6;  // sums of float coverages
  for (double* share : {&truth.hidden_by_own_aircraft,
                        &by_occluder,
                        &truth.hidden_by_intruder,
                        &truth.cut_by_frame})
    if (*share < kRounding) *share = 0;
  if (truth.hidden_by_occluder) truth.hidden_by_occluder = by_occluder;
}

// What is on the lens has boxes alone.
annotation::Intruder mark_truth(const setup::World& world,
                                const setup::Moment& moment,
                                std::size_t mark,
                                const Painted& painted) {
  using annotation::State;
  const image::Layer& layer = painted.layer;
  const std::vector<composite::Visible>& visible = painted.visible;
  annotation::Intruder truth;
  if (painted.has_occluders) truth.hidden_by_occluder = 0;
  truth.id = world.lens_marks[mark].id;
  truth.aircraft = truth.object_class = enum_name(world.lens_marks[mark].kind);
  if (!setup::is_there(world.lens_marks[mark], moment.time_s)) return truth;
  truth.state = State::kOutside;
  const auto& spot = moment.spots[mark];
  if (!spot) return truth;
  const lens::ImageSize size = world.lens.size();
  truth.exact_box_px = projection::spot_box(*spot, moment.sight.shutter, size.width, size.height);
  // Nothing is drawn where all lie wholly beyond the frame.
  if (!setup::meets_frame(*truth.exact_box_px, size)) truth.cut_by_frame = 1;
  const std::size_t i = world.actors.size() + mark;
  const bool drawn = i < layer.areas.size() && layer.areas[i].alone_in_frame_px > 0;
  if (drawn) truth.state = State::kHidden;
  if (i >= visible.size()) return truth;
  if (visible[i].box) truth.state = State::kVisible;
  add_pixels(truth, i, layer, visible[i]);
  return truth;
}

std::vector<annotation::Intruder> intruders_of(const setup::World& world,
                                               const setup::Moment& moment,
                                               const Painted& painted) {
  const image::Layer& layer = painted.layer;
  const std::vector<composite::Visible>& visible = painted.visible;
  std::vector<annotation::Intruder> result;
  for (std::size_t i = 0; i < world.actors.size(); ++i) {
    annotation::Intruder truth;
    truth.id = world.actors[i].id;
    truth.aircraft = world.actors[i].aircraft;
    truth.object_class = world.actors[i].object_class;
    if (painted.has_occluders) truth.hidden_by_occluder = 0;
    if (moment.states[i]) {
      add_geometry(truth, moment, *moment.states[i]);
      truth.encounter = encounter_of(world, moment.camera, *moment.states[i]);
      const composite::Visible* seen = i < visible.size() ? &visible[i] : nullptr;
      truth.state = state_of(moment, i, vector_of(*truth.position_in_cam_m), layer, seen);
      truth.exact_box_px = truth.state == annotation::State::kVisible ? moment.boxes[i].box
                                                                      : moment.boxes[i].whole();
      if (seen != nullptr) add_pixels(truth, i, layer, *seen);
      // The points that have a pixel do not bound a shape that reaches through the camera's plane:
      // what the picture shows of it, up to the border, belongs to the box, too.
      if (truth.covered_box_px && moment.boxes[i].partly_unseen) {
        const Box covered = as_box(*truth.covered_box_px);
        truth.exact_box_px = bounds(moment.boxes[i].box.value_or(covered), covered);
      }
      // What lies wholly beyond the frame is not drawn.
      if (truth.exact_box_px && !moment.search[i]) truth.cut_by_frame = 1;
    }
    result.push_back(std::move(truth));
  }
  for (std::size_t mark = 0; mark < world.lens_marks.size(); ++mark)
    result.push_back(mark_truth(world, moment, mark, painted));
  return result;
}

}  // namespace

annotation::Frame frame_truth(const setup::World& world,
                              const video::Frame& frame,
                              const std::string& motion_state,
                              const Shake& shake,
                              const setup::Moment& moment,
                              const Painted& painted) {
  annotation::Frame truth;
  truth.frame = frame.index;
  truth.time_s = frame.time_s;
  truth.damaged = frame.damaged;
  truth.motion_state = motion_state;
  annotation::take_shake(shake, truth);
  truth.camera_position_ned_m = numbers_of(moment.camera.position_in_world);
  truth.camera_attitude_yaw_pitch_roll_deg =
      numbers_of(yaw_pitch_roll(moment.camera.world_from_body));
  truth.intruders = intruders_of(world, moment, painted);
  for (annotation::Intruder& intruder : truth.intruders)
    if (const auto box = annotation::box_to_show(intruder))
      intruder.contrast_to_noise = image::contrast_to_noise(frame.picture, *box);
  return truth;
}

}  // namespace airtruth::insertion
