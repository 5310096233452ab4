// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/files.h"
#include "foundation/base/log.h"
#include "foundation/json/json_object.h"
#include "runners/results/detections.h"

// Detections as files (docs/detection.md). A folder holds one detector's:
//   detector.json     its name and settings (runners/runs writes it)
//   SEQUENCE.txt      MOTChallenge text, a line for each detection:
//                     frame,id,left,top,width,height,score,-1,-1,-1
//                     frames count from 1, the first pixel is at 1, the id of no track is -1
//   SEQUENCE.json     size and number of frames, categories, seconds of each frame; a video's path
//                     and the pictures' rate, where they were stated; the SHA-256 of what it was
//                     made of; it is written after the text, so a sequence that has it is whole
//   detections.json   COCO results of all sequences
//   backgrounds/      .txt and .json of the videos that the set was made over, where that is asked
// Coordinates are written to 1/1000 px (as_written()) and scores with 9 digits.
namespace airtruth::results {

// Whether a tracker's or detector's results can have this name: 1 to 80 of letters, digits, '-',
// '_' and '.', and no '.' first.
bool is_results_name(std::string_view name);
// Whether a name may hold this character.
bool is_of_results_name(char c);

// What a data set states about a sequence, and how results name its frames and categories.
struct ExpectedSequence {
  std::string name;
  int width = 0;  // px; 0: unknown
  int height = 0;
  std::int64_t frames = 0;
  // Of a sequence that was labelled elsewhere, for each frame: the picture's file name and its
  // number in its set (COCO's image id); empty where it has none. Both lists may be empty.
  std::vector<std::string> pictures = {};
  std::vector<std::optional<std::int64_t>> image_ids = {};
  // The categories by their numbers in that set.
  std::map<std::int64_t, std::string> category_ids = {};
  // The categories of its objects, and those of them that are no aircraft.
  std::set<std::string> categories = {};
  std::set<std::string> distractors = {};
};

// Coordinates are written as multiples of it.
inline constexpr double kWrittenStep_px = 0.001;
// The box as it is read again once it was written. Sides above 0 stay so.
Box as_written(const Box& box);

// Writes FOLDER/logs/RUN.log: what a tracker or detector printed, and how its run was broken off.
// Without text there is no such file, nor that of an earlier try.
void write_log(const fs::path& folder, const std::string& run, const std::string& text);

// Writes SEQUENCE.txt and SEQUENCE.json. Throws Error where a file cannot be written.
void write_sequence(const fs::path& folder, const SequenceDetections& detections);
// True where both files of a sequence are there.
bool has_sequence(const fs::path& folder, const std::string& name);
// Throws Error where the sequence of that name in the folder has another source, content or
// stated rate. What only one of the two states does not matter.
void expect_made_of(const fs::path& folder, const SequenceDetections& detections);
// The key of a record of results for what names the content of its sequence or its video.
inline constexpr const char* kSourceSha256 = "source_sha256";
// Its value for a sequence of a set; "" where the record is of a video alone, or lacks it.
std::string sha256_of_sequence(const JsonObject& record);
// Reads both files; of a video alone, without its source. Throws Error as read_detections does.
SequenceDetections read_sequence(const fs::path& folder, const std::string& name);

// Reads the detections of a set, in the order of `set`. A sequence without results is left out:
// in COCO results, which have no place for it, every sequence is present. `source` is one of
//   a folder as above;
//   a folder of MOTChallenge results: SEQUENCE.txt, data/SEQUENCE.txt or SEQUENCE/det/det.txt;
//   a COCO results file, or a folder with one JSON file alone: a list of {image_id, category_id,
//     bbox, score, track_id}.
// `file_name` or `image_name` of a COCO result, or an image_id that is a text, names the picture:
// by the file name that its set gave it, with or without folders and ending, or as NAME/000000.jpg.
// An image_id that is a number is the set's own id. Where the set states none, or one twice, they
// follow from `set`: the frames of all sequences are counted through in its order, from 1, as
// `airtruth dataset export --format coco` counts them (label_file::CocoNumbers). Where the file has
// an id that no picture has, and every id of it is the number that a picture is named (000012.jpg),
// as Ultralytics writes them, these numbers name the pictures. A category is named `category_name`,
// else by the set's category ids, else by those of its export; category_id 1 alone is "aircraft",
// and what fits none is "2", "3", ... What fits is decided by the whole file; `warn` hears of a
// file that fits two of these, or none. Throws Error with file and line for text that is no result,
// a sequence, image or frame that the set does not have, a box outside its image or without area, a
// score or coordinate that is not finite, a track that is twice in one frame, and a sequence that
// is there twice.
std::vector<SequenceDetections> read_detections(const fs::path& source,
                                                std::span<const ExpectedSequence> set,
                                                const Warn& warn = {});

// The same from COCO's results format alone (cocodataset.org, "Results format"): a list of
// {image_id, category_id, bbox, score}; bbox is [x, y, width, height] with the first pixel at 0. Or
// a whole COCO file whose annotations each have a score.
std::vector<SequenceDetections> read_coco_results(const fs::path& file,
                                                  std::span<const ExpectedSequence> set,
                                                  const Warn& warn = {});
// Writes COCO results of `set` to a file. `set` gives the ids, as read_detections() takes them;
// where it states none, categories are numbered from 1 in alphabetical order. The sequences are
// read from `folder` one at a time; a sequence of the set that is not in the folder has no results.
void write_coco_results(const fs::path& file,
                        const fs::path& folder,
                        std::span<const ExpectedSequence> set);

}  // namespace airtruth::results
