// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include <airtruth/dataset.h>
#include <airtruth/truth.h>
#include <nlohmann/json.hpp>

#include "camera/lens/lens.h"
#include "dataset/sequences/labels_of_truth.h"
#include "dataset/sequences/layout.h"
#include "foundation/base/error.h"
#include "foundation/base/files.h"
#include "foundation/json/parse_json.h"
#include "labels/annotation/truth.h"
#include "library/records/public_forms.h"

namespace airtruth {
namespace {

SequenceTruth public_truth(annotation::Truth truth) {
  return {public_lens(lens::lens_of(truth.lens)), std::move(truth.frames)};
}

// The video beside the record: NAME.mp4, NAME.mkv or NAME.avi, or the folder NAME of numbered png.
fs::path video_in(const fs::path& folder, const std::string& name) {
  for (const char* extension : {".mp4", ".mkv", ".avi", ""})
    if (const fs::path video = folder / (name + extension); fs::exists(video)) return video;
  throw Error("holds no video " + name + ".mp4, .mkv or .avi, and no folder " + name +
                  " of pictures; the folder is not whole",
              {folder.string()});
}

// The name that the record states.
std::string name_in_record(const fs::path& folder) {
  const fs::path file = folder / "sequence.json";
  const auto record = parse_json(read_file(file));
  if (!record.is_object() || !record.contains("name") || !record["name"].is_string())
    throw Error("is not a record of airtruth", {file.string()});
  const auto name = record["name"].get<std::string>();
  // A manipulated record must not name files outside its folder.
  if (!is_plain_file_name(name))
    throw Error("name is '" + name.substr(0, 80) + "'; expected " + kPlainFileName,
                {file.string()});
  return name;
}

exchange::Clip labels_of(const Sequence& sequence,
                         const annotation::Truth& truth,
                         dataset::Boxes boxes) {
  exchange::Clip clip;
  clip.name = sequence.name;
  clip.media = sequence.video;
  clip.width = truth.lens.width;
  clip.height = truth.lens.height;
  for (const annotation::Frame& frame : truth.frames)
    clip.frames.push_back(sequences::labels_of(frame, boxes, clip.width, clip.height));
  return clip;
}

Sequence rendered(const fs::path& folder, dataset::Boxes boxes) {
  Sequence sequence;
  sequence.folder = folder;
  sequence.name = name_in_record(folder);
  sequence.video = video_in(folder, sequence.name);
  annotation::Truth truth = annotation::read_truth(folder / "truth.jsonl");
  sequence.labels = labels_of(sequence, truth, boxes);
  sequence.truth = public_truth(std::move(truth));
  return sequence;
}

Sequence imported(const fs::path& folder) {
  Sequence sequence;
  sequence.folder = folder;
  sequence.is_imported = true;
  sequence.labels = exchange::read_labels(folder / sequences::kLabels);
  sequence.name = sequence.labels.name;
  sequence.video = sequence.labels.media;
  return sequence;
}

}  // namespace

SequenceTruth read_truth(const std::filesystem::path& file) {
  return public_truth(annotation::read_truth(file));
}

std::string truth_line(const FrameTruth& truth, const Lens& lens) {
  return annotation::jsonl_line(truth, lens::facts_of(lens.state().lens));
}

struct DataSet::State {
  sequences::SequenceFolders folders;
};

DataSet::DataSet(const std::filesystem::path& folder)
    : state_(std::make_shared<const State>(State{sequences::sequence_folders(folder)})) {
  if (names().empty()) throw sequences::no_sequence_in(folder);
}

const std::vector<std::string>& DataSet::names() const { return state_->folders.names; }

Sequence DataSet::sequence(const std::string& name, dataset::Boxes boxes) const {
  if (!std::binary_search(names().begin(), names().end(), name))
    throw Error("holds no sequence '" + name + "'", {state_->folders.root.string()});
  const fs::path folder = state_->folders.folder(name);
  return fs::exists(folder / sequences::kLabels) ? imported(folder) : rendered(folder, boxes);
}

}  // namespace airtruth
