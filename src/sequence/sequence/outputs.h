// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
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
#include "sequence/frame/masks.h"
#include "sequence/sequence/encounter_record.h"
#include "sequence/sequence/sequence.h"
#include "show/drawing/pictures.h"

// Writes the output of a run (docs/formats/output.md) frame by frame into the staged folder.
namespace airtruth::sequence {

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

  // The encoder may read the frame's own memory: the picture must not change after the call.
  void write(const std::shared_ptr<const video::Frame>& frame,
             const annotation::Frame& truth,
             const std::vector<MaskFile>& masks);
  // Closes all files and writes the annotation, the preview and, last, sequence.json. `scene` is
  // the scene that was rendered: its camera model may have been measured after the outputs were
  // opened.
  void finish(const scene::Scene& scene,
              const std::vector<Checksum>& inputs,
              const std::vector<EncounterRecord>& encounters,
              const Summary& summary);

 private:
  void write_annotations() const;
  void write_preview() const;
  void write_record(const std::vector<Checksum>& inputs,
                    const std::vector<EncounterRecord>& encounters,
                    const Summary& summary) const;

  fs::path folder_;
  scene::Scene scene_;
  annotation::LensFacts lens_;
  fs::path video_;
  video::Writer writer_;
  std::ofstream truth_;
  std::vector<Vector3> camera_ned_m_;
  // Indexed by [intruder][frame]. A scene without intruders has one entry whose frames have no
  // position.
  std::vector<std::vector<std::optional<annotation::EvisionFrame>>> evision_;
  drawing::ContactSheet sheet_;
};

}  // namespace airtruth::sequence
