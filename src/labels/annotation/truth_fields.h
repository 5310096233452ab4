// SPDX-License-Identifier: Apache-2.0
#pragma once

// The fields of a frame's truth with their keys in truth.jsonl, in the order of the file: the one
// list from which a line is written and read, and by which a table of the truth has its columns:
// visit(key, member).
namespace airtruth::annotation {

// Of an encounter, without its volumes.
template <typename Visit, typename AnyEncounter>
void each_measure(const Visit& visit, AnyEncounter& of) {
  visit("horizontal_m", of.horizontal_m);
  visit("above_m", of.above_m);
  visit("closing_speed_mps", of.closing_speed_mps);
  visit("bearing_deg", of.bearing_deg);
  visit("bearing_rate_dps", of.bearing_rate_dps);
  visit("relative_bearing_deg", of.relative_bearing_deg);
  visit("line_of_sight_rate_dps", of.line_of_sight_rate_dps);
  visit("tcpa_s", of.tcpa_s);
  visit("dcpa_m", of.dcpa_m);
  visit("hmd_m", of.hmd_m);
  visit("vmd_m", of.vmd_m);
  visit("tau_mod_s", of.tau_mod_s);
  visit("tcoa_s", of.tcoa_s);
}

// Of an intruder, after its id, its aircraft and its class.
template <typename Visit, typename AnyIntruder>
void each_field(const Visit& visit, AnyIntruder& of) {
  visit("state", of.state);
  visit("position_ned_m", of.position_ned_m);
  visit("velocity_ned_mps", of.velocity_ned_mps);
  visit("attitude_yaw_pitch_roll_deg", of.attitude_yaw_pitch_roll_deg);
  visit("position_in_cam_m", of.position_in_cam_m);
  visit("range_m", of.range_m);
  visit("range_rate_mps", of.range_rate_mps);
  visit("azimuth_deg", of.azimuth_deg);
  visit("elevation_deg", of.elevation_deg);
  visit("nominal_azimuth_deg", of.nominal_azimuth_deg);
  visit("nominal_elevation_deg", of.nominal_elevation_deg);
  visit("encounter", of.encounter);
  visit("exact_box_px", of.exact_box_px);
  visit("covered_box_px", of.covered_box_px);
  visit("covered_area_px", of.covered_area_px);
  visit("visible_box_px", of.visible_box_px);
  visit("contrast_to_noise", of.contrast_to_noise);
  visit("visible_area_px", of.visible_area_px);
  visit("alpha_sum_px", of.alpha_sum_px);
  visit("centroid_px", of.centroid_px);
  visit("hidden_by_own_aircraft", of.hidden_by_own_aircraft);
  visit("hidden_by_occluder", of.hidden_by_occluder);
  visit("hidden_by_intruder", of.hidden_by_intruder);
  visit("cut_by_frame", of.cut_by_frame);
}

}  // namespace airtruth::annotation
