// SPDX-License-Identifier: Apache-2.0
#include "sequence/pipeline/outputs.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <set>

#include <airtruth/version.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/or_null.h"
#include "picture/composite/cover.h"
#include "picture/video/still.h"
#include "scene/scene/camera_keys.h"
#include "sequence/setup/from_scene.h"
#include "sequence/setup/motion_source.h"
#include "sequence/setup/shared_inputs.h"

namespace airtruth::pipeline {
namespace {

video::WriterOptions writer_options(const scene::Output& output, int threads) {
  video::WriterOptions options;
  options.format = output.video;
  options.quality = output.quality;
  options.keyframe_s = output.keyframe_s;
  options.threads = threads;
  options.encoder = output.encoder;
  options.encoder_where = output.encoder_where;
  return options;
}

annotation::EvisionFrame evision_frame(const annotation::Frame& truth,
                                       const annotation::Intruder& intruder) {
  annotation::EvisionFrame frame;
  frame.number = static_cast<int>(truth.frame) + 1;
  frame.intruder_ned_m = *intruder.position_ned_m;
  frame.distance_m = *intruder.range_m;
  if (intruder.covered_box_px) frame.rect_px = *intruder.covered_box_px;
  return frame;
}

std::size_t aircraft_of(const scene::Scene& scene) {
  return static_cast<std::size_t>(std::ranges::count_if(scene.intruders, scene::is_aircraft));
}

nlohmann::ordered_json json_of(const std::vector<Checksum>& files) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Checksum& file : files) list.push_back({{"name", file.name}, {"sha256", file.sha256}});
  return list;
}

// Checksums of the files of a folder, and of the images in its sub-folders, by name.
std::vector<Checksum> checksums_below(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file()) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  std::vector<Checksum> result;
  for (const fs::path& file : files)
    result.push_back({fs::relative(file, folder).string(), sha256_of_file(file)});
  return result;
}

}  // namespace

std::vector<fs::path> model_files(const setup::World& world) {
  std::set<fs::path> models;
  for (const setup::Actor& actor : world.actors)
    models.insert(actor.type->aircraft->sources.begin(), actor.type->aircraft->sources.end());
  return {models.begin(), models.end()};
}

Outputs::Outputs(const fs::path& folder,
                 const scene::Scene& scene,
                 const lens::Lens& lens,
                 const video::StreamInfo& info,
                 int threads)
    : folder_(folder),
      lens_(annotation::facts_of(lens)),
      video_(folder / (scene.name + video::extension(scene.output.video))),
      writer_(video_, info, writer_options(scene.output, threads)),
      truth_(folder / "truth.jsonl", std::ios::binary),
      aircraft_(aircraft_of(scene)),
      sheet_(scene.name, info.frame_count_estimate) {
  check_truth("create");
  const std::size_t files = std::max<std::size_t>(1, aircraft_);
  for (std::size_t i = 0; i < files; ++i) {
    const std::string suffix = files == 1 ? "" : "-" + scene.intruders[i].id;
    evision_.emplace_back(folder / (scene.name + suffix + ".xml"));
  }
}

void Outputs::check_truth(const char* what) const {
  if (!truth_)
    throw Error(fmt::format("cannot {}: {}", what, std::strerror(errno)),
                {(folder_ / "truth.jsonl").string()});
}

void Outputs::write(const video::Frame& frame,
                    const annotation::Frame& truth,
                    const std::vector<insertion::MaskFile>& masks) {
  writer_.write(frame);
  for (const insertion::MaskFile& mask : masks) {
    fs::create_directories((folder_ / mask.name).parent_path());
    write_file(folder_ / mask.name, mask.png, Flush::kLater);
  }
  truth_ << annotation::jsonl_line(truth, lens_) << '\n';
  check_truth("write");
  const Vector3& camera_ned_m = truth.camera_position_ned_m;
  // The format is one of aircraft, which come first.
  if (aircraft_ == 0) evision_[0].add(std::nullopt, camera_ned_m);
  for (std::size_t i = 0; i < aircraft_; ++i) {
    const annotation::Intruder& intruder = truth.intruders[i];
    evision_[i].add(intruder.state == annotation::State::kEnded
                        ? std::nullopt
                        : std::optional(evision_frame(truth, intruder)),
                    camera_ned_m);
  }
  sheet_.add(frame.picture, truth);
}

void Outputs::finish(const scene::Scene& scene,
                     const std::vector<Checksum>& inputs,
                     const std::vector<EncounterRecord>& encounters,
                     const Summary& summary) {
  writer_.finish();
  truth_.close();
  check_truth("write");
  for (annotation::EvisionWriter& file : evision_) file.finish();
  video::write_still(folder_ / "preview.jpg", sheet_.sheet());
  if (scene.output.masks) flush_files(folder_);
  nlohmann::ordered_json record;
  record["format"] = "airtruth sequence 1";
  record["version"] = kVersion;
  record["name"] = scene.name;
  record["seed"] = scene.seed;
  record["weight"] = or_null(scene.weight);
  if (const auto weather = scene::weather_facts(scene); !weather.empty())
    record["weather"] = weather;
  record["encoder"] = writer_.encoder();
  record["covered_alpha"] = composite::kCoveredAlpha / 255.0;
  record["scene_toml"] = scene::toml_from_scene(scene);
  record["inputs"] = json_of(inputs);
  record["outputs"] = json_of(checksums_below(folder_));
  record["summary"] = {{"frames", summary.frames},
                       {"frames_with_an_intruder_visible", summary.frames_visible},
                       {"frames_with_bridged_motion", summary.frames_bridged},
                       {"frames_damaged_in_the_background", summary.frames_damaged}};
  record["encounters"] = json_of(encounters);
  write_file(folder_ / "sequence.json", record.dump(2) + "\n");
}

std::vector<Checksum> input_files(const scene::Scene& scene,
                                  const setup::World& world,
                                  const std::string& video_sha256,
                                  setup::SharedInputs& inputs) {
  std::vector<Checksum> result;
  if (!video_sha256.empty()) result.push_back({scene.background.video.string(), video_sha256});
  const auto add = [&](const fs::path& file) {
    result.push_back({file.string(), inputs.sha256_of_file(file)});
  };
  std::set<fs::path> masks;
  for (const scene::Occluder& occluder : scene.occluders)
    if (occluder.mask && masks.insert(*occluder.mask).second)
      result.push_back({occluder.mask->string(), setup::sha256_of_video(*occluder.mask, inputs)});
  for (const fs::path& file : scene::stated_files(scene))
    if (file != scene.background.video && !masks.contains(file)) add(file);
  for (const fs::path& model : model_files(world)) add(model);
  return result;
}

}  // namespace airtruth::pipeline
