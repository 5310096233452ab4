// SPDX-License-Identifier: Apache-2.0
// Replaces every number of the user's files by extreme values. The list of numbers comes from the
// readers themselves (scene/scene/table_reader.h), so that the test covers a new key automatically.
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <variant>
#include <vector>

#include <gtest/gtest.h>
#include <toml++/toml.h>

#include "camera/lens/calibration_file.h"
#include "dataset/catalogue/catalogue.h"
#include "dataset/catalogue/expand.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "labels/annotation/truth.h"
#include "scene/scene/table_reader.h"
#include "scene/trajectory/path.h"
#include "sequence/demo/demo.h"
#include "sequence/pipeline/render.h"
#include "support/temporary_folder.h"

namespace airtruth::catalogue {
namespace {

using Number = std::variant<double, std::int64_t>;

constexpr double kHuge = 1e308;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();

std::vector<Number> hostile_numbers(bool few) {
  if (few) return {kNone, kMost};
  return {kHuge,
          -kHuge,
          1e39,
          -1e39,
          5e-324,
          -5e-324,
          1e-310,
          -0.0,
          0.0,
          -1.0,
          kInfinity,
          -kInfinity,
          kNone,
          kMost,
          kLeast};
}

// The bounds themselves, and the first numbers beyond them.
void add_bounds(std::vector<Number>& numbers, const scene::Limits& limits) {
  for (const double bound : {limits.low, limits.high})
    for (const double number :
         {bound, std::nextafter(bound, -kInfinity), std::nextafter(bound, kInfinity)})
      numbers.emplace_back(number);
}

double as_double(const Number& number) {
  return std::visit([](auto value) { return static_cast<double>(value); }, number);
}

// A TOML file, a reader for it, and an action on the result.
struct Base {
  std::string text;
  // Reads the text and, where `renders` is true, also renders the result.
  std::function<void(const std::string& text, bool renders)> use;
  // Every reading lists the aircraft, which takes a tenth of a second: fewer numbers are tried.
  bool is_slow = false;
};

// "background[0].lens.focal_px": its table in the file, made where it is absent; and the last key.
std::pair<toml::table*, std::string> table_at(toml::table& root, const std::string& path) {
  toml::table* table = &root;
  std::string rest = path;
  for (std::size_t dot = rest.find('.'); dot != std::string::npos; dot = rest.find('.')) {
    std::string key = rest.substr(0, dot);
    rest = rest.substr(dot + 1);
    if (const std::size_t bracket = key.find('['); bracket != std::string::npos) {
      const std::size_t index = std::stoul(key.substr(bracket + 1));
      table = table->get_as<toml::array>(key.substr(0, bracket))->get_as<toml::table>(index);
    } else {
      if (!table->contains(key)) table->insert(key, toml::table{});
      table = table->get_as<toml::table>(key);
    }
  }
  return {table, rest};
}

void put(toml::array& array, std::size_t i, const Number& number) {
  std::visit(
      [&](auto value) { array.replace(array.cbegin() + static_cast<std::ptrdiff_t>(i), value); },
      number);
}

toml::array array_in(const toml::table& table,
                     const std::string& key,
                     const std::vector<scene::Limits>& limits) {
  if (const auto* there = table.get_as<toml::array>(key)) return *there;
  toml::array made;
  for (const scene::Limits& each : limits) made.push_back(std::clamp(1.0, each.low, each.high));
  return made;
}

std::string with_number(const toml::table& base,
                        const std::string& path,
                        const scene::NumberKey& key,
                        std::size_t place,
                        const Number& number) {
  toml::table root = base;
  const auto [table, name] = table_at(root, path);
  toml::array values = array_in(*table, name, key.limits);
  switch (key.shape) {
    case scene::NumberShape::kOne:
      std::visit([&, t = table, n = name](auto value) { t->insert_or_assign(n, value); }, number);
      break;
    case scene::NumberShape::kPoints:
      if (values.empty() || !values[0].is_array())
        values = toml::array{toml::array{60.0, 0.0, -150.0}, toml::array{60.0, 5.0, -150.0}};
      put(*values[0].as_array(), place, number);
      table->insert_or_assign(name, values);
      break;
    default:
      put(values, place, number);
      table->insert_or_assign(name, values);
  }
  std::ostringstream text;
  text << root;
  return text.str();
}

struct Keys {
  std::map<std::string, scene::NumberKey> numbers;
  std::map<std::string, scene::WholeKey> wholes;
};

const std::string kProfile =
    "{\"calib_dimension\": {\"w\": 64, \"h\": 64},\n\"fisheye_params\": {\"camera_matrix\": "
    "[[60,0,31.5],[0,60,31.5],[0,0,1]],\n\"radial_distortion_limit\": 2.5,\n"
    "\"distortion_coeffs\": [0.06, 0.01, -0.01, 0.004]}}";

class NumberRanges : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = temporary_.emplace().path();
    synthetic::FlightOptions options;
    options.width = 64;
    options.height = 64;
    options.frame_count = 2;
    demo::VirtualFlightOptions how;
    how.format = video::Format::kMkv;
    demo::write_flight(synthetic::Flight(options), root_ / "sky.mkv", how);
    write_file(root_ / "box.obj",
               "v 0 0 0\nv 4 0 0\nv 4 3 0\nv 0 3 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n");
    write_file(root_ / "path.csv",
               "time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg\n"
               "0,60,-3,-150,90,1,2\n1,61,4,-151,91,2,3\n");
  }
  static void TearDownTestSuite() { temporary_.reset(); }

  // Renders two frames: they are whole, or an Error says what is wrong.
  static void render(const scene::Scene& scene) {
    pipeline::Options options;
    options.use_cache = false;
    options.overwrite = true;
    options.threads = 1;
    const pipeline::Summary summary = pipeline::render(scene, root_ / "out", options);
    for (const auto& frame : annotation::read_truth(summary.folder / "truth.jsonl").frames)
      EXPECT_TRUE(std::isfinite(frame.time_s));
  }

  // Returns one line that describes the error, or an empty one. Any exception but Error fails the
  // test.
  static std::string error_of(const std::function<void()>& body) {
    try {
      body();
    } catch (const Error& error) {
      const std::string words = error.what();
      EXPECT_FALSE(words.empty());
      EXPECT_EQ(words.find('\n'), std::string::npos) << words;
      return words;
    }
    return "";
  }

  static void try_number(const Base& base, const std::string& text, bool holds, bool renders) {
    SCOPED_TRACE(text);
    const std::string words = error_of([&] { base.use(text, renders); });
    EXPECT_TRUE(holds || words.starts_with((root_ / "in.toml:").string())) << words;
  }

  static void walk_numbers(const Base& base, const toml::table& table, const Keys& keys) {
    for (const auto& [path, key] : keys.numbers) {
      for (std::size_t place = 0; place < key.limits.size(); ++place) {
        const scene::Limits& limits = key.limits[place];
        EXPECT_TRUE(limits.low >= -1e12 && limits.high <= 1e12 && limits.low < limits.high) << path;
        EXPECT_FALSE(limits.without_low) << path << ": a number as small as can be is let in";
        std::vector<Number> numbers = hostile_numbers(base.is_slow);
        add_bounds(numbers, limits);
        for (const Number& number : numbers) {
          const double value = as_double(number);
          const bool renders = value == limits.low || value == limits.high;
          try_number(base,
                     with_number(table, path, key, place, number),
                     limits.holds(value),
                     limits.holds(value) && renders);
        }
      }
    }
  }

  static void walk_wholes(const Base& base, const toml::table& table, const Keys& keys) {
    for (const auto& [path, key] : keys.wholes) {
      EXPECT_TRUE(key.high <= 1'000'000'000 || path.ends_with("seed")) << path;
      std::vector<Number> numbers = hostile_numbers(base.is_slow);
      for (const std::int64_t bound : {key.low, key.high, key.low - 1}) numbers.emplace_back(bound);
      if (key.high < kMost) numbers.emplace_back(key.high + 1);
      for (const Number& number : numbers) {
        const auto* whole = std::get_if<std::int64_t>(&number);
        const bool holds = whole != nullptr && *whole >= key.low && *whole <= key.high;
        try_number(base, with_number(table, path, {}, 0, number), holds, holds);
      }
    }
  }

  // Walks every number of the files, and sees that every key that their readers know is read with
  // one of them.
  static void walk(const std::vector<Base>& bases, const std::set<std::string>& never_read) {
    std::set<std::string> known;
    std::set<std::string> read;
    std::set<std::string> walked;
    for (const Base& base : bases) {
      SCOPED_TRACE(base.text);
      Keys keys;
      scene::call_on_key_use([&](const std::string& path, const scene::KeyUse& use) {
        if (std::holds_alternative<scene::KnownKey>(use)) known.insert(path);
        if (std::holds_alternative<scene::ReadKey>(use)) read.insert(path);
        if (const auto* number = std::get_if<scene::NumberKey>(&use)) keys.numbers[path] = *number;
        if (const auto* whole = std::get_if<scene::WholeKey>(&use)) keys.wholes[path] = *whole;
      });
      const std::string error = error_of([&] { base.use(base.text, false); });
      scene::call_on_key_use({});
      ASSERT_EQ(error, "");
      ASSERT_EQ(error_of([&] { base.use(base.text, true); }), "");
      std::erase_if(keys.numbers,
                    [&](const auto& key) { return !walked.insert(key.first).second; });
      std::erase_if(keys.wholes, [&](const auto& key) { return !walked.insert(key.first).second; });
      const toml::table table = toml::parse(base.text);
      walk_numbers(base, table, keys);
      walk_wholes(base, table, keys);
    }
    for (const std::string& key : known)
      EXPECT_TRUE(read.contains(key) || never_read.contains(key))
          << key << " is read with none of this test's files: add it to one";
  }

  // A file of another format, each of its numbers replaced in turn.
  static void walk_text(const std::string& text,
                        const std::function<void(const std::string&)>& use) {
    ASSERT_EQ(error_of([&] { use(text); }), "");
    const std::regex number("-?[0-9]+(\\.[0-9]+)?");
    const std::vector<std::string> hostile = {"1e308",
                                              "-1e308",
                                              "1e999",
                                              "1e39",
                                              "5e-324",
                                              "-0.0",
                                              "0",
                                              "nan",
                                              "inf",
                                              "-inf",
                                              "9223372036854775807",
                                              "-9223372036854775808",
                                              "1e9",
                                              ""};
    for (auto at = std::sregex_iterator(text.begin(), text.end(), number);
         at != std::sregex_iterator();
         ++at)
      for (const std::string& one : hostile) {
        const std::string whole =
            text.substr(0, static_cast<std::size_t>(at->position())) + one +
            text.substr(static_cast<std::size_t>(at->position() + at->length()));
        SCOPED_TRACE(whole);
        error_of([&] { use(whole); });
      }
  }

  static inline std::optional<test_support::TemporaryFolder> temporary_;
  static inline fs::path root_;
};

const std::string kIntruder =
    "[[intruder]]\naircraft = 'box.obj'\nmodel_scale = 1.5\nspin_time_s = 0.2\nstart_s = 0\n"
    "yaw_deg = 80\npitch_deg = 1\nroll_deg = 2\n";

// Every key of a scene, the keys that exclude each other in one or the other.
std::vector<std::string> scenes() {
  const std::string head =
      "seed = 1\n[background]\nvideo = 'sky.mkv'\nfirst_frame = 0\nframe_count = 2\n";
  const std::string light =
      "[motion]\nmodel = 'none'\nsmoothing_s = 1\n[light]\nsun_azimuth_deg = 10\n"
      "sun_elevation_deg = 20\nexposure = 1\nsky_colour = [0.5, 0.5, 0.5]\n"
      "ground_colour = [0.2, 0.2, 0.2]\n[render]\nquality = 1\n[output]\nvideo = 'avi'\nquality = "
      "18\n";
  return {
      head + "[lens]\nvertical_fov_deg = 60\n" + light + kIntruder +
          "waypoints_ned_m = [[60, -3, -150], [60, 20, -150]]\nspeed_mps = 20\n",
      head +
          "[lens]\nmodel = 'fisheye'\nvertical_fov_deg = 60\n"
          "[camera]\npath_file = 'path.csv'\n" +
          light + kIntruder + "path_file = 'path.csv'\n",
      head +
          "[lens]\nmodel = 'brown_conrady'\nfocal_px = [60, 60]\nprincipal_point_px = [32, 32]\n"
          "distortion = [0.1, 0.01, 0, 0]\n[camera]\nposition_ned_m = [0, 0, -150]\n"
          "velocity_ned_mps = [1, 0, 0]\nattitude_yaw_pitch_roll_deg = [0, 0, 0]\n" +
          light +
          "[shutter]\nexposure_s = 0.004\nreadout_s = 0.01\n[air]\nextinction_per_km = [1, 1, 1]\n"
          "airlight = [0.5, 0.5, 0.5]\n[optics]\npoint_spread_px = 0.7\nsharpening = 0.4\n"
          "sharpening_px = 1\n[sensor]\nnoise_gain = 1e-4\nnoise_floor = 1e-5\n"
          "noise_correlation_px = 0.5\nchroma_spread_px = 2\ncodec_step = 4\ngamma = 2.2\n"
          "[weather]\nexposure = 1.2\nwhite_balance = 1.1\nblur = 1.3\nnoise = 2\nsun_share = "
          "0.5\n" +
          kIntruder + "waypoints_ned_m = [[60, -3, -150], [60, 20, -150]]\ntimes_s = [0, 1]\n",
      head + "[lens]\nfile = 'lens.json'\n[shutter]\nangle_deg = 180\n" + light + kIntruder +
          "waypoints_ned_m = [[60, -3, -150], [60, 20, -150]]\nspeed_mps = 20\n",
      head + "[lens]\nvertical_fov_deg = 60\n[camera]\nvelocity_ned_mps = [30, 0, 0]\n" + light +
          "[[intruder]]\naircraft = 'box.obj'\n[intruder.encounter]\ncpa_time_s = 1\n"
          "cpa_right_m = 5\ncpa_above_m = 2\ncourse_deg = 180\nspeed_mps = 40\nclimb_mps = 1\n"
          "turn_rate_dps = 0\n[[intruder]]\naircraft = 'box.obj'\n[intruder.encounter]\n"
          "cpa_time_s = 1\ncpa_ahead_m = 50\ncourse_deg = 90\nspeed_mps = 40\n",
      head +
          "[truth]\nvolumes = ['nmac']\nlookahead_s = 60\n[[truth.volume]]\nname = 'own'\n"
          "horizontal_m = 300\nvertical_m = 50\ntau_s = 10\ncoaltitude_s = 5\n"
          "[lens]\nvertical_fov_deg = 60\n" +
          light +
          "[[intruder]]\naircraft = 'box.obj'\n[[intruder.seen]]\ntime_s = 0\npixel = [30, 30]\n"
          "range_m = 60\n[[intruder.seen]]\ntime_s = 0.0333\npixel = [32, 30]\nwidth_px = 4\n"};
}

TEST_F(NumberRanges, OfAScene) {
  write_file(root_ / "lens.json", kProfile);
  std::vector<Base> bases;
  for (const std::string& text : scenes())
    bases.push_back({text, [](const std::string& one, bool renders) {
                       const scene::Scene scene = scene::parse_scene(one, root_ / "in.toml");
                       if (renders) render(scene);
                     }});
  walk(bases, {});
}

TEST_F(NumberRanges, OfACameraFile) {
  const auto use = [](const std::string& text, bool) {
    scene::parse_camera_file(text, root_ / "in.toml");
  };
  walk({{"[clip]\nvideo = 'a'\nwidth = 64\nheight = 64\nframes = 2\nlens = 'pinhole'\ngamma = 2.2\n"
         "[light]\nsun_azimuth_deg = 1\nsun_elevation_deg = 2\n",
         use}},
       {"clip.video", "clip.frames", "uncertainty"});
}

const std::string kTables =
    "seed = 1\n[truth]\nvolumes = ['nmac']\nlookahead_s = 60\n[[truth.volume]]\nname = 'own'\n"
    "horizontal_m = 300\nvertical_m = 50\ntau_s = 10\ncoaltitude_s = 5\n"
    "[[background]]\nname = 'sky'\nlens = { vertical_fov_deg = 60 }\n"
    "flight = { seed = 1, frame_count = 2, width = 64, height = 64, cloud_cover = 0.3, speed_mps = "
    "30, "
    "altitude_m = 200 }\ncamera = { position_ned_m = [0, 0, -150] }\n"
    "[[aircraft]]\nname = 'box'\naircraft = 'box.obj'\n"
    "[[trajectory]]\nname = 'a'\nwaypoints_ned_m = [[60, -3, -150], [60, 20, -150]]\nspeed_mps = "
    "20\n"
    "frame_count = 2\n[[trajectory]]\nname = 'b'\n"
    "waypoints_ned_m = [[60, -3, -150], [60, 20, -150]]\ntimes_s = [0, 1]\n"
    "[[trajectory]]\nname = 'c'\nencounter = { cpa_time_s = 1, cpa_right_m = 9, cpa_above_m = 1, "
    "course_deg = 180, speed_mps = 20, climb_mps = 1, turn_rate_dps = 1 }\n"
    "[[trajectory]]\nname = 'd'\nencounter = { cpa_time_s = 1, cpa_ahead_m = 9, "
    "course_deg = 180, speed_mps = 20 }\n"
    "[[trajectory]]\nname = 'e'\n[[trajectory.seen]]\ntime_s = 0\npixel = [30, 30]\nrange_m = 60\n"
    "[[trajectory.seen]]\ntime_s = 0.03\npixel = [32, 30]\nwidth_px = 4\n"
    "[[sequence]]\nname = 'x'\nbackground = 'sky'\ntrajectory = 'a'\naircraft = 'box'\nframe_count "
    "= 2\n"
    "[[product]]\nname = '{trajectory}'\nbackgrounds = ['sky']\nframe_count = 2\n";

TEST_F(NumberRanges, OfACatalogue) {
  const auto use = [](const std::string& text, bool expands) {
    const Catalogue catalogue = parse_catalogue(text, root_ / "in.toml");
    if (!expands) return;
    const Expansion expansion(catalogue);
    for (const std::int64_t i : {std::int64_t{0}, expansion.size() / 2, expansion.size() - 1}) {
      Item item = expansion.at(i);
      place(item, catalogue, {root_ / "sky.mkv", {}});
      scene::parse_scene(scene::toml_from_scene(item.scene), root_ / "in.toml");
    }
  };
  const auto read = [](const std::string& text, bool) { parse_catalogue(text, root_ / "in.toml"); };
  const std::string video =
      "[[background]]\nname = 'sky'\nvideo = 'sky.mkv'\nmask = 'm.png'\nfirst_frame = "
      "0\nframe_count = 60\n"
      "lens = { vertical_fov_deg = 60 }\n[[random]]\nname = 'r{index}'\ncount = 2\n"
      "frame_count = 2\naircraft = ['738/738-Ryanair']\n";
  const std::string by_range =
      "range_m = [100, 200]\nazimuth_deg = [-5, 5]\nelevation_deg = [-5, 5]\n"
      "speed_mps = [40, 50]\nheading_deg = [0, 10]\nclimb_deg = [-1, 1]\n"
      "sun_azimuth_deg = [1, 2]\nsun_elevation_deg = [1, 2]\n";
  const std::string by_weather =
      "optics = { point_spread_px = 0.8 }\nsensor = { noise_floor = 1e-5 }\n";
  const std::string weather =
      "[random.weather]\nvisibility_m = [4000, 40000]\nexposure = [0.7, 1.4]\n"
      "white_balance = [0.8, 1.2]\nblur = [0.8, 1.5]\nnoise = 1.5\nsun_share = [0, 1]\n";
  const std::string of_camera = std::string(video).insert(video.find("[[random]]"), by_weather);
  const std::string by_approach =
      "[random.encounter]\ncpa_time_s = 1\ncpa_right_m = [-60, 60]\ncpa_above_m = [-20, 20]\n"
      "course_deg = 180\nspeed_mps = [40, 50]\nclimb_mps = 1\nturn_rate_dps = 0\n";
  const std::string by_approach_ahead =
      "[random.encounter]\ncpa_ahead_m = { any_of = [100, 200] }\ncourse_deg = 90\n";
  const std::string by_seen =
      "[[random.seen]]\ntime_s = 0\nx_px = [10, 20]\ny_px = 20\nrange_m = 100\n"
      "[[random.seen]]\ntime_s = 0.0333\npixel = [30, 30]\nwidth_px = 4\n";
  const std::string by_size =
      "size_px = [8, 30]\nbank_deg = [-20, 20]\ntime_of_day_h = [10, 12]\nlatitude_deg = 40\n"
      "day_of_year = 100\nintruders = [1, 2]\nnegatives = 0.1\nstart = 'first'\n"
      "[slurm]\ncpus = 2\n";
  walk({{kTables, use},
        {video + by_range, use, true},
        {video + by_size, read, true},
        {video + by_approach, use, true},
        {video + by_approach_ahead, use, true},
        {video + by_seen, use, true},
        {of_camera + weather, use, true}},
       {});
}

TEST_F(NumberRanges, OfLensFiles) {
  const lens::ImageSize size{64, 64};
  const auto use = [&](const char* name) {
    return [size, name](const std::string& text) {
      const lens::Lens lens = lens::parse_calibration(text, name, size);
      EXPECT_TRUE(std::isfinite(lens.focal_px()) && std::isfinite(lens.vertical_fov_deg()));
      for (const Pixel& pixel : {Pixel(0, 0), Pixel(32.5, 31.5), Pixel(64, 64)}) {
        const auto ray = lens.ray_from_pixel(pixel);
        EXPECT_TRUE(!ray || ray->allFinite());
      }
      for (const Vector3& point : {Vector3(0, 0, 1), Vector3(1, 2, -3), Vector3(1e9, 0, 1e-9)}) {
        const auto pixel = lens.pixel_from_cam(point);
        EXPECT_TRUE(!pixel || pixel->allFinite());
      }
    };
  };
  walk_text(kProfile, use("a.json"));
  walk_text(
      "%YAML:1.0\n---\nimage_width: 64\nimage_height: 64\ncamera_matrix: !!opencv-matrix\n"
      "   rows: 3\n   cols: 3\n   dt: d\n   data: [ 60.5, 0., 31.5, 0., 60.5, 31.5, 0., 0., 1. ]\n"
      "distortion_coefficients: !!opencv-matrix\n   rows: 1\n   cols: 5\n   dt: d\n"
      "   data: [ -0.1, 0.01, 0.001, 0.001, 0.001 ]\n",
      use("a.yml"));
}

TEST_F(NumberRanges, OfAPathFile) {
  walk_text(
      "time_s,north_m,east_m,down_m,yaw_deg,pitch_deg,roll_deg\n0,60,-3,-150,90,1,2\n"
      "1,61,4,-151,91,2,3\n3,62,9,-150,92,1,2\n",
      [](const std::string& text) {
        const trajectory::Path path = trajectory::parse_path_csv(text, "p.csv");
        for (const double share : {0.0, 0.3, 1.0}) {
          const auto state = path.at(path.start_s() + share * (path.end_s() - path.start_s()));
          ASSERT_TRUE(state);
          EXPECT_TRUE(state->position_in_world.allFinite() &&
                      state->velocity_in_world_mps.allFinite() &&
                      state->world_from_body.coeffs().allFinite());
        }
      });
}

}  // namespace
}  // namespace airtruth::catalogue
