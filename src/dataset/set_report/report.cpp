// SPDX-License-Identifier: Apache-2.0
#include "dataset/set_report/report.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "dataset/set_report/card.h"
#include "dataset/set_report/portrait.h"
#include "dataset/set_report/totals.h"
#include "foundation/base/error.h"
#include "foundation/base/file_state.h"
#include "foundation/base/files.h"
#include "foundation/base/in_parallel.h"
#include "foundation/base/text.h"
#include "show/html/page.h"
#include "show/html/page_assets.h"
#include "show/plot/plot_json.h"

namespace airtruth::set_report {
namespace {

using Json = nlohmann::ordered_json;

// Upper bound for the stills of all sequences together; a still takes some 30 kB of the page.
constexpr std::size_t kMaxStills = 1000;
constexpr std::size_t kMaxStillsOfOne = 60;
constexpr std::size_t kMinStillsOfOne = 4;

template <typename T>
Json json_of(const std::optional<T>& value) {
  return value ? Json(*value) : Json();
}

double rounded(double value, double unit) { return std::round(value / unit) * unit; }
Json rounded(const std::optional<double>& value, double unit) {
  return value ? Json(rounded(*value, unit)) : Json();
}

// The data is stored in columns because a page of a thousand sequences holds a hundred thousand
// points.
template <typename Row, typename Value>
Json column(const std::vector<Row>& rows, const Value& value) {
  Json values = Json::array();
  for (const Row& row : rows) values.push_back(value(row));
  return values;
}

Json series_of(const Portrait::Intruder& intruder) {
  using Point = Portrait::Point;
  const auto along = [&](std::size_t axis) {
    return column(intruder.points, [axis](const Point& p) {
      return p.position_ned_m ? Json(rounded((*p.position_ned_m)[axis], 0.1)) : Json();
    });
  };
  const auto of = [&](const auto& value) { return column(intruder.points, value); };
  return {{"id", intruder.id},
          {"aircraft", intruder.aircraft},
          {"frame", of([](const Point& p) { return p.frame; })},
          {"range_m", of([](const Point& p) { return rounded(p.range_m, 0.1); })},
          {"width_px", of([](const Point& p) { return json_of(p.width_px); })},
          {"height_px", of([](const Point& p) { return json_of(p.height_px); })},
          {"north_m", along(0)},
          {"east_m", along(1)},
          {"down_m", along(2)},
          {"state", of([](const Point& p) { return p.state; })},
          {"to_closest_s", of([](const Point& p) { return rounded(p.to_closest_s, 0.001); })}};
}

// The records as sequence.json has them, with the places of the closest approach.
Json encounters_json(const Portrait& portrait) {
  std::vector<pipeline::EncounterRecord> records;
  for (const Encountered& one : portrait.encounters) records.push_back(one.record);
  Json list = pipeline::json_of(records);
  for (std::size_t i = 0; i < list.size(); ++i) {
    const auto& closest = portrait.encounters[i].closest;
    if (!closest) continue;
    list[i]["own_ned_m"] = closest->own_ned_m;
    list[i]["intruder_ned_m"] = closest->intruder_ned_m;
  }
  return list;
}

Json camera_of(const Portrait& portrait) {
  using Camera = Portrait::Camera;
  const auto of = [&](const auto& value) { return column(portrait.camera, value); };
  return {{"frame", of([](const Camera& c) { return c.frame; })},
          {"north_m", of([](const Camera& c) { return rounded(c.position_ned_m[0], 0.1); })},
          {"east_m", of([](const Camera& c) { return rounded(c.position_ned_m[1], 0.1); })},
          {"down_m", of([](const Camera& c) { return rounded(c.position_ned_m[2], 0.1); })},
          {"yaw_deg", of([](const Camera& c) { return rounded(c.yaw_deg, 0.01); })},
          {"shift_px", of([](const Camera& c) { return rounded(c.shift_px, 0.01); })},
          {"roll_deg", of([](const Camera& c) { return rounded(c.roll_deg, 0.001); })}};
}

// Of the containers that airtruth writes and imports, browsers play these.
bool plays_in_browsers(const fs::path& video) {
  return video.extension() == ".mp4" || video.extension() == ".webm";
}

Json film_json(const Film& film) {
  return column(film.stills, [](const Film::Still& still) {
    const auto box_of = [](const Film::Marked& one) {
      return Json{one.intruder, one.box.x, one.box.y, one.box.width, one.box.height};
    };
    Json json{{"frame", still.frame}, {"boxes", column(still.boxes, box_of)}};
    if (!still.zoom_jpeg.empty()) json["zoom"] = {still.zoom_x, still.zoom_y, still.zoom_px};
    return json;
  });
}

// The mean contrast over the frames of the film; null without any.
Json mean_contrast(const Film& film) {
  if (film.contrasts.empty()) return {};
  double sum = 0;
  for (const double value : film.contrasts) sum += value;
  return rounded(sum / static_cast<double>(film.contrasts.size()), 0.1);
}

// A path as the page links to it.
fs::path beside(const fs::path& page, const fs::path& path) {
  return fs::absolute(path).lexically_relative(fs::absolute(page).parent_path());
}

Json json_of(const Portrait& portrait, const fs::path& page) {
  const auto link = [folder = beside(page, portrait.folder)](const std::string& file) {
    return (folder / file).generic_string();
  };
  const auto& scene = portrait.scene;
  return {
      {"name", portrait.facts.name},
      {"background", portrait.facts.background_name},
      {"aircraft", portrait.facts.categories},
      {"frames", portrait.facts.frames},
      {"seconds", rounded(portrait.duration_s, 0.01)},
      {"width", portrait.width},
      {"height", portrait.height},
      {"fov_deg", rounded(portrait.horizontal_fov_deg, 0.1)},
      {"sun_azimuth_deg", scene ? Json(rounded(scene->light.sun_azimuth_deg, 0.1)) : Json()},
      {"sun_elevation_deg", scene ? Json(rounded(scene->light.sun_elevation_deg, 0.1)) : Json()},
      {"weather", portrait.facts.weather},
      {"motion_model", scene ? enum_name(scene->motion.model) : ""},
      {"visible", portrait.frames_by_state[0]},
      {"hidden", portrait.frames_by_state[1]},
      {"contrast", mean_contrast(portrait.film)},
      {"loop_frames", portrait.film.loop_frames},
      {"loop_side", portrait.film.loop_side},
      {"stills", film_json(portrait.film)},
      {"poster", portrait.film.poster},
      {"ids", portrait.ids},
      {"video",
       plays_in_browsers(portrait.video) ? Json(beside(page, portrait.video).generic_string())
                                         : Json()},
      {"intruders", column(portrait.intruders, series_of)},
      {"camera", camera_of(portrait)},
      {"encounters", encounters_json(portrait)},
      {"files", column(portrait.files, link)}};
}

// The sequences of a set, and the counts over them.
struct Gallery {
  std::vector<Portrait> portraits;
  std::vector<bool> is_shown;
  Totals totals;
};

// Of a sequence that is not shown, no frame is decoded and no series is kept.
Gallery gallery_of(const labelled::LabelledSet& labelled, const ReportOptions& options) {
  const std::size_t count = labelled.names().size();
  Gallery gallery{std::vector<Portrait>(count), std::vector<bool>(count, false), {}};
  for (const std::size_t i : thinned(count, options.max_shown)) gallery.is_shown[i] = true;
  const std::size_t stills =
      std::clamp(kMaxStills / std::max<std::size_t>(1, count), kMinStillsOfOne, kMaxStillsOfOne);
  std::mutex mutex;
  in_parallel(
      count,
      options.jobs,
      [&](std::size_t i) {
        const bool is_shown = gallery.is_shown[i];
        Portrait portrait =
            portrait_of(labelled, labelled.names()[i], is_shown ? stills : 0, options.stop);
        const std::lock_guard lock(mutex);
        gallery.totals.add(portrait);  // sums of whole numbers, the same in any order
        if (!is_shown) {
          portrait.intruders = {};
          portrait.camera = {};
          portrait.centres = {};
        }
        gallery.portraits[i] = std::move(portrait);
      },
      options.progress,
      options.stop);
  return gallery;
}

// The name on the card, or the name of the folder.
std::string title_of(const Json& card, const fs::path& set) {
  if (card.contains("name")) return card.at("name").get<std::string>();
  const fs::path named = fs::absolute(set).lexically_normal();
  return named.has_filename() ? named.filename().string() : named.parent_path().filename().string();
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
           {{"columns", Portrait::kCellColumns},
            {"rows", Portrait::kCellRows},
            {"counts", totals.centres}}},
          {"plots", plots},
          // Of intruders, in their order.
          {"colours", colours()}};
}

// The pictures of all films, under the names by which the page finds them.
std::vector<html::PageBlob> pictures_of(const std::vector<const Portrait*>& portraits) {
  std::vector<html::PageBlob> pictures;
  for (std::size_t i = 0; i < portraits.size(); ++i) {
    const Film& film = portraits[i]->film;
    for (std::size_t k = 0; k < film.stills.size(); ++k) {
      const Film::Still& still = film.stills[k];
      pictures.push_back({fmt::format("still-{}-{}", i, k), base64_of(still.jpeg)});
      if (!still.zoom_jpeg.empty())
        pictures.push_back({fmt::format("zoom-{}-{}", i, k), base64_of(still.zoom_jpeg)});
    }
    if (!film.loop_jpeg.empty())
      pictures.push_back({fmt::format("loop-{}", i), base64_of(film.loop_jpeg)});
  }
  return pictures;
}

}  // namespace

void write_report(const fs::path& set, const fs::path& out, const ReportOptions& options) {
  check_output_file(out, options.overwrite);
  const labelled::LabelledSet labelled(set);
  const Gallery gallery = gallery_of(labelled, options);
  std::vector<const Portrait*> shown;
  Json sequences = Json::array();
  for (std::size_t i = 0; i < gallery.portraits.size(); ++i) {
    if (!gallery.is_shown[i]) continue;
    shown.push_back(&gallery.portraits[i]);
    sequences.push_back(json_of(gallery.portraits[i], out));
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
