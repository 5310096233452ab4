// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <airtruth/labels.h>

#include "foundation/base/files.h"

// Writes labelled clips one by one in the formats of <airtruth/labels.h>, without holding the whole
// set in memory.
namespace airtruth::exchange {

struct WriteOptions {
  // Every category that the clips use, in the order of the classes.
  std::vector<std::string> categories;
  // For example "train" and "val".
  std::vector<std::string> parts;
  std::string image_extension = ".jpg";
  // True: pictures are written beside the labels.
  bool with_images = true;
  // MOT only. True: classes are numbered from 1; false: every object has the class 1, and what is
  // no aircraft is not to be considered.
  bool mot_classes = false;
  // WebDataset only. Below this folder of the root the pictures wait to be packed (images() gives
  // their places); who makes the export removes it at the end.
  fs::path staging = "pictures";
  // WebDataset only: a shard ends with the first sample that makes it this large.
  std::int64_t shard_bytes = 500'000'000;
  // The table only: the names of further columns, and their cells in the row of a label of the
  // clip that is added.
  std::vector<std::string> columns;
  std::function<std::vector<std::string>(std::int64_t frame, const Label& label)> cells;
  // COCO only: the ids of the categories by name (label_file::CocoNumbers); those that are not here
  // are counted from 1.
  std::map<std::string, std::int64_t> category_ids = {};
};

// Writes a set into a folder, clip by clip. Of clips that are written it keeps only the names in
// memory.
class Writer {
 public:
  virtual ~Writer() = default;
  // The paths of the pictures of clip.frames, relative to the folder, one for each frame. `clip` is
  // a result of arranged().
  virtual std::vector<fs::path> images(const Clip& clip, const std::string& part) const = 0;
  virtual void add(const Clip& clip, const std::string& part) = 0;
  virtual void finish() = 0;
};
// Throws Error where the format can only be read.
void expect_written(Format format);
// Throws Error where a clip lacks what the format needs.
void expect_held(Format format, const Clip& clip);

std::unique_ptr<Writer> make_writer(Format format,
                                    const fs::path& root,
                                    const WriteOptions& options);

// True where the format can say of a box that it is of the class "ignore": COCO's iscrowd, VOC's
// difficult, MOT's seventh column, the class of a WebDataset and of a table.
bool has_ignore_mark(Format format);

// The clip without its distractors.
Clip aircraft_alone(Clip clip);

// By how much the number of each frame is more than that of the frame before, where it is the same
// throughout; empty for other clips, and for fewer than two frames.
std::optional<std::int64_t> frame_step(const Clip& clip);

// By the name of each clip that arranged() makes, the clip of which it is made.
using ArrangedNames = std::map<std::string, std::string>;
// Adds what is made of `clip`. Throws Error where a name is there: the object of track 2 in a clip
// "a" of several, and the only one of a clip "a-2".
void add_names(ArrangedNames& names, const std::string& clip, const std::vector<Clip>& arranged);

// What the format's own reader requires of pictures: AOT's opens PNG only, those of OTB and GOT-10k
// look for *.jpg; a table holds none.
enum class Pictures { kAny, kPngAlone, kJpgExpected, kNone };
Pictures pictures_of(Format format);

// The text of LOSS.md: what a format keeps of the truth, and what it cannot store.
std::string loss(Format format);

}  // namespace airtruth::exchange
