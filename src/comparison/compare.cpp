// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "aircraft/catalogue.h"
#include "annotation/truth.h"
#include "base/error.h"
#include "base/files.h"
#include "base/median.h"
#include "comparison/comparison.h"
#include "comparison/looks.h"
#include "comparison/place.h"
#include "geometry/whole_pixels.h"
#include "image/colour.h"
#include "report/draw.h"
#include "sequence/sequence.h"
#include "sequence/staging.h"
#include "sequence/world.h"
#include "video/reader.h"
#include "video/still.h"

namespace airtruth::comparison {
namespace {

constexpr int kZoom = 8;
constexpr int kCropPx = 44;
constexpr const char* kName = "sequence";

// The scene with its first intruder beside the real aircraft, everything else standing still.
scene::Scene scene_beside(const scene::Scene& given,
                          const fs::path& real,
                          const RealBoxes& boxes,
                          const Beside& path,
                          const YawPitchRoll& attitude) {
  scene::Scene scene = given;
  scene.name = kName;
  scene.background.video = real;
  scene.background.first_frame = boxes.begin()->first;
  scene.background.frame_count = boxes.rbegin()->first - boxes.begin()->first + 1;
  scene.camera = {};
  scene.camera.position_ned_m = Vector3::Zero();
  scene.motion.model = "none";
  scene.intruders.resize(1);
  scene::Intruder& intruder = scene.intruders[0];
  intruder.path_file.reset();
  intruder.waypoints_ned_m = path.waypoints_ned_m;
  intruder.times_s = path.times_s;
  intruder.speed_mps.reset();
  intruder.start_s = 0;
  intruder.yaw_deg = attitude.yaw_deg;
  intruder.pitch_deg = attitude.pitch_deg;
  intruder.roll_deg = attitude.roll_deg;
  scene.output.video = "mkv";  // what is compared is not encoded once more
  return scene;
}

struct Compared {
  std::int64_t frame = 0;
  Looks real, made;
  std::vector<float> real_features, made_features;
};

struct FigureRow {
  std::int64_t frame = 0;
  image::Rgb8 real, made;  // crops at 1x
};

double spread(std::vector<double> values) {
  if (values.size() < 3) return 0;
  std::sort(values.begin(), values.end());
  return (values[values.size() * 84 / 100] - values[values.size() * 16 / 100]) / 2;
}

template <typename Get>
Pair pair_of(const std::string& name, const std::vector<Compared>& all, const Get& get) {
  std::vector<double> real, made;
  for (const Compared& c : all) real.push_back(get(c.real)), made.push_back(get(c.made));
  return {name, median_or_0(real), spread(real), median_or_0(made), spread(made)};
}

// How much the contrast changes from one compared frame to the next.
Pair flicker_of(const std::vector<Compared>& all) {
  std::vector<double> real, made;
  for (std::size_t i = 1; i < all.size(); ++i) {
    if (all[i].frame != all[i - 1].frame + 1) continue;
    real.push_back(std::abs(all[i].real.contrast - all[i - 1].real.contrast));
    made.push_back(std::abs(all[i].made.contrast - all[i - 1].made.contrast));
  }
  return {"flicker of contrast, frame to frame",
          median_or_0(real),
          spread(real),
          median_or_0(made),
          spread(made)};
}

image::Rgb8 crop(const image::Picture& picture, const Box& box) {
  const int x = whole_pixels(box.x + box.width / 2) - kCropPx / 2;
  const int y = whole_pixels(box.y + box.height / 2) - kCropPx / 2;
  return image::rgb8_from_picture(picture, x, y, kCropPx, kCropPx);
}

// Real at 1x and 8x, inserted at 1x and 8x, a row a frame, two columns of rows.
image::Rgb8 figure_of(const std::vector<FigureRow>& rows) {
  constexpr int kGap = 10;
  constexpr int kTop = 34;
  const int large = kCropPx * kZoom;
  const int pair_width = 2 * (kCropPx + kGap + large + kGap);
  const int columns = rows.size() > 1 ? 2 : 1;
  const int lines = (static_cast<int>(rows.size()) + columns - 1) / columns;
  cv::Mat canvas(kTop + lines * (large + kTop),
                 columns * (pair_width + 2 * kGap),
                 CV_8UC3,
                 cv::Scalar(24, 24, 26));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const int x0 = kGap + static_cast<int>(i) % columns * (pair_width + 2 * kGap);
    const int y0 = kTop + static_cast<int>(i) / columns * (large + kTop);
    int x = x0;
    for (const image::Rgb8* one : {&rows[i].real, &rows[i].made}) {
      report::text(canvas,
                   one == &rows[i].real ? fmt::format("real, frame {}", rows[i].frame) : "inserted",
                   x,
                   y0 - 8,
                   14,
                   report::kWhite);
      image::Rgb8 copy = report::resized(*one, kCropPx, kCropPx, cv::INTER_NEAREST);
      report::view(copy).copyTo(canvas(cv::Rect(x, y0, kCropPx, kCropPx)));
      x += kCropPx + kGap;
      image::Rgb8 big = report::resized(*one, large, large, cv::INTER_NEAREST);
      report::view(big).copyTo(canvas(cv::Rect(x, y0, large, large)));
      x += large + kGap;
    }
  }
  return report::from_mat(canvas);
}

std::string table_of(const Comparison& c) {
  std::string text =
      fmt::format("{} frames compared; median, +- half the middle 68 %\n\n", c.frames);
  text += "| | real | inserted |\n|---|---:|---:|\n";
  for (const Pair& p : c.pairs)
    text += fmt::format("| {} | {:.3g} +- {:.2g} | {:.3g} +- {:.2g} |\n",
                        p.name,
                        p.real,
                        p.real_spread,
                        p.made,
                        p.made_spread);
  text +=
      fmt::format("| colour histogram distance | {:.3f} (to itself) | {:.3f} (to the real one) |\n",
                  c.colour_distance_within,
                  c.colour_distance);
  return text;
}

nlohmann::ordered_json json_of(const Comparison& c, const fs::path& real) {
  nlohmann::ordered_json json;
  json["video"] = real.string();
  json["frames"] = c.frames;
  for (const Pair& p : c.pairs)
    json["measures"].push_back({{"name", p.name},
                                {"real", p.real},
                                {"real_spread", p.real_spread},
                                {"inserted", p.made},
                                {"inserted_spread", p.made_spread}});
  json["colour_distance"] = c.colour_distance;
  json["colour_distance_within_real"] = c.colour_distance_within;
  return json;
}

std::string patches_csv(const std::vector<Compared>& all) {
  std::string text = "real,frame,features...\n";
  for (const Compared& c : all)
    for (const auto* features : {&c.real_features, &c.made_features}) {
      text += fmt::format("{},{}", features == &c.real_features ? 1 : 0, c.frame);
      for (const float f : *features) text += fmt::format(",{}", f);
      text += '\n';
    }
  return text;
}

class Comparing {
 public:
  Comparing(const fs::path& real,
            const RealBoxes& boxes,
            const scene::Scene& scene,
            const fs::path& out,
            const Options& options)
      : real_(real), boxes_(boxes), options_(options), staged_(out, options.overwrite) {
    require_utf8(fs::absolute(real));
    if (scene.intruders.empty()) throw Error("has no intruder to compare", {scene.file.string()});
    if (options.most_frames > 0)
      while (boxes_.rbegin()->first - boxes_.begin()->first + 1 > options.most_frames)
        boxes_.erase(std::prev(boxes_.end()));
    render(scene);
    compare();
  }

  Comparison finish(const fs::path& out) {
    if (all_.empty())
      throw Error("no frame shows both aircraft whole with room around them", {real_.string()});
    Comparison result;
    result.folder = out;
    result.frames = static_cast<std::int64_t>(all_.size());
    result.pairs = {
        pair_of("contrast to the surroundings, code values",
                all_,
                [](const Looks& l) { return l.contrast; }),
        pair_of("edge, 10 to 90 %, px", all_, [](const Looks& l) { return l.edge_width_px; }),
        pair_of("noise inside, code values", all_, [](const Looks& l) { return l.noise; }),
        pair_of(
            "noise around, code values", all_, [](const Looks& l) { return l.background_noise; }),
        pair_of("share of fine detail in the spectrum",
                all_,
                [](const Looks& l) { return l.fine_share; }),
        pair_of("saturation", all_, [](const Looks& l) { return l.saturation; }),
        pair_of("steps on the 8 px grid over others",
                all_,
                [](const Looks& l) { return l.blockiness; }),
        flicker_of(all_)};
    std::vector<double> between, within;
    for (std::size_t i = 0; i < all_.size(); ++i) {
      between.push_back(distance(all_[i].real.histogram, all_[i].made.histogram));
      within.push_back(distance(all_[i].real.histogram,
                                all_[(i + all_.size() / 2) % all_.size()].real.histogram));
    }
    result.colour_distance = median_or_0(between);
    result.colour_distance_within = median_or_0(within);
    const fs::path& part = staged_.path();
    video::write_still(part / "figure.png", figure_of(figure_));
    write_file(part / "comparison.md", table_of(result));
    write_file(part / "patches.csv", patches_csv(all_));
    write_file(part / "comparison.json", json_of(result, real_).dump(1) + "\n");
    staged_.commit();
    return result;
  }

 private:
  void render(const scene::Scene& given) {
    const video::StreamInfo info = video::Reader(real_, {.threads = 1}).info();
    const lens::ImageSize size{info.width, info.height};
    const lens::Lens lens = sequence::lens_of(given.lens, size);
    const scene::Intruder& intruder = given.intruders[0];
    aircraft::LoadOptions load;
    load.stop = options_.stop;
    const aircraft::Aircraft aircraft =
        aircraft::load_aircraft(intruder.aircraft, load, options_.warn);
    const YawPitchRoll attitude{intruder.yaw_deg.value_or(90),
                                intruder.pitch_deg.value_or(0),
                                intruder.roll_deg.value_or(0)};
    const Beside path = path_beside(boxes_, aircraft.mesh, attitude, lens, info.frame_rate.value());
    sequence::Options how;
    how.warn = options_.warn;
    how.stop = options_.stop;
    how.progress = [&](const sequence::Progress& p) {
      if (options_.progress) options_.progress(p.frames_done, 2 * p.frames_total);
    };
    sequence::render(scene_beside(given, real_, boxes_, path, attitude), staged_.path(), how);
  }

  void compare() {
    const fs::path folder = staged_.path() / kName;
    const annotation::Truth truth = annotation::read_truth(folder / "truth.jsonl");
    video::Reader reader(folder / (std::string(kName) + ".mkv"));
    const std::int64_t first = boxes_.begin()->first;
    const auto total = static_cast<std::int64_t>(truth.frames.size());
    const std::int64_t every = std::max<std::int64_t>(1, total / std::max(1, options_.pairs));
    while (const auto frame = reader.next()) {
      if (options_.stop.stop_requested()) throw Interrupted();
      if (options_.progress) options_.progress(total + frame->index, 2 * total);
      const auto box = boxes_.find(first + frame->index);
      if (box == boxes_.end() || frame->index >= total) continue;
      const annotation::Intruder& made =
          truth.frames[static_cast<std::size_t>(frame->index)].intruders[0];
      if (!made.visible_box_px || !made.exact_box_px || made.cut_by_frame > 0) continue;
      const auto real_patch = patch_of(frame->picture, box->second);
      const auto made_patch = patch_of(frame->picture, *made.exact_box_px);
      if (!real_patch || !made_patch) continue;
      constexpr int kFewest = 6;
      if (cv::countNonZero(real_patch->silhouette) < kFewest ||
          cv::countNonZero(made_patch->silhouette) < kFewest)
        continue;
      all_.push_back({box->first,
                      looks_of(*real_patch),
                      looks_of(*made_patch),
                      features_of(*real_patch),
                      features_of(*made_patch)});
      if (figure_.size() < static_cast<std::size_t>(options_.pairs) &&
          (figure_.empty() || box->first >= figure_.back().frame + every))
        figure_.push_back({box->first,
                           crop(frame->picture, box->second),
                           crop(frame->picture, *made.exact_box_px)});
    }
  }

  fs::path real_;
  RealBoxes boxes_;
  Options options_;
  sequence::StagedFolder staged_;
  std::vector<Compared> all_;
  std::vector<FigureRow> figure_;
};

}  // namespace

Comparison compare(const fs::path& real,
                   const RealBoxes& boxes,
                   const scene::Scene& scene,
                   const fs::path& out,
                   const Options& options) {
  return Comparing(real, boxes, scene, out, options).finish(out);
}

}  // namespace airtruth::comparison
