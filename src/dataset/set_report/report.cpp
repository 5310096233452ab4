// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <mutex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dataset/set_report/card.h"
#include "dataset/set_report/encounters.h"
#include "dataset/set_report/portrait.h"
#include "dataset/set_report/totals.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"
#include "foundation/json/or_null.h"
#include "sequence/setup/from_scene.h"
#include "show/html/page.h"
#include "show/plot/plot.h"

namespace airtruth::set_report {
namespace {

using Json = nlohmann::ordered_json;

// Upper bound for the stills of all sequences together; a still takes some 30 kB of the page.
constexpr std::size_t kMaxStills = 1000;
constexpr std::size_t kMaxStillsOfOne = 60;
constexpr std::size_t kMinStillsOfOne = 4;

// The frames of which the series of the page are, by index: at most 120 of a sequence, a display
// choice.
std::set<std::size_t> sampled_frames(const annotation::Truth& truth) {
  return drawing::spread_over(truth.frames.size(), 120);
}

// The series are stored in columns because a page of a thousand sequences holds a hundred thousand
// points.
void add_place(const std::optional<std::array<double, 3>>& ned_m, Json& series) {
  for (const auto& [key, axis] :
       {std::pair("north_m", 0u), std::pair("east_m", 1u), std::pair("down_m", 2u)})
    series[key].push_back(ned_m ? Json(rounded((*ned_m)[axis], 0.1)) : Json());
}

void add_point(const replay::Finished& finished,
               const annotation::Frame& frame,
               const annotation::Intruder& intruder,
               Json& series) {
  const auto box = annotation::box_to_show(intruder);
  const auto closest = closest_s(finished, intruder.id);
  series["frame"].push_back(frame.frame);
  series["range_m"].push_back(rounded(intruder.range_m, 0.1));
  series["width_px"].push_back(box ? Json(double(box->width)) : Json());
  series["height_px"].push_back(box ? Json(double(box->height)) : Json());
  add_place(intruder.position_ned_m, series);
  series["state"].push_back(enum_name(intruder.state));
  series["to_closest_s"].push_back(closest ? Json(rounded(*closest - frame.time_s, 0.001))
                                           : Json());
}

void add_camera(const annotation::Frame& frame, const lens::ImageSize& size, Json& series) {
  const Homography h = annotation::shake_of(frame).frame_from_reference;
  const Vector3 middle(size.width / 2.0, size.height / 2.0, 1);
  const double yaw_deg = frame.camera_attitude_yaw_pitch_roll_deg[0];
  series["frame"].push_back(frame.frame);
  add_place(frame.camera_position_ned_m, series);
  series["yaw_deg"].push_back(rounded(yaw_deg, 0.01));
  // Of the picture's centre by the measured motion.
  series["shift_px"].push_back(
      rounded(((h * middle).hnormalized() - middle.head<2>()).norm(), 0.01));
  series["roll_deg"].push_back(rounded(degrees(std::atan2(h(1, 0), h(0, 0))), 0.001));
}

Json intruders_json(const replay::Finished& finished) {
  Json list = Json::array();
  std::map<std::string, std::size_t> places;
  for (const std::size_t i : sampled_frames(finished.truth))
    for (const annotation::Intruder& intruder : finished.truth.frames[i].intruders) {
      const auto [place, is_new] = places.emplace(intruder.id, list.size());
      if (is_new) list.push_back({{"id", intruder.id}, {"aircraft", intruder.aircraft}});
      add_point(finished, finished.truth.frames[i], intruder, list[place->second]);
    }
  return list;
}

// Of an imported clip nothing is known of it.
Json camera_json(const replay::Finished& finished, const lens::ImageSize& size) {
  Json series;
  for (const char* key :
       {"frame", "north_m", "east_m", "down_m", "yaw_deg", "shift_px", "roll_deg"})
    series[key] = Json::array();
  if (finished.scene)
    for (const std::size_t i : sampled_frames(finished.truth))
      add_camera(finished.truth.frames[i], size, series);
  return series;
}

// The records as sequence.json has them, with the places of the closest approach.
Json encounters_json(const replay::Finished& finished) {
  Json list = pipeline::json_of(finished.encounters);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto closest = closest_places(finished.truth.frames, finished.encounters[i]);
    if (!closest) continue;
    list[i]["own_ned_m"] = closest->own_ned_m;
    list[i]["intruder_ned_m"] = closest->intruder_ned_m;
  }
  return list;
}

// Of the containers that airtruth writes and imports, browsers play these.
bool plays_in_browsers(const fs::path& video) {
  return fs::is_regular_file(video) &&
         (video.extension() == ".mp4" || video.extension() == ".webm");
}

Json film_json(const Film& film) {
  Json stills = Json::array();
  for (const Film::Still& still : film.stills) {
    Json boxes = Json::array();
    for (const auto& [intruder, box] : still.boxes)
      boxes.push_back(Json{intruder, box.x, box.y, box.width, box.height});
    Json& json = stills.emplace_back(Json{{"frame", still.frame}, {"boxes", boxes}});
    const drawing::Cutout& close = still.close;
    if (!close.jpeg.empty()) json["zoom"] = {close.x, close.y, close.px};
  }
  return stills;
}

// The mean contrast over the frames of the film; null without any.
Json mean_contrast(const Film& film) {
  if (film.contrasts.empty()) return {};
  double sum = 0;
  for (const double value : film.contrasts) sum += value;
  return rounded(sum / static_cast<double>(film.contrasts.size()), 0.1);
}

Json ends_json(const Portrait::Ends& ends) {
  if (!ends) return Json::array({nullptr, nullptr});
  return Json::array({rounded(ends->first, 0.1), rounded(ends->second, 0.1)});
}

// A path as the page links to it.
fs::path beside(const fs::path& page, const fs::path& path) {
  return fs::absolute(path).lexically_relative(fs::absolute(page).parent_path());
}

// The files of a sequence by name, without hidden ones, as the page links to them.
Json links_of(const fs::path& folder, const fs::path& page) {
  Json links = Json::array();
  for (const fs::path& file : entries(folder))
    if (fs::is_regular_file(file))
      links.push_back((beside(page, folder) / file.filename()).generic_string());
  return links;
}

Json json_of(const replay::Finished& finished, const Portrait& portrait, const fs::path& page) {
  const auto& scene = finished.scene;
  const lens::ImageSize size{portrait.info.width, portrait.info.height};
  const double seconds = static_cast<double>(finished.truth.frames.size()) /
                         std::max(1e-9, portrait.info.frame_rate.value());
  return {
      {"name", portrait.facts.name},
      {"background", portrait.facts.background_name},
      {"aircraft", portrait.facts.categories},
      {"frames", portrait.facts.frames},
      {"seconds", rounded(seconds, 0.01)},
      {"width", size.width},
      {"height", size.height},
      {"fov_deg",
       scene ? Json(rounded(setup::lens_of(scene->lens, size).horizontal_fov_deg(), 0.1)) : Json()},
      {"sun_azimuth_deg", scene ? Json(rounded(scene->light.sun_azimuth_deg, 0.1)) : Json()},
      {"sun_elevation_deg", scene ? Json(rounded(scene->light.sun_elevation_deg, 0.1)) : Json()},
      {"weather", portrait.facts.weather},
      {"motion_model", scene ? enum_name(scene->motion.model) : ""},
      {"visible", portrait.frames_by_state[0]},
      {"hidden", portrait.frames_by_state[1]},
      {"range_m", ends_json(portrait.range_m)},
      {"size_px", ends_json(portrait.size_px)},
      {"contrast", mean_contrast(portrait.film)},
      {"loop_frames", portrait.film.loop_frames},
      {"loop_side", portrait.film.loop_side},
      {"stills", film_json(portrait.film)},
      {"poster", portrait.film.poster},
      {"ids", replay::intruder_ids(finished.truth)},
      {"video",
       plays_in_browsers(finished.video) ? Json(beside(page, finished.video).generic_string())
                                         : Json()},
      {"intruders", intruders_json(finished)},
      {"camera", camera_json(finished, size)},
      {"encounters", encounters_json(finished)},
      {"files", links_of(finished.folder, page)}};
}

// The sequences of a set, and the counts over them.
struct Gallery {
  std::vector<Portrait> portraits;
  // As the page reads them; null where one is not shown.
  std::vector<Json> shown;
  Totals totals;
};

// Of a sequence that is not shown, no frame is decoded.
Gallery gallery_of(const labelled::LabelledSet& labelled,
                   const fs::path& page,
                   const ReportOptions& options) {
  const std::size_t count = labelled.names().size();
  Gallery gallery{std::vector<Portrait>(count), std::vector<Json>(count), {}};
  const std::set<std::size_t> shown = drawing::spread_over(count, options.max_shown);
  const std::size_t stills =
      std::clamp(kMaxStills / std::max<std::size_t>(1, count), kMinStillsOfOne, kMaxStillsOfOne);
  std::mutex mutex;
  in_parallel(count, options, [&](std::size_t i) {
    const bool is_shown = shown.contains(i);
    const std::string& name = labelled.names()[i];
    const replay::Finished finished = replay::open_finished(labelled.folder(name));
    Portrait portrait = portrait_of(labelled, name, finished, is_shown ? stills : 0, options.stop);
    if (is_shown) gallery.shown[i] = json_of(finished, portrait, page);
    const std::lock_guard lock(mutex);
    // Sums of whole numbers, the same in any order.
    gallery.totals.add(finished, portrait);
    gallery.portraits[i] = std::move(portrait);
  });
  return gallery;
}

// The name on the card, or the name of the folder.
std::string title_of(const Json& card, const fs::path& set) {
  if (card.contains("name")) return card.at("name").get<std::string>();
  return absolute_path(set).filename().string();
}

Json colours() {
  Json colours = Json::array();
  for (std::size_t i = 0; i < plot::kColours.size(); ++i)
    colours.push_back(plot::json_of(plot::style_of(i)).at("colour"));
  return colours;
}

// The counts over all sequences, as the page reads them.
Json json_of(const Totals& totals) {
  Json plots = Json::object();
  for (const auto& [name, plot] : overview_plots(totals)) plots[name] = plot::json_of(plot);
  return {{"frames", totals.frames},
          {"without_box", totals.without_box},
          {"frames_with_intruder", totals.frames_with_intruder},
          {"negative_sequences", totals.negative_sequences},
          {"classes", totals.boxes_by_class},
          {"centres",
           {{"columns", Totals::kCellColumns},
            {"rows", Totals::kCellRows},
            {"counts", totals.centres}}},
          {"plots", plots},
          // Of intruders, in their order.
          {"colours", colours()}};
}

// The pictures of all films, under the names by which the page finds them.
std::vector<html::PagePicture> pictures_of(const std::vector<const Portrait*>& portraits) {
  std::vector<html::PagePicture> pictures;
  for (std::size_t i = 0; i < portraits.size(); ++i) {
    const Film& film = portraits[i]->film;
    for (std::size_t k = 0; k < film.stills.size(); ++k)
      drawing::add_still(pictures, i, k, film.stills[k]);
    pictures.push_back({fmt::format("loop-{}", i), film.loop_jpeg});
  }
  return pictures;
}

}  // namespace

void write_report(const fs::path& set, const fs::path& out, const ReportOptions& options) {
  check_output_file(out, options.overwrite);
  const labelled::LabelledSet labelled(set);
  Gallery gallery = gallery_of(labelled, out, options);
  std::vector<const Portrait*> shown;
  Json sequences = Json::array();
  for (std::size_t i = 0; i < gallery.portraits.size(); ++i) {
    if (gallery.shown[i].is_null()) continue;
    shown.push_back(&gallery.portraits[i]);
    sequences.push_back(std::move(gallery.shown[i]));
  }
  Json card = Json::object();
  for (const auto& [key, text] : card_of(set, gallery.portraits)) card[key] = text;
  Json data = json_of(gallery.totals);
  data["title"] = title_of(card, set);
  data["missing"] = labelled.missing();
  data["card"] = card;
  data["count"] = gallery.portraits.size();
  data["sequences"] = sequences;
  write_file(out,
             html::page_of("airtruth data set",
                           html::page_body(),
                           data.dump(-1, ' ', false, Json::error_handler_t::replace),
                           pictures_of(shown),
                           std::string(html::encounters_js()) + std::string(html::page_js())));
}

}  // namespace airtruth::set_report
