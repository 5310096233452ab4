// SPDX-License-Identifier: Apache-2.0
#include "studio/session/plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "encounter/passage/passage.h"
#include "foundation/base/error.h"
#include "foundation/geometry/box.h"
#include "foundation/json/or_null.h"
#include "labels/projection/exact_box.h"
#include "sequence/preview/rows.h"
#include "sequence/setup/flyable.h"
#include "sequence/setup/moment.h"
#include "sequence/setup/world.h"

namespace airtruth::session {
namespace {

using Json = nlohmann::ordered_json;

// Points of a drawn path, at most: one for every few pixels of the page.
constexpr std::int64_t kMostPoints = 300;

// Of the time about a stated closest approach, in which it is looked for.
constexpr double kBesideS = 1;

// Of a line over one frame.
constexpr std::int64_t kMostLinePoints = 150;

// Of what has no parallax.
constexpr double kFarAwayM = 1e7;

double hundredths(double value) { return rounded(value, 0.01); }

Json ned(const Vector3& p) { return {hundredths(p.x()), hundredths(p.y()), hundredths(p.z())}; }
Json box_json(const Box& box) {
  return {hundredths(box.x), hundredths(box.y), hundredths(box.width), hundredths(box.height)};
}

// Frames from the first one on at even steps, about `most` of `count`, and the last one.
std::vector<std::int64_t> spread(std::int64_t count, std::int64_t most) {
  const std::int64_t step = std::max<std::int64_t>(1, (count + most - 1) / most);
  std::vector<std::int64_t> frames;
  for (std::int64_t k = 0; k < count - 1; k += step) frames.push_back(k);
  frames.push_back(count - 1);
  return frames;
}

// The world with one for each party, which stands for all of it: the boxes of a flock's birds in
// hundreds of frames take longer than a drag may. Without what moves while a frame is exposed,
// which would take most of the time and widens a box by less than is seen in a path.
setup::World world_of_middles(const setup::World& whole,
                              const std::vector<preview::Party>& parties) {
  setup::World world = whole;
  world.actors.clear();
  for (const preview::Party& party : parties) world.actors.push_back(whole.actors[party.middle]);
  world.shutter = {};
  return world;
}

bool is_in_view(const setup::Moment& moment, const trajectory::Path& path) {
  const auto state = path.at(moment.time_s);
  const auto pixel =
      state ? projection::pixel_from_world(moment.sight, state->position_in_world) : std::nullopt;
  const lens::ImageSize size = moment.sight.lens->size();
  return pixel && setup::meets_frame({pixel->x(), pixel->y(), 1, 1}, size);
}

// The two ends of the horizon where it crosses the picture's surroundings; empty where the camera
// does not see it.
std::optional<std::array<double, 4>> horizon_in(const setup::Moment& moment) {
  // Directions around the compass.
  constexpr int kDirections = 72;
  const Vector3 own = moment.camera.position_in_world;
  const lens::ImageSize size = moment.sight.lens->size();
  std::optional<std::pair<double, Pixel>> left, right;  // by the angle from the camera's axis
  const Vector3 axis = moment.sight.cam_from_world.rotation.conjugate() * Vector3(0, 0, 1);
  const double heading = std::atan2(axis.y(), axis.x());
  for (int i = -kDirections / 2; i <= kDirections / 2; ++i) {
    const double angle = i * kPi / kDirections;
    const double azimuth = heading + angle;
    const auto pixel = projection::pixel_from_world(
        moment.sight, own + kFarAwayM * Vector3(std::cos(azimuth), std::sin(azimuth), 0));
    if (!pixel || std::abs(pixel->x() - size.width / 2.0) > 2 * size.width ||
        std::abs(pixel->y() - size.height / 2.0) > 2 * size.height)
      continue;
    if (!left) left = {angle, *pixel};
    right = {angle, *pixel};
  }
  if (!left || right->first <= left->first) return std::nullopt;
  return std::array{hundredths(left->second.x()),
                    hundredths(left->second.y()),
                    hundredths(right->second.x()),
                    hundredths(right->second.y())};
}

using Checks = std::map<document::Begin, std::vector<std::string>>;

// The sentences of the command line that are about each table, by where the table begins.
Checks checks_of(const Stage& stage) {
  Checks checks;
  std::map<std::string, document::Begin> begin_of_place;
  const scene::Scene& scene = stage.scene();
  for (std::size_t i = 0; i < scene.intruders.size(); ++i) {
    const Where& where = scene.intruders[i].where;
    begin_of_place[to_string(where) + ": "] = document::begin_of(where);
    std::vector<std::string>& lines = checks[document::begin_of(where)];
    if (!lines.empty()) continue;  // of another bird of the flock
    const std::string words = setup::words_beyond_limits(
        scene.intruders[i].aircraft, stage.world().actors[i].path, 0, stage.duration_s());
    if (!words.empty()) lines.push_back(words);
  }
  setup::warn_below_ground(scene, stage.world(), stage.duration_s(), [&](const std::string& said) {
    // "scene.toml:12:1: intruder 'a' is ..."
    for (const auto& [place, begin] : begin_of_place)
      if (said.starts_with(place)) checks[begin].push_back(said.substr(place.size()));
  });
  return checks;
}

bool is_in(const Pixel& pixel, const lens::Lens& lens) {
  return setup::meets_frame({pixel.x(), pixel.y(), 0, 0}, lens.size());
}

// Whether the frame can show the actor; of what has no bounds the reference point decides.
bool shows(const setup::Moment& moment, std::size_t actor) {
  if (!moment.search[actor]) return false;
  if (!moment.boxes[actor].partly_unseen) return true;
  const auto pixel =
      projection::pixel_from_world(moment.sight, moment.states[actor]->position_in_world);
  return pixel && is_in(*pixel, *moment.sight.lens);
}

// From the pixel of an aircraft's reference point to the middle of its box, times the range, by
// which it shrinks; 0 where it is not seen.
Pixel range_times_offset(const setup::Actor& actor,
                         const projection::Sight& sight,
                         const trajectory::State& camera,
                         double time_s) {
  const auto state = actor.path.at(time_s);
  if (!state) return Pixel::Zero();
  const auto box =
      projection::exact_box(
          sight, actor.type->silhouette, state->world_from_body_rigid(), actor.turned_s(time_s))
          .whole();
  const auto pixel = projection::pixel_from_world(sight, state->position_in_world);
  if (!box || !pixel) return Pixel::Zero();
  const double range_m = (state->position_in_world - camera.position_in_world).norm();
  return is_in(centre_of(*box), *sight.lens) ? Pixel(range_m * (centre_of(*box) - *pixel))
                                             : Pixel(Pixel::Zero());
}

Json cpa_of(const std::optional<passage::Approach>& closest) {
  if (!closest) return nullptr;
  return {{"time_s", rounded(closest->time_s, 1e-3)},
          {"right_m", hundredths(closest->offset.right_m)},
          {"above_m", hundredths(closest->offset.above_m)},
          {"ahead_m", hundredths(closest->offset.ahead_m)},
          {"distance_m", hundredths(closest->distance_m)}};
}

// Steps between marks, in degrees, and how many of them are along the picture's longer side at
// most.
constexpr int kStepsDeg[] = {1, 2, 5, 10, 15, 30};
constexpr double kMostAcross = 8;

int step_deg(double view_deg) {
  for (const int step : kStepsDeg)
    if (view_deg <= kMostAcross * step) return step;
  return kStepsDeg[std::size(kStepsDeg) - 1];
}

class Planner {
 public:
  Planner(Stage& stage, const document::Tables& tables)
      : stage_(stage),
        tables_(tables),
        parties_(preview::parties_of(stage.scene())),
        middles_(world_of_middles(stage.world(), parties_)),
        checks_(checks_of(stage)) {
    for (const std::int64_t k : spread(stage.frame_count(), kMostPoints))
      moments_.push_back(setup::moment_at(middles_, k, stage.time_s(k), stage.shake_at(k)));
  }

  Json plan() const {
    Json frames, own, horizon = Json::array();
    for (const setup::Moment& moment : moments_) {
      frames.push_back(moment.frame);
      own.push_back(ned(moment.camera.position_in_world));
      if (const auto line = horizon_in(moment)) horizon.push_back({moment.frame, *line});
    }
    const setup::Moment& first = moments_.front();
    const YawPitchRoll attitude = yaw_pitch_roll(first.camera.world_from_body);
    Json tracks = Json::array();
    const std::vector<std::string> approaches = approach_words();
    for (std::size_t i = 0; i < parties_.size(); ++i) tracks.push_back(track(i, approaches[i]));
    return {{"complete", stage_.is_complete()},
            {"frames", frames},
            {"own",
             {{"ned", own},
              {"velocity_mps", ned(first.camera.velocity_in_world_mps)},
              {"heading_deg", hundredths(attitude.yaw_deg)},
              {"attitude", stage_.attitude_words()},
              {"attitude_deg",
               {hundredths(attitude.yaw_deg),
                hundredths(attitude.pitch_deg),
                hundredths(attitude.roll_deg)}}}},
            {"horizontal_fov_deg", hundredths(preview::view_deg(stage_.world()))},
            {"tracks", tracks},
            {"horizon", horizon},
            {"volumes", volumes()},
            {"warnings", stage_.warnings()}};
  }

 private:
  // Of the middles, as they say, with what is ever in view.
  std::vector<std::string> approach_words() const {
    std::vector<preview::Party> single;
    std::set<std::size_t> seen;
    for (std::size_t i = 0; i < parties_.size(); ++i) {
      const char* which = parties_[i].actors.size() > 1 ? ", its middle" : "";
      single.push_back({parties_[i].name + which, {i}, i});
      const bool is_seen = std::ranges::any_of(moments_, [&](const auto& moment) {
        if (shows(moment, i)) return true;
        return std::ranges::any_of(parties_[i].actors, [&](std::size_t actor) {
          return is_in_view(moment, stage_.world().actors[actor].path);
        });
      });
      if (is_seen) seen.insert(i);
    }
    return preview::approach_lines(middles_, single, seen, stage_.duration_s());
  }

  Json track(std::size_t place, const std::string& approach) const {
    const preview::Party& party = parties_[place];
    const setup::Actor& actor = middles_.actors[place];
    const scene::Intruder& stated = stage_.scene().intruders[party.middle];
    const Json table = table_at(tables_, stated.where);
    Json points = Json::array();
    Json positions = Json::array();
    for (const setup::Moment& moment : moments_) {
      const auto& state = moment.states[place];
      positions.push_back(state ? ned(state->position_in_world) : Json());
      if (state) points.push_back(point(moment, place));
    }
    const auto closest = closest_approach(stated, actor);
    Json checks = Json::array();
    if (const auto found = checks_.find(document::begin_of(stated.where)); found != checks_.end())
      for (const std::string& line : found->second) checks.push_back(line);
    const std::size_t never = approach.find("never in view");
    if (never != std::string::npos || approach.find("not in the world") != std::string::npos)
      checks.push_back(approach);
    return {{"table", table},
            {"id", party.name},
            {"points", points},
            {"ned", positions},
            {"handles", handles(table, place)},
            {"cpa", cpa_of(closest)},
            {"approach", approach},
            {"checks", checks}};
  }

  // Of the clip, and of a time before or after it that an encounter states.
  std::optional<passage::Approach> closest_approach(const scene::Intruder& stated,
                                                    const setup::Actor& actor) const {
    double begin_s = 0;
    double end_s = stage_.duration_s();
    if (stated.encounter) {
      begin_s = std::min(begin_s, stated.encounter->cpa_time_s - kBesideS);
      end_s = std::max(end_s, stated.encounter->cpa_time_s + kBesideS);
    }
    return passage::closest_approach(stage_.world().camera, actor.path, begin_s, end_s);
  }

  // [frame, x, y, range_m, width_px, visible]
  static Json point(const setup::Moment& moment, std::size_t actor) {
    const Vector3& place = moment.states[actor]->position_in_world;
    const auto box = moment.boxes[actor].whole();
    auto pixel = projection::pixel_from_world(moment.sight, place);
    // As a moment of [[intruder.seen]] states it.
    if (box && is_in(centre_of(*box), *moment.sight.lens)) pixel = centre_of(*box);
    return {moment.frame,
            pixel ? Json(hundredths(pixel->x())) : Json(),
            pixel ? Json(hundredths(pixel->y())) : Json(),
            hundredths((place - moment.camera.position_in_world).norm()),
            box ? Json(hundredths(box->width)) : Json(),
            shows(moment, actor)};
  }

  // The moments of [[intruder.seen]] as the path has them.
  Json handles(const Json& table, std::size_t actor) const {
    Json result = Json::array();
    if (!table.is_array()) return result;
    setup::World alone = middles_;
    alone.actors = {middles_.actors[actor]};
    for (const scene::Seen& seen : stage_.stated_seen(parties_[actor].middle)) {
      const std::int64_t frame = stage_.frame_near(seen.time_s);
      const setup::Moment moment =
          setup::moment_at(alone, frame, stage_.time_s(frame), stage_.shake_at(frame));
      const auto& state = moment.states.front();
      const auto box = moment.boxes.front().whole();
      result.push_back(
          {{"frame", frame},
           {"pixel", {seen.pixel.x(), seen.pixel.y()}},
           {"range_m",
            state ? Json(hundredths(
                        (state->position_in_world - moment.camera.position_in_world).norm()))
                  : Json()},
           {"width_px",
            seen.width_px ? Json(*seen.width_px)
            : box         ? Json(hundredths(box->width))
                          : Json()}});
    }
    return result;
  }

  Json volumes() const {
    Json result = Json::array();
    for (const auto& [name, volume] : stage_.world().volumes)
      result.push_back({{"name", name},
                        {"horizontal_m", volume.horizontal_m},
                        {"vertical_m", volume.vertical_m}});
    return result;
  }

  Stage& stage_;
  const document::Tables& tables_;
  std::vector<preview::Party> parties_;
  setup::World middles_;
  // Of the frames at which paths have their points.
  std::vector<setup::Moment> moments_;
  Checks checks_;
};

}  // namespace

Json table_at(const document::Tables& tables, const Where& where) {
  const auto found = tables.find(document::begin_of(where));
  return found == tables.end() ? Json() : found->second;
}

Json plan_of(Stage& stage, const document::Tables& tables) { return Planner(stage, tables).plan(); }

Json boxes_of(const Stage& stage, const setup::Moment& moment, const document::Tables& tables) {
  Json result = Json::array();
  for (std::size_t i = 0; i < moment.search.size(); ++i) {
    const auto box = moment.boxes[i].whole();
    if (!box || !shows(moment, i)) continue;
    result.push_back(
        {{"table", table_at(tables, stage.scene().intruders[i].where)},
         {"id", stage.world().actors[i].id},
         {"box", box_json(*box)},
         {"range_m",
          hundredths(
              (moment.states[i]->position_in_world - moment.camera.position_in_world).norm())}});
  }
  return result;
}

Json lines_over(const Stage& stage, std::int64_t frame, const document::Tables& tables) {
  const setup::World& world = stage.world();
  const double time_s = stage.time_s(frame);
  const auto camera = world.camera.at(time_s);
  const auto sight = stage.sight_at(frame);
  if (!camera || !sight) return Json::array();
  const std::vector<std::int64_t> frames = spread(stage.frame_count(), kMostLinePoints);
  Json lines = Json::array();
  for (const preview::Party& party : preview::parties_of(stage.scene())) {
    const setup::Actor& actor = world.actors[party.middle];
    const Pixel to_middle = range_times_offset(actor, *sight, *camera, time_s);
    Json points = Json::array();
    for (const std::int64_t k : frames) {
      const auto own = world.camera.at(stage.time_s(k));
      const auto other = actor.path.at(stage.time_s(k));
      if (own && other) {
        const Vector3 off = other->position_in_world - own->position_in_world;
        auto pixel = projection::pixel_from_world(*sight, camera->position_in_world + off);
        if (pixel) *pixel += to_middle / off.norm();
        points.push_back({k,
                          pixel ? Json(rounded(pixel->x(), 0.1)) : Json(),
                          pixel ? Json(rounded(pixel->y(), 0.1)) : Json()});
      }
    }
    lines.push_back({{"table", table_at(tables, stage.scene().intruders[party.middle].where)},
                     {"points", points}});
  }
  return lines;
}

Json directions_over(const Stage& stage, std::int64_t frame) {
  Json marks = Json::array();
  const auto sight = stage.sight_at(frame);
  if (!sight) return marks;
  const double view_deg =
      std::max(sight->lens->horizontal_fov_deg(), sight->lens->vertical_fov_deg());
  const int step = step_deg(view_deg);
  const Rigid world_from_cam = sight->cam_from_world.inverse();
  const Vector3 axis = world_from_cam.rotation * Vector3(0, 0, 1);
  // Farther from the axis nothing is in the picture: half of its diagonal is narrower than its
  // longer side.
  const double reach_deg = std::min(180.0, view_deg);
  const double least = std::cos(radians(reach_deg));
  const double axis_deg = degrees(std::asin(std::clamp(-axis.z(), -1.0, 1.0)));
  for (int elevation = -90 + step; elevation < 90; elevation += step) {
    if (std::abs(elevation - axis_deg) > reach_deg) continue;
    for (int azimuth = 0; azimuth < 360; azimuth += step) {
      const Vector3 direction = unit_vector(azimuth, elevation);
      if (direction.dot(axis) < least) continue;
      const auto pixel =
          projection::pixel_from_world(*sight, world_from_cam.translation + kFarAwayM * direction);
      if (pixel && is_in(*pixel, *sight->lens))
        marks.push_back({azimuth, elevation, rounded(pixel->x(), 0.1), rounded(pixel->y(), 0.1)});
    }
  }
  return marks;
}

}  // namespace airtruth::session
