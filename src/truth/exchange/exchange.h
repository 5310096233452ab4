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

// The annotation formats that trainers and toolkits read (docs/formats/exchange.md has the folders,
// origins and sources of each).
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
  // Read only: `render` writes it.
  kEvision,
  kCsv,
};

// "coco", "yolo", "mot", "voc", "cvat", "aot", "otb", "got10k", "vot", "evision" or "csv". For any
// other name it throws an Error that offers the nearest.
Format format_from_name(std::string_view name);
const char* name(Format format);
bool can_write(Format format);

// True for OTB, GOT-10k and VOT, which store one object for each sequence. A sequence begins with
// the first frame that shows the object whole (or shows it, where no frame does or the labels lack
// that information) and ends with the last that shows it.
bool is_single_object(Format format);

// The clips that a format stores for one clip: the clip itself, or one clip for each of its tracks.
std::vector<Clip> arranged(Format format, const Clip& clip);

struct WriteOptions {
  // Every category that the clips use, in the order of the classes.
  std::vector<std::string> categories;
  // For example "train" and "val".
  std::vector<std::string> parts;
  std::string image_extension = ".jpg";
  // True: pictures are written beside the labels.
  bool with_images = true;
  // MOT only. True: classes are numbered from 1; false: every object has the class 1.
  bool mot_classes = false;
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
std::unique_ptr<Writer> make_writer(Format format,
                                    const fs::path& root,
                                    const WriteOptions& options);

// What the format's own reader requires of pictures: AOT's opens PNG only, those of OTB and GOT-10k
// look for *.jpg.
enum class Pictures { kAny, kPngAlone, kJpgExpected };
Pictures pictures_of(Format format);

// The text of LOSS.md: what a format keeps of the truth, and what it cannot store.
std::string loss(Format format);

struct ReadOptions {
  // Width and height of the pictures, for sets whose labels and pictures do not state them.
  std::optional<std::pair<int, int>> size;
  // The category of objects where the format has none.
  std::string category = "aircraft";
  // CSV only: the coordinate of the first pixel, 0 or 1.
  int origin_px = 0;
};

// Reads every clip of a set. `source` is the folder that a Writer filled, or one of the same form.
// For COCO, CVAT and AOT it may also be the annotation file; for E-Vision it is an XML file or a
// folder of them; for CSV (`frame,x,y,w,h`) it is a file or a folder. Frames without an object are
// present and empty. Throws Error with file and line, and warns of what it left out.
std::vector<Clip> read_clips(Format format,
                             const fs::path& source,
                             const ReadOptions& options,
                             const Warn& warn);

}  // namespace airtruth::exchange
