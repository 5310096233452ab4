// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "camera/lens/lens.h"
#include "labels/annotation/evision.h"
#include "labels/annotation/lens_facts.h"
#include "labels/annotation/truth.h"
#include "picture/video/reader.h"
#include "picture/video/writer.h"
#include "scene/scene/scene.h"
#include "sequence/insertion/masks.h"
#include "sequence/pipeline/encounter_record.h"
#include "sequence/pipeline/render.h"
#include "sequence/setup/world.h"
#include "show/drawing/pictures.h"

// Writes the output of a run (docs/formats/output.md) frame by frame into the staged folder.
namespace airtruth::pipeline {

// An input or output file with its SHA-256, for sequence.json.
struct Checksum {
  std::string name;
  std::string sha256;
};

class Outputs {
 public:
  Outputs(const fs::path& folder,
          const scene::Scene& scene,
          const lens::Lens& lens,
          const video::StreamInfo& info,
          int threads);

  void write(const video::Frame& frame,
             const annotation::Frame& truth,
             const std::vector<insertion::MaskFile>& masks);
  // Closes all files and writes the annotation, the preview and, last, sequence.json. `scene` is
  // the resolved scene.
  void finish(const scene::Scene& scene,
              const std::vector<Checksum>& inputs,
              const std::vector<EncounterRecord>& encounters,
              const Summary& summary);

 private:
  // Throws Error where the truth could not be written so far.
  void check_truth(const char* what) const;

  fs::path folder_;
  annotation::LensFacts lens_;
  fs::path video_;
  video::Writer writer_;
  std::ofstream truth_;
  std::size_t aircraft_ = 0;  // of the scene's intruders, which they are the first of
  // By aircraft. A scene without aircraft has one file whose frames have no position.
  std::vector<annotation::EvisionWriter> evision_;
  drawing::ContactSheet sheet_;
};

// The files of the aircraft's models, by name.
std::vector<fs::path> model_files(const setup::World& world);

// Every file that a run reads, with its SHA-256, for sequence.json: video, mask, camera file, lens
// file, path files, masks of occluders, and the files of the aircraft's models by name. `scene` is
// the one the user gave. An empty `video_sha256` is left out. A series of pictures has one SHA-256.
std::vector<Checksum> input_files(const scene::Scene& scene,
                                  const setup::World& world,
                                  const std::string& video_sha256,
                                  setup::SharedInputs& inputs);

}  // namespace airtruth::pipeline
