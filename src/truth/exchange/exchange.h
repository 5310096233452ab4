// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "foundation/base/log.h"
#include "truth/exchange/labels.h"

// The annotation formats that trainers and toolkits read (docs/formats/exchange.md has each one's
// folders, origins and sources).
namespace airtruth::exchange {

enum class Format {
  kCoco,
  kYolo,
  kMot,
  kVoc,
  kCvat,
  kAot,
  kOtb,
  kGot10k,
  kVot,
  kEvision,  // read only, as the next: `render` writes it
  kCsv,
};

// "coco", "yolo", "mot", "voc", "cvat", "aot", "otb", "got10k", "vot", "evision", "csv"; throws
// Error with the nearest for anything else.
Format format_from_name(std::string_view name);
const char* name(Format format);
bool can_write(Format format);

// One object a sequence, from the first frame that shows it whole (or shows it, where none does or
// nothing is known) to the last that shows it: OTB, GOT-10k, VOT.
bool is_single_object(Format format);

// The clips that a format makes of one: itself, or a clip for each of its tracks.
std::vector<Clip> arranged(Format format, const Clip& clip);

struct WriteOptions {
  std::vector<std::string> categories;  // every one that the clips use, in the order of the classes
  std::vector<std::string> parts;       // "train", "val", ...
  std::string image_extension = ".jpg";
  bool with_images = true;   // pictures are written beside the labels
  bool mot_classes = false;  // MOT: classes numbered from 1 in place of 1 for every object
};

// Writes a set into a folder, clip by clip; of those written no more than names are held.
class Writer {
 public:
  virtual ~Writer() = default;
  // Where the pictures of clip.frames belong, relative to the folder, one for each. `clip` as
  // arranged().
  virtual std::vector<fs::path> images(const Clip& clip, const std::string& part) const = 0;
  virtual void add(const Clip& clip, const std::string& part) = 0;
  virtual void finish() = 0;
};
std::unique_ptr<Writer> make_writer(Format format,
                                    const fs::path& root,
                                    const WriteOptions& options);

// What the format's own reader does with pictures: AOT's opens PNG alone, those of OTB and GOT-10k
// look for *.jpg.
enum class Pictures { kAny, kPngAlone, kJpgExpected };
Pictures pictures_of(Format format);

// LOSS.md: what a format keeps of our truth, and what it has no place for.
std::string loss(Format format);

struct ReadOptions {
  std::optional<std::pair<int, int>>
      size;                           // of the pictures, where neither labels nor pictures say
  std::string category = "aircraft";  // where the format has none
  int origin_px = 0;                  // of CSV: what the first pixel is called, 0 or 1
};

// Every clip of a set. `source`: the folder that a Writer filled, or one of the same form; for
// COCO, CVAT and AOT also the annotation file; for E-Vision an XML file or a folder of them; for
// CSV
// (`frame,x,y,w,h`) a file or a folder. Frames without an object are there and empty. Throws Error
// at file and line; warns of what it left out.
std::vector<Clip> read_clips(Format format,
                             const fs::path& source,
                             const ReadOptions& options,
                             const Warn& warn);

}  // namespace airtruth::exchange
