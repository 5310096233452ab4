// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "labels/exchange/exchange.h"

namespace airtruth::labelled {

struct ImportOptions {
  exchange::Format format = exchange::Format::kCoco;
  exchange::ReadOptions read;
  // Maps a clip's name to its video, for videos that do not lie beside the labels. The name ""
  // stands for the only clip.
  std::map<std::string, fs::path> videos;
  // The class of the objects of clips whose name fits a pattern (foundation/base/names.h); the
  // last that fits counts. Clips without one hold aircraft. Objects without a category take the
  // class as theirs.
  struct ObjectClass {
    std::string pattern;
    std::string name;
  };
  std::vector<ObjectClass> classes;
  // Of pictures, for sets that state none.
  std::optional<double> frame_rate_hz;
  Warn warn;
};

struct ImportSummary {
  std::int64_t clips = 0;
  std::int64_t frames = 0;
  std::int64_t labels = 0;
};

// "bird" is the class of all clips ({"*", "bird"}), and "V_BIRD*=bird" that of those whose name
// fits. Throws Error for a class that is none.
ImportOptions::ObjectClass object_class_from(const std::string& text);

// "CATEGORY=CLASS" as the category and the class. Throws Error for any other text.
std::pair<std::string, std::string> class_of_category_from(const std::string& text);

// Reads labelled video of another format and writes out/sequences/NAME/labels.jsonl,
// sequence.json and, of pictures, pictures.txt (docs/formats/labels.md). `overlay`, `dataset
// export` and the evaluation read these like rendered sequences. The videos stay where they are.
// Throws Error where `out` exists and is not empty, for a class that is none, for a pattern that
// fits no clip, and for a video that fits none or several.
ImportSummary import_set(const fs::path& source, const fs::path& out, const ImportOptions& options);

}  // namespace airtruth::labelled
